#include <algorithm>
#include <cmath>
#include <filesystem>
#include <gtest/gtest.h>
#include <limits>
#include <tbb/parallel_for.h>

#include "core/overhang.h"
#include "files/load.h"
#include "kernels/roof_distance.h"
#include "packing/adaptive.h"
#include "packing/verify.h"
#include "tests/support/clearance.h"
#include "tests/support/shapes.h"

// Packings of voids with roofs, against brute force: every void against every triangle and every other void.
namespace aerate {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kRounding = 1e-9;

Packing pack(const Mesh& mesh, const PackingLimits& limits,
             DeviceRequest::Kind kind = DeviceRequest::Kind::cpu) {
  Monitor monitor;
  return pack_adaptive(mesh, limits, {}, monitor, {kind, 0});
}

PackingLimits limits_with(const Roof& roof, double min_radius) {
  return {.wall = 1.2, .gap = 0.9, .min_radius = min_radius, .max_radius = kInfinity, .roof = roof};
}

std::size_t roof_count(const Packing& packing) {
  return static_cast<std::size_t>(
      std::count_if(packing.spheres.begin(), packing.spheres.end(),
                    [&](const Sphere& s) { return packing.limits.roof.shapes(s.radius); }));
}

void expect_limits_held(const Mesh& mesh, const Packing& packing) {
  const PackingLimits& limits = packing.limits;
  const std::vector<Sphere>& spheres = packing.spheres;
  ASSERT_FALSE(spheres.empty());
  std::vector<double> walls(spheres.size(), kInfinity);
  tbb::parallel_for(std::size_t{0}, spheres.size(), [&](std::size_t i) {
    for (const Triangle& t : mesh.triangles) {
      walls[i] = std::min(walls[i], kernels::distance_to_facet(limits.roof, spheres[i].centre,
                                                               spheres[i].radius, facet_of(mesh, t)));
    }
  });
  for (std::size_t i = 0; i < spheres.size(); ++i) {
    ASSERT_GE(walls[i], limits.wall - kRounding) << i;
    ASSERT_EQ(test::winding_number(mesh, spheres[i].centre), 1) << i;
    ASSERT_GE(spheres[i].radius, limits.min_radius);
    for (std::size_t j = 0; j < i; ++j) {
      ASSERT_GE(kernels::distance_between(limits.roof, spheres[i].centre, spheres[i].radius,
                                          spheres[j].centre, spheres[j].radius),
                limits.gap - kRounding)
          << i << " and " << j;
    }
  }
}

void expect_same_bytes(const Packing& a, const Packing& b) {
  ASSERT_EQ(a.spheres.size(), b.spheres.size());
  for (std::size_t i = 0; i < a.spheres.size(); ++i) {
    ASSERT_TRUE(a.spheres[i].centre == b.spheres[i].centre) << i;
    ASSERT_EQ(a.spheres[i].radius, b.spheres[i].radius) << i;
  }
}

TEST(RoofedPacking, KeepsWallAndGapInABoxWhateverIsUp) {
  const Mesh box = test::make_box({0, 0, 0}, {34, 40, 30});
  for (const Vec3d up : {Vec3d{0, 0, 1}, {0, 0, -1}, {1, 0, 0}, {0, -1, 0}, {1, -2, 0.5}}) {
    for (const Overhang& overhang : {Overhang{.up = up}, Overhang{.degrees = 30, .bridge = 2, .up = up},
                                     Overhang{.bridge = 0, .up = up}}) {
      const Packing packing = pack(box, limits_with(make_roof(overhang), 1));
      EXPECT_GT(roof_count(packing), 0);
      expect_limits_held(box, packing);
      const Packing verified = verify_packing(SurfaceIndex(box), packing);
      EXPECT_EQ(verified.spheres.size(), packing.spheres.size());
      EXPECT_EQ(verified.statistics.dropped_by_verification, 0);
      EXPECT_FALSE(find_fault(SurfaceIndex(box), packing).has_value());
    }
  }
}

TEST(RoofedPacking, TheFirstVoidTouchesOnAllSides) {
  // In a tall box the walls decide: as wide as it may be. In a flat one, floor and ceiling: the void reaches
  // from wall to wall, up to the top of the room that is kept for it.
  const Roof roof = make_roof({});
  const Packing tall = pack(test::make_box({0, 0, 0}, {20, 20, 60}), limits_with(roof, 2));
  EXPECT_NEAR(tall.spheres[0].radius, 10 - 1.2, 1e-3);
  const Packing flat = pack(test::make_box({0, 0, 0}, {60, 60, 20}), limits_with(roof, 2));
  const double radius = flat.spheres[0].radius;
  EXPECT_NEAR(radius + roof.spine(radius) + roof.widest_ball, 20 - 2 * 1.2, 1e-3);
}

TEST(RoofedPacking, VerificationFindsWhatIsTooNearAbove) {
  const Mesh box = test::make_box({0, 0, 0}, {40, 40, 22.2F});
  Packing packing;
  packing.limits = limits_with(make_roof({}), 1);
  packing.spheres = {{{20, 20, 10.7}, 9.5, SphereKind::adaptive}};
  // As a ball it leaves 2 mm above, as a void with a roof none.
  ASSERT_TRUE(find_fault(SurfaceIndex(box), packing).has_value());
  EXPECT_EQ(find_fault(SurfaceIndex(box), packing)->kind, PackingFault::Kind::wall);
  EXPECT_TRUE(verify_packing(SurfaceIndex(box), packing).spheres.empty());
  packing.limits.roof = {};
  EXPECT_FALSE(find_fault(SurfaceIndex(box), packing).has_value());
  // A void in the roof of another.
  const Mesh large = test::make_box({-40, -40, -40}, {40, 40, 40});
  packing.spheres = {{{0, 0, 0}, 9.5, SphereKind::adaptive}, {{0, 0, 13}, 2, SphereKind::adaptive}};
  EXPECT_FALSE(find_fault(SurfaceIndex(large), packing).has_value());
  packing.limits.roof = make_roof({});
  ASSERT_TRUE(find_fault(SurfaceIndex(large), packing).has_value());
  EXPECT_EQ(find_fault(SurfaceIndex(large), packing)->kind, PackingFault::Kind::gap);
  EXPECT_EQ(verify_packing(SurfaceIndex(large), packing).spheres.size(), 1);
  EXPECT_LT(measure_clearances(SurfaceIndex(large), packing.spheres, packing.limits.roof).gap.value(), 0.9);
}

TEST(RoofedPacking, RoofsThatNoVoidNeedsChangeNothing) {
  const Mesh box = test::make_box({0, 0, 0}, {34, 40, 30});
  PackingLimits limits = limits_with({}, 1);
  limits.max_radius = 3.5;
  const Packing without = pack(box, limits);
  limits.roof = make_roof({});
  expect_same_bytes(pack(box, limits), without);
}

TEST(RoofedPacking, RealModelsLoseLittle) {
  for (const char* name : {"dragon-47k-100mm.stl", "bunny-100mm.stl"}) {
    const std::filesystem::path path = std::filesystem::path(AERATE_SHARED) / "models" / name;
    if (!std::filesystem::exists(path)) GTEST_SKIP() << "needs " << path;
    const Mesh mesh = load_model(path).mesh;
    const Packing free = pack(mesh, limits_with({}, 1.5));
    const Packing roofed = pack(mesh, limits_with(make_roof({}), 1.5));
    EXPECT_GT(roof_count(roofed), 10) << name;
    expect_limits_held(mesh, roofed);
    EXPECT_GE(total_volume(roofed), 0.85 * total_volume(free)) << name;
    RecordProperty(name, std::to_string(total_volume(roofed) / total_volume(free)));
    expect_same_bytes(roofed,
                      pack(mesh, limits_with(make_roof({}), 1.5), DeviceRequest::Kind::cpu_one_thread));
  }
}

}  // namespace
}  // namespace aerate
