#include <algorithm>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "tests/cli/job.h"
#include "tests/slicer/slicing.h"
#include "tests/support/caught.h"
#include "tests/support/files.h"

// `slice --supports`, and supports as a part.
namespace aerate::test {
namespace {

using Json = nlohmann::json;

Mesh tee() {
  return join(make_box({25, 0, 0}, {35, 20, 30}), make_box({0, 0, 30}, {60, 20, 36}));
}

class SliceSupports : public testing::Test {
 protected:
  ProcessResult slice(const std::vector<std::string>& more,
                      const std::string& slicer = "prusa-slicer") const {
    std::vector<std::string> command{AERATE_EXECUTABLE,
                                     "slice",
                                     job.input("tee.stl", tee()),
                                     "-o",
                                     job.output("out.gcode"),
                                     "--slicer",
                                     slicer,
                                     "--supports"};
    command.insert(command.end(), more.begin(), more.end());
    return run(command);
  }

  Job job;
};

TEST_F(SliceSupports, TakeLessThanTheSlicersOwn) {
  if (!is_installed("prusa-slicer")) GTEST_SKIP() << "prusa-slicer is not installed: nothing was sliced";
  const ProcessResult result = slice({"--json", "-"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const Json json = Json::parse(result.out);
  const auto filament = [&](const std::string& name) {
    const auto form =
        std::ranges::find_if(json["forms"], [&](const Json& each) { return each["supports"] == name; });
    return (*form)["filament_cm3"].get<double>();
  };
  const double none = filament("none"), ours = filament("aerate"), grid = filament("grid");
  // A slicer without organic ones would make its usual ones instead, and say nothing.
  for (const Json& form : json["forms"]) {
    if (form["supports"] != "organic") continue;
    EXPECT_NE(form["filament_cm3"].get<double>(), grid);
  }
  EXPECT_GT(ours, none + 0.5);
  EXPECT_LT(ours - none, 0.5 * (grid - none));
  EXPECT_GT(json["contact_mm2"].get<double>(), 50);
  EXPECT_TRUE(contains(read_bytes(job.output("out.gcode")), "G1 "));
}

TEST_F(SliceSupports, FollowTheLimitsThatAreGiven) {
  if (!is_installed("prusa-slicer")) GTEST_SKIP() << "prusa-slicer is not installed: nothing was sliced";
  const ProcessResult result = slice({"--bridge", "60"});
  EXPECT_EQ(result.exit_code, 5) << result.err;
  EXPECT_TRUE(contains(result.err, "more than 30 mm from what holds it"));
  EXPECT_TRUE(std::filesystem::is_empty(job.outputs()));
}

TEST_F(SliceSupports, RefuseWhatNoSlicerPrints) {
  EXPECT_EQ(slice({"--process", "sla"}).exit_code, 2);
  EXPECT_EQ(slice({"--process", "sls"}).exit_code, 2);
  const ProcessResult missing = slice({"--slicer-path", "/missing/slicer"});
  EXPECT_EQ(missing.exit_code, 2) << missing.err;
  EXPECT_TRUE(contains(missing.err, "/missing/slicer"));
  EXPECT_TRUE(std::filesystem::is_empty(job.outputs()));
}

TEST_F(SliceSupports, RefuseWhatIsForVoids) {
  for (const std::vector<std::string>& options :
       {std::vector<std::string>{"--as", "voids"}, std::vector<std::string>{"--compare", "patterns"}}) {
    const ProcessResult result = slice(options);
    EXPECT_EQ(result.exit_code, 2);
    EXPECT_TRUE(contains(result.err, "--supports makes no voids"));
  }
  EXPECT_TRUE(contains(slice({}, "cura-engine").err, "reads no supports as a part"));
}

}  // namespace
}  // namespace aerate::test
