#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "core/drainage.h"
#include "core/mesh.h"
#include "core/monitor.h"
#include "files/load.h"
#include "pipeline/input_facts.h"
#include "pipeline/process_choice.h"
#include "pipeline/report.h"
#include "pipeline/view_outputs.h"
#include "printing/slicers/slicers.h"
#include "supports/check_supports.h"
#include "supports/make_supports.h"
#include "supports/overhangs.h"

namespace aerate {

// A body of supports with voids in it.
struct FoamedBody {
  Mesh mesh;          // as it comes out of any file
  std::string words;  // what it is, for the report
};

// Whether something can run out of a hole there.
using MayOpen = std::function<bool(const Tube& hole)>;

struct SupportOptions {
  std::filesystem::path model;
  std::filesystem::path output;
  LoadOptions load;
  std::optional<double> weld;  // see HollowOptions
  Process process;
  PrintDirection direction;
  Limits given;  // the overhang angle and the bridge, where they are not the process's
  // Where not given, those of the process (supports/make_supports.h); millimetres.
  std::optional<double> clearance, contact_gap, tooth, layer_height;
  // The width that the body is not drawn in below, mm. If not given, that of the process and, where voids drain, no less than a hole
  // and a wall take.
  std::optional<double> stem;
  // Of overhangs that may be left without a tooth, seen from above, mm2: points between folds of a surface, of which real models have
  // few.
  double most_left = 1;
  std::optional<double> plate;  // its height along up; at the model's lowest point if not given
  // If given, one that has a format for parts: the model and the supports as parts of one object; the output has to be 3MF.
  const SlicerProfile* parts_for = nullptr;
  std::optional<int> extruder;  // that prints the supports, from 1; for parts
  // If given, makes voids in the body, with escape holes only where they may open. Throws what hollow() throws.
  std::function<FoamedBody(const Mesh& body, const MayOpen& may_open, Monitor& monitor)> foam;
  ViewOutputs views;
};

// Everything that `support` tells.
struct SupportReport {
  InputFacts input;
  Process process;
  PrintDirection direction;
  SupportRules rules;
  SupportShape shape;  // as it was made: the gap in whole layers
  Overhangs overhangs;
  std::size_t tooth_count = 0;
  std::size_t foot_count = 0;
  double tip_area = 0;                       // mm2
  double strength = 0;                       // of the material across layers, about, MPa
  double body_volume = 0;                    // before voids, mm3
  std::string foam;                          // in words; empty: the body is as it is
  const SlicerProfile* parts_for = nullptr;  // see SupportOptions
  std::vector<PartSetting> part_settings;    // of the supports, if they are a part
  std::filesystem::path output;
  std::size_t output_bytes = 0;
  SupportFacts facts;  // of the written file
  std::vector<StageCost> stages;
  std::vector<std::string> notices;

  // About what it takes to break all teeth at once, N.
  double force() const { return tip_area * strength; }
};

// Makes supports for a model, writes them beside their target, reads them back, checks them, and renames. Throws UsageError,
// InputError, MeshError, NothingToRemoveError where nothing needs supports, FailureError, InterruptedError.
SupportReport support_model(const SupportOptions& options, Monitor& monitor);

}  // namespace aerate
