#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <gtest/gtest.h>
#include <map>
#include <numbers>
#include <random>
#include <set>
#include <string>
#include <tbb/global_control.h>
#include <utility>
#include <vector>

#include "files/load.h"
#include "mesh/inspect.h"
#include "tests/support/shapes.h"

namespace aerate {
namespace {

using test::join;
using test::make_box;
using test::turned_inside_out;

Mesh unit_box() {
  return make_box({0, 0, 0}, {1, 1, 1});
}

TEST(Inspect, SoundBox) {
  const Inspection box = inspect(make_box({-1, 0, 2}, {1, 3, 6}));
  EXPECT_TRUE(box.closed());
  EXPECT_EQ(box.vertex_count, 8u);
  EXPECT_EQ(box.triangle_count, 12u);
  EXPECT_NEAR(box.volume, 24, 1e-12);
  EXPECT_EQ(box.filled_volume, box.volume);
  EXPECT_EQ(box.overlapped_volume, 0);
  EXPECT_NEAR(box.area, 2 * (6 + 8 + 12), 1e-12);
  EXPECT_EQ(box.box.lower, (Vec3f{-1, 0, 2}));
  EXPECT_EQ(box.box.upper, (Vec3f{1, 3, 6}));
  EXPECT_EQ(box.open_edges + box.misoriented_edges + box.non_manifold_edges, 0u);
  EXPECT_EQ(box.degenerate_triangles + box.duplicate_triangles, 0u);
  EXPECT_TRUE(box.boundary_loops.empty());
  ASSERT_EQ(box.shells.size(), 1u);
  EXPECT_TRUE(box.shells[0].closed);
  EXPECT_EQ(box.shells[0].triangle_count, 12u);
}

TEST(Inspect, NothingAtAll) {
  const Inspection nothing = inspect(Mesh{});
  EXPECT_EQ(nothing.triangle_count, 0u);
  EXPECT_TRUE(nothing.shells.empty());
}

TEST(Inspect, OpenBoxNamesItsHole) {
  Mesh mesh = make_box({0, 0, 0}, {4, 2, 3});
  mesh.triangles.erase(mesh.triangles.begin() + 2, mesh.triangles.begin() + 4);  // the face at z = 3
  const Inspection open = inspect(mesh);
  EXPECT_FALSE(open.closed());
  EXPECT_EQ(open.open_edges, 4u);
  ASSERT_EQ(open.boundary_loops.size(), 1u);
  EXPECT_EQ(open.boundary_loops[0].edge_count, 4u);
  EXPECT_NEAR(length(open.boundary_loops[0].centre - Vec3d{2, 1, 3}), 0, 1e-12);
  EXPECT_NEAR(open.boundary_loops[0].diameter, std::hypot(4.0, 2.0), 1e-6);
  ASSERT_EQ(open.shells.size(), 1u);
  EXPECT_FALSE(open.shells[0].closed);
}

TEST(Inspect, HolesAreListedTheLargestFirst) {
  Mesh small = unit_box();
  small.triangles.erase(small.triangles.begin());
  Mesh large = make_box({10, 0, 0}, {15, 5, 5});
  large.triangles.erase(large.triangles.begin(), large.triangles.begin() + 2);
  const Inspection open = inspect(join(small, large));
  ASSERT_EQ(open.boundary_loops.size(), 2u);
  EXPECT_EQ(open.boundary_loops[0].edge_count, 4u);
  EXPECT_GT(open.boundary_loops[0].centre.x, 9);
  EXPECT_EQ(open.boundary_loops[1].edge_count, 3u);
}

TEST(Inspect, HolesThatMeetInAVertexAreTwo) {
  Mesh mesh = unit_box();
  // One triangle of the bottom and one of the top share no vertex; these two share vertex 0 only.
  const Mesh whole = mesh;
  mesh.triangles.clear();
  for (std::size_t t = 0; t < whole.triangles.size(); ++t) {
    if (whole.triangles[t] != Triangle{0, 2, 3} && whole.triangles[t] != Triangle{0, 1, 5}) {
      mesh.triangles.push_back(whole.triangles[t]);
    }
  }
  const Inspection open = inspect(mesh);
  EXPECT_EQ(open.open_edges, 6u);
  ASSERT_EQ(open.boundary_loops.size(), 2u);
  EXPECT_EQ(open.boundary_loops[0].edge_count, 3u);
  EXPECT_EQ(open.boundary_loops[1].edge_count, 3u);
}

TEST(Inspect, FlippedTriangleIsMisorientedNotOpen) {
  Mesh mesh = unit_box();
  std::swap(mesh.triangles[5][1], mesh.triangles[5][2]);
  const Inspection flipped = inspect(mesh);
  EXPECT_FALSE(flipped.closed());
  EXPECT_EQ(flipped.open_edges, 0u);
  EXPECT_EQ(flipped.misoriented_edges, 3u);
  EXPECT_EQ(flipped.non_manifold_edges, 0u);
}

TEST(Inspect, DuplicateTriangles) {
  Mesh mesh = unit_box();
  const Triangle t = mesh.triangles[3];
  mesh.triangles.push_back({t[1], t[2], t[0]});
  mesh.triangles.push_back(t);
  mesh.triangles.push_back({t[0], t[2], t[1]});  // the other way round: no duplicate
  const Inspection result = inspect(mesh);
  EXPECT_EQ(result.duplicate_triangles, 2u);
  EXPECT_EQ(result.non_manifold_edges, 3u);
  EXPECT_EQ(result.misoriented_edges, 3u);
}

TEST(Inspect, DegenerateTrianglesDoNotOpenAMesh) {
  Mesh mesh = unit_box();
  mesh.triangles.push_back({0, 0, 1});
  mesh.triangles.push_back({2, 2, 2});
  const Inspection result = inspect(mesh);
  EXPECT_TRUE(result.closed());
  EXPECT_EQ(result.degenerate_triangles, 2u);
  EXPECT_EQ(result.non_manifold_edges, 0u);
  ASSERT_EQ(result.shells.size(), 1u);
  EXPECT_EQ(result.shells[0].triangle_count, 13u);
}

TEST(Inspect, CollinearCornersAreDegenerate) {
  Mesh mesh;
  mesh.positions = {
      {0.1f, 0.1f, 0.1f}, {0.2f, 0.2f, 0.2f}, {0.4f, 0.4f, 0.4f}, {0.4f, 0.4f, std::nextafter(0.4f, 1.0f)}};
  mesh.triangles = {{0, 1, 2}, {0, 1, 3}};
  EXPECT_EQ(inspect(mesh).degenerate_triangles, 1u);
}

TEST(Inspect, DoubledEdgesDoNotOpenAMesh) {
  // Two boxes that share an edge, welded: four triangles at that edge.
  Mesh mesh = join(unit_box(), make_box({1, 1, 0}, {2, 2, 1}));
  for (Triangle& t : mesh.triangles) {
    for (std::uint32_t& v : t) {
      if (v == 8) v = 3;
      if (v == 12) v = 7;
    }
  }
  const Inspection result = inspect(mesh);
  EXPECT_TRUE(result.closed());
  EXPECT_EQ(result.non_manifold_edges, 1u);
  EXPECT_EQ(result.shells.size(), 1u);
  EXPECT_NEAR(result.volume, 2, 1e-12);
}

TEST(Inspect, InsideOutBoxFillsItsVolumeAllTheSame) {
  const Inspection result = inspect(turned_inside_out(make_box({0, 0, 0}, {2, 2, 2})));
  EXPECT_TRUE(result.closed());
  EXPECT_NEAR(result.volume, -8, 1e-12);
  EXPECT_NEAR(result.overlapped_volume, 8, 1e-9);
  EXPECT_NEAR(result.filled_volume, 8, 1e-9);
}

TEST(Inspect, CavityIsNoOverlap) {
  const Inspection result =
      inspect(join(turned_inside_out(make_box({1, 1, 1}, {2, 3, 2})), make_box({0, 0, 0}, {4, 4, 4})));
  ASSERT_EQ(result.shells.size(), 2u);
  EXPECT_NEAR(result.shells[0].volume, 64, 1e-9);
  EXPECT_NEAR(result.shells[1].volume, -2, 1e-9);
  EXPECT_NEAR(result.volume, 62, 1e-9);
  EXPECT_EQ(result.filled_volume, result.volume);
  EXPECT_EQ(result.overlapped_volume, 0);
  EXPECT_EQ(result.overlapping_shells, 0u);
}

TEST(Inspect, OverlappingBoxes) {
  // 3 x 4 x 5 of overlap; a third box stands apart.
  const Mesh mesh = join(join(make_box({0, 0, 0}, {10, 10, 10}), make_box({7, 6, 5}, {20, 30, 20})),
                         make_box({-10, -10, -10}, {-8, -8, -8}));
  const Inspection result = inspect(mesh);
  EXPECT_EQ(result.shells.size(), 3u);
  EXPECT_EQ(result.overlapping_shells, 2u);
  EXPECT_NEAR(result.overlapped_volume, 60, 60 * 0.02);
  EXPECT_NEAR(result.filled_volume, 1000 + 13 * 24 * 15 + 8 - 60, 60 * 0.02);
}

TEST(Inspect, SolidInsideASolidIsOverlap) {
  const Inspection result = inspect(join(make_box({0, 0, 0}, {10, 10, 10}), make_box({4, 4, 4}, {6, 6, 6})));
  EXPECT_NEAR(result.overlapped_volume, 8, 8 * 0.02);
  EXPECT_NEAR(result.filled_volume, 1000, 8 * 0.02);
  EXPECT_EQ(result.overlapping_shells, 1u);  // the outer one bounds no doubled volume
}

TEST(Inspect, BoxesThatTouchDoNotOverlap) {
  for (const Mesh& second : {make_box({1, 0, 0}, {2, 1, 1}), make_box({0, 0, 1}, {1, 1, 2}),
                             make_box({0.25f, 0.3f, 1}, {0.7f, 0.9f, 1.7f})}) {
    const Inspection result = inspect(join(unit_box(), second));
    EXPECT_EQ(result.overlapped_volume, 0);
    EXPECT_EQ(result.overlapping_shells, 0u);
    EXPECT_EQ(result.filled_volume, result.volume);
  }
}

TEST(Inspect, OverlapOfBallsAgreesWithItsFormula) {
  const auto ball = [](Vec3d centre, double radius) {
    Mesh mesh;
    constexpr std::uint32_t kRows = 60, kColumns = 120;
    mesh.positions.push_back(to_float(centre + Vec3d{0, 0, radius}));
    for (std::uint32_t row = 1; row < kRows; ++row) {
      const double polar = std::numbers::pi * row / kRows;
      for (std::uint32_t column = 0; column < kColumns; ++column) {
        const double angle = 2 * std::numbers::pi * column / kColumns;
        mesh.positions.push_back(
            to_float(centre + Vec3d{radius * std::sin(polar) * std::cos(angle),
                                    radius * std::sin(polar) * std::sin(angle), radius * std::cos(polar)}));
      }
    }
    const auto last = static_cast<std::uint32_t>(mesh.positions.size());
    mesh.positions.push_back(to_float(centre - Vec3d{0, 0, radius}));
    const auto at = [&](std::uint32_t row, std::uint32_t column) {
      return 1 + (row - 1) * kColumns + column % kColumns;
    };
    for (std::uint32_t column = 0; column < kColumns; ++column) {
      mesh.triangles.push_back({0, at(1, column), at(1, column + 1)});
      mesh.triangles.push_back({last, at(kRows - 1, column + 1), at(kRows - 1, column)});
      for (std::uint32_t row = 1; row + 1 < kRows; ++row) {
        mesh.triangles.push_back({at(row, column), at(row + 1, column), at(row + 1, column + 1)});
        mesh.triangles.push_back({at(row, column), at(row + 1, column + 1), at(row, column + 1)});
      }
    }
    return mesh;
  };
  const double r = 5, d = 6;
  const Inspection result = inspect(join(ball({0, 0, 0}, r), ball({d / 3, d * 2 / 3, d * 2 / 3}, r)));
  const double lens = std::numbers::pi * (4 * r + d) * (2 * r - d) * (2 * r - d) / 12;
  EXPECT_NEAR(result.overlapped_volume, lens, lens * 0.01);
  EXPECT_EQ(result.overlapping_shells, 2u);
}

TEST(Inspect, FlatMeshesHaveNoVolume) {
  for (const Vec3f size : {Vec3f{0, 1, 2}, Vec3f{1, 0, 2}, Vec3f{1, 2, 0}, Vec3f{0, 0, 0}}) {
    const Mesh flat = make_box({3, 3, 3}, Vec3f{3, 3, 3} + size);
    for (const Mesh& mesh : {flat, join(flat, flat), turned_inside_out(flat)}) {
      const Inspection result = inspect(mesh);
      EXPECT_TRUE(result.closed());
      EXPECT_EQ(result.volume, 0);
      EXPECT_EQ(result.filled_volume, 0);
      EXPECT_EQ(result.overlapped_volume, 0);
    }
  }
}

TEST(Inspect, OneTriangle) {
  Mesh mesh;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  mesh.triangles = {{0, 1, 2}};
  const Inspection result = inspect(mesh);
  EXPECT_EQ(result.open_edges, 3u);
  ASSERT_EQ(result.boundary_loops.size(), 1u);
  EXPECT_EQ(result.boundary_loops[0].edge_count, 3u);
}

// ---- against brute force

struct Expected {
  std::size_t open = 0, misoriented = 0, non_manifold = 0, duplicates = 0, shells = 0;
};

Expected by_maps(const Mesh& mesh) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::pair<int, int>> edges;
  std::set<Triangle> seen;
  std::vector<std::size_t> proper;
  Expected expected;
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    Triangle t = mesh.triangles[i];
    if (t[0] == t[1] || t[1] == t[2] || t[2] == t[0]) continue;
    proper.push_back(i);
    for (std::size_t c = 0; c < 3; ++c) {
      const auto from = t[c], to = t[(c + 1) % 3];
      auto& [forward, backward] = edges[{std::min(from, to), std::max(from, to)}];
      ++(from < to ? forward : backward);
    }
    std::rotate(t.begin(), std::min_element(t.begin(), t.end()), t.end());
    if (!seen.insert(t).second) ++expected.duplicates;
  }
  for (const auto& [edge, uses] : edges) {
    const int count = uses.first + uses.second;
    if (count == 1) ++expected.open;
    if (count > 1 && uses.first != uses.second) ++expected.misoriented;
    if (count > 2) ++expected.non_manifold;
  }
  // Shells by flooding over shared edges, repeated vertices included as bridges.
  const auto share_edge = [&](const Triangle& a, const Triangle& b) {
    std::set<std::pair<std::uint32_t, std::uint32_t>> of_a;
    for (std::size_t c = 0; c < 3; ++c) of_a.insert(std::minmax(a[c], a[(c + 1) % 3]));
    for (std::size_t c = 0; c < 3; ++c) {
      if (b[c] != b[(c + 1) % 3] && of_a.contains(std::minmax(b[c], b[(c + 1) % 3]))) return true;
    }
    return false;
  };
  std::vector<bool> reached(mesh.triangles.size(), false);
  for (const std::size_t start : proper) {
    if (reached[start]) continue;
    ++expected.shells;
    std::vector<std::size_t> stack{start};
    reached[start] = true;
    while (!stack.empty()) {
      const std::size_t t = stack.back();
      stack.pop_back();
      for (std::size_t other = 0; other < mesh.triangles.size(); ++other) {
        if (!reached[other] && share_edge(mesh.triangles[t], mesh.triangles[other])) {
          reached[other] = true;
          stack.push_back(other);
        }
      }
    }
  }
  return expected;
}

TEST(Inspect, AgreesWithBruteForceOnRandomTriangles) {
  std::mt19937 random(3);
  const auto below = [&](std::size_t limit) { return static_cast<std::uint32_t>(random() % limit); };
  for (int round = 0; round < 300; ++round) {
    const std::uint32_t vertices = 4 + below(12);
    Mesh mesh;
    for (std::uint32_t v = 0; v < vertices; ++v) {
      mesh.positions.push_back(
          {static_cast<float>(below(100)), static_cast<float>(below(100)), static_cast<float>(below(100))});
    }
    for (std::size_t t = 1 + below(40); t > 0; --t) {
      mesh.triangles.push_back({below(vertices), below(vertices), below(vertices)});
    }
    const Expected expected = by_maps(mesh);
    const Inspection result = inspect(mesh);
    EXPECT_EQ(result.open_edges, expected.open);
    EXPECT_EQ(result.misoriented_edges, expected.misoriented);
    EXPECT_EQ(result.non_manifold_edges, expected.non_manifold);
    EXPECT_EQ(result.duplicate_triangles, expected.duplicates);
    EXPECT_EQ(result.shells.size(), expected.shells);
    std::size_t chained = 0;
    for (const BoundaryLoop& loop : result.boundary_loops) chained += loop.edge_count;
    EXPECT_EQ(chained, expected.open) << "every open edge is in one loop";
  }
}

// ---- real models

class InspectReal : public testing::TestWithParam<std::string> {
 protected:
  void SetUp() override {
    path_ = std::filesystem::path(AERATE_SHARED) / "models" / GetParam();
    if (!std::filesystem::exists(path_)) GTEST_SKIP() << path_ << " is not there";
    mesh_ = load_model(path_).mesh;
  }

  std::filesystem::path path_;
  Mesh mesh_;
};

TEST_P(InspectReal, IsClosedThoughFlawed) {
  const Inspection result = inspect(mesh_);
  EXPECT_TRUE(result.closed());
  EXPECT_TRUE(result.boundary_loops.empty());
  EXPECT_GT(result.volume, 0);
}

TEST_P(InspectReal, IsTheSameForAnyNumberOfThreads) {
  const auto inspect_with = [&](std::size_t threads) {
    const tbb::global_control control(tbb::global_control::max_allowed_parallelism, threads);
    return inspect(mesh_);
  };
  const Inspection one = inspect_with(1);
  for (const std::size_t threads : {2u, 8u}) {
    const Inspection many = inspect_with(threads);
    EXPECT_EQ(one.volume, many.volume);
    EXPECT_EQ(one.area, many.area);
    EXPECT_EQ(one.overlapped_volume, many.overlapped_volume);
    EXPECT_EQ(one.filled_volume, many.filled_volume);
    EXPECT_EQ(one.non_manifold_edges, many.non_manifold_edges);
    ASSERT_EQ(one.shells.size(), many.shells.size());
    for (std::size_t i = 0; i < one.shells.size(); ++i)
      EXPECT_EQ(one.shells[i].volume, many.shells[i].volume);
  }
}

INSTANTIATE_TEST_SUITE_P(Models, InspectReal,
                         testing::Values("bunny-144k.stl", "dragon-47k.stl", "dragon-871k.stl"),
                         [](const auto& model) {
                           return model.param.substr(0, model.param.find('-')) +
                                  model.param.substr(model.param.find('-') + 1, 3);
                         });

TEST(InspectDragon, CountsOfTheKnownFlaws) {
  const std::filesystem::path models = std::filesystem::path(AERATE_SHARED) / "models";
  if (!std::filesystem::exists(models / "dragon-871k.stl")) GTEST_SKIP() << models << " is not there";

  const Mesh mesh = load_model(models / "dragon-47k.stl").mesh;
  const Inspection flawed = inspect(mesh);
  EXPECT_EQ(flawed.non_manifold_edges, 2094u);
  EXPECT_EQ(flawed.duplicate_triangles, 202u);
  // The same flaws counted as directed edges beyond the first between the same two vertices.
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::size_t> directed;
  std::size_t surplus = 0;
  for (const Triangle& t : mesh.triangles) {
    for (std::size_t c = 0; c < 3; ++c) surplus += directed[{t[c], t[(c + 1) % 3]}]++ > 0 ? 1u : 0u;
  }
  EXPECT_EQ(surplus, 4364u);

  const Inspection large = inspect(load_model(models / "dragon-871k.stl").mesh);
  EXPECT_EQ(large.degenerate_triangles, 108u);
  EXPECT_EQ(large.non_manifold_edges, 0u);
}

}  // namespace
}  // namespace aerate
