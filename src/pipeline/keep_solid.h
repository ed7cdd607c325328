#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/kept_solid.h"
#include "core/monitor.h"
#include "files/load.h"
#include "pipeline/region_request.h"

namespace aerate {

struct PreparedModel;

// The names among these that may be those of modifiers in the model's file.
std::vector<std::string> names_of_regions(std::span<const RegionRequest> regions);

// How regions are read and kept away from.
struct KeepSolidPolicy {
  LoadOptions load;            // of mesh files, as of the model
  std::optional<double> weld;  // mm; see HollowOptions
  double wall = 0;             // mm
};

// The regions of a usable model; nothing if there are none. Each is a modifier that was read with the model, a mesh
// file, or made here. Throws what load_model throws, MeshError for one whose surface is not closed, and InputError,
// naming it and the model's box, for one that has nothing in common with the model.
std::optional<KeptSolid> keep_solid(const PreparedModel& model, std::span<const RegionRequest> regions,
                                    const KeepSolidPolicy& policy, Monitor& monitor);

}  // namespace aerate
