#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <gtest/gtest.h>
#include <numbers>
#include <set>
#include <string>
#include <tbb/global_control.h>
#include <tuple>
#include <utility>
#include <vector>

#include "core/ceiling.h"
#include "core/error.h"
#include "core/facet_distance.h"
#include "core/overhang.h"
#include "core/surface_index.h"
#include "kernels/triangle_bvh.h"
#include "packing/packing_cells.h"
#include "printing/cells/shape_cells.h"
#include "tests/support/blocks.h"
#include "tests/support/caught.h"
#include "tests/support/clearance.h"
#include "tests/support/closed_shells.h"
#include "tests/support/shapes.h"

namespace aerate {
namespace {

constexpr double kWall = 2, kGap = 1;
// Round edges of the model that point into a void, triangles are moved away from these to keep the wall.
constexpr double kAbout = 1.6;
constexpr CellShape kShape{.fillet = 1, .tolerance = 0.05};

Packing packing_of(std::vector<Sphere> spheres) {
  Packing packing;
  packing.spheres = std::move(spheres);
  packing.limits = {.wall = kWall, .gap = kGap, .min_radius = 2.5, .max_radius = 20};
  return packing;
}

Sphere ball(Vec3d centre, double radius) {
  return {centre, radius, SphereKind::adaptive};
}

CellPlanes planes_of(const Mesh& model, const Packing& packing) {
  Monitor silent;
  const Box3f box = bounding_box(model);
  return cells_of(packing, {to_double(box.lower), to_double(box.upper)}, {}, silent);
}

CellVoids shaped(const Mesh& model, const Packing& packing, const CellShape& shape = kShape) {
  Monitor silent;
  return shape_cells(SurfaceIndex(model), packing, planes_of(model, packing), shape, silent);
}

double volume_of(const CellVoid& piece) {
  return -signed_volume(piece.surface);
}

// A box with all edges rounded: what a ball that rolls in it reaches.
double rounded_box_volume(Vec3d size, double radius) {
  const Vec3d core = size - Vec3d{2, 2, 2} * radius;
  return core.x * core.y * core.z + 2 * radius * (core.x * core.y + core.y * core.z + core.z * core.x) +
         std::numbers::pi * radius * radius * (core.x + core.y + core.z) +
         4.0 / 3.0 * std::numbers::pi * radius * radius * radius;
}

double distance_between_surfaces(const Mesh& a, const Mesh& b, double limit) {
  const kernels::HostTriangleBvh bvh(b.positions, b.triangles);
  double least = limit;
  for (const Triangle& t : a.triangles)
    least = std::min(least, distance_to_surface(facet_of(a, t), bvh.view(), least));
  return least;
}

// Nodes are where the surface says, and about as many as it holds.
void expect_nodes_within(const CellVoids& cells, const CellVoid& piece) {
  double count = 0;
  std::size_t outside = 0;
  for (std::size_t i = 0; i < piece.nodes.size(); ++i) {
    const NodeRun& run = piece.nodes[i];
    EXPECT_LE(run.first, run.last);
    count += run.last - run.first + 1;
    if (i > 0) {
      const NodeRun& before = piece.nodes[i - 1];
      EXPECT_LT(std::tuple(before.z, before.y, before.last), std::tuple(run.z, run.y, run.first));
      EXPECT_FALSE(before.z == run.z && before.y == run.y && before.last + 1 >= run.first);
    }
    // Some of them, since each is held against all triangles.
    if (i % 7 != 0) continue;
    const std::int32_t middle = run.first + (run.last - run.first) / 2;
    outside += test::winding_number(piece.surface, cells.lattice.at(middle, run.y, run.z)) == -1 ? 0U : 1U;
  }
  // Nodes at the very surface may be a bit beyond it.
  EXPECT_LE(static_cast<double>(outside), 0.02 * static_cast<double>(piece.nodes.size()));
  const double cube = std::pow(cells.lattice.spacing, 3);
  EXPECT_NEAR(count * cube, volume_of(piece), 0.5 * cells.lattice.spacing * surface_area(piece.surface));
}

// What holds for all voids of cells, found out by brute force.
void expect_sound(const Mesh& model, const Packing& packing, const CellVoids& cells,
                  const CellShape& shape = kShape) {
  const PackingLimits& limits = packing.limits;
  EXPECT_EQ(cells.ball_radius, shape.fillet);
  for (std::size_t i = 0; i < cells.voids.size(); ++i) {
    SCOPED_TRACE("void " + std::to_string(i));
    const CellVoid& piece = cells.voids[i];
    EXPECT_LE(cells.voids[i == 0 ? 0 : i - 1].cell, piece.cell);
    EXPECT_TRUE(test::is_closed_manifold(piece.surface));
    EXPECT_EQ(test::euler_characteristic(piece.surface), piece.euler);
    EXPECT_GE(volume_of(piece), 1 - shape.tolerance * surface_area(piece.surface));
    EXPECT_LE(piece.deviation, kAbout * shape.tolerance);
    EXPECT_NEAR(volume_of(piece), piece.planned_volume, shape.tolerance * surface_area(piece.surface));
    for (const Vec3f& vertex : piece.surface.positions) {
      const Vec3d p = to_double(vertex);
      for (const CellPlane& plane : cells.planes.of(piece.cell))
        ASSERT_LE(dot(plane.normal, p), plane.offset + 1e-9);
      ASSERT_EQ(test::winding_number(model, p), 1);
    }
    for (const Triangle& t : piece.surface.triangles) {
      for (const Triangle& other : model.triangles) {
        ASSERT_GE(distance_between(facet_of(piece.surface, t), facet_of(model, other)), limits.wall - 1e-9);
      }
    }
    for (std::size_t j = 0; j < i; ++j)
      EXPECT_GE(distance_between_surfaces(piece.surface, cells.voids[j].surface, limits.gap), limits.gap);
    expect_nodes_within(cells, piece);
  }
}

TEST(ShapeCells, OneCellTakesAllThatIsDeeperThanTheWall) {
  const Mesh model = test::make_box({0, 0, 0}, {30, 30, 30});
  const Packing packing = packing_of({ball({15, 15, 15}, 13)});
  const CellVoids cells = shaped(model, packing);
  expect_sound(model, packing, cells);
  ASSERT_EQ(cells.voids.size(), 1U);
  EXPECT_EQ(cells.voids[0].euler, 2);
  const double expected = rounded_box_volume({26, 26, 26}, 1);
  EXPECT_LE(volume_of(cells.voids[0]), expected);
  EXPECT_GE(volume_of(cells.voids[0]), 0.995 * expected);
  // Flat to where edges are rounded.
  const Box3f box = bounding_box(cells.voids[0].surface);
  EXPECT_NEAR(box.lower.x, 2, 1e-4);
  EXPECT_NEAR(box.upper.z, 28, 1e-4);
  for (const Vec3f& p : cells.voids[0].surface.positions) {
    const Vec3d core = max_of(Vec3d{3, 3, 3}, min_of(Vec3d{27, 27, 27}, to_double(p)));
    EXPECT_LE(length(to_double(p) - core), 1 + 1e-6);
    EXPECT_GE(length(to_double(p) - core), 1 - kShape.tolerance);
  }
}

TEST(ShapeCells, FlatFacesTakeFewTriangles) {
  const Mesh model = test::make_box({0, 0, 0}, {30, 30, 30});
  const CellVoids cells = shaped(model, packing_of({ball({15, 15, 15}, 13)}));
  EXPECT_LT(cells.voids.at(0).surface.triangles.size(), 2500U);
}

TEST(ShapeCells, TheFilletRoundsInnerEdgesAlone) {
  const Mesh model = test::make_box({0, 0, 0}, {20, 20, 20});
  const Packing packing = packing_of({ball({10, 10, 10}, 8)});
  for (const double fillet : {0.5, 2.0, 4.0}) {
    const CellShape shape{.fillet = fillet, .tolerance = 0.1};
    const CellVoids cells = shaped(model, packing, shape);
    expect_sound(model, packing, cells, shape);
    ASSERT_EQ(cells.voids.size(), 1U);
    const double expected = rounded_box_volume({16, 16, 16}, fillet);
    EXPECT_LE(volume_of(cells.voids[0]), expected) << fillet;
    EXPECT_GE(volume_of(cells.voids[0]), 0.98 * expected) << fillet;
  }
}

// A sphere's own shape: a ball in a shell.
TEST(ShapeCells, InABallTheVoidIsABall) {
  const Mesh model = test::moved(test::make_uv_sphere(12, 40, 60), {20, 20, 20});
  const Packing packing = packing_of({ball({20, 20, 20}, 9.9)});
  const CellVoids cells = shaped(model, packing);
  ASSERT_EQ(cells.voids.size(), 1U);
  for (const Vec3f& p : cells.voids[0].surface.positions)
    ASSERT_GE(test::distance_to_surface(model, to_double(p)), kWall);
  const double expected = 4.0 / 3.0 * std::numbers::pi * 1000;
  EXPECT_LE(volume_of(cells.voids[0]), expected);
  EXPECT_GE(volume_of(cells.voids[0]), 0.96 * expected);
}

TEST(ShapeCells, APlaneWallAsThickAsTheGapPartsTwoCells) {
  const Mesh model = test::make_box({0, 0, 0}, {40, 40, 30});
  const std::vector<std::vector<Sphere>> pairs{
      {ball({10, 20, 15}, 8), ball({29, 20, 15}, 8)},          // across the box
      {ball({10, 20, 15}, 7), ball({28, 20, 15}, 9)},          // nearer to the smaller
      {ball({12, 11, 13}, 9), ball({27.7, 28.1, 16.3}, 10)}};  // aslant
  for (const std::vector<Sphere>& pair : pairs) {
    const Packing packing = packing_of(pair);
    const CellVoids cells = shaped(model, packing);
    expect_sound(model, packing, cells);
    ASSERT_EQ(cells.voids.size(), 2U);
    EXPECT_EQ(cells.voids[0].cell, 0U);
    EXPECT_EQ(cells.voids[1].cell, 1U);
    const Vec3d along = normalised(pair[1].centre - pair[0].centre);
    double farthest = -1e300, nearest = 1e300;
    for (const Vec3f& p : cells.voids[0].surface.positions)
      farthest = std::max(farthest, dot(along, to_double(p)));
    for (const Vec3f& p : cells.voids[1].surface.positions)
      nearest = std::min(nearest, dot(along, to_double(p)));
    EXPECT_GE(nearest - farthest, kGap - 1e-9);
    EXPECT_LT(nearest - farthest, kGap + 0.02);
    // Where the powers with respect to both spheres, each with half the gap, are the same.
    const double way = length(pair[1].centre - pair[0].centre);
    const auto square = [](const Sphere& sphere) { return std::pow(sphere.radius + kGap / 2, 2); };
    const double share = (way * way + square(pair[0]) - square(pair[1])) / (2 * way);
    EXPECT_NEAR((nearest + farthest) / 2, dot(along, pair[0].centre) + share, 0.01);
  }
}

// Spheres in the middles of boxes of 12 mm.
Packing grid_packing() {
  std::vector<Sphere> spheres;
  for (const double z : {6.0, 18.0, 30.0}) {
    for (const double y : {6.0, 18.0, 30.0}) {
      for (const double x : {6.0, 18.0, 30.0}) spheres.push_back(ball({x, y, z}, 4));
    }
  }
  return packing_of(std::move(spheres));
}

TEST(ShapeCells, AGridOfSpheresGivesAVoidForEach) {
  const Mesh model = test::make_box({0, 0, 0}, {36, 36, 36});
  const Packing packing = grid_packing();
  const CellVoids cells = shaped(model, packing);
  ASSERT_EQ(cells.voids.size(), 27U);
  expect_sound(model, packing, cells);
  for (std::uint32_t i = 0; i < 27; ++i) {
    const CellVoid& piece = cells.voids[i];
    EXPECT_EQ(piece.cell, i);
    EXPECT_EQ(piece.euler, 2);
    // Half a gap from other cells, a wall from the outside.
    const auto size = [](std::uint32_t at) { return at == 1 ? 11.0 : 9.5; };
    const double expected = rounded_box_volume({size(i % 3), size(i / 3 % 3), size(i / 9)}, 1);
    EXPECT_LE(volume_of(piece), expected);
    EXPECT_GE(volume_of(piece), 0.985 * expected);
  }
}

// Under a ridge as long as the cell: the section across it loses a triangle on either side. There voids of their own
// may be.
TEST(ShapeCells, ACeilingTooWideGetsARoofWhateverIsUp) {
  constexpr double kSide = 30, kInside = kSide - 2 * kWall, kBridge = 4;
  const Mesh model = test::make_box({0, 0, 0}, {kSide, kSide, kSide});
  for (const Vec3d up : {Vec3d{0, 0, 1}, Vec3d{0, 0, -1}, Vec3d{1, 0, 0}}) {
    SCOPED_TRACE(up.x + 2 * up.z);
    Packing packing = packing_of({ball({kSide / 2, kSide / 2, kSide / 2}, 12)});
    packing.limits.roof = make_roof({.degrees = 45, .bridge = kBridge, .up = up});
    const CellVoids cells = shaped(model, packing);
    ASSERT_FALSE(cells.voids.empty());
    expect_sound(model, packing, cells);
    double widest = 0;
    for (const CellVoid& piece : cells.voids) {
      for (const Ceiling& ceiling : ceilings_of(piece.surface, piece.surface.triangles, packing.limits.roof))
        widest = widest_disc(ceiling, widest);
    }
    EXPECT_LE(widest, kBridge + kShape.tolerance);
    EXPECT_GT(widest, kBridge / 2);
    const double beside = (kInside - kBridge) / 2;
    const double below_ridge =
        rounded_box_volume({kInside, kInside, kInside}, kShape.fillet) - beside * beside * kInside;
    EXPECT_GT(volume_of(cells.voids.front()), 0.94 * below_ridge);
    EXPECT_LT(volume_of(cells.voids.front()), 1.01 * below_ridge);
  }
}

// What leans by the overhang angle carries itself; a roof takes nothing from it.
TEST(ShapeCells, ACeilingThatCarriesItselfIsLeftAsItIs) {
  Mesh gable = test::make_box({0, 0, 0}, {30, 30, 30});
  for (Vec3f& p : gable.positions) p = {p.x, (p.y - p.z) * 0.75F, (p.y + p.z) * 0.75F};
  Packing packing = packing_of({ball({15, 0, 22.5}, 12)});
  const CellVoids free = shaped(gable, packing);
  packing.limits.roof = make_roof({.degrees = 45, .bridge = 4});
  const CellVoids roofed = shaped(gable, packing);
  ASSERT_EQ(roofed.voids.size(), 1);
  EXPECT_EQ(roofed.voids.front().surface.positions, free.voids.front().surface.positions);
}

TEST(ShapeCells, SameBytesForAnyThreadCount) {
  const Mesh model = test::moved(test::make_uv_sphere(18, 30, 40), {18, 18, 18});
  std::vector<Sphere> inside;
  for (const Sphere& sphere : grid_packing().spheres)
    if (length(sphere.centre - Vec3d{18, 18, 18}) < 13) inside.push_back({sphere.centre, 3.2, sphere.kind});
  const Packing packing = packing_of(inside);
  const CellShape shape{.fillet = 1, .tolerance = 0.1};
  CellVoids first;
  for (const std::size_t threads : {1U, 2U, 5U}) {
    const tbb::global_control control(tbb::global_control::max_allowed_parallelism, threads);
    CellVoids cells = shaped(model, packing, shape);
    if (threads == 1) first = cells;
    ASSERT_EQ(cells.voids.size(), first.voids.size());
    EXPECT_EQ(cells.voids.size(), 7U);
    for (std::size_t i = 0; i < cells.voids.size(); ++i) {
      const CellVoid &a = cells.voids[i], &b = first.voids[i];
      EXPECT_EQ(a.surface.positions, b.surface.positions) << threads << " threads";
      EXPECT_EQ(a.surface.triangles, b.surface.triangles) << threads << " threads";
      EXPECT_EQ(a.planned_volume, b.planned_volume) << threads << " threads";
      EXPECT_EQ(a.deviation, b.deviation) << threads << " threads";
      EXPECT_EQ(a.nodes.size(), b.nodes.size()) << threads << " threads";
    }
  }
}

// Two rooms, 20 mm and `small` mm wide, with a neck of that width and length between them.
Mesh dumbbell(float neck_width, float neck_length, float small = 20) {
  const auto middle = [](float width) { return std::pair{10 - width / 2, 10 + width / 2}; };
  std::set<float> across{
      0, 20, middle(neck_width).first, middle(neck_width).second, middle(small).first, middle(small).second};
  const std::vector<float> planes(across.begin(), across.end());
  const std::vector<float> along{0, 20, 20 + neck_length, 20 + neck_length + small};
  return test::make_blocks({along, planes, planes}, [&](int x, int y, int z) {
    const float width = x == 0 ? 20 : x == 1 ? neck_width : small;
    const auto is_in = [&](int i) {
      const float at = (planes[static_cast<std::size_t>(i)] + planes[static_cast<std::size_t>(i) + 1]) / 2;
      return at > middle(width).first && at < middle(width).second;
    };
    return is_in(y) && is_in(z);
  });
}

const Sphere kInFirstRoom = ball({10, 10, 10}, 8);

TEST(ShapeCells, ACellFallsApartWhereTheBallDoesNotPass) {
  const Packing packing = packing_of({kInFirstRoom});
  const Mesh narrow = dumbbell(5.8F, 6);  // leaves 1.8 mm between its walls
  const CellVoids two = shaped(narrow, packing);
  expect_sound(narrow, packing, two);
  ASSERT_EQ(two.voids.size(), 2U);
  for (const CellVoid& piece : two.voids) {
    EXPECT_EQ(piece.cell, 0U);
    EXPECT_EQ(piece.euler, 2);
    EXPECT_GE(volume_of(piece), 0.98 * rounded_box_volume({16, 16, 16}, 1));
  }
  EXPECT_LT(bounding_box(two.voids[0].surface).upper.x, 23);

  const Mesh wide = dumbbell(6.4F, 6);
  const CellVoids one = shaped(wide, packing);
  expect_sound(wide, packing, one);
  ASSERT_EQ(one.voids.size(), 1U);
  EXPECT_EQ(one.voids[0].euler, 2);
  EXPECT_GT(bounding_box(one.voids[0].surface).upper.x, 40);
}

TEST(ShapeCells, ThePiecesOfACellAreSortedBySize) {
  const Mesh model = dumbbell(5.8F, 6, 14);
  Packing packing = packing_of({ball({33, 10, 10}, 5)});  // in the smaller room
  const CellVoids cells = shaped(model, packing);
  expect_sound(model, packing, cells);
  ASSERT_EQ(cells.voids.size(), 2U);
  EXPECT_GT(volume_of(cells.voids[0]), 2 * volume_of(cells.voids[1]));
}

TEST(ShapeCells, APieceTakesABallOfTheLeastRadius) {
  const Mesh model = dumbbell(5.8F, 6, 10);  // 6 mm between the smaller room's walls
  Packing packing = packing_of({kInFirstRoom});
  packing.limits.min_radius = 2.65;  // as nodes tell it
  EXPECT_EQ(shaped(model, packing).voids.size(), 2U);
  packing.limits.min_radius = 3.1;
  EXPECT_EQ(shaped(model, packing).voids.size(), 1U);
}

TEST(ShapeCells, APieceHasACubicMillimetre) {
  Packing packing = packing_of({kInFirstRoom});
  packing.limits.min_radius = 0.4;
  const CellShape shape{.fillet = 0.4, .tolerance = 0.1};
  // 0.9 mm wide, and 1.3 mm.
  EXPECT_EQ(shaped(dumbbell(4.5F, 6, 4.9F), packing, shape).voids.size(), 1U);
  EXPECT_EQ(shaped(dumbbell(4.5F, 6, 5.3F), packing, shape).voids.size(), 2U);
}

// A thin plate with a hole that is just too narrow for the ball: it would come to the plate from both sides.
TEST(ShapeCells, PiecesOfOneCellKeepTheGap) {
  const Mesh model = dumbbell(5.924F, 0.587F, 14);
  for (const double gap : {1.0, 2.0, 3.0}) {
    SCOPED_TRACE(gap);
    Packing packing = packing_of({kInFirstRoom});
    packing.limits.gap = gap;
    const CellVoids cells = shaped(model, packing);
    expect_sound(model, packing, cells);
    ASSERT_EQ(cells.voids.size(), 2U);
    EXPECT_LT(distance_between_surfaces(cells.voids[0].surface, cells.voids[1].surface, 20), gap + 2.5);
  }
}

// A block of 42 x 42 x 14 mm with a hole of 14 mm through its middle.
Mesh block_with_hole() {
  const std::vector<float> across{0, 14, 28, 42};
  return test::make_blocks({across, across, {0, 14}}, [](int x, int y, int) { return x != 1 || y != 1; });
}

TEST(ShapeCells, AVoidRoundAHoleIsARing) {
  const Mesh model = block_with_hole();
  const Packing packing = packing_of({ball({7, 7, 7}, 5)});
  const CellVoids cells = shaped(model, packing);
  expect_sound(model, packing, cells);
  ASSERT_EQ(cells.voids.size(), 1U);
  EXPECT_EQ(cells.voids[0].euler, 0);
  EXPECT_GT(volume_of(cells.voids[0]), 10 * (38 * 38 - 18 * 18) * 0.97);
}

// Two pillars: walls round two thin holes through the block.
TEST(ShapeCells, EachPillarInAVoidIsATunnel) {
  const std::vector<float> along{0, 12, 13, 26, 27, 40}, across{0, 12, 13, 25};
  const Mesh model = test::make_blocks({along, across, {0, 16}},
                                       [](int x, int y, int) { return y != 1 || (x != 1 && x != 3); });
  const Packing packing = packing_of({ball({6, 6, 8}, 4)});
  const CellVoids cells = shaped(model, packing);
  expect_sound(model, packing, cells);
  ASSERT_EQ(cells.voids.size(), 1U);
  EXPECT_EQ(cells.voids[0].euler, -2);
}

// What is round a cavity is solid on all sides, here with no other cell's walls to hold it: a wall is kept to it.
TEST(ShapeCells, SolidRoundACavityIsNotLeftLoose) {
  const Mesh model = test::join(test::make_box({0, 0, 0}, {30, 30, 30}),
                                test::turned_inside_out(test::make_box({13, 13, 13}, {17, 17, 17})));
  const Packing packing = packing_of({ball({15, 15, 6.5}, 4)});
  const CellVoids cells = shaped(model, packing);
  expect_sound(model, packing, cells);
  ASSERT_EQ(cells.voids.size(), 1U);
  EXPECT_EQ(cells.voids[0].euler, 2);
}

TEST(ShapeCells, NothingIsMadeWherePartsOverlap) {
  const Mesh model =
      test::join(test::make_box({0, 0, 0}, {30, 20, 20}), test::make_box({18, 0, 0}, {48, 20, 20}));
  const Packing packing = packing_of({ball({9, 10, 10}, 6)});
  const CellVoids cells = shaped(model, packing);
  expect_sound(model, packing, cells);
  ASSERT_EQ(cells.voids.size(), 2U);  // before the overlap, and behind it
  for (const CellVoid& piece : cells.voids) {
    const Box3f box = bounding_box(piece.surface);
    EXPECT_TRUE(box.upper.x <= 16 || box.lower.x >= 32);
    EXPECT_GE(volume_of(piece), 0.98 * rounded_box_volume({14, 16, 16}, 1));
  }
}

// A part that lies wholly in another: where they overlap stays solid, with a wall round it.
TEST(ShapeCells, APartWithinAnotherStaysSolid) {
  const Mesh model =
      test::join(test::make_box({0, 0, 0}, {40, 20, 20}), test::make_box({18, 4, 4}, {34, 16, 16}));
  const Packing packing = packing_of({ball({8, 10, 10}, 6)});
  const CellVoids cells = shaped(model, packing);
  expect_sound(model, packing, cells);
  ASSERT_EQ(cells.voids.size(), 1U);
  EXPECT_LE(bounding_box(cells.voids[0].surface).upper.x, 38);
}

TEST(ShapeCells, ACellThatTakesNoBallStaysSolid) {
  const Mesh model = test::make_box({0, 0, 0}, {30, 30, 5});
  const Packing packing = packing_of({ball({15, 15, 2.5}, 0.5)});
  EXPECT_TRUE(shaped(model, packing).voids.empty());
}

TEST(ShapeCells, WhatIsSolidAroundAPlaceIsShapedAnew) {
  const Mesh model = test::make_box({0, 0, 0}, {40, 20, 20});
  const Packing packing = packing_of({ball({10, 10, 10}, 7), ball({30, 10, 10}, 7)});
  const CellVoids before = shaped(model, packing);
  ASSERT_EQ(before.voids.size(), 2U);
  const std::vector<CellPlace> places{{1, {37.9, 10, 10}}};
  const SurfaceIndex surface(model);
  Monitor silent;
  const CellVoids after = shape_around(surface, packing, before, kShape, places, silent);
  expect_sound(model, packing, after);
  ASSERT_EQ(after.voids.size(), 2U);
  EXPECT_EQ(after.voids[0].surface.positions, before.voids[0].surface.positions);
  EXPECT_EQ(after.voids[1].cell, 1U);
  EXPECT_EQ(test::winding_number(before.voids[1].surface, places[0].at), -1);
  EXPECT_EQ(test::winding_number(after.voids[1].surface, places[0].at), 0);
  EXPECT_GT(test::distance_to_surface(after.voids[1].surface, places[0].at), before.lattice.spacing / 2);
  EXPECT_GT(volume_of(after.voids[1]), 0.98 * volume_of(before.voids[1]));
}

TEST(ShapeCells, SaysWhereSinglePrecisionIsTooCoarse) {
  const Vec3f far{1e5F, 0, 0};
  const Mesh model = test::moved(test::make_box({0, 0, 0}, {20, 20, 20}), far);
  const Packing packing = packing_of({ball({1e5 + 10, 10, 10}, 7)});
  const std::string said = test::message_of<UsageError>([&] { shaped(model, packing); });
  EXPECT_TRUE(test::contains(said, "single precision"));
  EXPECT_TRUE(test::contains(said, "nearer to the origin"));
  // A tolerance that it can hold.
  const CellShape coarse{.fillet = 1, .tolerance = 0.2};
  const CellVoids cells = shaped(model, packing, coarse);
  expect_sound(model, packing, cells, coarse);
  EXPECT_EQ(cells.voids.size(), 1U);
}

TEST(ShapeCells, SaysWhereACellIsTooLarge) {
  const Mesh model = test::make_box({0, 0, 0}, {240, 240, 240});
  const Packing packing = packing_of({ball({120, 120, 120}, 20)});
  const CellShape fine{.fillet = 1, .tolerance = 0.05};
  EXPECT_TRUE(
      test::contains(test::message_of<UsageError>([&] { shaped(model, packing, fine); }), "too large"));
}

TEST(ShapeCells, SaysSoBeforeAnyCellIsLookedAt) {
  class NeverAsked : public Monitor {
    void check_interrupted() override { ADD_FAILURE() << "a cell is being shaped"; }
  } monitor;
  const Mesh model = test::make_box({0, 0, 0}, {40, 20, 20});
  const Packing packing = packing_of({ball({10, 10, 10}, 7), ball({30, 10, 10}, 7)});
  const CellShape fine{.fillet = 0.05, .tolerance = 0.05};
  const CellPlanes planes = planes_of(model, packing);
  EXPECT_TRUE(test::contains(
      test::message_of<UsageError>([&] { shape_cells(SurfaceIndex(model), packing, planes, fine, monitor); }),
      "too large"));
}

TEST(ShapeCells, WhatKeepsTheWallIsNotFarFromWhatWasPlanned) {
  // Dents, which a void bends round: vertices are moved to keep the wall.
  Mesh model = test::make_uv_sphere(20, 30, 30);
  for (Vec3f& p : model.positions)
    p = p * (1 + 0.2F * std::sin(p.x * 0.4F) * std::sin(p.y * 0.4F) * std::sin(p.z * 0.4F));
  const Packing packing = packing_of({ball({0, 0, 0}, 10)});
  const CellShape shape{.fillet = 1.75, .tolerance = 0.1};
  const CellVoids cells = shaped(model, packing, shape);
  ASSERT_EQ(cells.voids.size(), 1U);
  EXPECT_LE(cells.voids.front().deviation, 1.2 * shape.tolerance);
}

// Asked to stop at some question, or at none.
class StoppedAt : public Monitor {
 public:
  explicit StoppedAt(int question) : question_(question) {}
  int asked() const { return asked_; }
  void check_interrupted() override {
    if (++asked_ == question_) throw InterruptedError();
  }

 private:
  int question_, asked_ = 0;
};

TEST(ShapeCells, StopsWhenInterruptedWithinASingleCell) {
  const Mesh model = test::make_box({0, 0, 0}, {30, 30, 30});
  const Packing packing = packing_of({ball({15, 15, 15}, 12)});
  const SurfaceIndex surface(model);
  const CellPlanes planes = planes_of(model, packing);
  StoppedAt none(0);
  shape_cells(surface, packing, planes, kShape, none);
  EXPECT_GT(none.asked(), 300);
  for (const int question : {1, 2, 20, 100, 200, none.asked() / 2}) {
    StoppedAt monitor(question);
    EXPECT_THROW(shape_cells(surface, packing, planes, kShape, monitor), InterruptedError) << question;
    EXPECT_LE(monitor.asked(), none.asked());
  }
}

TEST(ShapeCells, CarvesTheVoidsInTheirOrder) {
  const Mesh model = test::make_box({0, 0, 0}, {40, 20, 20});
  const Packing packing = packing_of({ball({10, 10, 10}, 7), ball({30, 10, 10}, 7)});
  const CellVoids cells = shaped(model, packing);
  const Solid solid = carve_cells(model, cells);
  EXPECT_TRUE(test::is_closed_manifold(solid.mesh));
  EXPECT_EQ(solid.outer_triangle_count(), 12U);
  ASSERT_EQ(solid.of(PartKind::void_surface).size(), 2U);
  for (std::size_t i = 0; i < 2; ++i) {
    const Mesh made = test::extract(solid.mesh, solid.of(PartKind::void_surface)[i]);
    EXPECT_EQ(made.positions, cells.voids[i].surface.positions);
    EXPECT_EQ(made.triangles, cells.voids[i].surface.triangles);
  }
  EXPECT_NEAR(signed_volume(solid.mesh), 16000 - volume_of(cells.voids[0]) - volume_of(cells.voids[1]), 1e-2);
}

}  // namespace
}  // namespace aerate
