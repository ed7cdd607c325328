#pragma once

#include <optional>
#include <span>

#include "core/mesh.h"
#include "kernels/sphere.h"
#include "printing/print_settings.h"

namespace aerate {

// What a print takes of filament, mm3, as a model of what a slicer does (docs/economics.md). None of these
// depends on the infill, so that one pass over the layers answers for every infill.
struct FilamentUse {
  double wall_mm3 = 0;       // perimeters
  double solid_mm3 = 0;      // solid layers
  double connected_mm3 = 0;  // what joins lines of sparse infill along walls, as these get very sparse
  double sparse_mm3 = 0;     // the space that sparse infill stands in

  double volume_mm3(const PrintSettings& settings) const;
};
FilamentUse operator-(const FilamentUse& a, const FilamentUse& b);

// Filament for a closed mesh (outer surface and inward voids alike) that is printed upwards along z. Layer by
// layer on a raster: O(triangles + pixels); the number of threads does not change the result.
//   pixel: edge of a pixel, mm, where the model is not so large that it has to be coarser
FilamentUse filament_use(const Mesh& mesh, const PrintSettings& settings, double pixel = 0.5);

// What one spherical void of this radius adds, far from other voids and from walls; its sparse_mm3 is
// negative.
FilamentUse use_of_lone_void(double radius, const PrintSettings& settings);

// The radius above which a void among others saves filament, mm: 0 if every one does, nothing if not even one
// of 240 mm does. Packings without smaller voids than this take about the least filament.
std::optional<double> break_even_radius(const PrintSettings& settings);

// The infill (0..1) above which such a void of this radius saves filament; nothing if it never does.
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
