#pragma once

#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "core/mesh.h"

namespace aerate {

// A raster of pixels for the layers of a print: the same for each layer.
struct LayerRaster {
  double origin_x = 0, origin_y = 0;  // corner of the first pixel, mm
  double pixel = 0.4;                 // edge, mm
  std::size_t count_x = 0, count_y = 0;
  double first_z = 0;  // height of the first layer's middle, mm
  double layer_height = 0.2;
  std::size_t layer_count = 0;

  std::size_t pixels() const { return count_x * count_y; }
};

// The raster round a mesh, with a margin of a pixel. The pixels are no finer than `pixel`, and coarser if
// there would be more than `most_pixels` in all layers together.
LayerRaster raster_of(const Mesh& mesh, double pixel, double layer_height, double most_pixels);

// One layer of a model, as a slicer cuts it at its middle.
struct LayerSlice {
  std::vector<std::uint8_t> inside;  // pixels whose centre is in the solid (winding number at least 1)
  std::vector<float>
      depth;  // distance of a pixel's centre from the contour, on both sides, up to `reach`; else infinite
  double contour_length = 0;  // mm
};

// Cuts a closed mesh (outer surface and inward voids alike) into layers, along z.
class LayerSlicer {
 public:
  LayerSlicer(const Mesh& mesh, const LayerRaster& raster);

  // O(pixels + triangles that cross the layer). Called from any thread.
  LayerSlice slice(std::size_t layer, double reach) const;

  // The same of the mesh's first `first_triangles` triangles alone, and of all: what both have is measured once.
  std::pair<LayerSlice, LayerSlice> slices(std::size_t layer, double reach,
                                           std::size_t first_triangles) const;

 private:
  struct Segment {
    double ax, ay, bx, by;  // the solid is on the left
  };
  // Of the layer's triangles, in the mesh's order, those from number `first` on, and before number `last`.
  std::vector<Segment> contour(std::size_t layer, std::size_t first, std::size_t last) const;
  LayerSlice empty_slice() const;
  void fill(const std::vector<Segment>& contour, LayerSlice& slice) const;
  // Lowers the squares of the depths to those from these segments.
  void measure_squares(const std::vector<Segment>& contour, double reach, LayerSlice& slice) const;
  static void finish_depths(double reach, LayerSlice& slice);

  const Mesh& mesh_;
  LayerRaster raster_;
  std::vector<std::uint32_t> offsets_;     // of each layer's triangles, layer_count + 1
  std::vector<std::uint32_t> references_;  // triangles that may cross the layer's middle
};

}  // namespace aerate
