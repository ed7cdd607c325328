#include "pipeline/sound_cells.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <fmt/format.h>
#include <set>
#include <tbb/parallel_for.h>
#include <utility>
#include <vector>

#include "core/error.h"
#include "core/listed.h"
#include "mesh/inspect.h"
#include "packing/packing_cells.h"
#include "pipeline/budget.h"

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
    monitor.notice(fmt::format("{} not made: surfaces would run through themselves",
                               counted(dropped, "void is", "voids are")));
  return cells;
}

void tell_of_solid_cells(const CellVoids& cells, const Packing& packing, const CellShape& shape,
                         Monitor& monitor) {
  std::set<std::uint32_t> made;
  for (const CellVoid& piece : cells.voids) made.insert(piece.cell);
  const std::size_t solid = packing.spheres.size() - made.size();
  if (solid == 0) return;
  monitor.notice(fmt::format(
      "{} of {} cells {}: no part of {} takes a ball of --fillet {:g} mm{}", solid, packing.spheres.size(),
      solid == 1 ? "stays solid" : "stay solid", solid == 1 ? "it" : "them", shape.fillet,
      packing.limits.roof.limits_ceilings() ? " below a ceiling that can be bridged" : ""));
}

}  // namespace

CellPlanes planes_of_cells(const PreparedModel& model, const Packing& packing, const DeviceRequest& device,
                           Monitor& monitor) {
  const Box3f box = bounding_box(model.mesh);
  return cells_of(packing, {to_double(box.lower), to_double(box.upper)}, device, monitor);
}

CellVoids shape_sound_cells(const PreparedModel& model, const SurfaceIndex& surface, const Packing& packing,
                            const CellPlanes& planes, const CellShape& shape, Monitor& monitor) {
  require_memory_for_cells(model.mesh, packing, shape);
  CellVoids cells = shape_soundly(model.room_surface(surface), packing, planes, shape, monitor);
  // A piece keeps the wall from the surface of regions, so that one point tells for all of it.
  if (model.kept)
    std::erase_if(cells.voids, [&](const CellVoid& piece) {
      return model.kept->holds(to_double(piece.surface.positions.front()));
    });
  if (cells.voids.empty())
    throw NothingToRemoveError(fmt::format("{}: nothing to remove: no cell takes a ball of --fillet {:g} mm",
                                           model.input.path.filename().string(), shape.fillet),
                               "give a smaller --fillet, or --shape spheres");
  tell_of_solid_cells(cells, packing, shape, monitor);
  return cells;
}

}  // namespace aerate
