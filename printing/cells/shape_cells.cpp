#include "printing/cells/shape_cells.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstddef>
#include <fmt/format.h>
#include <iterator>
#include <map>
#include <numeric>
#include <optional>
#include <stdexcept>
#include <utility>
#include <vector>

#include "core/ceiling.h"
#include "core/disjoint_sets.h"
#include "core/error.h"
#include "printing/cells/cell_nodes.h"
#include "printing/cells/decimate.h"
#include "printing/cells/keep_wall.h"
#include "printing/cells/piece_roof.h"
#include "printing/cells/piece_surface.h"
#include "printing/cells/rolled_balls.h"
#include "printing/cells/shared_work.h"

namespace aerate {
namespace {

// Slicers drop smaller shells, mm3 (docs/processes.md).
constexpr double kLeastVolume = 1;

// Of the tolerance, for taking out triangles; the rest is for the wall, which triangles that bend round the model
// would not keep. And what decimation is told at first.
constexpr double kShareForDecimation = 0.45, kFirstShare = 0.33;

// Of the tolerance, with what vertices were moved by to keep the wall; of what decimation was told, where it is more.
constexpr double kMostDeviation = 1.2, kLessForWall = 0.6;

double volume_of(const std::vector<PlacedVertex>& vertices, const std::vector<Triangle>& triangles) {
  if (vertices.empty()) return 0;
  const Vec3d origin = vertices.front().at;
  double sum = 0;
  for (const Triangle& t : triangles)
    sum += dot(vertices[t[0]].at - origin, cross(vertices[t[1]].at - origin, vertices[t[2]].at - origin));
  return std::abs(sum) / 6;
}

// A region opened by the ball, and what is made of it next: the largest piece that is worth it, if any.
struct Opened {
  OpenedCell cell;
  std::vector<std::int32_t> labels;  // of nodes
  std::optional<std::int32_t> piece;
  bool has_others = false;  // that may be worth it
};

// What a roof leaves of a cell.
struct BelowRoof {
  CellNodes nodes;
  Opened opened;
};

// A piece below its roof.
struct Roofed {
  std::vector<CellPlane> planes;   // of the cell and of the roof
  std::optional<BelowRoof> below;  // absent: it needs no roof
};

class CellShaper {
 public:
  CellShaper(const SurfaceIndex& surface, const Packing& packing, const CellShape& shape,
             const NodeLattice& lattice, double margin, SharedWork& work)
      : surface_(surface),
        near_(surface.bvh()),
        packing_(packing),
        shape_(shape),
        lattice_(lattice),
        margin_(margin),
        work_(work) {}

  // `solid`: places about which nothing is taken out.
  std::vector<CellVoid> shape(std::uint32_t cell, std::span<const CellPlane> planes, const Box3d& box,
                              std::span<const Vec3d> solid) const {
    const CellRegion region(planes, surface_, near_, packing_.limits.wall);
    CellNodes nodes = look_at_nodes(region, box, shape_.fillet, lattice_, work_);
    for (const Vec3d place : solid) keep_solid_about(nodes, place);
    std::vector<CellVoid> voids;
    constexpr int kMostPieces = 64;
    for (int rounds = 0; rounds < kMostPieces; ++rounds) {
      if (rounds > 0) nodes = cut_to_balls(nodes, nodes.depth, packing_.spheres[cell], work_);
      if (nodes.box.size() == 0) break;
      const Opened opened = open(region, nodes, cell);
      if (!opened.piece) break;
      if (packing_.limits.roof.limits_ceilings()) {
        add_below_roof(cell, planes, nodes, opened, voids);
        continue;
      }
      const PieceSurface surface = surface_of(region, nodes, opened);
      if (const auto loose = middle_of_loose_solid(surface)) {
        keep_attached(nodes, *loose);
        continue;
      }
      voids.push_back(make(cell, region, surface, runs_of_piece(nodes.box, opened.labels, *opened.piece)));
      if (!opened.has_others) break;
      keep_away_from(nodes, nodes.box, opened.labels, *opened.piece);
    }
    return voids;
  }

 private:
  Opened open(const CellRegion& region, const CellNodes& nodes, std::uint32_t cell) const {
    const Sphere& own = packing_.spheres[cell];
    Opened opened;
    opened.cell = open_cell(region, nodes, own, work_);
    const std::vector<NodePiece> pieces = find_pieces(nodes.box, opened.cell.is_void, opened.labels);
    work_.check_interrupted();
    const auto piece = std::ranges::find_if(pieces, [&](const NodePiece& candidate) {
      return volume_of_nodes(candidate.size) >= kLeastVolume &&
             takes_least_ball(region, nodes, opened.labels, candidate.label, own);
    });
    if (piece == pieces.end()) return opened;
    constexpr std::size_t kFewNodes = 8;
    opened.piece = piece->label;
    opened.has_others = std::any_of(std::next(piece), pieces.end(),
                                    [](const NodePiece& other) { return other.size > kFewNodes; });
    return opened;
  }

  PieceSurface surface_of(const CellRegion& region, const CellNodes& nodes, const Opened& opened) const {
    const SurfacePlacer placer(region, shape_.fillet, lattice_.spacing, margin_);
    PieceSurface surface =
        surface_of_piece(nodes.box, opened.cell, nodes, opened.labels, *opened.piece, placer, work_);
    work_.check_interrupted();
    return surface;
  }

  // Appends the void that the piece leaves under a roof, if any, and takes it out of `nodes`, of which later pieces
  // are made; what is above the roof may be one of these.
  void add_below_roof(std::uint32_t cell, std::span<const CellPlane> planes, CellNodes& nodes,
                      const Opened& opened, std::vector<CellVoid>& voids) const {
    // The nodes tell only about where a ceiling ends, and the surface is measured: so narrower ceilings are tried, of
    // those that stay without a roof, and then of the roof itself.
    struct Narrowed {
      double share, bridge;
    };
    std::vector<std::vector<CellPlane>> tried;
    for (const auto& [share, bridge] : {Narrowed{1, 1}, Narrowed{0.6, 1}, Narrowed{0, 1}, Narrowed{0.6, 0.8},
                                        Narrowed{0, 0.8}, Narrowed{0, 0.5}}) {
      Roof roof = packing_.limits.roof;
      roof.widest_ball *= bridge;
      const std::optional<Roofed> roofed = put_roof(planes, nodes, opened, cell, roof, share);
      if (!roofed ||
          std::ranges::any_of(tried, [&](const auto& other) { return are_same(other, roofed->planes); }))
        continue;
      tried.push_back(roofed->planes);
      const CellNodes& left = roofed->below ? roofed->below->nodes : nodes;
      const Opened& piece = roofed->below ? roofed->below->opened : opened;
      const CellRegion region(roofed->planes, surface_, near_, packing_.limits.wall);
      const PieceSurface surface = surface_of(region, left, piece);
      if (const auto loose = middle_of_loose_solid(surface)) {
        keep_attached(nodes, *loose);
        return;
      }
      CellVoid made = make(cell, region, surface, runs_of_piece(left.box, piece.labels, *piece.piece));
      if (!is_bridged(made.surface)) continue;
      made.has_roof = roofed->planes.size() > planes.size();
      voids.push_back(std::move(made));
      keep_away_from(nodes, left.box, piece.labels, *piece.piece);
      return;
    }
    fill(nodes, opened);
  }

  static bool are_same(const std::vector<CellPlane>& one, const std::vector<CellPlane>& other) {
    return std::ranges::equal(one, other, [](const CellPlane& a, const CellPlane& b) {
      return a.normal == b.normal && a.offset == b.offset;
    });
  }

  bool is_bridged(const Mesh& surface) const {
    const Roof& roof = packing_.limits.roof;
    const double allowed = roof.bridge() + shape_.tolerance / 2;
    double widest = 0;
    for (const Ceiling& ceiling : ceilings_of(surface, surface.triangles, roof)) {
      if (ceiling.bound() > allowed) widest = widest_disc(ceiling, widest);
    }
    return widest <= allowed;
  }

  // The room below one roof leaves one piece.
  std::optional<Roofed> put_roof(std::span<const CellPlane> planes, const CellNodes& nodes,
                                 const Opened& opened, std::uint32_t cell, const Roof& roof,
                                 double share) const {
    constexpr int kMostTries = 3;
    Roofed roofed{{planes.begin(), planes.end()}, std::nullopt};
    std::vector<FlatCeiling> ceilings;
    for (int tries = 0; tries < kMostTries; ++tries) {
      const CellRegion region(roofed.planes, surface_, near_, packing_.limits.wall);
      const CellNodes& left = roofed.below ? roofed.below->nodes : nodes;
      const Opened& piece = roofed.below ? roofed.below->opened : opened;
      const std::vector<FlatCeiling> found =
          flat_ceilings(region, left, piece.labels, *piece.piece, roof, share, work_);
      if (found.empty()) return roofed;
      ceilings.insert(ceilings.end(), found.begin(), found.end());
      const std::vector<CellPlane> sides = roof_below(ceilings, nodes, opened.labels, *opened.piece, roof);
      if (sides.empty()) return std::nullopt;
      roofed.planes.assign(planes.begin(), planes.end());
      roofed.planes.insert(roofed.planes.end(), sides.begin(), sides.end());
      roofed.below.emplace();
      roofed.below->nodes = cut_to_balls(nodes, depth_behind(sides, nodes), packing_.spheres[cell], work_);
      if (roofed.below->nodes.box.size() == 0) return std::nullopt;
      roofed.below->opened =
          open(CellRegion(roofed.planes, surface_, near_, packing_.limits.wall), roofed.below->nodes, cell);
      if (!roofed.below->opened.piece) return std::nullopt;
    }
    return roofed;
  }

  static void fill(CellNodes& nodes, const Opened& opened) {
    for (std::size_t node = 0; node < nodes.box.size(); ++node)
      if (opened.labels[node] == *opened.piece) nodes.depth[node] = -1;
  }

  // That of each node behind planes.
  std::vector<float> depth_behind(std::span<const CellPlane> planes, const CellNodes& nodes) const {
    const NodeBox& box = nodes.box;
    std::vector<float> depth = nodes.depth;
    work_.for_each(static_cast<std::size_t>(box.count_z), 1, [&](std::size_t layer) {
      const auto k = static_cast<std::int32_t>(layer);
      for (std::int32_t j = 0; j < box.count_y; ++j) {
        for (std::int32_t i = 0; i < box.count_x; ++i) {
          float& own = depth[box.index(i, j, k)];
          if (own < 0) continue;
          const Vec3d at = box.at(i, j, k);
          for (const CellPlane& plane : planes)
            own = limited(own, plane.offset - dot(plane.normal, at), nodes.ball_radius);
        }
      }
    });
    return depth;
  }

  double volume_of_nodes(std::size_t count) const {
    return static_cast<double>(count) * lattice_.spacing * lattice_.spacing * lattice_.spacing;
  }

  bool takes_least_ball(const CellRegion& region, const CellNodes& nodes,
                        const std::vector<std::int32_t>& labels, std::int32_t piece,
                        const Sphere& own) const {
    const NodeBox& box = nodes.box;
    if (is_about_centre(nodes, labels, piece, own)) return true;
    const double least = packing_.limits.min_radius, needed = region.wall() + least;
    for (std::int32_t k = 0; k < box.count_z; ++k) {
      for (std::int32_t j = 0; j < box.count_y; ++j) {
        for (std::int32_t i = 0; i < box.count_x; ++i) {
          const std::size_t node = box.index(i, j, k);
          if (labels[node] != piece || !nodes.has_ball(node)) continue;
          const Vec3d at = box.at(i, j, k);
          double missing = least - region.behind_planes(at);
          if (missing <= 0) missing = needed - region.surface_near(at, needed, nodes.facet[node]).distance;
          if (missing <= 0) return true;
          // Depths change by no more than the way between two points, so those that follow do not do either.
          constexpr double kSurely = 1 - 1e-9;
          i += static_cast<std::int32_t>(missing * kSurely / lattice_.spacing);
        }
      }
    }
    return false;
  }

  // About its own sphere's centre a ball fits that is at least as large as the least.
  bool is_about_centre(const CellNodes& nodes, const std::vector<std::int32_t>& labels, std::int32_t piece,
                       const Sphere& own) const {
    const NodeBox& box = nodes.box;
    const Vec3d place = (own.centre - box.at(0, 0, 0)) * (1 / lattice_.spacing);
    const auto range = [](double middle, std::int32_t count) {
      return std::pair{std::max(0, static_cast<std::int32_t>(std::floor(middle)) - 1),
                       std::min(count - 1, static_cast<std::int32_t>(std::ceil(middle)) + 1)};
    };
    const auto [first_x, last_x] = range(place.x, box.count_x);
    const auto [first_y, last_y] = range(place.y, box.count_y);
    const auto [first_z, last_z] = range(place.z, box.count_z);
    for (std::int32_t k = first_z; k <= last_z; ++k) {
      for (std::int32_t j = first_y; j <= last_y; ++j) {
        for (std::int32_t i = first_x; i <= last_x; ++i) {
          const std::size_t node = box.index(i, j, k);
          if (labels[node] == piece && nodes.has_ball(node) &&
              length(box.at(i, j, k) - own.centre) < lattice_.spacing)
            return true;
        }
      }
    }
    return false;
  }

  CellVoid make(std::uint32_t cell, const CellRegion& region, const PieceSurface& dense,
                std::vector<NodeRun> nodes) const {
    CellVoid result;
    result.cell = cell;
    result.euler = dense.euler;
    result.planned_volume = volume_of(dense.vertices, dense.triangles);
    result.nodes = std::move(nodes);
    // What decimation bounds is the sum of its steps for each vertex that went, and not for what is beside it. So
    // what comes of it is measured.
    double allowed = kFirstShare * shape_.tolerance;
    constexpr int kMostTries = 5;
    Decimated fewer;
    std::vector<PlacedVertex> vertices;
    for (int i = 1; i <= kMostTries; ++i) {
      work_.check_interrupted();
      fewer = decimate(positions_of(dense), dense.triangles, i < kMostTries ? allowed : 0, work_);
      result.deviation = deviation(dense, fewer);
      if (i < kMostTries && result.deviation > kShareForDecimation * shape_.tolerance) {
        allowed *= std::clamp(0.85 * kShareForDecimation * shape_.tolerance / result.deviation, 0.3, 0.85);
        continue;
      }
      vertices.clear();
      for (const std::uint32_t v : fewer.vertices) vertices.push_back(dense.vertices[v]);
      result.deviation += keep_wall(region, vertices, fewer.triangles, work_);
      if (result.deviation <= kMostDeviation * shape_.tolerance) break;
      allowed *= kLessForWall;
    }
    for (const PlacedVertex& vertex : vertices) result.surface.positions.push_back(to_float(vertex.at));
    result.surface.triangles = std::move(fewer.triangles);
    return result;
  }

  static std::vector<Vec3d> positions_of(const PieceSurface& surface) {
    std::vector<Vec3d> positions;
    positions.reserve(surface.vertices.size());
    for (const PlacedVertex& vertex : surface.vertices) positions.push_back(vertex.at);
    return positions;
  }

  // How far the vertices that went are from what is left at most.
  double deviation(const PieceSurface& dense, const Decimated& fewer) const {
    std::vector<Vec3f> positions;
    positions.reserve(fewer.vertices.size());
    std::vector<char> is_left(dense.vertices.size(), 0);
    for (const std::uint32_t v : fewer.vertices) {
      positions.push_back(to_float(dense.vertices[v].at));
      is_left[v] = 1;
    }
    const kernels::HostTriangleBvh bvh(positions, fewer.triangles);
    work_.check_interrupted();
    const NearFacets facets(bvh.view());
    // Only the largest distance counts: a vertex that is known to be no farther off is not looked at any further.
    std::atomic<double> largest = 0;
    constexpr std::size_t kGrain = 512;
    work_.for_each_part(dense.vertices.size(), kGrain, [&](std::size_t first, std::size_t last) {
      std::uint32_t facet = kNone;
      for (std::size_t v = first; v < last; ++v) {
        if (is_left[v] != 0) continue;
        // Vertices that follow each other are near each other.
        const Vec3d at = dense.vertices[v].at;
        kernels::NearestFacet near{kInfinity, facet};
        if (facet != kNone)
          near.distance_squared = kernels::distance_squared_to_facet(at, facets.facet(facet));
        double known = largest.load(std::memory_order_relaxed);
        if (near.distance_squared <= known) continue;
        near = facets.nearer_than(at, near);
        facet = near.facet;
        while (near.distance_squared > known &&
               !largest.compare_exchange_weak(known, near.distance_squared, std::memory_order_relaxed)) {
        }
      }
    });
    return std::sqrt(largest.load());
  }

  // Where a void would surround a piece of solid, which would then be loose: the middle of that.
  static std::optional<Vec3d> middle_of_loose_solid(const PieceSurface& surface) {
    DisjointSets shells(surface.vertices.size());
    for (const Triangle& t : surface.triangles) {
      shells.join(t[0], t[1]);
      shells.join(t[1], t[2]);
    }
    // Of each shell; the one that reaches lowest along x is the outermost.
    std::map<std::uint32_t, Box3d> boxes;
    for (std::uint32_t v = 0; v < surface.vertices.size(); ++v) {
      const Vec3d at = surface.vertices[v].at;
      const auto [box, is_new] = boxes.try_emplace(shells.root(v), Box3d{at, at});
      if (!is_new) box->second = {min_of(box->second.lower, at), max_of(box->second.upper, at)};
    }
    if (boxes.size() < 2) return std::nullopt;
    const auto outermost =
        std::ranges::min_element(boxes, {}, [](const auto& shell) { return shell.second.lower.x; });
    const auto loose = boxes.begin() == outermost ? std::next(boxes.begin()) : boxes.begin();
    return (loose->second.lower + loose->second.upper) * 0.5;
  }

  // Keeps a plane wall of solid, as thick as the gap, from a place to the cell's end along x.
  void keep_attached(CellNodes& nodes, Vec3d place) const {
    const NodeBox& box = nodes.box;
    const double half = std::max(packing_.limits.gap, 2 * lattice_.spacing) / 2;
    for (std::int32_t k = 0; k < box.count_z; ++k) {
      for (std::int32_t j = 0; j < box.count_y; ++j) {
        for (std::int32_t i = 0; i < box.count_x; ++i) {
          const Vec3d away = box.at(i, j, k) - place;
          // Nodes tell to within a spacing where the surface is.
          limit(
              nodes, box.index(i, j, k),
              std::hypot(std::max(0.0, -away.x), std::max(0.0, std::abs(away.y) - half)) - lattice_.spacing);
        }
      }
    }
  }

  void keep_solid_about(CellNodes& nodes, Vec3d place) const {
    constexpr double kSpacings = 2;
    const NodeBox& box = nodes.box;
    for (std::int32_t k = 0; k < box.count_z; ++k) {
      for (std::int32_t j = 0; j < box.count_y; ++j) {
        for (std::int32_t i = 0; i < box.count_x; ++i) {
          const double away = length(box.at(i, j, k) - place) - kSpacings * lattice_.spacing;
          limit(nodes, box.index(i, j, k), away);
        }
      }
    }
  }

  // No more depth at a node than this.
  static float limited(float own, double depth, double ball_radius) {
    if (own < 0 || depth >= static_cast<double>(own)) return own;
    return depth < ball_radius ? -1.F : static_cast<float>(depth);
  }

  static void limit(CellNodes& nodes, std::size_t node, double depth) {
    nodes.depth[node] = limited(nodes.depth[node], depth, nodes.ball_radius);
  }

  // What is left of the cell: without a piece, and no nearer to it than the gap. `of_labels`: the box of their nodes, which is
  // a part of the cell's.
  void keep_away_from(CellNodes& nodes, const NodeBox& of_labels, const std::vector<std::int32_t>& labels,
                      std::int32_t piece) const {
    const NodeBox& box = nodes.box;
    // Nodes tell to within a spacing where a surface is, and its vertices are placed up to another away.
    const double kept = packing_.limits.gap + 3 * lattice_.spacing;
    const double reach = kept + nodes.deepest;
    const auto steps = static_cast<std::int32_t>(reach / lattice_.spacing);
    NodeExtent extent = extent_of(
        of_labels, [&](std::size_t node) { return labels[node] == piece; }, work_);
    const std::array<std::int32_t, 3> to_cell{of_labels.x - box.x, of_labels.y - box.y, of_labels.z - box.z};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      extent.first[axis] += to_cell[axis];
      extent.last[axis] += to_cell[axis];
    }
    extent = extent.grown(steps, box);
    const NodeBox near = part_of(box, extent);
    std::vector<std::uint8_t> is_in_piece(near.size(), 0);
    const auto for_each_row = [&](const auto& f) {
      work_.for_each(static_cast<std::size_t>(near.count_z), 1, [&](std::size_t layer) {
        const auto k = static_cast<std::int32_t>(layer);
        for (std::int32_t j = 0; j < near.count_y; ++j) f(j, k);
      });
    };
    for_each_row([&](std::int32_t j, std::int32_t k) {
      const std::int32_t y = j + extent.first[1] - to_cell[1], z = k + extent.first[2] - to_cell[2];
      if (y < 0 || z < 0 || y >= of_labels.count_y || z >= of_labels.count_z) return;
      for (std::int32_t i = 0; i < near.count_x; ++i) {
        const std::int32_t x = i + extent.first[0] - to_cell[0];
        if (x < 0 || x >= of_labels.count_x) continue;
        is_in_piece[near.index(i, j, k)] = labels[of_labels.index(x, y, z)] == piece ? 1 : 0;
      }
    });
    const std::vector<std::int32_t> squared = squared_distances(near, is_in_piece, steps, work_);
    for_each_row([&](std::int32_t j, std::int32_t k) {
      for (std::int32_t i = 0; i < near.count_x; ++i) {
        const std::size_t node = near.index(i, j, k);
        if (squared[node] == kFarAway) continue;
        const double apart = lattice_.spacing * std::sqrt(squared[node]);
        limit(nodes, box.index(i + extent.first[0], j + extent.first[1], k + extent.first[2]),
              is_in_piece[node] != 0 ? -1 : apart - kept);
      }
    });
  }

  const SurfaceIndex& surface_;
  NearFacets near_;
  const Packing& packing_;
  const CellShape& shape_;
  const NodeLattice& lattice_;
  double margin_;
  SharedWork& work_;
};

UsageError too_large(const CellShape& shape) {
  return UsageError(fmt::format("a cell is too large for a fillet of {:g} mm and a tolerance of {:g} mm",
                                shape.fillet, shape.tolerance),
                    "give a larger --fillet or --tolerance, or a smaller --max-radius");
}

// Before any cell is looked at, from their boxes.
void require_few_nodes(const CellVoids& cells, const CellShape& shape, std::span<const std::uint32_t> some) {
  const double spacing = cells.lattice.spacing;
  for (const std::uint32_t cell : some) {
    const Vec3d extent = cells.planes.boxes[cell].upper - cells.planes.boxes[cell].lower;
    // A cell without room for the ball has an empty box, or a flat one.
    if (!(std::min({extent.x, extent.y, extent.z}) > 0)) continue;
    if (extent.x * extent.y * extent.z > static_cast<double>(kMostNodesOfCell) * spacing * spacing * spacing)
      throw too_large(shape);
  }
}

// The voids of some cells, in their order.
std::vector<CellVoid> shape_some(const SurfaceIndex& surface, const Packing& packing, const CellVoids& cells,
                                 const CellShape& shape, std::span<const std::uint32_t> some,
                                 std::span<const CellPlace> solid, Monitor& monitor) {
  double largest = 0;
  for (const Box3d& box : cells.planes.boxes) {
    for (const Vec3d p : {box.lower, box.upper})
      largest = std::max({largest, std::abs(p.x), std::abs(p.y), std::abs(p.z)});
  }
  // Twice what rounding to fp32 moves a vertex by at most.
  const double margin = std::ldexp(largest, -22) + 1e-6;
  if (margin > shape.tolerance / 4)
    throw UsageError(
        fmt::format("cells at coordinates up to {:g} mm cannot be kept within a tolerance of {:g} mm: "
                    "coordinates in a mesh file are single precision",
                    largest, shape.tolerance),
        "move the model nearer to the origin, or raise --tolerance");
  SharedWork work(monitor);
  const CellShaper shaper(surface, packing, shape, cells.lattice, margin, work);
  require_few_nodes(cells, shape, some);
  std::vector<std::vector<CellVoid>> made(some.size());
  std::vector<char> is_too_large(some.size(), 0);
  work.for_each(some.size(), 1, [&](std::size_t i) {
    const std::uint32_t cell = some[i];
    std::vector<Vec3d> solid_here;
    for (const CellPlace& place : solid)
      if (place.cell == cell) solid_here.push_back(place.at);
    try {
      made[i] = shaper.shape(cell, cells.planes.of(cell), cells.planes.boxes[cell], solid_here);
    } catch (const std::length_error&) {
      is_too_large[i] = 1;
    }
  });
  if (std::ranges::find(is_too_large, 1) != is_too_large.end()) throw too_large(shape);
  std::vector<CellVoid> voids;
  for (std::vector<CellVoid>& of_cell : made) std::ranges::move(of_cell, std::back_inserter(voids));
  return voids;
}

}  // namespace

double node_spacing(const CellShape& shape, const PackingLimits& limits) {
  // Between nodes the surface bends by spacing^2 / (8 radius) or less, along the diagonals of squares more.
  constexpr double kShareForBend = 0.5, kAcrossSquares = 1.3, kLeastNodesPerRadius = 2.2;
  const double bend = std::min(shape.fillet, std::max(limits.wall, shape.fillet / 2));
  const double spacing = std::sqrt(8 * bend * kShareForBend * shape.tolerance) / kAcrossSquares;
  return std::min(spacing, shape.fillet / kLeastNodesPerRadius);
}

CellVoids shape_cells(const SurfaceIndex& surface, const Packing& packing, CellPlanes planes,
                      const CellShape& shape, Monitor& monitor) {
  CellVoids cells;
  cells.planes = std::move(planes);
  cells.ball_radius = shape.fillet;
  cells.lattice.spacing = node_spacing(shape, packing.limits);
  // Off whole multiples, where faces of models often are.
  cells.lattice.origin = Vec3d{0.31, 0.37, 0.41} * cells.lattice.spacing;
  std::vector<std::uint32_t> all(packing.spheres.size());
  std::iota(all.begin(), all.end(), 0U);
  cells.voids = shape_some(surface, packing, cells, shape, all, {}, monitor);
  return cells;
}

CellVoids shape_around(const SurfaceIndex& surface, const Packing& packing, CellVoids cells,
                       const CellShape& shape, std::span<const CellPlace> places, Monitor& monitor) {
  std::vector<std::uint32_t> anew;
  for (const CellPlace& place : places) anew.push_back(place.cell);
  std::ranges::sort(anew);
  anew.erase(std::unique(anew.begin(), anew.end()), anew.end());
  std::vector<CellVoid> made = shape_some(surface, packing, cells, shape, anew, places, monitor);
  std::erase_if(cells.voids,
                [&](const CellVoid& piece) { return std::ranges::binary_search(anew, piece.cell); });
  std::ranges::move(made, std::back_inserter(cells.voids));
  std::ranges::stable_sort(cells.voids, {}, &CellVoid::cell);
  return cells;
}

Solid carve_cells(Mesh outer, const CellVoids& cells) {
  Solid solid;
  solid.mesh = std::move(outer);
  solid.close_part(PartKind::outer);
  for (const CellVoid& piece : cells.voids) {
    const auto first = static_cast<std::uint32_t>(solid.mesh.positions.size());
    solid.mesh.positions.insert(solid.mesh.positions.end(), piece.surface.positions.begin(),
                                piece.surface.positions.end());
    for (const Triangle& t : piece.surface.triangles)
      solid.mesh.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
    solid.close_part(PartKind::void_surface);
  }
  return solid;
}

}  // namespace aerate
