#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/cells.h"
#include "core/mesh.h"
#include "core/segment_distance.h"

// Where liquid can stand in a void of any shape, counted on the nodes of a lattice.
//
// A hollow is a set of nodes that liquid fills as one: from a lowest node, or from where two hollows run over
// into each other, up to where the next one joins. The hollows of a void are a tree, the join tree of height
// on the graph of nodes and their six neighbours (H. Carr, J. Snoeyink and U. Axen, "Computing contour trees
// in all dimensions", 2003). It is made once; from then on what stays behind any openings follows from few
// hollows instead of many nodes. Hollows less deep than one spacing are not told apart.

namespace aerate {

// Orientations of the model, as indices.
inline constexpr std::size_t kUpright = 0, kUpsideDown = 1;

// Hollows of a void in one orientation. Heights are against gravity in that orientation, mm.
struct Hollows {
  std::vector<std::uint32_t> parent;  // into which it runs over; kNone for the topmost
  std::vector<double> rim;            // at this height; infinite for the topmost
  std::vector<double> bottom;         // height of the lowest node, those of hollows below included
  std::vector<std::vector<std::uint32_t>> children;
  std::vector<std::vector<std::uint32_t>> floor;  // lowest nodes; none where there are hollows below
  std::vector<std::uint32_t> of_node;

  std::size_t size() const { return parent.size(); }
};

// Nodes as rows of runs, several spacings of the lattice wide if that is necessary.
struct VoidNodes {
  NodeLattice lattice;
  std::vector<NodeRun> runs;           // ascending by z, y, x
  std::vector<std::uint32_t> first;    // number of the first node of each run, and the count of nodes
  std::vector<std::uint16_t> weights;  // of how many nodes of the void each is made; empty: 1

  std::size_t size() const { return first.empty() ? 0 : first.back(); }
  Vec3d at(std::uint32_t node) const;
  std::uint32_t number_of(std::int32_t x, std::int32_t y, std::int32_t z) const;  // kNone if there is none
};

// The nodes of a void; `halvings`: how often two by two by two of them become one. One that is there of the
// eight is enough, so that what hangs together still does. At most five times.
VoidNodes nodes_of(const CellVoid& cell_void, const NodeLattice& lattice, int halvings);

class VoidHollows {
 public:
  // Nodes that are in the same hollows in both orientations.
  struct Piece {
    std::uint32_t upright, upside_down;
    std::vector<double> heights;  // upright, ascending
    std::vector<double> volumes;  // below that height, mm3; even in between
    double volume() const { return volumes.empty() ? 0 : volumes.back(); }
  };

  // `up`: unit, against gravity in print orientation. `volume` (mm3) is shared by the nodes by the heights that they stand
  // for: floors and ceilings are then where `surface` has them, which faces into the void. O(n) in nodes.
  VoidHollows(VoidNodes nodes, Vec3d up, double volume, const Mesh& surface);

  const VoidNodes& nodes() const { return nodes_; }
  const Hollows& in(std::size_t orientation) const { return hollows_[orientation]; }
  std::span<const Piece> pieces() const { return pieces_; }
  double volume() const { return volume_; }
  double height_of(std::uint32_t node, std::size_t orientation) const;

  // Hollows that the nodes within `radius` of a segment belong to, of those that are at most a spacing above
  // `sill`; of the lowest if all are higher. If no node is that near, of one that is nearest.
  std::vector<std::uint32_t> hollows_near(const Segment& segment, double radius, double sill,
                                          std::size_t orientation) const;

 private:
  std::vector<std::uint32_t> nodes_near(const Segment& segment, double radius) const;

  VoidNodes nodes_;
  Vec3d up_;
  double volume_;
  std::array<Hollows, 2> hollows_;
  std::vector<Piece> pieces_;
};

// What of a piece is below a height along the orientation's up, mm3. Each node's share is spread evenly over the height that
// it stands for (packing/cells/node_spans.h).
double piece_below(const VoidHollows::Piece& piece, std::size_t orientation, double height);

}  // namespace aerate
