#pragma once

#include <optional>
#include <span>
#include <string>

namespace aerate {

// What prices are given for.
enum class PriceUnit {
  kilogram,
  litre,       // as printed
  bulk_litre,  // of loose powder
};
std::string name_of(PriceUnit unit);  // "kg", "l", "bulk-l"

// What a model is printed of, and what the figures for mass and cost are computed with. Densities are those of
// solid printed parts, bulk densities of the loose powder; prices are round figures in the user's currency, to be replaced by what was really paid.
struct Material {
  std::string name;
  double density_g_cm3 = 0;
  double price_per_kg = 0;
  std::optional<double> bulk_density_g_cm3 = {};
  PriceUnit priced_per = PriceUnit::kilogram;  // how the price was given

  double price_per_litre() const { return price_per_kg * density_g_cm3; }  // of the solid material
  double price_per(PriceUnit unit) const;  // throws UsageError as choose_material does
};

// Figures that go before those of a material.
struct MaterialFigures {
  std::optional<double> density_g_cm3 = {};
  std::optional<double> bulk_density_g_cm3 = {};
  std::optional<double> price = {};
  PriceUnit per = PriceUnit::kilogram;
};

// The built-in materials, PLA first.
std::span<const Material> materials();

// "PLA, PETG, .."
std::string material_names();

// A built-in material, by its name in any case, with what is given in place of its own figures. A name that is none of
// theirs is taken as it is if both density and price are given. Throws UsageError that lists the names there are
// otherwise, for a price of loose powder whose bulk density is not known, and for one that is no less than the density.
Material choose_material(const std::string& name, const MaterialFigures& given = {});

}  // namespace aerate
