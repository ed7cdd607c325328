#include <cmath>
#include <cstddef>
#include <cstring>
#include <filesystem>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "tests/cli/job.h"
#include "tests/support/caught.h"

// Voids that drain, as the program makes and reports them.
namespace aerate::test {
namespace {

using Json = nlohmann::json;

constexpr int kFailure = 1;
constexpr int kUsage = 2;
constexpr int kNothingToRemove = 5;

Mesh block_of_50() {
  return make_box({0, 0, 0}, {50, 40, 40});
}

Json json_of(std::vector<std::string> command) {
  command.insert(command.end(), {"--json", "-"});
  const ProcessResult result = run(command);
  EXPECT_EQ(result.exit_code, 0) << result.err;
  return result.exit_code == 0 ? Json::parse(result.out) : Json();
}

Json origin_of(const Json& report, const std::string& limit) {
  for (const Json& entry : report.at("process").at("limits"))
    if (entry.at("limit") == limit) return entry;
  return {};
}

void expect_refused(const Job& job, const std::vector<std::string>& arguments, int exit_code,
                    const std::vector<std::string>& said) {
  const ProcessResult result = run(job.hollow(job.input("block.stl", block_of_50()), arguments));
  EXPECT_EQ(result.exit_code, exit_code) << result.err;
  for (const std::string& part : said) EXPECT_TRUE(contains(result.err, part));
  EXPECT_EQ(entries_of(job.outputs()), std::vector<std::string>{});
}

// What holds for every drained result; then what another program run makes of the file.
void expect_drained(const Job& job, const Json& report, std::size_t shells_of_model) {
  const Json& drainage = report.at("drainage");
  EXPECT_EQ(drainage["sealed_cavities"], 0);
  EXPECT_GE(drainage["holes"].size(), 2U * drainage["networks"].get<std::size_t>());
  EXPECT_LE(drainage["pools"]["after_both_percent"].get<double>(), 1.0);
  EXPECT_GE(report["measured"]["wall_mm"].get<double>(), report["limits"]["wall_mm"].get<double>() - 1e-6);
  EXPECT_NEAR(report["volume"]["before_mm3"].get<double>() - report["volume"]["after_mm3"].get<double>(),
              report["volume"]["removed_mm3"].get<double>(), 1e-3);
  const ProcessResult result = run({AERATE_EXECUTABLE, "inspect", job.output(), "--json", "-"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const Json input = Json::parse(result.out).at("input");
  EXPECT_EQ(input["shells"], shells_of_model);
  EXPECT_TRUE(input["closed"].get<bool>());
  EXPECT_EQ(input["non_manifold_edges"], report["input"]["non_manifold_edges"]);
  EXPECT_NEAR(input["signed_volume_mm3"].get<double>(), report["volume"]["after_mm3"].get<double>(),
              1e-6 * report["volume"]["before_mm3"].get<double>());
}

// Fifty metres from the origin fp32 holds four thousandths of a millimetre: where that turns the small
// triangles of a hole's rim over, the hole is made elsewhere.
TEST(DrainageOptions, AModelFarFromTheOriginIsOpenedWhereRoundingAllowsIt) {
  const Job job;
  std::string bunny = read_bytes(sample("bunny.stl"));
  constexpr std::size_t kHeader = 84, kFacet = 50, kNormal = 12, kAttribute = 2;
  for (std::size_t facet = kHeader; facet < bunny.size(); facet += kFacet) {
    for (std::size_t i = facet + kNormal; i < facet + kFacet - kAttribute; i += sizeof(float)) {
      float coordinate = 0;
      std::memcpy(&coordinate, &bunny[i], sizeof coordinate);
      coordinate += 5e4F;
      std::memcpy(&bunny[i], &coordinate, sizeof coordinate);
    }
  }
  const Json report = json_of(job.hollow(job.input("far.stl", bunny), {"--process", "metal"}));
  ASSERT_FALSE(report.is_null());
  EXPECT_EQ(report.at("drainage")["sealed_cavities"], 0);
  EXPECT_GE(report.at("drainage")["holes"].size(), 2U);
  EXPECT_GE(report["voids"]["count"].get<int>(), 30);
}

TEST(DrainageOptions, ProcessesThatTrapMaterialDrainByThemselves) {
  for (const char* process : {"sla", "sls", "metal"}) {
    const Job job;
    const Json report = json_of(job.hollow(sample("bunny.stl"), {"--process", process}));
    expect_drained(job, report, 1);
    EXPECT_EQ(origin_of(report, "channel")["origin"], std::string("default of ") + process);
    EXPECT_EQ(origin_of(report, "escape-hole")["value"], report["drainage"]["hole_diameter_mm"]);
    EXPECT_GE(report["voids"]["count"].get<int>(), std::string(process) == "metal" ? 30 : 2);
    // Metal prints no wide ceilings: voids have roofs, and wide holes have to be steep.
    const bool limits_ceilings = std::string(process) == "metal";
    EXPECT_EQ(contains(report["notices"].dump(), "escape holes of 5 mm lean"), limits_ceilings);
    EXPECT_EQ(!report["ceilings"].is_null(), limits_ceilings);
    if (limits_ceilings) {
      EXPECT_LE(report["ceilings"]["widest_mm"].get<double>(), 2 + 0.05);
    }
  }
}

TEST(DrainageOptions, FdmDrainsWhenAskedTo) {
  const Job job;
  const Json sealed = json_of(job.hollow(job.input("block.stl", block_of_50())));
  EXPECT_TRUE(sealed["drainage"].is_null());
  const Json report =
      json_of(job.hollow(job.folder() / "block.stl", {"--drain", "--channel-diameter", "2", "--hole-diameter",
                                                      "2.5", "--min-radius", "1.5", "--max-radius", "6"}));
  expect_drained(job, report, 1);
  EXPECT_EQ(origin_of(report, "channel")["origin"], "command line");
  expect_refused(Job(), {"--drain"}, kUsage, {"fdm", "--channel-diameter"});
}

TEST(DrainageOptions, VoidsStaySealedWhenAskedTo) {
  const Job job;
  const Json report =
      json_of(job.hollow(job.input("block.stl", block_of_50()), {"--process", "sla", "--no-drain"}));
  EXPECT_TRUE(report["drainage"].is_null());
  EXPECT_TRUE(contains(report["notices"].dump(), "sealed"));
  EXPECT_TRUE(origin_of(report, "channel").is_null());
}

// Modifiers leave the model solid: nothing is trapped, and nothing is opened.
TEST(DrainageOptions, ModifiersHaveNothingToDrain) {
  const Job job;
  const auto command = [&](const std::vector<std::string>& more) {
    std::vector<std::string> all{AERATE_EXECUTABLE,
                                 "hollow",
                                 job.input("block.stl", block_of_50()),
                                 "-o",
                                 job.outputs() / "out.3mf",
                                 "--as",
                                 "modifiers",
                                 "--process",
                                 "sla"};
    all.insert(all.end(), more.begin(), more.end());
    return all;
  };
  const ProcessResult refused = run(command({"--drain"}));
  EXPECT_EQ(refused.exit_code, kUsage);
  EXPECT_TRUE(contains(refused.err, "--as modifiers leaves no voids that --drain could open"));
  EXPECT_EQ(entries_of(job.outputs()), std::vector<std::string>{});
  const Json report = json_of(command({}));
  EXPECT_TRUE(report["drainage"].is_null());
  EXPECT_FALSE(contains(report["notices"].dump(), "sealed"));
}

TEST(DrainageOptions, HolesOpenWhereAskedAndInPrintOrientation) {
  const Job job;
  const Json asked = json_of(job.hollow(
      job.input("block.stl", block_of_50()),
      {"--process", "sla", "--shape", "spheres", "--escape-hole", "12,20,0", "--escape-hole", "38,20,40"}));
  // No others are made, whatever stays; the notice says how much.
  EXPECT_EQ(asked["drainage"]["sealed_cavities"], 0);
  EXPECT_GT(asked["drainage"]["pools"]["after_both_percent"].get<double>(), 1);
  EXPECT_TRUE(contains(asked["notices"].dump(), "cannot run out"));
  ASSERT_EQ(asked["drainage"]["holes"].size(), 2U);
  EXPECT_NEAR(asked["drainage"]["holes"][0]["place_mm"][2].get<double>(), 0, 1e-3);
  EXPECT_NEAR(asked["drainage"]["holes"][1]["place_mm"][2].get<double>(), 40, 1e-3);

  const Json turned = json_of(job.hollow(job.folder() / "block.stl", {"--process", "sla", "--up", "-x"}));
  expect_drained(job, turned, 1);
  EXPECT_EQ(turned["process"]["up"]["direction"], "-x");
  double lowest = 0;
  for (const Json& hole : turned["drainage"]["holes"])
    lowest = std::max(lowest, hole["place_mm"][0].get<double>());
  EXPECT_GT(lowest, 40);
}

TEST(DrainageOptions, ARemeshedSurfaceIsCutAsWell) {
  const Job job;
  const Json report = json_of(job.hollow(job.input("block.stl", make_box({0, 0, 0}, {24, 22, 20})),
                                         {"--process", "sla", "--surface", "remesh"}));
  expect_drained(job, report, 1);
  EXPECT_EQ(report["surface"]["mode"], "remeshed");
}

TEST(DrainageOptions, StaysWithinTheTrianglesAskedFor) {
  const Job job;
  const Json report = json_of(
      job.hollow(job.input("block.stl", block_of_50()), {"--process", "sla", "--max-triangles", "9000"}));
  expect_drained(job, report, 1);
  EXPECT_LE(report["output"]["triangles"].get<int>(), 9000);
  EXPECT_GT(report["voids"]["tolerance_used_mm"].get<double>(), 0.05);
}

TEST(DrainageOptions, TheSameBytesForAnyNumberOfThreads) {
  std::string reference;
  for (const char* threads : {"1", "2", "8"}) {
    const Job job;
    ASSERT_EQ(run(job.hollow(job.input("block.stl", block_of_50()),
                             {"--process", "metal", "--hole-diameter", "2.8", "--threads", threads}))
                  .exit_code,
              0);
    const std::string bytes = read_bytes(job.output());
    if (reference.empty()) reference = bytes;
    EXPECT_TRUE(bytes == reference) << threads << " threads";
  }
}

TEST(DrainageOptions, TheReportInWords) {
  const Job job;
  const ProcessResult result = run(job.hollow(job.input("block.stl", block_of_50()), {"--process", "sla"}));
  for (const char* part : {"channels of 3.5 mm", "escape holes of 3.5 mm", "0 cavities sealed", "holes at (",
                           "after both", "channel 3.5 mm, escape-hole 3.5 mm (default of sla)"})
    EXPECT_TRUE(contains(result.out, part));
}

// Where the escape holes of a result come out, mm.
std::vector<Vec3d> places_of(const Json& report) {
  std::vector<Vec3d> places;
  for (const Json& hole : report.at("drainage").at("holes")) {
    const Json& at = hole.at("place_mm");
    places.push_back({at[0].get<double>(), at[1].get<double>(), at[2].get<double>()});
  }
  return places;
}

class HolesOn : public ::testing::TestWithParam<const char*> {
 protected:
  std::vector<Vec3d> holes_with(std::vector<std::string> options) const {
    options.insert(options.end(), {"--process", "sla", "--shape", GetParam()});
    const Json report = json_of(job_.hollow(job_.input("block.stl", block_of_50()), options));
    const std::vector<Vec3d> places = report.is_null() ? std::vector<Vec3d>{} : places_of(report);
    EXPECT_GE(places.size(), 2U);
    return places;
  }

 private:
  Job job_;
};

INSTANTIATE_TEST_SUITE_P(BothShapes, HolesOn, ::testing::Values("spheres", "cells"));

constexpr double kOnFace = 1e-3;  // mm

TEST_P(HolesOn, TheSidesAskedFor) {
  for (const Vec3d p : holes_with({"--holes-on", "left"})) EXPECT_NEAR(p.x, 0, kOnFace);
  for (const Vec3d p : holes_with({"--holes-on", "0,1,0"})) EXPECT_NEAR(p.y, 40, kOnFace);
  for (const Vec3d p : holes_with({"--holes-on", "right", "--holes-on", "front"}))
    EXPECT_TRUE(std::abs(p.x - 50) < kOnFace || std::abs(p.y) < kOnFace) << p.x << " " << p.y;
}

TEST_P(HolesOn, NotWhereTheyMayNot) {
  for (const Vec3d p :
       holes_with({"--holes-not-on", "left", "--holes-not-on", "right", "--holes-not-on", "top"}))
    EXPECT_TRUE(std::abs(p.y) < kOnFace || std::abs(p.y - 40) < kOnFace || std::abs(p.z) < kOnFace);
  // All of the block's back half.
  for (const Vec3d p : holes_with({"--holes-not-on", "box:-1,20,-1,51,41,41"})) EXPECT_LT(p.y, 20);
}

TEST_P(HolesOn, TopAndBottomAreThoseOfThePrint) {
  for (const Vec3d p : holes_with({"--up", "+x", "--holes-not-on", "above:20"})) EXPECT_LE(p.x, 20);
}

// Channels of spheres do not let out there what windows of cells do.
class HolesOfCellsOn : public HolesOn {};
INSTANTIATE_TEST_SUITE_P(Cells, HolesOfCellsOn, ::testing::Values("cells"));

TEST_P(HolesOfCellsOn, AreAllOnTopOrAllHalfWayUp) {
  for (const Vec3d p : holes_with({"--up", "+x", "--holes-on", "top"})) EXPECT_NEAR(p.x, 50, kOnFace);
  for (const Vec3d p : holes_with({"--holes-not-on", "above:22", "--holes-not-on", "below:8"})) {
    EXPECT_LE(p.z, 22);
    EXPECT_GE(p.z, 8);
  }
}

// They do not come out onto the plate of their own accord.
TEST_P(HolesOn, ThePlateOnlyWhereAsked) {
  for (const Vec3d p : holes_with({})) EXPECT_GT(p.z, 0.3);
  const Job job;
  const ProcessResult result =
      run(job.hollow(job.input("block.stl", block_of_50()),
                     {"--process", "sla", "--shape", GetParam(), "--holes-on", "bottom"}));
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_TRUE(contains(result.err, "onto the build plate")) << result.err;
}

TEST_P(HolesOn, ASideThatTheModelLacks) {
  expect_refused(Job(), {"--process", "sla", "--shape", GetParam(), "--holes-on", "1,1,1"}, kNothingToRemove,
                 {"--holes-on"});
}

TEST(DrainageOptions, PlacesAndSidesThatContradictEachOther) {
  const auto refused = [](std::vector<std::string> options, std::string_view why) {
    options.insert(options.end(), {"--process", "sla"});
    expect_refused(Job(), options, kUsage, {std::string(why)});
  };
  refused({"--escape-hole", "25,20,40", "--escape-hole", "25,20,0", "--escape-hole", "25,21,40"},
          "places 1 and 3 are 1 mm apart");
  refused({"--holes-on", "left", "--holes-not-on", "-1,0,0"}, "the same side");
  refused({"--holes-not-on", "above:5", "--holes-not-on", "below:8"}, "no height is left");
}

TEST(DrainageOptions, HolesSayWhatTheyAreForAndHowMuchTheyShow) {
  const Job job;
  const auto model = job.input("block.stl", block_of_50());
  const Json report =
      json_of(job.hollow(model, {"--process", "sla", "--escape-hole", "25,20,40", "--holes-on", "bottom"}));
  const Json& holes = report["drainage"]["holes"];
  ASSERT_GE(holes.size(), 2U);
  EXPECT_EQ(holes[0]["purpose"], "asked");
  EXPECT_EQ(holes[1]["purpose"], "drain");
  // The sky lights a flat top whole (views from the back count less), a bottom counts a third.
  EXPECT_NEAR(holes[0]["shows_percent"].get<double>(), 98, 3);
  EXPECT_NEAR(holes[1]["shows_percent"].get<double>(), 33, 2);
}

TEST(DrainageOptions, WrongInput) {
  const Job job;
  const std::vector<std::string> sla{"--process", "sla"};
  const auto refused = [&](std::vector<std::string> arguments, int code,
                           const std::vector<std::string>& said) {
    arguments.insert(arguments.begin(), sla.begin(), sla.end());
    expect_refused(job, arguments, code, said);
  };
  refused({"--escape-hole", "12,20,-30"}, kUsage, {"outside the model", "(12.00, 20.00, 0.00) mm"});
  refused({"--escape-hole", "25,20,20"}, kUsage, {"inside the model, away from its surface"});
  refused({"--max-radius", "2", "--min-radius", "1.9", "--channel-diameter", "3.8", "--hole-diameter", "4"},
          kUsage, {"a channel of 3.8 mm is too wide for every void", "--max-radius 2"});
  refused({"--channel-diameter", "1e-6"}, kUsage, {"single precision"});
  refused({"--escape-hole", "12,20"}, kUsage, {"--escape-hole", "x,y,z"});
  refused({"--hole-diameter", "3"}, kUsage, {"narrower than channels of 3.5 mm", "--hole-diameter"});
  refused({"--channel-diameter", "40", "--hole-diameter", "40"}, kUsage,
          {"too wide for every void", "a smaller --channel-diameter and --hole-diameter"});
  refused(
      {"--hole-diameter", "40"}, kUsage,
      {"an escape hole of 40 mm is too wide for every void", "a smaller --hole-diameter (3.5 mm or more"});
  refused({"--channel-diameter", "0"}, kUsage, {"--channel-diameter"});
  refused({"--up", "0,0,0"}, kUsage, {"--up", "no direction"});
  refused({"--no-drain", "--escape-hole", "12,20,0"}, kUsage,
          {"--escape-hole is for voids that drain", "--drain"});
  refused({"--shape", "spheres", "--hole-diameter", "18"}, kNothingToRemove, {"18 mm", "--hole-diameter"});
}

TEST(DrainageOptions, AllBadPlacesAreTold) {
  const std::vector<std::string> places{"--escape-hole", "12,20,-30",     "--escape-hole",
                                        "12,20,0",       "--escape-hole", "25,20,20"};
  for (const char* shape : {"spheres", "cells"}) {
    std::vector<std::string> arguments{"--process", "sla", "--shape", shape};
    arguments.insert(arguments.end(), places.begin(), places.end());
    expect_refused(Job(), arguments, kUsage,
                   {"2 of 3 escape holes cannot be made", "outside the model", "(12.00, 20.00, 0.00) mm",
                    "(25.00, 20.00, 20.00) mm", "inside the model, away from its surface", "--escape-hole"});
  }
  expect_refused(
      Job(), {"--process", "sla", "--escape-hole", "12,20", "--escape-hole", "1,2,3", "--escape-hole", "x"},
      kUsage, {"--escape-hole: '12,20' and 'x' are no places", "x,y,z"});
}

// A place on the surface from which no tube reaches a void; and one across an edge, which is cut like any
// other.
TEST(DrainageOptions, AnEscapeHoleIntoNothing) {
  const Job job;
  const auto model = job.input("bar.stl", make_box({0, 0, 0}, {90, 30, 30}));
  const auto spheres = job.input(
      "spheres.csv", std::string_view("x,y,z,radius,kind\n15,15,15,8,adaptive\n36,15,15,9,adaptive\n"));
  const auto command = [&](const std::string& place) {
    return job.hollow(model, {"--process", "sla", "--spheres", spheres, "--escape-hole", place});
  };
  const ProcessResult refused = run(command("80,15,0"));
  EXPECT_EQ(refused.exit_code, kUsage) << refused.err;
  EXPECT_TRUE(contains(refused.err, "no straight hole leads from (80.0"));
  EXPECT_TRUE(contains(refused.err, "--escape-hole"));
  EXPECT_EQ(entries_of(job.outputs()), std::vector<std::string>{});
  expect_drained(job, json_of(command("15,0.3,0")), 1);
}

// Real scans: one with a flat base, one with doubled edges and a crack.
struct Scan {
  const char *model, *process;
};
class DrainedScan : public testing::TestWithParam<Scan> {};

TEST_P(DrainedScan, DrainsWithoutANewFlaw) {
  const std::filesystem::path model = std::filesystem::path(AERATE_SHARED) / "models" / GetParam().model;
  if (!std::filesystem::exists(model)) GTEST_SKIP() << model << " is not there";
  const Job job;
  const Json report = json_of(job.hollow(model, {"--process", GetParam().process}));
  expect_drained(job, report, report["input"]["shells"].get<std::size_t>());
}

INSTANTIATE_TEST_SUITE_P(Shared, DrainedScan,
                         testing::Values(Scan{"bunny-100mm.stl", "metal"},
                                         Scan{"dragon-47k-100mm.stl", "sls"}));

}  // namespace
}  // namespace aerate::test
