#include <cmath>
#include <fmt/format.h>
#include <optional>

#include "cli/json_parts.h"
#include "cli/reports.h"
#include "core/printable.h"

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

double slicer_seconds(const FormsReport& report) {
  double sum = 0;
  for (const SlicedForm& form : report.forms) sum += form.slicer_seconds;
  return sum;
}

std::string time_line(const FormsReport& report) {
  const double slicing = slicer_seconds(report);
  return fmt::format("{:<12}{:.2f} s in the slicer, {:.2f} s beside it\n", "time", slicing,
                     total_of(report.stages).seconds - slicing);
}

Json json_of(const std::vector<SlicedForm>& forms) {
  Json list = Json::array();
  for (const SlicedForm& form : forms) {
    Json entry = {{"form", name_of(form.form)}};
    for (const NamedFigure& named : kNamedFigures) entry[named.name] = or_null(form.figures.*named.figure);
    entry["layers"] = form.figures.layers;
    entry["filament_saved_percent"] = form.form == PrintForm::solid
                                          ? Json(nullptr)
                                          : Json(100 * filament_saved(forms.front().figures, form.figures));
    entry["slicer_run_seconds"] = form.slicer_seconds;
    entry["voids"] = form.hollow ? Json(form.hollow->output.void_count) : Json(nullptr);
    entry["void_volume_mm3"] = form.hollow ? Json(form.hollow->output.volume_removed) : Json(nullptr);
    list.push_back(entry);
  }
  return list;
}

std::string closed(Json& json, const FormsReport& report) {
  json["seconds_in_slicer"] = slicer_seconds(report);
  add_closing(json, report.stages, report.notices);
  return dump(json);
}

}  // namespace

std::string to_text(const SliceReport& report) {
  const SlicerProfile& slicer = *report.slicer.profile;
  return fmt::format("{:<12}{}\n{:<12}{} ({}){}\n", "model", printable(report.model.filename().string()),
                     "slicer", slicer.name, printable(report.slicer.program.string()),
                     slicer.untested ? ", untested" : "") +
         table(report.forms) + voids_line(report.forms.back()) +
         fmt::format("{:<12}{}: {}\n", "output", printable(report.output.filename().string()),
                     name_of(report.best().form)) +
         time_line(report);
}

std::string to_text(const HookReport& report) {
  return fmt::format("{:<12}{} ({})\n", "G-code", printable(report.gcode.filename().string()),
                     printable(report.origin.name)) +
         table(report.forms) + voids_line(report.best()) +
         fmt::format("{:<12}{}{}\n", "result", report.result(),
                     report.remark.empty() ? "" : ": " + report.remark) +
         time_line(report);
}

std::string to_json(const SliceReport& report) {
  Json json = report_header("slice");
  json["model"] = report.model.string();
  json["slicer"] = {{"name", report.slicer.profile->name}, {"program", report.slicer.program.string()}};
  json["forms"] = json_of(report.forms);
  json["output"] = {{"path", report.output.string()}, {"form", name_of(report.best().form)}};
  return closed(json, report);
}

std::string to_json(const HookReport& report) {
  Json json = report_header("hook");
  json["gcode"] = report.gcode.string();
  json["generator"] = report.origin.name;
  json["forms"] = json_of(report.forms);
  json["result"] = report.result();
  json["remark"] = report.remark;
  return closed(json, report);
}

}  // namespace aerate::cli
