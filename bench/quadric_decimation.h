#pragma once

#include <cstddef>

#include "core/mesh.h"

namespace aerate::bench {

// A closed surface with about so many triangles, by CGAL's edge collapse with quadric errors of planes (M. Garland
// and P. Heckbert, "Surface Simplification Using Quadric Error Metrics", 1997), which places vertices anew.
Mesh decimate_by_quadrics(const Mesh& mesh, std::size_t triangles);

}  // namespace aerate::bench
