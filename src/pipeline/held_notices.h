#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/monitor.h"

namespace aerate {

// A monitor that keeps notices back until it is known whether they hold, and passes all else on: of what was
// tried and is not taken nothing is said.
class HeldNotices final : public Monitor {
 public:
  explicit HeldNotices(Monitor& inner) : inner_(inner) {}

  void stage(std::string_view name) override { inner_.stage(name); }
  void progress(double fraction) override { inner_.progress(fraction); }
  void notice(std::string_view text) override { notices_.emplace_back(text); }
  void check_interrupted() override { inner_.check_interrupted(); }
  void temporary_file_made(const std::filesystem::path& path) override { inner_.temporary_file_made(path); }
  void temporary_file_gone(const std::filesystem::path& path) override { inner_.temporary_file_gone(path); }

  void pass_on() {
    for (const std::string& text : take()) inner_.notice(text);
  }
  // What was kept back, for who knows only later whether it holds.
  std::vector<std::string> take() { return std::exchange(notices_, {}); }

 private:
  Monitor& inner_;
  std::vector<std::string> notices_;
};

}  // namespace aerate
