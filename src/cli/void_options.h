#pragma once

#include <CLI/CLI.hpp>

#include "core/packing.h"

namespace aerate::cli {

// Options of how voids are made, for every command that makes them. Each adds itself with the value that is
// there as the default.
void add_tolerance(CLI::App& command, double& tolerance);
void add_modifier_infill(CLI::App& command, double& percent);

// Throws UsageError for a tolerance (mm) that would leave little of the smallest voids.
void require_tolerance_for(const PackingLimits& limits, double tolerance);

}  // namespace aerate::cli
