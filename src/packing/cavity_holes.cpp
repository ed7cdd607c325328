#include "packing/cavity_holes.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <queue>
#include <tbb/parallel_for.h>
#include <tuple>

#include "core/segment_distance.h"
#include "kernels/constants.h"
#include "packing/hole_rules.h"
#include "packing/hole_showing.h"
#include "packing/tube_clearance.h"

namespace aerate {
namespace {

// Points of a cavity's surface from which holes are looked for.
constexpr std::size_t kSamples = 768;

// Rays begin this far behind the surface, mm.
constexpr double kBehindSurface = 1e-3;

// Tubes come up to the surface at either end a little steeper than they have to.
constexpr double kLeastFacing = kLeastSlope * 1.02;

// The ring in the middle of a hole is this far from the surface at least, seen along the axis, mm.
constexpr double kLeastAtRing = 0.05;
constexpr int kRingPoints = 16;

struct SurfacePoint {
  Vec3d place, normal;
};

double fraction(double x) {
  return x - std::floor(x);
}

// Points spread over the cavity's surface by area, inside its triangles (M. Roberts' R2 sequence).
std::vector<SurfacePoint> spread_over(const Mesh& mesh, const SealedCavity& cavity) {
  constexpr double kFirst = 0.7548776662466927, kSecond = 0.5698402909980532;
  std::vector<double> area_up_to;
  area_up_to.reserve(cavity.triangles.size());
  double area = 0;
  const auto doubled_normal = [&](const kernels::Facet& f) {
    return cross(to_double(f.b) - to_double(f.a), to_double(f.c) - to_double(f.a));
  };
  for (const std::uint32_t t : cavity.triangles)
    area_up_to.push_back(area += length(doubled_normal(facet_of(mesh, mesh.triangles[t]))));
  std::vector<SurfacePoint> points;
  points.reserve(kSamples);
  for (std::size_t i = 0; i < kSamples && area > 0; ++i) {
    const auto number = static_cast<double>(i);
    const auto at = std::ranges::lower_bound(area_up_to, area * (number + 0.5) / kSamples);
    const std::uint32_t t = cavity.triangles[static_cast<std::size_t>(at - area_up_to.begin())];
    const kernels::Facet facet = facet_of(mesh, mesh.triangles[t]);
    const Vec3d a = to_double(facet.a), b = to_double(facet.b), c = to_double(facet.c);
    double u = fraction(0.5 + kFirst * number), v = fraction(0.5 + kSecond * number);
    if (u + v > 1) std::tie(u, v) = std::pair(1 - u, 1 - v);
    points.push_back({a + (b - a) * u + (c - a) * v, normalised(doubled_normal(facet))});
  }
  return points;
}

struct Candidate {
  Tube tube;
  double cost = 0;  // what it is at least, or what it is once it is known how much it shows
  double shows = 0;
  bool is_looked_at = false;
};

class CavityPlaces {
 public:
  // `clearance`: of the model alone.
  CavityPlaces(const DrainableModel& model, const TubeClearance& clearance, const DrainageRequest& request,
               const PackingLimits& limits)
      : model_(model),
        request_(request),
        limits_(limits),
        clearance_(clearance),
        showing_(clearance, limits.roof.up, model.plate, request) {}

  // All tubes that lead out as they should at both ends, in no order.
  std::vector<Candidate> candidates(const std::vector<SurfacePoint>& points, Vec3d down,
                                    double longest) const {
    std::vector<Vec3d> directions = directions_about(down);
    directions.insert(directions.begin(), down);  // its place is that of each point's own
    std::vector<std::vector<Candidate>> found(points.size());
    double lowest = kInfinity;
    for (const SurfacePoint& point : points) lowest = std::min(lowest, dot(point.place, -down));
    tbb::parallel_for(std::size_t{0}, points.size(), [&](std::size_t i) {
      for (std::size_t d = 0; d < directions.size(); ++d) {
        const Vec3d direction = d == 0 ? -points[i].normal : directions[d];
        const auto tube = tube_from(points[i], direction, longest);
        if (!tube) continue;
        const double cost = sill_of(*tube, -down) - lowest + kLengthWeight * length(tube->end - tube->start);
        found[i].push_back({*tube, cost, 0, false});
      }
    });
    std::vector<Candidate> all;
    for (const std::vector<Candidate>& of_point : found)
      all.insert(all.end(), of_point.begin(), of_point.end());
    return all;
  }

  double showing_of(const Tube& tube) const { return showing_.of(tube); }

  // Everything else that is asked of a hole but that it can be cut.
  bool is_sound(const Tube& tube, std::span<const CavityHole> others) const {
    const Vec3d middle = (tube.start + tube.end) * 0.5;
    const Tube out{middle, tube.end, tube.radius}, in{middle, tube.start, tube.radius};
    return showing_.is_allowed(tube) && is_bridged(tube, limits_.roof) && keeps_gap_to(others, tube) &&
           leads_outside(out, limits_.wall, clearance_, model_.outward) && leads_into_air(in) &&
           clearance_.keeps_wall_on_way_out(out, kLeastSlope) &&
           clearance_.keeps_wall_on_way_out(in, kLeastSlope) && is_walled_in(tube);
  }

 private:
  std::optional<Tube> tube_from(const SurfacePoint& point, Vec3d direction, double longest) const {
    if (dot(point.normal, direction) > -kLeastFacing) return std::nullopt;
    const Vec3d behind = point.place + direction * kBehindSurface;
    const auto hit = clearance_.first_hit(behind, direction, longest);
    if (!hit) return std::nullopt;
    const Vec3d end = behind + direction * *hit;
    if (dot(clearance_.normal_near(end), direction) < kLeastFacing) return std::nullopt;
    return Tube{point.place, end, request_.hole_radius};
  }

  // What liquid in the cavity has to rise to, to run out.
  static double sill_of(const Tube& tube, Vec3d up) {
    const double rise = dot(direction_of(tube), up);
    const double below_axis = tube.radius * std::sqrt(std::max(0.0, 1 - rise * rise));
    return std::max(dot(tube.start, up), dot(tube.end, up)) - below_axis;
  }

  bool keeps_gap_to(std::span<const CavityHole> others, const Tube& tube) const {
    return std::ranges::all_of(others, [&](const CavityHole& other) {
      const Tube& t = other.tube;
      return distance_between({t.start, t.end}, {tube.start, tube.end}) >=
             t.radius + tube.radius + limits_.gap;
    });
  }

  // Is there room beyond the end of the half that leads into the cavity, as outside?
  bool leads_into_air(const Tube& in) const {
    const Vec3d axis = direction_of(in);
    for (const double beyond : {in.radius, 2 * in.radius}) {
      const Vec3d p = in.end + axis * beyond;
      if (clearance_.to_surface(p, beyond) < kLeastSlope * beyond / 2) return false;
      if (model_.surface.winding().winding_number(p) != 0) return false;
    }
    return true;
  }

  // Is there solid material all round in the middle, with surface on either side of it?
  bool is_walled_in(const Tube& tube) const {
    const TubeFrame frame = frame_of(tube, limits_.roof.up);
    const Vec3d middle = (tube.start + tube.end) * 0.5;
    const double farthest = length(tube.end - tube.start) / 2 + kCutBeyond * tube.radius;
    for (int i = 0; i < kRingPoints; ++i) {
      const double angle = 2 * std::numbers::pi * i / kRingPoints;
      const Vec3d p = middle + (frame.down * std::cos(angle) + frame.across * std::sin(angle)) * tube.radius;
      if (model_.surface.winding().winding_number(p) < 1) return false;
      for (const Vec3d along : {frame.axis, -frame.axis}) {
        const auto hit = clearance_.first_hit(p, along, farthest);
        if (!hit || *hit < kLeastAtRing) return false;
      }
    }
    return true;
  }

  const DrainableModel& model_;
  const DrainageRequest& request_;
  const PackingLimits& limits_;
  const TubeClearance& clearance_;
  HoleShowing showing_;
};

}  // namespace

std::optional<CavityHole> find_cavity_hole(const Mesh& mesh, const DrainableModel& model,
                                           const SealedCavity& cavity, std::uint32_t number,
                                           const DrainageRequest& request, const PackingLimits& limits,
                                           Vec3d down, std::span<const CavityHole> others,
                                           const CanCutThrough& can_cut) {
  const TubeClearance clearance(model.surface, Packing{{}, limits, {}, {}}, 0, request.hole_radius,
                                model.kept);
  const CavityPlaces places(model, clearance, request, limits);
  const std::vector<SurfacePoint> points = spread_over(mesh, cavity);
  double lowest = kInfinity, highest = -kInfinity;
  for (const SurfacePoint& point : points) {
    lowest = std::min(lowest, dot(point.place, down));
    highest = std::max(highest, dot(point.place, down));
  }
  const Box3f box = bounding_box(mesh);
  std::vector<Candidate> candidates =
      places.candidates(points, down, length(to_double(box.upper) - to_double(box.lower)));
  using Entry = std::pair<double, std::size_t>;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue;
  for (std::size_t i = 0; i < candidates.size(); ++i) queue.emplace(candidates[i].cost, i);
  while (!queue.empty()) {
    const std::size_t i = queue.top().second;
    queue.pop();
    Candidate& candidate = candidates[i];
    if (!candidate.is_looked_at) {
      if (!places.is_sound(candidate.tube, others)) continue;
      candidate.is_looked_at = true;
      candidate.shows = places.showing_of(candidate.tube);
      candidate.cost += request.worth_of_hiding * (highest - lowest) * candidate.shows;
      queue.emplace(candidate.cost, i);
      continue;
    }
    const CavityHole hole{number, candidate.tube, candidate.shows};
    if (can_cut(hole)) return hole;
  }
  return std::nullopt;
}

}  // namespace aerate
