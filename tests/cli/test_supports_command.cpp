#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "tests/cli/job.h"
#include "tests/support/caught.h"

// `inspect --overhangs` and `support`.
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

class SupportCommand : public testing::Test {
 protected:
  ProcessResult support(const std::vector<std::string>& more, const std::string& output = "out.stl") const {
    std::vector<std::string> command{AERATE_EXECUTABLE, "support", model, "-o", job.output(output)};
    command.insert(command.end(), more.begin(), more.end());
    return run(command);
  }
  Json report(std::vector<std::string> more, const std::string& output = "out.stl") const {
    more.insert(more.end(), {"--json", "-"});
    const ProcessResult result = support(more, output);
    EXPECT_EQ(result.exit_code, 0) << result.err;
    return result.exit_code == 0 ? Json::parse(result.out) : Json();
  }
  // Nothing is written.
  void expect_refused(const std::vector<std::string>& more, int exit_code, const std::string& why) const {
    const ProcessResult result = support(more);
    EXPECT_EQ(result.exit_code, exit_code) << result.err;
    EXPECT_TRUE(contains(result.err, why));
    EXPECT_TRUE(std::filesystem::is_empty(job.outputs()));
  }

  Job job;
  std::filesystem::path model = job.input("arm.stl", with_arm());
};

TEST_F(SupportCommand, WritesWhatItReports) {
  const Json json = report({});
  EXPECT_EQ(json["schema"], "aerate.support");
  EXPECT_EQ(json["teeth"]["kind"], "ridges");
  EXPECT_EQ(json["contact"]["unsupported_mm2"], 0);
  EXPECT_LT(json["contact"]["farthest_mm"].get<double>(), 2.5 + 1.5 * 0.45);
  EXPECT_GT(json["body"]["footing_margin_mm"].get<double>(), 0);
  EXPECT_EQ(json["body"]["fill"], "plain");
  EXPECT_TRUE(json["parts"].is_null());
  // Read by others, too.
  const ProcessResult read = inspect(job.output(), {"--json", "-"});
  ASSERT_EQ(read.exit_code, 0);
  EXPECT_EQ(Json::parse(read.out)["input"]["closed"], true);
}

TEST_F(SupportCommand, FollowsUp) {
  const Json json = report({"--up=-x"});  // on the end of its arm: the column hangs over
  EXPECT_EQ(json["contact"]["unsupported_mm2"], 0);
  const ProcessResult read = inspect(job.output(), {"--json", "-"});
  const Json box = Json::parse(read.out)["input"]["box"];
  EXPECT_NEAR(box["upper_mm"][0].get<double>(), 30, 1e-3);  // the plate is at the arm's end
}

TEST_F(SupportCommand, TellsOfGapsInWholeLayers) {
  const Json json = report({"--contact-gap", "0.35"});
  EXPECT_NEAR(json["limits"]["contact_gap_mm"].get<double>(), 0.4, 1e-9);
  ASSERT_FALSE(json["notices"].empty());
  EXPECT_TRUE(contains(json["notices"][0].get<std::string>(), "rounded to 0.4 mm: 2 layers"));
}

TEST_F(SupportCommand, LeavesABodyPlainThatIsTooThinForVoids) {
  const Json json = report({"--process", "sla"});
  EXPECT_EQ(json["body"]["fill"], "plain");
  ASSERT_FALSE(json["notices"].empty());
  EXPECT_TRUE(contains(json["notices"].back().get<std::string>(), "the body stays plain"));
}

TEST_F(SupportCommand, MakesConesForResinWithCells) {
  model = job.input("tee.stl", join(make_box({25, 0, 0}, {35, 20, 30}), make_box({0, 0, 30}, {60, 20, 36})));
  const Json plain = report({"--process", "sla", "--fill", "plain"});
  EXPECT_EQ(plain["teeth"]["kind"], "cones");
  EXPECT_EQ(plain["limits"]["contact_gap_mm"], 0);
  const Json cells = report({"--process", "sla"});
  EXPECT_EQ(cells["body"]["fill"], "cells");
  EXPECT_LT(cells["body"]["volume_after_mm3"].get<double>(), 0.8 * cells["body"]["volume_mm3"].get<double>());
  EXPECT_EQ(cells["contact"]["unsupported_mm2"], 0);
}

TEST_F(SupportCommand, PutsVoidsIntoTheBodyForFilament) {
  const Json json = report({"--fill", "spheres"});
  EXPECT_EQ(json["body"]["fill"], "spheres");
  EXPECT_LT(json["body"]["volume_after_mm3"].get<double>(), 0.9 * json["body"]["volume_mm3"].get<double>());
}

TEST_F(SupportCommand, WritesAPartForASlicer) {
  for (const auto& [flavor, key] : {std::pair("prusa", "perimeters"), std::pair("orca", "wall_loops")}) {
    const Json json = report({"--parts", flavor, "--extruder", "2"}, "out.3mf");
    EXPECT_EQ(json["parts"]["settings"][key], "1");
    EXPECT_EQ(json["parts"]["settings"]["extruder"], "2");
  }
}

TEST_F(SupportCommand, RefusesWhatCannotBe) {
  expect_refused({"--process", "sls"}, 2, "carries what hangs over");
  expect_refused({"--up=-z"}, 5, "nothing needs supports");
  expect_refused({"--plate", "1"}, 2, "begins 1 mm below that");
  expect_refused({"--contact-gap", "1"}, 2, "teeth would not reach");
  expect_refused({"--parts", "prusa"}, 2, "need a 3MF");
  expect_refused({"--extruder", "2"}, 2, "--extruder is for supports");
  expect_refused({"--process", "sla", "--tooth", "0"}, 2, "--tooth");
}

TEST_F(SupportCommand, RefusesVoidsThatFindNoPlace) {
  model = job.input("low.stl", join(make_box({0, 0, 0}, {10, 10, 8}), make_box({10, 0, 3}, {16, 10, 8})));
  expect_refused({"--process", "sla", "--fill", "spheres"}, 5, "");
}

TEST_F(SupportCommand, RefusesAPlaceWithoutRoom) {
  // A slot of 0.5 mm: a gap on each side leaves half a layer.
  model = job.input("slot.stl",
                    join(join(make_box({0, 0, 0}, {30, 20, 10}), make_box({0, 0, 10}, {8, 20, 10.5F})),
                         make_box({0, 0, 10.5F}, {30, 20, 16})));
  expect_refused({"--contact-gap", "0.2", "--clearance", "0.4"}, 4, "no support fits there");
}

}  // namespace
}  // namespace aerate::test
