#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <fmt/format.h>
#include <optional>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "core/disjoint_sets.h"
#include "core/listed.h"
#include "kernels/constants.h"
#include "mesh/repair.h"
#include "mesh/topology.h"

namespace aerate {
namespace {

double distance(const Mesh& mesh, std::uint32_t a, std::uint32_t b) {
  return length(to_double(mesh.positions[a]) - to_double(mesh.positions[b]));
}

// Points in a hash of cubes, each several times as wide as the distance that is asked for: mostly one or two
// cubes are looked into.
class NearPoints {
 public:
  NearPoints(std::vector<Vec3d> points, double reach)
      : points_(std::move(points)),
        reach_(reach),
        first_(std::bit_ceil(2 * points_.size() + 1), kNone),
        next_(points_.size()) {
    // From the end, so that lists are ascending.
    for (auto i = static_cast<std::uint32_t>(points_.size()); i-- > 0;) {
      std::uint32_t& first = first_[slot_of(cube_of(points_[i]))];
      next_[i] = first;
      first = i;
    }
  }

  // Calls f(i, j) for each two points i < j that are at most `reach` apart.
  template <typename F>
  void for_each_pair(const F& f) const {
    for (std::uint32_t i = 0; i < points_.size(); ++i) {
      const Vec3d reach{reach_, reach_, reach_};
      const Vec3d low = cube_of(points_[i] - reach), high = cube_of(points_[i] + reach);
      // Two cubes at most along each axis.
      for (unsigned corner = 0; corner < 8; ++corner) {
        const bool x = (corner & 1u) != 0, y = (corner & 2u) != 0, z = (corner & 4u) != 0;
        if ((x && low.x == high.x) || (y && low.y == high.y) || (z && low.z == high.z)) continue;
        look_into({x ? high.x : low.x, y ? high.y : low.y, z ? high.z : low.z}, i, f);
      }
    }
  }

 private:
  static constexpr double kCubeReaches = 16;

  template <typename F>
  void look_into(Vec3d cube, std::uint32_t i, const F& f) const {
    for (std::uint32_t j = first_[slot_of(cube)]; j != kNone; j = next_[j]) {
      // Two cubes may have one slot.
      if (j > i && cube_of(points_[j]) == cube && length(points_[j] - points_[i]) <= reach_) f(i, j);
    }
  }

  Vec3d cube_of(Vec3d p) const {
    const double width = kCubeReaches * reach_;
    return {std::floor(p.x / width), std::floor(p.y / width), std::floor(p.z / width)};
  }

  std::size_t slot_of(Vec3d cube) const {
    std::uint64_t h = 0;
    for (const double number : {cube.x, cube.y, cube.z}) {
      h = (h ^ std::bit_cast<std::uint64_t>(number + 0.0)) * 0xff51afd7ed558ccdu;
      h ^= h >> 32;
    }
    return h & (first_.size() - 1);
  }

  std::vector<Vec3d> points_;
  double reach_;
  std::vector<std::uint32_t> first_, next_;
};

// Sets of vertices that become one, at the place of the lowest, from which none is further than the
// tolerance.
class JoinedVertices {
 public:
  JoinedVertices(const Mesh& mesh, double tolerance)
      : mesh_(mesh),
        tolerance_(tolerance),
        sets_(mesh.positions.size()),
        farthest_(mesh.positions.size(), 0) {}

  bool can_join(std::uint32_t a, std::uint32_t b) {
    const auto [low, high] = std::minmax({sets_.root(a), sets_.root(b)});
    return low == high || farthest_[high] + distance(mesh_, low, high) <= tolerance_;
  }

  void join(std::uint32_t a, std::uint32_t b) {
    const auto [low, high] = std::minmax({sets_.root(a), sets_.root(b)});
    if (low == high) return;
    farthest_[low] = std::max(farthest_[low], farthest_[high] + distance(mesh_, low, high));
    sets_.join(low, high);
  }

  std::uint32_t place_of(std::uint32_t vertex) { return sets_.root(vertex); }

  // Of the vertices that became one with this, the distance of the farthest from their place, at most.
  double reach_of(std::uint32_t vertex) { return farthest_[sets_.root(vertex)]; }

  // The mesh with one vertex for each set; triangles may come to name one twice.
  Mesh joined() {
    Mesh mesh = mesh_;
    for (Triangle& triangle : mesh.triangles)
      for (std::uint32_t& vertex : triangle) vertex = place_of(vertex);
    return mesh;
  }

 private:
  const Mesh& mesh_;
  double tolerance_;
  DisjointSets sets_;
  std::vector<double> farthest_;  // of a set's members from its lowest, at most
};

// Two open edges that lie on each other.
struct FacingEdges {
  bool agree;  // run in opposite directions, as the two sides of an edge do
  double apart;
  std::uint32_t first, second;

  friend auto operator<=>(const FacingEdges& a, const FacingEdges& b) {
    return std::tuple(!a.agree, a.apart, a.first, a.second) <=>
           std::tuple(!b.agree, b.apart, b.first, b.second);
  }
};

std::vector<FacingEdges> facing_edges(const Mesh& mesh, const std::vector<OpenEdge>& edges,
                                      double tolerance) {
  std::vector<Vec3d> middles;
  middles.reserve(edges.size());
  for (const OpenEdge& edge : edges)
    middles.push_back((to_double(mesh.positions[edge.from]) + to_double(mesh.positions[edge.to])) * 0.5);
  std::vector<FacingEdges> facing;
  NearPoints(std::move(middles), tolerance).for_each_pair([&](std::uint32_t i, std::uint32_t j) {
    const OpenEdge &a = edges[i], &b = edges[j];
    const double against = std::max(distance(mesh, a.from, b.to), distance(mesh, a.to, b.from));
    const double along = std::max(distance(mesh, a.from, b.from), distance(mesh, a.to, b.to));
    if (against <= tolerance) {
      facing.push_back({true, against, i, j});
    } else if (along <= tolerance) {
      facing.push_back({false, along, i, j});
    }
  });
  std::sort(facing.begin(), facing.end());
  return facing;
}

// Joins the ends of edges that face each other, the nearest first, each edge with one other.
void join_facing_edges(const Mesh& mesh, const std::vector<OpenEdge>& edges, double tolerance,
                       JoinedVertices& joined) {
  std::vector<bool> taken(edges.size(), false);
  for (const FacingEdges& pair : facing_edges(mesh, edges, tolerance)) {
    if (taken[pair.first] || taken[pair.second]) continue;
    const OpenEdge& a = edges[pair.first];
    OpenEdge b = edges[pair.second];
    if (pair.agree) std::swap(b.from, b.to);
    if (!joined.can_join(a.from, b.from) || !joined.can_join(a.to, b.to)) continue;
    joined.join(a.from, b.from);
    joined.join(a.to, b.to);
    taken[pair.first] = taken[pair.second] = true;
  }
}

// ---- Where one long edge faces several short ones

// How far a triangle is from having no area: the least of its heights.
double width_of(const Mesh& mesh, const Triangle& t) {
  const Vec3d a = to_double(mesh.positions[t[0]]);
  const Vec3d ab = to_double(mesh.positions[t[1]]) - a, ac = to_double(mesh.positions[t[2]]) - a;
  const double longest = std::max({length(ab), length(ac), length(ac - ab)});
  return longest > 0 ? length(cross(ab, ac)) / longest : 0;
}

// Triangles that fill a loop whose two sides lie on each other, running along it: the sides are walked along
// together from one end to the other. Nothing if that needs a triangle wider than the tolerance.
std::optional<std::vector<Triangle>> fill_slit(const Mesh& mesh, std::vector<std::uint32_t> loop,
                                               double tolerance) {
  const auto place = [&](std::uint32_t vertex) { return to_double(mesh.positions[vertex]); };
  const auto farthest_from = [&](std::uint32_t from) {
    return std::max_element(loop.begin(), loop.end(), [&](auto a, auto b) {
      return length_squared(place(a) - place(from)) < length_squared(place(b) - place(from));
    });
  };
  std::rotate(loop.begin(), farthest_from(loop.front()), loop.end());
  const auto end = static_cast<std::size_t>(farthest_from(loop.front()) - loop.begin());
  const Vec3d direction = place(loop[end]) - place(loop.front());
  const auto along = [&](std::size_t i) { return dot(place(loop[i]), direction); };

  std::vector<Triangle> triangles;
  const auto add = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
    triangles.push_back({a, b, c});
    return width_of(mesh, triangles.back()) <= tolerance;
  };
  // Both sides begin in loop[0], so that their first two vertices make the first triangle.
  std::size_t up = 1, down = loop.size() - 1;
  if (!add(loop.front(), loop[up], loop[down])) return std::nullopt;
  while (down - up > 1) {
    const bool step_up = up < end && (down == end || along(up + 1) <= along(down - 1));
    if (!add(loop[up], step_up ? loop[up + 1] : loop[down - 1], loop[down])) return std::nullopt;
    step_up ? ++up : --down;
  }
  return triangles;
}

struct FilledSlits {
  std::size_t triangles = 0;
  double widest = 0;
};

FilledSlits fill_slits(Mesh& mesh, double tolerance) {
  FilledSlits filled;
  for (const BoundaryChain& chain : chain_boundary(mesh, EdgeUses(mesh))) {
    if (!chain.closed || chain.vertices.size() < 3) continue;
    const auto triangles = fill_slit(mesh, chain.vertices, tolerance);
    if (!triangles) continue;
    for (const Triangle& triangle : *triangles) {
      filled.widest = std::max(filled.widest, width_of(mesh, triangle));
      mesh.triangles.push_back(triangle);
    }
    filled.triangles += triangles->size();
  }
  return filled;
}

// ---- The ends of such edges

using VertexPair = std::pair<std::uint32_t, std::uint32_t>;

std::vector<std::uint32_t> ends_of(const std::vector<OpenEdge>& edges) {
  std::vector<std::uint32_t> ends;
  ends.reserve(2 * edges.size());
  for (const OpenEdge& edge : edges) {
    ends.push_back(edge.from);
    ends.push_back(edge.to);
  }
  std::sort(ends.begin(), ends.end());
  ends.erase(std::unique(ends.begin(), ends.end()), ends.end());
  return ends;
}

// Ends of open edges that are near each other, the nearest first.
std::vector<VertexPair> near_ends(const Mesh& mesh, double tolerance) {
  const std::vector<std::uint32_t> ends = ends_of(open_edges(mesh, EdgeUses(mesh)));
  std::vector<Vec3d> places;
  places.reserve(ends.size());
  for (const std::uint32_t vertex : ends) places.push_back(to_double(mesh.positions[vertex]));
  std::vector<std::pair<double, VertexPair>> pairs;
  NearPoints(std::move(places), tolerance).for_each_pair([&](std::uint32_t i, std::uint32_t j) {
    pairs.push_back({distance(mesh, ends[i], ends[j]), {ends[i], ends[j]}});
  });
  std::sort(pairs.begin(), pairs.end());
  std::vector<VertexPair> nearest_first;
  nearest_first.reserve(pairs.size());
  for (const auto& [apart, pair] : pairs) nearest_first.push_back(pair);
  return nearest_first;
}

// With these joined too, and slits filled.
struct Closed {
  Mesh mesh;
  JoinedVertices joined;
  FilledSlits slits;
};

Closed join_and_fill(JoinedVertices joined, const std::vector<VertexPair>& pairs, double tolerance) {
  for (const auto& [a, b] : pairs)
    if (joined.can_join(a, b)) joined.join(a, b);
  Closed closed{joined.joined(), std::move(joined), {}};
  closed.slits = fill_slits(closed.mesh, tolerance);
  return closed;
}

// The same with those pairs only that leave no open edge at their vertices.
Closed close_completely(const JoinedVertices& joined, std::vector<VertexPair> pairs, double tolerance) {
  for (;;) {
    Closed closed = join_and_fill(joined, pairs, tolerance);
    const std::vector<std::uint32_t> still_open = ends_of(open_edges(closed.mesh, EdgeUses(closed.mesh)));
    const std::size_t removed = std::erase_if(pairs, [&](const VertexPair& pair) {
      return std::binary_search(still_open.begin(), still_open.end(), closed.joined.place_of(pair.first));
    });
    if (removed == 0) return closed;
  }
}

std::vector<std::string> words_for(std::size_t moved, double farthest, const FilledSlits& slits) {
  std::vector<std::string> notices;
  if (moved > 0)
    notices.push_back(fmt::format("cracks are closed: {} moved, by {:.3g} mm at most",
                                  counted(moved, "vertex is", "vertices are"), farthest));
  if (slits.triangles > 0)
    notices.push_back(fmt::format(
        "cracks along edges that meet others in the middle are closed: by {}, {:.3g} mm wide at most",
        counted(slits.triangles, "triangle", "triangles"), slits.widest));
  return notices;
}

// Joins what faces each other within the tolerance, edges first and then what they leave.
Closed close_within(const Mesh& mesh, const std::vector<OpenEdge>& open, double tolerance) {
  JoinedVertices joined(mesh, tolerance);
  join_facing_edges(mesh, open, tolerance, joined);
  return close_completely(joined, near_ends(joined.joined(), tolerance), tolerance);
}

// Those of the rims, of at least this size, that have no open edge left.
std::vector<BoundaryChain> closed_rims(const Mesh& mesh, const std::vector<BoundaryChain>& rims, double size,
                                       Closed& closed) {
  const std::vector<std::uint32_t> still_open = ends_of(open_edges(closed.mesh, EdgeUses(closed.mesh)));
  std::vector<BoundaryChain> found;
  for (const BoundaryChain& rim : rims) {
    const bool is_closed = std::ranges::none_of(rim.vertices, [&](std::uint32_t vertex) {
      return std::ranges::binary_search(still_open, closed.joined.place_of(vertex));
    });
    if (is_closed && describe_loop(mesh, rim).diameter >= size) found.push_back(rim);
  }
  return found;
}

BoundaryLoop largest_of(const Mesh& mesh, const std::vector<BoundaryChain>& rims) {
  BoundaryLoop largest;
  for (const BoundaryChain& rim : rims) {
    const BoundaryLoop loop = describe_loop(mesh, rim);
    if (loop.diameter > largest.diameter) largest = loop;
  }
  return largest;
}

double widest_of(const std::vector<BoundaryChain>& rims, Closed& closed) {
  double width = closed.slits.widest;
  for (const BoundaryChain& rim : rims)
    for (const std::uint32_t vertex : rim.vertices) width = std::max(width, closed.joined.reach_of(vertex));
  return width;
}

}  // namespace

Repaired close_cracks(Mesh mesh, double tolerance) {
  const std::vector<OpenEdge> open = open_edges(mesh, EdgeUses(mesh));
  if (open.empty() || !(tolerance > 0)) return {std::move(mesh), {}};
  Closed closed = close_within(mesh, open, tolerance);
  std::size_t moved = 0;
  double farthest = 0;
  for (std::uint32_t vertex = 0; vertex < mesh.positions.size(); ++vertex) {
    const std::uint32_t place = closed.joined.place_of(vertex);
    if (place == vertex) continue;
    ++moved;
    farthest = std::max(farthest, distance(mesh, vertex, place));
  }
  if (moved == 0 && closed.slits.triangles == 0) return {std::move(mesh), {}};
  return {submesh(closed.mesh, closed.mesh.triangles), words_for(moved, farthest, closed.slits)};
}

std::optional<Crack> find_crack(const Mesh& mesh) {
  // Of each size of rims, those are looked at that are so many times as large as what is joined.
  constexpr double kSizes = 50, kLargestShare = 0.1, kWider = 1.5;
  constexpr int kSteps = 4;
  const EdgeUses uses(mesh);
  const std::vector<OpenEdge> open = open_edges(mesh, uses);
  const std::vector<BoundaryChain> rims = chain_boundary(mesh, uses);
  double size = kLargestShare * diagonal_of(bounding_box(mesh));
  for (int step = 0; step < kSteps && !open.empty(); ++step, size /= 4) {
    Closed closed = close_within(mesh, open, size / kSizes);
    const std::vector<BoundaryChain> cracks = closed_rims(mesh, rims, size, closed);
    if (cracks.empty()) continue;
    Crack crack{largest_of(mesh, cracks), widest_of(cracks, closed), size / kSizes};
    // Joining is greedy: what is little wider than the crack need not do.
    for (double weld = 2 * crack.width; weld > 0 && weld < size / kSizes; weld *= kWider) {
      Closed tried = close_within(mesh, open, weld);
      if (closed_rims(mesh, cracks, size, tried).size() != cracks.size()) continue;
      crack.weld = weld;
      break;
    }
    return crack;
  }
  return std::nullopt;
}

}  // namespace aerate
