#pragma once

#include <filesystem>
#include <variant>

#include "core/monitor.h"
#include "core/packing.h"
#include "core/surface_index.h"
#include "files/cell_table.h"
#include "files/formats.h"
#include "pipeline/announced_file.h"
#include "pipeline/options.h"
#include "pipeline/prepare.h"
#include "pipeline/report.h"

namespace aerate {

// What cells are written as: their planes as a table, or their pieces as a mesh.
using CellFormat = std::variant<CellTableFormat, const MeshFormat*>;

// From the file name's ending. Throws UsageError for one that cannot be written.
CellFormat cell_format_of(const std::filesystem::path& path);

// Writes the cells of a verified packing, under the limits that cells obey. Planes are those of whole cells; pieces
// are what `hollow` removes where voids are sealed, each a closed shell that faces outward. Pieces appear only after
// they were read back and checked. `surface` is the model's. Throws what shape_sound_cells and check_pieces throw;
// FailureError with the system's reason.
PackedCells write_cells(const PreparedModel& model, const SurfaceIndex& surface, const Packing& packing,
                        const PackOptions& options, const CellFormat& format, AnnouncedFile& file,
                        Monitor& monitor);

}  // namespace aerate
