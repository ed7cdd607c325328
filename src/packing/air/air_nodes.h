#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/surface_index.h"
#include "packing/air/air_columns.h"

namespace aerate {

// The columns' air at heights a spacing apart. Nodes of a column follow each other; a node's number is
// column * count_z + layer.
struct AirNodes {
  double origin_z = 0;
  std::uint32_t count_z = 0;
  // Distance to the surface as far as that is below `reach`, mm; negative in the solid.
  std::vector<float> clearance;
  double reach = 0;
  std::vector<std::uint32_t> span;  // kNone in the solid
  // Whether a ball as wide as was asked for, as it comes in from outside, covers it.
  std::vector<char> is_outside;

  double height(std::uint32_t layer, double spacing) const { return origin_z + spacing * layer; }
};

// The nodes beside a node, as far as they are of air and nothing stands between: those of its own column, and those to
// which a line is within the balls that are clear of the surface round both.
class AirNeighbours {
 public:
  AirNeighbours(const AirColumns& columns, const AirNodes& nodes);

  // f(node, axis, side)
  template <typename F>
  void for_each(std::size_t node, const F& f) const {
    const std::size_t layer = node % nodes_.count_z, column = node / nodes_.count_z;
    const std::size_t x = column % columns_.count_x, y = column / columns_.count_x;
    const auto look = [&](bool is_there, std::ptrdiff_t step, int axis) {
      const auto other = static_cast<std::size_t>(static_cast<std::ptrdiff_t>(node) + step);
      if (is_there && is_joined(node, other)) f(other, axis, step > 0 ? 1 : -1);
    };
    const auto row = static_cast<std::ptrdiff_t>(nodes_.count_z);
    const auto plane = row * static_cast<std::ptrdiff_t>(columns_.count_x);
    look(x > 0, -row, 0);
    look(x + 1 < columns_.count_x, row, 0);
    look(y > 0, -plane, 1);
    look(y + 1 < columns_.count_y, plane, 1);
    look(layer > 0, -1, 2);
    look(layer + 1 < nodes_.count_z, 1, 2);
  }

 private:
  bool is_joined(std::size_t a, std::size_t b) const {
    if (nodes_.span[a] == kNone || nodes_.span[b] == kNone) return false;
    if (nodes_.span[a] == nodes_.span[b]) return true;
    if (a / nodes_.count_z == b / nodes_.count_z) return false;
    return static_cast<double>(nodes_.clearance[a]) + static_cast<double>(nodes_.clearance[b]) >
           columns_.spacing;
  }

  const AirColumns& columns_;
  const AirNodes& nodes_;
};

// Columns of mere air that a ball needs round the model.
std::uint32_t margin_for(double ball_radius, double spacing);

// `surface`: what the columns were made of. The columns' margin leaves room for the ball. Memory: 25 bytes a node while it
// is made.
AirNodes air_nodes(const AirColumns& columns, const SurfaceIndex& surface, double ball_radius);

}  // namespace aerate
