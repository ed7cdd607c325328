#pragma once

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <functional>
#include <utility>

#include "kernels/annotations.h"

namespace aerate::kernels {

// Kernel: f for the elements from `first` on.
template <typename F>
struct FromIndex {
  F f;
  std::size_t first;

  AERATE_HD void operator()(std::size_t i) const { f(first + i); }
};

// Kernel: one step of an f(step, i).
template <typename F>
struct OneStep {
  F f;
  unsigned step;

  AERATE_HD void operator()(std::size_t i) const { f(step, i); }
};

// Calls piece(first, count) for runs of at most `most` elements that make up `total`.
template <typename Piece>
void for_each_piece(std::size_t total, std::size_t most, Piece piece) {
  for (std::size_t first = 0; first < total; first += most) piece(first, std::min(most, total - first));
}

// Runs long loops on an executor in pieces of about a quarter of a second and calls `poll` between them; what
// that throws ends the loop. The sizes of the pieces follow the clock, on which no result depends.
template <typename Executor>
class Paced {
 public:
  Paced(const Executor& executor, std::function<void()> poll) : executor_(executor), poll_(std::move(poll)) {}

  template <typename F>
  void for_each_index(std::size_t count, F f) {
    using Clock = std::chrono::steady_clock;
    std::size_t piece = kFirstPiece;
    for (std::size_t first = 0; first < count;) {
      const std::size_t size = std::min(piece, count - first);
      const Clock::time_point start = Clock::now();
      executor_.for_each_index(size, FromIndex<F>{f, first});
      const double seconds = std::chrono::duration<double>(Clock::now() - start).count();
      first += size;
      if (seconds < 0.5 * kPieceSeconds) piece *= 2;
      if (seconds > 2 * kPieceSeconds) piece = std::max(piece / 2, kFirstPiece);
      poll_();
    }
  }

  // f(step, i), one step after the other.
  template <typename F>
  void for_each_step(unsigned steps, std::size_t count, F f) {
    if (count <= kFirstPiece) {
      executor_.for_each_step(steps, count, f);
      return;
    }
    for (unsigned step = 0; step < steps; ++step) for_each_index(count, OneStep<F>{f, step});
  }

 private:
  static constexpr std::size_t kFirstPiece = Executor::kLeastPiece;
  static constexpr double kPieceSeconds = 0.25;

  const Executor& executor_;
  std::function<void()> poll_;
};

}  // namespace aerate::kernels
