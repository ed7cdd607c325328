#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "tests/cli/job.h"

// `inspect --overhangs`.
namespace aerate::test {
namespace {

using Json = nlohmann::json;

Mesh with_arm() {
  return join(make_box({0, 0, 0}, {10, 10, 20}), make_box({10, 0, 15}, {30, 10, 20}));
}

ProcessResult inspect(const std::filesystem::path& model, const std::vector<std::string>& more) {
  std::vector<std::string> command{AERATE_EXECUTABLE, "inspect", model};
  command.insert(command.end(), more.begin(), more.end());
  return run(command);
}

TEST(InspectOverhangs, ListsThem) {
  const Job job;
  const ProcessResult result = inspect(job.input("arm.stl", with_arm()), {"--overhangs", "--json", "-"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const Json overhangs = Json::parse(result.out)["overhangs"];
  EXPECT_EQ(overhangs["process"], "fdm");
  EXPECT_EQ(overhangs["overhang_degrees"], 45);
  EXPECT_EQ(overhangs["reach_mm"], 2.5);
  ASSERT_EQ(overhangs["regions"].size(), 1U);
  const Json region = overhangs["regions"][0];
  EXPECT_NEAR(region["area_mm2"].get<double>(), 200, 15);
  EXPECT_NEAR(region["width_mm"].get<double>(), 10, 1);
  EXPECT_NEAR(region["farthest_mm"].get<double>(), 20, 0.6);
  EXPECT_NEAR(region["place_mm"][2].get<double>(), 15, 1e-4);
  EXPECT_EQ(region["begins_in_air"], false);
}

TEST(InspectOverhangs, SaysItInWords) {
  const Job job;
  const auto model = job.input("arm.stl", with_arm());
  EXPECT_NE(inspect(model, {"--overhangs"}).out.find("needs supports: 1 overhang"), std::string::npos);
  EXPECT_NE(inspect(model, {"--overhangs", "--up=-z"}).out.find("prints without supports"),
            std::string::npos);
  EXPECT_NE(inspect(model, {"--overhangs", "--process", "sls"}).out.find("the powder of sls carries it"),
            std::string::npos);
  Mesh open = with_arm();
  open.triangles.pop_back();
  EXPECT_NE(inspect(job.input("open.stl", open), {"--overhangs"}).out.find("cannot be told"),
            std::string::npos);
}

TEST(InspectOverhangs, OptionsThatAskNothingAreRefused) {
  const Job job;
  const auto model = job.input("arm.stl", with_arm());
  EXPECT_EQ(inspect(model, {"--process", "fdm"}).exit_code, 2);
  EXPECT_EQ(inspect(model, {"--up=-z"}).exit_code, 2);
  EXPECT_EQ(inspect(model, {"--overhangs", "--build", "hanging"}).exit_code, 2);
}

}  // namespace
}  // namespace aerate::test
