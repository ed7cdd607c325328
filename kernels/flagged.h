#pragma once

#include <cstddef>
#include <cstdint>

#include "kernels/growing_buffer.h"
#include "kernels/view.h"

// Lists of the elements that a kernel has flagged.

namespace aerate::kernels {

struct Compact {
  View<const std::uint32_t> flags;
  View<const std::uint32_t> offsets;
  View<std::uint32_t> list;

  AERATE_HD void operator()(std::size_t i) const {
    if (flags[i] != 0) list[offsets[i]] = static_cast<std::uint32_t>(i);
  }
};

struct GatherIds {
  View<const std::uint32_t> from;
  View<const std::uint32_t> list;
  View<std::uint32_t> to;

  AERATE_HD void operator()(std::size_t i) const { to[i] = from[list[i]]; }
};

// Indices of the elements flagged 1 (of 0 and 1), ascending. `offsets` is scratch as long as `flags`.
template <typename Executor>
std::size_t list_flagged(const Executor& executor, View<std::uint32_t> flags, View<std::uint32_t> offsets,
                         GrowingBuffer<Executor, std::uint32_t>& list) {
  const std::size_t count = executor.exclusive_scan(flags, offsets);
  list.resize(executor, count);
  executor.for_each_index(flags.size, Compact{flags, offsets, list.view()});
  return count;
}

}  // namespace aerate::kernels
