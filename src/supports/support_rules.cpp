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

std::optional<SupportRules> support_rules(const Process& process) {
  const auto overhang = process.limits.find(Limit::overhang);
  if (overhang == process.limits.end()) return std::nullopt;
  SupportRules rules;
  rules.degrees = overhang->second.value;
  rules.degrees_source = overhang->second.source;
  rules.is_filament = process.drainage == Drainage::not_needed;
  const auto bridge = process.limits.find(Limit::bridge);
  if (bridge != process.limits.end()) {
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

SupportRules require_support_rules(const Process& process) {
  if (auto rules = support_rules(process)) return *rules;
  throw UsageError(fmt::format("{}: its powder carries what hangs over; there are no supports", process.name),
                   "choose a process that has an overhang angle: fdm, sla or metal");
}

}  // namespace aerate
