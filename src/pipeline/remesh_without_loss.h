#pragma once

#include <optional>
#include <string>

#include "core/mesh.h"
#include "core/monitor.h"
#include "core/packing.h"
#include "mesh/inspect.h"
#include "mesh/lost_surface.h"
#include "printing/remesh.h"

namespace aerate {

// What remeshing made of a model.
struct Remeshed {
  ModelLevelSet level_set;
  Mesh mesh;
  Inspection inspection;
  LostSurface lost;
  double deviation;  // of either surface from the other, less what became solid, mm
};

struct VoxelRequest {
  std::optional<double> asked = {};  // mm: this, or nothing
  double first = 0;                  // mm: halved where it loses parts of the model
};

// A closed model at the voxel size asked for, or the first of ever finer ones at which no part is lost
// (docs/carving.md). `name` is the model's, for messages. Throws MeshError for a model that loses parts all the
// same, as ModelLevelSet for one that takes too much memory; InterruptedError.
Remeshed remesh_without_loss(const Mesh& mesh, const Inspection& inspection, const VoxelRequest& voxels,
                             const std::string& name, Monitor& monitor);

// Voxel edge for remeshing that leaves room for the wall and the gap, mm.
double default_voxel_size(const PackingLimits& limits, const Box3f& box);

}  // namespace aerate
