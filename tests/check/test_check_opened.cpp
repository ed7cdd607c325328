#include <cmath>
#include <cstdint>
#include <gtest/gtest.h>
#include <numbers>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "check/check_opened.h"
#include "core/error.h"
#include "files/weld.h"
#include "printing/cut_through.h"
#include "tests/support/caught.h"
#include "tests/support/shapes.h"

// Models whose own cavities were opened: what is right passes, and each way of being wrong is seen.
namespace aerate::test {
namespace {

constexpr double kTolerance = 0.05;

Mesh box_with_cavity() {
  return join(make_box({0, 0, 0}, {30, 30, 30}), turned_inside_out(make_box({3, 3, 3}, {27, 27, 27})));
}

OpenedSurface closed_surface(const Mesh& mesh) {
  OpenedSurface surface{mesh, std::vector<std::uint32_t>(mesh.triangles.size(), OpenedSurface::kOutside)};
  for (std::size_t t = 12; t < mesh.triangles.size(); ++t) surface.bounds[t] = 0;
  return surface;
}

const std::vector<Tube> kHoles{{{10, 12, 3}, {10, 12, 0}, 2}, {{27, 14, 20}, {30, 15, 21}, 1.5}};

Mesh opened_box() {
  OpenedSurface surface = closed_surface(box_with_cavity());
  for (const Tube& hole : kHoles) {
    auto cut = cut_through(surface, hole, 0, kTolerance);
    EXPECT_TRUE(cut.has_value());
    if (cut) surface = std::move(*cut);
  }
  return surface.mesh;
}

void check(const Mesh& model, const Mesh& opened, const std::vector<Tube>& holes) {
  Monitor monitor;
  check_opened({model, inspect(model), opened, inspect(opened), holes}, monitor);
}

TEST(CheckOpened, HolesThroughTheWallJoinTheCavityToTheOutside) {
  const Mesh model = box_with_cavity(), opened = opened_box();
  check(model, opened, kHoles);
  require_no_sealed_cavity(as_read_back(opened));
  // One surface with two ways through: a torus.
  const Inspection inspection = inspect(opened);
  EXPECT_EQ(inspection.shells.size(), 1U);
  EXPECT_TRUE(inspection.closed());
  EXPECT_EQ(find_self_intersections(opened).pair_count, 0U);
  // Inscribed prisms of 2 and 1.5 mm, the second along (3, 1, 1).
  const double removed = signed_volume(model) - signed_volume(opened);
  const double round = std::numbers::pi * (2 * 2 * 3 + 1.5 * 1.5 * std::sqrt(11.0));
  EXPECT_LT(removed, round);
  EXPECT_GT(removed, 0.97 * round);
}

TEST(CheckOpened, WhatIsWrongIsSeen) {
  const Mesh model = box_with_cavity(), opened = opened_box();
  const auto flaw = [&](const Mesh& mesh, const std::vector<Tube>& holes) {
    return message_of<FailureError>([&] { check(model, mesh, holes); });
  };
  EXPECT_TRUE(contains(flaw(model, {}), "1 of its own cavities are sealed"));
  EXPECT_TRUE(contains(flaw(model, kHoles), "Euler characteristic"));
  EXPECT_TRUE(contains(flaw(opened, {kHoles.front()}), "Euler characteristic"));
  Mesh open = opened;
  open.triangles.pop_back();
  EXPECT_TRUE(contains(flaw(open, kHoles), "open edges"));
  Mesh moved_vertex = opened;
  moved_vertex.positions.front().x -= 0.1F;
  EXPECT_TRUE(contains(flaw(moved_vertex, kHoles), "a vertex of the model moved"));
  std::vector<Tube> elsewhere = kHoles;
  elsewhere[0].start.x += 1;
  elsewhere[0].end.x += 1;
  EXPECT_TRUE(contains(flaw(opened, elsewhere), "outside of the holes"));
  EXPECT_TRUE(contains(message_of<FailureError>([&] { require_no_sealed_cavity(as_read_back(model)); }),
                       "1 cavities are sealed"));
}

TEST(CheckOpened, AWallThinnerThanTheHoleIsWideIsCutToo) {
  const Mesh thin =
      join(make_box({0, 0, 0}, {30, 30, 30}), turned_inside_out(make_box({0.6F, 3, 3}, {27, 27, 27})));
  const Tube hole{{0.6, 15, 15}, {0, 15, 15}, 2.5};
  const auto cut = cut_through(closed_surface(thin), hole, 0, kTolerance);
  ASSERT_TRUE(cut.has_value());
  check(thin, cut->mesh, {hole});
}

// The prism would come out through two sides of the cavity, or not at all.
TEST(CheckOpened, WhatCannotBeCutIsNot) {
  const OpenedSurface surface = closed_surface(box_with_cavity());
  EXPECT_FALSE(cut_through(surface, {{4, 15, 3}, {4, 15, 0}, 2}, 0, kTolerance).has_value());
  EXPECT_FALSE(cut_through(surface, {{1.5, 15, 3}, {1.5, 15, 0}, 1}, 0, kTolerance).has_value());
}

}  // namespace
}  // namespace aerate::test
