#include "pipeline/report.h"

#include <algorithm>

namespace aerate {

std::size_t blocker_triangles(const HollowReport& report) {
  return report.support_blockers != nullptr ? report.output.void_triangle_count : 0;
}

// Only prints of filament have a prediction, and only they have supports that are built of layers.
bool may_be_filled_with_supports(const HollowReport& report) {
  return report.print && report.output.void_count > 0 && !report.modifiers &&
         report.support_blockers == nullptr;
}

const ShareOfBound& blocks_like(const HollowReport& report) {
  return report.cells ? kBlocksWithCells : kBlocksWithSpheres;
}

MaterialUse material_use(const HollowReport& report) {
  const double grams_per_mm3 = report.material.density_g_cm3 / 1000;
  const double price_per_gram = report.material.price_per_kg / 1000;
  MaterialUse use;
  use.predicted = report.print && report.print->described && !report.modifiers;
  use.mass_before_g =
      (use.predicted ? report.print->filament_before_mm3 : report.output.volume_before) * grams_per_mm3;
  use.mass_after_g =
      (use.predicted ? report.print->filament_after_mm3 : report.output.volume_after) * grams_per_mm3;
  use.cost_before = use.mass_before_g * price_per_gram;
  use.cost_after = use.mass_after_g * price_per_gram;
  return use;
}

StageCost total_of(const std::vector<StageCost>& stages) {
  StageCost total{.name = "total"};
  for (const StageCost& stage : stages) {
    total.seconds += stage.seconds;
    total.peak_bytes = std::max(total.peak_bytes, stage.peak_bytes);
  }
  return total;
}

}  // namespace aerate
