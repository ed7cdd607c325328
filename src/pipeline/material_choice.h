#pragma once

#include <optional>
#include <string>

#include "pipeline/options.h"

namespace aerate {

// The figures of a material preset, each of which can be overridden. A name that is none of the presets is
// taken as it is if density and price are both given. Throws UsageError that lists the presets otherwise.
MaterialFigures choose_material(const std::string& name, std::optional<double> density_g_cm3,
                                std::optional<double> price_per_kg);

// "PLA, PETG, ..."
std::string material_names();

}  // namespace aerate
