#pragma once

#include <filesystem>
#include <optional>

#include "core/monitor.h"
#include "files/load.h"
#include "pipeline/drainage_verdict.h"
#include "pipeline/overhang_findings.h"
#include "pipeline/report.h"
#include "pipeline/view_outputs.h"

namespace aerate {

enum class SelfIntersectionSearch { off, on };

struct InspectOptions {
  std::filesystem::path model;
  const MeshArrays* arrays = nullptr;  // see HollowOptions
  LoadOptions load;
  std::optional<double> weld;  // see HollowOptions
  SelfIntersectionSearch self_intersections = SelfIntersectionSearch::off;
  std::optional<DrainageInquiry> drainage;   // how it drains is asked, too
  std::optional<OverhangInquiry> overhangs;  // and what needs supports
  ViewOutputs views;
};

// Loads a model and looks at it; nothing about it is an error but what load_model throws. Throws UsageError for an inquiry
// into drainage under a process that needs none.
InspectReport inspect_model(const InspectOptions& options, Monitor& monitor);

// A model that was looked at, with what there is to see of it.
struct InspectedModel {
  InspectReport report;
  Mesh mesh;                     // as it was read
  std::optional<Error> refusal;  // what hollowing would throw
};

// The same for who shows it; `options.views` are not made.
InspectedModel inspect_to_show(const InspectOptions& options, Monitor& monitor);

}  // namespace aerate
