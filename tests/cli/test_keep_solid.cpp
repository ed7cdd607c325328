#include <algorithm>
#include <cmath>
#include <cstddef>
#include <functional>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "files/load.h"
#include "tests/cli/job.h"
#include "tests/support/caught.h"
#include "tests/support/three_mf_xml.h"
#include "tests/support/zip.h"

// Regions that stay solid, as the program keeps away from them: looked at on the written file.
namespace aerate::test {
namespace {

using Json = nlohmann::json;
using Distance = std::function<double(Vec3d)>;  // from a region, negative in it

constexpr int kUsage = 2, kUnreadable = 3, kUnusable = 4, kNothing = 5;

Mesh large_block() {
  return make_box({0, 0, 0}, {40, 40, 30});
}

Distance from_ball(Vec3d centre, double radius) {
  return [=](Vec3d p) { return length(p - centre) - radius; };
}

// Along z, longer than the model.
Distance from_pillar(double x, double y, double radius) {
  return [=](Vec3d p) { return std::hypot(p.x - x, p.y - y) - radius; };
}

Distance from_box(Vec3d lower, Vec3d upper) {
  return [=](Vec3d p) {
    const Vec3d out = max_of(max_of(lower - p, p - upper), {0, 0, 0});
    const Vec3d in = min_of(p - lower, upper - p);
    const double depth = std::min({in.x, in.y, in.z});
    return depth > 0 ? -depth : length(out);
  };
}

Json json_of(std::vector<std::string> command) {
  command.insert(command.end(), {"--json", "-"});
  const ProcessResult result = run(command);
  EXPECT_EQ(result.exit_code, 0) << result.err;
  return result.exit_code == 0 ? Json::parse(result.out) : Json();
}

std::vector<std::string> keeping(const std::vector<std::string>& regions,
                                 std::vector<std::string> options = {}) {
  for (const std::string& region : regions) options.insert(options.end(), {"--keep-solid", region});
  return options;
}

// Of all that was taken out of a model: vertices that are none of its own.
double least_distance(const std::filesystem::path& written, const Mesh& model, const Distance& distance) {
  double least = 1e9;
  for (const Vec3f p : load_model(written).mesh.positions) {
    if (std::ranges::find(model.positions, p) == model.positions.end())
      least = std::min(least, distance(to_double(p)));
  }
  return least;
}

void expect_kept(const Job& job, const Json& report, const Mesh& model, const Distance& distance) {
  const double wall = report["limits"]["wall_mm"].get<double>();
  const double measured = report["keep_solid"]["wall_mm"].get<double>();
  EXPECT_GE(measured, wall - 1e-4);
  const double found = least_distance(job.output(), model, distance);
  EXPECT_GE(found, wall - 1e-4);
  // Round regions are a little larger as meshes, and triangles are nearer than their corners.
  EXPECT_NEAR(measured, found, 0.2);
  EXPECT_GT(report["volume"]["removed_percent"].get<double>(), 1);
}

struct Kept {
  std::string region;
  Distance distance;
  std::vector<std::string> options;
};

TEST(KeepSolid, EveryProcessAndShapeKeepsTheWallFromEveryKindOfRegion) {
  const Mesh model = large_block();
  const std::string ball = "sphere:20,20,15,6", pillar = "cylinder:12,14,-9,12,14,60,3",
                    box = "box:-5,15,10,50,25,20";
  const Distance to_ball = from_ball({20, 20, 15}, 6), to_pillar = from_pillar(12, 14, 3),
                 to_box = from_box({-5, 15, 10}, {50, 25, 20});
  const std::vector<Kept> jobs{{ball, to_ball, {"--process", "fdm"}},
                               {box, to_box, {"--process", "fdm"}},
                               {pillar, to_pillar, {"--process", "fdm", "--packing", "hexagonal"}},
                               {box, to_box, {"--process", "fdm", "--shape", "cells"}},
                               {pillar, to_pillar, {"--process", "sla"}},
                               {ball, to_ball, {"--process", "sls"}},
                               {ball, to_ball, {"--process", "sla", "--no-drain"}},
                               {pillar, to_pillar, {"--process", "sls", "--shape", "spheres"}},
                               {ball, to_ball, {"--process", "metal"}},
                               {box, to_box, {"--process", "sla", "--surface", "remesh", "--voxel", "0.5"}}};
  for (const auto& [region, distance, options] : jobs) {
    SCOPED_TRACE(region + " " + options.back() + " " + options[1]);
    const Job job;
    const Json report = json_of(job.hollow(job.input("block.stl", model), keeping({region}, options)));
    if (report.is_null()) continue;
    EXPECT_EQ(report["keep_solid"]["regions"], 1);
    // Where the surface is made anew, all of its vertices are new.
    if (options.back() != "0.5") expect_kept(job, report, model, distance);
  }
}

TEST(KeepSolid, AsModifiersVoidsKeepAwayToo) {
  const Job job;
  const Json report =
      json_of({AERATE_EXECUTABLE, "hollow", job.input("block.stl", large_block()), "-o",
               job.output("out.3mf"), "--as", "modifiers", "--keep-solid", "sphere:20,20,15,6"});
  EXPECT_GE(report["keep_solid"]["wall_mm"].get<double>(), 0.9 - 1e-4);
  EXPECT_GE(least_distance(job.output("out.3mf"), large_block(), from_ball({20, 20, 15}, 6)), 0.9 - 1e-4);
}

TEST(KeepSolid, WithoutRegionsTheReportHasNone) {
  const Job job;
  EXPECT_TRUE(json_of(job.hollow(job.input("block.stl", block())))["keep_solid"].is_null());
}

TEST(KeepSolid, RegionsMayOverlapAndTouchTheModel) {
  const Job job;
  const Mesh model = large_block();
  const Json report = json_of(job.hollow(
      job.input("block.stl", model),
      keeping({"box:0,0,0,40,40,8", "box:10,10,0,30,30,16", "sphere:20,20,16,5", "box:12,12,2,20,20,7"})));
  const Distance low = from_box({0, 0, 0}, {40, 40, 8}), tower = from_box({10, 10, 0}, {30, 30, 16}),
                 ball = from_ball({20, 20, 16}, 5);
  expect_kept(job, report, model, [&](Vec3d p) { return std::min({low(p), tower(p), ball(p)}); });
  EXPECT_EQ(report["keep_solid"]["regions"], 4);
  // The union: two boxes and half of a ball.
  EXPECT_NEAR(report["keep_solid"]["volume_mm3"].get<double>(), 40 * 40 * 8 + 20 * 20 * 8 + 262, 60);
}

// There the winding number in the region is 1, as in a plain part of the model.
TEST(KeepSolid, PartsOfAModelMayOverlapInARegion) {
  const Mesh model = join(make_box({0, 0, 0}, {30, 30, 30}), make_box({20, 0, 0}, {60, 30, 30}));
  for (const std::string shape : {"spheres", "cells"}) {
    const Job job;
    const Json report = json_of(job.hollow(
        job.input("two.stl", model), keeping({"box:-5,-5,18,65,35,40"}, {"--shape", shape, "--wall", "1"})));
    expect_kept(job, report, model, from_box({-5, -5, 18}, {65, 35, 40}));
  }
}

TEST(KeepSolid, AMeshFileIsARegionInTheModelsCoordinates) {
  const Job job;
  const Mesh model = large_block();
  const auto path = job.input("block.stl", model);
  // As other programs leave meshes: inside out.
  const auto region = job.input("region.stl", turned_inside_out(make_box({10, 10, 5}, {30, 30, 25})));
  const Json report = json_of(job.hollow(path, keeping({region})));
  expect_kept(job, report, model, from_box({10, 10, 5}, {30, 30, 25}));
  // It is scaled as the model is; numbers are millimetres.
  const Json scaled = json_of(job.hollow(path, keeping({region}, {"--scale", "2"})));
  EXPECT_NEAR(scaled["keep_solid"]["volume_mm3"].get<double>(), 8 * 8000, 8 * 40);
  const Json numbers = json_of(job.hollow(path, keeping({"box:20,20,10,60,60,50"}, {"--scale", "2"})));
  EXPECT_EQ(scaled["volume"]["removed_mm3"], numbers["volume"]["removed_mm3"]);
}

TEST(KeepSolid, WhatOfARegionIsOutsideOfTheModelKeepsNoHoleAway) {
  const Job job;
  const Mesh model = large_block();
  // It leaves the bottom at x = 10 and goes on below the hole.
  const std::vector<std::string> options{"--process", "sla",           "--shape",
                                         "spheres",   "--escape-hole", "18,20,0"};
  const Json report =
      json_of(job.hollow(job.input("block.stl", model), keeping({"cylinder:5,20,5,25,20,-15,2"}, options)));
  bool is_there = false;
  for (const Json& hole : report["drainage"]["holes"])
    is_there =
        is_there || std::hypot(hole["place_mm"][0].get<double>() - 18, hole["place_mm"][1].get<double>() - 20,
                               hole["place_mm"][2].get<double>()) < 2;
  EXPECT_TRUE(is_there);
  EXPECT_GE(report["keep_solid"]["wall_mm"].get<double>(), 2 - 1e-4);
}

TEST(KeepSolid, NoHoleOpensInARegionEvenIfItIsAskedFor) {
  const Job job;
  const ProcessResult result =
      run(job.hollow(job.input("block.stl", large_block()),
                     keeping({"box:10,10,-1,30,30,5"},
                             {"--process", "sla", "--shape", "spheres", "--escape-hole", "20,20,0"})));
  EXPECT_EQ(result.exit_code, kUsage) << result.err;
  EXPECT_EQ(entries_of(job.outputs()), std::vector<std::string>{});
}

TEST(KeepSolid, PackedSpheresAndPiecesKeepTheWall) {
  const Job job;
  const auto model = job.input("block.stl", large_block());
  const auto pack = [&](const std::string& name, const std::vector<std::string>& options) {
    std::vector<std::string> command{AERATE_EXECUTABLE, "pack", model, "-o", job.output(name)};
    command.insert(command.end(), options.begin(), options.end());
    return json_of(std::move(command));
  };
  const std::vector<std::string> region{"sphere:20,20,15,8"};
  const Json spheres = pack("spheres.csv", keeping(region));
  EXPECT_GE(spheres["keep_solid"]["wall_mm"].get<double>(), 1.2 - 1e-6);
  const Json pieces = pack("pieces.stl", keeping(region, {"--shape", "cells"}));
  EXPECT_GE(pieces["keep_solid"]["wall_mm"].get<double>(), 1.2 - 1e-4);
  EXPECT_GE(least_distance(job.output("pieces.stl"), {}, from_ball({20, 20, 15}, 8)), 1.2 - 1e-4);
  // Given spheres are held against regions as well.
  const Json given = json_of(job.hollow(model, keeping(region, {"--spheres", job.output("spheres.csv")})));
  EXPECT_EQ(given["voids"]["count"], spheres["packing"]["spheres"]);
  const ProcessResult refused =
      run(job.hollow(model, keeping({"sphere:8,8,8,7"}, {"--spheres", job.output("spheres.csv")})));
  EXPECT_EQ(refused.exit_code, kUnreadable);
  EXPECT_TRUE(contains(refused.err, "--keep-solid"));
}

// A project of PrusaSlicer with two modifiers.
std::string project() {
  const Mesh all =
      join(join(large_block(), make_box({10, 10, -2}, {16, 16, 40})), make_box({25, 25, 5}, {35, 35, 15}));
  const auto volume = [](int first, const std::string& name, const std::string& kind) {
    return R"(<volume firstid=")" + std::to_string(first) + R"(" lastid=")" + std::to_string(first + 11) +
           R"("><metadata key="name" value=")" + name + R"("/><metadata key="volume_type" value=")" + kind +
           R"("/></volume>)";
  };
  return make_zip({{"3D/3dmodel.model", model_xml(object_xml(1, mesh_xml(all)), R"(<item objectid="1"/>)")},
                   {"Metadata/Slic3r_PE_model.config",
                    R"(<config><object id="1">)" + volume(0, "block", "ModelPart") +
                        volume(12, "screw", "ParameterModifier") + volume(24, "magnet", "ParameterModifier") +
                        "</object></config>"}});
}

TEST(KeepSolid, ModifiersOfAProjectAreRegionsByTheirNames) {
  const Job job;
  const auto model = job.input("project.3mf", project());
  const Json report = json_of(job.hollow(model, keeping({"screw", "magnet"})));
  const Distance screw = from_box({10, 10, -2}, {16, 16, 40}), magnet = from_box({25, 25, 5}, {35, 35, 15});
  expect_kept(job, report, large_block(), [&](Vec3d p) { return std::min(screw(p), magnet(p)); });
  EXPECT_EQ(report["input"]["triangles"], 12);
  // Those that are not named are still not part of the model.
  const ProcessResult result = run(job.hollow(model, keeping({"screw"})));
  EXPECT_EQ(result.exit_code, kUnreadable);
  EXPECT_TRUE(contains(result.err, "'magnet'"));
  EXPECT_FALSE(contains(result.err, "'screw'"));
}

void expect_refused(const std::vector<std::string>& regions, int exit_code,
                    const std::vector<std::string>& said) {
  const Job job;
  job.input("open.stl",
            Mesh{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}}});
  job.input("text.stl", "nothing of a mesh");
  std::vector<std::string> places = regions;
  for (std::string& region : places)
    if (region.ends_with(".stl")) region = job.folder() / region;
  const ProcessResult result = run(job.hollow(job.input("block.stl", block()), keeping(places)));
  EXPECT_EQ(result.exit_code, exit_code) << result.err;
  for (const std::string& text : said) EXPECT_TRUE(contains(result.err, text));
  EXPECT_EQ(entries_of(job.outputs()), std::vector<std::string>{});
}

TEST(KeepSolid, BadRegionsAreRefusedAndNothingIsWritten) {
  for (const char* const text :
       {"box:1,2,3,4,5", "box:1,2,3,4,5,6,7", "box:1,2,3,1,5,6", "box:", "box:a,2,3,4,5,6",
        "box:1,2,3,4,5,nan", "sphere:1,2,3,0", "sphere:1,2,3,-1", "sphere:1,2,3", "sphere:1e9,2,3,4",
        "cylinder:1,2,3,1,2,3,4", "cylinder:1,2,3,4,5,6,0", "cylinder:1,2,3,4,5,6", ""})
    expect_refused({text}, kUsage, {"--keep-solid", "is no region"});
  expect_refused({"sphere:15,15,15,2", "box:40,0,0,50,10,10"}, kUnreadable,
                 {"box:40,0,0,50,10,10", "(40, 0, 0) to (50, 10, 10)", "(0, 0, 0) to (30, 30, 30)"});
  // It only touches the model.
  expect_refused({"box:0,0,30,10,10,40"}, kUnreadable, {"nothing of it is in the model"});
  expect_refused({"nowhere.stl"}, kUnreadable, {"nowhere.stl", "no file of this name, and no modifier"});
  expect_refused({"text.stl"}, kUnreadable, {"text.stl"});
  expect_refused({"open.stl"}, kUnusable, {"open.stl", "has to be closed"});
  expect_refused({"box:-1,-1,-1,31,31,31"}, kNothing, {"--keep-solid", "nothing to remove"});
  expect_refused({"box:0,0,2,30,30,28"}, kNothing, {"--keep-solid", "nothing to remove"});
}

TEST(KeepSolid, ARegionsFileIsNeverOverwritten) {
  const Job job;
  const std::string bytes = to_binary_stl(make_box({10, 10, 10}, {20, 20, 20}));
  const auto region = job.input("outputs/out.stl", bytes);
  const ProcessResult result = run(job.hollow(job.input("block.stl", block()), keeping({region})));
  EXPECT_EQ(result.exit_code, kUsage);
  EXPECT_EQ(read_bytes(region), bytes);
}

}  // namespace
}  // namespace aerate::test
