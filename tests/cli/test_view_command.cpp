#include <filesystem>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "tests/cli/job.h"
#include "tests/support/caught.h"
#include "tests/view/page_reader.h"
#include "view/built_files.h"

// --view: a page beside the result, which is there with it or not at all.
namespace aerate::test {
namespace {

using Json = nlohmann::json;
using Names = std::vector<std::string>;

constexpr int kFailure = 1;
constexpr int kUsage = 2;

// What the page's data begins with.
Json header_of(const std::filesystem::path& page) {
  const std::string html = read_bytes(page);
  const std::string begin = "<script id=\"data\" type=\"text/plain\">";
  const std::size_t from = html.find(begin) + begin.size();
  const std::string bytes = inflated(from_base64(html.substr(from, html.find('<', from) - from)));
  std::size_t length = 0;
  for (unsigned i = 0; i < 4; ++i)
    length |= static_cast<std::size_t>(static_cast<unsigned char>(bytes.at(i))) << 8 * i;
  return Json::parse(bytes.substr(4, length));
}

class View : public testing::Test {
 protected:
  void SetUp() override {
    if (!built_file("view.html"))
      GTEST_SKIP() << "built without the page: " << why_no_built_file("view.html");
  }

  ProcessResult hollow(const Names& more) const {
    Names arguments{"--view", page()};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run(job_.hollow(job_.input("block.stl", block()), arguments));
  }
  std::filesystem::path page() const { return job_.output("page.html"); }

  Job job_;
};

TEST_F(View, SaysWhatTheReportSays) {
  const ProcessResult result = hollow({"--json", "-"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const Json report = Json::parse(result.out);
  const Json header = header_of(page());
  EXPECT_EQ(header["title"], "block.stl");
  EXPECT_EQ(header["use"], "removed");
  EXPECT_EQ(header["voids"]["radius"].size(), report["voids"]["count"]);
  EXPECT_LE(header["grid"]["step"].get<double>(), header["tolerance"].get<double>() / 4);
  std::size_t triangles = 0;
  for (const Json& count : header["parts"]["triangles"]) triangles += count.get<std::size_t>();
  EXPECT_EQ(triangles, report["output"]["triangles"]);
  ASSERT_FALSE(header["changes"].empty());
  EXPECT_NEAR(header["changes"][0]["before"].get<double>(), 27, 1e-6);
  EXPECT_LT(header["changes"][0]["after"].get<double>(), 27);
}

TEST_F(View, IsTheSameForAnyNumberOfThreads) {
  ASSERT_EQ(hollow({"--threads", "1", "--quiet"}).exit_code, 0);
  const std::string alone = read_bytes(page());
  ASSERT_EQ(hollow({"--threads", "2", "--quiet"}).exit_code, 0);
  EXPECT_EQ(read_bytes(page()), alone);
}

TEST_F(View, IsMadeOfAllJobsThatShowSomething) {
  const std::filesystem::path model = job_.input("block.stl", block());
  ASSERT_EQ(run({AERATE_EXECUTABLE, "inspect", model, "--view", page(), "--quiet"}).exit_code, 0);
  EXPECT_EQ(header_of(page())["use"], "found");
  ASSERT_EQ(
      run({AERATE_EXECUTABLE, "pack", model, "-o", job_.output("spheres.csv"), "--view", page(), "--quiet"})
          .exit_code,
      0);
  EXPECT_EQ(header_of(page())["use"], "packed");
  ASSERT_EQ(run({AERATE_EXECUTABLE, "hollow", model, "-o", job_.output("out.3mf"), "--as", "modifiers",
                 "--view", page(), "--quiet"})
                .exit_code,
            0);
  EXPECT_EQ(header_of(page())["use"], "modifiers");
}

TEST_F(View, IsNotThereAfterAnError) {
  const ProcessResult result = hollow({"--wall", "20"});
  EXPECT_NE(result.exit_code, 0);
  EXPECT_EQ(entries_of(job_.outputs()), Names{});
}

TEST_F(View, IsRefusedWhereItCannotBeWritten) {
  const ProcessResult result =
      run(job_.hollow(job_.input("block.stl", block()), {"--view", "/nowhere/page.html"}));
  EXPECT_EQ(result.exit_code, kFailure);
  EXPECT_TRUE(contains(result.err, "/nowhere/page.html"));
  EXPECT_EQ(entries_of(job_.outputs()), Names{});
}

TEST_F(View, IsRefusedByAnotherEnding) {
  const ProcessResult result =
      run(job_.hollow(job_.input("block.stl", block()), {"--view", job_.output("page.png")}));
  EXPECT_EQ(result.exit_code, kUsage);
  EXPECT_TRUE(contains(result.err, ".html"));
  EXPECT_EQ(entries_of(job_.outputs()), Names{});
}

TEST_F(View, ReplacesNeitherTheResultNorTheModel) {
  const std::filesystem::path model = job_.input("model.html", "no model");
  const ProcessResult result = run(job_.hollow(model, {"--view", model}));
  EXPECT_EQ(result.exit_code, kUsage);
  EXPECT_EQ(read_bytes(model), "no model");
}

TEST(ViewWithoutPage, SaysWhatTheBuildWasMissing) {
  if (built_file("view.html")) GTEST_SKIP() << "built with the page";
  const Job job;
  const ProcessResult result =
      run(job.hollow(job.input("block.stl", block()), {"--view", job.output("page.html")}));
  EXPECT_EQ(result.exit_code, kUsage);
  EXPECT_TRUE(contains(result.err, std::string(why_no_built_file("view.html"))));
  EXPECT_EQ(entries_of(job.outputs()), Names{});
}

}  // namespace
}  // namespace aerate::test
