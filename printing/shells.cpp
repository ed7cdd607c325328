#include "printing/shells.h"

#include <cstdint>
#include <limits>

#include "core/disjoint_sets.h"
#include "kernels/constants.h"

namespace aerate {
namespace {

// The shell of each triangle, numbered by first triangle, and their number.
struct ShellNumbers {
  std::vector<std::uint32_t> of_triangle;
  std::uint32_t count = 0;
};

ShellNumbers number_shells(const Mesh& mesh) {
  DisjointSets sets(mesh.positions.size());
  for (const Triangle& t : mesh.triangles) {
    sets.join(t[0], t[1]);
    sets.join(t[0], t[2]);
  }
  std::vector<std::uint32_t> of_root(mesh.positions.size(), kNone);
  ShellNumbers numbers;
  numbers.of_triangle.reserve(mesh.triangles.size());
  for (const Triangle& t : mesh.triangles) {
    std::uint32_t& number = of_root[sets.root(t[0])];
    if (number == kNone) number = numbers.count++;
    numbers.of_triangle.push_back(number);
  }
  return numbers;
}

}  // namespace

std::vector<Mesh> split_into_shells(const Mesh& mesh) {
  const ShellNumbers numbers = number_shells(mesh);
  std::vector<std::uint32_t> shell_of_vertex(mesh.positions.size(), kNone);
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    for (const std::uint32_t v : mesh.triangles[i]) shell_of_vertex[v] = numbers.of_triangle[i];
  }
  std::vector<Mesh> shells(numbers.count);
  std::vector<std::uint32_t> renumbered(mesh.positions.size());
  for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
    if (shell_of_vertex[v] == kNone) continue;
    std::vector<Vec3f>& positions = shells[shell_of_vertex[v]].positions;
    renumbered[v] = static_cast<std::uint32_t>(positions.size());
    positions.push_back(mesh.positions[v]);
  }
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    const Triangle& t = mesh.triangles[i];
    shells[numbers.of_triangle[i]].triangles.push_back(
        {renumbered[t[0]], renumbered[t[1]], renumbered[t[2]]});
  }
  return shells;
}

std::size_t count_shells(const Mesh& mesh) {
  return number_shells(mesh).count;
}

}  // namespace aerate
