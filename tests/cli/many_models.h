#pragma once

#include <chrono>
#include <filesystem>
#include <fstream>
#include <functional>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <string_view>
#include <sys/types.h>
#include <thread>
#include <vector>

#include "tests/cli/job.h"

namespace aerate::test {

namespace fs = std::filesystem;
using Json = nlohmann::json;

inline constexpr int kUsage = 2, kUnreadable = 3, kSomeNotDone = 6, kNoneDone = 7, kInterrupted = 130;

// Voids that take no time.
inline const std::vector<std::string> kQuick{"--max-voids", "2", "--tolerance", "0.3"};

class Batch {
 public:
  Batch() { fs::create_directory(models()); }

  fs::path models() const { return job_.folder() / "models"; }
  fs::path results() const { return job_.outputs(); }
  fs::path folder() const { return job_.folder(); }

  // A block of so many mm that takes voids quickly; all sizes differ in their results.
  fs::path block(const std::string& name, float height = 20) const {
    return file("models/" + name, to_binary_stl(make_box({0, 0, 0}, {20, 20, height})));
  }
  fs::path file(const std::string& name,
                std::string_view bytes) const {  // in the folder of models, manifests and all else
    fs::create_directories((folder() / name).parent_path());
    return job_.input(name, bytes);
  }

  std::vector<std::string> command(const std::vector<std::string>& arguments) const {
    std::vector<std::string> command{AERATE_EXECUTABLE, "batch", "-o", results()};
    command.insert(command.end(), kQuick.begin(), kQuick.end());
    command.insert(command.end(), arguments.begin(), arguments.end());
    return command;
  }
  ProcessResult run(const std::vector<std::string>& arguments) const { return test::run(command(arguments)); }

  Json summary() const { return Json::parse(read_bytes(results() / "summary.json")); }
  // The row of a model, by its file's name.
  Json row(const std::string& name) const {
    const Json all = summary();
    for (const Json& row : all.at("models"))
      if (fs::path(row.at("model").get<std::string>()).filename() == name) return row;
    return nullptr;
  }
  std::string result(const std::string& name) const { return read_bytes(results() / name); }

  // Of one model, as 'aerate hollow' writes it.
  std::string hollowed(const fs::path& model, std::vector<std::string> arguments = kQuick) const {
    const fs::path out = folder() / "alone.stl";
    arguments.insert(arguments.begin(), {AERATE_EXECUTABLE, "hollow", model, "-o", out, "--quiet"});
    EXPECT_EQ(test::run(arguments).exit_code, 0);
    return read_bytes(out);
  }

 private:
  Job job_;
};

// Processes of this program that are at work for a folder.
inline std::vector<pid_t> at_work_for(const fs::path& folder) {
  std::vector<pid_t> found;
  for (const auto& entry : fs::directory_iterator("/proc")) {
    const std::string name = entry.path().filename();
    if (name.find_first_not_of("0123456789") != std::string::npos) continue;
    std::ifstream file(entry.path() / "cmdline", std::ios::binary);
    std::stringstream words;
    words << file.rdbuf();
    const std::string line = words.str();
    if (line.find(AERATE_EXECUTABLE) != std::string::npos && line.find(folder.string()) != std::string::npos)
      found.push_back(std::stoi(name));
  }
  return found;
}

inline pid_t parent_of(pid_t process) {
  std::ifstream file("/proc/" + std::to_string(process) + "/status");
  for (std::string line; std::getline(file, line);)
    if (line.starts_with("PPid:")) return std::stoi(line.substr(5));
  return 0;
}

// Until something is so; fails after a minute.
inline void wait_until(const std::function<bool()>& is_so) {
  for (int i = 0; i < 6000 && !is_so(); ++i) std::this_thread::sleep_for(std::chrono::milliseconds(10));
  ASSERT_TRUE(is_so());
}

inline std::vector<std::string> temporary_files(const fs::path& folder) {
  std::vector<std::string> found;
  if (!fs::exists(folder)) return found;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    const std::string name = entry.path().filename();
    if (name.find(".aerate-") != std::string::npos && name != ".aerate-batch") found.push_back(name);
  }
  return found;
}

// Its name has the process.
inline pid_t process_that_made(const std::string& temporary_file) {
  constexpr std::string_view kMark = ".aerate-";
  return std::stoi(temporary_file.substr(temporary_file.rfind(kMark) + kMark.size()));
}

}  // namespace aerate::test
