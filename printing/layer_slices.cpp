#include "printing/layer_slices.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <utility>

namespace aerate {
namespace {

// Layers are cut so much below their middle, in layer heights: of two faces there, the lower one counts, as
// in PrusaSlicer.
constexpr double kBelowMiddle = 1e-3;

// The layers whose middles a triangle crosses: [first, last).
std::pair<std::size_t, std::size_t> layers_of(const Mesh& mesh, const Triangle& triangle,
                                              const LayerRaster& raster) {
  const auto z = [&](int corner) {
    return static_cast<double>(mesh.positions[triangle[static_cast<std::size_t>(corner)]].z);
  };
  const double lowest = std::min({z(0), z(1), z(2)});
  const double highest = std::max({z(0), z(1), z(2)});
  const auto layer = [&](double height) {
    const double at = std::ceil((height - raster.first_z) / raster.layer_height);
    return static_cast<std::size_t>(std::clamp(at, 0.0, static_cast<double>(raster.layer_count)));
  };
  // One more on either side: `contour` decides exactly.
  const std::size_t first = layer(lowest), last = layer(highest);
  return {first > 0 ? first - 1 : 0, std::min(last + 1, raster.layer_count)};
}

struct Point {
  double x, y;
};

// Where an edge meets the height. From its lower end, so that both triangles at it get the same point.
Point meet(Vec3d a, Vec3d b, double z) {
  if (b.z < a.z) std::swap(a, b);
  const double share = (z - a.z) / (b.z - a.z);
  return {a.x + share * (b.x - a.x), a.y + share * (b.y - a.y)};
}

// Pixels whose centres lie in [lower, upper] along an axis: [first, last).
std::pair<std::size_t, std::size_t> pixels_between(double lower, double upper, double origin, double pixel,
                                                   std::size_t count) {
  const auto at = [&](double position) {
    return static_cast<std::size_t>(
        std::clamp(std::ceil((position - origin) / pixel - 0.5), 0.0, static_cast<double>(count)));
  };
  return {at(lower), at(upper)};
}

// Pixels beside a segment: from its start to the first pixel's centre, from pixel to pixel, and along the segment.
struct PixelsBeside {
  float first_dx, first_dy, pixel, ex, ey, inverse_squared_length;
};

constexpr std::size_t kAtATime = 8;
using Eight = float __attribute__((vector_size(kAtATime * sizeof(float))));

// All that takes time: in single precision, eight pixels at a time without branches. Where the compiler can, it is compiled for
// wider registers as well, which changes no result.
#if defined(__GNUC__) && !defined(__clang__) && defined(__x86_64__) && !defined(__SANITIZE_ADDRESS__) && \
    !defined(__SANITIZE_THREAD__)
__attribute__((target_clones("avx2", "default")))
#endif
void lower_to_squares(float* squared, std::size_t stride, std::size_t rows, std::size_t columns,
                      PixelsBeside beside) {
  constexpr Eight kNone{}, kAll = kNone + 1.0F, kColumns = {0, 1, 2, 3, 4, 5, 6, 7};
  for (std::size_t row = 0; row < rows; ++row, squared += stride) {
    const float dy = beside.first_dy + static_cast<float>(row) * beside.pixel;
    for (std::size_t first = 0; first < columns; first += kAtATime) {
      const std::size_t bytes = std::min(kAtATime, columns - first) * sizeof(float);
      const Eight dx = beside.first_dx + (static_cast<float>(first) + kColumns) * beside.pixel;
      const Eight t = (dx * beside.ex + dy * beside.ey) * beside.inverse_squared_length;
      const Eight from_start = t < kNone ? kNone : t;
      const Eight along = kAll < from_start ? kAll : from_start;
      const Eight rx = dx - along * beside.ex, ry = dy - along * beside.ey;
      const Eight found = rx * rx + ry * ry;
      Eight before = found;
      if (bytes == sizeof before) {  // as a rule, and then these are no calls
        std::memcpy(&before, squared + first, sizeof before);
        before = found < before ? found : before;
        std::memcpy(squared + first, &before, sizeof before);
      } else {
        std::memcpy(&before, squared + first, bytes);
        before = found < before ? found : before;
        std::memcpy(squared + first, &before, bytes);
      }
    }
  }
}

// Added to a length, mm.
template <typename Segments>
double total_length(const Segments& segments, double length) {
  for (const auto& s : segments) {
    const double x = s.bx - s.ax, y = s.by - s.ay;
    length += std::sqrt(x * x + y * y);
  }
  return length;
}

}  // namespace

LayerRaster raster_of(const Mesh& mesh, double pixel, double layer_height, double most_pixels) {
  const Box3f box = bounding_box(mesh);
  const Vec3d lower = to_double(box.lower), size = to_double(box.upper) - lower;
  LayerRaster raster;
  raster.layer_height = layer_height;
  raster.first_z = lower.z + (0.5 - kBelowMiddle) * layer_height;
  raster.layer_count =
      static_cast<std::size_t>(std::max(1.0, std::round(size.z / layer_height + kBelowMiddle)));
  raster.pixel =
      std::max(pixel, std::sqrt(size.x * size.y * static_cast<double>(raster.layer_count) / most_pixels));
  raster.count_x = static_cast<std::size_t>(std::ceil(size.x / raster.pixel)) + 2;
  raster.count_y = static_cast<std::size_t>(std::ceil(size.y / raster.pixel)) + 2;
  const auto centred = [&](double start, double length, std::size_t count) {
    return start + length / 2 - static_cast<double>(count) * raster.pixel / 2;
  };
  raster.origin_x = centred(lower.x, size.x, raster.count_x);
  raster.origin_y = centred(lower.y, size.y, raster.count_y);
  return raster;
}

LayerSlicer::LayerSlicer(const Mesh& mesh, const LayerRaster& raster) : mesh_(mesh), raster_(raster) {
  offsets_.assign(raster.layer_count + 1, 0);
  for (const Triangle& triangle : mesh.triangles) {
    const auto [first, last] = layers_of(mesh, triangle, raster);
    for (std::size_t layer = first; layer < last; ++layer) ++offsets_[layer + 1];
  }
  for (std::size_t layer = 0; layer < raster.layer_count; ++layer) offsets_[layer + 1] += offsets_[layer];
  references_.resize(offsets_.back());
  std::vector<std::uint32_t> next(offsets_.begin(), offsets_.end() - 1);
  for (std::uint32_t i = 0; i < mesh.triangles.size(); ++i) {
    const auto [first, last] = layers_of(mesh, mesh.triangles[i], raster);
    for (std::size_t layer = first; layer < last; ++layer) references_[next[layer]++] = i;
  }
}

LayerSlice LayerSlicer::empty_slice() const {
  LayerSlice slice;
  slice.inside.assign(raster_.pixels(), 0);
  slice.depth.assign(raster_.pixels(), std::numeric_limits<float>::infinity());
  return slice;
}

LayerSlice LayerSlicer::slice(std::size_t layer, double reach) const {
  LayerSlice slice = empty_slice();
  const std::vector<Segment> segments = contour(layer, 0, mesh_.triangles.size());
  fill(segments, slice);
  measure_squares(segments, reach, slice);
  finish_depths(reach, slice);
  slice.contour_length = total_length(segments, 0);
  return slice;
}

std::pair<LayerSlice, LayerSlice> LayerSlicer::slices(std::size_t layer, double reach,
                                                      std::size_t first_triangles) const {
  LayerSlice first = empty_slice();
  std::vector<Segment> segments = contour(layer, 0, first_triangles);
  fill(segments, first);
  measure_squares(segments, reach, first);
  first.contour_length = total_length(segments, 0);

  const std::vector<Segment> others = contour(layer, first_triangles, mesh_.triangles.size());
  LayerSlice all = first;
  measure_squares(others, reach, all);
  finish_depths(reach, first);
  finish_depths(reach, all);
  all.contour_length = total_length(others, first.contour_length);
  segments.insert(segments.end(), others.begin(), others.end());
  std::fill(all.inside.begin(), all.inside.end(), std::uint8_t{0});
  fill(segments, all);
  return {std::move(first), std::move(all)};
}

std::vector<LayerSlicer::Segment> LayerSlicer::contour(std::size_t layer, std::size_t first,
                                                       std::size_t last) const {
  const double z = raster_.first_z + static_cast<double>(layer) * raster_.layer_height;
  std::vector<Segment> segments;
  for (std::uint32_t i = offsets_[layer]; i < offsets_[layer + 1]; ++i) {
    if (references_[i] < first || references_[i] >= last) continue;
    const Triangle& triangle = mesh_.triangles[references_[i]];
    const Vec3d corner[3] = {to_double(mesh_.positions[triangle[0]]), to_double(mesh_.positions[triangle[1]]),
                             to_double(mesh_.positions[triangle[2]])};
    // Corners at the height itself count as above it.
    const bool above[3] = {corner[0].z >= z, corner[1].z >= z, corner[2].z >= z};
    if (above[0] == above[1] && above[1] == above[2]) continue;
    Point leaving{}, entering{};
    for (std::size_t k = 0; k < 3; ++k) {
      const std::size_t next = (k + 1) % 3;
      if (above[k] && !above[next]) leaving = meet(corner[k], corner[next], z);
      if (!above[k] && above[next]) entering = meet(corner[k], corner[next], z);
    }
    // Seen from above, an outward triangle has the solid to the left of this.
    segments.push_back({leaving.x, leaving.y, entering.x, entering.y});
  }
  return segments;
}

void LayerSlicer::fill(const std::vector<Segment>& contour, LayerSlice& slice) const {
  struct Crossing {
    double x;
    int change;
  };
  std::vector<std::vector<Crossing>> rows(raster_.count_y);
  for (const Segment& s : contour) {
    const auto [first, last] = pixels_between(std::min(s.ay, s.by), std::max(s.ay, s.by), raster_.origin_y,
                                              raster_.pixel, raster_.count_y);
    for (std::size_t row = first; row < last; ++row) {
      const double y = raster_.origin_y + (static_cast<double>(row) + 0.5) * raster_.pixel;
      const double x = s.ax + (y - s.ay) / (s.by - s.ay) * (s.bx - s.ax);
      rows[row].push_back({x, s.by > s.ay ? -1 : 1});  // upwards, the solid is on the left: it ends here
    }
  }
  for (std::size_t row = 0; row < rows.size(); ++row) {
    std::sort(rows[row].begin(), rows[row].end(), [](const Crossing& a, const Crossing& b) {
      return a.x != b.x ? a.x < b.x : a.change > b.change;
    });
    int winding = 0;
    for (std::size_t i = 0; i + 1 < rows[row].size(); ++i) {
      winding += rows[row][i].change;
      if (winding < 1) continue;
      const auto [first, last] = pixels_between(rows[row][i].x, rows[row][i + 1].x, raster_.origin_x,
                                                raster_.pixel, raster_.count_x);
      std::fill(slice.inside.begin() + static_cast<std::ptrdiff_t>(row * raster_.count_x + first),
                slice.inside.begin() + static_cast<std::ptrdiff_t>(row * raster_.count_x + last),
                std::uint8_t{1});
    }
  }
}

void LayerSlicer::measure_squares(const std::vector<Segment>& contour, double reach,
                                  LayerSlice& slice) const {
  const auto pixel = static_cast<float>(raster_.pixel);
  for (const Segment& s : contour) {
    const auto [x0, x1] = pixels_between(std::min(s.ax, s.bx) - reach, std::max(s.ax, s.bx) + reach,
                                         raster_.origin_x, raster_.pixel, raster_.count_x);
    const auto [y0, y1] = pixels_between(std::min(s.ay, s.by) - reach, std::max(s.ay, s.by) + reach,
                                         raster_.origin_y, raster_.pixel, raster_.count_y);
    const auto ex = static_cast<float>(s.bx - s.ax), ey = static_cast<float>(s.by - s.ay);
    const float squared_length = ex * ex + ey * ey;
    const float inverse = squared_length > 0 ? 1 / squared_length : 0;
    // From the segment's start to the first pixel's centre.
    const auto offset = [&](double origin, std::size_t first, double start) {
      return static_cast<float>(origin + (static_cast<double>(first) + 0.5) * raster_.pixel - start);
    };
    // Whole groups of pixels where the row has them: what is further than the reach is left out later.
    const std::size_t grouped = x0 + (x1 - x0 + kAtATime - 1) / kAtATime * kAtATime,
                      end = grouped <= raster_.count_x ? grouped : x1;
    lower_to_squares(
        slice.depth.data() + y0 * raster_.count_x + x0, raster_.count_x, y1 - y0, end - x0,
        {offset(raster_.origin_x, x0, s.ax), offset(raster_.origin_y, y0, s.ay), pixel, ex, ey, inverse});
  }
}

void LayerSlicer::finish_depths(double reach, LayerSlice& slice) {
  const auto reach_squared = static_cast<float>(reach * reach);
  for (float& depth : slice.depth)
    depth = depth < reach_squared ? std::sqrt(depth) : std::numeric_limits<float>::infinity();
}

}  // namespace aerate
