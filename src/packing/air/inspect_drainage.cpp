#include "packing/air/inspect_drainage.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/surface_index.h"
#include "core/upright.h"

namespace aerate {
namespace {

// Columns are so many to the width of the widest hole, unless there would be more nodes than this.
constexpr double kColumnsPerHole = 16;
constexpr double kMostNodes = 4e6;
constexpr double kMostColumns = 2e5;
constexpr double kWider = 1.05;

double spacing_of_nodes(const Box3d& box, double widest_hole) {
  const Vec3d size = box.upper - box.lower;
  const double room = widest_hole + 6 * widest_hole / kColumnsPerHole;
  double spacing = widest_hole / kColumnsPerHole;
  while ((size.x + room) * (size.y + room) * (size.z + room) > kMostNodes * spacing * spacing * spacing)
    spacing *= kWider;
  return spacing;
}

Vec3d from_frame(const UprightFrame& frame, Vec3d p) {
  return frame.x * p.x + frame.y * p.y + frame.z * p.z;
}

void turn_back(FoundHollows& found, const UprightFrame& frame) {
  for (FoundHollow& hollow : found.hollows) hollow.place = from_frame(frame, hollow.place);
  for (FoundHole& hole : found.holes) hole.place = from_frame(frame, hole.place);
  if (found.wall) found.wall->place = from_frame(frame, found.wall->place);
}

void turn_back(std::vector<AirCup>& cups, const UprightFrame& frame) {
  for (AirCup& cup : cups) {
    cup.place = from_frame(frame, cup.place);
    cup.bottom = from_frame(frame, cup.bottom);
  }
}

// Sealed hollows hold all that they hold whichever way they are turned: they are told apart.
std::vector<AirPart> parts_that_open(const AirColumns& columns, const AirFlood& drained,
                                     const FoundHollows& found) {
  std::vector<AirPart> parts = found.parts;
  for (std::size_t i = 0; i < columns.spans.size(); ++i) {
    if (drained.height[i] == kInfinity) parts[i] = {};
  }
  return parts;
}

// What stays outside of hollows where it is as deep as a column is wide.
double left_in_recesses(const AirColumns& columns, const AirFlood& flood, std::size_t orientation,
                        const std::vector<AirPart>& hollow) {
  double volume = 0;
  for (std::uint32_t i = 0; i < columns.spans.size(); ++i) {
    const double floor = columns.spans[i].floor_in(orientation);
    const double top = std::min(flood.height[i], columns.spans[i].ceiling_in(orientation));
    if (flood.height[i] == kInfinity || floor == -kInfinity || hollow[i].to > hollow[i].from) continue;
    if (top - floor >= columns.spacing) volume += columns.area() * (top - floor);
  }
  return volume;
}

}  // namespace

InspectedDrainage inspect_drainage(const Mesh& model, const DrainageQuestion& question, Monitor& monitor) {
  const UprightFrame frame(question.up);
  const Mesh upright = turned_upright(model, frame);
  const SurfaceIndex surface(upright);
  const double radius = question.widest_hole / 2;
  InspectedDrainage result;
  result.spacing = spacing_of_nodes(surface.winding().box, question.widest_hole);
  const AirColumns columns =
      air_columns(upright, surface.winding(), result.spacing, margin_for(radius, result.spacing));
  monitor.check_interrupted();
  const AirFloods floods{flood(columns, kUpright), flood(columns, kUpsideDown)};
  monitor.check_interrupted();
  const AirNodes nodes = air_nodes(columns, surface, radius);
  monitor.check_interrupted();
  result.found = find_hollows(columns, nodes, surface, floods.upright, question.widest_hole);
  monitor.check_interrupted();
  result.pools = pools_in(columns, floods, parts_that_open(columns, floods.upright, result.found));
  result.recesses_upright = left_in_recesses(columns, floods.upright, kUpright, result.found.parts);
  result.recesses_upside_down =
      left_in_recesses(columns, floods.upside_down, kUpsideDown, result.found.parts);
  result.cups = cups_of(columns);
  turn_back(result.cups, frame);
  result.found.parts.clear();
  turn_back(result.found, frame);
  return result;
}

std::vector<AirCup> cups_of(const Mesh& model, Vec3d up, double spacing) {
  const UprightFrame frame(up);
  const Mesh upright = turned_upright(model, frame);
  const SurfaceIndex surface(upright);
  const Vec3d size = surface.winding().box.upper - surface.winding().box.lower;
  const double least = std::sqrt(size.x * size.y / kMostColumns);
  std::vector<AirCup> cups = cups_of(air_columns(upright, surface.winding(), std::max(spacing, least), 1));
  turn_back(cups, frame);
  return cups;
}

}  // namespace aerate
