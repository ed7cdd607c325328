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
  Vec3d scale{1, 1, 1};  // by which it was scaled along the axes when it was read
  Inspection inspection;
};

}  // namespace aerate
