#include "mesh/primitives.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <numbers>
#include <utility>

namespace aerate {
namespace {

// A side of a cylinder is 7.5 degrees: its corners are 0.0022 of the radius outside.
constexpr std::uint32_t kSides = 48;
// Triangles of a ball are those of an icosahedron cut in four so often: corners are 0.0035 of the radius outside.
constexpr int kHalvings = 3;

float at_most(double x) {
  const auto rounded = static_cast<float>(x);
  return static_cast<double>(rounded) <= x ? rounded
                                           : std::nextafter(rounded, -std::numeric_limits<float>::infinity());
}

float at_least(double x) {
  return -at_most(-x);
}

// No coordinate up to this is moved further by rounding.
double rounding_at(Vec3d p, double reach) {
  const double largest = std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)}) + reach;
  return largest * static_cast<double>(std::numeric_limits<float>::epsilon());
}

// Of radius 1, by the corners.
struct UnitBall {
  std::vector<Vec3d> corners;
  std::vector<Triangle> triangles;
};

UnitBall icosahedron() {
  const double g = std::numbers::phi;
  UnitBall ball;
  for (const Vec3d p : {Vec3d{-1, g, 0}, Vec3d{1, g, 0}, Vec3d{-1, -g, 0}, Vec3d{1, -g, 0}, Vec3d{0, -1, g},
                        Vec3d{0, 1, g}, Vec3d{0, -1, -g}, Vec3d{0, 1, -g}, Vec3d{g, 0, -1}, Vec3d{g, 0, 1},
                        Vec3d{-g, 0, -1}, Vec3d{-g, 0, 1}})
    ball.corners.push_back(normalised(p));
  ball.triangles = {{0, 11, 5},  {0, 5, 1},  {0, 1, 7},  {0, 7, 10}, {0, 10, 11}, {1, 5, 9}, {5, 11, 4},
                    {11, 10, 2}, {10, 7, 6}, {7, 1, 8},  {3, 9, 4},  {3, 4, 2},   {3, 2, 6}, {3, 6, 8},
                    {3, 8, 9},   {4, 9, 5},  {2, 4, 11}, {6, 2, 10}, {8, 6, 7},   {9, 8, 1}};
  return ball;
}

UnitBall cut_in_four(const UnitBall& coarse) {
  UnitBall fine{coarse.corners, {}};
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> between;
  const auto middle = [&](std::uint32_t a, std::uint32_t b) {
    const auto [place, is_new] =
        between.try_emplace(std::minmax(a, b), static_cast<std::uint32_t>(fine.corners.size()));
    if (is_new) fine.corners.push_back(normalised(coarse.corners[a] + coarse.corners[b]));
    return place->second;
  };
  for (const auto& [a, b, c] : coarse.triangles) {
    const std::uint32_t ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
    fine.triangles.insert(fine.triangles.end(), {{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}});
  }
  return fine;
}

// How far from the centre the nearest of the planes is.
double inner_radius(const UnitBall& ball) {
  double least = 1;
  for (const auto& [a, b, c] : ball.triangles) {
    const Vec3d p = ball.corners[a];
    least = std::min(least, dot(p, normalised(cross(ball.corners[b] - p, ball.corners[c] - p))));
  }
  return least;
}

}  // namespace

Mesh box_mesh(Vec3d lower, Vec3d upper) {
  const Vec3f low{at_most(lower.x), at_most(lower.y), at_most(lower.z)};
  const Vec3f high{at_least(upper.x), at_least(upper.y), at_least(upper.z)};
  Mesh mesh;
  for (unsigned corner = 0; corner < 8; ++corner)
    mesh.positions.push_back({(corner & 1) != 0 ? high.x : low.x, (corner & 2) != 0 ? high.y : low.y,
                              (corner & 4) != 0 ? high.z : low.z});
  mesh.triangles = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                    {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
  return mesh;
}

Mesh ball_mesh(Vec3d centre, double radius) {
  UnitBall ball = icosahedron();
  for (int i = 0; i < kHalvings; ++i) ball = cut_in_four(ball);
  const double size = (radius + rounding_at(centre, radius)) / inner_radius(ball);
  Mesh mesh;
  for (const Vec3d corner : ball.corners) mesh.positions.push_back(to_float(centre + corner * size));
  mesh.triangles = std::move(ball.triangles);
  return mesh;
}

Mesh cylinder_mesh(Vec3d start, Vec3d end, double radius) {
  const Vec3d axis = normalised(end - start);
  const Vec3d other = std::abs(axis.x) < 0.7 ? Vec3d{1, 0, 0} : Vec3d{0, 1, 0};
  const Vec3d u = normalised(cross(axis, other)), v = cross(axis, u);
  const double rounding = rounding_at(start, length(end - start) + radius);
  const double size = (radius + rounding) / std::cos(std::numbers::pi / kSides);
  const std::array<Vec3d, 2> ends{start - axis * rounding, end + axis * rounding};
  Mesh mesh;
  for (const Vec3d at : ends) {
    for (std::uint32_t i = 0; i < kSides; ++i) {
      const double angle = 2 * std::numbers::pi * i / kSides;
      mesh.positions.push_back(to_float(at + (u * std::cos(angle) + v * std::sin(angle)) * size));
    }
  }
  for (std::uint32_t i = 0; i < kSides; ++i) {
    const std::uint32_t next = (i + 1) % kSides;
    mesh.triangles.insert(mesh.triangles.end(), {{i, next, next + kSides}, {i, next + kSides, i + kSides}});
    if (i == 0 || next == 0) continue;
    mesh.triangles.insert(mesh.triangles.end(), {{0, next, i}, {kSides, i + kSides, next + kSides}});
  }
  return mesh;
}

}  // namespace aerate
