#include "pipeline/drain.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>
#include <limits>
#include <map>
#include <numbers>
#include <optional>
#include <span>
#include <string>
#include <tbb/parallel_for.h>
#include <utility>
#include <variant>
#include <vector>

#include "check/crossings.h"
#include "core/ceiling.h"
#include "core/error.h"
#include "core/listed.h"
#include "core/upright.h"
#include "kernels/constants.h"
#include "mesh/outward_shells.h"
#include "packing/cells/cell_drainage.h"
#include "packing/drainage_refusals.h"
#include "packing/hole_showing.h"
#include "printing/carve_drained.h"
#include "printing/cells/carve_drained_cells.h"
#include "printing/cut_holes.h"
#include "printing/tube_openings.h"

namespace aerate {
namespace {

const SurfaceIndex* kept_in(const PreparedModel& model) {
  return model.kept ? &model.kept->within : nullptr;
}

// Of the voids' volume: so much it is worth that no hole opens onto the build plate.
constexpr double kWorthOfPlate = 0.03;

// Of the voids' volume: so much it is worth that no layer sucks at more than may be.
constexpr double kWorthOfSuction = 0.1;

// By this factor the tolerance is loosened, so many times at most.
constexpr double kLooser = 1.25;
constexpr int kMostTries = 12;

// Places at which the surface turns out not to be cut, before that is an error.
constexpr std::size_t kMostRefused = 100;

std::string reasons(const UndrainedVoids& dropped, const DrainageRequest& request) {
  std::string text;
  const auto add = [&](std::size_t count, const char* why) {
    if (count > 0) text += fmt::format("{}{} {}", text.empty() ? "" : ", ", count, why);
  };
  add(dropped.narrow, "too small for a channel");
  add(dropped.unreached, "with no room for a channel");
  add(dropped.unopened, request.escape_holes.size() >= 2
                            ? "that the places asked for do not lead to"
                            : "in groups with no place for two escape holes, or not worth them");
  add(dropped.full, "that would stay full");
  return text;
}

// What is worth trying, where many voids have no way out for the holes' width.
std::string what_would_reach_them(const UndrainedVoids& dropped, const DrainageRequest& request) {
  const bool may_be_narrower =
      request.hole_radius > request.channel_radius && request.narrow_hole_radius == 0;
  if (!may_be_narrower || 2 * dropped.unopened < dropped.count() || request.escape_holes.size() >= 2)
    return {};
  return fmt::format("; narrower holes may find more places (--hole-diameter between {:g} and {:g} mm)",
                     2 * request.channel_radius, 2 * request.hole_radius);
}

// `plate`: the height of the model's lowest point.
void tell_of(const DrainedVoids& drainage, std::size_t packed, double plate, Monitor& monitor) {
  const UndrainedVoids& dropped = drainage.dropped;
  if (dropped.count() > 0)
    monitor.notice(fmt::format("{} of {} ({:.1f} mm3) cannot be drained and {} not made: {}{}",
                               dropped.count(), counted(packed, "void", "voids"), dropped.volume,
                               dropped.count() == 1 ? "is" : "are", reasons(dropped, drainage.request),
                               what_would_reach_them(dropped, drainage.request)));
  if (const std::size_t narrow = drainage.count_narrow_holes(); narrow > 0)
    monitor.notice(
        fmt::format("{} of {} escape holes {} {:g} mm wide, as channels are: there is no place for {:g} mm "
                    "(--hole-diameter {:g} leaves out what these do not reach)",
                    narrow, drainage.plan.holes.size(), narrow == 1 ? "is" : "are",
                    2 * drainage.request.narrow_hole_radius, 2 * drainage.request.hole_radius,
                    2 * drainage.request.hole_radius));
  const auto sealed = std::ranges::count_if(drainage.plan.holes, [&](const EscapeHole& hole) {
    return opens_onto_plate(hole.tube, drainage.plan.roof.up, plate);
  });
  if (sealed > 0)
    monitor.notice(fmt::format(
        "{} of {} escape holes {} onto the build plate, which closes {} while the model is printed standing "
        "on it: print "
        "it on supports",
        sealed, drainage.plan.holes.size(), sealed == 1 ? "opens" : "open", sealed == 1 ? "it" : "them"));
  const TrappedPools& pools = drainage.plan.pools;
  if (pools.after_both > kPoolsAimedAt * pools.total)
    monitor.notice(fmt::format(
        "{:.1f} mm3 ({:.2f} % of the voids) cannot run out, neither in print orientation nor upside down",
        pools.after_both, 100 * pools.after_both / pools.total));
}

// Throws UsageError unless fp32 can hold the sides of such a tube anywhere in the model.
void require_resolvable(const Mesh& model, double radius, double tolerance, const char* what) {
  constexpr double kStepsPerSide = 8;
  const double largest = largest_coordinate(model);
  const double step = largest * static_cast<double>(std::numeric_limits<float>::epsilon());
  const auto sides = static_cast<double>(sides_of({{}, {}, radius}, tolerance));
  if (2 * radius * std::sin(std::numbers::pi / sides) >= kStepsPerSide * step) return;
  throw UsageError(
      fmt::format("{} of {:g} mm at coordinates up to {:g} mm cannot be kept within a tolerance of "
                  "{:g} mm: coordinates in a mesh file are single precision",
                  what, 2 * radius, largest, tolerance),
      "move the model nearer to the origin, raise --tolerance, or give a larger diameter");
}

bool may_open(const Tube& hole, const HollowOptions& options) {
  return !options.may_open || options.may_open(hole);
}

bool is_among(std::span<const Tube> tubes, const Tube& tube) {
  return std::ranges::any_of(
      tubes, [&](const Tube& other) { return other.start == tube.start && other.end == tube.end; });
}

// The holes that were not cut, or not cut well.
std::vector<std::size_t> failed_holes(const std::variant<OuterWithHoles, UncutHoles>& cut,
                                      const DrainagePlan& plan) {
  if (const auto* uncut = std::get_if<UncutHoles>(&cut)) return uncut->indices;
  const auto& outer = std::get<OuterWithHoles>(cut);
  std::vector<char> is_crossed(plan.holes.size(), 0);
  tbb::parallel_for(std::size_t{0}, plan.holes.size(), [&](std::size_t i) {
    is_crossed[i] = is_crossed_at(outer, i, plan.holes[i].tube) ? 1 : 0;
  });
  std::vector<std::size_t> failed;
  for (std::size_t i = 0; i < plan.holes.size(); ++i) {
    if (is_crossed[i] != 0) failed.push_back(i);
  }
  return failed;
}

// What the user should know about channels and escape holes that are wider than the printer bridges, if it
// limits ceilings.
void warn_of_wide_tubes(const ProcessChoice& choice, const Roof& roof, const DrainageRequest& request,
                        Monitor& monitor) {
  if (!roof.limits_ceilings()) return;
  const auto tell = [&](double radius, const char* what, const char* option) {
    const double width = 2 * radius * roof.cosine;
    if (width <= roof.bridge() * (1 + 1e-9)) return;
    // Where sqrt(1 - (sine / lean)^2) of the diameter is the bridge.
    const double share = roof.bridge() / (2 * radius);
    const double steepest = std::asin(std::min(1.0, roof.sine / std::sqrt(1 - share * share)));
    monitor.notice(fmt::format(
        "{} of {:g} mm lean out of the vertical by {:.0f} degrees at most: level ones would have ceilings of "
        "{:.1f} mm, and {} bridges {:g} mm; up to {} {:.1f} they can lead anywhere",
        what, 2 * radius, steepest * 180 / std::numbers::pi, width, choice.process.name, roof.bridge(),
        option, std::floor(10 * roof.bridge() / roof.cosine) / 10));
  };
  tell(request.channel_radius, "channels", "--channel-diameter");
  tell(request.hole_radius, "escape holes", "--hole-diameter");
}

// Channels, then holes.
std::vector<Tube> tubes_of(const DrainagePlan& plan) {
  std::vector<Tube> tubes;
  tubes.reserve(plan.channels.size() + plan.holes.size());
  for (const Channel& channel : plan.channels) tubes.push_back(channel.tube);
  for (const EscapeHole& hole : plan.holes) tubes.push_back(hole.tube);
  return tubes;
}

std::vector<Tube> tubes_of(const UncutTubes& uncut, const DrainagePlan& plan) {
  std::vector<Tube> tubes;
  for (const std::size_t i : uncut.windows) tubes.push_back(plan.channels[i].tube);
  for (const std::size_t i : uncut.holes) tubes.push_back(plan.holes[i].tube);
  return tubes;
}

// The ceiling of a tube and that of the void that it opens into may hang together, and are then wider than each is.
// For each such ceiling the tube that opens nearest to it, seen from above.
std::vector<Tube> tubes_at_wide_ceilings(const Solid& solid, const DrainagePlan& plan, const Roof& roof,
                                         double tolerance) {
  std::vector<Tube> found;
  if (!roof.limits_ceilings()) return found;
  const UprightFrame frame(roof.up);
  const std::span<const Triangle> inner =
      std::span(solid.mesh.triangles).subspan(solid.outer_triangle_count());
  const double allowed = roof.bridge() + tolerance;
  const std::vector<Tube> tubes = tubes_of(plan);
  for (const Ceiling& ceiling : ceilings_of(solid.mesh, inner, roof)) {
    if (ceiling.bound() <= allowed || widest_disc(ceiling, roof.bridge()) <= allowed) continue;
    const auto distance_to = [&](const Tube& tube) {
      double least = kInfinity;
      for (const Vec3d end : {tube.start, tube.end}) {
        const Vec3d at = frame.to_frame(end);
        for (const auto& [a, b] : ceiling.rim) least = std::min(least, std::hypot(a.x - at.x, a.y - at.y));
      }
      return least;
    };
    found.push_back(*std::ranges::min_element(tubes, {}, distance_to));
  }
  return found;
}

double lowest_along(const Mesh& mesh, Vec3d up) {
  double lowest = kInfinity;
  for (const Vec3f position : mesh.positions) lowest = std::min(lowest, dot(to_double(position), up));
  return lowest;
}

// How good a plan is, the less the better: the share of the voids' volume that is not made, and what its holes and what is sucked at are worth.
double cost_of(const DrainedVoids& drained) {
  constexpr double kWorthOfFurtherHole = 0.005;  // beyond the two of each network
  const double all = drained.plan.pools.total + drained.dropped.volume;
  const double needed = 2 * static_cast<double>(drained.plan.network_count);
  const double more = static_cast<double>(drained.plan.holes.size()) - needed;
  const double suction = std::max(0.0, 1 - drained.request.widest_cup / drained.plan.widest_cup);
  return drained.dropped.volume / all + kWorthOfFurtherHole * more + kWorthOfSuction * suction +
         (drained.request.avoids_plate ? 0 : kWorthOfPlate);
}

// The best of several plans: off the build plate and where holes hardly show; off it, but low rather than hidden; and
// anywhere. The next is tried where the one before leaves something to be wished. `voids_of` says how the voids of a
// result drain. Throws what `drained_under` throws for the last if none can be made.
template <typename DrainedUnder, typename VoidsOf>
auto best_drained(const DrainageRequest& asked, const DrainedUnder& drained_under, const VoidsOf& voids_of) {
  constexpr double kLowRatherThanHidden = 0.08;
  constexpr double kLittle = 0.003;
  DrainageRequest hidden = asked, low = asked;
  hidden.avoids_plate = low.avoids_plate = true;
  low.worth_of_hiding = kLowRatherThanHidden;
  std::optional<decltype(drained_under(asked))> best;
  const auto cost = [&] { return best ? cost_of(voids_of(*best)) : kInfinity; };
  const auto try_plan = [&](const DrainageRequest& request) {
    try {
      auto drained = drained_under(request);
      if (cost_of(voids_of(drained)) < cost()) best = std::move(drained);
    } catch (const NothingToRemoveError&) {
      if (&request == &asked && !best) throw;
    }
  };
  const bool is_all_asked_for = asked.escape_holes.size() >= 2;
  if (!is_all_asked_for) try_plan(hidden);
  // That loses holes, not voids.
  if (cost() > kLittle && cost() <= kWorthOfPlate) try_plan(low);
  if (cost() > kWorthOfPlate) try_plan(asked);
  return std::move(*best);
}

// What stands in the way at the last of the tubes of cells that were refused.
FailureError too_many_refused(const Tube& tube, bool is_uncut, const Roof& roof) {
  const std::string place =
      fmt::format("near ({:.3f}, {:.3f}, {:.3f}) mm", tube.start.x, tube.start.y, tube.start.z);
  if (is_uncut)
    return FailureError(fmt::format("the surfaces at a tube {} cannot be cut", place),
                        "raise --tolerance, or give another --channel-diameter or --hole-diameter");
  return FailureError(
      fmt::format(
          "the ceilings at a tube {} would join to one wider than --bridge {:g} mm, after {} other places "
          "had been tried",
          place, roof.bridge(), kMostRefused),
      "give a smaller --channel-diameter and --hole-diameter, a larger --bridge, or --shape spheres");
}

}  // namespace

Packing with_only(const Packing& packing, std::span<const std::uint32_t> kept) {
  Packing part{{}, packing.limits, packing.statistics, packing.device};
  for (const std::uint32_t i : kept) part.spheres.push_back(packing.spheres[i]);
  return part;
}

CellVoids with_only(const CellVoids& cells, std::span<const std::uint32_t> kept) {
  CellVoids part{cells.planes, cells.lattice, cells.ball_radius, {}};
  for (const std::uint32_t i : kept) part.voids.push_back(cells.voids[i]);
  return part;
}

std::size_t DrainedVoids::count_narrow_holes() const {
  return static_cast<std::size_t>(std::ranges::count_if(
      plan.holes, [&](const EscapeHole& hole) { return hole.tube.radius < request.hole_radius; }));
}

DrainedPacking drain(const PreparedModel& model, const SurfaceIndex& surface, Packing packing,
                     const ProcessChoice& process, const HollowOptions& options, Monitor& monitor) {
  if (!options.drainage) return {std::move(packing), std::nullopt, {}};
  monitor.stage("drain");
  const double tolerance = options.tolerance;
  const Roof& roof = packing.limits.roof;
  warn_of_wide_tubes(process, roof, *options.drainage, monitor);
  require_resolvable_tubes(model.mesh, *options.drainage, tolerance);
  const OutwardShells outward(model.mesh, model.inspection, surface);
  const DrainableModel drainable{surface, outward.winding(), kept_in(model),
                                 lowest_along(model.mesh, roof.up)};
  std::vector<Tube> refused;
  const auto can_open = [&](const EscapeHole& hole) {
    const WayOut way{hole.tube, packing.spheres[hole.from]};
    return !is_among(refused, hole.tube) && may_open(hole.tube, options) &&
           may_be_cut(model.mesh, surface, way, roof, tolerance) &&
           !is_crossed_near(model.mesh, surface, hole.tube);
  };
  // Cutting takes longer than all the rest, so it is tried on a whole plan, and places where it fails, which
  // looked as if it would not, are avoided by the next.
  const auto drained_under = [&](const DrainageRequest& request) -> DrainedPacking {
    while (true) {
      PlannedDrainage planned = plan_drainage(drainable, packing, request, can_open, monitor);
      Packing kept = with_only(packing, planned.kept);
      auto cut = cut_holes(model.mesh, surface, kept, planned.plan, {.tolerance = tolerance}, monitor);
      const std::vector<std::size_t> failed = failed_holes(cut, planned.plan);
      if (failed.empty()) {
        DrainedVoids voids{request, std::move(planned.plan), planned.dropped};
        return {std::move(kept), std::move(voids), std::move(std::get<OuterWithHoles>(cut))};
      }
      if (refused.size() >= kMostRefused) throw cannot_be_cut(planned.plan.holes[failed.front()]);
      for (const std::size_t i : failed) refused.push_back(planned.plan.holes[i].tube);
    }
  };
  DrainedPacking drained =
      best_drained(*options.drainage, drained_under,
                   [](const DrainedPacking& made) -> const DrainedVoids& { return *made.voids; });
  tell_of(*drained.voids, packing.spheres.size(), drainable.plate, monitor);
  return drained;
}

DrainedCells drain_cells(const PreparedModel& model, const SurfaceIndex& surface, const CellVoids& cells,
                         const PackingLimits& limits, const HollowOptions& options, double tolerance,
                         Monitor& monitor) {
  monitor.stage("drain");
  require_resolvable_tubes(model.mesh, *options.drainage, tolerance);
  const OutwardShells outward(model.mesh, model.inspection, surface);
  const DrainableModel drainable{surface, outward.winding(), kept_in(model),
                                 lowest_along(model.mesh, limits.roof.up)};
  std::vector<Tube> refused;
  CellDrainagePlanner planner(drainable, cells, limits, *options.drainage, monitor);
  CellCarver carver(model.mesh, surface, cells, tolerance);
  // Plans differ in few holes. By void and ends.
  std::map<std::array<double, 7>, bool> known;
  const auto can_open = [&](const Tube& tube, std::uint32_t from) {
    if (is_among(refused, tube)) return false;
    const auto [place, is_new] = known.try_emplace({static_cast<double>(from), tube.start.x, tube.start.y,
                                                    tube.start.z, tube.end.x, tube.end.y, tube.end.z});
    if (is_new)
      place->second = may_open(tube, options) &&
                      may_be_cut(model.mesh, surface, cells.voids[from], tube, limits.roof, tolerance) &&
                      !is_crossed_near(model.mesh, surface, tube);
    return place->second;
  };
  const auto can_open_wall = [&](const Tube& window) { return !is_among(refused, window); };
  const auto drained_under = [&](const DrainageRequest& request) -> DrainedCells {
    while (true) {
      PlannedCellDrainage planned = planner.plan(request, can_open, can_open_wall);
      auto carved = carver.carve(planned.kept, planned.plan, monitor);
      auto* solid = std::get_if<Solid>(&carved);
      const std::vector<Tube> unfit =
          solid != nullptr ? tubes_at_wide_ceilings(*solid, planned.plan, limits.roof, tolerance)
                           : tubes_of(std::get<UncutTubes>(carved), planned.plan);
      if (unfit.empty()) {
        DrainedVoids voids{request, std::move(planned.plan), planned.dropped};
        return {with_only(cells, planned.kept), std::move(voids), std::move(*solid)};
      }
      for (const Tube& tube : unfit) {
        if (refused.size() >= kMostRefused) throw too_many_refused(tube, solid == nullptr, limits.roof);
        refused.push_back(tube);
      }
    }
  };
  DrainedCells drained =
      best_drained(*options.drainage, drained_under,
                   [](const DrainedCells& made) -> const DrainedVoids& { return made.voids; });
  tell_of(drained.voids, cells.voids.size(), drainable.plate, monitor);
  return drained;
}

void require_resolvable_tubes(const Mesh& model, const DrainageRequest& request, double tolerance) {
  require_resolvable(model, request.channel_radius, tolerance, "a channel");
  require_resolvable(model, request.hole_radius, tolerance, "an escape hole");
}

void require_room_for_tubes(const DrainageRequest& request, const PackingLimits& limits) {
  const auto require = [&](double radius, const char* what, const std::string& smaller) {
    if (radius <= kWidestTubeShare * limits.max_radius) return;
    throw UsageError(fmt::format("{} of {:g} mm is too wide for every void: none is wider than {:g} mm "
                                 "(--max-radius {:g})",
                                 what, 2 * radius, 2 * limits.max_radius, limits.max_radius),
                     fmt::format("give {}, or a larger --max-radius", smaller));
  };
  require(request.channel_radius, "a channel", narrower_channels());
  require(request.hole_radius, "an escape hole", narrower_holes(request));
}

CarvedModel carve_within(const PreparedModel& model, const SurfaceIndex& surface, const Packing& packing,
                         const DrainagePlan& plan, OuterWithHoles outer, double tolerance,
                         std::optional<std::size_t> max_triangles, Monitor& monitor) {
  const auto carve_at = [&](double at) {
    return carve_drained(model.mesh, surface, packing, plan, {.tolerance = at}, monitor);
  };
  // Cut for another tolerance, its holes have other sides.
  const bool fits = outer.tolerance == tolerance;
  Solid solid = fits ? carve_drained(std::move(outer), packing, plan, monitor) : carve_at(tolerance);
  for (int i = 0; i < kMostTries; ++i) {
    if (!max_triangles || solid.mesh.triangles.size() <= *max_triangles) return {std::move(solid), tolerance};
    tolerance *= kLooser;
    solid = carve_at(tolerance);
  }
  throw UsageError(
      fmt::format("--max-triangles {}: drained voids take more, however coarse they are", *max_triangles),
      "allow more triangles, or give a larger --min-radius for fewer voids");
}

}  // namespace aerate
