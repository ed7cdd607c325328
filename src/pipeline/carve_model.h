#pragma once

#include <memory>
#include <optional>

#include "core/cells.h"
#include "core/monitor.h"
#include "core/packing.h"
#include "core/surface_index.h"
#include "pipeline/drain.h"
#include "pipeline/options.h"
#include "pipeline/prepare.h"
#include "pipeline/prepared_models.h"
#include "pipeline/stand.h"
#include "pipeline/target.h"

namespace aerate {

// A model with its voids, ready to be written in one form or several.
struct HollowedModel {
  PackingRequest request;  // what was packed: without voids that would cost more than they save
  std::shared_ptr<const PreparedModel> model;
  SurfaceIndex surface;                  // of the model
  Packing packing;                       // the voids that are made, or the spheres whose cells they are
  std::optional<CellVoids> cells;        // what is made of them; absent: voids are the packing's own shapes
  std::optional<DrainedVoids> drainage;  // absent: each is sealed
  CarvedModel carved;
  std::optional<TargetFacts> target = {};
  std::optional<StandFacts> stand = {};
};

// Takes the model from `models`, packs, verifies, drains and carves; writes nothing. Throws what `hollow` throws.
HollowedModel carve_model(const HollowOptions& options, PreparedModels& models, Monitor& monitor);

// The model with its own cavities opened, and no void: where none can be made. nullopt if it has no cavities, or they are
// not to be opened.
std::optional<HollowedModel> open_without_voids(const HollowOptions& options, PreparedModels& models,
                                                Monitor& monitor);

}  // namespace aerate
