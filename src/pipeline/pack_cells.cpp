#include "pipeline/pack_cells.h"

#include <fmt/format.h>
#include <string>

#include "core/error.h"
#include "core/solid.h"
#include "pipeline/solid_file.h"
#include "pipeline/sound_cells.h"
#include "printing/slicers/object_parts.h"

namespace aerate {
namespace {

// Adds what was found on the file.
void write_pieces(const PreparedModel& model, const SurfaceIndex& surface, const Packing& packing,
                  const CellVoids& cells, const PackOptions& options, const MeshFormat& format,
                  AnnouncedFile* file, PackedCells& written, Monitor& monitor) {
  const Solid voids = carve_cells({}, cells);
  const Solid pieces{with_void_shells_turned(voids.mesh, voids), {}};
  const auto check = [&](const Mesh& read_back) {
    if (file != nullptr) written.file_bytes = std::filesystem::file_size(file->file().path());
    written.pieces = check_pieces(with_void_shells_turned(read_back, voids),
                                  {.solid = voids,
                                   .model = model.mesh,
                                   .surface = surface,
                                   .inspection = model.inspection,
                                   .packing = packing,
                                   .cells = &cells,
                                   .drainage = nullptr,
                                   .tolerance = options.tolerance,
                                   .kept = model.kept ? &*model.kept : nullptr},
                                  monitor);
  };
  write_beside(pieces, file, {.mesh = &format, .modifiers = {}, .blockers = {}, .object_name = {}}, check,
               monitor);
}

}  // namespace

Mesh pieces_of(const CellVoids& shapes) {
  const Solid voids = carve_cells({}, shapes);
  return with_void_shells_turned(voids.mesh, voids);
}

CellFormat cell_format_of(const std::filesystem::path& path) {
  if (path.empty()) return &MeshFormat::stl;
  if (const auto table = find_cell_table_format(path)) return *table;
  if (const MeshFormat* const mesh = find_format_to_write(path)) return mesh;
  const std::string ending = path.extension().string();
  throw UsageError(
      fmt::format("{}: cells cannot be written as {}", path.string(),
                  ending.empty() ? "a file without an ending" : ending),
      fmt::format("use a name that ends in {} for their pieces, or in .csv or .json for their planes",
                  endings_that_are_written()));
}

WrittenCells write_cells(const PreparedModel& model, const SurfaceIndex& surface, const Packing& packing,
                         const PackOptions& options, const CellFormat& format, AnnouncedFile* file,
                         Monitor& monitor) {
  monitor.stage("shape");
  const CellPlanes planes = planes_of_cells(model, packing, options.packing.device, monitor);
  WrittenCells result;
  PackedCells& written = result.facts;
  written.options = options.cells.value();
  written.tolerance = options.tolerance;
  written.plane_count = planes.planes.size();
  const bool writes_pieces = std::holds_alternative<const MeshFormat*>(format);
  if (writes_pieces || options.views.are_asked_for())
    result.shapes = shape_sound_cells(model, surface, packing, planes,
                                      {options.cells->fillet, options.tolerance}, monitor);
  if (const auto* const table = std::get_if<CellTableFormat>(&format)) {
    monitor.stage("write");
    const std::string text = cell_table(packing, planes, *table);
    written.file_bytes = text.size();
    write_bytes(text, file->file());
    return result;
  }
  write_pieces(model, surface, packing, *result.shapes, options, *std::get<const MeshFormat*>(format), file,
               written, monitor);
  return result;
}

}  // namespace aerate
