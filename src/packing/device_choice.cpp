#include "packing/device_choice.h"

#include <charconv>
#include <fmt/format.h>
#include <tbb/task_arena.h>

#include "core/listed.h"
#include "packing/run_on_device.h"

namespace aerate {
namespace {

using Kind = DeviceRequest::Kind;

// The device's side of the model by which `auto` decides: assumptions, pessimistic on purpose, until
// bench_devices has run on a GPU (docs/cuda.md). The CPU's side is measured, and comes with the WorkEstimate.
constexpr double kAssumedSecondsToStart = 0.4;          // driver, context, and code for the device
constexpr double kAssumedTransferBytesPerSecond = 4e9;  // from memory that is not pinned
constexpr double kAssumedThreadsOfADevice = 60;         // how many CPU threads do its work

double seconds_on_device(const WorkEstimate& work) {
  return kAssumedSecondsToStart + work.transfer_bytes / kAssumedTransferBytesPerSecond +
         work.thread_seconds / kAssumedThreadsOfADevice;
}

std::string name_of(const kernels::CudaDevice& device, int index) {
  return fmt::format("cuda:{} ({})", index, device.name);
}

DeviceChoice cpu_because(std::string reason) {
  return {{Kind::cpu, 0}, {"cpu", std::move(reason)}};
}

DeviceChoice choose_automatically(const WorkEstimate& work) {
  if (kernels::cuda_build().empty()) return cpu_because("this build has no CUDA");
  // Decided before a driver is started for it.
  const double on_cpu = work.thread_seconds / tbb::this_task_arena::max_concurrency();
  const double on_cuda = seconds_on_device(work);
  const std::string comparison = fmt::format(
      "about {:.2g} s on the CPU by measured costs, {:.2g} s with CUDA by assumed ones", on_cpu, on_cuda);
  if (on_cpu <= on_cuda) return cpu_because(comparison);
  const kernels::CudaDevices found = kernels::find_cuda_devices();
  if (found.devices.empty()) return cpu_because("no CUDA device: " + found.problem);
  return {{Kind::cuda, 0}, {name_of(found.devices[0], 0), comparison}};
}

}  // namespace

std::optional<DeviceRequest> parse_device(std::string_view text) {
  if (text == "auto") return DeviceRequest{Kind::automatic, 0};
  if (text == "cpu") return DeviceRequest{Kind::cpu, 0};
  if (text == "cuda") return DeviceRequest{Kind::cuda, 0};
  constexpr std::string_view kPrefix = "cuda:";
  if (!text.starts_with(kPrefix)) return std::nullopt;
  text.remove_prefix(kPrefix.size());
  int index = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), index);
  if (error != std::errc() || end != text.data() + text.size() || index < 0) return std::nullopt;
  return DeviceRequest{Kind::cuda, index};
}

std::vector<std::string> describe_devices() {
  std::vector<std::string> lines{
      "cpu: " +
      counted(static_cast<std::size_t>(tbb::this_task_arena::max_concurrency()), "thread", "threads")};
  const std::string build = kernels::cuda_build();
  if (build.empty()) {
    lines.emplace_back("cuda: not built in");
    return lines;
  }
  const kernels::CudaDevices found = kernels::find_cuda_devices();
  if (found.devices.empty()) {
    lines.push_back(fmt::format("cuda: no device ({}); built with {}", found.problem, build));
    return lines;
  }
  for (std::size_t i = 0; i < found.devices.size(); ++i) {
    const kernels::CudaDevice& device = found.devices[i];
    lines.push_back(fmt::format("cuda:{}: {}, compute capability {}.{}, {:.1f} GiB; built with {}", i,
                                device.name, device.major, device.minor,
                                static_cast<double>(device.memory_bytes) / (1024.0 * 1024 * 1024), build));
  }
  return lines;
}

DeviceChoice choose_device(const DeviceRequest& request, const WorkEstimate& work) {
  switch (request.kind) {
    case Kind::automatic:
      return choose_automatically(work);
    case Kind::cpu:
    case Kind::cpu_one_thread:
      return {request, {"cpu", "asked for"}};
    case Kind::cuda:
      break;
  }
  if (kernels::cuda_build().empty()) {
    throw FailureError("this build of aerate has no CUDA",
                       "build it with AERATE_CUDA=ON, or use --device cpu");
  }
  const kernels::CudaDevices found = kernels::find_cuda_devices();
  if (found.devices.empty()) {
    throw FailureError("there is no CUDA device: " + found.problem,
                       "`nvidia-smi` and CUDA_VISIBLE_DEVICES say what a program sees; or use --device cpu");
  }
  const auto index = static_cast<std::size_t>(request.index);
  if (index >= found.devices.size()) {
    throw FailureError(
        fmt::format("there is no CUDA device {}: this machine has {}", request.index, found.devices.size()),
        "`aerate --version` lists the devices");
  }
  return {request, {name_of(found.devices[index], request.index), "asked for"}};
}

kernels::PackerInput packer_input(const Mesh& mesh, Monitor& monitor) {
  const Box3f box = bounding_box(mesh);
  const auto progress = [&monitor](double share) {
    monitor.progress(share);
    monitor.check_interrupted();
  };
  return {mesh.positions, mesh.triangles, {to_double(box.lower), to_double(box.upper)}, progress};
}

FailureError device_failure(const kernels::CudaError& error) {
  return FailureError(error.what(), error.hint() + " (--device cpu)");
}

}  // namespace aerate
