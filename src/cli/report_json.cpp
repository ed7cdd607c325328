#include <algorithm>
#include <cmath>
#include <filesystem>
#include <optional>

#include "cli/json_parts.h"
#include "cli/reports.h"
#include "core/ceiling.h"
#include "core/overhang.h"
#include "pipeline/print_verdict.h"
#include "printing/slicers/slicers.h"
#include "printing/strength.h"

namespace aerate::cli {
namespace {

Json json_of(Vec3d v) {
  return {v.x, v.y, v.z};
}

Json json_of(const std::optional<Vec3d>& value) {
  return value ? json_of(*value) : Json(nullptr);
}

Json json_of(const Box3f& box) {
  return {{"lower_mm", json_of(to_double(box.lower))}, {"upper_mm", json_of(to_double(box.upper))}};
}

Json json_of(const InputFacts& input) {
  const Inspection& inspection = input.inspection;
  return {{"path", input.path.string()},
          {"format", input.format},
          {"parts", input.part_count},
          {"scale", json_of(input.scale)},
          {"triangles", inspection.triangle_count},
          {"vertices", inspection.vertex_count},
          {"box", json_of(inspection.box)},
          {"signed_volume_mm3", inspection.volume},
          {"filled_volume_mm3", inspection.filled_volume},
          {"area_mm2", inspection.area},
          {"closed", inspection.closed()},
          {"open_edges", inspection.open_edges},
          {"misoriented_edges", inspection.misoriented_edges},
          {"non_manifold_edges", inspection.non_manifold_edges},
          {"degenerate_triangles", inspection.degenerate_triangles},
          {"duplicate_triangles", inspection.duplicate_triangles},
          {"holes", inspection.boundary_loops.size()},
          {"shells", inspection.shells.size()},
          {"overlapping_shells", inspection.overlapping_shells},
          {"overlapped_volume_mm3", inspection.overlapped_volume}};
}

Json json_of(const PackingLimits& limits) {
  const Roof& roof = limits.roof;
  return {{"wall_mm", limits.wall},
          {"gap_mm", limits.gap},
          {"min_radius_mm", limits.min_radius},
          {"max_radius_mm", limits.max_radius},
          {"overhang_degrees", roof.limits_ceilings() ? Json(overhang_degrees(roof)) : Json(nullptr)},
          {"bridge_mm", roof.limits_ceilings() ? Json(roof.bridge()) : Json(nullptr)},
          {"up", json_of(roof.up)}};
}

Json json_of(const ProcessChoice& choice) {
  Json origins = Json::array();
  for (const auto& [limit, chosen] : choice.limits) {
    origins.push_back({{"limit", row_of(limit).name},
                       {"value", chosen.value},
                       {"unit", row_of(limit).unit.name},
                       {"origin", chosen.origin},
                       {"source", chosen.source.empty() ? Json(nullptr) : Json(chosen.source)}});
  }
  return {{"name", choice.process.name},
          {"title", choice.process.title},
          {"drainage_needed", choice.process.drainage == Drainage::needed},
          {"limits", origins},
          {"up", {{"direction", choice.direction.name}, {"origin", choice.direction.origin}}}};
}

Json json_of(const std::string& method, const DeviceUse& device, double density,
             const PackingStatistics& statistics) {
  return {{"method", method},
          {"device", {{"name", device.name}, {"reason", device.reason}}},
          {"density", density},
          {"candidates", statistics.candidates},
          {"outside", statistics.outside},
          {"overlapped_region", statistics.overlapped_region},
          {"near_surface", statistics.near_surface},
          {"below_min_radius", statistics.below_min_radius},
          {"shrunk_by_verification", statistics.shrunk_by_verification},
          {"dropped_by_verification", statistics.dropped_by_verification},
          {"index_bytes", statistics.index_bytes}};
}

Json json_of(const Clearances& clearances) {
  return {{"wall_mm", clearances.wall}, {"gap_mm", or_null(clearances.gap)}};
}

Json json_of(const std::optional<Ceilings>& ceilings, std::size_t roof_count, const PackingLimits& limits) {
  if (!ceilings) return nullptr;
  return {{"roofs", roof_count},
          {"count", ceilings->count},
          {"flatter_than_degrees", overhang_degrees(limits.roof) + kCeilingMarginDegrees},
          {"widest_mm", ceilings->widest}};
}

Json json_of(const std::optional<KeptFacts>& kept) {
  if (!kept) return nullptr;
  return {{"regions", kept->count}, {"volume_mm3", kept->volume}, {"wall_mm", or_null(kept->wall)}};
}

Json json_of(const PackedCells& cells, const PackReport& report) {
  Json json{{"count", report.packing.spheres.size()}, {"planes", cells.plane_count}, {"pieces", nullptr}};
  if (!cells.pieces) return json;
  const PieceFacts& pieces = *cells.pieces;
  json["pieces"] = {{"count", pieces.piece_count},
                    {"volume_mm3", pieces.volume},
                    {"volume_percent", 100 * pieces.volume / report.input.inspection.filled_volume},
                    {"triangles", pieces.triangle_count},
                    {"fillet_mm", cells.options.fillet},
                    {"tolerance_mm", cells.tolerance},
                    {"deviation_mm", pieces.deviation},
                    {"measured", json_of(pieces.clearances)},
                    {"ceilings", json_of(pieces.ceilings, pieces.roof_count, report.limits)}};
  return json;
}

// What voids would remove they do not as modifiers: null there, and what is known under "modifiers".
Json material_of(const HollowReport& report) {
  if (report.modifiers) return nullptr;
  const MaterialUse use = material_use(report);
  return {{"name", report.material.name},
          {"density_g_cm3", report.material.density_g_cm3},
          {"price_per_kg", report.material.price_per_kg},
          {"price_per_litre", report.material.price_per_litre()},
          {"bulk_density_g_cm3", or_null(report.material.bulk_density_g_cm3)},
          {"priced_per", name_of(report.material.priced_per)},
          {"assumes", use.predicted ? "the predicted filament" : "solid material (100 % infill)"},
          {"mass_before_g", use.mass_before_g},
          {"mass_after_g", use.mass_after_g},
          {"mass_saved_g", use.mass_before_g - use.mass_after_g},
          {"cost_before", use.cost_before},
          {"cost_after", use.cost_after},
          {"cost_saved", use.cost_before - use.cost_after}};
}

const char* name_of(TimeChange change) {
  switch (change) {
    case TimeChange::shorter:
      return "shorter";
    case TimeChange::same:
      return "same";
    case TimeChange::longer:
      return "longer";
  }
  return "unknown";
}

Json in_percent(const std::optional<double>& share) {
  return share ? Json(100 * *share) : Json(nullptr);
}

Json json_of(const std::vector<PrintOrigin>& origins) {
  Json json = Json::object();
  for (const PrintOrigin& each : origins)
    json[each.name] = {{"origin", each.origin}, {"key", each.key.empty() ? Json(nullptr) : Json(each.key)}};
  return json;
}

Json verdict_json(const PrintPrediction& print) {
  return {{"text", verdict_in_words(print)},
          {"infill_percent", 100 * print.usual.infill},
          {"infill_is_assumed", !print.described},
          {"filament_before_mm3", print.usual.before_mm3},
          {"filament_after_mm3", print.usual.after_mm3},
          {"filament_change_percent", 100 * print.usual.share()},
          {"solid_change_percent", 100 * print.solid.share()},
          {"as_modifiers_change_percent", in_percent(print.as_modifiers)}};
}

Json json_of(const PrintPrediction& print) {
  const PrintSettings& settings = print.settings;
  return {{"verdict", verdict_json(print)},
          {"described", print.described},
          {"infill_percent", 100 * settings.infill},
          {"modifier_infill_percent", 100 * settings.modifier_infill},
          {"infill_pattern", settings.pattern == InfillPattern::gyroid ? "gyroid" : "lines"},
          {"perimeters", settings.perimeters},
          {"line_width_mm", settings.line_width},
          {"layer_height_mm", settings.layer_height},
          {"top_layers", settings.top_layers},
          {"bottom_layers", settings.bottom_layers},
          {"filament_before_mm3", print.filament_before_mm3},
          {"filament_after_mm3", print.filament_after_mm3},
          {"filament_change_percent", 100 * (print.filament_after_mm3 / print.filament_before_mm3 - 1)},
          {"break_even_infill_percent", in_percent(print.break_even_infill)},
          {"break_even_radius_mm", or_null(print.break_even_radius)},
          {"time_direction", name_of(print.time)}};
}

Json json_of(const TrappedPools& pools, Build build) {
  return {{"print_orientation_mm3", as_printed(pools, build)},
          {"upside_down_mm3", turned_over(pools, build)},
          {"after_both_mm3", pools.after_both},
          {"after_both_percent", pools.total > 0 ? 100 * pools.after_both / pools.total : 0}};
}

const char* name_of(HolePurpose purpose) {
  switch (purpose) {
    case HolePurpose::asked:
      return "asked";
    case HolePurpose::drain:
      return "drain";
    case HolePurpose::pool:
      return "pool";
    case HolePurpose::cup:
      return "cup";
  }
  return "";
}

Json json_of(const std::optional<PrintedCups>& cups) {
  if (!cups) return nullptr;
  Json json{{"limit_mm2", cups->limit.value},
            {"limit_source", cups->limit.source},
            {"over_limit", cups->over_limit},
            {"widest", nullptr}};
  if (cups->widest)
    json["widest"] = {{"area_mm2", cups->widest->area},
                      {"volume_mm3", cups->widest->volume},
                      {"height_mm", cups->widest->height},
                      {"place_mm", json_of(cups->widest->place)},
                      {"bottom_mm", json_of(cups->widest->bottom)}};
  return json;
}

Json json_of(const DrainageFindings& findings) {
  Json json{{"verdict", findings.verdict},
            {"drains", findings.air ? Json(findings.drains) : Json(nullptr)},
            {"process", findings.inquiry.process.name},
            {"build", name_of(findings.inquiry.build)},
            {"up", findings.inquiry.direction.name},
            {"widest_hole_mm", findings.widest_hole}};
  if (!findings.air) return json;
  const InspectedDrainage& air = *findings.air;
  const bool hangs = findings.inquiry.build == Build::hanging;
  json["spacing_mm"] = air.spacing;
  json["sealed"] = {
      {"count", findings.sealed.count},
      {"volume_mm3", findings.sealed.volume},
      {"largest_mm3", findings.sealed.largest},
      {"largest_mm", findings.sealed.count > 0 ? json_of(findings.sealed.place) : Json(nullptr)}};
  json["hollows"] = Json::array();
  for (const FoundHollow& hollow : air.found.hollows)
    json["hollows"].push_back(
        {{"volume_mm3", hollow.volume}, {"place_mm", json_of(hollow.place)}, {"sealed", hollow.is_sealed}});
  json["holes"] = Json::array();
  for (const FoundHole& hole : air.found.holes)
    json["holes"].push_back(
        {{"place_mm", json_of(hole.place)}, {"width_mm", hole.width}, {"hollow", hole.hollow}});
  json["pools"] = json_of(air.pools, findings.inquiry.build);
  json["recesses"] = {{"print_orientation_mm3", hangs ? air.recesses_upside_down : air.recesses_upright},
                      {"upside_down_mm3", hangs ? air.recesses_upright : air.recesses_upside_down}};
  json["cups"] = json_of(findings.cups);
  json["thinnest_wall_mm"] = air.found.wall ? Json(air.found.wall->thickness) : Json(nullptr);
  json["thinnest_wall_place_mm"] = air.found.wall ? json_of(air.found.wall->place) : Json(nullptr);
  return json;
}

Json json_of(const OverhangFindings& findings) {
  Json json{{"verdict", findings.verdict},
            {"process", findings.inquiry.process.name},
            {"up", findings.inquiry.direction.name}};
  if (!findings.rules) return json;
  json["overhang_degrees"] = findings.rules->degrees;
  json["reach_mm"] = findings.rules->reach;
  json["reach_source"] = findings.rules->reach_source;
  if (!findings.overhangs) return json;
  json["spacing_mm"] = findings.overhangs->spacing;
  json["area_mm2"] = findings.overhangs->area();
  json["regions"] = Json::array();
  for (const OverhangRegion& region : findings.overhangs->regions)
    json["regions"].push_back({{"area_mm2", region.area},
                               {"place_mm", json_of(region.place)},
                               {"height_mm", region.height},
                               {"width_mm", region.width},
                               {"begins_in_air", !region.farthest},
                               {"farthest_mm", or_null(region.farthest)}});
  return json;
}

Json json_of(const DrainedVoids& drainage, const MeasuredDrainage& measured, Build build) {
  Json holes = Json::array();
  for (const EscapeHole& hole : drainage.plan.holes) {
    const Vec3d along = hole.tube.end - hole.tube.start;
    holes.push_back({{"place_mm", json_of(hole.tube.end)},
                     {"outwards", json_of(normalised(along))},
                     {"diameter_mm", 2 * hole.tube.radius},
                     {"network", hole.network},
                     {"purpose", name_of(hole.purpose)},
                     {"shows_percent", 100 * hole.shows}});
  }
  return {{"channel_diameter_mm", 2 * drainage.request.channel_radius},
          {"hole_diameter_mm", 2 * drainage.request.hole_radius},
          {"networks", drainage.plan.network_count},
          {"channels", drainage.plan.channels.size()},
          {"holes", holes},
          {"channel_wall_mm", drainage.plan.channels.empty() ? Json(nullptr) : Json(measured.channel_wall)},
          {"cut_triangles", measured.cut_triangles},
          {"sealed_cavities", measured.sealed_cavities},
          {"cavities_of_model", measured.cavities_of_model},
          {"pools", json_of(drainage.plan.pools, build)},
          {"build", name_of(build)},
          {"dropped_voids",
           {{"count", drainage.dropped.count()},
            {"volume_mm3", drainage.dropped.volume},
            {"narrow", drainage.dropped.narrow},
            {"unreached", drainage.dropped.unreached},
            {"unopened", drainage.dropped.unopened},
            {"full", drainage.dropped.full}}}};
}

Json json_of(const CavityHole& hole) {
  const Vec3d along = hole.tube.end - hole.tube.start;
  return {{"place_mm", json_of(hole.tube.end)},
          {"outwards", json_of(normalised(along))},
          {"diameter_mm", 2 * hole.tube.radius},
          {"length_mm", length(along)},
          {"shows_percent", 100 * hole.shows}};
}

Json json_of(const std::optional<CavityFacts>& facts, Build build) {
  if (!facts) return nullptr;
  Json cavities = Json::array();
  for (const OpenedCavity& cavity : facts->opened.cavities) {
    Json holes = Json::array();
    for (const CavityHole& hole : cavity.holes) holes.push_back(json_of(hole));
    cavities.push_back(
        {{"volume_mm3", cavity.volume}, {"place_mm", json_of(cavity.place)}, {"holes", holes}});
  }
  return {{"count", facts->opened.cavities.size()},
          {"volume_mm3", facts->opened.volume()},
          {"holes", facts->opened.hole_count()},
          {"removed_by_holes_mm3", facts->opened.removed},
          {"cavities", cavities},
          {"hollows_mm3", facts->pools ? Json(facts->pools->total) : Json(nullptr)},
          {"pools_of_file", facts->pools ? json_of(*facts->pools, build) : Json(nullptr)}};
}

// Each hole with its plug.
void add_plugs(Json& drainage, const std::optional<WrittenPlugs>& written) {
  for (Json& hole : drainage["holes"]) hole["plug"] = nullptr;
  drainage["plugs"] = nullptr;
  if (!written) return;
  for (const Plug& plug : written->plugs.plugs) {
    drainage["holes"][plug.hole]["plug"] = {{"number", plug.hole + 1},
                                            {"is_engraved", plug.is_numbered},
                                            {"place_mm", {plug.place.x, plug.place.y}},
                                            {"diameter_mm", 2 * plug.radius},
                                            {"inner_diameter_mm", 2 * plug.inner_radius},
                                            {"shortest_mm", plug.shortest},
                                            {"longest_mm", plug.longest}};
  }
  drainage["plugs"] = {
      {"path", written->request.output.string()}, {"bytes", written->bytes},
      {"count", written->plugs.plugs.size()},     {"volume_mm3", written->facts.volume},
      {"clearance_mm", written->facts.clearance}, {"taper_degrees", written->request.fit.taper_degrees},
      {"flush_within_mm", written->facts.flush}};
}

Json json_of(const Balance& balance, const OutputFacts& output, const ShareOfBound& blocks) {
  return {{"solid_fraction", output.volume_after / output.volume_before},
          {"relative_stiffness_upper_bound", balance.stiffness},
          {"poisson_ratio", kPoissonRatio},
          {"blocks_relative_to_bound", {{"least", blocks.least}, {"most", blocks.most}}},
          {"footing_margin_before_mm", or_null(balance.margin_before)},
          {"footing_margin_after_mm", or_null(balance.margin_after)},
          {"tips_over", balance.tips_over()}};
}

Json volume_of(const HollowReport& report) {
  const OutputFacts& output = report.output;
  const auto of_voids = [&](double value) { return report.modifiers ? Json(nullptr) : Json(value); };
  return {{"before_mm3", output.volume_before},
          {"after_mm3", of_voids(output.volume_after)},
          {"removed_mm3", of_voids(output.volume_removed)},
          {"removed_percent", of_voids(100 * output.volume_removed / output.volume_before)},
          {"estimated", report.volume_estimated}};
}

Json modifiers_of(const HollowReport& report) {
  if (!report.modifiers) return nullptr;
  const OutputFacts& output = report.output;
  const MaterialUse use = material_use(report);
  return {{"flavor", report.modifiers->slicer->modifiers->flavor},
          {"infill_percent", report.modifiers->infill_percent},
          {"pattern", report.modifiers->hold_lightning ? Json(kLightning) : Json(nullptr)},
          {"volume_mm3", output.volume_removed},
          {"volume_percent", 100 * output.volume_removed / output.volume_before},
          {"most_saved_g_per_infill_percent", report.modifiers->hold_lightning
                                                  ? Json(nullptr)
                                                  : Json((use.mass_before_g - use.mass_after_g) / 100)}};
}

// What was asked for in one of its two units, and reached in both.
Json target_of(const HollowReport& report) {
  if (!report.target) return nullptr;
  const TargetFacts& target = *report.target;
  const bool is_mass = target.asked.kind == SavingTarget::Kind::mass;
  const OutputFacts& output = report.output;
  const auto percent = [&](double removed) { return 100 * removed / output.volume_before; };
  return {{"mass_g", is_mass ? Json(target.asked.value) : Json(nullptr)},
          {"saving_percent", is_mass ? Json(nullptr) : Json(100 * target.asked.value)},
          {"reached_mass_g", output.volume_after * report.material.density_g_cm3 / 1000},
          {"reached_saving_percent", percent(output.volume_removed)},
          {"voids_to_choose_from", target.all_voids},
          {"most_saving_percent", percent(target.all_removed)}};
}

Json blockers_of(const HollowReport& report) {
  if (report.support_blockers == nullptr) return nullptr;
  return {{"flavor", report.support_blockers->modifiers->flavor},
          {"count", report.output.void_count},
          {"triangles", blocker_triangles(report)},
          {"growth_mm", report.blocker_growth}};
}

Json stand_of(const HollowReport& report) {
  if (!report.stand) return nullptr;
  const StandFacts& stand = *report.stand;
  const std::size_t made = report.output.void_count;
  return {{"asked_mm", stand.asked},
          {"needed_margin_mm", stand.needed},
          {"margin_before_mm", stand.margin_before},
          {"margin_after_mm", or_null(report.balance.margin_after)},
          {"margin_with_all_mm", stand.margin_with_all},
          {"voids_to_choose_from", stand.all_voids},
          {"voids_left_out", stand.all_voids - std::min(stand.all_voids, made)}};
}

// Null where nothing was written.
Json path_of(const std::filesystem::path& output) {
  return output.empty() ? Json(nullptr) : Json(output.string());
}

Json bytes_of(const std::filesystem::path& output, std::size_t bytes) {
  return output.empty() ? Json(nullptr) : Json(bytes);
}

}  // namespace

std::string to_json(const HollowReport& report) {
  const OutputFacts& output = report.output;
  Json json = report_header("hollow");
  json["input"] = json_of(report.input);
  json["process"] = json_of(report.process);
  json["limits"] = json_of(report.limits);
  json["limits"]["tolerance_mm"] = report.tolerance_asked;
  json["limits"]["max_triangles"] = or_null(report.max_triangles);
  json["packing"] =
      json_of(report.method, report.packing_device, report.packing_density, report.packing_statistics);
  json["surface"] = {{"mode", report.surface == OuterSurface::kept ? "kept" : "remeshed"},
                     {"voxel_mm", or_null(report.voxel_size)},
                     {"outer_deviation_mm", or_null(report.outer_deviation)}};
  json["output"] = {{"path", path_of(report.output_path)},
                    {"bytes", bytes_of(report.output_path, report.output_bytes)},
                    {"triangles", output.triangle_count + blocker_triangles(report)},
                    {"outer_triangles", output.outer_triangle_count},
                    {"void_triangles", output.void_triangle_count}};
  json["voids"] = {{"shape", report.cells ? "cells" : "spheres"},
                   {"fillet_mm", report.cells ? Json(report.cells->fillet) : Json(nullptr)},
                   {"count", output.void_count},
                   {"min_radius_mm", output.smallest_radius},
                   {"max_radius_mm", output.largest_radius},
                   {"tolerance_used_mm", report.tolerance_used},
                   {"deviation_mm", output.void_deviation}};
  json["target"] = target_of(report);
  json["stand"] = stand_of(report);
  json["measured"] = json_of(output.clearances);
  json["keep_solid"] = json_of(report.kept);
  json["ceilings"] = json_of(output.ceilings, output.roof_count, report.limits);
  json["drainage"] =
      report.drainage ? json_of(*report.drainage, *output.drainage, report.build) : Json(nullptr);
  json["opened_cavities"] = json_of(report.cavities, report.build);
  json["cups"] = json_of(report.cups);
  if (report.drainage) add_plugs(json["drainage"], report.plugs);
  json["volume"] = volume_of(report);
  json["modifiers"] = modifiers_of(report);
  json["support_blockers"] = blockers_of(report);
  json["centre_of_mass"] = {
      {"before_mm", json_of(output.centre_of_mass_before)},
      {"after_mm", report.modifiers ? Json(nullptr) : json_of(output.centre_of_mass_after)}};
  json["strength_and_balance"] =
      report.modifiers ? Json(nullptr) : json_of(report.balance, output, blocks_like(report));
  json["print"] = report.print ? json_of(*report.print) : Json(nullptr);
  if (report.print) json["print"]["origins"] = json_of(report.print_origins);
  json["material"] = material_of(report);
  add_closing(json, report.stages, report.notices);
  return dump(json);
}

std::string to_json(const PackReport& report) {
  Json json = report_header("pack");
  json["input"] = json_of(report.input);
  json["process"] = json_of(report.process);
  json["limits"] = json_of(report.limits);
  json["packing"] = json_of(report.method, report.packing.device, report.density, report.packing.statistics);
  json["packing"]["spheres"] = report.packing.spheres.size();
  json["measured"] = report.clearances ? json_of(*report.clearances) : Json(nullptr);
  json["keep_solid"] = json_of(report.kept);
  json["cells"] = report.cells ? json_of(*report.cells, report) : Json(nullptr);
  json["output"] = {{"path", path_of(report.output)},
                    {"bytes", bytes_of(report.output, report.output_bytes)}};
  add_closing(json, report.stages, report.notices);
  return dump(json);
}

std::string to_json(const InspectReport& report) {
  const Inspection& inspection = report.input.inspection;
  Json json = report_header("inspect");
  json["input"] = json_of(report.input);
  Json holes = Json::array();
  for (const BoundaryLoop& loop : inspection.boundary_loops)
    holes.push_back(
        {{"edges", loop.edge_count}, {"centre_mm", json_of(loop.centre)}, {"diameter_mm", loop.diameter}});
  json["holes"] = holes;
  Json shells = Json::array();
  for (const Shell& shell : inspection.shells)
    shells.push_back({{"triangles", shell.triangle_count},
                      {"signed_volume_mm3", shell.volume},
                      {"box", json_of(shell.box)},
                      {"closed", shell.closed}});
  json["shells"] = shells;
  json["use"] = report.use;
  json["drainage"] = report.drainage ? json_of(*report.drainage) : Json(nullptr);
  json["overhangs"] = report.overhangs ? json_of(*report.overhangs) : Json(nullptr);
  if (report.self_intersections) {
    Json places = Json::array();
    for (const Vec3d place : report.self_intersections->places) places.push_back(json_of(place));
    json["self_intersections"] = {{"pairs", report.self_intersections->pair_count}, {"places_mm", places}};
  } else {
    json["self_intersections"] = nullptr;
  }
  add_closing(json, report.stages, report.notices);
  return dump(json);
}

std::string to_json(const SupportReport& report) {
  const SupportFacts& facts = report.facts;
  const auto finite = [](double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); };
  Json json = report_header("support");
  json["input"] = json_of(report.input);
  json["process"] = report.process.name;
  json["up"] = report.direction.name;
  json["limits"] = {{"overhang_degrees", report.rules.degrees},    {"reach_mm", report.rules.reach},
                    {"reach_source", report.rules.reach_source},   {"layer_mm", report.rules.layer},
                    {"clearance_mm", report.shape.body.clearance}, {"contact_gap_mm", report.shape.tooth.gap},
                    {"stem_mm", 2 * report.shape.body.foot}};
  json["overhangs"] = {{"count", report.overhangs.regions.size()}, {"area_mm2", report.overhangs.area()}};
  json["body"] = {{"volume_mm3", report.body_volume},
                  {"fill", report.foam.empty() ? Json("plain") : Json(report.foam)},
                  {"volume_after_mm3", facts.volume},
                  {"distance_mm", finite(facts.body_distance)},
                  {"footing_margin_mm", or_null(facts.footing_margin)},
                  {"unsupported_mm2", or_null(facts.own_unsupported_area)}};
  json["teeth"] = {{"kind", report.shape.kind == ToothKind::ridge ? "ridges" : "cones"},
                   {"count", report.tooth_count},
                   {"on_model", report.foot_count},
                   {"width_mm", report.shape.tooth.width},
                   {"distance_mm", finite(facts.tooth_distance)},
                   {"tip_area_mm2", report.tip_area},
                   {"strength_mpa", report.strength},
                   {"force_estimate_n", report.force()}};
  json["contact"] = {{"area_mm2", facts.contact_area},
                     {"farthest_mm", finite(facts.farthest)},
                     {"unsupported_mm2", facts.unsupported_area}};
  Json settings = Json::object();
  for (const PartSetting& setting : report.part_settings) settings[setting.key] = setting.value;
  json["parts"] = report.parts_for == nullptr
                      ? Json(nullptr)
                      : Json{{"flavor", report.parts_for->modifiers->flavor}, {"settings", settings}};
  json["output"] = {
      {"path", report.output.string()}, {"bytes", report.output_bytes}, {"triangles", facts.triangle_count}};
  add_closing(json, report.stages, report.notices);
  return dump(json);
}

}  // namespace aerate::cli
