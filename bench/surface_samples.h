#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/mesh.h"

namespace aerate::bench {

// Points spread over a surface, every part of it alike, each with the triangle it lies on.
struct SurfaceSamples {
  std::vector<Vec3d> points;
  std::vector<std::uint32_t> triangles;
  double area_each = 0;  // mm2 for which a point stands
};

// About `count` points; the same ones every time.
SurfaceSamples sample_surface(const Mesh& mesh, std::size_t count);

}  // namespace aerate::bench
