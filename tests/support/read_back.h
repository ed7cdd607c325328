#pragma once

#include <vector>

#include "core/mesh.h"
#include "files/weld.h"

namespace aerate::test {

// As a file would give a mesh back: vertices welded and numbered in order of first use.
inline Mesh as_read_back(const Mesh& mesh) {
  std::vector<Vec3f> corners;
  for (const Triangle& t : mesh.triangles) {
    for (const std::uint32_t vertex : t) corners.push_back(mesh.positions[vertex]);
  }
  return weld(corners);
}

}  // namespace aerate::test
