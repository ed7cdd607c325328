#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "core/drainage.h"
#include "core/mesh.h"
#include "core/packing.h"
#include "packing/plan_drainage.h"

// Where the cavities that a model has itself, closed in by its own surface, can be opened to the outside.

namespace aerate {

struct SealedCavity {
  std::vector<std::uint32_t> triangles;  // of the model that bound it; they face into it
  double volume = 0;                     // mm3
  Vec3d place{0, 0, 0};                  // the middle of its box
};

// A way out of a cavity: the tube's axis leaves it at the start, and the model at the end.
struct CavityHole {
  std::uint32_t cavity = 0;
  Tube tube;
  double shows = 0;  // how much its place shows, 0 to 1 (packing/hole_showing.h)
};

// Can the surfaces at both of its ends be cut for it?
using CanCutThrough = std::function<bool(const CavityHole& hole)>;

// The best place for one hole, straight through the wall between a cavity and the outside: low in the sense of `down` (unit),
// where it shows little, and short, as for voids (packing/hole_places.h), on sides and with the radius that the request has.
// On its way it keeps the wall from all other surface and from kept regions, and the gap from `others`. nullopt if there
// is none that can be cut. The same for any number of threads.
std::optional<CavityHole> find_cavity_hole(const Mesh& mesh, const DrainableModel& model,
                                           const SealedCavity& cavity, std::uint32_t number,
                                           const DrainageRequest& request, const PackingLimits& limits,
                                           Vec3d down, std::span<const CavityHole> others,
                                           const CanCutThrough& can_cut);

}  // namespace aerate
