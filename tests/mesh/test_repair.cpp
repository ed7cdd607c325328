#include <algorithm>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <gtest/gtest.h>
#include <numbers>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "core/error.h"
#include "files/load.h"
#include "mesh/inspect.h"
#include "mesh/repair.h"
#include "tests/support/caught.h"
#include "tests/support/shapes.h"

namespace aerate {
namespace {

using test::contains;
using test::join;
using test::make_box;
using test::make_torus;
using test::message_of;
using test::turned_inside_out;

void flip(Triangle& t) {
  std::swap(t[1], t[2]);
}

// ---- orient_outward

TEST(OrientOutward, SoundModelsStayAsTheyAre) {
  const Mesh outer = make_box({0, 0, 0}, {10, 10, 10});
  const Mesh cavity = turned_inside_out(make_box({2, 2, 2}, {8, 8, 8}));
  const Mesh island = make_box({4, 4, 4}, {6, 6, 6});
  const Mesh overlapping = make_box({9, 9, 9}, {12, 12, 12});
  for (const Mesh& mesh : {outer, join(outer, cavity), join(cavity, outer), join(join(outer, cavity), island),
                           join(outer, overlapping), join(outer, island)}) {
    const Repaired repaired = orient_outward(mesh);
    EXPECT_EQ(repaired.mesh.triangles, mesh.triangles);
    EXPECT_TRUE(repaired.notices.empty());
  }
}

TEST(OrientOutward, InsideOutBoxIsTurnedWithANotice) {
  const Mesh box = make_box({0, 0, 0}, {1, 2, 3});
  const Repaired repaired = orient_outward(turned_inside_out(box));
  EXPECT_NEAR(signed_volume(repaired.mesh), 6, 1e-12);
  EXPECT_EQ(repaired.mesh.triangles, box.triangles);
  ASSERT_EQ(repaired.notices.size(), 1u);
  EXPECT_TRUE(contains(repaired.notices[0], "inside out"));
}

TEST(OrientOutward, InsideOutModelIsTurnedWithItsCavitiesAndTheirIslands) {
  const Mesh model =
      join(join(make_box({0, 0, 0}, {10, 10, 10}), turned_inside_out(make_box({2, 2, 2}, {8, 8, 8}))),
           make_box({4, 4, 4}, {6, 6, 6}));
  const Repaired repaired = orient_outward(turned_inside_out(model));
  EXPECT_EQ(repaired.mesh.triangles, model.triangles);
}

TEST(OrientOutward, OneOfTwoPartsInsideOut) {
  const Mesh sound = make_torus(5, 1, 24, 12);
  const Mesh other = make_box({20, 0, 0}, {21, 1, 1});
  const Repaired repaired = orient_outward(join(sound, turned_inside_out(other)));
  EXPECT_EQ(repaired.mesh.triangles, join(sound, other).triangles);
  ASSERT_EQ(repaired.notices.size(), 1u);
  EXPECT_TRUE(contains(repaired.notices[0], "1 of 2 shells"));
}

TEST(OrientOutward, CavityOfAPartThatIsInsideOutStaysACavity) {
  const Mesh outer = make_box({0, 0, 0}, {10, 10, 10});
  const Mesh cavity = turned_inside_out(make_box({2, 2, 2}, {8, 8, 8}));
  const Repaired repaired = orient_outward(join(turned_inside_out(outer), cavity));
  EXPECT_EQ(repaired.mesh.triangles, join(outer, cavity).triangles);
}

TEST(OrientOutward, OpenShellsAreLeftAlone) {
  Mesh mesh = turned_inside_out(make_box({0, 0, 0}, {1, 1, 1}));
  mesh.triangles.pop_back();
  EXPECT_EQ(orient_outward(mesh).mesh.triangles, mesh.triangles);
}

// ---- orient_consistently

TEST(OrientConsistently, FlippedTrianglesAreTurnedBack) {
  std::mt19937 random(5);
  const Mesh torus = make_torus(5, 2, 30, 20);
  for (const std::size_t flips : {1u, 7u, 300u}) {
    Mesh mesh = torus;
    for (std::size_t i = 0; i < flips; ++i) flip(mesh.triangles[random() % mesh.triangles.size()]);
    const Repaired repaired = orient_consistently(mesh);
    EXPECT_EQ(repaired.mesh.triangles, torus.triangles);
    ASSERT_EQ(repaired.notices.size(), 1u);
    if (flips == 1) {
      EXPECT_EQ(repaired.notices.front(), "1 triangle of 1 shell turned to agree with its neighbours");
    }
    EXPECT_TRUE(inspect(repaired.mesh).closed());
  }
}

TEST(OrientConsistently, SoundMeshesStayAsTheyAre) {
  const Mesh mesh = join(make_torus(5, 2, 30, 20), turned_inside_out(make_box({0, 0, 0}, {1, 1, 1})));
  const Repaired repaired = orient_consistently(mesh);
  EXPECT_EQ(repaired.mesh.triangles, mesh.triangles);
  EXPECT_TRUE(repaired.notices.empty());
}

TEST(WithoutRepeatedVertices, LeavesOutThoseTrianglesAlone) {
  const Mesh box = make_box({0, 0, 0}, {1, 2, 3});
  Mesh mesh = box;
  mesh.positions.push_back({9, 9, 9});
  mesh.triangles.assign(1, {4, 4, 8});
  for (const Triangle& t : box.triangles) {
    mesh.triangles.push_back(t);
    mesh.triangles.push_back({1, 0, 1});
  }
  mesh.triangles.push_back({2, 2, 2});
  const Repaired repaired = without_repeated_vertices(mesh);
  ASSERT_EQ(repaired.mesh.triangles.size(), 12u);
  EXPECT_EQ(repaired.mesh.positions.size(), 8u);
  for (std::size_t i = 0; i < 12; ++i) {
    for (std::size_t k = 0; k < 3; ++k)
      EXPECT_EQ(repaired.mesh.positions[repaired.mesh.triangles[i][k]], box.positions[box.triangles[i][k]]);
  }
  EXPECT_EQ(repaired.notices.size(), 1u);
}

TEST(WithoutRepeatedVertices, OthersWithoutAreaStay) {
  Mesh mesh = make_box({0, 0, 0}, {1, 2, 3});
  mesh.positions.push_back({0.5f, 0, 0});
  mesh.triangles.push_back({0, 8, 1});  // three places on a line
  const Repaired repaired = without_repeated_vertices(mesh);
  EXPECT_EQ(repaired.mesh.triangles, mesh.triangles);
  EXPECT_TRUE(repaired.notices.empty());
}

TEST(OrientConsistently, OpenMeshesToo) {
  Mesh mesh = make_torus(5, 2, 30, 20);
  mesh.triangles.resize(mesh.triangles.size() / 2);
  const std::vector<Triangle> expected = mesh.triangles;
  flip(mesh.triangles[100]);
  mesh.triangles.push_back({3, 3, 4});  // a degenerate triangle does not get in the way
  const Repaired repaired = orient_consistently(mesh);
  EXPECT_TRUE(std::equal(expected.begin(), expected.end(), repaired.mesh.triangles.begin()));
}

TEST(OrientConsistently, MoebiusStripIsLeftWithANotice) {
  Mesh mesh;
  constexpr std::uint32_t kSteps = 20;
  for (std::uint32_t i = 0; i < kSteps; ++i) {
    const double u = 2 * std::numbers::pi * i / kSteps;
    for (const double side : {-1.0, 1.0}) {
      const double distance = 5 + side * std::cos(u / 2);
      mesh.positions.push_back(
          to_float({distance * std::cos(u), distance * std::sin(u), side * std::sin(u / 2)}));
    }
  }
  for (std::uint32_t i = 0; i < kSteps; ++i) {
    const std::uint32_t a = 2 * i, b = 2 * i + 1;
    const bool last = i + 1 == kSteps;
    const std::uint32_t c = last ? 1 : a + 2, d = last ? 0 : a + 3;
    mesh.triangles.push_back({a, c, b});
    mesh.triangles.push_back({b, c, d});
  }
  Mesh with_flip = join(mesh, make_box({20, 0, 0}, {21, 1, 1}));
  std::vector<Triangle> expected = with_flip.triangles;
  flip(with_flip.triangles.back());
  const Repaired repaired = orient_consistently(with_flip);
  EXPECT_EQ(repaired.mesh.triangles, expected) << "the box is repaired, the strip is not";
  ASSERT_EQ(repaired.notices.size(), 2u);
  EXPECT_TRUE(contains(repaired.notices[0], "1 triangle"));
  EXPECT_TRUE(contains(repaired.notices[1], "cannot"));
}

// ---- fill_holes

TEST(FillHoles, BoxWithoutLid) {
  Mesh mesh = make_box({0, 0, 0}, {4, 2, 3});
  mesh.triangles.erase(mesh.triangles.begin() + 2, mesh.triangles.begin() + 4);
  const Mesh open = mesh;
  const Repaired repaired = fill_holes(mesh, 5);
  EXPECT_TRUE(inspect(repaired.mesh).closed());
  EXPECT_NEAR(signed_volume(repaired.mesh), 24, 1e-12);
  ASSERT_EQ(repaired.mesh.triangles.size(), 12u);
  EXPECT_TRUE(std::equal(open.triangles.begin(), open.triangles.end(), repaired.mesh.triangles.begin()));
  ASSERT_EQ(repaired.notices.size(), 1u);
  EXPECT_TRUE(contains(repaired.notices[0], "2 triangles"));
}

TEST(FillHoles, ClosedMeshesStayAsTheyAre) {
  const Repaired repaired = fill_holes(make_box({0, 0, 0}, {1, 1, 1}), 0);
  EXPECT_EQ(repaired.mesh.triangles.size(), 12u);
  EXPECT_TRUE(repaired.notices.empty());
}

TEST(FillHoles, ManyHolesOfATorus) {
  Mesh mesh = make_torus(20, 6, 60, 40);
  const double volume = signed_volume(mesh);
  std::vector<Triangle> kept;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    if (t % 97 > 5) kept.push_back(mesh.triangles[t]);
  }
  mesh.triangles = kept;
  const std::size_t holes = inspect(mesh).boundary_loops.size();
  EXPECT_GT(holes, 10u);
  const Repaired repaired = fill_holes(mesh, 10);
  const Inspection result = inspect(repaired.mesh);
  EXPECT_TRUE(result.closed());
  EXPECT_EQ(result.non_manifold_edges, 0u);
  EXPECT_NEAR(signed_volume(repaired.mesh), volume, 0.01 * volume);
}

TEST(FillHoles, LongFlatRim) {
  // A cylinder without its ends.
  Mesh mesh;
  constexpr std::uint32_t kSteps = 3000;
  for (std::uint32_t i = 0; i < kSteps; ++i) {
    const double u = 2 * std::numbers::pi * i / kSteps;
    for (const float z : {0.0f, 8.0f}) {
      mesh.positions.push_back({static_cast<float>(5 * std::cos(u)), static_cast<float>(5 * std::sin(u)), z});
    }
  }
  for (std::uint32_t i = 0; i < kSteps; ++i) {
    const std::uint32_t a = 2 * i, b = 2 * ((i + 1) % kSteps);
    mesh.triangles.push_back({a, b, a + 1});
    mesh.triangles.push_back({a + 1, b, b + 1});
  }
  const Repaired repaired = fill_holes(mesh, 15);
  EXPECT_TRUE(inspect(repaired.mesh).closed());
  EXPECT_NEAR(signed_volume(repaired.mesh), std::numbers::pi * 25 * 8, 0.01);
}

TEST(FillHoles, HoleTooLargeIsNamed) {
  Mesh mesh = make_box({0, 0, 0}, {4, 2, 3});
  mesh.triangles.erase(mesh.triangles.begin() + 2, mesh.triangles.begin() + 4);
  Mesh small = make_box({10, 0, 0}, {11, 1, 1});
  small.triangles.pop_back();
  const std::string message = message_of<MeshError>([&] { fill_holes(join(mesh, small), 2); });
  EXPECT_TRUE(contains(message, "the largest of 2 holes"));
  EXPECT_TRUE(contains(message, "4.47 mm across"));
  EXPECT_TRUE(contains(message, "(2.000, 1.000, 3.000)"));
}

TEST(FillHoles, RimThatEndsAtOtherTrianglesIsRefused) {
  // A fin on an edge of a box: the edge has three triangles, the fin's rim is no loop.
  Mesh mesh = make_box({0, 0, 0}, {1, 1, 1});
  mesh.positions.push_back({2, 2, 0});
  mesh.triangles.push_back({3, 7, 8});
  const std::string message = message_of<MeshError>([&] { fill_holes(mesh, 10); });
  EXPECT_TRUE(contains(message, "cannot be closed"));
}

TEST(FillHoles, RealModelWithAPieceCutOut) {
  const std::filesystem::path path = std::filesystem::path(AERATE_SHARED) / "models" / "bunny-7202.stl";
  if (!std::filesystem::exists(path)) GTEST_SKIP() << path << " is not there";
  Mesh mesh = load_model(path).mesh;
  const double volume = signed_volume(mesh);
  const Vec3f centre = mesh.positions[mesh.triangles[1000][0]];
  std::erase_if(mesh.triangles, [&](const Triangle& t) {
    return length(to_double(mesh.positions[t[0]]) - to_double(centre)) < 0.5;
  });
  const Repaired repaired = fill_holes(mesh, 2);
  EXPECT_TRUE(inspect(repaired.mesh).closed());
  EXPECT_NEAR(signed_volume(repaired.mesh), volume, 0.01 * volume);
}

// ---- find_self_intersections

TEST(SelfIntersections, SoundMeshesHaveNone) {
  EXPECT_EQ(find_self_intersections(make_box({0, 0, 0}, {1, 1, 1})).pair_count, 0u);
  EXPECT_EQ(find_self_intersections(make_torus(5, 2, 40, 20)).pair_count, 0u);
}

TEST(SelfIntersections, BoxesThatRunIntoEachOther) {
  const SelfIntersections found =
      find_self_intersections(join(make_box({0, 0, 0}, {4, 4, 4}), make_box({1, 1, 2}, {2, 2, 6})));
  // Each of the small box's four sides meets the top, whose two triangles it crosses in parts.
  EXPECT_GE(found.pair_count, 8u);
  ASSERT_FALSE(found.places.empty());
  for (const Vec3d& place : found.places) EXPECT_GT(place.z, 2);
}

TEST(SelfIntersections, FoldedAndRepeatedTriangles) {
  Mesh folded;
  folded.positions = {{0, 0, 0}, {2, 0, 0}, {1, 2, 0}, {1, 1, 0}, {1, -1, 0}};
  folded.triangles = {{0, 1, 2}, {1, 0, 3}};
  EXPECT_EQ(find_self_intersections(folded).pair_count, 1u);  // one lies in the other
  folded.triangles = {{0, 1, 2}, {1, 0, 4}};
  EXPECT_EQ(find_self_intersections(folded).pair_count, 0u);  // side by side
  folded.triangles = {{0, 1, 2}, {1, 2, 0}};
  EXPECT_EQ(find_self_intersections(folded).pair_count, 1u);
}

TEST(SelfIntersections, TrianglesThatShareACorner) {
  Mesh mesh;
  mesh.positions = {{0, 0, 0}, {2, 0, 0}, {0, 2, 0}, {1, 1, 1}, {1, 1, -1}, {-1, -1, 1}, {-1, -1, -1}};
  mesh.triangles = {{0, 1, 2}, {0, 3, 4}};
  EXPECT_EQ(find_self_intersections(mesh).pair_count, 1u);  // crosses it
  mesh.triangles = {{0, 1, 2}, {0, 5, 6}};
  EXPECT_EQ(find_self_intersections(mesh).pair_count, 0u);  // only touches it
}

// Segment against triangle, for triangles in general position without shared vertices.
bool crosses(const Mesh& mesh, const Triangle& s, const Triangle& t) {
  const auto at = [&](std::uint32_t v) { return to_double(mesh.positions[v]); };
  const auto side = [&](Vec3d a, Vec3d b, Vec3d c, Vec3d d) { return dot(cross(b - a, c - a), d - a) > 0; };
  for (std::size_t i = 0; i < 3; ++i) {
    const Vec3d p = at(s[i]), q = at(s[(i + 1) % 3]);
    const Vec3d a = at(t[0]), b = at(t[1]), c = at(t[2]);
    if (side(a, b, c, p) == side(a, b, c, q)) continue;
    const bool ab = side(p, q, a, b), bc = side(p, q, b, c), ca = side(p, q, c, a);
    if (ab == bc && bc == ca) return true;
  }
  return false;
}

TEST(SelfIntersections, AgreesWithBruteForceOnRandomTriangles) {
  std::mt19937 random(11);
  std::uniform_real_distribution<float> coordinate(0, 10);
  Mesh mesh;
  for (std::uint32_t t = 0; t < 150; ++t) {
    for (int corner = 0; corner < 3; ++corner) {
      mesh.positions.push_back({coordinate(random), coordinate(random), coordinate(random)});
    }
    mesh.triangles.push_back({3 * t, 3 * t + 1, 3 * t + 2});
  }
  std::size_t expected = 0;
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    for (std::size_t j = i + 1; j < mesh.triangles.size(); ++j) {
      expected += crosses(mesh, mesh.triangles[i], mesh.triangles[j]) ||
                          crosses(mesh, mesh.triangles[j], mesh.triangles[i])
                      ? 1u
                      : 0u;
    }
  }
  EXPECT_GT(expected, 100u);
  EXPECT_EQ(find_self_intersections(mesh).pair_count, expected);
}

}  // namespace
}  // namespace aerate
