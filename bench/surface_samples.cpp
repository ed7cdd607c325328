#include "bench/surface_samples.h"

#include <cmath>

namespace aerate::bench {

SurfaceSamples sample_surface(const Mesh& mesh, std::size_t count) {
  SurfaceSamples samples;
  samples.area_each = surface_area(mesh) / static_cast<double>(count);
  double area_due = samples.area_each / 2;
  double u = 0.5, v = 0.5;
  for (std::uint32_t i = 0; i < mesh.triangles.size(); ++i) {
    const Triangle& t = mesh.triangles[i];
    const Vec3d a = to_double(mesh.positions[t[0]]);
    const Vec3d ab = to_double(mesh.positions[t[1]]) - a, ac = to_double(mesh.positions[t[2]]) - a;
    area_due -= length(cross(ab, ac)) / 2;
    for (; area_due < 0; area_due += samples.area_each) {
      // The plastic-number sequence fills the unit square evenly; its upper half is folded down.
      u = std::fmod(u + 0.7548776662466927, 1.0);
      v = std::fmod(v + 0.5698402909980532, 1.0);
      samples.points.push_back(u + v <= 1 ? a + ab * u + ac * v : a + ab * (1 - u) + ac * (1 - v));
      samples.triangles.push_back(i);
    }
  }
  return samples;
}

}  // namespace aerate::bench
