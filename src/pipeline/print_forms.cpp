#include "pipeline/print_forms.h"

#include <chrono>
#include <fmt/format.h>
#include <string>
#include <strings.h>
#include <utility>

#include "core/error.h"
#include "files/formats.h"
#include "files/load.h"
#include "pipeline/hollow.h"
#include "pipeline/solid_file.h"
#include "printing/slicers/text_file.h"

namespace aerate {
namespace {

// In the scratch folder.
std::filesystem::path folder_of(PrintForm form, const FormJob& job) {
  std::filesystem::path folder = job.scratch / name_of(form);
  std::filesystem::create_directory(folder);
  return folder;
}

// What a slicer would call the model as STL.
std::string usual_name(const FormJob& job) {
  return job.request.hollow.model.stem().string() + ".stl";
}

std::string object_name(const FormJob& job) {
  return job.object_name.empty() ? usual_name(job) : job.object_name;
}

// The model's file in the form's folder. STL, whose object slicers name after the file; 3MF for modifiers and
// for other names of the object, which it carries.
std::filesystem::path model_file(PrintForm form, const FormJob& job) {
  const std::string stl = usual_name(job);
  const bool as_3mf =
      form == PrintForm::modifiers || (job.slicer.profile->modifiers && object_name(job) != stl);
  // Slicers write a file's name into G-code, where a line feed would begin a command.
  std::string name = on_one_line(as_3mf ? job.request.hollow.model.stem().string() + ".3mf" : stl);
  return folder_of(form, job) / name;
}

// The name that goes into a 3MF, as text; none where it is not, or the slicer reads no names.
std::optional<ObjectName> name_in_3mf(const FormJob& job) {
  const std::string name = object_name(job);
  if (!job.slicer.profile->modifiers || !is_utf8(name)) return std::nullopt;
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

SlicedForm slice_file(PrintForm form, std::filesystem::path model, const FormJob& job, Monitor& monitor) {
  monitor.check_interrupted();
  monitor.stage(fmt::format("slice {}", name_of(form)));
  SlicedForm sliced;
  sliced.form = form;
  const std::filesystem::path folder = model.parent_path();
  sliced.gcode = folder / "out.gcode";
  const auto begin = std::chrono::steady_clock::now();
  sliced.figures = slice(job.slicer,
                         {.model = std::move(model),
                          .gcode = sliced.gcode,
                          .settings = job.settings,
                          .keep_place = job.keep_place,
                          .scratch = folder},
                         monitor);
  sliced.slicer_seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  return sliced;
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
  }
  return "unknown";
}

bool is_project(const std::filesystem::path& model) {
  return ::strcasecmp(model.extension().c_str(), ".3mf") == 0;
}

std::vector<PrintForm> forms_to_try(std::optional<PrintForm> asked, const SlicerProfile& slicer) {
  if (asked == PrintForm::modifiers && !slicer.modifiers) {
    throw UsageError(fmt::format("{} reads no modifiers", slicer.name),
                     "use --as voids, or --as auto, which leaves them out");
  }
  if (asked) return {*asked};
  if (slicer.modifiers) return {PrintForm::voids, PrintForm::modifiers};
  return {PrintForm::voids};
}

SlicedForm slice_solid(const FormJob& job, Monitor& monitor) {
  std::filesystem::path model = model_file(PrintForm::solid, job);
  write_solid_model(job, model, monitor);
  return slice_file(PrintForm::solid, std::move(model), job, monitor);
}

std::vector<SlicedForm> slice_hollowed(const std::vector<PrintForm>& forms, const FormJob& job,
                                       Monitor& monitor) {
  const HollowedModel hollowed = carve_model(job.request.hollow, monitor);
  std::vector<SlicedForm> all;
  for (const PrintForm form : forms) {
    HollowOptions options = job.request.hollow;
    options.output = model_file(form, job);
    options.object_name = name_in_3mf(job);
    if (form == PrintForm::modifiers)
      options.modifiers = {job.slicer.profile, job.request.modifier_infill_percent};
    HollowReport report = write_hollowed(hollowed, options, monitor);
    all.push_back(slice_file(form, options.output, job, monitor));
    all.back().hollow = std::move(report);
  }
  return all;
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
  std::size_t best = 0;
  double most_saved = 0;
  for (std::size_t i = 1; i < forms.size(); ++i) {
    const double saved = filament_saved(forms[0].figures, forms[i].figures);
    if (saved <= most_saved) continue;
    most_saved = saved;
    best = i;
  }
  return best;
}

}  // namespace aerate
