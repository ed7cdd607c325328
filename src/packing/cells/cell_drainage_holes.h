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

// Where voids of any shape can be opened to the outside. What was found is remembered: the same hollows are
// looked at for many plans.
class CellHolePlaces {
 public:
  using Accept = std::function<bool(const CellHole& hole)>;

  // `hollows`: by void.
  CellHolePlaces(const DrainableModel& model, const CellVoids& cells, const std::vector<VoidHollows>& hollows,
                 const PackingLimits& limits, const DrainageRequest& request, double radius,
                 const CellSurfaces& surfaces);

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
  using Ways = std::vector<CellWayOut>;
  class Ranking;
  Ways ways_from(std::uint32_t from, std::uint32_t node, std::size_t orientation) const;

  const CellVoids& cells_;
  const std::vector<VoidHollows>& hollows_;
  PackingLimits limits_;
  const CellSurfaces& surfaces_;
  kernels::WindingView outward_;
  WaysOut ways_out_;
  HoleShowing showing_;
  double worth_of_hiding_;
  std::array<std::vector<Vec3d>, 2> directions_;                                 // by orientation
  std::map<std::tuple<std::size_t, std::uint32_t, std::uint32_t>, Ways> known_;  // orientation, void, node
};

}  // namespace aerate
