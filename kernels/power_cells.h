#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "kernels/cell_grid.h"
#include "kernels/cell_planes.h"
#include "kernels/clipped_polytope.h"
#include "kernels/constants.h"
#include "kernels/paced.h"
#include "kernels/packed_shape.h"
#include "kernels/vec.h"
#include "kernels/view.h"

// The cells of a power diagram of disjoint balls, each with its faces moved in by half the gap, as one
// template over the executor.
//
// With R = radius + gap / 2, the cell of ball i is where |x - c_i|^2 - R_i^2 is no more than for any other
// ball. Its face towards ball j is a plane across the line of centres, (d^2 + R_i^2 - R_j^2) / (2 d) from
// c_i, where d is their distance; moved in by gap / 2 it still leaves the ball inside, since R_i + R_j <= d.
//
// A cell is clipped out of a box, plane by plane, in dual form (a vertex is three planes), after Ray,
// Sokolov, Lefebvre and Levy, "Meshless Voronoi on the GPU", ACM Transactions on Graphics 37 (6), 2018.
// Balls are tried from near to far, until none that is left can reach the farthest vertex. In lattices more
// than three planes meet in a vertex: there the diagram is that of radii which differ by up to 1e-10 of the
// box's diagonal, by a hash of the ball's index, so that both balls at a face agree on it. Faces narrower
// than what that may bring about count as none; the planes that are returned are those of the radii as they
// are.

namespace aerate::kernels {

struct PowerCellsInput {
  std::span<const Ball> balls;  // at least `gap` from each other, mm
  double gap = 0;               // mm
  Box3d box{};                  // holds the centres
  // Called between pieces of work with the share that is done; what it throws ends the job.
  std::function<void(double)> progress = [](double) {};
};

namespace power_cells_detail {

// In diagonals of the box: how much a radius is changed, and the width that a face must have.
inline constexpr double kChange = 1e-10;
inline constexpr double kVanishing = 64 * kChange;

// Between -1 and 1 (the mixing steps of splitmix64).
AERATE_HD inline double hashed(std::uint32_t index, std::uint32_t attempt) {
  std::uint64_t x = (std::uint64_t{attempt} << 32 | index) + 0x9e3779b97f4a7c15u;
  x = (x ^ x >> 30) * 0xbf58476d1ce4e5b9u;
  x = (x ^ x >> 27) * 0x94d049bb133111ebu;
  x ^= x >> 31;
  return static_cast<double>(x >> 11) * 0x1p-52 - 1;
}

// Balls of similar size, in a grid of their own: a large ball is seen from afar, and must not make small ones
// look as far for each other.
struct Level {
  CellGrid grid;
  double above = 0;        // R of all is more than this; of the next level's it is not
  double most_weight = 0;  // a bound of the weights
};
inline constexpr std::size_t kMostLevels = 8;
inline constexpr unsigned kCellBits = 48;  // of a key; the level is above them

// A ball as clipping sees it: with a weight of R^2, where R is changed a little.
struct Site {
  Vec3d centre;
  double weight;
  std::uint32_t ball;
};

struct SiteKeys {
  View<const Ball> balls;
  double half_gap;
  View<const Level> levels;
  View<std::uint64_t> keys;
  View<std::uint32_t> order;

  AERATE_HD void operator()(std::size_t i) const {
    std::size_t level = 0;
    while (!(balls[i].radius + half_gap > levels[level].above)) ++level;
    keys[i] = std::uint64_t{level} << kCellBits | levels[level].grid.index_at(balls[i].centre);
    order[i] = static_cast<std::uint32_t>(i);
  }
};

// How much R is changed at most: next to nothing of itself in any case.
AERATE_HD inline double change_of(double radius, double change) {
  constexpr double kShare = 1e-3;
  return min_of(change, kShare * radius);
}

struct PlaceSites {
  View<const Ball> balls;
  double half_gap;
  double change;  // mm
  std::uint32_t attempt;
  View<const std::uint32_t> order;
  View<Site> sites;

  AERATE_HD void operator()(std::size_t i) const {
    const Ball ball = balls[order[i]];
    const double radius = ball.radius + half_gap;
    const double changed = radius + change_of(radius, change) * hashed(order[i], attempt);
    sites[i] = {ball.centre, changed * changed, order[i]};
  }
};

// Of a face: its extent, by which vanishing ones are told.
struct Extent {
  std::uint32_t start, end;  // vertices far from each other
  double low, high;          // across
};

struct CellOutcome {
  CellState state;
  std::uint32_t planes, vertices;
  std::uint32_t other;
};

// Memory for cells that are worked on at a time.
struct CellSpace {
  std::uint32_t capacity = 0;  // planes of a cell, the box's six and some that are of no more use included
  View<Plane> planes;          // `capacity` of each cell
  View<Vertex> vertices;       // twice as many
  View<std::uint32_t> links;   // `capacity`
  View<Extent> extents;        // `capacity`
  View<std::uint32_t> rings;   // one for each level
  View<CellOutcome> outcomes;  // one
};

// Clips cells. The rings of the grids' cubes round the ball's own are visited in order of how near their
// balls may be.
struct ClipCells {
  View<const std::uint32_t> cells;  // the sites whose cells are wanted
  View<const Site> sites;           // by key
  View<const std::uint64_t> keys;
  View<const Level> levels;
  Box3d box;
  CellSpace space;

  // What lies outside the rings before this one is at least so far away.
  AERATE_HD static double ring_distance(const CellGrid& grid, Vec3d p, std::uint32_t ring) {
    if (ring == 0) return 0;
    // Coordinates are put into cells with some rounding.
    const double slack = 1e-6 * grid.cell_size;
    const Vec3d q = p - grid.origin;
    return min_of(side_distance(q.x, grid.cell_x(p.x), grid.count_x, grid.cell_size, ring),
                  min_of(side_distance(q.y, grid.cell_y(p.y), grid.count_y, grid.cell_size, ring),
                         side_distance(q.z, grid.cell_z(p.z), grid.count_z, grid.cell_size, ring))) -
           slack;
  }
  AERATE_HD static double side_distance(double q, std::uint32_t cell, std::uint32_t count, double size,
                                        std::uint32_t ring) {
    const double above = cell + ring < count ? size * (cell + ring) - q : kInfinity;
    const double below = cell >= ring ? q - size * (cell - ring + 1) : kInfinity;
    return min_of(above, below);
  }

  AERATE_HD std::size_t first_from(std::uint64_t key) const {
    std::size_t first = 0, count = keys.size;
    while (count > 0) {
      const std::size_t half = count / 2;
      if (keys[first + half] < key) {
        first += half + 1;
        count -= half + 1;
      } else {
        count = half;
      }
    }
    return first;
  }

  AERATE_HD CellState cut_by(Polytope& polytope, const Site& own, std::uint32_t j) const {
    const Site site = sites[j];
    if (site.ball == own.ball) return CellState::done;
    const Vec3d way = site.centre - own.centre;
    const double distance_squared = length_squared(way);
    const double ahead = distance_squared + own.weight - site.weight;
    if (!(ahead > 0)) return CellState::overlaps;
    // The offset ahead / (2 distance) beyond the farthest vertex.
    if (ahead * ahead >= 4 * distance_squared * polytope.reach_squared) return CellState::done;
    const double inverse = 1 / std::sqrt(distance_squared);
    return polytope.cut({way * inverse, 0.5 * ahead * inverse, j});
  }

  AERATE_HD CellState cut_by_ring(Polytope& polytope, const Site& own, std::size_t level, std::uint32_t ring,
                                  std::uint32_t& other) const {
    const CellGrid& grid = levels[level].grid;
    const std::uint32_t x = grid.cell_x(own.centre.x), y = grid.cell_y(own.centre.y),
                        z = grid.cell_z(own.centre.z);
    const std::uint32_t y0 = y - min_of(y, ring), y1 = min_of(y + ring, grid.count_y - 1);
    const std::uint32_t z0 = z - min_of(z, ring), z1 = min_of(z + ring, grid.count_z - 1);
    for (std::uint32_t v = z0; v <= z1; ++v) {
      for (std::uint32_t u = y0; u <= y1; ++u) {
        // Of rows at the ring's sides all cells; of those between the two at the ends.
        const bool whole = v + ring == z || v == z + ring || u + ring == y || u == y + ring;
        for (std::uint32_t end = 0; end < (whole ? 1 : 2); ++end) {
          std::uint32_t x0 = x - min_of(x, ring), x1 = min_of(x + ring, grid.count_x - 1);
          if (!whole) {
            if (end == 0 ? x < ring : x + ring >= grid.count_x) continue;
            x0 = x1 = end == 0 ? x - ring : x + ring;
          }
          const std::uint64_t row = std::uint64_t{level} << kCellBits;
          const std::uint64_t last = row | grid.index(x1, u, v);
          for (std::size_t j = first_from(row | grid.index(x0, u, v)); j < keys.size && keys[j] <= last;
               ++j) {
            other = static_cast<std::uint32_t>(j);
            const CellState state = cut_by(polytope, own, other);
            if (state != CellState::done) return state;
          }
        }
      }
    }
    return CellState::done;
  }

  AERATE_HD void operator()(std::size_t i) const {
    const Site own = sites[cells[i]];
    const std::size_t capacity = space.capacity;
    Polytope polytope{space.planes.data + i * capacity, space.vertices.data + i * 2 * capacity,
                      space.links.data + i * capacity, space.capacity};
    polytope.start_as({box.lower - own.centre, box.upper - own.centre});
    std::uint32_t* rings = space.rings.data + i * levels.size;
    for (std::size_t level = 0; level < levels.size; ++level) rings[level] = 0;
    CellState state = CellState::done;
    std::uint32_t other = kNone;
    while (state == CellState::done) {
      const double reach = std::sqrt(polytope.reach_squared);
      std::size_t next = levels.size;
      double nearest = kInfinity;
      for (std::size_t level = 0; level < levels.size; ++level) {
        const double distance = ring_distance(levels[level].grid, own.centre, rings[level]);
        // Balls that are farther away cannot cut.
        const double lead = polytope.reach_squared + levels[level].most_weight - own.weight;
        const double most = reach + std::sqrt(max_of(lead, 0.0));
        if (distance < most && distance < nearest) {
          next = level;
          nearest = distance;
        }
      }
      if (next == levels.size) break;
      state = cut_by_ring(polytope, own, next, rings[next]++, other);
    }
    space.outcomes[i] = {state, polytope.plane_count, polytope.vertex_count, other};
  }
};

// Lists the planes of a cell whose faces do not vanish in `links`, by neighbour; and its box.
struct FinishCells {
  View<const std::uint32_t> cells;
  View<const Site> sites;
  double vanishing;  // mm
  Box3d box;
  CellSpace space;
  View<std::uint32_t> counts;
  View<Box3d> boxes;

  AERATE_HD bool has_face(const Plane& plane, const Extent& extent, const Vertex* vertices) const {
    if (plane.site == kNone || extent.start == kNone) return false;
    const double length_of = length(vertices[extent.end].position - vertices[extent.start].position);
    return length_of > vanishing && extent.high - extent.low > vanishing * length_of;
  }

  AERATE_HD void operator()(std::size_t i) const {
    const CellOutcome outcome = space.outcomes[i];
    counts[i] = 0;
    boxes[i] = {box.upper, box.lower};
    if (outcome.state != CellState::done) return;
    const std::size_t capacity = space.capacity;
    const Plane* planes = space.planes.data + i * capacity;
    const Vertex* vertices = space.vertices.data + i * 2 * capacity;
    Extent* extents = space.extents.data + i * capacity;
    for (std::uint32_t p = 0; p < outcome.planes; ++p) extents[p] = {kNone, kNone, 0, 0};
    Vec3d lower = vertices[0].position, upper = lower;
    for (std::uint32_t v = 0; v < outcome.vertices; ++v) {
      const Vec3d position = vertices[v].position;
      lower = min_of(lower, position);
      upper = max_of(upper, position);
      for (std::uint32_t side = 0; side < 3; ++side) {
        Extent& extent = extents[vertices[v].planes[side]];
        if (extent.start == kNone) extent.start = extent.end = v;
        // `high` is the largest distance squared so far.
        const double distance_squared = length_squared(position - vertices[extent.start].position);
        if (distance_squared > extent.high) {
          extent.high = distance_squared;
          extent.end = v;
        }
      }
    }
    for (std::uint32_t p = 0; p < outcome.planes; ++p) extents[p].high = 0;
    for (std::uint32_t v = 0; v < outcome.vertices; ++v) {
      for (std::uint32_t side = 0; side < 3; ++side) {
        const std::uint32_t p = vertices[v].planes[side];
        Extent& extent = extents[p];
        const Vec3d start = vertices[extent.start].position;
        const Vec3d along = vertices[extent.end].position - start;
        const double across = dot(cross(planes[p].normal, along), vertices[v].position - start);
        extent.low = min_of(extent.low, across);
        extent.high = max_of(extent.high, across);
      }
    }
    std::uint32_t* faces = space.links.data + i * capacity;
    std::uint32_t count = 0;
    for (std::uint32_t p = 0; p < outcome.planes; ++p) {
      if (!has_face(planes[p], extents[p], vertices)) continue;
      const std::uint32_t ball = sites[planes[p].site].ball;
      std::uint32_t place = count++;
      for (; place > 0 && sites[planes[faces[place - 1]].site].ball > ball; --place) {
        faces[place] = faces[place - 1];
      }
      faces[place] = p;
    }
    counts[i] = count;
    const Vec3d centre = sites[cells[i]].centre;
    const Vec3d slack{vanishing, vanishing, vanishing};
    boxes[i] = {max_of(box.lower, centre + lower - slack), min_of(box.upper, centre + upper + slack)};
  }
};

struct EmitPlanes {
  View<const std::uint32_t> cells;
  View<const Site> sites;
  View<const Ball> balls;
  double half_gap;
  CellSpace space;
  View<const std::uint32_t> counts, offsets;
  View<CellPlane> planes;

  AERATE_HD void operator()(std::size_t i) const {
    const Ball own = balls[sites[cells[i]].ball];
    const std::size_t first = i * space.capacity;
    for (std::uint32_t k = 0; k < counts[i]; ++k) {
      const std::uint32_t neighbour = sites[space.planes[first + space.links[first + k]].site].ball;
      const Ball ball = balls[neighbour];
      const double distance = length(ball.centre - own.centre);
      const Vec3d normal = (ball.centre - own.centre) * (1 / distance);
      const double sum = own.radius + ball.radius + 2 * half_gap;
      const double ahead = 0.5 * (distance + (own.radius - ball.radius) * sum / distance);
      planes[offsets[i] + k] = {normal, dot(normal, own.centre) + ahead - half_gap, neighbour};
    }
  }
};

// A grid over so many points with about half as many cells, whatever the box's proportions.
inline CellGrid grid_for(const Box3d& box, std::size_t points, double least_cell) {
  const Vec3d size = box.upper - box.lower;
  std::array<double, 3> sides{size.x, size.y, size.z};
  std::sort(sides.begin(), sides.end());
  const double each = 2 / static_cast<double>(points);
  double cell = std::cbrt(sides[0] * sides[1] * sides[2] * each);
  if (cell >= sides[0]) cell = std::sqrt(sides[1] * sides[2] * each);
  if (cell >= sides[1]) cell = sides[2] * each;
  return make_cell_grid(box, max_of(cell, least_cell));
}

inline void check(const PowerCellsInput& input) {
  const auto require = [](bool holds, const std::string& what) {
    if (!holds) throw std::invalid_argument("power cells: " + what);
  };
  const Vec3d size = input.box.upper - input.box.lower;
  require(size.x > 0 && size.y > 0 && size.z > 0 && length_squared(size) < kInfinity,
          "the box is empty or has no end");
  require(input.gap >= 0 && input.gap < kInfinity, "the gap is no length");
  require(input.balls.size() < kNone, "more than 2^32 - 2 balls");
  for (std::size_t i = 0; i < input.balls.size(); ++i) {
    const auto [c, radius] = input.balls[i];
    require(radius > 0 && radius < kInfinity, "ball " + std::to_string(i) + " has no size");
    require(c.x >= input.box.lower.x && c.x <= input.box.upper.x && c.y >= input.box.lower.y &&
                c.y <= input.box.upper.y && c.z >= input.box.lower.z && c.z <= input.box.upper.z,
            "the centre of ball " + std::to_string(i) + " is outside of the box");
  }
}

// By powers of four of R, the largest first; the smallest of all are together.
inline std::vector<Level> levels_of(const PowerCellsInput& input, double change) {
  constexpr double kRatio = 4;
  double most = 0;
  for (const Ball& ball : input.balls) most = max_of(most, ball.radius + input.gap / 2);
  struct Group {
    std::size_t count = 0;
    Box3d box{{kInfinity, kInfinity, kInfinity}, {-kInfinity, -kInfinity, -kInfinity}};
    double most = 0;
  };
  std::array<Group, kMostLevels> groups;
  for (const Ball& ball : input.balls) {
    const double radius = ball.radius + input.gap / 2;
    std::size_t k = 0;
    for (double above = most / kRatio; k + 1 < kMostLevels && !(radius > above); above /= kRatio) ++k;
    Group& group = groups[k];
    ++group.count;
    group.box = {min_of(group.box.lower, ball.centre), max_of(group.box.upper, ball.centre)};
    group.most = max_of(group.most, radius);
  }
  const double least_cell = 1e-6 * length(input.box.upper - input.box.lower);
  std::vector<Level> levels;
  double above = most;
  for (std::size_t k = 0; k < kMostLevels; ++k) {
    above /= kRatio;
    const Group& group = groups[k];
    if (group.count == 0) continue;
    const double largest = group.most + change_of(group.most, change);
    levels.push_back({grid_for(group.box, group.count, least_cell), k + 1 < kMostLevels ? above : 0,
                      largest * largest * (1 + 1e-12)});
  }
  return levels;
}

// What one piece of work brought back.
struct Piece {
  std::vector<std::uint32_t> balls, counts;
  std::vector<CellPlane> planes;
};

inline std::size_t bytes_of_cell(std::uint32_t capacity, std::size_t levels) {
  return capacity * (sizeof(Plane) + 2 * sizeof(Vertex) + sizeof(std::uint32_t) + sizeof(Extent)) +
         levels * sizeof(std::uint32_t) + sizeof(CellOutcome) + sizeof(Box3d) + 2 * sizeof(std::uint32_t) +
         16 * sizeof(CellPlane);
}

// Balls in the executor's memory, and the cells that have been made.
template <typename Executor>
class CellMaker {
 public:
  CellMaker(const Executor& executor, const PowerCellsInput& input)
      : executor_(executor),
        input_(input),
        diagonal_(length(input.box.upper - input.box.lower)),
        balls_(executor.upload(input.balls)),
        boxes_(input.balls.size()) {
    const std::vector<Level> levels = levels_of(input, kChange * diagonal_);
    const std::size_t count = input.balls.size();
    levels_ = executor.upload(std::span<const Level>(levels));
    keys_ = executor.template allocate<std::uint64_t>(count);
    order_ = executor.template allocate<std::uint32_t>(count);
    sites_ = executor.template allocate<Site>(count);
    executor.for_each_index(
        count, SiteKeys{balls_.view(), input.gap / 2, levels_.view(), keys_.view(), order_.view()});
    executor.sort_pairs(keys_.view(), order_.view());
    ball_of_site_ = executor.download(View<const std::uint32_t>(order_.view()));
  }

  CellPlanes make() {
    constexpr std::uint32_t kAttempts = 16;
    std::vector<std::uint32_t> cells(boxes_.size());
    for (std::uint32_t i = 0; i < cells.size(); ++i) cells[i] = i;
    for (std::uint32_t attempt = 0; !cells.empty(); ++attempt) {
      if (attempt == kAttempts) {
        throw std::runtime_error("power cells: the cell of ball " + std::to_string(ball_of_site_[cells[0]]) +
                                 " cannot be told from rounding");
      }
      executor_.for_each_index(boxes_.size(), PlaceSites{balls_.view(), input_.gap / 2, kChange * diagonal_,
                                                         attempt, order_.view(), sites_.view()});
      cells = make_of(std::move(cells));
    }
    return joined();
  }

 private:
  // With as many planes as it takes; returns the cells that came out inconsistent.
  std::vector<std::uint32_t> make_of(std::vector<std::uint32_t> cells) {
    // More than a ball has neighbours as a rule; only what is large amid small has more.
    constexpr std::uint32_t kFirstCapacity = 64, kGrowth = 8;
    std::vector<std::uint32_t> inconsistent;
    for (std::uint32_t capacity = kFirstCapacity; !cells.empty();) {
      std::vector<std::uint32_t> larger;
      const std::size_t at_a_time = cells_at_a_time(capacity);
      for_each_piece(cells.size(), at_a_time, [&](std::size_t first, std::size_t count) {
        make_piece(std::span(cells).subspan(first, count), capacity, larger, inconsistent);
      });
      cells = std::move(larger);
      // A cell cannot have more planes than there are balls, and the box's.
      capacity = static_cast<std::uint32_t>(
          min_of(std::uint64_t{capacity} * kGrowth, std::uint64_t{boxes_.size()} + kFirstCapacity));
    }
    return inconsistent;
  }

  // Not more than keeps the processor busy, and no more than a quarter of the memory.
  std::size_t cells_at_a_time(std::uint32_t capacity) const {
    const std::size_t wanted = Executor::kLeastPiece * 8192;
    const std::size_t bytes = min_of(wanted, executor_.free_bytes() / 4);
    return max_of(min_of(bytes / bytes_of_cell(capacity, levels_.size()), Executor::kLeastPiece / 4),
                  std::size_t{1});
  }

  void make_piece(std::span<const std::uint32_t> sites, std::uint32_t capacity,
                  std::vector<std::uint32_t>& larger, std::vector<std::uint32_t>& inconsistent) {
    const std::size_t count = sites.size(), room = count * capacity;
    const auto cells = executor_.upload(sites);
    reserve(count, capacity);
    CellSpace space;
    space.capacity = capacity;
    space.planes = {planes_.view().data, room};
    space.vertices = {vertices_.view().data, 2 * room};
    space.links = {links_.view().data, room};
    space.extents = {extents_.view().data, room};
    space.rings = rings_.view();
    space.outcomes = {outcomes_.view().data, count};
    const View<std::uint32_t> counts{counts_.view().data, count}, offsets{offsets_.view().data, count};
    const View<Box3d> boxes{cell_boxes_.view().data, count};
    const double half_gap = input_.gap / 2;
    const Vec3d grown{half_gap, half_gap, half_gap};
    // Faces just outside of the box may come into it where they are moved in.
    const Box3d around{input_.box.lower - grown, input_.box.upper + grown};
    executor_.for_each_index(
        count, ClipCells{cells.view(), sites_.view(), keys_.view(), levels_.view(), around, space});
    executor_.for_each_index(count, FinishCells{cells.view(), sites_.view(), kVanishing * diagonal_,
                                                input_.box, space, counts, boxes});
    const std::uint64_t total = executor_.exclusive_scan(View<const std::uint32_t>(counts), offsets);
    auto planes = executor_.template allocate<CellPlane>(total);
    executor_.for_each_index(count, EmitPlanes{cells.view(), sites_.view(), balls_.view(), half_gap, space,
                                               counts, offsets, planes.view()});
    const std::vector<CellOutcome> outcomes = executor_.download(space.outcomes);
    const std::vector<Box3d> piece_boxes = executor_.download(boxes);
    Piece piece{{}, executor_.download(counts), executor_.download(planes.view())};
    for (std::size_t i = 0; i < count; ++i) {
      const std::uint32_t ball = ball_of_site_[sites[i]];
      piece.balls.push_back(ball);
      boxes_[ball] = piece_boxes[i];
      switch (outcomes[i].state) {
        case CellState::done:
          ++done_;
          break;
        case CellState::too_many_planes:
          larger.push_back(sites[i]);
          break;
        case CellState::inconsistent:
          inconsistent.push_back(sites[i]);
          break;
        case CellState::overlaps:
          throw std::invalid_argument("power cells: balls " + std::to_string(ball) + " and " +
                                      std::to_string(ball_of_site_[outcomes[i].other]) + " overlap");
      }
    }
    pieces_.push_back(std::move(piece));
    input_.progress(static_cast<double>(done_) / static_cast<double>(boxes_.size()));
  }

  template <typename T>
  void reserve(typename Executor::template Buffer<T>& buffer, std::size_t size) {
    if (buffer.size() >= size) return;
    buffer = {};
    buffer = executor_.template allocate<T>(size);
  }
  void reserve(std::size_t cells, std::size_t capacity) {
    reserve<Plane>(planes_, cells * capacity);
    reserve<Vertex>(vertices_, 2 * cells * capacity);
    reserve<std::uint32_t>(links_, cells * capacity);
    reserve<Extent>(extents_, cells * capacity);
    reserve<std::uint32_t>(rings_, cells * levels_.size());
    reserve<CellOutcome>(outcomes_, cells);
    reserve<std::uint32_t>(counts_, cells);
    reserve<std::uint32_t>(offsets_, cells);
    reserve<Box3d>(cell_boxes_, cells);
  }

  // By ball.
  CellPlanes joined() {
    CellPlanes cells;
    cells.first.assign(boxes_.size() + 1, 0);
    std::uint64_t total = 0;
    for (const Piece& piece : pieces_) {
      total += piece.planes.size();
      for (std::size_t i = 0; i < piece.balls.size(); ++i) {
        cells.first[piece.balls[i] + std::size_t{1}] += piece.counts[i];
      }
    }
    if (total >= kNone) throw std::length_error("power cells: more than 2^32 - 2 faces");
    for (std::size_t i = 0; i < boxes_.size(); ++i) cells.first[i + 1] += cells.first[i];
    cells.planes.resize(total);
    for (const Piece& piece : pieces_) {
      auto plane = piece.planes.begin();
      for (std::size_t i = 0; i < piece.balls.size(); ++i) {
        if (piece.counts[i] == 0) continue;
        std::copy_n(plane, piece.counts[i], cells.planes.begin() + cells.first[piece.balls[i]]);
        plane += piece.counts[i];
      }
    }
    cells.boxes = std::move(boxes_);
    return cells;
  }

  template <typename T>
  using Buffer = typename Executor::template Buffer<T>;

  const Executor& executor_;
  const PowerCellsInput& input_;
  double diagonal_;  // mm
  Buffer<Ball> balls_;
  Buffer<Level> levels_;
  Buffer<std::uint64_t> keys_;
  Buffer<std::uint32_t> order_;
  Buffer<Site> sites_;
  Buffer<Plane> planes_;
  Buffer<Vertex> vertices_;
  Buffer<std::uint32_t> links_, rings_, counts_, offsets_;
  Buffer<Extent> extents_;
  Buffer<CellOutcome> outcomes_;
  Buffer<Box3d> cell_boxes_;
  std::vector<std::uint32_t> ball_of_site_;
  std::vector<Box3d> boxes_;
  std::vector<Piece> pieces_;
  std::size_t done_ = 0;
};

}  // namespace power_cells_detail

// The cells of balls as planes, in the order of the balls. Planes without a face in the box, or within half
// the gap of it, bound nothing and are left out; so are those with a face narrower than 6.4e-9 of the box's
// diagonal, which lets the cell grow by about as much. O(n) for n balls that are evenly spread, size by
// size; a cell of f faces costs O(f^2), on one thread.
//   balls: with centres in the box, disjoint (up to rounding), mm
//   gap: mm; what is left between a face's two sides
//   box: cuts cells, and is not moved; mm
// Throws std::invalid_argument for sizes that are none, a centre outside of the box, and balls that overlap
// so far that one's centre is not in its own cell; std::length_error for more than 2^32 - 2 faces;
// std::runtime_error where rounding hides what a cell looks like (no case is known); CudaError; and what
// `progress` throws.
template <typename Executor>
CellPlanes power_cells(const Executor& executor, const PowerCellsInput& input) {
  power_cells_detail::check(input);
  if (input.balls.empty()) return {{0}, {}, {}};
  return power_cells_detail::CellMaker<Executor>(executor, input).make();
}

template <typename Executor>
CellPlanes power_cells(const Executor& executor, std::span<const Ball> balls, double gap, const Box3d& box) {
  return power_cells(executor, PowerCellsInput{balls, gap, box});
}

// For kernels/pack_on_cuda.h.
struct PowerCells {
  using Input = PowerCellsInput;
  using Result = CellPlanes;

  template <typename Executor>
  static CellPlanes pack(const Executor& executor, const PowerCellsInput& input) {
    return power_cells(executor, input);
  }
};

}  // namespace aerate::kernels
