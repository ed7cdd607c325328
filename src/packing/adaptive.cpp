#include "packing/adaptive.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

#include "core/error.h"
#include "kernels/adaptive_packing.h"
#include "packing/run_on_device.h"

namespace aerate {
namespace {

void check(const PackingLimits& limits, const PackingStop& stop) {
  const auto is_length = [](double x) { return x >= 0 && std::isfinite(x); };
  if (!is_length(limits.wall) || !is_length(limits.gap) || !is_length(limits.min_radius)) {
    throw UsageError("wall, gap and least radius must be lengths of 0 mm or more");
  }
  if (!(limits.max_radius > 0) || limits.max_radius < limits.min_radius) {
    throw UsageError("the largest radius must be above 0 mm and not below the least radius");
  }
  if (!(stop.target_density > 0) || stop.target_density > 1) {
    throw UsageError("the target density must be above 0 and at most 1");
  }
  const bool ends = limits.min_radius > 0 || stop.target_density < 1 ||
                    stop.max_count < std::numeric_limits<std::size_t>::max();
  if (!ends) {
    throw UsageError("an adaptive packing without a least radius has no end",
                     "give --min-radius, --max-voids or --target-density");
  }
}

kernels::AdaptiveInput input_for(const Mesh& mesh, const PackingLimits& limits, const PackingStop& stop,
                                 Monitor& monitor) {
  kernels::AdaptiveInput input{packer_input(mesh, monitor)};
  input.volume = std::abs(signed_volume(mesh));
  input.parameters.wall = limits.wall;
  input.parameters.gap = limits.gap;
  input.parameters.min_radius = limits.min_radius;
  input.parameters.max_radius = limits.max_radius;
  input.parameters.max_count = stop.max_count;
  input.parameters.roof = limits.roof;
  input.parameters.in_level_squares = limits.in_level_squares;
  input.searches_more = stop.effort == PackingEffort::best && stop.max_count > 1;
  if (stop.target_density < 1) {
    input.parameters.max_volume = stop.target_density * stop.volume.value_or(input.volume);
  }
  return input;
}

// How many spheres of the least radius, each with half the gap around it, have so much volume; no more than
// are wanted.
double smallest_spheres_in(double volume, const PackingLimits& limits, const PackingStop& stop) {
  constexpr double kSphereVolume = 4.18879;
  const double smallest = limits.min_radius + limits.gap / 2;
  const auto wanted = static_cast<double>(stop.max_count);
  if (!(smallest > 0)) return wanted;
  return std::min(wanted, volume / (kSphereVolume * smallest * smallest * smallest));
}

double most_spheres(double volume, const PackingLimits& limits, const PackingStop& stop) {
  // The least radius is that of few at first, but of most at the end (measured on models of all kinds).
  constexpr double kShareOfVolume = 0.4;
  return smallest_spheres_in(kShareOfVolume * volume, limits, stop);
}

// How many spheres there are going to be, within a factor of two on the models of docs/cuda.md: a share of
// the volume beyond the wall, in units of the smallest sphere's, that falls as the radii spread.
double expected_spheres(const Mesh& mesh, double volume, const PackingLimits& limits,
                        const PackingStop& stop) {
  constexpr double kShareOfEqual = 0.74, kShareOfWide = 0.05, kFall = 2.27;
  const double beyond_wall = std::max(volume - surface_area(mesh) * limits.wall, 0.05 * volume);
  const double spread = (limits.max_radius + limits.gap / 2) / (limits.min_radius + limits.gap / 2);
  const double share = std::max(kShareOfEqual * std::pow(spread, -kFall), kShareOfWide);
  return smallest_spheres_in(share * beyond_wall, limits, stop);
}

// Seconds for a facet to be indexed and for a sphere to be placed, on one thread of a CPU (docs/cuda.md tells
// how they were measured).
WorkEstimate estimate_work(const Mesh& mesh, double volume, const PackingLimits& limits,
                           const PackingStop& stop) {
  constexpr double kSecondsPerFacet = 0.8e-6;
  constexpr double kSecondsPerSphere = 200e-6, kSecondsPerVoidWithRoof = 320e-6;
  const auto facets = static_cast<double>(mesh.triangles.size());
  const double spheres = expected_spheres(mesh, volume, limits, stop);
  constexpr double kWorkOfBest = 8;  // to normal work, about
  const double effort = stop.effort == PackingEffort::best ? kWorkOfBest : 1;
  const bool has_roofs = limits.roof.shapes(limits.max_radius);
  const double per_sphere = effort * (has_roofs ? kSecondsPerVoidWithRoof : kSecondsPerSphere);
  return {facets * kSecondsPerFacet + spheres * per_sphere,
          facets * (sizeof(Triangle) + sizeof(Vec3f)) + spheres * sizeof(kernels::Ball)};
}

Packing packing_of(OnDevice<kernels::AdaptiveResult> packed, const PackingLimits& limits) {
  const kernels::AdaptiveResult& result = packed.result;
  Packing packing;
  packing.limits = limits;
  packing.device = std::move(packed.use);
  packing.statistics.candidates = result.search_count;
  packing.statistics.index_bytes = result.index_bytes;
  packing.spheres.reserve(result.balls.size());
  for (const kernels::Ball& ball : result.balls) {
    const bool on_lattice = packing.spheres.size() < result.lattice_count;
    packing.spheres.push_back(
        {ball.centre, ball.radius, on_lattice ? SphereKind::lattice : SphereKind::adaptive});
  }
  return packing;
}

MemoryNeed memory_for(const Mesh& mesh, const PackingLimits& limits, const PackingStop& stop) {
  const double index_bytes = static_cast<double>(mesh.triangles.size()) * (4 * sizeof(kernels::Facet) + 64);
  // Each sphere comes with the cells around it and its entries in the grid: 560 to 1,700 bytes as measured
  // (docs/benchmarks.md).
  constexpr double kBytesPerSphere = 2000;
  const double spheres = most_spheres(std::abs(signed_volume(mesh)), limits, stop);
  return {
      index_bytes + spheres * kBytesPerSphere + (1 << 24),
      fmt::format("packing spheres down to radius {:.3g} mm into this model", limits.min_radius),
      "give a larger --min-radius (the number of spheres grows with the inverse of its cube), or limit it "
      "with --max-voids"};
}

}  // namespace

PackingMethod adaptive_method() {
  return {.name = "adaptive",
          .summary = "the largest that fits first, densest",
          .memory = memory_for,
          .pack = pack_adaptive};
}

Packing pack_adaptive(const Mesh& mesh, const PackingLimits& limits, const PackingStop& stop,
                      Monitor& monitor, const DeviceRequest& device) {
  check(limits, stop);
  if (mesh.triangles.empty() || stop.max_count == 0) return {{}, limits, {}, {}};
  const kernels::AdaptiveInput input = input_for(mesh, limits, stop, monitor);
  const WorkEstimate work = estimate_work(mesh, input.volume, limits, stop);
  const auto pack_voids = [&]<typename Shape>(const Shape&) {
    return run_on_device<kernels::AdaptivePacking<Shape>>(device, work, monitor, input);
  };
  const bool has_roofs = limits.roof.shapes(limits.max_radius);
  return packing_of(has_roofs ? pack_voids(kernels::RoofedShape{}) : pack_voids(kernels::BallShape{}),
                    limits);
}

}  // namespace aerate
