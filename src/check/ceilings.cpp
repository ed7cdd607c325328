#include "check/ceilings.h"

#include <algorithm>
#include <vector>

#include "check/check_failure.h"
#include "check/polled_loop.h"
#include "core/ceiling.h"

namespace aerate {

Ceilings measure_ceilings(const Mesh& mesh, std::span<const SolidPart> parts, const Roof& roof,
                          Monitor& monitor) {
  std::vector<std::vector<Ceiling>> by_part(parts.size());
  for_each_polled(parts.size(), kVoidsPerPiece, monitor,
                  [&](std::size_t i) { by_part[i] = ceilings_of(mesh, triangles_of(mesh, parts[i]), roof); });
  std::vector<const Ceiling*> ceilings;
  for (const std::vector<Ceiling>& own : by_part)
    for (const Ceiling& ceiling : own) ceilings.push_back(&ceiling);
  // The largest first: few of the others can be wider.
  std::stable_sort(ceilings.begin(), ceilings.end(),
                   [](const Ceiling* a, const Ceiling* b) { return a->area > b->area; });
  double widest = 0;
  for (const Ceiling* ceiling : ceilings) {
    if (ceiling->bound() <= widest) break;
    widest = std::max(widest, widest_disc(*ceiling, widest));
  }
  return {ceilings.size(), widest};
}

std::optional<Ceilings> limited_ceilings(const Mesh& mesh, std::span<const SolidPart> parts, const Roof& roof,
                                         double tolerance, Monitor& monitor) {
  if (!roof.limits_ceilings()) return std::nullopt;
  const Ceilings ceilings = measure_ceilings(mesh, parts, roof, monitor);
  require_bridged(ceilings, roof, tolerance);
  return ceilings;
}

void require_bridged(const Ceilings& ceilings, const Roof& roof, double tolerance) {
  if (ceilings.widest > roof.bridge() + tolerance)
    fail_check("a ceiling is {:.4g} mm wide, the bridge {:.4g} mm and the tolerance {:.4g} mm",
               ceilings.widest, roof.bridge(), tolerance);
}

}  // namespace aerate
