#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "core/mesh.h"
#include "kernels/constants.h"
#include "mesh/inspect.h"

// How the triangles of a mesh hang together. Triangles with a repeated vertex run along their edge once in
// each direction, or along none: they neither open nor close anything, and belong to the shell they touch
// along that edge, if there is one.
namespace aerate {

inline bool has_repeated_vertex(const Triangle& t) {
  return t[0] == t[1] || t[1] == t[2] || t[2] == t[0];
}

// Whether its corners are collinear, exactly.
bool has_no_area(const Mesh& mesh, const Triangle& triangle);

inline double diagonal_of(const Box3f& box) {
  return length(to_double(box.upper) - to_double(box.lower));
}

// Whether a closed surface with this volume in its box is flat: what it encloses is rounding, not a solid.
inline bool is_flat(double volume, const Box3f& box) {
  constexpr double kLeastShare = 1e-9;
  const Vec3d size = to_double(box.upper) - to_double(box.lower);
  return !(volume > kLeastShare * size.x * size.y * size.z);
}

// One triangle's use of an edge.
struct EdgeUse {
  std::uint32_t high;       // the edge's higher vertex
  std::uint32_t half_edge;  // 3 * triangle + corner that it starts from

  std::uint32_t triangle() const { return half_edge / 3; }
};

// All uses of all edges between two different vertices, as a CSR over their lower vertex; in a row, the uses
// of one edge follow each other, by triangle. Deterministic. O(m) expected.
class EdgeUses {
 public:
  explicit EdgeUses(const Mesh& mesh);

  // Rows are those of the mesh's vertices.
  std::size_t row_count() const { return offsets_.size() - 1; }
  std::span<const EdgeUse> row(std::size_t low) const {
    return {uses_.data() + offsets_[low], static_cast<std::size_t>(offsets_[low + 1] - offsets_[low])};
  }

  // Calls f(low, high, uses of that edge) for every edge of a row.
  template <typename F>
  void for_each_edge(std::size_t low, const F& f) const {
    const std::span<const EdgeUse> all = row(low);
    for (std::size_t begin = 0; begin < all.size();) {
      std::size_t end = begin + 1;
      while (end < all.size() && all[end].high == all[begin].high) ++end;
      f(static_cast<std::uint32_t>(low), all[begin].high, all.subspan(begin, end - begin));
      begin = end;
    }
  }

 private:
  std::vector<std::uint64_t> offsets_;
  std::vector<EdgeUse> uses_;
};

// How the triangles at an edge run along it; triangles with a repeated vertex are not counted.
struct EdgeBalance {
  std::size_t forward = 0;  // from the lower to the higher vertex
  std::size_t backward = 0;

  std::size_t count() const { return forward + backward; }
  bool is_open() const { return count() == 1; }
  bool is_misoriented() const { return count() > 1 && forward != backward; }
  bool is_non_manifold() const { return count() > 2; }
};
EdgeBalance balance_of(const Mesh& mesh, std::uint32_t low, std::span<const EdgeUse> uses);

// Shells: the edge-connected components of the triangles without a repeated vertex, numbered by their first
// triangle.
struct ShellLabels {
  std::vector<std::uint32_t> of_triangle;  // kNone for a triangle that touches none
  std::size_t count = 0;
};
ShellLabels label_shells(const Mesh& mesh, const EdgeUses& uses);

// The shells' sizes, by label, all taken for closed. Volumes are sums in index order.
std::vector<Shell> describe_shells(const Mesh& mesh, const ShellLabels& labels);

// Sets `closed` to false for shells with an edge that is not run along equally often in both directions.
void find_open_shells(const Mesh& mesh, const EdgeUses& uses, const ShellLabels& labels,
                      std::vector<Shell>& shells);

// An open edge as a patch runs along it: against the triangle that is there.
struct OpenEdge {
  std::uint32_t from, to;
};
std::vector<OpenEdge> open_edges(const Mesh& mesh, const EdgeUses& uses);

// Vertices along the rim of a hole, in the order in which a patch has to run along it.
struct BoundaryChain {
  std::vector<std::uint32_t> vertices;
  bool closed = true;  // false if the rim ends at an edge of another kind
};

// Chains the open edges; a chain visits no vertex twice, so that holes that meet in a vertex are separate
// ones.
std::vector<BoundaryChain> chain_boundary(const Mesh& mesh, const EdgeUses& uses);

BoundaryLoop describe_loop(const Mesh& mesh, const BoundaryChain& chain);

}  // namespace aerate
