#include <algorithm>
#include <chrono>
#include <exception>
#include <fmt/format.h>
#include <string>
#include <vector>

#include "bench/containers.h"
#include "core/error.h"
#include "core/monitor.h"
#include "kernels/cuda_device.h"
#include "packing/adaptive.h"
#include "packing/device_choice.h"
#include "packing/hexagonal.h"
#include "tests/support/shapes.h"

// Both packers on the CPU and on every CUDA device of the machine, side by side, on the paper's ten
// containers with its radii (no wall, no gap): seconds from the mesh in host memory to the spheres in host
// memory, the least of three runs after one that is not counted. The seconds that a device takes to start are
// printed first: what they and the tables say goes into the model of src/packing/device.cpp.
//
//   bench_devices [MODELS [FACTOR [CONTAINER]]]
// MODELS: the folder; FACTOR: to the radii (a simulated device wants 5 or more); CONTAINER: by name, only
// that

namespace aerate::bench {
namespace {

using Kind = DeviceRequest::Kind;

template <typename Pack>
double least_seconds(Pack pack) {
  constexpr int kRuns = 3;
  pack();
  double least = 1e300;
  for (int run = 0; run < kRuns; ++run) {
    const auto start = std::chrono::steady_clock::now();
    pack();
    least = std::min(least, std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
  }
  return least;
}

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

struct Arguments {
  std::string models = "../shared/models";
  double factor = 1;
  std::string container;  // empty for all
};

// The first job on a device, small enough for its own work not to matter.
void print_start(const DeviceRequest& device) {
  const Mesh box = test::make_box({0, 0, 0}, {4, 4, 4});
  Monitor monitor;
  const auto start = std::chrono::steady_clock::now();
  pack_hexagonal(box, {0, 0, 0, 1}, monitor, device);
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  fmt::print("cuda:{}: first job after {:.3f} s\n", device.index, seconds);
}

template <typename Pack>
void print_table(const std::string& title, const std::vector<DeviceRequest>& devices,
                 const Arguments& arguments, Pack pack) {
  fmt::print("\n{}\n\n| container | triangles | spheres | cpu s |", title);
  for (std::size_t i = 1; i < devices.size(); ++i) fmt::print(" cuda:{} s |", devices[i].index);
  for (std::size_t i = 1; i < devices.size(); ++i) fmt::print(" cpu / cuda:{} |", devices[i].index);
  fmt::print("\n|---|---|---|---|");
  for (std::size_t i = 1; i < devices.size(); ++i) fmt::print("---|---|");
  fmt::print("\n");
  for (const Container& container : paper_containers()) {
    if (!arguments.container.empty() && arguments.container != container.name) continue;
    const auto mesh = container_mesh(container, arguments.models);
    if (!mesh) {
      fmt::print("| {} | skipped: {}/{} is not there |\n", container.name, arguments.models,
                 container.model_file);
      continue;
    }
    Row row{container.name, mesh->triangles.size(), 0, {}};
    for (const DeviceRequest& device : devices) {
      row.seconds.push_back(least_seconds([&] {
        row.spheres = pack(*mesh, arguments.factor * container.max_radius, device).spheres.size();
      }));
    }
    fmt::print("{}\n", text_of(row));
    std::fflush(stdout);
  }
}

void run(const Arguments& arguments) {
  for (const std::string& line : describe_devices()) fmt::print("{}\n", line);
  const kernels::CudaDevices found = kernels::find_cuda_devices();
  std::vector<DeviceRequest> devices{{.kind = Kind::cpu}};
  for (int i = 0; i < static_cast<int>(found.devices.size()); ++i)
    devices.push_back({.kind = Kind::cuda, .index = i});
  if (devices.size() == 1)
    fmt::print("There is no CUDA device here ({}): the CPU's times stand alone.\n", found.problem);
  for (std::size_t i = 1; i < devices.size(); ++i) print_start(devices[i]);

  Monitor monitor;
  print_table("Hexagonal packing", devices, arguments,
              [&](const Mesh& mesh, double radius, const DeviceRequest& device) {
                return pack_hexagonal(mesh, {0, 0, 0, radius}, monitor, device);
              });
  constexpr double kLeastOfPaper = 0.1547;  // its smallest sphere to its largest
  print_table("Adaptive packing, the paper's range of radii", devices, arguments,
              [&](const Mesh& mesh, double radius, const DeviceRequest& device) {
                return pack_adaptive(mesh, {0, 0, kLeastOfPaper * radius, radius}, {}, monitor, device);
              });
}

}  // namespace
}  // namespace aerate::bench

int main(int argc, char** argv) {
  try {
    aerate::bench::Arguments arguments;
    if (argc > 1) arguments.models = argv[1];
    if (argc > 2) arguments.factor = std::stod(argv[2]);
    if (argc > 3) arguments.container = argv[3];
    aerate::bench::run(arguments);
  } catch (const std::exception& error) {
    fmt::print(stderr, "bench_devices: {}\n", error.what());
    return 1;
  }
  return 0;
}
