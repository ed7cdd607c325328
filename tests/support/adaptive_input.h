#pragma once

#include <cmath>

#include "core/mesh.h"
#include "kernels/adaptive_packing.h"

namespace aerate::test {

// A job for the kernels themselves: no wall, no gap, and still without an end.
inline kernels::AdaptiveInput adaptive_input(const Mesh& mesh) {
  const Box3f box = bounding_box(mesh);
  kernels::AdaptiveInput input;
  input.positions = mesh.positions;
  input.triangles = mesh.triangles;
  input.box = {to_double(box.lower), to_double(box.upper)};
  input.volume = std::abs(signed_volume(mesh));
  return input;
}

}  // namespace aerate::test
