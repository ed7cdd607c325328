#include <CLI/CLI.hpp>
#include <filesystem>
#include <fmt/format.h>
#include <memory>
#include <string>
#include <utility>

#include "cli/called_commands.h"
#include "cli/cell_options.h"
#include "cli/command_alone.h"
#include "cli/commands.h"
#include "cli/keep_solid_options.h"
#include "cli/model_options.h"
#include "cli/run_reported.h"
#include "cli/view_options.h"
#include "cli/void_options.h"
#include "core/error.h"
#include "files/cell_table.h"
#include "files/formats.h"
#include "files/sphere_table.h"
#include "pipeline/pack.h"

namespace aerate::cli {
namespace {

CellWords words_of_packed_cells() {
  return {
      .shape =
          "What is written: the packed spheres, or the cells round them, as 'aerate hollow --shape cells' "
          "takes them out where voids are sealed (default spheres)",
      .fillet = fmt::format("{:g}", CellOptions{}.fillet),
      .tolerance = fmt::format("Cells: surfaces of their pieces stay this far inside their shapes at most "
                               "(default {:g})",
                               kCellTolerance)};
}

// Throws UsageError for spheres as a mesh.
void require_table(const std::filesystem::path& output) {
  const MeshFormat* const mesh = find_format_to_write(output);
  if (mesh == nullptr || find_sphere_format(output)) return;
  throw UsageError(
      fmt::format("{}: spheres cannot be written as {}", output.string(), mesh->ending),
      fmt::format("give --shape cells for cells as {}, or a name that ends in {} for a table of spheres",
                  mesh->ending, endings_of_sphere_tables()));
}

struct PackCommand {
  PackCommand(CLI::App& command, const ConfigFile& config)
      : model(command),
        packing(command, config),
        keep_solid(command),
        cells(command, words_of_packed_cells()),
        views(command, "what was packed in the model"),
        run_options(command) {
    command
        .add_option("-o,--output", output,
                    fmt::format("Spheres: a table, {}; in a .csv a line x,y,z,radius,kind each. Cells: their "
                                "planes, .csv or .json, or their pieces as closed shells, {}",
                                endings_of_sphere_tables(), endings_that_are_written()))
        ->required()
        ->check(names_a_file())
        ->type_name("FILE");
  }

  PackOptions to_pipeline() const {
    PackOptions options;
    options.model = model.path;
    options.output = output;
    options.load = model.load();
    options.weld = model.weld;
    options.keep_solid = keep_solid.regions();
    ShapedRequest shaped =
        cells.applied_to(packing.request(), cells.asks_for_cells().value_or(false), CellOptions{}.fillet);
    options.packing = std::move(shaped.packing);
    options.cells = shaped.cells;
    options.views = views.outputs();
    options.tolerance = shaped.tolerance.value_or(options.tolerance);
    if (!options.cells && !output.empty()) require_table(options.output);
    if (!options.cells)
      cells.require_neither_fillet_nor_tolerance("without --shape cells", "spheres are written as they are");
    else if (find_cell_table_format(options.output))
      cells.require_neither_fillet_nor_tolerance(
          "with " + options.output.string(),
          fmt::format("planes are exact and have no edges; a name that ends in {} is for pieces, which have",
                      endings_that_are_written()));
    // Planes are exact.
    if (options.cells && !find_cell_table_format(options.output))
      require_tolerance_for(options.packing.process, options.tolerance);
    return options;
  }

  JobFiles files() const {
    JobFiles files{packing.inputs(model.path), {}};
    if (!output.empty()) files.outputs.emplace_back(output);
    for (NamedInput& region : keep_solid.inputs()) files.inputs.push_back(std::move(region));
    files.add_outputs(views.files());
    return files;
  }

  void run() const {
    const PackOptions options = to_pipeline();
    run_reported(run_options, files(), [&](Monitor& monitor) { return pack(options, monitor); });
  }

  ModelOptions model;
  PackingCommandOptions packing;
  KeepSolidOptions keep_solid;
  CellCommandOptions cells;
  ViewOptions views;
  RunOptions run_options;
  std::string output;
};

CalledResult call_pack(const Call& call, Monitor& monitor) {
  const CommandAlone<PackCommand> alone("pack", call);
  const PackCommand& command = alone.job();
  PackOptions options = command.to_pipeline();
  options.arrays = call.arrays;
  CalledResult result;
  run_called(command.run_options, command.files(), call, [&] {
    PackedPieces packed = pack_pieces(options, monitor);
    result.report = to_json(packed.report);
    result.spheres = std::move(packed.report.packing.spheres);
    result.mesh = std::move(packed.pieces);
  });
  return result;
}

}  // namespace

CalledCommand called_pack() {
  return {"pack", options_of_command<PackCommand>, call_pack};
}

void add_pack_command(CLI::App& app, const ConfigFile& config) {
  CLI::App& command =
      *app.add_subcommand("pack", "Pack spheres in a closed model and write them or their cells");
  command.callback([job = std::make_shared<PackCommand>(command, config)] { job->run(); });
}

}  // namespace aerate::cli
