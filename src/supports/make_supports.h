#pragma once

#include <cstddef>
#include <string>

#include "core/mesh.h"
#include "core/monitor.h"
#include "supports/body.h"
#include "supports/support_rules.h"
#include "supports/teeth.h"
#include "supports/tooth_surfaces.h"

namespace aerate {

struct SupportShape {
  ToothKind kind = ToothKind::ridge;
  BodyShape body;
  ToothShape tooth;
};

// The usual shape of a process's supports.
SupportShape usual_shape(const SupportRules& rules);

// Supports of a model that stands upright.
struct Supports {
  Mesh body;   // closed, outward; may be empty
  Mesh teeth;  // closed shells that run into the body and into each other
  std::size_t tooth_count = 0;
  std::size_t foot_count = 0;  // teeth by which they stand on the model
  double tip_area = 0;         // of what touches the model from below, mm2
  std::size_t no_room = 0;     // places for teeth that have none
};

// Throws NothingToRemoveError for a model that needs none, InterruptedError.
//   model: that `undersides` are of
Supports make_supports(const SurfaceIndex& model, const Undersides& undersides, const SupportRules& rules,
                       const SupportShape& shape, Monitor& monitor);

// One mesh, the body first.
Mesh joined(const Mesh& body, const Mesh& teeth);

}  // namespace aerate
