#pragma once

#include <functional>
#include <optional>

namespace aerate {

// Runs `job` with at most `threads` threads (all of the machine's if not given), in this thread and the
// oneTBB workers. More threads than cores are really started: results must not depend on their number, and
// tests use that. Exceptions pass through.
void run_with_threads(std::optional<int> threads, const std::function<void()>& job);

}  // namespace aerate
