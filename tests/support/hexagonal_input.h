#pragma once

#include "core/mesh.h"
#include "kernels/hexagonal_strips.h"

namespace aerate::test {

// A job for the kernels themselves: no wall, no gap.
inline kernels::HexagonalInput hexagonal_input(const Mesh& mesh, double radius) {
  const Box3f box = bounding_box(mesh);
  kernels::HexagonalInput input;
  input.positions = mesh.positions;
  input.triangles = mesh.triangles;
  input.box = {to_double(box.lower), to_double(box.upper)};
  input.grid = kernels::make_cell_grid(input.box, 2 * radius);
  input.parameters.lattice_radius = radius;
  input.parameters.rounding_slack = 1e-14;
  return input;
}

}  // namespace aerate::test
