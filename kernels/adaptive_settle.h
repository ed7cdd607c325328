#pragma once

#include "kernels/adaptive_cells.h"
#include "kernels/adaptive_field.h"
#include "kernels/adaptive_idle.h"
#include "kernels/adaptive_refine.h"
#include "kernels/adaptive_selection.h"
#include "kernels/vec.h"
#include "kernels/view.h"

// Where a ball of the largest radius permitted comes to rest.
//
// Where the clearance f exceeds the largest radius R there is room to choose, and the middle of the room is
// the worst choice: it leaves gaps all round. So the ball is pulled in one direction until it touches three
// of surface and balls: the point farthest along the pull where f >= R. That is the search of
// adaptive_refine.h with a plane g for one of the four constraints, which rises along the pull and is shifted
// until the maximum of min(f, g) has the value R (Newton's method; the derivative is the plane's weight).

namespace aerate::kernels {

struct RestingPlace {
  Vec3d point;
  double value;  // f(point), at most R
  bool at_rest;  // else it got as far as `point`, and the value means nothing
};

struct Settling {
  double radius;
  double tolerance = 1e-4;  // of the clearance at rest, to the radius
  Vec3d pull{-0.57735026918962576, -0.57735026918962576, -0.57735026918962576};  // unit, along a diagonal

  // A clearance that no ball at rest is below.
  AERATE_HD double least() const { return radius * (1 - 2 * tolerance); }
};

// `start`: f is at least `settling.least()` there.
template <typename Shape>
AERATE_HD inline RestingPlace find_resting_place(const FieldView<Shape>& field, Vec3d start,
                                                 const Settling& settling) {
  constexpr int kMostSteps = 120;
  constexpr int kMostRestarts = 8;
  const double slack = settling.tolerance * settling.radius;
  const double wanted = settling.radius + 0.5 * slack;
  const double reach = settling.radius;  // how far a ball is moved at a time, about
  SurfaceAnchor anchor{start, 0, kNone};
  Vec3d p = start, from = start;
  const auto nowhere = [](Vec3d end) { return RestingPlace{end, 0, false}; };
  FourConstraints four;
  four.reset_with_pull(p, settling.pull, wanted - reach, wanted + reach * (1.0 / 3), 1024 * reach);
  int restarts = 0;
  for (int step_count = 0; step_count < kMostSteps; ++step_count) {
    for (int k = 0; k < 2; ++k) {
      if (!four.linearise(p)) return nowhere(p);
      Vec3d step = four.step();
      const double walked = length(step);
      if (walked > reach) step = step * (reach / walked);
      p = p + step;
      if (walked < 1e-3 * settling.radius) break;
    }
    if (!four.linearise(p)) return nowhere(p);
    const double model = four.greatest();
    const double enough = min_of(model, settling.radius) - slack;
    const Clearance here = clearance_at(field, anchor, p, settling.radius, enough);
    if (here.value < enough) {
      if (!four.enter_beside_pull(here, p)) return nowhere(p);
      continue;
    }
    const double missing = wanted - model;
    if (missing >= 0.25 * slack || missing <= -0.25 * slack) {
      const double weight = four.pull_weight();
      if (!(weight > 1e-3)) return nowhere(p);
      four.raise_pull(missing / weight);
      continue;
    }
    const bool moved = dot(p - from, settling.pull) >= 1e-2 * settling.radius;
    if (four.any_artificial_beside_pull() && moved) {
      // Nothing but the end of the region searched holds it: on from here.
      if (++restarts > kMostRestarts) return nowhere(p);
      from = p;
      four.reset_with_pull(p, settling.pull, wanted - reach, wanted + reach * (1.0 / 3), 1024 * reach);
      continue;
    }
    return {p, here.value, here.value >= settling.least()};
  }
  return nowhere(p);
}

// Kernel: lets candidates come to rest, those farthest along the pull first; the others are none.
template <typename Shape>
struct Settle {
  CellsView cells;
  View<const std::uint32_t> list;
  FieldView<Shape> field;
  Settling settling;
  double shrink;  // taken off every radius, against rounding
  View<Candidate> candidates;
  View<std::uint8_t> found;
  View<IdlePath> paths;  // by cell

  AERATE_HD void operator()(std::size_t i) const {
    const std::uint32_t id = list[i];
    paths[id] = IdlePath::none();
    if (found[i] == 0) return;
    const RestingPlace place = find_resting_place(field, candidates[i].point, settling);
    found[i] = place.at_rest ? 1 : 0;
    if (!place.at_rest) {
      paths[id] = IdlePath::along(place.point - cells.cells[id].centre);
      return;
    }
    candidates[i] = {place.point, min_of(place.value, settling.radius) - shrink};
  }
};

}  // namespace aerate::kernels
