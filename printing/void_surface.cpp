#include "printing/void_surface.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstdint>
#include <fmt/format.h>
#include <limits>
#include <numbers>
#include <optional>
#include <tbb/parallel_for.h>

#include "core/error.h"
#include "core/upright.h"
#include "printing/rounding.h"

namespace aerate {
namespace {

// Greatest sagitta of a cut ball for the void, which then lies within the tolerance.
double allowed_sagitta(const Roof& roof, const Sphere& sphere, RoofTop top, double tolerance) {
  double rest = tolerance - void_rounding_margin(roof, sphere) -
                void_shrinkage(roof, sphere) * farthest_point(roof, sphere.radius);
  const double cone_width = sphere.radius * roof.cosine - roof.flat_radius();
  if (top == RoofTop::apex) rest -= roof.flat_radius() * roof.cosine;
  if (top == RoofTop::shoulder) rest -= 2 * cone_width / roof.sine;
  return rest / sphere.radius;
}

// Volume of a cut ball with its cone and top over that of the void.
double volume_share(const CutBall& cut, const Roof& roof, double radius) {
  const auto corners = static_cast<double>(cut.ring_count);
  const double of_circle = corners / (2 * std::numbers::pi) * std::sin(2 * std::numbers::pi / corners);
  const double shoulder = roof.shoulder(radius), wide = radius * roof.cosine, narrow = roof.flat_radius();
  const double above = std::numbers::pi / 3 *
                       (wide * wide * shoulder +
                        (roof.top(radius) - shoulder) * (wide * wide + wide * narrow + narrow * narrow));
  return (cut.volume * radius * radius * radius + of_circle * above) / void_volume(roof, radius);
}

// Writes the vertices and triangles of one void into a mesh, from the first that are its own, turned inside
// out.
class Placement {
 public:
  Placement(std::size_t first_vertex, std::size_t first_triangle, Mesh& mesh)
      : first_(static_cast<std::uint32_t>(first_vertex)),
        position_(mesh.positions.data() + first_vertex),
        triangle_(mesh.triangles.data() + first_triangle) {}

  void vertex(Vec3d p) { *position_++ = to_float(p); }
  // Counter-clockwise as seen from outside the void.
  void triangle(std::size_t a, std::size_t b, std::size_t c) {
    *triangle_++ = {number(a), number(c), number(b)};
  }

 private:
  std::uint32_t number(std::size_t vertex) const { return first_ + static_cast<std::uint32_t>(vertex); }

  std::uint32_t first_;
  Vec3f* position_;
  Triangle* triangle_;
};

void place_ball(const BallTemplate& ball, const Sphere& sphere, Placement place) {
  const double radius = sphere.radius - rounding_margin(sphere);
  for (const Vec3d& direction : ball.directions) place.vertex(sphere.centre + direction * radius);
  for (const Triangle& t : ball.triangles) place.triangle(t[0], t[1], t[2]);
}

void place_cut_ball(const VoidTemplate& chosen, const Sphere& sphere, const Roof& roof, Placement place) {
  const CutBall& cut = *chosen.cut;
  const std::size_t ring = cut.ring_count, rim = cut.directions.size();
  const UprightFrame frame(roof.up);
  const double shrunk = 1 - void_shrinkage(roof, sphere);
  const auto put = [&](double x, double y, double z) {
    place.vertex(sphere.centre + (frame.x * x + frame.y * y + frame.z * z) * shrunk);
  };
  const double top = roof.top(sphere.radius);
  const double to_rim = roof.flat_radius() / roof.cosine;  // from the ring's unit directions
  const bool is_shoulder = chosen.top == RoofTop::shoulder;
  for (std::size_t i = 0; i < cut.directions.size(); ++i) {
    const Vec3d d = cut.directions[i];
    if (is_shoulder && i < ring) {
      put(d.x * to_rim, d.y * to_rim, top);
    } else {
      put(d.x * sphere.radius, d.y * sphere.radius, d.z * sphere.radius);
    }
  }
  for (const Triangle& t : cut.triangles) place.triangle(t[0], t[1], t[2]);
  if (chosen.top == RoofTop::apex) put(0, 0, top);
  for (std::size_t i = 0; i < ring && chosen.top == RoofTop::flat; ++i)
    put(cut.directions[i].x * to_rim, cut.directions[i].y * to_rim, top);
  for (const Triangle& t : roof_triangles(chosen.top, 0, ring, rim)) place.triangle(t[0], t[1], t[2]);
}

}  // namespace

std::size_t VoidTemplate::vertex_count() const {
  if (ball != nullptr) return ball->directions.size();
  return cut->directions.size() + (top == RoofTop::flat ? cut->ring_count : top == RoofTop::apex ? 1 : 0);
}

std::size_t VoidTemplate::triangle_count() const {
  if (ball != nullptr) return ball->triangles.size();
  const std::size_t ring = cut->ring_count;
  return cut->triangles.size() + (top == RoofTop::flat   ? 3 * ring - 2
                                  : top == RoofTop::apex ? ring
                                                         : ring - 2);
}

void VoidTemplate::place(const Sphere& sphere, const Roof& roof, std::size_t first_vertex,
                         std::size_t first_triangle, Mesh& mesh) const {
  const Placement own(first_vertex, first_triangle, mesh);
  if (ball != nullptr) {
    place_ball(*ball, sphere, own);
  } else {
    place_cut_ball(*this, sphere, roof, own);
  }
}

struct VoidTemplates::Cut {
  std::optional<CutBall> made;
};

VoidTemplates::VoidTemplates(const Roof& roof) : roof_(roof), cuts_(BallLadder::kLevelCount) {}
VoidTemplates::~VoidTemplates() = default;

std::vector<VoidTemplate> VoidTemplates::choose(std::span<const Sphere> spheres, double tolerance,
                                                Monitor& monitor) {
  ladder_.prepare(spheres, tolerance, monitor);
  std::vector<VoidTemplate> chosen;
  chosen.reserve(spheres.size());
  for (const Sphere& sphere : spheres) {
    if (roof_.shapes(sphere.radius)) {
      chosen.push_back(choose_with_roof(sphere, tolerance));
    } else {
      chosen.push_back({.ball = &ladder_[ladder_.level_for(sphere, tolerance)]});
    }
  }
  return chosen;
}

VoidTemplate VoidTemplates::choose_with_roof(const Sphere& sphere, double tolerance) {
  const RoofTop top = roof_top_of(roof_, sphere, tolerance);
  const double allowed = allowed_sagitta(roof_, sphere, top, tolerance);
  if (!(allowed > 0)) throw too_many_triangles(sphere, tolerance);
  const double shrunk = 1 - void_shrinkage(roof_, sphere);
  for (std::size_t level = ladder_.level_for(sphere, tolerance); level < BallLadder::kLevelCount; ++level) {
    const CutBall* made = cut(level);
    if (made == nullptr || made->sagitta > allowed) continue;
    const double share = volume_share(*made, roof_, sphere.radius) * shrunk * shrunk * shrunk;
    if (share >= kLeastVolumeShare) return {.cut = made, .top = top};
  }
  throw too_many_triangles(sphere, tolerance);
}

const CutBall* VoidTemplates::cut(std::size_t level) {
  if (!cuts_[level]) {
    const BallTemplate* ball = ladder_.find(level);
    cuts_[level] = std::make_unique<Cut>(Cut{ball != nullptr ? cut_ball(*ball, roof_) : std::nullopt});
  }
  const std::optional<CutBall>& made = cuts_[level]->made;
  return made ? &*made : nullptr;
}

Solid assemble(Mesh outer, const Packing& packing, std::span<const VoidTemplate> templates) {
  assert(packing.spheres.size() == templates.size());
  Solid solid;
  solid.parts.reserve(1 + templates.size());
  solid.parts.push_back({PartKind::outer, 0, outer.triangles.size()});
  std::vector<std::size_t> first_vertices{outer.positions.size()};  // of the voids, and the end
  first_vertices.reserve(1 + templates.size());
  for (const VoidTemplate& chosen : templates) {
    solid.parts.push_back({PartKind::void_surface, solid.parts.back().end(), chosen.triangle_count()});
    first_vertices.push_back(first_vertices.back() + chosen.vertex_count());
  }
  const std::size_t triangle_count = solid.parts.back().end();
  if (first_vertices.back() > std::numeric_limits<std::uint32_t>::max()) {
    throw FailureError(fmt::format("the voids would take {} triangles", triangle_count),
                       "raise --tolerance, or set --max-triangles");
  }

  solid.mesh = std::move(outer);
  solid.mesh.positions.resize(first_vertices.back());
  solid.mesh.triangles.resize(triangle_count);
  const std::span<const SolidPart> voids = solid.of(PartKind::void_surface);
  tbb::parallel_for(std::size_t{0}, templates.size(), [&](std::size_t i) {
    templates[i].place(packing.spheres[i], packing.limits.roof, first_vertices[i], voids[i].first_triangle,
                       solid.mesh);
  });
  return solid;
}

}  // namespace aerate
