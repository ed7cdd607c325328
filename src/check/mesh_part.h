#pragma once

#include <cstdint>
#include <span>

#include "core/mesh.h"

namespace aerate {

// Some triangles of a mesh with vertices of their own; those that shared a vertex still do.
Mesh part_of(const Mesh& mesh, std::span<const std::uint32_t> triangles);

}  // namespace aerate
