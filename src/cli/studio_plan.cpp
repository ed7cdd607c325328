#include "cli/studio_plan.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <fmt/format.h>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "cli/hollow_forms.h"
#include "cli/keep_solid_options.h"
#include "cli/option_form.h"
#include "cli/reports.h"
#include "core/error.h"
#include "pipeline/process_choice.h"
#include "printing/processes.h"
#include "studio/names.h"

namespace aerate::cli {
namespace {

using studio::GivenOption;
using studio::OptionKind;
using studio::OptionRow;

// Beside those that name files: how the program runs, what pictures look like, and plugs, which are a file of their own.
constexpr std::array<std::string_view, 9> kNotOffered{"help",           "device",         "threads",
                                                      "quiet",          "picture-cut",    "picture-size",
                                                      "picture-colour", "plug-clearance", "plug-taper"};

constexpr std::string_view kFile = "FILE";

constexpr const char* kRegions =
    "Bodies that stay solid, and a wall round them: box:x0,y0,z0,x1,y1,z1, sphere:x,y,z,r or "
    "cylinder:x0,y0,z0,x1,y1,z1,r, in mm";

struct Group {
  std::string_view name;
  std::vector<std::string_view> options;
};

// By what they are about, in the order in which they are shown.
const std::vector<Group>& groups() {
  static const std::vector<Group> kGroups{
      {"Process", {"process", "up", "build", "as", "flavor", "support-blockers"}},
      {"Limits",
       {"wall", "gap", "min-radius", "max-radius", "overhang", "bridge", "max-voids", "target-saving",
        "target-mass", "target-density", "stand", "keep-solid"}},
      {"Shape of voids", {"shape", "cell-size", "fillet", "packing", "effort", "tolerance", "max-triangles"}},
      {"Drainage",
       {"drain", "channel-diameter", "hole-diameter", "escape-hole", "holes-on", "holes-not-on",
        "drain-cavities"}},
      {"Modifiers", {"modifier-infill", "modifier-pattern"}},
      {"Material", {"material", "density", "price", "price-per", "bulk-density"}},
      {"The model", {"unit", "scale", "weld", "surface", "voxel", "max-hole"}},
  };
  return kGroups;
}

std::string group_of(const std::string& name, const CLI::Option& option) {
  for (const Group& group : groups())
    if (std::ranges::find(group.options, name) != group.options.end()) return std::string(group.name);
  return option.get_group() == "Options" ? "More" : option.get_group();
}

// "METHOD:{adaptive,hexagonal}" -> its name and its choices
struct TypeOfValue {
  std::string name;
  std::vector<std::string> choices;
};

TypeOfValue type_of(const CLI::Option& option) {
  const std::string whole = option.get_type_name();
  const std::size_t colon = whole.find(':');
  TypeOfValue type{whole.substr(0, colon), {}};
  if (colon == std::string::npos || whole[colon + 1] != '{' || whole.back() != '}') return type;
  std::string_view choices = std::string_view(whole).substr(colon + 2);
  choices.remove_suffix(1);
  while (!choices.empty()) {
    const std::size_t comma = choices.find(',');
    type.choices.emplace_back(choices.substr(0, comma));
    choices.remove_prefix(comma == std::string_view::npos ? choices.size() : comma + 1);
  }
  return type;
}

// The unit of values that are called so; nothing for what is no number.
std::optional<std::string> unit_of(const std::string& placeholder) {
  for (const LimitRow& row : limit_rows())
    if (row.unit.placeholder == placeholder) return std::string(row.unit.symbol);
  static const std::map<std::string, std::string> kUnits{{"MM", "mm"}, {"[=MM]", "mm"},    {"PERCENT", "%"},
                                                         {"G", "g"},   {"G/CM3", "g/cm3"}, {"N", ""},
                                                         {"PRICE", ""}};
  const auto found = kUnits.find(placeholder);
  return found == kUnits.end() ? std::nullopt : std::optional(found->second);
}

std::optional<OptionRow> row_of_option(const CLI::Option& option) {
  if (option.get_lnames().empty()) return std::nullopt;  // the model
  const std::string name = option.get_lnames().front();
  const TypeOfValue type = type_of(option);
  if (type.name == kFile || std::ranges::find(kNotOffered, name) != kNotOffered.end()) return std::nullopt;
  OptionRow row{.name = name,
                .choices = type.choices,
                .description = option.get_description(),
                .group = group_of(name, option)};
  if (!option.get_default_str().empty()) row.default_value = option.get_default_str();
  const OptionForm form = form_of(option);
  row.may_be_off = form.may_be_off;
  row.may_be_bare = form.may_be_bare;
  if (name == "process")
    for (const Process& process : processes()) row.choices.push_back(process.name);
  const auto unit = unit_of(type.name);
  if (form.is_list)
    row.kind = OptionKind::list;
  else if (form.is_flag && !form.may_be_bare)
    row.kind = OptionKind::flag;
  else if (!row.choices.empty())
    row.kind = OptionKind::choice;
  else if (unit)
    row.kind = OptionKind::number;
  row.unit = unit.value_or("");
  if (name == "keep-solid") row.description = kRegions;
  if (row.kind == OptionKind::flag) row.default_value.reset();
  return row;
}

std::vector<OptionRow> rows_of_hollow() {
  std::vector<OptionRow> rows;
  visit_hollow_options([&](const CLI::Option& option) {
    if (auto row = row_of_option(option)) rows.push_back(*std::move(row));
  });
  const auto place = [](const OptionRow& row) {
    const auto found = std::ranges::find(groups(), row.group, &Group::name);
    const auto group = found - groups().begin();
    const auto within =
        found == groups().end() ? 0 : std::ranges::find(found->options, row.name) - found->options.begin();
    return std::pair(group, within);
  };
  std::ranges::stable_sort(rows, {}, place);
  return rows;
}

// Processes and regions can be files; those of a request never are.
void require_no_file(const OptionRow& row, const std::string& value) {
  if (row.name == "process" && std::ranges::find(row.choices, value) == row.choices.end())
    throw UsageError(fmt::format("unknown process \"{}\"", value),
                     fmt::format("use one of {}", process_names()));
  if (row.name != "keep-solid") return;
  const auto region = parse_region(value);
  if (region && std::holds_alternative<NamedRegion>(region->shape))
    throw UsageError(fmt::format("--keep-solid: '{}' is no body", value),
                     "give box:x0,y0,z0,x1,y1,z1, sphere:x,y,z,r or cylinder:x0,y0,z0,x1,y1,z1,r, in mm");
}

// An option as it is written on a command line. A value cannot be taken for another option.
void add_arguments(std::vector<std::string>& arguments, const OptionRow& row, const GivenOption& given) {
  const std::string option = fmt::format("--{}", row.name);
  if (given.is_off && !row.may_be_off) throw UsageError(option + " cannot be turned off", "leave it out");
  const bool is_bare = given.values.empty();
  if (is_bare && row.kind != OptionKind::flag && !row.may_be_bare)
    throw UsageError(option + " needs a value", "");
  if (!is_bare && row.kind == OptionKind::flag) throw UsageError(option + " takes no value", "send true");
  if (given.values.size() > 1 && row.kind != OptionKind::list)
    throw UsageError(option + " is given more than once", "send one value");
  if (is_bare) arguments.push_back(given.is_off ? fmt::format("--no-{}", row.name) : option);
  for (const std::string& value : given.values) {
    require_no_file(row, value);
    arguments.push_back(fmt::format("{}={}", option, value));
  }
}

// As a shell takes it for one word.
std::string quoted(const std::string& word) {
  const auto is_plain = [](char byte) {
    return (byte >= 'a' && byte <= 'z') || (byte >= 'A' && byte <= 'Z') || (byte >= '0' && byte <= '9') ||
           std::string_view("-_.,:/=+%").find(byte) != std::string_view::npos;
  };
  if (!word.empty() && std::ranges::all_of(word, is_plain)) return word;
  std::string text = "'";
  for (const char byte : word) text += byte == '\'' ? std::string("'\\''") : std::string(1, byte);
  return text + "'";
}

// A file's name that cannot be taken for an option.
std::string named(const std::string& file) {
  return quoted(file.starts_with('-') ? "./" + file : file);
}

studio::Plan plan_of(const std::vector<OptionRow>& rows, const studio::PlanRequest& request) {
  std::vector<std::string> arguments;
  for (const GivenOption& given : request.options) {
    const auto row = std::ranges::find(rows, given.name, &OptionRow::name);
    if (row == rows.end())
      throw UsageError(fmt::format("--{:.80}: the studio has no such option", given.name),
                       "use those that it shows, or 'aerate hollow' itself");
    add_arguments(arguments, *row, given);
  }
  studio::Plan plan;
  plan.forms = forms_of_hollow(request.model, request.stem, arguments);
  const std::string ending = plan.forms.front().options.output.extension().string();
  plan.output_name = studio::name_of_result(request.name, ending);
  plan.command = fmt::format("aerate hollow {} -o {}", named(request.name), named(plan.output_name));
  for (const std::string& argument : arguments) plan.command += " " + quoted(argument);
  return plan;
}

}  // namespace

studio::Lent lent_to_studio() {
  studio::Lent lent;
  lent.options = rows_of_hollow();
  lent.plan = [rows = lent.options](const studio::PlanRequest& request) { return plan_of(rows, request); };
  lent.report_text = [](const HollowReport& report) { return to_text(report); };
  lent.report_json = [](const HollowReport& report) { return to_json(report); };
  lent.inspection_json = [](const InspectReport& report) { return to_json(report); };
  return lent;
}

}  // namespace aerate::cli
