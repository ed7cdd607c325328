#include "cli/model_options.h"

#include <cctype>
#include <fmt/format.h>
#include <map>
#include <string_view>
#include <utility>
#include <vector>

#include "cli/numbers.h"
#include "core/error.h"
#include "core/listed.h"
#include "files/formats.h"
#include "packing/device_choice.h"
#include "packing/methods.h"
#include "printing/slicers/slicers.h"

namespace aerate::cli {
namespace {

const std::map<std::string, LengthUnit>& units() {
  static const std::map<std::string, LengthUnit> kUnits{{"mm", LengthUnit::millimetre},
                                                        {"cm", LengthUnit::centimetre},
                                                        {"m", LengthUnit::metre},
                                                        {"inch", LengthUnit::inch}};
  return kUnits;
}

// The packings that --max-voids and --target-density can stop.
std::string stoppable_packings() {
  std::vector<std::string> names;
  for (const PackingMethod& method : packing_methods())
    if (!method.on_lattice) names.emplace_back(method.name);
  return listed(names, "or") + " packing";
}

// One factor for all axes, or one for each.
std::optional<Vec3d> parse_scale(std::string_view text) {
  if (const auto factor = parse_number(text)) return Vec3d{*factor, *factor, *factor};
  return parse_point(text);
}

// Empty for factors that a model can be scaled by.
std::string fault_of_scale(const std::string& text) {
  constexpr double kMost = 1e9;
  const auto scale = parse_scale(text);
  if (!scale) return fmt::format("'{}' is neither a number nor three of them, x,y,z", text);
  for (const double factor : {scale->x, scale->y, scale->z}) {
    if (!(factor > 0)) return fmt::format("{:g} is too little (more than 0)", factor);
    if (factor > kMost) return fmt::format("{:g} is too much (at most {:g})", factor, kMost);
  }
  return {};
}

std::string capitalised(std::string text) {
  text[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(text[0])));
  return text;
}

}  // namespace

CLI::Validator names_a_file() {
  const auto check = [](const std::string& name) {
    return name.empty() ? "no name was given" : std::string();
  };
  return CLI::Validator(check, "");
}

ModelOptions::ModelOptions(CLI::App& command) {
  command.add_option("MODEL", path, "The model: " + names_that_are_read())->required()->type_name("");
  add_size_options(command);
}

ModelOptions::ModelOptions(CLI::App& command, const std::string& name, const std::string& description) {
  command.add_option(name, path, description)->type_name("FILE");
  add_size_options(command);
}

void ModelOptions::add_size_options(CLI::App& command) {
  command
      .add_option("--unit", unit_,
                  "Unit of the model's coordinates: mm, cm, m or inch; 3MF and glTF files have their own "
                  "(default mm)")
      ->check(CLI::IsMember({"mm", "cm", "m", "inch"}))
      ->type_name("UNIT");
  command
      .add_option("--scale", scale_,
                  "Factor for the model's size, or x,y,z: one along each of its axes, as for a resin that "
                  "shrinks unevenly")
      ->check(CLI::Validator(fault_of_scale, ""))
      ->type_name("FACTOR")
      ->capture_default_str();
  command
      .add_option("--weld", weld,
                  "Join vertices at open edges that are at most this far apart, 0 for none (default a "
                  "hundred-thousandth of the model's diagonal, at most 0.01)")
      ->check(number_between(0.0, 10, "mm"))
      ->type_name("MM");
}

LoadOptions ModelOptions::load() const {
  LoadOptions options;
  options.volume_lists = volume_lists();
  if (!unit_.empty()) options.unit = units().at(unit_);
  options.scale = parse_scale(scale_).value();
  return options;
}

PackingCommandOptions::PackingCommandOptions(CLI::App& command, const ConfigFile& config)
    : config_(config), process_(command, config) {
  const std::string stops = capitalised(stoppable_packings());
  std::vector<std::string> methods, summaries;
  for (const PackingMethod& method : packing_methods()) {
    methods.emplace_back(method.name);
    summaries.push_back(fmt::format("{} ({})", method.name, method.summary));
  }
  command.add_option("--packing", packing_, "How spheres are packed: " + listed(summaries, "or"))
      ->check(CLI::IsMember(methods))
      ->type_name("METHOD")
      ->capture_default_str();
  command
      .add_option("--effort", effort_,
                  stops +
                      ": normal, or best: six packings, of which the one that removes most is kept, for six "
                      "to eleven times the time")
      ->check(CLI::IsMember({"normal", "best"}))
      ->type_name("EFFORT")
      ->capture_default_str();
  command
      .add_option("--max-voids", max_voids_,
                  stops + ": no more voids than this, the largest ones (default no limit)")
      ->check(whole_number_between(1, 4e9, "voids"))
      ->type_name("N");
  command
      .add_option(
          "--target-density", target_density_,
          stops +
              ": stop when spheres fill this share of the model's volume, percent (default when no more fit)")
      ->check(number_between({}, 100, "%"))
      ->type_name("PERCENT");
  command
      .add_option("--device", device_,
                  "Where spheres are packed: auto (a CUDA device for large jobs, if there is one), cpu, cuda "
                  "or cuda:N; the result is the same")
      ->check(parsed_by(parse_device, "is not auto, cpu, cuda or cuda:N"))
      ->type_name("DEVICE")
      ->capture_default_str();
}

PackingRequest PackingCommandOptions::request() const {
  PackingRequest request;
  request.process = process_.choice();
  request.method = &packing_method(packing_);
  if (request.method->on_lattice) request.process = kept_to_balls_without_roofs(std::move(request.process));
  request.device = parse_device(device_).value();
  if (request.method->on_lattice && (max_voids_ || target_density_)) {
    throw UsageError(fmt::format("--max-voids and --target-density are for {}", stoppable_packings()),
                     fmt::format("leave out --packing {}", packing_));
  }
  if (effort_ == "best") {
    if (request.method->on_lattice)
      throw UsageError(fmt::format("--effort best is for {}", stoppable_packings()),
                       fmt::format("leave out --packing {}", packing_));
    request.stop.effort = PackingEffort::best;
  }
  if (max_voids_) request.stop.max_count = static_cast<std::size_t>(*max_voids_);
  if (target_density_) request.stop.target_density = *target_density_ / 100;
  return request;
}

std::vector<NamedInput> PackingCommandOptions::inputs(const std::filesystem::path& model) const {
  return {{"model", model}, {"configuration file", config_.path()}, {"process file", process_.file()}};
}

RunOptions::RunOptions(CLI::App& command) {
  command.add_option("--json", json, "Write the report as JSON to this file, '-' for standard output")
      ->type_name("FILE");
  command.add_option("--threads", threads, "Threads to use (default all); the result is the same")
      ->check(whole_number_between(1, 1024, "threads"))
      ->type_name("N");
  command.add_flag("--quiet", quiet_, "No report, no notices, no progress; only errors");
  command.fallthrough();
}

}  // namespace aerate::cli
