#include <algorithm>
#include <chrono>
#include <cmath>
#include <fmt/format.h>
#include <numbers>
#include <random>
#include <string>

#include "bench/containers.h"
#include "core/monitor.h"
#include "kernels/hexagonal.h"
#include "kernels/point_triangle.h"
#include "kernels/winding.h"
#include "packing/hexagonal.h"
#include "packing/verify.h"

// The paper's Tables 2 and 3 beside ours: no wall, no gap, its radii.

namespace aerate::bench {
namespace {

double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

// Places of all four kinds, as the paper counts its spheres: the bounding box filled, and 61 for each lattice
// sphere that met the surface.
std::size_t places_of(const Packing& packing) {
  return packing.statistics.candidates;
}

// One place tested against every triangle, as the method without an index does: crossings, then distances.
bool fits_by_brute_force(const Mesh& mesh, Vec3d centre, double radius) {
  int winding = 0;
  const auto facet = [&](const Triangle& t) {
    return kernels::Facet{mesh.positions[t[0]], mesh.positions[t[1]], mesh.positions[t[2]]};
  };
  for (const Triangle& t : mesh.triangles)
    winding += kernels::winding_detail::facet_crossing(facet(t), centre);
  if (winding != 1) return false;
  for (const Triangle& t : mesh.triangles) {
    if (kernels::distance_squared_to_facet(centre, facet(t)) < radius * radius) return false;
  }
  return true;
}

// Seconds on one thread to test all places by brute force, extrapolated from a random sample of lattice
// places.
double brute_force_seconds(const Mesh& mesh, double radius, std::size_t places) {
  const Box3f box = bounding_box(mesh);
  const kernels::HexagonalLattice lattice =
      kernels::make_hexagonal_lattice({to_double(box.lower), to_double(box.upper)}, radius);
  std::mt19937_64 random(1);
  std::uniform_int_distribution<std::uint32_t> slot(
      0, static_cast<std::uint32_t>(lattice.cell_count() * kernels::kLatticePerCell - 1));
  const std::size_t sample = std::clamp<std::size_t>(30'000'000 / mesh.triangles.size(), 20, 20'000);
  std::size_t fitting = 0;
  const auto start = std::chrono::steady_clock::now();
  for (std::size_t i = 0; i < sample; ++i) {
    if (fits_by_brute_force(mesh, lattice.lattice_position(slot(random)), radius)) ++fitting;
  }
  const double seconds = seconds_since(start);
  if (fitting > sample) throw std::logic_error("more spheres fit than were tested");
  return seconds / static_cast<double>(sample) * static_cast<double>(places);
}

// Bytes of the paper's dense matrices (boxes x triangles, spheres x boxes), one byte a value, box edge 4 x
// the sphere's diameter.
double dense_matrix_bytes(const Mesh& mesh, double radius, std::size_t places) {
  const Box3f box = bounding_box(mesh);
  const Vec3d extent = to_double(box.upper) - to_double(box.lower);
  const double edge = 4 * 2 * radius;
  const double boxes = std::ceil(extent.x / edge) * std::ceil(extent.y / edge) * std::ceil(extent.z / edge);
  return boxes * (static_cast<double>(mesh.triangles.size()) + static_cast<double>(places));
}

void print_row(const Container& container, const Mesh& mesh) {
  const PackingLimits limits{0, 0, 0, container.max_radius};
  Monitor monitor;
  Packing packing;
  double seconds = 1e300;
  for (int run = 0; run < 3; ++run) {
    const auto start = std::chrono::steady_clock::now();
    packing = pack_hexagonal(mesh, limits, monitor);
    seconds = std::min(seconds, seconds_since(start));
  }
  const std::size_t packed = packing.spheres.size();
  packing = verify_packing(mesh, packing);
  std::size_t kinds[4] = {};
  for (const Sphere& sphere : packing.spheres) ++kinds[static_cast<std::size_t>(sphere.kind)];
  const double volume = container.table_volume.value_or(signed_volume(mesh));
  const double density = 100 * total_volume(packing) / volume;
  fmt::print(
      "| {} | {} | {:.2f} | {:.2f} | {:+.2f} | {} / {} / {} / {} | {} | {:.3f} | {:.1f}* | {:.2f} | {:.2f} | "
      "{:.2f} | {:.0f} | {:.1f} | {:.0f}* |\n",
      container.name, mesh.triangles.size(), container.paper_density, density,
      density - container.paper_density, kinds[0], kinds[1], kinds[2], kinds[3],
      packed - packing.spheres.size(), seconds,
      brute_force_seconds(mesh, container.max_radius, places_of(packing)),
      container.paper_brute_force_seconds, container.paper_indexed_seconds, container.paper_best_seconds,
      container.paper_best_seconds / seconds, static_cast<double>(packing.statistics.index_bytes) / 1e6,
      dense_matrix_bytes(mesh, container.max_radius, places_of(packing)) / 1e6);
}

}  // namespace
}  // namespace aerate::bench

int main(int argc, char** argv) {
  using namespace aerate::bench;
  const std::string models = argc > 1 ? argv[1] : "../shared/models";
  fmt::print(
      "Hexagonal packing of the paper's containers: no wall, no gap, disjoint spheres (the paper's medium\n"
      "spheres overlap). Seconds are the least of three runs with all threads, index included; * "
      "extrapolated\n"
      "from a sample, one thread. Spheres: lattice / interstice / tetrahedral / replacement.\n\n"
      "| container | triangles | paper % | ours % | diff | spheres | dropped by verification | ours s | our "
      "brute "
      "force s | paper brute s | paper indexed s | paper best GPU s | paper best / ours | index MB | paper's "
      "matrices MB |\n|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|\n");
  for (const Container& container : paper_containers()) {
    if (const auto mesh = container_mesh(container, models)) {
      print_row(container, *mesh);
    } else {
      fmt::print("| {} | skipped: {}/{} is not there |\n", container.name, models, container.model_file);
    }
  }
}
