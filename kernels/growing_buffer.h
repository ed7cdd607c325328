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

// An executor's buffer whose capacity doubles as it grows. `resize` invalidates views.
template <typename Executor, typename T>
class GrowingBuffer {
 public:
  std::size_t size() const { return size_; }
  View<T> view() { return {buffer_.view().data, size_}; }

  // Keeps what is there; new elements are uninitialised.
  void resize(const Executor& executor, std::size_t size) {
    if (size > buffer_.size()) {
      std::size_t capacity = buffer_.size() < 1024 ? 1024 : buffer_.size();
      while (capacity < size) capacity *= 2;
      auto larger = executor.template allocate<T>(capacity);
      executor.for_each_index(size_, CopyElements<T>{buffer_.view(), larger.view()});
      buffer_ = std::move(larger);
    }
    size_ = size;
  }

 private:
  typename Executor::template Buffer<T> buffer_;
  std::size_t size_ = 0;
};

}  // namespace aerate::kernels
