#include "printing/full_infill.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/disjoint_sets.h"

namespace aerate {
namespace {

// Lines are not spread further than this many spacings.
constexpr double kMostSpread = 1.2;

// Pixels side by side in a row, `end` behind the last.
struct Run {
  std::size_t row, begin, end;
};

std::vector<Run> runs_of(const std::vector<std::uint8_t>& pixels, const LayerRaster& raster) {
  std::vector<Run> runs;
  for (std::size_t row = 0; row < raster.count_y; ++row) {
    const std::uint8_t* const of_row = pixels.data() + row * raster.count_x;
    for (std::size_t column = 0; column < raster.count_x;) {
      if (of_row[column] == 0) {
        ++column;
        continue;
      }
      const std::size_t begin = column;
      while (column < raster.count_x && of_row[column] != 0) ++column;
      runs.push_back({row, begin, column});
    }
  }
  return runs;
}

// Those that touch are of one region.
DisjointSets regions_of(const std::vector<Run>& runs) {
  DisjointSets regions(runs.size());
  std::size_t above = 0;
  for (std::size_t i = 0; i < runs.size(); ++i) {
    while (above < i && (runs[above].row + 1 < runs[i].row ||
                         (runs[above].row + 1 == runs[i].row && runs[above].end <= runs[i].begin)))
      ++above;
    for (std::size_t j = above; j < i && runs[j].row + 1 == runs[i].row && runs[j].begin < runs[i].end; ++j)
      regions.join(static_cast<std::uint32_t>(j), static_cast<std::uint32_t>(i));
  }
  return regions;
}

struct Region {
  double pixels = 0;
  double low = std::numeric_limits<double>::infinity(), high = -low;  // across the lines, mm
};

double printed_share_of(const Region& region, double spacing) {
  const double lines = std::floor((region.high - region.low) / spacing);
  if (lines < 1) return 1;
  return spacing / std::min((region.high - region.low) / lines, kMostSpread * spacing);
}

}  // namespace

double full_infill_share(const std::vector<std::uint8_t>& pixels, const LayerRaster& raster, double angle,
                         double spacing, const RimReach& reach) {
  const std::vector<Run> runs = runs_of(pixels, raster);
  DisjointSets sets = regions_of(runs);
  std::vector<Region> regions(runs.size());
  const double x = std::cos(angle), y = std::sin(angle);
  for (std::uint32_t i = 0; i < runs.size(); ++i) {
    Region& region = regions[sets.root(i)];
    const auto [row, begin, end] = runs[i];
    region.pixels += static_cast<double>(end - begin);
    // Along a row, what is furthest is at an end.
    for (const std::size_t column : {begin, end - 1}) {
      const std::size_t pixel = row * raster.count_x + column;
      const double at = raster.pixel * (x * static_cast<double>(column) + y * static_cast<double>(row));
      region.low = std::min(region.low, at - reach(pixel, -x, -y));
      region.high = std::max(region.high, at + reach(pixel, x, y));
    }
  }
  double all = 0, printed = 0;
  for (const Region& region : regions) {
    if (region.pixels == 0) continue;
    all += region.pixels;
    printed += region.pixels * printed_share_of(region, spacing);
  }
  return all > 0 ? printed / all : 1;
}

}  // namespace aerate
