#include "packing/cells/cell_windows.h"

#include <algorithm>
#include <cmath>
#include <tbb/parallel_for.h>
#include <utility>

#include "packing/cells/cell_drainage_faces.h"
#include "packing/placed_tubes.h"

namespace aerate {
namespace {

// Places that are looked at in a face are so many to a radius.
constexpr double kPlacesPerRadius = 6;

// The sine of the angle from the horizontal below which a face counts as level.
constexpr double kLevel = 0.05;

struct Pair {
  std::uint32_t from, to;
  CellPlane of_from, of_to;
};

std::vector<Pair> neighbouring(const CellVoids& cells) {
  std::vector<std::vector<std::uint32_t>> voids_of(cells.planes.size());
  for (std::uint32_t i = 0; i < cells.voids.size(); ++i) voids_of[cells.voids[i].cell].push_back(i);
  std::vector<Pair> pairs;
  for (std::uint32_t i = 0; i < cells.voids.size(); ++i) {
    const std::uint32_t cell = cells.voids[i].cell;
    for (const CellPlane& plane : cells.planes.of(cell)) {
      if (plane.neighbour >= cells.planes.size()) continue;
      const auto back = cells.planes.of(plane.neighbour);
      const auto opposite = std::find_if(back.begin(), back.end(),
                                         [&](const CellPlane& other) { return other.neighbour == cell; });
      if (opposite == back.end()) continue;
      for (const std::uint32_t j : voids_of[plane.neighbour]) {
        if (i < j) pairs.push_back({i, j, plane, *opposite});
      }
    }
  }
  return pairs;
}

class WindowFinder {
 public:
  WindowFinder(const CellVoids& cells, const std::vector<VoidHollows>& hollows, const PackingLimits& limits,
               double radius, const CellSurfaces& surfaces)
      : cells_(cells), hollows_(hollows), limits_(limits), radius_(radius), surfaces_(surfaces) {}

  std::vector<CellWindow> between(const Pair& pair) const {
    const Vec3d normal = pair.of_from.normal;
    const TubeFrame frame = frame_of({{0, 0, 0}, normal, radius_}, limits_.roof.up);
    const FlatFace a = flat_face(cells_.voids[pair.from].surface, pair.of_from, frame);
    const FlatFace b = flat_face(cells_.voids[pair.to].surface, pair.of_to, frame);
    std::vector<CellWindow> windows;
    if (a.triangles.empty() || b.triangles.empty()) return windows;
    const double margin = std::min(kWindowMargin, kOpeningSpacingShare * radius_);
    const DiscPlaces places(a, b, radius_ + margin, radius_ / kPlacesPerRadius);
    const double lean = dot(normal, limits_.roof.up);
    const bool is_level = 1 - lean * lean < kLevel * kLevel;
    for (const Flat at : places.choose(tube_spacing(radius_, radius_), is_level)) {
      CellWindow window = window_at(pair, frame.across * at.x + frame.down * at.y);
      if (is_sound(window)) windows.push_back(std::move(window));
    }
    return windows;
  }

 private:
  // `in_plane`: the place less what of it is along the normal.
  CellWindow window_at(const Pair& pair, Vec3d in_plane) const {
    const Vec3d normal = pair.of_from.normal;
    const Vec3d start = in_plane + normal * pair.of_from.offset;
    const double thickness = -pair.of_to.offset - pair.of_from.offset;
    const Vec3d end = start + normal * thickness;
    const double inset = std::min(kWindowInset, thickness / 4);
    CellWindow window{
        .channel = {pair.from, pair.to, {start - normal * inset, end + normal * inset, radius_}},
        .wall = {start, end},
        .passage = {}};
    for (const std::size_t orientation : {kUpright, kUpsideDown}) {
      const Vec3d up = orientation == kUpright ? limits_.roof.up : -limits_.roof.up;
      const double rise = dot(normal, up);
      const double lowered = radius_ * std::sqrt(std::max(0.0, 1 - rise * rise));
      const double sill = std::max(dot(start, up), dot(end, up)) - lowered;
      window.passage.sill[orientation] = sill;
      const auto mouth = [&](std::uint32_t of, Vec3d face, Vec3d inwards) {
        const double depth = 1.5 * hollows_[of].nodes().lattice.spacing;
        return hollows_[of].hollows_near({face, face + inwards * depth}, radius_, sill, orientation);
      };
      window.passage.mouths[0].hollows[orientation] = mouth(pair.from, start, -normal);
      window.passage.mouths[1].hollows[orientation] = mouth(pair.to, end, normal);
    }
    window.passage.mouths[0].into = pair.from;
    window.passage.mouths[1].into = pair.to;
    return window;
  }

  bool is_sound(const CellWindow& window) const {
    const Tube tube{window.wall.start, window.wall.end, radius_};
    const Vec3d along = tube.end - tube.start;
    for (const Vec3d start : lines_round(tube.start, tube, limits_.roof.up)) {
      if (!surfaces_.model().keeps_wall({start, start + along, 0})) return false;
    }
    return surfaces_.model().keeps_off_kept(window.channel.tube) &&
           surfaces_.keeps_gap(window.channel.tube, window.channel.from, window.channel.to);
  }

  const CellVoids& cells_;
  const std::vector<VoidHollows>& hollows_;
  const PackingLimits& limits_;
  double radius_;
  const CellSurfaces& surfaces_;
};

}  // namespace

std::vector<CellWindow> find_cell_windows(const CellVoids& cells, const std::vector<VoidHollows>& hollows,
                                          const PackingLimits& limits, double radius,
                                          const CellSurfaces& surfaces, Monitor& monitor) {
  const std::vector<Pair> pairs = neighbouring(cells);
  const WindowFinder finder(cells, hollows, limits, radius, surfaces);
  constexpr std::size_t kAtOnce = 64;
  std::vector<std::vector<CellWindow>> found(pairs.size());
  for (std::size_t first = 0; first < pairs.size(); first += kAtOnce) {
    monitor.check_interrupted();
    tbb::parallel_for(first, std::min(first + kAtOnce, pairs.size()),
                      [&](std::size_t i) { found[i] = finder.between(pairs[i]); });
  }
  std::vector<CellWindow> windows;
  for (std::vector<CellWindow>& some : found) {
    for (CellWindow& window : some) windows.push_back(std::move(window));
  }
  return windows;
}

}  // namespace aerate
