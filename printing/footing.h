#pragma once

#include <cstddef>
#include <optional>
#include <utility>
#include <vector>

#include "core/mesh.h"

namespace aerate {

// What a model stands on, seen along z: a convex polygon. Millimetres.
class Footprint {
 public:
  struct Point {
    double x = 0, y = 0;
  };
  // A line along a side, with the unit vector to the inside.
  struct Edge {
    std::size_t number = 0;
    double inward_x = 0, inward_y = 0;
    double distance = 0;  // of the point that was asked about, negative outside
  };

  // Counter-clockwise, at least three, no three in a line.
  explicit Footprint(std::vector<Point> corners) : corners_(std::move(corners)) {}

  Edge nearest_edge(double x, double y) const;
  // How far inside it a point is: negative outside.
  double margin(double x, double y) const { return nearest_edge(x, y).distance; }

 private:
  std::vector<Point> corners_;
};

// The convex hull of points. Nothing if that has no area.
std::optional<Footprint> footprint_around(std::vector<Footprint::Point> points);

// The convex hull of what stands on the ground: of vertices no higher than a hundredth of the mesh's height above its lowest
// point. Nothing if that has no area (a tip or an edge). `mesh`: the outer surface
std::optional<Footprint> footprint_of(const Mesh& mesh);

// How far inside the footprint a model's centre of mass is, seen along z: the distance in mm to the nearest
// edge of the convex hull of what stands on the ground, negative outside of it. Nothing if it stands on no
// area (on a tip or an edge).
std::optional<double> footing_margin(const Mesh& mesh, Vec3d centre_of_mass);

}  // namespace aerate
