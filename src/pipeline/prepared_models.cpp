#include "pipeline/prepared_models.h"

#include <algorithm>
#include <utility>

#include "pipeline/held_notices.h"

namespace aerate {

std::shared_ptr<const PreparedModel> PreparedModels::get(const HollowOptions& options, Monitor& monitor) {
  const PackingLimits limits = options.packing.limits();
  const Asked asked{limits.wall, limits.gap, options.opens_cavities ? options.tolerance : 0,
                    options.voxel_size};
  auto found = std::ranges::find(made_, asked, &Made::asked);
  if (found == made_.end()) {
    HeldNotices held(monitor);
    auto model = std::make_shared<const PreparedModel>(prepare_model(options, held));
    made_.push_back({asked, std::move(model), held.take()});
    found = std::prev(made_.end());
  }
  for (const std::string& notice : found->notices) monitor.notice(notice);
  return found->model;
}

}  // namespace aerate
