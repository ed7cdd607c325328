#include "pipeline/budget.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <string>
#include <tbb/task_arena.h>

#include "core/error.h"
#include "core/listed.h"
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
  if (!request.spheres.empty()) return;
  const MemoryNeed need = request.method->memory(mesh, request.limits(), request.stop);
  require(need.bytes, need.job, need.hint);
}

void require_memory_for_voids(const Packing& packing, double tolerance, std::size_t outer_triangles,
                              std::size_t copies) {
  const CarveOptions options{.tolerance = tolerance};
  const auto times = static_cast<double>(copies);
  if (bytes_of_result(times * most_void_triangles(packing, options), outer_triangles) <=
      available_memory_bytes())
    return;
  const std::size_t in_voids = copies * estimate_void_triangles(packing, options);
  require(bytes_of_result(static_cast<double>(in_voids), outer_triangles),
          fmt::format("a result of {} triangles ({})", outer_triangles + in_voids,
                      counted(packing.spheres.size(), "void", "voids")),
          "give a larger --tolerance or --min-radius, or limit it with --max-triangles");
}

void require_memory_for_cells(const Mesh& mesh, const Packing& packing, const CellShape& shape) {
  // About five triangles for each square of nodes before most are taken out, of no more surface than the model's
  // and twice what plane walls between balls of the packing's sizes have; and the nodes that a thread looks at.
  constexpr double kTrianglesPerSquare = 5, kBytesPerTriangle = 60, kBytesPerNode = 40;
  const double spacing = node_spacing(shape, packing.limits);
  double walls = 0, largest = 0;
  for (const Sphere& sphere : packing.spheres) {
    walls += 24 * sphere.radius * sphere.radius;
    largest = std::max(largest, sphere.radius);
  }
  const double triangles = kTrianglesPerSquare * (surface_area(mesh) + walls) / (spacing * spacing);
  const double nodes = signed_volume(mesh) / (spacing * spacing * spacing);
  const double in_hand =
      std::min(nodes, std::pow(4 * largest / spacing, 3) * tbb::this_task_arena::max_concurrency());
  require(
      triangles * kBytesPerTriangle + in_hand * kBytesPerNode,
      fmt::format("cells with a fillet of {:g} mm to a tolerance of {:g} mm ({:.3g} million lattice nodes)",
                  shape.fillet, shape.tolerance, nodes / 1e6),
      "give a larger --tolerance or --fillet");
}

double tolerance_for(const Packing& packing, double asked, std::size_t outer_triangles,
                     std::optional<std::size_t> max_triangles, std::size_t copies) {
  if (!max_triangles) return asked;
  const std::size_t left = *max_triangles > outer_triangles ? *max_triangles - outer_triangles : 0;
  const std::size_t for_voids = left / copies;
  const auto loosened = loosen_tolerance(packing, CarveOptions{.tolerance = asked}, for_voids);
  if (!loosened) {
    throw UsageError(
        fmt::format("--max-triangles {}: the model has {} triangles of its own, and {} more than the {} "
                    "that are left{}, however coarse",
                    *max_triangles, outer_triangles,
                    counted(packing.spheres.size(), "void takes", "voids take"), for_voids,
                    copies > 1 ? " beside their support blockers" : ""),
        "allow more triangles, or give a larger --min-radius for fewer voids");
  }
  return *loosened;
}

void notice_if_loosened(double tolerance, double asked, std::optional<std::size_t> max_triangles,
                        Monitor& monitor) {
  if (!max_triangles || tolerance <= asked) return;
  monitor.notice(fmt::format("the tolerance is {:.3g} mm instead of {:.3g} mm to stay within {} triangles",
                             tolerance, asked, *max_triangles));
}

}  // namespace aerate
