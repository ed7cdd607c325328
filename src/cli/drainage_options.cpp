#include "cli/drainage_options.h"

#include <algorithm>
#include <fmt/format.h>
#include <functional>
#include <optional>
#include <string_view>
#include <utility>

#include "cli/numbers.h"
#include "core/error.h"
#include "core/listed.h"
#include "files/formats.h"

namespace aerate::cli {
namespace {

const CLI::Option* add_drain(CLI::App& command, bool& drain) {
  const auto drains = [](const Process& process) { return process.drainage == Drainage::needed; };
  const std::string sealed = processes_that(std::not_fn(drains));
  return command.add_flag(
      "--drain,!--no-drain", drain,
      fmt::format("Join voids by channels and open them by escape holes, or leave them sealed "
                  "(default of the process: {} drain, {} {} not)",
                  processes_that(drains), sealed, sealed.find(' ') == std::string::npos ? "does" : "do"));
}

// The side of a model that a word or three numbers name; top and bottom are those of the print.
std::optional<Vec3d> parse_side(std::string_view text, Vec3d up) {
  if (text == "top") return up;
  if (text == "bottom") return -up;
  constexpr std::pair<std::string_view, std::string_view> kSides[] = {
      {"left", "-x"}, {"right", "+x"}, {"front", "-y"}, {"back", "+y"}};
  for (const auto& [name, axis] : kSides)
    if (text == name) return parse_direction(axis);
  return parse_direction(text);
}

// What follows a prefix, parsed.
template <typename Parse>
auto parse_after(std::string_view text, std::string_view prefix, const Parse& parse)
    -> decltype(parse(text)) {
  if (!text.starts_with(prefix)) return std::nullopt;
  return parse(text.substr(prefix.size()));
}

constexpr const char* kOneOrTheOther = "leave out one or the other";

// Sides, or heights, that are asked for and forbidden at once.
void require_somewhere(const HoleSides& sides) {
  constexpr double kSame = 1 - 1e-9;  // cosine
  for (const Vec3d on : sides.on)
    for (const Vec3d not_on : sides.not_on)
      if (dot(on, not_on) > kSame)
        throw UsageError("--holes-on and --holes-not-on name the same side", kOneOrTheOther);
  if (sides.not_below >= sides.not_above)
    throw UsageError(fmt::format("--holes-not-on: no height is left between below:{:g} and above:{:g}",
                                 sides.not_below, sides.not_above),
                     "give heights in mm along --up");
}

// Two places that one hole would take.
void require_apart(const std::vector<Vec3d>& places, double diameter) {
  for (std::size_t i = 0; i < places.size(); ++i)
    for (std::size_t j = 0; j < i; ++j)
      if (const double apart = length(places[i] - places[j]); apart < diameter)
        throw UsageError(fmt::format("the --escape-hole places {} and {} are {:.4g} mm apart, less than a "
                                     "hole of {:g} mm is wide",
                                     j + 1, i + 1, apart, diameter),
                         "give each hole a place of its own");
}

}  // namespace

BuildOption::BuildOption(CLI::App& command)
    : option_(
          command
              .add_option("--build", build_,
                          "Whether the part stands on its plate or hangs from it while it is printed, as in "
                          "resin printers that cure through the bottom of the vat: then liquid runs towards "
                          "--up, and what is closed in but for the layer being printed is sucked at")
              ->check(CLI::IsMember({name_of(Build::standing), name_of(Build::hanging)}))
              ->type_name("SIDE")
              ->capture_default_str()) {}

Build BuildOption::build() const {
  return build_ == name_of(Build::hanging) ? Build::hanging : Build::standing;
}

DrainageOptions::DrainageOptions(CLI::App& command, const ConfigFile& config)
    : drain_option_(add_drain(command, drain_)),
      limits_(command, config, {LimitGroup::drainage}),
      plug_limits_(command, config, {LimitGroup::plugs}),
      build_(command) {
  command
      .add_option("--escape-hole", places_,
                  "A point of the surface where an escape hole is to open, x,y,z in mm; may be repeated "
                  "(default where it shows least, low and high)")
      ->type_name("X,Y,Z")
      ->allow_extra_args(false)  // or it would take the model
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
  const auto add_sides = [&](const char* option, std::vector<std::string>& texts, const char* words) {
    command.add_option(option, texts, words)
        ->type_name("WHERE")
        ->allow_extra_args(false)
        ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
  };
  add_sides("--holes-on", on_,
            "Escape holes come out only where the surface faces this side, within 45 degrees: bottom, top "
            "(as printed), "
            "left (-x), right, front (-y), back, or a direction x,y,z; may be repeated");
  add_sides("--holes-not-on", not_on_,
            "They do not come out there: a side as above, above:HEIGHT, below:HEIGHT (along --up, mm) or "
            "box:x0,y0,z0,x1,y1,z1 (mm); may be repeated");
  command.add_flag(
      "--drain-cavities", opens_cavities_,
      "Open the sealed cavities that the model has itself too: each gets two escape holes straight "
      "out through its wall, one low and one high");
  command
      .add_option(
          "--plugs", plugs_,
          "Write a plug for each escape hole to this file too: a pin that narrows inwards, ends flush with "
          "the model's surface and has the hole's number on its inner end; " +
              endings_that_are_written())
      ->type_name("FILE");
}

void DrainageOptions::require_no_tubes() const {
  const auto refuse = [](std::string_view option) {
    throw UsageError(fmt::format("{} is for voids that drain", option), "add --drain");
  };
  for (const auto& [limit, given] : limits_.given()) refuse(row_of(limit).option);
  if (!places_.empty()) refuse("--escape-hole");
  if (!on_.empty()) refuse("--holes-on");
  if (!not_on_.empty()) refuse("--holes-not-on");
  if (build_.is_given()) refuse("--build");
  if (opens_cavities_) refuse("--drain-cavities");
  if (!plugs_.empty()) refuse("--plugs");
  for (const auto& [limit, given] : plug_limits_.given()) refuse(row_of(limit).option);
}

HoleSides DrainageOptions::sides(Vec3d up) const {
  HoleSides sides;
  for (const std::string& text : on_) {
    const auto side = parse_side(text, up);
    if (!side)
      throw UsageError(fmt::format("--holes-on: '{}' is no side of a model", text),
                       "give bottom, top, left, right, front, back or a direction x,y,z");
    sides.on.push_back(*side);
  }
  for (const std::string& text : not_on_) {
    if (const auto side = parse_side(text, up))
      sides.not_on.push_back(*side);
    else if (const auto above = parse_after(text, "above:", parse_number))
      sides.not_above = std::min(sides.not_above, *above);
    else if (const auto below = parse_after(text, "below:", parse_number))
      sides.not_below = std::max(sides.not_below, *below);
    else if (const auto box = parse_after(text, "box:", parse_box))
      sides.not_within.push_back(*box);
    else
      throw UsageError(
          fmt::format("--holes-not-on: '{}' says no place", text),
          "give bottom, top, left, right, front, back, a direction x,y,z, above:HEIGHT, below:HEIGHT or "
          "box:x0,y0,z0,x1,y1,z1");
  }
  require_somewhere(sides);
  if (places_.size() >= 2 && !sides.is_anywhere())
    throw UsageError(
        "two --escape-hole places are all the holes there are: --holes-on and --holes-not-on choose none",
        "leave out one or the other");
  return sides;
}

std::vector<Vec3d> DrainageOptions::escape_holes() const {
  std::vector<Vec3d> points;
  std::vector<std::string> others;
  for (const std::string& place : places_) {
    if (const auto point = parse_point(place))
      points.push_back(*point);
    else
      others.push_back(fmt::format("'{}'", place));
  }
  if (!others.empty())
    throw UsageError(fmt::format("--escape-hole: {} {}", listed(others, "and"),
                                 others.size() == 1 ? "is no place" : "are no places"),
                     "give three numbers x,y,z");
  return points;
}

HollowOptions DrainageOptions::applied_to(HollowOptions options) const {
  const ProcessChoice& choice = options.packing.process;
  const bool drains = drain_option_->count() > 0 ? drain_ : choice.process.drainage == Drainage::needed;
  if (!drains) {
    require_no_tubes();
    return options;
  }
  options.packing.process = with_tubes(choice, limits_.given());
  options.drainage = drainage_request(options.packing.process, escape_holes());
  require_apart(options.drainage->escape_holes, 2 * options.drainage->hole_radius);
  options.drainage->sides = sides(choice.direction.up);
  options.build = build_.build();
  const Limits& limits = options.packing.process.process.limits;
  const auto cup = limits.find(Limit::cup);
  if (options.build == Build::hanging && cup != limits.end())
    options.drainage->widest_cup = cup->second.value;
  options.opens_cavities = opens_cavities_;
  return with_plugs_asked_for(std::move(options));
}

HollowOptions DrainageOptions::with_plugs_asked_for(HollowOptions options) const {
  const Limits given = plug_limits_.given();
  if (plugs_.empty()) {
    if (!given.empty())
      throw UsageError(fmt::format("{} is for plugs", row_of(given.begin()->first).option),
                       "add --plugs FILE");
    return options;
  }
  options.packing.process = with_plugs(std::move(options.packing.process), given);
  const Limits& limits = options.packing.process.limits;
  options.plugs = {plugs_, {limits.at(Limit::plug_clearance).value, limits.at(Limit::plug_taper).value}};
  return options;
}

}  // namespace aerate::cli
