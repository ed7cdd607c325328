#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstddef>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <string>
#include <thread>
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

TEST(InspectOverhangs, FollowsTheLimitsThatAreGiven) {
  const Job job;
  const auto model = job.input("arm.stl", with_arm());
  EXPECT_TRUE(contains(inspect(model, {"--overhangs", "--bridge", "41"}).out, "prints without supports"));
  const ProcessResult result =
      inspect(model, {"--overhangs", "--overhang", "30", "--bridge", "20", "--json", "-"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const Json overhangs = Json::parse(result.out)["overhangs"];
  EXPECT_EQ(overhangs["overhang_degrees"], 30);
  EXPECT_EQ(overhangs["reach_mm"], 10);
  EXPECT_EQ(inspect(model, {"--overhangs", "--overhang", "3"}).exit_code, 2);
}

TEST(InspectOverhangs, OptionsThatAskNothingAreRefused) {
  const Job job;
  const auto model = job.input("arm.stl", with_arm());
  EXPECT_EQ(inspect(model, {"--process", "fdm"}).exit_code, 2);
  EXPECT_EQ(inspect(model, {"--up=-z"}).exit_code, 2);
  EXPECT_EQ(inspect(model, {"--overhang", "30"}).exit_code, 2);
  EXPECT_EQ(inspect(model, {"--drainage", "--bridge", "3"}).exit_code, 2);
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

  // Along y, of what was written at about this height.
  double width_at(double height) const {
    double least = 1e9, most = -1e9;
    const std::string bytes = read_bytes(job.output());
    for (std::size_t triangle = 84; triangle + 50 <= bytes.size(); triangle += 50) {
      std::array<float, 12> numbers;  // a normal and three corners
      std::memcpy(numbers.data(), bytes.data() + triangle, sizeof numbers);
      for (std::size_t corner = 3; corner < 12; corner += 3) {
        if (std::abs(static_cast<double>(numbers[corner + 2]) - height) > 0.5) continue;
        least = std::min(least, static_cast<double>(numbers[corner + 1]));
        most = std::max(most, static_cast<double>(numbers[corner + 1]));
      }
    }
    return most - least;
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
  EXPECT_EQ(plain["limits"]["stem_mm"], 4);
  const Json cells = report({"--process", "sla"});
  EXPECT_EQ(cells["body"]["fill"], "cells");
  // Most of a body that is drawn in as far as a hole and a wall allow.
  EXPECT_EQ(cells["limits"]["stem_mm"], 3.5 + 0.5);
  EXPECT_LT(cells["body"]["volume_after_mm3"].get<double>(),
            0.33 * cells["body"]["volume_mm3"].get<double>());
  EXPECT_EQ(cells["contact"]["unsupported_mm2"], 0);
  // It drains, by holes neither onto the plate nor under the model, where its teeth stand.
  const ProcessResult read = inspect(job.output(), {"--drainage", "--process", "sla", "--json", "-"});
  ASSERT_EQ(read.exit_code, 0) << read.err;
  const Json drainage = Json::parse(read.out)["drainage"];
  EXPECT_EQ(drainage["drains"], true) << drainage["verdict"];
  EXPECT_EQ(drainage["hollows"].size(), 2U);
  EXPECT_GE(drainage["holes"].size(), 4U);
  for (const Json& hole : drainage["holes"]) {
    EXPECT_GT(hole["place_mm"][2].get<double>(), 1.5) << hole;
    EXPECT_LT(hole["place_mm"][2].get<double>(), 27) << hole;
  }
}

// Voids have no feet.
TEST_F(SupportCommand, SaysHowABodyWithSealedVoidsStands) {
  model = job.input("tee.stl", join(make_box({25, 0, 0}, {35, 20, 30}), make_box({0, 0, 30}, {60, 20, 36})));
  const Json json = report({"--fill", "spheres", "--stem", "200"});
  EXPECT_LT(json["body"]["volume_after_mm3"].get<double>(), 0.9 * json["body"]["volume_mm3"].get<double>());
  ASSERT_TRUE(json["body"]["footing_margin_mm"].is_number()) << json["body"];
  EXPECT_GT(json["body"]["footing_margin_mm"].get<double>(), 1);
}

TEST_F(SupportCommand, TellsWhatTheVoidsOfItsBodyLack) {
  // Into narrow bodies no holes can be cut that are as wide as those of metal should be.
  model = job.input("tee.stl", join(make_box({9, 0, 0}, {14, 14, 20}), make_box({0, 0, 20}, {17, 14, 23})));
  const Json json = report({"--process", "metal"});
  EXPECT_EQ(json["body"]["fill"], "cells");
  const auto is_of_voids = [](const Json& notice) {
    return contains(notice.get<std::string>(), "voids in supports: ");
  };
  const auto notice = std::ranges::find_if(json["notices"], is_of_voids);
  ASSERT_NE(notice, json["notices"].end()) << json["notices"];
  // Options of another command are not proposed.
  EXPECT_FALSE(contains(notice->get<std::string>(), "--")) << *notice;
}

TEST_F(SupportCommand, PutsVoidsIntoTheBodyForFilament) {
  const Json json = report({"--fill", "spheres"});
  EXPECT_EQ(json["body"]["fill"], "spheres");
  EXPECT_LT(json["body"]["volume_after_mm3"].get<double>(), 0.9 * json["body"]["volume_mm3"].get<double>());
}

TEST_F(SupportCommand, DrawsBodiesInNoFurtherThanTheirStem) {
  const double drawn_in = report({})["body"]["volume_mm3"].get<double>();
  const Json straight = report({"--stem", "200"});
  EXPECT_EQ(straight["limits"]["stem_mm"], 200);
  EXPECT_GT(straight["body"]["volume_mm3"].get<double>(), 2 * drawn_in);
  EXPECT_NEAR(straight["body"]["volume_mm3"].get<double>(), 21 * 12 * 13.8, 200);
}

TEST_F(SupportCommand, FollowsTheOverhangAndTheBridgeThatAreGiven) {
  expect_refused({"--process", "sls", "--overhang", "45"}, 2, "carries what hangs over");
  // Held on one side, the arm reaches 20 mm out.
  expect_refused({"--bridge", "41"}, 5, "more than 20.5 mm from what holds it");
  const Json json = report({"--bridge", "20", "--overhang", "30"});
  EXPECT_EQ(json["limits"]["overhang_degrees"], 30);
  EXPECT_EQ(json["limits"]["reach_mm"], 10);
  EXPECT_EQ(json["limits"]["reach_source"], "half the bridge (command line)");
  EXPECT_GT(json["contact"]["farthest_mm"].get<double>(), 4);
}

TEST_F(SupportCommand, DrawsThem) {
  const Json json = report({"--picture", job.output("out.png"), "--view", job.output("out.html")});
  const std::string picture = read_bytes(job.output("out.png"));
  EXPECT_TRUE(picture.starts_with("\x89PNG"));
  EXPECT_GT(picture.size(), 5000U);
  EXPECT_GT(std::filesystem::file_size(job.output("out.html")), 10000U);
  std::filesystem::remove_all(job.outputs());
  std::filesystem::create_directory(job.outputs());
  expect_refused({"--picture", job.output("out.jpg")}, 2, ".png");
  expect_refused({"--picture", job.output("out.stl")}, 2, "");
  expect_refused({"--picture-cut", "x"}, 2, "--picture");
}

TEST_F(SupportCommand, AreLeftOutOfTheModelWhenTheirFileIsRead) {
  for (const char* flavor : {"prusa", "orca"}) {
    report({"--parts", flavor}, "out.3mf");
    const ProcessResult read = inspect(job.output("out.3mf"), {"--json", "-"});
    ASSERT_EQ(read.exit_code, 0) << read.err;
    EXPECT_TRUE(contains(read.err, "'supports' is no part of the model, and left out")) << read.err;
    EXPECT_NEAR(Json::parse(read.out)["input"]["filled_volume_mm3"].get<double>(), 3000, 1e-3);
  }
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
  expect_refused({"--plate", "-5000"}, 2, "begins 5000 mm above that");
  expect_refused({"--contact-gap", "1"}, 2, "teeth would not reach");
  expect_refused({"--parts", "prusa"}, 2, "need a 3MF");
  expect_refused({"--extruder", "2"}, 2, "--extruder is for supports");
  expect_refused({"--process", "sla", "--tooth", "0"}, 2, "--tooth");
}

TEST_F(SupportCommand, RefusesVoidsInAPart) {
  for (const char* fill : {"spheres", "cells"}) {
    const ProcessResult result = support({"--fill", fill, "--parts", "prusa"}, "out.3mf");
    EXPECT_EQ(result.exit_code, 2);
    EXPECT_TRUE(contains(result.err, "nothing for voids to take"));
  }
  const ProcessResult result = support({"--process", "sla", "--parts", "prusa"}, "out.3mf");
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_TRUE(contains(result.err, "--parts is for filament"));
  EXPECT_TRUE(std::filesystem::is_empty(job.outputs()));
}

TEST_F(SupportCommand, RefusesValuesThatCannotBe) {
  for (const char* option : {"--clearance", "--contact-gap", "--tooth", "--stem", "--layer-height",
                             "--overhang", "--bridge", "--plate", "--extruder"}) {
    for (const char* value : {"nan", "inf", "-1e9", "1e9", "x", ""})
      expect_refused({std::string(option) + "=" + value}, 2, option);
  }
  for (const char* option : {"--clearance", "--tooth", "--stem", "--layer-height", "--overhang", "--bridge"})
    expect_refused({std::string(option) + "=0"}, 2, option);
}

TEST_F(SupportCommand, RefusesModelsThatBoundNoSolid) {
  Mesh open = with_arm();
  open.triangles.pop_back();
  Mesh flat = with_arm();
  for (Vec3f& p : flat.positions) p.z = 0;
  const auto refuse = [&](const std::filesystem::path& other, int exit_code, const std::string& why) {
    model = other;
    expect_refused({}, exit_code, why);
  };
  refuse(job.input("open.stl", open), 4, "boundary edges");
  refuse(job.input("flat.stl", flat), 4, "flat");
  refuse(job.input("empty.stl", ""), 3, "empty.stl");
  refuse(job.folder() / "missing.stl", 3, "missing.stl");
}

TEST_F(SupportCommand, TellsOfModelsInAnotherUnit) {
  Mesh metres = with_arm(), kilometres = with_arm();
  for (Vec3f& p : metres.positions) p = {p.x * 1e-3F, p.y * 1e-3F, p.z * 1e-3F};
  for (Vec3f& p : kilometres.positions) p = {p.x * 1e3F, p.y * 1e3F, p.z * 1e3F};
  model = job.input("metres.stl", metres);
  expect_refused({}, 5, "--unit");
  EXPECT_EQ(report({"--unit", "m"})["contact"]["unsupported_mm2"], 0);
  std::filesystem::remove(job.output());
  model = job.input("kilometres.stl", kilometres);
  expect_refused({}, 4, "--unit");
  // Columns are narrow enough, but many and long.
  expect_refused({"--scale", "0.05"}, 4, "times as large");
}

// Bodies that touch or run into each other are one solid; one that floats is held.
TEST_F(SupportCommand, TakesSeveralBodies) {
  model = job.input("crossing.stl",
                    join(make_box({0, 0, 0}, {10, 10, 20}), make_box({5, 0, 15}, {30, 10, 20.5F})));
  EXPECT_EQ(report({})["contact"]["unsupported_mm2"], 0);
  model = job.input("floating.stl", join(with_arm(), make_box({50, 0, 10}, {60, 10, 20})));
  const Json json = report({});
  EXPECT_EQ(json["overhangs"]["count"], 2);
  EXPECT_EQ(json["contact"]["unsupported_mm2"], 0);
}

TEST_F(SupportCommand, StandsUpInAllDirections) {
  // A block with an arm to each side.
  model = job.input("cross.stl",
                    join(join(make_box({-4, -4, -4}, {4, 4, 4}), make_box({-16, -2, -2}, {16, 2, 2})),
                         join(make_box({-2, -16, -2}, {2, 16, 2}), make_box({-2, -2, -16}, {2, 2, 16}))));
  for (const char* up : {"+x", "-x", "+y", "-y", "+z", "-z"}) {
    SCOPED_TRACE(up);
    const Json json = report({std::string("--up=") + up});
    EXPECT_EQ(json["contact"]["unsupported_mm2"], 0);
    EXPECT_EQ(json["up"], up);
  }
}

TEST_F(SupportCommand, WritesOverNoFileThatItReads) {
  const std::string before = read_bytes(model);
  const auto onto = [&](const std::filesystem::path& output) {
    return run({AERATE_EXECUTABLE, "support", model, "-o", output});
  };
  EXPECT_EQ(onto(model).exit_code, 2);
  std::filesystem::create_symlink(model, job.outputs() / "link.stl");
  EXPECT_EQ(onto(job.outputs() / "link.stl").exit_code, 2);
  EXPECT_EQ(read_bytes(model), before);
  for (const std::filesystem::path& place :
       {job.outputs() / "missing" / "out.stl", std::filesystem::path("/proc/out.stl")}) {
    const ProcessResult result = onto(place);
    EXPECT_EQ(result.exit_code, 1) << result.err;
    EXPECT_TRUE(contains(result.err, place.string()));
  }
  EXPECT_EQ(support({}, "out.xyz").exit_code, 2);
}

TEST_F(SupportCommand, AFullDiskKeepsWhatWasThere) {
  std::ofstream(job.output()) << "an earlier result";
  const std::string command = "ulimit -f 8; \"" AERATE_EXECUTABLE "\" support \"" + model.string() +
                              "\" -o \"" + job.output().string() + "\"";
  const ProcessResult result = run({"/bin/sh", "-c", command});
  EXPECT_EQ(result.exit_code, 1) << result.err;
  EXPECT_TRUE(contains(result.err, "out.stl"));
  EXPECT_EQ(entries_of(job.outputs()), std::vector<std::string>{"out.stl"});
  EXPECT_EQ(read_bytes(job.output()), "an earlier result");
}

TEST_F(SupportCommand, AnInterruptLeavesNothingBehind) {
  model = sample("bunny.stl");
  Process process({AERATE_EXECUTABLE, "support", model, "-o", job.output(), "--process", "sla", "--picture",
                   job.output("out.png")});
  while (process.running() && entries_of(job.outputs()).empty())
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  process.send(SIGINT);
  const ProcessResult result = process.wait();
  EXPECT_EQ(result.exit_code, 130) << result.err;
  EXPECT_EQ(entries_of(job.outputs()), std::vector<std::string>{});
}

// A brim of their own: what is slender has a foot wider than its stem.
TEST_F(SupportCommand, SlenderBodiesStandOnWiderFeet) {
  model = job.input("tall.stl", join(make_box({0, 0, 0}, {10, 10, 80}), make_box({10, 3, 74}, {19, 7, 80})));
  const Json json = report({});
  EXPECT_GT(json["body"]["footing_margin_mm"].get<double>(), 2);
  EXPECT_NEAR(width_at(40), 4, 1.5);
  EXPECT_GT(width_at(0.2), width_at(40) + 4);
}

TEST_F(SupportCommand, RefusesVoidsThatFindNoPlace) {
  model = job.input("low.stl", join(make_box({0, 0, 0}, {10, 10, 8}), make_box({10, 0, 3}, {16, 10, 8})));
  expect_refused({"--process", "sla", "--fill", "spheres"}, 5, "leave out --fill");
}

TEST_F(SupportCommand, RefusesAPlaceWithoutRoom) {
  // A slot of 0.5 mm: a gap on each side leaves half a layer.
  model = job.input("slot.stl",
                    join(join(make_box({0, 0, 0}, {30, 20, 10}), make_box({0, 0, 10}, {8, 20, 10.5F})),
                         make_box({0, 0, 10.5F}, {30, 20, 16})));
  expect_refused({"--contact-gap", "0.2", "--clearance", "0.4"}, 4, "no support fits there");
}

TEST_F(SupportCommand, LeavesWhatItIsToldToLeave) {
  // The slot of before, of 22 x 20 mm, and an arm above.
  Mesh mesh = join(make_box({0, 0, 0}, {30, 20, 10}), make_box({0, 0, 10}, {8, 20, 10.5F}));
  mesh = join(mesh, make_box({0, 0, 10.5F}, {30, 20, 40}));
  model = job.input("slot.stl", join(mesh, make_box({30, 0, 34}, {50, 20, 40})));
  expect_refused({"--leave", "300"}, 4, "aerate support --leave 366");
  const Json json = report({"--leave", "500"});
  EXPECT_NEAR(json["contact"]["unsupported_mm2"].get<double>(), 400, 60);
  EXPECT_TRUE(contains(json["notices"].dump(), "have no room for teeth"));
}

}  // namespace
}  // namespace aerate::test
