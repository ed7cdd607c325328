#pragma once

#include <memory>

namespace CLI {
class App;
}

namespace aerate::cli {

class ConfigFile;
class InterruptGuard;

// aerate hollow
class HollowCommand {
 public:
  HollowCommand(CLI::App& app, const ConfigFile& config);  // adds itself
  ~HollowCommand();
  HollowCommand(const HollowCommand&) = delete;
  HollowCommand& operator=(const HollowCommand&) = delete;

  bool chosen() const;
  void run(InterruptGuard& interrupt) const;

 private:
  struct Options;
  std::unique_ptr<Options> options_;
};

}  // namespace aerate::cli
