#pragma once

#include <optional>
#include <vector>

#include "core/mesh.h"
#include "core/monitor.h"
#include "supports/support_rules.h"
#include "supports/undersides.h"

namespace aerate {

// A piece of a model's underside that cannot be printed without supports.
struct OverhangRegion {
  double area = 0;       // seen along up, of what leans out beyond the angle, mm2
  Vec3d place{0, 0, 0};  // where it is farthest from what holds it, or where it begins in the air; mm
  double width = 0;      // diameter of the largest disc in it, seen along up, mm
  std::optional<double>
      farthest;       // distance of that place from what holds it, mm; absent if it begins in the air
  double height = 0;  // of the place above the plate, mm
};

struct Overhangs {
  double spacing = 0;                   // of the columns that it was found on, mm
  std::vector<OverhangRegion> regions;  // the largest first

  double area() const;
};

// What of a model needs supports. Ceilings of sealed cavities stay out.
//   mesh: closed, outward
//   up: a unit vector; the plate is at the model's lowest point along it
// Throws InterruptedError.
Overhangs find_overhangs(const Mesh& mesh, const SupportRules& rules, Vec3d up, Monitor& monitor);

// The same on columns that are there already; places are in the frame of these.
std::vector<OverhangRegion> overhang_regions(const Undersides& undersides, const SupportRules& rules);

}  // namespace aerate
