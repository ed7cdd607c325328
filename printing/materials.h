#pragma once

#include <optional>
#include <span>
#include <string>

namespace aerate {

// What prices are given for.
enum class PriceUnit { kilogram, litre };

// What a model is printed of, and what the figures for mass and cost are computed with. Densities are those of
// solid printed parts; prices are round figures in the user's currency, to be replaced by what was really paid.
struct Material {
  std::string name;
  double density_g_cm3 = 0;
  double price_per_kg = 0;
  PriceUnit priced_per = PriceUnit::kilogram;  // how the price was given

  double price_per_litre() const { return price_per_kg * density_g_cm3; }  // of the solid material
};

// The built-in materials, PLA first.
std::span<const Material> materials();

// "PLA, PETG, .."
std::string material_names();

// A built-in material, by its name in any case, with these figures in place of its own; `per` says what the price is for. A name that is none of
// theirs is taken as it is if both figures are given. Throws UsageError that lists the names there are
// otherwise.
Material choose_material(const std::string& name, std::optional<double> density_g_cm3 = {},
                         std::optional<double> price = {}, PriceUnit per = PriceUnit::kilogram);

}  // namespace aerate
