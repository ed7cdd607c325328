#include <cmath>
#include <gtest/gtest.h>
#include <numbers>
#include <random>
#include <tbb/global_control.h>

#include "core/error.h"
#include "core/monitor.h"
#include "packing/sphere_pairs.h"
#include "packing/verify.h"
#include "tests/support/clearance.h"
#include "tests/support/shapes.h"

namespace aerate {
namespace {

std::vector<Sphere> random_spheres(std::size_t count, double smallest, double largest, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> coordinate(-10, 10);
  std::uniform_real_distribution<double> exponent(std::log(smallest), std::log(largest));
  std::vector<Sphere> spheres;
  for (std::size_t i = 0; i < count; ++i) {
    const double x = coordinate(random), y = coordinate(random), z = coordinate(random);
    spheres.push_back({{x, y, z}, std::exp(exponent(random)), SphereKind::adaptive});
  }
  return spheres;
}

TEST(SpherePairs, AreThoseOfBruteForceForRadiiOfAllSizes) {
  for (const double reach : {0.0, 0.3, 5.0}) {
    const std::vector<Sphere> spheres = random_spheres(1500, 0.002, 4.0, 11);
    std::vector<SpherePair> expected;
    for (std::uint32_t i = 0; i < spheres.size(); ++i) {
      for (std::uint32_t j = i + 1; j < spheres.size(); ++j) {
        const double gap =
            length(spheres[j].centre - spheres[i].centre) - spheres[i].radius - spheres[j].radius;
        if (gap < reach) expected.push_back({i, j, gap});
      }
    }
    const std::vector<SpherePair> found = find_pairs_within(spheres, reach);
    ASSERT_GT(expected.size(), 100U);
    ASSERT_EQ(found.size(), expected.size());
    for (std::size_t i = 0; i < found.size(); ++i) {
      ASSERT_EQ(found[i].first, expected[i].first);
      ASSERT_EQ(found[i].second, expected[i].second);
      ASSERT_NEAR(found[i].gap, expected[i].gap, 1e-12);
    }
  }
}

TEST(Verify, DropsWhatBreaksWallGapOrIsOutsideAndKeepsTheRest) {
  const Mesh box = test::make_box({0, 0, 0}, {20, 20, 20});
  Packing packing;
  packing.limits = {1, 0.5, 0.5, 5};
  packing.spheres = {
      {{5, 5, 5}, 4, SphereKind::lattice},       // touches the wall's limit exactly
      {{15, 15, 15}, 4.1, SphereKind::lattice},  // 0.1 too near to three walls
      {{30, 5, 5}, 1, SphereKind::lattice},      // outside
      {{11, 5, 5}, 1.4, SphereKind::lattice},    // gap of 0.6 to the first
      {{5, 11, 5}, 1.6, SphereKind::lattice},    // gap of 0.4 to the first
      {{15, 5, 15}, 0.4, SphereKind::lattice},   // below the least radius
  };
  const Packing verified = verify_packing(SurfaceIndex(box), packing);
  ASSERT_EQ(verified.spheres.size(), 2U);
  EXPECT_EQ(verified.spheres[0].centre, packing.spheres[0].centre);
  EXPECT_EQ(verified.spheres[0].radius, 4.0);
  EXPECT_EQ(verified.spheres[1].centre, packing.spheres[3].centre);
  EXPECT_EQ(verified.statistics.dropped_by_verification, 4U);
  EXPECT_EQ(verified.statistics.shrunk_by_verification, 0U);
}

TEST(Verify, ShrinksWhatRoundingMadeTooLarge) {
  const Mesh box = test::make_box({0, 0, 0}, {20, 20, 20});
  Packing packing;
  packing.limits = {1, 0.5, 0.5, 5};
  packing.spheres = {{{5, 5, 5}, 4 + 1e-6, SphereKind::lattice},
                     {{15, 5, 5}, 4, SphereKind::lattice},
                     {{5, 11, 5}, 1.5 + 2e-6, SphereKind::lattice}};
  const Packing verified = verify_packing(SurfaceIndex(box), packing);
  ASSERT_EQ(verified.spheres.size(), 3U);
  EXPECT_EQ(verified.statistics.shrunk_by_verification, 2U);
  EXPECT_GE(test::smallest_wall(box, verified.spheres), 1.0);
  EXPECT_GE(test::smallest_gap(verified.spheres), 0.5);
}

TEST(Verify, DropsASphereWhereTwoPartsOverlap) {
  const Mesh mesh =
      test::join(test::make_box({0, 0, 0}, {10, 10, 10}), test::make_box({5, 0, 0}, {15, 10, 10}));
  Packing packing;
  packing.limits = {0, 0, 0, 5};
  packing.spheres = {{{2.5, 5, 5}, 2, SphereKind::lattice}, {{7.5, 5, 5}, 2, SphereKind::lattice}};
  const Packing verified = verify_packing(SurfaceIndex(mesh), packing);
  ASSERT_EQ(verified.spheres.size(), 1U);
  EXPECT_EQ(verified.spheres[0].centre.x, 2.5);
}

TEST(FindFault, NamesTheFirstSphereThatBreaksALimit) {
  const Mesh mesh =
      test::join(test::make_box({0, 0, 0}, {20, 20, 20}), test::make_box({15, 0, 0}, {35, 20, 20}));
  Packing packing;
  packing.limits = {1, 0.5, 0.5, 5};
  packing.spheres = {{{5, 5, 5}, 4, SphereKind::lattice}};
  EXPECT_FALSE(find_fault(SurfaceIndex(mesh), packing).has_value());

  const auto fault_with = [&](Vec3d centre, double radius) {
    Packing changed = packing;
    changed.spheres.push_back({centre, radius, SphereKind::lattice});
    changed.spheres.push_back({{100, 0, 0}, 1, SphereKind::lattice});
    return find_fault(SurfaceIndex(mesh), changed);
  };
  const auto wall = fault_with({5, 15, 15}, 4.5);
  ASSERT_TRUE(wall.has_value());
  EXPECT_EQ(wall->kind, PackingFault::Kind::wall);
  EXPECT_EQ(wall->sphere, 1U);
  EXPECT_NEAR(wall->clearance, 0.5, 1e-12);
  const auto gap = fault_with({5, 12, 5}, 2.75);
  ASSERT_TRUE(gap.has_value());
  EXPECT_EQ(gap->kind, PackingFault::Kind::gap);
  EXPECT_EQ(gap->other, 0U);
  EXPECT_NEAR(gap->clearance, 0.25, 1e-12);
  EXPECT_EQ(fault_with({17.5, 10, 10}, 1)->kind, PackingFault::Kind::overlapped_region);
  EXPECT_EQ(fault_with({50, 10, 10}, 1)->kind, PackingFault::Kind::outside);
}

TEST(Verify, IsTheSameForAnyNumberOfThreads) {
  const Mesh torus = test::make_torus(9, 4, 64, 32);
  Packing packing;
  packing.limits = {0.1, 0.05, 0.1, 4};
  packing.spheres = random_spheres(4000, 0.1, 1.0, 5);
  std::vector<std::vector<Sphere>> results;
  for (const std::size_t threads : {1U, 2U, 8U}) {
    const tbb::global_control control(tbb::global_control::max_allowed_parallelism, threads);
    results.push_back(verify_packing(SurfaceIndex(torus), packing).spheres);
  }
  ASSERT_GT(results[0].size(), 100U);
  for (const std::vector<Sphere>& result : results) {
    ASSERT_EQ(result.size(), results[0].size());
    for (std::size_t i = 0; i < result.size(); ++i) {
      EXPECT_EQ(result[i].centre, results[0][i].centre);
      EXPECT_EQ(result[i].radius, results[0][i].radius);
    }
  }
  EXPECT_GE(test::smallest_gap(results[0]), packing.limits.gap);
  EXPECT_GE(test::smallest_wall(torus, results[0]), packing.limits.wall);
}

TEST(Clearances, AreMeasuredExactly) {
  const Mesh box = test::make_box({0, 0, 0}, {20, 20, 20});
  const std::vector<Sphere> spheres = {{{5, 5, 5}, 3, SphereKind::lattice},
                                       {{15, 5, 5}, 1, SphereKind::lattice}};
  const Clearances clearances = measure_clearances(SurfaceIndex(box), spheres);
  EXPECT_DOUBLE_EQ(clearances.wall, 2.0);
  ASSERT_TRUE(clearances.gap.has_value());
  EXPECT_DOUBLE_EQ(*clearances.gap, 6.0);
  EXPECT_FALSE(measure_clearances(SurfaceIndex(box), std::span(spheres).first(1)).gap.has_value());
}

}  // namespace
}  // namespace aerate
