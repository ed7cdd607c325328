#include "printing/cut_through.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <span>

#include "core/segment_distance.h"
#include "printing/cut_surface.h"
#include "printing/tube_openings.h"

namespace aerate {
namespace {

// A prism begins this much behind its ring, mm.
constexpr double kBehindRing = 0.02;

// Counter-clockwise about the tube's axis, in the plane through its middle.
std::vector<Vec3f> ring_of(const Tube& tube, std::size_t sides) {
  const TubeFrame frame = frame_of(tube, {0, 0, 1});
  const Vec3d middle = (tube.start + tube.end) * 0.5;
  const double radius = shrunk(tube).radius;
  std::vector<Vec3f> ring;
  ring.reserve(sides);
  for (std::size_t i = 0; i < sides; ++i) {
    const double angle = 2 * std::numbers::pi * static_cast<double>(i) / static_cast<double>(sides);
    ring.push_back(
        to_float(middle + (frame.down * std::cos(angle) + frame.across * std::sin(angle)) * radius));
  }
  return ring;
}

// From the ring to beyond one end of the tube.
CuttingPrism prism_to(Vec3d end, const Tube& tube, std::vector<Vec3f> ring) {
  const Vec3d middle = (tube.start + tube.end) * 0.5;
  CuttingPrism prism;
  prism.ring = std::move(ring);
  prism.axis = normalised(end - middle);
  prism.start = middle - prism.axis * kBehindRing;
  prism.length = length(end - middle) + kBehindRing + kCutBeyond * tube.radius;
  prism.radius = tube.radius;
  return prism;
}

// Of what bounds one thing, the triangles that a prism may meet: the other side of a thin wall is no nearer than the prism is
// wide, and is cut by itself.
std::vector<std::uint32_t> triangles_near(const OpenedSurface& surface, std::uint32_t bounded,
                                          const CuttingPrism& prism) {
  std::vector<std::uint32_t> near;
  for (std::uint32_t t = 0; t < surface.mesh.triangles.size(); ++t) {
    if (surface.bounds[t] != bounded) continue;
    if (distance_to_facet(axis_of(prism), facet_of(surface.mesh, surface.mesh.triangles[t])) <
        reach_of(prism))
      near.push_back(t);
  }
  return near;
}

// Puts what a cut leaves in the place of what it removes; `ring_at` says where the ring's vertices are.
template <typename RingAt>
void apply(OpenedSurface& surface, const SurfaceCut& cut, std::uint32_t bounded, const RingAt& ring_at) {
  Mesh& mesh = surface.mesh;
  const std::size_t ring_base = mesh.positions.size() + cut.new_positions.size();
  mesh.positions.insert(mesh.positions.end(), cut.new_positions.begin(), cut.new_positions.end());
  std::size_t left = 0;
  auto removed = cut.removed.begin();
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    if (removed != cut.removed.end() && *removed == t) {
      ++removed;
      continue;
    }
    mesh.triangles[left] = mesh.triangles[t];
    surface.bounds[left++] = surface.bounds[t];
  }
  mesh.triangles.resize(left);
  surface.bounds.resize(left);
  const auto add = [&](std::span<const Triangle> triangles, std::uint32_t what) {
    for (Triangle t : triangles) {
      for (std::uint32_t& v : t) {
        if (v >= ring_base) v = ring_at(v - ring_base);
      }
      mesh.triangles.push_back(t);
      surface.bounds.push_back(what);
    }
  };
  add(cut.surface, bounded);
  add(cut.sides, OpenedSurface::kHole);
}

}  // namespace

std::optional<OpenedSurface> cut_through(const OpenedSurface& surface, const Tube& tube, std::uint32_t cavity,
                                         double tolerance) {
  const std::size_t sides = sides_of(tube, tolerance);
  std::vector<Vec3f> ring = ring_of(tube, sides);
  const CuttingPrism outwards = prism_to(tube.end, tube, ring);
  std::reverse(ring.begin(), ring.end());
  const CuttingPrism inwards = prism_to(tube.start, tube, ring);

  const auto first =
      cut_surface(surface.mesh, triangles_near(surface, OpenedSurface::kOutside, outwards), outwards);
  if (!first) return std::nullopt;
  OpenedSurface opened = surface;
  const auto ring_base =
      static_cast<std::uint32_t>(surface.mesh.positions.size() + first->new_positions.size());
  apply(opened, *first, OpenedSurface::kOutside,
        [&](std::size_t i) { return static_cast<std::uint32_t>(ring_base + i); });
  opened.mesh.positions.insert(opened.mesh.positions.end(), outwards.ring.begin(), outwards.ring.end());

  const auto second = cut_surface(opened.mesh, triangles_near(opened, cavity, inwards), inwards);
  if (!second) return std::nullopt;
  // The same ring, which runs the other way.
  apply(opened, *second, cavity,
        [&](std::size_t i) { return static_cast<std::uint32_t>(ring_base + sides - 1 - i); });
  return opened;
}

}  // namespace aerate
