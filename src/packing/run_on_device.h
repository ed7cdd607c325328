#pragma once

#include <utility>

#include "core/device.h"
#include "core/error.h"
#include "core/mesh.h"
#include "core/monitor.h"
#include "kernels/cuda_device.h"
#include "kernels/exec_cpu.h"
#include "kernels/packer.h"

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

// The model as every packer (kernels/packer.h) takes it; both arguments must outlive it.
kernels::PackerInput packer_input(const Mesh& mesh, Monitor& monitor);

template <typename Result>
struct OnDevice {
  Result result;
  DeviceUse use;
};

// Runs a packer where it was asked to run. When the choice was left to the program, a failing device gives
// way to the CPU, with a notice.
template <typename Packer>
OnDevice<typename Packer::Result> run_on_device(const DeviceRequest& request, const WorkEstimate& work,
                                                Monitor& monitor, const typename Packer::Input& input) {
  DeviceChoice choice = choose_device(request, work);
  if (choice.request.kind == DeviceRequest::Kind::cpu_one_thread)
    return {Packer::pack(kernels::SerialExecutor{}, input), std::move(choice.use)};
  if (choice.request.kind == DeviceRequest::Kind::cuda) {
    try {
      return {kernels::pack_on_cuda<Packer>(choice.request.index, input), std::move(choice.use)};
    } catch (const kernels::CudaError& error) {
      if (request.kind == DeviceRequest::Kind::cuda) throw device_failure(error);
      monitor.notice(choice.use.name + " gave up, packing on the CPU instead: " + error.what());
      choice.use = {"cpu", choice.use.name + " failed: " + error.what()};
    }
  }
  return {Packer::pack(kernels::TbbExecutor{}, input), std::move(choice.use)};
}

}  // namespace aerate
