#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Polygon_mesh_processing/triangulate_hole.h>
#include <algorithm>
#include <array>
#include <cstdint>
#include <fmt/format.h>
#include <iterator>
#include <utility>
#include <vector>

#include "core/error.h"
#include "core/listed.h"
#include "mesh/repair.h"
#include "mesh/topology.h"

namespace aerate {
namespace {

constexpr std::size_t kMaxCubic = 200;

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;

std::string place(const BoundaryLoop& loop) {
  return fmt::format("{:.3g} mm across, {} edges, near ({:.3f}, {:.3f}, {:.3f}) mm", loop.diameter,
                     loop.edge_count, loop.centre.x, loop.centre.y, loop.centre.z);
}

// Triangles between the vertices of the chain, running along it in its direction; empty if none were found.
std::vector<Triangle> patch(const Mesh& mesh, const BoundaryChain& chain) {
  std::vector<Kernel::Point_3> points;
  for (const std::uint32_t vertex : chain.vertices) {
    const Vec3d p = to_double(mesh.positions[vertex]);
    points.emplace_back(p.x, p.y, p.z);
  }
  std::vector<CGAL::Triple<int, int, int>> corners;
  const std::size_t count = chain.vertices.size();
  // Without a triangulation among Delaunay's, all are searched, in cubic time: not for long rims.
  CGAL::Polygon_mesh_processing::triangulate_hole_polyline(
      points, std::back_inserter(corners),
      CGAL::parameters::use_2d_constrained_delaunay_triangulation(true)
          .use_delaunay_triangulation(true)
          .do_not_use_cubic_algorithm(count > kMaxCubic));
  std::vector<Triangle> triangles;
  bool along = true;
  for (const auto& [a, b, c] : corners) {
    const std::array<std::size_t, 3> local{static_cast<std::size_t>(a), static_cast<std::size_t>(b),
                                           static_cast<std::size_t>(c)};
    for (std::size_t i = 0; i < 3; ++i) {
      if ((local[(i + 1) % 3] + 1) % count == local[i]) along = false;
    }
    triangles.push_back({chain.vertices[local[0]], chain.vertices[local[1]], chain.vertices[local[2]]});
  }
  if (!along) {
    for (Triangle& triangle : triangles) std::swap(triangle[1], triangle[2]);
  }
  return triangles;
}

}  // namespace

Repaired fill_holes(Mesh mesh, double max_diameter) {
  const std::vector<BoundaryChain> chains = chain_boundary(mesh, EdgeUses(mesh));
  if (chains.empty()) return {std::move(mesh), {}};

  std::vector<BoundaryLoop> loops;
  loops.reserve(chains.size());
  for (const BoundaryChain& chain : chains) loops.push_back(describe_loop(mesh, chain));
  const BoundaryLoop& largest = *std::max_element(
      loops.begin(), loops.end(), [](const auto& a, const auto& b) { return a.diameter < b.diameter; });
  const std::string which =
      chains.size() == 1 ? "the hole" : fmt::format("the largest of {} holes", chains.size());
  if (!(largest.diameter <= max_diameter)) {
    throw MeshError(fmt::format("{} is too large to be closed (up to {:.3g} mm): {}", which, max_diameter,
                                place(largest)),
                    "close it in the program that made the model");
  }

  const std::size_t before = mesh.triangles.size();
  for (std::size_t i = 0; i < chains.size(); ++i) {
    const std::vector<Triangle> triangles =
        chains[i].closed ? patch(mesh, chains[i]) : std::vector<Triangle>{};
    if (triangles.empty()) {
      throw MeshError(
          fmt::format("a hole cannot be closed{}: {}",
                      chains[i].closed ? "" : " (its rim meets other triangles)", place(loops[i])),
          "repair the model in the program that made it");
    }
    mesh.triangles.insert(mesh.triangles.end(), triangles.begin(), triangles.end());
  }
  const std::string triangle_count = counted(mesh.triangles.size() - before, "triangle", "triangles");
  std::string notice = chains.size() == 1
                           ? fmt::format("a hole was closed with {}: {}", triangle_count, place(largest))
                           : fmt::format("{} holes were closed with {}, the largest {}", chains.size(),
                                         triangle_count, place(largest));
  return {std::move(mesh), {std::move(notice)}};
}

}  // namespace aerate
