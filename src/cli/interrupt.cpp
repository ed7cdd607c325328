#include "cli/interrupt.h"

#include <array>
#include <atomic>
#include <cerrno>
#include <climits>
#include <csignal>
#include <cstring>
#include <string_view>
#include <sys/wait.h>
#include <unistd.h>

#include "core/error.h"

namespace aerate::cli {
namespace {

constexpr std::array kSignals{SIGINT, SIGTERM, SIGHUP};

// What the handler may touch: lock-free atomics and buffers of fixed size. A signal handler has no parameter
// to pass these in.
struct GuardedFile {
  std::atomic<bool> in_use{false};
  std::array<char, PATH_MAX> path{};
};
std::array<GuardedFile, InterruptGuard::kMostFiles> g_files;  // NOLINT: see above
std::atomic<int> g_signals{0};                                // NOLINT: see above
static_assert(std::atomic<int>::is_always_lock_free && std::atomic<bool>::is_always_lock_free);

// A folder takes a program: a signal handler may fork, but not walk through a folder.
void remove_abruptly(const char* path) {
  if (unlink(path) == 0 || (errno != EISDIR && errno != EPERM)) return;
  const pid_t child = fork();
  if (child == 0) {
    execl("/bin/rm", "rm", "-rf", "--", path, static_cast<char*>(nullptr));
    _exit(1);
  }
  if (child > 0) waitpid(child, nullptr, 0);
}

extern "C" void on_interrupt(int /*signal*/) {
  const int error = errno;  // of what was interrupted, which may look at it
  if (g_signals.fetch_add(1) == 0) {
    if (isatty(STDERR_FILENO) != 0) {
      constexpr std::string_view kText = "\naerate: stopping; once more to stop at once\n";
      [[maybe_unused]] const ssize_t written = write(STDERR_FILENO, kText.data(), kText.size());
    }
    errno = error;
    return;
  }
  for (GuardedFile& file : g_files) {
    if (file.in_use.load()) remove_abruptly(file.path.data());
  }
  _exit(static_cast<int>(ExitCode::interrupted));
}

}  // namespace

InterruptGuard::InterruptGuard() {
  g_signals = 0;
  struct sigaction action {};
  action.sa_handler = on_interrupt;
  action.sa_flags = SA_RESTART;
  sigemptyset(&action.sa_mask);
  for (const int signal : kSignals) {
    // A signal that was ignored when the program began (nohup) stays ignored.
    struct sigaction before {};
    sigaction(signal, nullptr, &before);
    if (before.sa_handler != SIG_IGN) sigaction(signal, &action, nullptr);
  }
}

InterruptGuard::~InterruptGuard() {
  for (const int signal : kSignals) {
    struct sigaction now {};
    sigaction(signal, nullptr, &now);
    if (now.sa_handler == on_interrupt) std::signal(signal, SIG_DFL);
  }
}

bool InterruptGuard::interrupted() const {
  return g_signals.load() > 0;
}

void InterruptGuard::guard(const std::filesystem::path& path) {
  const std::string& name = path.native();
  for (GuardedFile& file : g_files) {
    if (file.in_use.load() || name.size() >= file.path.size()) continue;
    std::memcpy(file.path.data(), name.c_str(), name.size() + 1);
    file.in_use = true;
    return;
  }
}

void InterruptGuard::release(const std::filesystem::path& path) {
  for (GuardedFile& file : g_files) {
    if (file.in_use.load() && path.native() == file.path.data()) file.in_use = false;
  }
}

}  // namespace aerate::cli
