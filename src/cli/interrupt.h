#pragma once

#include <filesystem>

namespace aerate::cli {

// While it lives, SIGINT, SIGTERM and SIGHUP are noted instead of ending the process. A second one ends it at
// once with exit code 130, after removing the guarded files. One at a time: signal handlers know no objects.
class InterruptGuard {
 public:
  InterruptGuard();
  ~InterruptGuard();
  InterruptGuard(const InterruptGuard&) = delete;
  InterruptGuard& operator=(const InterruptGuard&) = delete;

  bool interrupted() const;

  // A file or folder to remove when the process is ended at once, and: no longer. At most kMostFiles, others
  // are left.
  void guard(const std::filesystem::path& path);
  void release(const std::filesystem::path& path);

  static constexpr int kMostFiles = 8;
};

}  // namespace aerate::cli
