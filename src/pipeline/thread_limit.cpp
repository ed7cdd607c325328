#include "pipeline/thread_limit.h"

#include <tbb/global_control.h>
#include <tbb/task_arena.h>

namespace aerate {

void run_with_threads(std::optional<int> threads, const std::function<void()>& job) {
  if (!threads) {
    job();
    return;
  }
  // The control bounds the workers of the whole process, the arena raises what this thread may use above the
  // number of cores.
  const tbb::global_control control(tbb::global_control::max_allowed_parallelism,
                                    static_cast<std::size_t>(*threads));
  tbb::task_arena arena(*threads);
  arena.execute(job);
}

}  // namespace aerate
