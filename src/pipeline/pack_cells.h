#pragma once

#include <filesystem>
#include <optional>
#include <variant>

#include "core/cells.h"
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

// From the file name's ending; of no name, any mesh. Throws UsageError for one that cannot be written.
CellFormat cell_format_of(const std::filesystem::path& path);

struct WrittenCells {
  PackedCells facts;
  std::optional<CellVoids> shapes;  // where pieces or pictures are made of them
};

// As they are written: closed shells that face outward.
Mesh pieces_of(const CellVoids& shapes);

// Writes the cells of a verified packing, under the limits that cells obey, beside their target. Planes are those of whole cells; pieces
// are what `hollow` removes where voids are sealed, each a closed shell that faces outward; they are read back and
// checked. `surface` is the model's; without a file, nothing is written. Throws what shape_sound_cells and check_pieces throw;
// FailureError with the system's reason.
WrittenCells write_cells(const PreparedModel& model, const SurfaceIndex& surface, const Packing& packing,
                         const PackOptions& options, const CellFormat& format, AnnouncedFile* file,
                         Monitor& monitor);

}  // namespace aerate
