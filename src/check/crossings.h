#pragma once

#include <cstddef>

#include "core/drainage.h"
#include "core/mesh.h"
#include "core/surface_index.h"
#include "printing/cut_holes.h"

// Whether surfaces run through themselves where escape holes come out: a hole there could not be told from
// such a flaw.

namespace aerate {

// The model, given with its index, near a tube's outer end.
bool is_crossed_near(const Mesh& model, const SurfaceIndex& surface, const Tube& tube);

// The surface with its holes, and the sides of one of these.
bool is_crossed_at(const OuterWithHoles& outer, std::size_t hole, const Tube& tube);

// A whole result at any of a plan's holes. Throws FailureError for the first that is crossed.
void require_no_crossings(const Mesh& read_back, const DrainagePlan& plan);

}  // namespace aerate
