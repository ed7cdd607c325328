#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <variant>
#include <vector>

#include "core/drainage.h"
#include "core/error.h"
#include "core/mesh.h"
#include "core/monitor.h"
#include "core/packing.h"
#include "core/surface_index.h"
#include "kernels/roof.h"
#include "printing/carve.h"

namespace aerate {

// A tube that leaves a model, and the ball that it comes out of.
struct WayOut {
  Tube tube;
  Sphere ball;
};

// Where a tube leaves a model, does its surface, given with its index, look as if it could be cut? Quick: see
// cut_surface.h.
bool may_be_cut(const Mesh& outer, const SurfaceIndex& surface, const WayOut& way, const Roof& roof,
                double tolerance);

// A model's surface with the escape holes of a plan cut out of it, and the sides of these.
struct OuterWithHoles {
  struct Hole {
    std::vector<Triangle> sides;
    std::size_t ring_base = 0;  // indices from this on mean the hole's ring on its ball
    std::vector<Vec3f> ring;
  };
  Mesh mesh;  // the triangles that were kept, in their order; then what is left of those that were cut
  std::size_t kept_triangle_count = 0;
  std::vector<Hole> holes;  // in the plan's order
  double tolerance = 0;     // of the sides, mm
};

// The holes, by index, for which a surface cannot be cut after it was cut for those before them.
struct UncutHoles {
  std::vector<std::size_t> indices;
};
FailureError cannot_be_cut(const EscapeHole& hole);

// Cuts a surface, given with its index, around the escape holes of a plan alone (cut_surface.h), as if for
// one after the other, so that two may meet the same triangle. Throws InterruptedError.
std::variant<OuterWithHoles, UncutHoles> cut_holes(const Mesh& outer, const SurfaceIndex& surface,
                                                   const Packing& packing, const DrainagePlan& plan,
                                                   const CarveOptions& options, Monitor& monitor);

}  // namespace aerate
