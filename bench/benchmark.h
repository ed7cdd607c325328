#pragma once

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <filesystem>
#include <limits>
#include <string>
#include <vector>

// What every benchmark needs: its arguments, errors, clocks, and a place for files.

namespace aerate::bench {

// What a benchmark was called with.
struct Arguments {
  std::vector<std::string> positional;
  std::string table_file;    // gets the tables in Markdown; empty: they are not wanted
  std::string summary_file;  // gets rows of README's table of packing: what, and the figure

  // The i-th, or what stands for it.
  std::string text(std::size_t i, const std::string& otherwise) const;
  // Throws std::invalid_argument for one that is no number above 0.
  double number(std::size_t i, double otherwise) const;
  bool wants_figures() const { return !table_file.empty() || !summary_file.empty(); }
};

enum class Tables { none, written };

inline constexpr std::size_t kAnyNumber = std::numeric_limits<std::size_t>::max();

// How a benchmark is called, in words, and how many arguments that is; those that write tables take
// [--table FILE] [--summary FILE] as well.
struct Usage {
  const char* arguments;
  std::size_t least = 0, most = 0;
  Tables tables = Tables::none;
};

// The whole of `main`: the exit status of `run`; 1 with a message for what it throws, 2 for a wrong call.
int run_benchmark(int argc, char** argv, const Usage& usage, int (*run)(const Arguments&));

class Stopwatch {
 public:
  double seconds() const { return std::chrono::duration<double>(Clock::now() - start_).count(); }

 private:
  using Clock = std::chrono::steady_clock;
  Clock::time_point start_ = Clock::now();
};

template <typename F>
double seconds_of(const F& f) {
  const Stopwatch watch;
  f();
  return watch.seconds();
}

// Of several runs the one that was disturbed least.
template <typename F>
double least_seconds(int runs, const F& f) {
  double least = std::numeric_limits<double>::infinity();
  for (int run = 0; run < runs; ++run) least = std::min(least, seconds_of(f));
  return least;
}

// A new folder, which is removed with all that is in it.
class ScratchFolder {
 public:
  ScratchFolder();
  ~ScratchFolder();
  ScratchFolder(const ScratchFolder&) = delete;
  ScratchFolder& operator=(const ScratchFolder&) = delete;

  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

}  // namespace aerate::bench
