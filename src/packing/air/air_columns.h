#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/mesh.h"
#include "kernels/constants.h"
#include "kernels/winding.h"
#include "packing/cells/node_pools.h"

// The air in and round a model, as vertical spans in columns that stand on a square grid: what liquid does at rest
// follows from how these hang together. Floors and ceilings are where the surface has them, and so is the
// height at which one passes from a column to the next; only what is narrower than a column is not seen.

namespace aerate {

// Heights are along +z; endless where nothing is below or above.
struct AirSpan {
  double floor = -kInfinity, ceiling = kInfinity;

  // Against gravity: upside down, the ceiling is the floor.
  double floor_in(std::size_t orientation) const { return orientation == kUpright ? floor : -ceiling; }
  double ceiling_in(std::size_t orientation) const { return orientation == kUpright ? ceiling : -floor; }
};

// Where a level line leads from one span to a neighbouring one: the lowest and the highest such line.
struct AirPassage {
  std::uint32_t to = 0;
  double lowest = 0, highest = 0;

  double sill_in(std::size_t orientation) const { return orientation == kUpright ? lowest : -highest; }
};

// Columns (x, y) for x < count_x and y < count_y; those at the rim hold nothing but air.
struct AirColumns {
  double origin_x = 0, origin_y = 0;
  double spacing = 1;
  std::uint32_t count_x = 0, count_y = 0;
  std::vector<std::uint32_t> first;        // span of each column; the count of spans
  std::vector<AirSpan> spans;              // from the lowest of its column to the highest
  std::vector<std::uint32_t> column_of;    // by span
  std::vector<std::size_t> first_passage;  // by span; the count of passages
  std::vector<AirPassage> passages;        // each both ways

  std::size_t column(std::uint32_t x, std::uint32_t y) const {
    return static_cast<std::size_t>(y) * count_x + x;
  }
  double area() const { return spacing * spacing; }
  std::span<const AirPassage> passages_of(std::uint32_t span) const {
    return std::span(passages).subspan(first_passage[span], first_passage[span + 1] - first_passage[span]);
  }
  // The middle of a span's column at a height.
  Vec3d at(std::uint32_t span, double height) const {
    const std::uint32_t x = column_of[span] % count_x, y = column_of[span] / count_x;
    return {origin_x + spacing * x, origin_y + spacing * y, height};
  }
};

// The spans of one column, from the lowest to the highest.
std::vector<AirSpan> air_spans_at(const kernels::WindingView& winding, double x, double y);

// `upright`: closed, up is +z; `winding`: of it. `margin`: columns of mere air round the model, at least 1.
AirColumns air_columns(const Mesh& upright, const kernels::WindingView& winding, double spacing,
                       std::uint32_t margin);

}  // namespace aerate
