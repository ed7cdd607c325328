#include "view/camera.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <span>
#include <vector>

namespace aerate {
namespace {

constexpr std::size_t kPlaces = 31;  // of cuts along an axis

Vec3d direction_of(CutAxis axis) {
  switch (axis) {
    case CutAxis::x:
      return {1, 0, 0};
    case CutAxis::y:
      return {0, 1, 0};
    case CutAxis::z:
      break;
  }
  return {0, 0, 1};
}

double along(Vec3d p, CutAxis axis) {
  return axis == CutAxis::x ? p.x : axis == CutAxis::y ? p.y : p.z;
}

// The axes round this one, in order.
ViewPoint across(Vec3d p, CutAxis axis) {
  return axis == CutAxis::x   ? ViewPoint{p.y, p.z}
         : axis == CutAxis::y ? ViewPoint{p.z, p.x}
                              : ViewPoint{p.x, p.y};
}

// Areas of a void's sections at evenly spaced places, added up. Each is the sum of triangles from its middle to the lines in which
// its surface meets the plane: nearly all of it where tubes open the surface.
class VoidAreas {
 public:
  VoidAreas(const Box3f& box, CutAxis axis)
      : axis_(axis),
        low_(along(to_double(box.lower), axis)),
        step_((along(to_double(box.upper), axis) - low_) / (kPlaces + 1)) {}

  void add(const std::array<Vec3d, 3>& corners, Vec3d middle) {
    if (!(step_ > 0)) return;
    std::array<double, 3> height{};
    for (std::size_t i = 0; i < 3; ++i) height[i] = (along(corners[i], axis_) - low_) / step_ - 1;
    const auto [low, high] = std::minmax({height[0], height[1], height[2]});
    const double first = std::max(std::ceil(low), 0.0);
    const double last = std::min(std::floor(high), static_cast<double>(kPlaces - 1));
    if (!(first <= last)) return;
    const ViewPoint origin = across(middle, axis_);
    for (auto place = static_cast<std::size_t>(first); place <= static_cast<std::size_t>(last); ++place)
      areas_[place] += area_at(corners, height, static_cast<double>(place), origin);
  }

  std::span<const double> areas() const { return areas_; }

 private:
  double area_at(const std::array<Vec3d, 3>& corners, const std::array<double, 3>& height, double place,
                 ViewPoint origin) const {
    std::array<ViewPoint, 2> ends{};
    for (std::size_t i = 0; i < 3; ++i) {
      const std::size_t next = (i + 1) % 3;
      const bool is_above = height[i] >= place;
      if (is_above == (height[next] >= place)) continue;
      const double share = (place - height[i]) / (height[next] - height[i]);
      const Vec3d p = corners[i] + (corners[next] - corners[i]) * share;
      const ViewPoint q = across(p, axis_);
      ends[is_above ? 1 : 0] = {q.x - origin.x, q.y - origin.y};
    }
    return 0.5 * (ends[0].x * ends[1].y - ends[0].y * ends[1].x);
  }

  CutAxis axis_;
  double low_, step_;
  std::array<double, kPlaces> areas_{};
};

}  // namespace

Cut cut_at(CutAxis axis, double share) {
  if (share <= 0) return {axis, 0, true};
  if (share >= 1) return {axis, 1, false};
  return {axis, share, axis == CutAxis::y};
}

Camera::Camera(const Box3f& box, const Cut& cut, Vec3d up) {
  const Vec3d axis = direction_of(cut.axis);
  forward_ = cut.looks_along_axis ? axis : -axis;
  const auto upright = [&](Vec3d wanted) { return wanted - forward_ * dot(wanted, forward_); };
  up_ = upright(up);
  constexpr double kLevel = 0.1;
  if (!(length(up_) > kLevel)) up_ = upright(cut.axis == CutAxis::z ? Vec3d{0, 1, 0} : Vec3d{0, 0, 1});
  up_ = normalised(up_);
  right_ = cross(forward_, up_);
  const double low = along(to_double(box.lower), cut.axis), high = along(to_double(box.upper), cut.axis);
  double place = low + cut.share * (high - low);
  // Before all of it, so that faces at its end are seen.
  constexpr double kBefore = 1e-3;
  if (cut.is_whole()) place += (cut.share <= 0 ? -kBefore : kBefore) * std::max(high - low, 1e-6);
  depth_ = cut.looks_along_axis ? place : -place;
}

Cut cut_with_most_void(const Scene& scene, std::span<const CutAxis> axes) {
  const Box3f box = bounding_box(scene.mesh);
  Cut best = cut_at(axes.empty() ? CutAxis::y : axes.front(), 0.5);
  double most = 0;
  const std::vector<SolidPart> parts = parts_of(scene, PartKind::void_surface);
  for (const CutAxis axis : axes) {
    VoidAreas areas(box, axis);
    for (std::size_t i = 0; i < parts.size(); ++i) {
      const Vec3d middle = i < scene.voids.size() ? scene.voids[i].place : Vec3d{0, 0, 0};
      for (const Triangle& t : triangles_of(scene.mesh, parts[i]))
        areas.add({to_double(scene.mesh.positions[t[0]]), to_double(scene.mesh.positions[t[1]]),
                   to_double(scene.mesh.positions[t[2]])},
                  middle);
    }
    for (std::size_t place = 0; place < kPlaces; ++place) {
      const double area = std::abs(areas.areas()[place]);
      // No other cut for what rounding makes.
      if (!(area > most * (1 + 1e-9))) continue;
      most = area;
      best = cut_at(axis, static_cast<double>(place + 1) / (kPlaces + 1));
    }
  }
  return best;
}

}  // namespace aerate
