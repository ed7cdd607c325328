#include "supports/body.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <set>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <utility>

#include "core/facet_distance.h"
#include "kernels/nearest_point.h"
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
    std::vector<std::uint8_t> is_far(count_y_, 1);  // rows without that value
    for_each_row([&](std::uint32_t y) {
      const std::size_t row = static_cast<std::size_t>(y) * count_x_;
      const auto sweep = [&](std::size_t i, int& since) {
        since = (set_[i] != 0) == value ? 0 : std::min(since + 1, reach + 1);
        rows[i] = std::min(rows[i], static_cast<float>(since * since));
        if (since == 0) is_far[y] = 0;
      };
      int since = reach + 1;
      for (std::size_t x = 0; x < count_x_; ++x) sweep(row + x, since);
      since = reach + 1;
      for (std::size_t x = count_x_; x-- > 0;) sweep(row + x, since);
    });
    for_each_row([&](std::uint32_t y) {
      const int from = std::max(0, static_cast<int>(y) - reach);
      const int to = std::min(static_cast<int>(count_y_) - 1, static_cast<int>(y) + reach);
      const std::size_t here = static_cast<std::size_t>(y) * count_x_;
      for (int other = from; other <= to; ++other) {
        if (is_far[static_cast<std::size_t>(other)] != 0) continue;
        const auto by = static_cast<float>((other - static_cast<int>(y)) * (other - static_cast<int>(y)));
        const std::size_t there = static_cast<std::size_t>(other) * count_x_;
        for (std::size_t x = 0; x < count_x_; ++x)
          all[here + x] = std::min(all[here + x], rows[there + x] + by);
      }
    });
    return all;
  }

  template <typename F>
  void for_each_row(const F& f) const {
    constexpr std::uint32_t kGrain = 32;
    tbb::parallel_for(tbb::blocked_range<std::uint32_t>(0, count_y_, kGrain),
                      [&](const tbb::blocked_range<std::uint32_t>& range) {
                        for (std::uint32_t y = range.begin(); y < range.end(); ++y) f(y);
                      });
  }

 private:
  std::uint32_t count_x_, count_y_;
  std::vector<std::uint8_t> set_;
};

float squared(double pixels) {
  return static_cast<float>(pixels * pixels);
}

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

// Drawn in by a pixel, where it is thicker than twice `half`. Of three layers one is drawn in at its corners as well, so that slopes are
// about the same all round.
Pixels drawn_in(const Pixels& layer, const Pixels& empty, double half, bool at_corners) {
  const std::vector<float> inside = layer.squared_distances(false, static_cast<int>(half) + 2);
  const Pixels thick = thick_part(layer, empty, half + 1, inside);
  Pixels next = layer;
  for (std::size_t i = 0; i < next.size(); ++i)
    if (thick[i] != 0 && inside[i] <= (at_corners ? 2.0F : 1.0F)) next[i] = 0;
  return next;
}

// Widened by a pixel, where it is thinner than twice `half`.
Pixels widened(const Pixels& layer, const Pixels& empty, double half) {
  const std::vector<float> inside = layer.squared_distances(false, static_cast<int>(half) + 2);
  const Pixels thick = thick_part(layer, empty, half, inside);
  Pixels thin = layer;
  for (std::size_t i = 0; i < thin.size(); ++i)
    if (thick[i] != 0) thin[i] = 0;
  const std::vector<float> near = thin.squared_distances(true, 2);
  Pixels next = layer;
  for (std::size_t i = 0; i < next.size(); ++i)
    if (near[i] <= 2) next[i] = 1;
  return next;
}

// Columns no farther than this from one, as steps.
std::vector<std::pair<int, int>> disc_of(double pixels) {
  const int reach = static_cast<int>(pixels);
  std::vector<std::pair<int, int>> disc;
  for (int dy = -reach; dy <= reach; ++dy)
    for (int dx = -reach; dx <= reach; ++dx)
      if (dx * dx + dy * dy <= pixels * pixels) disc.emplace_back(dx, dy);
  std::ranges::stable_sort(disc, {},
                           [](std::pair<int, int> d) { return d.first * d.first + d.second * d.second; });
  return disc;
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

// Moves vertices away from the model until no triangle is nearer to it than `least`, as far as that can be done; what stands on the plate
// stays on it.
void move_clear(Mesh& mesh, const SurfaceIndex& model, double plate, double least) {
  constexpr int kRounds = 12;
  const double wanted = least + 0.01;
  std::vector<std::uint8_t> is_near(mesh.triangles.size(), 1);  // that have to be looked at
  for (int round = 0; round < kRounds; ++round) {
    tbb::parallel_for(std::size_t{0}, mesh.triangles.size(), [&](std::size_t i) {
      if (is_near[i] == 0) return;
      const kernels::Facet facet = facet_of(mesh, mesh.triangles[i]);
      is_near[i] = distance_to_surface(facet, model.bvh(), least) < least ? 1 : 0;
    });
    std::vector<std::uint8_t> moves(mesh.positions.size(), 0);
    bool is_any = false;
    for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
      if (is_near[i] == 0) continue;
      is_any = true;
      for (const std::uint32_t v : mesh.triangles[i]) moves[v] = 1;
    }
    if (!is_any) return;
    tbb::parallel_for(std::size_t{0}, mesh.positions.size(), [&](std::size_t v) {
      if (moves[v] == 0) return;
      const Vec3d at = to_double(mesh.positions[v]);
      const kernels::NearestFacet nearest = model.bvh().nearest(at, kInfinity);
      const Vec3d foot = kernels::nearest_point_on_facet(at, model.bvh().facets[nearest.facet]).point;
      Vec3d way = at - foot;
      const bool is_on_plate = at.z <= plate;
      if (is_on_plate) way.z = 0;
      const double length = std::sqrt(length_squared(way));
      if (length <= 0) return;
      // Of a triangle whose middle is what is near all corners go a little.
      constexpr double kLeastStep = 0.03;
      const double step = std::max(kLeastStep, wanted - std::sqrt(nearest.distance_squared));
      Vec3d moved = at + way * (step / length);
      moved.z = std::max(moved.z, plate);
      mesh.positions[v] = to_float(moved);
    });
    // Neighbours of what has moved.
    for (std::size_t i = 0; i < mesh.triangles.size(); ++i)
      for (const std::uint32_t v : mesh.triangles[i])
        if (moves[v] != 0) is_near[i] = 1;
  }
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
      if (layer[i] != 0 && (number == 0 || near[i] <= 2 || is_above_model(i, z))) held[i] = 1;
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
  bool is_above_model(std::size_t column, double z) const {
    constexpr double kHighest = 1.6;  // clearances, as above a slope of 50 degrees
    for (std::uint32_t i = columns_.first[column]; i < columns_.first[column + 1]; ++i) {
      const AirSpan& span = columns_.spans[i];
      if (span.floor < z && z < span.ceiling)
        return z - span.floor < kHighest * clearance_ + columns_.spacing;
    }
    return false;
  }

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

std::vector<std::array<int, 3>> without_hanging(const std::vector<std::array<int, 3>>& voxels,
                                                const Undersides& columns, const BodyShape& shape,
                                                double reach) {
  HangingParts parts(columns, shape.clearance, reach / columns.spacing);
  const Pixels empty(columns.count_x, columns.count_y);
  std::vector<std::array<int, 3>> kept;
  kept.reserve(voxels.size());
  int next = 0;
  // From the lowest layer up; voxels come from the highest down.
  for (std::size_t end = voxels.size(); end > 0;) {
    const int layer = voxels[end - 1][2];
    std::size_t begin = end;
    while (begin > 0 && voxels[begin - 1][2] == layer) --begin;
    Pixels pixels = empty;
    for (; next < layer; ++next) parts.take_from(pixels, static_cast<std::size_t>(next));
    for (std::size_t i = begin; i < end; ++i)
      pixels[columns.column(static_cast<std::uint32_t>(voxels[i][0]),
                            static_cast<std::uint32_t>(voxels[i][1]))] = 1;
    parts.take_from(pixels, static_cast<std::size_t>(layer));
    next = layer + 1;
    for (std::size_t i = begin; i < end; ++i) {
      if (pixels[columns.column(static_cast<std::uint32_t>(voxels[i][0]),
                                static_cast<std::uint32_t>(voxels[i][1]))] != 0)
        kept.push_back(voxels[i]);
    }
    end = begin;
  }
  return kept;
}

}  // namespace

std::vector<std::array<int, 3>> body_voxels(const Undersides& columns,
                                            const std::vector<CarriedPlace>& carried, const BodyShape& shape,
                                            Monitor& monitor) {
  // What is lower than two voxels is left to teeth.
  const double size = columns.spacing;
  const Pixels empty(columns.count_x, columns.count_y);
  std::vector<std::vector<std::size_t>> begins;  // columns, by the layer in which their bodies begin
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
  // So that what bears a single tooth is no thinner than voxels show.
  const std::vector<std::pair<int, int>> margin =
      disc_of(std::max(shape.margin / size, std::numbers::sqrt2 + 0.01));
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
    body = layer < kFootLayers ? widened(body, empty, height / (2 * kSlender))
                               : drawn_in(body, empty, half, layer % 3 == 0);
    for (const std::size_t column : begins[layer]) {
      const auto x = static_cast<int>(column % columns.count_x),
                 y = static_cast<int>(column / columns.count_x);
      for (const auto& [dx, dy] : margin) {
        const std::size_t i =
            columns.column(static_cast<std::uint32_t>(x + dx), static_cast<std::uint32_t>(y + dy));
        if (body[i] == 0) top[i] = static_cast<float>(layer);
        body[i] = 1;
      }
    }
    keep_clear_of_model(body, columns, z, shape.clearance);
    for (std::size_t i = 0; i < body.size(); ++i) {
      if (body[i] == 0) continue;
      if (top[i] == 0) top[i] = highest;
      voxels.push_back({static_cast<int>(i % columns.count_x), static_cast<int>(i / columns.count_x),
                        static_cast<int>(layer)});
    }
  }
  return voxels;
}

Mesh support_body(const SurfaceIndex& model, const Undersides& undersides, const TeethPlan& teeth,
                  const BodyShape& shape, Monitor& monitor) {
  constexpr int kBelow = 2;  // layers, of which the plate cuts off what smoothing rounds
  std::vector<CarriedPlace> carried;
  carried.reserve(teeth.carried.size());
  for (const std::uint32_t span : teeth.carried) {
    const Vec3d at = undersides.place(span);
    carried.push_back({at.x, at.y, at.z, undersides.spans[span].floor});
  }
  // Overhangs are looked at more closely than the body needs to be.
  const bool is_fine = undersides.spacing < shape.least_voxel;
  const Undersides coarser =
      is_fine ? columns_of(model.winding(), undersides.plate, shape.least_voxel) : Undersides{};
  const Undersides& columns = is_fine ? coarser : undersides;
  const double size = columns.spacing;
  std::vector<std::array<int, 3>> voxels = body_voxels(columns, carried, shape, monitor);
  keep_clear_of_surface(voxels, columns, model, shape.clearance);
  voxels = without_hanging(voxels, columns, shape, teeth.reach);
  if (voxels.empty()) return {};
  const std::size_t above = voxels.size();
  for (std::size_t i = 0; i < above; ++i) {
    const std::array<int, 3> voxel = voxels[i];
    if (voxel[2] != 0) continue;
    for (int k = 1; k <= kBelow; ++k) voxels.push_back({voxel[0], voxel[1], -k});
  }
  // Voxels lie at whole multiples of their size.
  const Vec3d origin{columns.origin_x, columns.origin_y, columns.plate + 0.5 * size};
  // Facets of the surface cut corners of what voxels hold.
  const double free = shape.clearance + 0.25 * size;
  const auto taken = [&](Vec3d at, double more_than) {
    const Vec3d place = at + origin;
    const double below_plate = columns.plate - place.z;
    const double reach = free - std::max(more_than, below_plate);
    if (reach <= 0) return below_plate;
    const double nearest = std::sqrt(model.bvh().nearest(place, reach * reach).distance_squared);
    return std::max(free - nearest, below_plate);
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
  mesh = without_crumbs(mesh);
  monitor.check_interrupted();
  move_clear(mesh, model, to_double(to_float({0, 0, columns.plate})).z,
             shape.clearance - kClearanceTolerance);
  return mesh;
}

}  // namespace aerate
