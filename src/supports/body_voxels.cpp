#include "supports/body_voxels.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <map>
#include <numbers>
#include <optional>
#include <set>
#include <tbb/parallel_for.h>
#include <tuple>
#include <utility>

#include "core/disjoint_sets.h"
#include "printing/footing.h"
#include "supports/pixels.h"

namespace aerate {
namespace {

// A body this many times as high as it is wide is drawn in no further, and gets a wider foot.
constexpr double kSlender = 6;
// Over so many layers from the plate a foot widens.
constexpr int kFootLayers = 8;

using Voxels = std::vector<std::array<int, 3>>;

std::size_t column_of(const Undersides& columns, const std::array<int, 3>& voxel) {
  return columns.column(static_cast<std::uint32_t>(voxel[0]), static_cast<std::uint32_t>(voxel[1]));
}

float squared(double pixels) {
  return static_cast<float>(pixels * pixels);
}

// Takes away what is nearer to the model than the clearance.
void keep_clear_of_model(Pixels& body, const Undersides& columns, double z, double clearance) {
  const std::vector<std::pair<int, int>> disc = disc_of(clearance / columns.spacing);
  // What is as near above or below, but for what the level set cuts.
  const double level = clearance - columns.spacing;
  const auto count_x = static_cast<int>(columns.count_x), count_y = static_cast<int>(columns.count_y);
  body.for_each_row([&](std::uint32_t y) {
    for (std::uint32_t x = 0; x < columns.count_x; ++x) {
      const std::size_t here = columns.column(x, y);
      if (body[here] == 0) continue;
      const bool is_taken = std::ranges::any_of(disc, [&](std::pair<int, int> step) {
        const int at_x = static_cast<int>(x) + step.first, at_y = static_cast<int>(y) + step.second;
        return at_x >= 0 && at_y >= 0 && at_x < count_x && at_y < count_y &&
               columns.is_solid(
                   columns.column(static_cast<std::uint32_t>(at_x), static_cast<std::uint32_t>(at_y)), z);
      });
      if (is_taken || (level > 0 && (columns.is_solid(here, z - level) || columns.is_solid(here, z + level))))
        body[here] = 0;
    }
  });
}

// How thick bodies stay, in steps, so that there are few thicknesses to look for.
class Thickness {
 public:
  // foot: half of it at step 0, in pixels
  explicit Thickness(double foot) : foot_(foot) {}

  double half(int step) const { return foot_ * std::pow(kRatio, step); }
  int nearest_step(double half) const {
    return static_cast<int>(std::lround(std::log(half / foot_) / std::log(kRatio)));
  }

  static constexpr int kMore = 2;  // steps to half as much again

 private:
  static constexpr double kRatio = 1.25;
  double foot_;
};

// What of a layer is at least so many pixels thick, with its corners; `inside`: squared distances to what is no part of it.
Pixels thick_part(const Pixels& layer, const Pixels& empty, double half, const std::vector<float>& inside) {
  Pixels core = empty;
  bool is_any = false;
  for (std::size_t i = 0; i < core.size(); ++i) {
    core[i] = inside[i] > squared(half) ? 1 : 0;
    is_any = is_any || core[i] != 0;
  }
  if (!is_any) return core;
  // A square's corner is sqrt(2) from where its disc is, and one that does not lie along the pixels as much as one of these further.
  const double corner = std::numbers::sqrt2 * half + 1.25;
  const std::vector<float> near = core.squared_distances(true, static_cast<int>(corner) + 1);
  for (std::size_t i = 0; i < core.size(); ++i) core[i] = layer[i] != 0 && near[i] <= squared(corner) ? 1 : 0;
  return core;
}

// What of a layer is at least so thick, for each pixel as many steps as its own.
Pixels thick_parts(const Pixels& layer, const Pixels& empty, const Thickness& thickness,
                   const std::vector<int>& steps, double more, const std::vector<float>& inside) {
  Pixels thick = empty;
  std::set<int> different;
  for (std::size_t i = 0; i < layer.size(); ++i)
    if (layer[i] != 0) different.insert(steps[i]);
  for (const int step : different) {
    const Pixels as_thick = thick_part(layer, empty, thickness.half(step) + more, inside);
    for (std::size_t i = 0; i < layer.size(); ++i)
      if (layer[i] != 0 && steps[i] == step) thick[i] = as_thick[i];
  }
  return thick;
}

// Bodies from their tops down to the plate, layer by layer.
class GrowingBody {
 public:
  // wider: by column, steps by which a body is to be thicker than its foot at least
  GrowingBody(const Undersides& columns, const BodyShape& shape, const std::vector<int>& wider)
      : columns_(columns),
        wider_(wider),
        thickness_(shape.foot / columns.spacing),
        // So that what bears a single tooth is no thinner than voxels show.
        margin_(disc_of(std::max(shape.margin / columns.spacing, std::numbers::sqrt2 + 0.01))),
        clearance_(shape.clearance),
        empty_(columns.count_x, columns.count_y),
        body_(empty_),
        top_(body_.size(), 0),
        steps_(body_.size(), 0) {}

  const Pixels& layer() const { return body_; }

  // Down to the next layer, in which bodies begin below these columns.
  void go_down(std::size_t layer, const std::vector<std::size_t>& begin_in) {
    int most = 0;
    bool is_any = false;
    const std::vector<float> tops = tops_of_bodies();
    for (std::size_t i = 0; i < body_.size(); ++i) {
      if (body_[i] == 0) continue;
      is_any = true;
      const double half = (static_cast<double>(tops[i]) - static_cast<double>(layer)) / (2 * kSlender);
      const int step = thickness_.nearest_step(std::max(half, 0.5));
      steps_[i] = layer < kFootLayers ? step : std::max(step, wider_[i]);
      most = std::max(most, steps_[i]);
    }
    if (is_any) {
      const std::vector<float> inside =
          body_.squared_distances(false, static_cast<int>(thickness_.half(most)) + 2);
      if (layer < kFootLayers)
        widen(inside);
      else
        draw_in(inside, layer % 3 == 0);
    }
    for (const std::size_t column : begin_in) begin_below(column, layer);
    keep_clear_of_model(body_, columns_,
                        columns_.plate + (static_cast<double>(layer) + 0.5) * columns_.spacing, clearance_);
  }

 private:
  // Of each pixel's body, as far as it hangs together in this layer: the highest layer in which a column of it begins.
  std::vector<float> tops_of_bodies() const {
    DisjointSets sets(body_.size());
    for (std::size_t i = columns_.count_x; i < body_.size(); ++i) {
      if (body_[i] == 0) continue;
      for (const std::size_t other : {i - 1, i - columns_.count_x})
        if (body_[other] != 0) sets.join(static_cast<std::uint32_t>(i), static_cast<std::uint32_t>(other));
    }
    std::vector<float> tops(body_.size(), 0);
    for (std::size_t i = body_.size(); i-- > 0;) {
      if (body_[i] == 0) continue;
      float& top = tops[sets.root(static_cast<std::uint32_t>(i))];
      top = std::max(top, top_[i]);
    }
    for (std::size_t i = 0; i < body_.size(); ++i)
      if (body_[i] != 0) tops[i] = tops[sets.root(static_cast<std::uint32_t>(i))];
    return tops;
  }

  void begin_below(std::size_t column, std::size_t layer) {
    const auto x = static_cast<int>(column % columns_.count_x),
               y = static_cast<int>(column / columns_.count_x);
    for (const auto& [dx, dy] : margin_) {
      const std::size_t i =
          columns_.column(static_cast<std::uint32_t>(x + dx), static_cast<std::uint32_t>(y + dy));
      if (body_[i] == 0) top_[i] = static_cast<float>(layer);
      body_[i] = 1;
    }
  }

  // By a pixel, where it is thicker than it has to be. Of three layers one is drawn in at its corners as well, so that slopes are about
  // the same all round.
  void draw_in(const std::vector<float>& inside, bool at_corners) {
    const Pixels thick = thick_parts(body_, empty_, thickness_, steps_, 1, inside);
    for (std::size_t i = 0; i < body_.size(); ++i)
      if (thick[i] != 0 && inside[i] <= (at_corners ? 2.0F : 1.0F)) body_[i] = 0;
  }

  // Two columns of air stay on each side of the grid.
  bool is_at_side(std::size_t column) const {
    const std::size_t x = column % columns_.count_x, y = column / columns_.count_x;
    return x < 3 || y < 3 || x + 3 >= columns_.count_x || y + 3 >= columns_.count_y;
  }

  // By a pixel, where it is thinner.
  void widen(const std::vector<float>& inside) {
    const Pixels thick = thick_parts(body_, empty_, thickness_, steps_, 0, inside);
    const Pixels before = body_;
    for (std::size_t i = 0; i < before.size(); ++i) {
      if (before[i] == 0 || thick[i] != 0 || is_at_side(i)) continue;
      for (int dy = -1; dy <= 1; ++dy) {
        for (int dx = -1; dx <= 1; ++dx) {
          const std::size_t other = static_cast<std::size_t>(
              static_cast<std::ptrdiff_t>(i) + dy * static_cast<std::ptrdiff_t>(columns_.count_x) + dx);
          top_[other] = body_[other] != 0 ? std::max(top_[other], top_[i]) : top_[i];
          body_[other] = 1;
        }
      }
    }
  }

  const Undersides& columns_;
  const std::vector<int>& wider_;
  Thickness thickness_;
  std::vector<std::pair<int, int>> margin_;
  double clearance_;
  Pixels empty_, body_;
  std::vector<float> top_;  // layer in which the body of a column begins
  std::vector<int> steps_;  // how thick it stays
};

// Pixels that hang beside a model: nothing of the layer below is near them, nor is the plate, or the model where a foot could stand. Those that
// others of their layer hold within `reach` pixels stay.
class HangingParts {
 public:
  HangingParts(const Undersides& columns, double clearance, double reach)
      : columns_(columns),
        clearance_(clearance),
        reach_(static_cast<int>(reach)),
        empty_(columns.count_x, columns.count_y),
        below_(empty_) {}

  // Of the layers from the plate up: takes away what hangs.
  void take_from(Pixels& layer, std::size_t number) {
    const double z = columns_.plate + (static_cast<double>(number) + 0.5) * columns_.spacing;
    const std::vector<float> near = below_.squared_distances(true, 1);
    Pixels held = empty_;
    for (std::size_t i = 0; i < layer.size(); ++i)
      if (layer[i] != 0 && (number == 0 || near[i] <= 2 || stands_on_model(columns_, i, z, clearance_)))
        held[i] = 1;
    Pixels kept = held;
    for (int step = 0; step < reach_; ++step) {
      const std::vector<float> beside = kept.squared_distances(true, 1);
      bool is_any = false;
      for (std::size_t i = 0; i < layer.size(); ++i) {
        if (layer[i] == 0 || kept[i] != 0 || beside[i] > 1) continue;
        kept[i] = 1;
        is_any = true;
      }
      if (!is_any) break;
    }
    layer = kept;
    below_ = kept;
  }

 private:
  const Undersides& columns_;
  double clearance_;
  int reach_;
  Pixels empty_, below_;
};

// Takes away what is about features that pass between columns, where a voxel is as good as on the surface.
void keep_clear_of_surface(std::vector<std::array<int, 3>>& voxels, const Undersides& columns,
                           const SurfaceIndex& model, double clearance) {
  const double on_surface = 0.6 * columns.spacing;
  std::vector<std::uint8_t> is_on(voxels.size(), 0);
  tbb::parallel_for(std::size_t{0}, voxels.size(), [&](std::size_t i) {
    const auto& [x, y, layer] = voxels[i];
    const Vec3d at{columns.origin_x + columns.spacing * x, columns.origin_y + columns.spacing * y,
                   columns.plate + (layer + 0.5) * columns.spacing};
    const double limit = on_surface * on_surface;
    is_on[i] = model.bvh().nearest(at, limit).distance_squared < limit ? 1 : 0;
  });
  const std::vector<std::pair<int, int>> disc = disc_of(clearance / columns.spacing);
  std::set<std::array<int, 3>> taken;
  for (std::size_t i = 0; i < voxels.size(); ++i) {
    if (is_on[i] == 0) continue;
    for (const auto& [dx, dy] : disc) taken.insert({voxels[i][0] + dx, voxels[i][1] + dy, voxels[i][2]});
  }
  if (!taken.empty())
    std::erase_if(voxels, [&](const std::array<int, 3>& voxel) { return taken.contains(voxel); });
}

Voxels without_hanging(const Voxels& voxels, const Undersides& columns, const BodyShape& shape,
                       double reach) {
  HangingParts parts(columns, shape.clearance, reach / columns.spacing);
  const Pixels empty(columns.count_x, columns.count_y);
  Voxels kept;
  kept.reserve(voxels.size());
  int next = 0;
  // From the lowest layer up; voxels come from the highest down.
  for (std::size_t end = voxels.size(); end > 0;) {
    const int layer = voxels[end - 1][2];
    std::size_t begin = end;
    while (begin > 0 && voxels[begin - 1][2] == layer) --begin;
    Pixels pixels = empty;
    for (; next < layer; ++next) parts.take_from(pixels, static_cast<std::size_t>(next));
    for (std::size_t i = begin; i < end; ++i) pixels[column_of(columns, voxels[i])] = 1;
    parts.take_from(pixels, static_cast<std::size_t>(layer));
    next = layer + 1;
    for (std::size_t i = begin; i < end; ++i)
      if (pixels[column_of(columns, voxels[i])] != 0) kept.push_back(voxels[i]);
    end = begin;
  }
  return kept;
}

// Whether a tooth has room below a body that is so near above the model: not on slopes that it would stand beside.
bool has_footing(const Undersides& columns, std::size_t column, double z, double clearance) {
  constexpr double kSteep = 1.6;  // as kMostBeside of teeth
  if (!stands_on_model(columns, column, z, clearance)) return false;
  const double lowest = columns.height_above_model(column, z) + kSteep * columns.spacing;
  return std::ranges::none_of(
      std::array{column - 1, column + 1, column - columns.count_x, column + columns.count_x},
      [&](std::size_t other) {
        return !columns.is_solid(other, z) && columns.height_above_model(other, z) > lowest;
      });
}

// Voxels that hang together, of layers from the lowest up or from the highest down.
DisjointSets bodies_of(const Voxels& voxels, const Undersides& columns) {
  constexpr std::uint32_t kNone = 0xffffffff;
  // What is a single voxel wide is lost when voxels are smoothed.
  const auto is_wide = [&](const std::vector<std::uint32_t>& layer, std::size_t column) {
    return std::ranges::any_of(
        std::array{column, column - 1, column - columns.count_x, column - columns.count_x - 1},
        [&](std::size_t corner) {
          return layer[corner] != kNone && layer[corner + 1] != kNone &&
                 layer[corner + columns.count_x] != kNone && layer[corner + columns.count_x + 1] != kNone;
        });
  };
  DisjointSets sets(voxels.size());
  std::vector<std::uint32_t> last(static_cast<std::size_t>(columns.count_x) * columns.count_y, kNone),
      here = last;
  for (std::size_t begin = 0, end = 0, before = 0; begin < voxels.size(); before = begin, begin = end) {
    for (end = begin; end < voxels.size() && voxels[end][2] == voxels[begin][2]; ++end) {
      const std::size_t column = column_of(columns, voxels[end]);
      here[column] = static_cast<std::uint32_t>(end);
      // Neighbours that came before it, all around since there is air at the grid's sides.
      for (const std::size_t other :
           {column - 1, column - columns.count_x - 1, column - columns.count_x, column - columns.count_x + 1})
        if (here[other] != kNone) sets.join(static_cast<std::uint32_t>(end), here[other]);
    }
    const bool is_next = begin > 0 && std::abs(voxels[before][2] - voxels[begin][2]) == 1;
    for (std::size_t i = begin; i < end && is_next; ++i) {
      const std::size_t column = column_of(columns, voxels[i]);
      if (last[column] != kNone && is_wide(here, column) && is_wide(last, column))
        sets.join(static_cast<std::uint32_t>(i), last[column]);
    }
    for (std::size_t i = before; i < begin; ++i) last[column_of(columns, voxels[i])] = kNone;
    std::swap(last, here);
  }
  return sets;
}

bool is_crumb(double voxel_count, const Undersides& columns) {
  return voxel_count * std::pow(columns.spacing, 3) <= kCrumb;
}

// Columns of the voxels of some bodies.
std::vector<std::size_t> columns_of_bodies(const Voxels& voxels, const Undersides& columns,
                                           DisjointSets& sets, const std::set<std::uint32_t>& bodies) {
  std::vector<std::size_t> found;
  for (std::size_t i = 0; i < voxels.size(); ++i)
    if (bodies.contains(sets.root(static_cast<std::uint32_t>(i))))
      found.push_back(column_of(columns, voxels[i]));
  return found;
}

// Columns of bodies of which nothing is kept.
//   voxels: from the highest layer down; kept: some of them, from the lowest up
std::vector<std::size_t> lost_columns(const Voxels& voxels, const Voxels& kept, const Undersides& columns) {
  const auto is_lower = [](const std::array<int, 3>& a, const std::array<int, 3>& b) {
    return std::tie(a[2], a[1], a[0]) < std::tie(b[2], b[1], b[0]);
  };
  if (kept.size() == voxels.size()) return {};
  DisjointSets sets = bodies_of(voxels, columns);
  struct Count {
    std::size_t all = 0, kept = 0;
  };
  std::map<std::uint32_t, Count> counts;
  for (std::size_t i = 0; i < voxels.size(); ++i) {
    Count& count = counts[sets.root(static_cast<std::uint32_t>(i))];
    ++count.all;
    if (std::ranges::binary_search(kept, voxels[i], is_lower)) ++count.kept;
  }
  std::set<std::uint32_t> lost;
  for (const auto& [root, count] : counts)
    if (count.kept == 0 && !is_crumb(static_cast<double>(count.all), columns)) lost.insert(root);
  return columns_of_bodies(voxels, columns, sets, lost);
}

// Columns of bodies that do not stand: they have no feet, or stand on the plate with their centre of mass not above their feet there and on
// the model. None if all stand.
std::vector<std::size_t> tipping_columns(const Voxels& voxels, const Undersides& columns, double clearance) {
  constexpr double kLeastMargin = 0.5;  // pixels, since voxels are smoothed
  DisjointSets sets = bodies_of(voxels, columns);
  struct Body {
    double x = 0, y = 0, count = 0;  // sums
    bool is_on_plate = false, has_footing = false;
    std::vector<Footprint::Point> feet;
  };
  std::map<std::uint32_t, Body> bodies;
  for (std::size_t i = 0; i < voxels.size(); ++i) {
    const auto x = static_cast<double>(voxels[i][0]), y = static_cast<double>(voxels[i][1]);
    Body& body = bodies[sets.root(static_cast<std::uint32_t>(i))];
    body.x += x;
    body.y += y;
    body.count += 1;
    const bool is_on_plate = voxels[i][2] == 0;
    body.is_on_plate = body.is_on_plate || is_on_plate;
    const double z = columns.plate + (voxels[i][2] + 0.5) * columns.spacing;
    body.has_footing =
        body.has_footing || is_on_plate || has_footing(columns, column_of(columns, voxels[i]), z, clearance);
    if (!is_on_plate && !stands_on_model(columns, column_of(columns, voxels[i]), z, clearance)) continue;
    for (const auto& [dx, dy] :
         {std::pair(-0.5, -0.5), std::pair(0.5, -0.5), std::pair(-0.5, 0.5), std::pair(0.5, 0.5)})
      body.feet.push_back({x + dx, y + dy});
  }
  std::set<std::uint32_t> tipping;
  for (auto& [root, body] : bodies) {
    if (is_crumb(body.count, columns)) continue;
    if (!body.has_footing) tipping.insert(root);
    if (!body.is_on_plate) continue;
    const std::optional<Footprint> foot = footprint_around(std::move(body.feet));
    if (foot && foot->margin(body.x / body.count, body.y / body.count) < kLeastMargin) tipping.insert(root);
  }
  return columns_of_bodies(voxels, columns, sets, tipping);
}

// From the highest layer down, within a layer by columns.
Voxels grown_body(const Undersides& columns, const std::vector<std::vector<std::size_t>>& begins,
                  const BodyShape& shape, const std::vector<int>& wider, Monitor& monitor) {
  GrowingBody body(columns, shape, wider);
  Voxels voxels;
  for (std::size_t layer = begins.size(); layer-- > 0;) {
    monitor.check_interrupted();
    body.go_down(layer, begins[layer]);
    for (std::size_t i = 0; i < body.layer().size(); ++i)
      if (body.layer()[i] != 0)
        voxels.push_back({static_cast<int>(i % columns.count_x), static_cast<int>(i / columns.count_x),
                          static_cast<int>(layer)});
  }
  return voxels;
}

// By the layer in which their bodies begin: columns of what is carried.
std::vector<std::vector<std::size_t>> begins_of(const Undersides& columns,
                                                const std::vector<CarriedPlace>& carried,
                                                const BodyShape& shape) {
  // What is lower than two voxels is left to teeth.
  const double size = columns.spacing;
  std::vector<std::vector<std::size_t>> begins;
  for (const CarriedPlace& place : carried) {
    const double top = place.ceiling - shape.tooth_height;
    const double floor = std::max(place.floor + shape.clearance, columns.plate);
    if (top - floor < 2 * size) continue;
    const auto layer = static_cast<std::size_t>((top - columns.plate) / size - 0.5);
    if (layer >= begins.size()) begins.resize(layer + 1);
    begins[layer].push_back(
        columns.column(static_cast<std::uint32_t>(std::lround((place.x - columns.origin_x) / size)),
                       static_cast<std::uint32_t>(std::lround((place.y - columns.origin_y) / size))));
  }
  return begins;
}

}  // namespace

bool stands_on_model(const Undersides& columns, std::size_t column, double z, double clearance) {
  constexpr double kHighest = 1.6;  // clearances, as above a slope of 50 degrees
  return columns.height_above_model(column, z) < kHighest * clearance + columns.spacing;
}

std::vector<std::array<int, 3>> body_voxels(const Undersides& columns, const SurfaceIndex& model,
                                            const std::vector<CarriedPlace>& carried, const BodyShape& shape,
                                            double reach, Monitor& monitor) {
  constexpr int kTries = 9;  // by which it goes straight down
  const std::vector<std::vector<std::size_t>> begins = begins_of(columns, carried, shape);
  std::vector<int> wider(static_cast<std::size_t>(columns.count_x) * columns.count_y, 0);
  for (int tries = 1;; ++tries) {
    Voxels voxels = grown_body(columns, begins, shape, wider, monitor);
    keep_clear_of_surface(voxels, columns, model, shape.clearance);
    Voxels kept = without_hanging(voxels, columns, shape, reach);
    if (!shape.stands_alone || tries == kTries) return kept;
    std::vector<std::size_t> failing = tipping_columns(kept, columns, shape.clearance);
    // What ends above slopes on which it cannot stand.
    const std::vector<std::size_t> lost = lost_columns(voxels, kept, columns);
    failing.insert(failing.end(), lost.begin(), lost.end());
    if (failing.empty()) return kept;
    for (const std::size_t column : failing) wider[column] = tries * Thickness::kMore;
  }
}

}  // namespace aerate
