#include "packing/hexagonal.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/error.h"
#include "kernels/exec_cpu.h"
#include "kernels/hexagonal.h"

namespace aerate {
namespace {

using kernels::CandidateState;

constexpr double kLargestCount = 4294967295.0;

kernels::HexagonalParameters parameters_for(const Box3d& box, const PackingLimits& limits) {
  kernels::HexagonalParameters parameters;
  parameters.lattice_radius = limits.max_radius + limits.gap / 2;
  parameters.half_gap = limits.gap / 2;
  parameters.wall = limits.wall;
  parameters.min_radius = limits.min_radius;
  // A centre is the sum of a few products of doubles no larger than the farthest coordinate.
  const Vec3d farthest = max_of(-box.lower, box.upper);
  const double magnitude = std::max({farthest.x, farthest.y, farthest.z, limits.max_radius});
  parameters.rounding_slack = 16 * std::numeric_limits<double>::epsilon() * magnitude;
  return parameters;
}

// Cells a few times as wide as a facet hold a handful of references each. They need not be finer than what a
// query reaches, and must not be many more than there are facets or candidates.
kernels::CellGrid grid_for(const Box3d& box, std::size_t facets, const PackingLimits& limits) {
  const Vec3d extent = box.upper - box.lower;
  const double box_area = 2 * (extent.x * extent.y + extent.y * extent.z + extent.z * extent.x);
  const double facet_scale =
      2.5 * std::sqrt(box_area / static_cast<double>(std::max<std::size_t>(facets, 1)));
  const double reach = 2 * (limits.max_radius + limits.wall);
  const double most_cells =
      std::max(static_cast<double>(std::size_t{1} << 21), 8 * static_cast<double>(facets));
  const double coarsest = std::max({extent.x, extent.y, extent.z, 1e-30});
  const double finest = std::cbrt(extent.x * extent.y * extent.z / most_cells);
  const double finest_for_flat = std::sqrt(box_area / most_cells);
  return kernels::make_cell_grid(
      box, std::min(coarsest, std::max({std::min(facet_scale, reach), finest, finest_for_flat})));
}

template <typename Executor>
Packing pack(const Executor& executor, const Mesh& mesh, const PackingLimits& limits, Monitor& monitor) {
  const auto facets = kernels::gather_facets(executor, mesh.positions, mesh.triangles);
  const Box3f box_f = bounding_box(mesh);
  const Box3d box{to_double(box_f.lower), to_double(box_f.upper)};
  const auto winding = kernels::build_winding_index(executor, facets.view(), box);
  const auto grid =
      kernels::build_facet_grid(executor, facets.view(), grid_for(box, mesh.triangles.size(), limits));
  monitor.progress(0.3);
  monitor.check_interrupted();
  kernels::HexagonalResult result =
      kernels::pack_hexagonal(executor, winding.view, grid.view, parameters_for(box, limits));
  monitor.progress(1.0);
  monitor.check_interrupted();

  const auto count = [&](CandidateState state) {
    return static_cast<std::size_t>(result.state_counts[static_cast<std::size_t>(state)]);
  };
  Packing packing;
  packing.limits = limits;
  packing.statistics.outside = count(CandidateState::outside);
  packing.statistics.overlapped_region = count(CandidateState::overlapped_region);
  packing.statistics.near_surface = count(CandidateState::near_surface);
  packing.statistics.below_min_radius = count(CandidateState::below_min_radius);
  packing.statistics.candidates = packing.statistics.outside + packing.statistics.overlapped_region +
                                  packing.statistics.near_surface + packing.statistics.below_min_radius +
                                  result.spheres.size();
  packing.statistics.index_bytes = winding.bytes() + grid.bytes();
  packing.spheres = std::move(result.spheres);
  return packing;
}

}  // namespace

double estimate_hexagonal_bytes(const Mesh& mesh, const PackingLimits& limits) {
  const Box3f box = bounding_box(mesh);
  const Vec3d extent = to_double(box.upper) - to_double(box.lower);
  const double radius = limits.max_radius + limits.gap / 2;
  const double cells = (extent.x / (2 * radius) + 1) *
                       (extent.y / (2 * kernels::HexagonalLattice::kRow * radius) + 1) *
                       (extent.z / (kernels::HexagonalLattice::kLayer * radius) + 1);
  const double places = cells * static_cast<double>(kernels::kIntersticesPerCell);
  if (!(places < kLargestCount)) return std::numeric_limits<double>::infinity();
  // Lattice spheres that meet the surface are replaced by 61: at most those in a shell of the box's area.
  const double box_area = 2 * (extent.x * extent.y + extent.y * extent.z + extent.z * extent.x);
  const bool replaces = kernels::kRadiusOf61InUnitSphere * radius - limits.gap / 2 >= limits.min_radius;
  const double shell_volume = 4 * box_area * (radius + limits.wall);
  const double replaced =
      replaces ? std::min(2 * cells, shell_volume / (4 * std::sqrt(2.0) * radius * radius * radius)) * 61 : 0;
  const double facets = static_cast<double>(mesh.triangles.size());
  // Facets, twelve references each, and at most eight cells for each at eight bytes (see grid_for).
  constexpr double kIndexBytesPerFacet = sizeof(kernels::Facet) + 12 * sizeof(std::uint32_t) + 8 * 8;
  constexpr double kLeastIndexBytes = 16777216;
  const double index_bytes = facets * kIndexBytesPerFacet + kLeastIndexBytes;
  // Of all places at most about three in four lie inside a box-filling model and are emitted (twice, while
  // they are copied).
  return index_bytes + std::max(places, replaced) * static_cast<double>(kernels::kBytesPerCandidate) +
         (10 * cells + replaced) * 2 * sizeof(Sphere);
}

Packing pack_hexagonal(const Mesh& mesh, const PackingLimits& limits, Monitor& monitor, CpuThreads threads) {
  if (!std::isfinite(estimate_hexagonal_bytes(mesh, limits))) {
    throw FailureError("the hexagonal packing would have more than 2^32 places", "raise --max-radius");
  }
  return threads == CpuThreads::one ? pack(kernels::SerialExecutor{}, mesh, limits, monitor)
                                    : pack(kernels::TbbExecutor{}, mesh, limits, monitor);
}

}  // namespace aerate
