#include "packing/adaptive.h"

#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "kernels/adaptive_cuda.h"
#include "kernels/adaptive_packing.h"
#include "kernels/exec_cpu.h"
#include "packing/run_on_device.h"

namespace aerate {
namespace {

void check(const PackingLimits& limits, const AdaptiveOptions& options) {
  const auto is_length = [](double x) { return x >= 0 && std::isfinite(x); };
  if (!is_length(limits.wall) || !is_length(limits.gap) || !is_length(limits.min_radius)) {
    throw UsageError("wall, gap and least radius must be lengths of 0 mm or more");
  }
  if (!(limits.max_radius > 0) || limits.max_radius < limits.min_radius) {
    throw UsageError("the largest radius must be above 0 mm and not below the least radius");
  }
  if (!(options.target_density > 0) || options.target_density > 1) {
    throw UsageError("the target density must be above 0 and at most 1");
  }
  const bool ends = limits.min_radius > 0 || options.target_density < 1 ||
                    options.max_count < std::numeric_limits<std::size_t>::max();
  if (!ends) {
    throw UsageError("an adaptive packing without a least radius has no end",
                     "give --min-radius, --max-voids or --target-density");
  }
}

kernels::AdaptiveInput input_for(const Mesh& mesh, const PackingLimits& limits,
                                 const AdaptiveOptions& options, Monitor& monitor) {
  const Box3f box = bounding_box(mesh);
  kernels::AdaptiveInput input;
  input.positions = mesh.positions;
  input.triangles = mesh.triangles;
  input.box = {to_double(box.lower), to_double(box.upper)};
  input.volume = std::abs(signed_volume(mesh));
  input.parameters.wall = limits.wall;
  input.parameters.gap = limits.gap;
  input.parameters.min_radius = limits.min_radius;
  input.parameters.max_radius = limits.max_radius;
  input.parameters.max_count = options.max_count;
  input.parameters.roof = limits.roof;
  if (options.target_density < 1) {
    input.parameters.max_volume = options.target_density * options.volume.value_or(input.volume);
  }
  input.progress = [&monitor](double share) {
    monitor.progress(share);
    monitor.check_interrupted();
  };
  return input;
}

// How many spheres of the least radius, each with half the gap around it, have so much volume; no more than
// are wanted.
double smallest_spheres_in(double volume, const PackingLimits& limits, const AdaptiveOptions& options) {
  constexpr double kSphereVolume = 4.18879;
  const double smallest = limits.min_radius + limits.gap / 2;
  const auto wanted = static_cast<double>(options.max_count);
  if (!(smallest > 0)) return wanted;
  return std::min(wanted, volume / (kSphereVolume * smallest * smallest * smallest));
}

double most_spheres(double volume, const PackingLimits& limits, const AdaptiveOptions& options) {
  // The least radius is that of few at first, but of most at the end (measured on models of all kinds).
  constexpr double kShareOfVolume = 0.4;
  return smallest_spheres_in(kShareOfVolume * volume, limits, options);
}

// How many spheres there are going to be, within a factor of two on the models of docs/cuda.md: a share of
// the volume beyond the wall, in units of the smallest sphere's, that falls as the radii spread.
double expected_spheres(const Mesh& mesh, double volume, const PackingLimits& limits,
                        const AdaptiveOptions& options) {
  constexpr double kShareOfEqual = 0.74, kShareOfWide = 0.05, kFall = 2.27;
  const double beyond_wall = std::max(volume - surface_area(mesh) * limits.wall, 0.05 * volume);
  const double spread = (limits.max_radius + limits.gap / 2) / (limits.min_radius + limits.gap / 2);
  const double share = std::max(kShareOfEqual * std::pow(spread, -kFall), kShareOfWide);
  return smallest_spheres_in(share * beyond_wall, limits, options);
}

// Seconds for a facet to be indexed and for a sphere to be placed, on one thread of a CPU (docs/cuda.md tells
// how they were measured).
WorkEstimate estimate_work(const Mesh& mesh, double volume, const PackingLimits& limits,
                           const AdaptiveOptions& options) {
  constexpr double kSecondsPerFacet = 0.8e-6;
  constexpr double kSecondsPerSphere = 200e-6, kSecondsPerVoidWithRoof = 320e-6;
  const auto facets = static_cast<double>(mesh.triangles.size());
  const double spheres = expected_spheres(mesh, volume, limits, options);
  const bool has_roofs = limits.roof.shapes(limits.max_radius);
  return {facets * kSecondsPerFacet + spheres * (has_roofs ? kSecondsPerVoidWithRoof : kSecondsPerSphere),
          facets * (sizeof(Triangle) + sizeof(Vec3f)) + spheres * sizeof(kernels::Ball)};
}

Packing packing_of(const kernels::AdaptiveResult& result, const PackingLimits& limits) {
  Packing packing;
  packing.limits = limits;
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

template <typename Executor>
kernels::AdaptiveResult pack_with(const Executor& executor, const kernels::AdaptiveInput& input,
                                  bool has_roofs) {
  return has_roofs ? kernels::pack_adaptive_with_roofs(executor, input)
                   : kernels::pack_adaptive(executor, input);
}

}  // namespace

Packing pack_adaptive(const Mesh& mesh, const PackingLimits& limits, const AdaptiveOptions& options,
                      Monitor& monitor, const DeviceRequest& device) {
  check(limits, options);
  if (mesh.triangles.empty() || options.max_count == 0) return {{}, limits, {}, {}};
  const kernels::AdaptiveInput input = input_for(mesh, limits, options, monitor);
  DeviceUse use;
  const bool has_roofs = limits.roof.shapes(limits.max_radius);
  const auto on_cpu = [&](DeviceRequest::Kind kind) {
    return kind == DeviceRequest::Kind::cpu_one_thread
               ? pack_with(kernels::SerialExecutor{}, input, has_roofs)
               : pack_with(kernels::TbbExecutor{}, input, has_roofs);
  };
  const auto on_cuda = [&](int index) {
    return has_roofs ? kernels::pack_adaptive_with_roofs_on_cuda(index, input)
                     : kernels::pack_adaptive_on_cuda(index, input);
  };
  Packing packing = packing_of(run_on_device(device, estimate_work(mesh, input.volume, limits, options),
                                             monitor, use, on_cpu, on_cuda),
                               limits);
  packing.device = std::move(use);
  return packing;
}

double estimate_adaptive_bytes(const Mesh& mesh, const PackingLimits& limits,
                               const AdaptiveOptions& options) {
  const double index_bytes = static_cast<double>(mesh.triangles.size()) * (4 * sizeof(kernels::Facet) + 64);
  // Each sphere comes with the cells around it and its entries in the grid: 560 to 1,700 bytes as measured
  // (docs/benchmarks.md).
  constexpr double kBytesPerSphere = 2000;
  return index_bytes + most_spheres(std::abs(signed_volume(mesh)), limits, options) * kBytesPerSphere +
         (1 << 24);
}

}  // namespace aerate
