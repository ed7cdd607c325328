#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "core/mesh.h"

namespace aerate::test {

// A block on a narrow foot that holds up a long thin arm: only the block takes voids.
inline Mesh counterweight() {
  const std::vector<std::pair<float, float>> outline{{0, 0},  {10, 0},  {10, 5},   {120, 5}, {120, 8},
                                                     {10, 8}, {10, 35}, {-30, 35}, {-30, 5}, {0, 5}};
  const std::vector<Triangle> caps{{0, 1, 2}, {0, 2, 9}, {2, 3, 4}, {2, 4, 5},
                                   {9, 2, 5}, {9, 5, 8}, {5, 6, 8}, {6, 7, 8}};
  Mesh mesh;
  const auto count = static_cast<std::uint32_t>(outline.size());
  for (const float y : {0.0F, 30.0F})
    for (const auto& [x, z] : outline) mesh.positions.push_back({x, y, z});
  for (const Triangle& t : caps) {
    mesh.triangles.push_back(t);
    mesh.triangles.push_back({t[0] + count, t[2] + count, t[1] + count});
  }
  for (std::uint32_t i = 0; i < count; ++i) {
    const std::uint32_t next = (i + 1) % count;
    mesh.triangles.push_back({i, i + count, next});
    mesh.triangles.push_back({next, i + count, next + count});
  }
  return mesh;
}

}  // namespace aerate::test
