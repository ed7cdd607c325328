#include "pipeline/prepare.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <utility>

#include "core/error.h"
#include "mesh/repair.h"
#include "mesh/topology.h"
#include "packing/verify.h"
#include "pipeline/memory.h"

namespace aerate {
namespace {

// Holes up to this share of the model's diagonal are closed without being asked for more: larger ones are
// rather a missing part than damage.
constexpr double kSmallHoleShare = 0.1;

// Of the memory that is available, what the level set of a remeshed model may take.
constexpr double kLevelSetMemoryShare = 0.5;

// A level set tells two surfaces apart that are this many voxels from each other.
constexpr double kVoxelsBetweenSurfaces = 3;

// No finer than this many voxels along the model's diagonal by default: time and memory grow with the square.
constexpr double kMostVoxelsAlongDiagonal = 1500;
constexpr double kFewestVoxelsAlongDiagonal = 200;

// A closed mesh whose volume is less than this share of its bounding box's is flat: rounding, not a solid.
constexpr double kFlatVolumeShare = 1e-9;

std::string name_of(const PreparedModel& model) {
  return model.input.path.filename().string();
}

std::string plural(std::size_t count, const char* one, const char* many) {
  return fmt::format("{} {}", count, count == 1 ? one : many);
}

double diagonal_of(const Box3f& box) {
  return length(to_double(box.upper) - to_double(box.lower));
}

std::string holes_in_words(const Inspection& inspection) {
  const BoundaryLoop& largest = inspection.boundary_loops.front();
  const std::size_t holes = inspection.boundary_loops.size();
  return fmt::format("{} form {}{} near ({:.1f}, {:.1f}, {:.1f}) mm, {:.3g} mm across",
                     plural(inspection.open_edges, "boundary edge", "boundary edges"),
                     plural(holes, "hole", "holes"), holes == 1 ? "" : ", the largest", largest.centre.x,
                     largest.centre.y, largest.centre.z, largest.diameter);
}

double hole_limit(const Inspection& inspection, const SurfacePolicy& policy) {
  return policy.max_hole.value_or(kSmallHoleShare * diagonal_of(inspection.box));
}

void require_solid(const PreparedModel& model) {
  const Inspection& inspection = model.inspection;
  if (inspection.misoriented_edges > 0) {
    throw MeshError(fmt::format("{}: the triangles on either side of {} face opposite ways, so that the "
                                "inside is not defined",
                                name_of(model), plural(inspection.misoriented_edges, "edge", "edges")),
                    "make the normals consistent in a mesh editor");
  }
  const Vec3d size = to_double(inspection.box.upper) - to_double(inspection.box.lower);
  if (!(inspection.filled_volume > kFlatVolumeShare * size.x * size.y * size.z)) {
    throw MeshError(fmt::format("{}: the surface is flat or encloses no volume ({:.3g} x {:.3g} x {:.3g} mm)",
                                name_of(model), size.x, size.y, size.z),
                    "a solid needs three dimensions; see 'aerate inspect'");
  }
}

bool holes_are_small(const Inspection& inspection, const SurfacePolicy& policy) {
  return inspection.boundary_loops.front().diameter <= hole_limit(inspection, policy);
}

// The surface cannot be kept because it is open; says what would help.
[[noreturn]] void refuse_open(const PreparedModel& model, const SurfacePolicy& policy) {
  const double largest = model.inspection.boundary_loops.front().diameter;
  throw MeshError(
      fmt::format("{}: {}", name_of(model), holes_in_words(model.inspection)),
      holes_are_small(model.inspection, policy)
          ? "try --surface remesh, which closes holes of this size"
          : fmt::format("holes of more than {:.3g} mm are not closed unasked: close it in a mesh editor, or "
                        "let --surface remesh span it with --max-hole {:.3g}",
                        hole_limit(model.inspection, policy), std::ceil(largest * 10) / 10));
}

// Replaces the mesh by a repaired one and passes on what was done.
void adopt(PreparedModel& model, Repaired repaired, Monitor& monitor) {
  for (const std::string& notice : repaired.notices) monitor.notice(notice);
  model.mesh = std::move(repaired.mesh);
  model.inspection = inspect(model.mesh);
}

void turn_outward(PreparedModel& model, Monitor& monitor) {
  const auto is_inward = [](const Shell& shell) { return shell.volume < 0; };
  if (std::any_of(model.inspection.shells.begin(), model.inspection.shells.end(), is_inward))
    adopt(model, orient_outward(std::move(model.mesh)), monitor);
}

PreparedModel remesh(PreparedModel model, const SurfacePolicy& policy, Monitor& monitor) {
  monitor.stage("remesh");
  if (model.inspection.open_edges > 0) {
    if (!holes_are_small(model.inspection, policy)) refuse_open(model, policy);
    monitor.notice(
        fmt::format("{} closed", plural(model.inspection.boundary_loops.size(), "hole is", "holes are")));
    adopt(model, fill_holes(std::move(model.mesh), hole_limit(model.inspection, policy)), monitor);
  }
  turn_outward(model, monitor);
  require_solid(model);
  monitor.check_interrupted();

  const Mesh original = std::move(model.mesh);
  model.level_set.emplace(original, policy.voxel_size, kLevelSetMemoryShare * available_memory_bytes(),
                          monitor);
  model.mesh = model.level_set->surface();
  if (model.mesh.triangles.empty()) {
    throw MeshError(fmt::format("{}: nothing is left of the model at a voxel size of {:.3g} mm",
                                name_of(model), policy.voxel_size),
                    "give a smaller --voxel");
  }
  model.inspection = inspect(model.mesh);
  std::vector<Vec3d> vertices(model.mesh.positions.size());
  std::transform(model.mesh.positions.begin(), model.mesh.positions.end(), vertices.begin(),
                 [](Vec3f position) { return to_double(position); });
  const std::vector<double> distances = SurfaceIndex(original).distances(vertices);
  model.outer_deviation = *std::max_element(distances.begin(), distances.end());
  return model;
}

// Voxel edge for remeshing that leaves room for the wall and the gap, mm.
double default_voxel_size(const PackingLimits& limits, const Box3f& box) {
  const double diagonal = diagonal_of(box);
  double size = diagonal / kFewestVoxelsAlongDiagonal;
  for (const double distance : {limits.wall, limits.gap}) {
    if (distance > 0) size = std::min(size, distance / kVoxelsBetweenSurfaces);
  }
  return std::max(size, diagonal / kMostVoxelsAlongDiagonal);
}

}  // namespace

PreparedModel load_and_inspect(const std::filesystem::path& path, const LoadOptions& options,
                               Monitor& monitor) {
  PreparedModel model;
  monitor.stage("load");
  LoadedModel loaded = load_model(path, options);
  for (const std::string& notice : loaded.notices) monitor.notice(notice);
  model.mesh = std::move(loaded.mesh);
  model.input.path = path;
  model.input.format = loaded.format;
  model.input.part_count = loaded.part_count;
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
  if (std::ranges::any_of(model.mesh.triangles, has_repeated_vertex))
    adopt(model, without_repeated_vertices(std::move(model.mesh)), monitor);
  if (model.inspection.misoriented_edges > 0)
    adopt(model, orient_consistently(std::move(model.mesh)), monitor);

  SurfaceMode mode = policy.mode;
  if (mode == SurfaceMode::automatic) {
    const bool mendable = model.inspection.open_edges > 0 && holes_are_small(model.inspection, policy);
    mode = mendable ? SurfaceMode::remesh : SurfaceMode::keep;
    if (mendable)
      monitor.notice(fmt::format("{}: {}; the surface is meshed anew (--surface remesh)", name_of(model),
                                 holes_in_words(model.inspection)));
  }
  if (mode == SurfaceMode::remesh) return remesh(std::move(model), policy, monitor);
  if (model.inspection.open_edges > 0) refuse_open(model, policy);
  turn_outward(model, monitor);
  require_solid(model);
  return model;
}

PreparedModel prepare_model(const HollowOptions& options, Monitor& monitor) {
  PreparedModel model = load_and_inspect(options.model, options.load, monitor);
  const double voxel_size =
      options.voxel_size.value_or(default_voxel_size(options.packing.limits(), model.inspection.box));
  return make_usable(std::move(model), {options.surface, options.max_hole, voxel_size}, monitor);
}

}  // namespace aerate
