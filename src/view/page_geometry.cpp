#include "view/page_geometry.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <optional>
#include <tbb/parallel_for.h>
#include <vector>

namespace aerate {
namespace {

constexpr std::uint32_t kNoNumber = ~std::uint32_t{0};

// How the walk goes on at a gate, an edge a -> b with a triangle behind it and perhaps one before it.
enum Step : char {
  kNew = 0,       // the triangle before it has a corner that was not met yet
  kForward = 1,   // its corner is where the gate after this one ends
  kBackward = 2,  // ... where the gate before this one begins
  kNothing = 3,   // no triangle is left there
  kLink = 4,      // its corner was met, and `links` says how many vertices ago
  kStart = 8,     // elsewhere: a triangle of which bits 1, 2 and 4 say whether its corners were met
};

using Place = std::array<std::int32_t, 3>;

Place operator+(const Place& a, const Place& b) {
  return {a[0] + b[0], a[1] + b[1], a[2] + b[2]};
}
Place operator-(const Place& a, const Place& b) {
  return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}

// Seven bits a byte, the lowest first; the highest bit says that there are more.
void put_number(std::string& out, std::uint32_t number) {
  for (; number > 0x7f; number >>= 7) out.push_back(static_cast<char>(0x80 | (number & 0x7f)));
  out.push_back(static_cast<char>(number));
}

// Small without sign, small as a number.
std::uint32_t folded(std::int32_t number) {
  return (static_cast<std::uint32_t>(number) << 1) ^ static_cast<std::uint32_t>(number >> 31);
}

Place rounded(Vec3f position, const PageGrid& grid) {
  const Vec3d p = (to_double(position) - grid.origin) * (1 / grid.step);
  return {static_cast<std::int32_t>(std::lround(p.x)), static_cast<std::int32_t>(std::lround(p.y)),
          static_cast<std::int32_t>(std::lround(p.z))};
}

// An edge of the walk: it runs once round all that is known and has no other triangle yet.
struct Gate {
  std::uint32_t from = 0, to = 0;
  std::uint32_t behind = 0;             // third corner of the triangle that is known
  std::uint32_t before = 0, after = 0;  // neighbours on the walk
};

// One part's triangles, in the order in which they are met.
class PartWalk {
 public:
  PartWalk(const Mesh& mesh, const SolidPart& part, const PageGrid& grid) {
    // The part's own vertices, in order of their numbers.
    const std::span<const Triangle> triangles = triangles_of(mesh, part);
    std::vector<std::uint32_t> used;
    used.reserve(3 * triangles.size());
    for (const Triangle& t : triangles) used.insert(used.end(), t.begin(), t.end());
    std::ranges::sort(used);
    used.erase(std::unique(used.begin(), used.end()), used.end());
    const auto own = [&](std::uint32_t vertex) {
      return static_cast<std::uint32_t>(std::ranges::lower_bound(used, vertex) - used.begin());
    };
    triangles_.reserve(triangles.size());
    for (const Triangle& t : triangles) triangles_.push_back({own(t[0]), own(t[1]), own(t[2])});
    places_.reserve(used.size());
    for (const std::uint32_t vertex : used) places_.push_back(rounded(mesh.positions[vertex], grid));
    met_as_.assign(used.size(), kNoNumber);
    is_done_.assign(triangles.size(), false);
    list_corners();
  }

  PageGeometry take() {
    for (std::uint32_t t = 0; t < triangles_.size(); ++t) {
      if (is_done_[t]) continue;
      start(t);
      while (here_ != kNoNumber) go_on();
    }
    out_.vertex_count = met_;
    return std::move(out_);
  }

 private:
  void list_corners() {
    first_corner_.assign(places_.size() + 1, 0);
    for (const Triangle& t : triangles_)
      for (const std::uint32_t vertex : t) ++first_corner_[vertex + 1];
    for (std::size_t v = 0; v < places_.size(); ++v) first_corner_[v + 1] += first_corner_[v];
    corners_.resize(3 * triangles_.size());
    std::vector<std::uint32_t> at(first_corner_.begin(), first_corner_.end() - 1);
    for (std::uint32_t t = 0; t < triangles_.size(); ++t)
      for (std::uint32_t corner = 0; corner < 3; ++corner)
        corners_[at[triangles_[t][corner]]++] = 3 * t + corner;
  }

  // The first triangle that was not met and has the edge from -> to, as its corner at `from`.
  std::optional<std::uint32_t> corner_of_edge(std::uint32_t from, std::uint32_t to) const {
    for (std::uint32_t i = first_corner_[from]; i < first_corner_[from + 1]; ++i) {
      const std::uint32_t t = corners_[i] / 3, corner = corners_[i] % 3;
      if (!is_done_[t] && triangles_[t][(corner + 1) % 3] == to) return corners_[i];
    }
    return std::nullopt;
  }

  void put_place(std::uint32_t vertex, const Place& expected) {
    const Place off = places_[vertex] - expected;
    put_number(out_.x, folded(off[0]));
    put_number(out_.y, folded(off[1]));
    put_number(out_.z, folded(off[2]));
    met_as_[vertex] = met_++;
  }

  void put_link(std::uint32_t vertex) { put_number(out_.links, met_ - 1 - met_as_[vertex]); }

  void start(std::uint32_t t) {
    const Triangle& corners = triangles_[t];
    is_done_[t] = true;
    char step = kStart;
    for (std::size_t i = 0; i < 3; ++i)
      if (met_as_[corners[i]] != kNoNumber && !is_repeated(corners, i))
        step = static_cast<char>(step | 1 << i);
    // A corner that is there twice is met by then.
    for (std::size_t i = 0; i < 3; ++i)
      if (is_repeated(corners, i)) step = static_cast<char>(step | 1 << i);
    out_.steps.push_back(step);
    Place expected = last_;
    for (std::size_t i = 0; i < 3; ++i) {
      if (step & 1 << i) {
        put_link(corners[i]);
      } else {
        put_place(corners[i], expected);
      }
      expected = places_[corners[i]];
    }
    last_ = expected;
    const auto first = static_cast<std::uint32_t>(gates_.size());
    for (std::uint32_t i = 0; i < 3; ++i)
      gates_.push_back(
          {corners[i], corners[(i + 1) % 3], corners[(i + 2) % 3], first + (i + 2) % 3, first + (i + 1) % 3});
    here_ = first;
  }

  static bool is_repeated(const Triangle& corners, std::size_t i) {
    return std::find(corners.begin(), corners.begin() + static_cast<std::ptrdiff_t>(i), corners[i]) !=
           corners.begin() + static_cast<std::ptrdiff_t>(i);
  }

  void go_on() {
    const std::uint32_t here = here_;
    Gate& gate = gates_[here];
    const auto corner = corner_of_edge(gate.to, gate.from);
    if (!corner) {
      out_.steps.push_back(kNothing);
      here_ = gate.after;
      remove(here);
      return;
    }
    is_done_[*corner / 3] = true;
    const std::uint32_t tip = triangles_[*corner / 3][(*corner % 3 + 2) % 3];
    if (met_as_[tip] == kNoNumber) {
      out_.steps.push_back(kNew);
      put_place(tip, places_[gate.from] + places_[gate.to] - places_[gate.behind]);
      widen(here, tip);
    } else if (gate.after != here && gates_[gate.after].from == gate.to && gates_[gate.after].to == tip) {
      out_.steps.push_back(kForward);
      const std::uint32_t closed = gate.after;
      gate.behind = gate.to;
      gate.to = tip;
      remove(closed);
      settle(here);
    } else if (gate.before != here && gates_[gate.before].to == gate.from &&
               gates_[gate.before].from == tip) {
      out_.steps.push_back(kBackward);
      const std::uint32_t closed = gate.before;
      gate.behind = gate.from;
      gate.from = tip;
      remove(closed);
      settle(here);
    } else {
      out_.steps.push_back(kLink);
      put_link(tip);
      widen(here, tip);
    }
  }

  // a -> b becomes a -> tip -> b.
  void widen(std::uint32_t here, std::uint32_t tip) {
    const auto added = static_cast<std::uint32_t>(gates_.size());
    const Gate gate = gates_[here];
    gates_.push_back({tip, gate.to, gate.from, here, gate.after});
    gates_[gate.after].before = added;
    gates_[here] = {gate.from, tip, gate.to, gate.before == here ? added : gate.before, added};
    settle(added);
  }

  void remove(std::uint32_t gate) {
    gates_[gates_[gate].before].after = gates_[gate].after;
    gates_[gates_[gate].after].before = gates_[gate].before;
    if (here_ == gate) here_ = gates_[gate].after == gate ? kNoNumber : gates_[gate].after;
  }

  bool is_back(std::uint32_t a, std::uint32_t b) const {
    return gates_[a].from == gates_[b].to && gates_[a].to == gates_[b].from;
  }

  // Takes gates out that are two sides of one edge.
  void settle(std::uint32_t gate) {
    here_ = gate;
    while (true) {
      const std::uint32_t before = gates_[here_].before, after = gates_[here_].after;
      if (after == here_) return;
      std::uint32_t other = kNoNumber;
      if (is_back(here_, after)) {
        other = after;
      } else if (is_back(here_, before)) {
        other = before;
      } else {
        return;
      }
      const std::uint32_t closed = here_;
      const std::uint32_t left = other == after ? before : gates_[other].before;
      remove(closed);
      if (here_ == kNoNumber) return;
      const bool is_last = gates_[other].after == other;
      remove(other);
      if (is_last) {
        here_ = kNoNumber;
        return;
      }
      here_ = left;
    }
  }

  std::vector<Triangle> triangles_;
  std::vector<Place> places_;
  std::vector<std::uint32_t> met_as_;  // vertex to its number in the order of meeting
  std::uint32_t met_ = 0;
  std::vector<bool> is_done_;
  std::vector<std::uint32_t> first_corner_, corners_;  // of each vertex, 3 * triangle + corner
  std::vector<Gate> gates_;
  std::uint32_t here_ = kNoNumber;  // the gate to go on at
  Place last_{0, 0, 0};
  PageGeometry out_;
};

}  // namespace

PageGrid page_grid(const Mesh& mesh, double tolerance) {
  constexpr double kOfTolerance = 8;
  constexpr double kOfExtent = 32768, kResolved = 1 << 24;
  const Box3f box = bounding_box(mesh);
  const Vec3d lower = to_double(box.lower), size = to_double(box.upper) - lower;
  const double extent = std::max({size.x, size.y, size.z});
  double step = extent / kOfExtent;
  if (tolerance > 0) step = std::min(tolerance / 4, std::max(tolerance / kOfTolerance, step));
  step = std::max(step, extent / kResolved);
  return {lower, step > 0 ? step : 1};
}

PageGeometry encode_geometry(const Mesh& mesh, std::span<const SolidPart> parts, const PageGrid& grid) {
  std::vector<PageGeometry> encoded(parts.size());
  tbb::parallel_for(std::size_t{0}, parts.size(),
                    [&](std::size_t i) { encoded[i] = PartWalk(mesh, parts[i], grid).take(); });
  PageGeometry all;
  for (const PageGeometry& one : encoded) {
    all.steps += one.steps;
    all.links += one.links;
    all.x += one.x;
    all.y += one.y;
    all.z += one.z;
    all.vertex_count += one.vertex_count;
  }
  return all;
}

}  // namespace aerate
