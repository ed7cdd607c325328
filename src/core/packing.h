#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/device.h"
#include "kernels/roof.h"
#include "kernels/sphere.h"

namespace aerate {

// What the voids of a packing must obey; millimetres. Each void is a sphere with the roof that its radius
// takes (kernels/roof.h), by default none.
struct PackingLimits {
  double wall = 0;        // least distance between a void and the model's surface
  double gap = 0;         // least distance between two voids
  double min_radius = 0;  // smaller spheres are dropped
  double max_radius = 0;  // radius of the largest sphere
  Roof roof = {};
  // An adaptive packing starts from square layers of the largest spheres that are level along `roof.up`, if that is an
  // axis of the model: the upper faces of cells between such spheres lean by just 45 degrees.
  bool in_level_squares = false;
};

// Why candidates of a packing were not kept; each candidate is counted once.
struct PackingStatistics {
  std::size_t candidates = 0;
  std::size_t outside = 0;            // winding number at the centre is 0
  std::size_t overlapped_region = 0;  // winding number is neither 0 nor 1: slicers would fill a void there
  std::size_t near_surface = 0;       // nearer to the surface than radius + wall
  std::size_t below_min_radius = 0;   // would fit, but is smaller than min_radius
  std::size_t shrunk_by_verification = 0;
  std::size_t dropped_by_verification = 0;
  std::size_t index_bytes = 0;       // memory of the triangle index
  std::size_t index_references = 0;  // of cells to triangles, where the index is made of cells
  std::size_t index_cells = 0;
};

// Disjoint spheres inside a model, in the model's own coordinates, with the limits they were packed under.
struct Packing {
  std::vector<Sphere> spheres;
  PackingLimits limits;
  PackingStatistics statistics;
  DeviceUse device;
};

// Sum of the voids' volumes, their roofs included, mm3.
double total_volume(const Packing& packing);
// The same of spheres with these roofs.
double total_volume(std::span<const Sphere> spheres, const Roof& roof);

}  // namespace aerate
