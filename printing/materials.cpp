#include "printing/materials.h"

#include <algorithm>
#include <cctype>
#include <string>

#include "core/error.h"

namespace aerate {
namespace {

// Densities: PLA, PETG and ABS as in the "Generic" profiles that come with PrusaSlicer 2.5
// (PrusaResearch.ini, which also gives 25.4, 27.8 and 27.8 a kilogram); PA12 from HP's fact sheet for 3D High
// Reusability PA 12 (ASTM D792). Standard photopolymers are sold at about 1.1 as liquids and cure to
// 1.1..1.2. AlSi10Mg as EOS gives it for parts of its aluminium powder.
constexpr Material kMaterials[] = {
    {"PLA", 1.24, 25.0},   {"PETG", 1.27, 28.0}, {"ABS", 1.04, 28.0},
    {"resin", 1.10, 40.0}, {"PA12", 1.01, 60.0}, {"AlSi10Mg", 2.67, 80.0},
};

bool equal_in_any_case(std::string_view a, std::string_view b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                    [](unsigned char x, unsigned char y) { return std::tolower(x) == std::tolower(y); });
}

}  // namespace

std::span<const Material> materials() {
  return kMaterials;
}

const Material& find_material(std::string_view name) {
  std::string names;
  for (const Material& material : kMaterials) {
    if (equal_in_any_case(material.name, name)) return material;
    if (!names.empty()) names += ", ";
    names += material.name;
  }
  throw UsageError("unknown material \"" + std::string(name) + "\"",
                   "use one of " + names + ", or give --density and --price");
}

}  // namespace aerate
