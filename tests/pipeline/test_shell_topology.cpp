#include <gtest/gtest.h>
#include <optional>
#include <string>
#include <utility>

#include "pipeline/shell_topology.h"
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

  // Two boxes that share a vertex.
  Mesh pinched = test::join(box, box);
  for (Triangle& t : pinched.triangles) {
    for (std::uint32_t& vertex : t) vertex = vertex == 8 ? 7 : vertex;
  }
  expect_flaw(pinched, "Euler characteristic is 3");
}

}  // namespace
}  // namespace aerate
