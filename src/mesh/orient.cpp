#include <algorithm>
#include <cstdint>
#include <fmt/format.h>
#include <utility>
#include <vector>

#include "core/listed.h"
#include "kernels/constants.h"
#include "kernels/winding.h"
#include "mesh/repair.h"
#include "mesh/topology.h"

namespace aerate {
namespace {

void turn(Triangle& triangle) {
  std::swap(triangle[1], triangle[2]);
}

// Highest vertex of each shell (of equal ones the first): what lies above it belongs to other shells.
std::vector<Vec3d> top_vertices(const Mesh& mesh, const ShellLabels& labels) {
  std::vector<std::uint32_t> top(labels.count, kNone);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    if (labels.of_triangle[t] == kNone) continue;
    std::uint32_t& best = top[labels.of_triangle[t]];
    for (const std::uint32_t vertex : mesh.triangles[t]) {
      if (best == kNone || mesh.positions[vertex].z > mesh.positions[best].z ||
          (mesh.positions[vertex].z == mesh.positions[best].z && vertex < best)) {
        best = vertex;
      }
    }
  }
  std::vector<Vec3d> points;
  points.reserve(top.size());
  for (const std::uint32_t vertex : top) points.push_back(to_double(mesh.positions[vertex]));
  return points;
}

// Winding number, at the top of each closed shell, of the other closed shells together.
std::vector<int> windings_of_others(const Mesh& mesh, const ShellLabels& labels,
                                    const std::vector<Shell>& shells) {
  const kernels::HostWinding host(mesh.positions, mesh.triangles);
  const kernels::WindingView& winding = host.view();
  const std::vector<Vec3d> tops = top_vertices(mesh, labels);
  std::vector<int> windings(shells.size(), 0);
  for (std::uint32_t shell = 0; shell < shells.size(); ++shell) {
    const Vec3d p = tops[shell];
    winding.for_each_near(p.x, p.y, [&](std::uint32_t facet) {
      const std::uint32_t other = labels.of_triangle[facet];
      if (other == kNone || other == shell || !shells[other].closed) return;
      windings[shell] += kernels::winding_detail::facet_crossing(winding.facets[facet], p);
    });
  }
  return windings;
}

// A shell makes sense as it is if the winding number is 0 or 1 on both of its sides; it is inside out if that
// holds once all numbers change their sign. An outward shell on its own goes from 0 to 1, a cavity from 1 to
// 0; an inside-out one from 0 to -1, and a cavity of an inside-out model from -1 to 0.
bool is_inside_out(int winding_outside, double volume) {
  return (winding_outside == 0 && volume < 0) || (winding_outside == -1 && volume > 0);
}

// The triangles at the other side of each edge that has two.
class Neighbours {
 public:
  Neighbours(const Mesh& mesh, const EdgeUses& uses) : opposite_(3 * mesh.triangles.size()) {
    for (std::size_t row = 0; row < uses.row_count(); ++row) {
      uses.for_each_edge(row, [&](std::uint32_t low, std::uint32_t, std::span<const EdgeUse> edge) {
        const EdgeBalance balance = balance_of(mesh, low, edge);
        if (balance.count() != 2) return;
        const auto is_proper = [&](const EdgeUse& use) {
          return !has_repeated_vertex(mesh.triangles[use.triangle()]);
        };
        const auto first = std::find_if(edge.begin(), edge.end(), is_proper);
        const auto second = std::find_if(first + 1, edge.end(), is_proper);
        const bool agree = balance.forward == 1;
        opposite_[first->half_edge] = {second->triangle(), agree};
        opposite_[second->half_edge] = {first->triangle(), agree};
      });
    }
  }

  struct Side {
    std::uint32_t triangle = kNone;
    bool agrees = true;  // about the orientation
  };

  const Side& across(std::uint32_t triangle, std::uint32_t corner) const {
    return opposite_[3 * triangle + corner];
  }

 private:
  std::vector<Side> opposite_;
};

// For each triangle whether it has to be turned so that those with a common edge of two agree: found by
// flooding. The lesser part of each flooded patch is turned.
std::vector<bool> triangles_to_turn(const Mesh& mesh, const Neighbours& neighbours) {
  const std::size_t count = mesh.triangles.size();
  std::vector<bool> reached(count, false), turned(count, false);
  std::vector<std::uint32_t> patch;
  for (std::uint32_t seed = 0; seed < count; ++seed) {
    if (reached[seed]) continue;
    patch.assign(1, seed);
    reached[seed] = true;
    std::size_t turned_count = 0;
    for (std::size_t next = 0; next < patch.size(); ++next) {
      const std::uint32_t triangle = patch[next];
      for (std::uint32_t corner = 0; corner < 3; ++corner) {
        const Neighbours::Side& side = neighbours.across(triangle, corner);
        if (side.triangle == kNone || reached[side.triangle]) continue;
        reached[side.triangle] = true;
        turned[side.triangle] = side.agrees == turned[triangle];
        turned_count += turned[side.triangle] ? 1u : 0u;
        patch.push_back(side.triangle);
      }
    }
    if (2 * turned_count > patch.size()) {
      for (const std::uint32_t triangle : patch) turned[triangle] = !turned[triangle];
    }
  }
  return turned;
}

// Misoriented edges by shell.
std::vector<std::size_t> count_misoriented(const Mesh& mesh, const EdgeUses& uses,
                                           const ShellLabels& labels) {
  std::vector<std::size_t> counts(labels.count, 0);
  for (std::size_t row = 0; row < uses.row_count(); ++row) {
    uses.for_each_edge(row, [&](std::uint32_t low, std::uint32_t, std::span<const EdgeUse> edge) {
      if (balance_of(mesh, low, edge).is_misoriented()) ++counts[labels.of_triangle[edge.front().triangle()]];
    });
  }
  return counts;
}

}  // namespace

Repaired orient_consistently(Mesh mesh) {
  const EdgeUses uses(mesh);
  const ShellLabels labels = label_shells(mesh, uses);
  const std::vector<std::size_t> before = count_misoriented(mesh, uses, labels);
  if (std::all_of(before.begin(), before.end(), [](std::size_t count) { return count == 0; })) {
    return {std::move(mesh), {}};
  }

  const std::vector<bool> turned = triangles_to_turn(mesh, Neighbours(mesh, uses));
  Mesh candidate = mesh;
  for (std::size_t t = 0; t < turned.size(); ++t) {
    if (turned[t]) turn(candidate.triangles[t]);
  }
  // Half edges of a turned triangle run the other way, but along the same edges.
  const std::vector<std::size_t> after = count_misoriented(candidate, EdgeUses(candidate), labels);

  std::size_t turned_count = 0, turned_shells = 0, left = 0;
  for (std::size_t shell = 0; shell < labels.count; ++shell) {
    turned_shells += before[shell] > 0 && after[shell] == 0 ? 1u : 0u;
    left += after[shell] > 0 ? before[shell] : 0;
  }
  for (std::size_t t = 0; t < turned.size(); ++t) {
    const std::uint32_t shell = labels.of_triangle[t];
    if (shell == kNone || before[shell] == 0 || after[shell] > 0 || !turned[t]) continue;
    turn(mesh.triangles[t]);
    ++turned_count;
  }
  Repaired repaired{std::move(mesh), {}};
  if (turned_count > 0) {
    repaired.notices.push_back(fmt::format("{} of {} turned to agree with {}",
                                           counted(turned_count, "triangle", "triangles"),
                                           counted(turned_shells, "shell", "shells"),
                                           turned_count == 1 ? "its neighbours" : "their neighbours"));
  }
  if (left > 0) {
    repaired.notices.push_back(
        fmt::format("triangles disagree about inside and outside at {}, and cannot be made to agree",
                    counted(left, "edge", "edges")));
  }
  return repaired;
}

Repaired orient_outward(Mesh mesh) {
  const EdgeUses uses(mesh);
  const ShellLabels labels = label_shells(mesh, uses);
  std::vector<Shell> shells = describe_shells(mesh, labels);
  if (std::none_of(shells.begin(), shells.end(), [](const Shell& shell) { return shell.volume < 0; })) {
    return {std::move(mesh), {}};
  }
  find_open_shells(mesh, uses, labels, shells);
  const std::vector<int> outside =
      shells.size() == 1 ? std::vector<int>{0} : windings_of_others(mesh, labels, shells);

  std::size_t turned = 0;
  std::vector<bool> inside_out(shells.size());
  for (std::size_t i = 0; i < shells.size(); ++i) {
    inside_out[i] = shells[i].closed && is_inside_out(outside[i], shells[i].volume);
    turned += inside_out[i] ? 1u : 0u;
  }
  if (turned == 0) return {std::move(mesh), {}};
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const std::uint32_t label = labels.of_triangle[t];
    if (label != kNone && inside_out[label]) turn(mesh.triangles[t]);
  }
  std::string notice = turned == shells.size()
                           ? std::string("the model was inside out and has been turned")
                           : fmt::format("{} of {} shells {} been turned", turned, shells.size(),
                                         turned == 1 ? "was inside out and has" : "were inside out and have");
  return {std::move(mesh), {std::move(notice)}};
}

}  // namespace aerate
