#include "pipeline/memory.h"

#include <algorithm>
#include <array>
#include <fmt/format.h>
#include <fstream>
#include <limits>
#include <optional>
#include <string>

namespace aerate {
namespace {

// The number after `key` in a file of "key number" lines, in the file's own unit.
std::optional<double> field_of(const std::string& path, const std::string& key) {
  std::ifstream file(path);
  for (std::string line; std::getline(file, line);) {
    if (line.starts_with(key)) return std::stod(line.substr(key.size()));
  }
  return std::nullopt;
}

constexpr double kBytesPerKilobyte = 1024;

// A file that holds one number; "max" (no limit) and anything else reads as nothing.
std::optional<double> number_in(const std::string& path) {
  std::ifstream file(path);
  double number = 0;
  if (file >> number) return number;
  return std::nullopt;
}

// What the control group and its ancestors leave, over all that this process is in. Version 2 has one line
// "0::/path", version 1 one with "memory" among its controllers.
double cgroup_headroom_bytes() {
  double headroom = std::numeric_limits<double>::infinity();
  // What the page cache holds and nobody has used lately counts as used, but is given up on demand.
  const auto consider = [&](const std::string& folder, const char* limit, const char* usage,
                            const char* reclaimable) {
    const auto most = number_in(folder + "/" + limit);
    const auto used = number_in(folder + "/" + usage);
    if (!most || !used) return;
    const double cached = field_of(folder + "/memory.stat", reclaimable).value_or(0.0);
    headroom = std::min(headroom, std::max(0.0, *most - std::max(0.0, *used - cached)));
  };
  std::ifstream groups("/proc/self/cgroup");
  for (std::string line; std::getline(groups, line);) {
    const auto first = line.find(':');
    const auto second = line.find(':', first + 1);
    if (first == std::string::npos || second == std::string::npos) continue;
    const std::string controllers = line.substr(first + 1, second - first - 1);
    const bool version_2 = controllers.empty();
    if (!version_2 && controllers.find("memory") == std::string::npos) continue;
    const std::string root = version_2 ? "/sys/fs/cgroup" : "/sys/fs/cgroup/memory";
    for (std::string path = line.substr(second + 1);; path = path.substr(0, path.rfind('/'))) {
      if (version_2) {
        consider(root + path, "memory.max", "memory.current", "inactive_file ");
      } else {
        consider(root + path, "memory.limit_in_bytes", "memory.usage_in_bytes", "total_inactive_file ");
      }
      if (path.find('/') == std::string::npos) break;
    }
  }
  return headroom;
}

}  // namespace

double available_memory_bytes() {
  const auto kilobytes = field_of("/proc/meminfo", "MemAvailable:");
  const double system = kilobytes ? *kilobytes * kBytesPerKilobyte : std::numeric_limits<double>::infinity();
  return std::min(system, cgroup_headroom_bytes());
}

double peak_memory_bytes() {
  // Not getrusage: its maximum starts from what the parent process held when it forked.
  return field_of("/proc/self/status", "VmHWM:").value_or(0.0) * kBytesPerKilobyte;
}

std::string format_bytes(double bytes) {
  constexpr std::array kUnits{"bytes", "kB", "MB", "GB", "TB", "PB", "EB"};
  std::size_t unit = 0;
  while (bytes >= 1000.0 && unit + 1 < kUnits.size()) {
    bytes /= 1000.0;
    ++unit;
  }
  return unit == 0 ? fmt::format("{:.0f} {}", bytes, kUnits[unit])
                   : fmt::format("{:.3g} {}", bytes, kUnits[unit]);
}

}  // namespace aerate
