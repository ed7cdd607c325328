#pragma once

#include "core/mesh.h"
#include "core/monitor.h"
#include "core/surface_index.h"
#include "printing/plugs.h"

namespace aerate {

// What was measured on a file of plugs.
struct PlugFacts {
  double volume = 0;     // of all, mm3
  double clearance = 0;  // the least between a plug and its hole, mm
  // The largest distance of the middle of an outer end's triangle from the surface that the hole was cut out of, mm;
  // their corners lie on it.
  double flush = 0;
};

// Holds a file of plugs that was read back against what was to be written: triangle for triangle the same; each plug
// one closed 2-manifold shell of its own with a volume, standing on z = 0 apart from the others; in its hole it keeps
// the clearance, is no longer than it, and its outer end lies on the surface, which is that of the model without holes.
// Throws FailureError, InterruptedError.
PlugFacts check_plugs(const Mesh& read_back, const Plugs& plugs, const PlugFit& fit,
                      const SurfaceIndex& surface, Monitor& monitor);

}  // namespace aerate
