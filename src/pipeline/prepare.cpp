#include "pipeline/prepare.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/error.h"
#include "core/listed.h"
#include "mesh/repair.h"
#include "mesh/topology.h"
#include "pipeline/held_notices.h"
#include "pipeline/keep_solid.h"

namespace aerate {
namespace {

// Holes up to this share of the model's diagonal are closed without being asked for more: larger ones are
// rather a missing part than damage.
constexpr double kSmallHoleShare = 0.1;

// Vertices nearer than this share of the model's diagonal are apart by rounding; no more than so many mm.
constexpr double kRoundingShare = 1e-5;
constexpr double kMostRounding = 0.01;

// Longest side of a model's box, mm.
constexpr double kLongestModel = 1e6;
constexpr double kShortestModel = 1e-3;

std::string name_of(const PreparedModel& model) {
  return model.input.path.filename().string();
}

// For an option: three digits, none of them rounded down.
std::string at_least(double value) {
  const double unit = std::pow(10, std::floor(std::log10(value)) - 2);
  return fmt::format("{:.6g}", std::ceil(value / unit * (1 - 1e-9)) * unit);
}

std::string holes_in_words(const Inspection& inspection) {
  const BoundaryLoop& largest = inspection.boundary_loops.front();
  const std::size_t holes = inspection.boundary_loops.size();
  return fmt::format("{} form {}{} near ({:.1f}, {:.1f}, {:.1f}) mm, {:.3g} mm across",
                     counted(inspection.open_edges, "boundary edge", "boundary edges"),
                     counted(holes, "hole", "holes"), holes == 1 ? "" : ", the largest", largest.centre.x,
                     largest.centre.y, largest.centre.z, largest.diameter);
}

double hole_limit(const Inspection& inspection, const SurfacePolicy& policy) {
  return policy.max_hole.value_or(kSmallHoleShare * diagonal_of(inspection.box));
}

// Beyond these, single precision and the smallest of steps are of no use to a printer.
void require_size(const PreparedModel& model) {
  const Vec3d size = to_double(model.inspection.box.upper) - to_double(model.inspection.box.lower);
  const double longest = std::max({size.x, size.y, size.z});
  if (longest <= kLongestModel && longest >= kShortestModel) return;
  throw MeshError(
      fmt::format("{}: the model is {:.3g} x {:.3g} x {:.3g} mm; what is printed is {:g} mm to {:g} m long",
                  name_of(model), size.x, size.y, size.z, kShortestModel, kLongestModel / 1000),
      "are --unit and --scale right?");
}

void require_solid(const PreparedModel& model) {
  const Inspection& inspection = model.inspection;
  if (inspection.misoriented_edges > 0) {
    throw MeshError(fmt::format("{}: the triangles on either side of {} face opposite ways, so that the "
                                "inside is not defined",
                                name_of(model), counted(inspection.misoriented_edges, "edge", "edges")),
                    "make the normals consistent in a mesh editor");
  }
  if (is_flat(inspection.filled_volume, inspection.box)) {
    const Vec3d size = to_double(inspection.box.upper) - to_double(inspection.box.lower);
    throw MeshError(fmt::format("{}: the surface is flat or encloses no volume ({:.3g} x {:.3g} x {:.3g} mm)",
                                name_of(model), size.x, size.y, size.z),
                    "a solid needs three dimensions; see 'aerate inspect'");
  }
}

bool holes_are_small(const Inspection& inspection, const SurfacePolicy& policy) {
  return inspection.boundary_loops.front().diameter <= hole_limit(inspection, policy);
}

double weld_tolerance(const Inspection& inspection, const SurfacePolicy& policy) {
  return policy.weld.value_or(std::min(kRoundingShare * diagonal_of(inspection.box), kMostRounding));
}

// The surface cannot be kept because it is open; says what would help.
[[noreturn]] void refuse_open(const PreparedModel& model, const SurfacePolicy& policy) {
  const double largest = model.inspection.boundary_loops.front().diameter;
  throw MeshError(
      fmt::format("{}: {}", name_of(model), holes_in_words(model.inspection)),
      holes_are_small(model.inspection, policy)
          ? "try 'aerate hollow --surface remesh', which closes holes of this size"
          : fmt::format("holes of more than {:.3g} mm are not closed unasked: close it in a mesh editor, or "
                        "let 'aerate hollow --surface remesh' span it with --max-hole {}",
                        hole_limit(model.inspection, policy), at_least(largest)));
}

// Replaces the mesh by a repaired one and passes on what was done. Without a notice nothing was, and what is known
// of the mesh still holds.
void adopt(PreparedModel& model, Repaired repaired, Monitor& monitor) {
  for (const std::string& notice : repaired.notices) monitor.notice(notice);
  model.mesh = std::move(repaired.mesh);
  if (!repaired.notices.empty()) model.inspection = inspect(model.mesh);
}

void turn_outward(PreparedModel& model, Monitor& monitor) {
  const auto is_inward = [](const Shell& shell) { return shell.volume < 0; };
  if (std::any_of(model.inspection.shells.begin(), model.inspection.shells.end(), is_inward))
    adopt(model, orient_outward(std::move(model.mesh)), monitor);
}

// Where bodies of both directions lie in one place, which of them go decides about what is solid: then all stay.
void unite(PreparedModel& model, Monitor& monitor) {
  constexpr double kSameVolume = 0.01;
  Repaired united = unite_doubles(model.mesh);
  if (united.notices.empty()) return;
  const double before = model.inspection.filled_volume, after = inspect(united.mesh).filled_volume;
  if (model.inspection.closed() && std::abs(after - before) > kSameVolume * std::abs(before)) return;
  adopt(model, std::move(united), monitor);
}

// Filling a crack as if it were a hole would cut through the model.
// What helps is judged on the model as it is, for that is what another --weld begins with.
void require_no_cracks(const PreparedModel& model, const Mesh& closed) {
  const auto left = find_crack(closed);
  if (!left) return;
  const Crack crack = find_crack(model.mesh).value_or(*left);
  throw MeshError(
      fmt::format("{}: the surface is cracked: {} of a rim near ({:.1f}, {:.1f}, {:.1f}) mm, {:.3g} mm "
                  "across, lie on "
                  "each other but for {:.3g} mm",
                  name_of(model), counted(crack.rim.edge_count, "edge", "edges"), crack.rim.centre.x,
                  crack.rim.centre.y, crack.rim.centre.z, crack.rim.diameter, crack.width),
      fmt::format("join what is so near with --weld {}", at_least(crack.weld)));
}

// What is damaged whatever becomes of the surface.
void mend(PreparedModel& model, const SurfacePolicy& policy, Monitor& monitor) {
  if (model.inspection.open_edges > 0) {
    Repaired closed = close_cracks(model.mesh, weld_tolerance(model.inspection, policy));
    require_no_cracks(model, closed.mesh);
    adopt(model, std::move(closed), monitor);
  }
  if (std::ranges::any_of(model.mesh.triangles, has_repeated_vertex))
    adopt(model, without_repeated_vertices(std::move(model.mesh)), monitor);
  if (model.inspection.duplicate_triangles > 0) unite(model, monitor);
  if (model.inspection.misoriented_edges > 0)
    adopt(model, orient_consistently(std::move(model.mesh)), monitor);
}

PreparedModel remesh(PreparedModel model, const SurfacePolicy& policy, Monitor& monitor) {
  monitor.stage("remesh");
  if (model.inspection.open_edges > 0) {
    if (!holes_are_small(model.inspection, policy)) refuse_open(model, policy);
    adopt(model, fill_holes(std::move(model.mesh), hole_limit(model.inspection, policy)), monitor);
  }
  turn_outward(model, monitor);
  require_solid(model);
  monitor.check_interrupted();
  Remeshed remeshed =
      remesh_without_loss(model.mesh, model.inspection, policy.voxels, name_of(model), monitor);
  model.mesh = std::move(remeshed.mesh);
  model.inspection = std::move(remeshed.inspection);
  model.outer_deviation = remeshed.deviation;
  model.level_set.emplace(std::move(remeshed.level_set));
  return model;
}

// Which of the two the model is to go through.
SurfaceMode surface_mode(const PreparedModel& model, const SurfacePolicy& policy) {
  if (policy.mode != SurfaceMode::automatic) return policy.mode;
  const bool has_small_holes = model.inspection.open_edges > 0 && holes_are_small(model.inspection, policy);
  return has_small_holes ? SurfaceMode::remesh : SurfaceMode::keep;
}

PreparedModel keep(PreparedModel model, const SurfacePolicy& policy, Monitor& monitor) {
  if (model.inspection.open_edges > 0) refuse_open(model, policy);
  turn_outward(model, monitor);
  require_solid(model);
  return model;
}

// Keeps what it is told.
class NoticeList : public Monitor {
 public:
  void notice(std::string_view text) override { texts.emplace_back(text); }

  std::vector<std::string> texts;
};

}  // namespace

PreparedModel load_and_inspect(const ModelSource& source, const LoadOptions& options, Monitor& monitor) {
  const std::filesystem::path& path = source.path;
  PreparedModel model;
  monitor.stage("load");
  LoadedModel loaded = source.arrays != nullptr ? load_model(*source.arrays, path.string(), options)
                                                : load_model(path, options);
  for (const std::string& notice : loaded.notices) {
    monitor.notice(fmt::format("{}: {}", path.filename().string(), notice));
  }
  model.mesh = std::move(loaded.mesh);
  model.modifiers = std::move(loaded.modifiers);
  model.input.path = path;
  model.input.format = loaded.format;
  model.input.part_count = loaded.part_count;
  model.input.scale = options.scale;
  if (loaded.part_count > 1)
    monitor.notice(fmt::format("{} holds {} parts; all are used, as one model", path.filename().string(),
                               loaded.part_count));
  monitor.check_interrupted();

  monitor.stage("inspect");
  model.inspection = inspect(model.mesh);
  model.input.inspection = model.inspection;
  monitor.check_interrupted();
  return model;
}

PreparedModel make_usable(PreparedModel model, const SurfacePolicy& policy, Monitor& monitor) {
  require_size(model);
  mend(model, policy, monitor);
  const SurfaceMode mode = surface_mode(model, policy);
  if (mode == SurfaceMode::keep) return keep(std::move(model), policy, monitor);
  if (policy.mode == SurfaceMode::automatic)
    monitor.notice(fmt::format("{}: {}; the surface is meshed anew (--surface remesh)", name_of(model),
                               holes_in_words(model.inspection)));
  return remesh(std::move(model), policy, monitor);
}

UsableCopy usable_copy(const PreparedModel& read, Monitor& monitor) {
  PreparedModel model{read.input, read.mesh, read.inspection, std::nullopt, std::nullopt, {}, std::nullopt};
  try {
    return {make_usable(std::move(model), {.mode = SurfaceMode::keep}, monitor)};
  } catch (const MeshError& error) {
    return {std::nullopt, fmt::format("cannot be told: {}; {}", error.what(), error.hint())};
  }
}

ModelUse use_of(PreparedModel model, const SurfacePolicy& policy) {
  NoticeList done;
  try {
    require_size(model);
    mend(model, policy, done);
    if (surface_mode(model, policy) == SurfaceMode::remesh)
      return {"'aerate hollow' meshes the surface anew, which closes its holes (see --max-hole)"};
    static_cast<void>(keep(std::move(model), policy, done));
  } catch (const MeshError& error) {
    return {fmt::format("none: {}; {}", error.what(), error.hint()), error};
  }
  if (done.texts.empty()) return {"'aerate hollow' can keep this surface as it is"};
  return {fmt::format("'aerate hollow' can keep this surface, mended: {}", fmt::join(done.texts, "; "))};
}

PreparedModel prepare_model(const HollowOptions& options, Monitor& monitor) {
  LoadOptions load = options.load;
  load.wanted_modifiers = names_of_regions(options.keep_solid);
  PreparedModel model = load_and_inspect({options.model, options.arrays}, load, monitor);
  const double voxel_size = default_voxel_size(options.packing.limits(), model.inspection.box);
  model = make_usable(std::move(model),
                      {options.surface, options.weld, options.max_hole, {options.voxel_size, voxel_size}},
                      monitor);
  const KeepSolidPolicy policy{options.load, options.weld, options.packing.limits().wall};
  if (options.opens_cavities) {
    // Holes keep off these regions, and the room that they leave is that of the opened model.
    HeldNotices held(monitor);
    model.kept = keep_solid(model, options.keep_solid, policy, held);
    model = with_open_cavities(std::move(model),
                               {*options.drainage, options.packing.limits(), options.tolerance}, monitor);
  }
  model.kept = keep_solid(model, options.keep_solid, policy, monitor);
  return model;
}

}  // namespace aerate
