#include "printing/processes.h"

#include <algorithm>
#include <utility>
#include <vector>

namespace aerate {
namespace {

struct LimitName {
  Limit limit;
  std::string_view name;
  std::string_view unit;
};

constexpr LimitName kNames[] = {
    {Limit::wall, "wall", "mm"},
    {Limit::gap, "gap", "mm"},
    {Limit::min_radius, "min-radius", "mm"},
    {Limit::max_radius, "max-radius", "mm"},
    {Limit::least_wall, "least-wall", "mm"},
    {Limit::least_gap, "least-gap", "mm"},
    {Limit::overhang, "overhang", "degrees from the vertical"},
    {Limit::bridge, "bridge", "mm"},
    {Limit::channel, "channel", "mm"},
    {Limit::escape_hole, "escape-hole", "mm"},
};
static_assert(std::size(kNames) == kLimitCount);

// The guides that figures are taken from (docs/processes.md):
//   Hubs: "Design rules for 3D printing", the table of key design considerations of 3D Hubs (now Protolabs
//         Network)
//   i.materialise: design guide of its standard and gray resins
//   Formlabs: design guide for its SLA printers; Addema's SLA recommendations give the same overhang
//   Materialise: design guidelines for PA 12 (SLS)
//   Shapeways: guidelines for its nylon (escape holes)
//   Protolabs: "How to Design 4 Common Metal 3D Printing Features"
constexpr const char* kOwnChoice = "aerate's choice: ";

std::string own(const char* why) {
  return std::string(kOwnChoice) + why;
}

Process make(std::string name, std::string title, std::string material, Drainage drainage,
             const std::vector<std::pair<Limit, SourcedValue>>& figures) {
  Process process{std::move(name), std::move(title), std::move(material), drainage, {}};
  for (const auto& [limit, figure] : figures) process[limit] = figure;
  return process;
}

Process fdm() {
  return make(
      "fdm", "fused filament, 0.4 mm nozzle", "PLA", Drainage::not_needed,
      {{Limit::wall, {kDefaultLimits.wall, own("three extrusion lines; Hubs gives 0.8 mm as the least")}},
       {Limit::gap, {kDefaultLimits.gap, own("two extrusion lines, the least that separates two voids")}},
       {Limit::min_radius, {kDefaultLimits.min_radius, "1 mm3: slicers drop smaller shells (PrusaSlicer)"}},
       {Limit::max_radius,
        {kDefaultLimits.max_radius, own("ceilings get roofs; at 15 % infill voids pay from about 18 mm on")}},
       {Limit::least_wall, {0.4, own("the nozzle's diameter")}},
       {Limit::least_gap, {0.45, own("one extrusion line of a 0.4 mm nozzle")}},
       {Limit::overhang, {45, "Hubs"}},
       {Limit::bridge, {5, "the lower end of the 5 to 10 mm that guides give; Hubs 10 mm"}}});
}

Process sla() {
  return make("sla", "stereolithography and other resin printers", "resin", Drainage::needed,
              {{Limit::wall,
                {2.0, "i.materialise: for parts whose sides add up to 200 to 400 mm (below 1, above 3)"}},
               {Limit::gap, {1.0, "Hubs: unsupported wall"}},
               {Limit::min_radius, {2.5, own("wider than the channel that empties it")}},
               {Limit::max_radius, {10, own("guides give no figure; wide ceilings cup and peel")}},
               {Limit::least_wall, {0.5, "Hubs: supported wall"}},
               {Limit::least_gap, {0.5, "Hubs: supported wall"}},
               {Limit::overhang, {71, "Formlabs: 19 degrees from the level"}},
               {Limit::channel, {3.5, "Formlabs: drain holes of at least 3.5 mm"}},
               {Limit::escape_hole, {3.5, "Formlabs: at least 3.5 mm, two of them"}}});
}

Process sls() {
  return make("sls", "powder bed, plastic (SLS, MJF)", "PA12", Drainage::needed,
              {{Limit::wall, {2.0, "Hubs: hollow parts, 2 to 3 mm"}},
               {Limit::gap, {1.0, "Materialise, PA 12: recommended wall"}},
               {Limit::min_radius, {3.0, own("wider than the channel that empties it")}},
               {Limit::max_radius, {10, own("powder carries any ceiling; guides give no figure")}},
               {Limit::least_wall, {0.7, "Hubs: supported wall"}},
               {Limit::least_gap, {0.7, "Hubs: supported wall"}},
               {Limit::channel, {4.0, "Shapeways: one hole of at least 4 mm"}},
               {Limit::escape_hole, {5.0, "Hubs: 5 mm"}}});
}

Process metal() {
  return make(
      "metal", "powder bed, metal (DMLS, SLM)", "AlSi10Mg", Drainage::needed,
      {{Limit::wall, {1.0, own("twice the unsupported wall of Hubs, 0.5 mm")}},
       {Limit::gap, {1.0, own("twice the unsupported wall of Hubs, 0.5 mm")}},
       {Limit::min_radius, {3.0, own("wider than the channel that empties it")}},
       {Limit::max_radius, {8, own("guides give no figure")}},
       {Limit::least_wall, {0.4, "Hubs: supported wall"}},
       {Limit::least_gap, {0.4, "Hubs: supported wall"}},
       {Limit::overhang, {45, "Protolabs: self-supporting angles; Hubs"}},
       {Limit::bridge, {2, "Hubs"}},
       {Limit::channel, {2.8, own("level ones have ceilings beyond 45 degrees as wide as the bridge")}},
       {Limit::escape_hole, {5.0, "Hubs: 5 mm"}}});
}

}  // namespace

std::string_view name_of(Limit limit) {
  return kNames[static_cast<std::size_t>(limit)].name;
}

std::string_view unit_of(Limit limit) {
  return kNames[static_cast<std::size_t>(limit)].unit;
}

std::optional<Limit> limit_named(std::string_view name) {
  const auto* found = std::find_if(std::begin(kNames), std::end(kNames),
                                   [&](const LimitName& entry) { return entry.name == name; });
  return found == std::end(kNames) ? std::nullopt : std::optional(found->limit);
}

std::span<const Process> processes() {
  static const std::array<Process, 4> kProcesses{fdm(), sla(), sls(), metal()};
  return kProcesses;
}

const Process* find_process(std::string_view name) {
  for (const Process& process : processes())
    if (process.name == name) return &process;
  return nullptr;
}

}  // namespace aerate
