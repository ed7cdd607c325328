#pragma once

#include <optional>
#include <span>
#include <string>

#include "core/mesh.h"

namespace aerate {

// Why triangles are not one closed, oriented 2-manifold shell of genus 0 (the surface of a ball, bent as it
// may be), in words; nothing if they are. O(triangles + range of their vertices' numbers), as long as no
// vertex has very many triangles.
std::optional<std::string> flaw_of_sphere_shell(std::span<const Triangle> triangles);

}  // namespace aerate
