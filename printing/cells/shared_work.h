#pragma once

#include <algorithm>
#include <cstddef>
#include <mutex>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include "core/monitor.h"

namespace aerate {

// Loops of all threads, within loops of all threads, that are heard when the user asks to stop: whichever thread it
// is asks the monitor, one at a time, and what that throws ends them all.
class SharedWork {
 public:
  explicit SharedWork(Monitor& monitor) : monitor_(monitor) {}

  void check_interrupted() {
    const std::lock_guard lock(mutex_);
    monitor_.check_interrupted();
  }

  // Calls f(first, last) for parts of [0, count) of about `grain`, in any order, which may enter no result.
  template <typename F>
  void for_each_part(std::size_t count, std::size_t grain, const F& f) {
    // A thread that waits here does not begin other work meanwhile, which would hold this up.
    tbb::this_task_arena::isolate([&] {
      tbb::parallel_for(tbb::blocked_range<std::size_t>(0, count, grain), [&](const auto& part) {
        for (std::size_t first = part.begin(); first < part.end(); first += grain) {
          check_interrupted();
          f(first, std::min(part.end(), first + grain));
        }
      });
    });
  }

  template <typename F>
  void for_each(std::size_t count, std::size_t grain, const F& f) {
    for_each_part(count, grain, [&](std::size_t first, std::size_t last) {
      for (std::size_t i = first; i < last; ++i) f(i);
    });
  }

 private:
  Monitor& monitor_;
  std::mutex mutex_;
};

}  // namespace aerate
