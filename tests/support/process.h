#pragma once

#include <string>
#include <sys/types.h>
#include <utility>
#include <vector>

#include "tests/support/temporary_folder.h"

namespace aerate::test {

struct ProcessResult {
  int exit_code = -1;  // 128 + signal for a process that a signal ended
  std::string out;
  std::string err;
};

// A program that runs with nothing on its standard input. Ended with SIGKILL if it is still running at the
// end of this object's life.
class Process {
 public:
  // `environment` is added to this process's own.
  explicit Process(const std::vector<std::string>& command,
                   const std::vector<std::pair<std::string, std::string>>& environment = {});
  ~Process();
  Process(const Process&) = delete;
  Process& operator=(const Process&) = delete;

  bool running();
  void send(int signal) const;
  ProcessResult wait();

 private:
  TemporaryFolder folder_;  // for its output
  pid_t pid_ = -1;
  int status_ = 0;
  bool ended_ = false;
};

// Runs a program to its end.
ProcessResult run(const std::vector<std::string>& command,
                  const std::vector<std::pair<std::string, std::string>>& environment = {});

// Runs a program with standard error (and standard output) on a pseudo-terminal, to its end; what it wrote
// there is in `err`.
ProcessResult run_on_terminal(const std::vector<std::string>& command,
                              const std::vector<std::pair<std::string, std::string>>& environment = {});

// True if a program of this name is on the path.
bool is_installed(const std::string& program);

}  // namespace aerate::test
