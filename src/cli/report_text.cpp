#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <iterator>

#include "cli/reports.h"
#include "core/listed.h"
#include "core/printable.h"
#include "pipeline/memory.h"
#include "pipeline/print_verdict.h"
#include "printing/slicers/slicers.h"

namespace aerate::cli {
namespace {

// Writes "label      value" lines.
class Lines {
 public:
  template <typename... Arguments>
  void add(const char* label, fmt::format_string<Arguments...> format, Arguments&&... arguments) {
    fmt::format_to(std::back_inserter(text_), "{:<12}", label);
    text_ += printable(fmt::format(format, std::forward<Arguments>(arguments)...));
    text_ += '\n';
  }
  std::string take() { return std::move(text_); }

 private:
  std::string text_;
};

// 1234567 -> "1,234,567"
std::string grouped(std::size_t number) {
  std::string digits = fmt::format("{}", number);
  for (std::ptrdiff_t at = std::ssize(digits) - 3; at > 0; at -= 3)
    digits.insert(static_cast<std::size_t>(at), 1, ',');
  return digits;
}

std::string point(Vec3d p) {
  // Rounded first, so that nothing reads as -0.00.
  for (double* coordinate : {&p.x, &p.y, &p.z}) *coordinate = std::round(*coordinate * 100) / 100 + 0.0;
  return fmt::format("({:.2f}, {:.2f}, {:.2f})", p.x, p.y, p.z);
}

std::string size_of(const Box3f& box) {
  const Vec3d size = to_double(box.upper) - to_double(box.lower);
  return fmt::format("{:.4g} x {:.4g} x {:.4g} mm", size.x, size.y, size.z);
}

std::string count_of(std::size_t count, const char* one, const char* many) {
  return fmt::format("{} {}", grouped(count), count == 1 ? one : many);
}

// Nothing for a model of the size that its file has.
std::string scaling_of(Vec3d scale) {
  if (scale == Vec3d{1, 1, 1}) return {};
  if (scale.x == scale.y && scale.y == scale.z) return fmt::format(", scaled by {:g}", scale.x);
  return fmt::format(", scaled by {:g} along x, {:g} along y, {:g} along z", scale.x, scale.y, scale.z);
}

void add_input(Lines& lines, const InputFacts& input) {
  lines.add("model", "{}: {}, {}, {}{}", input.path.filename().string(), input.format,
            count_of(input.inspection.triangle_count, "triangle", "triangles"), size_of(input.inspection.box),
            scaling_of(input.scale));
}

void add_stages(Lines& lines, const std::vector<StageCost>& stages) {
  std::string parts;
  for (const StageCost& stage : stages)
    parts += fmt::format("{}{} {:.2f}", parts.empty() ? "" : ", ", stage.name, stage.seconds);
  const StageCost total = total_of(stages);
  lines.add("time", "{:.2f} s ({}), memory {} at most", total.seconds, parts, format_bytes(total.peak_bytes));
}

// Each limit with where it came from; those of the same origin together.
void add_limits(Lines& lines, const ProcessChoice& choice) {
  lines.add("process", "{}: {}", choice.process.name, choice.process.title);
  std::vector<std::pair<std::string, std::string>> values_by_origin;
  for (const auto& [limit, chosen] : choice.limits) {
    auto found =
        std::ranges::find(values_by_origin, chosen.origin, &std::pair<std::string, std::string>::first);
    if (found == values_by_origin.end()) found = values_by_origin.insert(found, {chosen.origin, ""});
    auto& values = found->second;
    values += fmt::format("{}{} {:.4g} {}", values.empty() ? "" : ", ", row_of(limit).name, chosen.value,
                          row_of(limit).unit.name);
  }
  for (const auto& [origin, values] : values_by_origin) lines.add("", "{} ({})", values, origin);
}

// `roofs`: "2 of 7 voids"
void add_ceilings(Lines& lines, const std::optional<Ceilings>& ceilings, const std::string& roofs,
                  const Roof& roof, double tolerance, const ProcessChoice& process) {
  if (!ceilings) return;
  lines.add(
      "ceilings", "{:.2f} mm wide at most (bridge {:g}, tolerance {:.3g}); {} with roofs; up is {} ({})",
      ceilings->widest, roof.bridge(), tolerance, roofs, process.direction.name, process.direction.origin);
}

// "0.620 to 3.500 mm"
std::string radii(double smallest, double largest) {
  const std::string from = fmt::format("{:.3f}", smallest);
  const std::string to = fmt::format("{:.3f}", largest);
  return from == to ? to + " mm" : from + " to " + to + " mm";
}

void add_packing(Lines& lines, const char* label, const std::string& shapes, const std::string& radii,
                 const std::string& method, double density, const DeviceUse& device) {
  lines.add(label, "{}, radius {}; {} packing, {:.2f} % of the model", shapes, radii, method, 100 * density);
  lines.add("packed on", "{}: {}", device.name, device.reason);
}

void add_clearances(Lines& lines, const Clearances& clearances, const PackingLimits& limits) {
  const std::string gap =
      clearances.gap ? fmt::format("{:.3f} mm at least", *clearances.gap) : "none, there is one void";
  lines.add("wall", "{:.3f} mm at least (limit {:g}); gap {} (limit {:g})", clearances.wall, limits.wall, gap,
            limits.gap);
}

void add_kept(Lines& lines, const std::optional<KeptFacts>& kept, const PackingLimits& limits) {
  if (!kept) return;
  // Regions that hold all of the model's surface have none in it.
  const bool is_measured = kept->wall && std::isfinite(*kept->wall);
  lines.add(
      "kept solid", "{}, about {:.1f} mm3 of the model{}", count_of(kept->count, "region", "regions"),
      kept->volume,
      is_measured ? fmt::format("; wall {:.3f} mm at least (limit {:g})", *kept->wall, limits.wall) : "");
}

std::string margin_in_words(double margin) {
  return fmt::format("{:.1f} mm {} the edge of its base", std::abs(margin),
                     margin >= 0 ? "inside" : "outside");
}

void add_balance(Lines& lines, const HollowReport& report) {
  const OutputFacts& output = report.output;
  const ShareOfBound& blocks = blocks_like(report);
  lines.add(
      "strength",
      "{:.1f} % solid; stiffness about {:.0f} % (Hashin-Shtrikman bound, an estimate; blocks with {} had "
      "{:.2f} to {:.2f} of it)",
      100 * output.volume_after / output.volume_before, 100 * report.balance.stiffness,
      report.cells ? "cells" : "spheres", blocks.least, blocks.most);
  if (!output.centre_of_mass_before || !output.centre_of_mass_after) return;
  lines.add("balance", "centre of mass {} -> {} mm, moved by {:.2f} mm", point(*output.centre_of_mass_before),
            point(*output.centre_of_mass_after),
            length(*output.centre_of_mass_after - *output.centre_of_mass_before));
  const Balance& balance = report.balance;
  if (!balance.margin_before || !balance.margin_after || *balance.margin_before < 0) {
    lines.add("", "does not stand by itself as it lies, with or without voids");
  } else {
    lines.add("", "stands {} -> {}{}", margin_in_words(*balance.margin_before),
              margin_in_words(*balance.margin_after), balance.tips_over() ? ": it tips over" : "");
  }
}

void add_pools(Lines& lines, const char* label, const TrappedPools& pools, Build build) {
  lines.add(label, "{:.1f} mm3 stay as printed{}, {:.1f} {}, {:.1f} ({:.2f} % of the voids) after both",
            as_printed(pools, build), build == Build::hanging ? " (hanging)" : "", turned_over(pools, build),
            build == Build::hanging ? "standing" : "upside down", pools.after_both,
            pools.total > 0 ? 100 * pools.after_both / pools.total : 0);
}

// What happens to what a layer closes in depends on how the part hangs or stands.
void add_cups(Lines& lines, const PrintedCups& cups) {
  if (!cups.widest) {
    lines.add("cups", "none: no layer closes anything in");
    return;
  }
  const AirCup& cup = *cups.widest;
  lines.add("cups", "{:.1f} mm2 at most (limit {:g}), {:.2f} mm from the start of the print near {} mm: {}",
            cup.area, cups.limit.value, cup.height, point(cup.place),
            cups.build == Build::hanging
                ? "suction where the layer is pulled off"
                : "liquid stands in it; suction only if the part hangs (--build hanging)");
  lines.add("", "{:.1f} mm3 are closed in, down to {} mm; {} over the limit", cup.volume, point(cup.bottom),
            count_of(cups.over_limit, "cup", "cups"));
}

void add_drainage(Lines& lines, const HollowReport& report) {
  if (!report.drainage) return;
  const DrainedVoids& drainage = *report.drainage;
  const DrainagePlan& plan = drainage.plan;
  const std::size_t narrow = drainage.count_narrow_holes();
  lines.add("drainage", "{} of {:g} mm, {} of {:g} mm{}; {} sealed",
            count_of(plan.channels.size(), "channel", "channels"), 2 * drainage.request.channel_radius,
            count_of(plan.holes.size() - narrow, "escape hole", "escape holes"),
            2 * drainage.request.hole_radius,
            narrow > 0 ? fmt::format(", {} of {:g} mm", narrow, 2 * drainage.request.narrow_hole_radius) : "",
            count_of(report.output.drainage->sealed_cavities, "cavity", "cavities"));
  std::string places;
  for (const EscapeHole& hole : plan.holes) places += (places.empty() ? "" : ", ") + point(hole.tube.end);
  lines.add("", "holes at {} mm", places);
  const auto for_pools = std::ranges::count(plan.holes, HolePurpose::pool, &EscapeHole::purpose);
  if (for_pools > 0)
    lines.add("", "{} of them for pools that would stay, beyond the two of each group of voids ({})",
              for_pools, count_of(plan.network_count, "group", "groups"));
  const auto for_cups = std::ranges::count(plan.holes, HolePurpose::cup, &EscapeHole::purpose);
  if (for_cups > 0)
    lines.add("", "{} of them where a layer would close in more than {:g} mm2", for_cups,
              drainage.request.widest_cup);
  add_pools(lines, "", plan.pools, report.build);
  if (drainage.dropped.count() > 0)
    lines.add("", "{} that cannot be drained not made ({:.1f} mm3)",
              count_of(drainage.dropped.count(), "void", "voids"), drainage.dropped.volume);
}

void add_cavities(Lines& lines, const HollowReport& report) {
  if (!report.cavities || report.cavities->opened.cavities.empty()) return;
  const OpenedCavities& opened = report.cavities->opened;
  lines.add("cavities", "{} of the model's own ({:.1f} mm3) opened by {}",
            count_of(opened.cavities.size(), "cavity", "cavities"), opened.volume(),
            count_of(opened.hole_count(), "hole", "holes"));
  std::string places;
  for (const OpenedCavity& cavity : opened.cavities)
    for (const CavityHole& hole : cavity.holes) places += (places.empty() ? "" : ", ") + point(hole.tube.end);
  lines.add("", "holes at {} mm", places);
  if (report.cavities->pools) add_pools(lines, "in all", *report.cavities->pools, report.build);
}

void add_plugs(Lines& lines, const std::optional<WrittenPlugs>& written) {
  if (!written) return;
  const auto& [request, plugs, facts, bytes] = *written;
  lines.add("plugs", "{}: {} for {}, {:.3g} mm free all round, {:g} degrees of taper; flush within {:.2g} mm",
            request.output.filename().string(), count_of(plugs.plugs.size(), "plug", "plugs"),
            count_of(plugs.plugs.size() + plugs.without.size(), "hole", "holes"), facts.clearance,
            request.fit.taper_degrees, facts.flush);
}

const char* in_words(TimeChange change) {
  switch (change) {
    case TimeChange::shorter:
      return "takes less time";
    case TimeChange::same:
      return "takes about as long";
    case TimeChange::longer:
      return "takes longer";
  }
  return "";
}

std::string in_words(const PrintSettings& settings) {
  return fmt::format("{} {} of {:g} mm, {:g} mm layers, {} and {} solid", settings.perimeters,
                     settings.perimeters == 1 ? "perimeter" : "perimeters", settings.line_width,
                     settings.layer_height, settings.top_layers, settings.bottom_layers);
}

// What describes the print, with where it came from; what is of one origin together. Of a file the keys are in the JSON.
void add_print_origins(Lines& lines, const std::vector<PrintOrigin>& origins) {
  std::vector<std::pair<std::string, std::string>> values_by_origin;
  for (const PrintOrigin& each : origins) {
    auto found =
        std::ranges::find(values_by_origin, each.origin, &std::pair<std::string, std::string>::first);
    if (found == values_by_origin.end()) found = values_by_origin.insert(found, {each.origin, ""});
    found->second += (found->second.empty() ? "" : ", ") + each.value;
  }
  const char* label = "print";
  for (const auto& [origin, values] : values_by_origin) {
    lines.add(label, "{} ({})", values, origin);
    label = "";
  }
}

// What there is to know first, of a print of filament.
void add_verdict(Lines& lines, const HollowReport& report) {
  if (!report.print) return;
  const char* label = "verdict";
  for (const std::string& line : verdict_of(*report.print)) {
    lines.add(label, "{}", line);
    label = "";
  }
}

// What the figures for material mean, and from which infill on they save.
void add_print(Lines& lines, const HollowReport& report) {
  if (!report.print) {
    lines.add("", "as solid material");
    return;
  }
  const PrintPrediction& print = *report.print;
  if (print.described) {
    lines.add("", "as predicted for {:g} % infill, {}; the print {}", 100 * print.settings.infill,
              in_words(print.settings), in_words(print.time));
  } else {
    lines.add("", "as solid material (100 % infill); --infill predicts a sparse print");
  }
  if (print.break_even_infill) {
    lines.add("", "these voids save filament above {:.0f} % infill{}",
              std::ceil(100 * *print.break_even_infill),
              print.described ? "" : fmt::format(" ({})", in_words(print.settings)));
  } else {
    lines.add("", "these voids save filament at no infill");
  }
}

// Of modifiers, which have no figures of solid material.
void add_predicted_filament(Lines& lines, const PrintPrediction& print) {
  const double before = print.filament_before_mm3, after = print.filament_after_mm3;
  lines.add("filament", "{:.2f} -> {:.2f} cm3 ({:+.1f} %), predicted for {:g} % infill{}; the print {}",
            before / 1000, after / 1000, 100 * (after / before - 1), 100 * print.settings.infill,
            print.described ? "" : ", which is assumed: --infill says what it is", in_words(print.time));
  lines.add("", "with {}", in_words(print.settings));
}

void add_volume(Lines& lines, const HollowReport& report) {
  const OutputFacts& output = report.output;
  const double percent = 100 * output.volume_removed / output.volume_before;
  const char* estimated =
      report.volume_estimated ? "; the model's volume is an estimate, since parts overlap" : "";
  if (report.modifiers) {
    lines.add("modifiers",
              "{:.1f} of {:.1f} mm3 ({:.2f} %) with {:g} %{} infill instead of the print's own{}",
              output.volume_removed, output.volume_before, percent, report.modifiers->infill_percent,
              report.modifiers->hold_lightning ? " lightning" : "", estimated);
    const SlicerProfile& slicer = *report.modifiers->slicer;
    lines.add("", "for {}{}; nothing is removed, and no walls are printed round them",
              listed(slicer.family, "and"), slicer.untested ? " (untested)" : "");
    if (!slicer.modifiers->elsewhere.empty()) lines.add("", "{}", slicer.modifiers->elsewhere);
    return;
  }
  lines.add("removed", "{:.1f} of {:.1f} mm3 ({:.2f} %), {:.1f} mm3 left{}", output.volume_removed,
            output.volume_before, percent, output.volume_after, estimated);
}

// What keeps a slicer's supports out of voids.
void add_supports(Lines& lines, const HollowReport& report) {
  if (report.support_blockers != nullptr) {
    lines.add("supports", "{} for {}, larger than the voids by {:.2g} mm; other programs show them as bodies",
              count_of(report.output.void_count, "support blocker", "support blockers"),
              listed(report.support_blockers->family, "and"), report.blocker_growth);
  } else if (may_be_filled_with_supports(report)) {
    lines.add("supports", "in the slicer: on the build plate only, or they fill voids (or a 3MF with {})",
              "--support-blockers");
  }
}

void add_target(Lines& lines, const HollowReport& report) {
  if (!report.target) return;
  const TargetFacts& target = *report.target;
  const OutputFacts& output = report.output;
  const std::string voids =
      fmt::format("{} of {}", grouped(output.void_count), count_of(target.all_voids, "void", "voids"));
  if (target.asked.kind == SavingTarget::Kind::mass)
    lines.add("target", "{:g} g at most: {:.4g} g with {}", target.asked.value,
              output.volume_after * report.material.density_g_cm3 / 1000, voids);
  else
    lines.add("target", "{:g} % at least: {:.2f} % with {}", 100 * target.asked.value,
              100 * output.volume_removed / output.volume_before, voids);
}

void add_stand(Lines& lines, const HollowReport& report) {
  if (!report.stand || !report.balance.margin_after) return;
  const StandFacts& stand = *report.stand;
  lines.add("stand", "at least {:.2f} mm inside what it stands on: {:.2f} -> {:.2f} mm ({:.2f} with all {})",
            stand.needed, stand.margin_before, *report.balance.margin_after, stand.margin_with_all,
            count_of(stand.all_voids, "void", "voids"));
  lines.add("", "{} left out",
            count_of(stand.all_voids - std::min(stand.all_voids, report.output.void_count), "void", "voids"));
}

void add_material(Lines& lines, const HollowReport& report) {
  const MaterialUse use = material_use(report);
  const Material& material = report.material;
  std::string figures = fmt::format("{:g} g/cm3 and {:g} a {}", material.density_g_cm3,
                                    material.price_per(material.priced_per), name_of(material.priced_per));
  if (material.priced_per == PriceUnit::bulk_litre)
    figures += fmt::format(" of powder of {:g} g/cm3", *material.bulk_density_g_cm3);
  if (report.modifiers && report.modifiers->hold_lightning) {
    lines.add("material", "lightning infill takes less than its density says; 'aerate slice' tells what");
    return;
  }
  if (report.modifiers) {
    // Infill that the slicer makes solid for other reasons (under a top, over a bottom) stays.
    lines.add("material",
              "{}: each point of the print's infill above {:g} % saves up to {:.3f} g, cost {:.4f} (at {})",
              report.material.name, report.modifiers->infill_percent,
              (use.mass_before_g - use.mass_after_g) / 100, (use.cost_before - use.cost_after) / 100,
              figures);
    if (report.print) add_predicted_filament(lines, *report.print);
    return;
  }
  // A sparse print may become heavier with the same voids.
  const bool is_if_solid = report.print && !use.predicted;
  lines.add("material", "{}{} {:.1f} -> {:.1f} g, cost {:.2f} -> {:.2f} (at {})", report.material.name,
            is_if_solid ? ", if printed solid:" : "", use.mass_before_g, use.mass_after_g, use.cost_before,
            use.cost_after, figures);
  add_print(lines, report);
}

// Of the model: what the pieces of cells take.
void add_pieces(Lines& lines, const PackReport& report) {
  const PackedCells& cells = *report.cells;
  const PieceFacts& pieces = *cells.pieces;
  const std::string count = count_of(pieces.piece_count, "piece", "pieces");
  lines.add("pieces", "{}, {:.1f} mm3 ({:.2f} % of the model), fillet {:g} mm", count, pieces.volume,
            100 * pieces.volume / report.input.inspection.filled_volume, cells.options.fillet);
  add_clearances(lines, pieces.clearances, report.limits);
  add_kept(lines, report.kept, report.limits);
  add_ceilings(lines, pieces.ceilings, fmt::format("{} of {}", grouped(pieces.roof_count), count),
               report.limits.roof, cells.tolerance, report.process);
  lines.add("tolerance", "{:.3g} mm; surfaces of pieces are at most {:.3g} mm inside their cells",
            cells.tolerance, pieces.deviation);
}

// What was written.
std::string output_of(const PackReport& report) {
  const std::string size = format_bytes(static_cast<double>(report.output_bytes));
  const std::string file = report.output.filename().string();
  if (!report.cells) return fmt::format("{}: {}", file, size);
  const std::size_t planes = report.cells->plane_count;
  return report.cells->pieces
             ? fmt::format("{}: {}, {}", file,
                           count_of(report.cells->pieces->triangle_count, "triangle", "triangles"), size)
             : fmt::format("{}: {} of {}, {}", file, count_of(planes, "plane", "planes"),
                           count_of(report.packing.spheres.size(), "cell", "cells"), size);
}

// A line for each of the first few.
template <typename T, typename AddLine>
void add_some(Lines& lines, const std::vector<T>& all, const AddLine& add_line) {
  constexpr std::size_t kMost = 10;
  for (std::size_t i = 0; i < std::min(kMost, all.size()); ++i) add_line(all[i], i == 0);
  if (all.size() > kMost) lines.add("", "and {} more", all.size() - kMost);
}

// How a model drains that is as it is.
void add_findings(Lines& lines, const DrainageFindings& findings) {
  lines.add("drainage", "{}", findings.verdict);
  if (!findings.air) return;
  const InspectedDrainage& air = *findings.air;
  const Build build = findings.inquiry.build;
  lines.add("", "for {}, {}, up is {} ({}); found on columns of {:.2f} mm", findings.inquiry.process.name,
            name_of(build), findings.inquiry.direction.name, findings.inquiry.direction.origin, air.spacing);
  if (findings.sealed.count > 0)
    lines.add("sealed", "{}, {:.1f} mm3; the largest {:.1f} mm3 near {} mm",
              count_of(findings.sealed.count, "cavity", "cavities"), findings.sealed.volume,
              findings.sealed.largest, point(findings.sealed.place));
  std::vector<FoundHollow> open;
  std::ranges::copy_if(air.found.hollows, std::back_inserter(open),
                       [](const FoundHollow& hollow) { return !hollow.is_sealed; });
  add_some(lines, open, [&](const FoundHollow& hollow, bool is_first) {
    lines.add(is_first ? "hollows" : "", "{:.1f} mm3 about {} mm", hollow.volume, point(hollow.place));
  });
  add_some(lines, air.found.holes, [&](const FoundHole& hole, bool is_first) {
    lines.add(is_first ? "holes" : "", "about {:.1f} mm wide near {} mm", hole.width, point(hole.place));
  });
  if (air.found.holes.empty()) lines.add("holes", "none narrower than {:g} mm", findings.widest_hole);
  if (air.pools.total > 0) add_pools(lines, "pools", air.pools, build);
  const bool hangs = build == Build::hanging;
  lines.add("recesses", "{:.1f} mm3 stay as printed outside of hollows, {:.1f} turned over",
            hangs ? air.recesses_upside_down : air.recesses_upright,
            hangs ? air.recesses_upright : air.recesses_upside_down);
  if (findings.cups) add_cups(lines, *findings.cups);
  if (air.found.wall)
    lines.add("wall", "{:.2f} mm between a hollow and the outside where it is thinnest, near {} mm",
              air.found.wall->thickness, point(air.found.wall->place));
}

void add_overhangs(Lines& lines, const OverhangFindings& findings) {
  lines.add("overhangs", "{}", findings.verdict);
  if (!findings.overhangs) return;
  lines.add("", "for {}, up is {} ({}): beyond {:g} degrees, and {:g} mm from what holds it; {}",
            findings.inquiry.process.name, findings.inquiry.direction.name, findings.inquiry.direction.origin,
            findings.rules->degrees, findings.rules->reach, findings.rules->reach_source);
  add_some(lines, findings.overhangs->regions, [&](const OverhangRegion& region, bool) {
    const std::string how = region.farthest ? fmt::format("{:.1f} mm from what holds it", *region.farthest)
                                            : std::string("begins in the air");
    lines.add("", "{:.1f} mm2, {:.1f} mm wide, near {} mm, {:.1f} mm up: {}", region.area, region.width,
              point(region.place), region.height, how);
  });
}

}  // namespace

std::string to_text(const HollowReport& report) {
  const OutputFacts& output = report.output;
  Lines lines;
  add_verdict(lines, report);
  add_input(lines, report.input);
  add_limits(lines, report.process);
  add_print_origins(lines, report.print_origins);
  if (output.void_count == 0)
    lines.add("voids", "none");
  else
    add_packing(lines, "voids",
                report.cells ? count_of(output.void_count, "cell round a sphere", "cells round spheres")
                             : count_of(output.void_count, "sphere", "spheres"),
                radii(output.smallest_radius, output.largest_radius), report.method, report.packing_density,
                report.packing_device);
  add_volume(lines, report);
  add_target(lines, report);
  add_stand(lines, report);
  if (output.void_count > 0) add_clearances(lines, output.clearances, report.limits);
  add_kept(lines, report.kept, report.limits);
  add_ceilings(
      lines, output.ceilings,
      fmt::format("{} of {}", grouped(output.roof_count), count_of(output.void_count, "void", "voids")),
      report.limits.roof, report.tolerance_used, report.process);
  add_drainage(lines, report);
  add_cavities(lines, report);
  if (report.cups) add_cups(lines, *report.cups);
  add_plugs(lines, report.plugs);
  if (!report.modifiers) add_balance(lines, report);
  add_material(lines, report);
  add_supports(lines, report);
  const std::size_t in_blockers = blocker_triangles(report);
  lines.add("output", "{}: {} ({} outside, {}{}), {}", report.output_path.filename().string(),
            count_of(output.triangle_count + in_blockers, "triangle", "triangles"),
            grouped(output.outer_triangle_count),
            report.surface == OuterSurface::kept ? "kept as they were" : "remeshed",
            in_blockers > 0 ? fmt::format("; {} of support blockers", grouped(in_blockers)) : "",
            format_bytes(static_cast<double>(report.output_bytes)));
  if (report.voxel_size && report.outer_deviation) {
    lines.add("remeshed", "voxels of {:.3g} mm, at most {:.3g} mm from the model's surface",
              *report.voxel_size, *report.outer_deviation);
  }
  lines.add("tolerance", "{:.3g} mm; void surfaces are at most {:.3g} mm inside their {}",
            report.tolerance_used, output.void_deviation,
            report.cells            ? "cells"
            : output.roof_count > 0 ? "spheres and roofs"
                                    : "spheres");
  add_stages(lines, report.stages);
  return lines.take();
}

std::string to_text(const PackReport& report) {
  const std::vector<Sphere>& spheres = report.packing.spheres;
  const auto [smallest, largest] = std::minmax_element(
      spheres.begin(), spheres.end(), [](const Sphere& a, const Sphere& b) { return a.radius < b.radius; });
  Lines lines;
  add_input(lines, report.input);
  add_limits(lines, report.process);
  add_packing(lines, "spheres", count_of(spheres.size(), "sphere", "spheres"),
              radii(smallest->radius, largest->radius), report.method, report.density, report.packing.device);
  // Of pieces, which are what is written then, below.
  const bool has_pieces = report.cells && report.cells->pieces;
  if (report.clearances && !has_pieces) add_clearances(lines, *report.clearances, report.packing.limits);
  if (!has_pieces) add_kept(lines, report.kept, report.packing.limits);
  const PackingStatistics& statistics = report.packing.statistics;
  lines.add("places",
            "{} tried; {} outside, {} near the surface, {} below the smallest radius, {} where parts "
            "overlap, {} dropped by the last check",
            grouped(statistics.candidates), grouped(statistics.outside), grouped(statistics.near_surface),
            grouped(statistics.below_min_radius), grouped(statistics.overlapped_region),
            grouped(statistics.dropped_by_verification));
  if (has_pieces) add_pieces(lines, report);
  lines.add("output", "{}", output_of(report));
  add_stages(lines, report.stages);
  return lines.take();
}

std::string to_text(const InspectReport& report) {
  const Inspection& inspection = report.input.inspection;
  Lines lines;
  add_input(lines, report.input);
  lines.add("parts", "{} in the file; {}", report.input.part_count,
            count_of(inspection.vertex_count, "vertex", "vertices"));
  const Vec3d lower = to_double(inspection.box.lower);
  const Vec3d upper = to_double(inspection.box.upper);
  lines.add("box", "{} to {} mm", point(lower), point(upper));
  lines.add("volume", "{:.6g} mm3 signed; a slicer fills {:.6g} mm3", inspection.volume,
            inspection.filled_volume);
  lines.add("area", "{:.6g} mm2", inspection.area);
  lines.add("closed", "{}", inspection.closed() ? "yes" : "no");
  lines.add("edges", "{} open, {} misoriented, {} with more than two triangles",
            grouped(inspection.open_edges), grouped(inspection.misoriented_edges),
            grouped(inspection.non_manifold_edges));
  lines.add("triangles", "{} without area, {} doubled", grouped(inspection.degenerate_triangles),
            grouped(inspection.duplicate_triangles));

  add_some(lines, inspection.boundary_loops, [&](const BoundaryLoop& loop, bool is_first) {
    lines.add(is_first ? "holes" : "", "near {} mm, {:.3g} mm across, {}", point(loop.centre), loop.diameter,
              count_of(loop.edge_count, "edge", "edges"));
  });
  lines.add("shells", "{}, {} of them overlapping ({:.4g} mm3)", grouped(inspection.shells.size()),
            grouped(inspection.overlapping_shells), inspection.overlapped_volume);
  add_some(lines, inspection.shells, [&](const Shell& shell, bool) {
    lines.add("", "{}, {:.4g} mm3, {}{}", count_of(shell.triangle_count, "triangle", "triangles"),
              shell.volume, size_of(shell.box), shell.closed ? "" : ", open");
  });

  if (report.self_intersections) {
    lines.add("crossings", "{} that intersect",
              count_of(report.self_intersections->pair_count, "pair of triangles", "pairs of triangles"));
    for (const Vec3d place : report.self_intersections->places) lines.add("", "near {} mm", point(place));
  }
  if (report.drainage) add_findings(lines, *report.drainage);
  if (report.overhangs) add_overhangs(lines, *report.overhangs);
  lines.add("use", "{}", report.use);
  add_stages(lines, report.stages);
  return lines.take();
}

std::string to_text(const SupportReport& report) {
  const SupportFacts& facts = report.facts;
  const bool are_ridges = report.shape.kind == ToothKind::ridge;
  Lines lines;
  add_input(lines, report.input);
  lines.add("overhangs",
            "{}, {:.1f} mm2 seen from above; beyond {:g} degrees and {:g} mm from what holds them ({})",
            count_of(report.overhangs.regions.size(), "overhang", "overhangs"), report.overhangs.area(),
            report.rules.degrees, report.rules.reach, report.process.name);
  lines.add("body", "{:.1f} mm3{}", report.body_volume,
            report.foam.empty() ? std::string()
                                : fmt::format(" -> {:.1f} mm3, {} in it", facts.volume, report.foam));
  if (report.foam.empty() && report.rules.is_filament && report.parts_for == nullptr)
    lines.add(
        "",
        "print it with one perimeter, lightning infill of 10 % and one top layer, as --parts tells a slicer");
  if (std::isfinite(facts.body_distance))
    lines.add("", "{}{:.2f} mm from the model (clearance {:g} mm)",
              facts.body_distance < 2 * report.shape.body.clearance ? "" : "more than ", facts.body_distance,
              report.shape.body.clearance);
  lines.add("teeth", "{}{}, {:g} mm wide, {}",
            count_of(report.tooth_count, are_ridges ? "ridge" : "cone", are_ridges ? "ridges" : "cones"),
            report.foot_count > 0 ? fmt::format(", and {} on the model", grouped(report.foot_count)) : "",
            report.shape.tooth.width,
            report.shape.tooth.gap > 0 ? fmt::format("a gap of {:g} mm", report.shape.tooth.gap)
                                       : std::string("joined to the model"));
  lines.add("contact", "{:.1f} mm2 of the model's underside; {}", facts.contact_area,
            std::isfinite(facts.farthest)
                ? fmt::format("an overhang is {:.2f} mm from what holds it at most", facts.farthest)
                : std::string("there is a place that nothing holds"));
  for (const PartSetting& setting : report.part_settings)
    lines.add(&setting == report.part_settings.data() ? "settings" : "", "{} = {}", setting.key,
              setting.value);
  lines.add("force",
            "about {:.0f} N to break all teeth at once, if they hold as well as solid material: an estimate",
            report.force());
  if (facts.footing_margin)
    lines.add("stands", "centres of mass are at least {:.2f} mm inside of feet", *facts.footing_margin);
  lines.add("output", "{}: {}, {}", report.output.filename().string(),
            count_of(facts.triangle_count, "triangle", "triangles"),
            format_bytes(static_cast<double>(report.output_bytes)));
  add_stages(lines, report.stages);
  return lines.take();
}

}  // namespace aerate::cli
