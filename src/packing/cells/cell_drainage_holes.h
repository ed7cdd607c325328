#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <span>
#include <tuple>
#include <vector>

#include "packing/cells/cell_drainage_ways_out.h"
#include "packing/hole_showing.h"
#include "packing/plan_drainage.h"

namespace aerate {

// The ways out of voids of any shape by tubes of one radius. What was found is remembered: the same hollows are looked at for
// many plans, whose requests have the same sides.
class CellHoleWays {
 public:
  using Ways = std::vector<CellWayOut>;

  // `hollows`: by void. All have to outlive this.
  CellHoleWays(const DrainableModel& model, const CellVoids& cells, const std::vector<VoidHollows>& hollows,
               const PackingLimits& limits, double radius, const CellSurfaces& surfaces,
               const HoleSides& sides);

  const WaysOut& tubes() const { return tubes_; }

  // A node of a void, as liquid gets there in an orientation.
  struct Start {
    std::size_t orientation;
    std::uint32_t from, node;
    friend bool operator<(const Start& a, const Start& b) {
      return std::tie(a.orientation, a.from, a.node) < std::tie(b.orientation, b.from, b.node);
    }
  };
  // The ways from there, which stay where they are; `is_new`: they are still to be looked for.
  struct Known {
    Ways* ways;
    bool is_new;
  };
  Known known(const Start& start);
  Ways look_from(const Start& start) const;

 private:
  const CellVoids& cells_;
  const std::vector<VoidHollows>& hollows_;
  Vec3d up_;
  WaysOut tubes_;
  std::array<std::vector<Vec3d>, 2> directions_;  // by orientation
  std::map<Start, Ways> known_;
};

// Where voids of any shape can be opened to the outside as one request wants it.
class CellHolePlaces {
 public:
  using Accept = std::function<bool(const CellHole& hole)>;

  // `hollows`: by void. All have to outlive this.
  CellHolePlaces(const DrainableModel& model, const CellVoids& cells, const std::vector<VoidHollows>& hollows,
                 const PackingLimits& limits, const DrainageRequest& request, const CellSurfaces& surfaces,
                 CellHoleWays& ways);

  // A hole that drains one of some hollows in that orientation: the best that is sound and accepted. A place
  // is the better, the lower liquid gets there, the less it shows in print orientation, and the shorter the
  // tube. Only hollows in the lowest `share` of the height of all are looked at.
  std::optional<CellHole> best(std::span<const Basin::Part> hollows, std::size_t orientation, double share,
                               const Accept& accept);

  // The shortest hole that opens near a place on the surface. Throws UsageError if the surface is farther
  // than the hole's diameter from there.
  std::optional<CellHole> leading_to(Vec3d place, std::span<const std::uint32_t> voids,
                                     const Accept& accept) const;

  const HoleShowing& showing() const { return showing_; }

 private:
  using Ways = CellHoleWays::Ways;
  class Ranking;
  bool is_allowed(CellWayOut& way) const;

  const CellVoids& cells_;
  const std::vector<VoidHollows>& hollows_;
  PackingLimits limits_;
  const CellSurfaces& surfaces_;
  kernels::WindingView outward_;
  CellHoleWays& ways_;
  const WaysOut& ways_out_;
  HoleShowing showing_;
  bool avoids_plate_;
  double worth_of_hiding_;
};

}  // namespace aerate
