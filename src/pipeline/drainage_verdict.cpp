#include "pipeline/drainage_verdict.h"

#include <algorithm>
#include <fmt/format.h>
#include <utility>
#include <vector>

#include "core/error.h"

namespace aerate {
namespace {

// A model drains of which no more stays than this: twice what `hollow` aims at, since pools are found on columns.
constexpr double kMayStay = 2 * kPoolsAimedAt;

// Holes twice as wide as those that a process asks for are seen as holes.
constexpr double kWidestHoles = 2;

double widest_hole_of(const DrainageInquiry& inquiry) {
  if (inquiry.widest_hole) return *inquiry.widest_hole;
  const auto& limits = inquiry.process.limits;
  if (!limits.contains(Limit::escape_hole) || inquiry.process.drainage == Drainage::not_needed)
    throw UsageError(fmt::format("--drainage: process {} leaves nothing in voids", inquiry.process.name),
                     "give another --process, or say with --widest-hole what is a hole");
  return kWidestHoles * limits.at(Limit::escape_hole).value;
}

std::string point(Vec3d p) {
  return fmt::format("({:.2f}, {:.2f}, {:.2f}) mm", p.x + 0.0, p.y + 0.0, p.z + 0.0);
}

// Of shells; where parts overlap these bound no cavities of their own, and what the air shows counts.
OwnCavities sealed_in(const PreparedModel& model, const FoundHollows& found) {
  if (!model.inspection.parts_overlap()) return cavities_of(model.inspection);
  OwnCavities cavities;
  for (const FoundHollow& hollow : found.hollows) {
    if (!hollow.is_sealed) continue;
    if (cavities.count++ == 0) {
      cavities.largest = hollow.volume;
      cavities.place = hollow.place;
    }
    cavities.volume += hollow.volume;
  }
  return cavities;
}

double share_of(double volume, const TrappedPools& pools) {
  return pools.total > 0 ? volume / pools.total : 0;
}

std::string what_suction_says(const DrainageFindings& findings) {
  if (!findings.cups || findings.cups->over_limit == 0 || findings.cups->build != Build::hanging) return {};
  const AirCup& cup = *findings.cups->widest;
  return fmt::format("; a suction cup of {:.0f} mm2 while it is printed, {:.2f} mm from its start", cup.area,
                     cup.height);
}

// Whether the hollows that are open drain, and why not.
std::string what_pools_say(const DrainageFindings& findings) {
  const InspectedDrainage& air = *findings.air;
  const Build build = findings.inquiry.build;
  const bool is_hollow = air.pools.total > 0;
  if (share_of(air.pools.after_both, air.pools) > kMayStay)
    return fmt::format("does not drain: {:.1f} mm3 ({:.1f} % of its hollows) stay as printed and turned over",
                       air.pools.after_both, 100 * share_of(air.pools.after_both, air.pools));
  if (!is_hollow) return "has no hollow that could keep anything";
  const double printed = as_printed(air.pools, build);
  std::string verdict = "drains";
  if (share_of(printed, air.pools) > kMayStay)
    verdict =
        fmt::format("drains once it is turned over: {:.1f} mm3 ({:.1f} % of its hollows) stay as printed",
                    printed, 100 * share_of(printed, air.pools));
  return verdict;
}

// Hollows with one hole: what runs out there has to let air in by the same way.
std::size_t count_with_one_hole(const FoundHollows& found) {
  std::vector<std::size_t> holes(found.hollows.size(), 0);
  for (const FoundHole& hole : found.holes) ++holes[hole.hollow];
  return static_cast<std::size_t>(std::count(holes.begin(), holes.end(), 1));
}

void judge(DrainageFindings& findings) {
  const InspectedDrainage& air = *findings.air;
  const OwnCavities& sealed = findings.sealed;
  const bool keeps_little = share_of(air.pools.after_both, air.pools) <= kMayStay;
  findings.drains = sealed.count == 0 && keeps_little;
  if (sealed.count > 0) {
    findings.verdict = fmt::format("does not drain: {} sealed {} of {:.1f} mm3", sealed.count,
                                   sealed.count == 1 ? "cavity" : "cavities", sealed.volume);
    if (air.pools.total > 0) findings.verdict += "; what is open " + what_pools_say(findings);
  } else {
    findings.verdict = what_pools_say(findings);
  }
  if (const std::size_t one = count_with_one_hole(air.found); one > 0 && findings.drains)
    findings.verdict += one == 1 ? "; one hollow has a single hole, by which air has to get in as well"
                                 : fmt::format(
                                       "; {} hollows have a single hole each, by which air has to "
                                       "get in as well",
                                       one);
  findings.verdict += what_suction_says(findings);
}

}  // namespace

std::optional<PrintedCups> printed_cups(const std::vector<AirCup>& cups, const Process& process,
                                        Build build) {
  const auto limit = process.limits.find(Limit::cup);
  if (limit == process.limits.end()) return std::nullopt;
  PrintedCups printed{.build = build, .limit = limit->second, .widest = std::nullopt, .over_limit = 0};
  if (!cups.empty()) printed.widest = cups.front();
  for (const AirCup& cup : cups) {
    const bool is_over = cup.area > printed.limit.value;
    printed.over_limit += is_over ? 1 : 0;
    if (is_over || printed.worst.empty()) printed.worst.push_back(cup);
  }
  return printed;
}

void warn_of_suction(const PrintedCups& cups, const Process& process, Monitor& monitor) {
  if (cups.over_limit == 0 || cups.build != Build::hanging) return;
  const AirCup& cup = *cups.widest;
  monitor.notice(fmt::format(
      "suction: {:.0f} mm2 near {} are closed in, with {:.1f} mm3, but for the layer that is printed {:.2f} "
      "mm from the start of the print ({}: {:g} mm2 at most{}); an escape hole near {} would end it",
      cup.area, point(cup.place), cup.volume, cup.height, process.name, cups.limit.value,
      cups.over_limit > 1 ? fmt::format("; {} more cups are over it", cups.over_limit - 1) : "",
      point(cup.bottom)));
}

DrainageFindings inspect_drainage_of(const PreparedModel& read, const DrainageInquiry& inquiry,
                                     Monitor& monitor) {
  DrainageFindings findings{.inquiry = inquiry,
                            .widest_hole = widest_hole_of(inquiry),
                            .air = std::nullopt,
                            .sealed = {},
                            .cups = std::nullopt,
                            .drains = false,
                            .verdict = {}};
  UsableCopy usable = usable_copy(read, monitor);
  if (!usable.model) {
    findings.verdict = std::move(usable.verdict);
    return findings;
  }
  const PreparedModel& model = *usable.model;
  findings.air = inspect_drainage(model.mesh,
                                  {.up = inquiry.direction.up, .widest_hole = findings.widest_hole}, monitor);
  findings.sealed = sealed_in(model, findings.air->found);
  findings.cups = printed_cups(findings.air->cups, inquiry.process, inquiry.build);
  if (findings.cups) warn_of_suction(*findings.cups, inquiry.process, monitor);
  constexpr double kColumnsAcrossHole = 3;
  const double narrowest = kColumnsAcrossHole * findings.air->spacing;
  const auto asked = inquiry.process.limits.find(Limit::escape_hole);
  if (asked != inquiry.process.limits.end() && narrowest > asked->second.value)
    monitor.notice(
        fmt::format("the model is large: holes narrower than {:.1f} mm may not be seen", narrowest));
  judge(findings);
  return findings;
}

}  // namespace aerate
