#pragma once

#include <memory>

namespace CLI {
class App;
}

namespace aerate::cli {

class ConfigFile;
class InterruptGuard;

// aerate pack
class PackCommand {
 public:
  PackCommand(CLI::App& app, const ConfigFile& config);  // adds itself
  ~PackCommand();
  PackCommand(const PackCommand&) = delete;
  PackCommand& operator=(const PackCommand&) = delete;

  bool chosen() const;
  void run(InterruptGuard& interrupt) const;

 private:
  struct Options;
  std::unique_ptr<Options> options_;
};

}  // namespace aerate::cli
