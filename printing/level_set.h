#pragma once

#include <array>
#include <functional>
#include <memory>
#include <span>

#include "core/mesh.h"
#include "core/monitor.h"
#include "kernels/sphere.h"

namespace aerate {

// An OpenVDB narrow-band level set, negative inside, without OpenVDB's types. Voxel centres lie at whole
// multiples of the voxel size; the band reaches three voxels to either side of the surface.
class LevelSet {
 public:
  // OpenVDB silently leaves out balls whose radius is below 1.5 voxels; no function here makes one so small.
  static constexpr double kSmallestRadiusVoxels = 1.6;

  // How the inside of a mesh is told from its outside.
  enum class Interior {
    // What cannot be reached from outside without crossing the surface. Closes cracks that are thinner than
    // the voxels, and fills cavities.
    enclosed,
    // Where the winding number is not 0. Keeps cavities, and what is left of cracks.
    wound,
  };

  // `mesh` must be closed. The monitor is asked now and then on the calling thread.
  static LevelSet of_solid(const Mesh& mesh, double voxel_size, Interior interior, Monitor& monitor);

  // Precondition: every radius >= kSmallestRadiusVoxels * voxel_size.
  static LevelSet of_ball(Vec3d centre, double radius, double voxel_size);
  static LevelSet of_balls(std::span<const Sphere> balls, double voxel_size);

  // What voxels fill, given by their coordinates in voxels, with steps smoothed out.
  static LevelSet of_voxels(std::span<const std::array<int, 3>> voxels, double voxel_size);

  ~LevelSet();
  LevelSet(LevelSet&&) noexcept;
  LevelSet& operator=(LevelSet&&) noexcept;

  // This without what is nearer to its surface than three voxels and where `taken` is positive: a distance, mm, at a place, as far as that is
  // more than what is given beside it and less than three voxels. Called from all threads.
  LevelSet without(const std::function<double(Vec3d, double)>& taken) const;

  // This without what is inside `other`. Precondition: both have the same voxel size.
  LevelSet minus(const LevelSet& other) const;

  // The zero set by dual contouring, outward: closed and 2-manifold, quads split along their shorter
  // diagonal.
  Mesh surface() const;

  std::size_t bytes() const;

 private:
  struct Grid;
  explicit LevelSet(std::unique_ptr<Grid> grid);

  std::unique_ptr<Grid> grid_;
};

}  // namespace aerate
