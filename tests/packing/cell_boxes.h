#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <gtest/gtest.h>
#include <utility>
#include <vector>

#include "core/segment_distance.h"
#include "packing/cells/cell_drainage.h"
#include "tests/support/shapes.h"

// Boxes as cells of a block, and how these drain.

namespace aerate::test {

inline constexpr double kWall = 2, kGap = 1, kSpacing = 0.5;
inline const NodeLattice kLattice{{0.25, 0.25, 0.25}, kSpacing};

struct Box {
  Vec3d lower, upper;
  bool holds(Vec3d p) const {
    return p.x > lower.x && p.y > lower.y && p.z > lower.z && p.x < upper.x && p.y < upper.y && p.z < upper.z;
  }
};

inline std::vector<NodeRun> runs_where(const Box& within, const std::function<bool(Vec3d)>& is_inside) {
  const auto index = [](double x) { return static_cast<std::int32_t>(std::floor(x / kSpacing)); };
  std::vector<NodeRun> runs;
  for (std::int32_t z = index(within.lower.z); z <= index(within.upper.z); ++z) {
    for (std::int32_t y = index(within.lower.y); y <= index(within.upper.y); ++y) {
      for (std::int32_t x = index(within.lower.x); x <= index(within.upper.x); ++x) {
        if (!is_inside(kLattice.at(x, y, z))) continue;
        const bool goes_on =
            !runs.empty() && runs.back().z == z && runs.back().y == y && runs.back().last == x - 1;
        if (goes_on)
          runs.back().last = x;
        else
          runs.push_back({x, x, y, z});
      }
    }
  }
  return runs;
}

// A void that is a box.
inline CellVoid box_void(std::uint32_t cell, const Box& box) {
  CellVoid result;
  result.cell = cell;
  result.surface = turned_inside_out(make_box(to_float(box.lower), to_float(box.upper)));
  result.planned_volume = -signed_volume(result.surface);
  result.nodes = runs_where(box, [&](Vec3d p) { return box.holds(p); });
  return result;
}

// Boxes in a row along x, a gap apart: each is a cell.
inline CellVoids row_of(const std::vector<Box>& boxes) {
  CellVoids cells;
  cells.lattice = kLattice;
  cells.ball_radius = 1.5;
  cells.planes.first.push_back(0);
  for (std::uint32_t i = 0; i < boxes.size(); ++i) {
    if (i > 0) cells.planes.planes.push_back({{-1, 0, 0}, -boxes[i].lower.x, i - 1});
    if (i + 1 < boxes.size()) cells.planes.planes.push_back({{1, 0, 0}, boxes[i].upper.x, i + 1});
    cells.planes.first.push_back(static_cast<std::uint32_t>(cells.planes.planes.size()));
    cells.planes.boxes.push_back({boxes[i].lower, boxes[i].upper});
    cells.voids.push_back(box_void(i, boxes[i]));
  }
  return cells;
}

inline std::vector<Box> equal_boxes(int count, double width) {
  std::vector<Box> boxes;
  for (int i = 0; i < count; ++i) {
    const double from = kWall + i * (width + kGap);
    boxes.push_back({{from, kWall, kWall}, {from + width, kWall + 20, kWall + 20}});
  }
  return boxes;
}

inline Mesh block_round(const std::vector<Box>& boxes) {
  Box all = boxes.front();
  for (const Box& box : boxes) all = {min_of(all.lower, box.lower), max_of(all.upper, box.upper)};
  const Vec3d wall{kWall, kWall, kWall};
  return make_box(to_float(all.lower - wall), to_float(all.upper + wall));
}

inline DrainageRequest request_of(std::vector<Vec3d> holes = {}) {
  return {.channel_radius = 1.5, .hole_radius = 1.5, .escape_holes = std::move(holes)};
}

inline PackingLimits limits_of(Vec3d up = {0, 0, 1}) {
  PackingLimits limits{.wall = kWall, .gap = kGap};
  limits.roof.up = up;
  return limits;
}

inline const CanOpenCell kAlways = [](const Tube&, std::uint32_t) { return true; };

inline PlannedCellDrainage plan(const Mesh& model, const CellVoids& cells,
                                const DrainageRequest& request = request_of(),
                                const PackingLimits& limits = limits_of(),
                                const CanOpenCell& can_open = kAlways) {
  const SurfaceIndex surface(model);
  Monitor monitor;
  return plan_cell_drainage(
      {surface, surface.winding()}, cells, limits, request, can_open, [](const Tube&) { return true; },
      monitor);
}

inline double distance_to(const Mesh& mesh, const Segment& segment) {
  double nearest = 1e300;
  for (const Triangle& t : mesh.triangles)
    nearest = std::min(nearest, distance_to_facet(segment, facet_of(mesh, t)));
  return nearest;
}

// Every hole begins in its void and ends on the surface; at its side all but the last bit keeps the wall, and
// it keeps the gap from other voids.
inline void expect_sound(const Mesh& model, const CellVoids& cells, const PlannedCellDrainage& planned,
                         const std::vector<Box>& boxes) {
  for (const EscapeHole& hole : planned.plan.holes) {
    const std::uint32_t from = planned.kept.at(hole.from);
    EXPECT_TRUE(boxes.at(from).holds(hole.tube.start));
    EXPECT_NEAR(distance_to(model, {hole.tube.end, hole.tube.end}), 0, 1e-4);
    for (std::uint32_t i = 0; i < cells.voids.size(); ++i) {
      if (i == from) continue;
      EXPECT_GE(distance_to(cells.voids[i].surface, {hole.tube.start, hole.tube.end}),
                hole.tube.radius + kGap - 1e-6);
    }
    // Each point of the axis is farther from the surface than half its way to the end, or keeps the wall.
    for (int k = 0; k < 20; ++k) {
      const Vec3d p = hole.tube.start + (hole.tube.end - hole.tube.start) * (k / 20.0);
      const double needed = std::min(hole.tube.radius + kWall, 0.5 * length(hole.tube.end - p));
      EXPECT_GE(distance_to(model, {p, p}), needed - 0.03);
    }
  }
  for (std::size_t i = 0; i < planned.plan.holes.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      const Tube &a = planned.plan.holes[i].tube, &b = planned.plan.holes[j].tube;
      EXPECT_GE(distance_between({a.start, a.end}, {b.start, b.end}), a.radius + b.radius + 0.5);
    }
  }
}

}  // namespace aerate::test
