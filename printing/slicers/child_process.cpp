#include "printing/slicers/child_process.h"

#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <fcntl.h>
#include <fstream>
#include <spawn.h>
#include <string_view>
#include <sys/wait.h>
#include <system_error>
#include <thread>
#include <unistd.h>

#include "core/error.h"
#include "printing/slicers/text_file.h"

namespace aerate {
namespace {

namespace fs = std::filesystem;

constexpr std::chrono::milliseconds kPollInterval{10};
constexpr mode_t kOwnerOnly = 0600;

std::vector<char*> pointers_to(std::vector<std::string>& strings) {
  std::vector<char*> pointers;
  pointers.reserve(strings.size() + 1);
  for (std::string& string : strings) pointers.push_back(string.data());
  pointers.push_back(nullptr);
  return pointers;
}

std::vector<std::string> merged_environment(const std::vector<std::pair<std::string, std::string>>& added) {
  std::vector<std::string> variables;
  for (char** variable = environ; *variable != nullptr; ++variable) {
    const std::string_view text = *variable;
    bool replaced = false;
    for (const auto& [name, value] : added) replaced = replaced || text.starts_with(name + "=");
    if (!replaced) variables.emplace_back(text);
  }
  for (const auto& [name, value] : added) variables.push_back(std::string(name).append("=").append(value));
  return variables;
}

// Starts a program that leads a process group, with its standard streams from and to these files.
pid_t spawn(std::vector<std::string> arguments, std::vector<std::string> variables, const fs::path& answers,
            const fs::path& printed) {
  const std::vector<char*> argv = pointers_to(arguments), envp = pointers_to(variables);
  posix_spawn_file_actions_t streams;
  posix_spawn_file_actions_init(&streams);
  posix_spawn_file_actions_addopen(&streams, STDIN_FILENO, answers.c_str(), O_RDONLY, 0);
  posix_spawn_file_actions_addopen(&streams, STDOUT_FILENO, printed.c_str(),
                                   O_WRONLY | O_CREAT | O_APPEND | O_TRUNC, kOwnerOnly);
  posix_spawn_file_actions_adddup2(&streams, STDOUT_FILENO, STDERR_FILENO);
  posix_spawnattr_t attributes;
  posix_spawnattr_init(&attributes);
  posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETPGROUP);
  posix_spawnattr_setpgroup(&attributes, 0);
  pid_t pid = -1;
  const int error = posix_spawnp(&pid, argv[0], &streams, &attributes, argv.data(), envp.data());
  posix_spawn_file_actions_destroy(&streams);
  posix_spawnattr_destroy(&attributes);
  if (error != 0)
    throw FailureError(arguments.front() + ": cannot be run: " + std::generic_category().message(error));
  return pid;
}

int wait_for(pid_t pid) {
  int status = 0;
  while (::waitpid(pid, &status, 0) < 0 && errno == EINTR) {
  }
  return status;
}

// Ends the child and whatever it started when it is left while running.
class RunningChild {
 public:
  RunningChild(pid_t pid, Monitor& monitor) : pid_(pid), monitor_(monitor) {}
  ~RunningChild() {
    if (ended_) return;
    ::kill(-pid_, SIGKILL);
    wait_for(pid_);
  }
  RunningChild(const RunningChild&) = delete;
  RunningChild& operator=(const RunningChild&) = delete;

  int wait() {
    int status = 0;
    for (;;) {
      const pid_t changed = ::waitpid(pid_, &status, WNOHANG);
      if (changed == pid_) break;
      if (changed < 0 && errno != EINTR) throw FailureError("a started program cannot be waited for");
      monitor_.check_interrupted();
      std::this_thread::sleep_for(kPollInterval);
    }
    ended_ = true;
    return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  }

 private:
  pid_t pid_;
  Monitor& monitor_;
  bool ended_ = false;
};

}  // namespace

PrivateFolder::PrivateFolder(Monitor& monitor) : monitor_(monitor) {
  // Not temp_directory_path, which does not say which path it could not use.
  const char* given = std::getenv("TMPDIR");
  const fs::path base = given != nullptr && *given != '\0' ? given : "/tmp";
  std::string pattern = (fs::absolute(base) / "aerate-XXXXXX").string();
  if (::mkdtemp(pattern.data()) == nullptr) {
    const int error = errno;
    throw FailureError(
        "no temporary folder can be made in " + base.string() + ": " + std::generic_category().message(error),
        "set TMPDIR to a folder with free space");
  }
  path_ = pattern;
  monitor_.temporary_file_made(path_);
}

PrivateFolder::~PrivateFolder() {
  std::error_code ignored;
  fs::remove_all(path_, ignored);
  monitor_.temporary_file_gone(path_);
}

ChildOutcome run_child(const ChildCommand& command, Monitor& monitor) {
  const fs::path answers = command.folder / "answers", printed = command.folder / "printed";
  std::ofstream(answers) << "y\n";
  RunningChild child(spawn(command.arguments, merged_environment(command.environment), answers, printed),
                     monitor);
  ChildOutcome outcome;
  outcome.exit_code = child.wait();
  outcome.printed = read_text(printed);
  return outcome;
}

}  // namespace aerate
