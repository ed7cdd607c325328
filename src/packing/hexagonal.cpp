#include "packing/hexagonal.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <limits>

#include "core/error.h"
#include "kernels/hexagonal_strips.h"
#include "packing/run_on_device.h"

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

kernels::HexagonalInput input_for(const Mesh& mesh, const PackingLimits& limits, Monitor& monitor) {
  kernels::HexagonalInput input{packer_input(mesh, monitor)};
  input.grid = grid_for(input.box, mesh.triangles.size(), limits);
  input.parameters = parameters_for(input.box, limits);
  return input;
}

// Seconds for a facet to be indexed and for a place to be tested, on one thread of a CPU (docs/cuda.md tells
// how they were measured).
WorkEstimate estimate_work(const Mesh& mesh, const kernels::HexagonalInput& input) {
  constexpr double kSecondsPerFacet = 0.6e-6;
  constexpr double kSecondsPerPlace = 1.0e-6;
  const double radius = input.parameters.lattice_radius;
  const auto facets = static_cast<double>(input.triangles.size());
  const auto scheme = static_cast<double>(
      kernels::make_hexagonal_lattice(input.box, radius).cell_count() *
      (kernels::kLatticePerCell + kernels::kIntersticesPerCell + kernels::kTetrahedralPerCell));
  // Lattice spheres whose centres are within their radius and the wall of the surface give way to 61 each.
  const double met =
      surface_area(mesh) * (radius + input.parameters.wall) / (4 * std::sqrt(2.0) * radius * radius * radius);
  const double places = scheme + kernels::kReplacements * std::min(met, scheme / 5);
  return {facets * kSecondsPerFacet + places * kSecondsPerPlace,
          facets * (sizeof(Triangle) + sizeof(Vec3f)) + places * sizeof(Sphere)};
}

Packing packing_of(OnDevice<kernels::HexagonalResult> packed, const PackingLimits& limits) {
  kernels::HexagonalResult& result = packed.result;
  const auto count = [&](CandidateState state) {
    return static_cast<std::size_t>(result.state_counts[static_cast<std::size_t>(state)]);
  };
  Packing packing;
  packing.limits = limits;
  packing.device = std::move(packed.use);
  packing.statistics.outside = count(CandidateState::outside);
  packing.statistics.overlapped_region = count(CandidateState::overlapped_region);
  packing.statistics.near_surface = count(CandidateState::near_surface);
  packing.statistics.below_min_radius = count(CandidateState::below_min_radius);
  packing.statistics.candidates = packing.statistics.outside + packing.statistics.overlapped_region +
                                  packing.statistics.near_surface + packing.statistics.below_min_radius +
                                  result.spheres.size();
  packing.statistics.index_bytes = result.index_bytes;
  packing.statistics.index_references = result.index_references;
  packing.statistics.index_cells = result.index_cells;
  packing.spheres = std::move(result.spheres);
  return packing;
}

// Cells of the lattice over a box, about.
double lattice_cells(Vec3d extent, double radius) {
  return (extent.x / (2 * radius) + 1) * (extent.y / (2 * kernels::HexagonalLattice::kRow * radius) + 1) *
         (extent.z / (kernels::HexagonalLattice::kLayer * radius) + 1);
}

MemoryNeed memory_for_lattice(const Mesh& mesh, const PackingLimits& limits, const PackingStop& /*stop*/) {
  const Box3f box = bounding_box(mesh);
  const Vec3d extent = to_double(box.upper) - to_double(box.lower);
  const double radius = limits.max_radius + limits.gap / 2;
  const double cells = lattice_cells(extent, radius);
  const double places = cells * static_cast<double>(kernels::kIntersticesPerCell);
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
  const double slab = std::min(std::max(places, replaced), static_cast<double>(kernels::kMostSlots));
  // Of all places at most about three in four lie inside a box-filling model and are emitted (twice, while
  // they are copied).
  return {index_bytes + slab * static_cast<double>(kernels::kBytesPerSlot) +
              (10 * cells + replaced) * 2 * sizeof(Sphere),
          fmt::format("packing spheres of radius {:.3g} mm into this model", limits.max_radius),
          "give a larger --max-radius: the number of spheres falls with its cube"};
}

}  // namespace

PackingMethod hexagonal_method() {
  return {
      .name = "hexagonal",
      .summary = "a lattice",
      .on_lattice = true,
      .memory = memory_for_lattice,
      .pack = [](const Mesh& mesh, const PackingLimits& limits, const PackingStop& /*stop*/, Monitor& monitor,
                 const DeviceRequest& device) { return pack_hexagonal(mesh, limits, monitor, device); }};
}

Packing pack_hexagonal(const Mesh& mesh, const PackingLimits& limits, Monitor& monitor,
                       const DeviceRequest& device) {
  const Box3f box = bounding_box(mesh);
  const double cells =
      lattice_cells(to_double(box.upper) - to_double(box.lower), limits.max_radius + limits.gap / 2);
  if (!(cells * static_cast<double>(kernels::kIntersticesPerCell) < kLargestCount)) {
    throw FailureError("the hexagonal packing would have more than 2^32 places", "raise --max-radius");
  }
  const kernels::HexagonalInput input = input_for(mesh, limits, monitor);
  return packing_of(
      run_on_device<kernels::HexagonalPacking>(device, estimate_work(mesh, input), monitor, input), limits);
}

}  // namespace aerate
