#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <type_traits>
#include <typeinfo>
#include <utility>
#include <vector>

#include "kernels/cuda_device.h"
#include "kernels/tally.h"
#include "kernels/view.h"

// The executor that runs kernels on a CUDA device: the interface of exec_cpu.h. For nvcc alone.

namespace aerate::kernels {

namespace cuda_detail {

// The stream and the memory pool that an executor and its buffers share. All members throw CudaError but
// those that cannot.
class Queue {
 public:
  explicit Queue(int device);
  ~Queue();
  Queue(const Queue&) = delete;
  Queue& operator=(const Queue&) = delete;

  cudaStream_t stream() const { return stream_; }
  void* allocate(std::size_t bytes);
  void free(void* memory) noexcept;
  void copy_to_device(void* to, const void* from, std::size_t bytes);
  // Waits for all work of the queue.
  void copy_to_host(void* to, const void* from, std::size_t bytes);
  // Memory for the temporaries of one operation: valid until the next operation that asks for some.
  void* scratch(std::size_t bytes);
  std::size_t free_bytes() const;

  // After each launch: its name goes into later errors, since a kernel's own fault only shows in a later
  // call.
  void check_launch(const std::type_info& functor);
  // For a call in which a fault of a kernel may show.
  void check_after_kernels(cudaError_t error, const std::string& call) const;

 private:
  void wait(const std::string& call) const { check_after_kernels(cudaStreamSynchronize(stream_), call); }

  cudaMemPool_t pool_ = nullptr;
  cudaStream_t stream_ = nullptr;
  void* scratch_ = nullptr;
  std::size_t scratch_bytes_ = 0;
  const std::type_info* last_kernel_ = nullptr;
};

}  // namespace cuda_detail

// Device memory, freed in the order of the queue. It may outlive its executor.
template <typename T>
class CudaBuffer {
  static_assert(std::is_trivially_copyable_v<T>);

 public:
  CudaBuffer() = default;
  CudaBuffer(std::shared_ptr<cuda_detail::Queue> queue, std::size_t size)
      : queue_(std::move(queue)), data_(static_cast<T*>(queue_->allocate(size * sizeof(T)))), size_(size) {}
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
    if (data_ != nullptr) queue_->free(data_);
  }

  View<T> view() { return {data_, size_}; }
  View<const T> view() const { return {data_, size_}; }
  std::size_t size() const { return size_; }

 private:
  std::shared_ptr<cuda_detail::Queue> queue_;
  T* data_ = nullptr;
  std::size_t size_ = 0;
};

namespace cuda_detail {

// Small blocks, since kernels that handle a triangle in fp64 need up to 220 registers.
inline constexpr unsigned kBlock = 128;

// The functor stays where the launch put it, in constant memory; no thread copies it.
template <typename F>
__global__ void __launch_bounds__(kBlock, 1) run(const __grid_constant__ F f, std::size_t count) {
  const std::size_t i = static_cast<std::size_t>(blockIdx.x) * kBlock + threadIdx.x;
  if (i < count) f(i);
}

template <typename F>
__global__ void __launch_bounds__(kBlock, 1)
    run_step(const __grid_constant__ F f, unsigned step, std::size_t count) {
  const std::size_t i = static_cast<std::size_t>(blockIdx.x) * kBlock + threadIdx.x;
  if (i < count) f(step, i);
}

// All steps in one block, whose barrier parts them.
inline constexpr unsigned kStepBlock = 256;
inline constexpr std::size_t kMostInOneBlock = 4096;

template <typename F>
__global__ void __launch_bounds__(kStepBlock, 1)
    run_all_steps(const __grid_constant__ F f, unsigned steps, std::size_t count) {
  for (unsigned step = 0; step < steps; ++step) {
    for (std::size_t i = threadIdx.x; i < count; i += kStepBlock) f(step, i);
    __syncthreads();
  }
}

// A block of `select` handles tiles of this many elements, a thread a few neighbours of each.
inline constexpr unsigned kSelectBlock = 256;
inline constexpr std::size_t kSelectRun = 8;
inline constexpr std::size_t kSelectTile = kSelectRun * kSelectBlock;

// Sums within a block by shuffles. Ours and not cub::BlockScan, whose headers every file with a kernel would
// have to compile.
struct TallySums {
  Tally before;  // of the threads before this one
  Tally all;     // of the whole block
};

__device__ inline TallySums sum_over_block(Tally own) {
  constexpr unsigned kAll = 0xffffffffu, kWarp = 32;
  __shared__ Tally warp_sums[kSelectBlock / kWarp];
  const unsigned lane = threadIdx.x % kWarp, warp = threadIdx.x / kWarp;
  Tally upto = own;
  for (unsigned distance = 1; distance < kWarp; distance *= 2) {
    const Tally left{__shfl_up_sync(kAll, upto.first, distance), __shfl_up_sync(kAll, upto.second, distance),
                     __shfl_up_sync(kAll, upto.third, distance)};
    if (lane >= distance) upto = upto + left;
  }
  if (lane == kWarp - 1) warp_sums[warp] = upto;
  __syncthreads();
  TallySums sums{};
  for (unsigned k = 0; k < kSelectBlock / kWarp; ++k) {
    if (k < warp) sums.before = sums.before + warp_sums[k];
    sums.all = sums.all + warp_sums[k];
  }
  __syncthreads();  // the next call writes to warp_sums
  const Tally in_warp{upto.first - own.first, upto.second - own.second, upto.third - own.third};
  sums.before = sums.before + in_warp;
  return sums;
}

template <typename TallyOf>
__global__ void __launch_bounds__(kSelectBlock, 1)
    select_sums(const __grid_constant__ TallyOf tally, std::size_t count, Tally* sums) {
  const std::size_t first = blockIdx.x * kSelectTile;
  Tally own{};
  for (std::size_t k = threadIdx.x; k < kSelectTile && first + k < count; k += kSelectBlock) {
    own = own + tally(first + k);
  }
  const Tally sum = sum_over_block(own).all;
  if (threadIdx.x == 0) sums[blockIdx.x] = sum;
}

// Numbers elements from `first` to `last` in order; `sum` is that of those before, then of those up to them.
template <typename TallyOf, typename Emit>
__device__ void select_elements(const TallyOf& tally, const Emit& emit, std::size_t first, std::size_t last,
                                Tally& sum) {
  for (std::size_t tile = first; tile < last; tile += kSelectTile) {
    const std::size_t begin = tile + threadIdx.x * kSelectRun;
    const std::size_t end = begin + kSelectRun < last ? begin + kSelectRun : last;
    Tally own{};
    for (std::size_t i = begin; i < end; ++i) own = own + tally(i);
    const TallySums sums = sum_over_block(own);
    Tally before = sum + sums.before;
    for (std::size_t i = begin; i < end; ++i) {
      emit(i, before);
      before = before + tally(i);
    }
    sum = sum + sums.all;
  }
}

template <typename TallyOf, typename Emit>
__global__ void __launch_bounds__(kSelectBlock, 1)
    select_emit(const __grid_constant__ TallyOf tally, const __grid_constant__ Emit emit, std::size_t count,
                const Tally* sums, Tally* total) {
  Tally own{};
  for (unsigned block = threadIdx.x; block < blockIdx.x; block += kSelectBlock) own = own + sums[block];
  Tally sum = sum_over_block(own).all;
  const std::size_t first = blockIdx.x * kSelectTile;
  const std::size_t last = first + kSelectTile < count ? first + kSelectTile : count;
  select_elements(tally, emit, first, last, sum);
  if (threadIdx.x == 0 && blockIdx.x + 1 == gridDim.x) *total = sum;
}

template <typename TallyOf, typename Emit>
__global__ void __launch_bounds__(kSelectBlock, 1)
    select_in_one_block(const __grid_constant__ TallyOf tally, const __grid_constant__ Emit emit,
                        std::size_t count, Tally* total) {
  Tally sum{};
  select_elements(tally, emit, 0, count, sum);
  if (threadIdx.x == 0) *total = sum;
}

}  // namespace cuda_detail

// Runs everything in order on one stream of one device; launches return at once, downloads and scans wait.
// Memory comes from a pool of the executor's own, so that allocating in a loop costs nothing, and all goes
// back with the executor. Not for use from several threads at a time. All members throw CudaError.
class CudaExecutor {
 public:
  template <typename T>
  using Buffer = CudaBuffer<T>;

  static constexpr std::size_t kLeastPiece = std::size_t{1} << 18;

  // device: CUDA's index
  explicit CudaExecutor(int device);

  template <typename T>
  CudaBuffer<T> allocate(std::size_t size) const {
    return CudaBuffer<T>(queue_, size);
  }

  template <typename T>
  CudaBuffer<T> upload(std::span<const T> source) const {
    CudaBuffer<T> buffer(queue_, source.size());
    queue_->copy_to_device(buffer.view().data, source.data(), source.size_bytes());
    return buffer;
  }

  template <typename T>
  std::vector<std::remove_const_t<T>> download(View<T> source) const {
    std::vector<std::remove_const_t<T>> copy(source.size);
    queue_->copy_to_host(copy.data(), source.data, source.size * sizeof(T));
    return copy;
  }

  template <typename F>
  void for_each_index(std::size_t count, F f) const {
    if (count == 0) return;
    const unsigned blocks = blocks_of(count, cuda_detail::kBlock);
    cuda_detail::run<F><<<blocks, cuda_detail::kBlock, 0, queue_->stream()>>>(f, count);
    queue_->check_launch(typeid(F));
  }

  // One launch for a few thousand elements, else one for each step.
  template <typename F>
  void for_each_step(unsigned steps, std::size_t count, F f) const {
    using namespace cuda_detail;
    if (count == 0) return;
    if (count <= kMostInOneBlock) {
      run_all_steps<F><<<1, kStepBlock, 0, queue_->stream()>>>(f, steps, count);
      queue_->check_launch(typeid(F));
      return;
    }
    for (unsigned step = 0; step < steps; ++step) {
      run_step<F><<<blocks_of(count, kBlock), kBlock, 0, queue_->stream()>>>(f, step, count);
      queue_->check_launch(typeid(F));
    }
  }

  // One launch for a few thousand elements, else two; then the host waits for the sum.
  template <typename TallyOf, typename Emit>
  Tally select(std::size_t count, TallyOf tally, Emit emit) const {
    using namespace cuda_detail;
    if (count == 0) return {};
    const unsigned blocks = count <= kMostInOneBlock ? 1 : blocks_of(count, kSelectTile);
    auto* const total = static_cast<Tally*>(queue_->scratch((blocks + std::size_t{1}) * sizeof(Tally)));
    if (blocks == 1) {
      select_in_one_block<<<1, kSelectBlock, 0, queue_->stream()>>>(tally, emit, count, total);
    } else {
      select_sums<<<blocks, kSelectBlock, 0, queue_->stream()>>>(tally, count, total + 1);
      queue_->check_launch(typeid(TallyOf));
      select_emit<<<blocks, kSelectBlock, 0, queue_->stream()>>>(tally, emit, count, total + 1, total);
    }
    queue_->check_launch(typeid(Emit));
    Tally sum{};
    queue_->copy_to_host(&sum, total, sizeof sum);
    return sum;
  }

  std::uint64_t exclusive_scan(View<const std::uint32_t> in, View<std::uint32_t> out) const;
  void sort_pairs(View<std::uint64_t> keys, View<std::uint32_t> values) const;

  // Bytes that could be allocated now; another process may be quicker.
  std::size_t free_bytes() const { return queue_->free_bytes(); }

 private:
  static unsigned blocks_of(std::size_t count, std::size_t in_a_block) {
    return static_cast<unsigned>((count + in_a_block - 1) / in_a_block);
  }

  std::shared_ptr<cuda_detail::Queue> queue_;
};

}  // namespace aerate::kernels
