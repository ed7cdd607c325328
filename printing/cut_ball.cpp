#include "printing/cut_ball.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>

#include "kernels/constants.h"
#include "printing/star_triangulation.h"

namespace aerate {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kFewestOnRing = 12;  // keeps 95 % of the cone's volume

// Vertices nearer to the ring than this share of an edge give way to it, so that no slivers lie along it.
constexpr double kClearOfRing = 0.4;

// The ring begins at no special place of the triangulation.
constexpr double kRingPhase = 0.3106;

// What is above the ring is bent into a dome of this height, in radii: convex, so that edge flips find the
// ring, and flat enough for the ring to be on the convex hull. For that its slope at the ring, which is twice
// the height over the ring's radius, has to stay below the ball's own.
double dome_height(double ring_angle) {
  constexpr double kHighest = 0.02;
  const double slope = std::tan(ring_angle);
  return std::min(kHighest, slope * slope / 4);
}

std::size_t ring_size(double sagitta, const Roof& roof) {
  // A chord of the ring stays cosine^2 (1 - cos(pi / n)) below the cone.
  const double share = std::min(sagitta / (roof.cosine * roof.cosine), 1.0);
  return static_cast<std::size_t>(std::max(kFewestOnRing, std::ceil(kPi / std::acos(1 - share))));
}

// Edge of one of so many equilateral triangles on the unit sphere.
double edge_length(std::size_t triangles) {
  return std::sqrt(16 * kPi / (std::numbers::sqrt3 * static_cast<double>(triangles)));
}

class Cutter {
 public:
  Cutter(const BallTemplate& ball, const Roof& roof)
      : sine_(roof.sine), ring_angle_(std::acos(roof.sine)), triangulation_(bend_cap(ball), ball.triangles) {}

  bool put_in_ring(std::size_t count) {
    if (!triangulation_.connect()) return false;
    const double radius = std::sin(ring_angle_);
    for (std::size_t i = 0; i < count; ++i) {
      const double turn = 2 * kPi * (static_cast<double>(i) + kRingPhase) / static_cast<double>(count);
      const auto vertex = triangulation_.insert({radius * std::cos(turn), radius * std::sin(turn), sine_});
      if (!vertex) return false;
      ring_.push_back(*vertex);
      kinds_.push_back(Kind::ring);
    }
    triangulation_.flip_to_hull();
    return true;
  }

  // nullopt unless what is left ends exactly along the ring.
  std::optional<CutBall> lower_part() const {
    CutBall cut;
    cut.ring_count = ring_.size();
    std::vector<std::uint32_t> renumbered(kinds_.size(), kNone);
    const auto keep = [&](std::uint32_t vertex) {
      if (renumbered[vertex] == kNone) {
        renumbered[vertex] = static_cast<std::uint32_t>(cut.directions.size());
        cut.directions.push_back(triangulation_.positions()[vertex]);
      }
      return renumbered[vertex];
    };
    for (const std::uint32_t vertex : ring_) keep(vertex);
    std::size_t ring_edges = 0;
    for (std::uint32_t t = 0; t < triangulation_.triangles().size(); ++t) {
      const Triangle& triangle = triangulation_.triangles()[t];
      const auto is = [&](Kind kind) {
        return std::count_if(triangle.begin(), triangle.end(), [&](auto v) { return kinds_[v] == kind; });
      };
      if (is(Kind::below) == 0) continue;
      if (is(Kind::cap) > 0) return std::nullopt;
      cut.triangles.push_back({keep(triangle[0]), keep(triangle[1]), keep(triangle[2])});
      if (is(Kind::ring) == 2 && runs_along_ring(cut.triangles.back(), ring_.size())) ++ring_edges;
      if (!measure(t, cut)) return std::nullopt;
    }
    return ring_edges == ring_.size() && is_disc(cut) ? std::optional(std::move(cut)) : std::nullopt;
  }

 private:
  enum class Kind : std::uint8_t { below, ring, cap };

  // Moves what is above the ring, or near to it, towards the axis and down to a shallow dome.
  std::vector<Vec3d> bend_cap(const BallTemplate& ball) {
    const double margin = kClearOfRing * edge_length(ball.triangles.size());
    const double widest = ring_angle_ + margin;
    const double inner = std::max(ring_angle_ - margin, ring_angle_ / 2);
    const double dome = dome_height(ring_angle_);
    std::vector<Vec3d> bent = ball.directions;
    kinds_.assign(bent.size(), Kind::below);
    for (std::size_t v = 0; v < bent.size(); ++v) {
      const double angle = std::acos(std::clamp(bent[v].z, -1.0, 1.0));
      if (angle >= widest) continue;
      kinds_[v] = Kind::cap;
      // Seen from the centre, the dome's points must lie in the direction that they are bent to.
      const double slope = std::tan(angle * inner / widest);
      const double aside = std::hypot(bent[v].x, bent[v].y);
      const double share = slope / std::tan(ring_angle_);  // of the ring's radius, about
      const double height = sine_ * (1 + dome * (1 - share * share));
      const double scale = aside > 0 ? height * slope / aside : 0;
      bent[v] = {bent[v].x * scale, bent[v].y * scale, height};
    }
    return bent;
  }

  // From each vertex of the ring back to the one before it: the side of the triangle that will be open.
  static bool runs_along_ring(const Triangle& triangle, std::size_t count) {
    for (std::size_t k = 0; k < 3; ++k) {
      const std::size_t from = triangle[k], to = triangle[(k + 1) % 3];
      if (from < count && to < count && from == (to + 1) % count) return true;
    }
    return false;
  }

  bool measure(std::uint32_t t, CutBall& cut) const {
    const auto [a, b, c] = triangulation_.corners(t);
    const Vec3d area = cross(b - a, c - a);
    const double six_volume = dot(area, a);
    const double depth = 1 - six_volume / length(area);
    if (!(six_volume > 0) || !(depth < 1)) return false;
    cut.sagitta = std::max(cut.sagitta, depth);
    cut.volume += six_volume / 6;
    return true;
  }

  // Euler: a disc whose border is the ring. Open edges elsewhere, or a second border, give another number.
  static bool is_disc(const CutBall& cut) {
    const std::size_t vertices = cut.directions.size(), faces = cut.triangles.size();
    return 2 * vertices + 2 * faces == 3 * faces + cut.ring_count + 2;
  }

  double sine_;
  double ring_angle_;  // from the axis
  std::vector<Kind> kinds_;
  std::vector<std::uint32_t> ring_;
  StarTriangulation triangulation_;
};

}  // namespace

std::optional<CutBall> cut_ball(const BallTemplate& ball, const Roof& roof) {
  const std::size_t count = ring_size(ball.sagitta, roof);
  Cutter cutter(ball, roof);
  if (!cutter.put_in_ring(count)) return std::nullopt;
  std::optional<CutBall> cut = cutter.lower_part();
  if (cut) {
    const double chord = roof.cosine * roof.cosine * (1 - std::cos(kPi / static_cast<double>(count)));
    cut->sagitta = std::max(cut->sagitta, chord);
  }
  return cut;
}

}  // namespace aerate
