#include "pipeline/inspect_model.h"

#include <utility>

#include "pipeline/job_log.h"
#include "pipeline/prepare.h"
#include "pipeline/scene_of.h"
#include "pipeline/view_files.h"

namespace aerate {

InspectReport inspect_model(const InspectOptions& options, Monitor& monitor) {
  JobLog log(monitor);
  InspectReport report;
  ViewFiles views(options.views, log);
  PreparedModel model = load_and_inspect(options.model, options.load, log);
  report.input = model.input;
  if (options.self_intersections == SelfIntersectionSearch::on) {
    log.stage("self-intersections");
    report.self_intersections = find_self_intersections(model.mesh);
  }
  if (options.drainage) {
    log.stage("drainage");
    report.drainage = inspect_drainage_of(model, *options.drainage, log);
  }
  const Mesh as_read = options.views.are_asked_for() ? model.mesh : Mesh{};
  report.use = use_of(std::move(model), {.mode = SurfaceMode::automatic, .weld = options.weld});
  views.write([&] { return scene_of(as_read, report); }, log);
  views.commit_with({});
  report.stages = log.finish();
  report.notices = log.notices();
  return report;
}

}  // namespace aerate
