#pragma once

#include "core/mesh.h"
#include "printing/print_settings.h"

namespace aerate {

// What a print takes of filament, mm3, as a model of what a slicer does (docs/economics.md). None of these
// depends on the infill, so that one pass over the layers answers for every infill.
struct FilamentUse {
  double wall_mm3 = 0;    // perimeters
  double solid_mm3 = 0;   // solid layers
  double joined_mm3 = 0;  // what joins lines of sparse infill where they end
  double sparse_mm3 = 0;  // the space that lines of sparse infill run through
  double rim_mm3 = 0;     // the space between those and walls or solid layers, which a solid print fills

  double volume_mm3(const PrintSettings& settings) const;
};
FilamentUse operator+(const FilamentUse& a, const FilamentUse& b);
FilamentUse operator-(const FilamentUse& a, const FilamentUse& b);

// Filament for a closed mesh (outer surface and inward voids alike) that is printed upwards along z. Layer by
// layer on a raster, with the exact distance of each pixel's centre from the contour: O(triangles + pixels);
// the number of threads does not change the result.
//   pixel: edge of a pixel, mm, where the model is not so large that it has to be coarser
FilamentUse filament_use(const Mesh& mesh, const PrintSettings& settings, double pixel = 0.5);

}  // namespace aerate
