#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "core/drainage.h"
#include "packing/cells/node_pools.h"

// How liquid runs through the hollows of voids that windows and holes open, and what stays. A flood in order
// of height from the holes gives each hollow its spill height: the least height, over all ways out, of the
// highest sill or rim on the way (priority flood; R. Barnes, C. Lehman and D. Mulla, "Priority-flood", 2014).
// What of a hollow lies below that stays in it.

namespace aerate {

// Where a passage opens into a void: the hollows beside it that it drains, by orientation.
struct Mouth {
  std::uint32_t into = kNone;  // void; kNone: outside
  std::array<std::vector<std::uint32_t>, 2> hollows;
};

// A window or a hole as liquid sees it.
struct Passage {
  std::array<double, 2> sill;  // that liquid has to reach to pass it, by orientation, along its up
  std::array<Mouth, 2> mouths;

  bool leads_out() const { return mouths[1].into == kNone; }
};

// Passages by address, so that a draft is cheap to change.
using Passages = std::vector<const Passage*>;

// Spill heights by vertex: hollows of all voids, then passages.
struct HollowFlood {
  std::vector<double> height;  // infinite if nothing leads out
  std::vector<std::uint32_t>
      towards;  // the vertex that it runs over into; kNone at a hole, or if there is none
};

// What stays in print orientation in hollows that are one basin: of one spill height along a way out.
struct Basin {
  double volume = 0;  // mm3
  struct Part {
    std::uint32_t in, hollow;
  };
  std::vector<Part> hollows;
};

class CellPools {
 public:
  explicit CellPools(std::span<const VoidHollows> voids);

  std::span<const VoidHollows> voids() const { return voids_; }
  std::uint32_t vertex(std::uint32_t in, std::uint32_t hollow, std::size_t orientation) const {
    return first_[orientation][in] + hollow;
  }
  std::uint32_t hollow_count(std::size_t orientation) const { return first_[orientation].back(); }

  // `accept`, if given, is called once for each passage between voids that the flood comes to, with the
  // number of the void on its other side, or of `mouths[1]` if both were reached; false: it is not there.
  using Accept = std::function<bool(std::size_t passage, bool reaches_a_void)>;
  HollowFlood flood(const Passages& passages, std::size_t orientation, const Accept& accept = {}) const;

  // Of the voids that are kept. `after_both` is an upper bound. What stays upright runs, once the model is
  // turned, down from where it is into any hollows below it, and from full ones along their ways out; how it
  // parts between several is not known, so it is taken to part such that the most stays (a maximal flow).
  // Each litre is counted once, and no hollow holds more than stays in it upside down.
  TrappedPools measure(const Passages& passages, std::span<const char> is_kept) const;

  // By void, what stays in one orientation, mm3.
  std::vector<double> stays_in(const HollowFlood& flood, std::size_t orientation) const;

  // The largest first.
  std::vector<Basin> basins(const HollowFlood& flood, std::size_t orientation,
                            std::span<const char> is_kept) const;

 private:
  std::span<const VoidHollows> voids_;
  std::array<std::vector<std::uint32_t>, 2> first_;    // vertex of each void's first hollow; the count
  std::array<std::vector<std::uint32_t>, 2> void_of_;  // by vertex
};

}  // namespace aerate
