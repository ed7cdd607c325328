#include "cli/model_options.h"

#include <charconv>
#include <cmath>
#include <fmt/format.h>
#include <map>

#include "core/error.h"

namespace aerate::cli {
namespace {

const std::map<std::string, LengthUnit>& units() {
  static const std::map<std::string, LengthUnit> kUnits{{"mm", LengthUnit::millimetre},
                                                        {"cm", LengthUnit::centimetre},
                                                        {"m", LengthUnit::metre},
                                                        {"inch", LengthUnit::inch}};
  return kUnits;
}

}  // namespace

CLI::Validator number_between(std::optional<double> least, double most, const std::string& unit) {
  const std::string suffix = unit.empty() ? "" : " " + unit;
  const auto check = [least, most, suffix](const std::string& text) -> std::string {
    double number = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
    const bool is_number = error == std::errc() && end == text.data() + text.size() && std::isfinite(number);
    if (!is_number) return fmt::format("'{}' is not a number", text);
    if (number > most) return fmt::format("{}{} is too much (at most {}{})", text, suffix, most, suffix);
    if (least && number < *least)
      return fmt::format("{}{} is too little (at least {}{})", text, suffix, *least, suffix);
    if (!least && number <= 0) return fmt::format("{}{} is too little (more than 0{})", text, suffix, suffix);
    return {};
  };
  return CLI::Validator(check, "");
}

ModelOptions::ModelOptions(CLI::App& command) {
  command.add_option("MODEL", path, "The model: STL, OBJ, PLY, OFF or 3MF")->required()->type_name("");
  command
      .add_option("--unit", unit_,
                  "Unit of the model's coordinates: mm, cm, m or inch; 3MF files name their own (default mm)")
      ->check(CLI::IsMember({"mm", "cm", "m", "inch"}))
      ->type_name("UNIT");
  command.add_option("--scale", scale_, "Factor for the model's size")
      ->check(number_between({}, 1e9, ""))
      ->type_name("FACTOR")
      ->capture_default_str();
}

LoadOptions ModelOptions::load() const {
  LoadOptions options;
  if (!unit_.empty()) options.unit = units().at(unit_);
  options.scale = scale_;
  return options;
}

LimitOptions::LimitOptions(CLI::App& command) {
  const auto add_length = [&](const char* name, double& value, const char* what,
                              std::optional<double> least) {
    command.add_option(name, value, what)
        ->check(number_between(least, kLongest, "mm"))
        ->type_name("MM")
        ->capture_default_str();
  };
  add_length("--wall", limits_.wall, "Least thickness between a void and the model's surface", 0.0);
  add_length("--gap", limits_.gap, "Least thickness between two voids", 0.0);
  add_length("--min-radius", limits_.min_radius, "Smaller voids are not made", {});
  add_length("--max-radius", limits_.max_radius, "Radius of the largest voids", {});
  command.add_option("--packing", packing_, "How spheres are packed: hexagonal")
      ->check(CLI::IsMember({"hexagonal"}))
      ->type_name("METHOD")
      ->capture_default_str();
}

PackingLimits LimitOptions::limits() const {
  if (limits_.min_radius > limits_.max_radius) {
    throw UsageError(fmt::format("--min-radius {} mm is more than --max-radius {} mm", limits_.min_radius,
                                 limits_.max_radius),
                     "give a smaller --min-radius or a larger --max-radius");
  }
  return limits_;
}

RunOptions::RunOptions(CLI::App& command) {
  command.add_option("--json", json, "Write the report as JSON to this file, '-' for standard output")
      ->type_name("FILE");
  command.add_option("--threads", threads, "Threads to use (default all); the result is the same")
      ->check(number_between(1.0, 1024, "threads"))
      ->type_name("N");
  command.add_flag("--quiet", quiet_, "No report, no notices, no progress; only errors");
  command.fallthrough();
}

}  // namespace aerate::cli
