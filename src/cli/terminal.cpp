#include "cli/terminal.h"

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <fcntl.h>
#include <fmt/format.h>
#include <iostream>
#include <system_error>
#include <unistd.h>

#include "core/printable.h"

namespace aerate::cli {
namespace {

bool is_set(const char* name) {
  const char* value = std::getenv(name);
  return value != nullptr && *value != '\0';
}

bool stderr_is_terminal() {
  const char* terminal = std::getenv("TERM");
  return isatty(STDERR_FILENO) != 0 && (terminal == nullptr || std::string_view(terminal) != "dumb");
}

// https://no-color.org: any value but an empty one forbids colour.
bool colour_allowed() {
  return stderr_is_terminal() && !is_set("NO_COLOR");
}

enum class Tone { error, notice, faint };

std::string toned(std::string_view text, Tone tone) {
  if (!colour_allowed()) return std::string(text);
  const char* code = tone == Tone::error ? "1;31" : tone == Tone::notice ? "33" : "2";
  return fmt::format("\x1b[{}m{}\x1b[0m", code, text);
}

// A line from outside, such as one of a slicer, as it may be shown: of one that is endless, both ends.
std::string shown_line(std::string_view line) {
  constexpr std::size_t kEnd = 600;
  if (line.size() <= 2 * kEnd) return printable(line);
  return printable(line.substr(0, kEnd)) + " ... " + printable(line.substr(line.size() - kEnd));
}

// Lines after the first are set off, so that none from outside can be taken for one of ours.
std::string shown(std::string_view text) {
  std::string lines;
  for (std::size_t start = 0;;) {
    const std::size_t end = text.find('\n', start);
    lines += shown_line(text.substr(start, end - start));
    if (end == std::string_view::npos) return lines;
    lines += "\n  ";
    start = end + 1;
  }
}

void print_to_stderr(const std::string& text) {
  std::fwrite(text.data(), 1, text.size(), stderr);
  std::fflush(stderr);
}

}  // namespace

TerminalMonitor::TerminalMonitor(InterruptGuard& interrupt, Verbosity verbosity)
    : interrupt_(interrupt),
      verbosity_(verbosity),
      bar_allowed_(verbosity == Verbosity::normal && stderr_is_terminal()) {}

TerminalMonitor::~TerminalMonitor() {
  clear();
}

void TerminalMonitor::stage(std::string_view name) {
  stage_ = name;
  drawn_percent_ = -1;
  draw_bar(0);
}

void TerminalMonitor::progress(double fraction) {
  draw_bar(fraction);
}

void TerminalMonitor::notice(std::string_view text) {
  if (verbosity_ == Verbosity::quiet) return;
  clear();
  print_note(text);
}

void TerminalMonitor::check_interrupted() {
  if (interrupt_.interrupted()) throw InterruptedError();
}

void TerminalMonitor::draw_bar(double fraction) {
  if (!bar_allowed_) return;
  const int percent = static_cast<int>(std::clamp(fraction, 0.0, 1.0) * 100);
  if (percent == drawn_percent_) return;
  drawn_percent_ = percent;
  constexpr int kWidth = 30;
  const auto filled = static_cast<std::size_t>(percent * kWidth / 100);
  print_to_stderr(fmt::format("\r\x1b[K{:<18} [{}{}] {:3} %", stage_, std::string(filled, '#'),
                              toned(std::string(kWidth - filled, '.'), Tone::faint), percent));
}

void TerminalMonitor::clear() {
  if (!bar_allowed_ || drawn_percent_ < 0) return;
  print_to_stderr("\r\x1b[K");
  drawn_percent_ = -1;
}

void keep_standard_descriptors() {
  for (int descriptor = STDIN_FILENO; descriptor <= STDERR_FILENO; ++descriptor) {
    if (fcntl(descriptor, F_GETFD) >= 0) continue;
    // The lowest number that is free is this one.
    static_cast<void>(open("/dev/null", descriptor == STDIN_FILENO ? O_WRONLY : O_RDONLY));
  }
}

void require_stdout_written() {
  errno = 0;
  std::cout.flush();
  if (std::fflush(stdout) == 0 && std::cout) return;
  throw FailureError("standard output cannot be written: " +
                     std::generic_category().message(errno == 0 ? EIO : errno));
}

void print_error(std::string_view what, std::string_view hint) {
  print_to_stderr(fmt::format("{} {}\n", toned("aerate: error:", Tone::error), shown(what)));
  if (hint.empty()) return;
  print_to_stderr(fmt::format("{} {}\n", toned("aerate: hint:", Tone::notice), shown(hint)));
}

void print_note(std::string_view text) {
  print_to_stderr(fmt::format("{} {}\n", toned("aerate: note:", Tone::notice), shown(text)));
}

}  // namespace aerate::cli
