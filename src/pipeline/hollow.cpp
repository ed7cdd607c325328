#include "pipeline/hollow.h"

#include <algorithm>
#include <filesystem>
#include <fmt/format.h>
#include <optional>
#include <utility>

#include "check/check_drained.h"
#include "check/check_output.h"
#include "core/error.h"
#include "core/upright.h"
#include "core/void_plan.h"
#include "pipeline/announced_file.h"
#include "pipeline/budget.h"
#include "pipeline/drain.h"
#include "pipeline/job_log.h"
#include "pipeline/pack.h"
#include "pipeline/prepare.h"
#include "pipeline/print_prediction.h"
#include "pipeline/solid_file.h"
#include "printing/carve.h"
#include "printing/footing.h"
#include "printing/remesh.h"
#include "printing/strength.h"

namespace aerate {
namespace {

Solid carve(PreparedModel& model, const VoidPlan& plan, const CarveOptions& options, Monitor& monitor) {
  if (model.level_set) return model.level_set->subtract(plan, options, monitor);
  return carve_keeping_surface(model.mesh, plan, options, monitor);
}

Balance balance_of(const Mesh& outer, const OutputFacts& output, const UprightFrame& frame) {
  if (!frame.is_the_models_own()) {
    OutputFacts turned = output;
    for (auto* centre : {&turned.centre_of_mass_before, &turned.centre_of_mass_after})
      if (*centre) *centre = frame.to_frame(**centre);
    return balance_of(turned_upright(outer, frame), turned, UprightFrame({0, 0, 1}));
  }
  Balance balance;
  balance.stiffness = stiffness_upper_bound(output.volume_after / output.volume_before);
  if (output.centre_of_mass_before)
    balance.margin_before = footing_margin(outer, *output.centre_of_mass_before);
  if (output.centre_of_mass_after) balance.margin_after = footing_margin(outer, *output.centre_of_mass_after);
  return balance;
}

void warn_of_tipping(const HollowReport& report, Monitor& monitor) {
  const Vec3d centre = *report.output.centre_of_mass_after;
  monitor.notice(
      fmt::format("the model stood, and with these voids it tips over: its centre of mass, now at "
                  "({:.1f}, {:.1f}, {:.1f}) mm, "
                  "is {:.1f} mm outside of what it stands on",
                  centre.x, centre.y, centre.z, -*report.balance.margin_after));
}

// Throws what check_drained and check_output throw.
OutputFacts check_written(const Mesh& written, const HollowedModel& hollowed, HollowReport& report,
                          Monitor& monitor) {
  if (hollowed.drained) {
    return check_drained(written,
                         {.solid = *hollowed.drained,
                          .model = hollowed.model.mesh,
                          .surface = hollowed.surface,
                          .inspection = hollowed.model.inspection,
                          .balls = hollowed.plan.spheres,
                          .plan = report.drainage->plan,
                          .limits = report.limits,
                          .tolerance = report.tolerance_used},
                         *report.drainage, monitor);
  }
  return check_output(written,
                      {.solid = hollowed.solid,
                       .model = hollowed.model.mesh,
                       .surface = hollowed.surface,
                       .inspection = hollowed.model.inspection,
                       .plan = hollowed.plan,
                       .limits = report.limits,
                       .tolerance = report.tolerance_used,
                       .outer = report.surface},
                      monitor);
}

HollowReport write_to(AnnouncedFile& pending, const HollowedModel& hollowed, const HollowOptions& options,
                      Monitor& monitor) {
  HollowReport report = hollowed.report;
  report.modifiers = options.modifiers;
  const auto check = [&](const Mesh& written) {
    report.output = check_written(written, hollowed, report, monitor);
    report.output_path = options.output;
    report.output_bytes = std::filesystem::file_size(pending.file().path());
    if (!options.modifiers)
      report.balance = balance_of(hollowed.model.mesh, report.output, UprightFrame(report.limits.roof.up));
    if (report.balance.tips_over()) warn_of_tipping(report, monitor);
  };
  write_checked(hollowed.solid, pending, solid_format_of(options), check, monitor);
  return report;
}

}  // namespace

HollowedModel carve_model(const HollowOptions& options, Monitor& monitor) {
  HollowReport report;
  report.method = options.packing.method;
  report.tolerance_asked = options.tolerance;
  report.max_triangles = options.max_triangles;
  report.material = options.material;

  // Modifiers have no walls to pay for, and leave the model solid.
  const PackingRequest request =
      options.modifiers ? options.packing : without_voids_that_cost(options.packing, options, monitor);
  report.limits = request.limits();
  report.process = request.process;
  if (options.drainage) require_room_for_tubes(*options.drainage, request.limits());
  if (!options.modifiers && !options.drainage)
    warn_of_trapped_material(options.packing.process.process, monitor);
  PreparedModel model = load_and_inspect(options.model, options.load, monitor);
  const double voxel_size =
      options.voxel_size.value_or(default_voxel_size(options.packing.limits(), model.inspection.box));
  model = make_usable(std::move(model), {options.surface, options.max_hole, voxel_size}, monitor);
  report.input = model.input;
  report.surface = model.level_set ? OuterSurface::remeshed : OuterSurface::kept;
  if (model.level_set) report.voxel_size = model.level_set->voxel_size();
  report.outer_deviation = model.outer_deviation;
  report.volume_estimated = model.inspection.parts_overlap();

  auto [packing, surface] = pack_model(model, request, monitor);
  report.packing_statistics = packing.statistics;
  report.packing_device = packing.device;
  std::optional<OuterWithHoles> with_holes;
  if (options.drainage) {
    monitor.stage("drain");
    warn_of_wide_tubes(request.process, request.limits().roof, *options.drainage, monitor);
    auto [drainage, outer] =
        drain_packing(model, surface, packing, *options.drainage, options.tolerance, monitor);
    report.drainage = std::move(drainage);
    with_holes = std::move(outer);
  }
  report.packing_density = total_volume(packing) / model.inspection.filled_volume;

  VoidPlan plan{packing.spheres, request.limits().roof};
  const std::size_t outer_triangles = model.mesh.triangles.size();
  report.tolerance_used = tolerance_for(plan, options.tolerance, outer_triangles, options.max_triangles);
  if (report.tolerance_used > options.tolerance)
    monitor.notice(fmt::format("the tolerance is {:.3g} mm instead of {:.3g} mm to stay within {} triangles",
                               report.tolerance_used, options.tolerance, *options.max_triangles));
  require_memory_for_voids(plan, report.tolerance_used, outer_triangles);

  monitor.stage("carve");
  std::optional<DrainedSolid> drained;
  if (with_holes)
    drained = carve_within(model, std::move(*with_holes), packing, report.drainage->plan,
                           report.tolerance_used, options.max_triangles, monitor);
  Solid solid =
      drained ? as_solid(*drained) : carve(model, plan, {.tolerance = report.tolerance_used}, monitor);
  monitor.check_interrupted();
  return {std::move(report),  std::move(plan),  std::move(model),
          std::move(surface), std::move(solid), std::move(drained)};
}

HollowReport write_hollowed(const HollowedModel& hollowed, const HollowOptions& options, Monitor& monitor) {
  AnnouncedFile pending(options.output, monitor);
  return write_to(pending, hollowed, options, monitor);
}

HollowReport hollow(const HollowOptions& options, Monitor& monitor) {
  static_cast<void>(solid_format_of(options));  // refuses what cannot be written
  require_other_file(options.model, options.output);
  JobLog log(monitor);
  // Made before the long stages, so that a place that cannot be written to is found at once.
  AnnouncedFile pending(options.output, log);
  HollowedModel hollowed = carve_model(options, log);
  if (!options.modifiers && prints_filament(options)) {
    log.stage("predict");
    hollowed.report.print = predict_print(hollowed.model.mesh, hollowed.solid, hollowed.plan, options, log);
  }
  HollowReport report = write_to(pending, hollowed, options, log);
  report.stages = log.finish();
  report.notices = log.notices();
  return report;
}

}  // namespace aerate
