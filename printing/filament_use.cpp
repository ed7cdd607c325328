#include "printing/filament_use.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <tbb/parallel_for.h>
#include <vector>

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
// From one pixel to the next along a way towards the middle, depths rise by at least this share of the way.
constexpr double kRise = 0.6;

constexpr double kPi = std::numbers::pi;

// One value for each pixel of a layer.
using Pixels = std::vector<std::uint8_t>;

// The layers' pixels: 0 outside; else 1 and up, the depth of the centre under the contour in steps. The
// rules' lengths in these steps.
struct Layers {
  std::vector<Pixels> depths;
  LayerRaster raster;
  ShellRules rules;
  double step = 1;  // mm
  int wall = 1, fill = 1, widened_walls = 0, lean = 0, shadow = 0, least_shell = 0, widening = 0,
      half_line = 0;
  int near = 0;  // of an edge that may pass between this pixel and the next

  int steps(double length) const { return static_cast<int>(std::lround(length / step)); }
  bool is_fill(std::uint8_t depth) const { return depth >= fill; }
  bool is_wall(std::uint8_t depth) const { return depth != 0 && depth < wall; }
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

// Where infill would be too narrow, depths are those of walls: what no pixel of its middle is near to is
// narrower than twice the middle's depth.
Pixels with_widened_walls(const Pixels& depths, const Layers& layers) {
  Pixels result = depths;
  const LayerRaster& raster = layers.raster;
  const int middle = layers.wall + layers.widened_walls / 2;
  const auto away = static_cast<std::size_t>(std::max(
      1.0, std::ceil((layers.rules.wall - layers.rules.fill + layers.rules.widened_walls) / raster.pixel)));
  const double steps_per_pixel = kRise * raster.pixel / layers.step;
  for (std::size_t row = 0; row < raster.count_y; ++row) {
    for (std::size_t column = 0; column < raster.count_x; ++column) {
      const std::size_t at = row * raster.count_x + column;
      const int depth = depths[at];
      if (depth < layers.fill || depth >= middle) continue;
      const auto leads_to_the_middle = [&](std::size_t other, double distance) {
        const int risen = depth + static_cast<int>(steps_per_pixel * distance);
        return depths[other] >= middle && depths[other] >= std::min(1 + kSteps, risen);
      };
      if (!any_around(row, column, away, raster, leads_to_the_middle))
        result[at] = static_cast<std::uint8_t>(layers.fill - 1);
    }
  }
  return result;
}

Layers layers_of(const Mesh& mesh, const LayerRaster& raster, const PrintSettings& settings) {
  Layers layers;
  layers.raster = raster;
  const ShellRules& rules = layers.rules = shell_rules(settings);
  // As deep as has to be known: a shell's width, where the sparse infill that it reaches into begins.
  const double reach = rules.wall + rules.least_shell + rules.widening + rules.spacing / 2;
  layers.step = reach / kSteps;
  layers.wall = 1 + layers.steps(rules.wall);
  layers.fill = 1 + layers.steps(rules.fill);
  layers.widened_walls = layers.steps(rules.widened_walls);
  layers.lean = layers.steps(rules.lean);
  layers.shadow = layers.steps(rules.shadow);
  layers.least_shell = layers.steps(rules.least_shell);
  layers.widening = layers.steps(rules.widening);
  layers.half_line = layers.steps(rules.spacing / 2);
  layers.near = 1 + std::min(layers.steps(kNearest * raster.pixel), kSteps - layers.fill);
  layers.depths.resize(raster.layer_count);
  const LayerSlicer slicer(mesh, raster);
  tbb::parallel_for(std::size_t{0}, raster.layer_count, [&](std::size_t k) {
    LayerSlice slice = slicer.slice(k, reach);
    for (std::size_t i = 0; i < slice.inside.size(); ++i) {
      const double steps = static_cast<double>(slice.depth[i]) / layers.step;
      if (slice.inside[i] != 0)
        slice.inside[i] = static_cast<std::uint8_t>(1 + std::min<double>(kSteps, steps));
    }
    layers.depths[k] = with_widened_walls(slice.inside, layers);
  });
  return layers;
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

Pixels skins_of(const Layers& layers, std::size_t k) {
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
  // Trimmed by what is skin already.
  const auto add = [&](std::ptrdiff_t direction, SkinFlag shades) {
    const Pixels seeds = exposed(static_cast<std::ptrdiff_t>(k) + direction);
    if (seeds.empty()) return;
    const Pixels skin = grown(seeds, margin, layers.raster);
    const Pixels shadow = grown(seeds, margin + layers.rules.shadow, layers.raster);
    for (std::size_t i = 0; i < depths.size(); ++i) {
      if (shadow[i] != 0 && (flags[i] & kIsSkin) == 0) flags[i] |= shades;
      if (skin[i] != 0 && layers.is_fill(depths[i])) flags[i] |= kIsSkin;
    }
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
      if (step < count) {  // the walls of the last one do not count
        const Pixels& flags = skins[static_cast<std::size_t>(at)];
        transform(cover.depths, other, [](std::uint8_t a, std::uint8_t b) { return std::min(a, b); });
        transform(cover.shaded, flags, [shades](std::uint8_t a, std::uint8_t b) {
          return static_cast<std::uint8_t>(a | (b & shades));
        });
      }
      if (step < count && layers.shadow <= layers.fill) continue;  // then they reach further than shadows
      const Pixels& before = layers.depths[static_cast<std::size_t>(at - direction)];
      for (std::size_t i = 0; i < pixels; ++i) {
        const bool leans = before[i] > other[i] + layers.lean;
        const int shadowed = std::max(0, other[i] + layers.fill - layers.shadow);
        const int least = other[i] == 0 ? 0 : leans ? shadowed : 1 + kSteps;
        cover.depths[i] = static_cast<std::uint8_t>(std::min<int>(cover.depths[i], least));
      }
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
  double edge = 0;  // of sparse infill along walls and shells, in sides of pixels
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
  Parts result{std::vector<Part>(depths.size(), Part::outside), 0};
  std::size_t in_band = 0;
  for (std::size_t row = 0; row < raster.count_y; ++row) {
    for (std::size_t column = 0; column < raster.count_x; ++column) {
      const std::size_t i = row * raster.count_x + column;
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
        part = from_edge < 0 ? Part::shell : from_edge < layers.half_line ? Part::rim : Part::sparse;
        if (std::abs(2 * (from_edge - layers.half_line) + 1) < 2 * band) ++in_band;
      }
    }
  }
  result.edge = static_cast<double>(in_band) * raster.pixel / (2 * band * layers.step);
  return result;
}

FilamentUse use_of(const Layers& layers, std::size_t k, const Parts& layer) {
  const LayerRaster& raster = layers.raster;
  const ShellRules& rules = layers.rules;
  // Areas in pixels, lengths in sides of pixels.
  std::size_t wall = 0, solid = 0, fill = 0, sparse = 0, skin_edge = 0, shade_edge = 0;
  const auto is_sparse = [&](std::size_t i) { return layer.parts[i] == Part::sparse ? 1U : 0U; };
  // The first and the last pixels of rows and columns are outside.
  const std::size_t columns = raster.count_x;
  for (std::size_t i = columns; i + columns < layer.parts.size(); ++i) {
    const Part part = layer.parts[i];
    if (part == Part::outside) continue;
    if (layers.is_wall(layers.depths[k][i])) ++wall;
    if (part == Part::wall) continue;
    ++fill;
    if (part == Part::sparse) ++sparse;
    if (part == Part::shell) ++solid;
    if (part == Part::skin || part == Part::shade) {
      ++solid;
      (part == Part::skin ? skin_edge : shade_edge) +=
          is_sparse(i - 1) + is_sparse(i + 1) + is_sparse(i - columns) + is_sparse(i + columns);
    }
  }
  const double volume = raster.pixel * raster.pixel * raster.layer_height;
  // A curve of length L crosses L * 4 / pi / pixel sides of pixels, averaged over its directions (Cauchy,
  // Crofton).
  const double strip = kPi / 4 * raster.pixel * raster.layer_height;
  const double skin_strip = strip * static_cast<double>(skin_edge);
  const double shade_strip = strip * static_cast<double>(shade_edge);
  const double edge = raster.pixel * raster.layer_height * layer.edge + skin_strip + shade_strip;
  FilamentUse use;
  use.wall_mm3 = volume * rules.wall_density * static_cast<double>(wall);
  use.solid_mm3 = volume * static_cast<double>(solid) + rules.widening * shade_strip;
  use.sparse_mm3 =
      std::max(0.0, volume * static_cast<double>(sparse) - rules.spacing / 2 * (skin_strip + shade_strip) -
                        rules.widening * shade_strip);
  use.joined_mm3 = kJoinedShare * rules.spacing * edge;
  use.rim_mm3 = volume * static_cast<double>(fill) - use.solid_mm3 - use.sparse_mm3;
  return use;
}

}  // namespace

double FilamentUse::volume_mm3(const PrintSettings& settings) const {
  if (settings.infill >= 1) return wall_mm3 + solid_mm3 + sparse_mm3 + rim_mm3;
  const double joined = settings.infill > 0 ? joined_mm3 : 0;
  return wall_mm3 + solid_mm3 + joined + printed_share(settings) * sparse_mm3;
}

FilamentUse operator+(const FilamentUse& a, const FilamentUse& b) {
  return {a.wall_mm3 + b.wall_mm3, a.solid_mm3 + b.solid_mm3, a.joined_mm3 + b.joined_mm3,
          a.sparse_mm3 + b.sparse_mm3, a.rim_mm3 + b.rim_mm3};
}

FilamentUse operator-(const FilamentUse& a, const FilamentUse& b) {
  return {a.wall_mm3 - b.wall_mm3, a.solid_mm3 - b.solid_mm3, a.joined_mm3 - b.joined_mm3,
          a.sparse_mm3 - b.sparse_mm3, a.rim_mm3 - b.rim_mm3};
}

FilamentUse filament_use(const Mesh& upright, const PrintSettings& settings, double pixel) {
  if (upright.triangles.empty()) return {};
  const Mesh mesh = turned(upright);
  const Layers layers = layers_of(mesh, raster_of(mesh, pixel, settings.layer_height, kMostPixels), settings);
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

}  // namespace aerate
