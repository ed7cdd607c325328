#include "supports/tooth_surfaces.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <vector>

#include "core/facet_distance.h"
#include "packing/air/air_columns.h"

namespace aerate {
namespace {

constexpr std::uint32_t kConeSides = 12;
// A cone is so much wider at its base than at its tip, for its height; no more than so often.
constexpr double kConeSlope = 0.35, kWidestBase = 2.5;
// Where there is no room for a tip, one so much narrower may have some.
constexpr double kNarrowTip = 0.6;
// A flat tip below a point is farther from it at its middle; no more than so many gaps.
constexpr double kMostGap = 1.25;
// And a foot below one of its rims, beside what it would stand on.
constexpr double kMostBeside = 2;
// The share of the least height that is enough on the plate, where layers begin.
constexpr double kLeastShareOnPlate = 0.6;

// Heights between which a tooth is, at one place.
struct Extent {
  double lower = 0, upper = 0;
};

// One side of a cut across a ridge.
struct Flank {
  double x = 0, y = 0;
  Extent z;
};

// The air below a height near to `z`, at any place.
AirSpan air_below(const kernels::WindingView& solid, double x, double y, double z) {
  AirSpan best;
  double least = kInfinity;
  for (const AirSpan& span : air_spans_at(solid, x, y)) {
    if (span.floor >= z || !std::isfinite(span.ceiling)) continue;
    const double off = std::abs(span.ceiling - z);
    if (off < least) {
      least = off;
      best = span;
    }
  }
  return best;
}

// What holds between a model above and a body or the model below.
class BelowModel {
 public:
  BelowModel(const kernels::WindingView& model, const kernels::WindingView* body, double plate,
             const ToothShape& shape)
      : model_(model), body_(body), plate_(plate), shape_(shape) {}

  // `ceiling`: of the column that the tooth is in. Lower than that where the model is beside it; nothing where that would be lower
  // by more than `nearest`.
  Extent extent(double x, double y, double ceiling, double nearest) const {
    AirSpan air = air_below(model_, x, y, ceiling);
    if (std::abs(air.ceiling - ceiling) > nearest) {
      // A free edge, if there is air; else a wall.
      air = {-kInfinity, ceiling};
      bool is_free = false;
      for (const AirSpan& span : air_spans_at(model_, x, y)) {
        if (span.floor >= ceiling - shape_.off() || span.ceiling < ceiling) continue;
        is_free = true;
        air.floor = span.floor;
      }
      if (!is_free) return {kInfinity, -kInfinity};
    }
    const double upper = air.ceiling - shape_.off();
    return {lower(x, y, air.floor, upper), upper};
  }

 private:
  double lower(double x, double y, double floor, double upper) const {
    const double ground = std::max(plate_, std::isfinite(floor) ? floor + shape_.off() : plate_);
    if (body_ == nullptr) return ground;
    const std::vector<AirSpan> spans = air_spans_at(*body_, x, y);
    for (std::size_t i = spans.size() - 1; i-- > 0;) {
      const double bottom = spans[i].ceiling, top = spans[i + 1].floor;
      if (bottom >= upper) continue;
      if (top <= ground) break;
      return std::max(std::min(top, upper) - shape_.embedded, 0.5 * (bottom + top));
    }
    return ground;
  }

  const kernels::WindingView& model_;
  const kernels::WindingView* body_;
  double plate_;
  const ToothShape& shape_;
};

class OnModel {
 public:
  OnModel(const kernels::WindingView& model, const kernels::WindingView& body, double plate,
          const ToothShape& shape)
      : model_(model), body_(body), plate_(plate), shape_(shape) {}

  Extent extent(double x, double y, double ceiling, double /*nearest*/) const {
    double floor = -kInfinity;
    for (const AirSpan& span : air_spans_at(model_, x, y))
      if (span.floor < ceiling) floor = std::max(floor, span.floor);
    const double ground = std::max(plate_, floor + shape_.off());
    // The body may go on below.
    double top = ground, lower = ground;
    const std::vector<AirSpan> spans = air_spans_at(body_, x, y);
    for (std::size_t i = 1; i < spans.size(); ++i) {
      const double bottom = spans[i - 1].ceiling, end = spans[i].floor;
      if (end <= top || end > ceiling - shape_.least_height) continue;
      top = end;
      lower = std::max({ground, end - shape_.embedded, 0.5 * (bottom + end)});
    }
    return {lower, ceiling + shape_.embedded};
  }

 private:
  const kernels::WindingView& model_;
  const kernels::WindingView& body_;
  double plate_;
  const ToothShape& shape_;
};

void add_quad(Mesh& mesh, std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d) {
  mesh.triangles.push_back({a, b, c});
  mesh.triangles.push_back({a, c, d});
}

// Vertices of a cut: left lower, left upper, right lower, right upper, seen along the ridge with z up.
void add_ridge(Mesh& mesh, const std::vector<std::array<Flank, 2>>& cuts) {
  const auto first = static_cast<std::uint32_t>(mesh.positions.size());
  for (const std::array<Flank, 2>& cut : cuts) {
    for (const Flank& flank : cut) {
      mesh.positions.push_back(to_float({flank.x, flank.y, flank.z.lower}));
      mesh.positions.push_back(to_float({flank.x, flank.y, flank.z.upper}));
    }
  }
  const auto count = static_cast<std::uint32_t>(cuts.size());
  for (std::uint32_t i = 0; i + 1 < count; ++i) {
    const std::uint32_t a = first + 4 * i, b = a + 4;
    add_quad(mesh, a, a + 1, b + 1, b);          // left
    add_quad(mesh, a + 2, b + 2, b + 3, a + 3);  // right
    add_quad(mesh, a + 3, b + 3, b + 1, a + 1);  // top
    add_quad(mesh, a, b, b + 2, a + 2);          // bottom
  }
  const std::uint32_t last = first + 4 * (count - 1);
  add_quad(mesh, first, first + 2, first + 3, first + 1);
  add_quad(mesh, last, last + 1, last + 3, last + 2);
}

void add_cone(Mesh& mesh, Vec3d tip, double tip_radius, Vec3d base, double base_radius) {
  const auto first = static_cast<std::uint32_t>(mesh.positions.size());
  for (const auto& [centre, radius] : {std::pair(base, base_radius), std::pair(tip, tip_radius)}) {
    for (std::uint32_t i = 0; i < kConeSides; ++i) {
      const double angle = 2 * std::numbers::pi * i / kConeSides;
      mesh.positions.push_back(
          to_float({centre.x + radius * std::cos(angle), centre.y + radius * std::sin(angle), centre.z}));
    }
  }
  for (std::uint32_t i = 0; i < kConeSides; ++i) {
    const std::uint32_t next = (i + 1) % kConeSides;
    add_quad(mesh, first + i, first + next, first + kConeSides + next, first + kConeSides + i);
  }
  for (std::uint32_t i = 1; i + 1 < kConeSides; ++i) {
    mesh.triangles.push_back({first, first + i + 1, first + i});
    mesh.triangles.push_back({first + kConeSides, first + kConeSides + i, first + kConeSides + i + 1});
  }
}

// Whether a surface keeps its distance from the model.
bool keeps_off(const Mesh& tooth, const SurfaceIndex& model, const ToothShape& shape) {
  const double least = shape.least_distance();
  if (least <= 0) return true;
  return std::ranges::all_of(tooth.triangles, [&](const Triangle& t) {
    return distance_to_surface(facet_of(tooth, t), model.bvh(), least) >= least;
  });
}

// A tooth is high enough to be printed.
bool is_high_enough(const Extent& z, double plate, const ToothShape& shape) {
  const bool is_on_plate = z.lower <= plate;
  return z.upper - z.lower >= (is_on_plate ? kLeastShareOnPlate : 1) * shape.least_height;
}

// A tooth that nothing joins to what it touches would fall over.
bool is_needle(double length, double height, const ToothShape& shape) {
  constexpr double kSlender = 6;
  return shape.gap > 0 && height > shape.most_alone && height > kSlender * length;
}

// Which way a ridge goes at each of its points, a unit vector, and how much wider its cuts are there than it is.
struct RidgeWay {
  double x = 1, y = 0;
  double wider = 1;
};

RidgeWay way_at(const RidgeRun& run, std::size_t i) {
  const auto between = [&](std::size_t from, std::size_t to) {
    const double x = run.points[to].x - run.points[from].x, y = run.points[to].y - run.points[from].y;
    const double length = std::hypot(x, y);
    return length > 0 ? RidgeWay{x / length, y / length} : RidgeWay{};
  };
  const std::size_t last = run.points.size() - 1;
  if (last == 0) return {};
  if (i == 0) return between(0, 1);
  if (i == last) return between(last - 1, last);
  RidgeWay way = between(i - 1, i + 1);
  const RidgeWay onward = between(i, i + 1);
  way.wider = 1 / std::max(0.7, way.x * onward.x + way.y * onward.y);
  return way;
}

// Where ridges have `z`-extents that are a tooth, flank by flank; pieces of a run, since room may end.
template <typename Heights>
void add_run(ToothSurfaces& teeth, const SurfaceIndex& model, const Undersides& columns, const RidgeRun& run,
             const Heights& heights, const ToothShape& shape, std::vector<bool>& is_made) {
  const double nearest = 2 * columns.spacing;
  const auto flanks = [&](std::size_t i, double along) -> std::optional<std::array<Flank, 2>> {
    const RidgeWay way = way_at(run, i);
    const RidgePoint& point = run.points[i];
    const double ceiling = columns.spans[point.span].ceiling;
    // Ridges that meet in a corner share no vertices.
    const double beyond = along * (std::abs(way.x) >= std::abs(way.y) ? 0.5 : 0.45) * shape.width;
    const double x = point.x + beyond * way.x, y = point.y + beyond * way.y;
    std::array<Flank, 2> cut;
    for (const std::size_t side : {std::size_t{0}, std::size_t{1}}) {
      const double aside = (side == 0 ? 0.5 : -0.5) * shape.width * way.wider;  // left first
      const double at_x = x - aside * way.y, at_y = y + aside * way.x;
      cut[side] = {at_x, at_y, heights.extent(at_x, at_y, ceiling, nearest)};
    }
    for (const Flank& flank : cut)
      if (!is_high_enough(flank.z, columns.plate, shape)) return std::nullopt;
    return cut;
  };
  const auto goes_on = [&](const std::array<Flank, 2>& from, const std::array<Flank, 2>& to) {
    Mesh piece;
    add_ridge(piece, {from, to});
    return keeps_off(piece, model, shape);
  };
  std::vector<std::array<Flank, 2>> cuts;
  std::vector<std::uint32_t> under;  // the spans that these are under
  const auto finish = [&](std::size_t end_at) {
    if (cuts.empty()) return;
    if (const auto end = flanks(end_at, 1); end && goes_on(cuts.back(), *end)) cuts.push_back(*end);
    double length = 0, height = 0;
    for (std::size_t i = 0; i < cuts.size(); ++i) {
      for (const Flank& flank : cuts[i]) height = std::max(height, flank.z.upper - flank.z.lower);
      if (i > 0) length += std::hypot(cuts[i][0].x - cuts[i - 1][0].x, cuts[i][0].y - cuts[i - 1][0].y);
    }
    if (cuts.size() > 1 && !is_needle(length, height, shape)) {
      add_ridge(teeth.mesh, cuts);
      for (std::size_t i = 1; i < cuts.size(); ++i)
        teeth.tip_area += shape.width *
                          std::hypot(cuts[i][0].x + cuts[i][1].x - cuts[i - 1][0].x - cuts[i - 1][1].x,
                                     cuts[i][0].y + cuts[i][1].y - cuts[i - 1][0].y - cuts[i - 1][1].y) /
                          2;
      ++teeth.count;
      for (const std::uint32_t span : under) is_made[span] = true;
    }
    cuts.clear();
    under.clear();
  };
  for (std::size_t i = 0; i < run.points.size(); ++i) {
    const auto cut = flanks(i, 0);
    if (!cut) {
      finish(i - 1);
      continue;
    }
    if (!cuts.empty() && !goes_on(cuts.back(), *cut)) finish(i - 1);
    if (cuts.empty()) {
      if (const auto begin = flanks(i, -1); begin && goes_on(*begin, *cut)) cuts.push_back(*begin);
    }
    cuts.push_back(*cut);
    under.push_back(run.points[i].span);
  }
  finish(run.points.size() - 1);
}

// A flat tip leaves the gap at its rim, too.
template <typename Heights>
void keep_below_rim(const Heights& heights, Vec3d at, double radius, double nearest, bool tip_is_above,
                    Extent& z) {
  for (std::uint32_t i = 0; i < kConeSides; ++i) {
    const double angle = 2 * std::numbers::pi * i / kConeSides;
    const Extent rim =
        heights.extent(at.x + radius * std::cos(angle), at.y + radius * std::sin(angle), at.z, nearest);
    if (!(rim.upper > rim.lower)) continue;
    if (tip_is_above)
      z.upper = std::min(z.upper, rim.upper);
    else
      z.lower = std::max(z.lower, rim.lower);
  }
}

// The lowest point of a ceiling near a column's middle, no farther than that from it; for a point that lies between columns.
template <typename Heights>
Vec3d lowest_near(const Heights& heights, Vec3d at, double spacing, double off) {
  Vec3d lowest = at;
  constexpr int kHalvings = 4;
  double step = spacing;
  for (int i = 0; i < kHalvings; ++i) {
    step /= 2;
    const Vec3d middle = lowest;
    for (int dx = -1; dx <= 1; ++dx) {
      for (int dy = -1; dy <= 1; ++dy) {
        const Vec3d place{middle.x + step * dx, middle.y + step * dy, middle.z};
        const Extent z = heights.extent(place.x, place.y, place.z, 2 * spacing);
        if (z.upper > z.lower && z.upper + off < lowest.z) lowest = {place.x, place.y, z.upper + off};
      }
    }
  }
  // Under the column itself, which is what begins in the air.
  return {std::clamp(lowest.x, at.x - spacing / 2, at.x + spacing / 2),
          std::clamp(lowest.y, at.y - spacing / 2, at.y + spacing / 2), lowest.z};
}

// How wide a cone may be: its base in tips, and its tip in those asked for.
struct ConeWidths {
  double widest_base = kWidestBase;
  double tip = 1;
};

// False if the model leaves it no room.
template <typename Heights>
bool add_cone_at(ToothSurfaces& teeth, const SurfaceIndex& model, const Undersides& columns,
                 std::uint32_t span, const Heights& heights, const ToothShape& shape, ConeWidths widths,
                 bool tip_is_above) {
  const bool is_tip = std::ranges::binary_search(columns.tips, span);
  const Vec3d at = is_tip && tip_is_above
                       ? lowest_near(heights, columns.place(span), columns.spacing, shape.off())
                       : columns.place(span);
  const double radius = widths.tip * shape.width / 2;
  Extent z = heights.extent(at.x, at.y, at.z, columns.spacing);
  const double foot = z.lower;
  if (shape.gap > 0) keep_below_rim(heights, at, radius, columns.spacing, tip_is_above, z);
  // A foot beside what it would stand on.
  if (shape.gap > 0 && !tip_is_above && z.lower - foot > kMostBeside * shape.gap) return false;
  if (!is_high_enough(z, columns.plate, shape)) return false;
  if (is_needle(2 * radius, z.upper - z.lower, shape)) return false;
  if (shape.gap > 0 && tip_is_above && at.z - z.upper > kMostGap * shape.gap) return false;
  const double base = std::min(radius + kConeSlope * (z.upper - z.lower), widths.widest_base * radius);
  const Vec3d upper{at.x, at.y, z.upper}, lower{at.x, at.y, z.lower};
  Mesh cone;
  add_cone(cone, upper, tip_is_above ? radius : base, lower, tip_is_above ? base : radius);
  if (!keeps_off(cone, model, shape)) return false;
  add_cone(teeth.mesh, upper, tip_is_above ? radius : base, lower, tip_is_above ? base : radius);
  teeth.tip_area += std::numbers::pi * radius * radius;
  ++teeth.count;
  return true;
}

// A cone under a span, as wide as there is room for.
template <typename Heights>
bool add_widest_cone(ToothSurfaces& teeth, const SurfaceIndex& model, const Undersides& columns,
                     std::uint32_t span, const Heights& heights, const ToothShape& shape, bool tip_is_above) {
  constexpr std::array<ConeWidths, 4> kWidths{
      {{kWidestBase, 1}, {1, 1}, {1, kNarrowTip}, {1, kNarrowTip * kNarrowTip}}};
  return std::ranges::any_of(kWidths, [&](ConeWidths widths) {
    return add_cone_at(teeth, model, columns, span, heights, shape, widths, tip_is_above);
  });
}

// Spans no more than so many columns from one, the nearest first, itself the first.
std::vector<std::uint32_t> spans_near(const Undersides& columns, std::uint32_t span, std::size_t rings) {
  std::vector<std::uint32_t> near{span};
  std::size_t first = 0;
  for (std::size_t ring = 0; ring < rings; ++ring) {
    const std::size_t end = near.size();
    for (std::size_t i = first; i < end; ++i) {
      for (const auto& [dx, dy] : {std::pair(1, 0), std::pair(0, 1), std::pair(-1, 0), std::pair(0, -1)}) {
        const std::uint32_t other = columns.next(near[i], dx, dy);
        if (other != kNoSpan && std::ranges::find(near, other) == near.end()) near.push_back(other);
      }
    }
    first = end;
  }
  return near;
}

// Cones where those that were planned have no room, beside these places.
template <typename Heights>
void add_beside(ToothSurfaces& teeth, const SurfaceIndex& model, const Undersides& columns,
                const Heights& heights, const ToothShape& shape, double reach, bool tip_is_above,
                const std::vector<bool>& is_made) {
  constexpr std::size_t kRings = 3;
  std::vector<Holder> made;
  for (std::uint32_t i = 0; i < columns.spans.size(); ++i)
    if (is_made[i]) made.push_back(holder_in(columns, i));
  std::vector<double> distances = distances_from_hold(columns, made);
  std::vector<std::uint32_t> left;
  for (std::uint32_t i = 0; i < columns.spans.size(); ++i)
    if (columns.hold[i] == Hold::bridge && distances[i] > reach) left.push_back(i);
  // The farthest first, and of those that nothing holds the lowest.
  std::ranges::stable_sort(left, [&](std::uint32_t a, std::uint32_t b) {
    return distances[a] != distances[b] ? distances[a] > distances[b]
                                        : columns.spans[a].ceiling < columns.spans[b].ceiling;
  });
  for (const std::uint32_t span : left) {
    if (distances[span] <= reach) continue;
    for (const std::uint32_t other : spans_near(columns, span, kRings)) {
      if (!add_widest_cone(teeth, model, columns, other, heights, shape, tip_is_above)) continue;
      hold_also(columns, {holder_in(columns, other)}, distances);
      break;
    }
    if (distances[span] > reach) teeth.left.push_back(span);
  }
}

template <typename Heights>
ToothSurfaces teeth_of(const SurfaceIndex& model, const Undersides& columns, const TeethPlan& plan,
                       const Heights& heights, const ToothShape& shape, bool tip_is_above) {
  ToothSurfaces teeth;
  // Where a ridge cannot be, as under a point, a cone may.
  std::vector<bool> is_made(columns.spans.size(), false);
  for (const RidgeRun& run : plan.runs) add_run(teeth, model, columns, run, heights, shape, is_made);
  for (const std::uint32_t span : plan.held) {
    if (!is_made[span])
      is_made[span] = add_widest_cone(teeth, model, columns, span, heights, shape, tip_is_above);
  }
  add_beside(teeth, model, columns, heights, shape, plan.reach, tip_is_above, is_made);
  return teeth;
}

}  // namespace

ToothSurfaces teeth_below(const SurfaceIndex& model, const kernels::WindingView* body,
                          const Undersides& columns, const TeethPlan& plan, const ToothShape& shape) {
  return teeth_of(model, columns, plan, BelowModel(model.winding(), body, columns.plate, shape), shape, true);
}

ToothSurfaces teeth_on_model(const SurfaceIndex& model, const kernels::WindingView& body,
                             const Undersides& columns, const TeethPlan& plan, const ToothShape& shape) {
  return teeth_of(model, columns, plan, OnModel(model.winding(), body, columns.plate, shape), shape, false);
}

}  // namespace aerate
