#include "printing/cut_holes.h"

#include <algorithm>
#include <fmt/format.h>
#include <iterator>
#include <optional>
#include <tbb/parallel_for.h>
#include <utility>

#include "core/segment_distance.h"
#include "printing/cut_surface.h"
#include "printing/tube_openings.h"

namespace aerate {
namespace {

// A prism begins this much inside its ball's surface, mm.
constexpr double kPrismMargin = 0.02;

CuttingPrism prism_of(const WayOut& way, const Roof& roof, double tolerance) {
  const Tube& tube = way.tube;
  const Opening opening = opening_of(tube, TubeEnd::start, way.ball, roof, sides_of(tube, tolerance));
  const Vec3d along = tube.end - tube.start;
  CuttingPrism prism;
  prism.axis = normalised(along);
  prism.start = tube.start - prism.axis * kPrismMargin;
  prism.length = length(along) + kPrismMargin + kCutBeyond * tube.radius;
  prism.radius = tube.radius;
  for (const Vec3d p : opening.ring) prism.ring.push_back(to_float(p));
  return prism;
}

// The triangles of the whole surface that a hole may meet, and how it is cut out of them.
struct LoneCut {
  std::vector<std::uint32_t> near;
  std::optional<SurfaceCut> cut;
};

// A surface out of which holes are cut, one after the other. Triangles that were cut away keep their places
// until the end.
class SurfaceInWork {
 public:
  SurfaceInWork(const Mesh& whole, Mesh& mesh) : whole_(whole), mesh_(mesh) {
    mesh_ = whole;
    is_removed_.assign(whole.triangles.size(), false);
  }

  // What is left of triangles of the whole surface, and what cuts have made in their stead.
  std::vector<std::uint32_t> what_is_left_of(std::span<const std::uint32_t> of_whole,
                                             const CuttingPrism& prism) const {
    std::vector<std::uint32_t> near;
    const auto is_there = [this](std::uint32_t t) { return !is_removed_[t]; };
    std::copy_if(of_whole.begin(), of_whole.end(), std::back_inserter(near), is_there);
    for (auto t = static_cast<std::uint32_t>(whole_.triangles.size()); t < mesh_.triangles.size(); ++t) {
      const auto [a, b, c] = mesh_.triangles[t];
      const kernels::Facet facet{mesh_.positions[a], mesh_.positions[b], mesh_.positions[c]};
      if (is_there(t) && distance_to_facet(axis_of(prism), facet) < reach_of(prism)) near.push_back(t);
    }
    return near;
  }

  // How a hole is cut out of what there is now.
  std::optional<SurfaceCut> cut_for(const CuttingPrism& prism, const LoneCut& lone) const {
    const std::vector<std::uint32_t> near = what_is_left_of(lone.near, prism);
    if (near != lone.near) return cut_surface(mesh_, near, prism);
    std::optional<SurfaceCut> cut = lone.cut;
    if (!cut) return cut;
    // Its own vertices come after those of the holes before it.
    const auto added = static_cast<std::uint32_t>(mesh_.positions.size() - whole_.positions.size());
    for (std::vector<Triangle>* triangles : {&cut->surface, &cut->sides}) {
      for (Triangle& t : *triangles) {
        for (std::uint32_t& v : t) v += v < whole_.positions.size() ? 0 : added;
      }
    }
    return cut;
  }

  void apply(const SurfaceCut& cut) {
    mesh_.triangles.insert(mesh_.triangles.end(), cut.surface.begin(), cut.surface.end());
    mesh_.positions.insert(mesh_.positions.end(), cut.new_positions.begin(), cut.new_positions.end());
    is_removed_.resize(mesh_.triangles.size(), false);
    for (const std::uint32_t t : cut.removed) is_removed_[t] = true;
  }

  // Takes away what was cut away; returns how many triangles of the whole surface are kept.
  std::size_t finish() {
    std::size_t left = 0, kept = 0;
    for (std::size_t t = 0; t < mesh_.triangles.size(); ++t) {
      if (is_removed_[t]) continue;
      if (t < whole_.triangles.size()) ++kept;
      mesh_.triangles[left++] = mesh_.triangles[t];
    }
    mesh_.triangles.resize(left);
    return kept;
  }

 private:
  const Mesh& whole_;
  Mesh& mesh_;
  std::vector<bool> is_removed_;
};

}  // namespace

bool may_be_cut(const Mesh& outer, const SurfaceIndex& surface, const WayOut& way, const Roof& roof,
                double tolerance) {
  const CuttingPrism prism = prism_of(way, roof, tolerance);
  return may_be_cut(outer, surface.triangles_near(axis_of(prism), reach_of(prism)), prism);
}

FailureError cannot_be_cut(const EscapeHole& hole) {
  const Vec3d end = hole.tube.end;
  return FailureError(fmt::format("the surface cannot be cut for an escape hole near ({:f}, {:f}, {:f}) mm",
                                  end.x, end.y, end.z),
                      "ask for other places with --escape-hole");
}

std::variant<OuterWithHoles, UncutHoles> cut_holes(const Mesh& outer, const SurfaceIndex& surface,
                                                   const Packing& packing, const DrainagePlan& plan,
                                                   const CarveOptions& options, Monitor& monitor) {
  std::vector<CuttingPrism> prisms;
  for (const EscapeHole& hole : plan.holes)
    prisms.push_back(
        prism_of({hole.tube, packing.spheres[hole.from]}, packing.limits.roof, options.tolerance));
  // Few holes meet the same triangles, and the others do not depend on each other.
  std::vector<LoneCut> lone(prisms.size());
  tbb::parallel_for(std::size_t{0}, prisms.size(), [&](std::size_t i) {
    lone[i].near = surface.triangles_near(axis_of(prisms[i]), reach_of(prisms[i]));
    lone[i].cut = cut_surface(outer, lone[i].near, prisms[i]);
  });
  UncutHoles uncut;
  OuterWithHoles result;
  result.tolerance = options.tolerance;
  SurfaceInWork work(outer, result.mesh);
  for (std::size_t i = 0; i < prisms.size(); ++i) {
    monitor.check_interrupted();
    auto cut = work.cut_for(prisms[i], lone[i]);
    if (!cut) {
      uncut.indices.push_back(i);
      continue;
    }
    work.apply(*cut);
    result.holes.push_back({std::move(cut->sides), result.mesh.positions.size(), std::move(prisms[i].ring)});
  }
  if (!uncut.indices.empty()) return uncut;
  result.kept_triangle_count = work.finish();
  return result;
}

}  // namespace aerate
