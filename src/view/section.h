#pragma once

#include <cstdint>
#include <vector>

#include "core/solid.h"
#include "kernels/vec.h"
#include "view/camera.h"
#include "view/scene.h"

namespace aerate {

// Where a triangle of a part meets the plane of a cut, in view coordinates. Solid is on one side of all lines of a scene.
struct SectionLine {
  ViewPoint from, to;      // mm
  std::uint32_t part = 0;  // of the scene
};

// All such lines. A plane through a corner passes just before it, so that the lines of a closed surface are closed.
std::vector<SectionLine> section_of(const Scene& scene, const std::vector<Vec3d>& corners);

// What lies in the plane along a row.
struct SectionSpan {
  enum class Kind : std::uint8_t { solid, overlap, modifier };
  double from = 0, to = 0;  // x, mm
  Kind kind = Kind::solid;
  std::uint32_t part = 0;  // of a modifier
};

// Rows of a section, at ascending heights, `spacing` apart. What is solid is where the winding number is not 0: of a
// scene that is not closed, nothing is.
class SectionRows {
 public:
  SectionRows(const Scene& scene, const std::vector<SectionLine>& lines, double first, double spacing,
              std::size_t count);

  const std::vector<SectionSpan>& row(std::size_t i) const { return rows_[i]; }

 private:
  std::vector<std::vector<SectionSpan>> rows_;
};

// What there is at x, or nullptr.
const SectionSpan* span_at(const std::vector<SectionSpan>& row, double x);

}  // namespace aerate
