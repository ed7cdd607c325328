#pragma once

#include <string>
#include <string_view>

#include "cli/interrupt.h"
#include "core/error.h"
#include "core/monitor.h"

namespace aerate::cli {

enum class Verbosity { normal, quiet };

// Notices and, if standard error is a terminal, a progress bar on it. Stops the job when a signal has come.
class TerminalMonitor final : public Monitor {
 public:
  TerminalMonitor(InterruptGuard& interrupt, Verbosity verbosity);
  ~TerminalMonitor() override;
  TerminalMonitor(const TerminalMonitor&) = delete;
  TerminalMonitor& operator=(const TerminalMonitor&) = delete;

  void stage(std::string_view name) override;
  void progress(double fraction) override;
  void notice(std::string_view text) override;
  void check_interrupted() override;
  void clear();  // takes the bar away, before results are printed
  void temporary_file_made(const std::filesystem::path& path) override { interrupt_.guard(path); }
  void temporary_file_gone(const std::filesystem::path& path) override { interrupt_.release(path); }

 private:
  void draw_bar(double fraction);

  InterruptGuard& interrupt_;
  Verbosity verbosity_;
  bool bar_allowed_;
  std::string stage_;
  int drawn_percent_ = -1;
};

// Descriptors 0 to 2 that are closed are opened on nothing, for an output would get their numbers, and with them
// what is meant for the terminal. Writing to them fails.
void keep_standard_descriptors();

// Throws FailureError if what was printed to standard output did not get there: a full disk or a closed pipe
// shows when it is flushed.
void require_stdout_written();

// What is shown here may hold text from outside: names, lines of files, what a slicer printed.

// "aerate: error: ..." and, if there is one, a line with the hint, on standard error.
void print_error(std::string_view what, std::string_view hint);

// "aerate: note: ..." there, as notices of a job are.
void print_note(std::string_view text);

}  // namespace aerate::cli
