#include "packing/air/air_nodes.h"

#include <algorithm>
#include <cmath>
#include <tbb/parallel_for.h>

#include "kernels/constants.h"
#include "kernels/point_triangle.h"

namespace aerate {
namespace {

void measure(AirNodes& nodes, const AirColumns& columns, const SurfaceIndex& surface) {
  const std::size_t column_count = columns.first.size() - 1;
  nodes.clearance.assign(column_count * nodes.count_z, -1);
  nodes.span.assign(nodes.clearance.size(), kNone);
  const double limit = nodes.reach * nodes.reach;
  tbb::parallel_for(std::size_t{0}, column_count, [&](std::size_t column) {
    for (std::uint32_t i = columns.first[column]; i < columns.first[column + 1]; ++i) {
      const AirSpan& span = columns.spans[i];
      std::uint32_t near = kNone;  // facet that the node below is nearest to
      for (std::uint32_t layer = 0; layer < nodes.count_z; ++layer) {
        const double height = nodes.height(layer, columns.spacing);
        if (height <= span.floor || height >= span.ceiling) continue;
        const std::size_t node = column * nodes.count_z + layer;
        nodes.span[node] = i;
        const Vec3d p = columns.at(i, height);
        kernels::NearestFacet nearest{limit, kNone};
        if (near != kNone) {
          const double known = kernels::distance_squared_to_facet(p, surface.bvh().facets[near]);
          if (known < limit) nearest = {known, near};
        }
        nearest = surface.bvh().nearer_than(p, nearest);
        near = nearest.facet;
        nodes.clearance[node] = static_cast<float>(std::sqrt(nearest.distance_squared));
      }
    }
  });
}

// Where the middle of the ball can come to from a corner of the lattice.
std::vector<char> reached_by_middle(const AirColumns& columns, const AirNodes& nodes, double radius) {
  const AirNeighbours neighbours(columns, nodes);
  std::vector<char> is_reached(nodes.span.size(), 0);
  std::vector<std::size_t> open{0};
  is_reached[0] = 1;
  while (!open.empty()) {
    const std::size_t at = open.back();
    open.pop_back();
    neighbours.for_each(at, [&](std::size_t next, int, int) {
      if (is_reached[next] != 0 || static_cast<double>(nodes.clearance[next]) < radius) return;
      is_reached[next] = 1;
      open.push_back(next);
    });
  }
  return is_reached;
}

// Of a row of values the lower envelope of parabolas that stand on them, at each place (P. Felzenszwalb and
// D. Huttenlocher, "Distance transforms of sampled functions", 2012). Lengths in spacings.
class Envelope {
 public:
  void apply(float* values, std::size_t count, std::size_t stride) {
    own_.resize(count);
    places_.clear();
    begins_.clear();
    for (std::size_t i = 0; i < count; ++i) own_[i] = static_cast<double>(values[i * stride]);
    for (std::size_t i = 0; i < count; ++i) {
      if (own_[i] >= kFar) continue;
      double begin = -kInfinity;
      while (!places_.empty()) {
        begin = meeting(places_.back(), i);
        if (begin > begins_.back()) break;
        places_.pop_back();
        begins_.pop_back();
        begin = -kInfinity;
      }
      places_.push_back(i);
      begins_.push_back(begin);
    }
    if (places_.empty()) return;
    for (std::size_t i = 0, at = 0; i < count; ++i) {
      const auto x = static_cast<double>(i);
      while (at + 1 < places_.size() && begins_[at + 1] <= x) ++at;
      const double away = x - static_cast<double>(places_[at]);
      values[i * stride] = static_cast<float>(away * away + own_[places_[at]]);
    }
  }

  static constexpr double kFar = 1e20;

 private:
  double meeting(std::size_t i, std::size_t j) const {
    const auto a = static_cast<double>(i), b = static_cast<double>(j);
    return ((own_[j] + b * b) - (own_[i] + a * a)) / (2 * (b - a));
  }

  std::vector<double> own_, begins_;
  std::vector<std::size_t> places_;
};

// Balls that stay clear of the surface round all places of the middle: together they touch it wherever the ball does.
void cover(AirNodes& nodes, const AirColumns& columns, const std::vector<char>& middles) {
  const std::size_t layers = nodes.count_z, plane = layers * columns.count_x;
  std::vector<float> power(middles.size(), static_cast<float>(Envelope::kFar));
  for (std::size_t i = 0; i < middles.size(); ++i) {
    const float radius = nodes.clearance[i] / static_cast<float>(columns.spacing);
    if (middles[i] != 0) power[i] = -radius * radius;
  }
  tbb::parallel_for(std::size_t{0}, std::size_t{columns.count_y}, [&](std::size_t y) {
    Envelope envelope;
    for (std::size_t x = 0; x < columns.count_x; ++x)
      envelope.apply(&power[y * plane + x * layers], layers, 1);
    for (std::size_t z = 0; z < layers; ++z) envelope.apply(&power[y * plane + z], columns.count_x, layers);
  });
  tbb::parallel_for(std::size_t{0}, std::size_t{columns.count_x}, [&](std::size_t x) {
    Envelope envelope;
    for (std::size_t z = 0; z < layers; ++z) envelope.apply(&power[x * layers + z], columns.count_y, plane);
  });
  // Between balls that touch a flat face there is as little left as a quarter of spacing^2 / radius.
  constexpr float kTouching = 1;
  nodes.is_outside.resize(middles.size());
  for (std::size_t i = 0; i < middles.size(); ++i)
    nodes.is_outside[i] = nodes.span[i] != kNone && power[i] < kTouching ? 1 : 0;
}

}  // namespace

AirNeighbours::AirNeighbours(const AirColumns& columns, const AirNodes& nodes)
    : columns_(columns), nodes_(nodes) {}

std::uint32_t margin_for(double ball_radius, double spacing) {
  return static_cast<std::uint32_t>(std::ceil(ball_radius / spacing)) + 2;
}

AirNodes air_nodes(const AirColumns& columns, const SurfaceIndex& surface, double ball_radius) {
  constexpr double kDiagonal = 1.7320508;
  const Box3d& box = surface.winding().box;
  const double spacing = columns.spacing;
  const std::uint32_t margin = margin_for(ball_radius, spacing);
  AirNodes nodes;
  nodes.reach = ball_radius + kDiagonal * spacing;
  nodes.origin_z = box.lower.z - (margin + 0.5) * spacing;
  nodes.count_z =
      static_cast<std::uint32_t>(std::ceil((box.upper.z - box.lower.z) / spacing)) + 2 * margin + 1;
  measure(nodes, columns, surface);
  cover(nodes, columns, reached_by_middle(columns, nodes, ball_radius));
  return nodes;
}

}  // namespace aerate
