#pragma once

#include <memory>

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

 private:
  struct Options;
  std::unique_ptr<Options> options_;
};

}  // namespace aerate::cli
