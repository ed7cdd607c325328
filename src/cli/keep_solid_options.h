#pragma once

#include <CLI/CLI.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "cli/model_options.h"
#include "pipeline/region_request.h"

namespace aerate::cli {

// "box:x0,y0,z0,x1,y1,z1", "sphere:x,y,z,r", "cylinder:x0,y0,z0,x1,y1,z1,r", or else a name; nothing for a body whose
// numbers are not these, out of reach or leave it without volume.
std::optional<RegionRequest> parse_region(const std::string& text);

// --keep-solid
class KeepSolidOptions {
 public:
  explicit KeepSolidOptions(CLI::App& command);

  std::vector<RegionRequest> regions() const;
  // Mesh files among them, and what may be such.
  std::vector<NamedInput> inputs() const;

 private:
  std::vector<std::string> texts_;
};

}  // namespace aerate::cli
