#include "cli/void_options.h"

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

void add_modifier_infill(CLI::App& command, double& percent) {
  command.add_option("--modifier-infill", percent, "Infill inside modifiers")
      ->check(number_between(0.0, 100, "%"))
      ->type_name("PERCENT")
      ->capture_default_str();
}

void require_tolerance_for(const PackingLimits& limits, double tolerance) {
  if (tolerance <= limits.min_radius / 2) return;
  throw UsageError(
      fmt::format("--tolerance {} mm is more than half of --min-radius {} mm", tolerance, limits.min_radius),
      "give a smaller --tolerance or a larger --min-radius");
}

}  // namespace aerate::cli
