#include "check/check_pieces.h"

#include <algorithm>

#include "check/check_cells.h"
#include "check/check_failure.h"
#include "check/check_kept.h"
#include "check/same_triangles.h"

namespace aerate {

PieceFacts check_pieces(const Mesh& read_back, const Expected& expected, Monitor& monitor) {
  require_same_triangles(read_back, expected.solid.mesh, monitor);
  const std::vector<CellVoid>& planned = expected.cells->voids;
  const auto pieces = expected.solid.of(PartKind::void_surface);
  if (pieces.size() != planned.size())
    fail_check("{} pieces were planned, {} made", planned.size(), pieces.size());
  const MeasuredCells measured = check_cells(read_back, expected, monitor);
  monitor.check_interrupted();
  PieceFacts facts;
  facts.triangle_count = read_back.triangles.size();
  facts.piece_count = pieces.size();
  facts.volume = measured.inside.volume;
  facts.deviation = measured.deviation;
  facts.clearances = measured.clearances;
  if (expected.kept != nullptr) facts.kept_wall = check_kept(read_back, expected, monitor);
  facts.roof_count = static_cast<std::size_t>(std::ranges::count_if(planned, &CellVoid::has_roof));
  facts.ceilings =
      limited_ceilings(read_back, pieces, expected.packing.limits.roof, expected.tolerance, monitor);
  return facts;
}

}  // namespace aerate
