#include "tests/support/process.h"

#include <array>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <fcntl.h>
#include <pty.h>
#include <spawn.h>
#include <sstream>
#include <stdexcept>
#include <sys/wait.h>
#include <unistd.h>

#include "tests/support/files.h"

namespace aerate::test {
namespace {

using Environment = std::vector<std::pair<std::string, std::string>>;

std::vector<char*> pointers_to(std::vector<std::string>& strings) {
  std::vector<char*> pointers;
  for (std::string& string : strings) pointers.push_back(string.data());
  pointers.push_back(nullptr);
  return pointers;
}

std::vector<std::string> merged_environment(const Environment& added) {
  std::vector<std::string> variables;
  for (char** variable = environ; *variable != nullptr; ++variable) {
    const std::string text = *variable;
    const std::string name = text.substr(0, text.find('='));
    bool replaced = false;
    for (const auto& [key, value] : added) replaced = replaced || key == name;
    if (!replaced) variables.push_back(text);
  }
  for (const auto& [key, value] : added) variables.push_back(key + "=" + value);
  return variables;
}

pid_t spawn(std::vector<std::string> command, const Environment& environment,
            const posix_spawn_file_actions_t& actions) {
  std::vector<std::string> variables = merged_environment(environment);
  pid_t pid = -1;
  const int error = posix_spawnp(&pid, command.front().c_str(), &actions, nullptr,
                                 pointers_to(command).data(), pointers_to(variables).data());
  if (error != 0) throw std::runtime_error("cannot run " + command.front());
  return pid;
}

int exit_code_of(int status) {
  return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

int wait_for(pid_t pid) {
  int status = 0;
  while (waitpid(pid, &status, 0) < 0) {
    if (errno != EINTR) throw std::runtime_error("waitpid failed");
  }
  return status;
}

}  // namespace

Process::Process(const std::vector<std::string>& command, const Environment& environment) {
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  const std::string out = folder_.path() / "out";
  const std::string err = folder_.path() / "err";
  constexpr int kCreate = O_WRONLY | O_CREAT | O_TRUNC;
  posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, out.c_str(), kCreate, 0600);
  posix_spawn_file_actions_addopen(&actions, STDERR_FILENO, err.c_str(), kCreate, 0600);
  pid_ = spawn(command, environment, actions);
  posix_spawn_file_actions_destroy(&actions);
}

Process::~Process() {
  if (!running()) return;
  send(SIGKILL);
  wait_for(pid_);
}

bool Process::running() {
  if (!ended_) ended_ = waitpid(pid_, &status_, WNOHANG) == pid_;
  return !ended_;
}

void Process::send(int signal) const {
  kill(pid_, signal);
}

ProcessResult Process::wait() {
  if (!ended_) status_ = wait_for(pid_);
  ended_ = true;
  return {exit_code_of(status_), read_bytes(folder_.path() / "out"), read_bytes(folder_.path() / "err")};
}

ProcessResult run(const std::vector<std::string>& command, const Environment& environment) {
  return Process(command, environment).wait();
}

ProcessResult run_on_terminal(const std::vector<std::string>& command, const Environment& environment) {
  int controller = -1;
  int terminal = -1;
  if (openpty(&controller, &terminal, nullptr, nullptr, nullptr) != 0)
    throw std::runtime_error("cannot open a pseudo-terminal");
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_adddup2(&actions, terminal, STDOUT_FILENO);
  posix_spawn_file_actions_adddup2(&actions, terminal, STDERR_FILENO);
  posix_spawn_file_actions_addclose(&actions, controller);
  const pid_t pid = spawn(command, environment, actions);
  posix_spawn_file_actions_destroy(&actions);
  close(terminal);

  ProcessResult result;
  std::array<char, 4096> buffer{};
  // Reading fails with EIO when the last one that had the terminal open is gone.
  for (ssize_t count = 0; (count = read(controller, buffer.data(), buffer.size())) > 0;)
    result.err.append(buffer.data(), static_cast<std::size_t>(count));
  close(controller);
  result.exit_code = exit_code_of(wait_for(pid));
  return result;
}

bool is_installed(const std::string& program) {
  const char* path = std::getenv("PATH");
  std::istringstream folders(path != nullptr ? path : "");
  for (std::string folder; std::getline(folders, folder, ':');) {
    if (access((folder + "/" + program).c_str(), X_OK) == 0) return true;
  }
  return false;
}

}  // namespace aerate::test
