#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "core/mesh.h"

namespace aerate {

// Corners are numbered in 32 bits.
inline constexpr std::size_t kMostTriangles = std::numeric_limits<std::uint32_t>::max() / 3;

// Joins corners whose coordinates are equal (-0 equals 0; the bits of the first one stay). Vertices are
// numbered in order of first use. O(1) expected for each corner.
class Welder {
 public:
  // Reserves room for this many triangles of a closed mesh; more are welcome, up to kMostTriangles.
  explicit Welder(std::size_t expected_triangles);

  // Finite coordinates only.
  void add_triangle(Vec3f a, Vec3f b, Vec3f c) {
    if (waiting_ == kBlock) weld_block();
    block_[waiting_] = a;
    block_[waiting_ + 1] = b;
    block_[waiting_ + 2] = c;
    waiting_ += 3;
  }

  std::size_t triangle_count() const { return mesh_.triangles.size() + waiting_ / 3; }

  Mesh finish() &&;

 private:
  // Corners are welded in blocks that stay in the cache, in a loop that can look ahead.
  static constexpr std::size_t kBlock = 3 * 512;

  void weld_block();
  void make_room();

  Mesh mesh_;
  std::vector<Vec3f> block_;
  std::size_t waiting_ = 0;           // corners in the block
  std::vector<std::uint32_t> slots_;  // vertex numbers by hash: open addressing, at most half full
};

// The same for 3 m corners, three for each triangle.
Mesh weld(std::span<const Vec3f> corners);

// As a file gives a mesh back: corners joined, vertices numbered in order of first use.
Mesh as_read_back(const Mesh& mesh);

}  // namespace aerate
