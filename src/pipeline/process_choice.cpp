#include "pipeline/process_choice.h"

#include <algorithm>
#include <fmt/format.h>
#include <iterator>
#include <optional>

#include "core/error.h"
#include "core/overhang.h"
#include "pipeline/process_file.h"

namespace aerate {
namespace {

std::string process_names() {
  std::string names;
  for (const Process& process : processes()) names += (names.empty() ? "" : ", ") + process.name;
  return names;
}

double value_of(const Process& process, Limit limit) {
  const auto& figure = process[limit];
  if (!figure) {
    throw UsageError(fmt::format("process {}: no {}", process.name, name_of(limit)),
                     fmt::format("give --{}, or \"{}\" in the process file", name_of(limit), name_of(limit)));
  }
  return figure->value;
}

std::optional<double> value_among(const std::vector<LimitOrigin>& origins, Limit limit) {
  for (const LimitOrigin& origin : origins)
    if (origin.limit == limit) return origin.value;
  return std::nullopt;
}

// Whether ceilings are limited: by figures of the process or of the user, which come in pairs.
bool limits_ceilings(const Process& process, const std::vector<GivenLimit>& given) {
  const auto is_given = [&](Limit limit) {
    return std::any_of(given.begin(), given.end(), [&](const GivenLimit& own) { return own.limit == limit; });
  };
  const bool has_overhang = process[Limit::overhang] || is_given(Limit::overhang);
  const bool has_bridge = process[Limit::bridge] || is_given(Limit::bridge);
  if (has_overhang && has_bridge) return true;
  if (is_given(Limit::overhang) || is_given(Limit::bridge)) {
    throw UsageError(
        fmt::format("process {}: a limit for ceilings needs both --overhang and --bridge", process.name),
        fmt::format("give --{} too", has_overhang ? "bridge" : "overhang"));
  }
  return false;
}

std::string described(const LimitOrigin& origin) {
  return fmt::format("{} {:g} mm ({})", name_of(origin.limit), origin.value, origin.origin);
}

// A wall or gap that is too thin to be printed, even if the process file itself says so.
void require_printable(const Process& process, const LimitOrigin& asked, Limit least) {
  const auto& figure = process[least];
  if (!figure || asked.value >= figure->value) return;
  throw UsageError(fmt::format("{}: {} is less than {} can print: {:g} mm ({})", process.name,
                               described(asked), process.name, figure->value, figure->source),
                   fmt::format("give a --{} of {:g} mm or more", name_of(asked.limit), figure->value));
}

}  // namespace

Process choose_process(const std::string& name_or_file) {
  if (name_or_file.ends_with(".json") || name_or_file.find('/') != std::string::npos)
    return read_process_file(name_or_file);
  const Process* process = find_process(name_or_file);
  if (process == nullptr) {
    throw UsageError(fmt::format("unknown process \"{}\"", name_or_file),
                     fmt::format("use one of {}, or the path of a process file (.json)", process_names()));
  }
  return *process;
}

PackingLimits packing_limits(const ProcessChoice& choice) {
  const auto value = [&](Limit limit) {
    const auto found = value_among(choice.origins, limit);
    if (!found) throw FailureError(fmt::format("no limit {}", name_of(limit)));
    return *found;
  };
  const auto overhang = value_among(choice.origins, Limit::overhang);
  const auto bridge = value_among(choice.origins, Limit::bridge);
  Roof roof =
      make_roof({.degrees = overhang.value_or(45), .bridge = bridge.value_or(0), .up = choice.direction.up});
  if (!overhang || !bridge) roof.widest_ball = Roof{}.widest_ball;
  return {.wall = value(Limit::wall),
          .gap = value(Limit::gap),
          .min_radius = value(Limit::min_radius),
          .max_radius = value(Limit::max_radius),
          .roof = roof};
}

ProcessChoice limits_under(const Process& process, const std::vector<GivenLimit>& given, ProcessCheck check) {
  ProcessChoice choice{.process = process, .origins = {}};
  const auto choose = [&](Limit limit) {
    LimitOrigin chosen{.limit = limit, .value = 0, .origin = "default of " + process.name, .source = {}};
    bool overridden = false;
    for (const GivenLimit& own : given) {
      if (own.limit != limit) continue;
      chosen.value = own.value;
      chosen.origin = own.origin;
      overridden = true;
    }
    if (!overridden) {
      chosen.value = value_of(process, limit);
      chosen.source = process[limit]->source;
      chosen.is_default = true;
    }
    choice.origins.push_back(chosen);
  };
  for (const Limit limit : {Limit::wall, Limit::gap, Limit::min_radius, Limit::max_radius}) choose(limit);
  if (limits_ceilings(process, given))
    for (const Limit limit : {Limit::overhang, Limit::bridge}) choose(limit);

  const PackingLimits limits = packing_limits(choice);
  if (!(limits.min_radius > 0))
    throw UsageError(described(choice.origins[2]) + " must be more than 0 mm", "give a --min-radius");
  if (limits.min_radius > limits.max_radius) {
    throw UsageError(
        fmt::format("--{} is more than --{}", described(choice.origins[2]), described(choice.origins[3])),
        "give a smaller --min-radius or a larger --max-radius");
  }
  if (check == ProcessCheck::strict) {
    require_printable(process, choice.origins[0], Limit::least_wall);
    require_printable(process, choice.origins[1], Limit::least_gap);
  }
  return choice;
}

void keep_to_balls_without_roofs(ProcessChoice& choice) {
  const PackingLimits limits = packing_limits(choice);
  if (!limits.roof.shapes(limits.max_radius)) return;
  for (LimitOrigin& origin : choice.origins) {
    if (origin.limit != Limit::max_radius || !origin.is_default) continue;
    origin.value = largest_without_roof(limits.roof);
    origin.origin = "the largest of a lattice that need no roof";
    origin.source.clear();
  }
}

void warn_of_trapped_material(const Process& process, Monitor& monitor) {
  if (process.drainage == Drainage::not_needed) return;
  monitor.notice(
      fmt::format("the voids are sealed: a print by {} keeps its liquid or powder in them, and saves "
                  "nothing; --drain joins "
                  "them and opens them by escape holes",
                  process.name));
}

std::string processes_in_words() {
  std::string text;
  const auto line = std::back_inserter(text);
  for (const Process& process : processes()) {
    fmt::format_to(line, "{}: {}; material {}{}\n", process.name, process.title, process.material,
                   process.drainage == Drainage::needed ? "; closed voids have to be drained" : "");
    for (std::size_t i = 0; i < kLimitCount; ++i) {
      const auto limit = static_cast<Limit>(i);
      const auto& figure = process[limit];
      if (figure)
        fmt::format_to(line, "  {:<12}{:>5g} {}: {}\n", name_of(limit), figure->value,
                       limit == Limit::overhang ? "deg" : "mm", figure->source);
    }
  }
  return text;
}

}  // namespace aerate
