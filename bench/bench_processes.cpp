#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <fmt/format.h>
#include <random>
#include <string>
#include <vector>

#include "core/monitor.h"
#include "kernels/winding.h"
#include "mesh/load.h"
#include "packing/verify.h"
#include "pipeline/hollow.h"
#include "pipeline/process_choice.h"

// What each process leaves of a model, whole jobs, checked: and in the same run the same limits without
// roofs.
//   bench_processes [MODELS]

namespace aerate::bench {
namespace {

struct Row {
  std::string name;
  ProcessChoice choice;
};

std::vector<Row> rows() {
  const std::vector<GivenLimit> wide{{Limit::min_radius, 1.5, "here"}, {Limit::max_radius, 10, "here"}};
  std::vector<GivenLimit> wide_without = wide;
  wide_without.push_back({Limit::bridge, 100, "here"});
  const auto of = [](const char* process, const std::vector<GivenLimit>& given) {
    return limits_under(choose_process(process), given, ProcessCheck::strict);
  };
  return {{"fdm", of("fdm", {})},
          {"fdm, radius 1.5 to 10", of("fdm", wide)},
          {"the same without roofs", of("fdm", wide_without)},
          {"sla", of("sla", {})},
          {"sls", of("sls", {})},
          {"metal", of("metal", {})},
          {"the same without roofs", of("metal", {{Limit::bridge, 100, "here"}})}};
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
  const std::vector<double> distances = distances_to_surface(mesh, inside);
  const auto deep =
      std::count_if(distances.begin(), distances.end(), [&](double distance) { return distance >= wall; });
  return static_cast<double>(deep) * kStep * kStep * kStep;
}

void print_rows(const std::filesystem::path& model, const std::filesystem::path& folder) {
  const Mesh mesh = load_model(model).mesh;
  fmt::print("{}\n\n", model.filename().string());
  fmt::print(
      "| process | voids | with roofs | void volume, mm3 | % of the model | % of what is deeper than the "
      "wall "
      "| widest ceiling, mm | pack s | all s |\n|---|---|---|---|---|---|---|---|---|\n");
  double roofed = 0;
  std::string ratios;
  for (const Row& row : rows()) {
    HollowOptions options;
    options.model = model;
    options.output = folder / "hollow.stl";
    options.packing.process = row.choice;
    options.packing.limits = packing_limits(row.choice);
    Monitor monitor;
    const HollowReport report = hollow(options, monitor);
    const OutputFacts& output = report.output;
    const auto pack = std::find_if(report.stages.begin(), report.stages.end(),
                                   [](const StageCost& stage) { return stage.name == "pack"; });
    fmt::print("| {} | {} | {} | {:.0f} | {:.2f} | {:.1f} | {} | {:.2f} | {:.2f} |\n", row.name,
               output.void_count, output.roof_count, output.volume_removed,
               100 * output.volume_removed / output.volume_before,
               100 * output.volume_removed / deeper_than(mesh, options.packing.limits.wall),
               output.ceilings ? fmt::format("{:.2f}", output.ceilings->widest) : "not limited",
               pack->seconds, total_of(report.stages).seconds);
    if (row.name == "the same without roofs")
      ratios += fmt::format("{}{:.3f} ({})", ratios.empty() ? "" : ", ", roofed / output.volume_removed,
                            report.process.process.name);
    roofed = output.volume_removed;
  }
  fmt::print("\nvoid volume with roofs / without: {}\n\n", ratios);
}

int run(const std::vector<std::filesystem::path>& models) {
  const std::filesystem::path folder =
      std::filesystem::temp_directory_path() / fmt::format("aerate-bench-{}", std::random_device{}());
  std::filesystem::create_directory(folder);
  for (const std::filesystem::path& model : models) {
    if (std::filesystem::exists(model)) {
      print_rows(model, folder);
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
    const std::filesystem::path folder = argc > 1 ? argv[1] : "../shared/models";
    return aerate::bench::run({folder / "dragon-47k-100mm.stl", folder / "bunny-100mm.stl"});
  } catch (const std::exception& error) {
    fmt::print(stderr, "bench_processes: {}\n", error.what());
    return EXIT_FAILURE;
  }
}
