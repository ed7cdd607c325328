#pragma once

#include <cstddef>
#include <cstdint>

#include "kernels/vec.h"

// The places of the hexagonal packing: cells of one "hepta-sphere" of Cuba and Loaiza each, with two lattice
// spheres, four interstices, and a tetrahedral hole above and below two of these. A place's index is its
// slot; there are fewer than 2^32 of each kind (the caller's estimate refuses a larger job), so that finding
// a slot's cell takes 32-bit divisions only.

namespace aerate::kernels {

// Radii of the scheme for lattice spheres of radius 1.
inline constexpr double kInterstice = 0.154700538379251529;  // 2 / sqrt(3) - 1 (Eq. 1)
inline constexpr double kTetrahedral =
    0.224744871391589049;  // sqrt(3 / 2) - 1: the sphere that fits (not Eq. 2)

inline constexpr std::uint32_t kLatticePerCell = 2;
inline constexpr std::uint32_t kIntersticesPerCell = 4;
inline constexpr std::uint32_t kTetrahedralPerCell = 4;

struct HexagonalLattice {
  Box3d box{};
  double radius = 1;
  std::uint32_t count_x = 0, count_y = 0, count_z = 0;

  AERATE_HD std::size_t cell_count() const { return static_cast<std::size_t>(count_x) * count_y * count_z; }
  AERATE_HD bool is_odd_layer(std::uint32_t cell) const { return (cell / count_x / count_y) % 2 != 0; }

  // p0 of the paper.
  AERATE_HD Vec3d cell_position(std::uint32_t cell) const {
    const std::uint32_t row = cell / count_x, layer = row / count_y;
    const double i = static_cast<double>(cell - row * count_x);
    const double j = static_cast<double>(row - layer * count_y);
    const double k = static_cast<double>(layer);
    const bool odd = is_odd_layer(cell);
    return {box.lower.x + radius * (1 + 2 * i + (odd ? 1.0 : 0.0)),
            box.lower.y + radius * (1 + kRow * 2 * j + (odd ? kBarycentre : 0.0)),
            box.lower.z + radius * kLayer * k};
  }

  AERATE_HD Vec3d lattice_position(std::uint32_t slot) const {
    const Vec3d p0 = cell_position(slot / kLatticePerCell);
    return slot % kLatticePerCell == 0 ? p0 : p0 + Vec3d{radius, radius * kRow, 0};
  }

  // p3, p4, p5, p6 of the paper.
  AERATE_HD Vec3d interstice_position(std::uint32_t slot) const {
    const Vec3d p0 = cell_position(slot / kIntersticesPerCell);
    switch (slot % kIntersticesPerCell) {
      case 0:
        return p0 + Vec3d{0, -2 * kBarycentre * radius, 0};
      case 1:
        return p0 + Vec3d{radius, -kBarycentre * radius, 0};
      case 2:
        return p0 + Vec3d{radius, kBarycentre * radius, 0};
      default:
        return p0 + Vec3d{0, 2 * kBarycentre * radius, 0};
    }
  }

  // Above and below those interstices that have a lattice sphere of the next layers over them.
  AERATE_HD Vec3d tetrahedral_position(std::uint32_t slot) const {
    const std::uint32_t cell = slot / kTetrahedralPerCell;
    const std::uint32_t which = slot % kTetrahedralPerCell;
    const bool first = which < 2;
    const std::uint32_t interstice = is_odd_layer(cell) ? (first ? 1 : 3) : (first ? 0 : 2);
    const Vec3d base = interstice_position(cell * kIntersticesPerCell + interstice);
    return base + Vec3d{0, 0, which % 2 == 0 ? kTetrahedralHeight * radius : -kTetrahedralHeight * radius};
  }

  // For lattice spheres of radius 1:
  static constexpr double kRow = 1.732050807568877294;                // sqrt(3): distance of rows
  static constexpr double kBarycentre = 0.577350269189625765;         // 1 / sqrt(3): row to barycentre
  static constexpr double kLayer = 1.632993161855452065;              // 2 sqrt(2 / 3): pitch of layers
  static constexpr double kTetrahedralHeight = 0.408248290463863016;  // 1 / sqrt(6): layer to hole
};

// Cells whose p0 is inside the box, the odd layers' shift left aside.
inline HexagonalLattice make_hexagonal_lattice(const Box3d& box, double radius) {
  const auto steps = [](double extent, double pitch) {
    constexpr double kMost = 4294967294.0;
    return extent < 0 ? 0 : static_cast<std::uint32_t>(min_of(extent / pitch, kMost)) + 1;
  };
  HexagonalLattice lattice{box, radius, 0, 0, 0};
  lattice.count_x = steps(box.upper.x - box.lower.x - radius, 2 * radius);
  lattice.count_y = steps(box.upper.y - box.lower.y - radius, 2 * HexagonalLattice::kRow * radius);
  lattice.count_z = steps(box.upper.z - box.lower.z, HexagonalLattice::kLayer * radius);
  return lattice;
}

}  // namespace aerate::kernels
