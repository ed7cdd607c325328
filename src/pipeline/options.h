#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "core/device.h"
#include "core/drainage.h"
#include "core/packing.h"
#include "files/load.h"
#include "packing/methods.h"
#include "pipeline/process_choice.h"
#include "pipeline/region_request.h"
#include "pipeline/view_outputs.h"
#include "printing/materials.h"
#include "printing/plugs.h"
#include "printing/print_settings.h"

namespace aerate {

struct SlicerProfile;

// Which surface the result has outside.
enum class SurfaceMode {
  automatic,  // keep, or remesh with a notice where the model cannot be kept
  keep,       // the model's own triangles, every one as it is
  remesh,     // the model becomes a level set and is meshed anew
};

// How a model is to be packed.
struct PackingRequest {
  const PackingMethod* method = &packing_methods().front();
  ProcessChoice process;          // under whose limits
  std::filesystem::path spheres;  // if not empty, these are taken and nothing is packed
  PackingStop stop;               // for a method that is not on a lattice
  DeviceRequest device;
  // If given, the least radius is the least with which a void saves filament in this print.
  std::optional<PrintSettings> pays_in = std::nullopt;

  // The spheres' cells become voids, and get the roofs that the spheres then do without.
  bool is_for_cells = false;
  // Of cells, their spheres' centres are so far from each other at least, mm.
  std::optional<double> spacing;

  PackingLimits limits() const { return packing_limits(process); }
  // Of the spheres themselves.
  PackingLimits sphere_limits() const {
    PackingLimits of_spheres = limits();
    if (!is_for_cells || !of_spheres.roof.limits_ceilings()) return of_spheres;
    // Faces of cells that lean by 45 degrees need no roofs where that is allowed.
    constexpr double kSineOfSquares = 0.70710678;
    of_spheres.in_level_squares = of_spheres.roof.sine >= kSineOfSquares;
    of_spheres.roof.widest_ball = Roof{}.widest_ball;
    return of_spheres;
  }
};

// For reports.
std::string name_of_method(const PackingRequest& request);

// Voids fill the cells of their packing instead of being spheres.
struct CellOptions {
  double fillet = 1;  // mm: radius of their inner edges, and of the ball that has to fit everywhere in them
};

// The tolerance of cells unless it is given, mm: inner walls need less than the surface of spheres, and cells have
// more of them.
inline constexpr double kCellTolerance = 0.1;

struct PackOptions {
  std::filesystem::path model;
  // If given, the model's arrays, which the caller keeps; `model` is what it is called then.
  const MeshArrays* arrays = nullptr;
  // A table of spheres or, of cells, a table of planes or a mesh of pieces: as its ending says. Empty: nothing is written, and
  // cells become pieces.
  std::filesystem::path output;
  LoadOptions load;
  std::optional<double> weld;  // see HollowOptions
  PackingRequest packing;
  std::vector<RegionRequest> keep_solid;  // see HollowOptions
  std::optional<CellOptions> cells;
  double tolerance = kCellTolerance;  // of pieces, mm; see HollowOptions
  ViewOutputs views;
};

// What to do when voids make a print heavier than it would be without them.
enum class HeavierPrint { refuse, allow };

// Voids as parts of a 3MF where the slicer changes the infill and prints no walls, instead of as shells.
struct ModifierOptions {
  const SlicerProfile* slicer = nullptr;  // whose: one that has a format for them
  double infill_percent = 0;
  // In them infill is a slicer's lightning, which holds up what is above, and not the print's own pattern.
  bool hold_lightning = false;
};

struct ObjectName {
  const SlicerProfile* slicer = nullptr;  // one that has a format for modifiers
  std::string name;
};

// Where to stop: with the fewest voids that reach it.
struct SavingTarget {
  enum class Kind {
    mass,   // of the result, as solid material, at most: g
    share,  // of the model's volume that is removed, at least: 0 to 1
  };
  Kind kind = Kind::share;
  double value = 0;
};

// Plugs for the escape holes, in a file of their own.
struct PlugRequest {
  std::filesystem::path output;
  PlugFit fit;
};

// A setting of the print in words, and where it came from.
struct PrintOrigin {
  std::string name;    // "infill"
  std::string value;   // "15 %"
  std::string origin;  // "command line", "default", or a file's name
  std::string key;     // what it is called in that file
};

struct HollowOptions {
  std::filesystem::path model;
  // If given, the model's arrays, which the caller keeps; `model` is what it is called then.
  const MeshArrays* arrays = nullptr;
  // Empty: nothing is written, and the mesh is checked as if it had been read back.
  std::filesystem::path output;
  // If given, and the output is 3MF: what this slicer is to call the object, in UTF-8.
  std::optional<ObjectName> object_name;
  LoadOptions load;
  PackingRequest packing;
  std::optional<CellOptions> cells;
  // Regions that nothing is taken out of, nor anything nearer to them than the wall.
  std::vector<RegionRequest> keep_solid;
  SurfaceMode surface = SurfaceMode::automatic;
  // If given, voids become modifiers; the output has to be 3MF.
  std::optional<ModifierOptions> modifiers;
  // If given, one that has a format for support blockers: sealed voids get them; the output has to be 3MF.
  const SlicerProfile* support_blockers = nullptr;
  // If given, voids are joined by channels and opened by escape holes; else each is sealed.
  std::optional<DrainageRequest> drainage;
  // If given, asked of each escape hole: one of which it is not true is not made.
  std::function<bool(const Tube& hole)> may_open;
  Build build = Build::standing;
  bool opens_cavities = false;       // those that the model has itself; if voids drain
  std::optional<PlugRequest> plugs;  // if given, of voids that drain

  // Void surfaces deviate from the planned balls by at most this, inwards. Millimetres.
  double tolerance = 0.05;
  // The tolerance is loosened until the result has at most so many triangles, support blockers included.
  std::optional<std::size_t> max_triangles;
  // Edge of the voxels when remeshing, mm; chosen from the limits if not given.
  std::optional<double> voxel_size;
  // Vertices at open edges are joined that are at most so many mm apart; a hundred-thousandth of the model's
  // diagonal, and no more than 0.01 mm, if not given.
  std::optional<double> weld;
  // Remeshing closes holes up to this diameter, mm; a tenth of the model's diagonal if not given.
  std::optional<double> max_hole;

  Material material;
  // If given, not for modifiers.
  std::optional<SavingTarget> target;
  // If given, voids are left out until the model stands as it stood, and further inside of what it stands on by so many mm;
  // neither for modifiers nor beside a target.
  std::optional<double> stand;

  // How filament is printed.
  PrintSettings print;
  // Whether its infill was said; else figures are for solid material.
  bool infill_is_known = false;
  // Where the width of its lines came from, if that was said: walls and gaps follow it (followed_by_lines).
  std::optional<std::string> line_width_origin;
  std::vector<PrintOrigin> print_origins;  // of all that describes the print, if anything of it was given
  std::vector<std::string> print_remarks;  // what is to be said of where it was read
  HeavierPrint heavier = HeavierPrint::refuse;
  // Voids are made from this share on of the radius from which they save in such a print (docs/economics.md).
  double paying_share = 1;

  ViewOutputs views;  // of the result
};

}  // namespace aerate
