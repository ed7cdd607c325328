#include <algorithm>
#include <cmath>
#include <filesystem>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "core/mesh.h"
#include "files/formats.h"
#include "files/load.h"
#include "printing/slicers/support_blockers.h"
#include "tests/slicer/slicing.h"
#include "tests/support/blocks.h"
#include "tests/support/caught.h"
#include "tests/support/closed_shells.h"
#include "tests/support/shapes.h"
#include "tests/support/temporary_folder.h"

// Support blockers of voids: their shape, their files, and what PrusaSlicer makes of these.
namespace aerate::test {
namespace {

using Json = nlohmann::json;

// --- shape ---

TEST(BlockersOfVoids, AreLargerAllRound) {
  const double by = 0.4;
  const Mesh ball = make_uv_sphere(5, 24, 48), larger = grown(ball, by);
  EXPECT_TRUE(is_closed_manifold(larger));
  for (const Vec3f& p : larger.positions) EXPECT_NEAR(length(to_double(p)), 5 + by, 0.01);
}

TEST(BlockersOfVoids, MoveNoCornerFurtherThanHalfOfTheWall) {
  const double wall = 1.2, by = growth_of_blockers(wall);
  const Mesh box = make_box({0, 0, 0}, {8, 6, 4}), larger = grown(box, by);
  for (std::size_t i = 0; i < box.positions.size(); ++i)
    EXPECT_LE(length(to_double(larger.positions[i]) - to_double(box.positions[i])), wall / 2 + 1e-6);
  // A face is above the next layer all over, corners included.
  const Box3f bounds = bounding_box(larger);
  EXPECT_GT(bounds.upper.z, 4 + 0.3);
  EXPECT_LE(bounds.upper.z, 4 + by + 1e-6);
  EXPECT_GT(signed_volume(larger), signed_volume(box));
}

TEST(BlockersOfVoids, FollowTheSolidOnePerVoid) {
  Solid solid;
  solid.mesh = make_box({0, 0, 0}, {30, 20, 20});
  solid.close_part(PartKind::outer);
  for (const float x : {5.0F, 15.0F}) {
    solid.mesh = join(solid.mesh, turned_inside_out(make_box({x, 5, 5}, {x + 5, 10, 10})));
    solid.close_part(PartKind::void_surface);
  }
  const Mesh all = with_support_blockers(solid, 0.3);
  ASSERT_EQ(all.triangles.size(), 12u + 2 * 24u);
  EXPECT_TRUE(std::equal(solid.mesh.triangles.begin(), solid.mesh.triangles.end(), all.triangles.begin()));
  const std::vector<ObjectPart> parts = blocker_parts(solid);
  ASSERT_EQ(parts.size(), 2u);
  EXPECT_EQ(parts.back().first_triangle, 36u);
  EXPECT_EQ(parts.back().end(), 60u);
  // Outward, where the voids are inward.
  const Mesh blockers = submesh(all, std::span(all.triangles).subspan(36));
  EXPECT_GT(signed_volume(blockers), 2 * 125);
}

// --- files ---

class SupportBlockers : public testing::Test {
 protected:
  std::filesystem::path model(const Mesh& mesh) const {
    const auto path = folder_.path() / "model.stl";
    write_mesh(mesh, path, MeshFormat::stl);
    return path;
  }
  std::filesystem::path block() const { return model(make_box({0, 0, 0}, {22, 22, 22})); }

  ProcessResult hollow(const std::filesystem::path& model, const std::string& output,
                       const std::vector<std::string>& options) const {
    std::vector<std::string> command{AERATE_EXECUTABLE, "hollow", model, "-o", folder_.path() / output};
    command.insert(command.end(), options.begin(), options.end());
    return run(command);
  }
  Json report(const std::filesystem::path& model, const std::string& output,
              std::vector<std::string> options) const {
    options.insert(options.end(), {"--json", "-"});
    const ProcessResult result = hollow(model, output, options);
    EXPECT_EQ(result.exit_code, 0) << result.err;
    return result.exit_code == 0 ? Json::parse(result.out) : Json();
  }

  TemporaryFolder folder_;
};

TEST_F(SupportBlockers, AreInTheFileAndNotInTheModelThatIsReadFromIt) {
  const auto plain = folder_.path() / "plain.3mf";
  const Json without = report(block(), "plain.3mf", {});
  EXPECT_TRUE(without["support_blockers"].is_null());
  const LoadedModel voids = load_model(plain, {.unit = {}, .volume_lists = volume_lists()});
  for (const std::string flavor : {"prusa", "orca"}) {
    SCOPED_TRACE(flavor);
    const Json with = report(block(), "with.3mf", {"--support-blockers", "--flavor", flavor});
    const auto path = folder_.path() / "with.3mf";
    const std::size_t of_voids = with["output"]["void_triangles"];
    EXPECT_EQ(with["support_blockers"]["flavor"], flavor);
    EXPECT_EQ(with["support_blockers"]["count"], without["voids"]["count"]);
    EXPECT_EQ(with["support_blockers"]["triangles"], of_voids);
    EXPECT_EQ(with["output"]["triangles"], voids.mesh.triangles.size() + of_voids);
    EXPECT_EQ(with["volume"], without["volume"]);
    // Every triangle for who does not know of them.
    EXPECT_EQ(load_model(path).mesh.triangles.size(), voids.mesh.triangles.size() + of_voids);
    const LoadedModel again = load_model(path, {.unit = {}, .volume_lists = volume_lists()});
    EXPECT_EQ(again.mesh.positions, voids.mesh.positions);
    EXPECT_EQ(again.mesh.triangles, voids.mesh.triangles);
    ASSERT_EQ(again.notices.size(), 1u);
    EXPECT_TRUE(contains(again.notices.front(), kSupportBlockers));
    const ProcessResult inspected = run({AERATE_EXECUTABLE, "inspect", path, "--json", "-"});
    ASSERT_EQ(inspected.exit_code, 0) << inspected.err;
    EXPECT_EQ(Json::parse(inspected.out)["input"]["triangles"], voids.mesh.triangles.size());
  }
}

TEST_F(SupportBlockers, CountAmongTheTrianglesThatAreAllowed) {
  for (const std::string shape : {"spheres", "cells"}) {
    SCOPED_TRACE(shape);
    const std::vector<std::string> options{"--shape", shape, "--support-blockers"};
    const std::size_t all = report(block(), "all.3mf", options)["output"]["triangles"];
    std::vector<std::string> limited = options;
    limited.insert(limited.end(), {"--max-triangles", std::to_string(all * 3 / 4)});
    const Json fewer = report(block(), "fewer.3mf", limited);
    EXPECT_LE(fewer["output"]["triangles"], all * 3 / 4);
    EXPECT_EQ(load_model(folder_.path() / "fewer.3mf").mesh.triangles.size(), fewer["output"]["triangles"]);
  }
}

TEST_F(SupportBlockers, AreRefusedWhereTheyHaveNoUse) {
  constexpr int kUsage = 2;
  struct Case {
    std::string output;
    std::vector<std::string> options;
    std::string said;
  };
  for (const Case& each :
       {Case{"x.stl", {}, "support blockers need a 3MF file"},
        Case{"x.3mf", {"--as", "modifiers"}, "leaves no voids that supports could fill"},
        Case{"x.3mf", {"--process", "sla"}, "--support-blockers is for sealed voids"},
        Case{"x.3mf", {"--flavor", "slic3r"}, "files of flavor slic3r hold no support blockers"}}) {
    std::vector<std::string> options = each.options;
    options.emplace_back("--support-blockers");
    const ProcessResult refused = hollow(block(), each.output, options);
    EXPECT_EQ(refused.exit_code, kUsage) << each.said;
    EXPECT_TRUE(contains(refused.err, each.said));
    EXPECT_FALSE(std::filesystem::exists(folder_.path() / each.output));
  }
}

TEST_F(SupportBlockers, TheReportSaysWhatToSwitchWithoutThem) {
  const std::string switch_it = "on the build plate only, or they fill voids";
  const ProcessResult plain = hollow(block(), "x.stl", {});
  EXPECT_TRUE(contains(plain.out, switch_it));
  EXPECT_FALSE(contains(plain.err, switch_it));
  EXPECT_FALSE(contains(hollow(block(), "x.3mf", {"--support-blockers"}).out, switch_it));
  EXPECT_FALSE(contains(hollow(block(), "x.3mf", {"--as", "modifiers"}).out, switch_it));
  EXPECT_FALSE(contains(hollow(block(), "x.stl", {"--process", "sls"}).out, switch_it));
}

// --- with PrusaSlicer ---

class SlicedSupportBlockers : public SupportBlockers {
 protected:
  void SetUp() override {
    if (!is_installed("prusa-slicer")) GTEST_SKIP() << "prusa-slicer is not installed: nothing was sliced";
  }

  double filament(const std::filesystem::path& model, bool has_supports) const {
    std::vector<std::string> options{"--fill-density", "15%", "--fill-pattern", "gyroid",
                                     "--layer-height", "0.3", "--skirts",       "0"};
    if (has_supports) options.emplace_back("--support-material");
    return slice_with_prusa(model, folder_.path() / "out.gcode", options).filament_mm.value_or(0);
  }
};

TEST_F(SlicedSupportBlockers, KeepSupportsOutOfVoids) {
  for (const std::string shape : {"spheres", "cells"}) {
    SCOPED_TRACE(shape);
    report(block(), "plain.3mf", {"--shape", shape});
    report(block(), "with.3mf", {"--shape", shape, "--support-blockers"});
    const auto plain = folder_.path() / "plain.3mf", with = folder_.path() / "with.3mf";
    const double bare = filament(plain, false), filled = filament(plain, true), kept = filament(with, true);
    std::printf("%s: filament %.1f mm, with supports everywhere %.1f, with blockers %.1f\n", shape.c_str(),
                bare, filled, kept);
    EXPECT_GT(filled, 1.03 * bare);
    EXPECT_NEAR(kept, bare, 0.01 * bare);
    EXPECT_NEAR(filament(with, false), bare, 0.001 * bare);
  }
}

TEST_F(SlicedSupportBlockers, LeaveOverhangsOutsideTheirSupports) {
  // An arm of 16 mm, 10 mm thick, out of a block, with voids close above its lower side.
  const auto is_solid = [](int x, int /*y*/, int z) { return x == 0 || z == 1; };
  const auto solid = model(make_blocks({{{0, 20, 36}, {0, 14}, {0, 12, 22}}}, is_solid));
  report(solid, "plain.3mf", {"--max-radius", "4", "--shape", "spheres"});
  report(solid, "with.3mf", {"--max-radius", "4", "--shape", "spheres", "--support-blockers"});
  const auto plain = folder_.path() / "plain.3mf", with = folder_.path() / "with.3mf";
  const double outside = filament(solid, true) - filament(solid, false);
  const double bare = filament(plain, false);
  const double everywhere = filament(plain, true) - bare, kept = filament(with, true) - bare;
  std::printf("supports: %.1f mm outside, %.1f with voids, %.1f with blockers\n", outside, everywhere, kept);
  EXPECT_GT(outside, 100);
  EXPECT_GT(everywhere, 1.05 * outside);
  EXPECT_NEAR(kept, outside, 0.02 * outside);
}

TEST_F(SlicedSupportBlockers, AreWhatSliceGivesVoidsWhereSupportsAreEverywhere) {
  const auto slice = [&](const std::string& settings, std::vector<std::string> options) {
    const auto config = folder_.write("settings.ini", "layer_height = 0.3\nfill_density = 80%\n" + settings);
    options.insert(options.begin(),
                   {AERATE_EXECUTABLE, "slice", block(), "--slicer", "prusa-slicer", "-o",
                    folder_.path() / "out.gcode", "--config", config, "--as", "voids", "--json", "-"});
    const ProcessResult result = run(options);
    EXPECT_EQ(result.exit_code, 0) << result.err;
    return result;
  };
  const auto filament_of = [](const ProcessResult& result) {
    return Json::parse(result.out)["forms"][1]["filament_mm"].get<double>();
  };
  const std::string kept_out = "support blockers keep them out";
  const ProcessResult everywhere = slice("support_material = 1\n", {});
  const ProcessResult on_plate = slice("support_material = 1\nsupport_material_buildplate_only = 1\n", {});
  const ProcessResult none = slice("", {});
  EXPECT_TRUE(contains(everywhere.err, kept_out));
  EXPECT_FALSE(contains(on_plate.err, kept_out));
  EXPECT_FALSE(contains(none.err, kept_out));
  EXPECT_NEAR(filament_of(everywhere), filament_of(none), 0.01 * filament_of(none));
  EXPECT_NEAR(filament_of(on_plate), filament_of(none), 0.01 * filament_of(none));
}

}  // namespace
}  // namespace aerate::test
