#include "printing/cells/carve_drained_cells.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <optional>
#include <span>
#include <tbb/parallel_for.h>
#include <utility>

#include "printing/cells/tube_section.h"
#include "printing/cut_surface.h"
#include "printing/tube_openings.h"

namespace aerate {
namespace {

// A prism ends so far beyond the surface that it passes, mm; and the least that is left between a void's surface
// and the model's for its ring.
constexpr double kBeyond = 0.2;

// Where lines along a tube pass surfaces, from its start.
struct Passage {
  double first = kInfinity, last = -kInfinity;

  void add(double along) {
    first = std::min(first, along);
    last = std::max(last, along);
  }
};

// Where a line from `start` in a unit direction passes a triangle.
std::optional<double> passes(Vec3d start, Vec3d direction, const kernels::Facet& facet) {
  const Vec3d a = to_double(facet.a), ab = to_double(facet.b) - a, ac = to_double(facet.c) - a;
  const Vec3d p = cross(direction, ac);
  const double determinant = dot(ab, p);
  if (determinant == 0) return std::nullopt;
  const Vec3d from_a = start - a;
  const double u = dot(from_a, p) / determinant;
  const Vec3d q = cross(from_a, ab);
  const double v = dot(direction, q) / determinant;
  if (u < 0 || v < 0 || u + v > 1) return std::nullopt;
  return dot(ac, q) / determinant;
}

// What the prism of a tube depends on besides the tube.
struct TubeShape {
  const Roof& roof;
  double tolerance;
  double turn;
};

std::vector<Vec3d> section_of(const Tube& tube, const TubeShape& shape) {
  return tube_section(tube, shape.roof, sides_of(tube, shape.tolerance), shape.turn);
}

// The two prisms of a tube, from the same ring: the other way its points run the other way round.
struct PrismPair {
  CuttingPrism inward;  // into the void that the tube starts in
  CuttingPrism onward;
};

PrismPair prisms_of(const Tube& tube, double ring_at, double inward_length, double onward_length,
                    const TubeShape& shape) {
  const Vec3d axis = direction_of(tube);
  const Vec3d middle = tube.start + axis * ring_at;
  PrismPair pair;
  for (const Vec3d p : section_of(shrunk(tube), shape))
    pair.onward.ring.push_back(to_float(p + axis * ring_at));
  pair.inward.ring.assign(pair.onward.ring.rbegin(), pair.onward.ring.rend());
  // Rounding moves points of the ring along the axis.
  constexpr double kSlack = 1e-3;
  pair.onward.axis = axis;
  pair.inward.axis = -axis;
  pair.onward.start = middle - axis * kSlack;
  pair.inward.start = middle + axis * kSlack;
  pair.onward.length = onward_length + kSlack;
  pair.inward.length = inward_length + kSlack;
  pair.onward.radius = pair.inward.radius = tube.radius;
  return pair;
}

PrismPair prisms_of_window(const Tube& tube, const TubeShape& shape) {
  const double half = length(tube.end - tube.start) / 2;
  return prisms_of(tube, half, half, half, shape);
}

// How far starts of lines along a tube are from its axis at most.
double reach_across(const std::vector<Vec3d>& starts, const Tube& tube) {
  double reach = 0;
  for (const Vec3d start : starts) reach = std::max(reach, length(start - tube.start));
  return reach;
}

// Facets that may come as near to a segment, by their boxes.
std::vector<kernels::Facet> facets_about(const Mesh& mesh, const Segment& segment, double reach) {
  constexpr double kSlack = 1e-3;  // mm
  const Vec3d around{reach + kSlack, reach + kSlack, reach + kSlack};
  const Vec3d lower = min_of(segment.start, segment.end) - around;
  const Vec3d upper = max_of(segment.start, segment.end) + around;
  std::vector<kernels::Facet> facets;
  for (const Triangle& t : mesh.triangles) {
    const kernels::Facet facet = facet_of(mesh, t);
    const Box3f box = kernels::box_of(facet);
    const Vec3d least = to_double(box.lower), most = to_double(box.upper);
    if (least.x <= upper.x && least.y <= upper.y && least.z <= upper.z && most.x >= lower.x &&
        most.y >= lower.y && most.z >= lower.z)
      facets.push_back(facet);
  }
  return facets;
}

// nullopt if no plane across the hole lies between the void's surface and the model's.
std::optional<PrismPair> prisms_of_hole(const Mesh& outer, std::span<const std::uint32_t> near_outside,
                                        const Mesh& from, const Tube& tube, const TubeShape& shape) {
  const Vec3d axis = direction_of(tube);
  const double farthest = length(tube.end - tube.start) + kCutBeyond * tube.radius;
  std::vector<Vec3d> starts = section_of(tube, shape);
  starts.push_back(tube.start);
  const std::vector<kernels::Facet> near = facets_about(
      from, {tube.start - axis * tube.radius, tube.start + axis * farthest}, reach_across(starts, tube));
  Passage out_of_void, outside;
  for (const Vec3d start : starts) {
    Passage line;
    for (const kernels::Facet& facet : near) {
      const auto along = passes(start, axis, facet);
      if (along && *along > -tube.radius && *along < farthest) line.add(*along);
    }
    if (line.last < line.first) return std::nullopt;
    out_of_void.add(line.last);
    for (const std::uint32_t i : near_outside) {
      const auto along = passes(start, axis, facet_of(outer, outer.triangles[i]));
      if (along && *along > 0 && *along < farthest) outside.add(*along);
    }
  }
  if (!(outside.first - out_of_void.last > kBeyond)) return std::nullopt;
  const double ring_at = (outside.first + out_of_void.last) / 2;
  return prisms_of(tube, ring_at, ring_at - out_of_void.first + kBeyond, farthest - ring_at, shape);
}

// A surface that is cut several times. Triangles that are cut away stay in the mesh, marked.
struct CutMesh {
  Mesh mesh;
  std::size_t own_triangle_count = 0;
  std::vector<char> is_gone;

  explicit CutMesh(Mesh whole)
      : mesh(std::move(whole)), own_triangle_count(mesh.triangles.size()), is_gone(own_triangle_count, 0) {}

  std::vector<std::uint32_t> near(const CuttingPrism& prism, std::span<const std::uint32_t> own) const {
    std::vector<std::uint32_t> result;
    for (const std::uint32_t i : own) {
      if (is_gone[i] == 0) result.push_back(i);
    }
    const Segment axis = axis_of(prism);
    for (auto i = static_cast<std::uint32_t>(own_triangle_count); i < mesh.triangles.size(); ++i) {
      if (is_gone[i] == 0 && distance_to_facet(axis, facet_of(mesh, mesh.triangles[i])) < reach_of(prism))
        result.push_back(i);
    }
    return result;
  }
};

// One end of a tube: the sides of its prism. Vertices from `ring_base` on are those of its ring.
struct CutEnd {
  std::vector<Triangle> sides;
  std::uint32_t ring_base = 0;
};

// A void, and the tubes that it was cut by.
struct CutTubes {
  std::vector<CuttingPrism> prisms;
  std::vector<CutEnd> ends;  // and whether it could be
  std::vector<char> is_cut;
  CutMesh mesh{Mesh{}};
};

bool are_same(const CuttingPrism& a, const CuttingPrism& b) {
  return a.ring == b.ring && a.axis == b.axis && a.start == b.start && a.length == b.length &&
         a.radius == b.radius;
}

bool cut(CutMesh& target, std::span<const std::uint32_t> own_near, const CuttingPrism& prism, CutEnd& end) {
  const std::vector<std::uint32_t> near = target.near(prism, own_near);
  auto made = cut_surface(target.mesh, near, prism);
  if (!made) return false;
  for (const std::uint32_t i : made->removed) target.is_gone[i] = 1;
  Mesh& mesh = target.mesh;
  mesh.positions.insert(mesh.positions.end(), made->new_positions.begin(), made->new_positions.end());
  mesh.triangles.insert(mesh.triangles.end(), made->surface.begin(), made->surface.end());
  target.is_gone.resize(mesh.triangles.size(), 0);
  end.ring_base = static_cast<std::uint32_t>(mesh.positions.size());
  end.sides = std::move(made->sides);
  return true;
}

// What is to be cut, in the plan's order: windows, then holes.
struct PlannedCut {
  std::uint32_t from = 0;
  std::optional<std::uint32_t> to;  // absent: to the outside
  PrismPair prisms;
  std::vector<std::uint32_t> near_outside;
  CutEnd inward, onward;
  bool is_made = false;
};

class Carver {
 public:
  // `surface_of` gives that of a void of the plan, `last_of` what it was cut by last.
  template <typename SurfaceOf, typename LastOf>
  Carver(const Mesh& outer, const SurfaceIndex& surface, std::size_t void_count, const SurfaceOf& surface_of,
         const LastOf& last_of, const DrainagePlan& plan, double tolerance, const std::vector<double>& turns)
      : plan_(plan), outer_(outer) {
    voids_.reserve(void_count);
    for (std::uint32_t v = 0; v < void_count; ++v) voids_.push_back({&surface_of(v), &last_of(v)});
    cuts_.resize(plan.channels.size() + plan.holes.size());
    tbb::parallel_for(std::size_t{0}, cuts_.size(), [&](std::size_t i) {
      PlannedCut& cut = cuts_[i];
      const TubeShape shape{plan.roof, tolerance, turns[i]};
      if (i < plan.channels.size()) {
        const Channel& channel = plan.channels[i];
        cut.from = channel.from;
        cut.to = channel.to;
        cut.prisms = prisms_of_window(channel.tube, shape);
        cut.is_made = true;
        return;
      }
      const EscapeHole& hole = plan.holes[i - plan.channels.size()];
      cut.from = hole.from;
      const Vec3d beyond = direction_of(hole.tube) * (kCutBeyond * hole.tube.radius);
      cut.near_outside =
          surface.triangles_near({hole.tube.start, hole.tube.end + beyond}, hole.tube.radius + kBeyond);
      const auto prisms = prisms_of_hole(outer, cut.near_outside, surface_of(hole.from), hole.tube, shape);
      if (!prisms) return;
      cut.prisms = *prisms;
      cut.near_outside = surface.triangles_near(axis_of(cut.prisms.onward), reach_of(cut.prisms.onward));
      cut.is_made = true;
    });
  }

  std::variant<Solid, UncutTubes> carve(Monitor& monitor) {
    cut_voids();
    monitor.check_interrupted();
    for (PlannedCut& planned : cuts_) {
      if (planned.to || !planned.is_made) continue;
      planned.is_made = cut(outer_, planned.near_outside, planned.prisms.onward, planned.onward);
      monitor.check_interrupted();
    }
    UncutTubes uncut;
    for (std::size_t i = 0; i < cuts_.size(); ++i) {
      if (cuts_[i].is_made) continue;
      if (i < plan_.channels.size()) {
        uncut.windows.push_back(i);
      } else {
        uncut.holes.push_back(i - plan_.channels.size());
      }
    }
    if (!uncut.windows.empty() || !uncut.holes.empty()) return uncut;
    return put_together();
  }

 private:
  // One end of a planned cut.
  struct VoidEnd {
    std::size_t cut;
    bool is_inward;
  };

  struct VoidOfPlan {
    const Mesh* surface;
    CutTubes* cut;
  };

  // Each void's surface is cut by one tube after the other, different ones at the same time.
  void cut_voids() {
    std::vector<char> is_cut(2 * cuts_.size(), 1);
    tbb::parallel_for(std::size_t{0}, voids_.size(), [&](std::size_t v) {
      std::vector<VoidEnd> ends;
      for (std::size_t i = 0; i < cuts_.size(); ++i) {
        if (!cuts_[i].is_made) continue;
        if (cuts_[i].from == v) ends.push_back({i, true});
        if (cuts_[i].to == v) ends.push_back({i, false});
      }
      cut_void(voids_[v], ends);
      for (std::size_t n = 0; n < ends.size(); ++n) {
        const auto [i, is_inward] = ends[n];
        (is_inward ? cuts_[i].inward : cuts_[i].onward) = voids_[v].cut->ends[n];
        is_cut[2 * i + (is_inward ? 0 : 1)] = voids_[v].cut->is_cut[n];
      }
    });
    for (std::size_t i = 0; i < cuts_.size(); ++i)
      cuts_[i].is_made = cuts_[i].is_made && is_cut[2 * i] != 0 && is_cut[2 * i + 1] != 0;
  }

  void cut_void(const VoidOfPlan& own, const std::vector<VoidEnd>& ends) const {
    std::vector<CuttingPrism> prisms;
    prisms.reserve(ends.size());
    for (const VoidEnd& end : ends)
      prisms.push_back(end.is_inward ? cuts_[end.cut].prisms.inward : cuts_[end.cut].prisms.onward);
    CutTubes& cut = *own.cut;
    if (!cut.mesh.mesh.triangles.empty() && std::ranges::equal(cut.prisms, prisms, are_same)) return;
    cut = {std::move(prisms), std::vector<CutEnd>(ends.size()), std::vector<char>(ends.size(), 0),
           CutMesh(*own.surface)};
    for (std::size_t n = 0; n < ends.size(); ++n)
      cut.is_cut[n] = cut_once(cut.mesh, cut.prisms[n], cut.ends[n]) ? 1 : 0;
  }

  static bool cut_once(CutMesh& target, const CuttingPrism& prism, CutEnd& end) {
    std::vector<std::uint32_t> near = triangles_near(target.mesh, axis_of(prism), reach_of(prism));
    std::erase_if(near, [&](std::uint32_t i) { return i >= target.own_triangle_count; });
    return cut(target, near, prism, end);
  }

  Solid put_together() {
    Solid solid;
    Mesh& mesh = solid.mesh;
    mesh.positions = outer_.mesh.positions;
    const auto add_part = [&](const CutMesh& source, std::size_t first, std::size_t last, std::uint32_t base,
                              PartKind kind) {
      for (std::size_t i = first; i < last; ++i) {
        const Triangle& t = source.mesh.triangles[i];
        if (source.is_gone[i] == 0) mesh.triangles.push_back({t[0] + base, t[1] + base, t[2] + base});
      }
      solid.close_part(kind);
    };
    add_part(outer_, 0, outer_.own_triangle_count, 0, PartKind::outer);
    add_part(outer_, outer_.own_triangle_count, outer_.mesh.triangles.size(), 0, PartKind::remnant);
    std::vector<std::uint32_t> bases;
    for (const VoidOfPlan& own : voids_) {
      const CutMesh& piece = own.cut->mesh;
      bases.push_back(static_cast<std::uint32_t>(mesh.positions.size()));
      mesh.positions.insert(mesh.positions.end(), piece.mesh.positions.begin(), piece.mesh.positions.end());
      // Both kinds of triangles are one part.
      for (std::size_t i = 0; i < piece.mesh.triangles.size(); ++i) {
        const Triangle& t = piece.mesh.triangles[i];
        if (piece.is_gone[i] == 0)
          mesh.triangles.push_back({t[0] + bases.back(), t[1] + bases.back(), t[2] + bases.back()});
      }
      solid.close_part(PartKind::void_surface);
    }
    for (std::size_t i = 0; i < cuts_.size(); ++i) {
      const PlannedCut& planned = cuts_[i];
      const std::vector<Vec3f>& ring = planned.prisms.onward.ring;
      const auto ring_base = static_cast<std::uint32_t>(mesh.positions.size());
      const auto sides = static_cast<std::uint32_t>(ring.size());
      mesh.positions.insert(mesh.positions.end(), ring.begin(), ring.end());
      add_sides(solid, planned.inward, bases[planned.from],
                [&](std::uint32_t v) { return ring_base + sides - 1 - v; });
      add_sides(solid, planned.onward, planned.to ? bases[*planned.to] : 0,
                [&](std::uint32_t v) { return ring_base + v; });
      solid.close_part(planned.to ? PartKind::channel : PartKind::hole);
    }
    drop_unused_vertices(mesh);
    return solid;
  }

  template <typename OfRing>
  static void add_sides(Solid& solid, const CutEnd& end, std::uint32_t base, const OfRing& of_ring) {
    for (Triangle t : end.sides) {
      for (std::uint32_t& v : t) v = v >= end.ring_base ? of_ring(v - end.ring_base) : v + base;
      solid.mesh.triangles.push_back(t);
    }
  }

  const DrainagePlan& plan_;
  CutMesh outer_;
  std::vector<VoidOfPlan> voids_;
  std::vector<PlannedCut> cuts_;
};

}  // namespace

bool may_be_cut(const Mesh& outer, const SurfaceIndex& surface, const CellVoid& from, const Tube& hole,
                const Roof& roof, double tolerance) {
  const Vec3d beyond = direction_of(hole) * (kCutBeyond * hole.radius);
  const std::vector<std::uint32_t> near =
      surface.triangles_near({hole.start, hole.end + beyond}, hole.radius + kBeyond);
  const auto prisms = prisms_of_hole(outer, near, from.surface, hole, {roof, tolerance, 0});
  if (!prisms) return false;
  const CuttingPrism &inward = prisms->inward, &onward = prisms->onward;
  return may_be_cut(outer, surface.triangles_near(axis_of(onward), reach_of(onward)), onward) &&
         may_be_cut(from.surface, triangles_near(from.surface, axis_of(inward), reach_of(inward)), inward);
}

struct CellCarver::CutVoid {
  CutTubes tubes;
};

CellCarver::CellCarver(const Mesh& outer, const SurfaceIndex& surface, const CellVoids& cells,
                       double tolerance)
    : outer_(outer), surface_(surface), cells_(cells), tolerance_(tolerance), last_(cells.voids.size()) {}

CellCarver::~CellCarver() = default;

std::variant<Solid, UncutTubes> CellCarver::carve(std::span<const std::uint32_t> kept,
                                                  const DrainagePlan& plan, Monitor& monitor) {
  // Small triangles beside a rim may be turned over by rounding to fp32: a turned ring makes others.
  constexpr double kTurn = 0.382;
  constexpr int kMostTurns = 6;
  const auto surface_of = [&](std::uint32_t v) -> const Mesh& { return cells_.voids[kept[v]].surface; };
  const auto last_of = [&](std::uint32_t v) -> CutTubes& { return last_[kept[v]].tubes; };
  std::vector<double> turns(plan.channels.size() + plan.holes.size(), 0);
  for (int i = 1;; ++i) {
    auto carved =
        Carver(outer_, surface_, kept.size(), surface_of, last_of, plan, tolerance_, turns).carve(monitor);
    const auto* uncut = std::get_if<UncutTubes>(&carved);
    if (uncut == nullptr || i == kMostTurns) return carved;
    for (const std::size_t window : uncut->windows) turns[window] += kTurn;
    for (const std::size_t hole : uncut->holes) turns[plan.channels.size() + hole] += kTurn;
  }
}

std::variant<Solid, UncutTubes> carve_drained_cells(const Mesh& outer, const SurfaceIndex& surface,
                                                    const CellVoids& cells, const DrainagePlan& plan,
                                                    double tolerance, Monitor& monitor) {
  std::vector<std::uint32_t> all(cells.voids.size());
  std::iota(all.begin(), all.end(), 0U);
  return CellCarver(outer, surface, cells, tolerance).carve(all, plan, monitor);
}

}  // namespace aerate
