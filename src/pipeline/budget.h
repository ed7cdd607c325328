#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>

#include "core/mesh.h"
#include "core/monitor.h"
#include "core/packing.h"
#include "mesh/inspect.h"
#include "pipeline/options.h"
#include "printing/cells/shape_cells.h"

namespace aerate {

// Refuses a job that memory cannot hold before it starts: throws UsageError with the estimate, what there is
// and what to change.
void require_memory_for_packing(const Mesh& mesh, const PackingRequest& request);

// The same for what is made of the packing: the void surfaces, the file and its check. `outer_triangles` is
// the size of the model's own surface.
//   copies: of each void surface that are written, support blockers among them
void require_memory_for_voids(const Packing& packing, double tolerance, std::size_t outer_triangles,
                              std::size_t copies = 1);

// The same for voids that fill cells.
void require_memory_for_cells(const Mesh& mesh, const Packing& packing, const CellShape& shape);

// The smallest tolerance, but no smaller than `asked`, with which the result has at most `max_triangles`.
// Throws UsageError if none does. mm.
double tolerance_for(const Packing& packing, double asked, std::size_t outer_triangles,
                     std::optional<std::size_t> max_triangles, std::size_t copies = 1);

// Notes that a tolerance is not the one that was asked for, if so. mm.
void notice_if_loosened(double tolerance, double asked, std::optional<std::size_t> max_triangles,
                        Monitor& monitor);

}  // namespace aerate
