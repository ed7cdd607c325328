#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "packing/cells/cell_drainage.h"
#include "packing/cells/cell_drainage_holes.h"
#include "packing/cells/cell_drainage_pools.h"
#include "packing/cells/cell_drainage_surfaces.h"
#include "packing/cells/cell_windows.h"

// What the stages of planning the drainage of cells hand on to each other.

namespace aerate {

// What can be looked up: the same for all plans of these cells.
struct CellDrainageGround {
  CellDrainageGround(const DrainableModel& drained, const CellVoids& voids, const PackingLimits& kept,
                     const DrainageRequest& request, Monitor& monitor);
  CellDrainageGround(const CellDrainageGround&) = delete;
  CellDrainageGround& operator=(const CellDrainageGround&) = delete;

  const DrainableModel& model;
  const CellVoids& cells;
  PackingLimits limits;
  std::vector<VoidHollows> hollows;  // by void
  double volume = 0;                 // of all voids, mm3
  CellPools pools;
  CellSurfaces surfaces;
  std::vector<CellWindow> windows;  // all places for windows
  std::vector<CellHoleWays> ways;   // for holes of the usual width, then for narrower ones if there are any
};

// What is asked for as well: the same for all drafts.
struct CellDrainageTask {
  CellDrainageTask(CellDrainageGround& ground, const DrainageRequest& asked, const CanOpenCell& can_cut,
                   const CanOpenWall& can_cut_wall, Monitor& watched);
  CellDrainageTask(const CellDrainageTask&) = delete;
  CellDrainageTask& operator=(const CellDrainageTask&) = delete;

  const CellVoids& cells;
  const PackingLimits& limits;
  const DrainageRequest& request;
  const CanOpenCell& can_open;
  Monitor& monitor;
  const std::vector<VoidHollows>& hollows;
  double volume;
  const CellPools& pools;
  const CellSurfaces& surfaces;
  std::vector<CellWindow> windows;     // those that may be opened
  std::vector<CellHolePlaces> places;  // as the ways of the ground
  std::vector<EscapeHole> uncut;       // that could not be cut: nothing is tried again as near as a radius

  std::size_t void_count() const { return hollows.size(); }
};

// A plan that is being made. A value: what may not be worth it is tried on a copy.
struct CellDraft {
  std::vector<char> is_kept;           // by void
  std::vector<std::uint32_t> windows;  // of the task, in the order in which they were placed
  std::vector<std::shared_ptr<const CellHole>> holes;
  std::vector<std::uint32_t> asked_for;  // voids with holes that were asked for
  UndrainedVoids dropped;
};

// Voids, ascending.
using CellMembers = std::vector<std::uint32_t>;

double volume_of(const CellDrainageTask& task, const CellMembers& members);

// Does a tube between two voids (or out of one, which is then both) keep away from those that are placed?
bool keeps_clear(const CellDrainageTask& task, const CellDraft& draft, const Tube& tube, std::uint32_t from,
                 std::uint32_t to);
bool is_open(const CellDrainageTask& task, const CellDraft& draft, std::uint32_t window);

// Counts voids as not made, for the given reason, and removes their windows and holes.
void leave_out(const CellDrainageTask& task, CellDraft& draft, const CellMembers& members,
               std::size_t UndrainedVoids::*reason);

// Sets of kept voids that the draft's windows join.
std::vector<CellMembers> parts_of(const CellDrainageTask& task, const CellDraft& draft);
std::vector<std::uint32_t> holes_of(const CellDraft& draft, const CellMembers& members);

// Places the best hole for some hollows in an orientation. Was there one?
bool open_hollows(CellDrainageTask& task, CellDraft& draft, std::span<const Basin::Part> hollows,
                  std::size_t orientation);
// The same for all hollows of some voids.
bool open_voids(CellDrainageTask& task, CellDraft& draft, const CellMembers& voids, std::size_t orientation);
// Is it accepted: clear of what is placed, and not refused by whoever cuts it?
bool can_place(CellDrainageTask& task, const CellDraft& draft, const CellHole& hole);

// Windows, then holes.
Passages passages_of(const CellDrainageTask& task, const CellDraft& draft);
TrappedPools pools_of(const CellDrainageTask& task, const CellDraft& draft);

PlannedCellDrainage planned(const CellDrainageTask& task, const CellDraft& draft);

}  // namespace aerate
