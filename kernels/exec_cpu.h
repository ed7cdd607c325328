#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_scan.h>
#include <tbb/parallel_sort.h>
#include <utility>
#include <vector>

#include "kernels/constants.h"
#include "kernels/tally.h"
#include "kernels/view.h"

// The executors that run kernels on the CPU. An executor is a value with
//
//   Buffer<T> allocate<T>(n)         uninitialised memory; RAII, movable, empty by default
//   Buffer<T> upload(span<const T>)  copy from the host
//   vector<T> download(View<T>)      copy to the host
//   for_each_index(n, f)             f(i) for every i < n, in any order; f is a functor of views and values
//   for_each_step(steps, n, f)       f(step, i) for every i < n, in any order, one step after the other
//   select(n, tally, emit)           stable partition: emit(i, before) for every i < n, in any order, where
//                                    `before` is the sum of tally(j) over j < i, which numbers the elements
//                                    of up to three lists; returns the sum over all. tally may be called
//                                    several times and must not read what emit writes
//   exclusive_scan(in, out)          out[i] = in[0] + ... + in[i-1]; returns the sum of all (64 bit, whatever
//                                    the offsets are); `in` and `out` may be the same memory
//   sort_pairs(keys, values)         both by (key, value) ascending; values ascend already
//   free_bytes()                     what could still be allocated, for those who can do with less, or
//                                    kAsMuchAsIsWanted
//   kLeastPiece                      smaller pieces of work than this cost more than they are worth
//
// and nothing else, so that one template over the executor is the algorithm for every processor, and every
// executor gives the same bytes (exec_cuda.h has the CUDA one).

namespace aerate::kernels {

// Host memory that is not zeroed when it is allocated.
template <typename T>
class HostBuffer {
 public:
  HostBuffer() = default;
  explicit HostBuffer(std::size_t size) : data_(std::make_unique_for_overwrite<T[]>(size)), size_(size) {}

  View<T> view() { return {data_.get(), size_}; }
  View<const T> view() const { return {data_.get(), size_}; }
  std::size_t size() const { return size_; }

 private:
  std::unique_ptr<T[]> data_;
  std::size_t size_ = 0;
};

// What the CPU executors share: memory is the host's.
class HostMemory {
 public:
  static constexpr std::size_t kLeastPiece = 8192;

  template <typename T>
  using Buffer = HostBuffer<T>;

  template <typename T>
  HostBuffer<T> allocate(std::size_t size) const {
    return HostBuffer<T>(size);
  }

  template <typename T>
  HostBuffer<T> upload(std::span<const T> source) const {
    HostBuffer<T> buffer(source.size());
    std::copy(source.begin(), source.end(), buffer.view().data);
    return buffer;
  }

  template <typename T>
  std::vector<std::remove_const_t<T>> download(View<T> source) const {
    return {source.data, source.data + source.size};
  }

  // The host's memory is no concern of the executor: jobs that need too much are refused before they start.
  std::size_t free_bytes() const { return kAsMuchAsIsWanted; }
};

// One thread, in index order: the reference the others are tested against.
class SerialExecutor : public HostMemory {
 public:
  template <typename F>
  void for_each_index(std::size_t count, F f) const {
    for (std::size_t i = 0; i < count; ++i) f(i);
  }

  template <typename F>
  void for_each_step(unsigned steps, std::size_t count, F f) const {
    for (unsigned step = 0; step < steps; ++step) {
      for (std::size_t i = 0; i < count; ++i) f(step, i);
    }
  }

  template <typename TallyOf, typename Emit>
  Tally select(std::size_t count, TallyOf tally, Emit emit) const {
    Tally sum{};
    for (std::size_t i = 0; i < count; ++i) {
      emit(i, sum);
      sum = sum + tally(i);
    }
    return sum;
  }

  std::uint64_t exclusive_scan(View<const std::uint32_t> in, View<std::uint32_t> out) const;
  void sort_pairs(View<std::uint64_t> keys, View<std::uint32_t> values) const;
};

// All threads of the current oneTBB arena.
class TbbExecutor : public HostMemory {
 public:
  template <typename F>
  void for_each_index(std::size_t count, F f) const {
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, count, kGrain),
                      [f](const tbb::blocked_range<std::size_t>& range) {
                        for (std::size_t i = range.begin(); i != range.end(); ++i) f(i);
                      });
  }

  template <typename F>
  void for_each_step(unsigned steps, std::size_t count, F f) const {
    for (unsigned step = 0; step < steps; ++step) {
      for_each_index(count, [f, step](std::size_t i) { f(step, i); });
    }
  }

  template <typename TallyOf, typename Emit>
  Tally select(std::size_t count, TallyOf tally, Emit emit) const {
    return tbb::parallel_scan(
        tbb::blocked_range<std::size_t>(0, count, kSelectGrain), Tally{},
        [tally, emit](const tbb::blocked_range<std::size_t>& range, Tally sum, bool is_final) {
          for (std::size_t i = range.begin(); i != range.end(); ++i) {
            if (is_final) emit(i, sum);
            sum = sum + tally(i);
          }
          return sum;
        },
        [](Tally a, Tally b) { return a + b; });
  }

  std::uint64_t exclusive_scan(View<const std::uint32_t> in, View<std::uint32_t> out) const;
  void sort_pairs(View<std::uint64_t> keys, View<std::uint32_t> values) const;

 private:
  static constexpr std::size_t kGrain = 64;
  static constexpr std::size_t kSelectGrain = 4096;
};

}  // namespace aerate::kernels
