#pragma once

#include <cstddef>
#include <memory>
#include <utility>

#include "core/mesh.h"
#include "printing/print_settings.h"

namespace aerate {

// What a print takes of filament, mm3, as a model of what a slicer does (docs/economics.md). None of these depends on the
// infill (but solid layers on whether modifiers have any), so that one pass over the layers answers for every infill.
struct SparseUse {
  double edge_mm3 =
      0;  // lines all along the edge of sparse infill, of which a share joins lines that end there
  double sparse_mm3 = 0;  // the space that lines of sparse infill run through
  double full_mm3 = 0;    // the same at full infill, whose lines run up to walls and solid layers
  double border_mm3 = 0;  // the same along the border of modifiers

  double volume_mm3(double infill, const PrintSettings& settings) const;
};

struct FilamentUse : SparseUse {
  double wall_mm3 = 0;   // perimeters
  double solid_mm3 = 0;  // solid layers
  SparseUse modified;    // infill in modifiers

  double volume_mm3(const PrintSettings& settings) const;
};
FilamentUse operator+(const FilamentUse& a, const FilamentUse& b);
FilamentUse operator-(const FilamentUse& a, const FilamentUse& b);

// Edge of a raster's pixels, mm.
inline constexpr double kFilamentPixel = 0.5;

// A print whose layers are cut, so that what it takes can be asked for with modifiers and without. All meshes are printed
// upwards along z, closed, outer surface and inward voids alike, and have triangles.
class SlicedPrint {
 public:
  //   pixel: edge of a pixel, mm, where the model is not so large that it has to be coarser
  static SlicedPrint of(const Mesh& mesh, const PrintSettings& settings, double pixel = kFilamentPixel);
  // Without its voids, and with them: the outer surface, which is the mesh's first triangles, is cut once for both.
  static std::pair<SlicedPrint, SlicedPrint> of_both(const Mesh& mesh, std::size_t outer_triangles,
                                                     const PrintSettings& settings,
                                                     double pixel = kFilamentPixel);
  ~SlicedPrint();
  SlicedPrint(SlicedPrint&&) noexcept;
  SlicedPrint& operator=(SlicedPrint&&) noexcept;

  // In these, closed and outward, infill is that of modifiers. Its lines end at their border and are joined along it, and on
  // the other side so are those of the rest. None if there are no triangles.
  void add_modifiers(const Mesh& modifiers, const PrintSettings& settings);

  FilamentUse use() const;

 private:
  struct Impl;
  explicit SlicedPrint(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

// Filament for a closed mesh (outer surface and inward voids alike) that is printed upwards along z. Layer by
// layer on a raster, with the exact distance of each pixel's centre from the contour: O(triangles + pixels);
// the number of threads does not change the result.
//   modifiers, pixel: see SlicedPrint
FilamentUse filament_use(const Mesh& mesh, const PrintSettings& settings, double pixel = kFilamentPixel,
                         const Mesh& modifiers = {});

}  // namespace aerate
