#pragma once

#include <cstdint>
#include <vector>

#include "core/mesh.h"
#include "kernels/cell_planes.h"
#include "kernels/vec.h"

// Voids that fill the cells of their packing's power diagram, instead of the spheres alone. Millimetres.

namespace aerate {

// Nodes of a lattice, from `first` to `last` along x.
struct NodeRun {
  std::int32_t first = 0, last = 0;
  std::int32_t y = 0, z = 0;
};

// Points at whole multiples of a spacing from an origin; all voids of a result share one.
struct NodeLattice {
  Vec3d origin{0, 0, 0};
  double spacing = 1;

  Vec3d at(std::int32_t x, std::int32_t y, std::int32_t z) const {
    return origin + Vec3d{spacing * x, spacing * y, spacing * z};
  }
};

// One connected piece of a cell.
struct CellVoid {
  std::uint32_t cell = 0;     // of which sphere of the packing
  bool has_roof = false;      // under planes of its own, that carry themselves or can be bridged
  Mesh surface;               // closed, facing into the void
  std::int64_t euler = 2;     // Euler characteristic of the surface, counted on the nodes
  double planned_volume = 0;  // of the surface before triangles were taken out
  double deviation = 0;       // how far that surface lies from `surface` at most
  std::vector<NodeRun>
      nodes;  // the lattice's nodes in it, ascending by z, y, x; two runs never touch along x
};

struct CellVoids {
  CellPlanes planes;  // of each sphere's cell, moved in by half the gap
  NodeLattice lattice;
  double ball_radius = 0;       // of the ball that every void is a union of
  std::vector<CellVoid> voids;  // by cell; pieces of one cell by size, the largest first
};

}  // namespace aerate
