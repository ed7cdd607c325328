#include "pipeline/budget.h"

#include <fmt/format.h>
#include <string>

#include "core/error.h"
#include "packing/adaptive.h"
#include "packing/hexagonal.h"
#include "pipeline/memory.h"
#include "printing/carve.h"

namespace aerate {
namespace {

// Memory for each triangle of the result while it is written, read back and checked: twice the mesh, 18 bytes
// a triangle, and the table that welds it. Measured as 48 bytes on 30 million triangles, doubled here for
// formats that are made in memory and for what an allocator leaves unused.
constexpr double kBytesPerOutputTriangle = 100;

// What each triangle outside takes beyond that: the hierarchy that walls are measured with and, if the
// surface was remeshed, its edges.
constexpr double kBytesPerOuterTriangle = 150;

double bytes_of_result(double void_triangles, std::size_t outer_triangles) {
  const auto outer = static_cast<double>(outer_triangles);
  return (outer + void_triangles) * kBytesPerOutputTriangle + outer * kBytesPerOuterTriangle;
}

void require(double needed, const std::string& what, const std::string& hint) {
  const double available = available_memory_bytes();
  if (needed <= available) return;
  throw UsageError(fmt::format("{} would need about {}, and {} of memory are available", what,
                               format_bytes(needed), format_bytes(available)),
                   hint);
}

}  // namespace

void require_memory_for_packing(const Mesh& mesh, const PackingRequest& request) {
  double needed = 0;
  switch (request.method) {
    case PackingMethod::adaptive:
      needed = estimate_adaptive_bytes(mesh, request.limits, request.stop);
      require(
          needed,
          fmt::format("packing spheres down to radius {:.3g} mm into this model", request.limits.min_radius),
          "give a larger --min-radius (the number of spheres grows with the inverse of its cube), or limit "
          "it "
          "with --max-voids");
      return;
    case PackingMethod::given:
      return;
    case PackingMethod::hexagonal:
      needed = estimate_hexagonal_bytes(mesh, request.limits);
      break;
  }
  require(needed,
          fmt::format("packing spheres of radius {:.3g} mm into this model", request.limits.max_radius),
          "give a larger --max-radius: the number of spheres falls with its cube");
}

void require_memory_for_voids(const Packing& packing, double tolerance, std::size_t outer_triangles) {
  const CarveOptions options{.tolerance = tolerance};
  if (bytes_of_result(most_void_triangles(packing, options), outer_triangles) <= available_memory_bytes())
    return;
  const std::size_t in_voids = estimate_void_triangles(packing, options);
  require(
      bytes_of_result(static_cast<double>(in_voids), outer_triangles),
      fmt::format("a result of {} triangles ({} voids)", outer_triangles + in_voids, packing.spheres.size()),
      "give a larger --tolerance or --min-radius, or limit it with --max-triangles");
}

double tolerance_for(const Packing& packing, double asked, std::size_t outer_triangles,
                     std::optional<std::size_t> max_triangles) {
  if (!max_triangles) return asked;
  const std::size_t for_voids = *max_triangles > outer_triangles ? *max_triangles - outer_triangles : 0;
  const auto loosened = loosen_tolerance(packing, CarveOptions{.tolerance = asked}, for_voids);
  if (!loosened) {
    throw UsageError(
        fmt::format("--max-triangles {}: the model has {} triangles of its own, and {} voids take "
                    "more than the {} that are left, however coarse they are",
                    *max_triangles, outer_triangles, packing.spheres.size(), for_voids),
        "allow more triangles, or give a larger --min-radius for fewer voids");
  }
  return *loosened;
}

}  // namespace aerate
