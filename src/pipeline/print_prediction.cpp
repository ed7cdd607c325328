#include "pipeline/print_prediction.h"

#include <cmath>
#include <cstddef>
#include <fmt/format.h>
#include <span>
#include <string>

#include "core/error.h"
#include "core/upright.h"
#include "pipeline/print_verdict.h"
#include "printing/slicers/object_parts.h"

namespace aerate {
namespace {

// To a hundredth of a millimetre, so that the radius which is read is the one that is used.
double rounded_up(double length) {
  return std::ceil(length * 100) / 100;
}

std::string saving_infill(const std::optional<double>& infill) {
  if (!infill) return "save at no infill";
  const double percent = std::ceil(in_percent(*infill));
  if (percent >= 100) return "save only in a solid print";
  return fmt::format("save above {:.0f} % infill", percent);
}

constexpr const char* kOtherWays =
    "--as modifiers -o MODEL.3mf makes them volumes of 0 % infill, which have no walls and save at "
    "nearly any infill; --force writes these voids all the same";

[[noreturn]] void refuse_all(const PackingLimits& limits, const PrintSettings& settings,
                             const std::optional<double>& least_radius) {
  const std::string why = least_radius
                              ? fmt::format(
                                    "a void takes less filament than it saves only above a radius of "
                                    "{:.1f} mm, since walls and skins are printed round it, and the "
                                    "largest allowed is {:g} mm (--max-radius)",
                                    *least_radius, limits.max_radius)
                              : std::string(
                                    "walls and skins round a void take more filament than it saves, "
                                    "however large it is");
  throw NothingToRemoveError(
      fmt::format("nothing would be saved: at {:g} % infill {}", in_percent(settings.infill), why),
      "where they fit, " + where_voids_pay(limits.max_radius, settings));
}

std::string change_in_words(const PrintPrediction& prediction) {
  return fmt::format("{:.2f} instead of {:.2f} cm3 of filament ({:+.1f} %) at {:g} % infill{}",
                     prediction.filament_after_mm3 / 1000, prediction.filament_before_mm3 / 1000,
                     in_percent(prediction.filament_after_mm3 / prediction.filament_before_mm3 - 1),
                     in_percent(prediction.settings.infill),
                     prediction.described ? "" : ", which is assumed");
}

PrintSettings settings_of(const HollowOptions& options) {
  PrintSettings settings = options.print;
  if (options.modifiers) {
    if (!options.infill_is_known) settings.infill = kUsualInfill;
    settings.modifier_infill = options.modifiers->infill_percent / 100;
  }
  return settings;
}

// The voids by themselves, as bodies.
Mesh voids_of(const Solid& solid) {
  Mesh mesh = with_void_shells_turned(solid.mesh, solid);
  const auto outer = static_cast<std::ptrdiff_t>(solid.outer_triangle_count());
  mesh.triangles.erase(mesh.triangles.begin(), mesh.triangles.begin() + outer);
  return mesh;
}

// A mesh as it is printed: itself, or turned into `turned`.
const Mesh& upright(const Mesh& mesh, const UprightFrame& frame, Mesh& turned) {
  if (frame.is_the_models_own()) return mesh;
  turned = turned_upright(mesh, frame);
  return turned;
}

// What is cut of a print for its prediction.
struct Prints {
  SlicedPrint whole;
  FilamentUse whole_use, hollow_use;
};

// The solid's outer surface is as a rule the model's, triangle by triangle.
std::pair<SlicedPrint, SlicedPrint> whole_and_hollow(const Mesh& outer, const Mesh& solid,
                                                     std::size_t outer_triangles,
                                                     const PrintSettings& settings) {
  const bool is_the_same =
      outer_triangles == outer.triangles.size() && outer.positions.size() <= solid.positions.size() &&
      std::equal(outer.triangles.begin(), outer.triangles.end(), solid.triangles.begin()) &&
      std::equal(outer.positions.begin(), outer.positions.end(), solid.positions.begin());
  if (is_the_same) return SlicedPrint::of_both(solid, outer_triangles, settings);
  return {SlicedPrint::of(outer, settings), SlicedPrint::of(solid, settings)};
}

// `outer`: as it is printed.
Prints prints_of(const Mesh& outer, const Solid& solid, const UprightFrame& frame,
                 const HollowOptions& options, const PrintSettings& settings, Monitor& monitor) {
  Mesh turned;
  if (options.modifiers) {
    SlicedPrint print = SlicedPrint::of(outer, settings);
    const FilamentUse whole_use = print.use();
    monitor.check_interrupted();
    print.add_modifiers(upright(voids_of(solid), frame, turned), settings);
    const FilamentUse hollow_use = print.use();
    return {std::move(print), whole_use, hollow_use};
  }
  auto [whole, hollow] =
      whole_and_hollow(outer, upright(solid.mesh, frame, turned), solid.outer_triangle_count(), settings);
  monitor.check_interrupted();
  const FilamentUse whole_use = whole.use();
  monitor.check_interrupted();
  return {std::move(whole), whole_use, hollow.use()};
}

FilamentChange change_at(double infill, const FilamentUse& whole, const FilamentUse& hollow,
                         PrintSettings settings) {
  settings.infill = infill;
  return {infill, whole.volume_mm3(settings), hollow.volume_mm3(settings)};
}

// How much more a print takes with the voids as modifiers of 0 % infill, as a share. Adds these to what is cut.
double change_as_modifiers(Prints& prints, const Solid& solid, const UprightFrame& frame,
                           PrintSettings settings, double infill) {
  settings.modifier_infill = 0;
  Mesh turned;
  prints.whole.add_modifiers(upright(voids_of(solid), frame, turned), settings);
  return change_at(infill, prints.whole_use, prints.whole.use(), settings).share();
}

std::string what_else(const PrintPrediction& prediction, const HollowOptions& options) {
  const std::string where = saving_infill(prediction.break_even_infill);
  if (!options.modifiers && prediction.as_modifiers)
    return fmt::format(
        "these voids {}; as volumes of 0 % infill, which have no walls (--as modifiers -o MODEL.3mf), they "
        "would "
        "change it by {:+.1f} %; --force writes these voids all the same",
        where, in_percent(*prediction.as_modifiers));
  if (!options.modifiers) return fmt::format("these voids {}; {}", where, kOtherWays);
  return fmt::format(
      "infill is joined along the border of modifiers, which costs more than these save: they {}; larger "
      "ones ({}) or {} cost less; --force writes these all the same",
      saving_infill(prediction.break_even_infill),
      options.cells ? "--cell-size" : "--shape cells, --min-radius, --max-radius",
      options.modifiers->infill_percent > 0 ? "a lower --modifier-infill" : "a thinner --wall");
}

}  // namespace

std::string where_voids_pay(double radius, const PrintSettings& settings) {
  return fmt::format("voids of {:.2g} mm {}; {}", radius, saving_infill(break_even_infill(radius, settings)),
                     kOtherWays);
}

PackingRequest without_voids_that_cost(PackingRequest request, const HollowOptions& options,
                                       Monitor& monitor) {
  if (!options.infill_is_known || options.heavier == HeavierPrint::allow || !request.spheres.empty())
    return request;
  const PrintSettings& settings = options.print;
  const PackingLimits limits = request.limits();
  const auto least_radius = break_even_radius(settings);
  // A cell about a sphere has as much wall for its volume as the sphere itself, but reaches further. Whether all of them
  // together save is for the prediction.
  constexpr double kCellsReach = 1.5;
  const double largest = (options.cells ? kCellsReach : 1) * limits.max_radius;
  if (!least_radius || options.paying_share * *least_radius > largest)
    refuse_all(limits, settings, least_radius);
  if (options.cells) return request;
  const double raised = rounded_up(options.paying_share * *least_radius);
  if (raised <= limits.min_radius) return request;
  const double percent = in_percent(settings.infill);
  if (options.paying_share == 1) {
    monitor.notice(fmt::format(
        "at {:g} % infill a void saves filament only above a radius of {:g} mm: smaller ones are not "
        "made",
        percent, raised));
  } else {
    monitor.notice(
        fmt::format("at {:g} % infill voids as a rule save filament above a radius of {:.2f} mm, which gave "
                    "nothing here: "
                    "those from {:g} mm on are made",
                    percent, *least_radius, raised));
  }
  request.pays_in = settings;
  request.process.limits[Limit::min_radius] = {
      std::min(raised, limits.max_radius), "docs/economics.md",
      options.paying_share == 1
          ? fmt::format("break-even at {:g} % infill", percent)
          : fmt::format("{:g} of break-even at {:g} % infill", options.paying_share, percent)};
  return request;
}

void require_modifiers_that_save(const HollowOptions& options) {
  if (!options.modifiers || options.heavier == HeavierPrint::allow) return;
  if (options.modifiers->hold_lightning) return;  // which takes less than its density says
  const bool is_known = options.infill_is_known;
  const double within = options.modifiers->infill_percent;
  const double around = is_known ? in_percent(options.print.infill) : 100;  // else the most that there is
  if (within < around) return;
  const char* const force = is_known ? "; --force writes these all the same" : "";
  if (around == 0)
    throw NothingToRemoveError(
        "nothing would be saved: a print of 0 % infill has none that modifiers could lower",
        std::string("print the model as it is, or give the --infill that it has") + force);
  throw NothingToRemoveError(
      fmt::format("nothing would be saved: modifiers of {:g} % infill in a print of {:g} %{}", within, around,
                  is_known ? "" : " at most"),
      fmt::format("give a --modifier-infill below {:g}; 0 saves most{}", around, force));
}

std::optional<PrintPrediction> predict_print(const Mesh& outer, const Solid& solid, const Packing& packing,
                                             const HollowOptions& options, Monitor& monitor) {
  const bool prints_filament = options.packing.process.process.drainage == Drainage::not_needed;
  if (!prints_filament || (options.modifiers && options.modifiers->hold_lightning)) return std::nullopt;
  monitor.stage("predict");
  PrintPrediction prediction;
  prediction.described = options.infill_is_known;
  prediction.of_modifiers = options.modifiers.has_value();
  prediction.settings = settings_of(options);
  const PrintSettings& settings = prediction.settings;
  const UprightFrame frame(packing.limits.roof.up);
  Mesh turned;
  const Mesh& printed = upright(outer, frame, turned);
  Prints prints = prints_of(printed, solid, frame, options, settings, monitor);
  const FilamentUse &whole = prints.whole_use, &hollow = prints.hollow_use;
  monitor.check_interrupted();
  prediction.filament_before_mm3 = whole.volume_mm3(settings);
  prediction.filament_after_mm3 = hollow.volume_mm3(settings);
  prediction.break_even_infill = break_even_infill(hollow - whole, settings);
  // No walls are printed round modifiers.
  if (!options.modifiers) prediction.break_even_radius = break_even_radius(settings);
  prediction.time = time_change(
      whole, hollow, options.modifiers ? std::span<const Sphere>() : std::span(packing.spheres), settings);
  const double infill = prediction.described ? settings.infill : kUsualInfill;
  prediction.usual = change_at(infill, whole, hollow, settings);
  prediction.solid = change_at(1, whole, hollow, settings);
  // Voids that drain are no bodies by themselves.
  if (prediction.usual.heavier() && !options.modifiers && !options.drainage)
    prediction.as_modifiers = change_as_modifiers(prints, solid, frame, settings, infill);
  monitor.check_interrupted();

  return prediction;
}

void judge(const PrintPrediction& prediction, const HollowOptions& options, Monitor& monitor) {
  const bool tells = prediction.described || options.modifiers;
  if (tells && prediction.heavier()) {
    if (prediction.described && options.heavier == HeavierPrint::refuse) {
      throw NothingToRemoveError("the print would become heavier: " + change_in_words(prediction),
                                 what_else(prediction, options));
    }
    monitor.notice("the print becomes heavier: " + change_in_words(prediction));
  } else if (tells &&
             prediction.filament_after_mm3 > (1 - kUncertainShare) * prediction.filament_before_mm3) {
    monitor.notice(fmt::format(
        "the print may become heavier: {} is predicted, to within {:g} points; `aerate slice` asks "
        "your slicer",
        change_in_words(prediction), in_percent(kUncertainShare)));
  } else if (!tells && prediction.usual.heavier() && options.heavier == HeavierPrint::refuse) {
    monitor.notice(fmt::format("{} (--infill says what yours is)", verdict_in_words(prediction)));
  }
}

}  // namespace aerate
