#pragma once

#include <string>
#include <utility>

#include "core/device.h"
#include "core/error.h"
#include "core/monitor.h"
#include "kernels/cuda_device.h"

namespace aerate {

// What a job costs, for the choice between processors.
struct WorkEstimate {
  double thread_seconds = 0;  // on one thread of a CPU
  double transfer_bytes = 0;  // to a device and back
};

// Where a job should run, by the model in docs/cuda.md; `automatic` becomes `cpu` or `cuda`.
struct DeviceChoice {
  DeviceRequest request;
  DeviceUse use;
};
DeviceChoice choose_device(const DeviceRequest& request, const WorkEstimate& work);

// A CUDA failure as an error of the job, with what the user can do about it.
FailureError device_failure(const kernels::CudaError& error);

// Runs a job where it was asked to run: `on_cpu(kind)` or `on_cuda(index)`. When the choice was left to the
// program, a failing device gives way to the CPU, with a notice. Says in `use` where it ran.
template <typename OnCpu, typename OnCuda>
auto run_on_device(const DeviceRequest& request, const WorkEstimate& work, Monitor& monitor, DeviceUse& use,
                   OnCpu on_cpu, OnCuda on_cuda) {
  DeviceChoice choice = choose_device(request, work);
  use = std::move(choice.use);
  if (choice.request.kind != DeviceRequest::Kind::cuda) return on_cpu(choice.request.kind);
  try {
    return on_cuda(choice.request.index);
  } catch (const kernels::CudaError& error) {
    if (request.kind == DeviceRequest::Kind::cuda) throw device_failure(error);
    monitor.notice(use.name + " gave up, packing on the CPU instead: " + error.what());
    use = {"cpu", use.name + " failed: " + error.what()};
  }
  return on_cpu(DeviceRequest::Kind::cpu);
}

}  // namespace aerate
