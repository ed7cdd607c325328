#pragma once

#include <cstddef>
#include <gtest/gtest.h>

#include "core/mesh.h"

namespace aerate::test {

// The same triangles in the same order, whatever the numbers of their vertices.
inline void expect_same_corners(const Mesh& a, const Mesh& b) {
  ASSERT_EQ(a.triangles.size(), b.triangles.size());
  for (std::size_t i = 0; i < a.triangles.size(); ++i) {
    for (std::size_t corner = 0; corner < 3; ++corner)
      ASSERT_EQ(a.positions[a.triangles[i][corner]], b.positions[b.triangles[i][corner]]) << "triangle " << i;
  }
}

}  // namespace aerate::test
