#pragma once

#include <cstdint>

#include "kernels/constants.h"
#include "kernels/vec.h"

// The polytope that becomes a cell of a power diagram (power_cells.h): it is clipped plane by plane, in memory that
// is given.

namespace aerate::kernels::power_cells_detail {

// What is clipped, relative to the cell's ball. Vertices name their planes counter-clockwise, seen from
// outside.
struct Plane {
  Vec3d normal;
  double offset;
  std::uint32_t site;  // or kNone: of the box
};
struct Vertex {
  Vec3d position;
  std::uint32_t planes[3];
};
enum class CellState : std::uint32_t {
  done,
  too_many_planes,  // for the memory that was given
  inconsistent,     // rounding made a polytope of what is none
  overlaps,         // another ball, whose site `other` is, so far that the centre is not in its own cell
};

// A convex polytope that holds the origin, while it is clipped.
struct Polytope {
  Plane* planes;
  Vertex* vertices;
  std::uint32_t* links;  // from a plane to the next round a region that is cut off; kNone between cuts
  std::uint32_t capacity;
  std::uint32_t plane_count = 0, vertex_count = 0;
  double reach_squared = 0;  // of the farthest vertex

  AERATE_HD void start_as(const Box3d& box) {
    for (std::uint32_t i = 0; i < capacity; ++i) links[i] = kNone;
    planes[0] = {{1, 0, 0}, box.upper.x, kNone};
    planes[1] = {{-1, 0, 0}, -box.lower.x, kNone};
    planes[2] = {{0, 1, 0}, box.upper.y, kNone};
    planes[3] = {{0, -1, 0}, -box.lower.y, kNone};
    planes[4] = {{0, 0, 1}, box.upper.z, kNone};
    planes[5] = {{0, 0, -1}, -box.lower.z, kNone};
    plane_count = 6;
    for (std::uint32_t corner = 0; corner < 8; ++corner) {
      const std::uint32_t x = corner & 1, y = corner >> 1 & 1, z = corner >> 2;
      const bool mirrored = ((x + y + z) & 1) != 0;
      vertices[corner] = {{x == 0 ? box.upper.x : box.lower.x, y == 0 ? box.upper.y : box.lower.y,
                           z == 0 ? box.upper.z : box.lower.z},
                          {x, mirrored ? 4 + z : 2 + y, mirrored ? 2 + y : 4 + z}};
    }
    vertex_count = 8;
    measure_reach();
  }

  AERATE_HD void measure_reach() {
    reach_squared = 0;
    for (std::uint32_t i = 0; i < vertex_count; ++i) {
      reach_squared = max_of(reach_squared, length_squared(vertices[i].position));
    }
  }

  // Whether one of the vertices from `first` on has these planes one after the other.
  AERATE_HD bool has_edge(std::uint32_t first, std::uint32_t from, std::uint32_t to) const {
    for (std::uint32_t i = first; i < vertex_count; ++i) {
      const std::uint32_t a = vertices[i].planes[0], b = vertices[i].planes[1], c = vertices[i].planes[2];
      if ((a == from && b == to) || (b == from && c == to) || (c == from && a == to)) return true;
    }
    return false;
  }

  // Drops planes without vertices.
  AERATE_HD void drop_planes() {
    for (std::uint32_t i = 0; i < vertex_count; ++i) {
      for (std::uint32_t side = 0; side < 3; ++side) links[vertices[i].planes[side]] = 0;
    }
    std::uint32_t kept = 0;
    for (std::uint32_t p = 0; p < plane_count; ++p) {
      if (links[p] == kNone) continue;
      planes[kept] = planes[p];
      links[p] = kept++;
    }
    for (std::uint32_t i = 0; i < vertex_count; ++i) {
      for (std::uint32_t side = 0; side < 3; ++side) {
        vertices[i].planes[side] = links[vertices[i].planes[side]];
      }
    }
    for (std::uint32_t p = 0; p < plane_count; ++p) links[p] = kNone;
    plane_count = kept;
  }

  // The vertex of three planes; false if they are no corner of a polytope.
  AERATE_HD bool set_vertex(std::uint32_t i, std::uint32_t a, std::uint32_t b, std::uint32_t c) const {
    const Vec3d across = cross(planes[b].normal, planes[c].normal);
    const double volume = dot(planes[a].normal, across);
    if (!(volume > 0)) return false;
    const Vec3d position =
        (across * planes[a].offset + cross(planes[c].normal, planes[a].normal) * planes[b].offset +
         cross(planes[a].normal, planes[b].normal) * planes[c].offset) *
        (1 / volume);
    vertices[i] = {position, {a, b, c}};
    return length_squared(position) < kInfinity;
  }

  // Cuts off what lies beyond a plane.
  AERATE_HD CellState cut(const Plane& plane) {
    std::uint32_t kept = vertex_count;
    for (std::uint32_t i = 0; i < kept;) {
      if (dot(plane.normal, vertices[i].position) > plane.offset) {
        --kept;
        const Vertex beyond = vertices[i];
        vertices[i] = vertices[kept];
        vertices[kept] = beyond;
      } else {
        ++i;
      }
    }
    if (kept == vertex_count) return CellState::done;
    if (kept == 0) return CellState::inconsistent;
    if (plane_count == capacity) {
      drop_planes();
      if (plane_count == capacity) return CellState::too_many_planes;
    }
    // Edges round the vertices that go: those whose other end stays.
    std::uint32_t edges = 0, first = kNone;
    for (std::uint32_t i = kept; i < vertex_count; ++i) {
      for (std::uint32_t side = 0; side < 3; ++side) {
        const std::uint32_t from = vertices[i].planes[side];
        const std::uint32_t to = vertices[i].planes[side == 2 ? 0 : side + 1];
        if (has_edge(kept, to, from)) continue;
        if (links[from] != kNone) return CellState::inconsistent;
        links[from] = to;
        first = from;
        ++edges;
      }
    }
    if (first == kNone || edges > 2 * capacity - kept) return CellState::inconsistent;
    // One round, or what goes is no disc.
    planes[plane_count] = plane;
    vertex_count = kept;
    std::uint32_t at = first;
    do {
      const std::uint32_t to = links[at];
      if (to == kNone || !set_vertex(vertex_count, at, to, plane_count)) return CellState::inconsistent;
      links[at] = kNone;
      ++vertex_count;
      at = to;
    } while (at != first);
    if (vertex_count - kept != edges) return CellState::inconsistent;
    ++plane_count;
    measure_reach();
    return CellState::done;
  }
};

}  // namespace aerate::kernels::power_cells_detail
