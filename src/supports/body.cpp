#include "supports/body.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "mesh/topology.h"
#include "printing/level_set.h"

namespace aerate {
namespace {

// A body this many times as high as it is wide is drawn in no further, and gets a wider foot.
constexpr double kSlender = 6;
// Over so many layers from the plate a foot widens.
constexpr int kFootLayers = 8;
// Smaller pieces are crumbs, mm3.
constexpr double kCrumb = 2;

// Pixels of one layer.
class Pixels {
 public:
  Pixels(std::uint32_t count_x, std::uint32_t count_y)
      : count_x_(count_x), count_y_(count_y), set_(static_cast<std::size_t>(count_x) * count_y, 0) {}

  std::uint8_t& operator[](std::size_t i) { return set_[i]; }
  std::uint8_t operator[](std::size_t i) const { return set_[i]; }
  std::size_t size() const { return set_.size(); }

  // Squared distance of each pixel to the nearest one whose value is `value`, in pixels, up to `reach` (P. Felzenszwalb and
  // D. Huttenlocher, "Distance transforms of sampled functions", by brute force over a short reach).
  std::vector<float> squared_distances(bool value, int reach) const {
    const auto far = static_cast<float>((reach + 1) * (reach + 1));
    std::vector<float> rows(set_.size(), far), all(set_.size(), far);
    for (std::uint32_t y = 0; y < count_y_; ++y) {
      const std::size_t row = static_cast<std::size_t>(y) * count_x_;
      const auto sweep = [&](std::size_t i, int& since) {
        since = (set_[i] != 0) == value ? 0 : std::min(since + 1, reach + 1);
        rows[i] = std::min(rows[i], static_cast<float>(since * since));
      };
      int since = reach + 1;
      for (std::size_t x = 0; x < count_x_; ++x) sweep(row + x, since);
      since = reach + 1;
      for (std::size_t x = count_x_; x-- > 0;) sweep(row + x, since);
    }
    for (std::uint32_t y = 0; y < count_y_; ++y) {
      const int from = std::max(0, static_cast<int>(y) - reach);
      const int to = std::min(static_cast<int>(count_y_) - 1, static_cast<int>(y) + reach);
      for (int other = from; other <= to; ++other) {
        const auto by = static_cast<float>((other - static_cast<int>(y)) * (other - static_cast<int>(y)));
        const std::size_t here = static_cast<std::size_t>(y) * count_x_;
        const std::size_t there = static_cast<std::size_t>(other) * count_x_;
        for (std::size_t x = 0; x < count_x_; ++x)
          all[here + x] = std::min(all[here + x], rows[there + x] + by);
      }
    }
    return all;
  }

 private:
  std::uint32_t count_x_, count_y_;
  std::vector<std::uint8_t> set_;
};

float squared(double pixels) {
  return static_cast<float>(pixels * pixels);
}

// What of a layer is at least so many pixels thick, with its corners.
Pixels thick_part(const Pixels& layer, const Pixels& empty, double half, int reach) {
  Pixels core = empty;
  const std::vector<float> inside = layer.squared_distances(false, reach);
  bool is_any = false;
  for (std::size_t i = 0; i < core.size(); ++i) {
    core[i] = inside[i] > squared(half) ? 1 : 0;
    is_any = is_any || core[i] != 0;
  }
  if (!is_any) return core;
  constexpr double kCorner = 1.45;  // a square's corner is sqrt(2) from where its disc is
  const std::vector<float> near = core.squared_distances(true, static_cast<int>(kCorner * half) + 1);
  for (std::size_t i = 0; i < core.size(); ++i)
    core[i] = layer[i] != 0 && near[i] <= squared(kCorner * half) ? 1 : 0;
  return core;
}

// Drawn in by a pixel, where it is thicker than twice `half`.
Pixels drawn_in(const Pixels& layer, const Pixels& empty, double half) {
  const int reach = static_cast<int>(half) + 2;
  const Pixels thick = thick_part(layer, empty, half + 1, reach);
  const std::vector<float> inside = layer.squared_distances(false, 2);
  Pixels next = layer;
  for (std::size_t i = 0; i < next.size(); ++i)
    if (thick[i] != 0 && inside[i] <= 1) next[i] = 0;
  return next;
}

// Widened by a pixel, where it is thinner than twice `half`.
Pixels widened(const Pixels& layer, const Pixels& empty, double half) {
  const Pixels thick = thick_part(layer, empty, half, static_cast<int>(half) + 2);
  Pixels thin = layer;
  for (std::size_t i = 0; i < thin.size(); ++i)
    if (thick[i] != 0) thin[i] = 0;
  const std::vector<float> near = thin.squared_distances(true, 2);
  Pixels next = layer;
  for (std::size_t i = 0; i < next.size(); ++i)
    if (near[i] <= 2) next[i] = 1;
  return next;
}

// Where the model is in a layer, and what is nearer to that than the clearance.
Pixels taken_by_model(const Undersides& columns, const Pixels& empty, double z, double clearance) {
  Pixels solid = empty;
  for (std::size_t i = 0; i < solid.size(); ++i) solid[i] = columns.is_solid(i, z) ? 1 : 0;
  const double pixels = clearance / columns.spacing;
  const std::vector<float> near = solid.squared_distances(true, static_cast<int>(pixels) + 1);
  for (std::size_t i = 0; i < solid.size(); ++i) solid[i] = near[i] <= squared(pixels) ? 1 : 0;
  // What is as near above or below, but for what the level set cuts.
  const double level = clearance - columns.spacing;
  for (std::size_t i = 0; level > 0 && i < solid.size(); ++i) {
    if (columns.is_solid(i, z - level) || columns.is_solid(i, z + level)) solid[i] = 1;
  }
  return solid;
}

Mesh without_crumbs(const Mesh& mesh) {
  const EdgeUses uses(mesh);
  const ShellLabels labels = label_shells(mesh, uses);
  const std::vector<Shell> shells = describe_shells(mesh, labels);
  std::vector<Triangle> kept;
  kept.reserve(mesh.triangles.size());
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i)
    if (shells[labels.of_triangle[i]].volume > kCrumb) kept.push_back(mesh.triangles[i]);
  return submesh(mesh, kept);
}

}  // namespace

std::vector<std::array<int, 3>> body_voxels(const Undersides& columns, const TeethPlan& teeth,
                                            const BodyShape& shape, Monitor& monitor) {
  // What is lower than two voxels is left to teeth.
  const double size = columns.spacing;
  const Pixels empty(columns.count_x, columns.count_y);
  std::vector<std::vector<std::uint32_t>> begins;  // columns, by the layer in which their bodies begin
  for (const std::uint32_t span : teeth.carried) {
    const double top = columns.spans[span].ceiling - shape.tooth_height;
    const double floor = std::max(columns.spans[span].floor + shape.clearance, columns.plate);
    if (top - floor < 2 * size) continue;
    const auto layer = static_cast<std::size_t>((top - columns.plate) / size - 0.5);
    if (layer >= begins.size()) begins.resize(layer + 1);
    begins[layer].push_back(columns.column_of[span]);
  }
  std::vector<std::array<int, 3>> voxels;
  Pixels body = empty;
  std::vector<float> top(body.size(), 0);  // layer in which the body of a column begins
  for (std::size_t layer = begins.size(); layer-- > 0;) {
    monitor.check_interrupted();
    const double z = columns.plate + (static_cast<double>(layer) + 0.5) * size;
    float highest = 0;
    bool is_any = !begins[layer].empty();
    for (std::size_t i = 0; i < body.size(); ++i) {
      if (body[i] == 0) continue;
      is_any = true;
      highest = std::max(highest, top[i]);
    }
    if (!is_any) continue;
    const double height = static_cast<double>(highest) - static_cast<double>(layer);  // in voxels
    const double half = std::max(shape.foot / size, height / (2 * kSlender));
    body = layer < kFootLayers ? widened(body, empty, height / (2 * kSlender)) : drawn_in(body, empty, half);
    for (const std::uint32_t column : begins[layer]) {
      // A margin round what is carried, so that what bears a single tooth is no thinner than voxels show.
      const auto x = static_cast<int>(column % columns.count_x),
                 y = static_cast<int>(column / columns.count_x);
      for (int dy = -2; dy <= 2; ++dy) {
        for (int dx = -2; dx <= 2; ++dx) {
          if (dx * dx + dy * dy > 5) continue;
          const std::size_t i =
              columns.column(static_cast<std::uint32_t>(x + dx), static_cast<std::uint32_t>(y + dy));
          if (body[i] == 0) top[i] = static_cast<float>(layer);
          body[i] = 1;
        }
      }
    }
    const Pixels taken = taken_by_model(columns, empty, z, shape.clearance);
    for (std::size_t i = 0; i < body.size(); ++i) {
      if (taken[i] != 0) body[i] = 0;
      if (body[i] == 0) continue;
      if (top[i] == 0) top[i] = highest;
      voxels.push_back({static_cast<int>(i % columns.count_x), static_cast<int>(i / columns.count_x),
                        static_cast<int>(layer)});
    }
  }
  return voxels;
}

Mesh support_body(const SurfaceIndex& model, const Undersides& columns, const TeethPlan& teeth,
                  const BodyShape& shape, Monitor& monitor) {
  constexpr int kBelow = 2;  // layers, of which the plate cuts off what smoothing rounds
  const double size = columns.spacing;
  std::vector<std::array<int, 3>> voxels = body_voxels(columns, teeth, shape, monitor);
  if (voxels.empty()) return {};
  const std::size_t above = voxels.size();
  for (std::size_t i = 0; i < above; ++i) {
    const std::array<int, 3> voxel = voxels[i];
    if (voxel[2] != 0) continue;
    for (int k = 1; k <= kBelow; ++k) voxels.push_back({voxel[0], voxel[1], -k});
  }
  // Voxels lie at whole multiples of their size.
  const Vec3d origin{columns.origin_x, columns.origin_y, columns.plate + 0.5 * size};
  const double reach = shape.clearance + 3 * size;
  const auto taken = [&](Vec3d at) {
    const Vec3d place = at + origin;
    const double nearest = std::sqrt(model.bvh().nearest(place, reach * reach).distance_squared);
    // Facets of the surface cut corners of what voxels hold.
    return std::max(shape.clearance + 0.25 * size - nearest, columns.plate - place.z);
  };
  const LevelSet smooth = LevelSet::of_voxels(voxels, size);
  monitor.check_interrupted();
  Mesh mesh = smooth.without(taken).surface();
  const double snap = 0.05 * size;
  for (Vec3f& p : mesh.positions) {
    Vec3d moved = to_double(p) + origin;
    if (moved.z < columns.plate + snap) moved.z = columns.plate;
    p = to_float(moved);
  }
  return without_crumbs(mesh);
}

}  // namespace aerate
