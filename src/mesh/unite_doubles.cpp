#include <algorithm>
#include <cmath>
#include <cstdint>
#include <fmt/format.h>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "core/listed.h"
#include "kernels/constants.h"
#include "mesh/repair.h"
#include "mesh/topology.h"

namespace aerate {
namespace {

// Turned so that the lowest vertex comes first: the same for triangles that are the same.
Triangle canonical(Triangle t) {
  std::rotate(t.begin(), std::min_element(t.begin(), t.end()), t.end());
  return t;
}

// The triangles that repeat an earlier one, ascending.
std::vector<std::uint32_t> repeated_triangles(const Mesh& mesh) {
  std::vector<std::pair<Triangle, std::uint32_t>> sorted;
  sorted.reserve(mesh.triangles.size());
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t)
    if (!has_repeated_vertex(mesh.triangles[t])) sorted.emplace_back(canonical(mesh.triangles[t]), t);
  std::sort(sorted.begin(), sorted.end());
  std::vector<std::uint32_t> repeated;
  for (std::size_t i = 1; i < sorted.size(); ++i)
    if (sorted[i].first == sorted[i - 1].first) repeated.push_back(sorted[i].second);
  std::sort(repeated.begin(), repeated.end());
  return repeated;
}

Mesh only(const Mesh& mesh, const std::vector<std::uint32_t>& triangles) {
  Mesh part{mesh.positions, {}};
  part.triangles.reserve(triangles.size());
  for (const std::uint32_t t : triangles) part.triangles.push_back(mesh.triangles[t]);
  return part;
}

Mesh without(const Mesh& mesh, const std::vector<std::uint32_t>& triangles) {
  std::vector<Triangle> rest;
  rest.reserve(mesh.triangles.size() - triangles.size());
  auto next = triangles.begin();
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    if (next != triangles.end() && *next == t) {
      ++next;
    } else {
      rest.push_back(mesh.triangles[t]);
    }
  }
  return submesh(mesh, rest);
}

std::size_t count_unbalanced_edges(const Mesh& mesh) {
  const EdgeUses uses(mesh);
  std::size_t count = 0;
  for (std::size_t row = 0; row < uses.row_count(); ++row) {
    uses.for_each_edge(row, [&](std::uint32_t low, std::uint32_t, std::span<const EdgeUse> edge) {
      const EdgeBalance balance = balance_of(mesh, low, edge);
      count += balance.forward != balance.backward ? 1u : 0u;
    });
  }
  return count;
}

// A fold is none.
bool is_body(const Shell& shell) {
  return shell.closed && !is_flat(std::abs(shell.volume), shell.box);
}

// Of the repeated triangles those that make up closed bodies among themselves.
std::vector<std::uint32_t> closed_bodies(const Mesh& mesh, const std::vector<std::uint32_t>& repeated) {
  const Mesh copies = only(mesh, repeated);
  const EdgeUses uses(copies);
  const ShellLabels labels = label_shells(copies, uses);
  std::vector<Shell> shells = describe_shells(copies, labels);
  find_open_shells(copies, uses, labels, shells);
  std::vector<std::uint32_t> closed;
  for (std::size_t i = 0; i < repeated.size(); ++i)
    if (is_body(shells[labels.of_triangle[i]])) closed.push_back(repeated[i]);
  return closed;
}

}  // namespace

Repaired unite_doubles(Mesh mesh) {
  std::vector<std::string> notices;
  std::vector<std::uint32_t> repeated = repeated_triangles(mesh);
  const std::vector<std::uint32_t> bodies = closed_bodies(mesh, repeated);
  if (!bodies.empty()) {
    notices.push_back(fmt::format("bodies that lie twice in one place are taken once: {} left out",
                                  counted(bodies.size(), "triangle is", "triangles are")));
    mesh = without(mesh, bodies);
    repeated = repeated_triangles(mesh);
  }
  if (repeated.empty()) return {std::move(mesh), std::move(notices)};
  // Single triangles go where that is what their edges lack.
  Mesh single = without(mesh, repeated);
  if (count_unbalanced_edges(single) >= count_unbalanced_edges(mesh))
    return {std::move(mesh), std::move(notices)};
  notices.push_back(
      fmt::format("{} left out", counted(repeated.size(), "doubled triangle is", "doubled triangles are")));
  return {std::move(single), std::move(notices)};
}

}  // namespace aerate
