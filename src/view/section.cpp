#include "view/section.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <tbb/parallel_for.h>

namespace aerate {
namespace {

// A line's crossing of a row.
struct Crossing {
  double x;
  int entering;
  std::uint32_t part;

  friend bool operator<(const Crossing& a, const Crossing& b) {
    if (a.x != b.x) return a.x < b.x;
    return a.part != b.part ? a.part < b.part : a.entering > b.entering;
  }
};

// From one before the plane to one in or behind it: for both triangles at an edge the same.
ViewPoint passing(Vec3d before, Vec3d behind) {
  const double share = -before.z / (behind.z - before.z);
  return {before.x + share * (behind.x - before.x), before.y + share * (behind.y - before.y)};
}

// The line of a triangle that the plane passes through, directed so that what is solid is on the same side of all.
SectionLine line_through(const std::array<Vec3d, 3>& corners, std::uint32_t part) {
  SectionLine line;
  line.part = part;
  for (std::size_t i = 0; i < 3; ++i) {
    const Vec3d& from = corners[i];
    const Vec3d& to = corners[(i + 1) % 3];
    if (from.z < 0 && to.z >= 0) line.to = passing(from, to);
    if (from.z >= 0 && to.z < 0) line.from = passing(to, from);
  }
  return line;
}

// What bounds the model outside counts apart from modifiers in it.
bool is_modifier(const Scene& scene, std::uint32_t part) {
  return scene.void_use == VoidUse::modifiers && scene.parts[part].kind == PartKind::void_surface;
}

std::vector<SectionSpan> spans_of(const Scene& scene, std::vector<Crossing> crossings) {
  std::sort(crossings.begin(), crossings.end());
  std::vector<SectionSpan> spans;
  int solid = 0, modifiers = 0;
  std::uint32_t modifier = 0;
  for (std::size_t i = 0; i + 1 < crossings.size(); ++i) {
    const Crossing& here = crossings[i];
    if (is_modifier(scene, here.part)) {
      modifiers += here.entering;
      modifier = here.part;
    } else {
      solid += here.entering;
    }
    if (solid == 0 || !(crossings[i + 1].x > here.x)) continue;
    const auto kind = modifiers != 0              ? SectionSpan::Kind::modifier
                      : solid == 1 || solid == -1 ? SectionSpan::Kind::solid
                                                  : SectionSpan::Kind::overlap;
    spans.push_back({here.x, crossings[i + 1].x, kind, modifier});
  }
  return spans;
}

}  // namespace

std::vector<SectionLine> section_of(const Scene& scene, const std::vector<Vec3d>& corners) {
  std::vector<SectionLine> lines;
  for (std::uint32_t part = 0; part < scene.parts.size(); ++part) {
    for (const Triangle& t : triangles_of(scene.mesh, scene.parts[part])) {
      const std::array<Vec3d, 3> triangle{corners[t[0]], corners[t[1]], corners[t[2]]};
      const int behind = (triangle[0].z >= 0) + (triangle[1].z >= 0) + (triangle[2].z >= 0);
      if (behind == 1 || behind == 2) lines.push_back(line_through(triangle, part));
    }
  }
  return lines;
}

SectionRows::SectionRows(const Scene& scene, const std::vector<SectionLine>& lines, double first,
                         double spacing, std::size_t count)
    : rows_(count) {
  if (!scene.is_closed) return;
  std::vector<std::vector<Crossing>> crossings(count);
  for (const SectionLine& line : lines) {
    // In one direction, so that ends that are equal are crossed by one of two lines.
    const bool goes_up = line.to.y > line.from.y;
    const ViewPoint low = goes_up ? line.from : line.to, high = goes_up ? line.to : line.from;
    const double from = std::max(std::ceil((low.y - first) / spacing) - 1, 0.0);
    const double to = std::min(std::floor((high.y - first) / spacing) + 1, static_cast<double>(count) - 1);
    if (!(from <= to)) continue;
    for (auto row = static_cast<std::size_t>(from); row <= static_cast<std::size_t>(to); ++row) {
      const double y = first + spacing * static_cast<double>(row);
      if ((low.y <= y) == (high.y <= y)) continue;
      const double x = low.x + (high.x - low.x) * ((y - low.y) / (high.y - low.y));
      crossings[row].push_back({x, goes_up ? -1 : 1, line.part});
    }
  }
  tbb::parallel_for(std::size_t{0}, count,
                    [&](std::size_t row) { rows_[row] = spans_of(scene, std::move(crossings[row])); });
}

const SectionSpan* span_at(const std::vector<SectionSpan>& row, double x) {
  const auto after = std::upper_bound(
      row.begin(), row.end(), x, [](double value, const SectionSpan& span) { return value < span.from; });
  if (after == row.begin()) return nullptr;
  const SectionSpan& span = *(after - 1);
  return x < span.to ? &span : nullptr;
}

}  // namespace aerate
