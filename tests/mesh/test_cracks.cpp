#include <algorithm>
#include <cmath>
#include <cstdint>
#include <gtest/gtest.h>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "files/weld.h"
#include "mesh/inspect.h"
#include "mesh/lost_surface.h"
#include "mesh/repair.h"
#include "tests/support/caught.h"
#include "tests/support/shapes.h"

namespace aerate {
namespace {

using test::contains;
using test::join;
using test::make_box;
using test::make_torus;
using test::make_uv_sphere;
using test::moved;
using test::turned_inside_out;

// Every corner with a rounding of its own: no two triangles share a vertex.
Mesh with_corners_apart(const Mesh& mesh, double by) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> shift(-by, by);
  std::vector<Vec3f> corners;
  for (const Triangle& triangle : mesh.triangles)
    for (const std::uint32_t vertex : triangle)
      corners.push_back(
          to_float(to_double(mesh.positions[vertex]) + Vec3d{shift(random), shift(random), shift(random)}));
  return weld(corners);
}

// A box whose sides round the corner at its lower end and those round its upper end are surfaces of their own,
// apart by some offset: two rims along six of the box's edges.
Mesh box_in_halves(float side, Vec3f offset) {
  const Mesh box = make_box({0, 0, 0}, {side, side, side});
  Mesh lower{box.positions, {}}, upper{box.positions, {}};
  for (const Triangle& t : box.triangles) {
    const bool touches_zero = std::ranges::any_of(std::array{0, 1, 2}, [&](int axis) {
      return std::ranges::all_of(t, [&](std::uint32_t v) {
        const Vec3f p = box.positions[v];
        return std::array{p.x, p.y, p.z}[static_cast<std::size_t>(axis)] == 0;
      });
    });
    (touches_zero ? lower : upper).triangles.push_back(t);
  }
  return join(lower, moved(upper, offset));
}

TEST(CloseCracks, SoundModelsStayAsTheyAre) {
  for (const Mesh& mesh : {make_box({0, 0, 0}, {1, 1, 1}), make_torus(10, 3, 40, 20),
                           join(make_box({0, 0, 0}, {1, 1, 1}), make_box({1.000001F, 0, 0}, {2, 1, 1}))}) {
    const Repaired closed = close_cracks(mesh, 0.01);
    EXPECT_EQ(closed.mesh.triangles, mesh.triangles);
    EXPECT_EQ(closed.mesh.positions, mesh.positions);
    EXPECT_TRUE(closed.notices.empty());
  }
}

TEST(CloseCracks, CornersThatDifferByRoundingAreJoined) {
  for (const double by : {1e-6, 1e-5, 1e-3}) {
    const Mesh torus = make_torus(10, 3, 40, 20);
    const Mesh apart = with_corners_apart(torus, by);
    EXPECT_GT(inspect(apart).open_edges, 1000u);
    const Repaired closed = close_cracks(apart, 0.01);
    const Inspection inspection = inspect(closed.mesh);
    EXPECT_TRUE(inspection.closed()) << by;
    EXPECT_EQ(inspection.shells.size(), 1u);
    EXPECT_EQ(closed.mesh.positions.size(), torus.positions.size());
    EXPECT_EQ(closed.mesh.triangles.size(), torus.triangles.size());
    EXPECT_NEAR(inspection.volume, signed_volume(torus), 500 * by);
    ASSERT_EQ(closed.notices.size(), 1u);
    EXPECT_TRUE(contains(closed.notices[0], "vertices are moved"));
  }
}

TEST(CloseCracks, JoinedVerticesTakeThePlaceOfTheLowestAndNoOtherMoves) {
  const Mesh halves = box_in_halves(40, {1e-4F, -2e-4F, 1e-4F});
  const Mesh closed = close_cracks(halves, 1e-3).mesh;
  EXPECT_TRUE(inspect(closed).closed());
  ASSERT_EQ(closed.triangles.size(), halves.triangles.size());
  for (std::size_t t = 0; t < closed.triangles.size(); ++t) {
    for (std::size_t corner = 0; corner < 3; ++corner) {
      const Vec3f before = halves.positions[halves.triangles[t][corner]];
      const Vec3f after = closed.positions[closed.triangles[t][corner]];
      EXPECT_LE(length(to_double(after) - to_double(before)), 3e-4);
      // The lower half comes first; of the upper one, only the corner that touches no rim keeps its place.
      const bool stays = t < 6 || before == Vec3f{40 + 1e-4F, 40 - 2e-4F, 40 + 1e-4F};
      EXPECT_EQ(after == before, stays) << t;
    }
  }
}

TEST(CloseCracks, NothingIsJoinedFurtherApartThanTheTolerance) {
  const Mesh halves = box_in_halves(40, {0.1F, 0, 0});
  const Repaired closed = close_cracks(halves, 0.05);
  EXPECT_EQ(closed.mesh.positions, halves.positions);
  EXPECT_TRUE(closed.notices.empty());
  EXPECT_TRUE(close_cracks(halves, 0).notices.empty());
}

// One side of a box is of two triangles, its neighbour has a vertex in the middle of their common edge.
TEST(CloseCracks, AnEdgeThatMeetsOthersInItsMiddleIsClosedWithoutMovingAnything) {
  for (const float off : {0.0F, 1e-4F}) {
    Mesh mesh = make_box({0, 0, 0}, {20, 20, 20});
    const Triangle t = mesh.triangles.front();
    const Vec3d a = to_double(mesh.positions[t[0]]), b = to_double(mesh.positions[t[1]]);
    const auto middle = static_cast<std::uint32_t>(mesh.positions.size());
    mesh.positions.push_back(to_float((a + b) * 0.5 + Vec3d{off, 0, 0}));
    mesh.triangles.front() = {t[0], middle, t[2]};
    mesh.triangles.push_back({middle, t[1], t[2]});
    ASSERT_EQ(inspect(mesh).open_edges, 3u);
    const Repaired closed = close_cracks(mesh, 1e-3);
    const Inspection inspection = inspect(closed.mesh);
    EXPECT_TRUE(inspection.closed());
    EXPECT_NEAR(inspection.volume, 8000, 1);
    EXPECT_EQ(closed.mesh.triangles.size(), mesh.triangles.size() + 1);
    ASSERT_EQ(closed.notices.size(), 1u);
    EXPECT_TRUE(contains(closed.notices[0], "by 1 triangle"));
  }
}

// A rim of a few long edges against one of many short ones, and corners that do not quite meet.
TEST(CloseCracks, RimsDividedDifferentlyAreClosed) {
  // A square in the plane of x, of triangles that meet in one corner, its opposite side cut at these heights.
  const auto square = [](const std::vector<double>& heights, double x) {
    std::vector<Vec3f> corners;
    const auto add = [&](Vec3d a, Vec3d b) {
      for (const Vec3d p : {a, b, Vec3d{x, 10, 0}}) corners.push_back(to_float(p));
    };
    for (std::size_t i = 0; i + 1 < heights.size(); ++i) add({x, 0, heights[i]}, {x, 0, heights[i + 1]});
    add({x, 0, heights.back()}, {x, 10, heights.back()});
    return corners;
  };
  std::vector<Vec3f> corners = square({0, 3, 7, 10}, 0), back = square({0, 2, 5, 6, 10}, 1e-5);
  for (std::size_t i = 0; i < back.size(); i += 3) std::swap(back[i + 1], back[i + 2]);
  corners.insert(corners.end(), back.begin(), back.end());
  const Mesh apart = weld(corners);
  ASSERT_EQ(inspect(apart).shells.size(), 2u);
  const Repaired closed = close_cracks(apart, 1e-3);
  EXPECT_EQ(inspect(closed.mesh).shells.size(), 1u);
  EXPECT_TRUE(inspect(closed.mesh).closed());
}

TEST(CloseCracks, AHoleStaysAHole) {
  Mesh mesh = make_uv_sphere(20, 30, 60);
  mesh.triangles.erase(mesh.triangles.begin() + 500, mesh.triangles.begin() + 502);
  const Inspection before = inspect(mesh);
  ASSERT_GT(before.open_edges, 0u);
  EXPECT_TRUE(close_cracks(mesh, 0.01).notices.empty());
  EXPECT_FALSE(find_crack(mesh));
}

TEST(FindCrack, TellsTwoRimsThatLieOnEachOtherAndHowFarApart) {
  const auto crack = find_crack(box_in_halves(40, {0.02F, 0.01F, 0}));
  ASSERT_TRUE(crack);
  EXPECT_GT(crack->rim.diameter, 60);
  EXPECT_NEAR(crack->width, std::hypot(0.02, 0.01), 1e-4);
  EXPECT_TRUE(inspect(close_cracks(box_in_halves(40, {0.02F, 0.01F, 0}), crack->weld).mesh).closed());
}

TEST(FindCrack, ItsWeldIsEnoughWhereEveryCornerIsElsewhere) {
  for (const double by : {1e-4, 1e-3, 5e-3}) {
    const Mesh apart = with_corners_apart(make_box({0, 0, 0}, {20, 20, 20}), by);
    const auto crack = find_crack(apart);
    ASSERT_TRUE(crack) << by;
    EXPECT_TRUE(inspect(close_cracks(apart, crack->weld).mesh).closed()) << by;
    EXPECT_LT(crack->weld, 20 * by);
  }
}

TEST(FindCrack, AnOpenBoxHasNone) {
  Mesh box = make_box({0, 0, 0}, {30, 30, 40});
  box.triangles.resize(box.triangles.size() - 2);
  EXPECT_FALSE(find_crack(box));
  EXPECT_FALSE(find_crack(make_box({0, 0, 0}, {30, 30, 40})));
}

TEST(UniteDoubles, BodiesInOnePlaceAreTakenOnce) {
  const Mesh box = make_box({0, 0, 0}, {20, 20, 20}), other = make_torus(40, 5, 30, 12);
  for (const auto& [doubled, expected] : {std::pair{join(box, box), box},
                                          {join(join(box, box), box), box},
                                          {join(join(box, other), box), join(box, other)}}) {
    std::vector<Vec3f> corners;
    for (const Triangle& t : doubled.triangles)
      for (const std::uint32_t v : t) corners.push_back(doubled.positions[v]);
    const Repaired single = unite_doubles(weld(corners));
    EXPECT_EQ(single.mesh.triangles.size(), expected.triangles.size());
    EXPECT_NEAR(signed_volume(single.mesh), signed_volume(expected), 1e-6);
    EXPECT_TRUE(inspect(single.mesh).closed());
    ASSERT_FALSE(single.notices.empty());
    EXPECT_TRUE(contains(single.notices[0], "taken once"));
  }
}

TEST(UniteDoubles, ASingleDoubledTriangleGoesWhereEdgesAgreeWithoutIt) {
  Mesh box = make_box({0, 0, 0}, {20, 20, 20});
  const std::vector<Triangle> sound = box.triangles;
  const Triangle t = box.triangles[4];
  box.triangles.push_back({t[1], t[2], t[0]});
  const Repaired single = unite_doubles(box);
  EXPECT_EQ(single.mesh.triangles.size(), sound.size());
  EXPECT_TRUE(inspect(single.mesh).closed());
  ASSERT_EQ(single.notices.size(), 1u);
  EXPECT_TRUE(contains(single.notices[0], "1 doubled triangle is left out"));
}

TEST(UniteDoubles, AFoldThatIsThereTwiceIsNoBody) {
  Mesh box = make_box({0, 0, 0}, {20, 20, 20});
  const Triangle t = box.triangles[4];
  for (int times = 0; times < 2; ++times) {
    box.triangles.push_back({t[0], t[2], t[1]});
    box.triangles.push_back(t);
  }
  ASSERT_TRUE(inspect(box).closed());
  EXPECT_EQ(unite_doubles(box).mesh.triangles, box.triangles);
}

TEST(UniteDoubles, ACavityThatFillsItsBodyIsNoDouble) {
  const Mesh box = make_box({0, 0, 0}, {20, 20, 20});
  EXPECT_TRUE(unite_doubles(join(box, turned_inside_out(box))).notices.empty());
}

// The same body with its squares divided the other way is another surface, and found by what it fills.
TEST(Inspect, ABodyDividedInTwoWaysInOnePlaceFillsItsPlaceOnce) {
  const Mesh box = make_box({0, 0, 0}, {20, 20, 20});
  Mesh other = box;
  for (std::size_t i = 0; i + 1 < other.triangles.size(); i += 2) {
    // Two triangles of a square: a b c, a c d become a b d, b c d.
    const Triangle first = box.triangles[i], second = box.triangles[i + 1];
    std::vector<std::uint32_t> shared;
    for (const std::uint32_t v : first)
      if (std::ranges::count(second, v) > 0) shared.push_back(v);
    const auto single = [&](const Triangle& t) {
      return static_cast<std::size_t>(
          std::ranges::find_if(t, [&](auto v) { return std::ranges::count(shared, v) == 0; }) - t.begin());
    };
    const std::size_t at = single(first);
    const std::uint32_t tip = first[at], next = first[(at + 1) % 3], last = first[(at + 2) % 3];
    const std::uint32_t far = second[single(second)];
    other.triangles[i] = {tip, next, far};
    other.triangles[i + 1] = {tip, far, last};
  }
  Mesh both = box;
  both.triangles.insert(both.triangles.end(), other.triangles.begin(), other.triangles.end());
  const Inspection inspection = inspect(both);
  ASSERT_TRUE(inspection.closed());
  EXPECT_NEAR(inspection.volume, 16000, 1e-6);
  EXPECT_NEAR(inspection.filled_volume, 8000, 80);
  EXPECT_TRUE(inspection.parts_overlap());
}

TEST(LostSurface, SeesAPartThatIsNotThereAndNoneThatIs) {
  const Mesh box = make_box({0, 0, 0}, {20, 20, 20}), rod = make_box({5, 5, 20}, {6, 6, 40});
  const Mesh model = join(box, rod);
  const SurfaceIndex surface(model);
  const LostSurface lost = find_lost_surface(model, surface, SurfaceIndex(box), 0.5);
  EXPECT_NEAR(lost.farthest, 20, 0.5);
  EXPECT_GT(lost.place.z, 39);
  EXPECT_NEAR(lost.area_share, 78.0 / (2400 + 82), 0.005);
  const LostSurface none = find_lost_surface(model, surface, surface, 0.5);
  EXPECT_EQ(none.farthest, 0);
  EXPECT_EQ(none.area_share, 0);
}

// What became solid is not lost.
TEST(LostSurface, AFilledCrackIsNoLoss) {
  const Mesh box = make_box({0, 0, 0}, {20, 20, 20});
  const Mesh cavity = turned_inside_out(make_box({5, 5, 9.9F}, {15, 15, 10.1F}));
  const Mesh model = join(box, cavity);
  EXPECT_EQ(find_lost_surface(model, SurfaceIndex(model), SurfaceIndex(box), 0.5).area_share, 0);
}

}  // namespace
}  // namespace aerate
