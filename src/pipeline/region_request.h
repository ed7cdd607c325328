#pragma once

#include <filesystem>
#include <string>
#include <variant>

#include "kernels/vec.h"

namespace aerate {

struct BallRegion {
  Vec3d centre;
  double radius = 0;
};

// About the axis from `start` to `end`.
struct CylinderRegion {
  Vec3d start, end;
  double radius = 0;
};

// The name of a modifier in the model's file, or else a mesh file.
using NamedRegion = std::filesystem::path;

// A region that is to stay solid, as it was asked for; mm, in the model's coordinates.
struct RegionRequest {
  std::string text;  // as the user gave it, for messages
  std::variant<NamedRegion, Box3d, BallRegion, CylinderRegion> shape;
};

}  // namespace aerate
