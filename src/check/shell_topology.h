#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>

#include "core/mesh.h"

namespace aerate {

// How a surface hangs together.
struct SurfaceTopology {
  // Why it is not closed, oriented and 2-manifold, in words; nothing if it is.
  std::optional<std::string> flaw;
  // Else:
  std::size_t shell_count = 0;  // connected across edges
  std::int64_t euler = 0;       // of all shells: vertices - edges + triangles
  std::size_t pinch_count = 0;  // how often fans of triangles meet in a vertex alone
};

// O(triangles + range of their vertices' numbers), as long as no vertex has very many triangles.
SurfaceTopology topology_of(std::span<const Triangle> triangles);

// Why triangles are not one closed, oriented 2-manifold shell of genus 0 (the surface of a ball, bent as it
// may be), in words; nothing if they are. Costs what `topology_of` does.
std::optional<std::string> flaw_of_sphere_shell(std::span<const Triangle> triangles);

}  // namespace aerate
