#include <algorithm>
#include <cmath>
#include <cstddef>
#include <fmt/format.h>
#include <optional>
#include <string>
#include <vector>

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

// What the solid print is, as far as that is known.
std::string infill_of(const std::optional<DescribedPrint>& print) {
  if (!print) return {};
  const std::string infill = fmt::format("{:g} %", 100 * print->settings.infill);
  return print->pattern.empty() ? infill : infill + " " + print->pattern;
}

// Why a form has no figures.
std::string reason(const SkippedForm& form) {
  if (form.predicted) return fmt::format("predicted {:+.0f} %, not sliced", 100 * *form.predicted);
  return "not sliced: " + form.why;
}

// uses: what each form is good for; none for a report that does not tell
std::string table(const FormsReport& report, const std::vector<std::string>& uses = {}) {
  constexpr const char* kRow = "{:<{}}{:>13}{:>9}{:>9}{:>9}{:>13}{:>8}  {:<10}  {}\n";
  constexpr const char* kSkippedRow = "{:<{}}{}\n";
  std::size_t width = 12;
  for (const SlicedForm& form : report.forms) width = std::max(width, form.name().size() + 2);
  for (const SkippedForm& form : report.skipped) width = std::max(width, form.name.size() + 2);
  std::string text =
      fmt::format(fmt::runtime(kRow), "", width, "filament mm", "cm3", "g", "cost", "time", "layers", "", "");
  for (std::size_t i = 0; i < report.forms.size(); ++i) {
    const SlicedForm& form = report.forms[i];
    const GcodeFigures& figures = form.figures;
    text += fmt::format(fmt::runtime(kRow), form.name(), width, cell(figures.filament_mm, 2),
                        cell(figures.filament_cm3, 2), cell(figures.filament_g, 2), cell(figures.cost, 2),
                        duration(figures.seconds), figures.layers, saving(report.forms.front(), form),
                        i < uses.size() ? uses[i] : "");
  }
  for (const SkippedForm& form : report.skipped)
    text += fmt::format(fmt::runtime(kSkippedRow), form.name, width, printable(reason(form)));
  // No blanks at the ends of lines.
  for (std::size_t at = 0; (at = text.find(" \n", at)) != std::string::npos;) text.erase(at--, 1);
  return text;
}

std::vector<std::string> uses_of(const SliceReport& report) {
  std::vector<std::string> uses{infill_of(report.print)};
  for (std::size_t i = 1; i < report.forms.size(); ++i) uses.push_back(report.use(report.forms[i]));
  return uses;
}

// "4.71 cm3 (-30.4 %)"
std::string filament_of(const SlicedForm& form, const SlicedForm& solid) {
  const GcodeFigures& figures = form.figures;
  const std::string amount = figures.filament_cm3 ? fmt::format("{:.2f} cm3", *figures.filament_cm3)
                             : figures.filament_g ? fmt::format("{:.2f} g", *figures.filament_g)
                                                  : cell(figures.filament_mm, 0) + " mm";
  return fmt::format("{} ({:+.1f} %)", amount, -100 * filament_saved(solid.figures, form.figures));
}

std::string time_change_of(const SlicedForm& form, const SlicedForm& solid) {
  const auto before = solid.figures.seconds, after = form.figures.seconds;
  if (!before || !after || *before == *after) return {};
  return fmt::format(", {} {}", duration(std::abs(*after - *before)), *after < *before ? "less" : "more");
}

// What to print, in the first line: a pattern of the slicer, where it takes less than all that is made here.
std::string verdict(const SliceReport& report) {
  const SlicedForm& solid = report.forms.front();
  const SlicedForm& lightest = report.lightest();
  if (lightest.form == PrintForm::solid)
    return fmt::format("{:<12}solid, as it is: nothing that was sliced takes less filament\n", "least");
  const std::string figures = filament_of(lightest, solid) + time_change_of(lightest, solid);
  if (lightest.form != PrintForm::pattern)
    return fmt::format("{:<12}{}: {}; {}\n", "least", lightest.name(), figures, report.use(lightest));
  std::string text = fmt::format("{:<12}{} infill, a setting of {}: {}; {}\n", "least", lightest.name(),
                                 report.slicer.profile->name, figures, report.use(lightest));
  if (&report.best() == &lightest) return text;
  return text + fmt::format("{:<12}set it there, or give --as {}; what was written is {}{}\n", "",
                            lightest.name(), report.best().name(),
                            report.chosen == 0 ? "" : ", " + filament_of(report.best(), solid));
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

Json json_of(const std::vector<SlicedForm>& forms, const std::vector<std::string>& uses = {}) {
  Json list = Json::array();
  for (const SlicedForm& form : forms) {
    Json entry = {{"form", form.name()}};
    for (const NamedFigure& named : kNamedFigures) entry[named.name] = or_null(form.figures.*named.figure);
    entry["layers"] = form.figures.layers;
    entry["filament_saved_percent"] = form.form == PrintForm::solid
                                          ? Json(nullptr)
                                          : Json(100 * filament_saved(forms.front().figures, form.figures));
    entry["slicer_run_seconds"] = form.slicer_seconds;
    entry["voids"] = form.hollow ? Json(form.hollow->output.void_count) : Json(nullptr);
    entry["void_volume_mm3"] = form.hollow ? Json(form.hollow->output.volume_removed) : Json(nullptr);
    if (!uses.empty()) entry["good_for"] = uses[list.size()];
    list.push_back(entry);
  }
  return list;
}

Json json_of(const std::vector<SkippedForm>& forms) {
  Json list = Json::array();
  for (const SkippedForm& form : forms)
    list.push_back({{"form", form.name},
                    {"predicted_percent", form.predicted ? Json(100 * *form.predicted) : Json(nullptr)},
                    {"why", reason(form)}});
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
  return verdict(report) +
         fmt::format("{:<12}{}\n{:<12}{} ({}){}\n", "model", printable(report.model.filename().string()),
                     "slicer", slicer.name, printable(report.slicer.program.string()),
                     slicer.untested ? ", untested" : "") +
         table(report, uses_of(report)) + voids_line(report.best()) +
         fmt::format("{:<12}{}: {}\n", "output", printable(report.output.filename().string()),
                     report.best().name()) +
         time_line(report);
}

std::string to_text(const HookReport& report) {
  return fmt::format("{:<12}{} ({})\n", "G-code", printable(report.gcode.filename().string()),
                     printable(report.origin.name)) +
         table(report) + voids_line(report.best()) +
         fmt::format("{:<12}{}{}\n", "result", report.result(),
                     report.remark.empty() ? "" : ": " + report.remark) +
         time_line(report);
}

std::string to_json(const SliceReport& report) {
  Json json = report_header("slice");
  json["model"] = report.model.string();
  const auto& version = report.slicer.facts.version;
  json["slicer"] = {{"name", report.slicer.profile->name},
                    {"program", report.slicer.program.string()},
                    {"version", version ? Json(to_text(*version)) : Json(nullptr)}};
  json["forms"] = json_of(report.forms, uses_of(report));
  json["not_sliced"] = json_of(report.skipped);
  json["least"] = report.lightest().name();
  json["output"] = {{"path", report.output.string()}, {"form", report.best().name()}};
  return closed(json, report);
}

std::string to_json(const HookReport& report) {
  Json json = report_header("hook");
  json["gcode"] = report.gcode.string();
  json["generator"] = report.origin.name;
  json["forms"] = json_of(report.forms);
  json["not_sliced"] = json_of(report.skipped);
  json["result"] = report.result();
  json["remark"] = report.remark;
  return closed(json, report);
}

std::string to_text(const SliceSupportsReport& report) {
  constexpr const char* kRow = "{:<12}{:>13}{:>9}{:>9}{:>13}{:>8}\n";
  std::string text =
      fmt::format("{:<12}{}\n{:<12}{} ({})\n", "model", printable(report.model.filename().string()), "slicer",
                  report.slicer.profile->name, printable(report.slicer.program.string()));
  text += fmt::format(fmt::runtime(kRow), "supports", "filament mm", "cm3", "g", "time", "layers");
  for (const SupportedForm& form : report.forms) {
    const GcodeFigures& figures = form.figures;
    text += fmt::format(fmt::runtime(kRow), form.name, cell(figures.filament_mm, 2),
                        cell(figures.filament_cm3, 2), cell(figures.filament_g, 2), duration(figures.seconds),
                        figures.layers);
  }
  for (const std::string& name : report.failed) text += fmt::format("{:<12}this version has none\n", name);
  const SupportFacts& facts = report.supports.facts;
  text += fmt::format("{:<12}{:.1f} mm2 of the model's underside (aerate)\n", "contact", facts.contact_area);
  const StageCost total = total_of(report.stages);
  return text + fmt::format("{:<12}{}: with supports of aerate\n{:<12}{:.1f} s\n", "output",
                            printable(report.output.filename().string()), "time", total.seconds);
}

std::string to_json(const SliceSupportsReport& report) {
  Json json = report_header("slice_supports");
  json["model"] = report.model.string();
  const auto& version = report.slicer.facts.version;
  json["slicer"] = {{"name", report.slicer.profile->name},
                    {"program", report.slicer.program.string()},
                    {"version", version ? Json(to_text(*version)) : Json(nullptr)}};
  json["forms"] = Json::array();
  for (const SupportedForm& form : report.forms) {
    const GcodeFigures& figures = form.figures;
    json["forms"].push_back({{"supports", form.name},
                             {"filament_mm", or_null(figures.filament_mm)},
                             {"filament_cm3", or_null(figures.filament_cm3)},
                             {"filament_g", or_null(figures.filament_g)},
                             {"seconds", or_null(figures.seconds)},
                             {"layers", figures.layers},
                             {"slicer_seconds", form.slicer_seconds}});
  }
  json["not_sliced"] = report.failed;
  json["contact_mm2"] = report.supports.facts.contact_area;
  json["farthest_mm"] =
      std::isfinite(report.supports.facts.farthest) ? Json(report.supports.facts.farthest) : Json(nullptr);
  json["output"] = report.output.string();
  add_closing(json, report.stages, report.notices);
  return dump(json);
}

}  // namespace aerate::cli
