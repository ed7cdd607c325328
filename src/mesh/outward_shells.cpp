#include "mesh/outward_shells.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "kernels/constants.h"
#include "mesh/topology.h"

namespace aerate {

OutwardShells::OutwardShells(const Mesh& model, const Inspection& inspection, const SurfaceIndex& surface)
    : surface_(surface) {
  const bool has_cavities = std::any_of(inspection.shells.begin(), inspection.shells.end(),
                                        [](const Shell& shell) { return shell.volume < 0; });
  if (!has_cavities) return;
  const ShellLabels labels = label_shells(model, EdgeUses(model));
  const std::vector<Shell> shells = describe_shells(model, labels);
  std::vector<Triangle> outward;
  for (std::size_t i = 0; i < model.triangles.size(); ++i) {
    const std::uint32_t label = labels.of_triangle[i];
    if (label != kNone && shells[label].volume >= 0) outward.push_back(model.triangles[i]);
  }
  own_.emplace(model.positions, outward);
}

const kernels::WindingView& OutwardShells::winding() const {
  return own_ ? own_->view() : surface_.winding();
}

}  // namespace aerate
