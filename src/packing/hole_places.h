#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <queue>
#include <span>
#include <tuple>
#include <vector>

#include "core/drainage.h"
#include "core/packing.h"
#include "kernels/winding.h"
#include "packing/hole_rules.h"
#include "packing/hole_showing.h"
#include "packing/plan_drainage.h"
#include "packing/tube_clearance.h"

namespace aerate {

// Where the surface of a model can be opened. What was found is remembered: the same voids are looked at for
// many plans.
class HolePlaces {
  struct Place;

 public:
  // Tubes that lead out of some voids, the best first. What a tube costs at least is known before its way to
  // the surface, so that is looked for only where it may be the best of those left.
  class Ranking {
   public:
    // nullopt if there are no more.
    std::optional<EscapeHole> next();

   private:
    friend class HolePlaces;
    struct Candidate {
      double cost;  // what it is at least, or what it is
      std::size_t number;
      Place* place;
      friend bool operator>(const Candidate& a, const Candidate& b) {
        return std::tie(a.cost, a.number) > std::tie(b.cost, b.number);
      }
    };
    // `lowest` and `height` are those of the voids.
    Ranking(const HolePlaces& places, std::span<Place* const> candidates, Vec3d down, double lowest,
            double height);
    double cost_of(const Place& place) const;
    void push(std::size_t number, Place& place);

    const HolePlaces& places_;
    Vec3d down_;
    double lowest_, height_;
    std::priority_queue<Candidate, std::vector<Candidate>, std::greater<>> queue_;
  };

  HolePlaces(const DrainableModel& model, std::span<const VoidShape> voids, const PackingLimits& limits,
             const DrainageRequest& request, const TubeClearance& clearance);

  // Tubes that lead out of some of the voids. `down` is the way liquid runs: the direction of gravity as
  // printed for the low hole, the opposite for the high one. A place is the better, the lower it lies in that
  // sense, the less it shows (packing/hole_showing.h), and the shorter the tube.
  // Only voids in the lowest `share` of their height in that sense are looked at.
  Ranking ranked(std::span<const std::uint32_t> voids, Vec3d down, double share);

  // Tubes that lead from voids to a place on the surface near `place`, the shortest first. Throws UsageError
  // if the surface is farther than the hole's diameter from there.
  std::vector<EscapeHole> leading_to(Vec3d place, std::span<const std::uint32_t> voids) const;

  const HoleShowing& showing() const { return showing_; }

  // Does the tube keep the wall on its way to the surface and the gap from voids, meet the surface not too
  // obliquely, and open to the outside of every shell? Remembered.
  bool is_sound(const EscapeHole& hole);

 private:
  // Before it is looked at, `sill`, `showing` and `length` are what they are at least.
  struct Place {
    EscapeHole hole;
    double sill;         // that liquid has to reach; infinite if the surface is too far away
    double showing = 0;  // to 1
    double length;       // of the tube
    bool is_looked_at = false;
  };
  using PlacesByVoid = std::vector<std::optional<std::vector<Place>>>;

  PlacesByVoid& places_of(Vec3d down);
  void find_places(std::span<const std::uint32_t> voids, Vec3d down);
  std::optional<Place> place_of(std::uint32_t from, Vec3d direction, Vec3d down, std::size_t point) const;
  void look_at(Place& place, Vec3d down) const;
  bool look_whether_sound(const EscapeHole& hole) const;
  std::optional<Tube> tube_from(const VoidShape& shape, Vec3d inside, Vec3d direction) const;
  bool reach_surface(EscapeHole& hole) const;
  std::optional<Vec3d> start_inside(const VoidShape& shape, Vec3d direction, Vec3d down,
                                    std::size_t point) const;

  std::span<const VoidShape> voids_;
  PackingLimits limits_;
  const DrainageRequest& request_;
  const TubeClearance& clearance_;
  kernels::WindingView outward_;
  HoleShowing showing_;
  std::array<PlacesByVoid, 2> places_;  // for print orientation and upside down
  std::map<std::array<double, 7>, bool> sound_;
};

}  // namespace aerate
