#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <random>
#include <stdexcept>
#include <tbb/global_control.h>
#include <vector>

#include "core/error.h"
#include "kernels/exec_cpu.h"
#include "kernels/power_cells.h"
#include "packing/packing_cells.h"
#include "tests/support/balls.h"
#include "tests/support/packing_of.h"
#include "tests/support/same_cells.h"

namespace aerate {
namespace {

using kernels::Ball;
using kernels::power_cells;
using kernels::SerialExecutor;

constexpr Box3d kBox{{-3, 1, 10}, {7, 11, 20}};

CellPlanes cells_in_box(const std::vector<Ball>& balls, double gap, const Box3d& box = kBox) {
  return power_cells(SerialExecutor{}, balls, gap, box);
}

// How far a point is beyond the plane between two balls that is moved in.
double beyond_plane(const Ball& own, const Ball& other, double gap, Vec3d p) {
  const double distance = length(other.centre - own.centre);
  const double a = own.radius + gap / 2, b = other.radius + gap / 2;
  const Vec3d normal = (other.centre - own.centre) * (1 / distance);
  return dot(normal, p - own.centre) - ((distance * distance + a * a - b * b) / (2 * distance) - gap / 2);
}

double beyond_all(const std::vector<Ball>& balls, std::size_t i, double gap, Vec3d p) {
  double most = -1e9;
  for (std::size_t j = 0; j < balls.size(); ++j) {
    if (j != i) most = std::max(most, beyond_plane(balls[i], balls[j], gap, p));
  }
  return most;
}

double beyond_faces(const CellPlanes& cells, std::size_t i, Vec3d p) {
  double most = -1e9;
  for (const CellPlane& plane : cells.of(i)) most = std::max(most, dot(plane.normal, p) - plane.offset);
  return most;
}

bool holds(const Box3d& box, Vec3d p) {
  return min_of(box.lower, p) == box.lower && max_of(box.upper, p) == box.upper;
}

// A point of the box at about the cell's surface.
Vec3d point_about(const std::vector<Ball>& balls, std::size_t i, double gap, const Box3d& box,
                  std::mt19937& random) {
  const Vec3d far = test::random_point(random, box);
  double inside = 0, outside = 1;
  for (int step = 0; step < 30; ++step) {
    const double middle = (inside + outside) / 2;
    (beyond_all(balls, i, gap, balls[i].centre + (far - balls[i].centre) * middle) <= 0 ? inside : outside) =
        middle;
  }
  std::uniform_real_distribution<double> share(0.8, 1.2);
  const Vec3d p = balls[i].centre + (far - balls[i].centre) * (inside * share(random));
  return min_of(max_of(p, box.lower), box.upper);
}

// The faces alone against the planes of all n - 1, at random points of the box and at some near the surface
// of the cell; the boxes hold what is inside before faces are moved in.
void expect_cells_of_all_planes(const std::vector<Ball>& balls, double gap, const Box3d& box = kBox) {
  constexpr double kTolerance = 1e-7;
  const CellPlanes cells = cells_in_box(balls, gap, box);
  ASSERT_EQ(cells.size(), balls.size());
  ASSERT_EQ(cells.first.size(), balls.size() + 1);
  ASSERT_EQ(cells.first.back(), cells.planes.size());
  std::mt19937 random(3);
  for (std::size_t i = 0; i < balls.size(); ++i) {
    std::uint32_t last = 0;
    for (const CellPlane& plane : cells.of(i)) {
      ASSERT_NEAR(length(plane.normal), 1, 1e-14);
      ASSERT_NE(plane.neighbour, i);
      ASSERT_TRUE(&plane == cells.of(i).data() || plane.neighbour > last);
      last = plane.neighbour;
      const Vec3d on_plane = plane.normal * plane.offset;
      ASSERT_NEAR(beyond_plane(balls[i], balls[plane.neighbour], gap, on_plane), 0, 1e-11);
    }
    for (int k = 0; k < 40; ++k) {
      const Vec3d p = k < 10 ? test::random_point(random, box) : point_about(balls, i, gap, box, random);
      const double all = beyond_all(balls, i, gap, p), faces = beyond_faces(cells, i, p);
      ASSERT_LE(faces, all + 1e-11);
      if (faces <= 0) {
        ASSERT_LE(all, kTolerance) << "cell " << i;
      }
      if (all <= gap / 2) {
        ASSERT_TRUE(holds(cells.boxes[i], p)) << "cell " << i;
      }
    }
  }
}

std::vector<Ball> random_balls(std::size_t count, double smallest, double largest, double gap,
                               unsigned seed) {
  std::vector<Ball> balls;
  test::add_random_balls(balls, count, kBox, smallest, largest, gap, seed);
  return balls;
}

TEST(PowerCells, AreWhatAllPlanesLeave) {
  expect_cells_of_all_planes(random_balls(300, 0.1, 0.5, 0, 1), 0);
  expect_cells_of_all_planes(random_balls(300, 0.1, 0.5, 0.1, 2), 0.1);
  expect_cells_of_all_planes(random_balls(50, 0.3, 2, 0.4, 3), 0.4);
  for (unsigned seed = 4; seed < 24; ++seed) {
    expect_cells_of_all_planes(random_balls(2 + seed % 5, 0.1, 3, 0.5, seed), 0.5);
  }
}

TEST(PowerCells, AreWhatAllPlanesLeaveForRadiiOfAllSizes) {
  std::vector<Ball> balls{{{1, 5, 15}, 2.5}, {{5, 9, 18}, 1}};
  test::add_random_balls(balls, 60, kBox, 0.1, 0.6, 0.01, 5);
  test::add_random_balls(balls, 500, kBox, 0.001, 0.1, 0.01, 6);
  expect_cells_of_all_planes(balls, 0.01);
}

TEST(PowerCells, OfFlatAndLongModels) {
  const Box3d flat{{0, 0, 0}, {30, 30, 1}}, rod{{0, 0, 0}, {1, 100, 1}};
  for (const Box3d& box : {flat, rod}) {
    std::vector<Ball> balls;
    test::add_random_balls(balls, 100, box, 0.1, 0.3, 0.02, 7);
    expect_cells_of_all_planes(balls, 0.02, box);
    for (Ball& ball : balls) ball.centre.x = ball.centre.z = 0.5;
    std::vector<Ball> row;
    for (int i = 0; i < 50; ++i) row.push_back({{0.5, 0.5 + i * (box.upper.y - 1) / 49, 0.5}, 0.25});
    expect_cells_of_all_planes(row, 0.02, box);
    const CellPlanes cells = cells_in_box(row, 0.02, box);
    for (std::size_t i = 0; i < row.size(); ++i) {
      EXPECT_EQ(cells.of(i).size(), i == 0 || i + 1 == row.size() ? 1U : 2U);
    }
  }
}

TEST(PowerCells, OfNothingAndOfOneBallHaveNoPlanes) {
  EXPECT_EQ(cells_in_box({}, 0.1).size(), 0U);
  EXPECT_EQ(cells_in_box({}, 0.1).first, std::vector<std::uint32_t>{0});
  const CellPlanes one = cells_in_box({{{1, 2, 15}, 0.5}}, 0.1);
  ASSERT_EQ(one.size(), 1U);
  EXPECT_TRUE(one.of(0).empty());
  EXPECT_EQ(one.boxes[0].lower, kBox.lower);
  EXPECT_EQ(one.boxes[0].upper, kBox.upper);
}

TEST(PowerCells, OfTwoBallsAreHalvesOfTheBoxApart) {
  const CellPlanes two = cells_in_box({{{0, 5, 15}, 1}, {{4, 5, 15}, 2}}, 0.5);
  ASSERT_EQ(two.of(0).size(), 1U);
  ASSERT_EQ(two.of(1).size(), 1U);
  // 16 + 1.25^2 - 2.25^2 = 12.5 of 8
  EXPECT_EQ(two.of(0)[0].neighbour, 1U);
  EXPECT_EQ(two.of(0)[0].normal, (Vec3d{1, 0, 0}));
  EXPECT_NEAR(two.of(0)[0].offset, 1.5625 - 0.25, 1e-14);
  EXPECT_EQ(two.of(1)[0].neighbour, 0U);
  EXPECT_NEAR(two.of(1)[0].offset, -1.5625 - 0.25, 1e-14);
  EXPECT_NEAR(two.boxes[0].upper.x, 1.5625, 1e-6);
  EXPECT_GE(two.boxes[0].upper.x, 1.5625);
  EXPECT_EQ(two.boxes[1].upper.x, kBox.upper.x);
}

TEST(PowerCells, OfAFaceCentredLatticeAreRhombicDodecahedra) {
  for (const double cube : {2.0, 0.7310585786300049}) {
    const std::vector<Ball> balls = test::face_centred_balls(4, cube);
    const Box3d box{{0, 0, 0}, {4 * cube, 4 * cube, 4 * cube}};
    const CellPlanes cells = cells_in_box(balls, 0, box);
    std::size_t inner = 0;
    for (std::size_t i = 0; i < balls.size(); ++i) {
      const Vec3d c = balls[i].centre, m{cube, cube, cube};
      if (!holds({box.lower + m, box.upper - m}, c)) continue;
      ++inner;
      ASSERT_EQ(cells.of(i).size(), 12U) << "cell " << i;
      for (const CellPlane& plane : cells.of(i)) {
        EXPECT_NEAR(plane.offset - dot(plane.normal, c), balls[i].radius, 1e-12);
      }
    }
    EXPECT_EQ(inner, 32U);
    expect_cells_of_all_planes(balls, 0, box);
  }
}

// Touching balls in layers A B A B: trapezo-rhombic dodecahedra.
TEST(PowerCells, OfAHexagonalLatticeHaveTwelveFaces) {
  std::vector<Ball> balls;
  constexpr int kCount = 7;
  for (int z = 0; z < kCount; ++z) {
    for (int y = 0; y < kCount; ++y) {
      for (int x = 0; x < kCount; ++x) {
        const double shift = z % 2 == 0 ? 0 : 1;
        balls.push_back({{1 + 2 * x + (y % 2) + shift, 1 + std::sqrt(3.0) * y + shift / std::sqrt(3.0),
                          1 + std::sqrt(8.0 / 3) * z},
                         1});
      }
    }
  }
  const Box3d box{{0, 0, 0}, {16, 14, 13}};
  const CellPlanes cells = cells_in_box(balls, 0, box);
  std::size_t inner = 0;
  for (std::size_t i = 0; i < balls.size(); ++i) {
    const Vec3d m{3.5, 3.5, 3.5};
    if (!holds({box.lower + m, box.upper - m}, balls[i].centre)) continue;
    ++inner;
    EXPECT_EQ(cells.of(i).size(), 12U) << "cell " << i;
  }
  EXPECT_GT(inner, 15U);
  expect_cells_of_all_planes(balls, 0, box);
}

TEST(PowerCells, OfACubicLatticeAreCubes) {
  std::vector<Ball> balls;
  for (int i = 0; i < 6 * 6 * 6; ++i) balls.push_back({{i % 6 + 0.5, i / 6 % 6 + 0.5, i / 36 + 0.5}, 0.4});
  const Box3d box{{0, 0, 0}, {6, 6, 6}};
  const CellPlanes cells = cells_in_box(balls, 0.2, box);
  for (std::size_t i = 0; i < balls.size(); ++i) {
    std::size_t inward = 0;
    for (const double x : {balls[i].centre.x, balls[i].centre.y, balls[i].centre.z}) {
      inward += x > 1 && x < 5 ? 2 : 1;
    }
    ASSERT_EQ(cells.of(i).size(), inward) << "cell " << i;
  }
  expect_cells_of_all_planes(balls, 0.2, box);
}

TEST(PowerCells, OfALargeBallAmidSmallOnesHasAllItsFaces) {
  std::vector<Ball> balls{{{2, 6, 15}, 3}};
  std::mt19937 random(9);
  std::normal_distribution<double> normal;
  while (balls.size() < 501) {
    const double x = normal(random), y = normal(random), z = normal(random);
    const Vec3d c = balls[0].centre + normalised(Vec3d{x, y, z}) * 3.15;
    const bool free = std::all_of(balls.begin() + 1, balls.end(),
                                  [c](const Ball& ball) { return length(ball.centre - c) >= 0.2; });
    if (free) balls.push_back({c, 0.1});
  }
  const CellPlanes cells = cells_in_box(balls, 0.05);
  EXPECT_EQ(cells.of(0).size(), 500U);
  expect_cells_of_all_planes(balls, 0.05);
}

TEST(PowerCells, FacesAreThoseOfBothSides) {
  std::vector<Ball> balls = random_balls(400, 0.05, 0.8, 0.02, 12);
  for (const Ball& ball : test::face_centred_balls(3, 1.0)) {
    const Ball moved{ball.centre + kBox.lower, 0.3};
    const bool free = std::all_of(balls.begin(), balls.end(), [&](const Ball& other) {
      return length(other.centre - moved.centre) >= other.radius + moved.radius + 0.02;
    });
    if (free) balls.push_back(moved);
  }
  const CellPlanes cells = cells_in_box(balls, 0.02);
  for (std::uint32_t i = 0; i < balls.size(); ++i) {
    for (const CellPlane& plane : cells.of(i)) {
      const std::span<const CellPlane> others = cells.of(plane.neighbour);
      EXPECT_TRUE(std::any_of(others.begin(), others.end(),
                              [i](const CellPlane& other) { return other.neighbour == i; }))
          << i << " and " << plane.neighbour;
    }
  }
}

TEST(PowerCells, AreTheSameForAnyNumberOfThreads) {
  std::vector<Ball> balls{{{2, 6, 15}, 3}};
  test::add_random_balls(balls, 3000, kBox, 0.01, 0.2, 0.01, 13);
  const CellPlanes serial = cells_in_box(balls, 0.01);
  EXPECT_GT(serial.of(0).size(), 100U);
  for (const std::size_t threads : {1U, 2U, 8U}) {
    const tbb::global_control control(tbb::global_control::max_allowed_parallelism, threads);
    test::expect_same_cells(power_cells(kernels::TbbExecutor{}, balls, 0.01, kBox), serial);
  }
}

TEST(PowerCells, RefusesWhatHasNone) {
  const auto refused = [](const std::vector<Ball>& balls, double gap, const Box3d& box) {
    try {
      cells_in_box(balls, gap, box);
    } catch (const std::invalid_argument& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  const Ball ball{{0, 5, 15}, 1};
  EXPECT_EQ(refused({ball}, 0, kBox), "");
  EXPECT_NE(refused({ball, {{9, 5, 15}, 1}}, 0, kBox).find("ball 1 is outside"), std::string::npos);
  EXPECT_NE(refused({ball, {{1, 5, std::nan("")}, 1}}, 0, kBox).find("ball 1"), std::string::npos);
  EXPECT_NE(refused({ball, {{4, 5, 15}, 0}}, 0, kBox).find("ball 1 has no size"), std::string::npos);
  EXPECT_NE(refused({ball}, -1, kBox).find("gap"), std::string::npos);
  EXPECT_NE(refused({ball}, 0, {kBox.lower, kBox.lower}).find("box"), std::string::npos);
  EXPECT_NE(refused({ball, {{4, 5, 15}, 1}, {{4, 5.1, 15}, 2}}, 0, kBox).find("balls"), std::string::npos);
  EXPECT_NE(refused({ball, ball}, 0, kBox).find("overlap"), std::string::npos);
}

TEST(CellsOf, APackingAreThoseOfItsSpheresAndGap) {
  const std::vector<Ball> balls = random_balls(200, 0.1, 0.5, 0.1, 14);
  std::vector<Sphere> spheres;
  for (const Ball& ball : balls) spheres.push_back({ball.centre, ball.radius, SphereKind::adaptive});
  Packing packing = test::packing_of(spheres);
  packing.limits.gap = 0.1;
  Monitor monitor;
  for (const auto kind : {DeviceRequest::Kind::cpu, DeviceRequest::Kind::cpu_one_thread}) {
    test::expect_same_cells(cells_of(packing, kBox, {.kind = kind}, monitor), cells_in_box(balls, 0.1));
  }
  packing.spheres.push_back(packing.spheres.front());
  EXPECT_THROW(cells_of(packing, kBox, {.kind = DeviceRequest::Kind::cpu}, monitor), FailureError);
}

TEST(CellsOf, APackingCanBeInterrupted) {
  class Stopped : public Monitor {
   public:
    void check_interrupted() override { throw InterruptedError(); }
  } monitor;
  const Packing packing = test::packing_of({{{0, 5, 15}, 1, SphereKind::adaptive}});
  EXPECT_THROW(cells_of(packing, kBox, {.kind = DeviceRequest::Kind::cpu}, monitor), InterruptedError);
}

}  // namespace
}  // namespace aerate
