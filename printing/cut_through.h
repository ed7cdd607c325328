#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "core/drainage.h"
#include "core/mesh.h"

namespace aerate {

// A model's surface while the cavities that it has itself are opened.
struct OpenedSurface {
  // What a triangle bounds: a cavity, by its number, or one of these.
  static constexpr std::uint32_t kOutside = 0xFFFFFFFF;
  static constexpr std::uint32_t kHole = 0xFFFFFFFE;

  Mesh mesh;
  std::vector<std::uint32_t> bounds;  // by triangle
};

// Cuts a round hole through the wall between a cavity and the outside, along a tube whose axis leaves the cavity at its start
// and the model at its end: from a ring in the middle of the wall a prism is cut out of the surface at either end
// (cut_surface.h). The prism is inscribed in the tube, to the tolerance of tubes. Vertices that are there keep their numbers and
// places; new ones come after them. nullopt if either surface cannot be cut, or is not sound when it is rounded.
std::optional<OpenedSurface> cut_through(const OpenedSurface& surface, const Tube& tube, std::uint32_t cavity,
                                         double tolerance);

}  // namespace aerate
