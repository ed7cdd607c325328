#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <type_traits>
#include <typeinfo>
#include <utility>
#include <vector>

#include "kernels/cuda_device.h"
#include "kernels/view.h"

// The executor that runs kernels on a CUDA device: the interface of exec_cpu.h. Host code may include this
// header; only nvcc sees what launches kernels.

struct CUstream_st;

namespace aerate::kernels {

namespace cuda_detail {

// The stream and the memory pool that an executor and its buffers share.
class Queue;

void* allocate(Queue& queue, std::size_t bytes);
void free(Queue& queue, void* memory) noexcept;
void copy_to_device(Queue& queue, void* to, const void* from, std::size_t bytes);
// Waits for all work of the queue.
void copy_to_host(Queue& queue, void* to, const void* from, std::size_t bytes);
CUstream_st* stream(Queue& queue);
// After each launch: throws if it failed; its name goes into later errors, since a kernel's own fault only
// shows in a later call.
void check_launch(Queue& queue, const std::type_info& functor);

}  // namespace cuda_detail

// Device memory, freed in the order of the queue. It may outlive its executor.
template <typename T>
class CudaBuffer {
  static_assert(std::is_trivially_copyable_v<T>);

 public:
  CudaBuffer() = default;
  CudaBuffer(std::shared_ptr<cuda_detail::Queue> queue, std::size_t size)
      : queue_(std::move(queue)),
        data_(static_cast<T*>(cuda_detail::allocate(*queue_, size * sizeof(T)))),
        size_(size) {}
  CudaBuffer(CudaBuffer&& other) noexcept
      : queue_(std::move(other.queue_)),
        data_(std::exchange(other.data_, nullptr)),
        size_(std::exchange(other.size_, 0)) {}
  CudaBuffer& operator=(CudaBuffer&& other) noexcept {
    std::swap(queue_, other.queue_);
    std::swap(data_, other.data_);
    std::swap(size_, other.size_);
    return *this;
  }
  ~CudaBuffer() {
    if (data_ != nullptr) cuda_detail::free(*queue_, data_);
  }

  View<T> view() { return {data_, size_}; }
  View<const T> view() const { return {data_, size_}; }
  std::size_t size() const { return size_; }

 private:
  std::shared_ptr<cuda_detail::Queue> queue_;
  T* data_ = nullptr;
  std::size_t size_ = 0;
};

#if defined(__CUDACC__)
namespace cuda_detail {

// Small blocks, since kernels that handle a triangle in fp64 need up to 170 registers.
inline constexpr unsigned kBlock = 128;

// The functor stays where the launch put it, in constant memory; no thread copies it.
template <typename F>
__global__ void __launch_bounds__(kBlock, 1) run(const __grid_constant__ F f, std::size_t count) {
  const std::size_t i = static_cast<std::size_t>(blockIdx.x) * kBlock + threadIdx.x;
  if (i < count) f(i);
}

}  // namespace cuda_detail
#endif

// Runs everything in order on one stream of one device; launches return at once, downloads and scans wait.
// Memory comes from a pool of the executor's own, so that allocating in a loop costs nothing, and all goes
// back with the executor. Not for use from several threads at a time. All members throw CudaError.
class CudaExecutor {
 public:
  template <typename T>
  using Buffer = CudaBuffer<T>;

  // device: CUDA's index
  explicit CudaExecutor(int device);

  template <typename T>
  CudaBuffer<T> allocate(std::size_t size) const {
    return CudaBuffer<T>(queue_, size);
  }

  template <typename T>
  CudaBuffer<T> upload(std::span<const T> source) const {
    CudaBuffer<T> buffer(queue_, source.size());
    cuda_detail::copy_to_device(*queue_, buffer.view().data, source.data(), source.size_bytes());
    return buffer;
  }

  template <typename T>
  std::vector<std::remove_const_t<T>> download(View<T> source) const {
    std::vector<std::remove_const_t<T>> copy(source.size);
    cuda_detail::copy_to_host(*queue_, copy.data(), source.data, source.size * sizeof(T));
    return copy;
  }

#if defined(__CUDACC__)
  template <typename F>
  void for_each_index(std::size_t count, F f) const {
    if (count == 0) return;
    const auto blocks = static_cast<unsigned>((count + cuda_detail::kBlock - 1) / cuda_detail::kBlock);
    cuda_detail::run<F><<<blocks, cuda_detail::kBlock, 0, cuda_detail::stream(*queue_)>>>(f, count);
    cuda_detail::check_launch(*queue_, typeid(F));
  }
#endif

  std::uint64_t exclusive_scan(View<const std::uint32_t> in, View<std::uint32_t> out) const;
  std::uint64_t exclusive_scan(View<const std::uint32_t> in, View<std::uint64_t> out) const;
  void sort_pairs(View<std::uint64_t> keys, View<std::uint32_t> values) const;

  // Bytes that could be allocated now; another process may be quicker.
  std::size_t free_bytes() const;

 private:
  std::shared_ptr<cuda_detail::Queue> queue_;
};

}  // namespace aerate::kernels
