#include "pipeline/carve_as_cells.h"

#include <algorithm>
#include <cstddef>
#include <fmt/format.h>
#include <limits>
#include <optional>
#include <string>
#include <utility>

#include "core/error.h"
#include "pipeline/budget.h"
#include "pipeline/held_notices.h"
#include "pipeline/solid_file.h"
#include "pipeline/sound_cells.h"
#include "printing/cells/shape_cells.h"

namespace aerate {
namespace {

CarvedCells carve_at(const PreparedModel& model, const SurfaceIndex& surface, const Packing& packing,
                     const CellPlanes& planes, const HollowOptions& options, double tolerance,
                     Monitor& monitor) {
  const CellShape shape{options.cells->fillet, tolerance};
  CellVoids cells = shape_sound_cells(model, surface, packing, planes, shape, monitor);
  return carve_some_cells(model, surface, std::move(cells), packing.limits, options, tolerance, monitor);
}

// `fewest`: of the results that there were, if any.
UsageError takes_more_triangles(std::size_t most, std::size_t outer, std::optional<std::size_t> fewest) {
  std::string what = fmt::format("--max-triangles {}: the model has {} triangles of its own", most, outer);
  if (!fewest) return UsageError(what, "allow more triangles: these stay as they are");
  what += fmt::format(", and with cells there were no fewer than {}, however coarse these were", *fewest);
  return UsageError(
      what, fmt::format("allow {} triangles or more, or give a larger --cell-size or --min-radius for "
                        "fewer cells",
                        *fewest));
}

// Whether that a coarser result failed only says that it was too coarse.
bool may_be_too_coarse(const Error& error) {
  return error.code() == ExitCode::nothing_to_remove || error.code() == ExitCode::failure;
}

}  // namespace

CarvedCells carve_some_cells(const PreparedModel& model, const SurfaceIndex& surface, CellVoids cells,
                             const PackingLimits& limits, const HollowOptions& options, double tolerance,
                             Monitor& monitor) {
  if (!options.drainage) {
    Solid solid = carve_cells(model.mesh, cells);
    return {std::move(cells), std::nullopt, {std::move(solid), tolerance}};
  }
  DrainedCells drained = drain_cells(model, surface, cells, limits, options, tolerance, monitor);
  return {std::move(drained.cells), std::move(drained.voids), {std::move(drained.solid), tolerance}};
}

CarvedCells carve_as_cells(const PreparedModel& model, const SurfaceIndex& surface, const Packing& packing,
                           const HollowOptions& options, Monitor& monitor) {
  constexpr double kLooser = 1.5;
  constexpr int kMostTries = 10;
  if (options.drainage) require_resolvable_tubes(model.mesh, *options.drainage, options.tolerance);
  monitor.stage("shape");
  const CellPlanes planes = planes_of_cells(model, packing, options.packing.device, monitor);
  const std::size_t outer = model.mesh.triangles.size();
  const std::size_t most = options.max_triangles.value_or(std::numeric_limits<std::size_t>::max());
  if (most <= outer) throw takes_more_triangles(most, outer, std::nullopt);
  std::optional<std::size_t> fewest;
  double tolerance = options.tolerance;
  for (int tries = 0; tries < kMostTries; ++tries, tolerance *= kLooser) {
    HeldNotices held(monitor);
    try {
      CarvedCells made = carve_at(model, surface, packing, planes, options, tolerance, held);
      const std::size_t count = triangles_written(made.carved.solid, options);
      fewest = std::min(count, fewest.value_or(count));
      if (count > most) continue;
      held.pass_on();
      notice_if_loosened(tolerance, options.tolerance, options.max_triangles, monitor);
      return made;
    } catch (const Error& error) {
      if (fewest && may_be_too_coarse(error)) break;
      held.pass_on();
      throw;
    }
  }
  throw takes_more_triangles(most, outer, fewest);
}

}  // namespace aerate
