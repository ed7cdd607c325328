#include "mesh/topology.h"

#include <algorithm>
#include <atomic>
#include <limits>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_scan.h>

#include "core/disjoint_sets.h"
#include "kernels/constants.h"

namespace aerate {
namespace {

constexpr std::size_t kGrain = 4096;

template <typename F>
void for_each_index(std::size_t count, const F& f) {
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, count, kGrain),
                    [&](const tbb::blocked_range<std::size_t>& range) {
                      for (std::size_t i = range.begin(); i != range.end(); ++i) f(i);
                    });
}

// f(lower vertex, higher vertex, half edge) for the edges of a triangle between two different vertices.
template <typename F>
void for_each_side(const Triangle& triangle, std::size_t number, const F& f) {
  for (std::size_t corner = 0; corner < 3; ++corner) {
    const std::uint32_t from = triangle[corner];
    const std::uint32_t to = triangle[(corner + 1) % 3];
    if (from == to) continue;
    f(std::min(from, to), std::max(from, to), static_cast<std::uint32_t>(3 * number + corner));
  }
}

bool comes_before(const EdgeUse& a, const EdgeUse& b) {
  return a.high != b.high ? a.high < b.high : a.half_edge < b.half_edge;
}

}  // namespace

// The difference of two fp32 coordinates is exact in fp64 unless they are apart by 2^29 or more, and so is
// the product of two such differences: the cross product is zero for collinear corners only.
bool has_no_area(const Mesh& mesh, const Triangle& triangle) {
  const Vec3d a = to_double(mesh.positions[triangle[0]]);
  const Vec3d b = to_double(mesh.positions[triangle[1]]);
  const Vec3d c = to_double(mesh.positions[triangle[2]]);
  return cross(b - a, c - a) == Vec3d{0, 0, 0};
}

EdgeUses::EdgeUses(const Mesh& mesh) {
  const std::size_t rows = mesh.positions.size();
  const std::size_t triangles = mesh.triangles.size();
  std::vector<std::uint32_t> counts(rows, 0);
  for_each_index(triangles, [&](std::size_t t) {
    for_each_side(mesh.triangles[t], t, [&](std::uint32_t low, std::uint32_t, std::uint32_t) {
      std::atomic_ref<std::uint32_t>(counts[low]).fetch_add(1, std::memory_order_relaxed);
    });
  });

  offsets_.resize(rows + 1);
  offsets_[rows] = tbb::parallel_scan(
      tbb::blocked_range<std::size_t>(0, rows, kGrain), std::uint64_t{0},
      [&](const tbb::blocked_range<std::size_t>& range, std::uint64_t sum, bool is_final) {
        for (std::size_t i = range.begin(); i != range.end(); ++i) {
          if (is_final) offsets_[i] = sum;
          sum += counts[i];
        }
        return sum;
      },
      std::plus<std::uint64_t>());

  // Rows are filled from their end in whatever order, and then sorted.
  uses_.resize(offsets_[rows]);
  for_each_index(triangles, [&](std::size_t t) {
    for_each_side(mesh.triangles[t], t, [&](std::uint32_t low, std::uint32_t high, std::uint32_t half_edge) {
      const std::uint32_t left =
          std::atomic_ref<std::uint32_t>(counts[low]).fetch_sub(1, std::memory_order_relaxed);
      uses_[offsets_[low] + left - 1] = {high, half_edge};
    });
  });
  for_each_index(rows, [&](std::size_t low) {
    std::sort(uses_.begin() + static_cast<std::ptrdiff_t>(offsets_[low]),
              uses_.begin() + static_cast<std::ptrdiff_t>(offsets_[low + 1]), comes_before);
  });
}

EdgeBalance balance_of(const Mesh& mesh, std::uint32_t low, std::span<const EdgeUse> uses) {
  EdgeBalance balance;
  for (const EdgeUse& use : uses) {
    const Triangle& triangle = mesh.triangles[use.triangle()];
    if (has_repeated_vertex(triangle)) continue;
    if (triangle[use.half_edge % 3] == low) {
      ++balance.forward;
    } else {
      ++balance.backward;
    }
  }
  return balance;
}

ShellLabels label_shells(const Mesh& mesh, const EdgeUses& uses) {
  const std::size_t triangles = mesh.triangles.size();
  DisjointSets sets(triangles);
  for (std::size_t low = 0; low < uses.row_count(); ++low) {
    const std::span<const EdgeUse> row = uses.row(low);
    for (std::size_t i = 1; i < row.size(); ++i) {
      if (row[i].high == row[i - 1].high) sets.join(row[i - 1].triangle(), row[i].triangle());
    }
  }

  // A set gets its label when its first proper triangle turns up; one without any keeps none.
  ShellLabels labels;
  labels.of_triangle.assign(triangles, kNone);
  std::vector<std::uint32_t> label_of_root(triangles, kNone);
  for (std::size_t t = 0; t < triangles; ++t) {
    std::uint32_t& label = label_of_root[sets.root(static_cast<std::uint32_t>(t))];
    if (label == kNone && !has_repeated_vertex(mesh.triangles[t])) {
      label = static_cast<std::uint32_t>(labels.count++);
    }
  }
  for (std::size_t t = 0; t < triangles; ++t) {
    labels.of_triangle[t] = label_of_root[sets.root(static_cast<std::uint32_t>(t))];
  }
  return labels;
}

std::vector<Shell> describe_shells(const Mesh& mesh, const ShellLabels& labels) {
  constexpr float kFar = std::numeric_limits<float>::infinity();
  std::vector<Shell> shells(labels.count);
  for (Shell& shell : shells) shell.box = {{kFar, kFar, kFar}, {-kFar, -kFar, -kFar}};
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    if (labels.of_triangle[t] == kNone) continue;
    Shell& shell = shells[labels.of_triangle[t]];
    ++shell.triangle_count;
    for (const std::uint32_t vertex : mesh.triangles[t]) {
      shell.box.lower = min_of(shell.box.lower, mesh.positions[vertex]);
      shell.box.upper = max_of(shell.box.upper, mesh.positions[vertex]);
    }
  }

  // Tetrahedra from the centre of the shell's own box: a small shell far from the origin keeps its digits.
  std::vector<Vec3d> centres(shells.size());
  for (std::size_t i = 0; i < shells.size(); ++i) {
    centres[i] = (to_double(shells[i].box.lower) + to_double(shells[i].box.upper)) * 0.5;
  }
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const std::uint32_t label = labels.of_triangle[t];
    if (label == kNone) continue;
    const Triangle& triangle = mesh.triangles[t];
    const Vec3d a = to_double(mesh.positions[triangle[0]]) - centres[label];
    const Vec3d b = to_double(mesh.positions[triangle[1]]) - centres[label];
    const Vec3d c = to_double(mesh.positions[triangle[2]]) - centres[label];
    shells[label].volume += dot(a, cross(b, c)) / 6.0;
  }

  return shells;
}

void find_open_shells(const Mesh& mesh, const EdgeUses& uses, const ShellLabels& labels,
                      std::vector<Shell>& shells) {
  for (std::size_t row = 0; row < uses.row_count(); ++row) {
    uses.for_each_edge(row, [&](std::uint32_t low, std::uint32_t, std::span<const EdgeUse> edge) {
      const EdgeBalance balance = balance_of(mesh, low, edge);
      if (balance.forward != balance.backward)
        shells[labels.of_triangle[edge.front().triangle()]].closed = false;
    });
  }
}

}  // namespace aerate
