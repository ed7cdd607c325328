#include "pipeline/material_choice.h"

#include <fmt/format.h>

#include "printing/materials.h"

namespace aerate {

MaterialFigures choose_material(const std::string& name, std::optional<double> density_g_cm3,
                                std::optional<double> price_per_kg) {
  if (density_g_cm3 && price_per_kg) return {name, *density_g_cm3, *price_per_kg};
  const Material& preset = find_material(name);
  return {std::string(preset.name), density_g_cm3.value_or(preset.density),
          price_per_kg.value_or(preset.price)};
}

std::string material_names() {
  std::string words;
  for (const Material& material : materials()) {
    words += fmt::format("{}{}", words.empty() ? "" : ", ", material.name);
  }
  return words;
}

}  // namespace aerate
