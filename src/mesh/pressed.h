#pragma once

#include "core/mesh.h"

namespace aerate {

// A closed mesh with all that is beyond a box pressed onto its sides: the same within the box, closed, and no larger
// than that. Triangles across a side are cut along it.
Mesh pressed_into(const Box3f& box, const Mesh& mesh);

}  // namespace aerate
