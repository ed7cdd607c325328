#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <limits>
#include <numbers>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "check/check_plugs.h"
#include "check/shell_topology.h"
#include "core/overhang.h"
#include "printing/carve_drained.h"
#include "printing/plug_surface.h"
#include "printing/plugs.h"
#include "tests/support/caught.h"
#include "tests/support/clearance.h"
#include "tests/support/closed_shells.h"
#include "tests/support/packing_of.h"
#include "tests/support/shapes.h"

namespace aerate {
namespace {

constexpr double kRadius = 3, kHeight = 4, kTangent = 0.05;

PlugShape level(std::size_t number, double height = kHeight) {
  return {.radius = kRadius, .tangent = kTangent, .number = number, .height = [height](double, double) {
            return std::optional(height);
          }};
}

Mesh mesh_of(const PlugSurface& surface) {
  Mesh mesh;
  for (const Vec3d p : surface.positions) mesh.positions.push_back(to_float(p));
  mesh.triangles = surface.triangles;
  return mesh;
}

// Of a frustum over regular polygons of so many sides.
double frustum_volume(double lower, double upper, double height, std::size_t sides) {
  const double n = static_cast<double>(sides);
  const double of_unit = n / 2 * std::sin(2 * std::numbers::pi / n);
  return of_unit * height / 3 * (lower * lower + lower * upper + upper * upper);
}

// What is engraved, as it is read from below with +y up: a line of text for each row of the finest grid.
std::vector<std::string> read_from_below(const PlugSurface& surface) {
  std::set<double> xs, ys;
  std::vector<Triangle> sunk;
  for (const Triangle& t : surface.triangles) {
    const auto is_sunk = [&](std::uint32_t v) {
      return surface.positions[v].z > 0 && surface.positions[v].z < kShortestPlug;
    };
    if (!std::ranges::all_of(t, is_sunk)) continue;
    sunk.push_back(t);
    for (const std::uint32_t v : t) {
      xs.insert(std::round(surface.positions[v].x * 1e6) / 1e6);
      ys.insert(std::round(surface.positions[v].y * 1e6) / 1e6);
    }
  }
  if (sunk.empty()) return {};
  double line = std::numeric_limits<double>::infinity();
  for (auto x = xs.begin(); std::next(x) != xs.end(); ++x) line = std::min(line, *std::next(x) - *x);
  const auto covers = [&](double x, double y) {
    return std::ranges::any_of(sunk, [&](const Triangle& t) {
      const auto side = [&](std::uint32_t from, std::uint32_t to) {
        const Vec3d a = surface.positions[from], b = surface.positions[to];
        return (b.x - a.x) * (y - a.y) - (b.y - a.y) * (x - a.x);
      };
      // Faces down: clockwise.
      return side(t[0], t[1]) <= 1e-9 && side(t[1], t[2]) <= 1e-9 && side(t[2], t[0]) <= 1e-9;
    });
  };
  std::vector<std::string> rows;
  const auto steps = [&](const std::set<double>& all) {
    return static_cast<int>(std::lround((*all.rbegin() - *all.begin()) / line));
  };
  for (int row = 0; row < steps(ys); ++row) {
    rows.emplace_back();
    for (int column = 0; column < steps(xs); ++column)
      rows.back() +=
          covers(*xs.rbegin() - (column + 0.3) * line, *ys.rbegin() - (row + 0.4) * line) ? '#' : '.';
  }
  return rows;
}

TEST(PlugSurface, IsAFrustumLessItsNumber) {
  const auto surface = plug_surface(level(8));
  ASSERT_TRUE(surface);
  const std::size_t sides = tube_sides(kRadius, 0.01);
  const double inner = kRadius - kHeight * kTangent;
  EXPECT_DOUBLE_EQ(surface->inner_radius, inner);
  const double whole = frustum_volume(inner, kRadius, kHeight, sides);
  const double engraved_8 = whole - signed_volume(mesh_of(*surface));
  EXPECT_GT(engraved_8, 0);
  // Of the same lines 8 has 13 squares, 7 has 7 and 1 has 5; but 1 is written by one column of three.
  for (const auto& [number, squares] : {std::pair{7U, 7.0}, {1U, 5.0}, {4U, 9.0}, {0U, 12.0}}) {
    const double engraved = whole - signed_volume(mesh_of(plug_surface(level(number)).value()));
    EXPECT_NEAR(engraved / engraved_8, squares / 13, 1e-3) << number;
  }
}

TEST(PlugSurface, ItsNumberIsReadFromBelow) {
  using Rows = std::vector<std::string>;
  EXPECT_EQ(read_from_below(plug_surface(level(7)).value()), (Rows{"###", "..#", "..#", "..#", "..#"}));
  EXPECT_EQ(read_from_below(plug_surface(level(24)).value()),
            (Rows{"###.#.#", "..#.#.#", "###.###", "#.....#", "###...#"}));
  // 6 and 9 are told apart by a line under them; 8 needs none, nor does 69.
  EXPECT_EQ(read_from_below(plug_surface(level(6)).value()),
            (Rows{"###", "#..", "###", "#.#", "###", "...", "###"}));
  EXPECT_EQ(read_from_below(plug_surface(level(9)).value()),
            (Rows{"###", "#.#", "###", "..#", "###", "...", "###"}));
  EXPECT_EQ(read_from_below(plug_surface(level(8)).value()).size(), 5U);
  EXPECT_EQ(read_from_below(plug_surface(level(69)).value()).size(), 5U);
  EXPECT_EQ(read_from_below(plug_surface(level(10)).value()).size(), 7U);
}

TEST(PlugSurface, IsOneShellUnderEveryNumberAndItsInnerEndIsNoWhereDouble) {
  for (std::size_t number = 1; number <= 130; ++number) {
    const auto surface = plug_surface(level(number));
    ASSERT_TRUE(surface);
    EXPECT_TRUE(surface->is_numbered) << number;
    EXPECT_EQ(flaw_of_sphere_shell(surface->triangles), std::nullopt) << number;
    // Faces below, whether sunk or not: all look down, and cover the end once.
    double area = 0;
    for (const Triangle& t : surface->triangles) {
      const Vec3d a = surface->positions[t[0]], b = surface->positions[t[1]], c = surface->positions[t[2]];
      const bool is_level = a.z == b.z && b.z == c.z && a.z < kShortestPlug;
      if (!is_level) continue;
      const double z = cross(b - a, c - a).z / 2;
      EXPECT_LT(z, 0) << number;
      area -= z;
    }
    const auto sides = static_cast<double>(tube_sides(kRadius, 0.01));
    const double inner = surface->inner_radius;
    EXPECT_NEAR(area, sides / 2 * std::sin(2 * std::numbers::pi / sides) * inner * inner, 1e-9) << number;
  }
}

TEST(PlugSurface, EndsOnASlopeAndLeansByItsTaperAllRound) {
  PlugShape shape = level(3);
  shape.height = [](double x, double y) { return std::optional(5 + x - 0.3 * y); };
  const auto surface = plug_surface(shape);
  ASSERT_TRUE(surface);
  EXPECT_EQ(flaw_of_sphere_shell(surface->triangles), std::nullopt);
  double widest = 0;
  for (const Vec3d p : surface->positions) {
    const double distance = std::hypot(p.x, p.y);
    widest = std::max(widest, distance);
    EXPECT_LE(distance, kRadius + 1e-12);
    EXPECT_LE(distance, surface->inner_radius + p.z * kTangent + 1e-4);
  }
  EXPECT_NEAR(widest, kRadius, 0.02);  // at the one highest place
  for (std::size_t i = 0; i < surface->outer_end_triangles; ++i)
    for (const std::uint32_t v : surface->triangles[i])
      EXPECT_NEAR(surface->positions[v].z, *shape.height(surface->positions[v].x, surface->positions[v].y),
                  1e-9);
  EXPECT_NEAR(surface->longest, 5 + kRadius * std::hypot(1, 0.3), 0.15);
  EXPECT_NEAR(surface->shortest, 5 - kRadius * std::hypot(1, 0.3), 0.5);
}

TEST(PlugSurface, ThereIsNoneWhereItWouldBeShortOrTheSurfaceIsMissing) {
  EXPECT_TRUE(plug_surface(level(1, kShortestPlug)));
  EXPECT_FALSE(plug_surface(level(1, kShortestPlug - 1e-3)));
  PlugShape beside = level(1);
  beside.height = [](double x, double) { return x > 1 ? std::nullopt : std::optional(2.0); };
  EXPECT_FALSE(plug_surface(beside));
  PlugShape thin = level(1, 100);  // its taper would use up its width
  EXPECT_FALSE(plug_surface(thin));
  PlugShape narrow = level(100);
  narrow.radius = 1;
  const auto unnumbered = plug_surface(narrow);
  ASSERT_TRUE(unnumbered);
  EXPECT_FALSE(unnumbered->is_numbered);
  EXPECT_EQ(flaw_of_sphere_shell(unnumbered->triangles), std::nullopt);
}

// Two voids in a block with a channel, a hole below and one that leans to the side.
class PlugsOfABlock : public testing::Test {
 protected:
  PlugsOfABlock() {
    plan_.channels.push_back({0, 1, {{18, 15, 12.7}, {22.6, 15, 13.3}, 2}});
    plan_.holes.push_back({0, {{12, 15, 5.3}, {12, 15, 0}, 2}, 0});
    const Vec3d sideways = normalised(Vec3d{1, 0, 0.4});
    plan_.holes.push_back(
        {1, {Vec3d{28, 15, 14} + sideways * 5.65, Vec3d{28, 15, 14} + sideways * (12 / sideways.x), 2}, 0});
    plan_.network_count = 1;
    solid_ = carve_drained(model_, surface_, packing_, plan_, {.tolerance = 0.05}, silent_);
    plugs_ = make_plugs(model_, surface_, solid_, plan_, fit_);
  }

  PlugFacts check(const Mesh& mesh) { return check_plugs(mesh, plugs_, fit_, surface_, silent_); }

  Monitor silent_;
  Mesh model_ = test::make_box({0, 0, 0}, {40, 30, 30});
  SurfaceIndex surface_{model_};
  Packing packing_ =
      test::packing_of({{{12, 15, 12}, 7, SphereKind::adaptive}, {{28, 15, 14}, 6, SphereKind::adaptive}});
  DrainagePlan plan_;
  PlugFit fit_{0.2, 3};
  Solid solid_;
  Plugs plugs_;
};

TEST_F(PlugsOfABlock, AreCheckedAndCloseTheHolesFlush) {
  ASSERT_EQ(plugs_.plugs.size(), 2U);
  EXPECT_TRUE(plugs_.without.empty());
  const PlugFacts facts = check(plugs_.mesh);
  EXPECT_NEAR(facts.clearance, 0.2, 1e-4);
  EXPECT_LT(facts.flush, 1e-4);  // faces of a block are plane
  EXPECT_NEAR(facts.volume, signed_volume(plugs_.mesh), 1e-3);
  // Below the wall is 5 mm and a little; aside the plug is longer above than below.
  EXPECT_NEAR(plugs_.plugs[0].shortest, 5.28, 0.05);
  EXPECT_NEAR(plugs_.plugs[0].longest, plugs_.plugs[0].shortest, 1e-6);
  EXPECT_NEAR(plugs_.plugs[1].longest - plugs_.plugs[1].shortest, 2 * plugs_.plugs[1].radius * 0.4, 0.05);
  EXPECT_LT(plugs_.plugs[0].radius, 2 - 0.2 + 1e-6);
  EXPECT_GT(plugs_.plugs[0].radius, 2 - 0.2 - 0.1);
}

// In its hole a plug is within the model and touches nothing that was left of it.
TEST_F(PlugsOfABlock, FitIntoTheirHoles) {
  for (const Plug& plug : plugs_.plugs) {
    const Vec3d middle = place_in_hole(plug, plug.place + Vec3d{0, 0, plug.shortest / 2});
    for (std::size_t i = 0; i < plug.triangle_count; ++i) {
      const Triangle& t = plugs_.mesh.triangles[plug.first_triangle + i];
      for (const std::uint32_t v : t) {
        const Vec3d p = place_in_hole(plug, to_double(plugs_.mesh.positions[v]));
        const Vec3d within = p + (middle - p) * 0.01;
        EXPECT_EQ(test::winding_number(model_, within), 1);
        EXPECT_EQ(test::winding_number(solid_.mesh, within), 0);
      }
    }
  }
}

TEST_F(PlugsOfABlock, AreRefusedIfTheFileIsAnother) {
  const auto refusal = [&](const Mesh& mesh) { return test::message_of<FailureError>([&] { check(mesh); }); };
  Mesh mesh = plugs_.mesh;
  mesh.triangles.pop_back();
  EXPECT_TRUE(test::contains(refusal(mesh), "triangles instead of"));
  mesh = plugs_.mesh;
  mesh.positions[5].x += 0.01F;
  EXPECT_TRUE(test::contains(refusal(mesh), "is not the one of the result"));

  // What was planned wrongly is found too.
  const Plugs right = plugs_;
  plugs_.plugs[0].room -= 0.1;
  EXPECT_TRUE(test::contains(refusal(right.mesh), "plug 1 has a clearance of"));
  plugs_ = right;
  plugs_.plugs[1].inner_end = plugs_.plugs[1].inner_end + plugs_.plugs[1].frame.axis * 0.1;
  EXPECT_TRUE(test::contains(refusal(right.mesh), "outer end of plug 2 is"));
  plugs_ = right;
  plugs_.plugs[1].place.x = plugs_.plugs[0].place.x + 5;
  EXPECT_FALSE(refusal(right.mesh).empty());
  plugs_ = right;
  for (Vec3f& p : plugs_.mesh.positions) p.z += 1;
  EXPECT_TRUE(test::contains(refusal(plugs_.mesh), "above the build plate"));
  plugs_ = right;
  std::swap(plugs_.mesh.triangles[3][0], plugs_.mesh.triangles[3][1]);
  EXPECT_TRUE(test::contains(refusal(plugs_.mesh), "plug 1 is no closed shell"));
}

TEST_F(PlugsOfABlock, HaveNoRoomWithAClearanceOfHalfTheHole) {
  const Plugs none = make_plugs(model_, surface_, solid_, plan_, {2, 2});
  EXPECT_TRUE(none.plugs.empty());
  EXPECT_EQ(none.without, (std::vector<std::size_t>{0, 1}));
}

}  // namespace
}  // namespace aerate
