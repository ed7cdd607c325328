#include "printing/cells/decimate.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <tuple>
#include <utility>

namespace aerate {
namespace {

// Sum of squared distances to planes, weighted by area, relative to a point near them:
// x'Ax + 2b'x + c.
struct Quadric {
  double xx = 0, xy = 0, xz = 0, yy = 0, yz = 0, zz = 0, bx = 0, by = 0, bz = 0, c = 0, area = 0;

  void add_plane(Vec3d n, double d, double weight) {
    xx += weight * n.x * n.x;
    xy += weight * n.x * n.y;
    xz += weight * n.x * n.z;
    yy += weight * n.y * n.y;
    yz += weight * n.y * n.z;
    zz += weight * n.z * n.z;
    bx += weight * n.x * d;
    by += weight * n.y * d;
    bz += weight * n.z * d;
    c += weight * d * d;
    area += weight;
  }
  void add(const Quadric& o) {
    xx += o.xx, xy += o.xy, xz += o.xz, yy += o.yy, yz += o.yz, zz += o.zz;
    bx += o.bx, by += o.by, bz += o.bz, c += o.c, area += o.area;
  }
  double at(Vec3d p) const {
    return p.x * (xx * p.x + 2 * (xy * p.y + xz * p.z + bx)) + p.y * (yy * p.y + 2 * (yz * p.z + by)) +
           p.z * (zz * p.z + 2 * bz) + c;
  }
};

struct Collapse {
  float cost;
  std::uint32_t gone, kept;
  friend bool operator<(const Collapse& a, const Collapse& b) {
    return std::tie(a.cost, a.gone, a.kept) < std::tie(b.cost, b.gone, b.kept);
  }
};

class Decimation {
 public:
  Decimation(const std::vector<Vec3d>& positions, std::vector<Triangle> triangles, double tolerance)
      : triangles_(std::move(triangles)),
        quadrics_(positions.size()),
        first_(positions.size() + 1),
        deviation_(positions.size()),
        most_(tolerance) {
    Vec3d sum{0, 0, 0};
    for (const Vec3d p : positions) sum = sum + p;
    const Vec3d middle = sum * (1.0 / static_cast<double>(std::max<std::size_t>(positions.size(), 1)));
    points_.reserve(positions.size());
    for (const Vec3d p : positions) points_.push_back(p - middle);
    for (const Triangle& t : triangles_) {
      const Vec3d doubled = doubled_area(t[0], t[1], t[2]);
      const double size = length(doubled);
      if (size <= 0) continue;
      const Vec3d n = doubled * (1 / size);
      for (const std::uint32_t v : t) quadrics_[v].add_plane(n, -dot(n, points_[t[0]]), size / 6);
    }
  }

  // One pass: how many edges were collapsed.
  std::size_t pass(double most_squared, SharedWork& work) {
    work.check_interrupted();
    index();
    find_candidates(most_squared, work);
    work.check_interrupted();
    sort_by_cost();
    work.check_interrupted();
    busy_.assign(points_.size(), 0);
    renamed_.resize(points_.size());
    for (std::uint32_t v = 0; v < renamed_.size(); ++v) renamed_[v] = v;
    constexpr std::size_t kBetween = std::size_t{1} << 16;
    std::size_t count = 0, looked_at = 0;
    for (const Collapse& c : candidates_) {
      if (++looked_at % kBetween == 0) work.check_interrupted();
      if (busy_[c.gone] != 0 || busy_[c.kept] != 0 || !keeps_topology(c)) continue;
      const std::optional<double> deviation = deviation_after(c);
      if (!deviation) continue;
      deviation_[c.kept] = std::max(deviation_[c.kept], *deviation);
      renamed_[c.gone] = c.kept;
      quadrics_[c.kept].add(quadrics_[c.gone]);
      for_each_neighbour(c.gone, [&](std::uint32_t v) { busy_[v] = 1; });
      busy_[c.gone] = 1;
      ++count;
    }
    std::size_t left = 0;
    for (const Triangle& t : triangles_) {
      const Triangle n{renamed_[t[0]], renamed_[t[1]], renamed_[t[2]]};
      if (n[0] != n[1] && n[1] != n[2] && n[2] != n[0]) triangles_[left++] = n;
    }
    triangles_.resize(left);
    return count;
  }

  std::size_t size() const { return triangles_.size(); }

  Decimated result() && {
    std::vector<std::uint32_t> number(points_.size(), 0);
    for (const Triangle& t : triangles_)
      for (const std::uint32_t v : t) number[v] = 1;
    Decimated made;
    for (std::uint32_t v = 0; v < number.size(); ++v) {
      if (number[v] == 0) continue;
      number[v] = static_cast<std::uint32_t>(made.vertices.size());
      made.vertices.push_back(v);
    }
    for (Triangle& t : triangles_) t = {number[t[0]], number[t[1]], number[t[2]]};
    made.triangles = std::move(triangles_);
    return made;
  }

 private:
  // Of both ends of each edge, in any order.
  void find_candidates(double most_squared, SharedWork& work) {
    constexpr std::size_t kPart = std::size_t{1} << 14;
    const std::size_t parts = (triangles_.size() + kPart - 1) / kPart;
    std::vector<std::vector<Collapse>> found(parts);
    work.for_each(parts, 1, [&](std::size_t part) {
      found[part].reserve(3 * kPart);
      for (std::size_t i = part * kPart; i < std::min(triangles_.size(), (part + 1) * kPart); ++i) {
        const Triangle& t = triangles_[i];
        for (std::size_t e = 0; e < 3; ++e) {
          const std::uint32_t a = t[e], b = t[(e + 1) % 3];
          if (a > b) continue;  // each edge once: the other triangle has it the other way round
          Quadric both = quadrics_[a];
          both.add(quadrics_[b]);
          const double onto_a = std::max(0.0, both.at(points_[a])),
                       onto_b = std::max(0.0, both.at(points_[b]));
          const double most = most_squared * both.area;
          // Of short edges first, where planes tell no difference.
          const double bias = 1e-7 * length_squared(points_[a] - points_[b]) * both.area;
          if (onto_a <= most) found[part].push_back({static_cast<float>((onto_a + bias) / both.area), b, a});
          if (onto_b <= most) found[part].push_back({static_cast<float>((onto_b + bias) / both.area), a, b});
        }
      }
    });
    candidates_.clear();
    for (const std::vector<Collapse>& some : found)
      candidates_.insert(candidates_.end(), some.begin(), some.end());
  }

  // By digits of the cost's bits, which of floats that are not negative ascend with these; then those of the same cost.
  void sort_by_cost() {
    constexpr unsigned kDigitBits = 11, kDigits = 3;
    constexpr std::size_t kValues = std::size_t{1} << kDigitBits;
    const auto digit = [](const Collapse& c, unsigned n) {
      return std::bit_cast<std::uint32_t>(c.cost) >> (n * kDigitBits) & (kValues - 1);
    };
    std::array<std::array<std::size_t, kValues>, kDigits> next{};
    for (const Collapse& c : candidates_)
      for (unsigned n = 0; n < kDigits; ++n) ++next[n][digit(c, n)];
    sorted_.resize(candidates_.size());
    for (unsigned n = 0; n < kDigits; ++n) {
      std::size_t before = 0;
      for (std::size_t& count : next[n]) before += std::exchange(count, before);
      for (const Collapse& c : candidates_) sorted_[next[n][digit(c, n)]++] = c;
      std::swap(candidates_, sorted_);
    }
    for (std::size_t first = 0; first < candidates_.size();) {
      std::size_t last = first + 1;
      while (last < candidates_.size() && candidates_[last].cost == candidates_[first].cost) ++last;
      if (last > first + 1)
        std::sort(candidates_.begin() + static_cast<std::ptrdiff_t>(first),
                  candidates_.begin() + static_cast<std::ptrdiff_t>(last));
      first = last;
    }
  }

  Vec3d doubled_area(std::uint32_t a, std::uint32_t b, std::uint32_t c) const {
    return cross(points_[b] - points_[a], points_[c] - points_[a]);
  }

  // Triangles by vertex (CSR).
  void index() {
    std::fill(first_.begin(), first_.end(), 0);
    for (const Triangle& t : triangles_)
      for (const std::uint32_t v : t) ++first_[v + 1];
    for (std::size_t v = 1; v < first_.size(); ++v) first_[v] += first_[v - 1];
    around_.resize(3 * triangles_.size());
    std::vector<std::uint32_t>& next = renamed_;
    next.assign(first_.begin(), first_.end() - 1);
    for (std::uint32_t t = 0; t < triangles_.size(); ++t)
      for (const std::uint32_t v : triangles_[t]) around_[next[v]++] = t;
  }

  // Of a closed manifold: each neighbour follows v in one of its triangles.
  template <typename Visit>
  void for_each_neighbour(std::uint32_t v, Visit visit) const {
    for (std::uint32_t i = first_[v]; i < first_[v + 1]; ++i) {
      const Triangle& t = triangles_[around_[i]];
      visit(t[0] == v ? t[1] : t[1] == v ? t[2] : t[0]);
    }
  }

  // The ends have only the two opposite corners as common neighbours, and stay a surface.
  bool keeps_topology(const Collapse& c) const {
    std::array<std::uint32_t, 64> ring;
    std::size_t size = 0;
    bool fits = true;
    for_each_neighbour(c.gone, [&](std::uint32_t v) {
      if (size < ring.size()) {
        ring[size++] = v;
      } else {
        fits = false;
      }
    });
    if (!fits || size < 4) return false;
    std::size_t common = 0;
    for_each_neighbour(c.kept, [&](std::uint32_t v) {
      common += std::find(ring.begin(), ring.begin() + size, v) != ring.begin() + size;
    });
    return common == 2;
  }

  // How far what went is from the surface at most after a collapse that keeps triangles in shape.
  std::optional<double> deviation_after(const Collapse& c) const {
    constexpr double kLeastCosine = 0.5;
    constexpr double kLeastAltitude = 0.03;  // of the longest side
    double nearest = 1e300;
    for (std::uint32_t i = first_[c.gone]; i < first_[c.gone + 1]; ++i) {
      Triangle t = triangles_[around_[i]];
      if (t[0] == c.kept || t[1] == c.kept || t[2] == c.kept) continue;
      const Vec3d before = doubled_area(t[0], t[1], t[2]);
      const double flat_before = flatness(t, length(before));
      for (std::uint32_t& v : t) v = v == c.gone ? c.kept : v;
      const Vec3d after = doubled_area(t[0], t[1], t[2]);
      const double size = length(after);
      if (!(dot(before, after) > kLeastCosine * length(before) * size)) return std::nullopt;
      const double flat = flatness(t, size);
      if (flat < kLeastAltitude && flat < flat_before) return std::nullopt;
      nearest = std::min(nearest, distance_squared(points_[c.gone], t));
    }
    const double deviation = deviation_[c.gone] + std::sqrt(nearest);
    if (deviation > most_) return std::nullopt;
    return deviation;
  }

  double distance_squared(Vec3d p, const Triangle& t) const {
    const Vec3d a = points_[t[0]], b = points_[t[1]], c = points_[t[2]];
    const Vec3d normal = cross(b - a, c - a);
    const auto beyond = [&](Vec3d from, Vec3d to) { return dot(cross(normal, to - from), p - from) < 0; };
    const auto to_side = [&](Vec3d from, Vec3d to) {
      const Vec3d side = to - from;
      const double along = std::clamp(dot(p - from, side) / length_squared(side), 0.0, 1.0);
      return length_squared(p - (from + side * along));
    };
    if (!beyond(a, b) && !beyond(b, c) && !beyond(c, a)) {
      const double height = dot(normal, p - a);
      return height * height / length_squared(normal);
    }
    return std::min({to_side(a, b), to_side(b, c), to_side(c, a)});
  }

  // Least altitude over the longest side.
  double flatness(const Triangle& t, double doubled) const {
    const double longest = std::max({length_squared(points_[t[0]] - points_[t[1]]),
                                     length_squared(points_[t[1]] - points_[t[2]]),
                                     length_squared(points_[t[2]] - points_[t[0]])});
    return longest > 0 ? doubled / longest : 0;
  }

  std::vector<Triangle> triangles_;
  std::vector<Vec3d> points_;
  std::vector<Quadric> quadrics_;
  std::vector<std::uint32_t> first_, around_, renamed_;
  std::vector<Collapse> candidates_, sorted_;
  std::vector<char> busy_;
  std::vector<double> deviation_;  // by vertex: of what went into it
  double most_ = 0;
};

}  // namespace

Decimated decimate(const std::vector<Vec3d>& positions, std::vector<Triangle> triangles, double tolerance,
                   SharedWork& work) {
  // Mean squared distances, of what may be the most.
  constexpr double kSteps[] = {1.0 / 1024, 1.0 / 64, 1.0 / 16, 0.25};
  constexpr double kWorthIt = 0.02;  // of the triangles
  Decimation decimation(positions, std::move(triangles), tolerance);
  for (const double step : kSteps) {
    const double most = step * tolerance * tolerance;
    while (static_cast<double>(decimation.pass(most, work)) * 2 >
           kWorthIt * static_cast<double>(decimation.size()))
      ;
  }
  return std::move(decimation).result();
}

}  // namespace aerate
