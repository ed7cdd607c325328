#include "pipeline/print_forms.h"

#include <chrono>
#include <fmt/format.h>
#include <string>
#include <utility>

#include "core/error.h"
#include "files/formats.h"
#include "files/load.h"
#include "pipeline/hollow.h"

namespace aerate {
namespace {

// The slicer names the object after the file, so that every form keeps the model's name.
std::filesystem::path folder_of(PrintForm form, const FormJob& job) {
  std::filesystem::path folder = job.scratch / name_of(form);
  std::filesystem::create_directory(folder);
  return folder;
}

// STL as every slicer reads it, whatever the model came as.
void write_solid_model(const FormJob& job, const std::filesystem::path& path, Monitor& monitor) {
  monitor.stage("load");
  const HollowOptions& options = job.request.hollow;
  write_mesh(load_model(options.model, options.load).mesh, path, MeshFormat::stl);
}

// The model's file in the form's folder.
std::filesystem::path model_file(PrintForm form, const FormJob& job) {
  const std::string ending = form == PrintForm::modifiers ? ".3mf" : ".stl";
  return folder_of(form, job) / (job.request.hollow.model.stem().string() + ending);
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
