#include "printing/processes.h"

#include <algorithm>

namespace aerate {
namespace {

constexpr LimitUnit kMillimetres{"mm", "mm", "MM"};
constexpr LimitUnit kSquareMillimetres{"mm2", "mm2", "MM2"};
constexpr LimitUnit kDegreesFromVertical{"degrees from the vertical", "deg", "DEG"};

constexpr LimitUnit kDegrees{"degrees", "deg", "DEG"};

constexpr std::optional<double> kMoreThanZero;

constexpr LimitRow kRows[] = {
    {Limit::wall, LimitGroup::packing, "wall", "--wall", kMillimetres, 0.0,
     "Least thickness between a void and the model's surface"},
    {Limit::gap, LimitGroup::packing, "gap", "--gap", kMillimetres, 0.0, "Least thickness between two voids"},
    {Limit::min_radius, LimitGroup::packing, "min-radius", "--min-radius", kMillimetres, kMoreThanZero,
     "Smaller voids are not made"},
    {Limit::max_radius, LimitGroup::packing, "max-radius", "--max-radius", kMillimetres, kMoreThanZero,
     "Radius of the largest voids"},
    {Limit::cell_size, LimitGroup::cells, "cell-size", "--cell-size", kMillimetres, kMoreThanZero,
     "About how far inner walls are apart where voids are cells"},
    {Limit::least_wall, LimitGroup::printer, "least-wall", "", kMillimetres, 0.0, ""},
    {Limit::least_gap, LimitGroup::printer, "least-gap", "", kMillimetres, 0.0, ""},
    {Limit::overhang, LimitGroup::ceilings, "overhang", "--overhang", kDegreesFromVertical, 1.0,
     "How far a ceiling may lean out before it needs support, in degrees from the vertical; voids whose "
     "ceilings lean further and are wider than --bridge get a roof: a cone that leans by this angle, cut "
     "flat where it is as wide as the bridge",
     90},
    {Limit::bridge, LimitGroup::ceilings, "bridge", "--bridge", kMillimetres, 0.0,
     "Width of the widest flat ceiling that prints without support; one as wide as the largest void leaves "
     "all voids spheres"},
    {Limit::channel, LimitGroup::drainage, "channel", "--channel-diameter", kMillimetres, kMoreThanZero,
     "Diameter of the channels that join voids"},
    {Limit::escape_hole, LimitGroup::drainage, "escape-hole", "--hole-diameter", kMillimetres, kMoreThanZero,
     "Diameter of the escape holes, no less than that of channels"},
    {Limit::cup, LimitGroup::printer, "cup", "", kSquareMillimetres, 0.0, ""},
    {Limit::plug_clearance, LimitGroup::plugs, "plug-clearance", "--plug-clearance", kMillimetres, 0.0,
     "What plugs leave free in their holes all round, where they are widest"},
    {Limit::plug_taper, LimitGroup::plugs, "plug-taper", "--plug-taper", kDegrees, 0.0,
     "Angle by which a plug narrows inwards, on each side", 30},
};
static_assert(std::size(kRows) == kLimitCount);

std::string own(const std::string& why) {
  return "aerate's choice: " + why;
}

}  // namespace

std::span<const LimitRow> limit_rows() {
  return kRows;
}

const LimitRow& row_of(Limit limit) {
  return kRows[static_cast<std::size_t>(limit)];
}

// The guides that figures are taken from (docs/processes.md):
//   Hubs: "Design rules for 3D printing", the table of key design considerations of 3D Hubs (now Protolabs
//         Network)
//   i.materialise: design guide of its standard and gray resins
//   Formlabs: design guide for its SLA printers; Addema's SLA recommendations give the same overhang
//   Materialise: design guidelines for PA 12 (SLS)
//   Shapeways: guidelines for its nylon (escape holes)
//   Protolabs: "How to Design 4 Common Metal 3D Printing Features"
//   Makelab: "What clearance should I give two fitting parts?"
//   Layer X: "Designing snap fits, press fits, and assembly tolerances for 3D printed parts"
std::span<const Process> processes() {
  static const Process kProcesses[] = {
      {"fdm",
       "fused filament, 0.4 mm nozzle",
       "PLA",
       Drainage::not_needed,
       {{Limit::wall, {1.2, own("three extrusion lines; Hubs gives 0.8 mm as the least")}},
        {Limit::gap, {0.9, own("two extrusion lines, the least that separates two voids")}},
        {Limit::min_radius, {0.62, "1 mm3: slicers drop smaller shells (PrusaSlicer)"}},
        {Limit::max_radius, {25, own("ceilings get roofs; at 15 % infill voids pay from about 18 mm on")}},
        {Limit::least_wall, {0.4, own("the nozzle's diameter")}},
        {Limit::least_gap, {0.45, own("one extrusion line of a 0.4 mm nozzle")}},
        {Limit::overhang, {45, "Hubs"}},
        {Limit::bridge, {5, "the lower end of the 5 to 10 mm that guides give; Hubs 10 mm"}},
        {Limit::plug_clearance, {0.2, "Makelab: 0.4 mm between fitting parts, half of it on each side"}},
        {Limit::plug_taper, {2, own("goes in by itself and still fills the hole")}}}},
      {"sla",
       "stereolithography and other resin printers",
       "resin",
       Drainage::needed,
       {{Limit::wall,
         {2.0, "i.materialise: for parts whose sides add up to 200 to 400 mm (below 1, above 3)"}},
        {Limit::gap, {1.0, "Hubs: unsupported wall"}},
        {Limit::min_radius, {2.5, own("wider than the channel that empties it")}},
        {Limit::max_radius, {10, own("guides give no figure; wide ceilings cup and peel")}},
        {Limit::cell_size, {33, own("two holes then drain most parts of 40 to 100 mm (docs/drainage.md)")}},
        {Limit::least_wall, {0.5, "Hubs: supported wall"}},
        {Limit::least_gap, {0.5, "Hubs: supported wall"}},
        {Limit::overhang, {71, "Formlabs: 19 degrees from the level"}},
        {Limit::channel, {3.5, "Formlabs: drain holes of at least 3.5 mm"}},
        {Limit::escape_hole, {3.5, "Formlabs: at least 3.5 mm, two of them"}},
        {Limit::cup, {100, own("guides give no figure; the air presses on this with 10 N at most")}},
        {Limit::plug_clearance, {0.125, "Makelab: 0.25 mm between fitting parts, half of it on each side"}},
        {Limit::plug_taper, {2, own("goes in by itself and still fills the hole")}}}},
      {"sls",
       "powder bed, plastic (SLS, MJF)",
       "PA12",
       Drainage::needed,
       {{Limit::wall, {2.0, "Hubs: hollow parts, 2 to 3 mm"}},
        {Limit::gap, {1.0, "Materialise, PA 12: recommended wall"}},
        {Limit::min_radius, {3.0, own("wider than the channel that empties it")}},
        {Limit::max_radius, {10, own("powder carries any ceiling; guides give no figure")}},
        {Limit::cell_size, {33, own("two holes then drain most parts of 40 to 100 mm (docs/drainage.md)")}},
        {Limit::least_wall, {0.7, "Hubs: supported wall"}},
        {Limit::least_gap, {0.7, "Hubs: supported wall"}},
        {Limit::channel, {4.0, "Shapeways: one hole of at least 4 mm"}},
        {Limit::escape_hole, {5.0, "Hubs: 5 mm"}},
        {Limit::plug_clearance,
         {0.25, "Materialise, PA 12: 0.5 mm of play for a lid on a hollowed part, half of it on each side"}},
        {Limit::plug_taper, {2, own("goes in by itself and still fills the hole")}}}},
      {"metal",
       "powder bed, metal (DMLS, SLM)",
       "AlSi10Mg",
       Drainage::needed,
       {{Limit::wall, {1.0, own("twice the unsupported wall of Hubs, 0.5 mm")}},
        {Limit::gap, {1.0, own("twice the unsupported wall of Hubs, 0.5 mm")}},
        {Limit::min_radius, {3.0, own("wider than the channel that empties it")}},
        {Limit::max_radius, {8, own("guides give no figure")}},
        {Limit::least_wall, {0.4, "Hubs: supported wall"}},
        {Limit::least_gap, {0.4, "Hubs: supported wall"}},
        {Limit::overhang, {45, "Protolabs: self-supporting angles; Hubs"}},
        {Limit::bridge, {2, "Hubs"}},
        {Limit::channel, {2.8, own("level ones have ceilings beyond 45 degrees as wide as the bridge")}},
        {Limit::escape_hole, {5.0, "Hubs: 5 mm"}},
        {Limit::plug_clearance, {0.15, "Layer X: DMLS parts are accurate to 0.05 to 0.15 mm as built"}},
        {Limit::plug_taper, {2, own("goes in by itself and still fills the hole")}}}}};
  return kProcesses;
}

const Process* find_process(std::string_view name) {
  const auto found = std::ranges::find(processes(), name, &Process::name);
  return found == processes().end() ? nullptr : &*found;
}

}  // namespace aerate
