#include "printing/filament_use.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <numbers>
#include <tbb/parallel_for.h>
#include <utility>
#include <vector>

#include "printing/full_infill.h"
#include "printing/layer_slices.h"
#include "printing/shell_rules.h"

namespace aerate {
namespace {

// The raster is turned by this angle, so that no straight wall runs along a row of pixels.
constexpr double kTurn = 0.13;
// No more pixels than this in all layers of a raster together.
constexpr double kMostPixels = 1.2e7;
// Depths are told apart in so many steps.
constexpr int kSteps = 250;
// An edge passes a pixel's centre on its inner side at no more than this many pixels, and on average at half
// of that.
constexpr double kNearest = 0.7;

// Distances from the border of a modifier are told apart in so many steps a millimetre, up to 1.27 mm.
constexpr double kBorderSteps = 100;
constexpr int kFarFromBorder = 127;

constexpr double kPi = std::numbers::pi;

// One value for each pixel of a layer.
using Pixels = std::vector<std::uint8_t>;

// Most pixels are far from all contours, outside or in: so many beside each other are passed by at once.
constexpr std::size_t kAtOnce = sizeof(std::uint64_t);

bool are_all(const std::uint8_t* pixels, std::uint8_t value) {
  std::uint64_t bytes = 0;
  std::memcpy(&bytes, pixels, kAtOnce);
  return bytes == 0x0101010101010101U * value;
}

// The layers' pixels: 0 outside; else 1 and up, the depth of the centre under the contour in steps. The
// rules' lengths in these steps.
struct Layers {
  std::vector<Pixels> depths;
  std::vector<double> contour_lengths;  // mm
  std::vector<double> rims;  // pixels that are to be added, since pixels on the contour are in or out
  // By how far a pixel is inside a modifier; empty where there are none.
  std::vector<std::vector<std::int8_t>> modifiers;
  std::array<int, kFarFromBorder + 1> border_steps{};  // a distance from the border in steps of depths
  bool prints_in_modifiers = false;
  LayerRaster raster;
  ShellRules rules;
  double reach = 1;  // mm, of what is known of depths
  double step = 1;   // mm
  int wall = 1, fill = 1, widened_walls = 0, lean = 0, shadow = 0, least_shell = 0, widening = 0,
      half_line = 0, skin_margin = 0, skin_shadow = 0;
  int near = 0;  // of an edge that may pass between this pixel and the next

  int steps(double length) const { return static_cast<int>(std::lround(length / step)); }
  bool is_fill(std::uint8_t depth) const { return depth >= fill; }
  bool is_wall(std::uint8_t depth) const { return depth != 0 && depth < wall; }
  // In steps of the border; negative outside.
  int in_modifier(std::size_t k, std::size_t i) const {
    return modifiers.empty() ? -kFarFromBorder : modifiers[k][i];
  }
  bool is_modified(std::size_t k, std::size_t i) const { return in_modifier(k, i) >= 0; }
  std::ptrdiff_t count() const { return std::ssize(depths); }
};

Mesh turned(const Mesh& mesh) {
  Mesh result = mesh;
  const double c = std::cos(kTurn), s = std::sin(kTurn);
  for (Vec3f& p : result.positions) {
    const Vec3d old = to_double(p);
    p = to_float({c * old.x - s * old.y, s * old.x + c * old.y, old.z});
  }
  return result;
}

// Whether `holds` (index, distance in pixels) for one of the eight pixels round this one, `away` rows or
// columns from it.
template <typename Holds>
bool any_around(std::size_t row, std::size_t column, std::size_t away, const LayerRaster& raster,
                const Holds& holds) {
  const auto rows = static_cast<std::ptrdiff_t>(raster.count_y);
  const auto columns = static_cast<std::ptrdiff_t>(raster.count_x);
  for (int dy = -1; dy <= 1; ++dy) {
    for (int dx = -1; dx <= 1; ++dx) {
      if (dx == 0 && dy == 0) continue;
      const std::ptrdiff_t y = static_cast<std::ptrdiff_t>(row) + dy * static_cast<std::ptrdiff_t>(away);
      const std::ptrdiff_t x = static_cast<std::ptrdiff_t>(column) + dx * static_cast<std::ptrdiff_t>(away);
      if (y < 0 || x < 0 || y >= rows || x >= columns) continue;
      const double distance = static_cast<double>(away) * (dx != 0 && dy != 0 ? std::numbers::sqrt2 : 1.0);
      if (holds(static_cast<std::size_t>(y * columns + x), distance)) return true;
    }
  }
  return false;
}

// How depths change round a pixel, from those of its neighbours nearer to the contour: in the middle between two contours they
// rise on either side.
struct DepthSlope {
  double x = 0, y = 0;  // a unit vector that points away from the contour, or 0
};

DepthSlope slope_at(const Pixels& depths, std::size_t i, const LayerRaster& raster) {
  const auto along = [&](std::size_t step) -> double {
    const int before = depths[i - step], here = depths[i], after = depths[i + step];
    const bool rises = before < after;
    const int lower = std::min(before, after);
    // Outside there are no depths: then that of the other side.
    const int rise = lower > 0 ? here - lower : std::max(before, after) - here;
    return rises ? rise : -rise;
  };
  const double x = along(1), y = along(raster.count_x), length = std::sqrt(x * x + y * y);
  return length > 0 ? DepthSlope{x / length, y / length} : DepthSlope{};
}

// Depths between the centres of pixels: each of the four around says how far it is to the contour that it is nearest to.
struct SampledDepth {
  double depth = 0;  // steps
  DepthSlope slope;  // of the one that is nearest
};

// `x`, `y`: in pixels, from the centre of the first.
SampledDepth depth_at(const Pixels& depths, double x, double y, const Layers& layers) {
  const LayerRaster& raster = layers.raster;
  const double steps_per_pixel = raster.pixel / layers.step;
  SampledDepth result{1.0 + kSteps, {}};
  const double column = std::floor(x), row = std::floor(y);
  for (const double r : {row, row + 1}) {
    for (const double c : {column, column + 1}) {
      if (c < 1 || r < 1 || c + 2 > static_cast<double>(raster.count_x) ||
          r + 2 > static_cast<double>(raster.count_y))
        return {};
      const std::size_t i = static_cast<std::size_t>(r) * raster.count_x + static_cast<std::size_t>(c);
      if (depths[i] == 0) return {};
      if (depths[i] > kSteps) continue;  // further than is known
      const DepthSlope slope = slope_at(depths, i, raster);
      const double depth = depths[i] + steps_per_pixel * (slope.x * (x - c) + slope.y * (y - r));
      if (depth < result.depth) result = {depth, slope};
    }
  }
  return result;
}

// Where infill would be too narrow, depths are those of walls: where straight inwards, and inwards of what is nearer there
// (in a corner), the middle of the least infill is not as far from all contours as it has to be.
Pixels with_widened_walls(const Pixels& depths, const Layers& layers) {
  constexpr double kNear = 4;  // steps that a depth may lack
  Pixels result = depths;
  const LayerRaster& raster = layers.raster;
  const double middle = layers.wall + layers.widened_walls / 2.0,
               steps_per_pixel = raster.pixel / layers.step;
  const auto leads_to_the_middle = [&](std::size_t row, std::size_t column) {
    double x = static_cast<double>(column), y = static_cast<double>(row);
    SampledDepth here{static_cast<double>(depths[row * raster.count_x + column]),
                      slope_at(depths, row * raster.count_x + column, raster)};
    for (int turn = 0; turn < 2; ++turn) {
      const double way = (middle - here.depth) / steps_per_pixel;
      x += way * here.slope.x;
      y += way * here.slope.y;
      here = depth_at(depths, x, y, layers);
      if (here.depth >= middle - kNear) return true;
      if (here.depth <= 0) return false;
    }
    return false;
  };
  for (std::size_t row = 1; row + 1 < raster.count_y; ++row) {
    for (std::size_t column = 1; column + 1 < raster.count_x; ++column) {
      const std::size_t at = row * raster.count_x + column;
      if (depths[at] < layers.fill || depths[at] >= middle) continue;
      if (!leads_to_the_middle(row, column)) result[at] = static_cast<std::uint8_t>(layers.fill - 1);
    }
  }
  return result;
}

// What of a pixel is beyond a line, less 1 if its centre is. `beyond` pixels: how far that is.
double rest_of_pixel(double beyond) {
  if (std::abs(beyond) >= 0.5) return 0;
  return beyond + (beyond >= 0 ? -0.5 : 0.5);
}

// The area within the contour less the pixels whose centre is, in pixels. Where parts overlap there is no border.
double rim_of(const LayerSlice& slice, const LayerRaster& raster) {
  double rim = 0;
  const auto half = static_cast<float>(raster.pixel / 2);
  const std::size_t columns = raster.count_x;
  for (std::size_t i = columns; i + columns < slice.inside.size(); ++i) {
    if (slice.depth[i] >= half) continue;
    const std::uint8_t here = slice.inside[i];
    const bool is_border = slice.inside[i - 1] != here || slice.inside[i + 1] != here ||
                           slice.inside[i - columns] != here || slice.inside[i + columns] != here;
    if (!is_border) continue;
    const double within = static_cast<double>(slice.depth[i]) / raster.pixel;
    rim += here != 0 ? within - 0.5 : 0.5 - within;
  }
  return rim;
}

// Without what the model has in them.
Layers empty_layers(const LayerRaster& raster, const PrintSettings& settings) {
  Layers layers;
  layers.raster = raster;
  const ShellRules& rules = layers.rules = shell_rules(settings);
  // As deep as has to be known: a shell's width, where the sparse infill that it reaches into begins.
  layers.reach = rules.wall + rules.least_shell + rules.widening + rules.spacing / 2;
  layers.step = layers.reach / kSteps;
  layers.wall = 1 + layers.steps(rules.wall);
  layers.fill = 1 + layers.steps(rules.fill);
  layers.widened_walls = layers.steps(rules.widened_walls);
  layers.lean = layers.steps(rules.lean);
  layers.shadow = layers.steps(rules.shadow);
  layers.least_shell = layers.steps(rules.least_shell);
  layers.widening = layers.steps(rules.widening);
  layers.half_line = layers.steps(rules.spacing / 2);
  layers.skin_margin = layers.steps(rules.skin_margin);
  layers.skin_shadow = layers.steps(rules.skin_shadow);
  layers.near = 1 + std::min(layers.steps(kNearest * raster.pixel), kSteps - layers.fill);
  for (std::size_t i = 0; i < layers.border_steps.size(); ++i)
    layers.border_steps[i] = layers.steps(static_cast<double>(i) / kBorderSteps);
  layers.depths.resize(raster.layer_count);
  layers.contour_lengths.resize(raster.layer_count);
  layers.rims.resize(raster.layer_count);
  return layers;
}

void set_layer(Layers& layers, std::size_t k, LayerSlice slice) {
  layers.rims[k] = rim_of(slice, layers.raster);
  for (std::size_t i = 0; i < slice.inside.size(); ++i) {
    if (i + kAtOnce <= slice.inside.size() && are_all(slice.inside.data() + i, 0)) {
      i += kAtOnce - 1;
      continue;
    }
    const double steps = static_cast<double>(slice.depth[i]) / layers.step;
    if (slice.inside[i] != 0)
      slice.inside[i] = static_cast<std::uint8_t>(1 + std::min<double>(kSteps, steps));
  }
  layers.depths[k] = with_widened_walls(slice.inside, layers);
  layers.contour_lengths[k] = slice.contour_length;
}

void add_modifiers(Layers& layers, const Mesh& mesh, const PrintSettings& settings) {
  if (mesh.triangles.empty()) return;
  layers.prints_in_modifiers = settings.modifier_infill > 0;
  layers.modifiers.resize(layers.raster.layer_count);
  const LayerSlicer slicer(mesh, layers.raster);
  tbb::parallel_for(std::size_t{0}, layers.raster.layer_count, [&](std::size_t k) {
    const LayerSlice slice = slicer.slice(k, kFarFromBorder / kBorderSteps);
    std::vector<std::int8_t>& inside = layers.modifiers[k];
    inside.resize(slice.inside.size());
    for (std::size_t i = 0; i < inside.size(); ++i) {
      const double steps =
          std::min<double>(kFarFromBorder, kBorderSteps * static_cast<double>(slice.depth[i]));
      inside[i] =
          static_cast<std::int8_t>(slice.inside[i] != 0 ? steps : -1 - std::min(steps, kFarFromBorder - 1.0));
    }
  });
}

// The pixels within `reach` of a pixel of `seeds`.
Pixels grown(const Pixels& seeds, double reach, const LayerRaster& raster) {
  Pixels result(seeds.size(), 0);
  const auto rows = static_cast<std::ptrdiff_t>(raster.count_y);
  const auto columns = static_cast<std::ptrdiff_t>(raster.count_x);
  const double reach_pixels = reach / raster.pixel;
  const auto most = static_cast<std::ptrdiff_t>(reach_pixels);
  // Starts and ends of the runs that cover each row, to be added up from left to right.
  std::vector<std::int32_t> change(static_cast<std::size_t>(rows * (columns + 1)), 0);
  std::ptrdiff_t first_row = rows, last_row = -1;
  for (std::ptrdiff_t row = 0; row < rows; ++row) {
    const std::uint8_t* seed = seeds.data() + row * columns;
    for (std::ptrdiff_t start = 0; start < columns;) {
      if (seed[start] == 0) {
        ++start;
        continue;
      }
      std::ptrdiff_t end = start;
      while (end < columns && seed[end] != 0) ++end;
      first_row = std::min(first_row, std::max<std::ptrdiff_t>(0, row - most));
      last_row = std::min(rows - 1, row + most);
      for (std::ptrdiff_t dy = std::max(-most, -row); dy <= std::min(most, rows - 1 - row); ++dy) {
        const auto half = static_cast<std::ptrdiff_t>(
            std::sqrt(reach_pixels * reach_pixels - static_cast<double>(dy * dy)));
        std::int32_t* target = change.data() + (row + dy) * (columns + 1);
        ++target[std::max<std::ptrdiff_t>(0, start - half)];
        --target[std::min(columns, end + half)];
      }
      start = end;
    }
  }
  for (std::ptrdiff_t row = first_row; row <= last_row; ++row) {
    std::int32_t covered = 0;
    for (std::ptrdiff_t column = 0; column < columns; ++column) {
      covered += change[static_cast<std::size_t>(row * (columns + 1) + column)];
      if (covered > 0) result[static_cast<std::size_t>(row * columns + column)] = 1;
    }
  }
  return result;
}

// What a layer's surfaces that look up or down make solid.
enum SkinFlag : std::uint8_t {
  kIsSkin = 1,       // in the layer itself
  kShadesBelow = 2,  // in the layers under it, as it looks up
  kShadesAbove = 4,  // in those over it, as it looks down
};

// Whether a skin may be printed wider than it is in this pixel: in a modifier that stays empty only on what
// the layer below has.
bool carries_skin(const Layers& layers, std::size_t k, std::size_t i) {
  if (layers.prints_in_modifiers || k == 0 || !layers.is_modified(k, i)) return true;
  const Pixels& below = layers.depths[k - 1];
  if (below[i] == 0) return false;
  const double in_modifier = layers.in_modifier(k - 1, i) / kBorderSteps;
  const double in_fill = (below[i] - layers.fill) * layers.step;
  return std::min(in_modifier, in_fill) < layers.rules.unsupported;
}

// Where margins are narrow: they are told by how deep a pixel is under the next layer's contour, which is exact, however coarse
// pixels are.
Pixels narrow_skins_of(const Layers& layers, std::size_t k) {
  const Pixels& depths = layers.depths[k];
  Pixels flags(depths.size(), 0);
  const auto add = [&](std::ptrdiff_t next, SkinFlag shades) {
    const Pixels* other =
        next >= 0 && next < layers.count() ? &layers.depths[static_cast<std::size_t>(next)] : nullptr;
    for (std::size_t i = 0; i < depths.size(); ++i) {
      if (!layers.is_fill(depths[i])) continue;
      const int covering = other != nullptr ? (*other)[i] : 0;
      if (covering > 0 && depths[i] - covering < layers.fill) continue;  // a wall alone is free
      if (covering <= layers.skin_margin) flags[i] |= kIsSkin;
      if (covering <= layers.skin_shadow) flags[i] |= shades;
    }
  };
  if (layers.rules.bottom_layers > 0) add(static_cast<std::ptrdiff_t>(k) - 1, kShadesAbove);
  if (layers.rules.top_layers > 0) add(static_cast<std::ptrdiff_t>(k) + 1, kShadesBelow);
  return flags;
}

Pixels skins_of(const Layers& layers, std::size_t k) {
  if (layers.rules.has_narrow_skins) return narrow_skins_of(layers, k);
  const Pixels& depths = layers.depths[k];
  Pixels flags(depths.size(), 0);
  // Infill that the next layer's contour leaves free, be it by less than a pixel; empty if there is none.
  const auto exposed = [&](std::ptrdiff_t next) {
    Pixels seeds(depths.size(), 0);
    bool any = false;
    const Pixels* other =
        next >= 0 && next < layers.count() ? &layers.depths[static_cast<std::size_t>(next)] : nullptr;
    for (std::size_t i = 0; i < depths.size(); ++i) {
      if (!layers.is_fill(depths[i])) continue;
      const int covering = other != nullptr ? (*other)[i] : 0;
      if (covering > layers.near || (covering > 0 && depths[i] - covering < layers.fill)) continue;
      seeds[i] = 1;
      any = true;
    }
    return any ? seeds : Pixels{};
  };
  const double margin = layers.rules.skin_margin - kNearest / 2 * layers.raster.pixel;
  // Trimmed by what is skin already. Skins of modifiers and of the rest grow by themselves, and not into each other.
  const auto grow = [&](const Pixels& all, bool modified, SkinFlag shades) {
    Pixels seeds = all;
    bool any = false;
    for (std::size_t i = 0; i < seeds.size(); ++i) {
      if (layers.is_modified(k, i) != modified) seeds[i] = 0;
      any = any || seeds[i] != 0;
    }
    if (!any) return;
    const Pixels skin = grown(seeds, margin, layers.raster);
    const Pixels shadow = grown(seeds, margin + layers.rules.shadow, layers.raster);
    const double across = layers.rules.shadow * kBorderSteps;
    for (std::size_t i = 0; i < depths.size(); ++i) {
      const int inside = layers.in_modifier(k, i);
      const bool carried = seeds[i] != 0 || carries_skin(layers, k, i);
      if (shadow[i] != 0 && (flags[i] & kIsSkin) == 0 && carried && (modified ? -inside : inside) <= across)
        flags[i] |= shades;
      if (skin[i] != 0 && layers.is_fill(depths[i]) && carried && (inside >= 0) == modified)
        flags[i] |= kIsSkin;
    }
  };
  const auto add = [&](std::ptrdiff_t direction, SkinFlag shades) {
    const Pixels seeds = exposed(static_cast<std::ptrdiff_t>(k) + direction);
    if (seeds.empty()) return;
    grow(seeds, false, shades);
    if (!layers.modifiers.empty()) grow(seeds, true, shades);
  };
  // What looks down goes before what looks up.
  if (layers.rules.bottom_layers > 0) add(-1, kShadesAbove);
  if (layers.rules.top_layers > 0) add(+1, kShadesBelow);
  return flags;
}

// Pixel by pixel. Through plain pointers, since bytes that are written might else be those of the vectors
// themselves, and the loop would not be vectorized.
template <typename Operation>
void transform(Pixels& pixels, const Pixels& others, const Operation& operation) {
  std::uint8_t* a = pixels.data();
  const std::uint8_t* b = others.data();
  const std::size_t count = pixels.size();
  for (std::size_t i = 0; i < count; ++i) a[i] = operation(a[i], b[i]);
}

// Walls that lean out further than they reach, from the layer `before` to the `other`, shade what is under them or over them.
void shade_by_leaning_walls(Pixels& covers, const Pixels& before, const Pixels& other, const Layers& layers) {
  std::uint8_t* cover = covers.data();
  const std::uint8_t *from = before.data(), *to = other.data();
  const int lean = layers.lean, shadow = layers.fill - layers.shadow;
  const std::size_t count = covers.size();
  for (std::size_t i = 0; i < count; ++i) {
    const int depth = to[i], shadowed = std::max(0, depth + shadow);
    const int of_wall = from[i] > depth + lean ? shadowed : 1 + kSteps;
    const int least = depth == 0 ? 0 : of_wall;
    cover[i] = static_cast<std::uint8_t>(std::min<int>(cover[i], least));
  }
}

// What the layers above and below leave of a layer's infill.
struct Cover {
  Pixels depths;  // least depth of the pixel in any of them, where infill begins at `fill` in this one
  Pixels shaded;  // not 0 in the shadow of what looks up or down
};

Cover cover_of(const Layers& layers, const std::vector<Pixels>& skins, std::size_t k) {
  const std::size_t pixels = layers.depths[k].size();
  Cover cover{Pixels(pixels, 1 + kSteps), Pixels(pixels, 0)};
  const auto look = [&](std::ptrdiff_t direction, int count, std::uint8_t shades) {
    for (int step = 1; step <= count; ++step) {
      const std::ptrdiff_t at = static_cast<std::ptrdiff_t>(k) + step * direction;
      if (at < 0 || at >= layers.count()) {
        std::fill(cover.depths.begin(), cover.depths.end(), std::uint8_t{0});
        return;
      }
      const Pixels& other = layers.depths[static_cast<std::size_t>(at)];
      const bool walls_cover =
          layers.rules.walls_cover && step < count;  // those of the last one do not count
      if (walls_cover)
        transform(cover.depths, other, [](std::uint8_t a, std::uint8_t b) { return std::min(a, b); });
      if (step < count) {
        const Pixels& flags = skins[static_cast<std::size_t>(at)];
        transform(cover.shaded, flags, [shades](std::uint8_t a, std::uint8_t b) {
          return static_cast<std::uint8_t>(a | (b & shades));
        });
      }
      if (walls_cover && layers.shadow <= layers.fill) continue;  // then they reach further than shadows
      shade_by_leaning_walls(cover.depths, layers.depths[static_cast<std::size_t>(at - direction)], other,
                             layers);
    }
  };
  look(+1, layers.rules.top_layers, kShadesBelow);
  look(-1, layers.rules.bottom_layers, kShadesAbove);
  return cover;
}

enum class Part : std::uint8_t {
  outside,
  wall,
  skin,   // solid, as it looks up or down
  shade,  // solid, in the shadow of that
  shell,  // solid, along leaning walls
  rim,    // sparse, but narrower than half a line
  sparse,
};

// A layer's pixels by what is printed there.
struct Parts {
  std::vector<Part> parts;
  // Of sparse infill along walls, shells and the border of modifiers, in sides of pixels; outside and inside of modifiers.
  std::array<double, 2> edge{}, border{};
};

Parts parts_of(const Layers& layers, const std::vector<Pixels>& skins, std::size_t k) {
  const LayerRaster& raster = layers.raster;
  const Pixels& depths = layers.depths[k];
  const Cover cover = cover_of(layers, skins, k);
  // Of the shell between the layer's own walls and what the others cover, whatever side the pixel is on.
  const auto width = [&](std::size_t i) {
    if (depths[i] == 0) return 0;
    return cover.depths[i] == 0 ? 1 + kSteps : depths[i] - cover.depths[i];
  };
  // A shell that ends reaches on from where it is as wide as it has to be, by what it is grown again.
  const double reach = (layers.rules.least_shell / 2 + layers.rules.widening) / raster.pixel;
  const auto away = static_cast<std::size_t>(std::max(1L, std::lround(reach)));
  const auto is_kept = [&](std::size_t row, std::size_t column, std::size_t i) {
    const int here = width(i);
    if (here >= layers.least_shell) return true;
    if (here <= 0) return false;
    return any_around(row, column, away, raster, [&](std::size_t other, double distance) {
      const int there = width(other);
      const bool on_the_shell = depths[other] >= layers.fill - layers.least_shell / 2 &&
                                cover.depths[other] <= layers.fill + layers.least_shell / 2;
      return there >= layers.least_shell && on_the_shell &&
             distance * (layers.least_shell - here) <= reach * (there - here);
    });
  };
  // The edge's length is how fast the area falls with the distance from walls and shells.
  const int band = std::max(1, layers.half_line / 2);
  constexpr std::uint8_t kFurthest = 1 + kSteps;  // than is known
  const bool deep_is_sparse =
      layers.modifiers.empty() && kFurthest - layers.fill - layers.widening >= layers.half_line + 2 * band;
  const auto is_deep = [&](std::size_t i) {
    return deep_is_sparse && are_all(&depths[i], kFurthest) && are_all(&cover.depths[i], kFurthest) &&
           are_all(&cover.shaded[i], 0) && are_all(&skins[k][i], 0);
  };
  Parts result{std::vector<Part>(depths.size(), Part::outside), {}};
  std::array<std::size_t, 2> in_band{}, in_border_band{};
  for (std::size_t row = 0; row < raster.count_y; ++row) {
    for (std::size_t column = 0; column < raster.count_x; ++column) {
      const std::size_t i = row * raster.count_x + column;
      if (column + kAtOnce <= raster.count_x) {
        if (are_all(&depths[i], 0)) {
          column += kAtOnce - 1;
          continue;
        }
        if (is_deep(i)) {
          std::fill_n(result.parts.begin() + static_cast<std::ptrdiff_t>(i), kAtOnce, Part::sparse);
          column += kAtOnce - 1;
          continue;
        }
      }
      if (depths[i] == 0) continue;
      Part& part = result.parts[i];
      if (!layers.is_fill(depths[i])) {
        part = Part::wall;
      } else if ((skins[k][i] & kIsSkin) != 0) {
        part = Part::skin;
      } else if (cover.shaded[i] != 0) {
        part = Part::shade;
      } else {
        int from_edge = depths[i] - layers.fill;
        const int from_shell = cover.depths[i] - layers.fill - layers.widening;
        if (from_shell < layers.half_line + band && from_shell < from_edge && is_kept(row, column, i))
          from_edge = from_shell;
        const int inside = layers.in_modifier(k, i);
        const int from_border = layers.border_steps[static_cast<std::size_t>(std::abs(inside))];
        const bool at_border =
            std::abs(inside) < kFarFromBorder - 1 && from_edge >= 0 && from_border < from_edge;
        if (at_border) from_edge = from_border;
        part = from_edge < 0 ? Part::shell : from_edge < layers.half_line ? Part::rim : Part::sparse;
        if (std::abs(2 * (from_edge - layers.half_line) + 1) < 2 * band)
          ++(at_border ? in_border_band : in_band)[inside >= 0 ? 1 : 0];
      }
    }
  }
  const double side_of_pixel = raster.pixel / (2 * band * layers.step);
  for (std::size_t side = 0; side < 2; ++side) {
    result.edge[side] = static_cast<double>(in_band[side]) * side_of_pixel;
    result.border[side] = static_cast<double>(in_border_band[side]) * side_of_pixel;
  }
  return result;
}

// What lines of full infill print of a layer's sparse infill; outside and inside of modifiers.
std::array<double, 2> full_shares(const Layers& layers, std::size_t k, const Parts& layer) {
  const Pixels& depths = layers.depths[k];
  // Towards a wall as far as infill goes; else, where a solid layer begins, half a pixel.
  const auto reach = [&](std::size_t i, double x, double y) {
    const LayerRaster& raster = layers.raster;
    const DepthSlope slope = slope_at(depths, i, raster);
    const double outward = -(slope.x * x + slope.y * y), beyond = (depths[i] - layers.fill) * layers.step;
    constexpr double kTowardsIt = 0.3;
    return outward > kTowardsIt ? std::min(beyond / outward, 2 * raster.pixel) : raster.pixel / 2;
  };
  const double angle = kTurn + (k % 2 == 0 ? kPi / 4 : 3 * kPi / 4);
  std::array<double, 2> shares{1, 1};
  for (std::size_t side = 0; side < 2; ++side) {
    if (side == 1 && layers.modifiers.empty()) break;
    Pixels region(depths.size(), 0);
    for (std::size_t i = 0; i < region.size(); ++i) {
      const bool is_sparse = layer.parts[i] == Part::sparse || layer.parts[i] == Part::rim;
      region[i] = is_sparse && layers.is_modified(k, i) == (side == 1) ? 1 : 0;
    }
    shares[side] = full_infill_share(region, layers.raster, angle, layers.rules.spacing, reach);
  }
  return shares;
}

// Whether there is no infill inwards of a wall's pixel: walls of both sides meet.
bool is_of_web(const Layers& layers, std::size_t k, std::size_t i) {
  const Pixels& depths = layers.depths[k];
  const LayerRaster& raster = layers.raster;
  if (depths[i] == layers.fill - 1) return true;  // a widened wall
  const DepthSlope slope = slope_at(depths, i, raster);
  const double way = (layers.fill - depths[i]) * layers.step / raster.pixel + kNearest;
  const auto columns = static_cast<std::ptrdiff_t>(raster.count_x);
  const std::ptrdiff_t at =
      static_cast<std::ptrdiff_t>(i) + std::lround(way * slope.x) + std::lround(way * slope.y) * columns;
  return at < 0 || at >= std::ssize(depths) || !layers.is_fill(depths[static_cast<std::size_t>(at)]);
}

FilamentUse use_of(const Layers& layers, std::size_t k, const Parts& layer) {
  const LayerRaster& raster = layers.raster;
  const ShellRules& rules = layers.rules;
  // Areas in pixels, lengths in sides of pixels; of infill outside and inside of modifiers.
  struct Infill {
    std::size_t solid = 0, sparse = 0, skin_edge = 0, shade_edge = 0;
    double fill = 0;
  };
  double wall = layers.rims[k];
  std::size_t web = 0;
  std::array<Infill, 2> infill;
  const int half_pixel = 2 + layers.steps(raster.pixel / 2);  // or a little more
  // The first and the last pixels of rows and columns are outside.
  const std::size_t columns = raster.count_x;
  const auto are_all_of = [&](std::size_t i, Part part) {
    return are_all(reinterpret_cast<const std::uint8_t*>(&layer.parts[i]), static_cast<std::uint8_t>(part));
  };
  const bool deep_is_beyond_lines = 1 + kSteps - std::max(layers.wall, layers.fill) > half_pixel;
  for (std::size_t i = columns; i + columns < layer.parts.size(); ++i) {
    if (i + kAtOnce + columns < layer.parts.size()) {
      if (are_all_of(i, Part::outside)) {
        i += kAtOnce - 1;
        continue;
      }
      if (layers.modifiers.empty() && deep_is_beyond_lines && are_all_of(i, Part::sparse) &&
          are_all(&layers.depths[k][i], 1 + kSteps)) {
        infill[0].fill += kAtOnce;
        infill[0].sparse += kAtOnce;
        i += kAtOnce - 1;
        continue;
      }
    }
    const Part part = layer.parts[i];
    if (part == Part::outside) continue;
    const std::uint8_t depth = layers.depths[k][i];
    const bool is_web = layers.is_wall(depth) && is_of_web(layers, k, i);
    const auto rest_beyond = [&](int line) {
      if (std::abs(depth - line) > half_pixel) return 0.0;
      return rest_of_pixel((depth + 0.5 - line) * layers.step / raster.pixel);
    };
    Infill& here = infill[layers.is_modified(k, i) ? 1 : 0];
    if (layers.is_wall(depth)) ++wall;
    if (is_web) ++web;
    if (!is_web) {
      wall -= rest_beyond(layers.wall);
      here.fill += rest_beyond(layers.fill);
    }
    if (part == Part::wall) continue;
    ++here.fill;
    if (part == Part::sparse) ++here.sparse;
    if (part == Part::shell) ++here.solid;
    if (part == Part::skin || part == Part::shade) {
      ++here.solid;
      for (const std::size_t next : {i - 1, i + 1, i - columns, i + columns}) {
        if (layer.parts[next] != Part::sparse) continue;
        Infill& beside = infill[layers.is_modified(k, next) ? 1 : 0];
        ++(part == Part::skin ? beside.skin_edge : beside.shade_edge);
      }
    }
  }
  const double volume = raster.pixel * raster.pixel * raster.layer_height;
  // A curve of length L crosses L * 4 / pi / pixel sides of pixels, averaged over its directions (Cauchy,
  // Crofton).
  const double strip = kPi / 4 * raster.pixel * raster.layer_height;
  const std::array<double, 2> full = full_shares(layers, k, layer);
  FilamentUse use;
  const double printed = wall + rules.web_excess * static_cast<double>(web);
  use.wall_mm3 =
      std::max(0.0, volume * printed - rules.round_edge * layers.contour_lengths[k] * raster.layer_height);
  for (std::size_t side = 0; side < 2; ++side) {
    const Infill& of = infill[side];
    const double skin_strip = strip * static_cast<double>(of.skin_edge);
    const double shade_strip = strip * static_cast<double>(of.shade_edge);
    const double edge = raster.pixel * raster.layer_height * layer.edge[side] + skin_strip + shade_strip;
    const double solid = volume * static_cast<double>(of.solid) + rules.widening * shade_strip;
    SparseUse& sparse = side == 1 ? use.modified : use;
    use.solid_mm3 += solid;
    sparse.sparse_mm3 =
        std::max(0.0, volume * static_cast<double>(of.sparse) -
                          rules.spacing / 2 * (skin_strip + shade_strip) - rules.widening * shade_strip);
    sparse.edge_mm3 = rules.spacing * edge;
    sparse.border_mm3 = rules.spacing * raster.pixel * raster.layer_height * layer.border[side];
    sparse.full_mm3 = full[side] * std::max(0.0, volume * of.fill - solid);
  }
  return use;
}

SparseUse sum(const SparseUse& a, const SparseUse& b, double sign) {
  return {a.edge_mm3 + sign * b.edge_mm3, a.sparse_mm3 + sign * b.sparse_mm3, a.full_mm3 + sign * b.full_mm3,
          a.border_mm3 + sign * b.border_mm3};
}

FilamentUse sum(const FilamentUse& a, const FilamentUse& b, double sign) {
  const SparseUse &sparse_a = a, &sparse_b = b;
  return {sum(sparse_a, sparse_b, sign), a.wall_mm3 + sign * b.wall_mm3, a.solid_mm3 + sign * b.solid_mm3,
          sum(a.modified, b.modified, sign)};
}

}  // namespace

double SparseUse::volume_mm3(double infill, const PrintSettings& settings) const {
  if (infill >= 1) return full_mm3;
  return (infill > 0 ? joined_share(infill, settings.pattern) * edge_mm3 : 0) +
         border_share(infill, settings) * border_mm3 + printed_share(infill, settings.pattern) * sparse_mm3;
}

double FilamentUse::volume_mm3(const PrintSettings& settings) const {
  return wall_mm3 + solid_mm3 + SparseUse::volume_mm3(settings.infill, settings) +
         modified.volume_mm3(settings.modifier_infill, settings);
}

FilamentUse operator+(const FilamentUse& a, const FilamentUse& b) {
  return sum(a, b, 1);
}

FilamentUse operator-(const FilamentUse& a, const FilamentUse& b) {
  return sum(a, b, -1);
}

struct SlicedPrint::Impl {
  Layers layers;
};

SlicedPrint::SlicedPrint(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
SlicedPrint::~SlicedPrint() = default;
SlicedPrint::SlicedPrint(SlicedPrint&&) noexcept = default;
SlicedPrint& SlicedPrint::operator=(SlicedPrint&&) noexcept = default;

SlicedPrint SlicedPrint::of(const Mesh& upright, const PrintSettings& settings, double pixel) {
  const Mesh mesh = turned(upright);
  const LayerRaster raster = raster_of(mesh, pixel, settings.layer_height, kMostPixels);
  auto impl = std::make_unique<Impl>(Impl{empty_layers(raster, settings)});
  const LayerSlicer slicer(mesh, raster);
  tbb::parallel_for(std::size_t{0}, raster.layer_count,
                    [&](std::size_t k) { set_layer(impl->layers, k, slicer.slice(k, impl->layers.reach)); });
  return SlicedPrint(std::move(impl));
}

std::pair<SlicedPrint, SlicedPrint> SlicedPrint::of_both(const Mesh& upright, std::size_t outer_triangles,
                                                         const PrintSettings& settings, double pixel) {
  const Mesh mesh = turned(upright);
  const LayerRaster raster = raster_of(mesh, pixel, settings.layer_height, kMostPixels);
  auto whole = std::make_unique<Impl>(Impl{empty_layers(raster, settings)});
  auto hollow = std::make_unique<Impl>(Impl{empty_layers(raster, settings)});
  const LayerSlicer slicer(mesh, raster);
  tbb::parallel_for(std::size_t{0}, raster.layer_count, [&](std::size_t k) {
    auto slices = slicer.slices(k, whole->layers.reach, outer_triangles);
    set_layer(whole->layers, k, std::move(slices.first));
    set_layer(hollow->layers, k, std::move(slices.second));
  });
  return {SlicedPrint(std::move(whole)), SlicedPrint(std::move(hollow))};
}

void SlicedPrint::add_modifiers(const Mesh& modifiers, const PrintSettings& settings) {
  aerate::add_modifiers(impl_->layers, turned(modifiers), settings);
}

FilamentUse SlicedPrint::use() const {
  const Layers& layers = impl_->layers;
  const std::size_t count = layers.depths.size();
  std::vector<Pixels> skins(count);
  tbb::parallel_for(std::size_t{0}, count, [&](std::size_t k) { skins[k] = skins_of(layers, k); });
  std::vector<FilamentUse> uses(count);
  tbb::parallel_for(std::size_t{0}, count,
                    [&](std::size_t k) { uses[k] = use_of(layers, k, parts_of(layers, skins, k)); });
  FilamentUse total;
  for (const FilamentUse& use : uses) total = total + use;
  return total;
}

FilamentUse filament_use(const Mesh& upright, const PrintSettings& settings, double pixel,
                         const Mesh& modifiers) {
  if (upright.triangles.empty()) return {};
  SlicedPrint print = SlicedPrint::of(upright, settings, pixel);
  print.add_modifiers(modifiers, settings);
  return print.use();
}

}  // namespace aerate
