#pragma once

#include <span>

#include "core/drainage.h"
#include "core/mesh.h"
#include "core/monitor.h"
#include "mesh/inspect.h"

namespace aerate {

// Inward shells smaller than this are folds of a scan, mm3.
inline constexpr double kLeastCavity = 0.01;

// A model whose own cavities were opened by holes that lead from them to the outside.
struct ExpectedOpening {
  const Mesh& model;             // as it was
  const Inspection& inspection;  // of `model`
  const Mesh& opened;
  const Inspection& opened_inspection;
  std::span<const Tube> holes;
};

// Checks what opening a model's cavities has made of it:
//   - it is closed, without misoriented edges, with no more non-manifold edges than before;
//   - its Euler characteristic is less by 2 for each hole: each is one tube between two places of the surface;
//   - no inward shell of kLeastCavity or more is left;
//   - vertices of the model keep their places, new ones lie within the holes, and so does what was removed;
//   - no triangles intersect near the holes.
// Throws FailureError for the first that is not so; InterruptedError.
void check_opened(const ExpectedOpening& expected, Monitor& monitor);

// Whether triangles intersect near a hole that is cut through a wall.
bool is_crossed_along(const Mesh& mesh, const Tube& hole);

// Of a mesh that was read back: throws FailureError if it has an inward shell of kLeastCavity or more.
void require_no_sealed_cavity(const Mesh& read_back);

}  // namespace aerate
