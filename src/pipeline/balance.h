#pragma once

#include <optional>

#include "check/output_facts.h"
#include "core/mesh.h"
#include "core/monitor.h"

namespace aerate {

// How a model stands, and how stiff it is left.
struct Balance {
  // How far inside the footprint the centre of mass is, mm (footing_margin): absent for a model that stands
  // on a tip or an edge, or where there is no centre of mass.
  std::optional<double> margin_before;
  std::optional<double> margin_after;
  double stiffness = 1;  // upper bound of what is left of it, 0..1 (stiffness_upper_bound)

  bool tips_over() const { return margin_before && margin_after && *margin_before >= 0 && *margin_after < 0; }
};

// Of a result by what was measured on it; `outer` is its outer surface, `up` against gravity.
Balance balance_of(const Mesh& outer, const OutputFacts& output, Vec3d up);

// Says so if the model stood and its voids tip it over.
void warn_of_tipping(const Balance& balance, const OutputFacts& output, Monitor& monitor);

}  // namespace aerate
