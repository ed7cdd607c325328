#include "pipeline/hollow.h"

#include <filesystem>
#include <fmt/format.h>
#include <optional>
#include <utility>
#include <vector>

#include "check/check_failure.h"
#include "check/check_opened.h"
#include "check/check_written.h"
#include "core/error.h"
#include "core/listed.h"
#include "packing/air/inspect_drainage.h"
#include "pipeline/announced_file.h"
#include "pipeline/balance.h"
#include "pipeline/best_form.h"
#include "pipeline/job_log.h"
#include "pipeline/own_cavities.h"
#include "pipeline/plug_file.h"
#include "pipeline/scene_of.h"
#include "pipeline/solid_file.h"
#include "pipeline/view_files.h"

namespace aerate {
namespace {

OuterSurface surface_of(const PreparedModel& model) {
  return model.level_set ? OuterSurface::remeshed : OuterSurface::kept;
}

// What was found on the written file.
struct WrittenFile {
  std::size_t bytes = 0;
  OutputFacts facts;
  Balance balance;
};

// By what was measured on the written file.
void require_standing(const Balance& balance, const StandFacts& stand) {
  constexpr double kMeasureError = 1e-6;  // mm
  if (!balance.margin_after || *balance.margin_after < stand.needed - kMeasureError)
    fail_check("its centre of mass is {:.6g} mm inside what it stands on, it has to be {:.6g} mm",
               balance.margin_after.value_or(0), stand.needed);
}

// Without a file, nothing is written but all is checked.
WrittenFile write_to(AnnouncedFile* pending, const HollowedModel& hollowed, const HollowOptions& options,
                     Monitor& monitor) {
  WrittenFile written;
  const auto check = [&](const Mesh& read_back) {
    written.facts = check_written(read_back,
                                  {.solid = hollowed.carved.solid,
                                   .model = hollowed.model->mesh,
                                   .surface = hollowed.surface,
                                   .inspection = hollowed.model->inspection,
                                   .packing = hollowed.packing,
                                   .cells = hollowed.cells ? &*hollowed.cells : nullptr,
                                   .drainage = hollowed.drainage ? &hollowed.drainage->plan : nullptr,
                                   .tolerance = hollowed.carved.tolerance,
                                   .outer = surface_of(*hollowed.model),
                                   .kept = hollowed.model->kept ? &*hollowed.model->kept : nullptr},
                                  monitor);
    if (hollowed.model->opened) require_no_sealed_cavity(read_back);
    if (pending != nullptr) written.bytes = std::filesystem::file_size(pending->file().path());
    if (options.modifiers) return;
    written.balance = balance_of(hollowed.model->mesh, written.facts, hollowed.packing.limits.roof.up);
    if (hollowed.stand) require_standing(written.balance, *hollowed.stand);
    warn_of_tipping(written.balance, written.facts, monitor);
  };
  write_beside(hollowed.carved.solid, pending, solid_format_of(options), check, monitor);
  return written;
}

// Everything that the stages found out.
HollowReport report_of(const HollowedModel& hollowed, const WrittenFile& written,
                       const HollowOptions& options,
                       const std::optional<PrintPrediction>& print = std::nullopt) {
  const PreparedModel& model = *hollowed.model;
  HollowReport report;
  report.input = model.input;
  report.limits = hollowed.request.limits();
  report.process = hollowed.request.process;
  report.method = name_of_method(options.packing);
  report.packing_statistics = hollowed.packing.statistics;
  report.cells = options.cells;
  const Roof roof_of_spheres = hollowed.request.sphere_limits().roof;
  report.packing_density =
      total_volume(hollowed.packing.spheres, roof_of_spheres) / model.inspection.filled_volume;
  report.packing_device = hollowed.packing.device;
  report.surface = surface_of(model);
  if (model.level_set) report.voxel_size = model.level_set->voxel_size();
  report.outer_deviation = model.outer_deviation;
  report.tolerance_asked = options.tolerance;
  report.tolerance_used = hollowed.carved.tolerance;
  report.max_triangles = options.max_triangles;
  report.modifiers = options.modifiers;
  report.support_blockers = options.support_blockers;
  if (const auto blockers = solid_format_of(options).blockers) report.blocker_growth = blockers->growth;
  report.output_path = options.output;
  report.output_bytes = written.bytes;
  report.output = written.facts;
  report.drainage = hollowed.drainage;
  report.build = options.build;
  report.volume_estimated = model.inspection.parts_overlap();
  report.balance = written.balance;
  report.target = hollowed.target;
  report.stand = hollowed.stand;
  if (model.kept) report.kept = {model.kept->count, model.kept->volume, written.facts.kept_wall};
  report.print = print;
  report.print_origins = options.print_origins;
  report.material = options.material;
  return report;
}

// What the layers of the result close in while they are printed; a channel is several columns wide.
std::optional<PrintedCups> cups_of(const HollowedModel& hollowed, const HollowOptions& options,
                                   Monitor& monitor) {
  constexpr double kColumnsPerChannel = 8;
  const Process& process = hollowed.request.process.process;
  if (!options.drainage || !process.limits.contains(Limit::cup)) return std::nullopt;
  monitor.stage("cups");
  const double spacing = 2 * options.drainage->channel_radius / kColumnsPerChannel;
  auto cups = printed_cups(cups_of(hollowed.carved.solid.mesh, hollowed.packing.limits.roof.up, spacing),
                           process, options.build);
  monitor.check_interrupted();
  warn_of_suction(*cups, process, monitor);
  return cups;
}

// The best form; if no void can be made in any, the model with its own cavities opened, where that is asked for.
HollowedForm carve_or_open(std::span<const JobForm> forms, Monitor& monitor) {
  const HollowOptions& options = forms.front().options;
  PreparedModels models;
  try {
    return carve_best_form(forms, models, monitor);
  } catch (const Error& error) {
    const bool asks_for_voids = options.plugs || options.target || options.stand;
    if (error.code() != ExitCode::nothing_to_remove || asks_for_voids) throw;
    auto opened = open_without_voids(options, models, monitor);
    if (!opened) throw;
    monitor.notice(
        fmt::format("no voids are made, only the model's own cavities are opened: {}", error.what()));
    return {&options, std::move(*opened), std::nullopt};
  }
}

// What stays in the result's voids and opened cavities together, which is found out on columns of its air.
std::optional<CavityFacts> cavities_of(const HollowedModel& hollowed, const HollowOptions& options,
                                       Monitor& monitor) {
  constexpr double kWidestHoles = 2;  // in holes of the request
  if (!hollowed.model->opened) return std::nullopt;
  CavityFacts facts{*hollowed.model->opened, std::nullopt};
  if (facts.opened.cavities.empty()) return facts;
  monitor.stage("pools");
  const double widest = kWidestHoles * 2 * options.drainage->hole_radius;
  facts.pools = inspect_drainage(hollowed.carved.solid.mesh,
                                 {.up = hollowed.packing.limits.roof.up, .widest_hole = widest}, monitor)
                    .pools;
  const TrappedPools& pools = *facts.pools;
  if (pools.after_both > 2 * kPoolsAimedAt * pools.total)
    monitor.notice(fmt::format(
        "{:.1f} mm3 ({:.1f} % of the voids and of the model's own cavities) cannot run out, neither in print "
        "orientation nor upside down",
        pools.after_both, 100 * pools.after_both / pools.total));
  return facts;
}

// Plugs are for the holes of voids.
void warn_of_unplugged(const OpenedCavities& opened, Monitor& monitor) {
  if (opened.hole_count() > 0)
    monitor.notice(fmt::format("the {} of the model's own cavities get no plugs",
                               counted(opened.hole_count(), "hole", "holes")));
}

}  // namespace

HollowReport write_hollowed(const HollowedModel& hollowed, const HollowOptions& options, Monitor& monitor) {
  AnnouncedFile pending(options.output, monitor);
  const WrittenFile written = write_to(&pending, hollowed, options, monitor);
  pending.file().commit();
  return report_of(hollowed, written, options);
}

HollowReport hollow(std::span<const JobForm> forms, Monitor& monitor) {
  return hollow(forms, monitor, [](const HollowedForm&, const HollowReport&, Monitor&) {});
}

HollowReport hollow(std::span<const JobForm> forms, Monitor& monitor, const AlsoMade& also) {
  const HollowOptions& options = forms.front().options;
  static_cast<void>(solid_format_of(options));  // refuses what cannot be written
  if (options.plugs) require_writable(*options.plugs);
  JobLog log(monitor);
  for (const std::string& remark : options.print_remarks) log.notice(remark);
  // Made before the long stages, so that a place that cannot be written to is found at once.
  std::optional<AnnouncedFile> pending;
  if (!options.output.empty()) pending.emplace(options.output, log);
  ViewFiles views(options.views, log);
  std::optional<AnnouncedFile> pending_plugs;
  if (options.plugs) pending_plugs.emplace(options.plugs->output, log);
  const HollowedForm best = carve_or_open(forms, log);
  const WrittenFile written = write_to(pending ? &*pending : nullptr, best.hollowed, *best.options, log);
  HollowReport report = report_of(best.hollowed, written, *best.options, best.print);
  if (!best.options->modifiers)
    warn_of_cavities(best.hollowed.model->inspection, best.hollowed.request.process.process, log);
  report.cups = cups_of(best.hollowed, *best.options, log);
  report.cavities = cavities_of(best.hollowed, *best.options, log);
  if (report.cavities && options.plugs) warn_of_unplugged(report.cavities->opened, log);
  std::vector<PendingFile*> results;
  if (pending_plugs) {
    report.plugs = write_plugs(*pending_plugs, best.hollowed, *options.plugs, log);
    results.push_back(&pending_plugs->file());
  }
  if (pending) results.push_back(&pending->file());
  views.write([&] { return scene_of(best.hollowed, report); }, log);
  also(best, report, log);
  end_job(log, report, [&] { views.commit_with(std::move(results)); });
  return report;
}

HollowReport hollow(const HollowOptions& options, Monitor& monitor) {
  const JobForm form{options};
  return hollow(std::span(&form, 1), monitor);
}

}  // namespace aerate
