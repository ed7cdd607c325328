#include <algorithm>
#include <gtest/gtest.h>

#include "mesh/inspect.h"
#include "pipeline/scene_of.h"
#include "tests/support/shapes.h"

namespace aerate::test {
namespace {

Scene inspected(const Mesh& mesh) {
  InspectReport report;
  report.input.path = "somewhere/model.stl";
  report.input.inspection = inspect(mesh);
  return scene_of(mesh, report);
}

std::size_t count_of(const Scene& scene, MarkKind kind) {
  return static_cast<std::size_t>(std::ranges::count(scene.marks, kind, &SceneMark::kind));
}

const SceneMark& first_of(const Scene& scene, MarkKind kind) {
  return *std::ranges::find(scene.marks, kind, &SceneMark::kind);
}

// A cube of 40 mm with a hollow of 30 x 30 x 20 mm, 2 mm below its top: flat on top, which nothing bridges.
TEST(SceneOf, SealedHollowsAreVoidsWithTheirWallsAndCeilings) {
  const Mesh mesh =
      join(turned_inside_out(make_box({5, 5, 18}, {35, 35, 38})), make_box({0, 0, 0}, {40, 40, 40}));
  const Scene scene = inspected(mesh);
  EXPECT_TRUE(scene.is_closed);
  EXPECT_EQ(scene.title, "model.stl");
  EXPECT_EQ(scene.void_use, VoidUse::found);
  ASSERT_EQ(scene.voids.size(), 1U);
  EXPECT_NEAR(scene.voids[0].volume, 30 * 30 * 20, 1e-3);
  EXPECT_NEAR(scene.voids[0].wall.value(), 2, 1e-6);
  // The hollow comes last, though it was first in the file.
  ASSERT_EQ(scene.parts.size(), 2U);
  EXPECT_EQ(scene.parts[1].kind, PartKind::void_surface);
  EXPECT_EQ(scene.parts[1].end(), mesh.triangles.size());
  ASSERT_EQ(count_of(scene, MarkKind::ceiling), 1U);
  const SceneMark& ceiling = first_of(scene, MarkKind::ceiling);
  EXPECT_NEAR(length(ceiling.place - Vec3d{20, 20, 38}), 0, 1e-3);
  EXPECT_NE(ceiling.text.find("30.0 mm wide"), std::string::npos) << ceiling.text;
  ASSERT_EQ(count_of(scene, MarkKind::thinnest_wall), 1U);
  EXPECT_NEAR(first_of(scene, MarkKind::thinnest_wall).place.z, 38, 1e-6);
}

TEST(SceneOf, RimsOfHolesAreMarked) {
  Mesh mesh = make_box({0, 0, 0}, {10, 10, 10});
  mesh.triangles.erase(mesh.triangles.begin() + 2, mesh.triangles.begin() + 4);  // the top
  const Scene scene = inspected(mesh);
  EXPECT_FALSE(scene.is_closed);
  EXPECT_TRUE(scene.voids.empty());
  ASSERT_EQ(scene.marks.size(), 1U);
  EXPECT_EQ(scene.marks[0].kind, MarkKind::hole_in_mesh);
  EXPECT_EQ(scene.marks[0].lines.size(), 4U);
  EXPECT_NEAR(length(scene.marks[0].place - Vec3d{5, 5, 10}), 0, 1e-6);
  for (const auto& [from, to] : scene.marks[0].lines) {
    EXPECT_EQ(from.z, 10);
    EXPECT_EQ(to.z, 10);
  }
}

// Two fins, each at an edge that has two triangles already.
TEST(SceneOf, EdgesThatHangTogetherAreOneMark) {
  Mesh mesh = make_box({0, 0, 0}, {10, 10, 10});
  mesh.positions.push_back({5, -5, -5});
  mesh.positions.push_back({5, 15, 15});
  mesh.triangles.push_back({0, 1, 8});
  mesh.triangles.push_back({6, 7, 9});
  const Scene scene = inspected(mesh);
  EXPECT_EQ(count_of(scene, MarkKind::bad_edges), 2U);
  EXPECT_EQ(first_of(scene, MarkKind::bad_edges).lines.size(), 1U);
}

TEST(SceneOf, AModelThatIsInsideOutHasNoHollow) {
  const Scene scene = inspected(turned_inside_out(make_box({0, 0, 0}, {10, 10, 10})));
  EXPECT_TRUE(scene.voids.empty());
  EXPECT_EQ(scene.parts.size(), 1U);
  EXPECT_TRUE(scene.marks.empty());
}

}  // namespace
}  // namespace aerate::test
