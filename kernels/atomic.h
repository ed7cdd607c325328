#pragma once

#include <cstdint>

#include "kernels/annotations.h"

#if !defined(__CUDA_ARCH__)
#include <atomic>
#endif

namespace aerate::kernels {

// Adds to a counter that several threads share and returns its value before. Integers only: the sum does not
// depend on the order (what is done with the returned values must not either).
AERATE_HD inline std::uint32_t atomic_add(std::uint32_t& counter, std::uint32_t value) {
#if defined(__CUDA_ARCH__)
  return atomicAdd(&counter, value);
#else
  return std::atomic_ref<std::uint32_t>(counter).fetch_add(value, std::memory_order_relaxed);
#endif
}

AERATE_HD inline std::uint64_t atomic_add(std::uint64_t& counter, std::uint64_t value) {
#if defined(__CUDA_ARCH__)
  return atomicAdd(reinterpret_cast<unsigned long long*>(&counter), value);
#else
  return std::atomic_ref<std::uint64_t>(counter).fetch_add(value, std::memory_order_relaxed);
#endif
}

// Stores a value and returns the one before.
AERATE_HD inline std::uint32_t atomic_exchange(std::uint32_t& place, std::uint32_t value) {
#if defined(__CUDA_ARCH__)
  return atomicExch(&place, value);
#else
  return std::atomic_ref<std::uint32_t>(place).exchange(value, std::memory_order_relaxed);
#endif
}

// Reads a place that other threads may be writing to.
AERATE_HD inline std::uint32_t atomic_load(std::uint32_t& place) {
#if defined(__CUDA_ARCH__)
  return *static_cast<volatile std::uint32_t*>(&place);
#else
  return std::atomic_ref<std::uint32_t>(place).load(std::memory_order_relaxed);
#endif
}

}  // namespace aerate::kernels
