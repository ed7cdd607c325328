#include "packing/cells/node_spans.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>

#include "kernels/constants.h"

namespace aerate {
namespace {

// The axis along which a unit direction lies; 3 if it is along none.
std::size_t axis_of(Vec3d up) {
  const std::array<double, 3> along{std::abs(up.x), std::abs(up.y), std::abs(up.z)};
  const auto largest = std::max_element(along.begin(), along.end());
  constexpr double kAlong = 1 - 1e-9;
  return *largest >= kAlong ? static_cast<std::size_t>(largest - along.begin()) : 3;
}

// A corner in spacings of the lattice: across it, and along the axis.
struct Corner {
  double u, v, height;
};

class ColumnCrossings {
 public:
  ColumnCrossings(const VoidNodes& nodes, Vec3d up, std::size_t axis)
      : nodes_(nodes), axis_(axis), sign_(dot(up, Vec3d{1, 1, 1}) > 0 ? 1 : -1) {}

  // Calls f(node, distance of the crossing from the node, is the crossing below it) where a column of nodes runs through
  // the triangle; spacings. The node is the nearest, or the next one inside if that is outside.
  template <typename F>
  void for_each(const kernels::Facet& facet, const F& f) const {
    const Corner a = corner(facet.a), b = corner(facet.b), c = corner(facet.c);
    const double doubled_area = (b.u - a.u) * (c.v - a.v) - (b.v - a.v) * (c.u - a.u);
    if (doubled_area == 0) return;  // upright
    const auto [u_least, u_most] = std::minmax({a.u, b.u, c.u});
    const auto [v_least, v_most] = std::minmax({a.v, b.v, c.v});
    for (std::int32_t u = up_to(u_least); u <= u_most; ++u) {
      for (std::int32_t v = up_to(v_least); v <= v_most; ++v) {
        // Of each corner the share that the opposite edge leaves it.
        const double of_b = ((u - a.u) * (c.v - a.v) - (v - a.v) * (c.u - a.u)) / doubled_area;
        const double of_c = ((b.u - a.u) * (v - a.v) - (b.v - a.v) * (u - a.u)) / doubled_area;
        if (of_b < 0 || of_c < 0 || of_b + of_c > 1) continue;
        const double height = a.height + of_b * (b.height - a.height) + of_c * (c.height - a.height);
        // Seen from beyond the end of the axis corners that run anticlockwise face it.
        const bool is_floor = (doubled_area > 0) == (sign_ > 0);
        const int inwards = is_floor ? sign_ : -sign_;
        auto layer = static_cast<std::int32_t>(std::lround(height));
        if (number_of(u, v, layer) == kNone) layer += inwards;
        const std::uint32_t node = number_of(u, v, layer);
        const double distance = inwards * (layer - height);
        if (node != kNone && distance <= 1) f(node, distance, is_floor);
      }
    }
  }

 private:
  static std::int32_t up_to(double x) { return static_cast<std::int32_t>(std::ceil(x)); }

  // The axis and the two after it, in turn, are right-handed.
  Corner corner(Vec3f position) const {
    const Vec3d at = (to_double(position) - nodes_.lattice.origin) * (1 / nodes_.lattice.spacing);
    const std::array<double, 3> of{at.x, at.y, at.z};
    return {of[(axis_ + 1) % 3], of[(axis_ + 2) % 3], of[axis_]};
  }

  std::uint32_t number_of(std::int32_t u, std::int32_t v, std::int32_t layer) const {
    std::array<std::int32_t, 3> of{};
    of[axis_] = layer;
    of[(axis_ + 1) % 3] = u;
    of[(axis_ + 2) % 3] = v;
    return nodes_.number_of(of[0], of[1], of[2]);
  }

  const VoidNodes& nodes_;
  std::size_t axis_;
  int sign_;
};

}  // namespace

NodeSpans spans_of(const VoidNodes& nodes, const Mesh& surface, Vec3d up) {
  constexpr float kUnlimited = std::numeric_limits<float>::infinity();
  NodeSpans spans{std::vector<float>(nodes.size(), kUnlimited), std::vector<float>(nodes.size(), kUnlimited)};
  if (const std::size_t axis = axis_of(up); axis < 3) {
    const ColumnCrossings columns(nodes, up, axis);
    for (const Triangle& triangle : surface.triangles) {
      columns.for_each(facet_of(surface, triangle), [&](std::uint32_t node, double distance, bool is_below) {
        float& span = is_below ? spans.below[node] : spans.above[node];
        span = std::min(span, static_cast<float>(distance * nodes.lattice.spacing));
      });
    }
  }
  const auto half = static_cast<float>(nodes.lattice.spacing / 2);
  for (std::vector<float>* side : {&spans.below, &spans.above}) std::ranges::replace(*side, kUnlimited, half);
  return spans;
}

}  // namespace aerate
