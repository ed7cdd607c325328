#include <algorithm>
#include <chrono>
#include <ctime>
#include <filesystem>
#include <fmt/format.h>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "bench/fill_with_spheres.h"
#include "core/monitor.h"
#include "core/packing.h"
#include "kernels/triangle_bvh.h"
#include "kernels/winding.h"
#include "mesh/load.h"
#include "packing/adaptive.h"
#include "packing/sphere_pairs.h"

// Adaptive packing: density, time and broken limits for each case, with OpenVDB's fillWithSpheres in the same
// run. Usage: bench_adaptive MODELS_DIRECTORY [REPETITIONS]; times are the least of the repetitions.

namespace aerate::bench {
namespace {

constexpr double kUnlimited = std::numeric_limits<double>::infinity();

struct Case {
  std::string name;
  std::string file;
  PackingLimits limits;
  AdaptiveOptions options;
  double target_density;  // %
  double target_seconds;  // 0 for no target
  double peer_voxel;      // mm; 0 for no comparison
};

// Processor time beside the clock's: on a busy machine the clock says little.
struct Time {
  double seconds = kUnlimited;
  double processor_seconds = kUnlimited;
};

template <typename F>
Time time_of(F f) {
  const auto start = std::chrono::steady_clock::now();
  const std::clock_t processor_start = std::clock();
  f();
  return {std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count(),
          static_cast<double>(std::clock() - processor_start) / CLOCKS_PER_SEC};
}

struct Violations {
  std::size_t wall = 0, gap = 0, winding = 0;
};

// `slack` is 0 for us; for the peer, what fp32 centres and radii explain.
Violations count_violations(const Mesh& mesh, std::span<const Sphere> spheres, const PackingLimits& limits,
                            double slack) {
  const kernels::HostTriangleBvh bvh(mesh.positions, mesh.triangles);
  const kernels::HostWinding winding(mesh.positions, mesh.triangles);
  std::vector<Vec3d> centres;
  for (const Sphere& sphere : spheres) centres.push_back(sphere.centre);
  const std::vector<double> distances = bvh.distances(centres);
  const std::vector<int> numbers = winding.winding_numbers(centres);
  Violations violations;
  for (std::size_t i = 0; i < spheres.size(); ++i) {
    if (distances[i] - spheres[i].radius < limits.wall - slack) ++violations.wall;
    if (numbers[i] != 1) ++violations.winding;
  }
  for (const SpherePair& pair : find_pairs_within(spheres, limits.gap)) {
    if (pair.gap < limits.gap - slack) ++violations.gap;
  }
  return violations;
}

double density_of(const Mesh& mesh, std::span<const Sphere> spheres) {
  Packing packing;
  packing.spheres.assign(spheres.begin(), spheres.end());
  return 100 * total_volume(packing) / signed_volume(mesh);
}

void print_row(const std::string& name, const Mesh& mesh, std::span<const Sphere> spheres, const Time& time,
               const Violations& violations, const std::string& target) {
  fmt::print("| {:<42} | {:>8} | {:>6.2f} | {:>8.3f} | {:>8.3f} | {:>5} {:>5} {:>5} | {:<16} |\n", name,
             spheres.size(), density_of(mesh, spheres), time.seconds, time.processor_seconds, violations.wall,
             violations.gap, violations.winding, target);
  std::fflush(stdout);
}

void run(const Case& c, const std::filesystem::path& models, int repetitions) {
  const std::filesystem::path path = models / c.file;
  if (!std::filesystem::exists(path)) {
    fmt::print("| {:<42} | {} is not there\n", c.name, path.string());
    return;
  }
  const Mesh mesh = load_model(path).mesh;
  Monitor monitor;
  Packing packing;
  Time best;
  for (int i = 0; i < repetitions; ++i) {
    const Time time = time_of([&] {
      packing = pack_adaptive(mesh, c.limits, c.options, monitor, {DeviceRequest::Kind::cpu, 0});
    });
    best.seconds = std::min(best.seconds, time.seconds);
    best.processor_seconds = std::min(best.processor_seconds, time.processor_seconds);
  }
  print_row(c.name, mesh, packing.spheres, best, count_violations(mesh, packing.spheres, c.limits, 0),
            c.target_seconds > 0 ? fmt::format("{} % in {} s", c.target_density, c.target_seconds) : "-");
  if (c.peer_voxel == 0) return;
  std::vector<Sphere> spheres;
  const Time time = time_of([&] { spheres = fill_with_spheres(mesh, c.options.max_count, c.peer_voxel); });
  // Its positions are of voxels, in fp32.
  constexpr double kFloatSlack = 1e-6;
  print_row("  OpenVDB fillWithSpheres", mesh, spheres, time,
            count_violations(mesh, spheres, c.limits, kFloatSlack), "-");
}

std::vector<Case> cases() {
  std::vector<Case> list;
  for (const auto& [count, density, seconds] :
       {std::tuple{100, 64.0, 0.2}, std::tuple{1000, 76.0, 0.5}, std::tuple{10000, 85.0, 3.0}}) {
    AdaptiveOptions options;
    options.max_count = static_cast<std::size_t>(count);
    list.push_back({fmt::format("dino, {} spheres", count),
                    "dino.off",
                    {0, 0, 0, kUnlimited},
                    options,
                    density,
                    seconds,
                    0.02});
  }
  list.push_back({"dragon 100 mm, wall 1.2, gap 0.8, r >= 1.5",
                  "dragon-47k-100mm.stl",
                  {1.2, 0.8, 1.5, kUnlimited},
                  {},
                  33.5,
                  0.5,
                  0});
  list.push_back({"cube 10, r >= 0.2", "cube.stl", {0, 0, 0.2, kUnlimited}, {}, 84.0, 1, 0});
  list.push_back({"cube 10, r >= 0.1", "cube.stl", {0, 0, 0.1, kUnlimited}, {}, 88.5, 3, 0});
  // The paper's cube by the ratio of the radii.
  for (const double least : {0.15, 0.1, 0.05}) {
    list.push_back({fmt::format("cube 10, r {}..0.2", least), "cube.stl", {0, 0, least, 0.2}, {}, 0, 0, 0});
  }
  list.push_back({"cube 10, r 0.031..0.2", "cube.stl", {0, 0, 0.031, 0.2}, {}, 83.0, 10, 0});
  list.push_back({"dragon HT, r 0.0077..0.05", "dragon-871k.stl", {0, 0, 0.0077, 0.05}, {}, 74.1, 15, 0});
  return list;
}

}  // namespace
}  // namespace aerate::bench

int main(int argc, char** argv) {
  using namespace aerate::bench;
  if (argc < 2) {
    fmt::print(stderr, "usage: {} MODELS_DIRECTORY [REPETITIONS]\n", argv[0]);
    return 2;
  }
  const int repetitions = argc > 2 ? std::max(std::atoi(argv[2]), 1) : 1;
  fmt::print("| case | spheres | density % | seconds | processor s | broken: wall gap winding | target |\n");
  fmt::print("| --- | --- | --- | --- | --- | --- | --- |\n");
  for (const Case& c : cases()) run(c, argv[1], repetitions);
  return 0;
}
