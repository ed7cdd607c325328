#include "printing/economics.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <span>
#include <tbb/parallel_for.h>
#include <vector>

#include "printing/layer_slices.h"

namespace aerate {
namespace {

// How PrusaSlicer 2.5 prints, with the values of its own 0.2 mm profiles. docs/economics.md says which of
// these are the slicer's and which were fitted to its figures, on three models of the six that they are held
// against.

// Surfaces that look up or down are printed this much wider than they are, into the infill. The slicer's.
constexpr double kSkinMargin = 3.0;
// Infill reaches into walls by this share of a line's spacing. The slicer's.
constexpr double kInfillOverlap = 0.25;
// Solid layers are widened into sparse infill by this share of a line's spacing. The slicer's.
constexpr double kSolidWidening = 0.3 * 1.05;
// Solid strips along leaning walls are no narrower than this share of a line's spacing. Fitted.
constexpr double kLeastStrip = 0.4;
// Of the walls that lines of sparse infill end at, they are joined along this share of what their own ends
// leave: from each end to the next, and not from there on.
constexpr double kConnectedShare = 0.5;
// What gyroid infill really takes of the share it is asked for. Fitted.
constexpr double kGyroidShare = 0.925;
// Voids in company share skins and walls: they pay from this share of the radius on that a lone one needs.
// Fitted.
constexpr double kCompanyShare = 0.8;

// The raster is turned by this angle, so that no straight wall runs along a row of pixels.
constexpr double kTurn = 0.13;
// No more pixels than this in all layers of a raster together.
constexpr double kMostPixels = 1.2e7;

// For the time (PrusaSlicer's default speeds, mm/s): straight infill, walls, and walls of less than this
// radius.
constexpr double kInfillSpeed = 60;
constexpr double kWallSpeed = 45;
constexpr double kSmallWallSpeed = 15;
constexpr double kSmallWallRadius = 6.5;
// And for the way to a contour of its own, its seam and retraction, s.
constexpr double kSecondsPerContour = 1;
// Differences of the time below this share are not told.
constexpr double kSameTime = 0.03;

constexpr double kPi = std::numbers::pi;

// Lines are printed side by side at less than their width, since their sides are round.
double spacing_of(const PrintSettings& settings) {
  return settings.line_width - settings.layer_height * (1 - kPi / 4);
}

// From the contour to where infill may be.
double wall_thickness(const PrintSettings& settings) {
  if (settings.perimeters == 0) return 0;
  return settings.line_width / 2 + (settings.perimeters - 0.5) * spacing_of(settings);
}

// Material in that thickness, over its volume.
double wall_density(const PrintSettings& settings) {
  if (settings.perimeters == 0) return 1;
  return settings.perimeters * spacing_of(settings) / wall_thickness(settings);
}

double overlap_of(const PrintSettings& settings) {
  return settings.perimeters == 0 ? 0 : kInfillOverlap * spacing_of(settings);
}

// What is printed of the space that sparse infill fills.
double printed_share(const PrintSettings& settings) {
  if (settings.infill >= 1) return 1;
  return settings.infill * (settings.pattern == InfillPattern::gyroid ? kGyroidShare : 1.0);
}

// Solid strips between leaning walls that are narrower than this are left out.
double least_strip(const PrintSettings& settings) {
  return kLeastStrip * spacing_of(settings);
}

// The layers of a model as pixels: 0 outside; else 1 and up, the depth under the contour in steps.
struct Layers {
  std::vector<std::vector<std::uint8_t>> depth;
  std::uint8_t fill = 1;   // pixels at least so deep are infill, those between are walls
  std::uint8_t strip = 1;  // steps of the least strip

  bool is_fill(std::uint8_t pixel) const { return pixel >= fill; }
  bool is_wall(std::uint8_t pixel) const { return pixel != 0 && pixel < fill; }
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

Layers layers_of(const Mesh& mesh, const LayerRaster& raster, const PrintSettings& settings) {
  const double wall = wall_thickness(settings), reach = wall + least_strip(settings);
  const double step = reach / 250;
  Layers layers;
  layers.fill = static_cast<std::uint8_t>(1 + std::lround(wall / step));
  layers.strip = static_cast<std::uint8_t>(std::lround(least_strip(settings) / step));
  layers.depth.resize(raster.layer_count);
  const LayerSlicer slicer(mesh, raster);
  tbb::parallel_for(std::size_t{0}, raster.layer_count, [&](std::size_t k) {
    LayerSlice slice = slicer.slice(k, reach);
    for (std::size_t i = 0; i < slice.inside.size(); ++i) {
      if (slice.inside[i] != 0)
        slice.inside[i] =
            static_cast<std::uint8_t>(1 + std::min(250.0, static_cast<double>(slice.depth[i]) / step));
    }
    layers.depth[k] = std::move(slice.inside);
  });
  return layers;
}

// Adds to `solid` the pixels within `reach` of a pixel of `seeds`.
void add_grown(const std::vector<std::uint8_t>& seeds, double reach, const LayerRaster& raster,
               std::vector<std::uint8_t>& solid) {
  const auto rows = static_cast<std::ptrdiff_t>(raster.count_y);
  const auto columns = static_cast<std::ptrdiff_t>(raster.count_x);
  const double reach_pixels = reach / raster.pixel;
  const auto most = static_cast<std::ptrdiff_t>(reach_pixels);
  // Starts and ends of the runs that cover each row, to be added up from left to right.
  std::vector<std::int32_t> change(static_cast<std::size_t>(rows * (columns + 1)), 0);
  bool any = false;
  for (std::ptrdiff_t row = 0; row < rows; ++row) {
    const std::uint8_t* seed = seeds.data() + row * columns;
    for (std::ptrdiff_t start = 0; start < columns;) {
      if (seed[start] == 0) {
        ++start;
        continue;
      }
      std::ptrdiff_t end = start;
      while (end < columns && seed[end] != 0) ++end;
      for (std::ptrdiff_t dy = std::max(-most, -row); dy <= std::min(most, rows - 1 - row); ++dy) {
        const auto half = static_cast<std::ptrdiff_t>(
            std::sqrt(reach_pixels * reach_pixels - static_cast<double>(dy * dy)));
        std::int32_t* target = change.data() + (row + dy) * (columns + 1);
        ++target[std::max<std::ptrdiff_t>(0, start - half)];
        --target[std::min(columns, end + half)];
      }
      any = true;
      start = end;
    }
  }
  if (!any) return;
  for (std::ptrdiff_t row = 0; row < rows; ++row) {
    std::int32_t covered = 0;
    for (std::ptrdiff_t column = 0; column < columns; ++column) {
      covered += change[static_cast<std::size_t>(row * (columns + 1) + column)];
      if (covered > 0) solid[static_cast<std::size_t>(row * columns + column)] = 1;
    }
  }
}

// Adds to `solid` the infill between two solid pixels, in any direction: the slicer merges sparse regions
// into solid ones that they part where they are narrower than 1.26 spacings of its lines, which is about a
// pixel.
void close_narrow_gaps(const std::vector<std::uint8_t>& layer, const Layers& layers,
                       const LayerRaster& raster, std::vector<std::uint8_t>& solid) {
  const std::vector<std::uint8_t> before = solid;
  const std::size_t columns = raster.count_x;
  for (std::size_t row = 1; row + 1 < raster.count_y; ++row) {
    for (std::size_t i = row * columns + 1; i + 1 < (row + 1) * columns; ++i) {
      if (before[i] != 0 || !layers.is_fill(layer[i])) continue;
      for (const std::size_t step : {std::size_t{1}, columns, columns + 1, columns - 1})
        if (before[i - step] != 0 && before[i + step] != 0) solid[i] = 1;
    }
  }
}

// Pixels of a layer's infill that are printed solid: some layers under what looks up, and over what looks
// down. Walls that lean are closed the same way, with one layer fewer.
std::vector<std::uint8_t> solid_fill(const Layers& layers, std::size_t k, const LayerRaster& raster,
                                     const PrintSettings& settings) {
  const std::vector<std::uint8_t>& layer = layers.depth[k];
  std::vector<std::uint8_t> solid(layer.size(), 0), exposed(layer.size(), 0);
  const auto look = [&](int direction, int count) {
    for (int step = 1; step <= count; ++step) {
      const std::ptrdiff_t at = static_cast<std::ptrdiff_t>(k) + step * direction;
      const bool exists = at >= 0 && at < std::ssize(layers.depth);
      for (std::size_t i = 0; i < layer.size(); ++i) {
        if (!layers.is_fill(layer[i])) continue;
        const std::uint8_t other = exists ? layers.depth[static_cast<std::size_t>(at)][i] : std::uint8_t{0};
        if (other == 0 || (step < count && layers.is_wall(other) && layer[i] - other >= layers.strip))
          solid[i] = 1;
        if (other == 0 && step == 1) exposed[i] = 1;
      }
    }
  };
  look(+1, settings.top_layers);
  look(-1, settings.bottom_layers);
  add_grown(exposed, kSkinMargin, raster, solid);
  close_narrow_gaps(layer, layers, raster, solid);
  return solid;
}

// Areas in pixels, and lengths in sides of pixels.
struct LayerSums {
  double wall = 0, solid = 0, sparse = 0;
  double solid_edge = 0, sparse_edge = 0;  // where infill meets walls
  double border = 0;                       // between solid and sparse infill
};

LayerSums sums_of(const Layers& layers, std::size_t k, const std::vector<std::uint8_t>& solid,
                  const LayerRaster& raster) {
  const std::vector<std::uint8_t>& layer = layers.depth[k];
  LayerSums sums;
  const auto meet = [&](std::size_t a, std::size_t b) {
    if (!layers.is_fill(layer[a])) return;
    if (!layers.is_fill(layer[b])) (solid[a] != 0 ? sums.solid_edge : sums.sparse_edge) += 1;
    if (layers.is_fill(layer[b]) && solid[a] != 0 && solid[b] == 0) sums.border += 1;
  };
  for (std::size_t row = 0; row < raster.count_y; ++row) {
    for (std::size_t column = 0; column < raster.count_x; ++column) {
      const std::size_t i = row * raster.count_x + column;
      if (layers.is_wall(layer[i])) sums.wall += 1;
      if (layers.is_fill(layer[i])) (solid[i] != 0 ? sums.solid : sums.sparse) += 1;
      if (column + 1 < raster.count_x) meet(i, i + 1), meet(i + 1, i);
      if (row + 1 < raster.count_y) meet(i, i + raster.count_x), meet(i + raster.count_x, i);
    }
  }
  return sums;
}

FilamentUse use_of(const LayerSums& sums, const LayerRaster& raster, const PrintSettings& settings) {
  const double volume = raster.pixel * raster.pixel * raster.layer_height;
  // A curve of length L crosses L * 4 / pi / pixel sides of pixels, averaged over its directions (Cauchy,
  // Crofton).
  const double strip = kPi / 4 * raster.pixel * raster.layer_height;
  const double overlap = overlap_of(settings);
  FilamentUse use;
  use.wall_mm3 = volume * wall_density(settings) * sums.wall;
  const double widening = kSolidWidening * spacing_of(settings);
  use.solid_mm3 = volume * sums.solid + strip * (overlap * sums.solid_edge + widening * sums.border);
  use.sparse_mm3 =
      std::max(0.0, volume * sums.sparse + strip * (overlap * sums.sparse_edge - widening * sums.border));
  use.connected_mm3 = strip * kConnectedShare * spacing_of(settings) * (sums.sparse_edge + sums.border);
  return use;
}

}  // namespace

double FilamentUse::volume_mm3(const PrintSettings& settings) const {
  const double connected = settings.infill > 0 ? connected_mm3 * std::max(0.0, 1 - settings.infill) : 0;
  return wall_mm3 + solid_mm3 + connected + printed_share(settings) * sparse_mm3;
}

FilamentUse operator-(const FilamentUse& a, const FilamentUse& b) {
  return {a.wall_mm3 - b.wall_mm3, a.solid_mm3 - b.solid_mm3, a.connected_mm3 - b.connected_mm3,
          a.sparse_mm3 - b.sparse_mm3};
}

FilamentUse filament_use(const Mesh& upright, const PrintSettings& settings, double pixel) {
  if (upright.triangles.empty()) return {};
  const Mesh mesh = turned(upright);
  const LayerRaster raster = raster_of(mesh, pixel, settings.layer_height, kMostPixels);
  const Layers layers = layers_of(mesh, raster, settings);
  std::vector<FilamentUse> uses(raster.layer_count);
  tbb::parallel_for(std::size_t{0}, raster.layer_count, [&](std::size_t k) {
    uses[k] = use_of(sums_of(layers, k, solid_fill(layers, k, raster, settings), raster), raster, settings);
  });
  FilamentUse total;
  for (const FilamentUse& use : uses) {
    total.wall_mm3 += use.wall_mm3;
    total.solid_mm3 += use.solid_mm3;
    total.sparse_mm3 += use.sparse_mm3;
    total.connected_mm3 += use.connected_mm3;
  }
  return total;
}

FilamentUse use_of_lone_void(double radius, const PrintSettings& settings) {
  const double h = settings.layer_height, wall = wall_thickness(settings);
  // The void's radius in a layer; its centre lies between two layers.
  const auto cut = [&](long k) {
    const double z = (static_cast<double>(k) + 0.5) * h;
    return z * z < radius * radius ? std::sqrt(radius * radius - z * z) : 0.0;
  };
  const long reach =
      std::lround(std::ceil(radius / h)) + std::max(settings.top_layers, settings.bottom_layers) + 1;
  FilamentUse use;
  for (long k = -reach; k < reach; ++k) {
    const double hole = cut(k);
    const double fill = hole > 0 ? hole + wall : 0;  // infill is outside of this, and solid up to `solid`
    double solid = fill;
    const auto look = [&](int direction, int count) {
      for (int step = 1; step <= count; ++step) {
        const double other = cut(k + step * direction);
        if (other <= 0) continue;
        if (other > fill) solid = std::max(solid, step == 1 ? other + kSkinMargin : other);
        if (step < count && other + wall >= fill + least_strip(settings))
          solid = std::max(solid, other + wall);
      }
    };
    look(+1, settings.top_layers);
    look(-1, settings.bottom_layers);
    if (solid <= 0) continue;
    const double overlap = 2 * kPi * fill * overlap_of(settings);
    const double widening = solid > fill ? 2 * kPi * solid * kSolidWidening * spacing_of(settings) : 0;
    const double solid_area = kPi * (solid * solid - fill * fill) + widening + (solid > fill ? overlap : 0);
    const double sparse_area = -kPi * solid * solid - widening + (solid > fill ? 0 : overlap);
    use.wall_mm3 += h * wall_density(settings) * kPi * (hole > 0 ? fill * fill - hole * hole : 0.0);
    use.solid_mm3 += h * solid_area;
    use.sparse_mm3 += h * sparse_area;
    use.connected_mm3 += h * 2 * kPi * solid * kConnectedShare * spacing_of(settings);
  }
  return use;
}

std::optional<double> break_even_radius(const PrintSettings& settings) {
  const auto costs = [&](double radius) {
    return use_of_lone_void(radius, settings).volume_mm3(settings) > 0;
  };
  // Layers make the cost of small voids jump, so the largest radius that costs is looked for from above.
  constexpr double kSmallest = 0.3, kLargest = 300, kStep = 1.1;
  if (costs(kLargest)) return std::nullopt;
  double saving = kLargest, costing = kLargest / kStep;
  while (costing > kSmallest && !costs(costing)) saving = costing, costing /= kStep;
  if (costing <= kSmallest) return 0;
  for (int i = 0; i < 30; ++i) {
    const double middle = (saving + costing) / 2;
    (costs(middle) ? costing : saving) = middle;
  }
  return kCompanyShare * saving;
}

std::optional<double> break_even_infill(double radius, const PrintSettings& settings) {
  return break_even_infill(use_of_lone_void(radius / kCompanyShare, settings), settings);
}

std::optional<double> break_even_infill(const FilamentUse& difference, const PrintSettings& settings) {
  PrintSettings solid = settings;
  solid.infill = 1;
  if (difference.volume_mm3(solid) >= 0 || difference.sparse_mm3 >= 0) return std::nullopt;
  // Linear in the infill: fixed + connected (1 - f) + sparse f.
  PrintSettings full = settings;
  full.infill = std::nextafter(1.0, 0.0);
  const double at_none = difference.wall_mm3 + difference.solid_mm3 + difference.connected_mm3;
  const double falls_by = difference.connected_mm3 - printed_share(full) * difference.sparse_mm3;
  if (falls_by <= 0) return std::nullopt;
  return std::clamp(at_none / falls_by, 0.0, 1.0);
}

TimeChange time_change(const FilamentUse& whole, const FilamentUse& hollow, std::span<const Sphere> voids,
                       const PrintSettings& settings) {
  const double section = spacing_of(settings) * settings.layer_height;
  const auto infill_seconds = [&](const FilamentUse& use) {
    return (use.volume_mm3(settings) - use.wall_mm3) / section / kInfillSpeed;
  };
  const double before = infill_seconds(whole) + whole.wall_mm3 / section / kWallSpeed;
  double after = infill_seconds(hollow) + whole.wall_mm3 / section / kWallSpeed;
  // Walls round voids: what there is in all, at the speeds of those that each void alone would have.
  double length = 0, seconds = 0;
  for (const Sphere& sphere : voids) {
    const auto layers = static_cast<long>(sphere.radius / settings.layer_height);
    for (long k = -layers; k < layers; ++k) {
      const double z = (static_cast<double>(k) + 0.5) * settings.layer_height;
      const double radius = std::sqrt(std::max(0.0, sphere.radius * sphere.radius - z * z));
      const double walls = settings.perimeters * 2 * kPi * radius;
      length += walls;
      seconds += walls / (radius < kSmallWallRadius ? kSmallWallSpeed : kWallSpeed);
      after += kSecondsPerContour;
    }
  }
  const double added = std::max(0.0, hollow.wall_mm3 - whole.wall_mm3) / section;
  if (length > 0) after += added * seconds / length;
  if (std::abs(after - before) <= kSameTime * before) return TimeChange::same;
  return after > before ? TimeChange::longer : TimeChange::shorter;
}

}  // namespace aerate
