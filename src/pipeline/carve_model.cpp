#include "pipeline/carve_model.h"

#include <cstdint>
#include <fmt/format.h>
#include <optional>
#include <span>
#include <utility>

#include "pipeline/budget.h"
#include "pipeline/carve_as_cells.h"
#include "pipeline/held_notices.h"
#include "pipeline/pack.h"
#include "pipeline/print_prediction.h"
#include "pipeline/solid_file.h"
#include "pipeline/worthy_modifiers.h"
#include "printing/carve.h"

namespace aerate {
namespace {

// Refuses what cannot be made before the long stages, and says what sealed voids would mean.
PackingRequest request_of(const HollowOptions& options, Monitor& monitor) {
  // Modifiers have no walls to pay for, and leave the model solid.
  if (options.modifiers) {
    require_modifiers_that_save(options);
    return options.packing;
  }
  PackingRequest request = without_voids_that_cost(options.packing, options, monitor);
  if (options.drainage) {
    require_room_for_tubes(*options.drainage, request.limits());
  } else {
    warn_of_trapped_material(options.packing.process.process, monitor);
  }
  return request;
}

// The tolerance at which the voids take no more triangles than are allowed, and no more memory than there is.
double tolerance_within(const Packing& packing, std::size_t outer_triangles, const HollowOptions& options,
                        Monitor& monitor) {
  const std::size_t copies = options.support_blockers == nullptr ? 1 : 2;
  const double tolerance =
      tolerance_for(packing, options.tolerance, outer_triangles, options.max_triangles, copies);
  notice_if_loosened(tolerance, options.tolerance, options.max_triangles, monitor);
  require_memory_for_voids(packing, tolerance, outer_triangles, copies);
  return tolerance;
}

Solid carve_sealed(const PreparedModel& model, const Packing& packing, double tolerance, Monitor& monitor) {
  const CarveOptions options{.tolerance = tolerance};
  if (model.level_set) return model.level_set->subtract(packing, options, monitor);
  return carve_keeping_surface(model.mesh, packing, options, monitor);
}

void warn_of_many_triangles(const CarvedModel& carved, std::size_t outer_triangles,
                            const HollowOptions& options, Monitor& monitor) {
  constexpr std::size_t kMany = 1000000;
  const std::size_t count = triangles_written(carved.solid, options);
  if (count <= kMany || count <= 2 * outer_triangles) return;
  monitor.notice(fmt::format(
      "the result has {} triangles, the model {}: slicers may be slow with it; --max-triangles or a larger "
      "--tolerance gives fewer",
      count, outer_triangles));
}

// `outer` has the holes of voids that drain.
CarvedModel carve(const PreparedModel& model, const SurfaceIndex& surface, const Packing& packing,
                  const std::optional<DrainedVoids>& drained, OuterWithHoles outer,
                  const HollowOptions& options, Monitor& monitor) {
  const double tolerance = tolerance_within(packing, model.mesh.triangles.size(), options, monitor);
  monitor.stage("carve");
  CarvedModel carved = drained ? carve_within(model, surface, packing, drained->plan, std::move(outer),
                                              tolerance, options.max_triangles, monitor)
                               : CarvedModel{carve_sealed(model, packing, tolerance, monitor), tolerance};
  warn_of_many_triangles(carved, model.mesh.triangles.size(), options, monitor);
  monitor.check_interrupted();
  return carved;
}

// Voids in the shapes of a packing, as far as they drain if the options ask for it.
MadeVoids make_spheres(const PreparedModel& model, const SurfaceIndex& surface, Packing packing,
                       const ProcessChoice& process, const HollowOptions& options, Monitor& monitor) {
  if (options.modifiers && options.packing.spheres.empty() && is_default(process, Limit::min_radius)) {
    const double tolerance = tolerance_within(packing, model.mesh.triangles.size(), options, monitor);
    packing = worthy_modifiers(
        model, packing, options,
        [&](const Packing& some) { return carve_sealed(model, some, tolerance, monitor); }, monitor);
  }
  auto [made, drainage, outer] = drain(model, surface, std::move(packing), process, options, monitor);
  CarvedModel carved = carve(model, surface, made, drainage, std::move(outer), options, monitor);
  return {std::move(made), std::nullopt, std::move(drainage), std::move(carved)};
}

MadeVoids make_cells(const PreparedModel& model, const SurfaceIndex& surface, Packing packing,
                     const HollowOptions& options, Monitor& monitor) {
  auto [cells, drainage, carved] = carve_as_cells(model, surface, packing, options, monitor);
  warn_of_many_triangles(carved, model.mesh.triangles.size(), options, monitor);
  return {std::move(packing), std::move(cells), std::move(drainage), std::move(carved)};
}

// Makes some of those voids again, as they were made. All that is given has to outlive it.
MakeSome maker_of_some(const PreparedModel& model, const SurfaceIndex& surface, const MadeVoids& all,
                       const ProcessChoice& process, const HollowOptions& options) {
  const double tolerance = all.carved.tolerance;
  if (all.cells)
    return [&model, &surface, &options, tolerance, cells = *all.cells, packing = all.packing](
               std::span<const std::uint32_t> voids, Monitor& within) {
      auto [made, drainage, carved] = carve_some_cells(model, surface, with_only(cells, voids),
                                                       packing.limits, options, tolerance, within);
      return MadeVoids{packing, std::move(made), std::move(drainage), std::move(carved)};
    };
  return [&model, &surface, &process, &options, packing = all.packing](std::span<const std::uint32_t> voids,
                                                                       Monitor& within) {
    return make_spheres(model, surface, with_only(packing, voids), process, options, within);
  };
}

HollowedModel carve_once(const HollowOptions& options, PreparedModels& models, Monitor& monitor) {
  PackingRequest request = request_of(options, monitor);
  std::shared_ptr<const PreparedModel> prepared = models.get(options, monitor);
  const PreparedModel& model = *prepared;
  request = sized_for(model, std::move(request), monitor);
  auto [packing, surface] = pack_model(model, request, monitor);
  if (options.cells) packing.limits = request.limits();
  HeldNotices held(monitor);
  Monitor& making = options.target || options.stand ? held : monitor;
  MadeVoids made = options.cells
                       ? make_cells(model, surface, std::move(packing), options, making)
                       : make_spheres(model, surface, std::move(packing), request.process, options, making);
  made.notices = held.take();
  std::optional<TargetFacts> target;
  std::optional<StandFacts> stand;
  if (options.target) {
    monitor.stage("target");
    const MakeSome make_some = maker_of_some(model, surface, made, request.process, options);
    made = to_target(model, *options.target, options.material, std::move(made), make_some, target.emplace(),
                     monitor);
  } else if (options.stand) {
    monitor.stage("stand");
    const MakeSome make_some = maker_of_some(model, surface, made, request.process, options);
    made = to_stand(model, *options.stand, request.limits().roof.up, std::move(made), make_some,
                    stand.emplace(), monitor);
  }
  return {std::move(request),
          std::move(prepared),
          std::move(surface),
          std::move(made.packing),
          std::move(made.cells),
          std::move(made.drainage),
          std::move(made.carved),
          target,
          stand};
}

}  // namespace

// Voxels that were not asked for become finer until they hold the voids.
HollowedModel carve_model(const HollowOptions& options, PreparedModels& models, Monitor& monitor) {
  constexpr int kMostTries = 4;
  HollowOptions tried = options;
  for (int tries = 1;; ++tries) {
    try {
      return carve_once(tried, models, monitor);
    } catch (const VoxelsTooCoarse& error) {
      if (options.voxel_size || tries == kMostTries) throw;
      tried.voxel_size = error.fine_enough();
      monitor.notice(fmt::format("{}; voxels of {:g} mm are taken", error.what(), *tried.voxel_size));
    }
  }
}

std::optional<HollowedModel> open_without_voids(const HollowOptions& options, PreparedModels& models,
                                                Monitor& monitor) {
  if (!options.opens_cavities) return std::nullopt;
  std::shared_ptr<const PreparedModel> model = models.get(options, monitor);
  if (model->opened->cavities.empty()) return std::nullopt;
  SurfaceIndex surface(model->mesh);
  Solid solid{model->mesh, {}};
  solid.close_part(PartKind::outer);
  return HollowedModel{options.packing,
                       std::move(model),
                       std::move(surface),
                       Packing{{}, options.packing.limits(), {}, {}},
                       std::nullopt,
                       std::nullopt,
                       CarvedModel{std::move(solid), options.tolerance}};
}

}  // namespace aerate
