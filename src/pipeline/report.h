#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "check/check_pieces.h"
#include "check/output_facts.h"
#include "core/packing.h"
#include "mesh/inspect.h"
#include "pipeline/balance.h"
#include "pipeline/drain.h"
#include "pipeline/drainage_verdict.h"
#include "pipeline/input_facts.h"
#include "pipeline/open_cavities.h"
#include "pipeline/options.h"
#include "pipeline/overhang_findings.h"
#include "pipeline/plug_file.h"
#include "pipeline/print_prediction.h"
#include "pipeline/stand.h"
#include "pipeline/target.h"
#include "printing/strength.h"

namespace aerate {

// Wall-clock time of one stage, and the most memory the process had held when it ended.
struct StageCost {
  std::string name;
  double seconds = 0;
  double peak_bytes = 0;
};

// Regions that stay solid.
struct KeptFacts {
  std::size_t count = 0;
  double volume = 0;           // of what of them is in the model, about, mm3
  std::optional<double> wall;  // measured between them and what was taken out, mm
};

// Cavities of the model's own that were opened, and what stays in all hollows of the written file.
struct CavityFacts {
  OpenedCavities opened;
  std::optional<TrappedPools> pools;  // absent if there were no cavities
};

// Everything that `hollow` tells; rendered as text and as JSON by the command line.
struct HollowReport {
  InputFacts input;
  PackingLimits limits;
  ProcessChoice process;
  std::string method;                // name_of_method
  std::optional<CellOptions> cells;  // voids fill the cells of the packing; absent: they are its spheres
  PackingStatistics packing_statistics;
  double packing_density = 0;  // volume of the planned balls over that of the packed model
  DeviceUse packing_device;

  OuterSurface surface = OuterSurface::kept;
  // When remeshed: voxel edge, and the largest distance between the new surface and the model as it was read,
  // less what became solid. mm.
  std::optional<double> voxel_size;
  std::optional<double> outer_deviation;

  double tolerance_asked = 0;
  double tolerance_used = 0;
  std::optional<std::size_t> max_triangles;

  // Voids were written as modifiers. The solid model stays: what `output` says of volumes and of the centre
  // of mass is then that of the model less the modifiers, not of a print.
  std::optional<ModifierOptions> modifiers;

  // The file has a support blocker for each void, larger than it by so much, for this slicer; null: it has none.
  const SlicerProfile* support_blockers = nullptr;
  double blocker_growth = 0;  // mm

  std::filesystem::path output_path;
  std::size_t output_bytes = 0;
  OutputFacts output;
  // Of voids that drain; absent where each is sealed.
  std::optional<DrainedVoids> drainage;
  std::optional<CavityFacts> cavities;  // absent unless they were to be opened
  std::optional<WrittenPlugs> plugs;    // absent unless asked for
  std::optional<KeptFacts> kept;        // absent without such regions
  std::optional<TargetFacts> target;    // absent where none was asked for
  std::optional<StandFacts> stand;      // absent unless it was asked for
  Build build = Build::standing;
  std::optional<PrintedCups> cups;  // of voids that drain, in a process that limits them
  // Parts overlap: the volume before (and so the one after) is estimated along a raster of rays.
  bool volume_estimated = false;

  Balance balance;
  // Absent for a process that prints no filament.
  std::optional<PrintPrediction> print;
  std::vector<PrintOrigin> print_origins;  // empty where nothing of the print was given
  Material material;
  std::vector<StageCost> stages;
  std::vector<std::string> notices;
};

// Mass and cost before and after: of the filament that is predicted if the print was described, else of solid
// material.
struct MaterialUse {
  bool predicted = false;
  double mass_before_g = 0;
  double mass_after_g = 0;
  double cost_before = 0;
  double cost_after = 0;
};
MaterialUse material_use(const HollowReport& report);

// Triangles of support blockers, each of which is one of a void's.
std::size_t blocker_triangles(const HollowReport& report);

// Whether supports would fill the voids in a slicer that builds them wherever they are wanted.
bool may_be_filled_with_supports(const HollowReport& report);

// How stiff blocks with such voids were.
const ShareOfBound& blocks_like(const HollowReport& report);

// All stages together: the times added, the largest peak.
StageCost total_of(const std::vector<StageCost>& stages);

// The cells of a packing as `pack` wrote them, one round each sphere.
struct PackedCells {
  CellOptions options;
  double tolerance = 0;  // mm
  std::size_t plane_count = 0;
  std::size_t file_bytes = 0;
  std::optional<PieceFacts> pieces;  // absent if the planes were written
};

struct PackReport {
  InputFacts input;
  std::filesystem::path output;
  std::size_t output_bytes = 0;
  PackingLimits limits;  // of cells, if these were written
  ProcessChoice process;
  std::string method;  // name_of_method
  Packing packing;
  double density = 0;
  std::optional<Clearances> clearances;  // of the spheres, measured, fp64
  std::optional<KeptFacts> kept;         // absent without regions that stay solid
  std::optional<PackedCells> cells;      // absent: the spheres were written
  std::vector<StageCost> stages;
  std::vector<std::string> notices;
};

struct InspectReport {
  InputFacts input;
  std::optional<SelfIntersections> self_intersections;
  std::string use;  // what hollowing will make of it
  std::optional<DrainageFindings> drainage;
  std::optional<OverhangFindings> overhangs;
  std::vector<StageCost> stages;
  std::vector<std::string> notices;
};

}  // namespace aerate
