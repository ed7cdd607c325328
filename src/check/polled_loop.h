#pragma once

#include <algorithm>
#include <cstddef>
#include <tbb/parallel_for.h>

#include "core/monitor.h"

namespace aerate {

// Voids between two questions to the monitor: about ten million triangles at the very most.
inline constexpr std::size_t kVoidsPerPiece = 4096;

// Calls f(i) for every i < count, in any order on all threads, and asks the monitor between pieces of
// `per_piece`. f must not throw: which of several exceptions came first would depend on threads.
template <typename F>
void for_each_polled(std::size_t count, std::size_t per_piece, Monitor& monitor, const F& f) {
  for (std::size_t first = 0; first < count; first += per_piece) {
    monitor.check_interrupted();
    tbb::parallel_for(first, std::min(count, first + per_piece), f);
  }
}

}  // namespace aerate
