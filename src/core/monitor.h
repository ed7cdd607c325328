#pragma once

#include <filesystem>
#include <string_view>

namespace aerate {

// How a stage tells its caller what it is doing, and learns that it should stop. Passed in; there is no
// global log. The default does nothing, for tests and library use. Called from the thread that runs the
// stage.
class Monitor {
 public:
  virtual ~Monitor() = default;

  // A stage begins ("load", "pack", ...).
  virtual void stage(std::string_view /*name*/) {}

  // The share of the current stage that is done, in [0, 1].
  virtual void progress(double /*fraction*/) {}

  // Something the user should know although the job goes on, in one line without a final full stop.
  virtual void notice(std::string_view /*text*/) {}

  // Throws InterruptedError when the user has asked to stop. Stages call it between pieces of work of at most
  // a second or so; also from other threads that work for them, one at a time.
  virtual void check_interrupted() {}

  // A file exists from now on that must not outlive a process which is ended abruptly; and: it is gone, or
  // has become an output. A few at a time.
  virtual void temporary_file_made(const std::filesystem::path& /*path*/) {}
  virtual void temporary_file_gone(const std::filesystem::path& /*path*/) {}
};

}  // namespace aerate
