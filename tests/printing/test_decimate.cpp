#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <gtest/gtest.h>
#include <map>
#include <tuple>
#include <vector>

#include "printing/cells/decimate.h"
#include "tests/support/clearance.h"
#include "tests/support/closed_shells.h"
#include "tests/support/shapes.h"

namespace aerate {
namespace {

Decimated decimated(const std::vector<Vec3d>& positions, const std::vector<Triangle>& triangles,
                    double tolerance) {
  Monitor silent;
  SharedWork work(silent);
  return decimate(positions, triangles, tolerance, work);
}

// What is beside a vertex that went may move a bit farther away from it, by later steps.
constexpr double kAbout = 1.3;

struct Surface {
  std::vector<Vec3d> positions;
  std::vector<Triangle> triangles;
};

// A cube of 10 mm about the origin, each face in `count` x `count` squares.
Surface fine_cube(std::uint32_t count) {
  Surface cube;
  std::map<std::tuple<double, double, double>, std::uint32_t> known;
  const auto vertex = [&](Vec3d p) {
    const auto [found, is_new] =
        known.try_emplace({p.x, p.y, p.z}, static_cast<std::uint32_t>(cube.positions.size()));
    if (is_new) cube.positions.push_back(p);
    return found->second;
  };
  const auto at = [&](std::uint32_t i) { return -5 + 10.0 * i / count; };
  for (int axis = 0; axis < 3; ++axis) {
    for (const int side : {0, 1}) {
      for (std::uint32_t i = 0; i < count; ++i) {
        for (std::uint32_t j = 0; j < count; ++j) {
          const auto corner = [&](std::uint32_t u, std::uint32_t v) {
            const double height = side == 0 ? -5 : 5;
            const double x = at(i + u), y = at(j + v);
            return vertex(axis == 0   ? Vec3d{height, x, y}
                          : axis == 1 ? Vec3d{y, height, x}
                                      : Vec3d{x, y, height});
          };
          const std::uint32_t a = corner(0, 0), b = corner(1, 0), c = corner(1, 1), d = corner(0, 1);
          cube.triangles.push_back(side == 1 ? Triangle{a, b, c} : Triangle{a, c, b});
          cube.triangles.push_back(side == 1 ? Triangle{a, c, d} : Triangle{a, d, c});
        }
      }
    }
  }
  return cube;
}

// The same on a sphere of that radius.
Surface fine_sphere(double radius, std::uint32_t count) {
  Surface sphere = fine_cube(count);
  for (Vec3d& p : sphere.positions) p = normalised(p) * radius;
  return sphere;
}

Surface surface_of(const Mesh& mesh) {
  Surface surface{{}, mesh.triangles};
  for (const Vec3f& p : mesh.positions) surface.positions.push_back(to_double(p));
  return surface;
}

Mesh mesh_of(const Surface& surface, const Decimated& fewer) {
  Mesh mesh;
  for (const std::uint32_t v : fewer.vertices) mesh.positions.push_back(to_float(surface.positions[v]));
  mesh.triangles = fewer.triangles;
  return mesh;
}

// How far a vertex of the surface is from what was left of it, at most.
double farthest(const Surface& surface, const Mesh& left) {
  double most = 0;
  for (const Vec3d p : surface.positions) most = std::max(most, test::distance_to_surface(left, p));
  return most;
}

// Closed, of as many holes as before, with vertices of the surface's own, and no farther from them than it may.
Mesh expect_good(const Surface& surface, const Decimated& fewer, double tolerance, long euler) {
  EXPECT_TRUE(std::ranges::is_sorted(fewer.vertices));
  EXPECT_EQ(std::ranges::adjacent_find(fewer.vertices), fewer.vertices.end());
  Mesh left = mesh_of(surface, fewer);
  EXPECT_TRUE(test::is_closed_manifold(left));
  EXPECT_EQ(test::euler_characteristic(left), euler);
  EXPECT_LE(farthest(surface, left), kAbout * tolerance + 1e-5);  // fp32
  return left;
}

TEST(Decimate, ASphereStaysWithinTheTolerance) {
  const Surface sphere = fine_sphere(10, 24);
  std::size_t before = sphere.triangles.size();
  for (const double tolerance : {0.03, 0.06, 0.2, 1.0}) {
    SCOPED_TRACE(tolerance);
    const Decimated fewer = decimated(sphere.positions, sphere.triangles, tolerance);
    const Mesh left = expect_good(sphere, fewer, tolerance, 2);
    EXPECT_LT(left.triangles.size(), before);
    before = left.triangles.size();
    // All faces still look outwards.
    EXPECT_TRUE(test::is_star_shaped(left, {0, 0, 0}));
    EXPECT_GT(signed_volume(left), 4.18879 * std::pow(10 - 2 * tolerance, 3));
  }
  EXPECT_LT(before, 200U);
}

TEST(Decimate, FlatFacesComeDownToAFewTriangles) {
  const Surface cube = fine_cube(32);
  EXPECT_EQ(cube.triangles.size(), 12288U);
  const Decimated fewer = decimated(cube.positions, cube.triangles, 0.01);
  const Mesh left = expect_good(cube, fewer, 0.01, 2);
  EXPECT_LE(left.triangles.size(), 120U);
  EXPECT_NEAR(signed_volume(left), 1000, 3);
}

TEST(Decimate, ATorusKeepsItsHole) {
  const Surface torus = surface_of(test::make_torus(10, 3, 80, 40));
  for (const double tolerance : {0.05, 0.5, 5.0}) {
    SCOPED_TRACE(tolerance);
    const Decimated fewer = decimated(torus.positions, torus.triangles, tolerance);
    const Mesh left = expect_good(torus, fewer, tolerance, 0);
    EXPECT_LT(left.triangles.size(), 2 * torus.triangles.size() / 3);
  }
}

// Poles with 80 triangles each.
TEST(Decimate, VerticesOfManyTrianglesAreLeftAlone) {
  const Surface sphere = surface_of(test::make_uv_sphere(10, 40, 80));
  expect_good(sphere, decimated(sphere.positions, sphere.triangles, 0.1), 0.1, 2);
}

TEST(Decimate, NothingSmallerThanATetrahedronIsLeft) {
  const Surface box = surface_of(test::make_box({0, 0, 0}, {1, 1, 1}));
  const Decimated fewer = decimated(box.positions, box.triangles, 100);
  EXPECT_TRUE(test::is_closed_manifold(mesh_of(box, fewer)));
  EXPECT_GE(fewer.triangles.size(), 4U);
}

TEST(Decimate, TwoShellsStayTwo) {
  const Surface two = surface_of(
      test::join(test::make_uv_sphere(5, 20, 30), test::moved(test::make_uv_sphere(5, 20, 30), {20, 0, 0})));
  const Mesh left = expect_good(two, decimated(two.positions, two.triangles, 0.2), 0.2, 4);
  EXPECT_LT(left.triangles.size(), two.triangles.size());
}

TEST(Decimate, WithoutAToleranceACurvedSurfaceStays) {
  const Surface sphere = fine_sphere(10, 8);
  const Decimated fewer = decimated(sphere.positions, sphere.triangles, 0);
  EXPECT_EQ(fewer.vertices.size(), sphere.positions.size());
  EXPECT_EQ(fewer.triangles, sphere.triangles);
}

TEST(Decimate, WithoutAToleranceNothingMoves) {
  const Surface cube = fine_cube(8);
  expect_good(cube, decimated(cube.positions, cube.triangles, 0), 0, 2);
}

TEST(Decimate, IsTheSameEachTime) {
  const Surface sphere = fine_sphere(10, 16);
  const Decimated first = decimated(sphere.positions, sphere.triangles, 0.1);
  const Decimated second = decimated(sphere.positions, sphere.triangles, 0.1);
  EXPECT_EQ(first.vertices, second.vertices);
  EXPECT_EQ(first.triangles, second.triangles);
}

TEST(Decimate, FarFromTheOriginItIsAsGood) {
  Surface sphere = fine_sphere(10, 16);
  const std::size_t near = decimated(sphere.positions, sphere.triangles, 0.1).triangles.size();
  for (Vec3d& p : sphere.positions) p = p + Vec3d{1e5, -2e5, 3e5};
  const Decimated far = decimated(sphere.positions, sphere.triangles, 0.1);
  EXPECT_NEAR(static_cast<double>(far.triangles.size()), static_cast<double>(near),
              0.05 * static_cast<double>(near));
}

TEST(Decimate, NothingComesOfNothing) {
  const Decimated none = decimated({}, {}, 1);
  EXPECT_TRUE(none.vertices.empty());
  EXPECT_TRUE(none.triangles.empty());
}

}  // namespace
}  // namespace aerate
