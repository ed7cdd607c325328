#include "cli/cell_options.h"

#include <fmt/format.h>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "cli/numbers.h"
#include "core/error.h"
#include "core/listed.h"
#include "pipeline/process_choice.h"
#include "printing/processes.h"

namespace aerate::cli {
namespace {

// "33 for sla and sls"
std::string sizes_of_processes() {
  std::map<double, std::vector<std::string>> names;
  for (const Process& process : processes())
    if (const auto size = process.limits.find(Limit::cell_size); size != process.limits.end())
      names[size->second.value].push_back(process.name);
  std::vector<std::string> sizes;
  for (const auto& [size, of] : names) sizes.push_back(fmt::format("{:g} for {}", size, listed(of, "and")));
  return listed(sizes, "and");
}

}  // namespace

bool may_be_cells(const PackingRequest& request) {
  return !request.method->on_lattice && request.spheres.empty() && request.stop.target_density >= 1;
}

CellCommandOptions::CellCommandOptions(CLI::App& command, const CellWords& words) {
  command.add_option("--shape", shape_, words.shape)
      ->check(CLI::IsMember({"spheres", "cells"}))
      ->type_name("SHAPE");
  command
      .add_option(
          "--cell-size", cell_size_,
          fmt::format("Cells: about how far inner walls are apart (default of the process, 21 where it "
                      "has none, or what --max-radius gives; {}); --min-radius is by default half of "
                      "the largest that fits",
                      sizes_of_processes()))
      ->check(number_between({}, kLongest, "mm"))
      ->type_name("MM");
  command
      .add_option("--fillet", fillet_,
                  fmt::format("Cells: radius of their inner edges; what is narrower than a ball of it stays "
                              "solid (default {})",
                              words.fillet))
      ->check(number_between({}, kLongest, "mm"))
      ->type_name("MM");
  command.add_option("--tolerance", tolerance_, words.tolerance)
      ->check(number_between({}, kLongest, "mm"))
      ->type_name("MM");
}

std::optional<bool> CellCommandOptions::asks_for_cells() const {
  if (shape_.empty()) return std::nullopt;
  return shape_ == "cells";
}

void CellCommandOptions::require_neither_fillet_nor_tolerance(const std::string& where,
                                                              const std::string& why) const {
  if (fillet_) throw UsageError("--fillet " + where, why);
  if (tolerance_) throw UsageError("--tolerance " + where, why);
}

ShapedRequest CellCommandOptions::applied_to(PackingRequest packing, bool makes_cells, double fillet) const {
  if (!makes_cells) {
    if (fillet_) throw UsageError("--fillet without --shape cells", "spheres have no edges");
    if (cell_size_)
      throw UsageError("--cell-size without --shape cells", "--max-radius says how large spheres are");
    return {std::move(packing), std::nullopt, tolerance_};
  }
  packing.process = sized_for_cells(std::move(packing.process), cell_size_);
  packing.is_for_cells = true;
  return {std::move(packing), CellOptions{fillet_.value_or(fillet)}, tolerance_.value_or(kCellTolerance)};
}

}  // namespace aerate::cli
