#pragma once

#include <memory>

namespace CLI {
class App;
}

namespace aerate::cli {

class InterruptGuard;

// aerate inspect
class InspectCommand {
 public:
  explicit InspectCommand(CLI::App& app);  // adds itself
  ~InspectCommand();
  InspectCommand(const InspectCommand&) = delete;
  InspectCommand& operator=(const InspectCommand&) = delete;

  bool chosen() const;
  void run(InterruptGuard& interrupt) const;

 private:
  struct Options;
  std::unique_ptr<Options> options_;
};

}  // namespace aerate::cli
