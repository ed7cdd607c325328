#include "files/mesh_arrays.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <fmt/format.h>
#include <utility>
#include <vector>

#include "core/error.h"
#include "files/weld.h"

namespace aerate {
namespace {

bool is_finite(Vec3f p) {
  return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z);
}

// In millimetres.
std::vector<Vec3f> converted(std::span<const double> vertices, const std::string& name, Vec3d factor) {
  std::vector<Vec3f> positions;
  positions.reserve(vertices.size() / 3);
  for (std::size_t i = 0; i + 2 < vertices.size(); i += 3) {
    const Vec3d read{vertices[i], vertices[i + 1], vertices[i + 2]};
    const Vec3f position = to_float({read.x * factor.x, read.y * factor.y, read.z * factor.z});
    if (!is_finite(position))
      throw InputError(fmt::format("{}: vertices[{}] is ({:g}, {:g}, {:g}), which is not finite, or too "
                                   "large for single precision",
                                   name, i / 3, read.x, read.y, read.z),
                       "leave such vertices and their triangles out; check unit and scale");
    positions.push_back(position);
  }
  return positions;
}

}  // namespace

Mesh mesh_of_arrays(const MeshArrays& arrays, const std::string& name, Vec3d factor) {
  const std::size_t count = arrays.triangles.size() / 3;
  if (count == 0) throw InputError(fmt::format("{}: no triangles", name));
  if (count > kMostTriangles)
    throw InputError(fmt::format("{}: more than {} triangles", name, kMostTriangles));
  const std::vector<Vec3f> positions = converted(arrays.vertices, name, factor);
  const auto is_row = [&](std::int64_t row) { return row >= 0 && std::cmp_less(row, positions.size()); };
  Welder welder(count);
  for (std::size_t i = 0; i < count; ++i) {
    const std::array<std::int64_t, 3> t{arrays.triangles[3 * i], arrays.triangles[3 * i + 1],
                                        arrays.triangles[3 * i + 2]};
    if (!std::ranges::all_of(t, is_row))
      throw InputError(fmt::format("{}: triangles[{}] is ({}, {}, {}), and there are {} vertices", name, i,
                                   t[0], t[1], t[2], positions.size()),
                       "triangles hold rows of the vertices, counted from 0");
    const auto corner = [&](std::size_t k) { return positions[static_cast<std::size_t>(t[k])]; };
    welder.add_triangle(corner(0), corner(1), corner(2));
  }
  return std::move(welder).finish();
}

}  // namespace aerate
