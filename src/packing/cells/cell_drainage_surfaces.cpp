#include "packing/cells/cell_drainage_surfaces.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace aerate {
namespace {

Mesh all_surfaces(const CellVoids& cells) {
  Mesh mesh;
  for (const CellVoid& one : cells.voids) {
    const auto offset = static_cast<std::uint32_t>(mesh.positions.size());
    mesh.positions.insert(mesh.positions.end(), one.surface.positions.begin(), one.surface.positions.end());
    for (const Triangle& t : one.surface.triangles)
      mesh.triangles.push_back({t[0] + offset, t[1] + offset, t[2] + offset});
  }
  return mesh;
}

std::vector<std::uint32_t> first_triangles(const CellVoids& cells) {
  std::vector<std::uint32_t> first{0};
  for (const CellVoid& one : cells.voids)
    first.push_back(first.back() + static_cast<std::uint32_t>(one.surface.triangles.size()));
  return first;
}

Packing without_spheres(const PackingLimits& limits) {
  Packing packing;
  packing.limits = limits;
  return packing;
}

}  // namespace

std::vector<Vec3d> lines_round(Vec3d at, const Tube& tube, Vec3d up) {
  const TubeFrame frame = frame_of(tube, up);
  std::vector<Vec3d> starts;
  for (int i = 0; i < kTubeSides; ++i) {
    const double angle = 2 * std::numbers::pi * i / kTubeSides;
    starts.push_back(at + (frame.down * std::cos(angle) + frame.across * std::sin(angle)) * tube.radius);
  }
  return starts;
}

CellSurfaces::CellSurfaces(const SurfaceIndex& model, const CellVoids& cells, const PackingLimits& limits,
                           double longest, const SurfaceIndex* kept)
    : first_(first_triangles(cells)),
      index_(all_surfaces(cells)),
      gap_(limits.gap),
      model_(model, without_spheres(limits), longest, 0, kept),
      voids_(index_, without_spheres(limits), longest, 0) {}

bool CellSurfaces::keeps_gap(const Tube& tube, std::uint32_t from, std::uint32_t to) const {
  const auto near = index_.triangles_near({tube.start, tube.end}, tube.radius + gap_);
  return std::all_of(near.begin(), near.end(), [&](std::uint32_t triangle) {
    const auto after = std::upper_bound(first_.begin(), first_.end(), triangle);
    const auto owner = static_cast<std::uint32_t>(after - first_.begin() - 1);
    return owner == from || owner == to;
  });
}

}  // namespace aerate
