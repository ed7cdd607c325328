#include "pipeline/slice_model.h"

#include <utility>

#include "pipeline/announced_file.h"
#include "pipeline/job_log.h"
#include "printing/slicers/child_process.h"
#include "printing/slicers/text_file.h"

namespace aerate {

SliceReport slice_model(const SliceModelOptions& options, Monitor& monitor) {
  require_other_file(options.hollow.model, options.output);
  SliceReport report;
  report.model = options.hollow.model;
  report.output = options.output;
  report.choice = options.form;
  report.slicer = find_slicer(options.slicer, options.slicer_path);
  require_settings(options.settings);
  const std::vector<PrintForm> hollowed = forms_to_try(options.form, options.slicer);

  JobLog log(monitor);
  if (have_post_processing(options.settings))
    log.notice("the post-processing programs of the settings are not run");
  AnnouncedFile pending(options.output, log);
  const PrivateFolder scratch(log);
  const FormJob job{.slicer = report.slicer,
                    .settings = options.settings,
                    .hollow = options.hollow,
                    .modifier_infill_percent = options.modifier_infill_percent,
                    .scratch = scratch.path()};
  // Hollowing is quick beside slicing, and says sooner that nothing can be removed.
  std::vector<SlicedForm> forms;
  forms.reserve(hollowed.size() + 1);
  for (const PrintForm form : hollowed) forms.push_back(slice_form(form, job, log));
  forms.insert(forms.begin(), slice_form(PrintForm::solid, job, log));
  report.forms = std::move(forms);
  report.chosen = choose_form(report.forms, options.form);
  if (report.chosen == 0)
    log.notice("no hollowed form takes less filament than the solid model, so that is what was written");

  pending.commit_text(read_text(report.forms[report.chosen].gcode));
  report.stages = log.finish();
  report.notices = log.notices();
  return report;
}

}  // namespace aerate
