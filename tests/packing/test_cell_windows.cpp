#include <gtest/gtest.h>
#include <utility>
#include <vector>

#include "packing/cells/cell_drainage_faces.h"
#include "packing/cells/cell_windows.h"
#include "tests/packing/cell_boxes.h"

namespace aerate::test {
namespace {

TEST(DiscPlaces, AreTheLowestAndTheHighestExactly) {
  const Mesh surface = make_box({0, 0, 0}, {10, 8, 6});
  const CellPlane plane{{1, 0, 0}, 10, 0};
  const TubeFrame frame = frame_of({{0, 0, 0}, plane.normal, 1}, {0, 0, 1});
  const FlatFace face = flat_face(surface, plane, frame);
  ASSERT_EQ(face.triangles.size(), 2U);
  ASSERT_EQ(face.rim.size(), 4U);
  const DiscPlaces places(face, face, 1.3, 0.17);
  const std::vector<Flat> chosen = places.choose(2, false);
  ASSERT_GE(chosen.size(), 3U);
  EXPECT_NEAR(dot(frame.down * chosen[0].y, Vec3d{0, 0, 1}), 1.3, 0.01);
  EXPECT_NEAR(dot(frame.down * chosen[1].y, Vec3d{0, 0, 1}), 6 - 1.3, 0.01);
  EXPECT_TRUE(DiscPlaces(face, face, 3.01, 0.17).choose(2, false).empty());
}

TEST(CellWindows, AWindowLiesAsLowAsBothFacesAllow) {
  std::vector<Box> boxes = equal_boxes(2, 19.5);
  boxes[1].lower.z = 5;  // its face begins higher
  const Mesh model = block_round(boxes);
  const CellVoids cells = row_of(boxes);
  const PlannedCellDrainage planned = plan(model, cells);
  ASSERT_EQ(planned.kept, (std::vector<std::uint32_t>{0, 1}));
  EXPECT_EQ(planned.dropped.count(), 0U);
  ASSERT_FALSE(planned.plan.channels.empty());
  const Channel& window = planned.plan.channels.front();
  EXPECT_EQ(std::pair(window.from, window.to), std::pair(0U, 1U));
  EXPECT_NEAR(window.tube.start.x, 21.25, 1e-6);
  EXPECT_NEAR(window.tube.end.x, 22.75, 1e-6);
  EXPECT_NEAR(window.tube.start.y, window.tube.end.y, 1e-9);
  EXPECT_NEAR(window.tube.start.z, 5 + 1.5 + kWindowMargin, 0.01);
  EXPECT_NEAR(window.tube.end.z, window.tube.start.z, 1e-9);
  expect_sound(model, cells, planned, boxes);
  EXPECT_EQ(planned.plan.network_count, 1U);
  EXPECT_EQ(planned.plan.holes.size(), 2U);
}

// A box of which the right or left face leans: x changes by `lean` for each millimetre of z.
Mesh leaning_box(const Box& box, bool leans_right, double lean) {
  Mesh mesh = turned_inside_out(make_box(to_float(box.lower), to_float(box.upper)));
  for (Vec3f& p : mesh.positions) {
    const Vec3d at = to_double(p);
    if (at.x == (leans_right ? box.upper.x : box.lower.x))
      p = to_float(at + Vec3d{lean * (at.z - box.lower.z), 0, 0});
  }
  return mesh;
}

TEST(CellWindows, AWindowInALeaningWallIsPerpendicularToIt) {
  constexpr double kLean = 0.75;
  const Vec3d normal{0.8, 0, -0.6};
  std::vector<Box> boxes{{{2, 2, 2}, {22, 22, 22}}, {{23.25, 2, 2}, {50, 22, 22}}};  // a gap apart
  CellVoids cells = row_of(boxes);
  for (std::uint32_t i = 0; i < 2; ++i) {
    cells.voids[i].surface = leaning_box(boxes[i], i == 0, kLean);
    const Vec3d on_face = i == 0 ? Vec3d{22, 0, 2} : Vec3d{23.25, 0, 2};
    CellPlane& plane = cells.planes.planes[i];
    plane.normal = i == 0 ? normal : -normal;
    plane.offset = dot(plane.normal, on_face);
    Box around = boxes[i];
    around.upper.x = 50;
    cells.voids[i].nodes =
        runs_where(around, [&](Vec3d p) { return around.holds(p) && dot(plane.normal, p) < plane.offset; });
  }
  const Mesh model = block_round(boxes);
  const PlannedCellDrainage planned = plan(model, cells);
  ASSERT_EQ(planned.kept.size(), 2U);
  ASSERT_GE(planned.plan.channels.size(), 1U);
  for (const Channel& channel : planned.plan.channels) {
    EXPECT_NEAR(dot(direction_of(channel.tube), normal), 1, 1e-9);
    EXPECT_NEAR(dot(normal, channel.tube.start), cells.planes.planes[0].offset - 0.25, 1e-6);
    EXPECT_NEAR(dot(normal, channel.tube.end), cells.planes.planes[0].offset + 1.25, 1e-6);
  }
  // On the first face the lower edge of the second shows 0.6 mm higher, along the wall 0.75.
  const Tube& tube = planned.plan.channels[0].tube;
  const double on_face = tube.start.z - 0.25 * 0.6 - 2;
  EXPECT_NEAR(on_face, (1.5 + kWindowMargin + 0.75) * 0.8, 0.01);
}

}  // namespace
}  // namespace aerate::test
