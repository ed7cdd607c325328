#include "pipeline/hook.h"

#include <cstdlib>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

#include "core/error.h"
#include "core/listed.h"
#include "files/output_file.h"
#include "pipeline/announced_file.h"
#include "pipeline/job_log.h"
#include "pipeline/model_of_print.h"
#include "printing/slicers/child_process.h"
#include "printing/slicers/gcode_match.h"
#include "printing/slicers/text_file.h"

namespace aerate {
namespace {

namespace fs = std::filesystem;

// What to do where the hook cannot.
constexpr const char* kHollowFirst =
    "what was set in the slicer's window for objects, layers or faces is not in a mesh: hollow the model "
    "first "
    "('aerate hollow') and set it there";

constexpr const char* kHollowInsteadOfFuzzy =
    "switch fuzzy skin off, or hollow the model first ('aerate hollow')";

constexpr const char* kNoFormHoldsAll =
    "inside a hollow there may be supports, layers and tools that the solid print has not: try --as "
    "modifiers "
    "or voids, or other settings of the slicer";

// The block of comments begins and ends with these.
constexpr std::string_view kBegin = "; aerate = begin\n", kEnd = "; aerate = end\n";

std::string read_gcode(const fs::path& path) {
  std::error_code error;
  if (!fs::is_regular_file(path, error)) throw InputError(path.string() + ": is not a file");
  std::string text = read_text(path);
  if (is_binary_gcode(text)) {
    throw InputError(
        path.string() + ": is binary G-code, which a script cannot edit",
        "switch off \"Supports binary G-code\" in the slicer's printer settings (Printers, General)");
  }
  if (origin_of(text).slicer == nullptr || !extrudes(text)) {
    throw InputError(path.string() + ": is not G-code of a slicer that is known here",
                     listed(of_slicers(&SlicerProfile::family), "and") + " are");
  }
  if (text.find("\n" + std::string(kBegin)) != std::string::npos)
    throw InputError(path.string() + ": has been through aerate already", "slice again");
  return text;
}

// The slicer that can repeat what it did from its own G-code.
Slicer slicer_of(const GcodeOrigin& origin, const HookOptions& options) {
  if (!origin.slicer->repeats_gcode) {
    throw UsageError(fmt::format("{}: {} cannot be run again from the settings in its G-code",
                                 options.gcode.string(), origin.name),
                     "hollow the model before slicing, or leave out --model to annotate only");
  }
  return find_slicer(*origin.slicer, options.request.slicer_path);
}

// What the G-code holds that is compared with what the model gives.
struct Original {
  explicit Original(std::string_view gcode)
      : moves(extrusion_moves(gcode)),
        log(log_of_print(gcode)),
        has_fuzzy_skin(setting_in(gcode, "fuzzy_skin").value_or("none") != "none") {}

  std::vector<ExtrusionMove> moves;
  PrintLog log;
  bool has_fuzzy_skin;
};

// The solid model where the print is, if the slicer puts it where it is told.
SlicedForm slice_solid_in_place(FormJob& job, const Original& original, Monitor& monitor) {
  SlicedForm solid = slice_solid(job, monitor);
  if (!job.place) return solid;
  const auto shift = shift_of(original.moves, extrusion_moves(read_text(solid.gcode)));
  if (!shift) return solid;
  job.place->x += shift->x;
  job.place->y += shift->y;
  return slice_solid(job, monitor);
}

void require_match(const Original& original, const SlicedForm& solid, const Slicer& slicer,
                   const GcodeOrigin& origin, const HookOptions& options) {
  const std::string gcode = read_text(solid.gcode);
  auto difference = difference_of(original.moves, extrusion_moves(gcode));
  const bool is_elsewhere = difference.has_value();
  if (!difference) difference = difference_of(original.log, log_of_print(gcode));
  if (!difference) return;
  if (original.has_fuzzy_skin) *difference += ": fuzzy skin is random, so it cannot be compared";
  const std::string slicer_name = origin_of(gcode).name;
  throw InputError(
      fmt::format("{}: sliced with the settings of {} it does not give the same G-code ({})",
                  options.request.hollow.model.string(), options.gcode.filename().string(), *difference),
      slicer_name != origin.name
          ? fmt::format("the G-code is by {}, and {} is {}: give the program that made it as --slicer-path",
                        origin.name, slicer.program.string(), slicer_name)
      : original.has_fuzzy_skin ? kHollowInsteadOfFuzzy
      : is_elsewhere
          ? "it has to be the only object on the plate, as it stands in the file: not turned, scaled, "
            "mirrored, cut or moved; a project saved as 3MF keeps its place"
          : kHollowFirst);
}

// Of a project saved as 3MF the slicer knows more than the mesh, which is all that is sliced again.
ProjectFacts facts_of_project(const HookOptions& options, const Slicer& slicer) {
  const fs::path& model = options.request.hollow.model;
  if (!is_project(model) || slicer.profile->project == nullptr) return {};
  ProjectFacts facts = slicer.profile->project(model);
  if (!facts.beyond_mesh.empty())
    throw InputError(fmt::format("{}: the project has {}, which would be lost", model.string(),
                                 on_one_line(facts.beyond_mesh.front())),
                     kHollowFirst);
  return facts;
}

// As the G-code calls it, if it does, since it may have been renamed on the plate; else as the slicer would.
std::string object_name_in(const std::string& gcode, const ProjectFacts& facts, const Slicer& slicer,
                           const fs::path& model) {
  if (slicer.profile->labelled_object != nullptr) {
    if (auto name = slicer.profile->labelled_object(gcode)) return *name;
  }
  if (!facts.object_name.empty()) return facts.object_name;
  return is_project(model) ? "" : model.filename().string();
}

// Why a hollowed print cannot take the original's place, if it does not do all that this does beside moving.
std::optional<std::string> loss_in(const SlicedForm& form, const Original& original) {
  const auto difference = difference_in_commands(original.log, log_of_print(read_text(form.gcode)));
  if (!difference) return std::nullopt;
  return fmt::format("the print with {} does not do all that the G-code does ({})", name_of(form.form),
                     *difference);
}

// Without them the slicer would take its defaults, or stumble.
void require_settings_in(const std::string& gcode, const HookOptions& options) {
  if (setting_in(gcode, "layer_height")) return;
  throw InputError(
      options.gcode.string() + ": the slicer's settings are not in it, so it cannot be sliced again",
      "switch off whatever takes the last lines of the G-code away, or leave out --model");
}

std::string comments_for(const HookReport& report) {
  const SlicedForm& best = report.best();
  std::string text(kBegin);
  text += fmt::format("; aerate_result = {}\n", report.result());
  if (!report.remark.empty()) text += fmt::format("; aerate_remark = {}\n", on_one_line(report.remark));
  for (const auto& [name, figure, decimals] : kNamedFigures) {
    const std::optional<double> before = report.forms.front().figures.*figure, now = best.figures.*figure;
    if (!now) continue;
    text += fmt::format("; aerate_{} = {:.{}f}", name, *now, decimals);
    if (report.chosen > 0 && before) text += fmt::format(" (solid {:.{}f})", *before, decimals);
    text += '\n';
  }
  text += fmt::format("; aerate_layers = {}\n", best.figures.layers);
  if (best.hollow) {
    const OutputFacts& facts = best.hollow->output;
    text +=
        fmt::format("; aerate_voids = {}, radius {:.3f} to {:.3f} mm, {:.1f} mm3, wall {:.3f} mm at least\n",
                    facts.void_count, facts.smallest_radius, facts.largest_radius, facts.volume_removed,
                    facts.clearances.wall);
  }
  return text + std::string(kEnd);
}

// In one line, for a comment.
std::string reason_of(const Error& error) {
  return error.hint().empty() ? error.what() : fmt::format("{}; {}", error.what(), error.hint());
}

// The print stays as the slicer made it.
void leave_as_it_is(HookReport& report, const Error& error) {
  report.forms.resize(1);
  report.chosen = 0;
  report.remark = reason_of(error);
  report.is_refused = true;
}

// PrusaSlicer takes another name for the print from a file beside the G-code (its post-processing scripts, "output name").
constexpr const char* kOutputName = "SLIC3R_PP_OUTPUT_NAME";
constexpr const char* kNewName = ".output_name";

std::optional<std::string> output_name() {
  const char* const name = std::getenv(kOutputName);
  return name != nullptr && *name != '\0' ? std::optional<std::string>(name) : std::nullopt;
}

// "part.gcode" becomes "part_aerate-12pct.gcode".
std::optional<std::string> name_with_saving(const HookReport& report) {
  const auto given = output_name();
  if (!given || report.chosen == 0) return std::nullopt;
  const fs::path name = fs::path(*given).filename();
  const double saved = filament_saved(report.forms.front().figures, report.best().figures);
  return fmt::format("{}_aerate-{:.0f}pct{}", name.stem().string(), 100 * saved, name.extension().string());
}

std::string joined(const std::vector<std::string>& remarks) {
  return fmt::format("{}", fmt::join(remarks, "; "));
}

// Solid, then hollowed as far as that is possible.
void slice_forms(const std::string& original, const HookOptions& options, const fs::path& scratch,
                 HookReport& report, JobLog& log) {
  Slicer slicer = slicer_of(report.origin, options);
  require_settings_in(original, options);
  const FormRequest& request = options.request;
  const std::vector<PrintForm> hollowed = forms_to_try(request.form, *slicer.profile);
  // A slicer tells G-code by its ending, and the file that a script gets may have another.
  const fs::path settings = scratch / "settings.gcode";
  write_bytes(original, settings);
  slicer.facts = ask_slicer(slicer, scratch, log);
  const fs::path& model = request.hollow.model;
  const ProjectFacts facts = facts_of_project(options, slicer);
  FormJob job{request,
              slicer,
              {{settings}},
              scratch,
              is_project(model),
              object_name_in(original, facts, slicer, model),
              has_supports_everywhere(*slicer.profile, original)};
  if (!job.keep_place) job.place = place_for(slicer, job.settings);
  const Original read(original);
  const SlicedForm solid = slice_solid_in_place(job, read, log);
  log.stage("compare");
  require_match(read, solid, slicer, report.origin, options);
  report.forms.front().slicer_seconds = solid.slicer_seconds;
  report.print = described_print(*slicer.profile, original);
  std::vector<std::string> losses;
  try {
    TriedForms tried = slice_hollowed(hollowed, job, report.print, log);
    report.skipped = std::move(tried.skipped);
    for (SlicedForm& form : tried.sliced) {
      if (const auto displacement = displacement_of(form, read.moves)) throw FailureError(*displacement);
      if (auto loss = loss_in(form, read)) {
        losses.push_back(std::move(*loss));
      } else {
        report.forms.push_back(std::move(form));
      }
    }
  } catch (const NothingToRemoveError& error) {
    // Not a failure of the print: the script may stand in the settings for models of any size.
    report.remark = error.what();
    return;
  }
  report.remark = joined(losses);
  // What another form would lose is no reason to refuse one that loses nothing.
  if (report.forms.size() == 1 && !losses.empty()) throw FailureError(report.remark, kNoFormHoldsAll);
  for (const std::string& loss : losses) log.notice(loss);
  if (report.forms.size() > 1) report.chosen = choose_form(report.forms, request.form);
  if (report.chosen > 0) return;
  losses.insert(losses.begin(), "no hollowed form takes less filament");
  report.remark = joined(losses);
}

std::string new_content(const std::string& original, const HookReport& report) {
  if (report.chosen == 0) return with_comments(original, comments_for(report));
  std::string gcode = with_setting_of(read_text(report.best().gcode), original, kPostProcess);
  return with_comments(with_thumbnails_of(std::move(gcode), original), comments_for(report));
}

HookOptions with_model_found(HookOptions options, const std::string& gcode, const SlicerProfile& slicer,
                             Monitor& monitor) {
  const HollowOptions& hollow = options.request.hollow;
  if (options.model_folder.empty() || !hollow.model.empty()) return options;
  PrintNames names{.object = std::nullopt, .output = output_name().value_or("")};
  if (slicer.labelled_object != nullptr) names.object = slicer.labelled_object(gcode);
  options.request.set_model(
      model_of_print(options.model_folder, names, size_of_print(gcode), hollow.load, monitor));
  return options;
}

}  // namespace

HookReport run_hook(const HookOptions& options, Monitor& monitor) {
  if (std::getenv(kSlicedByVariable) != nullptr) {
    throw UsageError("the hook was called by a slicer that aerate itself runs",
                     "remove it from the slicer's own default settings");
  }
  JobLog log(monitor);
  HookReport report;
  report.gcode = options.gcode;
  log.stage("read");
  const std::string original = read_gcode(options.gcode);
  report.origin = origin_of(original);
  report.forms.push_back({.form = PrintForm::solid,
                          .figures = figures_of(original, *report.origin.slicer),
                          .gcode = options.gcode,
                          .hollow = std::nullopt});
  AnnouncedFile pending(options.gcode, log);
  const PrivateFolder scratch(log);
  try {
    if (options.refused) throw Error(*options.refused);
    const HookOptions complete = with_model_found(options, original, *report.origin.slicer, log);
    if (complete.request.hollow.model.empty()) {
      report.remark = "no model was given";
    } else {
      slice_forms(original, complete, scratch.path(), report, log);
    }
  } catch (const Error& error) {
    if (options.is_strict || error.code() == ExitCode::interrupted) throw;
    leave_as_it_is(report, error);
  }
  log.stage("write");
  const std::string content = new_content(original, report);
  log.check_interrupted();
  pending.commit_text(content);
  if (options.names_saving) report.new_name = name_with_saving(report);
  if (report.new_name) {
    AnnouncedFile name(options.gcode.string() + kNewName, log);
    name.commit_text(*report.new_name + '\n');
  }
  report.stages = log.finish();
  report.notices = log.notices();
  return report;
}

}  // namespace aerate
