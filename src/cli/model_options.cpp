#include "cli/model_options.h"

#include <fmt/format.h>
#include <map>
#include <utility>

#include "cli/numbers.h"
#include "core/error.h"
#include "packing/device.h"

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

ModelOptions::ModelOptions(CLI::App& command) {
  command.add_option("MODEL", path, "The model: STL, OBJ, PLY, OFF or 3MF")->required()->type_name("");
  add_size_options(command);
}

ModelOptions::ModelOptions(CLI::App& command, const std::string& name, const std::string& description) {
  command.add_option(name, path, description)->type_name("FILE");
  add_size_options(command);
}

void ModelOptions::add_size_options(CLI::App& command) {
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

PackingCommandOptions::PackingCommandOptions(CLI::App& command, const ConfigFile& config)
    : process_(command, config) {
  command
      .add_option(
          "--packing", packing_,
          "How spheres are packed: adaptive (the largest that fits first, densest) or hexagonal (a lattice)")
      ->check(CLI::IsMember({"adaptive", "hexagonal"}))
      ->type_name("METHOD")
      ->capture_default_str();
  command
      .add_option("--max-voids", max_voids_, "Adaptive packing: no more voids than this, the largest ones")
      ->check(whole_number_between(1, 4e9, "voids"))
      ->type_name("N");
  command
      .add_option("--target-density", target_density_,
                  "Adaptive packing: stop when voids fill this share of the model's volume, percent")
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
  if (packing_ == "hexagonal") request.process = kept_to_balls_without_roofs(std::move(request.process));
  request.device = parse_device(device_).value();
  if (packing_ == "hexagonal") {
    request.method = PackingMethod::hexagonal;
    if (max_voids_ || target_density_) {
      throw UsageError("--max-voids and --target-density are for adaptive packing",
                       "leave out --packing hexagonal");
    }
  }
  if (max_voids_) request.stop.max_count = static_cast<std::size_t>(*max_voids_);
  if (target_density_) request.stop.target_density = *target_density_ / 100;
  return request;
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
