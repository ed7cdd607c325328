#include "pipeline/own_processes.h"

#include <algorithm>
#include <cstdlib>
#include <fmt/format.h>
#include <system_error>

#include "core/error.h"

namespace aerate {
namespace {

constexpr const char* kEnding = ".json";

// A folder that a variable of the environment names in full.
std::optional<std::filesystem::path> folder_from(const char* variable) {
  const char* value = std::getenv(variable);
  if (value == nullptr || !std::filesystem::path(value).is_absolute()) return std::nullopt;
  return value;
}

}  // namespace

std::optional<std::filesystem::path> own_processes_folder() {
  std::optional<std::filesystem::path> configuration = folder_from("XDG_CONFIG_HOME");
  if (!configuration) {
    const auto home = folder_from("HOME");
    if (!home) return std::nullopt;
    configuration = *home / ".config";
  }
  return *configuration / "aerate" / "processes";
}

std::optional<std::filesystem::path> own_process_file(const std::string& name) {
  const auto folder = own_processes_folder();
  if (!folder || name.empty()) return std::nullopt;
  std::filesystem::path file = *folder / (name + kEnding);
  std::error_code error;
  // A link that leads nowhere is there: choosing it says what is wrong.
  if (!std::filesystem::exists(std::filesystem::symlink_status(file, error))) return std::nullopt;
  return file;
}

std::vector<std::filesystem::path> own_process_files() {
  std::vector<std::filesystem::path> files;
  const auto folder = own_processes_folder();
  if (!folder) return files;
  std::error_code error;
  std::filesystem::directory_iterator entry(*folder, error);
  while (!error && entry != std::filesystem::directory_iterator()) {
    const std::filesystem::path& path = entry->path();
    if (path.extension() == kEnding && !path.filename().string().starts_with('.')) files.push_back(path);
    entry.increment(error);
  }
  if (error && error != std::errc::no_such_file_or_directory)
    throw InputError(
        fmt::format("{}: process files cannot be looked for: {}", folder->string(), error.message()));
  std::ranges::sort(files);
  return files;
}

}  // namespace aerate
