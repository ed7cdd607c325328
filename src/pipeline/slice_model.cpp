#include "pipeline/slice_model.h"

#include <algorithm>
#include <cstddef>
#include <fmt/format.h>
#include <iterator>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/error.h"
#include "files/formats.h"
#include "files/output_file.h"
#include "pipeline/announced_file.h"
#include "pipeline/job_log.h"
#include "pipeline/prepare.h"
#include "pipeline/scene_of.h"
#include "pipeline/view_files.h"
#include "printing/slicers/child_process.h"
#include "printing/slicers/ini_settings.h"
#include "printing/slicers/setting_names.h"
#include "printing/slicers/text_file.h"

namespace aerate {
namespace {

// A slip such as `-o part.stl` would put G-code where a model is looked for.
void require_no_models_name(const std::filesystem::path& output) {
  if (!is_a_models_name(output)) return;
  throw UsageError(output.string() + ": a model's name, and what is written is G-code",
                   "give a name such as " + output.stem().string() + ".gcode");
}

// The first few names that are not known, each with the one that may be meant.
std::string some_of(const std::vector<std::string>& unknown,
                    const std::set<std::string, std::less<>>& known) {
  constexpr std::size_t kShown = 3;
  const std::vector<std::string_view> names(known.begin(), known.end());
  std::string text;
  for (std::size_t i = 0; i < std::min(kShown, unknown.size()); ++i) {
    text += (i == 0 ? "" : ", ") + on_one_line(unknown[i]);
    if (const std::string_view meant = nearest_name(unknown[i], names); !meant.empty())
      text += fmt::format(" (is {} meant?)", meant);
  }
  return unknown.size() > kShown ? text + ", .." : text;
}

// The settings of a print that a project holds come before the user's. A mesh is all that is sliced of it.
SlicerSettings settings_with_project(const SliceModelOptions& options, const std::filesystem::path& scratch,
                                     JobLog& log) {
  SlicerSettings settings;
  const std::filesystem::path& model = options.request.hollow.model;
  if (!is_project(model)) return options.settings;
  for (const SlicerProfile& slicer : slicers()) {
    if (slicer.project == nullptr) continue;
    const ProjectFacts facts = slicer.project(model);
    for (const std::string& setting : facts.beyond_mesh)
      log.notice("the project has " + on_one_line(setting) + ", which is not used: its mesh alone is sliced");
    if (facts.settings.empty() && !facts.has_unread_settings) continue;
    if (slicer.name != options.slicer->name || facts.has_unread_settings) {
      if (options.settings.files.empty())
        throw InputError(
            fmt::format("{}: the settings in the project are {}'s and not read, so that {} would print with "
                        "its defaults",
                        model.string(), slicer.name, options.slicer->name),
            fmt::format("give {}'s settings as --config", options.slicer->name));
      log.notice("the settings in the project are " + slicer.name + "'s and not used: give " +
                 options.slicer->name + "'s as --config");
      continue;
    }
    log.notice("the settings in the project are used where --config gives none");
    const std::filesystem::path file = scratch / "project.ini";
    write_bytes(facts.settings, file);
    settings.files.push_back(file);
  }
  for (const std::filesystem::path& file : options.settings.files) settings.files.push_back(file);
  return settings;
}

// Slicers say nothing of settings that they do not know, and print with their defaults.
void require_known_settings(const SliceModelOptions& options, const Slicer& slicer, JobLog& log) {
  std::set<std::string, std::less<>> known;
  for (const auto& [key, value] : slicer.facts.settings) known.insert(key);
  if (known.empty()) return;
  for (const std::filesystem::path& file : options.settings.files) {
    const SettingNames names = names_in(plain_settings(read_text(file)), known);
    if (names.unknown.empty()) continue;
    const std::string which = some_of(names.unknown, known);
    if (names.known == 0)
      throw InputError(
          fmt::format("{}: {} knows none of its settings ({})", file.string(), slicer.profile->name, which),
          "export the settings in use: File, Export, Export Config");
    log.notice(fmt::format("{}: {} of {} settings are not known to {} and not used: {}", file.string(),
                           names.unknown.size(), names.unknown.size() + names.known, slicer.profile->name,
                           which));
  }
}

// Without forms that the slicer put elsewhere than the solid print. Throws FailureError if that was asked for.
void add(SliceReport& report, TriedForms tried, const FormJob& job) {
  const std::vector<ExtrusionMove> solid = extrusion_moves(read_text(report.forms.front().gcode));
  for (SlicedForm& form : tried.sliced) {
    if (const auto displacement = displacement_of(form, solid)) {
      if (job.request.form) throw FailureError(*displacement);
      report.skipped.push_back({form.name(), std::nullopt, *displacement});
    } else {
      report.forms.push_back(std::move(form));
    }
  }
  std::ranges::move(tried.skipped, std::back_inserter(report.skipped));
}

// If nothing can be removed and the form is left open, the solid model is all there is.
void slice_what_can_be_hollowed(const std::vector<PrintForm>& forms, const FormJob& job, SliceReport& report,
                                JobLog& log) {
  try {
    add(report, slice_hollowed(forms, job, report.print, log), job);
  } catch (const NothingToRemoveError& error) {
    if (job.request.form) throw;
    log.notice(std::string(error.what()) + "; the solid model is what was written");
  }
}

// Throws UsageError for a pattern that the slicer has not.
std::vector<SparsePattern> patterns_to_try(const SliceModelOptions& options) {
  std::vector<SparsePattern> patterns = options.slicer->patterns;
  const FormRequest& request = options.request;
  if (request.form == PrintForm::pattern) {
    std::erase_if(patterns, [&](const SparsePattern& each) { return each.name != request.pattern; });
    if (patterns.empty())
      throw UsageError(fmt::format("{} cannot be asked for {} infill", options.slicer->name, request.pattern),
                       "set it in --config, and leave out --as");
  } else if (request.form || options.comparison == Comparison::forms) {
    patterns.clear();
  } else if (options.comparison == Comparison::lightning) {
    // In dense prints patterns are no choice, and take some slicers minutes.
    const bool tells_infill = options.slicer->described_print != nullptr;
    patterns.resize(std::min<std::size_t>(patterns.size(), tells_infill ? 1 : 0));
  }
  return patterns;
}

// Without those that would be the print itself, or that slicers do not make so dense or so sparse.
void slice_what_can_be_sparse(std::vector<SparsePattern> patterns, const FormJob& job, SliceReport& report,
                              JobLog& log) {
  if (report.print && !job.request.form) {
    const double infill = report.print->settings.infill;
    std::erase_if(patterns, [&](const SparsePattern& each) { return each.name == report.print->pattern; });
    if (infill <= 0 || infill >= 1) {
      for (const SparsePattern& each : patterns)
        report.skipped.push_back(
            {each.name, std::nullopt, fmt::format("no pattern of {:g} % infill", 100 * infill)});
      return;
    }
  }
  add(report, slice_patterns(patterns, report.forms.front(), job, log), job);
}

// Of the form that is written, with the slicer's figures.
Scene scene_of_best(SliceReport& report, const HollowOptions& model, JobLog& log) {
  SlicedForm& best = report.forms[report.chosen];
  Scene scene;
  if (best.scene) {
    scene = std::move(*best.scene);
  } else {
    const PreparedModel read = load_and_inspect({model.model}, model.load, log);
    scene = scene_of(read.mesh, read.input);
  }
  if (report.print) scene.layer_height = report.print->settings.layer_height;
  const GcodeFigures& solid = report.forms.front().figures;
  const auto add = [&](const char* name, const std::optional<double>& from, const std::optional<double>& to,
                       const char* unit, double unit_size) {
    if (!from || !to) return;
    const std::string value = fmt::format("{:.1f}", *to / unit_size);
    scene.figures.push_back({name, report.chosen == 0
                                       ? fmt::format("{} {}", value, unit)
                                       : fmt::format("{:.1f} -> {} {}", *from / unit_size, value, unit)});
  };
  add("filament", solid.filament_mm, best.figures.filament_mm, "m", 1000);
  add("print time", solid.seconds, best.figures.seconds, "min", 60);
  scene.figures.push_back({"sliced as", fmt::format("{} by {}", best.name(), report.slicer.profile->name)});
  return scene;
}

}  // namespace

std::string SliceReport::use(const SlicedForm& form) const {
  if (form.form != PrintForm::pattern) return use_of(form.form);
  return std::ranges::find(slicer.profile->patterns, form.pattern, &SparsePattern::name)->good_for;
}

SliceReport slice_model(const SliceModelOptions& options, Monitor& monitor) {
  const FormRequest& request = options.request;
  require_no_models_name(options.output);
  SliceReport report;
  report.model = request.hollow.model;
  report.output = options.output;
  report.slicer = find_slicer(*options.slicer, request.slicer_path);
  require_settings(options.settings, *options.slicer);
  const std::vector<PrintForm> hollowed =
      forms_to_try(request.form, *options.slicer, options.comparison == Comparison::patterns);
  const std::vector<SparsePattern> patterns = patterns_to_try(options);

  JobLog log(monitor);
  if (have_post_processing(options.settings))
    log.notice("the post-processing programs of the settings are not run");
  AnnouncedFile pending(options.output, log);
  ViewFiles views(options.views, log);
  const PrivateFolder scratch(log);
  report.slicer.facts = ask_slicer(report.slicer, scratch.path(), log);
  require_known_settings(options, report.slicer, log);
  FormJob job{request, report.slicer, settings_with_project(options, scratch.path(), log), scratch.path()};
  job.wants_scenes = options.views.are_asked_for();
  job.place = place_for(job.slicer, job.settings);
  report.forms.push_back(slice_solid(job, log));
  // What the print is decides what is worth slicing.
  {
    const std::string solid = read_text(report.forms.front().gcode);
    report.print = described_print(*options.slicer, solid);
    job.supports_everywhere = has_supports_everywhere(*options.slicer, solid);
  }
  slice_what_can_be_sparse(patterns, job, report, log);
  const std::size_t unhollowed = report.forms.size(), skipped = report.skipped.size();
  if (!hollowed.empty()) slice_what_can_be_hollowed(hollowed, job, report, log);
  if (report.forms.size() > 1) report.chosen = choose_form(report.forms, request.form);
  if (report.chosen == 0 && (report.forms.size() > unhollowed || report.skipped.size() > skipped))
    log.notice("no hollowed form takes less filament than the solid model, so that is what was written");

  write_bytes(read_text(report.best().gcode), pending.file());
  views.write([&] { return scene_of_best(report, request.hollow, log); }, log);
  end_job(log, report, [&] { views.commit_with({&pending.file()}); });
  return report;
}

}  // namespace aerate
