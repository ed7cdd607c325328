#pragma once

#include <optional>
#include <string>

#include "core/monitor.h"
#include "core/packing.h"
#include "core/solid.h"
#include "pipeline/options.h"
#include "printing/economics.h"

namespace aerate {

// What voids change about a print of filament, as predicted.
struct PrintPrediction {
  PrintSettings settings;
  // Its infill was said; else it is not known: for voids taken to be solid, for modifiers 15 %.
  bool described = false;
  double filament_before_mm3 = 0;
  double filament_after_mm3 = 0;
  std::optional<double> break_even_infill;  // these voids save above it (0..1); nothing: never
  std::optional<double>
      break_even_radius;  // a void far from others saves above it, mm; nothing: never, or modifiers
  TimeChange time = TimeChange::same;

  bool heavier() const { return filament_after_mm3 > filament_before_mm3; }
};

// The request with voids left out that would take more filament than they save, each by itself: a larger
// min_radius, with a notice. Nothing is changed if its infill is not known, if it may become heavier, or
// for given spheres. Throws NothingToRemoveError with the figures if even the largest void would not pay.
PackingRequest without_voids_that_cost(PackingRequest request, const HollowOptions& options,
                                       Monitor& monitor);

// Throws NothingToRemoveError for modifiers with no less infill than the print, unless it may become heavier.
void require_modifiers_that_save(const HollowOptions& options);

// "voids of 3.5 mm save above 62 % infill", and what else there is to do.
std::string where_voids_pay(double radius, const PrintSettings& settings);

// `outer`: the surface of `solid` without the voids. Nothing where the process prints no filament. Throws
// NothingToRemoveError if the print's infill is known and it would become heavier, unless the options allow it; then it
// is a notice.
std::optional<PrintPrediction> predict_print(const Mesh& outer, const Solid& solid, const Packing& packing,
                                             const HollowOptions& options, Monitor& monitor);

}  // namespace aerate
