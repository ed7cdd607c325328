#include <algorithm>
#include <cub/device/device_radix_sort.cuh>
#include <cub/device/device_scan.cuh>
#include <cxxabi.h>
#include <string>
#include <thrust/iterator/tabulate_output_iterator.h>

#include "kernels/exec_cuda.h"

namespace aerate::kernels {
namespace {

std::string readable_name(const std::type_info& type) {
  int status = 0;
  const std::unique_ptr<char, decltype(&std::free)> name(
      abi::__cxa_demangle(type.name(), nullptr, nullptr, &status), &std::free);
  return status == 0 ? name.get() : type.name();
}

CudaError::Kind kind_of(cudaError_t error) {
  switch (error) {
    case cudaErrorMemoryAllocation:
      return CudaError::Kind::out_of_memory;
    case cudaErrorNoDevice:
    case cudaErrorInvalidDevice:
    case cudaErrorInsufficientDriver:
    case cudaErrorSystemDriverMismatch:
    case cudaErrorNoKernelImageForDevice:
    case cudaErrorUnsupportedPtxVersion:
    case cudaErrorDevicesUnavailable:
      return CudaError::Kind::no_device;
    default:
      return CudaError::Kind::failed;
  }
}

std::string hint_for(cudaError_t error) {
  switch (error) {
    case cudaErrorMemoryAllocation:
      return kTooLittleMemoryHint;
    case cudaErrorInsufficientDriver:
    case cudaErrorSystemDriverMismatch:
      return "install an NVIDIA driver as new as " + cuda_build() + ", or run on the CPU";
    case cudaErrorNoDevice:
    case cudaErrorInvalidDevice:
      return "`nvidia-smi` and CUDA_VISIBLE_DEVICES say which devices a program sees; or run on the CPU";
    case cudaErrorNoKernelImageForDevice:
    case cudaErrorUnsupportedPtxVersion:
      return "this build is " + cuda_build() +
             ": build it for this device (AERATE_CUDA_ARCHITECTURES), or run on the CPU";
    default:
      return "run on the CPU; with CUDA_LAUNCH_BLOCKING=1 or under compute-sanitizer the message names the "
             "kernel that failed";
  }
}

[[noreturn]] void fail(cudaError_t error, const std::string& call) {
  cudaGetLastError();  // this error is reported here, not by the next launch
  throw CudaError(
      kind_of(error),
      "CUDA: " + call + " failed: " + cudaGetErrorString(error) + " (" + cudaGetErrorName(error) + ")",
      hint_for(error));
}

void check(cudaError_t error, const std::string& call) {
  if (error != cudaSuccess) fail(error, call);
}

}  // namespace

namespace cuda_detail {

Queue::Queue(int device) {
  check(cudaSetDevice(device), "cudaSetDevice(" + std::to_string(device) + ")");
  cudaMemPoolProps properties{};
  properties.allocType = cudaMemAllocationTypePinned;
  properties.location = {cudaMemLocationTypeDevice, device};
  check(cudaMemPoolCreate(&pool_, &properties), "cudaMemPoolCreate");
  std::uint64_t keep_all = ~std::uint64_t{0};
  const char* call = "cudaMemPoolSetAttribute";
  cudaError_t error = cudaMemPoolSetAttribute(pool_, cudaMemPoolAttrReleaseThreshold, &keep_all);
  if (error == cudaSuccess) {
    call = "cudaStreamCreateWithFlags";
    error = cudaStreamCreateWithFlags(&stream_, cudaStreamNonBlocking);
  }
  if (error != cudaSuccess) {
    cudaMemPoolDestroy(pool_);
    fail(error, call);
  }
}

Queue::~Queue() {
  if (scratch_ != nullptr) free(scratch_);
  cudaStreamSynchronize(stream_);
  cudaStreamDestroy(stream_);
  cudaMemPoolDestroy(pool_);
  cudaGetLastError();
}

void* Queue::allocate(std::size_t bytes) {
  if (bytes == 0) return nullptr;
  void* memory = nullptr;
  cudaError_t error = cudaMallocFromPoolAsync(&memory, bytes, pool_, stream_);
  if (error == cudaErrorMemoryAllocation) {
    // What was freed in the queue but is not yet reusable may be all that is missing.
    cudaGetLastError();
    wait("cudaStreamSynchronize");
    cudaMemPoolTrimTo(pool_, 0);
    error = cudaMallocFromPoolAsync(&memory, bytes, pool_, stream_);
  }
  check(error, "cudaMallocFromPoolAsync of " + std::to_string(bytes) + " bytes");
  return memory;
}

void Queue::free(void* memory) noexcept {
  if (cudaFreeAsync(memory, stream_) != cudaSuccess) cudaGetLastError();
}

void Queue::copy_to_device(void* to, const void* from, std::size_t bytes) {
  if (bytes == 0) return;
  check_after_kernels(cudaMemcpyAsync(to, from, bytes, cudaMemcpyHostToDevice, stream_),
                      "cudaMemcpyAsync of " + std::to_string(bytes) + " bytes to the device");
}

void Queue::copy_to_host(void* to, const void* from, std::size_t bytes) {
  if (bytes == 0) return;
  const std::string call = "cudaMemcpyAsync of " + std::to_string(bytes) + " bytes to the host";
  check_after_kernels(cudaMemcpyAsync(to, from, bytes, cudaMemcpyDeviceToHost, stream_), call);
  wait(call);
}

void* Queue::scratch(std::size_t bytes) {
  constexpr std::size_t kLeast = 4096;
  if (bytes <= scratch_bytes_) return scratch_;
  if (scratch_ != nullptr) free(std::exchange(scratch_, nullptr));
  scratch_bytes_ = 0;
  const std::size_t granted = std::max(bytes + bytes / 2, kLeast);
  scratch_ = allocate(granted);
  scratch_bytes_ = granted;
  return scratch_;
}

std::size_t Queue::free_bytes() const {
  std::size_t free = 0, total = 0;
  check_after_kernels(cudaMemGetInfo(&free, &total), "cudaMemGetInfo");
  std::uint64_t reserved = 0, used = 0;
  check(cudaMemPoolGetAttribute(pool_, cudaMemPoolAttrReservedMemCurrent, &reserved),
        "cudaMemPoolGetAttribute");
  check(cudaMemPoolGetAttribute(pool_, cudaMemPoolAttrUsedMemCurrent, &used), "cudaMemPoolGetAttribute");
  return free + (reserved > used ? reserved - used : 0);
}

void Queue::check_launch(const std::type_info& functor) {
  const cudaError_t error = cudaGetLastError();
  if (error != cudaSuccess) fail(error, "launch of the kernel " + readable_name(functor));
  last_kernel_ = &functor;
}

void Queue::check_after_kernels(cudaError_t error, const std::string& call) const {
  if (error == cudaSuccess) return;
  fail(error, last_kernel_ == nullptr ? call : call + " after the kernel " + readable_name(*last_kernel_));
}

}  // namespace cuda_detail

namespace {

using cuda_detail::Queue;

// Where a scan writes: sums as offsets, and the sum of all where the host will look for it.
struct StoreSums {
  View<const std::uint32_t> in;
  View<std::uint32_t> out;
  std::uint64_t* total;

  __device__ void operator()(std::size_t i, std::uint64_t sum) const {
    if (i + 1 == in.size) *total = sum + in[i];
    out[i] = static_cast<std::uint32_t>(sum);
  }
};

// Calls a CUB algorithm twice, as they want it: for the size of its temporary memory, and to do the work.
template <typename Algorithm>
void run_cub(const std::shared_ptr<Queue>& queue, const std::string& name, Algorithm algorithm) {
  std::size_t bytes = 0;
  queue->check_after_kernels(algorithm(nullptr, bytes), name);
  CudaBuffer<std::byte> temporary(queue, bytes);
  queue->check_after_kernels(algorithm(temporary.view().data, bytes), name);
}

}  // namespace

CudaExecutor::CudaExecutor(int device) : queue_(std::make_shared<Queue>(device)) {}

std::uint64_t CudaExecutor::exclusive_scan(View<const std::uint32_t> in, View<std::uint32_t> out) const {
  if (in.size == 0) return 0;
  CudaBuffer<std::uint64_t> total(queue_, 1);
  const auto output = thrust::make_tabulate_output_iterator(StoreSums{in, out, total.view().data});
  run_cub(queue_, "cub::DeviceScan", [&](void* temporary, std::size_t& bytes) {
    return cub::DeviceScan::ExclusiveScan(temporary, bytes, in.data, output, cuda::std::plus<>{},
                                          std::uint64_t{0}, in.size, queue_->stream());
  });
  std::uint64_t sum = 0;
  queue_->copy_to_host(&sum, total.view().data, sizeof sum);
  return sum;
}

// A stable sort by key: values that ascend stay in order where keys are equal.
void CudaExecutor::sort_pairs(View<std::uint64_t> keys, View<std::uint32_t> values) const {
  if (keys.size < 2) return;
  CudaBuffer<std::uint64_t> other_keys(queue_, keys.size);
  CudaBuffer<std::uint32_t> other_values(queue_, values.size);
  cub::DoubleBuffer<std::uint64_t> key_buffers(keys.data, other_keys.view().data);
  cub::DoubleBuffer<std::uint32_t> value_buffers(values.data, other_values.view().data);
  run_cub(queue_, "cub::DeviceRadixSort", [&](void* temporary, std::size_t& bytes) {
    return cub::DeviceRadixSort::SortPairs(temporary, bytes, key_buffers, value_buffers, keys.size, 0, 64,
                                           queue_->stream());
  });
  const auto bring_home = [&](void* home, const void* current, std::size_t bytes) {
    if (home == current) return;
    queue_->check_after_kernels(
        cudaMemcpyAsync(home, current, bytes, cudaMemcpyDeviceToDevice, queue_->stream()),
        "cudaMemcpyAsync of " + std::to_string(bytes) + " bytes on the device");
  };
  bring_home(keys.data, key_buffers.Current(), keys.size * sizeof(std::uint64_t));
  bring_home(values.data, value_buffers.Current(), values.size * sizeof(std::uint32_t));
}

std::string cuda_build() {
  return "CUDA " + std::to_string(__CUDACC_VER_MAJOR__) + "." + std::to_string(__CUDACC_VER_MINOR__) +
         " for " AERATE_CUDA_TARGETS;
}

CudaDevices find_cuda_devices() {
  CudaDevices found;
  int count = 0;
  cudaError_t error = cudaGetDeviceCount(&count);
  for (int i = 0; error == cudaSuccess && i < count; ++i) {
    cudaDeviceProp properties{};
    error = cudaGetDeviceProperties(&properties, i);
    found.devices.push_back({properties.name, properties.major, properties.minor, properties.totalGlobalMem});
  }
  if (error != cudaSuccess) {
    cudaGetLastError();
    return {{}, cudaGetErrorString(error)};
  }
  if (count == 0) found.problem = "no CUDA-capable device is detected";
  return found;
}

}  // namespace aerate::kernels
