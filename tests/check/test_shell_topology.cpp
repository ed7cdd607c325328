#include <algorithm>
#include <cstdint>
#include <gtest/gtest.h>
#include <numeric>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "check/shell_topology.h"
#include "tests/support/caught.h"
#include "tests/support/shapes.h"

namespace aerate {
namespace {

using test::contains;

TEST(ShellTopology, SpheresAndBoxesAreSound) {
  EXPECT_EQ(flaw_of_sphere_shell(test::make_box({0, 0, 0}, {1, 1, 1}).triangles), std::nullopt);
  EXPECT_EQ(flaw_of_sphere_shell(test::make_uv_sphere(1, 10, 20).triangles), std::nullopt);
  EXPECT_EQ(flaw_of_sphere_shell(test::turned_inside_out(test::make_uv_sphere(1, 5, 7)).triangles),
            std::nullopt);
}

TEST(ShellTopology, NumbersOfVerticesMayBeginAnywhere) {
  Mesh sphere = test::make_uv_sphere(1, 6, 6);
  for (Triangle& t : sphere.triangles) t = {t[0] + 1000, t[1] + 1000, t[2] + 1000};
  EXPECT_EQ(flaw_of_sphere_shell(sphere.triangles), std::nullopt);
}

void expect_flaw(const Mesh& mesh, const std::string& said) {
  const auto flaw = flaw_of_sphere_shell(mesh.triangles);
  ASSERT_TRUE(flaw.has_value()) << "no flaw found; expected: " << said;
  EXPECT_TRUE(contains(*flaw, said));
}

TEST(ShellTopology, FindsEachFlaw) {
  const Mesh box = test::make_box({0, 0, 0}, {1, 1, 1});
  expect_flaw({}, "no triangles");

  Mesh open = box;
  open.triangles.pop_back();
  expect_flaw(open, "open");

  Mesh twisted = box;
  std::swap(twisted.triangles[0][0], twisted.triangles[0][1]);
  expect_flaw(twisted, "opposite ways");

  Mesh repeated = box;
  repeated.triangles.push_back({0, 0, 1});
  expect_flaw(repeated, "twice");

  expect_flaw(test::join(box, box), "more than one shell");
  expect_flaw(test::make_torus(3, 1, 12, 8), "Euler characteristic is 0");

  // Two boxes that share a vertex, and two that share opposite ones, whose Euler characteristic is 2.
  Mesh pinched = test::join(box, box);
  const auto join_vertices = [&](std::uint32_t kept, std::uint32_t gone) {
    for (Triangle& t : pinched.triangles) std::replace(t.begin(), t.end(), gone, kept);
  };
  join_vertices(7, 8);
  expect_flaw(pinched, "more than one shell");
  join_vertices(0, 15);
  expect_flaw(pinched, "more than one shell");
}

TEST(ShellTopology, FindsASphereThatTouchesItself) {
  // Poles of a sphere made one vertex.
  Mesh sphere = test::make_uv_sphere(1, 8, 12);
  const auto by_height = [&](std::uint32_t a, std::uint32_t b) {
    return sphere.positions[a].z < sphere.positions[b].z;
  };
  std::vector<std::uint32_t> vertices(sphere.positions.size());
  std::iota(vertices.begin(), vertices.end(), 0U);
  const auto [south, north] = std::minmax_element(vertices.begin(), vertices.end(), by_height);
  for (Triangle& t : sphere.triangles) std::replace(t.begin(), t.end(), *north, *south);
  expect_flaw(sphere, "Euler characteristic is 1");
}

// One vertex in the place of two.
Mesh with_joined(Mesh mesh, std::uint32_t kept, std::uint32_t gone) {
  for (Triangle& t : mesh.triangles) std::replace(t.begin(), t.end(), gone, kept);
  return mesh;
}

// Euler characteristics are those of what is not pinched less one for each pinch, also where they look sound.
TEST(ShellTopology, CountsPinches) {
  const auto expect = [](const Mesh& mesh, std::size_t shells, std::int64_t euler, std::size_t pinches) {
    const SurfaceTopology topology = topology_of(mesh.triangles);
    EXPECT_EQ(topology.flaw, std::nullopt);
    EXPECT_EQ(topology.shell_count, shells);
    EXPECT_EQ(topology.euler, euler);
    EXPECT_EQ(topology.pinch_count, pinches);
  };
  const Mesh box = test::make_box({0, 0, 0}, {1, 1, 1});
  const Mesh two = test::join(box, box), torus = test::make_torus(3, 1, 12, 8);
  expect(box, 1, 2, 0);
  expect(two, 2, 4, 0);
  expect(torus, 1, 0, 0);
  expect(with_joined(two, 7, 8), 2, 3, 1);
  expect(with_joined(with_joined(two, 7, 8), 0, 15), 2, 2, 2);  // as a box
  expect(with_joined(torus, 0, 50), 1, -1, 1);
  const Mesh box_and_torus = test::join(box, torus);
  expect(box_and_torus, 2, 2, 0);  // again
  expect(with_joined(box_and_torus, 7, 8), 2, 1, 1);
}

}  // namespace
}  // namespace aerate
