#include "printing/carve_drained.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <limits>
#include <map>
#include <numbers>
#include <numeric>
#include <tbb/parallel_for.h>
#include <utility>
#include <variant>

#include "core/error.h"
#include "core/void_shape.h"
#include "printing/ball_template.h"
#include "printing/open_ball.h"
#include "printing/roof_top.h"
#include "printing/rounding.h"
#include "printing/star_triangulation.h"
#include "printing/tube_openings.h"

namespace aerate {
namespace {

// Beside an opening the surface of a ball is made of longer triangles than elsewhere. If these are too deep a
// finer template is taken, by this factor in tolerance, so many times at most.
constexpr double kFinerStep = 0.8;
constexpr int kMostSteps = 10;

// Edges of a roof's circle, in the least distances of openings from it. With 2 an opening's rim could be as
// near to the middle of an edge as its ends are.
constexpr double kEdgePerSpacing = 1.5;

// Of the circle at which the roof of a void begins. Its edges are short enough for the openings beside it, of
// which `thinnest` is the least radius.
std::size_t shoulder_sides(const Sphere& ball, const Roof& roof, double thinnest, double tolerance) {
  const double radius = ball.radius * roof.cosine;
  std::size_t sides = tube_sides(radius, tolerance / 8);
  while (2 * radius * std::sin(std::numbers::pi / static_cast<double>(sides)) >
         kEdgePerSpacing * kOpeningSpacingShare * thinnest)
    sides += 2;
  return sides;
}

// That circle, as if an upright tube came out of the ball there.
Opening shoulder_of(const Sphere& ball, const Roof& roof, std::size_t sides) {
  const Sphere smaller = shrunk(roof, ball);
  const Tube tube{smaller.centre, smaller.centre + roof.up, smaller.radius * roof.cosine};
  return {tube, TubeEnd::start, VoidShape(smaller, roof).rim(tube, TubeEnd::start, sides)};
}

// A ball with its openings, that of its roof last, and where its vertices begin in the result.
struct Part {
  std::vector<Opening> openings;
  std::optional<Tube> out_of_top;  // instead of the roof's flat top
  OpenedBall surface;
  std::size_t top_ring = 0;  // the first vertex of that tube's rim
  std::uint32_t first_vertex = 0;

  std::size_t ring_vertex_count() const {
    std::size_t count = 0;
    for (const Opening& opening : openings) count += opening.ring.size();
    return count;
  }
};

// Puts the roof on a ball that is open along its shoulder.
void close_above(Part& part, const Sphere& ball, const Roof& roof, double tolerance) {
  OpenedBall& opened = part.surface;
  const std::size_t count = part.openings.back().ring.size();
  const std::size_t first = part.ring_vertex_count() - count;
  const std::size_t rim = part.top_ring = opened.positions.size();
  const Sphere smaller = shrunk(roof, ball);
  const double tube_radius = part.out_of_top ? shrunk(*part.out_of_top).radius : 0;
  const RoofTop top = part.out_of_top ? RoofTop::flat : roof_top_of(roof, ball, tolerance);
  const double scale = smaller.radius / ball.radius;
  const double width = part.out_of_top ? tube_radius : roof.flat_radius() * scale;
  const double height = part.out_of_top ? VoidShape(smaller, roof).top_opening_height(tube_radius)
                                        : roof.top(ball.radius) * scale;
  const Vec3d middle = ball.centre + roof.up * height;
  if (top == RoofTop::apex) opened.positions.push_back(middle);
  for (std::size_t i = 0; i < count && top == RoofTop::flat; ++i) {
    const Vec3d offset = opened.positions[first + i] - ball.centre;
    const Vec3d aside = offset - roof.up * dot(offset, roof.up);
    opened.positions.push_back(middle + aside * (width / (smaller.radius * roof.cosine)));
  }
  const std::vector<Triangle> added = roof_triangles(top, first, count, rim);
  // Those of a flat top come last.
  const std::size_t of_cone = part.out_of_top ? 2 * count : added.size();
  opened.triangles.insert(opened.triangles.end(), added.begin(),
                          added.begin() + static_cast<std::ptrdiff_t>(of_cone));
}

// Small triangles may be turned over by rounding to fp32, far from the origin.
bool faces_outward_when_rounded(const OpenedBall& surface, Vec3d centre) {
  return std::all_of(surface.triangles.begin(), surface.triangles.end(), [&](const Triangle& t) {
    const Vec3d a = to_double(to_float(surface.positions[t[0]])) - centre,
                b = to_double(to_float(surface.positions[t[1]])) - centre,
                c = to_double(to_float(surface.positions[t[2]])) - centre;
    return dot(cross(b - a, c - a), a + b + c) > 0;
  });
}

// Where the ring of an opening begins among the vertices of its ball.
struct RingPlace {
  std::uint32_t ball = 0;
  std::uint32_t first = 0;
};
constexpr std::uint32_t kOnTop = std::numeric_limits<std::uint32_t>::max();  // the rim of `out_of_top`

class DrainedCarver {
 public:
  DrainedCarver(const Packing& packing, const DrainagePlan& plan, double tolerance, Monitor& monitor)
      : balls_(packing.spheres),
        roof_(packing.limits.roof),
        plan_(plan),
        tolerance_(tolerance),
        monitor_(monitor),
        parts_(balls_.size()) {
    for (const Channel& channel : plan.channels) thinnest_ = std::min(thinnest_, channel.tube.radius);
    for (const EscapeHole& hole : plan.holes) thinnest_ = std::min(thinnest_, hole.tube.radius);
    for (const Channel& channel : plan.channels) add_channel_openings(channel);
    for (const EscapeHole& hole : plan.holes)
      hole_rings_.push_back(
          add_opening(hole.from, hole.tube, TubeEnd::start, sides_of(hole.tube, tolerance_)));
    for (std::size_t i = 0; i < balls_.size(); ++i) {
      if (roof_.shapes(balls_[i].radius))
        parts_[i].openings.push_back(shoulder_of(balls_[i], roof_, sides_above(i)));
    }
  }

  Solid carve(OuterWithHoles outer) {
    open_balls();
    solid_.mesh = std::move(outer.mesh);
    solid_.parts.push_back({PartKind::outer, 0, outer.kept_triangle_count});
    solid_.close_part(PartKind::remnant);
    for (Part& part : parts_) {
      part.first_vertex = static_cast<std::uint32_t>(solid_.mesh.positions.size());
      for (const Vec3d p : part.surface.positions) solid_.mesh.positions.push_back(to_float(p));
      for (const Triangle& t : part.surface.triangles)
        add({t[0] + part.first_vertex, t[2] + part.first_vertex, t[1] + part.first_vertex});
      solid_.close_part(PartKind::void_surface);
    }
    for (std::size_t i = 0; i < plan_.channels.size(); ++i) add_channel(i);
    for (std::size_t i = 0; i < plan_.holes.size(); ++i) add_hole(hole_rings_[i], outer.holes[i]);
    drop_unused_vertices(solid_.mesh);
    return std::move(solid_);
  }

 private:
  RingPlace add_opening(std::uint32_t ball, const Tube& tube, TubeEnd end, std::size_t sides) {
    Part& part = parts_[ball];
    const RingPlace place{ball, static_cast<std::uint32_t>(part.ring_vertex_count())};
    part.openings.push_back(opening_of(tube, end, balls_[ball], roof_, sides));
    return place;
  }

  void add_channel_openings(const Channel& channel) {
    const Tube& tube = channel.tube;
    std::size_t sides = sides_of(tube, tolerance_);
    RingPlace start{channel.from, kOnTop};
    if (VoidShape(balls_[channel.from], roof_).comes_out_of_top(tube)) {
      parts_[channel.from].out_of_top = tube;
      sides = sides_above(channel.from);
    } else {
      start = add_opening(channel.from, tube, TubeEnd::start, sides);
    }
    channel_rings_.push_back(
        {start, add_opening(channel.to, tube, TubeEnd::end, sides), static_cast<std::uint32_t>(sides)});
  }

  // Sides of a roof's cone, and of the tube that comes out of it.
  std::size_t sides_above(std::size_t ball) const {
    const std::size_t sides = shoulder_sides(balls_[ball], roof_, thinnest_, tolerance_);
    const auto& tube = parts_[ball].out_of_top;
    return tube ? std::max(sides, sides_of(*tube, tolerance_)) : sides;
  }

  // Opens a ball and puts its roof on. False if that takes a finer template.
  bool make_surface(Part& part, const Sphere& ball, const StarTriangulation& whole) const {
    auto opened = open_ball(shrunk(roof_, ball), whole, part.openings);
    if (!opened || opened->nearest < ball.radius - tolerance_ + void_rounding_margin(roof_, ball))
      return false;
    part.surface = std::move(*opened);
    if (roof_.shapes(ball.radius)) close_above(part, ball, roof_, tolerance_);
    return faces_outward_when_rounded(part.surface, ball.centre);
  }

  void open_balls() {
    BallLadder ladder;
    std::vector<std::size_t> pending(balls_.size());
    std::iota(pending.begin(), pending.end(), std::size_t{0});
    double tolerance = tolerance_;
    for (int step = 0; step < kMostSteps && !pending.empty(); ++step, tolerance *= kFinerStep) {
      monitor_.check_interrupted();
      std::vector<Sphere> wanted;
      wanted.reserve(pending.size());
      for (const std::size_t i : pending) wanted.push_back(balls_[i]);
      ladder.prepare(wanted, tolerance, monitor_);
      std::map<std::size_t, StarTriangulation> connected;
      std::vector<const StarTriangulation*> templates;
      templates.reserve(pending.size());
      for (const Sphere& ball : wanted) {
        const std::size_t level = ladder.level_for(ball, tolerance);
        const auto [place, is_new] =
            connected.try_emplace(level, ladder[level].directions, ladder[level].triangles);
        if (is_new) place->second.connect();
        templates.push_back(&place->second);
      }
      std::vector<char> is_done(pending.size(), 0);
      tbb::parallel_for(std::size_t{0}, pending.size(), [&](std::size_t i) {
        const std::size_t ball = pending[i];
        is_done[i] = make_surface(parts_[ball], balls_[ball], *templates[i]) ? 1 : 0;
      });
      std::vector<std::size_t> left;
      for (std::size_t i = 0; i < pending.size(); ++i) {
        if (is_done[i] == 0) left.push_back(pending[i]);
      }
      pending = std::move(left);
    }
    if (pending.empty()) return;
    const Sphere& ball = balls_[pending.front()];
    throw FailureError(
        fmt::format("the openings of a void of radius {:f} mm near ({:f}, {:f}, {:f}) mm cannot "
                    "be meshed within a tolerance of {:f} mm",
                    ball.radius, ball.centre.x, ball.centre.y, ball.centre.z, tolerance_),
        "raise --tolerance or --gap, give a smaller --channel-diameter, or move the model "
        "nearer to the origin");
  }

  void add(Triangle t) { solid_.mesh.triangles.push_back(t); }

  void add_channel(std::size_t index) {
    const auto [start, end, sides] = channel_rings_[index];
    const Part& from = parts_[start.ball];
    const std::uint32_t a =
        from.first_vertex + (start.first == kOnTop ? static_cast<std::uint32_t>(from.top_ring) : start.first);
    const std::uint32_t b = parts_[end.ball].first_vertex + end.first;
    for (std::uint32_t i = 0; i < sides; ++i) {
      const std::uint32_t next = (i + 1) % sides;
      // The ring at the end runs the other way.
      add({a + next, a + i, b + sides - 1 - i});
      add({a + next, b + sides - 1 - i, b + sides - 1 - next});
    }
    solid_.close_part(PartKind::channel);
  }

  void add_hole(const RingPlace& ring, const OuterWithHoles::Hole& hole) {
    for (Triangle t : hole.sides) {
      for (std::uint32_t& v : t) {
        if (v >= hole.ring_base)
          v = static_cast<std::uint32_t>(v - hole.ring_base) + parts_[ring.ball].first_vertex + ring.first;
      }
      add(t);
    }
    solid_.close_part(PartKind::hole);
  }

  struct RingPair {
    RingPlace start, end;
    std::uint32_t sides;
  };
  std::span<const Sphere> balls_;
  const Roof& roof_;
  const DrainagePlan& plan_;
  double tolerance_;
  Monitor& monitor_;
  double thinnest_ = std::numeric_limits<double>::infinity();  // radius of a tube
  std::vector<Part> parts_;
  std::vector<RingPair> channel_rings_;
  std::vector<RingPlace> hole_rings_;
  Solid solid_;
};

}  // namespace

Solid carve_drained(OuterWithHoles outer, const Packing& packing, const DrainagePlan& plan,
                    Monitor& monitor) {
  DrainedCarver carver(packing, plan, outer.tolerance, monitor);
  return carver.carve(std::move(outer));
}

Solid carve_drained(const Mesh& outer, const SurfaceIndex& surface, const Packing& packing,
                    const DrainagePlan& plan, const CarveOptions& options, Monitor& monitor) {
  auto cut = cut_holes(outer, surface, packing, plan, options, monitor);
  if (const auto* uncut = std::get_if<UncutHoles>(&cut))
    throw cannot_be_cut(plan.holes[uncut->indices.front()]);
  return carve_drained(std::move(std::get<OuterWithHoles>(cut)), packing, plan, monitor);
}

}  // namespace aerate
