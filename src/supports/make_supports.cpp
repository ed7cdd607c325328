#include "supports/make_supports.h"

#include <algorithm>
#include <fmt/format.h>
#include <optional>

#include "core/error.h"

namespace aerate {

SupportShape usual_shape(const SupportRules& rules) {
  SupportShape shape;
  if (rules.is_filament) {
    shape.kind = ToothKind::ridge;
    shape.body = {.clearance = 0.8, .tooth_height = 1.2, .foot = 2};
    shape.tooth = {.width = 0.5, .gap = 0.2, .penetration = 0, .embedded = 0.9, .least_height = 0.18};
  } else {
    shape.kind = ToothKind::cone;
    shape.body = {.clearance = 0.8, .tooth_height = 1.2, .foot = 2, .margin = 0.6, .stands_alone = false};
    shape.tooth = {.width = 0.4, .gap = 0, .penetration = 0.1, .embedded = 0.9, .least_height = 0.045};
  }
  return shape;
}

Supports make_supports(const SurfaceIndex& model, const Undersides& columns, const SupportRules& rules,
                       const SupportShape& shape, Monitor& monitor) {
  const TeethPlan plan = plan_teeth(columns, rules, shape.kind);
  if (plan.held.empty())
    throw NothingToRemoveError(
        fmt::format(
            "nothing needs supports: nothing leans out further than {:g} degrees from the vertical and "
            "is more than {:g} mm from what holds it, nor begins in the air",
            rules.degrees, rules.reach),
        "see 'aerate inspect --overhangs'");
  monitor.check_interrupted();
  Supports supports;
  supports.body = support_body(model, columns, plan, shape.body, monitor);
  std::optional<kernels::HostWinding> body;
  if (!supports.body.triangles.empty()) body.emplace(supports.body.positions, supports.body.triangles);
  const ToothSurfaces above = teeth_below(model, body ? &body->view() : nullptr, columns, plan, shape.tooth);
  supports.teeth = above.mesh;
  supports.tooth_count = above.count;
  supports.tip_area = above.tip_area;
  supports.no_room = above.left.size();
  monitor.check_interrupted();
  if (!body) return supports;
  // The body's own underside is held where it leans by no more than the angle, and by teeth on the model else.
  const Undersides below =
      find_undersides(supports.body, body->view(), rules, columns.plate, columns.spacing);
  const ToothSurfaces feet =
      teeth_on_model(model, body->view(), below, plan_teeth(below, rules, shape.kind), shape.tooth);
  supports.foot_count = feet.count;
  supports.teeth = joined(supports.teeth, feet.mesh);
  return supports;
}

Mesh joined(const Mesh& body, const Mesh& teeth) {
  Mesh all = body;
  const auto first = static_cast<std::uint32_t>(body.positions.size());
  all.positions.insert(all.positions.end(), teeth.positions.begin(), teeth.positions.end());
  all.triangles.reserve(all.triangles.size() + teeth.triangles.size());
  for (const Triangle& t : teeth.triangles)
    all.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
  return all;
}

}  // namespace aerate
