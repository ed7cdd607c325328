#pragma once

#include <cstddef>

#include "packing/cells/cell_drainage_draft.h"

// Each takes a draft and gives the next.

namespace aerate {

// All voids, without windows and holes, but those that nothing can be joined to and that are too small to be
// worth two holes of their own.
CellDraft begin_draft(const CellDrainageTask& task);

// Places the holes that were asked for. Throws UsageError.
CellDraft open_where_asked(CellDrainageTask& task, CellDraft draft);

// Gives each network its two holes and the tree of windows; leaves out what is not reached or opened.
CellDraft open_and_join(CellDrainageTask& task, CellDraft draft);

// Joins voids that no hole is reached from any more by windows to those of which one is, where that is
// possible.
CellDraft rejoin(const CellDrainageTask& task, CellDraft draft);

// Windows beside the tree where they lower pools.
CellDraft add_windows_for_pools(CellDrainageTask& task, CellDraft draft);

// More holes for the largest pools.
CellDraft open_pools(CellDrainageTask& task, CellDraft draft);

// More windows and holes for the widest cups, while these are wider than the request allows; and how wide they are, mm2.
CellDraft open_cups(CellDrainageTask& task, CellDraft draft);
double widest_cup(const CellDrainageTask& task, const CellDraft& draft);

// All windows that are clear of what is placed and by which hollows drain lower in an orientation.
CellDraft with_windows_that_lower(const CellDrainageTask& task, const CellDraft& draft,
                                  std::size_t orientation);

// Leaves out voids that would stay full, until little stays.
CellDraft leave_out_pools(CellDrainageTask& task, CellDraft draft);

}  // namespace aerate
