#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fmt/format.h>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "bench/benchmark.h"
#include "bench/figures.h"
#include "core/monitor.h"
#include "core/surface_index.h"
#include "files/load.h"
#include "packing/verify.h"
#include "pipeline/hollow.h"
#include "pipeline/process_choice.h"

// What each process leaves of a model: whole jobs, drained where the process asks for that, and in the same
// run the same job with sealed voids; then what roofs cost against the same limits without them.
// --table: the tables of processes, as docs/processes.md has them.

namespace aerate::bench {
namespace {

// Each job is run so often, the kinds in turn; the shortest time counts.
constexpr int kRuns = 3;

ProcessChoice choice_of(const Process& process, const Limits& given = {}) {
  return limits_under(process, given, ProcessCheck::strict);
}

HollowOptions options_for(const std::filesystem::path& model, const std::filesystem::path& folder,
                          const ProcessChoice& choice) {
  HollowOptions options;
  options.model = model;
  options.output = folder / "hollow.stl";
  options.packing.process = choice;
  return options;
}

// As the command asks for it, if the process does.
std::optional<DrainageRequest> drainage_of(const ProcessChoice& choice) {
  if (choice.process.drainage != Drainage::needed) return std::nullopt;
  return drainage_request(with_tubes(choice, {}), {});
}

// Volume of the model deeper than the wall, mm3: no void can take more. By points of a raster of 0.5 mm.
double deeper_than(const Mesh& mesh, double wall) {
  constexpr double kStep = 0.5;
  const Box3f box = bounding_box(mesh);
  const Vec3d lower = to_double(box.lower), extent = to_double(box.upper) - lower;
  const SurfaceIndex surface(mesh);
  std::vector<Vec3d> inside;
  for (double z = kStep / 2; z < extent.z; z += kStep) {
    for (double y = kStep / 2; y < extent.y; y += kStep) {
      for (double x = kStep / 2; x < extent.x; x += kStep) {
        const Vec3d p = lower + Vec3d{x, y, z};
        if (surface.winding().winding_number(p) == 1) inside.push_back(p);
      }
    }
  }
  const std::vector<double> distances = surface.distances(inside);
  const auto deep =
      std::count_if(distances.begin(), distances.end(), [&](double distance) { return distance >= wall; });
  return static_cast<double>(deep) * kStep * kStep * kStep;
}

std::string percent_of_bound(const HollowReport& report, double bound) {
  return fmt::format("{:.1f}", 100 * report.output.volume_removed / bound);
}

std::string widest_ceiling(const OutputFacts& output) {
  return output.ceilings ? fmt::format("{:.2f}", output.ceilings->widest) : "not limited";
}

// The job as asked for, and sealed, with the shortest times of both.
struct Jobs {
  HollowReport asked, sealed;
  double asked_seconds = std::numeric_limits<double>::infinity();
  double sealed_seconds = std::numeric_limits<double>::infinity();
};

Jobs run_jobs(HollowOptions options) {
  Jobs jobs;
  const std::optional<DrainageRequest> drainage = drainage_of(options.packing.process);
  for (int i = 0; i < kRuns; ++i) {
    Monitor monitor;
    options.drainage.reset();
    jobs.sealed = hollow(options, monitor);
    jobs.sealed_seconds = std::min(jobs.sealed_seconds, total_of(jobs.sealed.stages).seconds);
    options.drainage = drainage;
    if (!drainage) continue;
    jobs.asked = hollow(options, monitor);
    jobs.asked_seconds = std::min(jobs.asked_seconds, total_of(jobs.asked.stages).seconds);
  }
  if (!drainage) jobs.asked = jobs.sealed, jobs.asked_seconds = jobs.sealed_seconds;
  return jobs;
}

// Prints the table, and returns it with its heading.
std::string measure_processes(const std::filesystem::path& model, const std::filesystem::path& folder) {
  const Mesh mesh = load_model(model).mesh;
  const std::string heading = model.filename().string() + "\n\n";
  fmt::print("{}", heading);
  Table table({"process", "voids", "not made", "void volume, mm3", "% of what is deeper than the wall",
               "the same sealed, %", "widest ceiling, mm", "drained", "escape holes", "trapped, %", "job, s",
               "sealed, s", "ratio"});
  const auto add_row = [&](const std::string& name, const HollowOptions& options) {
    const Jobs jobs = run_jobs(options);
    const double bound = deeper_than(mesh, options.packing.limits().wall);
    const OutputFacts& output = jobs.asked.output;
    const auto& drainage = jobs.asked.drainage;
    table.add(
        {name, fmt::format("{}", output.void_count),
         drainage ? fmt::format("{}", drainage->dropped.count()) : "-",
         fmt::format("{:.0f}", output.volume_removed), percent_of_bound(jobs.asked, bound),
         percent_of_bound(jobs.sealed, bound), widest_ceiling(output), drainage ? "yes" : "sealed",
         drainage ? fmt::format("{}", drainage->plan.holes.size()) : "-",
         drainage ? hundredths(100 * drainage->plan.pools.after_both / drainage->plan.pools.total) : "-",
         hundredths(jobs.asked_seconds), hundredths(jobs.sealed_seconds),
         hundredths(jobs.asked_seconds / jobs.sealed_seconds)});
  };
  for (const Process& process : processes()) {
    HollowOptions options = options_for(model, folder, choice_of(process));
    add_row(process.name + " spheres", options);
    if (process.limits.contains(Limit::bridge)) continue;  // cells have no roofs
    options.packing.process = sized_for_cells(std::move(options.packing.process), std::nullopt);
    options.packing.is_for_cells = true;
    options.cells = {.fillet = drainage_of(options.packing.process)->channel_radius};
    options.tolerance = kCellTolerance;
    add_row(process.name + " cells", options);
  }
  fmt::print("\n");
  return heading + table.markdown();
}

// The same limits with and without a rule for ceilings, sealed.
void print_roofs(const std::filesystem::path& model, const std::filesystem::path& folder) {
  const Limits wide{{Limit::min_radius, {1.5}}, {Limit::max_radius, {10}}};
  const Limits without_rule{{Limit::bridge, {100}}};
  Limits wide_without_rule = wide;
  wide_without_rule.insert(without_rule.begin(), without_rule.end());
  const Process& fdm = *find_process("fdm");
  const Process& metal = *find_process("metal");
  struct Pair {
    const char* name;
    ProcessChoice with, without;
  };
  const std::vector<Pair> pairs{
      {"fdm, radius 1.5 to 10", choice_of(fdm, wide), choice_of(fdm, wide_without_rule)},
      {"metal", choice_of(metal), choice_of(metal, without_rule)}};
  Table table({"limits", "voids", "with roofs", "void volume, mm3", "without roofs, mm3", "ratio",
               "widest ceiling, mm"});
  for (const Pair& pair : pairs) {
    Monitor monitor;
    const OutputFacts with = hollow(options_for(model, folder, pair.with), monitor).output;
    const OutputFacts without = hollow(options_for(model, folder, pair.without), monitor).output;
    table.add({pair.name, fmt::format("{}", with.void_count), fmt::format("{}", with.roof_count),
               fmt::format("{:.0f}", with.volume_removed), fmt::format("{:.0f}", without.volume_removed),
               fmt::format("{:.3f}", with.volume_removed / without.volume_removed), widest_ceiling(with)});
  }
  fmt::print("\n");
}

int run(const Arguments& arguments) {
  const ScratchFolder folder;
  std::vector<std::string> tables;
  for (const char* name : {"dragon-47k-100mm.stl", "bunny-100mm.stl"}) {
    const std::filesystem::path model = std::filesystem::path(arguments.text(0, "../shared/models")) / name;
    if (std::filesystem::exists(model)) {
      tables.push_back(measure_processes(model, folder.path()));
      print_roofs(model, folder.path());
    } else {
      fmt::print(stderr, "skipped: {} is not there\n", model.string());
      if (arguments.wants_figures()) return 1;
    }
  }
  write_figures(arguments, fmt::format("{}", fmt::join(tables, "\n")), "");
  return 0;
}

}  // namespace
}  // namespace aerate::bench

int main(int argc, char** argv) {
  return aerate::bench::run_benchmark(argc, argv, {"[MODELS]", 0, 1, aerate::bench::Tables::written},
                                      aerate::bench::run);
}
