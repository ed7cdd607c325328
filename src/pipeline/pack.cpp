#include "pipeline/pack.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/error.h"
#include "core/overhang.h"
#include "files/sphere_table.h"
#include "files/weld.h"
#include "packing/largest_places.h"
#include "packing/spread_out.h"
#include "packing/verify.h"
#include "pipeline/announced_file.h"
#include "pipeline/budget.h"
#include "pipeline/job_log.h"
#include "pipeline/keep_solid.h"
#include "pipeline/pack_cells.h"
#include "pipeline/print_prediction.h"
#include "pipeline/scene_of.h"
#include "pipeline/solid_file.h"
#include "pipeline/view_files.h"

namespace aerate {
namespace {

Packing given_packing(const PackingRequest& request) {
  Packing packing;
  packing.limits = request.sphere_limits();
  packing.spheres = read_sphere_table(request.spheres);
  packing.statistics.candidates = packing.spheres.size();
  packing.device.reason = "the spheres were given";
  return packing;
}

// Spheres of a file have to be a packing of this model under these limits.
void require_no_fault(const PreparedModel& model, const SurfaceIndex& surface, const Packing& packing,
                      const PackingRequest& request) {
  const auto fault = find_fault(model.room_surface(surface), packing);
  if (!fault) return;

  const PackingLimits& limits = packing.limits;
  const std::string file = request.spheres.filename().string();
  const Sphere& sphere = packing.spheres[fault->sphere];
  const std::string which =
      fmt::format("{}: sphere {} (radius {:.4g} mm at ({:.3f}, {:.3f}, {:.3f}) mm)", file, fault->sphere + 1,
                  sphere.radius, sphere.centre.x, sphere.centre.y, sphere.centre.z);
  const bool has_roof =
      limits.roof.shapes(sphere.radius) ||
      (fault->kind == PackingFault::Kind::gap && limits.roof.shapes(packing.spheres[fault->other].radius));
  const char* const roof = has_roof ? " with the roofs that --bridge and --overhang ask for" : "";
  const auto radius_fault = [&](const char* relation, const char* option, double limit) {
    return InputError(fmt::format("{} is {} {} {:.4g} mm", which, relation, option, limit),
                      fmt::format("give the {} it was packed with, or pack again", option));
  };
  const bool is_kept = model.kept && model.kept->holds(sphere.centre);
  if (is_kept) throw InputError(which + " is in a region of --keep-solid", "pack again with --keep-solid");
  const char* const kept = model.kept ? " (to the surface or to a region of --keep-solid)" : "";
  switch (fault->kind) {
    case PackingFault::Kind::outside:
      throw InputError(which + " is outside the model",
                       "are the list and the model in the same unit and place?");
    case PackingFault::Kind::overlapped_region:
      throw InputError(which + " is where parts of the model overlap, and a slicer would fill it",
                       "unite the parts first, or pack this model anew");
    case PackingFault::Kind::wall:
      throw InputError(
          fmt::format("{}{} leaves a wall of {:.4g} mm{}, the limit is {:.4g} mm", which, roof,
                      fault->clearance, kept, limits.wall),
          fmt::format("give the {} it was packed with, or pack again", has_roof ? "--bridge" : "--wall"));
    case PackingFault::Kind::gap:
      throw InputError(
          fmt::format("{}{} leaves a gap of {:.4g} mm to sphere {}, the limit is {:.4g} mm", which, roof,
                      fault->clearance, fault->other + 1, limits.gap),
          fmt::format("give the {} it was packed with, or pack again", has_roof ? "--bridge" : "--gap"));
    case PackingFault::Kind::too_small:
      throw radius_fault("smaller than", "--min-radius", limits.min_radius);
    case PackingFault::Kind::too_large:
      throw radius_fault("larger than", "--max-radius", limits.max_radius);
  }
  throw FailureError("unknown fault of a packing");
}

// A lattice's places have room for spheres, not for roofs above them.
void require_room_for_roofs(const PackingMethod& method, const PackingLimits& limits) {
  if (!method.on_lattice || !limits.roof.shapes(limits.max_radius)) return;
  throw UsageError(
      fmt::format("--packing {} with spheres of --max-radius {:g} mm: their ceilings are wider than "
                  "--bridge {:g} mm, and a lattice has no room for roofs",
                  method.name, limits.max_radius, limits.roof.bridge()),
      fmt::format("give --max-radius {:g} or less, or --packing adaptive; with --bridge {:g} spheres of this "
                  "size stay as they are",
                  largest_without_roof(limits.roof), std::ceil(2 * limits.max_radius)));
}

// Where parts of the model overlap, the packers take a region for what is filled once.
void leave_out_kept(const PreparedModel& model, Packing& packing) {
  if (model.kept)
    packing.statistics.overlapped_region += std::erase_if(
        packing.spheres, [&](const Sphere& sphere) { return model.kept->holds(sphere.centre); });
}

Packing pack_unverified(const PreparedModel& model, const PackingRequest& request, Monitor& monitor) {
  if (!request.spheres.empty()) return given_packing(request);
  require_room_for_roofs(*request.method, request.sphere_limits());
  PackingStop stop = request.stop;
  stop.volume = model.inspection.filled_volume;
  Packing packing =
      request.method->pack(model.room(), request.sphere_limits(), stop, monitor, request.device);
  leave_out_kept(model, packing);
  return packing;
}

// Where the packing has found no place although there are some: it looks from the centres of a grid's cells.
Packing packed_from_samples(const PreparedModel& model, const SurfaceIndex& room,
                            const PackingRequest& request, Packing packing, Monitor& monitor) {
  if (!request.spheres.empty() || request.method->on_lattice) return packing;
  PackingStop stop = request.stop;
  stop.volume = model.inspection.filled_volume;
  packing.spheres = largest_places(room, request.sphere_limits(), stop, monitor);
  leave_out_kept(model, packing);
  return verify_packing(room, std::move(packing));
}

// Of what is filled: more than this lies in several parts.
constexpr double kMostlyOverlapped = 0.5;

// Says what would fit, and which limit stands in the way.
[[noreturn]] void refuse_empty(const PreparedModel& model, const SurfaceIndex& surface,
                               const PackingRequest& request, Monitor& monitor) {
  const PackingLimits limits = request.sphere_limits();
  const std::string file =
      model.input.path.filename().string() + (model.kept ? ", less what --keep-solid keeps" : "");
  const Sphere largest = largest_inscribed_sphere(surface, monitor);
  // Rounded first, so that nothing reads as -0.0.
  const auto tenths = [](double coordinate) { return std::round(coordinate * 10) / 10 + 0.0; };
  const std::string place = fmt::format("({:.1f}, {:.1f}, {:.1f}) mm", tenths(largest.centre.x),
                                        tenths(largest.centre.y), tenths(largest.centre.z));
  const double fitting = largest.radius - limits.wall;
  if (model.kept && largest.radius <= 0)
    throw NothingToRemoveError(file + ": nothing to remove: the regions leave nothing of the model",
                               "give smaller regions");
  if (model.inspection.overlapped_volume > kMostlyOverlapped * model.inspection.filled_volume) {
    throw NothingToRemoveError(
        fmt::format("{}: nothing to remove: parts overlap in {:.5g} of {:.5g} mm3, which stay solid", file,
                    model.inspection.overlapped_volume, model.inspection.filled_volume),
        "'aerate hollow --surface remesh' unites the parts");
  }
  if (fitting <= 0) {
    throw NothingToRemoveError(
        fmt::format("{}: nothing to remove: the model is thinner than twice the wall of {:.3g} mm; without "
                    "any wall the largest sphere that fits has radius {:.3g} mm, near {}",
                    file, limits.wall, largest.radius, place),
        largest.radius < limits.min_radius
            ? fmt::format(
                  "not even without a wall would a void of --min-radius {:.3g} mm fit: are --unit and "
                  "--scale right?",
                  limits.min_radius)
            : fmt::format("give a --wall well below {:.3g} mm", largest.radius));
  }
  const bool on_lattice = request.method->on_lattice;
  if (request.pays_in && (fitting < limits.min_radius || !on_lattice)) {
    const std::string what_fits =
        fitting < limits.min_radius
            ? fmt::format("the largest that fits has radius {:.3g} mm, near {}", fitting, place)
            : fmt::format("a sphere of radius {:.3g} mm fits near {}, but {}", fitting, place,
                          limits.roof.shapes(fitting) ? "not with the roof that it needs"
                                                      : "no such place was found");
    throw NothingToRemoveError(
        fmt::format(
            "{}: nothing would be saved: at {:g} % infill a void takes less filament than it saves only "
            "above a radius of {:.2f} mm, and with a wall of {:.3g} mm {}",
            file, 100 * request.pays_in->infill, limits.min_radius, limits.wall, what_fits),
        where_voids_pay(fitting, *request.pays_in));
  }
  if (fitting < limits.min_radius) {
    throw NothingToRemoveError(
        fmt::format("{}: nothing to remove: with a wall of {:.3g} mm the largest sphere that fits has radius "
                    "{:.3g} mm, near {}, which is less than --min-radius {:.3g} mm",
                    file, limits.wall, fitting, place, limits.min_radius),
        "give a smaller --wall or --min-radius");
  }
  if (!on_lattice && !limits.roof.shapes(limits.min_radius)) {
    throw NothingToRemoveError(
        fmt::format("{}: nothing to remove: with a wall of {:.3g} mm a sphere of radius {:.3g} mm fits near "
                    "{}, but no place was found for one of --min-radius {:.3g} mm",
                    file, limits.wall, fitting, place, limits.min_radius),
        "give a smaller --min-radius or --wall");
  }
  if (!on_lattice) {
    throw NothingToRemoveError(
        fmt::format(
            "{}: nothing to remove: with a wall of {:.3g} mm a sphere of radius {:.3g} mm fits near {}, "
            "but without the roof that it needs above a ceiling wider than --bridge {:g} mm",
            file, limits.wall, fitting, place, limits.roof.bridge()),
        "give a smaller --min-radius or --wall, or a larger --bridge");
  }
  throw NothingToRemoveError(
      fmt::format("{}: nothing to remove: no place of the packing's lattice fits, although with a wall of "
                  "{:.3g} mm a sphere of radius {:.3g} mm fits near {}",
                  file, limits.wall, fitting, place),
      fmt::format("give a --max-radius of about {:.2g} mm or less", fitting / 2));
}

// Centres of cells are so far from each other at least: nearly as far as those of the largest spheres are.
double spacing_of_cells(const PackingLimits& limits) {
  constexpr double kShare = 0.75;
  return kShare * (2 * limits.max_radius + limits.gap);
}

}  // namespace

PackingRequest sized_for(const PreparedModel& model, PackingRequest request, Monitor& monitor) {
  if (!request.is_for_cells || !request.spheres.empty() || request.method->on_lattice) return request;
  // The largest few that were asked for are taken as they come, and so are all those from a given radius, and the
  // lattice whose cells carry their own ceilings, unless windows have to be found in these.
  const bool is_sized =
      !is_default(request.process, Limit::min_radius) || request.stop.max_count != PackingStop{}.max_count;
  const bool drains = request.process.limits.contains(Limit::channel);
  if (!is_sized && (drains || !request.limits().roof.limits_ceilings()))
    request.spacing = spacing_of_cells(request.limits());
  PackingStop first_alone = request.stop;
  first_alone.max_count = 1;
  first_alone.effort = PackingEffort::normal;
  first_alone.volume = model.inspection.filled_volume;
  const Packing largest =
      request.method->pack(model.room(), request.sphere_limits(), first_alone, monitor, request.device);
  if (!largest.spheres.empty())
    request.process = evenly_large(std::move(request.process), largest.spheres.front().radius);
  return request;
}

PackedModel pack_model(const PreparedModel& model, const PackingRequest& request, Monitor& monitor) {
  require_memory_for_packing(model.room(), request);
  monitor.stage("pack");
  Packing packing = pack_unverified(model, request, monitor);
  if (request.spacing) packing.spheres = spread_out(packing.spheres, *request.spacing);
  monitor.check_interrupted();

  monitor.stage("verify");
  SurfaceIndex surface(model.mesh);
  const SurfaceIndex& room = model.room_surface(surface);
  if (!request.spheres.empty()) require_no_fault(model, surface, packing, request);
  packing = verify_packing(room, std::move(packing));
  monitor.check_interrupted();
  if (packing.spheres.empty())
    packing = packed_from_samples(model, room, request, std::move(packing), monitor);
  if (packing.spheres.empty()) refuse_empty(model, room, request, monitor);

  if (model.inspection.parts_overlap() && packing.statistics.overlapped_region > 0)
    monitor.notice(
        fmt::format("parts of the model overlap in about {:.3g} mm3, which stay solid; 'aerate hollow "
                    "--surface remesh' unites the parts first",
                    model.inspection.overlapped_volume));
  return {std::move(packing), std::move(surface)};
}

namespace {

// The report, and the shapes of cells where pieces or pictures were made of them.
struct PackedShapes {
  PackReport report;
  std::optional<CellVoids> shapes;
};

PackedShapes pack_shapes(const PackOptions& options, Monitor& monitor) {
  // Refuses what cannot be written.
  const bool is_written = !options.output.empty();
  const auto cells = options.cells ? std::optional(cell_format_of(options.output)) : std::nullopt;
  const auto spheres =
      cells || !is_written ? std::nullopt : std::optional(sphere_format_to_write(options.output));

  JobLog log(monitor);
  PackedShapes packed;
  PackReport& report = packed.report;
  report.method = name_of_method(options.packing);
  report.output = options.output;
  LoadOptions load = options.load;
  load.wanted_modifiers = names_of_regions(options.keep_solid);
  PreparedModel model = load_and_inspect({options.model, options.arrays}, load, log);
  std::optional<AnnouncedFile> file;
  if (is_written) file.emplace(options.output, log);
  ViewFiles views(options.views, log);
  model = make_usable(std::move(model), {.mode = SurfaceMode::keep, .weld = options.weld}, log);
  model.kept =
      keep_solid(model, options.keep_solid, {options.load, options.weld, options.packing.limits().wall}, log);
  report.input = model.input;
  const PackingRequest request = sized_for(model, options.packing, log);
  report.process = request.process;
  report.limits = request.limits();
  auto [packing, surface] = pack_model(model, request, log);
  report.packing = std::move(packing);
  report.density = total_volume(report.packing) / model.inspection.filled_volume;

  log.stage("measure");
  report.clearances = measure_clearances(surface, report.packing.spheres, report.packing.limits.roof);
  if (model.kept)
    report.kept = {
        model.kept->count, model.kept->volume,
        measure_clearances(model.kept->within, report.packing.spheres, report.packing.limits.roof).wall};
  if (cells) {
    Packing of_cells = report.packing;
    of_cells.limits = report.limits;
    WrittenCells written =
        write_cells(model, surface, of_cells, options, *cells, file ? &*file : nullptr, log);
    packed.shapes = std::move(written.shapes);
    report.cells = written.facts;
    report.output_bytes = report.cells->file_bytes;
    if (report.kept && report.cells->pieces) report.kept->wall = report.cells->pieces->kept_wall;
  } else if (spheres) {
    log.stage("write");
    const std::string table = sphere_table(report.packing, *spheres, model.inspection.box);
    report.output_bytes = table.size();
    write_bytes(table, file->file());
  }
  const auto& shapes = packed.shapes;
  views.write(
      [&, &of_model = surface] {
        return scene_of(model, of_model, report, shapes ? &*shapes : nullptr, log);
      },
      log);
  end_job(log, report,
          [&] { views.commit_with(file ? std::vector{&file->file()} : std::vector<PendingFile*>{}); });
  return packed;
}

}  // namespace

PackReport pack(const PackOptions& options, Monitor& monitor) {
  return pack_shapes(options, monitor).report;
}

PackedPieces pack_pieces(const PackOptions& options, Monitor& monitor) {
  PackedShapes packed = pack_shapes(options, monitor);
  PackedPieces result{std::move(packed.report), {}};
  if (result.report.cells && result.report.cells->pieces)
    result.pieces = as_read_back(pieces_of(*packed.shapes));
  return result;
}

}  // namespace aerate
