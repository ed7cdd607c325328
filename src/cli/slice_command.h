#pragma once

#include <memory>

namespace CLI {
class App;
}

namespace aerate::cli {

class ConfigFile;
class InterruptGuard;

// aerate slice
class SliceCommand {
 public:
  SliceCommand(CLI::App& app, const ConfigFile& config);  // adds itself
  ~SliceCommand();
  SliceCommand(const SliceCommand&) = delete;
  SliceCommand& operator=(const SliceCommand&) = delete;

  bool chosen() const;
  void run(InterruptGuard& interrupt) const;

 private:
  struct Options;
  std::unique_ptr<Options> options_;
};

}  // namespace aerate::cli
