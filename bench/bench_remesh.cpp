// Where a model is far from its remeshed surface, and what lies there.
//
// The voxel size is in mm.
//
// A place counts as far if it is more than two voxels from the remeshed surface. Rays from it, on the side
// where the model is not, tell how much of the surroundings is in view, and how wide the space in front of it
// is.

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <fmt/core.h>
#include <map>
#include <numbers>
#include <numeric>
#include <set>
#include <string>
#include <tuple>
#include <vector>

#include "bench/benchmark.h"
#include "bench/surface_samples.h"
#include "core/mesh.h"
#include "files/load.h"
#include "kernels/constants.h"
#include "kernels/triangle_bvh.h"
#include "kernels/winding.h"
#include "printing/remesh.h"

namespace aerate::bench {
namespace {

constexpr double kFarVoxels = 2;
constexpr double kStep = 0.01;  // mm off the surface, where rays begin
constexpr int kRays = 128;      // over the whole sphere; half of them are used

// What one sample sees.
struct View {
  int winding = 0;           // of the side that its triangle faces: 0 is outside of the model
  double escaping = 0;       // share of rays that leave the model's box
  double width = kInfinity;  // distance to the surface opposite, along the normal
};

struct FarSample {
  Vec3d point{0, 0, 0};
  std::uint32_t triangle = 0;
  double distance = 0;
  View view;
};

class Surroundings {
 public:
  explicit Surroundings(const Mesh& mesh)
      : bvh_(mesh.positions, mesh.triangles),
        winding_(mesh.positions, mesh.triangles),
        box_{to_double(bounding_box(mesh).lower), to_double(bounding_box(mesh).upper)} {}

  View look(Vec3d point, Vec3d normal) const {
    View view;
    const Vec3d start = point + normal * kStep;
    view.winding = winding_.view().winding_number(start);
    view.width = first_hit(start, normal);
    int rays = 0, escaped = 0;
    for (int i = 0; i < kRays; ++i) {
      // Even over the sphere: the golden angle from one to the next.
      const double z = 1 - (2 * i + 1.0) / kRays;
      const double angle = i * std::numbers::pi * (3 - std::sqrt(5.0));
      const double r = std::sqrt(1 - z * z);
      const Vec3d direction{r * std::cos(angle), r * std::sin(angle), z};
      if (dot(direction, normal) < 0.1) continue;
      ++rays;
      if (first_hit(start, direction) == kInfinity) ++escaped;
    }
    view.escaping = static_cast<double>(escaped) / rays;
    return view;
  }

 private:
  // Distance along a ray to the surface, by steps as long as the surface is away; infinite if it leaves the
  // box.
  double first_hit(Vec3d start, Vec3d direction) const {
    constexpr double kTouching = kStep / 5;
    double along = 0;
    for (int step = 0; step < 1000; ++step) {
      const Vec3d p = start + direction * along;
      if (p.x < box_.lower.x || p.y < box_.lower.y || p.z < box_.lower.z || p.x > box_.upper.x ||
          p.y > box_.upper.y || p.z > box_.upper.z)
        return kInfinity;
      const double distance = std::sqrt(bvh_.view().nearest(p, kInfinity).distance_squared);
      if (distance < kTouching) break;
      along += distance;
    }
    return along;
  }

  kernels::HostTriangleBvh bvh_;
  kernels::HostWinding winding_;
  Box3d box_;
};

Vec3d normal_of(const Mesh& mesh, std::uint32_t triangle) {
  const Triangle& t = mesh.triangles[triangle];
  const Vec3d a = to_double(mesh.positions[t[0]]);
  const Vec3d normal = cross(to_double(mesh.positions[t[1]]) - a, to_double(mesh.positions[t[2]]) - a);
  return normal * (1 / length(normal));
}

// Groups of samples whose cells of side `reach` touch, the one with the largest distance first.
std::vector<std::vector<FarSample>> group(const std::vector<FarSample>& samples, double reach) {
  using Cell = std::tuple<int, int, int>;
  std::map<Cell, std::vector<std::size_t>> cells;
  const auto coordinate = [reach](double x) { return static_cast<int>(std::floor(x / reach)); };
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const Vec3d p = samples[i].point;
    cells[{coordinate(p.x), coordinate(p.y), coordinate(p.z)}].push_back(i);
  }
  std::vector<std::vector<FarSample>> groups;
  while (!cells.empty()) {
    std::vector<Cell> waiting{cells.begin()->first};
    std::vector<FarSample> members;
    while (!waiting.empty()) {
      const auto [x, y, z] = waiting.back();
      waiting.pop_back();
      const auto found = cells.find({x, y, z});
      if (found == cells.end()) continue;
      for (const std::size_t i : found->second) members.push_back(samples[i]);
      cells.erase(found);
      for (int n = 0; n < 27; ++n) waiting.emplace_back(x + n % 3 - 1, y + n / 3 % 3 - 1, z + n / 9 - 1);
    }
    groups.push_back(std::move(members));
  }
  const auto largest = [](const std::vector<FarSample>& g) {
    double distance = 0;
    for (const FarSample& sample : g) distance = std::max(distance, sample.distance);
    return distance;
  };
  std::stable_sort(groups.begin(), groups.end(),
                   [&](const auto& a, const auto& b) { return largest(a) > largest(b); });
  return groups;
}

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

void print_group(const std::vector<FarSample>& members, double area_each) {
  FarSample farthest;
  std::vector<double> widths, escaping;
  std::set<std::uint32_t> triangles;
  int inside = 0;
  for (const FarSample& sample : members) {
    triangles.insert(sample.triangle);
    if (sample.distance > farthest.distance) farthest = sample;
    widths.push_back(sample.view.width);
    escaping.push_back(sample.view.escaping);
    inside += sample.view.winding != 0 ? 1 : 0;
  }
  fmt::print(
      "{:9.3f} {:>27} {:9.2f} {:9} {:10.0f} {:12.3f} {:12.1f}\n", farthest.distance,
      fmt::format("({:.1f}, {:.1f}, {:.1f})", farthest.point.x, farthest.point.y, farthest.point.z),
      area_each * static_cast<double>(members.size()), triangles.size(),
      100.0 * inside / static_cast<double>(members.size()), median(widths),
      100 * std::accumulate(escaping.begin(), escaping.end(), 0.0) / static_cast<double>(escaping.size()));
}

void trace(const std::filesystem::path& path, double voxel) {
  const Mesh model = load_model(path).mesh;
  Monitor monitor;
  const Mesh remeshed = ModelLevelSet(model, voxel, kInfinity, monitor).surface();
  const SurfaceSamples samples = sample_surface(model, 500'000);
  const std::vector<double> distances =
      kernels::HostTriangleBvh(remeshed.positions, remeshed.triangles).distances(samples.points);
  const Surroundings surroundings(model);

  std::vector<FarSample> far;
  for (std::size_t i = 0; i < distances.size(); ++i) {
    if (distances[i] <= kFarVoxels * voxel) continue;
    far.push_back({samples.points[i], samples.triangles[i], distances[i],
                   surroundings.look(samples.points[i], normal_of(model, samples.triangles[i]))});
  }
  const auto share = [&](const auto& holds) {
    return 100.0 * static_cast<double>(std::count_if(far.begin(), far.end(), holds)) /
           std::max(1.0, static_cast<double>(far.size()));
  };
  fmt::print(
      "\n{} at voxels of {} mm: {:.2f} of {:.0f} mm2 are more than {} mm from the remeshed surface\n"
      "of these {:.1f} % face the model's inside, {:.1f} % see nothing but the model, {:.1f} % have less "
      "than a voxel in front\n\n",
      path.filename().string(), voxel, samples.area_each * static_cast<double>(far.size()),
      surface_area(model), kFarVoxels * voxel, share([](const FarSample& s) { return s.view.winding != 0; }),
      share([](const FarSample& s) { return s.view.escaping == 0; }),
      share([&](const FarSample& s) { return s.view.width < voxel; }));
  fmt::print("{:>9} {:>27} {:>9} {:>9} {:>10} {:>12} {:>12}\n", "distance", "farthest at, mm", "mm2",
             "triangles", "inside, %", "width, mm", "rays out, %");
  const auto groups = group(far, 2 * voxel);
  for (std::size_t i = 0; i < std::min<std::size_t>(groups.size(), 8); ++i)
    print_group(groups[i], samples.area_each);
  fmt::print("{} places in all\n", groups.size());
}

int run(const Arguments& arguments) {
  const double voxel = arguments.number(0, 0);
  for (std::size_t i = 1; i < arguments.positional.size(); ++i) trace(arguments.positional[i], voxel);
  return 0;
}

}  // namespace
}  // namespace aerate::bench

int main(int argc, char** argv) {
  return aerate::bench::run_benchmark(argc, argv, {"VOXEL_SIZE MODEL.stl...", 2, aerate::bench::kAnyNumber},
                                      aerate::bench::run);
}
