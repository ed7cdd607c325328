#pragma once

#include <stdexcept>
#include <string>

namespace aerate {

// The process exit codes, as documented in `aerate --help` and the README.
enum class ExitCode : int {
  done = 0,
  failure = 1,            // internal or back-end failure, including an output that cannot be written
  usage = 2,              // the command line or a configuration file
  unreadable_input = 3,   // a file that is missing, empty, truncated or not what it claims to be
  unusable_mesh = 4,      // a mesh that was read but bounds no solid
  nothing_to_remove = 5,  // no void fits under these limits
  interrupted = 130,
};

// A promise that cannot be kept. `what()` names the file, what is wrong and where; `hint()` says what to try
// (it may be empty).
class Error : public std::runtime_error {
 public:
  Error(ExitCode code, const std::string& what, std::string hint = {})
      : std::runtime_error(what), code_(code), hint_(std::move(hint)) {}

  ExitCode code() const { return code_; }
  const std::string& hint() const { return hint_; }

 private:
  ExitCode code_;
  std::string hint_;
};

class FailureError : public Error {
 public:
  explicit FailureError(const std::string& what, std::string hint = {})
      : Error(ExitCode::failure, what, std::move(hint)) {}
};

class UsageError : public Error {
 public:
  explicit UsageError(const std::string& what, std::string hint = {})
      : Error(ExitCode::usage, what, std::move(hint)) {}
};

class InputError : public Error {
 public:
  explicit InputError(const std::string& what, std::string hint = {})
      : Error(ExitCode::unreadable_input, what, std::move(hint)) {}
};

class MeshError : public Error {
 public:
  explicit MeshError(const std::string& what, std::string hint = {})
      : Error(ExitCode::unusable_mesh, what, std::move(hint)) {}
};

class NothingToRemoveError : public Error {
 public:
  explicit NothingToRemoveError(const std::string& what, std::string hint = {})
      : Error(ExitCode::nothing_to_remove, what, std::move(hint)) {}
};

class InterruptedError : public Error {
 public:
  InterruptedError() : Error(ExitCode::interrupted, "interrupted; no output was written") {}
};

}  // namespace aerate
