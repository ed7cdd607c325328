#pragma once

#include <cstddef>

#include "kernels/annotations.h"

namespace aerate::kernels {

// A plain pointer and length into an executor's memory, for use inside kernels only: host code must not
// dereference it, since it may point to a device.
template <typename T>
struct View {
  T* data = nullptr;
  std::size_t size = 0;

  AERATE_HD T& operator[](std::size_t i) const { return data[i]; }

  // A view of mutable elements reads as a view of constant ones.
  AERATE_HD operator View<const T>() const { return {data, size}; }
};

// Kernel: fills a buffer.
template <typename T>
struct SetAll {
  View<T> values;
  T value;

  AERATE_HD void operator()(std::size_t i) const { values[i] = value; }
};

}  // namespace aerate::kernels
