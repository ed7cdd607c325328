#pragma once

#include <vector>

#include "core/solid.h"
#include "printing/slicers/object_parts.h"

// Volumes in which a slicer builds no supports, for voids that it would fill with them. A slicer asks a blocker in the layer
// that needs support, which over a void is the first one above it: a blocker of the void's own size keeps nothing out
// (PrusaSlicer 2.5: 839 pieces of support in 56 voids, 863 with such blockers). So a blocker is its void, larger all
// round by more than a layer.
namespace aerate {

// By how much at least, where facets meet bluntly, for voids behind such a wall; no vertex moves by more than half
// of the wall. A wall is three lines thick by default, and a layer lower than a line is wide. Lengths in mm.
double growth_of_blockers(double wall);

// A closed outward mesh whose facets are moved outward by that much; at sharp edges by less, so that no vertex moves
// further than half as much again.
Mesh grown(Mesh shell, double by);

// The mesh of a solid whose voids are sealed, with a blocker for each of them after its triangles.
Mesh with_support_blockers(const Solid& solid, double growth);

// The parts of such a mesh: the solid, and one that holds all blockers.
std::vector<ObjectPart> blocker_parts(const Solid& solid);

}  // namespace aerate
