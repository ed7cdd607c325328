#pragma once

#include <cmath>
#include <cstdint>

#include "kernels/adaptive_field.h"
#include "kernels/tally.h"
#include "kernels/triangle_bvh.h"
#include "kernels/vec.h"
#include "kernels/view.h"
#include "kernels/winding.h"

// Densest lattices of equal balls, the core of an adaptive packing whose largest radius is small against the
// model.

namespace aerate::kernels {

// Layers along one of the axes, of balls in rows along the next: hexagonal layers stacked AB (HCP) or ABC
// (FCC), or the square layers of the FCC lattice.
enum class Stacking : std::uint32_t { square, hexagonal_ab, hexagonal_abc };

struct Lattice {
  Vec3d origin{0, 0, 0};  // of point (0, 0, 0), in the axes of the lattice
  double radius = 1;      // half the distance of neighbours
  Stacking stacking = Stacking::square;
  std::uint32_t axis = 0;  // the layers' normal: 0, 1, 2 for x, y, z
  std::uint32_t count_x = 0, count_y = 0, count_z = 0;

  AERATE_HD std::size_t size() const { return static_cast<std::size_t>(count_x) * count_y * count_z; }

  AERATE_HD static Vec3d turned(Vec3d v, std::uint32_t axis) {
    if (axis == 0) return {v.y, v.z, v.x};
    if (axis == 1) return {v.z, v.x, v.y};
    return v;
  }
  AERATE_HD static Vec3d turned_back(Vec3d v, std::uint32_t axis) {
    if (axis == 0) return {v.z, v.x, v.y};
    if (axis == 1) return {v.y, v.z, v.x};
    return v;
  }

  AERATE_HD Vec3d pitch() const {
    constexpr double kSqrt2 = 1.4142135623730951;
    constexpr double kSqrt3 = 1.7320508075688772;
    constexpr double kHexagonalLayer = 1.6329931618554521;  // 2 sqrt(2/3)
    if (stacking == Stacking::square) return Vec3d{2, 2, kSqrt2} * radius;
    return Vec3d{2, kSqrt3, kHexagonalLayer} * radius;
  }

  AERATE_HD Vec3d point(std::size_t i) const {
    const auto x = static_cast<std::uint32_t>(i % count_x);
    const auto y = static_cast<std::uint32_t>(i / count_x % count_y);
    const auto z = static_cast<std::uint32_t>(i / count_x / count_y);
    const Vec3d step = pitch();
    Vec3d p{step.x * x, step.y * y, step.z * z};
    if (stacking == Stacking::square) {
      const double shift = (z % 2) * radius;
      p = p + Vec3d{shift, shift, 0};
    } else {
      const std::uint32_t layer = z % (stacking == Stacking::hexagonal_ab ? 2 : 3);
      p = p + Vec3d{((y + layer) % 2) * radius, layer * step.y / 3, 0};
    }
    return turned_back(origin + p, axis);
  }
};

// One of an endless number for each stacking and axis: the first layer, row and ball as near as they may be to the
// sides of the box, then with offsets from a sequence of low discrepancy.
inline Lattice make_lattice(const Box3d& box, double radius, double inset, Stacking stacking,
                            std::uint32_t axis, std::uint32_t round) {
  constexpr double kOffset[3] = {0.8191725133961645, 0.6710436067037893, 0.5497004779019703};
  Lattice lattice;
  lattice.radius = radius;
  lattice.stacking = stacking;
  lattice.axis = axis;
  const Vec3d lower = Lattice::turned(box.lower, lattice.axis);
  const Vec3d upper = Lattice::turned(box.upper, lattice.axis);
  const Vec3d step = lattice.pitch();
  const auto start = [&](double low, double pitch, int k) {
    const double offset = round * kOffset[k];
    return low + inset - pitch * (offset - std::floor(offset));
  };
  lattice.origin = {start(lower.x, step.x, 0), start(lower.y, step.y, 1), start(lower.z, step.z, 2)};
  const auto count = [](double length, double pitch) {
    return static_cast<std::uint32_t>(std::floor(max_of(length, 0.0) / pitch)) + 2;
  };
  lattice.count_x = count(upper.x - lattice.origin.x, step.x);
  lattice.count_y = count(upper.y - lattice.origin.y, step.y);
  lattice.count_z = count(upper.z - lattice.origin.z, step.z);
  return lattice;
}

// One of an endless number of trials: all nine combinations of stacking and axis, then again with other offsets.
inline Lattice make_lattice(const Box3d& box, double radius, double inset, std::uint32_t trial) {
  constexpr std::uint32_t kAxes[3] = {1, 0, 2};  // of those with as many places the first is taken
  return make_lattice(box, radius, inset, static_cast<Stacking>(trial % 3), kAxes[trial / 3 % 3], trial / 9);
}

struct LatticeFit {
  TriangleBvhView surface;
  WindingView winding;
  double clearance;  // that a centre needs
  Lattice lattice{};
  std::size_t first{};
  View<std::uint8_t> fits{};

  AERATE_HD void operator()(std::size_t i) const {
    const Vec3d p = lattice.point(first + i);
    fits[i] =
        winding.winding_number(p) == 1 && surface.nearest(p, clearance * clearance).facet == kNone ? 1 : 0;
  }
};

struct CountOnly {
  AERATE_HD void operator()(std::size_t, Tally) const {}
};

struct PlaceLattice {
  Lattice lattice;
  std::size_t first;
  View<const std::uint8_t> fits;
  double radius;
  View<Ball> balls;  // as many as there is room for

  AERATE_HD void operator()(std::size_t i, Tally before) const {
    if (fits[i] != 0 && before.first < balls.size) balls[before.first] = {lattice.point(first + i), radius};
  }
};

}  // namespace aerate::kernels
