#pragma once

#include <memory>

#include "core/error.h"

namespace CLI {
class App;
}

namespace aerate::cli {

class ConfigFile;
class InterruptGuard;

// aerate hook
class HookCommand {
 public:
  HookCommand(CLI::App& app, const ConfigFile& config);  // adds itself
  ~HookCommand();
  HookCommand(const HookCommand&) = delete;
  HookCommand& operator=(const HookCommand&) = delete;

  bool chosen() const;
  void run(InterruptGuard& interrupt) const;

  // The same error in one line, with its hint: slicers show what a failing script wrote in a dialog.
  static Error on_one_line(const Error& error);

 private:
  struct Options;
  std::unique_ptr<Options> options_;
};

}  // namespace aerate::cli
