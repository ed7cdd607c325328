#include <fmt/format.h>
#include <string>
#include <vector>

#include "bench/benchmark.h"
#include "bench/containers.h"
#include "core/monitor.h"
#include "kernels/cuda_device.h"
#include "packing/adaptive.h"
#include "packing/device_choice.h"
#include "packing/hexagonal.h"
#include "tests/support/shapes.h"

// Both packers on the CPU and on every CUDA device of the machine, side by side, on the paper's ten
// containers with its radii (no wall, no gap): seconds from the mesh in host memory to the spheres in host
// memory, the least of three runs after one that is not counted. The seconds that a device takes to start are
// printed first: what they and the tables say goes into the model of src/packing/device_choice.cpp.
//
// MODELS: the folder; FACTOR: to the radii (a simulated device wants 5 or more); CONTAINER: by name, only
// that

namespace aerate::bench {
namespace {

using Kind = DeviceRequest::Kind;

struct Row {
  std::string name;
  std::size_t facets = 0, spheres = 0;
  std::vector<double> seconds;  // by device
};

std::string text_of(const Row& row) {
  std::string text = fmt::format("| {} | {} | {} |", row.name, row.facets, row.spheres);
  for (const double seconds : row.seconds) text += fmt::format(" {:.4f} |", seconds);
  for (std::size_t i = 1; i < row.seconds.size(); ++i)
    text += fmt::format(" {:.1f} |", row.seconds[0] / row.seconds[i]);
  return text;
}

struct Selection {
  std::string models;
  double factor;
  std::string container;  // empty for all
};

// The first job on a device, small enough for its own work not to matter.
void print_start(const DeviceRequest& device) {
  const Mesh box = test::make_box({0, 0, 0}, {4, 4, 4});
  Monitor monitor;
  const double seconds = seconds_of([&] { pack_hexagonal(box, {0, 0, 0, 1}, monitor, device); });
  fmt::print("cuda:{}: first job after {:.3f} s\n", device.index, seconds);
}

template <typename Pack>
void print_table(const std::string& title, const std::vector<DeviceRequest>& devices, const Selection& chosen,
                 Pack pack) {
  fmt::print("\n{}\n\n| container | triangles | spheres | cpu s |", title);
  for (std::size_t i = 1; i < devices.size(); ++i) fmt::print(" cuda:{} s |", devices[i].index);
  for (std::size_t i = 1; i < devices.size(); ++i) fmt::print(" cpu / cuda:{} |", devices[i].index);
  fmt::print("\n|---|---|---|---|");
  for (std::size_t i = 1; i < devices.size(); ++i) fmt::print("---|---|");
  fmt::print("\n");
  for (const Container& container : paper_containers()) {
    if (!chosen.container.empty() && chosen.container != container.name) continue;
    const auto mesh = container_mesh(container, chosen.models);
    if (!mesh) {
      fmt::print("| {} | skipped: {}/{} is not there |\n", container.name, chosen.models,
                 container.model_file);
      continue;
    }
    Row row{container.name, mesh->triangles.size(), 0, {}};
    for (const DeviceRequest& device : devices) {
      const auto once = [&] {
        row.spheres = pack(*mesh, chosen.factor * container.max_radius, device).spheres.size();
      };
      once();
      row.seconds.push_back(least_seconds(3, once));
    }
    fmt::print("{}\n", text_of(row));
    std::fflush(stdout);
  }
}

int run(const Arguments& arguments) {
  const Selection chosen{arguments.text(0, "../shared/models"), arguments.number(1, 1),
                         arguments.text(2, "")};
  for (const std::string& line : describe_devices()) fmt::print("{}\n", line);
  const kernels::CudaDevices found = kernels::find_cuda_devices();
  std::vector<DeviceRequest> devices{{.kind = Kind::cpu}};
  for (int i = 0; i < static_cast<int>(found.devices.size()); ++i)
    devices.push_back({.kind = Kind::cuda, .index = i});
  if (devices.size() == 1)
    fmt::print("There is no CUDA device here ({}): the CPU's times stand alone.\n", found.problem);
  for (std::size_t i = 1; i < devices.size(); ++i) print_start(devices[i]);

  Monitor monitor;
  print_table("Hexagonal packing", devices, chosen,
              [&](const Mesh& mesh, double radius, const DeviceRequest& device) {
                return pack_hexagonal(mesh, {0, 0, 0, radius}, monitor, device);
              });
  constexpr double kLeastOfPaper = 0.1547;  // its smallest sphere to its largest
  print_table("Adaptive packing, the paper's range of radii", devices, chosen,
              [&](const Mesh& mesh, double radius, const DeviceRequest& device) {
                return pack_adaptive(mesh, {0, 0, kLeastOfPaper * radius, radius}, {}, monitor, device);
              });
  return 0;
}

}  // namespace
}  // namespace aerate::bench

int main(int argc, char** argv) {
  return aerate::bench::run_benchmark(argc, argv, {"[MODELS [FACTOR [CONTAINER]]]", 0, 3},
                                      aerate::bench::run);
}
