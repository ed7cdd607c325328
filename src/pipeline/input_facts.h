#pragma once

#include <cstddef>
#include <filesystem>
#include <string>

#include "mesh/inspect.h"

namespace aerate {

// A model as it came from its file.
struct InputFacts {
  std::filesystem::path path;
  std::string format;
  std::size_t part_count = 1;
  Inspection inspection;
};

}  // namespace aerate
