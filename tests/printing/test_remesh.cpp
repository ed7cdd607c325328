#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <gtest/gtest.h>
#include <set>
#include <string>
#include <tbb/global_control.h>
#include <vector>

#include "core/error.h"
#include "core/overhang.h"
#include "files/load.h"
#include "kernels/point_triangle.h"
#include "kernels/winding.h"
#include "printing/level_set.h"
#include "printing/remesh.h"
#include "printing/shells.h"
#include "tests/support/caught.h"
#include "tests/support/closed_shells.h"
#include "tests/support/packing_of.h"
#include "tests/support/shapes.h"

namespace aerate {
namespace {

constexpr double kPlenty = 4e9;  // bytes

ModelLevelSet level_set_of(const Mesh& mesh, double voxel_size) {
  Monitor monitor;
  return ModelLevelSet(mesh, voxel_size, kPlenty, monitor);
}

Sphere ball(Vec3d centre, double radius) {
  return {centre, radius, SphereKind::lattice};
}

// Closed and 2-manifold, also for a reader who joins vertices at one place, as STL readers do.
bool is_sound(const Mesh& mesh) {
  std::set<std::array<float, 3>> places;
  for (const Vec3f& p : mesh.positions) places.insert({p.x, p.y, p.z});
  return places.size() == mesh.positions.size() && test::is_closed_manifold(mesh);
}

double distance_to(const Mesh& mesh, Vec3d p) {
  double nearest = 1e300;
  for (const Triangle& t : mesh.triangles) {
    const kernels::Facet facet{mesh.positions[t[0]], mesh.positions[t[1]], mesh.positions[t[2]]};
    nearest = std::min(nearest, kernels::distance_squared_to_facet(p, facet));
  }
  return std::sqrt(nearest);
}

double largest_distance(const Mesh& from, const Mesh& to) {
  double largest = 0;
  for (const Vec3f& p : from.positions) largest = std::max(largest, distance_to(to, to_double(p)));
  return largest;
}

// A block of 20 x 20 x 10 mm with a slit from above, 15 mm deep and `width` mm wide, around x = 10.
Mesh make_slit_block(float width) {
  const float left = 10 - width / 2, right = 10 + width / 2;
  const Vec3f outline[8] = {{0, 0, 0},     {20, 0, 0},   {20, 20, 0},   {right, 20, 0},
                            {right, 5, 0}, {left, 5, 0}, {left, 20, 0}, {0, 20, 0}};
  Mesh mesh;
  for (const Vec3f& p : outline) mesh.positions.push_back(p);
  for (const Vec3f& p : outline) mesh.positions.push_back({p.x, p.y, 10});
  const Triangle cap[6] = {{0, 1, 4}, {0, 4, 5}, {1, 2, 3}, {1, 3, 4}, {0, 5, 6}, {0, 6, 7}};
  for (const Triangle& t : cap) {
    mesh.triangles.push_back({t[0], t[2], t[1]});
    mesh.triangles.push_back({t[0] + 8, t[1] + 8, t[2] + 8});
  }
  for (std::uint32_t i = 0; i < 8; ++i) {
    const std::uint32_t j = (i + 1) % 8;
    mesh.triangles.push_back({i, j, j + 8});
    mesh.triangles.push_back({i, j + 8, i + 8});
  }
  return mesh;
}

TEST(Shells, AreSplitByFirstTriangleAndKeepTheirOrder) {
  const Mesh a = test::make_box({0, 0, 0}, {1, 2, 3}), b = test::make_box({5, 5, 5}, {6, 6, 6});
  Mesh mesh = test::join(a, b);
  EXPECT_EQ(count_shells(mesh), 2);
  std::reverse(mesh.triangles.begin(), mesh.triangles.end());
  mesh.positions.push_back({9, 9, 9});
  const std::vector<Mesh> shells = split_into_shells(mesh);
  ASSERT_EQ(shells.size(), 2);
  EXPECT_EQ(shells[0].positions, b.positions);
  EXPECT_EQ(shells[1].positions, a.positions);
  EXPECT_EQ(shells[1].triangles.back(), a.triangles.front());
  EXPECT_EQ(count_shells({}), 0);
}

TEST(Remesh, ABlockStaysWithinAVoxel) {
  const Mesh block = test::make_box({0.1f, 0.2f, 0.3f}, {20.1f, 15.2f, 10.3f});
  const Mesh surface = level_set_of(block, 0.5).surface();
  EXPECT_TRUE(is_sound(surface));
  EXPECT_EQ(test::euler_characteristic(surface), 2);
  EXPECT_LE(largest_distance(surface, block), 0.25);
  EXPECT_LE(largest_distance(block, surface), 0.5 * std::sqrt(3.0));
  EXPECT_NEAR(signed_volume(surface), signed_volume(block), 0.005 * signed_volume(block));
}

TEST(Remesh, CavitiesStay) {
  const Mesh outer = test::make_box({0, 0, 0}, {20, 20, 20}), inner = test::make_box({5, 5, 5}, {15, 15, 15});
  const Mesh model = test::join(outer, test::turned_inside_out(inner));
  const Mesh surface = level_set_of(model, 0.4).surface();
  EXPECT_TRUE(is_sound(surface));
  const std::vector<Mesh> shells = split_into_shells(surface);
  ASSERT_EQ(shells.size(), 2);
  const double first = signed_volume(shells[0]), second = signed_volume(shells[1]);
  EXPECT_NEAR(std::max(first, second), 8000, 80);
  EXPECT_NEAR(std::min(first, second), -1000, 20);
}

TEST(Remesh, OverlappingPartsAreUnited) {
  // The second cavity-free part also covers a cavity of the first: solid there, as slicers fill it.
  const Mesh first = test::make_box({0, 0, 0}, {20, 20, 20});
  const Mesh cavity = test::turned_inside_out(test::make_box({12, 8, 8}, {16, 12, 12}));
  const Mesh second = test::make_box({10, 5, 5}, {30, 15, 15});
  const Mesh model = test::join(test::join(first, cavity), second);
  const Mesh surface = level_set_of(model, 0.4).surface();
  EXPECT_TRUE(is_sound(surface));
  EXPECT_EQ(count_shells(surface), 1);
  EXPECT_NEAR(signed_volume(surface), 8000 + 1000, 0.01 * 9000);
  EXPECT_LE(largest_distance(surface, test::join(first, second)), 0.4);
}

TEST(Remesh, ACrackThinnerThanAVoxelTurnsNoRegion) {
  for (const float width : {0.01f, 0.1f, 0.3f}) {
    const Mesh block = make_slit_block(width);
    ASSERT_TRUE(test::is_closed_manifold(block));
    const Mesh surface = level_set_of(block, 0.5).surface();
    EXPECT_TRUE(is_sound(surface));
    EXPECT_EQ(count_shells(surface), 1);
    EXPECT_NEAR(signed_volume(surface), 4000, 0.03 * 4000) << "slit of " << width;

    // The same crack between two parts, where the winding number decides.
    const Mesh parts = test::join(test::make_box({0, 0, 0}, {10 - width / 2, 20, 10}),
                                  test::make_box({10 + width / 2, 0, 0}, {20, 20, 10}));
    const Mesh both = level_set_of(parts, 0.5).surface();
    EXPECT_TRUE(is_sound(both));
    EXPECT_NEAR(signed_volume(both), 4000, 0.03 * 4000) << "parts " << width << " apart";
    const kernels::HostWinding winding(both.positions, both.triangles);
    for (double x = 1.1; x < 20; x += 0.7) {
      if (std::abs(x - 10) < 1) continue;
      EXPECT_EQ(winding.view().winding_number({x, 10.3, 5.2}), 1) << "x " << x;
    }
  }
}

// Cracks thinner than a voxel, doubled edges, triangles of any shape.
TEST(Remesh, AScannedModelBecomesSound) {
  const std::filesystem::path path = std::filesystem::path(AERATE_SHARED) / "models" / "dragon-47k-100mm.stl";
  if (!std::filesystem::exists(path)) GTEST_SKIP() << path << " is not there";
  const Mesh dragon = load_model(path).mesh;
  ASSERT_EQ(count_shells(dragon), 1);
  const Mesh surface = level_set_of(dragon, 0.5).surface();
  EXPECT_TRUE(is_sound(surface));
  EXPECT_EQ(count_shells(surface), 1);
  EXPECT_NEAR(signed_volume(surface), signed_volume(dragon), 0.001 * signed_volume(dragon));

  // With a second part the winding number decides, and cracks that voxels hold in part stay in part.
  const Mesh parts = test::join(dragon, test::make_box({200, 0, 0}, {210, 10, 10}));
  const Mesh both = level_set_of(parts, 0.5).surface();
  EXPECT_TRUE(is_sound(both));
  EXPECT_NEAR(signed_volume(both), signed_volume(parts), 0.004 * signed_volume(parts));
  EXPECT_EQ(count_shells(both), 2) << "noise is left";
}

TEST(Remesh, RefusesMoreMemoryThanAllowedAndNamesAVoxelSizeThatWouldDo) {
  const Mesh block = test::make_box({0, 0, 0}, {20, 20, 20});
  constexpr double kLittle = 2e7;
  Monitor monitor;
  const std::string message =
      test::message_of<UsageError>([&] { ModelLevelSet(block, 0.01, kLittle, monitor); });
  const std::size_t at = message.find("use --voxel ");
  ASSERT_NE(at, std::string::npos) << message;
  const double suggested = std::stod(message.substr(at + 12));
  EXPECT_LE(ModelLevelSet::estimated_bytes(block, suggested), kLittle);
  EXPECT_GE(ModelLevelSet::estimated_bytes(block, suggested / 1.2), kLittle);
  EXPECT_NO_THROW(ModelLevelSet(block, suggested, kLittle, monitor));
  EXPECT_THROW(ModelLevelSet(block, 1e-12, kPlenty, monitor), UsageError);
}

TEST(Remesh, SaysThatNothingIsLeft) {
  EXPECT_TRUE(test::contains(test::message_of<UsageError>([] {
                               level_set_of(test::make_box({0.1f, 0.1f, 0.1f}, {0.3f, 0.3f, 0.3f}), 1);
                             }),
                             "nothing is left"));
}

TEST(Remesh, StopsWhenInterrupted) {
  class Interrupted : public Monitor {
   public:
    void check_interrupted() override { throw InterruptedError(); }
  } monitor;
  const Mesh block = test::make_box({0, 0, 0}, {20, 20, 20});
  EXPECT_THROW(ModelLevelSet(block, 0.5, kPlenty, monitor), InterruptedError);
  EXPECT_THROW(level_set_of(block, 0.5).subtract({}, {}, monitor), InterruptedError);
}

TEST(Remesh, WithoutVoidsOnlyTheSurfaceIsThere) {
  const ModelLevelSet model = level_set_of(test::make_box({0, 0, 0}, {20, 20, 20}), 0.5);
  Monitor monitor;
  const Solid solid = model.subtract({}, {}, monitor);
  EXPECT_EQ(solid.mesh.triangles, model.surface().triangles);
  EXPECT_EQ(solid.parts.size(), 1u);
}

class Subtract : public testing::Test {
 protected:
  Mesh block_ = test::make_box({0, 0, 0}, {30, 20, 20});
  Packing packing_ = test::packing_of({ball({22.3, 10, 10}, 5), ball({9.1, 9.7, 10.2}, 7),
                                       ball({16.8, 3.2, 3.1}, 1.7), ball({16.8, 16.2, 16.1}, 2.3)});
};

TEST_F(Subtract, GivesTheSurfaceAndEachVoidInOrder) {
  constexpr double kTolerance = 0.05;
  const ModelLevelSet model = level_set_of(block_, 0.4);
  Monitor monitor;
  const Solid solid = model.subtract(packing_, {kTolerance}, monitor);
  EXPECT_TRUE(is_sound(solid.mesh));

  const Mesh surface = model.surface();
  const Mesh outer = test::extract(solid.mesh, solid.parts.front());
  EXPECT_EQ(outer.triangles, surface.triangles);
  EXPECT_EQ(outer.positions, surface.positions);

  ASSERT_EQ(solid.of(PartKind::void_surface).size(), packing_.spheres.size());
  for (std::size_t i = 0; i < packing_.spheres.size(); ++i) {
    SCOPED_TRACE("void " + std::to_string(i));
    const Sphere& sphere = packing_.spheres[i];
    const Mesh shell =
        test::turned_inside_out(test::extract(solid.mesh, solid.of(PartKind::void_surface)[i]));
    EXPECT_EQ(test::euler_characteristic(shell), 2);
    EXPECT_TRUE(test::is_star_shaped(shell, sphere.centre));
    const test::Deviation deviation = test::deviation_from(shell, sphere);
    EXPECT_LE(deviation.highest, 0);
    EXPECT_GE(deviation.lowest, -kTolerance);
    EXPECT_LE(static_cast<double>(shell.triangles.size()), 2 * 4.84 * sphere.radius / kTolerance);
  }
}

TEST_F(Subtract, TheDifferenceLeavesTheOuterSurfaceAsItIs) {
  Monitor monitor;
  const LevelSet model = LevelSet::of_solid(block_, 0.4, LevelSet::Interior::enclosed, monitor);
  const Mesh whole = model.surface();
  const Mesh cut = model.minus(LevelSet::of_balls(packing_.spheres, 0.4)).surface();
  EXPECT_TRUE(is_sound(cut));
  const std::vector<Mesh> shells = split_into_shells(cut);
  EXPECT_EQ(shells.size(), 1 + packing_.spheres.size());
  for (const Mesh& shell : shells) {
    if (signed_volume(shell) < 0) continue;
    EXPECT_EQ(shell.positions, whole.positions);
    EXPECT_EQ(shell.triangles, whole.triangles);
  }
}

TEST_F(Subtract, KeepsAToleranceThatIsMuchFinerThanTheVoxels) {
  constexpr double kTolerance = 0.002;
  Monitor monitor;
  const Solid solid = level_set_of(block_, 0.4).subtract(packing_, {kTolerance}, monitor);
  EXPECT_TRUE(is_sound(solid.mesh));
  for (std::size_t i = 0; i < packing_.spheres.size(); ++i) {
    const test::Deviation deviation = test::deviation_from(
        test::turned_inside_out(test::extract(solid.mesh, solid.of(PartKind::void_surface)[i])),
        packing_.spheres[i]);
    EXPECT_LE(deviation.highest, 0);
    EXPECT_GE(deviation.lowest, -kTolerance);
  }
}

TEST_F(Subtract, RefusesVoidsThatVoxelsCannotHold) {
  packing_.spheres.push_back(ball({2, 2, 2}, 0.7));
  Monitor monitor;
  const ModelLevelSet model = level_set_of(block_, 0.4);
  const std::string message = test::message_of<UsageError>([&] { model.subtract(packing_, {}, monitor); });
  EXPECT_TRUE(test::contains(message, "1 of 5 voids are too small for a voxel size of 0.4 mm"));
  EXPECT_TRUE(test::contains(message, "use --voxel 0.35 or less"));
  EXPECT_NO_THROW(level_set_of(block_, 0.35).subtract(packing_, {}, monitor));
}

TEST_F(Subtract, RefusesVoidsThatRunTogether) {
  packing_.spheres = {ball({9.6, 10, 10}, 5), ball({19.85, 10, 10}, 5), ball({15, 16, 16}, 2.2)};
  Monitor monitor;
  const ModelLevelSet model = level_set_of(block_, 1);
  const std::string message = test::message_of<UsageError>([&] { model.subtract(packing_, {}, monitor); });
  EXPECT_TRUE(test::contains(message, "the void at (9.6, 10, 10) mm runs together with its neighbour"));
  EXPECT_TRUE(test::contains(message, "use --voxel 0.12 or less"));
  EXPECT_NO_THROW(level_set_of(block_, 0.12).subtract(packing_, {}, monitor));
}

TEST_F(Subtract, FindsVoidsWithRoofsAgain) {
  for (const Vec3d up : {Vec3d{0, 0, 1}, {-1, 0, 0}, {0.6, 0, 0.8}}) {
    packing_ = test::packing_of({ball({8, 10, 9}, 6), ball({22, 10, 9}, 5), ball({15, 3, 4}, 1.5)},
                                make_roof({.bridge = 3, .up = up}));
    Monitor monitor;
    const Solid solid = level_set_of(block_, 0.3).subtract(packing_, {0.05}, monitor);
    ASSERT_EQ(solid.of(PartKind::void_surface).size(), 3U);
    for (std::size_t i = 0; i < 3; ++i) {
      const Mesh shell =
          test::turned_inside_out(test::extract(solid.mesh, solid.of(PartKind::void_surface)[i]));
      const double planned = void_volume(packing_.limits.roof, packing_.spheres[i].radius);
      EXPECT_LT(signed_volume(shell), planned);
      EXPECT_GT(signed_volume(shell), 0.93 * planned);
    }
  }
  // Far enough apart as spheres; the roof of one reaches into the other.
  packing_ = test::packing_of({ball({15, 10, 6}, 5), ball({15, 10, 14}, 2)}, {});
  Monitor monitor;
  const ModelLevelSet model = level_set_of(block_, 0.3);
  EXPECT_NO_THROW(model.subtract(packing_, {}, monitor));
  packing_.limits.roof = make_roof({.bridge = 1});
  EXPECT_TRUE(test::contains(test::message_of<UsageError>([&] { model.subtract(packing_, {}, monitor); }),
                             "runs together with its neighbour"));
}

TEST_F(Subtract, RefusesVoidsThatOpenTheSurface) {
  packing_.spheres.push_back(ball({27, 2.7, 17.3}, 2.71));
  Monitor monitor;
  const ModelLevelSet model = level_set_of(block_, 0.4);
  EXPECT_TRUE(test::contains(test::message_of<UsageError>([&] { model.subtract(packing_, {}, monitor); }),
                             "runs into the surface"));
}

TEST_F(Subtract, SameBytesForAnyThreadCount) {
  for (int i = 0; i < 27; ++i) {
    packing_.spheres.push_back(
        ball({35.0 + 4 * (i % 3), 4.0 + 4 * (i / 3 % 3), 4.0 + 4 * (i / 9)}, 1.0 + 0.02 * i));
  }
  block_ = test::join(block_, test::make_box({29, 0, 0}, {50, 20, 20}));
  Solid first;
  for (const std::size_t threads : {1u, 2u, 8u}) {
    const tbb::global_control control(tbb::global_control::max_allowed_parallelism, threads);
    Monitor monitor;
    Solid solid = level_set_of(block_, 0.4).subtract(packing_, {0.02}, monitor);
    if (threads == 1) first = solid;
    EXPECT_EQ(solid.mesh.triangles, first.mesh.triangles) << threads << " threads";
    EXPECT_EQ(solid.mesh.positions, first.mesh.positions) << threads << " threads";
  }
}

}  // namespace
}  // namespace aerate
