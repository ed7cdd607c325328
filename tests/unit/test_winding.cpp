#include <cmath>
#include <gtest/gtest.h>
#include <random>
#include <set>
#include <vector>

#include "kernels/exec_cpu.h"
#include "kernels/winding.h"
#include "tests/support/shapes.h"

namespace aerate {
namespace {

using kernels::HostWinding;

std::vector<int> winding_numbers(const Mesh& mesh, const std::vector<Vec3d>& points) {
  const HostWinding winding(mesh.positions, mesh.triangles);
  std::vector<int> numbers;
  for (const Vec3d& p : points) numbers.push_back(winding.view().winding_number(p));
  return numbers;
}

TEST(Winding, OfTwoOverlappingBoxesCountsThem) {
  const Mesh mesh = test::join(test::make_box({0, 0, 0}, {2, 2, 2}), test::make_box({1, 1, 1}, {3, 3, 3}));
  EXPECT_EQ(
      winding_numbers(mesh, {{0.5, 0.5, 0.5}, {1.5, 1.5, 1.5}, {2.5, 2.5, 2.5}, {2.5, 0.5, 0.5}, {-1, 0, 0}}),
      (std::vector<int>{1, 2, 1, 0, 0}));
}

TEST(Winding, OfACavityIsZeroAndOfAnInsideOutBoxMinusOne) {
  const Mesh cavity = test::join(test::make_box({0, 0, 0}, {4, 4, 4}),
                                 test::turned_inside_out(test::make_box({1, 1, 1}, {3, 3, 3})));
  EXPECT_EQ(winding_numbers(cavity, {{2, 2, 2}, {0.5, 2, 2}, {2, 2, 3.5}}), (std::vector<int>{0, 1, 1}));
  const Mesh turned = test::turned_inside_out(test::make_box({0, 0, 0}, {4, 4, 4}));
  EXPECT_EQ(winding_numbers(turned, {{2, 2, 2}}), std::vector<int>{-1});
}

// Rays through vertices and edges: an octahedron whose vertices and edges lie on the queried rays.
TEST(Winding, RaysThroughVerticesAndEdgesAreCountedOnce) {
  Mesh mesh;
  mesh.positions = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
  mesh.triangles = {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4}, {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}};
  const HostWinding winding(mesh.positions, mesh.triangles);
  for (int ix = -8; ix <= 8; ++ix) {
    for (int iy = -8; iy <= 8; ++iy) {
      for (int iz = -8; iz <= 8; ++iz) {
        const Vec3d p{ix / 8.0, iy / 8.0, iz / 8.0 + 1.0 / 64};
        const double norm = std::abs(p.x) + std::abs(p.y) + std::abs(p.z);
        EXPECT_EQ(winding.view().winding_number(p), norm < 1 ? 1 : 0) << p.x << ' ' << p.y << ' ' << p.z;
      }
    }
  }
}

// The oracle: the same crossing rule without the column index.
TEST(Winding, IndexAgreesWithBruteForceOnSerialAndParallelExecutors) {
  std::mt19937 random(7);
  std::uniform_real_distribution<float> coordinate(-1, 1);
  Mesh mesh;
  for (int shell = 0; shell < 40; ++shell) {
    const Vec3f corner{coordinate(random), coordinate(random), coordinate(random)};
    mesh = test::join(mesh, test::make_box(corner, corner + Vec3f{0.5F, 0.25F, 0.75F}));
  }
  const HostWinding winding(mesh.positions, mesh.triangles);
  const kernels::SerialExecutor serial;
  const auto facets = kernels::gather_facets(serial, mesh.positions, mesh.triangles);
  const auto serial_index = kernels::build_winding_index(serial, facets.view(), winding.view().box);
  std::set<int> seen;
  for (int query = 0; query < 5000; ++query) {
    const Vec3d p = to_double({coordinate(random), coordinate(random), coordinate(random)}) * 1.5;
    int expected = 0;
    for (std::size_t i = 0; i < facets.size(); ++i) {
      expected += kernels::winding_detail::facet_crossing(facets.view()[i], p);
    }
    ASSERT_EQ(winding.view().winding_number(p), expected);
    ASSERT_EQ(serial_index.view.winding_number(p), expected);
    seen.insert(expected);
  }
  EXPECT_GE(seen.size(), 3U) << "the scene should have overlaps";
}

}  // namespace
}  // namespace aerate
