#include "pipeline/inspect_model.h"

#include <utility>

#include "pipeline/job_log.h"
#include "pipeline/prepare.h"
#include "pipeline/scene_of.h"
#include "pipeline/view_files.h"

namespace aerate {

namespace {

// All but what is told of the stages. The mesh is kept if it is to be shown.
InspectedModel look_at(const InspectOptions& options, bool is_shown, JobLog& log) {
  InspectedModel inspected;
  InspectReport& report = inspected.report;
  PreparedModel model = load_and_inspect({options.model, options.arrays}, options.load, log);
  report.input = model.input;
  if (options.self_intersections == SelfIntersectionSearch::on) {
    log.stage("self-intersections");
    report.self_intersections = find_self_intersections(model.mesh);
  }
  if (options.drainage) {
    log.stage("drainage");
    report.drainage = inspect_drainage_of(model, *options.drainage, log);
  }
  if (options.overhangs) {
    log.stage("overhangs");
    report.overhangs = find_overhangs_of(model, *options.overhangs, log);
  }
  if (is_shown) inspected.mesh = model.mesh;
  ModelUse use = use_of(std::move(model), {.mode = SurfaceMode::automatic, .weld = options.weld});
  inspected.refusal = std::move(use.refusal);
  report.use = std::move(use.words);
  return inspected;
}

}  // namespace

InspectedModel inspect_to_show(const InspectOptions& options, Monitor& monitor) {
  JobLog log(monitor);
  InspectedModel inspected = look_at(options, true, log);
  end_job(log, inspected.report, [] {});
  return inspected;
}

InspectReport inspect_model(const InspectOptions& options, Monitor& monitor) {
  JobLog log(monitor);
  ViewFiles views(options.views, log);
  InspectedModel inspected = look_at(options, options.views.are_asked_for(), log);
  InspectReport report = std::move(inspected.report);
  views.write([&] { return scene_of(inspected.mesh, report); }, log);
  end_job(log, report, [&] { views.commit_with({}); });
  return report;
}

}  // namespace aerate
