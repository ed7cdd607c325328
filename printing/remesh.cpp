#include "printing/remesh.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <limits>
#include <numbers>
#include <tbb/parallel_for.h>
#include <vector>

#include "core/error.h"
#include "core/listed.h"
#include "kernels/roof_distance.h"
#include "printing/level_set.h"
#include "printing/shells.h"

namespace aerate {
namespace {

// Peak memory, `subtract` included, for each h x h of the model's surface, h being the voxel edge, and for
// each of its triangles: measured as 320..430 bytes on two scans of 100 mm at h = 0.1..0.5 mm.
constexpr double kBytesPerSurfaceVoxel = 500;
constexpr double kBytesPerTriangle = 100;

// A void whose surface has this many voxels across cannot be mistaken for noise.
constexpr double kSmallestVoidRadiusVoxels = 2;
static_assert(kSmallestVoidRadiusVoxels >= LevelSet::kSmallestRadiusVoxels);

// Two digits, rounded to the safe side.
double rounded_up(double value) {
  const double unit = std::pow(10, std::floor(std::log10(value)) - 1);
  return std::ceil(value / unit) * unit;
}
double rounded_down(double value) {
  const double unit = std::pow(10, std::floor(std::log10(value)) - 1);
  return std::floor(value / unit) * unit;
}

void append(Mesh& mesh, const Mesh& shell) {
  const auto first = static_cast<std::uint32_t>(mesh.positions.size());
  mesh.positions.insert(mesh.positions.end(), shell.positions.begin(), shell.positions.end());
  for (const Triangle& t : shell.triangles) {
    mesh.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
  }
}

// What sampling by voxels leaves of cracks and slivers.
bool is_noise(const Mesh& shell, double voxel_size) {
  constexpr double kSmallestCavity = 4.0 / 3.0 * std::numbers::pi * LevelSet::kSmallestRadiusVoxels *
                                     LevelSet::kSmallestRadiusVoxels * LevelSet::kSmallestRadiusVoxels;
  const double volume = signed_volume(shell) / (voxel_size * voxel_size * voxel_size);
  return volume > -kSmallestCavity && volume < 1;
}

// A shell that a ball left in a level set, still seen as part of the solid: facing inward.
struct VoidShell {
  Mesh surface;
  Vec3d centre;
};

// Mean of the vertices; of a ball's surface within a fraction of a voxel of its centre.
Vec3d mean_position(const Mesh& mesh) {
  Vec3d sum{0, 0, 0};
  for (const Vec3f& p : mesh.positions) sum = sum + to_double(p);
  return sum * (1.0 / static_cast<double>(mesh.positions.size()));
}

// A void as balls along its spine (kernels/roof.h), half a voxel apart, as far as voxels can hold them: the
// room that is kept for it. The first is the sphere itself.
std::vector<Sphere> balls_of(const Sphere& sphere, const Roof& roof, double voxel_size) {
  std::vector<Sphere> balls{sphere};
  const double spine = roof.spine(sphere.radius);
  const auto steps = static_cast<std::size_t>(std::ceil(2 * spine / voxel_size));
  for (std::size_t i = 1; i <= steps; ++i) {
    const double height = spine * static_cast<double>(i) / static_cast<double>(steps);
    const double radius = sphere.radius - height * roof.sine;
    if (radius < kSmallestVoidRadiusVoxels * voxel_size) break;
    balls.push_back({sphere.centre + roof.up * height, radius, sphere.kind});
  }
  return balls;
}

double distance_to(const std::vector<Sphere>& balls, Vec3d p) {
  double distance = std::numeric_limits<double>::infinity();
  for (const Sphere& ball : balls) distance = std::min(distance, length(p - ball.centre) - ball.radius);
  return distance;
}

// For each void its shell, if there is one whose mean lies within half a voxel of the void's spine and that
// follows its balls, give or take a voxel.
std::vector<const VoidShell*> find_shells(const std::vector<std::vector<Sphere>>& voids,
                                          const std::vector<VoidShell>& shells_by_x, double voxel_size) {
  std::vector<const VoidShell*> found(voids.size());
  tbb::parallel_for(std::size_t{0}, voids.size(), [&](std::size_t i) {
    const Vec3d foot = voids[i].front().centre, spine = voids[i].back().centre - foot;
    const double reach = voxel_size / 2;
    auto shell =
        std::lower_bound(shells_by_x.begin(), shells_by_x.end(), std::min(foot.x, foot.x + spine.x) - reach,
                         [](const VoidShell& s, double x) { return s.centre.x < x; });
    for (; shell != shells_by_x.end() && shell->centre.x <= std::max(foot.x, foot.x + spine.x) + reach;
         ++shell) {
      const Vec3d offset = shell->centre - foot;
      const double extent = length_squared(spine);
      const double along = extent > 0 ? std::clamp(dot(offset, spine) / extent, 0.0, 1.0) : 0.0;
      if (length(offset - spine * along) > reach) continue;
      const bool fits = std::all_of(
          shell->surface.positions.begin(), shell->surface.positions.end(),
          [&](const Vec3f& p) { return std::abs(distance_to(voids[i], to_double(p))) <= voxel_size; });
      if (fits) found[i] = &*shell;
    }
  });
  return found;
}

UsageError too_much_memory(const Mesh& mesh, double voxel_size, double bytes, double max_bytes) {
  constexpr double kMebibyte = 1024.0 * 1024.0;
  const double for_voxels = max_bytes - kBytesPerTriangle * static_cast<double>(mesh.triangles.size());
  const double would_do = std::sqrt(kBytesPerSurfaceVoxel * surface_area(mesh) / for_voxels);
  return UsageError(fmt::format("remeshing at a voxel size of {:g} mm would need about {:.0f} MiB of memory, "
                                "more than the {:.0f} MiB there are for it",
                                voxel_size, std::ceil(bytes / kMebibyte), std::ceil(max_bytes / kMebibyte)),
                    for_voxels > 0 ? fmt::format("use --voxel {:g} or more", rounded_up(would_do))
                                   : "use a model of fewer triangles");
}

VoxelsTooCoarse too_small_for_voxels(const Packing& packing, double voxel_size) {
  double smallest = std::numeric_limits<double>::max();
  std::size_t count = 0;
  for (const Sphere& sphere : packing.spheres) {
    smallest = std::min(smallest, sphere.radius);
    if (sphere.radius < kSmallestVoidRadiusVoxels * voxel_size) ++count;
  }
  const double fine_enough = rounded_down(smallest / kSmallestVoidRadiusVoxels);
  return VoxelsTooCoarse(
      fmt::format("{} of {} too small for a voxel size of {:g} mm: the smallest has a radius of {:g} mm",
                  count, counted(packing.spheres.size(), "void is", "voids are"), voxel_size, smallest),
      fmt::format("use --voxel {:g} or less, or raise --min-radius", fine_enough), fine_enough);
}

// The void of sphere `lost` has no shell of its own.
VoxelsTooCoarse runs_together(const Packing& packing, std::size_t lost, double voxel_size) {
  const Sphere& sphere = packing.spheres[lost];
  double gap = std::numeric_limits<double>::max();
  for (std::size_t i = 0; i < packing.spheres.size(); ++i) {
    if (i == lost) continue;
    const Sphere& other = packing.spheres[i];
    gap = std::min(gap, kernels::distance_between(packing.limits.roof, sphere.centre, sphere.radius,
                                                  other.centre, other.radius));
  }
  const bool neighbour_is_near = gap < 2 * voxel_size;
  const double voxel_wanted = neighbour_is_near ? std::max(gap, 0.0) / 2 : voxel_size / 2;
  const double fine_enough = rounded_down(voxel_wanted > 0 ? voxel_wanted : voxel_size / 2);
  return VoxelsTooCoarse(
      fmt::format("the void at ({:g}, {:g}, {:g}) mm runs {} at a voxel size of {:g} mm", sphere.centre.x,
                  sphere.centre.y, sphere.centre.z,
                  neighbour_is_near ? fmt::format("together with its neighbour, {:g} mm away,", gap)
                                    : "into the surface",
                  voxel_size),
      voxel_wanted > 0 ? fmt::format("use --voxel {:g} or less", fine_enough) : "raise --gap", fine_enough);
}

}  // namespace

struct ModelLevelSet::Impl {
  LevelSet level_set;
  double voxel_size;
  Mesh surface;
};

ModelLevelSet::ModelLevelSet(const Mesh& mesh, double voxel_size, double max_bytes, Monitor& monitor) {
  const double bytes = estimated_bytes(mesh, voxel_size);
  if (!(bytes <= max_bytes)) throw too_much_memory(mesh, voxel_size, bytes, max_bytes);
  const bool one_shell = count_shells(mesh) == 1;
  const auto interior = one_shell ? LevelSet::Interior::enclosed : LevelSet::Interior::wound;
  LevelSet level_set = LevelSet::of_solid(mesh, voxel_size, interior, monitor);
  Mesh surface;
  for (const Mesh& shell : split_into_shells(level_set.surface())) {
    if (one_shell || !is_noise(shell, voxel_size)) append(surface, shell);
  }
  if (surface.triangles.empty()) {
    throw VoxelsTooCoarse(fmt::format("nothing is left of the model at a voxel size of {:g} mm", voxel_size),
                          "use a smaller --voxel", voxel_size / 2);
  }
  monitor.check_interrupted();
  impl_ = std::make_unique<Impl>(Impl{std::move(level_set), voxel_size, std::move(surface)});
}

ModelLevelSet::~ModelLevelSet() = default;
ModelLevelSet::ModelLevelSet(ModelLevelSet&&) noexcept = default;
ModelLevelSet& ModelLevelSet::operator=(ModelLevelSet&&) noexcept = default;

double ModelLevelSet::estimated_bytes(const Mesh& mesh, double voxel_size) {
  return kBytesPerSurfaceVoxel * surface_area(mesh) / (voxel_size * voxel_size) +
         kBytesPerTriangle * static_cast<double>(mesh.triangles.size());
}

double ModelLevelSet::voxel_size() const {
  return impl_->voxel_size;
}

double ModelLevelSet::bytes() const {
  return static_cast<double>(impl_->level_set.bytes() + impl_->surface.positions.size() * sizeof(Vec3f) +
                             impl_->surface.triangles.size() * sizeof(Triangle));
}

Mesh ModelLevelSet::surface() const {
  return impl_->surface;
}

Solid ModelLevelSet::subtract(const Packing& packing, const CarveOptions& options, Monitor& monitor) const {
  const double voxel_size = impl_->voxel_size;
  for (const Sphere& sphere : packing.spheres) {
    if (sphere.radius < kSmallestVoidRadiusVoxels * voxel_size)
      throw too_small_for_voxels(packing, voxel_size);
  }

  std::vector<std::vector<Sphere>> balls_by_void;
  std::vector<Sphere> balls;
  for (const Sphere& sphere : packing.spheres) {
    balls_by_void.push_back(balls_of(sphere, packing.limits.roof, voxel_size));
    balls.insert(balls.end(), balls_by_void.back().begin(), balls_by_void.back().end());
  }
  std::vector<VoidShell> shells;
  {
    const LevelSet voids = LevelSet::of_balls(balls, voxel_size);
    monitor.check_interrupted();
    const LevelSet cut = impl_->level_set.minus(voids);
    monitor.check_interrupted();
    for (Mesh& shell : split_into_shells(cut.surface())) {
      const Vec3d centre = mean_position(shell);
      if (signed_volume(shell) < 0) shells.push_back({std::move(shell), centre});
    }
  }
  std::stable_sort(shells.begin(), shells.end(),
                   [](const VoidShell& a, const VoidShell& b) { return a.centre.x < b.centre.x; });
  monitor.check_interrupted();

  const std::vector<const VoidShell*> found = find_shells(balls_by_void, shells, voxel_size);
  for (std::size_t i = 0; i < found.size(); ++i) {
    if (found[i] == nullptr) throw runs_together(packing, i, voxel_size);
  }

  return carve_keeping_surface(impl_->surface, packing, options, monitor);
}

}  // namespace aerate
