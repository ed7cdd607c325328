#pragma once

#include <cstddef>
#include <type_traits>

#include "kernels/annotations.h"

namespace aerate::kernels {

// A plain pointer and length into an executor's memory, for use inside kernels only: host code must not
// dereference it, since it may point to a device.
template <typename T>
struct View {
  T* data = nullptr;
  std::size_t size = 0;

  View() = default;
  AERATE_HD constexpr View(T* first, std::size_t count) : data(first), size(count) {}
  // A view of mutable elements reads as a view of constant ones.
  template <typename Mutable>
  requires std::is_same_v<const Mutable, T> AERATE_HD constexpr View(View<Mutable> other)
      : data(other.data), size(other.size) {}

  AERATE_HD T& operator[](std::size_t i) const { return data[i]; }
};

// Kernel: fills a buffer.
template <typename T>
struct SetAll {
  View<T> values;
  T value;

  AERATE_HD void operator()(std::size_t i) const { values[i] = value; }
};

}  // namespace aerate::kernels
