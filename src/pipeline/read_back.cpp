#include "pipeline/read_back.h"

#include <charconv>
#include <fmt/format.h>
#include <fstream>
#include <string>
#include <string_view>
#include <vector>

#include "core/error.h"
#include "mesh/load.h"
#include "mesh/weld.h"

namespace aerate {
namespace {

// Three numbers, each after a space, and nothing else.
template <typename Number>
bool scan_three(std::string_view text, Number (&numbers)[3]) {
  for (Number& number : numbers) {
    if (text.empty() || text.front() != ' ') return false;
    const auto [end, error] = std::from_chars(text.data() + 1, text.data() + text.size(), number);
    if (error != std::errc()) return false;
    text.remove_prefix(static_cast<std::size_t>(end - text.data()));
  }
  return text.empty();
}

Mesh read_written_obj(const std::filesystem::path& path) {
  std::ifstream file(path);
  std::vector<Vec3f> positions;
  std::vector<Vec3f> corners;
  std::size_t line_number = 0;
  for (std::string line; std::getline(file, line);) {
    ++line_number;
    float coordinates[3];
    std::uint32_t indices[3];
    if (line.starts_with('v') && scan_three(std::string_view(line).substr(1), coordinates)) {
      positions.push_back({coordinates[0], coordinates[1], coordinates[2]});
    } else if (line.starts_with('f') && scan_three(std::string_view(line).substr(1), indices)) {
      for (const std::uint32_t index : indices) {
        if (index == 0 || index > positions.size())
          throw FailureError(
              fmt::format("{}: line {} names a vertex that is not there", path.string(), line_number));
        corners.push_back(positions[index - 1]);
      }
    } else if (!line.empty() && !line.starts_with('#')) {
      throw FailureError(fmt::format("{}: line {} is not what was written", path.string(), line_number));
    }
  }
  return weld(corners);
}

}  // namespace

Mesh read_back(const std::filesystem::path& path, MeshFormat format) {
  return format == MeshFormat::obj ? read_written_obj(path) : load_model(path).mesh;
}

}  // namespace aerate
