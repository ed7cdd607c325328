#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <fmt/format.h>
#include <limits>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include "core/monitor.h"
#include "files/load.h"
#include "kernels/winding.h"
#include "packing/verify.h"
#include "pipeline/hollow.h"
#include "pipeline/process_choice.h"

// What each process leaves of a model: whole jobs, drained where the process asks for that, and in the same
// run the same job with sealed voids; then what roofs cost against the same limits without them.
//   bench_processes [--markdown] [MODELS]
// --markdown: the table of processes alone, as docs/processes.md has it.

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
  std::vector<Vec3d> inside;
  {
    std::vector<Vec3d> points;
    for (double z = kStep / 2; z < extent.z; z += kStep)
      for (double y = kStep / 2; y < extent.y; y += kStep)
        for (double x = kStep / 2; x < extent.x; x += kStep) points.push_back(lower + Vec3d{x, y, z});
    const std::vector<int> winding =
        kernels::HostWinding(mesh.positions, mesh.triangles).winding_numbers(points);
    for (std::size_t i = 0; i < points.size(); ++i)
      if (winding[i] == 1) inside.push_back(points[i]);
  }
  const std::vector<double> distances = SurfaceIndex(mesh).distances(inside);
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

void print_processes(const std::filesystem::path& model, const std::filesystem::path& folder) {
  const Mesh mesh = load_model(model).mesh;
  fmt::print("{}\n\n", model.filename().string());
  fmt::print(
      "| process | voids | not made | void volume, mm3 | % of what is deeper than the wall | the same "
      "sealed, "
      "% | widest ceiling, mm | drained | escape holes | trapped, % | job, s | sealed, s | ratio |\n"
      "|---|---|---|---|---|---|---|---|---|---|---|---|---|\n");
  for (const Process& process : processes()) {
    const HollowOptions options = options_for(model, folder, choice_of(process));
    const Jobs jobs = run_jobs(options);
    const double bound = deeper_than(mesh, options.packing.limits().wall);
    const OutputFacts& output = jobs.asked.output;
    const auto& drainage = jobs.asked.drainage;
    fmt::print("| {} | {} | {} | {:.0f} | {} | {} | {} | {} | {} | {} | {:.2f} | {:.2f} | {:.2f} |\n",
               process.name, output.void_count, drainage ? fmt::format("{}", drainage->dropped.count()) : "-",
               output.volume_removed, percent_of_bound(jobs.asked, bound),
               percent_of_bound(jobs.sealed, bound), widest_ceiling(output), drainage ? "yes" : "sealed",
               drainage ? fmt::format("{}", drainage->plan.holes.size()) : "-",
               drainage
                   ? fmt::format("{:.2f}", 100 * drainage->plan.pools.after_both / drainage->plan.pools.total)
                   : "-",
               jobs.asked_seconds, jobs.sealed_seconds, jobs.asked_seconds / jobs.sealed_seconds);
  }
  fmt::print("\n");
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
  fmt::print(
      "| limits | voids | with roofs | void volume, mm3 | without roofs, mm3 | ratio | widest ceiling, mm |\n"
      "|---|---|---|---|---|---|---|\n");
  for (const Pair& pair : pairs) {
    Monitor monitor;
    const OutputFacts with = hollow(options_for(model, folder, pair.with), monitor).output;
    const OutputFacts without = hollow(options_for(model, folder, pair.without), monitor).output;
    fmt::print("| {} | {} | {} | {:.0f} | {:.0f} | {:.3f} | {} |\n", pair.name, with.void_count,
               with.roof_count, with.volume_removed, without.volume_removed,
               with.volume_removed / without.volume_removed, widest_ceiling(with));
  }
  fmt::print("\n");
}

int run(const std::vector<std::filesystem::path>& models, bool markdown) {
  const std::filesystem::path folder =
      std::filesystem::temp_directory_path() / fmt::format("aerate-bench-{}", std::random_device{}());
  std::filesystem::create_directory(folder);
  for (const std::filesystem::path& model : models) {
    if (std::filesystem::exists(model)) {
      print_processes(model, folder);
      if (!markdown) print_roofs(model, folder);
    } else {
      fmt::print("skipped: {} is not there\n", model.string());
    }
  }
  std::filesystem::remove_all(folder);
  return EXIT_SUCCESS;
}

}  // namespace
}  // namespace aerate::bench

int main(int argc, char** argv) {
  try {
    const bool markdown = argc > 1 && std::string(argv[1]) == "--markdown";
    const int models = markdown ? 2 : 1;
    const std::filesystem::path folder = argc > models ? argv[models] : "../shared/models";
    return aerate::bench::run({folder / "dragon-47k-100mm.stl", folder / "bunny-100mm.stl"}, markdown);
  } catch (const std::exception& error) {
    fmt::print(stderr, "bench_processes: {}\n", error.what());
    return EXIT_FAILURE;
  }
}
