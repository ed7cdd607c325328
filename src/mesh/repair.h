#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "core/mesh.h"
#include "mesh/inspect.h"

namespace aerate {

// What was changed, in words for the user, one line each; empty if nothing was.
struct Repaired {
  Mesh mesh;
  std::vector<std::string> notices;
};

// Closes cracks of no width: open edges that lie on each other but for rounding, as exports write them whose
// vertices differ in their last digits. Vertices at open edges that are at most `tolerance` mm apart become one,
// at the place of the lowest index, from which none is further than that; where one long edge faces several
// short ones, triangles no wider than that are added at the end. Only what closes open edges is joined: a mesh
// without any stays as it is. Triangles keep their order; some may come to name a vertex twice. O(m) expected.
Repaired close_cracks(Mesh mesh, double tolerance);

// A rim that is no hole: its sides lie on each other, no further apart than a fiftieth of its size.
struct Crack {
  BoundaryLoop rim;
  double width;  // mm
  double weld;   // with which close_cracks closes it and all that are as wide, mm
};

// The largest crack among the boundary's loops, if there is one.
std::optional<Crack> find_crack(const Mesh& mesh);

// Takes bodies that lie in one place, triangle for triangle, once: the later copies go. Single triangles that
// are there twice go where edges then agree better; others stay. Triangles keep their order.
Repaired unite_doubles(Mesh mesh);

// Leaves out triangles that use a vertex twice: they bound nothing, and slicers see open edges at them. (Those
// without area whose vertices differ close T-junctions, and stay.) Vertices are numbered by first use again.
// A mesh of nothing else stays as it is.
Repaired without_repeated_vertices(Mesh mesh);

// Turns single triangles so that those with a common edge of two triangles run along it in opposite
// directions; the lesser part of a patch is turned. A shell that cannot be made consistent (like a Moebius
// strip, or at edges of more than two triangles) stays as it is, with a notice. Triangles keep their order; a
// turned one swaps its last two indices. Whether a shell is inside out as a whole is for `orient_outward`.
Repaired orient_consistently(Mesh mesh);

// Turns closed shells that are inside out: those that only make sense if all winding numbers change their
// sign, such as a shell of negative volume that no other encloses, and a cavity of positive volume inside
// one. Cavities (inward shells inside an outward one) stay. Triangles keep their order; a turned one swaps
// its last two indices. Where open shells are to be closed, do that first.
Repaired orient_outward(Mesh mesh);

// Closes boundary loops of at most `max_diameter` mm with CGAL's hole filling: triangles between the vertices
// of the loop are added at the end. Throws MeshError, naming the largest loop and where it is, if one is
// larger, or if a loop could not be filled.
Repaired fill_holes(Mesh mesh, double max_diameter);

}  // namespace aerate
