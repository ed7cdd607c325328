#include "batch/name_template.h"

#include <algorithm>
#include <fmt/format.h>

#include "core/error.h"

namespace aerate::batch {
namespace {

namespace fs = std::filesystem;

std::string part_called(const std::string& word, const NameParts& parts, const std::string& pattern) {
  if (word == "name") return parts.name;
  if (word == "folder") return parts.folder;
  if (word == "process") return parts.process;
  if (word == "n") return std::to_string(parts.number);
  throw UsageError(fmt::format("--name {}: '{{{}}}' stands for nothing", pattern, word),
                   "use {name}, {folder}, {process} and {n}");
}

}  // namespace

fs::path require_inside(const fs::path& name) {
  const auto leads_up = [](const fs::path& part) { return part == ".."; };
  if (name.is_absolute() || std::ranges::any_of(name, leads_up))
    throw UsageError(fmt::format("{}: the name leads out of the folder of results", name.string()),
                     "give one without '..' and without a '/' at its front");
  if (!name.has_filename() || name.stem().empty() || name.filename() == ".")
    throw UsageError(fmt::format("'{}' names no file", name.string()));
  if (name.filename().string().starts_with('.'))
    throw UsageError(fmt::format("'{}' is a hidden file's name", name.string()));
  return name.lexically_normal();
}

fs::path name_from(const std::string& pattern, const NameParts& parts) {
  std::string name;
  for (std::size_t i = 0; i < pattern.size(); ++i) {
    const std::size_t end = pattern[i] == '{' ? pattern.find('}', i) : std::string::npos;
    if (end == std::string::npos) {
      name += pattern[i];
      continue;
    }
    name += part_called(pattern.substr(i + 1, end - i - 1), parts, pattern);
    i = end;
  }
  return require_inside(name);
}

}  // namespace aerate::batch
