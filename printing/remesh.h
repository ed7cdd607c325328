#pragma once

#include <cstddef>
#include <memory>

#include "core/mesh.h"
#include "core/monitor.h"
#include "core/solid.h"
#include "core/void_plan.h"
#include "printing/carve.h"

namespace aerate {

// A model as an OpenVDB level set. Hides OpenVDB from whoever includes this.
class ModelLevelSet {
 public:
  // Voxel edge in mm. The sign comes from the winding number of `mesh`, so that overlapping parts are united
  // and cavities stay. `mesh` must be closed (fill its holes first). Throws FailureError when the level set
  // would need more than `max_bytes`.
  ModelLevelSet(const Mesh& mesh, double voxel_size, double max_bytes, Monitor& monitor);
  ~ModelLevelSet();
  ModelLevelSet(ModelLevelSet&&) noexcept;
  ModelLevelSet& operator=(ModelLevelSet&&) noexcept;

  double voxel_size() const;
  double bytes() const;

  // The zero set as a closed mesh: what the model becomes when it is remeshed. Packing is done against this
  // one, so that walls hold in the result.
  Mesh surface() const;

  // csgDifference(model, voids), meshed as a whole: outer surface and void shells. Vertices of void shells
  // are projected onto the planned shapes. Throws FailureError if voids run together at this voxel size (gap
  // too small for it), naming the size that would do.
  Solid subtract(const VoidPlan& plan, const CarveOptions& options, Monitor& monitor) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace aerate
