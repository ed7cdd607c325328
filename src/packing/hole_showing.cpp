#include "packing/hole_showing.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <numbers>

#include "core/facet_distance.h"
#include "packing/hole_rules.h"

namespace aerate {
namespace {

constexpr double kFromBelow = 1.0 / 3;
constexpr double kFromBack = 0.9;

// Rays begin so far above the surface, and what is farther off than so many diameters of the hole keeps nothing off: a hole
// in a hollow of its own size is hidden, one that a far part of the model overhangs is not. Millimetres.
constexpr double kAboveSurface = 0.01;
constexpr double kFarOff = 20;

// A rim that comes nearer to the plate than this is closed by it, mm.
constexpr double kLeastAbovePlate = 0.3;

// A side of the model is where its normal is within 45 degrees of a direction.
constexpr double kSide = 0.70710678;

Vec3d back_of(Vec3d up) {
  const Vec3d side = std::abs(up.x) < 0.9 ? Vec3d{1, 0, 0} : Vec3d{0, 1, 0};
  return normalised(cross(up, side));
}

std::vector<Vec3d> all_round(Vec3d axis) {
  std::vector<Vec3d> views = directions_about(axis);
  const std::vector<Vec3d> other = directions_about(-axis);
  views.insert(views.end(), other.begin(), other.end());
  return views;
}

}  // namespace

bool opens_onto_plate(const Tube& hole, Vec3d up, double plate) {
  const double rise = dot(direction_of(hole), up);
  const double reach = hole.radius * std::sqrt(std::max(0.0, 1 - rise * rise));
  return dot(hole.end, up) - reach < plate + kLeastAbovePlate;
}

HoleShowing::HoleShowing(const TubeClearance& clearance, Vec3d up, double plate,
                         const DrainageRequest& request)
    : clearance_(clearance),
      up_(up),
      back_(back_of(up)),
      plate_(plate),
      request_(request),
      views_(all_round(up)) {}

// Where a hole comes out across an edge its side leaves the model by another face than its middle does.
std::vector<Vec3d> HoleShowing::rim_of(const Tube& hole) const {
  constexpr int kLines = 16;
  const Vec3d axis = direction_of(hole);
  const TubeFrame frame = frame_of(hole, up_);
  // From where all of the side is still within the model.
  const Vec3d inside = hole.end - axis * std::min(length(hole.end - hole.start), 2 * hole.radius);
  std::vector<Vec3d> rim;
  rim.reserve(kLines);
  for (int i = 0; i < kLines; ++i) {
    const double angle = 2 * std::numbers::pi * i / kLines;
    const Vec3d start =
        inside + (frame.down * std::cos(angle) + frame.across * std::sin(angle)) * hole.radius;
    const auto out = clearance_.first_hit(start, axis, (2 + kCutBeyond) * hole.radius);
    rim.push_back(start + axis * out.value_or(0));  // without: it is outside already
  }
  return rim;
}

bool HoleShowing::reaches_plate(const Tube& hole) const {
  if (opens_onto_plate(hole, up_, plate_)) return true;
  const double lowest = std::min(0.0, kCutBeyond * dot(direction_of(hole), up_)) - 1;
  const double highest_allowed = plate_ + kLeastAbovePlate;
  if (dot(hole.end, up_) + lowest * hole.radius >= highest_allowed) return false;
  return std::ranges::any_of(rim_of(hole), [&](Vec3d p) { return dot(p, up_) < highest_allowed; });
}

bool HoleShowing::is_on_allowed_side(Vec3d place) const {
  const HoleSides& sides = request_.sides;
  const Vec3d normal = clearance_.normal_near(place);
  const auto faces = [&](Vec3d direction) { return dot(normal, direction) >= kSide; };
  if (!sides.on.empty() && std::ranges::none_of(sides.on, faces)) return false;
  return std::ranges::none_of(sides.not_on, faces);
}

bool HoleShowing::is_allowed(const Tube& hole) const {
  return !(request_.avoids_plate && reaches_plate(hole)) && is_on_sides(hole);
}

bool HoleShowing::is_on_sides(const Tube& hole) const {
  const HoleSides& sides = request_.sides;
  if (sides.is_anywhere()) return true;
  if (!is_on_allowed_side(hole.end)) return false;
  const double height = dot(hole.end, up_);
  if (height > sides.not_above || height < sides.not_below) return false;
  if (std::ranges::any_of(sides.not_within, [&](const Box3d& box) {
        return distance_squared(box, {hole.end, hole.end}) <= hole.radius * hole.radius;
      }))
    return false;
  if (sides.on.empty() && sides.not_on.empty()) return true;
  return std::ranges::all_of(rim_of(hole), [&](Vec3d p) { return is_on_allowed_side(p); });
}

double HoleShowing::of(const Tube& hole) const {
  const Vec3d normal = clearance_.normal_near(hole.end);
  const Vec3d start = hole.end + normal * kAboveSurface;
  const double far_off = kFarOff * hole.radius;
  double seen = 0, all = 0;
  for (const Vec3d view : views_) {
    const double along = dot(view, normal);
    if (along <= 0) continue;
    const double weight = (dot(view, up_) < 0 ? kFromBelow : 1) * (dot(view, back_) > 0.5 ? kFromBack : 1);
    all += along;
    if (!clearance_.is_hit(start, view, far_off)) seen += weight * along;
  }
  return all > 0 ? seen / all : 1;
}

void describe_holes(std::vector<EscapeHole>& holes, const DrainageRequest& request,
                    const HoleShowing& showing) {
  constexpr std::size_t kNeeded = 2;
  std::map<std::uint32_t, std::size_t> count;  // by network
  for (EscapeHole& hole : holes) {
    const bool is_asked = std::ranges::any_of(request.escape_holes, [&](Vec3d place) {
      return length(hole.tube.end - place) <= 3 * hole.tube.radius;
    });
    const bool is_needed = ++count[hole.network] <= kNeeded;
    hole.shows = showing.of(hole.tube);
    if (is_asked)
      hole.purpose = HolePurpose::asked;
    else if (is_needed)
      hole.purpose = HolePurpose::drain;
    else if (hole.purpose != HolePurpose::cup)
      hole.purpose = HolePurpose::pool;
  }
}

}  // namespace aerate
