#include "mesh/lost_surface.h"

#include <cstddef>
#include <tbb/parallel_for.h>
#include <vector>

#include "mesh/r2_sequence.h"

namespace aerate {
namespace {

constexpr double kSpreadPoints = 200000;

// How far beneath the surface the inside is asked for, of what is tolerated.
constexpr double kDepthShare = 0.01;

struct Sample {
  Vec3d place, beneath;
  double area;  // that it stands for
};

// Points of a square, folded into the triangle.
void add_samples(const kernels::Facet& facet, double area_each, double depth, std::vector<Sample>& samples) {
  const Vec3d a = to_double(facet.a);
  const Vec3d ab = to_double(facet.b) - a, ac = to_double(facet.c) - a;
  const Vec3d normal = cross(ab, ac);
  const double twice = length(normal);
  if (!(twice > 0)) return;
  const auto count = 1 + static_cast<std::size_t>(twice / 2 / area_each);
  for (std::size_t i = 0; i < count; ++i) {
    auto [u, v] = r2_point(i, 1.0 / 3);
    if (u + v > 1) {
      u = 1 - u;
      v = 1 - v;
    }
    const Vec3d place = a + ab * u + ac * v;
    samples.push_back({place, place - normal * (depth / twice), twice / 2 / static_cast<double>(count)});
  }
}

}  // namespace

LostSurface find_lost_surface(const Mesh& model, const SurfaceIndex& model_surface,
                              const SurfaceIndex& new_surface, double tolerated) {
  const double area = surface_area(model);
  std::vector<Sample> samples;
  samples.reserve(model.triangles.size() + static_cast<std::size_t>(kSpreadPoints));
  for (const Triangle& triangle : model.triangles)
    add_samples(facet_of(model, triangle), area / kSpreadPoints, kDepthShare * tolerated, samples);

  std::vector<Vec3d> places;
  places.reserve(samples.size());
  for (const Sample& sample : samples) places.push_back(sample.place);
  std::vector<double> distances = new_surface.distances(places);
  tbb::parallel_for(std::size_t{0}, samples.size(), [&](std::size_t i) {
    const Vec3d p = samples[i].beneath;
    const bool lost =
        new_surface.winding().winding_number(p) == 0 && model_surface.winding().winding_number(p) != 0;
    if (!lost) distances[i] = 0;
  });

  LostSurface result;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    if (distances[i] > tolerated) result.area_share += samples[i].area / area;
    if (distances[i] <= result.farthest) continue;
    result.farthest = distances[i];
    result.place = samples[i].place;
  }
  return result;
}

}  // namespace aerate
