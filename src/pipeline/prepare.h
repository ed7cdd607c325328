#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/error.h"
#include "core/kept_solid.h"
#include "core/mesh.h"
#include "core/monitor.h"
#include "files/load.h"
#include "mesh/inspect.h"
#include "pipeline/input_facts.h"
#include "pipeline/open_cavities.h"
#include "pipeline/options.h"
#include "pipeline/remesh_without_loss.h"
#include "printing/remesh.h"

namespace aerate {

// A model that voids can be packed into.
struct PreparedModel {
  InputFacts input;       // as it came from the file
  Mesh mesh;              // closed, outward: what is packed, and the outer surface of the result
  Inspection inspection;  // of `mesh`
  // When the model was remeshed: `mesh` is this level set's zero set.
  std::optional<ModelLevelSet> level_set;
  std::optional<double> outer_deviation;  // see HollowReport
  std::vector<NamedModifier> modifiers;   // of its file, that were asked for
  std::optional<KeptSolid> kept;          // regions of it that stay solid
  // Its own cavities, if they were to be opened; `mesh` has the holes then.
  std::optional<OpenedCavities> opened = {};

  // Where voids may be: the model less those regions. `surface` is the model's.
  const Mesh& room() const { return kept ? kept->room : mesh; }
  const SurfaceIndex& room_surface(const SurfaceIndex& surface) const {
    return kept ? kept->room_surface : surface;
  }
};

// How the surface may be changed to make the model usable.
struct SurfacePolicy {
  SurfaceMode mode = SurfaceMode::keep;
  std::optional<double> weld = {};      // mm; see HollowOptions
  std::optional<double> max_hole = {};  // mm; see HollowOptions
  VoxelRequest voxels = {};             // for remeshing
};

// A model's file, or arrays that are called by this name.
struct ModelSource {
  std::filesystem::path path;
  const MeshArrays* arrays = nullptr;
};

// Reads and inspects a model; notes several parts. Throws what load_model throws.
PreparedModel load_and_inspect(const ModelSource& source, const LoadOptions& options, Monitor& monitor);

// Closes cracks of no width, takes doubled bodies once, turns what is inside out, and remeshes if the policy
// says so. Throws MeshError, naming what is wrong and where, for a model that bounds no solid, that the policy
// does not let mend, or that remeshing would lose parts of.
PreparedModel make_usable(PreparedModel model, const SurfacePolicy& policy, Monitor& monitor);

// A copy of a model as it was read, made usable as it is, for questions that only a solid answers.
struct UsableCopy {
  std::optional<PreparedModel> model;
  std::string verdict = {};  // without one: why it cannot be told
};
UsableCopy usable_copy(const PreparedModel& read, Monitor& monitor);

// What hollowing will make of a model: whether its surface can be kept, or what stands in the way.
struct ModelUse {
  std::string words;
  std::optional<Error> refusal = {};  // what hollowing would throw
};
ModelUse use_of(PreparedModel model, const SurfacePolicy& policy);

// Both, as `hollow` is asked to, the model's own cavities opened, and the regions that stay solid. Unless the options say, voxels for remeshing leave room for wall and gap.
PreparedModel prepare_model(const HollowOptions& options, Monitor& monitor);

}  // namespace aerate
