#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <variant>
#include <vector>

#include "core/cells.h"
#include "core/drainage.h"
#include "core/mesh.h"
#include "core/monitor.h"
#include "core/solid.h"
#include "core/surface_index.h"

namespace aerate {

// Can an escape hole be cut from a void to the outside? Quick; other reasons why not are rare. `outer` is a model's
// surface, given with its index.
bool may_be_cut(const Mesh& outer, const SurfaceIndex& surface, const CellVoid& from, const Tube& hole,
                const Roof& roof, double tolerance);

// The tubes of a plan, by index, that cannot be cut.
struct UncutTubes {
  std::vector<std::size_t> windows, holes;
};

// Takes cells out of a model, with the windows in the walls between them (the plan's channels) and the escape holes. A tube is
// a prism inscribed in it (printing/cells/tube_section.h) that begins as a ring within the wall and runs from there both ways:
// into one void, and into the other or to the outside. What it leaves of the surfaces is CGAL's corefinement of the few
// triangles that it meets (printing/cut_surface.h); all others stay as they are.
//
// For several plans, which differ in few tubes: a void that is cut as it was last time is not cut again.
class CellCarver {
 public:
  // All that is given has to outlive this.
  CellCarver(const Mesh& outer, const SurfaceIndex& surface, const CellVoids& cells, double tolerance);
  ~CellCarver();
  CellCarver(const CellCarver&) = delete;
  CellCarver& operator=(const CellCarver&) = delete;

  // The plan counts those of `cells.voids` that are `kept`. Throws InterruptedError.
  std::variant<Solid, UncutTubes> carve(std::span<const std::uint32_t> kept, const DrainagePlan& plan,
                                        Monitor& monitor);

 private:
  struct CutVoid;

  const Mesh& outer_;
  const SurfaceIndex& surface_;
  const CellVoids& cells_;
  double tolerance_;
  std::vector<CutVoid> last_;  // by void
};

// For one plan, which counts all voids.
std::variant<Solid, UncutTubes> carve_drained_cells(const Mesh& outer, const SurfaceIndex& surface,
                                                    const CellVoids& cells, const DrainagePlan& plan,
                                                    double tolerance, Monitor& monitor);

}  // namespace aerate
