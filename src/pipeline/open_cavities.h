#pragma once

#include <cstddef>
#include <vector>

#include "core/drainage.h"
#include "core/monitor.h"
#include "packing/cavity_holes.h"
#include "pipeline/process_choice.h"

namespace aerate {

struct PreparedModel;

// A cavity that a model had itself, and the holes that open it: two, one low and one high as printed, where both find a
// place.
struct OpenedCavity {
  double volume = 0;     // mm3
  Vec3d place{0, 0, 0};  // the middle of its box
  std::vector<CavityHole> holes;
};

struct OpenedCavities {
  std::vector<OpenedCavity> cavities;  // the largest first
  double removed = 0;                  // by the holes, mm3

  double volume() const;
  std::size_t hole_count() const;
};

// How they are opened.
struct OpeningPolicy {
  DrainageRequest request;  // radii and sides of holes; of its places none is for cavities
  PackingLimits limits;
  double tolerance = 0;  // mm
};

// A usable model with its own cavities (own_cavities.h) opened: holes straight through the wall are part of its surface from
// then on, so that voids keep the wall from them. They keep off regions that stay solid, if the model has these already. Off
// the build plate where that can be; as narrow as channels, with a notice, where the usual width finds no place; a
// cavity with one hole is told in a notice. The result is checked (check_opened.h). Throws NothingToRemoveError
// for a cavity that no hole leads out of, FailureError, InterruptedError.
PreparedModel with_open_cavities(PreparedModel model, const OpeningPolicy& policy, Monitor& monitor);

}  // namespace aerate
