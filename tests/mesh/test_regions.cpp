#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <numbers>
#include <string>

#include "core/surface_index.h"
#include "mesh/common.h"
#include "mesh/inspect.h"
#include "mesh/pressed.h"
#include "mesh/primitives.h"
#include "tests/support/shapes.h"

// Bodies that regions are made of, and what of them is in a model.
namespace aerate::test {
namespace {

// Closed and outward; a model's point is in it, or not.
void expect_closed(const Mesh& mesh) {
  const Inspection found = inspect(mesh);
  EXPECT_TRUE(found.closed());
  EXPECT_EQ(found.non_manifold_edges, 0U);
  EXPECT_EQ(found.degenerate_triangles, 0U);
  EXPECT_EQ(found.shells.size(), 1U);
  EXPECT_GT(found.volume, 0);
}

// How far from an axis the nearest of the planes of triangles that face away from it is.
double least_plane_distance(const Mesh& mesh, Vec3d from) {
  double least = 1e9;
  for (const Triangle& t : mesh.triangles) {
    const kernels::Facet facet = facet_of(mesh, t);
    const Vec3d a = to_double(facet.a);
    least = std::min(least, dot(a - from, normalised(cross(to_double(facet.b) - a, to_double(facet.c) - a))));
  }
  return least;
}

double farthest_vertex(const Mesh& mesh, Vec3d from) {
  double farthest = 0;
  for (const Vec3f p : mesh.positions) farthest = std::max(farthest, length(to_double(p) - from));
  return farthest;
}

TEST(Regions, ABallMeshHoldsItsBall) {
  for (const Vec3d centre : {Vec3d{0, 0, 0}, Vec3d{100.3, -7.1, 3000.7}}) {
    const Mesh mesh = ball_mesh(centre, 2.7);
    expect_closed(mesh);
    EXPECT_GE(least_plane_distance(mesh, centre), 2.7);
    EXPECT_LE(farthest_vertex(mesh, centre), 2.7 * 1.005 + 0.002);
  }
}

TEST(Regions, ACylinderMeshHoldsItsCylinder) {
  const Vec3d start{1, 2, 3}, end{4, -2, 9};
  const Mesh mesh = cylinder_mesh(start, end, 1.3);
  expect_closed(mesh);
  const double height = length(end - start);
  // Seen from the middle, ends are half the height away.
  EXPECT_GE(least_plane_distance(mesh, (start + end) * 0.5), 1.3);
  EXPECT_LE(farthest_vertex(mesh, (start + end) * 0.5), std::hypot(height / 2, 1.3 * 1.003) + 1e-4);
  const double least = std::numbers::pi * 1.3 * 1.3 * height;
  EXPECT_GE(signed_volume(mesh), least);
  EXPECT_LE(signed_volume(mesh), least * 1.003);
}

// Its sides are no fp32 numbers: none lies inside.
TEST(Regions, ABoxMeshHoldsItsBox) {
  const Vec3d lower{-0.1, 1.0 / 3, 7.7}, upper{2.3, 4.1, 1234.5678};
  const Mesh mesh = box_mesh(lower, upper);
  expect_closed(mesh);
  const Box3f box = bounding_box(mesh);
  for (const auto along : {&Vec3d::x, &Vec3d::y, &Vec3d::z}) {
    EXPECT_LE(to_double(box.lower).*along, lower.*along);
    EXPECT_GE(to_double(box.upper).*along, upper.*along);
    EXPECT_NEAR(to_double(box.upper).*along, upper.*along, 2e-4);
  }
}

TEST(Regions, WhatIsBeyondABoxIsPressedOntoIt) {
  const Mesh ball = ball_mesh({0, 0, 0}, 10);
  const Box3f box{{-4, -20, -5}, {20, 3, 6}};
  const Mesh pressed = pressed_into(box, ball);
  EXPECT_TRUE(inspect(pressed).closed());
  const Box3f reached = bounding_box(pressed);
  EXPECT_EQ(reached.lower.x, -4);
  EXPECT_EQ(reached.lower.z, -5);
  EXPECT_EQ(reached.upper.y, 3);
  EXPECT_LE(reached.upper.x, 10.1F);
  const SurfaceIndex before(ball), after(pressed);
  for (int i = 0; i < 5000; ++i) {
    const auto part = [&](double step, double lower, double upper) {
      const double share = std::fmod(step * i, 1);
      return lower + (upper - lower) * share;
    };
    const Vec3d p{part(0.7548776662, -3.99, 12), part(0.5698402909, -12, 2.99),
                  part(0.618033988, -4.99, 5.99)};
    EXPECT_EQ(after.winding().winding_number(p), before.winding().winding_number(p));
  }
}

TEST(Regions, OfASurfaceOnlyWhatIsInTheModelIsTaken) {
  const SurfaceIndex model(make_box({0, 0, 0}, {30, 30, 30}));
  const auto area_within = [&](const Mesh& mesh) { return surface_area(surface_within(mesh, model, 0.1)); };
  const Mesh inside = ball_mesh({15, 15, 15}, 5);
  EXPECT_EQ(surface_within(inside, model, 0.1).triangles.size(), inside.triangles.size());
  EXPECT_EQ(area_within(ball_mesh({15, 15, 40}, 5)), 0);
  EXPECT_EQ(area_within(make_box({-5, -5, -5}, {35, 35, 35})), 0);
  // A block through the top: its sides below that, and its bottom.
  EXPECT_NEAR(area_within(make_box({10, 10, 20}, {14, 14, 50})), 16 + 4 * 4 * 10, 4 * 4 * 0.1);
  for (const Vec3f p : surface_within(make_box({10, 10, 20}, {14, 14, 50}), model, 0.1).positions)
    EXPECT_LE(p.z, 30.1F);
  // Its top in the model's.
  EXPECT_NEAR(area_within(make_box({10, 10, 20}, {14, 14, 30})), 2 * 16 + 4 * 4 * 10, 1e-3);
}

TEST(Regions, TheVolumeInCommonLeavesOutWhatWasCounted) {
  const SurfaceIndex model(make_box({0, 0, 0}, {30, 30, 30}));
  const SurfaceIndex through(make_box({10, 10, 20}, {14, 14, 50})),
      beside(make_box({12, 10, 25}, {18, 14, 28})), outside(make_box({30.5, 0, 0}, {40, 30, 30}));
  EXPECT_NEAR(common_volume(through.winding(), model.winding(), {}), 160, 0.5);
  const std::vector counted{through.winding()};
  EXPECT_NEAR(common_volume(beside.winding(), model.winding(), counted), 4 * 4 * 3, 0.5);
  EXPECT_EQ(common_volume(outside.winding(), model.winding(), {}), 0);
}

}  // namespace
}  // namespace aerate::test
