#include <cmath>
#include <fmt/format.h>
#include <optional>

#include "cli/json_parts.h"
#include "cli/reports.h"

namespace aerate::cli {
namespace {

std::string cell(const std::optional<double>& value, int decimals) {
  return value ? fmt::format("{:.{}f}", *value, decimals) : "-";
}

std::string duration(const std::optional<double>& seconds) {
  if (!seconds) return "-";
  const auto all = static_cast<long>(std::lround(*seconds));
  if (all >= 3600) return fmt::format("{}h {:02}m {:02}s", all / 3600, all / 60 % 60, all % 60);
  return fmt::format("{}m {:02}s", all / 60, all % 60);
}

std::string saving(const SlicedForm& solid, const SlicedForm& form) {
  if (form.form == PrintForm::solid) return {};
  return fmt::format("{:+.2f} %", -100 * filament_saved(solid.figures, form.figures));
}

std::string table(const std::vector<SlicedForm>& forms) {
  constexpr const char* kRow = "{:<12}{:>13}{:>9}{:>9}{:>9}{:>13}{:>8}  {}\n";
  std::string text =
      fmt::format(fmt::runtime(kRow), "", "filament mm", "cm3", "g", "cost", "time", "layers", "");
  for (const SlicedForm& form : forms) {
    const GcodeFigures& figures = form.figures;
    text += fmt::format(fmt::runtime(kRow), name_of(form.form), cell(figures.filament_mm, 2),
                        cell(figures.filament_cm3, 2), cell(figures.filament_g, 2), cell(figures.cost, 2),
                        duration(figures.seconds), figures.layers, saving(forms.front(), form));
  }
  // No blanks at the ends of lines.
  for (std::size_t at = 0; (at = text.find(" \n", at)) != std::string::npos;) text.erase(at--, 1);
  return text;
}

std::string voids_line(const SlicedForm& form) {
  if (!form.hollow) return {};
  const OutputFacts& facts = form.hollow->output;
  return fmt::format("{:<12}{}, radius {:.3f} to {:.3f} mm, {:.2f} % of the model\n", "voids",
                     facts.void_count, facts.smallest_radius, facts.largest_radius,
                     100 * facts.volume_removed / facts.volume_before);
}

double slicer_seconds(const std::vector<SlicedForm>& forms) {
  double sum = 0;
  for (const SlicedForm& form : forms) sum += form.slicer_seconds;
  return sum;
}

std::string time_line(const std::vector<SlicedForm>& forms, const std::vector<StageCost>& stages) {
  const double slicing = slicer_seconds(forms);
  return fmt::format("{:<12}{:.2f} s in the slicer, {:.2f} s beside it\n", "time", slicing,
                     total_of(stages).seconds - slicing);
}

Json json_of(const std::vector<SlicedForm>& forms) {
  Json list = Json::array();
  for (const SlicedForm& form : forms) {
    const GcodeFigures& figures = form.figures;
    Json entry = {{"form", name_of(form.form)},
                  {"filament_mm", or_null(figures.filament_mm)},
                  {"filament_cm3", or_null(figures.filament_cm3)},
                  {"filament_g", or_null(figures.filament_g)},
                  {"cost", or_null(figures.cost)},
                  {"seconds", or_null(figures.seconds)},
                  {"layers", figures.layers}};
    entry["filament_saved_percent"] = form.form == PrintForm::solid
                                          ? Json(nullptr)
                                          : Json(100 * filament_saved(forms.front().figures, figures));
    entry["slicer_run_seconds"] = form.slicer_seconds;
    entry["voids"] = form.hollow ? Json(form.hollow->output.void_count) : Json(nullptr);
    entry["void_volume_mm3"] = form.hollow ? Json(form.hollow->output.volume_removed) : Json(nullptr);
    list.push_back(entry);
  }
  return list;
}

}  // namespace

std::string to_text(const SliceReport& report) {
  const SlicedForm& chosen = report.forms[report.chosen];
  const char* untested = report.slicer.kind == SlicerKind::orca_slicer ? ", untested" : "";
  return fmt::format("{:<12}{}\n{:<12}{} ({}){}\n", "model", report.model.filename().string(), "slicer",
                     name_of(report.slicer.kind), report.slicer.program.string(), untested) +
         table(report.forms) + voids_line(report.forms.back()) +
         fmt::format("{:<12}{}: {}\n", "output", report.output.filename().string(), name_of(chosen.form)) +
         time_line(report.forms, report.stages);
}

std::string to_text(const HookReport& report) {
  const SlicedForm& chosen = report.forms[report.chosen];
  return fmt::format("{:<12}{} ({})\n", "G-code", report.gcode.filename().string(), report.origin.name) +
         table(report.forms) + voids_line(chosen) +
         fmt::format("{:<12}{}{}\n", "result", report.chosen > 0 ? name_of(chosen.form) : "unchanged",
                     report.remark.empty() ? "" : ": " + report.remark) +
         time_line(report.forms, report.stages);
}

std::string to_json(const SliceReport& report) {
  Json json = report_header("slice");
  json["model"] = report.model.string();
  json["slicer"] = {{"name", name_of(report.slicer.kind)}, {"program", report.slicer.program.string()}};
  json["forms"] = json_of(report.forms);
  json["output"] = {{"path", report.output.string()}, {"form", name_of(report.forms[report.chosen].form)}};
  json["seconds_in_slicer"] = slicer_seconds(report.forms);
  add_closing(json, report.stages, report.notices);
  return dump(json);
}

std::string to_json(const HookReport& report) {
  Json json = report_header("hook");
  json["gcode"] = report.gcode.string();
  json["generator"] = report.origin.name;
  json["forms"] = json_of(report.forms);
  json["result"] = report.chosen > 0 ? name_of(report.forms[report.chosen].form) : "unchanged";
  json["remark"] = report.remark;
  json["seconds_in_slicer"] = slicer_seconds(report.forms);
  add_closing(json, report.stages, report.notices);
  return dump(json);
}

}  // namespace aerate::cli
