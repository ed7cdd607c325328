#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fmt/format.h>
#include <fstream>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include "bench/benchmark.h"
#include "bench/figures.h"
#include "bench/fill_with_spheres.h"
#include "bench/packing_quality.h"
#include "core/monitor.h"
#include "core/packing.h"
#include "files/formats.h"
#include "files/load.h"
#include "kernels/constants.h"
#include "packing/adaptive.h"
#include "packing/hexagonal.h"

// Packings of other programs beside ours, of the same models in one run: YADE's random dense packing (Debian's
// `yade`), OpenVDB's fillWithSpheres, the paper's lattice as it is rebuilt here, and the adaptive packing under
// the radii of each. No wall and no gap. Exit status 1 if a sphere of ours breaks a limit; where YADE is not
// installed its rows are left out, with a message, and no figures are written.

namespace aerate::bench {
namespace {

constexpr DeviceRequest kCpu{DeviceRequest::Kind::cpu, 0};

struct Packed {
  std::vector<Sphere> spheres;
  double seconds = 0;
};

Packed pack_ours(const Mesh& mesh, const PackingLimits& limits, const PackingStop& stop) {
  Monitor monitor;
  Packed packed;
  packed.seconds =
      seconds_of([&] { packed.spheres = pack_adaptive(mesh, limits, stop, monitor, kCpu).spheres; });
  return packed;
}

Packed pack_lattice(const Mesh& mesh, const PackingLimits& limits) {
  Monitor monitor;
  Packed packed;
  packed.seconds = seconds_of([&] { packed.spheres = pack_hexagonal(mesh, limits, monitor, kCpu).spheres; });
  return packed;
}

Packed pack_openvdb(const Mesh& mesh, std::size_t count, double voxel) {
  Packed packed;
  packed.seconds = seconds_of([&] { packed.spheres = fill_with_spheres(mesh, count, voxel); });
  return packed;
}

bool has_yade() {
  return std::system("command -v yade >/dev/null 2>&1") == 0;
}

// Seconds are those of the packing itself, without YADE's start.
Packed pack_yade(const Mesh& mesh, double radius, double fuzz) {
  const ScratchFolder folder;
  const std::filesystem::path model = folder.path() / "model.stl", out = folder.path() / "spheres.txt";
  write_mesh(mesh, model, format_to_write(model));
  const std::filesystem::path script = std::filesystem::path(__FILE__).parent_path() / "yade_dense_pack.py";
  const std::string command =
      fmt::format("yade -n -x -j2 '{}' '{}' {} {} '{}' >'{}' 2>&1", script.string(), model.string(), radius,
                  fuzz, out.string(), (folder.path() / "log").string());
  if (std::system(command.c_str()) != 0) throw std::runtime_error("yade failed: " + command);
  std::ifstream file(out);
  Packed packed;
  if (!(file >> packed.seconds)) throw std::runtime_error("yade wrote no packing");
  Sphere sphere{{}, 0, SphereKind::adaptive};
  while (file >> sphere.centre.x >> sphere.centre.y >> sphere.centre.z >> sphere.radius)
    packed.spheres.push_back(sphere);
  return packed;
}

struct Model {
  std::string name;
  std::string file;
  double radius;      // of spheres of one size, mm
  double fuzz;        // YADE's radii are spread so far around it, as a share
  std::size_t count;  // of OpenVDB's spheres, at most
  double voxel;       // OpenVDB's, mm
};

struct Run {
  Table& table;
  std::size_t broken = 0;
};

void add_row(Run& run, const std::string& model, const std::string& packer, const Mesh& mesh,
             const Packed& packed, double slack) {
  const Violations broken = count_violations(mesh, packed.spheres, {0, 0, 0, kInfinity}, slack);
  if (slack == 0) run.broken += broken.all();
  const auto [least, most] = std::ranges::minmax(packed.spheres, {}, &Sphere::radius);
  run.table.add({model, packer, grouped(static_cast<double>(packed.spheres.size())),
                 fmt::format("{:.3g} to {:.3g}", least.radius, most.radius),
                 hundredths(density_of(mesh, packed.spheres)), hundredths(packed.seconds), to_cell(broken)});
}

// The adaptive packing between the same least and largest radii.
void add_with_ours(Run& run, const std::string& model, const std::string& packer, const Mesh& mesh,
                   const Packed& packed) {
  constexpr double kPeersSlack = 1e-6;  // mm, of fp32
  add_row(run, model, packer, mesh, packed, kPeersSlack);
  const auto [least, most] = std::ranges::minmax(packed.spheres, {}, &Sphere::radius);
  add_row(run, model, "`aerate`, between the same radii", mesh,
          pack_ours(mesh, {0, 0, least.radius, most.radius}, {}), 0);
}

void add_model(const Model& model, const Mesh& mesh, bool yade, Run& run) {
  const PackingLimits equal{0, 0, model.radius, model.radius};
  const Packed lattice = pack_lattice(mesh, equal);
  add_row(run, model.name, "the paper's lattice, one size", mesh, lattice, 0);
  if (yade) {
    add_row(run, model.name, "YADE, one size", mesh, pack_yade(mesh, model.radius, 0), 1e-6);
  }
  add_row(run, model.name, "`aerate`, one size", mesh, pack_ours(mesh, equal, {}), 0);
  if (yade)
    add_with_ours(run, model.name, fmt::format("YADE, radii spread by {:g} %", 100 * model.fuzz), mesh,
                  pack_yade(mesh, model.radius, model.fuzz));
  const Packed openvdb = pack_openvdb(mesh, model.count, model.voxel);
  add_row(run, model.name, "OpenVDB `fillWithSpheres`", mesh, openvdb, 1e-6);
  add_row(run, model.name, "`aerate`, as many spheres", mesh,
          pack_ours(mesh, {0, 0, 0, kInfinity}, {.max_count = openvdb.spheres.size()}), 0);
}

int run(const Arguments& arguments) {
  const std::filesystem::path models = arguments.text(0, "../shared/models");
  const bool yade = has_yade();
  if (!yade) fmt::print(stderr, "yade is not installed: its rows are left out\n");
  Table table({"model", "packing", "spheres", "radii, mm", "density %", "s", kViolationsTitle});
  Run run{table};
  for (const Model& model : {Model{"cube of 10 mm", "cube.stl", 0.2, 0.3, 1000, 0.05},
                             Model{"dinosaur", "dino.off", 0.06, 0.3, 1000, 0.02}}) {
    const std::filesystem::path path = models / model.file;
    if (!std::filesystem::exists(path)) {
      fmt::print(stderr, "{} is skipped: {} is not there\n", model.name, path.string());
      return arguments.wants_figures() ? 1 : 0;
    }
    add_model(model, load_model(path).mesh, yade, run);
  }
  if (!report_broken(run.broken)) return 1;
  if (!yade && arguments.wants_figures()) return 1;
  write_figures(arguments, table.markdown(), "");
  return 0;
}

}  // namespace
}  // namespace aerate::bench

int main(int argc, char** argv) {
  return aerate::bench::run_benchmark(argc, argv, {"[MODELS]", 0, 1, aerate::bench::Tables::written},
                                      aerate::bench::run);
}
