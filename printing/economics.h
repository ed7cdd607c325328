#pragma once

#include <optional>
#include <span>

#include "kernels/sphere.h"
#include "printing/filament_use.h"
#include "printing/print_settings.h"

namespace aerate {

// What one spherical void of this radius adds, far from other voids and from walls; its sparse_mm3 is
// negative.
FilamentUse use_of_lone_void(double radius, const PrintSettings& settings);

// The radius above which a void among others saves filament, mm: 0 if every one does, nothing if not even one
// of 240 mm does. Packings without smaller voids than this take about the least filament.
std::optional<double> break_even_radius(const PrintSettings& settings);

// The infill (0..1) above which a lone void of this radius saves filament; nothing if it never does.
std::optional<double> break_even_infill(double radius, const PrintSettings& settings);

// The infill (0..1) above which a change of this much saves filament; nothing if it never does.
// `settings.infill` is not used.
std::optional<double> break_even_infill(const FilamentUse& difference, const PrintSettings& settings);

// Whether the print takes longer with voids: a rough estimate from lengths and typical speeds, of which only
// the direction means something.
enum class TimeChange { shorter, same, longer };
TimeChange time_change(const FilamentUse& whole, const FilamentUse& hollow, std::span<const Sphere> voids,
                       const PrintSettings& settings);

}  // namespace aerate
