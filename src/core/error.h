#pragma once

#include <stdexcept>
#include <string>
#include <utility>

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

template <ExitCode kCode>
class ErrorOf : public Error {
 public:
  explicit ErrorOf(const std::string& what, std::string hint = {}) : Error(kCode, what, std::move(hint)) {}
};

using FailureError = ErrorOf<ExitCode::failure>;
using UsageError = ErrorOf<ExitCode::usage>;
using InputError = ErrorOf<ExitCode::unreadable_input>;
using MeshError = ErrorOf<ExitCode::unusable_mesh>;
using NothingToRemoveError = ErrorOf<ExitCode::nothing_to_remove>;

class InterruptedError : public Error {
 public:
  InterruptedError() : Error(ExitCode::interrupted, "interrupted; no output was written") {}
};

}  // namespace aerate
