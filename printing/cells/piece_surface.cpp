#include "printing/cells/piece_surface.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

namespace aerate {
namespace {

class Netter {
 public:
  Netter(const NodeBox& box, const OpenedCell& opened, const CellNodes& nodes,
         const std::vector<std::int32_t>& labels, std::int32_t piece, const SurfacePlacer& placer)
      : box_(box), opened_(opened), nodes_(nodes), labels_(labels), piece_(piece), placer_(placer) {}

  PieceSurface make(SharedWork& work) {
    vertex_of_cube_.assign(box_.size(), kNone);
    const NodeExtent piece = extent_of(
                                 box_, [&](std::size_t node) { return is_in(node); }, work)
                                 .grown(1, box_);
    // Layer by layer, on all threads; what they find follows in the order of layers.
    std::vector<Layer> layers(static_cast<std::size_t>(box_.count_z));
    const auto for_each_layer = [&](const auto& f) {
      work.for_each(layers.size(), 1, [&](std::size_t k) {
        if (static_cast<std::int32_t>(k) >= piece.first[2] && static_cast<std::int32_t>(k) <= piece.last[2])
          f(static_cast<std::int32_t>(k), layers[k]);
      });
    };
    for_each_layer([&](std::int32_t k, Layer& layer) {
      for (std::int32_t j = piece.first[1]; j < piece.last[1]; ++j)
        look_at_row(piece.first[0], piece.last[0], j, k, layer);
    });
    std::int64_t cells = 0;
    std::uint32_t vertices = 0;
    for (Layer& layer : layers) {
      cells += layer.cells;
      layer.first_vertex = vertices;
      vertices += static_cast<std::uint32_t>(layer.passed.size());
    }
    // The surface of a solid has twice the solid's Euler characteristic.
    surface_.euler = 2 * cells;
    surface_.vertices.resize(vertices);
    for_each_layer([&](std::int32_t, const Layer& layer) {
      for (std::uint32_t n = 0; n < layer.passed.size(); ++n)
        vertex_of_cube_[box_.index(layer.passed[n].i, layer.passed[n].j, layer.passed[n].k)] =
            layer.first_vertex + n;
    });
    std::vector<Cube> passed;
    passed.reserve(vertices);
    for (const Layer& layer : layers) passed.insert(passed.end(), layer.passed.begin(), layer.passed.end());
    constexpr std::size_t kGrain = 256;
    work.for_each(passed.size(), kGrain, [&](std::size_t v) { surface_.vertices[v] = vertex(passed[v]); });
    for_each_layer([&](std::int32_t, Layer& layer) {
      for (const Cube& cube : layer.passed) join_round(box_.index(cube.i, cube.j, cube.k), layer.triangles);
    });
    for (const Layer& layer : layers)
      surface_.triangles.insert(surface_.triangles.end(), layer.triangles.begin(), layer.triangles.end());
    return std::move(surface_);
  }

 private:
  // A cube of nodes that the surface passes, and its corners in the void.
  struct Cube {
    std::int32_t i, j, k;
    unsigned set;
  };

  // What is found about the cubes of a layer.
  struct Layer {
    std::vector<Cube> passed;
    std::int64_t cells = 0;
    std::uint32_t first_vertex = 0;
    std::vector<Triangle> triangles;
  };

  bool is_in(std::size_t node) const { return labels_[node] == piece_; }

  // Counts nodes - edges + faces - cubes of the void, of those that begin at the first corners of cubes. Notes the cubes that
  // the surface passes.
  void look_at_row(std::int32_t first, std::int32_t last, std::int32_t j, std::int32_t k,
                   Layer& layer) const {
    const std::array<std::size_t, 8> row = cube_at(box_, 0, j, k);
    // Corners of a cube with the same place along x, as bits of their numbers.
    const auto side_at = [&](std::int32_t i) {
      unsigned set = 0;
      for (const unsigned corner : {0U, 2U, 4U, 6U})
        set |= (is_in(row[corner] + static_cast<std::size_t>(i)) ? 1U : 0U) << corner;
      return set;
    };
    unsigned side = side_at(first);
    for (std::int32_t i = first; i < last; ++i) {
      const unsigned next = side_at(i + 1), set = side | next << 1;
      side = next;
      if (set == 0 || set == 255) continue;  // of a cube that is all in it come to 0
      const auto has = [set](unsigned mask) { return (set & mask) == mask ? 1 : 0; };
      layer.cells += has(1) - has(3) - has(5) - has(17) + has(15) + has(51) + has(85);
      layer.passed.push_back({i, j, k, set});
    }
  }

  // How deep in the void a node is, as far as it matters for where an edge passes its surface.
  double level(std::size_t node) const {
    const double spacing = box_.lattice.spacing;
    if (nodes_.has_ball(node)) return spacing;
    return std::clamp(static_cast<double>(opened_.cover[node]), -2 * spacing, spacing);
  }

  PlacedVertex vertex(const Cube& cube) const {
    const auto [i, j, k, set] = cube;
    const std::array<std::size_t, 8> corners = cube_at(box_, i, j, k);
    Vec3d sum{0, 0, 0};
    int count = 0;
    std::size_t shallowest = kNoNode;
    for (unsigned corner = 0; corner < 8; ++corner) {
      const bool is_in_piece = (set >> corner & 1U) != 0;
      for (unsigned axis = 0; axis < 3; ++axis) {
        const unsigned end = corner | 1U << axis;
        if (end == corner || ((set >> end & 1U) != 0) == is_in_piece) continue;
        const double here = level(corners[corner]), there = level(corners[end]);
        const double along = here == there ? 0.5 : std::clamp(here / (here - there), 0.02, 0.98);
        const auto step = [&](unsigned a) { return (corner >> a & 1U) + (a == axis ? along : 0.0); };
        sum = sum +
              box_.at_of_whole(i + box_.cut_x + step(0), j + box_.cut_y + step(1), k + box_.cut_z + step(2));
        ++count;
      }
      if (!is_in_piece || opened_.ball[corners[corner]] == kNone) continue;
      if (shallowest == kNoNode || opened_.cover[corners[corner]] < opened_.cover[shallowest])
        shallowest = corners[corner];
    }
    const Vec3d point = sum * (1.0 / count);
    if (shallowest == kNoNode) return {point, point};
    const RolledBall& near = opened_.balls[opened_.ball[shallowest]];
    return placer_.place(point, near, is_crease(corners, set, near));
  }

  // Is the void covered from far apart here?
  bool is_crease(const std::array<std::size_t, 8>& corners, unsigned set, const RolledBall& near) const {
    for (unsigned corner = 0; corner < 8; ++corner) {
      const std::uint32_t ball = opened_.ball[corners[corner]];
      if ((set >> corner & 1U) == 0 || ball == kNone) continue;
      const RolledBall& other = opened_.balls[ball];
      const double apart = length(other.centre - near.centre);
      if (apart > 1.2 * nodes_.ball_radius &&
          apart > 1.2 * std::max(near.radius, other.radius) - 0.6 * nodes_.ball_radius)
        return true;
    }
    return false;
  }

  // Where an edge from the node leaves or enters the void, the four cubes round the edge have a square. The cube that begins at
  // the node is one of them.
  void join_round(std::size_t node, std::vector<Triangle>& triangles) const {
    const std::array<std::size_t, 3> steps{1, box_.step_y(), box_.step_z()};
    const bool is_in_piece = is_in(node);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      if (is_in(node + steps[axis]) == is_in_piece) continue;
      const std::size_t u = steps[(axis + 1) % 3], v = steps[(axis + 2) % 3];
      std::array<std::uint32_t, 4> square{vertex_of_cube_[node - u - v], vertex_of_cube_[node - v],
                                          vertex_of_cube_[node], vertex_of_cube_[node - u]};
      if (is_in_piece) std::swap(square[1], square[3]);
      const auto diagonal = [&](std::size_t a, std::size_t b) {
        return length_squared(surface_.vertices[square[a]].at - surface_.vertices[square[b]].at);
      };
      const std::size_t first = diagonal(0, 2) <= diagonal(1, 3) ? 0 : 1;
      const auto corner = [&](std::size_t n) { return square[(first + n) % 4]; };
      triangles.push_back({corner(0), corner(1), corner(2)});
      triangles.push_back({corner(0), corner(2), corner(3)});
    }
  }

  static constexpr std::size_t kNoNode = static_cast<std::size_t>(-1);

  const NodeBox& box_;
  const OpenedCell& opened_;
  const CellNodes& nodes_;
  const std::vector<std::int32_t>& labels_;
  std::int32_t piece_;
  const SurfacePlacer& placer_;
  std::vector<std::uint32_t> vertex_of_cube_;
  PieceSurface surface_;
};

}  // namespace

PieceSurface surface_of_piece(const NodeBox& box, const OpenedCell& opened, const CellNodes& nodes,
                              const std::vector<std::int32_t>& labels, std::int32_t piece,
                              const SurfacePlacer& placer, SharedWork& work) {
  return Netter(box, opened, nodes, labels, piece, placer).make(work);
}

std::vector<NodeRun> runs_of_piece(const NodeBox& box, const std::vector<std::int32_t>& labels,
                                   std::int32_t piece) {
  std::vector<NodeRun> runs;
  for (std::int32_t k = 0; k < box.count_z; ++k) {
    for (std::int32_t j = 0; j < box.count_y; ++j) {
      std::int32_t first = -1;
      for (std::int32_t i = 0; i < box.count_x; ++i) {
        const bool is_in = labels[box.index(i, j, k)] == piece;
        if (is_in && first < 0) first = i;
        if (is_in || first < 0) continue;
        runs.push_back({box.x + first, box.x + i - 1, box.y + j, box.z + k});
        first = -1;
      }
    }
  }
  return runs;
}

}  // namespace aerate
