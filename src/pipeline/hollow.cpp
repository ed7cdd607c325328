#include "pipeline/hollow.h"

#include <filesystem>
#include <fmt/format.h>
#include <optional>
#include <utility>

#include "check/check_written.h"
#include "pipeline/announced_file.h"
#include "pipeline/balance.h"
#include "pipeline/budget.h"
#include "pipeline/carve_as_cells.h"
#include "pipeline/job_log.h"
#include "pipeline/pack.h"
#include "pipeline/print_prediction.h"
#include "pipeline/solid_file.h"
#include "printing/carve.h"

namespace aerate {
namespace {

// Refuses what cannot be made before the long stages, and says what sealed voids would mean.
PackingRequest request_of(const HollowOptions& options, Monitor& monitor) {
  // Modifiers have no walls to pay for, and leave the model solid.
  if (options.modifiers) return options.packing;
  PackingRequest request = without_voids_that_cost(options.packing, options, monitor);
  if (options.drainage) {
    require_room_for_tubes(*options.drainage, request.limits());
  } else {
    warn_of_trapped_material(options.packing.process.process, monitor);
  }
  return request;
}

// The tolerance at which the voids take no more triangles than are allowed, and no more memory than there is.
double tolerance_within(const Packing& packing, std::size_t outer_triangles, const HollowOptions& options,
                        Monitor& monitor) {
  const double tolerance = tolerance_for(packing, options.tolerance, outer_triangles, options.max_triangles);
  notice_if_loosened(tolerance, options.tolerance, options.max_triangles, monitor);
  require_memory_for_voids(packing, tolerance, outer_triangles);
  return tolerance;
}

Solid carve_sealed(const PreparedModel& model, const Packing& packing, double tolerance, Monitor& monitor) {
  const CarveOptions options{.tolerance = tolerance};
  if (model.level_set) return model.level_set->subtract(packing, options, monitor);
  return carve_keeping_surface(model.mesh, packing, options, monitor);
}

void warn_of_many_triangles(const CarvedModel& carved, std::size_t outer_triangles, Monitor& monitor) {
  constexpr std::size_t kMany = 1000000;
  const std::size_t count = carved.solid.mesh.triangles.size();
  if (count <= kMany || count <= 2 * outer_triangles) return;
  monitor.notice(fmt::format(
      "the result has {} triangles, the model {}: slicers may be slow with it; --max-triangles or a larger "
      "--tolerance gives fewer",
      count, outer_triangles));
}

// `outer` has the holes of voids that drain.
CarvedModel carve(const PreparedModel& model, const SurfaceIndex& surface, const Packing& packing,
                  const std::optional<DrainedVoids>& drained, OuterWithHoles outer,
                  const HollowOptions& options, Monitor& monitor) {
  const double tolerance = tolerance_within(packing, model.mesh.triangles.size(), options, monitor);
  monitor.stage("carve");
  CarvedModel carved = drained ? carve_within(model, surface, packing, drained->plan, std::move(outer),
                                              tolerance, options.max_triangles, monitor)
                               : CarvedModel{carve_sealed(model, packing, tolerance, monitor), tolerance};
  warn_of_many_triangles(carved, model.mesh.triangles.size(), monitor);
  monitor.check_interrupted();
  return carved;
}

OuterSurface surface_of(const PreparedModel& model) {
  return model.level_set ? OuterSurface::remeshed : OuterSurface::kept;
}

// What was found on the written file.
struct WrittenFile {
  std::size_t bytes = 0;
  OutputFacts facts;
  Balance balance;
};

WrittenFile write_to(AnnouncedFile& pending, const HollowedModel& hollowed, const HollowOptions& options,
                     Monitor& monitor) {
  WrittenFile written;
  const auto check = [&](const Mesh& read_back) {
    written.facts = check_written(read_back,
                                  {.solid = hollowed.carved.solid,
                                   .model = hollowed.model.mesh,
                                   .surface = hollowed.surface,
                                   .inspection = hollowed.model.inspection,
                                   .packing = hollowed.packing,
                                   .cells = hollowed.cells ? &*hollowed.cells : nullptr,
                                   .drainage = hollowed.drainage ? &hollowed.drainage->plan : nullptr,
                                   .tolerance = hollowed.carved.tolerance,
                                   .outer = surface_of(hollowed.model)},
                                  monitor);
    written.bytes = std::filesystem::file_size(pending.file().path());
    if (options.modifiers) return;
    written.balance = balance_of(hollowed.model.mesh, written.facts, hollowed.packing.limits.roof.up);
    warn_of_tipping(written.balance, written.facts, monitor);
  };
  write_checked(hollowed.carved.solid, pending, solid_format_of(options), check, monitor);
  return written;
}

// Everything that the stages found out.
HollowReport report_of(const HollowedModel& hollowed, const WrittenFile& written,
                       const HollowOptions& options,
                       const std::optional<PrintPrediction>& print = std::nullopt) {
  const PreparedModel& model = hollowed.model;
  HollowReport report;
  report.input = model.input;
  report.limits = hollowed.request.limits();
  report.process = hollowed.request.process;
  report.method = name_of_method(options.packing);
  report.packing_statistics = hollowed.packing.statistics;
  report.cells = options.cells;
  report.packing_density = total_volume(hollowed.packing) / model.inspection.filled_volume;
  report.packing_device = hollowed.packing.device;
  report.surface = surface_of(model);
  if (model.level_set) report.voxel_size = model.level_set->voxel_size();
  report.outer_deviation = model.outer_deviation;
  report.tolerance_asked = options.tolerance;
  report.tolerance_used = hollowed.carved.tolerance;
  report.max_triangles = options.max_triangles;
  report.modifiers = options.modifiers;
  report.output_path = options.output;
  report.output_bytes = written.bytes;
  report.output = written.facts;
  report.drainage = hollowed.drainage;
  report.volume_estimated = model.inspection.parts_overlap();
  report.balance = written.balance;
  report.print = print;
  report.material = options.material;
  return report;
}

}  // namespace

namespace {

HollowedModel carve_once(const HollowOptions& options, Monitor& monitor) {
  PackingRequest request = request_of(options, monitor);
  PreparedModel model = prepare_model(options, monitor);
  request = sized_for(model, std::move(request), monitor);
  auto [packing, surface] = pack_model(model, request, monitor);
  if (options.cells) {
    packing.limits = request.limits();
    auto [cells, drainage, carved] = carve_as_cells(model, surface, packing, options, monitor);
    warn_of_many_triangles(carved, model.mesh.triangles.size(), monitor);
    return {std::move(request), std::move(model),    std::move(surface), std::move(packing),
            std::move(cells),   std::move(drainage), std::move(carved)};
  }
  auto [made, drainage, outer] = drain(model, surface, std::move(packing), request.process, options, monitor);
  CarvedModel carved = carve(model, surface, made, drainage, std::move(outer), options, monitor);
  return {std::move(request), std::move(model),    std::move(surface), std::move(made),
          std::nullopt,       std::move(drainage), std::move(carved)};
}

}  // namespace

// Voxels that were not asked for become finer until they hold the voids.
HollowedModel carve_model(const HollowOptions& options, Monitor& monitor) {
  constexpr int kMostTries = 4;
  HollowOptions tried = options;
  for (int tries = 1;; ++tries) {
    try {
      return carve_once(tried, monitor);
    } catch (const VoxelsTooCoarse& error) {
      if (options.voxel_size || tries == kMostTries) throw;
      tried.voxel_size = error.fine_enough();
      monitor.notice(fmt::format("{}; voxels of {:g} mm are taken", error.what(), *tried.voxel_size));
    }
  }
}

HollowReport write_hollowed(const HollowedModel& hollowed, const HollowOptions& options, Monitor& monitor) {
  AnnouncedFile pending(options.output, monitor);
  return report_of(hollowed, write_to(pending, hollowed, options, monitor), options);
}

HollowReport hollow(const HollowOptions& options, Monitor& monitor) {
  static_cast<void>(solid_format_of(options));  // refuses what cannot be written
  JobLog log(monitor);
  // Made before the long stages, so that a place that cannot be written to is found at once.
  AnnouncedFile pending(options.output, log);
  const HollowedModel hollowed = carve_model(options, log);
  const std::optional<PrintPrediction> print =
      predict_print(hollowed.model.mesh, hollowed.carved.solid, hollowed.packing, options, log);
  const WrittenFile written = write_to(pending, hollowed, options, log);
  HollowReport report = report_of(hollowed, written, options, print);
  report.stages = log.finish();
  report.notices = log.notices();
  return report;
}

}  // namespace aerate
