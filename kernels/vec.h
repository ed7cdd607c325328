#pragma once

#include <cmath>

#include "kernels/annotations.h"

namespace aerate {

// A point or vector in millimetres. Model data is fp32, as the file formats hold it; geometry is computed in
// fp64 (`Vec3d`), where the difference of two fp32 coordinates of similar size is exact.
template <typename T>
struct Vec3 {
  T x, y, z;

  friend AERATE_HD constexpr Vec3 operator+(Vec3 a, Vec3 b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
  friend AERATE_HD constexpr Vec3 operator-(Vec3 a, Vec3 b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
  friend AERATE_HD constexpr Vec3 operator-(Vec3 a) { return {-a.x, -a.y, -a.z}; }
  friend AERATE_HD constexpr Vec3 operator*(Vec3 a, T s) { return {a.x * s, a.y * s, a.z * s}; }
  friend AERATE_HD constexpr Vec3 operator*(T s, Vec3 a) { return a * s; }
  friend AERATE_HD constexpr bool operator==(Vec3 a, Vec3 b) {
    return a.x == b.x && a.y == b.y && a.z == b.z;
  }
};

using Vec3f = Vec3<float>;
using Vec3d = Vec3<double>;

AERATE_HD constexpr Vec3d to_double(Vec3f v) {
  return {static_cast<double>(v.x), static_cast<double>(v.y), static_cast<double>(v.z)};
}
AERATE_HD constexpr Vec3f to_float(Vec3d v) {
  return {static_cast<float>(v.x), static_cast<float>(v.y), static_cast<float>(v.z)};
}

template <typename T>
AERATE_HD constexpr T dot(Vec3<T> a, Vec3<T> b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}

template <typename T>
AERATE_HD constexpr Vec3<T> cross(Vec3<T> a, Vec3<T> b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

template <typename T>
AERATE_HD constexpr T length_squared(Vec3<T> a) {
  return dot(a, a);
}

template <typename T>
AERATE_HD inline T length(Vec3<T> a) {
  return std::sqrt(dot(a, a));
}

template <typename T>
AERATE_HD inline Vec3<T> normalised(Vec3<T> a) {
  return a * (1 / length(a));
}

// std::min and std::max are not device functions; these also fix which operand is returned for signed zeros.
template <typename T>
AERATE_HD constexpr T min_of(T a, T b) {
  return b < a ? b : a;
}
template <typename T>
AERATE_HD constexpr T max_of(T a, T b) {
  return a < b ? b : a;
}

template <typename T>
AERATE_HD constexpr Vec3<T> min_of(Vec3<T> a, Vec3<T> b) {
  return {min_of(a.x, b.x), min_of(a.y, b.y), min_of(a.z, b.z)};
}
template <typename T>
AERATE_HD constexpr Vec3<T> max_of(Vec3<T> a, Vec3<T> b) {
  return {max_of(a.x, b.x), max_of(a.y, b.y), max_of(a.z, b.z)};
}

// An axis-aligned box; empty while lower > upper.
template <typename T>
struct Box3 {
  Vec3<T> lower, upper;
};
using Box3f = Box3<float>;
using Box3d = Box3<double>;

}  // namespace aerate
