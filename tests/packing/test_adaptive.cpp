#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>
#include <iterator>
#include <limits>
#include <numbers>
#include <string>
#include <tbb/global_control.h>
#include <tbb/task_arena.h>

#include "core/error.h"
#include "core/overhang.h"
#include "kernels/adaptive_packing.h"
#include "kernels/exec_cpu.h"
#include "packing/adaptive.h"
#include "packing/verify.h"
#include "tests/support/adaptive_input.h"
#include "tests/support/clearance.h"
#include "tests/support/shapes.h"

namespace aerate {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

Packing pack(const Mesh& mesh, const PackingLimits& limits, const PackingStop& options = {},
             DeviceRequest::Kind kind = DeviceRequest::Kind::cpu) {
  Monitor monitor;
  return pack_adaptive(mesh, limits, options, monitor, {kind, 0});
}

// No index is asked: every sphere against every triangle and every other sphere.
void expect_limits_held(const Mesh& mesh, const Packing& packing) {
  ASSERT_FALSE(packing.spheres.empty());
  EXPECT_GE(test::smallest_gap(packing.spheres), packing.limits.gap);
  for (const Sphere& sphere : packing.spheres) {
    EXPECT_GE(test::distance_to_surface(mesh, sphere.centre) - sphere.radius, packing.limits.wall);
    EXPECT_EQ(test::winding_number(mesh, sphere.centre), 1);
    EXPECT_GE(sphere.radius, packing.limits.min_radius);
    EXPECT_LE(sphere.radius, packing.limits.max_radius);
  }
}

void expect_same_bytes(const Packing& a, const Packing& b) {
  ASSERT_EQ(a.spheres.size(), b.spheres.size());
  for (std::size_t i = 0; i < a.spheres.size(); ++i) {
    ASSERT_TRUE(a.spheres[i].centre == b.spheres[i].centre) << i;
    ASSERT_EQ(a.spheres[i].radius, b.spheres[i].radius) << i;
  }
}

// A corner of many directions, concave edges included: an L-shaped block on its side.
Mesh make_bracket() {
  Mesh mesh;
  const float profile[6][2] = {{0, 0}, {30, 0}, {30, 8}, {9, 8}, {9, 25}, {0, 25}};
  for (const float z : {0.0f, 12.0f}) {
    for (const auto& p : profile) mesh.positions.push_back({p[0], p[1], z});
  }
  for (std::uint32_t i = 0; i < 6; ++i) {
    const std::uint32_t j = (i + 1) % 6;
    mesh.triangles.push_back({i, j, j + 6});
    mesh.triangles.push_back({i, j + 6, i + 6});
  }
  for (const Triangle& t : std::vector<Triangle>{{0, 1, 2}, {0, 2, 3}, {0, 3, 4}, {0, 4, 5}}) {
    mesh.triangles.push_back({t[0], t[2], t[1]});
    mesh.triangles.push_back({t[0] + 6, t[1] + 6, t[2] + 6});
  }
  return mesh;
}

// A UV sphere of radius 10 around (3, -4, 5).
Mesh make_ball(std::uint32_t rings) {
  Mesh mesh;
  const std::uint32_t segments = 2 * rings;
  mesh.positions.push_back({3, -4, 15});
  for (std::uint32_t r = 1; r < rings; ++r) {
    for (std::uint32_t s = 0; s < segments; ++s) {
      const double theta = std::numbers::pi * r / rings;
      const double phi = 2 * std::numbers::pi * s / segments;
      mesh.positions.push_back(
          to_float({3 + 10 * std::sin(theta) * std::cos(phi), -4 + 10 * std::sin(theta) * std::sin(phi),
                    5 + 10 * std::cos(theta)}));
    }
  }
  mesh.positions.push_back({3, -4, -5});
  const auto at = [&](std::uint32_t r, std::uint32_t s) { return 1 + (r - 1) * segments + s % segments; };
  const auto last = static_cast<std::uint32_t>(mesh.positions.size() - 1);
  for (std::uint32_t s = 0; s < segments; ++s) {
    mesh.triangles.push_back({0, at(1, s), at(1, s + 1)});
    mesh.triangles.push_back({last, at(rings - 1, s + 1), at(rings - 1, s)});
    for (std::uint32_t r = 1; r + 1 < rings; ++r) {
      mesh.triangles.push_back({at(r, s), at(r + 1, s), at(r + 1, s + 1)});
      mesh.triangles.push_back({at(r, s), at(r + 1, s + 1), at(r, s + 1)});
    }
  }
  return mesh;
}

Mesh read_binary_stl(const std::filesystem::path& path) {
  std::string bytes(std::filesystem::file_size(path), '\0');
  std::ifstream(path, std::ios::binary).read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  std::uint32_t count = 0;
  std::memcpy(&count, bytes.data() + 80, 4);
  Mesh mesh;
  for (std::size_t i = 0; i < count; ++i) {
    const auto first = static_cast<std::uint32_t>(mesh.positions.size());
    for (std::size_t corner = 0; corner < 3; ++corner) {
      float p[3];
      std::memcpy(p, bytes.data() + 84 + 50 * i + 12 + 12 * corner, 12);
      mesh.positions.push_back({p[0], p[1], p[2]});
    }
    mesh.triangles.push_back({first, first + 1, first + 2});
  }
  return mesh;
}

TEST(Adaptive, FirstSphereOfABallIsTheBall) {
  const Mesh ball = make_ball(40);
  const Packing packing = pack(ball, {1, 0.5, 0.5, kInfinity}, {.max_count = 1});
  ASSERT_EQ(packing.spheres.size(), 1U);
  EXPECT_LT(length(packing.spheres[0].centre - Vec3d{3, -4, 5}), 0.05);
  // The facets lie a little inside of the sphere through their corners.
  EXPECT_LT(packing.spheres[0].radius, 9.0);
  EXPECT_GT(packing.spheres[0].radius, 10 * std::cos(std::numbers::pi / 40) - 1.02);
}

TEST(Adaptive, FirstSpheresOfACubeAreThoseOfGeometry) {
  const Mesh cube = test::make_box({0, 0, 0}, {10, 10, 10});
  const Packing packing = pack(cube, {0, 0, 0.01, kInfinity}, {.max_count = 9});
  ASSERT_EQ(packing.spheres.size(), 9U);
  EXPECT_NEAR(packing.spheres[0].radius, 5, 1e-3);
  EXPECT_NEAR(length(packing.spheres[0].centre - Vec3d{5, 5, 5}), 0, 1e-2);
  // In a corner, tangent to three faces and the first sphere: sqrt(3) (5 - r) = 5 + r.
  const double corner = 5 * (std::sqrt(3.0) - 1) / (std::sqrt(3.0) + 1);
  for (std::size_t i = 1; i < 9; ++i) EXPECT_NEAR(packing.spheres[i].radius, corner, 1e-3) << i;
}

TEST(Adaptive, HoldsWallGapAndRadii) {
  const Mesh bracket = make_bracket();
  for (const PackingLimits& limits :
       {PackingLimits{0, 0, 0.3, kInfinity}, PackingLimits{0.8, 0, 0.3, 2.0}, PackingLimits{0, 0.7, 0.3, 1.0},
        PackingLimits{1.0, 0.5, 0.4, kInfinity}, PackingLimits{0.3, 0.2, 0.45, 0.5}}) {
    expect_limits_held(bracket, pack(bracket, limits));
  }
}

TEST(Adaptive, VerificationFindsNothingToCorrect) {
  const Mesh ball = make_ball(24);
  const Packing packing = verify_packing(SurfaceIndex(ball), pack(ball, {0.4, 0.2, 0.2, 3.0}));
  EXPECT_GT(packing.spheres.size(), 1000U);
  EXPECT_EQ(packing.statistics.dropped_by_verification, 0U);
  EXPECT_EQ(packing.statistics.shrunk_by_verification, 0U);
}

TEST(Adaptive, LeavesNoRoomForAnotherSphere) {
  const Mesh bracket = make_bracket();
  const PackingLimits limits{0.5, 0.4, 0.8, kInfinity};
  const Packing packing = pack(bracket, limits);
  // On a grid as fine as this a void with room for 1.15 times the least radius cannot hide.
  const double step = 0.25 * limits.min_radius;
  double largest = 0;
  for (double x = 0.5; x < 30; x += step) {
    for (double y = 0.5; y < 25; y += step) {
      for (double z = 0.5; z < 12; z += step) {
        double room = kInfinity;
        for (const Sphere& s : packing.spheres) {
          room = std::min(room, length(Vec3d{x, y, z} - s.centre) - s.radius - limits.gap);
        }
        if (room <= largest || test::winding_number(bracket, {x, y, z}) != 1) continue;
        largest =
            std::max(largest, std::min(room, test::distance_to_surface(bracket, {x, y, z}) - limits.wall));
      }
    }
  }
  EXPECT_LT(largest, 1.02 * limits.min_radius);
}

TEST(Adaptive, SameBytesForAnyNumberOfThreads) {
  const Mesh bracket = make_bracket();
  for (const PackingLimits& limits :
       {PackingLimits{0.2, 0.1, 0.3, kInfinity}, PackingLimits{0, 0, 0.25, 1.0}}) {
    const Packing serial = pack(bracket, limits, {}, DeviceRequest::Kind::cpu_one_thread);
    EXPECT_GT(serial.spheres.size(), 500U);
    for (const int threads : {1, 2, 8}) {
      const tbb::global_control control(tbb::global_control::max_allowed_parallelism,
                                        static_cast<std::size_t>(std::max(threads, 2)));
      tbb::task_arena arena(threads);
      arena.execute([&] { expect_same_bytes(serial, pack(bracket, limits)); });
    }
  }
}

// Cells, searches and places of the lattice in pieces, as a device of little memory needs them.
TEST(Adaptive, IsTheSameInPiecesOfAnySize) {
  const Mesh torus = test::make_torus(5, 2, 48, 24);
  kernels::AdaptiveInput input = test::adaptive_input(torus);
  input.parameters.max_radius = 0.6;
  input.parameters.min_radius = 0.25;
  input.parameters.gap = 0.05;
  const kernels::AdaptiveResult whole = kernels::AdaptivePacking<>::pack(kernels::TbbExecutor{}, input);
  ASSERT_GT(whole.lattice_count, 50U);
  ASSERT_GT(whole.balls.size(), whole.lattice_count + 200);
  input.most_at_a_time = 1;
  const kernels::AdaptiveResult pieces = kernels::AdaptivePacking<>::pack(kernels::TbbExecutor{}, input);
  EXPECT_LT(pieces.most_at_a_time, 1000U);
  EXPECT_EQ(pieces.search_count, whole.search_count);
  ASSERT_EQ(pieces.balls.size(), whole.balls.size());
  EXPECT_EQ(std::memcmp(pieces.balls.data(), whole.balls.data(), whole.balls.size() * sizeof(kernels::Ball)),
            0);
}

// Of several packings, the first of which is that of normal effort.
TEST(Adaptive, BestEffortRemovesMore) {
  const PackingLimits limits{0.2, 0.1, 0.8, kInfinity};
  const PackingStop best{.effort = PackingEffort::best};
  double gained = 0;
  for (const Mesh& mesh :
       {make_bracket(), test::make_torus(5, 2, 48, 24), test::make_box({0, 0, 0}, {9, 7, 8})}) {
    const Packing normal = pack(mesh, limits);
    const Packing most = pack(mesh, limits, best);
    EXPECT_GE(total_volume(most), total_volume(normal));
    gained += total_volume(most) - total_volume(normal);
    EXPECT_GT(most.statistics.candidates, 4 * normal.statistics.candidates);
    expect_limits_held(mesh, most);
    expect_same_bytes(most, pack(mesh, limits, best, DeviceRequest::Kind::cpu_one_thread));
  }
  EXPECT_GT(gained, 0.1);
}

TEST(Adaptive, BestEffortKeepsTheLimitsOfCountAndDensity) {
  const Mesh bracket = make_bracket();
  const PackingLimits limits{0.2, 0.1, 0.4, 1.5};
  EXPECT_EQ(pack(bracket, limits, {.max_count = 30, .effort = PackingEffort::best}).spheres.size(), 30U);
  // What reaches the density that is wanted is taken.
  expect_same_bytes(pack(bracket, limits, {.target_density = 0.2}),
                    pack(bracket, limits, {.target_density = 0.2, .effort = PackingEffort::best}));
}

TEST(Adaptive, StopsAtACountWithTheLargest) {
  const Mesh bracket = make_bracket();
  const Packing few = pack(bracket, {0.5, 0.5, 0.1, kInfinity}, {.max_count = 20});
  const Packing more = pack(bracket, {0.5, 0.5, 0.1, kInfinity}, {.max_count = 60});
  ASSERT_EQ(few.spheres.size(), 20U);
  ASSERT_EQ(more.spheres.size(), 60U);
  double largest_after = 0;
  for (std::size_t i = 20; i < 60; ++i) largest_after = std::max(largest_after, more.spheres[i].radius);
  for (const Sphere& sphere : few.spheres) EXPECT_GE(sphere.radius, 0.85 * largest_after);
}

TEST(Adaptive, StopsAtADensity) {
  const Mesh cube = test::make_box({0, 0, 0}, {10, 10, 10});
  for (const double max_radius : {kInfinity, 0.8}) {
    const Packing packing = pack(cube, {0, 0, 0.2, max_radius}, {.target_density = 0.6});
    const Sphere last = packing.spheres.back();
    const double volume = total_volume(packing);
    EXPECT_GE(volume, 600);
    EXPECT_LT(volume - 4.0 / 3.0 * std::numbers::pi * std::pow(last.radius, 3), 600.0);
  }
}

// The surface integral counts what two parts have in common twice: 2,400 mm3 for the 2,000 that are filled.
TEST(Adaptive, StopsAtADensityOfTheVolumeThatIsGiven) {
  const Mesh parts =
      test::join(test::make_box({0, 0, 0}, {10, 10, 10}), test::make_box({6, 0, 0}, {20, 10, 10}));
  const Packing packing = pack(parts, {0, 0, 0.1, kInfinity}, {.target_density = 0.2, .volume = 2000});
  const double volume = total_volume(packing);
  EXPECT_GE(volume, 400);
  EXPECT_LT(volume - 4.0 / 3.0 * std::numbers::pi * std::pow(packing.spheres.back().radius, 3), 400);
}

TEST(Adaptive, StartsFromALatticeWhereTheLargestRadiusIsSmall) {
  const Mesh cube = test::make_box({0, 0, 0}, {10, 10, 10});
  const Packing packing = pack(cube, {0, 0, 0.12, 0.5});
  const auto on_lattice = std::count_if(packing.spheres.begin(), packing.spheres.end(),
                                        [](const Sphere& s) { return s.kind == SphereKind::lattice; });
  EXPECT_GT(on_lattice, 1000);
  EXPECT_GT(total_volume(packing), 730);
  EXPECT_GE(measure_clearances(SurfaceIndex(cube), packing.spheres).wall, 0);
  EXPECT_GE(measure_clearances(SurfaceIndex(cube), packing.spheres).gap.value(), 0);
}

TEST(Adaptive, StartsFromALatticeInASlabWhereRadiiAreAlike) {
  const Mesh slab = test::make_box({0, 0, 0}, {12, 12, 1});
  const Packing packing = pack(slab, {0, 0, 0.3, 0.3});
  EXPECT_TRUE(
      std::ranges::all_of(packing.spheres, [](const Sphere& s) { return s.kind == SphereKind::lattice; }));
  EXPECT_GT(total_volume(packing) / 144, 0.39);
  const Packing others = pack(slab, {0, 0, 0.2, 0.3});
  EXPECT_TRUE(
      std::ranges::none_of(others.spheres, [](const Sphere& s) { return s.kind == SphereKind::lattice; }));
}

// How spheres of a face-centred cubic lattice lie: layers along `up` half a cube apart, and in each layer four
// neighbours at right angles, as far away as those of the next layer.
void expect_level_squares(const Packing& packing, std::size_t up, std::size_t least_count) {
  const PackingLimits& limits = packing.limits;
  const double apart = 2 * limits.max_radius + limits.gap, layer = apart / std::numbers::sqrt2;
  const auto height = [&](const Sphere& s) { return std::array{s.centre.x, s.centre.y, s.centre.z}[up]; };
  std::vector<Sphere> lattice;
  std::ranges::copy_if(packing.spheres, std::back_inserter(lattice),
                       [](const Sphere& s) { return s.kind == SphereKind::lattice; });
  ASSERT_GE(lattice.size(), least_count);
  std::size_t level = 0, slanting = 0, most_beside = 0;
  for (const Sphere& s : lattice) {
    EXPECT_NEAR(s.radius, limits.max_radius, 1e-6);
    const double layers = (height(s) - height(lattice.front())) / layer;
    EXPECT_NEAR(layers, std::round(layers), 1e-6);
    std::size_t beside = 0;
    for (const Sphere& t : lattice) {
      const double distance = length(t.centre - s.centre);
      if (&t == &s || distance > 1.01 * apart) continue;
      EXPECT_NEAR(distance, apart, 1e-6);
      const double rise = std::abs(height(t) - height(s));
      // Faces towards these stand, and towards those lean by 45 degrees.
      EXPECT_TRUE(rise < 1e-6 || std::abs(rise - layer) < 1e-6) << rise;
      beside += rise < 1e-6 ? 1 : 0;
      (rise < 1e-6 ? level : slanting) += 1;
    }
    most_beside = std::max(most_beside, beside);
  }
  EXPECT_EQ(most_beside, 4U);
  EXPECT_GT(level, lattice.size());
  EXPECT_GT(slanting, lattice.size());
}

TEST(Adaptive, StartsFromSquareLayersThatAreLevelWhicheverAxisIsUp) {
  const Mesh box = test::make_box({1, -2, 3}, {27, 30, 27});
  for (std::size_t axis = 0; axis < 3; ++axis) {
    for (const double sign : {1.0, -1.0}) {
      std::array<double, 3> up{};
      up[axis] = sign;
      PackingLimits limits{1, 0.6, 1.5, 2.5};
      limits.roof.up = {up[0], up[1], up[2]};
      limits.in_level_squares = true;
      const Packing packing = pack(box, limits);
      expect_level_squares(packing, axis, 40);
      expect_limits_held(box, packing);
      expect_same_bytes(pack(box, limits, {}, DeviceRequest::Kind::cpu_one_thread), packing);
    }
  }
}

// Without them a lattice has to be small against the model; level squares stand however few they are.
TEST(Adaptive, LevelSquaresAreAskedFor) {
  const Mesh box = test::make_box({0, 0, 0}, {24, 24, 24});
  PackingLimits limits{1, 0.6, 2, 4};
  const auto on_lattice = [&] {
    const Packing packing = pack(box, limits);
    return std::ranges::count(packing.spheres, SphereKind::lattice, &Sphere::kind);
  };
  EXPECT_EQ(on_lattice(), 0);
  limits.in_level_squares = true;
  EXPECT_GE(on_lattice(), 8);
  // Only along an axis of the model.
  limits.roof.up = normalised(Vec3d{1, 0, 1});
  EXPECT_EQ(on_lattice(), 0);
}

TEST(Adaptive, FillsABoxThatIsAWholeNumberOfDiametersWide) {
  const Mesh cube = test::make_box({0, 0, 0}, {10, 10, 10});
  const Packing packing = pack(cube, {0, 0, 0.45, 0.5});
  // Square layers of ten by ten and nine by nine, 13 of them.
  EXPECT_GE(packing.spheres.size(), 1180U);
  expect_limits_held(cube, packing);
}

TEST(Adaptive, BallsOfTheLargestRadiusComeToRestWhereNoLatticeFits) {
  const Mesh bracket = make_bracket();
  const Packing packing = pack(bracket, {0, 0.2, 2.0, 2.2});
  EXPECT_TRUE(
      std::ranges::none_of(packing.spheres, [](const Sphere& s) { return s.kind == SphereKind::lattice; }));
  expect_limits_held(bracket, packing);
  for (const Sphere& s : packing.spheres) {
    if (s.radius < 2.2 * (1 - 1e-3)) continue;
    int touched = 0;
    for (const Sphere& t : packing.spheres) {
      if (&t != &s && length(s.centre - t.centre) < s.radius + t.radius + 0.2 + 0.01) ++touched;
    }
    if (test::distance_to_surface(bracket, s.centre) < s.radius + 0.01) ++touched;
    EXPECT_GE(touched, 1) << s.centre.x << ' ' << s.centre.y << ' ' << s.centre.z;
  }
}

// Where nothing was placed since nothing was found there.
TEST(Adaptive, LooksForRestOnlyWhereABallCameNear) {
  const Mesh slab = test::make_box({0, 0, 0}, {24, 24, 1});
  const Packing packing = pack(slab, {0, 0, 0.3, 0.4});
  EXPECT_GT(packing.spheres.size(), 800U);
  EXPECT_LT(packing.statistics.candidates, 100 * packing.spheres.size());
}

TEST(Adaptive, PlacesSpheresOfOneSizeWhereNoLatticeFits) {
  struct Case {
    Mesh mesh;
    PackingLimits limits;
    std::size_t least;
  };
  const Roof roof = make_roof({.degrees = 45, .bridge = 3, .up = {0, 0, 1}});
  for (const Case& c : {Case{test::make_box({0, 0, 0}, {30, 30, 30}), {0, 0, 6, 6}, 8},
                        Case{test::make_box({0, 0, 0}, {30, 30, 30}), {1, 0.5, 5.9999, 6}, 8},
                        Case{test::make_box({0, 0, 0}, {30, 30, 30}), {1, 0.5, 5, 5, roof}, 4},
                        Case{make_bracket(), {0.3, 0.2, 2.2, 2.2}, 20}}) {
    const Packing packing = verify_packing(SurfaceIndex(c.mesh), pack(c.mesh, c.limits));
    EXPECT_GE(packing.spheres.size(), c.least);
    EXPECT_EQ(packing.statistics.dropped_by_verification, 0U);
    for (const Sphere& s : packing.spheres) EXPECT_GE(s.radius, c.limits.min_radius * (1 - 2e-9));
  }
}

// In its middle the clearance is above the largest radius everywhere.
TEST(Adaptive, FillsASlabThickerThanItsLargestSpheres) {
  const Mesh slab = test::make_box({0, 0, 0}, {12, 12, 1});
  for (const double min_radius : {0.3, 0.4}) {
    const Packing packing = verify_packing(SurfaceIndex(slab), pack(slab, {0, 0, min_radius, 0.4}));
    EXPECT_GT(total_volume(packing) / 144, 0.37);
    EXPECT_EQ(packing.statistics.dropped_by_verification, 0U);
  }
}

TEST(Adaptive, LeavesOverlapsOfPartsAlone) {
  const Mesh parts =
      test::join(test::make_box({0, 0, 0}, {10, 10, 10}), test::make_box({6, 0, 0}, {20, 10, 10}));
  expect_limits_held(parts, pack(parts, {0.5, 0.5, 0.7, kInfinity}));
}

TEST(Adaptive, HoldsItsLimitsInOddModels) {
  const Mesh far_away = test::make_box({123456, -98765, 100000}, {123486, -98745, 100012});
  const Mesh needle = test::make_box({0, 0, 0}, {2.5f, 2.5f, 300});
  // A ball within a ball within a ball: the middle one is hollow.
  const Mesh shells = test::join(
      test::join(test::make_uv_sphere(15, 20, 40), test::turned_inside_out(test::make_uv_sphere(10, 16, 32))),
      test::make_uv_sphere(8, 16, 32));
  // A sheet without thickness in a block, and facets without area.
  Mesh flawed = test::make_box({0, 0, 0}, {20, 20, 20});
  const auto first = static_cast<std::uint32_t>(flawed.positions.size());
  flawed.positions.insert(flawed.positions.end(), {{5, 5, 10}, {15, 5, 10}, {10, 15, 10}});
  for (const Triangle& t : std::vector<Triangle>{{0, 1, 2}, {0, 2, 1}, {0, 0, 1}, {2, 2, 2}, {0, 1, 0}}) {
    flawed.triangles.push_back({first + t[0], first + t[1], first + t[2]});
  }
  for (const Mesh& mesh : {far_away, needle, shells, flawed}) {
    expect_limits_held(mesh, pack(mesh, {0, 0, 0.9, kInfinity}));
    expect_limits_held(mesh, pack(mesh, {0.3, 0.2, 0.6, 1.2}));
  }
}

TEST(Adaptive, KeepsTheWallToACrackThinnerThanAnyCell) {
  // A slit 1 micrometre wide, from above almost to the ground.
  const Mesh block = test::make_box({0, 0, 0}, {20, 20, 20});
  const Mesh slit = test::turned_inside_out(test::make_box({9.9995f, -1, 2}, {10.0005f, 21, 21}));
  const Mesh cracked = test::join(block, slit);
  const Packing packing = pack(cracked, {1.2, 0.8, 1.0, kInfinity});
  expect_limits_held(cracked, packing);
  for (const Sphere& s : packing.spheres) {
    if (s.centre.z > 2) {
      EXPECT_GE(std::abs(s.centre.x - 10) - s.radius, 1.199);
    }
  }
}

TEST(Adaptive, KeepsTheWallOfTheDragonWithItsCrack) {
  const std::filesystem::path path = std::filesystem::path(AERATE_SHARED) / "models/dragon-47k-100mm.stl";
  if (!std::filesystem::exists(path)) GTEST_SKIP() << path << " is not there";
  const Mesh dragon = read_binary_stl(path);
  const Packing packing = pack(dragon, {1.2, 0.8, 1.5, kInfinity});
  expect_limits_held(dragon, packing);
  EXPECT_GT(total_volume(packing) / signed_volume(dragon), 0.335);
}

TEST(Adaptive, GivesNothingWhereNothingFits) {
  const Mesh cube = test::make_box({0, 0, 0}, {10, 10, 10});
  EXPECT_TRUE(pack(cube, {4.0, 0, 1.5, kInfinity}).spheres.empty());
  EXPECT_TRUE(pack(cube, {20.0, 0, 1.5, kInfinity}).spheres.empty());
  EXPECT_TRUE(pack({}, {0, 0, 1.5, kInfinity}).spheres.empty());
}

TEST(Adaptive, RefusesLimitsThatContradictOrNeverEnd) {
  const Mesh cube = test::make_box({0, 0, 0}, {10, 10, 10});
  EXPECT_THROW(pack(cube, {0, 0, 0, kInfinity}), UsageError);
  EXPECT_THROW(pack(cube, {-1, 0, 1, kInfinity}), UsageError);
  EXPECT_THROW(pack(cube, {0, 0, 2, 1}), UsageError);
  EXPECT_THROW(pack(cube, {0, 0, 0, 0}), UsageError);
  EXPECT_THROW(pack(cube, {0, 0, 1, kInfinity}, {.target_density = 1.5}), UsageError);
  EXPECT_NO_THROW(pack(cube, {0, 0, 0, kInfinity}, {.max_count = 3}));
}

}  // namespace
}  // namespace aerate
