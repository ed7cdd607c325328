#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "core/mesh.h"

namespace aerate {

// What was changed, in words for the user, one line each; empty if nothing was.
struct Repaired {
  Mesh mesh;
  std::vector<std::string> notices;
};

// Turns shells that are inside out: an edge-connected closed shell of negative volume that no other shell
// encloses. Cavities (inward shells inside another shell) stay. Triangles keep their order; a turned one
// swaps its last two indices.
Repaired orient_outward(Mesh mesh);

// Closes boundary loops of at most `max_diameter` mm with CGAL's hole filling. Throws MeshError, naming the
// largest loop and where it is, if one is larger, or if a loop could not be filled.
Repaired fill_holes(Mesh mesh, double max_diameter);

}  // namespace aerate
