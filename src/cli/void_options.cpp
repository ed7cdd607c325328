#include "cli/void_options.h"

#include <cmath>
#include <fmt/format.h>

#include "cli/numbers.h"
#include "core/error.h"
#include "printing/processes.h"

namespace aerate::cli {

void add_tolerance(CLI::App& command, double& tolerance) {
  command.add_option("--tolerance", tolerance, "Void surfaces stay this far inside their spheres at most")
      ->check(number_between({}, kLongest, "mm"))
      ->type_name("MM")
      ->capture_default_str();
}

const CLI::Option* add_modifier_infill(CLI::App& command, double& percent) {
  return command.add_option("--modifier-infill", percent, "Modifiers: infill inside them")
      ->check(number_between(0.0, 100, "%"))
      ->type_name("PERCENT")
      ->capture_default_str();
}

void ModifierOnlyOptions::require_none(const std::string& where) const {
  for (const CLI::Option* option : options_) {
    if (option->count() == 0 || !config_.is_on_command_line(*option)) continue;
    throw UsageError(fmt::format("{} {} has no effect", option->get_name(), where),
                     "give --as modifiers, or leave it out");
  }
}

void require_tolerance_for(const ProcessChoice& choice, double tolerance) {
  const PackingLimits limits = packing_limits(choice);
  if (tolerance <= limits.min_radius / 2) return;
  if (is_lowered_for_cells(choice)) {
    // The least radius is half of the largest.
    const double fine_enough = std::ceil(10 * (8 * tolerance + limits.gap) + 1e-6) / 10;
    throw UsageError(
        fmt::format("--cell-size {:g} mm: cells of this size are too small for a tolerance of {:g} mm",
                    2 * limits.max_radius + limits.gap, tolerance),
        fmt::format("give a --cell-size of {:g} mm or more, or a smaller --tolerance", fine_enough));
  }
  throw UsageError(fmt::format("--tolerance {:g} mm is more than half of --min-radius {:g} mm", tolerance,
                               limits.min_radius),
                   "give a smaller --tolerance or a larger --min-radius");
}

}  // namespace aerate::cli
