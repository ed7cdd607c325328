#include "pipeline/print_forms.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <fmt/format.h>
#include <set>
#include <string>
#include <strings.h>
#include <utility>

#include "core/error.h"
#include "files/formats.h"
#include "files/load.h"
#include "pipeline/best_form.h"
#include "pipeline/held_notices.h"
#include "pipeline/hollow.h"
#include "pipeline/lightning_modifiers.h"
#include "pipeline/print_prediction.h"
#include "pipeline/scene_of.h"
#include "pipeline/solid_file.h"
#include "printing/slicers/gcode_match.h"
#include "printing/slicers/text_file.h"

namespace aerate {
namespace {

// A setting of PrusaSlicer from 2.7 on.
constexpr const char* kBinaryGcode = "binary_gcode";

// Of a form, in the scratch folder.
std::filesystem::path folder_of(const std::string& name, const FormJob& job) {
  std::filesystem::path folder = job.scratch / name;
  std::filesystem::create_directory(folder);
  return folder;
}

bool is_modifiers(PrintForm form) {
  return form == PrintForm::modifiers || form == PrintForm::lightning_modifiers;
}

// Whether voids get support blockers.
bool blocks_supports(PrintForm form, const FormJob& job) {
  const auto& format = job.slicer.profile->modifiers;
  return form == PrintForm::voids && job.supports_everywhere && format && format->has_blockers;
}

// What a slicer would call the model as STL.
std::string usual_name(const FormJob& job) {
  return job.request.hollow.model.stem().string() + ".stl";
}

std::string object_name(const FormJob& job) {
  return job.object_name.empty() ? usual_name(job) : job.object_name;
}

// Whether the slicer reads objects' names from a 3MF.
bool keeps_names(const FormJob& job) {
  const auto& format = job.slicer.profile->modifiers;
  return format && format->named != nullptr;
}

// The model's file in the form's folder. STL, whose object slicers name after the file; 3MF for modifiers and
// for other names of the object, which it carries.
std::filesystem::path model_file(PrintForm form, const FormJob& job) {
  std::string name = usual_name(job);
  const std::string stem = job.request.hollow.model.stem().string();
  if (is_modifiers(form) || blocks_supports(form, job)) {
    name = stem + job.slicer.profile->modifiers->ending;
  } else if (keeps_names(job) && object_name(job) != name) {
    name = stem + ".3mf";
  }
  // Slicers write a file's name into G-code, where a line feed would begin a command.
  return folder_of(name_of(form), job) / on_one_line(name);
}

// The name that goes into a 3MF, as text; none where it is not, or the slicer reads no names.
std::optional<ObjectName> name_in_3mf(const FormJob& job) {
  const std::string name = object_name(job);
  if (!keeps_names(job) || !is_utf8(name)) return std::nullopt;
  return ObjectName{job.slicer.profile, on_one_line(name)};
}

// As every slicer reads it, whatever the model came as.
void write_solid_model(const FormJob& job, const std::filesystem::path& path, Monitor& monitor) {
  monitor.stage("load");
  const HollowOptions& options = job.request.hollow;
  const Mesh mesh = load_model(options.model, options.load).mesh;
  const std::optional<ObjectName> name = name_in_3mf(job);
  const bool as_3mf = path.extension() == ".3mf";
  if (as_3mf && name) {
    write_named(mesh, path, *name);
  } else {
    write_mesh(mesh, path, as_3mf ? MeshFormat::three_mf : MeshFormat::stl);
  }
}

SlicedForm slice_file(PrintForm form, std::filesystem::path model, const FormJob& job, Monitor& monitor,
                      const std::string& pattern = {}) {
  SlicedForm sliced;
  sliced.form = form;
  sliced.pattern = pattern;
  monitor.check_interrupted();
  monitor.stage(fmt::format("slice {}", sliced.name()));
  const std::filesystem::path folder = model.parent_path();
  sliced.gcode = folder / "out.gcode";
  const auto begin = std::chrono::steady_clock::now();
  sliced.figures = slice(job.slicer,
                         {.model = std::move(model),
                          .gcode = sliced.gcode,
                          .settings = job.settings,
                          .pattern = pattern,
                          .keep_place = job.keep_place,
                          .place = job.keep_place ? std::nullopt : job.place,
                          .says_text = job.slicer.facts.settings.contains(kBinaryGcode),
                          .scratch = folder},
                         monitor);
  sliced.slicer_seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  return sliced;
}

HollowOptions printed_as(HollowOptions options, const std::optional<DescribedPrint>& print) {
  if (!print || !print->is_predictable) return options;
  options.print = print->settings;
  options.infill_is_known = true;
  return options;
}

// How a form is to be made, in several ways if it is open which is best.
std::vector<JobForm> options_for(PrintForm form, const FormJob& job,
                                 const std::optional<DescribedPrint>& print) {
  const FormRequest& request = job.request;
  std::vector<JobForm> ways;
  if (is_modifiers(form)) {
    HollowOptions options = printed_as(request.modifiers, print);
    options.modifiers = {job.slicer.profile, request.modifier_infill_percent};
    options.packing.process = walled_by_perimeters(std::move(options.packing.process), options.print);
    options.heavier = HeavierPrint::allow;  // what it takes is judged here
    if (form == PrintForm::lightning_modifiers)
      options = holding_lightning(std::move(options), kLightningInfill);
    ways.push_back({std::move(options)});
    return ways;
  }
  for (const HollowOptions& shaped : request.voids) {
    ways.push_back({printed_as(shaped, print)});
    // Which shape is better can be told of a print that is known alone.
    if (ways.back().options.infill_is_known) continue;
    ways.back().options.heavier = HeavierPrint::allow;  // the slicer's own figures say it
    break;
  }
  return ways;
}

// Without voids that cost more than they save; with all of them where no others are.
HollowedForm carve(std::vector<JobForm>& ways, PreparedModels& models, Monitor& monitor) {
  if (!ways.front().options.infill_is_known || ways.front().options.heavier == HeavierPrint::allow)
    return carve_best_form(ways, models, monitor);
  HeldNotices held(monitor);
  try {
    HollowedForm best = carve_best_form(ways, models, held);
    held.pass_on();
    return best;
  } catch (const Error& error) {
    if (error.code() != ExitCode::nothing_to_remove) throw;
    ways.resize(1);
    ways.front().options.heavier = HeavierPrint::allow;
    HeldNotices unsaid(monitor);  // that the print becomes heavier
    return carve_best_form(ways, models, unsaid);
  }
}

// How much more filament than solid, as a share.
double predicted_change(const PrintPrediction& print) {
  return print.filament_after_mm3 / print.filament_before_mm3 - 1;
}

// Whether more filament is predicted by more than the prediction may be off (docs/economics.md).
bool is_hopeless(const PrintPrediction& print) {
  constexpr double kUncertainOfChange = 0.1;
  constexpr double kWithOneWall = 0.04, kWithoutWalls = 0.09;
  const double change = predicted_change(print);
  double uncertain = std::max(kUncertainShare, kUncertainOfChange * std::abs(change));
  if (print.settings.perimeters < 2)
    uncertain = std::max(uncertain, print.settings.perimeters == 1 ? kWithOneWall : kWithoutWalls);
  return change > uncertain;
}

// What keeps supports out of voids, where they are built everywhere.
void tell_of_supports(const FormJob& job, Monitor& monitor) {
  if (!job.supports_everywhere) return;
  const SlicerProfile& slicer = *job.slicer.profile;
  if (blocks_supports(PrintForm::voids, job)) {
    monitor.notice("supports would be built in voids too: support blockers keep them out");
  } else {
    monitor.notice(fmt::format("supports are built in voids too, and stay there: {} keeps them out ({})",
                               slicer.supports_on_plate, slicer.name));
  }
}

// Passes each text on once, though the model is looked at for each form.
class EachNoticeOnce {
 public:
  explicit EachNoticeOnce(Monitor& monitor) : monitor_(monitor) {}
  void pass_on(HeldNotices& held) {
    for (const std::string& text : held.take())
      if (said_.insert(text).second) monitor_.notice(text);
  }

 private:
  Monitor& monitor_;
  std::set<std::string> said_;
};

// The form that takes the least filament of those that are candidates, or the first, which is solid.
template <typename IsCandidate>
std::size_t lightest_of(const std::vector<SlicedForm>& forms, const IsCandidate& is_candidate) {
  std::size_t lightest = 0;
  double most_saved = 0;
  for (std::size_t i = 1; i < forms.size(); ++i) {
    if (!is_candidate(forms[i])) continue;
    const double saved = filament_saved(forms[0].figures, forms[i].figures);
    if (saved <= most_saved) continue;
    most_saved = saved;
    lightest = i;
  }
  return lightest;
}

}  // namespace

const char* name_of(PrintForm form) {
  switch (form) {
    case PrintForm::solid:
      return "solid";
    case PrintForm::voids:
      return "voids";
    case PrintForm::modifiers:
      return "modifiers";
    case PrintForm::lightning_modifiers:
      return "lightning-modifiers";
    case PrintForm::pattern:
      return "pattern";
  }
  return "unknown";
}

const char* use_of(PrintForm form) {
  switch (form) {
    case PrintForm::voids:
      return "walls inside, for dense prints";
    case PrintForm::modifiers:
      return "infill between empty cells";
    case PrintForm::lightning_modifiers:
      return "infill along walls, holds up tops";
    case PrintForm::solid:
    case PrintForm::pattern:
      break;
  }
  return "";
}

void FormRequest::set_model(const std::filesystem::path& model) {
  hollow.model = modifiers.model = model;
  for (HollowOptions& options : voids) options.model = model;
}

bool is_project(const std::filesystem::path& model) {
  return ::strcasecmp(model.extension().c_str(), ".3mf") == 0;
}

std::vector<PrintForm> forms_to_try(std::optional<PrintForm> asked, const SlicerProfile& slicer,
                                    bool with_lightning) {
  const bool has_lightning = slicer.modifiers && slicer.modifiers->has_lightning;
  if (asked && is_modifiers(*asked) && !slicer.modifiers)
    throw UsageError(fmt::format("{} reads no modifiers", slicer.name),
                     "use --as voids, or --as auto, which leaves them out");
  if (asked == PrintForm::lightning_modifiers && !has_lightning)
    throw UsageError(fmt::format("modifiers for {} hold no lightning infill", slicer.name),
                     "use --as modifiers, in which there is no infill");
  if (asked == PrintForm::pattern) return {};
  if (asked) return {*asked};
  std::vector<PrintForm> forms{PrintForm::voids};
  if (slicer.modifiers) forms.push_back(PrintForm::modifiers);
  if (with_lightning && has_lightning) forms.push_back(PrintForm::lightning_modifiers);
  return forms;
}

std::optional<DescribedPrint> described_print(const SlicerProfile& slicer, std::string_view gcode) {
  if (slicer.described_print == nullptr) return std::nullopt;
  return slicer.described_print(gcode);
}

bool has_supports_everywhere(const SlicerProfile& slicer, std::string_view gcode) {
  return slicer.supports_everywhere != nullptr && slicer.supports_everywhere(gcode);
}

SlicedForm slice_solid(const FormJob& job, Monitor& monitor) {
  std::filesystem::path model = model_file(PrintForm::solid, job);
  write_solid_model(job, model, monitor);
  return slice_file(PrintForm::solid, std::move(model), job, monitor);
}

TriedForms slice_patterns(const std::vector<SparsePattern>& patterns, const SlicedForm& solid,
                          const FormJob& job, Monitor& monitor) {
  TriedForms tried;
  const std::filesystem::path name = model_file(PrintForm::solid, job).filename();
  for (const SparsePattern& pattern : patterns) {
    const std::filesystem::path model = folder_of(pattern.name, job) / name;
    std::filesystem::copy_file(solid.gcode.parent_path() / name, model);
    try {
      tried.sliced.push_back(slice_file(PrintForm::pattern, model, job, monitor, pattern.name));
    } catch (const FailureError& error) {
      if (job.request.form) throw;
      const std::string why = error.what();
      tried.skipped.push_back({pattern.name, std::nullopt, why.substr(0, why.find('\n'))});
    }
  }
  return tried;
}

TriedForms slice_hollowed(const std::vector<PrintForm>& forms, const FormJob& job,
                          const std::optional<DescribedPrint>& print, Monitor& monitor) {
  TriedForms tried;
  EachNoticeOnce notices(monitor);
  PreparedModels models;
  std::optional<NothingToRemoveError> refusal;
  bool all_refused = true;
  for (const PrintForm form : forms) {
    std::vector<JobForm> ways = options_for(form, job, print);
    for (JobForm& way : ways) {
      HollowOptions& options = way.options;
      options.output = model_file(form, job);
      options.object_name = name_in_3mf(job);
      if (blocks_supports(form, job)) options.support_blockers = job.slicer.profile;
    }
    HeldNotices held(monitor);
    try {
      const HollowedForm best = carve(ways, models, held);
      all_refused = false;
      const bool is_predicted = best.print && best.print->described;
      if (is_predicted && !job.request.form && is_hopeless(*best.print)) {
        tried.skipped.push_back({name_of(form), predicted_change(*best.print)});
        continue;
      }
      HollowReport report = write_hollowed(best.hollowed, *best.options, held);
      if (form == PrintForm::voids) tell_of_supports(job, held);
      notices.pass_on(held);
      tried.sliced.push_back(slice_file(form, best.options->output, job, monitor));
      if (job.wants_scenes) tried.sliced.back().scene = scene_of(best.hollowed, report);
      tried.sliced.back().hollow = std::move(report);
    } catch (const Error& error) {
      if (error.code() != ExitCode::nothing_to_remove) throw;
      if (!refusal) refusal.emplace(error.what(), error.hint());
      tried.skipped.push_back({name_of(form), std::nullopt, error.what()});
    }
  }
  if (all_refused && refusal) throw NothingToRemoveError(*refusal);
  return tried;
}

std::optional<std::string> displacement_of(const SlicedForm& form, const std::vector<ExtrusionMove>& solid) {
  constexpr double kLineWidth = 1;  // mm, more than that of any: seams and fills may differ
  const double distance = outline_distance(extrusion_moves(read_text(form.gcode)), solid);
  if (distance <= kLineWidth) return std::nullopt;
  return fmt::format("the slicer put the model with {} elsewhere, {:.1f} mm off", form.name(), distance);
}

double filament_saved(const GcodeFigures& solid, const GcodeFigures& other) {
  for (const auto figure :
       {&GcodeFigures::filament_mm, &GcodeFigures::filament_cm3, &GcodeFigures::filament_g}) {
    const std::optional<double> before = solid.*figure, after = other.*figure;
    if (before && after && *before > 0) return 1 - *after / *before;
  }
  throw FailureError("the slicer's G-code does not say how much filament it takes");
}

std::size_t choose_form(const std::vector<SlicedForm>& forms, std::optional<PrintForm> asked) {
  if (asked) return 1;
  return lightest_of(forms, [](const SlicedForm& form) { return form.form != PrintForm::pattern; });
}

std::size_t lightest_form(const std::vector<SlicedForm>& forms) {
  return lightest_of(forms, [](const SlicedForm&) { return true; });
}

}  // namespace aerate
