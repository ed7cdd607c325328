#include "pipeline/remesh_without_loss.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <utility>
#include <vector>

#include "core/error.h"
#include "core/surface_index.h"
#include "mesh/topology.h"
#include "pipeline/memory.h"

namespace aerate {
namespace {

// Of the memory that is available, what the level set of a remeshed model may take.
constexpr double kLevelSetMemoryShare = 0.5;

// A level set tells two surfaces apart that are this many voxels from each other.
constexpr double kVoxelsBetweenSurfaces = 3;

// No finer than this many voxels along the model's diagonal by default: time and memory grow with the square.
constexpr double kMostVoxelsAlongDiagonal = 1500;
constexpr double kFewestVoxelsAlongDiagonal = 200;

// Of a model that is remeshed, parts of its surface may lie this many voxels outside the new one ...
constexpr double kMostVoxelsLost = 2;
// ... on no more than this share of it; and its volume may change by a layer of so many voxels (at most 0.01
// on models of ours that have nothing thin).
constexpr double kMostAreaLost = 0.01;
constexpr double kMostVoxelsOfVolume = 0.1;
// Voxels are halved so often before a model is refused.
constexpr int kMostHalvings = 3;

// The largest distance of a vertex from a surface, mm.
double farthest_vertex(const Mesh& mesh, const SurfaceIndex& surface) {
  std::vector<Vec3d> vertices(mesh.positions.size());
  std::transform(mesh.positions.begin(), mesh.positions.end(), vertices.begin(),
                 [](Vec3f position) { return to_double(position); });
  const std::vector<double> distances = surface.distances(vertices);
  return *std::max_element(distances.begin(), distances.end());
}

Remeshed remesh_at(double voxel_size, const Mesh& original, const SurfaceIndex& surface, Monitor& monitor) {
  ModelLevelSet level_set(original, voxel_size, kLevelSetMemoryShare * available_memory_bytes(), monitor);
  Mesh mesh = level_set.surface();
  Inspection inspection = inspect(mesh);
  monitor.check_interrupted();
  const LostSurface lost =
      find_lost_surface(original, surface, SurfaceIndex(mesh), kMostVoxelsLost * voxel_size);
  const double deviation = std::max(farthest_vertex(mesh, surface), lost.farthest);
  return {std::move(level_set), std::move(mesh), std::move(inspection), lost, deviation};
}

// What is wrong with a remeshed model, in words; empty if nothing is.
std::string loss_in_words(const Remeshed& remeshed, const Inspection& original) {
  const double voxel_size = remeshed.level_set.voxel_size();
  if (remeshed.lost.area_share > kMostAreaLost) {
    const Vec3d place = remeshed.lost.place;
    return fmt::format("{:.2g} % of the surface are lost, most near ({:.1f}, {:.1f}, {:.1f}) mm",
                       100 * remeshed.lost.area_share, place.x, place.y, place.z);
  }
  const double before = original.filled_volume, after = remeshed.inspection.filled_volume;
  if (std::abs(after - before) > kMostVoxelsOfVolume * voxel_size * original.area)
    return fmt::format("{:.4g} mm3 become {:.4g} mm3", before, after);
  return {};
}

}  // namespace

Remeshed remesh_without_loss(const Mesh& mesh, const Inspection& inspection, const VoxelRequest& voxels,
                             const std::string& name, Monitor& monitor) {
  const SurfaceIndex surface(mesh);
  double voxel_size = voxels.asked.value_or(voxels.first);
  for (int halvings = 0;; ++halvings, voxel_size /= 2) {
    std::string loss;
    try {
      Remeshed remeshed = remesh_at(voxel_size, mesh, surface, monitor);
      loss = loss_in_words(remeshed, inspection);
      if (loss.empty()) return remeshed;
    } catch (const VoxelsTooCoarse&) {
      loss = "nothing is left of it";
    }
    if (voxels.asked || halvings == kMostHalvings) {
      throw MeshError(
          fmt::format("{}: voxels of {:.3g} mm are too coarse for the model: {}", name, voxel_size, loss),
          fmt::format("give --voxel {:.2g} or less, or mend the model so that its surface can be kept",
                      voxel_size / 2));
    }
    monitor.notice(fmt::format("voxels of {:.3g} mm are too coarse for the model ({}): {:.3g} mm are taken",
                               voxel_size, loss, voxel_size / 2));
  }
}

double default_voxel_size(const PackingLimits& limits, const Box3f& box) {
  const double diagonal = diagonal_of(box);
  double size = diagonal / kFewestVoxelsAlongDiagonal;
  for (const double distance : {limits.wall, limits.gap}) {
    if (distance > 0) size = std::min(size, distance / kVoxelsBetweenSurfaces);
  }
  return std::max(size, diagonal / kMostVoxelsAlongDiagonal);
}

}  // namespace aerate
