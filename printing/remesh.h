#pragma once

#include <cstddef>
#include <memory>
#include <string>

#include "core/error.h"
#include "core/mesh.h"
#include "core/monitor.h"
#include "core/packing.h"
#include "core/solid.h"
#include "printing/carve.h"

namespace aerate {

// Voxels that cannot hold what they are to hold; the hint names the size that would do.
class VoxelsTooCoarse : public UsageError {
 public:
  VoxelsTooCoarse(const std::string& what, const std::string& hint, double fine_enough)
      : UsageError(what, hint), fine_enough_(fine_enough) {}

  double fine_enough() const { return fine_enough_; }  // mm

 private:
  double fine_enough_;
};

// A model as an OpenVDB level set. Hides OpenVDB from whoever includes this.
class ModelLevelSet {
 public:
  // Voxel edge in mm. `mesh` must be closed (fill its holes first). What is inside is told by flood filling
  // for a mesh of one shell, so that cracks thinner than a voxel close instead of breaking up; by the winding
  // number for several shells, so that overlapping parts are united and cavities stay. Of several shells
  // those that voxels cannot hold are left out: cavities smaller than a ball of 1.6 voxels radius, and crumbs
  // smaller than a voxel. Throws UsageError, before the work, when it would need more than `max_bytes`,
  // VoxelsTooCoarse when nothing of the model is left at this voxel size; InterruptedError.
  ModelLevelSet(const Mesh& mesh, double voxel_size, double max_bytes, Monitor& monitor);
  ~ModelLevelSet();
  ModelLevelSet(ModelLevelSet&&) noexcept;
  ModelLevelSet& operator=(ModelLevelSet&&) noexcept;

  // What the constructor reckons with, from the surface area alone: about the peak of its memory and of what
  // `subtract` adds, without the triangles of the voids.
  static double estimated_bytes(const Mesh& mesh, double voxel_size);

  double voxel_size() const;
  double bytes() const;  // of the level set and its surface, as they are

  // The zero set as a closed mesh: what the model becomes when it is remeshed. Packing is done against this
  // one, so that walls hold in the result.
  Mesh surface() const;

  // Computes csgDifference(model, voids), meshes it as a whole and finds each void again as a shell of its
  // own that follows its sphere: the proof that voids and surface are apart at this voxel size. The result is
  // `surface()` and, for each void, the shell that `carve_keeping_surface` makes: voxels that suit the model
  // give a sphere several times the triangles it needs, or miss the tolerance.
  // Throws VoxelsTooCoarse for a sphere that the voxels cannot hold and for voids that run together or into
  // the surface at this voxel size; as `carve_keeping_surface`; InterruptedError.
  Solid subtract(const Packing& packing, const CarveOptions& options, Monitor& monitor) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace aerate
