#pragma once

#include <cstddef>

#include "kernels/view.h"

namespace aerate::kernels {

template <typename T>
struct CopyElements {
  View<const T> from;
  View<T> to;

  AERATE_HD void operator()(std::size_t i) const { to[i] = from[i]; }
};

// An executor's buffer whose capacity doubles as it grows, as long as memory allows. `resize` invalidates
// views.
template <typename Executor, typename T>
class GrowingBuffer {
 public:
  std::size_t size() const { return size_; }
  View<T> view() { return {buffer_.view().data, size_}; }
  View<T> view_from(std::size_t first) { return {buffer_.view().data + first, size_ - first}; }

  // Keeps what is there; new elements are uninitialised.
  void resize(const Executor& executor, std::size_t size) {
    if (size > buffer_.size()) {
      auto larger = executor.template allocate<T>(larger_capacity(executor, size));
      executor.for_each_index(size_, CopyElements<T>{{buffer_.view().data, size_}, larger.view()});
      buffer_ = std::move(larger);
    }
    size_ = size;
  }

  // Drops what is there.
  void clear() { size_ = 0; }

 private:
  std::size_t larger_capacity(const Executor& executor, std::size_t size) const {
    constexpr std::size_t kLeast = 1024;
    std::size_t capacity = buffer_.size() < kLeast ? kLeast : buffer_.size();
    while (capacity < size) capacity *= 2;
    return capacity <= executor.free_bytes() / sizeof(T) / 2 ? capacity : size;
  }

  typename Executor::template Buffer<T> buffer_;
  std::size_t size_ = 0;
};

}  // namespace aerate::kernels
