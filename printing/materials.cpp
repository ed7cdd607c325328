#include "printing/materials.h"

#include <algorithm>
#include <cctype>
#include <string_view>

#include "core/error.h"

namespace aerate {
namespace {

bool equal_in_any_case(std::string_view a, std::string_view b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                    [](unsigned char x, unsigned char y) { return std::tolower(x) == std::tolower(y); });
}

}  // namespace

// Densities: PLA, PETG and ABS as in the "Generic" profiles that come with PrusaSlicer 2.5
// (PrusaResearch.ini, which also gives 25.4, 27.8 and 27.8 a kilogram); PA12 from HP's fact sheet for 3D High
// Reusability PA 12 (ASTM D792). Standard photopolymers are sold at about 1.1 as liquids and cure to
// 1.1..1.2. AlSi10Mg as EOS gives it for parts of its aluminium powder.
std::span<const Material> materials() {
  static const Material kMaterials[] = {
      {"PLA", 1.24, 25.0},   {"PETG", 1.27, 28.0}, {"ABS", 1.04, 28.0},
      {"resin", 1.10, 40.0}, {"PA12", 1.01, 60.0}, {"AlSi10Mg", 2.67, 80.0},
  };
  return kMaterials;
}

std::string material_names() {
  std::string names;
  for (const Material& material : materials()) names += (names.empty() ? "" : ", ") + material.name;
  return names;
}

Material choose_material(const std::string& name, std::optional<double> density_g_cm3,
                         std::optional<double> price, PriceUnit per) {
  // A litre weighs as many kilograms as a cubic centimetre has grams.
  const auto priced = [&](Material material) {
    if (!price) return material;
    material.price_per_kg = per == PriceUnit::litre ? *price / material.density_g_cm3 : *price;
    material.priced_per = per;
    return material;
  };
  if (density_g_cm3 && price) return priced({.name = name, .density_g_cm3 = *density_g_cm3});
  for (const Material& preset : materials()) {
    if (!equal_in_any_case(preset.name, name)) continue;
    Material material = preset;
    material.density_g_cm3 = density_g_cm3.value_or(preset.density_g_cm3);
    return priced(material);
  }
  throw UsageError("unknown material \"" + name + "\"",
                   "use one of " + material_names() + ", or give --density and --price");
}

}  // namespace aerate
