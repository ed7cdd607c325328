#include "printing/materials.h"

#include <algorithm>
#include <cctype>
#include <fmt/format.h>
#include <string_view>

#include "core/error.h"

namespace aerate {
namespace {

bool equal_in_any_case(std::string_view a, std::string_view b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                    [](unsigned char x, unsigned char y) { return std::tolower(x) == std::tolower(y); });
}

// A litre weighs as many kilograms as a cubic centimetre has grams.
double kilograms_in(const Material& material, PriceUnit unit) {
  if (unit == PriceUnit::kilogram) return 1;
  if (unit == PriceUnit::litre) return material.density_g_cm3;
  if (!material.bulk_density_g_cm3)
    throw UsageError(fmt::format("the bulk density of {} is not known", material.name),
                     "give --bulk-density in g/cm3, or the price of a kg");
  return *material.bulk_density_g_cm3;
}

}  // namespace

// Densities: PLA, PETG and ABS as in the "Generic" profiles that come with PrusaSlicer 2.5
// (PrusaResearch.ini, which also gives 25.4, 27.8 and 27.8 a kilogram); PA12 from HP's fact sheet for 3D High
// Reusability PA 12 (ASTM D792). Standard photopolymers are sold at about 1.1 as liquids and cure to
// 1.1..1.2. The same sheet gives the bulk density of PA12's powder (ASTM D1895). AlSi10Mg as EOS gives it for parts of its aluminium powder.
std::span<const Material> materials() {
  static const Material kMaterials[] = {
      {"PLA", 1.24, 25.0},   {"PETG", 1.27, 28.0},        {"ABS", 1.04, 28.0},
      {"resin", 1.10, 40.0}, {"PA12", 1.01, 60.0, 0.425}, {"AlSi10Mg", 2.67, 80.0},
  };
  return kMaterials;
}

std::string material_names() {
  std::string names;
  for (const Material& material : materials()) names += (names.empty() ? "" : ", ") + material.name;
  return names;
}

std::string name_of(PriceUnit unit) {
  switch (unit) {
    case PriceUnit::litre:
      return "l";
    case PriceUnit::bulk_litre:
      return "bulk-l";
    default:
      return "kg";
  }
}

double Material::price_per(PriceUnit unit) const {
  return price_per_kg * kilograms_in(*this, unit);
}

Material choose_material(const std::string& name, const MaterialFigures& given) {
  const auto preset = std::ranges::find_if(
      materials(), [&](const Material& material) { return equal_in_any_case(material.name, name); });
  const bool is_known = preset != materials().end();
  if (!is_known && !(given.density_g_cm3 && given.price))
    throw UsageError("unknown material \"" + name + "\"",
                     "use one of " + material_names() + ", or give --density and --price");
  Material material = is_known ? *preset : Material{.name = name};
  material.density_g_cm3 = given.density_g_cm3.value_or(material.density_g_cm3);
  if (given.bulk_density_g_cm3) material.bulk_density_g_cm3 = given.bulk_density_g_cm3;
  if (given.bulk_density_g_cm3 && *given.bulk_density_g_cm3 >= material.density_g_cm3)
    throw UsageError(
        fmt::format("a bulk density of {:g} g/cm3 is not less than the {:g} g/cm3 of what is printed",
                    *given.bulk_density_g_cm3, material.density_g_cm3),
        "give --bulk-density of the loose powder");
  if (!given.price) return material;
  material.price_per_kg = *given.price / kilograms_in(material, given.per);
  material.priced_per = given.per;
  return material;
}

}  // namespace aerate
