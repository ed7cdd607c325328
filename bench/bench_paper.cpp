#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fmt/format.h>
#include <numbers>
#include <random>
#include <string>

#include "bench/benchmark.h"
#include "bench/containers.h"
#include "bench/figures.h"
#include "core/monitor.h"
#include "kernels/hexagonal_packing.h"
#include "kernels/point_triangle.h"
#include "kernels/winding.h"
#include "packing/hexagonal.h"
#include "packing/verify.h"

// The paper's Tables 2 and 3 beside ours: no wall, no gap, its radii.
// Exit status 1 if a sphere breaks a limit, or if a model is missing of which figures were to be written.

namespace aerate::bench {
namespace {

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
  const Stopwatch watch;
  for (std::size_t i = 0; i < sample; ++i) {
    if (fits_by_brute_force(mesh, lattice.lattice_position(slot(random)), radius)) ++fitting;
  }
  const double seconds = watch.seconds();
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

struct Figures {
  double difference = 0;  // of density to the paper's, points
  double seconds = 0;
  double brute_force_seconds = 0;
  std::size_t corrected = 0;  // spheres that verification dropped or shrank: none, unless there is a bug
};

Figures add_row(Table& table, const Container& container, const Mesh& mesh) {
  const PackingLimits limits{0, 0, 0, container.max_radius};
  Monitor monitor;
  Packing packing;
  Figures figures;
  figures.seconds = least_seconds(3, [&] {
    packing = pack_hexagonal(mesh, limits, monitor, {DeviceRequest::Kind::cpu, 0});
  });
  packing = verify_packing(SurfaceIndex(mesh), packing);
  figures.corrected = packing.statistics.dropped_by_verification + packing.statistics.shrunk_by_verification;
  std::size_t kinds[4] = {};
  for (const Sphere& sphere : packing.spheres) ++kinds[static_cast<std::size_t>(sphere.kind)];
  const double volume = container.table_volume.value_or(signed_volume(mesh));
  const double density = 100 * total_volume(packing) / volume;
  figures.difference = density - container.paper_density;
  figures.brute_force_seconds = brute_force_seconds(mesh, container.max_radius, places_of(packing));
  table.add(
      {container.name, grouped(static_cast<double>(mesh.triangles.size())),
       fmt::format("{:.2f}", container.paper_density), fmt::format("{:.2f}", density),
       fmt::format("{:+.2f}", figures.difference),
       fmt::format("{} / {} / {} / {}", kinds[0], kinds[1], kinds[2], kinds[3]),
       fmt::format("{}", figures.corrected), fmt::format("{:.3f}", figures.seconds),
       fmt::format("{:.1f}*", figures.brute_force_seconds),
       fmt::format("{:.2f}", container.paper_brute_force_seconds),
       fmt::format("{:.2f}", container.paper_indexed_seconds),
       fmt::format("{:.2f}", container.paper_best_seconds),
       fmt::format("{:.0f}", container.paper_best_seconds / figures.seconds),
       fmt::format("{:.1f}", static_cast<double>(packing.statistics.index_bytes) / 1e6),
       fmt::format("{:.0f}*", dense_matrix_bytes(mesh, container.max_radius, places_of(packing)) / 1e6)});
  return figures;
}

struct Totals {
  std::size_t containers = 0, missing = 0, corrected = 0;
  double sum_of_differences = 0, largest_difference = 0;  // absolute, points
  std::string summary;                                    // of the paper's largest case
};

void add(Totals& totals, const Container& container, const Figures& figures) {
  ++totals.containers;
  totals.corrected += figures.corrected;
  totals.sum_of_differences += std::abs(figures.difference);
  totals.largest_difference = std::max(totals.largest_difference, std::abs(figures.difference));
  if (container.name != "Dragon HT") return;
  totals.summary = fmt::format(
      "| the paper's largest case, \"Dragon HT\" (hexagonal, r = {:g}) | {:.2f} s; by brute force {} s "
      "(one thread, extrapolated); the paper: {} s sequential, {:.0f} s on its best GPU |\n",
      container.max_radius, figures.seconds, grouped(figures.brute_force_seconds),
      grouped(container.paper_indexed_seconds), container.paper_best_seconds);
}

int run(const Arguments& arguments) {
  const std::string models = arguments.text(0, "../shared/models");
  fmt::print(
      "Hexagonal packing of the paper's containers: no wall, no gap, disjoint spheres (the paper's medium\n"
      "spheres overlap). Seconds are the least of three runs with all threads, index included; * "
      "extrapolated\nfrom a sample, one thread. Spheres: lattice / interstice / tetrahedral / "
      "replacement.\n\n");
  Table table({"container", "triangles", "paper %", "ours %", "diff", "spheres", "corrected by verification",
               "ours s", "our brute force s", "paper brute s", "paper indexed s", "paper best GPU s",
               "paper best / ours", "index MB", "paper's matrices MB"});
  Totals totals;
  for (const Container& container : paper_containers()) {
    if (const auto mesh = container_mesh(container, models)) {
      add(totals, container, add_row(table, container, *mesh));
    } else {
      ++totals.missing;
      fmt::print(stderr, "{} is skipped: {}/{} is not there\n", container.name, models, container.model_file);
    }
  }
  const double mean =
      totals.sum_of_differences / static_cast<double>(std::max<std::size_t>(totals.containers, 1));
  const std::string differences =
      fmt::format("Mean absolute difference of density to the paper: {:.2f} points, none above {:.2f}.", mean,
                  totals.largest_difference);
  fmt::print("\n{}\n", differences);
  if (totals.corrected > 0) fmt::print(stderr, "{} spheres broke a limit\n", totals.corrected);
  if (totals.corrected > 0) return 1;
  if (totals.missing > 0) return arguments.wants_figures() ? 1 : 0;
  totals.summary += fmt::format(
      "| densities of the paper's ten containers (hexagonal, disjoint spheres) | {:.2f} points from the "
      "paper's on average, {:.2f} at most |\n",
      mean, totals.largest_difference);
  write_figures(arguments, table.markdown() + '\n' + differences + '\n', totals.summary);
  return 0;
}

}  // namespace
}  // namespace aerate::bench

int main(int argc, char** argv) {
  return aerate::bench::run_benchmark(argc, argv, {"[MODELS]", 0, 1, aerate::bench::Tables::written},
                                      aerate::bench::run);
}
