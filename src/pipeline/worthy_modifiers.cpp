#include "pipeline/worthy_modifiers.h"

#include <algorithm>
#include <fmt/format.h>
#include <optional>
#include <utility>
#include <vector>

#include "kernels/sphere.h"
#include "pipeline/held_notices.h"
#include "pipeline/print_prediction.h"

namespace aerate {
namespace {

// Of filament, that may be lost for a shorter print.
constexpr double kMayBeLost = 0.005;

Packing from_radius_on(const Packing& packing, double least) {
  Packing some = packing;
  std::erase_if(some.spheres, [&](const Sphere& sphere) { return sphere.radius < least; });
  return some;
}

// Least radii to try, mm, from that of the packing to that of its largest sphere, each 1.4 times the one before.
std::vector<double> radii_to_try(const Packing& packing) {
  constexpr double kStep = 1.4;
  const auto radius = [](const Sphere& sphere) { return static_cast<double>(sphere.radius); };
  const double largest = radius(*std::ranges::max_element(packing.spheres, {}, radius));
  std::vector<double> radii;
  double least = packing.limits.min_radius;
  while (least <= largest) {
    radii.push_back(least);
    least *= kStep;
  }
  return radii;
}

}  // namespace

Packing worthy_modifiers(const PreparedModel& model, const Packing& packing, const HollowOptions& options,
                         const std::function<Solid(const Packing& some)>& solid_of, Monitor& monitor) {
  struct Choice {
    double least = 0;
    Packing packing;
    double filament = 0;  // mm3
  };
  if (packing.spheres.empty()) return packing;
  HollowOptions judged = options;
  judged.heavier = HeavierPrint::allow;  // of what is only tried nothing is said
  std::vector<Choice> choices;
  for (const double least : radii_to_try(packing)) {
    Packing some = from_radius_on(packing, least);
    if (!choices.empty() && some.spheres.size() == choices.back().packing.spheres.size()) continue;
    HeldNotices held(monitor);
    const std::optional<PrintPrediction> print =
        predict_print(model.mesh, solid_of(some), some, judged, held);
    if (!print) return packing;
    choices.push_back({least, std::move(some), print->filament_after_mm3});
  }
  const double best = std::ranges::min_element(choices, {}, &Choice::filament)->filament;
  auto chosen = std::ranges::find_if(choices.rbegin(), choices.rend(), [&](const Choice& choice) {
    return choice.filament <= (1 + kMayBeLost) * best;
  });
  if (chosen->packing.spheres.size() < packing.spheres.size())
    monitor.notice(
        fmt::format("{} instead of {} modifiers, of a radius of {:.2g} mm and more: smaller ones would save "
                    "less than {:g} % of the "
                    "filament and make the print longer (--min-radius)",
                    chosen->packing.spheres.size(), packing.spheres.size(), chosen->least, 100 * kMayBeLost));
  return std::move(chosen->packing);
}

}  // namespace aerate
