#pragma once

#include <cstdint>
#include <functional>
#include <unordered_map>
#include <vector>

#include "core/drainage.h"

namespace aerate {

// Distance that the axes of two tubes have to keep where both meet one void, so that an edge of one's rim
// does not cut the other.
double tube_spacing(double radius, double other_radius);

// The channels and holes of a plan that is being made, and how far others have to keep from them. A value:
// a stage that may not be worth it works on a copy.
class PlacedTubes {
 public:
  // Tubes keep `gap` from each other. None is longer than `longest` or has a larger radius than
  // `widest_radius`. Millimetres.
  PlacedTubes(const Roof& roof, double gap, double longest, double widest_radius);

  // Its channels and holes are those that are placed, in that order; it counts no networks or pools.
  const DrainagePlan& plan() const { return plan_; }

  // Does a tube between two voids (or out of one, which is then both) keep the gap from those that are
  // placed? On a void that both meet, openings are apart by a share of their radius at least.
  bool keep_clear_of(const Tube& tube, std::uint32_t from, std::uint32_t to) const;

  void place(const Channel& channel);
  void place(const EscapeHole& hole);
  // All that lead from or to such voids.
  void remove_tubes_of(const std::function<bool(std::uint32_t)>& is_such);

 private:
  struct Placed {
    Tube tube;
    std::uint32_t from, to;
  };
  void enter(const Placed& placed);
  std::uint64_t cell_of(const Tube& tube, int dx, int dy, int dz) const;

  DrainagePlan plan_;
  double gap_;
  double cell_size_;
  std::unordered_map<std::uint64_t, std::vector<Placed>> cells_;  // by the middle of a tube
};

}  // namespace aerate
