#include "pipeline/overhang_findings.h"

#include <algorithm>
#include <fmt/format.h>
#include <utility>

#include "core/error.h"
#include "core/listed.h"

namespace aerate {
namespace {

std::string in_words(const Overhangs& overhangs) {
  if (overhangs.regions.empty()) return "prints without supports";
  const auto in_the_air =
      std::ranges::count_if(overhangs.regions, [](const OverhangRegion& region) { return !region.farthest; });
  return fmt::format("needs supports: {}, {:.1f} mm2 seen from above{}",
                     counted(overhangs.regions.size(), "overhang", "overhangs"), overhangs.area(),
                     in_the_air > 0 ? fmt::format("; {} of them {} in the air", in_the_air,
                                                  in_the_air == 1 ? "begins" : "begin")
                                    : "");
}

}  // namespace

OverhangFindings find_overhangs_of(const PreparedModel& read, const OverhangInquiry& inquiry,
                                   Monitor& monitor) {
  OverhangFindings findings{inquiry, support_rules(inquiry.process, inquiry.given), std::nullopt, {}};
  if (!findings.rules) {
    findings.verdict = "needs no supports: the powder of " + inquiry.process.name + " carries it";
    return findings;
  }
  UsableCopy usable = usable_copy(read, monitor);
  if (!usable.model) {
    findings.verdict = std::move(usable.verdict);
    return findings;
  }
  findings.overhangs = find_overhangs(usable.model->mesh, *findings.rules, inquiry.direction.up, monitor);
  findings.verdict = in_words(*findings.overhangs);
  return findings;
}

}  // namespace aerate
