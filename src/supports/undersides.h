#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "core/mesh.h"
#include "kernels/constants.h"
#include "kernels/winding.h"
#include "packing/air/air_columns.h"
#include "supports/support_rules.h"

// What faces down on a model, on columns of a square grid: where it is held while it is printed, and how far it is from
// what holds it. Up is +z.

namespace aerate {

inline constexpr std::uint32_t kNoSpan = 0xffffffff;

// How each ceiling is held.
enum class Hold : std::uint8_t {
  none,    // no ceiling (open above), or of a sealed cavity
  angle,   // leans out by no more than the angle, or stands on the plate
  bridge,  // leans out further
};

// Columns (x, y) for x < count_x and y < count_y, `margin` of them mere air on each side.
struct Undersides {
  double origin_x = 0, origin_y = 0;
  double spacing = 1;
  double plate = 0;  // z of the plate
  std::uint32_t count_x = 0, count_y = 0;
  std::vector<std::uint32_t> first;  // span of each column; the count of spans
  std::vector<AirSpan> spans;
  std::vector<std::uint32_t> column_of;  // by span
  std::vector<Hold> hold;                // by span, of its ceiling
  std::vector<std::uint32_t> tips;       // spans at whose ceilings the model begins in the air

  std::size_t column(std::uint32_t x, std::uint32_t y) const {
    return static_cast<std::size_t>(y) * count_x + x;
  }
  std::uint32_t x_of(std::uint32_t span) const { return column_of[span] % count_x; }
  std::uint32_t y_of(std::uint32_t span) const { return column_of[span] / count_x; }
  double area() const { return spacing * spacing; }
  double x_at(std::uint32_t x) const { return origin_x + spacing * x; }
  double y_at(std::uint32_t y) const { return origin_y + spacing * y; }
  Vec3d place(std::uint32_t span) const { return {x_at(x_of(span)), y_at(y_of(span)), spans[span].ceiling}; }

  // Whether the model is at this height of a column.
  bool is_solid(std::size_t column, double z) const;
  // How high above the model below a place in the air of a column is; kInfinity above the plate alone.
  double height_above_model(std::size_t column, double z) const;
  // The nearest one; none beside the grid.
  std::optional<std::size_t> column_at(double x, double y) const;
  // The span of a neighbouring column whose ceiling goes on that of `span`, at (dx, dy) in columns; kNoSpan if none.
  std::uint32_t next(std::uint32_t span, int dx, int dy) const;
};

// How far apart columns are, mm: as the process needs, coarser for models with more than some millions of columns.
double column_spacing(const Mesh& upright, const SupportRules& rules);

// Columns and their spans alone, without how these are held. `winding`: of what is closed, up is +z.
Undersides columns_of(const kernels::WindingView& winding, double plate, double spacing);

// `upright`: closed, up is +z; `winding`: of it; `plate`: no higher than its lowest point. The same on any number of
// threads.
Undersides find_undersides(const Mesh& upright, const kernels::WindingView& winding,
                           const SupportRules& rules, double plate, double spacing);

// What holds a span's ceiling, at a place in or beside its column, mm.
struct Holder {
  std::uint32_t span = 0;
  double x = 0, y = 0;
};

// In the middle of a span's column.
Holder holder_in(const Undersides& undersides, std::uint32_t span);

// Along the underside, from lower to higher, as it is printed: horizontally measured, mm, from the nearest ceiling that is held by
// its angle, or from one of `held`; kInfinity for what begins in the air.
std::vector<double> distances_from_hold(const Undersides& undersides, const std::vector<Holder>& held);

// The same for some more that hold: lowers `distances`.
void hold_also(const Undersides& undersides, const std::vector<Holder>& held, std::vector<double>& distances);

}  // namespace aerate
