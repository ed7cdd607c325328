#pragma once

#include <optional>
#include <string>

#include "core/monitor.h"
#include "core/packing.h"
#include "core/solid.h"
#include "pipeline/options.h"
#include "printing/economics.h"

namespace aerate {

// What a print takes at some infill, without voids and with them.
struct FilamentChange {
  double infill = 0;  // 0..1
  double before_mm3 = 0;
  double after_mm3 = 0;

  // How much more it takes, as a share; negative: less.
  double share() const { return before_mm3 > 0 ? after_mm3 / before_mm3 - 1 : 0; }
  bool heavier() const { return after_mm3 > before_mm3; }
};

// Predictions are off by so much of the print without voids at most (docs/economics.md).
inline constexpr double kUncertainShare = 0.015;

// What is taken for the infill of a print that is not described.
inline constexpr double kUsualInfill = 0.15;

// What voids change about a print of filament, as predicted.
struct PrintPrediction {
  PrintSettings settings;
  bool of_modifiers = false;  // the voids are
  // Its infill was said; else it is not known: for voids taken to be solid, for modifiers 15 %.
  bool described = false;
  double filament_before_mm3 = 0;
  double filament_after_mm3 = 0;
  std::optional<double> break_even_infill;  // these voids save above it (0..1); nothing: never
  std::optional<double>
      break_even_radius;  // a void far from others saves above it, mm; nothing: never, or modifiers
  TimeChange time = TimeChange::same;
  FilamentChange usual;  // at the print's infill, or the usual one if that is not known
  FilamentChange solid;  // at 100 %
  // How much more `usual` would take with the same voids as modifiers of 0 % infill, as a share. Absent unless voids
  // make it heavier.
  std::optional<double> as_modifiers;

  bool heavier() const { return filament_after_mm3 > filament_before_mm3; }
};

// The request with voids left out that would take more filament than they save: a larger min_radius, with a notice, of
// `options.paying_share`. Nothing is changed if its infill is not known, if it may become heavier, or for given spheres.
// Throws NothingToRemoveError with the figures if not even the largest void is so large.
PackingRequest without_voids_that_cost(PackingRequest request, const HollowOptions& options,
                                       Monitor& monitor);

// Throws NothingToRemoveError for modifiers with no less infill than the print, unless it may become heavier.
void require_modifiers_that_save(const HollowOptions& options);

// "voids of 3.5 mm save above 62 % infill", and what else there is to do.
std::string where_voids_pay(double radius, const PrintSettings& settings);

// `outer`: the surface of `solid` without the voids. Nothing where the process prints no filament, and for modifiers that hold
// lightning.
std::optional<PrintPrediction> predict_print(const Mesh& outer, const Solid& solid, const Packing& packing,
                                             const HollowOptions& options, Monitor& monitor);

// What follows from a prediction: throws NothingToRemoveError with its figures if the print's infill is known and it would
// become heavier, unless the options allow it; then, and where the usual print would, it is a notice.
void judge(const PrintPrediction& prediction, const HollowOptions& options, Monitor& monitor);

}  // namespace aerate
