#include "packing/cells/cell_drainage_faces.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <utility>

namespace aerate {
namespace {

constexpr double kRounding = 2e-4;  // mm: positions are fp32

// Places along one side of a face that are looked at, at most.
constexpr double kMostPlaces = 600;

struct FlatBox {
  Flat least{1e300, 1e300}, most{-1e300, -1e300};
};

FlatBox box_of(const FlatFace& face) {
  FlatBox box;
  for (const std::array<Flat, 3>& t : face.triangles) {
    for (const Flat p : t) {
      box.least = {std::min(box.least.x, p.x), std::min(box.least.y, p.y)};
      box.most = {std::max(box.most.x, p.x), std::max(box.most.y, p.y)};
    }
  }
  return box;
}

double side(Flat a, Flat b, Flat p) {
  return (b.x - a.x) * (p.y - a.y) - (b.y - a.y) * (p.x - a.x);
}

bool holds(const std::array<Flat, 3>& t, Flat p) {
  const double ab = side(t[0], t[1], p), bc = side(t[1], t[2], p), ca = side(t[2], t[0], p);
  return (ab >= 0 && bc >= 0 && ca >= 0) || (ab <= 0 && bc <= 0 && ca <= 0);
}

double distance_squared(Flat a, Flat b) {
  return (a.x - b.x) * (a.x - b.x) + (a.y - b.y) * (a.y - b.y);
}

double distance_squared_to_edge(const std::array<Flat, 2>& edge, Flat p) {
  const Flat along{edge[1].x - edge[0].x, edge[1].y - edge[0].y};
  const double whole = along.x * along.x + along.y * along.y;
  const double share =
      whole > 0 ? std::clamp(((p.x - edge[0].x) * along.x + (p.y - edge[0].y) * along.y) / whole, 0.0, 1.0)
                : 0;
  return distance_squared({edge[0].x + along.x * share, edge[0].y + along.y * share}, p);
}

}  // namespace

FlatFace flat_face(const Mesh& surface, const CellPlane& plane, const TubeFrame& frame) {
  std::vector<char> is_on(surface.positions.size());
  for (std::size_t i = 0; i < is_on.size(); ++i) {
    const double beyond = dot(plane.normal, to_double(surface.positions[i])) - plane.offset;
    is_on[i] = beyond <= kRounding && beyond >= -kFlatWithin ? 1 : 0;
  }
  const auto flat = [&](std::uint32_t v) {
    const Vec3d p = to_double(surface.positions[v]);
    return Flat{dot(p, frame.across), dot(p, frame.down)};
  };
  FlatFace face;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> edges;
  for (const Triangle& t : surface.triangles) {
    if (is_on[t[0]] == 0 || is_on[t[1]] == 0 || is_on[t[2]] == 0) continue;
    face.triangles.push_back({flat(t[0]), flat(t[1]), flat(t[2])});
    for (std::size_t k = 0; k < 3; ++k) edges.emplace_back(t[k], t[(k + 1) % 3]);
  }
  std::sort(edges.begin(), edges.end());
  for (const auto& [from, to] : edges) {
    if (!std::binary_search(edges.begin(), edges.end(), std::pair(to, from)))
      face.rim.push_back({flat(from), flat(to)});
  }
  return face;
}

DiscPlaces::DiscPlaces(const FlatFace& a, const FlatFace& b, double radius, double step)
    : a_(a), b_(b), radius_(radius), step_(step) {
  const FlatBox of_a = box_of(a), of_b = box_of(b);
  const Flat least{std::max(of_a.least.x, of_b.least.x), std::max(of_a.least.y, of_b.least.y)};
  const Flat most{std::min(of_a.most.x, of_b.most.x), std::min(of_a.most.y, of_b.most.y)};
  const double width = most.x - least.x, height = most.y - least.y;
  if (!(width >= 2 * radius && height >= 2 * radius)) return;
  step_ = std::max(step, std::max(width, height) / kMostPlaces);
  origin_ = least;
  columns_ = static_cast<std::size_t>(width / step_) + 1;
  rows_ = static_cast<std::size_t>(height / step_) + 1;
  std::vector<unsigned char> mask(columns_ * rows_, 0);
  rasterise(a, 1, mask);
  rasterise(b, 2, mask);
  places_ = eroded(mask);
  for (const Flat p : places_) middle_ = {middle_.x + p.x, middle_.y + p.y};
  const auto count = static_cast<double>(std::max<std::size_t>(places_.size(), 1));
  middle_ = {middle_.x / count, middle_.y / count};
}

void DiscPlaces::rasterise(const FlatFace& face, unsigned char bit, std::vector<unsigned char>& mask) const {
  const auto first = [&](double x, double from) {
    return static_cast<std::size_t>(std::max(0.0, std::ceil((x - from) / step_ - 1e-9)));
  };
  for (const std::array<Flat, 3>& t : face.triangles) {
    const auto [left, right] = std::minmax({t[0].x, t[1].x, t[2].x});
    const auto [top, bottom] = std::minmax({t[0].y, t[1].y, t[2].y});
    for (std::size_t row = first(top, origin_.y); row < rows_; ++row) {
      const double y = origin_.y + static_cast<double>(row) * step_;
      if (y > bottom) break;
      for (std::size_t column = first(left, origin_.x); column < columns_; ++column) {
        const double x = origin_.x + static_cast<double>(column) * step_;
        if (x > right) break;
        unsigned char& place = mask[row * columns_ + column];
        if (holds(t, {x, y})) place = static_cast<unsigned char>(place | bit);
      }
    }
  }
}

// Places that are the radius away from any that is not in both faces.
std::vector<Flat> DiscPlaces::eroded(const std::vector<unsigned char>& mask) const {
  constexpr unsigned char kBoth = 3;
  // No place in the disc may be outside; that there is none between places either, `fits` says.
  const double needed = radius_ / step_ * (1 - 1e-9);
  const auto reach = static_cast<std::size_t>(std::max(1.0, std::ceil(needed)));
  // Of each place how far it is along its column to one that is not in both.
  std::vector<std::size_t> along(mask.size(), 0);
  for (std::size_t i = 0; i < mask.size(); ++i)
    along[i] = mask[i] != kBoth ? 0 : 1 + (i >= columns_ ? along[i - columns_] : 0);
  for (std::size_t i = mask.size(); i-- > 0;)
    along[i] =
        mask[i] != kBoth ? 0 : std::min(along[i], 1 + (i + columns_ < mask.size() ? along[i + columns_] : 0));
  std::vector<Flat> places;
  for (std::size_t row = 0; row < rows_; ++row) {
    for (std::size_t column = 0; column < columns_; ++column) {
      if (mask[row * columns_ + column] != kBoth) continue;
      double nearest = std::numeric_limits<double>::infinity();
      const auto look = [&](std::size_t aside, std::size_t length) {
        nearest = std::min(nearest, static_cast<double>(aside * aside + length * length));
      };
      for (std::size_t aside = 0; aside <= reach; ++aside) {
        look(aside, column >= aside ? along[row * columns_ + column - aside] : 0);
        look(aside, column + aside < columns_ ? along[row * columns_ + column + aside] : 0);
      }
      if (nearest >= needed * needed)
        places.push_back(
            {origin_.x + static_cast<double>(column) * step_, origin_.y + static_cast<double>(row) * step_});
    }
  }
  return places;
}

bool DiscPlaces::is_in_both(Flat at) const {
  const auto is_in = [&](const FlatFace& face) {
    return std::any_of(face.triangles.begin(), face.triangles.end(),
                       [&](const auto& t) { return holds(t, at); });
  };
  return is_in(a_) && is_in(b_);
}

bool DiscPlaces::fits(Flat at) const {
  const double least = radius_ * radius_ * (1 - 1e-12);
  const auto is_clear = [&](const FlatFace& face) {
    return std::all_of(face.rim.begin(), face.rim.end(),
                       [&](const auto& edge) { return distance_squared_to_edge(edge, at) >= least; });
  };
  return is_clear(a_) && is_clear(b_) && is_in_both(at);
}

// As far as it fits in the direction of y, by less than a step.
Flat DiscPlaces::slid(Flat from, double direction) const {
  constexpr int kHalvings = 6;  // to less than a hundredth of a step
  double way = step_ / 2;
  for (int i = 0; i < kHalvings; ++i, way /= 2) {
    const Flat next{from.x, from.y + direction * way};
    if (fits(next)) from = next;
  }
  return from;
}

std::vector<Flat> DiscPlaces::choose(double spacing, bool is_level) const {
  constexpr std::size_t kMost = 6;
  enum class By { low, high, middle };
  std::vector<Flat> chosen;
  const auto cost = [&](Flat p, By by) {
    if (by == By::middle) return std::pair(distance_squared(p, middle_), 0.0);
    return std::pair(by == By::low ? -p.y : p.y, std::abs(p.x - middle_.x));
  };
  const auto add = [&](By by) {
    std::vector<Flat> apart;
    for (const Flat p : places_) {
      const bool is_apart = std::all_of(chosen.begin(), chosen.end(), [&](Flat other) {
        return distance_squared(p, other) >= spacing * spacing;
      });
      if (is_apart) apart.push_back(p);
    }
    std::stable_sort(apart.begin(), apart.end(), [&](Flat p, Flat q) { return cost(p, by) < cost(q, by); });
    const auto found = std::find_if(apart.begin(), apart.end(), [&](Flat p) { return fits(p); });
    if (found == apart.end()) return;
    chosen.push_back(by == By::middle ? *found : slid(*found, by == By::low ? 1 : -1));
  };
  const std::array<By, kMost> order =
      is_level ? std::array{By::middle, By::low, By::high, By::low, By::high, By::low}
               : std::array{By::low, By::high, By::middle, By::low, By::low, By::high};
  for (const By by : order) add(by);
  return chosen;
}

}  // namespace aerate
