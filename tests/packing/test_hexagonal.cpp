#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <map>
#include <numbers>

#include "core/error.h"
#include "kernels/exec_cpu.h"
#include "kernels/hexagonal_packing.h"
#include "kernels/hexagonal_strips.h"
#include "packing/hexagonal.h"
#include "tests/support/clearance.h"
#include "tests/support/hexagonal_input.h"
#include "tests/support/shapes.h"

namespace aerate {
namespace {

double density(const Mesh& mesh, const Packing& packing) {
  return total_volume(packing) / signed_volume(mesh);
}

std::map<SphereKind, std::size_t> count_kinds(const Packing& packing) {
  std::map<SphereKind, std::size_t> kinds;
  for (const Sphere& sphere : packing.spheres) ++kinds[sphere.kind];
  return kinds;
}

// Every place of the scheme, tested against every triangle and without any index, in the order of the result.
std::vector<Sphere> pack_by_brute_force(const Mesh& mesh, const PackingLimits& limits) {
  const Box3f box_f = bounding_box(mesh);
  const Box3d box{to_double(box_f.lower), to_double(box_f.upper)};
  const double lattice_radius = limits.max_radius + limits.gap / 2;
  const kernels::HexagonalLattice lattice = kernels::make_hexagonal_lattice(box, lattice_radius);
  const auto radius_of = [&](double relative) { return relative * lattice_radius - limits.gap / 2; };
  const auto is_candidate = [&](Vec3d c) {
    return c.x > box.lower.x && c.x < box.upper.x && c.y > box.lower.y && c.y < box.upper.y &&
           c.z > box.lower.z && c.z < box.upper.z && test::winding_number(mesh, c) == 1;
  };
  const auto fits = [&](Vec3d c, double radius) {
    return radius >= limits.min_radius && test::distance_to_surface(mesh, c) >= radius + limits.wall;
  };
  std::vector<Sphere> kept;
  std::vector<Vec3d> replaced;
  const auto try_place = [&](Vec3d c, double relative, SphereKind kind) {
    if (!is_candidate(c)) return;
    if (fits(c, radius_of(relative))) {
      kept.push_back({c, radius_of(relative), kind});
    } else if (kind == SphereKind::lattice) {
      replaced.push_back(c);
    } else if (kind == SphereKind::tetrahedral && fits(c, radius_of(kernels::kInterstice))) {
      kept.push_back({c, radius_of(kernels::kInterstice), SphereKind::interstice});
    }
  };
  for (std::uint32_t i = 0; i < lattice.cell_count() * kernels::kLatticePerCell; ++i) {
    try_place(lattice.lattice_position(i), 1.0, SphereKind::lattice);
  }
  for (std::uint32_t i = 0; i < lattice.cell_count() * kernels::kIntersticesPerCell; ++i) {
    try_place(lattice.interstice_position(i), kernels::kInterstice, SphereKind::interstice);
  }
  for (std::uint32_t i = 0; i < lattice.cell_count() * kernels::kTetrahedralPerCell; ++i) {
    try_place(lattice.tetrahedral_position(i), kernels::kTetrahedral, SphereKind::tetrahedral);
  }
  for (const Vec3d& c : replaced) {
    for (const Vec3d& q : kernels::kCentresOf61InUnitSphere) {
      try_place(c + q * lattice_radius, kernels::kRadiusOf61InUnitSphere, SphereKind::replacement);
    }
  }
  return kept;
}

void expect_same_spheres(const std::vector<Sphere>& a, const std::vector<Sphere>& b,
                         double radius_tolerance) {
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    ASSERT_EQ(a[i].centre, b[i].centre) << "sphere " << i;
    ASSERT_EQ(a[i].kind, b[i].kind) << "sphere " << i;
    ASSERT_NEAR(a[i].radius, b[i].radius, radius_tolerance) << "sphere " << i;
  }
}

TEST(SixtyOneSpheres, AreDisjointInsideTheUnitSphere) {
  double smallest_distance = 2;
  for (std::size_t i = 0; i < 61; ++i) {
    const Vec3d a = kernels::kCentresOf61InUnitSphere[i];
    EXPECT_LE(length(a) + kernels::kRadiusOf61InUnitSphere, 1.0);
    for (std::size_t j = 0; j < i; ++j) {
      smallest_distance = std::min(smallest_distance, length(a - kernels::kCentresOf61InUnitSphere[j]));
    }
  }
  EXPECT_GE(smallest_distance, 2 * kernels::kRadiusOf61InUnitSphere);
}

TEST(Hexagonal, EqualsBruteForceWithAllFourKinds) {
  const Mesh torus = test::make_torus(5, 2, 48, 24);
  Monitor monitor;
  for (const PackingLimits& limits : {PackingLimits{0, 0, 0, 0.6}, PackingLimits{0.2, 0.1, 0.05, 0.7}}) {
    const Packing packing = pack_hexagonal(torus, limits, monitor);
    EXPECT_EQ(count_kinds(packing).size(), 4U);
    expect_same_spheres(packing.spheres, pack_by_brute_force(torus, limits), 1e-12);
  }
}

// A fan of long diagonal slivers, as lathe-turned parts have them: entered by bounding boxes, they would fill
// the index.
TEST(Hexagonal, IndexesLongDiagonalTrianglesInLinearMemory) {
  constexpr std::uint32_t kSides = 20000;
  Mesh disc;
  for (std::uint32_t i = 0; i < kSides; ++i) {
    const double angle = 2 * std::numbers::pi * i / kSides;
    for (const double height : {0.0, 30.0}) {
      disc.positions.push_back(to_float({40 * std::cos(angle), 40 * std::sin(angle), height}));
    }
  }
  disc.positions.push_back({0, 0, 0});
  disc.positions.push_back({0, 0, 30});
  for (std::uint32_t i = 0; i < kSides; ++i) {
    const std::uint32_t a = 2 * i, b = 2 * ((i + 1) % kSides);
    disc.triangles.push_back({a, b, b + 1});
    disc.triangles.push_back({a, b + 1, a + 1});
    disc.triangles.push_back({2 * kSides, b, a});
    disc.triangles.push_back({2 * kSides + 1, a + 1, b + 1});
  }
  Monitor monitor;
  const Packing packing = pack_hexagonal(disc, {1, 0.5, 0.1, 3}, monitor);
  EXPECT_GT(density(disc, packing), 0.3);
  EXPECT_LT(packing.statistics.index_bytes, std::size_t{100} << 20);
}

TEST(Hexagonal, KeepsWallAndGapExactly) {
  const Mesh torus = test::make_torus(20, 8, 96, 48);
  Monitor monitor;
  const PackingLimits limits{1.2, 0.8, 0.1, 3.0};
  const Packing packing = pack_hexagonal(torus, limits, monitor);
  ASSERT_GT(packing.spheres.size(), 100U);
  EXPECT_GE(test::smallest_wall(torus, packing.spheres), limits.wall);
  EXPECT_GE(test::smallest_gap(packing.spheres), limits.gap);
  EXPECT_LT(test::smallest_gap(packing.spheres), limits.gap + 1e-9)
      << "lattice spheres should touch up to the gap";
}

// What the paper's kinds fill of space (docs/packing.md): the ceiling that a large box comes near to.
TEST(Hexagonal, FillsABoxNearlyToTheSchemesCeiling) {
  const Mesh box = test::make_box({0, 0, 0}, {10, 10, 10});
  Monitor monitor;
  const Packing packing = pack_hexagonal(box, {0, 0, 0, 0.2}, monitor);
  EXPECT_GT(density(box, packing), 0.70);
  EXPECT_LT(density(box, packing), 0.763);
}

TEST(Hexagonal, DropsAndCountsSpheresBelowTheLeastRadius) {
  const Mesh box = test::make_box({0, 0, 0}, {10, 10, 10});
  Monitor monitor;
  const Packing all = pack_hexagonal(box, {0, 0, 0, 1.0}, monitor);
  const Packing large = pack_hexagonal(box, {0, 0, 0.2, 1.0}, monitor);
  EXPECT_GT(count_kinds(all)[SphereKind::interstice], 0U);
  EXPECT_EQ(count_kinds(large)[SphereKind::interstice], 0U);
  EXPECT_GT(count_kinds(large)[SphereKind::tetrahedral], 0U) << "0.2247 mm is not below 0.2 mm";
  EXPECT_EQ(all.statistics.below_min_radius, 0U);
  EXPECT_GE(large.statistics.below_min_radius, count_kinds(all)[SphereKind::interstice] / 2);
  EXPECT_EQ(all.statistics.candidates, large.statistics.candidates);
}

TEST(Hexagonal, ASphereExactlyAsLargeAsTheLimitIsKept) {
  const Mesh box = test::make_box({0, 0, 0}, {10, 10, 10});
  Monitor monitor;
  const Packing packing = pack_hexagonal(box, {0, 0.1, 1.0, 1.0}, monitor);
  EXPECT_GT(packing.spheres.size(), 10U);
}

TEST(Hexagonal, PutsNothingWhereTwoPartsOverlap) {
  const Mesh mesh =
      test::join(test::make_box({0, 0, 0}, {10, 10, 10}), test::make_box({5, 5, 5}, {15, 15, 15}));
  Monitor monitor;
  const Packing packing = pack_hexagonal(mesh, {0, 0, 0, 0.7}, monitor);
  EXPECT_GT(packing.statistics.overlapped_region, 0U);
  ASSERT_GT(packing.spheres.size(), 100U);
  for (const Sphere& sphere : packing.spheres) EXPECT_EQ(test::winding_number(mesh, sphere.centre), 1);
}

TEST(Hexagonal, IsTheSameOnOneThreadAndOnAll) {
  const Mesh torus = test::make_torus(5, 2, 200, 100);
  Monitor monitor;
  const PackingLimits limits{0.1, 0.05, 0.01, 0.3};
  const Packing serial =
      pack_hexagonal(torus, limits, monitor, {.kind = DeviceRequest::Kind::cpu_one_thread});
  const Packing parallel = pack_hexagonal(torus, limits, monitor, {.kind = DeviceRequest::Kind::cpu});
  ASSERT_GT(serial.spheres.size(), 1000U);
  expect_same_spheres(serial.spheres, parallel.spheres, 0.0);
}

TEST(Hexagonal, IsTheSameInSlabsOfAnySize) {
  const Mesh torus = test::make_torus(5, 2, 48, 24);
  const kernels::HexagonalInput whole = test::hexagonal_input(torus, 0.6);
  const kernels::HexagonalResult expected = kernels::HexagonalPacking::pack(kernels::SerialExecutor{}, whole);
  ASSERT_GT(expected.spheres.size(), 1000U);
  for (const std::size_t most_slots : {std::size_t{1}, std::size_t{500}, std::size_t{777}}) {
    kernels::HexagonalInput slabs = whole;
    slabs.most_slots = most_slots;
    const kernels::HexagonalResult result = kernels::HexagonalPacking::pack(kernels::SerialExecutor{}, slabs);
    EXPECT_LE(result.slots_at_a_time, std::max<std::size_t>(most_slots, kernels::kReplacements));
    expect_same_spheres(result.spheres, expected.spheres, 0.0);
    EXPECT_EQ(result.state_counts, expected.state_counts);
  }
}

// Tilted, so that strips along y cut through it and facets lie across them.
TEST(Hexagonal, IsTheSameInStripsOfTheModel) {
  Mesh tilted = test::make_torus(5, 2, 48, 24);
  for (Vec3f& p : tilted.positions) p = {p.x, 0.8f * p.y - 0.6f * p.z, 0.6f * p.y + 0.8f * p.z};
  const kernels::HexagonalInput input = test::hexagonal_input(tilted, 0.5);
  const kernels::HexagonalResult expected = kernels::HexagonalPacking::pack(kernels::SerialExecutor{}, input);
  ASSERT_GT(expected.spheres.size(), 1000U);
  const std::uint32_t rows = kernels::make_hexagonal_lattice(input.box, 0.5).count_y;
  for (const std::uint32_t strips : {2U, 3U, rows}) {
    const kernels::HexagonalResult result =
        kernels::pack_hexagonal_in_strips(kernels::TbbExecutor{}, input, strips);
    EXPECT_EQ(result.strips, strips);
    expect_same_spheres(result.spheres, expected.spheres, 0.0);
    EXPECT_EQ(result.state_counts, expected.state_counts);
    EXPECT_LT(result.index_bytes, expected.index_bytes);
  }
}

TEST(Hexagonal, EstimateCoversWhatIsKeptAndRefusesTheAbsurd) {
  const Mesh box = test::make_box({0, 0, 0}, {10, 10, 10});
  Monitor monitor;
  const PackingLimits limits{0, 0, 0, 0.2};
  const Packing packing = pack_hexagonal(box, limits, monitor);
  EXPECT_GE(hexagonal_method().memory(box, limits, {}).bytes,
            static_cast<double>(packing.spheres.size() * sizeof(Sphere) + packing.statistics.index_bytes));
  EXPECT_GT(hexagonal_method().memory(box, {0, 0, 0, 1e-4}, {}).bytes, 1e15);
  EXPECT_THROW(pack_hexagonal(box, {0, 0, 0, 1e-4}, monitor), FailureError);
}

}  // namespace
}  // namespace aerate
