#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/monitor.h"
#include "pipeline/options.h"
#include "pipeline/prepare.h"

namespace aerate {

// Models that are prepared once for all forms of a job (best_form.h). Those read one model, mend it the same way and open
// its cavities by the same holes; what they ask of it differs in the limits that these depend on, or not at all.
class PreparedModels {
 public:
  // What prepare_model makes of it, with all that it says: made now or before.
  std::shared_ptr<const PreparedModel> get(const HollowOptions& options, Monitor& monitor);

 private:
  struct Asked {
    double wall, gap;  // which voxels and holes depend on
    double tolerance;  // of holes that open cavities; 0 where none are
    std::optional<double> voxel_size;

    friend bool operator==(const Asked&, const Asked&) = default;
  };
  struct Made {
    Asked asked;
    std::shared_ptr<const PreparedModel> model;
    std::vector<std::string> notices;
  };
  std::vector<Made> made_;
};

}  // namespace aerate
