#include "packing/largest_places.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numeric>
#include <tbb/parallel_for.h>

#include "kernels/constants.h"
#include "kernels/roof.h"
#include "kernels/triangle_bvh.h"

namespace aerate {
namespace {

constexpr std::size_t kSteps = 48, kStarts = 32;

// Distances to the surface at points all over the model, and from the best of these to the largest balls.
class PlaceSearch {
 public:
  PlaceSearch(const SurfaceIndex& surface, Monitor& monitor)
      : surface_(surface),
        monitor_(monitor),
        lower_(surface.winding().box.lower),
        extent_(surface.winding().box.upper - lower_) {
    constexpr std::size_t kPlaces = kSteps * kSteps;
    samples_.resize(kSteps * kPlaces);
    for (std::size_t layer = 0; layer < kSteps; ++layer) {
      monitor.check_interrupted();
      tbb::parallel_for(layer * kPlaces, (layer + 1) * kPlaces, [&](std::size_t i) {
        const Vec3d p =
            lower_ + Vec3d{extent_.x * fraction(i % kSteps), extent_.y * fraction(i / kSteps % kSteps),
                           extent_.z * fraction(i / kPlaces)};
        samples_[i] = {p, clearance(p), SphereKind::adaptive};
      });
    }
  }

  // That touches the surface, and keeps its distance to what is taken.
  Sphere largest() const {
    std::vector<std::size_t> order(samples_.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::partial_sort(order.begin(), order.begin() + kStarts, order.end(), [&](std::size_t a, std::size_t b) {
      return samples_[a].radius != samples_[b].radius ? samples_[a].radius > samples_[b].radius : a < b;
    });
    std::vector<Sphere> starts;
    starts.reserve(kStarts);
    for (std::size_t i = 0; i < kStarts; ++i) starts.push_back(samples_[order[i]]);
    constexpr std::size_t kAtOnce = 4;
    for (std::size_t first = 0; first < starts.size(); first += kAtOnce) {
      monitor_.check_interrupted();
      tbb::parallel_for(first, first + kAtOnce, [&](std::size_t i) { improve(starts[i]); });
    }
    return *std::ranges::max_element(starts, {}, &Sphere::radius);
  }

  // No other comes nearer to this one than so much, measured from its centre, less its own radius.
  void take(Vec3d centre, double reach) {
    taken_.push_back({centre, reach, SphereKind::adaptive});
    for (Sphere& sample : samples_)
      sample.radius = std::min(sample.radius, std::max(length(sample.centre - centre) - reach, 0.0));
  }

 private:
  static double fraction(std::size_t step) { return (static_cast<double>(step) + 0.5) / kSteps; }

  double clearance(Vec3d p) const {
    if (surface_.winding().winding_number(p) != 1) return 0;
    double free = std::sqrt(surface_.bvh().nearest(p, kInfinity).distance_squared);
    for (const Sphere& sphere : taken_) free = std::min(free, length(p - sphere.centre) - sphere.radius);
    return std::max(free, 0.0);
  }

  // Pattern search: tries the 26 neighbours at a step that halves when none is better.
  void improve(Sphere& best) const {
    const double first_step = std::max({extent_.x, extent_.y, extent_.z}) / kSteps;
    for (double step = first_step; step > 1e-3 * first_step;) {
      Sphere next = best;
      for (int direction = 0; direction < 27; ++direction) {
        const int dx = direction % 3 - 1, dy = direction / 3 % 3 - 1, dz = direction / 9 - 1;
        const Vec3d offset{static_cast<double>(dx), static_cast<double>(dy), static_cast<double>(dz)};
        const Vec3d p = best.centre + offset * step;
        const double radius = clearance(p);
        if (radius > next.radius) next = {p, radius, SphereKind::adaptive};
      }
      if (next.radius > best.radius) {
        best = next;
      } else {
        step /= 2;
      }
    }
  }

  const SurfaceIndex& surface_;
  Monitor& monitor_;
  Vec3d lower_, extent_;
  std::vector<Sphere> samples_, taken_;
};

}  // namespace

Sphere largest_inscribed_sphere(const SurfaceIndex& surface, Monitor& monitor) {
  return PlaceSearch(surface, monitor).largest();
}

std::vector<Sphere> largest_places(const SurfaceIndex& surface, const PackingLimits& limits,
                                   const PackingStop& stop, Monitor& monitor) {
  constexpr std::size_t kMost = 100;
  std::vector<Sphere> places;
  PlaceSearch search(surface, monitor);
  const double enough =
      stop.target_density < 1 ? stop.target_density * stop.volume.value_or(kInfinity) : kInfinity;
  double volume = 0;
  while (places.size() < std::min(stop.max_count, kMost) && volume < enough) {
    Sphere place = search.largest();
    place.radius = std::min(place.radius - limits.wall, limits.max_radius);
    if (place.radius < limits.min_radius || place.radius <= 0 || limits.roof.shapes(place.radius)) break;
    // What is as far from this one as the surface is from others, less the wall.
    search.take(place.centre, place.radius + limits.gap - limits.wall);
    volume += void_volume(limits.roof, place.radius);
    places.push_back(place);
  }
  return places;
}

}  // namespace aerate
