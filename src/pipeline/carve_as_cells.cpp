#include "pipeline/carve_as_cells.h"

#include <algorithm>
#include <cstddef>
#include <fmt/format.h>
#include <limits>
#include <optional>
#include <string>
#include <tbb/parallel_for.h>
#include <utility>
#include <vector>

#include "core/error.h"
#include "mesh/inspect.h"
#include "packing/packing_cells.h"
#include "pipeline/budget.h"
#include "pipeline/held_notices.h"
#include "printing/cells/shape_cells.h"

namespace aerate {
namespace {

// Where surfaces of voids run through themselves.
std::vector<CellPlace> find_crossings(const CellVoids& cells) {
  std::vector<std::vector<Vec3d>> found(cells.voids.size());
  tbb::parallel_for(std::size_t{0}, cells.voids.size(), [&](std::size_t i) {
    found[i] = find_self_intersections(cells.voids[i].surface).places;
  });
  std::vector<CellPlace> places;
  for (std::size_t i = 0; i < found.size(); ++i) {
    for (const Vec3d at : found[i]) places.push_back({cells.voids[i].cell, at});
  }
  return places;
}

CellVoids shape_soundly(const SurfaceIndex& surface, const Packing& packing, const CellPlanes& planes,
                        const CellShape& shape, Monitor& monitor) {
  constexpr int kMostTries = 8;
  CellVoids cells = shape_cells(surface, packing, planes, shape, monitor);
  std::vector<CellPlace> solid;
  for (int tries = 0; tries < kMostTries; ++tries) {
    const std::vector<CellPlace> crossings = find_crossings(cells);
    if (crossings.empty()) return cells;
    // Those of earlier tries as well: a cell is shaped from the beginning.
    solid.insert(solid.end(), crossings.begin(), crossings.end());
    cells = shape_around(surface, packing, std::move(cells), shape, solid, monitor);
  }
  // Rare, and small: such voids stay solid.
  const std::vector<CellPlace> crossings = find_crossings(cells);
  const auto is_crossed = [&](const CellVoid& piece) {
    return std::ranges::find(crossings, piece.cell, &CellPlace::cell) != crossings.end();
  };
  const std::size_t dropped = std::erase_if(cells.voids, is_crossed);
  if (dropped > 0)
    monitor.notice(
        fmt::format("{} voids are not made: their surfaces would run through themselves", dropped));
  return cells;
}

CarvedCells carve_at(const PreparedModel& model, const SurfaceIndex& surface, const Packing& packing,
                     const CellPlanes& planes, const HollowOptions& options, double tolerance,
                     Monitor& monitor) {
  const CellShape shape{options.cells->fillet, tolerance};
  require_memory_for_cells(model.mesh, packing, shape);
  CellVoids cells = shape_soundly(surface, packing, planes, shape, monitor);
  if (cells.voids.empty())
    throw NothingToRemoveError(fmt::format("{}: nothing to remove: no cell takes a ball of --fillet {:g} mm",
                                           model.input.path.filename().string(), options.cells->fillet),
                               "give a smaller --fillet, or --shape spheres");
  if (!options.drainage) {
    Solid solid = carve_cells(model.mesh, cells);
    return {std::move(cells), std::nullopt, {std::move(solid), tolerance}};
  }
  DrainedCells drained =
      drain_cells(model, surface, std::move(cells), packing.limits, options, tolerance, monitor);
  return {std::move(drained.cells), std::move(drained.voids), {std::move(drained.solid), tolerance}};
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

CarvedCells carve_as_cells(const PreparedModel& model, const SurfaceIndex& surface, const Packing& packing,
                           const HollowOptions& options, Monitor& monitor) {
  constexpr double kLooser = 1.5;
  constexpr int kMostTries = 10;
  if (options.drainage) require_resolvable_tubes(model.mesh, *options.drainage, options.tolerance);
  monitor.stage("shape");
  const Box3f box = bounding_box(model.mesh);
  const CellPlanes planes =
      cells_of(packing, {to_double(box.lower), to_double(box.upper)}, options.packing.device, monitor);
  const std::size_t outer = model.mesh.triangles.size();
  const std::size_t most = options.max_triangles.value_or(std::numeric_limits<std::size_t>::max());
  if (most <= outer) throw takes_more_triangles(most, outer, std::nullopt);
  std::optional<std::size_t> fewest;
  double tolerance = options.tolerance;
  for (int tries = 0; tries < kMostTries; ++tries, tolerance *= kLooser) {
    HeldNotices held(monitor);
    try {
      CarvedCells made = carve_at(model, surface, packing, planes, options, tolerance, held);
      const std::size_t count = made.carved.solid.mesh.triangles.size();
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
