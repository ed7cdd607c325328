#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <functional>
#include <map>
#include <vector>

#include "core/mesh.h"

namespace aerate::test {

using IsSolid = std::function<bool(int, int, int)>;

// The surface of what is solid of a grid's boxes, outward, with joined corners. `planes`: where the grid's planes
// are along x, y and z, ascending. No two solid boxes may meet in an edge or a corner alone.
inline Mesh make_blocks(const std::array<std::vector<float>, 3>& planes, const IsSolid& is_solid) {
  Mesh mesh;
  std::map<std::array<int, 3>, std::uint32_t> known;
  const auto vertex = [&](const std::array<int, 3>& at) {
    const auto [found, is_new] = known.try_emplace(at, static_cast<std::uint32_t>(mesh.positions.size()));
    const auto along = [&](std::size_t axis) { return planes[axis][static_cast<std::size_t>(at[axis])]; };
    if (is_new) mesh.positions.push_back({along(0), along(1), along(2)});
    return found->second;
  };
  const auto count = [&](std::size_t axis) { return static_cast<int>(planes[axis].size()) - 1; };
  const auto holds = [&](const std::array<int, 3>& box) {
    for (std::size_t axis = 0; axis < 3; ++axis)
      if (box[axis] < 0 || box[axis] >= count(axis)) return false;
    return is_solid(box[0], box[1], box[2]);
  };
  const auto add_side = [&](const std::array<int, 3>& box, std::size_t axis, int side) {
    const auto corner = [&](int u, int v) {
      std::array<int, 3> at = box;
      at[axis] += side;
      at[(axis + 1) % 3] += u;
      at[(axis + 2) % 3] += v;
      return vertex(at);
    };
    const std::uint32_t a = corner(0, 0), b = corner(1, 0), c = corner(1, 1), d = corner(0, 1);
    mesh.triangles.push_back(side == 1 ? Triangle{a, b, c} : Triangle{a, c, b});
    mesh.triangles.push_back(side == 1 ? Triangle{a, c, d} : Triangle{a, d, c});
  };
  for (int z = 0; z < count(2); ++z) {
    for (int y = 0; y < count(1); ++y) {
      for (int x = 0; x < count(0); ++x) {
        const std::array<int, 3> box{x, y, z};
        if (!holds(box)) continue;
        for (std::size_t axis = 0; axis < 3; ++axis) {
          for (const int side : {0, 1}) {
            std::array<int, 3> next = box;
            next[axis] += side == 1 ? 1 : -1;
            if (!holds(next)) add_side(box, axis, side);
          }
        }
      }
    }
  }
  return mesh;
}

}  // namespace aerate::test
