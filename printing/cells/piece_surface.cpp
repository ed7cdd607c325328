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
    std::int64_t cells = 0;
    for (std::int32_t k = 0; k + 1 < box_.count_z; ++k) {
      work.check_interrupted();
      for (std::int32_t j = 0; j + 1 < box_.count_y; ++j) {
        for (std::int32_t i = 0; i + 1 < box_.count_x; ++i) cells += look_at(i, j, k);
      }
    }
    surface_.vertices.resize(passed_.size());
    constexpr std::size_t kGrain = 256;
    work.for_each(passed_.size(), kGrain, [&](std::size_t v) { surface_.vertices[v] = vertex(passed_[v]); });
    // The surface of a solid has twice the solid's Euler characteristic.
    surface_.euler = 2 * cells;
    for (std::int32_t k = 1; k + 1 < box_.count_z; ++k) {
      work.check_interrupted();
      for (std::int32_t j = 1; j + 1 < box_.count_y; ++j) {
        for (std::int32_t i = 1; i + 1 < box_.count_x; ++i) join_round(box_.index(i, j, k));
      }
    }
    return std::move(surface_);
  }

 private:
  // A cube of nodes that the surface passes, and its corners in the void.
  struct Cube {
    std::int32_t i, j, k;
    unsigned set;
  };

  bool is_in(std::size_t node) const { return labels_[node] == piece_; }

  // Nodes - edges + faces - cubes of the void, of those that begin at the cube's first corner. Notes the cube
  // if the surface passes.
  std::int64_t look_at(std::int32_t i, std::int32_t j, std::int32_t k) {
    const std::array<std::size_t, 8> corners = cube_at(box_, i, j, k);
    unsigned set = 0;
    for (unsigned corner = 0; corner < 8; ++corner) set |= (is_in(corners[corner]) ? 1U : 0U) << corner;
    if (set == 0) return 0;
    const auto has = [set](unsigned mask) { return (set & mask) == mask ? 1 : 0; };
    if (set != 255) {
      vertex_of_cube_[corners[0]] = static_cast<std::uint32_t>(passed_.size());
      passed_.push_back({i, j, k, set});
    }
    return has(1) - has(3) - has(5) - has(17) + has(15) + has(51) + has(85) - has(255);
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
        sum = sum + box_.at(i + step(0), j + step(1), k + step(2));
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

  // Where an edge from the node leaves or enters the void, the four cubes round the edge have a square.
  void join_round(std::size_t node) {
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
      surface_.triangles.push_back({corner(0), corner(1), corner(2)});
      surface_.triangles.push_back({corner(0), corner(2), corner(3)});
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
  std::vector<Cube> passed_;
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
