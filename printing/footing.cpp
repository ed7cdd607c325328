#include "printing/footing.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace aerate {
namespace {

// Scanned bases are never quite flat: what is no higher than this share of the model's height carries it, and
// at least half a usual layer, mm.
constexpr double kContactShare = 0.01;
constexpr double kLeastContact = 0.1;

// Twice the area of the triangle, positive counter-clockwise.
double turn(Footprint::Point a, Footprint::Point b, Footprint::Point c) {
  return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

// Counter-clockwise, without points along its edges (Andrew's monotone chain).
std::vector<Footprint::Point> convex_hull(std::vector<Footprint::Point> points) {
  std::sort(points.begin(), points.end(),
            [](Footprint::Point a, Footprint::Point b) { return a.x != b.x ? a.x < b.x : a.y < b.y; });
  std::vector<Footprint::Point> hull;
  const auto add_chain = [&](auto first, auto last) {
    const std::size_t start = hull.size();
    for (; first != last; ++first) {
      while (hull.size() >= start + 2 && turn(hull[hull.size() - 2], hull.back(), *first) <= 0)
        hull.pop_back();
      hull.push_back(*first);
    }
    hull.pop_back();  // the next chain begins there
  };
  if (points.size() < 3) return {};
  add_chain(points.begin(), points.end());
  add_chain(points.rbegin(), points.rend());
  return hull;
}

}  // namespace

Footprint::Edge Footprint::nearest_edge(double x, double y) const {
  Edge nearest{.distance = std::numeric_limits<double>::infinity()};
  for (std::size_t i = 0; i < corners_.size(); ++i) {
    const Footprint::Point a = corners_[i], b = corners_[(i + 1) % corners_.size()];
    const double side = std::hypot(b.x - a.x, b.y - a.y);
    const double distance = turn(a, b, {x, y}) / side;
    if (distance < nearest.distance) nearest = {i, -(b.y - a.y) / side, (b.x - a.x) / side, distance};
  }
  return nearest;
}

std::optional<Footprint> footprint_around(std::vector<Footprint::Point> points) {
  std::vector<Footprint::Point> hull = convex_hull(std::move(points));
  if (hull.size() < 3) return std::nullopt;
  return Footprint(std::move(hull));
}

std::optional<Footprint> footprint_of(const Mesh& mesh) {
  const Box3f box = bounding_box(mesh);
  const double ground = static_cast<double>(box.lower.z);
  const double contact_height =
      std::max(kLeastContact, kContactShare * (static_cast<double>(box.upper.z) - ground));
  std::vector<Footprint::Point> contact;
  for (const Triangle& triangle : mesh.triangles) {
    for (const std::uint32_t vertex : triangle) {
      const Vec3d p = to_double(mesh.positions[vertex]);
      if (p.z <= ground + contact_height) contact.push_back({p.x, p.y});
    }
  }
  return footprint_around(std::move(contact));
}

std::optional<double> footing_margin(const Mesh& mesh, Vec3d centre_of_mass) {
  const auto footprint = footprint_of(mesh);
  if (!footprint) return std::nullopt;
  return footprint->margin(centre_of_mass.x, centre_of_mass.y);
}

}  // namespace aerate
