#include "pipeline/support.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <functional>
#include <utility>

#include "check/same_triangles.h"
#include "core/error.h"
#include "core/surface_index.h"
#include "core/upright.h"
#include "files/formats.h"
#include "files/output_file.h"
#include "kernels/triangle_bvh.h"
#include "pipeline/announced_file.h"
#include "pipeline/job_log.h"
#include "pipeline/prepare.h"
#include "pipeline/scene_of.h"
#include "pipeline/view_files.h"

namespace aerate {
namespace {

// Across layers, about: half of what data sheets give for PLA, all of it for a usual resin and for AlSi10Mg as built.
constexpr double kFilamentStrength = 25, kResinStrength = 45, kMetalStrength = 300;

double strength_of(const Process& process) {
  if (process.drainage == Drainage::not_needed) return kFilamentStrength;
  return process.limits.contains(Limit::bridge) ? kMetalStrength : kResinStrength;
}

// Whole layers, at least one where any gap is wanted.
double in_layers(double gap, double layer, Monitor& monitor) {
  if (gap <= 0) return 0;
  const double layers = std::max(1.0, std::round(gap / layer));
  const double rounded = layers * layer;
  if (std::abs(rounded - gap) > 1e-6)
    monitor.notice(fmt::format("--contact-gap {:g} mm is rounded to {:g} mm: {:g} {} of {:g} mm", gap,
                               rounded, layers, layers == 1 ? "layer" : "layers", layer));
  return rounded;
}

// Half the width of bodies that voids drain in: no less than a hole and a wall take. What is wider leaves more material (docs/supports.md).
double foot_with_voids(const Process& process, double usual) {
  const auto channel = process.limits.find(Limit::channel), wall = process.limits.find(Limit::least_wall);
  if (process.drainage != Drainage::needed || channel == process.limits.end() || wall == process.limits.end())
    return usual;
  return std::max(usual, (channel->second.value + wall->second.value) / 2);
}

SupportShape shape_for(const SupportOptions& options, const SupportRules& rules, Monitor& monitor) {
  SupportShape shape = usual_shape(rules);
  if (options.foam) {
    shape.body.foot = foot_with_voids(options.process, shape.body.foot);
    shape.body.least_voxel = 0;
    // Roots reach into walls, not through them.
    const auto wall = options.process.limits.find(Limit::least_wall);
    if (wall != options.process.limits.end())
      shape.tooth.embedded = std::min(shape.tooth.embedded, wall->second.value);
  }
  if (options.stem) shape.body.foot = *options.stem / 2;
  if (options.clearance) shape.body.clearance = *options.clearance;
  if (options.tooth) shape.tooth.width = *options.tooth;
  shape.tooth.gap = in_layers(options.contact_gap.value_or(shape.tooth.gap), rules.layer, monitor);
  // A lower tooth is not printed.
  shape.tooth.least_height = 0.9 * rules.layer;
  if (shape.tooth.gap >= shape.body.clearance)
    throw UsageError(
        fmt::format(
            "a contact gap of {:g} mm leaves more free than the clearance of {:g} mm, so that teeth would "
            "not reach out of the body",
            shape.tooth.gap, shape.body.clearance),
        "give a smaller --contact-gap or --layer-height, or a larger --clearance");
  // What is joined to the model and to the plate cannot tip.
  shape.body.stands_alone = shape.tooth.gap > 0;
  // So that the body keeps its clearance below what it holds.
  shape.body.tooth_height = shape.body.clearance + 0.4;
  // What is too low for a body is left to teeth alone.
  shape.tooth.most_alone = std::max(
      shape.tooth.most_alone, shape.body.tooth_height + shape.body.clearance + shape.tooth.embedded + 2);
  return shape;
}

Mesh turned_back(Mesh mesh, const UprightFrame& frame) {
  if (frame.is_the_models_own()) return mesh;
  for (Vec3f& p : mesh.positions) {
    const Vec3d at = to_double(p);
    p = to_float(frame.x * at.x + frame.y * at.y + frame.z * at.z);
  }
  return mesh;
}

// Of a model above its plate: no printer is so high.
constexpr double kHighestLift = 1000;  // mm

double plate_for(const SupportOptions& options, const Mesh& upright) {
  const double lowest = static_cast<double>(bounding_box(upright).lower.z);
  if (!options.plate) return lowest;
  if (*options.plate > lowest + 1e-6)
    throw UsageError(fmt::format("--plate {:g}: the model begins {:g} mm below that, at {:g} mm along up",
                                 *options.plate, *options.plate - lowest, lowest),
                     "give no more than that, or leave it out for a plate at the model's lowest point");
  if (*options.plate < lowest - kHighestLift)
    throw UsageError(
        fmt::format("--plate {:g}: the model begins {:g} mm above that, supports are no higher than {:g} mm",
                    *options.plate, lowest - *options.plate, kHighestLift),
        "give a plate nearer to the model");
  return *options.plate;
}

// Where holes drain: what runs out has room between the body and the plate, the model and the teeth.
class RoomForHoles {
 public:
  RoomForHoles(const SurfaceIndex& model, const Mesh& teeth, double plate)
      : model_(model), teeth_(teeth.positions, teeth.triangles), plate_(plate) {}

  bool operator()(const Tube& hole) const {
    // A ball as wide as the hole in front of it, and one in its mouth.
    const Vec3d before = hole.end + direction_of(hole) * hole.radius;
    const double squared = hole.radius * hole.radius;
    const auto is_clear = [&](const kernels::TriangleBvhView& surface, Vec3d place) {
      return surface.nearest(place, squared).distance_squared >= squared;
    };
    return before.z - hole.radius >= plate_ && is_clear(model_.bvh(), before) &&
           is_clear(teeth_.view(), before) && is_clear(teeth_.view(), hole.end);
  }

 private:
  const SurfaceIndex& model_;
  kernels::HostTriangleBvh teeth_;
  double plate_;
};

// The height of the air below an overhang, mm.
double room_below(Vec3d place, const Undersides& undersides) {
  const auto column = undersides.column_at(place.x, place.y);
  double room = kInfinity, nearest = kInfinity;
  if (!column) return room;
  for (std::uint32_t i = undersides.first[*column]; i < undersides.first[*column + 1]; ++i) {
    const AirSpan& span = undersides.spans[i];
    if (std::abs(span.ceiling - place.z) >= nearest) continue;
    nearest = std::abs(span.ceiling - place.z);
    room = span.ceiling - std::max(span.floor, undersides.plate);
  }
  return room;
}

[[noreturn]] void refuse_unreached(const SupportFacts& facts, const Supports& supports,
                                   const SupportRules& rules, const SupportShape& shape,
                                   const Undersides& undersides, const UprightFrame& frame) {
  const Vec3d up = *facts.farthest_place;
  const Vec3d at = frame.x * up.x + frame.y * up.y + frame.z * up.z;
  const std::string far = std::isfinite(facts.farthest)
                              ? fmt::format("{:.2f} mm from what holds it", facts.farthest)
                              : std::string("held by nothing");
  if (supports.no_room == 0)
    throw FailureError(
        fmt::format("the result failed its check, so it was not kept: the overhang near ({:.2f}, "
                    "{:.2f}, {:.2f}) mm is {}, {:g} mm are allowed",
                    at.x, at.y, at.z, far, rules.reach),
        "please report this with the model and the options");
  const std::string why =
      room_below(up, undersides) > 2 * shape.tooth.gap + 2 * rules.layer
          ? std::string("no tooth that stands reaches it: it is too narrow, or walls are beside it")
          : fmt::format("no support fits there: what is below is nearer than two gaps of {:g} mm and a layer",
                        shape.tooth.gap);
  throw MeshError(fmt::format("the overhang near ({:.2f}, {:.2f}, {:.2f}) mm is {}, and {}; {:.1f} mm2 of "
                              "overhangs are left in all",
                              at.x, at.y, at.z, far, why, facts.unsupported_area),
                  fmt::format("give a smaller --contact-gap, print it another way --up, let the slicer make "
                              "supports there, or leave it: "
                              "'aerate support --leave {:g}'",
                              std::ceil(facts.unsupported_area)));
}

// Of a model's box, of which all voxels are looked at: 630 mm cubed.
constexpr double kLargestBox = 2.5e8;  // mm3

// Columns wider than what has to be held see no overhang, and hold none.
double require_columns(const Mesh& upright, const SupportRules& rules) {
  const double spacing = column_spacing(upright, rules);
  const Box3f box = bounding_box(upright);
  const Vec3d size = to_double(box.upper) - to_double(box.lower);
  if (spacing <= rules.reach && size.x * size.y * size.z > kLargestBox)
    throw MeshError(
        fmt::format("the model's box is {:g} x {:g} x {:g} mm, {:g} times as large as what supports are "
                    "made for, which is {:g} m3",
                    size.x, size.y, size.z, std::ceil(size.x * size.y * size.z / kLargestBox),
                    kLargestBox / 1e9),
        "are --unit and --scale right? Make supports for pieces of it");
  if (spacing <= rules.reach) return spacing;
  throw MeshError(
      fmt::format(
          "the model is {:g} x {:g} mm seen from above, so large that overhangs are looked for {:.3g} mm "
          "apart, and {:g} mm have to be held",
          size.x, size.y, spacing, rules.reach),
      "are --unit and --scale right? Make supports for pieces of it");
}

// Of a model so small that what hangs over on it is nearer to what holds it, whatever it is.
NothingToRemoveError with_its_size(const NothingToRemoveError& error, const Mesh& upright,
                                   const SupportRules& rules) {
  const Box3f box = bounding_box(upright);
  const Vec3d size = to_double(box.upper) - to_double(box.lower);
  if (std::max(size.x, size.y) > 2 * rules.reach) return error;
  return NothingToRemoveError(
      fmt::format("{}; the model is {:.3g} x {:.3g} x {:.3g} mm", error.what(), size.x, size.y, size.z),
      "are --unit and --scale right?");
}

}  // namespace

SupportReport support_model(const SupportOptions& options, Monitor& monitor) {
  SupportRules rules = require_support_rules(options.process, options.given);
  const MeshFormat& format = format_to_write(options.output);
  if (options.parts_for != nullptr && &format != &MeshFormat::three_mf)
    throw UsageError(fmt::format("{}: model and supports as parts need a 3MF", options.output.string()),
                     "give a name that ends in .3mf, or leave out --parts");
  if (options.parts_for != nullptr && options.foam)
    throw UsageError(
        "--fill makes voids, and --parts is for a plain body: its settings print one perimeter and next to "
        "no "
        "infill, so that there is nothing for voids to take",
        "leave out --fill, or --parts");
  if (options.parts_for != nullptr && !rules.is_filament)
    throw UsageError(
        fmt::format("--parts is for filament: its settings are of perimeters and infill, which {} "
                    "does not print with",
                    options.process.name),
        "leave out --parts for supports alone, or give --process fdm");
  JobLog log(monitor);
  if (options.layer_height) rules.layer = *options.layer_height;
  SupportReport report;
  report.shape = shape_for(options, rules, log);
  AnnouncedFile pending(options.output, log);
  ViewFiles views(options.views, log);

  PreparedModel model = load_and_inspect({options.model, nullptr}, options.load, log);
  model = make_usable(std::move(model), {.mode = SurfaceMode::keep, .weld = options.weld}, log);
  const UprightFrame frame(options.direction.up);
  const Mesh& own = model.mesh;
  const Mesh turned = frame.is_the_models_own() ? Mesh{} : turned_upright(own, frame);
  const Mesh& upright = frame.is_the_models_own() ? own : turned;
  const double plate = plate_for(options, upright);

  log.stage("overhangs");
  const SurfaceIndex index(upright);
  const Undersides undersides =
      find_undersides(upright, index.winding(), rules, plate, require_columns(upright, rules));
  report.overhangs = {undersides.spacing, overhang_regions(undersides, rules)};
  log.check_interrupted();

  log.stage("supports");
  Supports supports = [&] {
    try {
      return make_supports(index, undersides, rules, report.shape, log);
    } catch (const NothingToRemoveError& error) {
      throw with_its_size(error, upright, rules);
    }
  }();
  Mesh body = std::move(supports.body);
  report.body_volume = signed_volume(body);
  if (options.foam && !body.triangles.empty()) {
    log.stage("foam");
    const RoomForHoles room(index, supports.teeth, plate);
    FoamedBody foamed = options.foam(body, std::cref(room), log);
    body = std::move(foamed.mesh);
    report.foam = foamed.words;
  }
  const std::size_t body_triangles = body.triangles.size();
  const Mesh made = turned_back(joined(body, supports.teeth), frame);

  log.stage("write");
  const bool are_parts = options.parts_for != nullptr;
  std::vector<ObjectPart> parts;
  if (are_parts) {
    std::vector<PartSetting> settings = options.parts_for->modifiers->support_settings;
    if (options.extruder) settings.push_back({"extruder", fmt::format("{}", *options.extruder)});
    report.part_settings = settings;
    parts = support_parts(own.triangles.size(), made.triangles.size(), std::move(settings));
    write_bytes(options.parts_for->modifiers->file(joined(own, made), parts.front(), parts.back(), ""),
                pending.file());
  } else {
    write_mesh(made, pending.file(), format);
  }
  log.check_interrupted();
  log.stage("check");
  Mesh read = read_back(pending.file().path(), format, log);
  if (are_parts) {
    if (options.parts_for->modifiers->read(pending.file().path()) != parts)
      throw FailureError(
          "the result failed its check, so it was not kept: its parts are not the model and its supports",
          "please report this with the model and the options");
    require_same_triangles(read, joined(own, made), log);
    read.triangles.erase(read.triangles.begin(),
                         read.triangles.begin() + static_cast<std::ptrdiff_t>(own.triangles.size()));
    drop_unused_vertices(read);
  } else {
    require_same_triangles(read, made, log);
  }
  report.facts =
      check_supports(frame.is_the_models_own() ? read : turned_upright(read, frame), body_triangles, index,
                     undersides, rules, report.shape, !report.foam.empty(), log);
  if (report.facts.unsupported_area > options.most_left)
    refuse_unreached(report.facts, supports, rules, report.shape, undersides, frame);

  if (report.facts.unsupported_area > 0) {
    const Vec3d at = *report.facts.farthest_place;
    const Vec3d place = frame.x * at.x + frame.y * at.y + frame.z * at.z;
    log.notice(fmt::format(
        "{:.1f} mm2 of overhangs have no room for teeth, among them near ({:.2f}, {:.2f}, {:.2f}) mm",
        report.facts.unsupported_area, place.x, place.y, place.z));
  }

  report.input = model.input;
  report.process = options.process;
  report.direction = options.direction;
  report.rules = rules;
  report.tooth_count = supports.tooth_count;
  report.foot_count = supports.foot_count;
  report.tip_area = supports.tip_area;
  report.strength = strength_of(options.process);
  report.parts_for = options.parts_for;
  report.output = options.output;
  report.output_bytes = std::filesystem::file_size(pending.file().path());
  views.write([&] { return scene_of(joined(own, made), report); }, log);
  end_job(log, report, [&] { views.commit_with({&pending.file()}); });
  return report;
}

}  // namespace aerate
