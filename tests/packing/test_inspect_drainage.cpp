#include <cmath>
#include <cstdio>
#include <gtest/gtest.h>
#include <numbers>

#include "packing/air/inspect_drainage.h"
#include "tests/support/hollow_boxes.h"
#include "tests/support/shapes.h"

namespace aerate {
namespace {

using test::BoxHole;
using test::hollow_box;
using test::kHollowOfBox;

InspectedDrainage look_at(const Mesh& model, Vec3d up = {0, 0, 1}) {
  Monitor monitor;
  InspectedDrainage r= inspect_drainage(model, {.up = up, .widest_hole = 7}, monitor);
  printf("spacing %.3f hollows %zu holes %zu\n", r.spacing, r.found.hollows.size(), r.found.holes.size());
  for (auto& h : r.found.hollows) printf(" hollow %.1f sealed %d (%.2f %.2f %.2f)\n", h.volume, h.is_sealed, h.place.x,h.place.y,h.place.z);
  for (auto& h : r.found.holes) printf(" hole %.2f of %u (%.2f %.2f %.2f)\n", h.width, h.hollow, h.place.x,h.place.y,h.place.z);
  if (r.found.wall) printf(" wall %.3f (%.2f %.2f %.2f)\n", r.found.wall->thickness, r.found.wall->place.x,r.found.wall->place.y,r.found.wall->place.z);
  printf(" pools up %.1f down %.1f both %.1f of %.1f; recess %.1f %.1f\n", r.pools.upright, r.pools.upside_down, r.pools.after_both, r.pools.total, r.recesses_upright, r.recesses_upside_down);
  for (size_t i=0;i<r.cups.size()&&i<4;++i) printf(" cup %.2f mm2 %.2f mm3 (%.2f %.2f %.2f)\n", r.cups[i].area, r.cups[i].volume, r.cups[i].place.x, r.cups[i].place.y, r.cups[i].place.z);
  return r;
}

TEST(InspectDrainage, Boxes) {
  look_at(hollow_box({BoxHole::bottom, BoxHole::top}));
  look_at(hollow_box({BoxHole::top}));
  look_at(hollow_box({BoxHole::side_middle}));
  look_at(hollow_box({BoxHole::side_low}));
  look_at(hollow_box({}));
  look_at(hollow_box({BoxHole::top}), {0,0,-1});
  look_at(hollow_box({BoxHole::side_middle}), normalised(Vec3d{1,0,1}));
  look_at(test::make_torus(20, 5, 64, 32));
}

}  // namespace
}  // namespace aerate
