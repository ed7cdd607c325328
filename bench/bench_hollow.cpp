#include <filesystem>
#include <fmt/format.h>
#include <random>
#include <string>

#include "bench/benchmark.h"
#include "core/monitor.h"
#include "files/formats.h"
#include "files/load.h"
#include "kernels/hexagonal_packing.h"
#include "kernels/point_triangle.h"
#include "kernels/winding.h"
#include "mesh/inspect.h"
#include "packing/hexagonal.h"
#include "packing/verify.h"
#include "pipeline/hollow.h"
#include "printing/remesh.h"

// The whole job on a large model, stage by stage, and in the same run what it is measured against: the
// pipeline one would write with OpenVDB alone, and packing without an index.

namespace aerate::bench {
namespace {

double longest_side(const Mesh& mesh) {
  const Box3f box = bounding_box(mesh);
  const Vec3f extent = box.upper - box.lower;
  return static_cast<double>(max_of(extent.x, max_of(extent.y, extent.z)));
}

// The whole model as a level set, one CSG difference, one mesh of the whole.
double naive_pipeline(const std::filesystem::path& model, double scale, const PackingLimits& limits,
                      double voxel, const std::filesystem::path& output) {
  Monitor monitor;
  const Stopwatch watch;
  Stopwatch since_last;
  const auto lap = [&](const char* stage) {
    fmt::print("| naive: {} | {:.2f} | |\n", stage, since_last.seconds());
    since_last = {};
  };
  const Mesh mesh = load_model(model, {.unit = std::nullopt, .scale = {scale, scale, scale}}).mesh;
  lap("load");
  const ModelLevelSet level_set(mesh, voxel, 16e9, monitor);
  lap("meshToVolume");
  const Packing packing = pack_hexagonal(mesh, limits, monitor);
  lap("pack");
  const Solid solid = level_set.subtract(packing, {.tolerance = 0.05}, monitor);
  lap("csgDifference and volumeToMesh");
  write_mesh(solid.mesh, output, format_to_write(output));
  lap("write");
  const double seconds = watch.seconds();
  fmt::print("| naive: all, {} triangles, voxels of {} mm, not checked | {:.2f} | |\n",
             solid.mesh.triangles.size(), voxel, seconds);
  return seconds;
}

// One thread, extrapolated from a sample of the lattice's places.
double brute_force_packing(const Mesh& mesh, const PackingLimits& limits, std::size_t candidates) {
  const Box3f box = bounding_box(mesh);
  const kernels::HexagonalLattice lattice = kernels::make_hexagonal_lattice(
      {to_double(box.lower), to_double(box.upper)}, limits.max_radius + limits.gap / 2);
  std::mt19937_64 random(1);
  std::uniform_int_distribution<std::size_t> slot(0, lattice.cell_count() * kernels::kLatticePerCell - 1);
  constexpr std::size_t kSample = 100;
  const double reach = limits.max_radius + limits.wall;
  std::size_t fitting = 0;
  const Stopwatch watch;
  for (std::size_t i = 0; i < kSample; ++i) {
    const Vec3d centre = lattice.lattice_position(static_cast<std::uint32_t>(slot(random)));
    int winding = 0;
    bool is_near = false;
    for (const Triangle& t : mesh.triangles) {
      const kernels::Facet facet{mesh.positions[t[0]], mesh.positions[t[1]], mesh.positions[t[2]]};
      winding += kernels::winding_detail::facet_crossing(facet, centre);
      is_near = is_near || kernels::distance_squared_to_facet(centre, facet) < reach * reach;
    }
    if (winding == 1 && !is_near) ++fitting;
  }
  const double seconds = watch.seconds() / kSample * static_cast<double>(candidates);
  fmt::print("| packing by brute force, one thread, from {} of {} places ({} fit) | {:.0f}* | |\n", kSample,
             candidates, fitting, seconds);
  return seconds;
}

int run(const Arguments& arguments) {
  const std::filesystem::path model = arguments.text(0, "../shared/models/dragon-871k.stl");
  const double side = arguments.number(1, 100), voxel = arguments.number(2, 0.2);
  if (!std::filesystem::exists(model)) {
    fmt::print(stderr, "skipped: {} is not there\n", model.string());
    return 0;
  }
  const ScratchFolder folder;
  const double scale = side / longest_side(load_model(model).mesh);
  HollowOptions options;
  options.model = model;
  options.output = folder.path() / "hollow.stl";
  options.load.scale = {scale, scale, scale};
  options.packing.method = &packing_method("hexagonal");
  const Limits given{
      {Limit::wall, {0.8}}, {Limit::gap, {0.4}}, {Limit::min_radius, {0.62}}, {Limit::max_radius, {1.0}}};
  options.packing.process = limits_under(*find_process("fdm"), given, ProcessCheck::none);
  options.surface = SurfaceMode::keep;
  Monitor monitor;
  const HollowReport report = hollow(options, monitor);

  fmt::print("{}: {} triangles, longest side {} mm, R = 1, wall 0.8, gap 0.4, tolerance 0.05 mm\n\n",
             model.filename().string(), report.input.inspection.triangle_count, side);
  fmt::print("| stage | seconds | peak MB |\n|---|---|---|\n");
  for (const StageCost& stage : report.stages) {
    fmt::print("| {} | {:.2f} | {:.0f} |\n", stage.name, stage.seconds, stage.peak_bytes / 1e6);
  }
  const StageCost total = total_of(report.stages);
  fmt::print("| all: {} voids, {} triangles, checked | {:.2f} | {:.0f} |\n", report.output.void_count,
             report.output.triangle_count, total.seconds, total.peak_bytes / 1e6);

  const double naive =
      naive_pipeline(model, scale, options.packing.limits(), voxel, folder.path() / "naive.stl");
  const Mesh mesh = load_model(model, options.load).mesh;
  const Stopwatch watch;
  const Packing packing = pack_hexagonal(mesh, options.packing.limits(), monitor);
  const double indexed = watch.seconds();
  const double brute_force = brute_force_packing(
      mesh, options.packing.limits(),
      packing.statistics.outside + packing.statistics.near_surface + packing.spheres.size());
  fmt::print("| packing with the index | {:.3f} | |\n\n", indexed);
  fmt::print("naive / whole job: {:.1f}; brute force / index: {:.0f}\n", naive / total.seconds,
             brute_force / indexed);
  return 0;
}

}  // namespace
}  // namespace aerate::bench

int main(int argc, char** argv) {
  return aerate::bench::run_benchmark(argc, argv, {"[MODEL [LONGEST_SIDE_MM [VOXEL_MM]]]", 0, 3},
                                      aerate::bench::run);
}
