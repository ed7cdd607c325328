#include "supports/support_rules.h"

#include <fmt/format.h>

#include "core/error.h"

namespace aerate {
namespace {

// Of a process that has an overhang angle and no bridge.
constexpr double kUnsupportedReach = 1;
constexpr const char* kUnsupportedSource =
    "Addema's SLA recommendations: unsupported overhangs below 1 mm; EnvisionTEC's test parts agree";

}  // namespace

std::optional<SupportRules> support_rules(const Process& process, const Limits& given) {
  if (!process.limits.contains(Limit::overhang)) return std::nullopt;
  Limits limits = process.limits;
  for (const auto& [limit, figure] : given) limits[limit] = {figure.value, figure.origin, figure.origin};
  SupportRules rules;
  rules.degrees = limits.at(Limit::overhang).value;
  rules.degrees_source = limits.at(Limit::overhang).source;
  rules.is_filament = process.drainage == Drainage::not_needed;
  const auto bridge = limits.find(Limit::bridge);
  if (bridge != limits.end()) {
    rules.reach = bridge->second.value / 2;
    rules.reach_source = fmt::format("half the bridge ({})", bridge->second.source);
  } else {
    rules.reach = kUnsupportedReach;
    rules.reach_source = kUnsupportedSource;
  }
  // Usual ones: a nozzle of 0.4 mm; resin and metal powder.
  rules.layer = rules.is_filament ? 0.2 : 0.05;
  return rules;
}

SupportRules require_support_rules(const Process& process, const Limits& given) {
  if (auto rules = support_rules(process, given)) return *rules;
  throw UsageError(fmt::format("{}: its powder carries what hangs over; there are no supports", process.name),
                   "choose a process that has an overhang angle: fdm, sla or metal");
}

}  // namespace aerate
