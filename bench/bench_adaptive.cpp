#include <algorithm>
#include <cstdio>
#include <ctime>
#include <filesystem>
#include <fmt/format.h>
#include <span>
#include <string>
#include <vector>

#include "bench/benchmark.h"
#include "bench/figures.h"
#include "bench/fill_with_spheres.h"
#include "bench/packing_quality.h"
#include "core/monitor.h"
#include "core/packing.h"
#include "files/load.h"
#include "kernels/constants.h"
#include "packing/adaptive.h"
#include "packing/hexagonal.h"

// Adaptive packing: density, time and broken limits for each case, with OpenVDB's fillWithSpheres in the same
// run, and what ProtoSphere's authors published beside both.
// Times are the least of the repetitions. Exit status 1 if a sphere breaks a limit, or if a model is missing
// of which figures were to be written.

namespace aerate::bench {
namespace {

constexpr DeviceRequest kCpu{DeviceRequest::Kind::cpu, 0};

struct Case {
  std::string name;
  std::string file;
  PackingLimits limits;
  PackingStop options{};
  std::string target{};     // the least that was wanted
  double peer_voxel = 0;    // mm; 0 for no comparison
  std::string published{};  // ProtoSphere's density and time on an RTX A2000 (CGAL, pull request 9013)
  // For the summary: what stands beside density and time there; empty for none.
  std::string in_summary{};
  bool hexagonal = false;  // for comparison: spheres of one size
};

// Processor time beside the clock's: on a busy machine the clock says little.
struct Time {
  double seconds = kInfinity;
  double processor_seconds = kInfinity;
};

template <typename F>
Time time_of(F f) {
  const std::clock_t processor_start = std::clock();
  const double seconds = seconds_of(f);
  return {seconds, static_cast<double>(std::clock() - processor_start) / CLOCKS_PER_SEC};
}

std::string whole(std::size_t count) {
  return grouped(static_cast<double>(count));
}

// Largest radius to the smallest.
std::string spread_of(std::span<const Sphere> spheres) {
  if (spheres.empty()) return "";
  const auto [least, most] = std::ranges::minmax(spheres, {}, &Sphere::radius);
  return fmt::format("{:.1f}", most.radius / least.radius);
}

// What OpenVDB makes of a case: the cells beside ours.
std::vector<std::string> cells_of_peer(const Case& c, const Mesh& mesh, double our_seconds) {
  if (c.peer_voxel == 0) return {"", "", "", "", ""};
  std::vector<Sphere> spheres;
  const Time time = time_of([&] { spheres = fill_with_spheres(mesh, c.options.max_count, c.peer_voxel); });
  // Its positions are of voxels, in fp32.
  constexpr double kFloatSlack = 1e-6;
  const Violations broken = count_violations(mesh, spheres, c.limits, kFloatSlack);
  return {whole(spheres.size()), hundredths(density_of(mesh, spheres)), hundredths(time.seconds),
          whole(broken.wall), fmt::format("{:.1f}", time.seconds / our_seconds)};
}

struct Run {
  const std::filesystem::path models;
  const int repetitions;
  Table& table;
  std::string summary{};
  std::size_t missing = 0, broken = 0;
};

void run_case(const Case& c, Run& run) {
  const std::filesystem::path path = run.models / c.file;
  if (!std::filesystem::exists(path)) {
    ++run.missing;
    fmt::print(stderr, "{} is skipped: {} is not there\n", c.name, path.string());
    return;
  }
  const Mesh mesh = load_model(path).mesh;
  Monitor monitor;
  Packing packing;
  Time best;
  for (int i = 0; i < run.repetitions; ++i) {
    const Time time = time_of([&] {
      packing = c.hexagonal ? pack_hexagonal(mesh, c.limits, monitor, kCpu)
                            : pack_adaptive(mesh, c.limits, c.options, monitor, kCpu);
    });
    best.seconds = std::min(best.seconds, time.seconds);
    best.processor_seconds = std::min(best.processor_seconds, time.processor_seconds);
  }
  const Violations broken = count_violations(mesh, packing.spheres, c.limits, 0);
  run.broken += broken.all();
  const double density = density_of(mesh, packing.spheres);
  std::vector<std::string> cells{c.name,
                                 whole(packing.spheres.size()),
                                 spread_of(packing.spheres),
                                 hundredths(density),
                                 hundredths(best.seconds),
                                 hundredths(best.processor_seconds),
                                 to_cell(broken),
                                 c.target,
                                 c.published};
  const std::vector<std::string> peer = cells_of_peer(c, mesh, best.seconds);
  cells.insert(cells.end(), peer.begin(), peer.end());
  run.table.add(cells);
  if (c.in_summary.empty()) return;
  std::string others = c.in_summary;
  if (c.peer_voxel > 0) {
    others += fmt::format("; OpenVDB's `fillWithSpheres` in the same run {} % in {} s", peer[1], peer[2]);
  }
  run.summary += fmt::format("| {} | {:.1f} % with {} spheres in {} s; {} |\n", c.name, density,
                             whole(packing.spheres.size()), hundredths(best.seconds), others);
}

// By count: CGAL's dinosaur.
void add_dinosaurs(std::vector<Case>& list) {
  struct Dinosaur {
    std::size_t count;
    const char* target;
    const char* published;
  };
  for (const Dinosaur& d :
       {Dinosaur{100, ">= 64 % in 0.2 s", "59.3 % in 0.77 s"},
        Dinosaur{1000, ">= 76 % in 0.5 s", "72.0 % in 4.8 s"},
        Dinosaur{10000, ">= 85 % in 3 s", "83.3 % in 34.7 s"}, Dinosaur{100000, "", ""}}) {
    Case c{fmt::format("dino, {} spheres", whole(d.count)), "dino.off", {0, 0, 0, kInfinity}};
    c.options.max_count = d.count;
    c.target = d.target;
    c.published = d.published;
    c.peer_voxel = d.count <= 10000 ? 0.02 : 0;
    if (d.count == 1000) c.in_summary = "ProtoSphere on an RTX A2000 72.0 % in 4.8 s (published)";
    list.push_back(c);
  }
}

std::vector<Case> cases() {
  std::vector<Case> list;
  add_dinosaurs(list);
  list.push_back({.name = "dragon 100 mm, wall 1.2, gap 0.8, r >= 1.5",
                  .file = "dragon-47k-100mm.stl",
                  .limits = {1.2, 0.8, 1.5, kInfinity},
                  .target = ">= 33.5 % in 0.5 s",
                  .in_summary = "no more than 67.6 % is deeper than the wall"});
  list.push_back({.name = "the same, effort best",
                  .file = "dragon-47k-100mm.stl",
                  .limits = {1.2, 0.8, 1.5, kInfinity},
                  .options = {.effort = PackingEffort::best},
                  .target = ">= 36.3 % in 1 s"});
  list.push_back({.name = "the same by spheres of one size, r = 3",
                  .file = "dragon-47k-100mm.stl",
                  .limits = {1.2, 0.8, 3, 3},
                  .in_summary = "hexagonal",
                  .hexagonal = true});
  for (const auto& [least, target] :
       {std::pair{0.2, ">= 84 %"}, std::pair{0.1, ">= 88.5 %"}, std::pair{0.05, ""}}) {
    list.push_back({.name = fmt::format("cube 10, r >= {}", least),
                    .file = "cube.stl",
                    .limits = {0, 0, least, kInfinity},
                    .target = target});
  }
  // The paper's cube by the ratio of the radii.
  for (const double least : {0.15, 0.1, 0.05}) {
    list.push_back(
        {.name = fmt::format("cube 10, r {}..0.2", least), .file = "cube.stl", .limits = {0, 0, least, 0.2}});
  }
  list.push_back({.name = "cube 10, r 0.031..0.2",
                  .file = "cube.stl",
                  .limits = {0, 0, 0.031, 0.2},
                  .target = ">= 83 % in 10 s",
                  .in_summary = "the paper 71.96 %"});
  list.push_back({.name = "dragon HT, r 0.0077..0.05",
                  .file = "dragon-871k.stl",
                  .limits = {0, 0, 0.0077, 0.05},
                  .target = ">= 74.1 % in 15 s",
                  .in_summary = "the paper 64.07 %"});
  return list;
}

int run(const Arguments& arguments) {
  Table table({"case", "spheres", "largest / smallest radius", "density %", "s", "processor s",
               kViolationsTitle, "wanted", "ProtoSphere, published", "OpenVDB: spheres", "density %", "s",
               "surfaces it crossed", "its time / ours"});
  Run run{arguments.text(0, "../shared/models"), static_cast<int>(arguments.number(1, 1)), table};
  for (const Case& c : cases()) run_case(c, run);
  if (!report_broken(run.broken)) return 1;
  if (run.missing > 0) return arguments.wants_figures() ? 1 : 0;
  write_figures(arguments, table.markdown(), run.summary);
  return 0;
}

}  // namespace
}  // namespace aerate::bench

int main(int argc, char** argv) {
  return aerate::bench::run_benchmark(
      argc, argv, {"[MODELS [REPETITIONS]]", 0, 2, aerate::bench::Tables::written}, aerate::bench::run);
}
