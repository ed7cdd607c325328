#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "core/mesh.h"
#include "pipeline/best_form.h"

namespace aerate {

// How deep in a model its points lie: what a job could remove is told from it at once, whatever its limits.
struct DepthSamples {
  double volume = 0;  // of the model, mm3
  std::vector<double>
      depths;  // mm, ascending: distances from the surface of points that are spread evenly inside it
};

// Of a closed mesh, which has this volume, with the unit and scale that it was read with; the points are always the same.
DepthSamples sample_depths(const Mesh& mesh, double volume);

// The share of the model that is deeper than so many mm, 0 to 1.
double share_deeper(const DepthSamples& samples, double depth);

struct ShareRange {
  double from = 0, to = 0;
};

// What a job would come to. Nothing is packed: the share that is deeper than the wall is counted, and what voids of a kind took of
// it on a set of models is taken of it (docs/studio.md, "The estimate").
struct JobEstimate {
  double solid_volume = 0;  // mm3, with the job's unit and scale
  ShareRange deeper;        // than the wall; one value where the model is scaled evenly
  ShareRange removed;       // of the model's volume; of modifiers, what they fill
};

// `forms`: of the job, as for hollow(); they say its unit and scale, while `samples` are of the model as it is in its file. Where the
// job says how much is to be removed, that is the range, but no more than there is.
JobEstimate estimate_job(const DepthSamples& samples, std::span<const JobForm> forms);

}  // namespace aerate
