#pragma once

#include <vector>

#include "core/mesh.h"
#include "printing/cells/cell_region.h"
#include "printing/cells/shared_work.h"
#include "printing/cells/surface_placer.h"

namespace aerate {

// The vertices of a void's surface, moved into the void until no triangle is nearer to the model's surface than
// the wall: vertices keep it as they are placed, but where the void bends round the model, triangles between them
// do not. Triangles are those that a file will have, of positions rounded to fp32, and distances exact.
// Returns how far a vertex was moved at most, mm.
double keep_wall(const CellRegion& region, std::vector<PlacedVertex>& vertices,
                 const std::vector<Triangle>& triangles, SharedWork& work);

}  // namespace aerate
