#pragma once

#include <filesystem>
#include <initializer_list>
#include <string>
#include <sys/types.h>
#include <utility>
#include <vector>

#include "core/monitor.h"

namespace aerate {

// A folder that only this user can enter, in the system's place for temporary files; removed with everything
// in it at the end of its life. Folders that processes left there which were killed go first. Throws FailureError if it cannot be made.
class PrivateFolder {
 public:
  explicit PrivateFolder(Monitor& monitor);
  ~PrivateFolder();
  PrivateFolder(const PrivateFolder&) = delete;
  PrivateFolder& operator=(const PrivateFolder&) = delete;

  const std::filesystem::path& path() const { return path_; }

 private:
  Monitor& monitor_;
  std::filesystem::path path_;
  int lock_ = -1;  // held for as long as the folder is in use
};

struct ChildCommand {
  void add(std::initializer_list<std::string> more) { arguments.insert(arguments.end(), more); }

  std::vector<std::string> arguments;  // the program first, looked for on the path; no shell is involved
  std::vector<std::pair<std::string, std::string>> environment;  // added to this process's own
  std::filesystem::path folder;                                  // for what it prints; working folder stays
  std::vector<std::string> without = {};  // variables that it is not given: names, or "NAME_*"
  int held = -1;  // a descriptor, as of a lock, that stays open until it has ended with all it started
};

struct ChildOutcome {
  int exit_code = 0;    // 128 + signal for a process that a signal ended
  std::string printed;  // standard output and error, as they came
};

// Runs a program to its end. It reads one line "y" and then an end of file, should it ask a question. It
// leads a process group, which is killed when the monitor interrupts or this process ends, however it does. Throws FailureError if it cannot be
// started. May be called by several threads, each with a folder of its own.
ChildOutcome run_child(const ChildCommand& command, Monitor& monitor);

// What a process does with its arguments, as main; its exit status.
using CommandMain = int (*)(int argc, char* const* argv);

// Runs commands of this program in processes of their own, without loading it anew for each: they are forked from a copy of this
// process. To be made before this process has any thread but those that libraries began when they were loaded, and before it has printed anything.
class OwnCommands {
 public:
  explicit OwnCommands(CommandMain main);  // throws FailureError
  ~OwnCommands();
  OwnCommands(const OwnCommands&) = delete;
  OwnCommands& operator=(const OwnCommands&) = delete;

  // As run_child does, which see; the environment is this process's own. The program is named as the first argument, as ever.
  ChildOutcome run(const ChildCommand& command, Monitor& monitor) const;

 private:
  int requests_ = -1;
  pid_t starter_ = -1;
};

}  // namespace aerate
