#pragma once

#include "core/cells.h"
#include "core/mesh.h"
#include "core/monitor.h"
#include "core/surface_index.h"
#include "pipeline/carve_model.h"
#include "pipeline/input_facts.h"
#include "pipeline/prepare.h"
#include "pipeline/report.h"
#include "view/scene.h"

// What there is to see of each kind of job.

namespace aerate {

struct SupportReport;

// A result, as it was planned, carved and checked.
Scene scene_of(const HollowedModel& hollowed, const HollowReport& report);

// A packing in its model: its spheres with their roofs, or the cells that were made of them. `surface` is the model's.
// Throws what carving throws.
Scene scene_of(const PreparedModel& model, const SurfaceIndex& surface, const PackReport& report,
               const CellVoids* cells, Monitor& monitor);

// A model as it was read, with what is wrong with it.
Scene scene_of(const Mesh& mesh, const InspectReport& report);

// The same without, of a model that is printed solid.
Scene scene_of(const Mesh& mesh, const InputFacts& input);

// A model and the supports that were made for it, as one mesh.
Scene scene_of(const Mesh& model_and_supports, const SupportReport& report);

}  // namespace aerate
