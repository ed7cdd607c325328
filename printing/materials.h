#pragma once

#include <span>
#include <string_view>

namespace aerate {

// What a model is printed of. Densities are those of solid printed parts; prices are round figures for one
// kilogram in the user's currency, to be replaced by what was really paid.
struct Material {
  std::string_view name;
  double density;  // g/cm3
  double price;    // per kg
};

// The built-in materials, PLA first.
std::span<const Material> materials();

// Looks a material up by name, in any case. Throws UsageError that lists the names there are.
const Material& find_material(std::string_view name);

}  // namespace aerate
