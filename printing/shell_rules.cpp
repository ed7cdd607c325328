#include "printing/shell_rules.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numbers>

namespace aerate {
namespace {

// The slicer's.
constexpr double kInfillOverlap = 0.25;  // of a spacing, infill into walls
constexpr double kSkinMargin = 3.0;
constexpr double kUnsupportedShare = 0.3;  // of that margin
constexpr double kShellSpacing = 1.05;     // spacings that shells are measured in
constexpr double kLeastShell = 1.0;        // of those: it opens shells by half of this,
constexpr double kGrownAgain = 0.8;        // and grows them by this
constexpr double kTopThickness = 0.7;      // mm, that solid layers have at least, if there are any
constexpr double kBottomThickness = 0.5;
// The same from 2.6 on.
constexpr double kShadowSince26 = 0.05;      // spacings
constexpr double kLeastShellSince26 = 0.65;  // of the spacings of shells
constexpr double kOverlapSince26 = 0.2;      // of those
constexpr double kLean = 0.2;                // line widths: it opens what looks up or down by half of this

// Arachne lays one line more where there is room for a whole one, and infill begins there.
constexpr double kWidenedWalls = 1;  // spacings
// It prints lines of changing width as wide as their wider end, and small loops where three webs meet: measured 0.1 to 3 % of webs
// between cells, -2 to 0 % of those between spheres.
constexpr double kWebExcess = 0.01;
// Classic walls leave gaps of 0.6 spacings, overlap of infill included, to lines that fill gaps: so much of it is beyond the walls.
constexpr double kGapBetweenWalls = 0.1;
// Fitted to solid prints of eight models at 15, 30, 60 and 80 % by the slicer.
constexpr double kGyroidShare = 0.92;
struct JoinedAt {
  double infill, share;
};
constexpr JoinedAt kGyroidJoined[] = {{0.15, 0.46}, {0.3, 0.54}, {0.6, 0.42}, {0.8, 0.38}};
// Fitted to three of them.
constexpr double kLinesJoined = 0.545;

// Fitted to two of the models: at the border of modifiers, where infill is narrow, each line's end is joined along so much, mm.
constexpr double kJoinedPerEnd = 1.6;

// Lines are printed side by side at less than their width, since their sides are round.
double spacing_of(const PrintSettings& settings) {
  return settings.line_width - settings.layer_height * (1 - std::numbers::pi / 4);
}

// Solid layers of such a thickness at least.
int solid_layers(int asked_for, double thickness, double layer_height) {
  constexpr double kMost = 1000;  // more than any layer height that is printed asks for
  if (asked_for == 0) return 0;
  return std::max(asked_for, static_cast<int>(std::min(kMost, std::ceil(thickness / layer_height - 1e-4))));
}

// Skins grow after shells were found: by a spacing into sparse infill, further into what is solid anyway.
void set_rules_since_2_6(ShellRules& rules, const PrintSettings& settings) {
  const double shell_spacing = kShellSpacing * rules.spacing;
  rules.has_narrow_skins = true;
  rules.skin_margin = settings.perimeters > 0 ? rules.spacing : 0;
  rules.shadow = rules.skin_shadow = kShadowSince26 * rules.spacing;
  rules.least_shell = kLeastShellSince26 * shell_spacing;
  rules.widening = kOverlapSince26 * shell_spacing;
  rules.walls_cover = settings.vertical_shells == VerticalShells::enabled;
  if (settings.vertical_shells != VerticalShells::disabled) return;
  rules.shadow = 0;
  rules.skin_shadow = rules.skin_margin;
  rules.least_shell = settings.line_width;
  rules.widening = 0;
}

}  // namespace

ShellRules shell_rules(const PrintSettings& settings) {
  ShellRules rules;
  rules.spacing = spacing_of(settings);
  if (settings.perimeters > 0) {
    rules.wall = settings.line_width / 2 + (settings.perimeters - 0.5) * rules.spacing;
    rules.round_edge = (settings.line_width - rules.spacing) / 2;
    rules.fill = rules.wall - kInfillOverlap * rules.spacing;
    if (settings.walls == WallGenerator::arachne) rules.web_excess = kWebExcess;
    rules.widened_walls =
        (settings.walls == WallGenerator::classic ? kGapBetweenWalls : kWidenedWalls) * rules.spacing;
  }
  rules.top_layers = solid_layers(settings.top_layers, kTopThickness, settings.layer_height);
  rules.bottom_layers = solid_layers(settings.bottom_layers, kBottomThickness, settings.layer_height);
  rules.lean = kLean * settings.line_width;
  rules.skin_margin = kSkinMargin;
  rules.unsupported = kUnsupportedShare * kSkinMargin;
  const double shell_spacing = kShellSpacing * rules.spacing;
  rules.shadow = shell_spacing;
  rules.skin_shadow = rules.skin_margin + rules.shadow;
  rules.least_shell = kLeastShell * shell_spacing;
  rules.widening = (kGrownAgain - kLeastShell / 2) * shell_spacing;
  if (settings.rules == SolidRules::prusa_2_6) set_rules_since_2_6(rules, settings);
  return rules;
}

double printed_share(double infill, InfillPattern pattern) {
  if (infill >= 1) return 1;
  return infill * (pattern == InfillPattern::gyroid ? kGyroidShare : 1.0);
}

double joined_share(double infill, InfillPattern pattern) {
  if (pattern != InfillPattern::gyroid) return kLinesJoined;
  const auto* const end = std::end(kGyroidJoined);
  const auto* const above =
      std::find_if(std::begin(kGyroidJoined), end, [&](const JoinedAt& at) { return at.infill >= infill; });
  if (above == std::begin(kGyroidJoined)) return above->share;
  const JoinedAt& below = *std::prev(above);
  if (above == end) return below.share;
  return std::lerp(below.share, above->share, (infill - below.infill) / (above->infill - below.infill));
}

double border_share(double infill, const PrintSettings& settings) {
  // Ends of lines on a millimetre of any curve (Cauchy, Crofton).
  const double ends = 2 / std::numbers::pi * infill / spacing_of(settings);
  return std::min(joined_share(infill, settings.pattern), kJoinedPerEnd * ends);
}

}  // namespace aerate
