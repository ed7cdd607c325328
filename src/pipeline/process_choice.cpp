#include "pipeline/process_choice.h"

#include <algorithm>
#include <fmt/format.h>
#include <iterator>
#include <utility>

#include "core/error.h"
#include "core/listed.h"
#include "core/overhang.h"
#include "core/printable.h"
#include "pipeline/own_processes.h"
#include "pipeline/process_file.h"

namespace aerate {
namespace {

std::string default_of(const Process& process) {
  return "default of " + process.name;
}

// The limits of a job, were it under all of them.
Limits all_limits(const Process& process, const Limits& given) {
  Limits limits = given;
  for (const auto& [limit, figure] : process.limits)
    limits.insert({limit, {figure.value, figure.source, default_of(process)}});
  return limits;
}

// Whether ceilings are limited: by figures of the process or of the user, which come in pairs.
bool limits_ceilings(const Process& process, const Limits& given) {
  const Limits all = all_limits(process, given);
  const bool has_overhang = all.contains(Limit::overhang);
  if (has_overhang && all.contains(Limit::bridge)) return true;
  if (given.contains(Limit::overhang) || given.contains(Limit::bridge)) {
    throw UsageError(
        fmt::format("process {}: a limit for ceilings needs both --overhang and --bridge", process.name),
        fmt::format("give --{} too", has_overhang ? "bridge" : "overhang"));
  }
  return false;
}

std::string described(const Limits& limits, Limit limit) {
  const LimitValue& chosen = limits.at(limit);
  return fmt::format("{} {:g} mm ({})", row_of(limit).name, chosen.value, chosen.origin);
}

// A wall or gap that is too thin to be printed, even if the process file itself says so.
void require_printable(const ProcessChoice& choice, Limit limit, Limit least) {
  const Process& process = choice.process;
  if (!process.limits.contains(least)) return;
  const LimitValue& figure = process.limits.at(least);
  if (choice.limits.at(limit).value >= figure.value) return;
  throw UsageError(fmt::format("{}: {} is less than {} can print: {:g} mm ({})", process.name,
                               described(choice.limits, limit), process.name, figure.value, figure.source),
                   fmt::format("give a {} of {:g} mm or more", row_of(limit).option, figure.value));
}

UsageError unknown_process(const std::string& name) {
  const auto folder = own_processes_folder();
  const std::string in_folder = folder ? fmt::format(" the name of a file in {},", folder->string()) : "";
  return UsageError(
      fmt::format("unknown process \"{}\"", name),
      fmt::format("use one of {},{} or the path of a process file (.json)", process_names(), in_folder));
}

std::string figures_of(const Process& process) {
  std::string text;
  for (const auto& [limit, figure] : process.limits) {
    const LimitRow& row = row_of(limit);
    fmt::format_to(std::back_inserter(text), "  {:<14} {:>5g} {}: {}\n", row.name, figure.value,
                   row.unit.symbol, printable(figure.source));
  }
  return text;
}

std::string in_words(const std::string& name, const Process& process) {
  return fmt::format("{}: {}; material {}{}\n", printable(name), printable(process.title),
                     printable(process.material),
                     process.drainage == Drainage::needed ? "; closed voids have to be drained" : "");
}

// A process of the user's own by the name that it is chosen by; what is wrong with it if it cannot be.
std::string own_in_words(const std::filesystem::path& file) {
  const std::string name = file.stem().string();
  const std::string place = fmt::format("  {:<14} {}\n", "file", printable(file.string()));
  if (find_process(name) != nullptr)
    return fmt::format("{}: the built-in process of this name goes first, give the path of yours\n{}",
                       printable(name), place);
  try {
    const Process process = read_process_file(file);
    static_cast<void>(limits_under(process, {}, ProcessCheck::strict));
    return in_words(name, process) + place + figures_of(process);
  } catch (const Error& error) {
    return fmt::format("{}: broken: {}\n{}", printable(name), printable(error.what()), place);
  }
}

std::string own_processes_in_words() {
  std::string text;
  try {
    for (const std::filesystem::path& file : own_process_files()) text += own_in_words(file);
  } catch (const InputError& error) {
    text += printable(error.what()) + "\n";
  }
  return text;
}

}  // namespace

bool is_default(const ProcessChoice& choice, Limit limit) {
  return choice.limits.at(limit).origin == default_of(choice.process);
}

const char* name_of(Build build) {
  return build == Build::hanging ? "hanging" : "standing";
}

std::filesystem::path process_file_of(const std::string& name_or_file) {
  if (name_or_file.ends_with(".json") || name_or_file.find('/') != std::string::npos) return name_or_file;
  if (find_process(name_or_file) != nullptr) return {};
  return own_process_file(name_or_file).value_or(std::filesystem::path());
}

Process choose_process(const std::string& name_or_file) {
  if (const auto file = process_file_of(name_or_file); !file.empty()) return read_process_file(file);
  const Process* process = find_process(name_or_file);
  if (process == nullptr) throw unknown_process(name_or_file);
  return *process;
}

ProcessChoice limits_under(const Process& process, const Limits& given, ProcessCheck check) {
  const bool has_ceilings = limits_ceilings(process, given);
  ProcessChoice choice{.process = process, .limits = all_limits(process, given)};
  std::erase_if(choice.limits, [&](const auto& chosen) {
    const LimitGroup group = row_of(chosen.first).group;
    return group != LimitGroup::packing && (group != LimitGroup::ceilings || !has_ceilings);
  });
  const PackingLimits limits = packing_limits(choice);
  const std::string min_radius = described(choice.limits, Limit::min_radius);
  if (!(limits.min_radius > 0))
    throw UsageError(min_radius + " must be more than 0 mm", "give a --min-radius");
  if (limits.min_radius > limits.max_radius) {
    throw UsageError(
        fmt::format("--{} is more than --{}", min_radius, described(choice.limits, Limit::max_radius)),
        "give a smaller --min-radius or a larger --max-radius");
  }
  if (check == ProcessCheck::strict) {
    require_printable(choice, Limit::wall, Limit::least_wall);
    require_printable(choice, Limit::gap, Limit::least_gap);
  }
  return choice;
}

ProcessChoice kept_to_balls_without_roofs(ProcessChoice choice) {
  const PackingLimits limits = packing_limits(choice);
  LimitValue& largest = choice.limits.at(Limit::max_radius);
  if (limits.roof.shapes(limits.max_radius) && is_default(choice, Limit::max_radius))
    largest = {largest_without_roof(limits.roof), "", "the largest of a lattice that need no roof"};
  return choice;
}

ProcessChoice sized_for_cells(ProcessChoice choice, std::optional<double> cell_size) {
  constexpr double kLargestUnasked = 10;  // mm
  LimitValue& largest = choice.limits.at(Limit::max_radius);
  LimitValue& least = choice.limits.at(Limit::min_radius);
  const auto radius_of = [&](double size) { return (size - choice.limits.at(Limit::gap).value) / 2; };
  const bool is_given = !is_default(choice, Limit::max_radius);
  const auto usual = choice.process.limits.find(Limit::cell_size);
  if (cell_size) {
    if (is_given) throw UsageError("--cell-size and --max-radius say the same", "leave out one of them");
    if (!(radius_of(*cell_size) > 0))
      throw UsageError(fmt::format("--cell-size {:g} mm is no more than --gap", *cell_size),
                       "give a larger --cell-size");
    largest = {radius_of(*cell_size), "", fmt::format("of --cell-size {:g}", *cell_size)};
  } else if (!is_given && usual != choice.process.limits.end()) {
    const auto& [size, source, origin] = usual->second;
    largest = {std::max(radius_of(size), least.value), source,
               fmt::format("of cells of {:g} mm, {}", size, default_of(choice.process))};
  } else if (!is_given && largest.value > kLargestUnasked) {
    largest = {std::max(kLargestUnasked, least.value), "", "of cells, unless --cell-size says otherwise"};
  }
  if (least.value > largest.value) {
    if (!is_default(choice, Limit::min_radius))
      throw UsageError(fmt::format("--min-radius {:g} mm is more than the {:g} mm of cells of this size",
                                   least.value, largest.value),
                       "give a smaller --min-radius or a larger --cell-size");
    least.value = largest.value / 2;
  }
  return choice;
}

bool is_lowered_for_cells(const ProcessChoice& choice) {
  const double least = choice.limits.at(Limit::min_radius).value;
  return is_default(choice, Limit::min_radius) && least < choice.process.limits.at(Limit::min_radius).value;
}

ProcessChoice with_larger_cells(ProcessChoice choice) {
  LimitValue& largest = choice.limits.at(Limit::max_radius);
  const double size = 2 * largest.value + choice.limits.at(Limit::gap).value;
  largest = {2 * largest.value, "", fmt::format("of cells twice as large as those of {:g} mm", size)};
  return choice;
}

std::optional<ProcessChoice> with_smaller_cells(ProcessChoice choice) {
  LimitValue& largest = choice.limits.at(Limit::max_radius);
  const LimitValue& of_spheres = choice.process.limits.at(Limit::max_radius);
  const double least = choice.limits.at(Limit::min_radius).value;
  if (largest.value <= of_spheres.value || least > of_spheres.value) return std::nullopt;
  largest = {of_spheres.value, of_spheres.source, "of smaller cells"};
  return choice;
}

std::optional<ProcessChoice> with_usual_limits(const ProcessChoice& choice, bool makes_cells) {
  const Limits& figures = choice.process.limits;
  const auto size = makes_cells ? figures.find(Limit::cell_size) : figures.end();
  ProcessChoice usual = choice;
  bool allows_more = false;
  for (const Limit limit : {Limit::wall, Limit::gap, Limit::min_radius, Limit::max_radius}) {
    const auto own = choice.process.limits.find(limit);
    if (own == choice.process.limits.end() || is_default(choice, limit)) continue;
    LimitValue& value = usual.limits.at(limit);
    const double largest =
        size == figures.end() ? own->second.value : (size->second.value - figures.at(Limit::gap).value) / 2;
    const bool is_freer =
        limit == Limit::max_radius ? value.value > largest : value.value < own->second.value;
    if (!is_freer) continue;
    value = {own->second.value, own->second.source, default_of(choice.process)};
    allows_more = true;
  }
  const PackingLimits limits = packing_limits(usual);
  if (!allows_more || limits.min_radius > limits.max_radius) return std::nullopt;
  return usual;
}

ProcessChoice evenly_large(ProcessChoice choice, double fitting) {
  if (!is_default(choice, Limit::min_radius)) return choice;
  LimitValue& least = choice.limits.at(Limit::min_radius);
  const double half = std::min(fitting, choice.limits.at(Limit::max_radius).value) / 2;
  if (half > least.value || is_lowered_for_cells(choice))
    least = {std::max(half, least.value), "", "half of the largest, for cells"};
  return choice;
}

ProcessChoice followed_by_lines(ProcessChoice choice, double line_width, const std::string& origin) {
  const Process& process = choice.process;
  if (process.drainage == Drainage::needed || find_process(process.name) == nullptr) return choice;
  const auto follow = [&](Limit limit, int lines, const char* in_words) {
    if (!is_default(choice, limit)) return;
    choice.limits.at(limit) = {lines * line_width, "docs/processes.md",
                               fmt::format("{} lines of {:.4g} mm ({})", in_words, line_width, origin)};
  };
  follow(Limit::wall, 3, "three");
  follow(Limit::gap, 2, "two");
  return choice;
}

ProcessChoice walled_by_perimeters(ProcessChoice choice, const PrintSettings& settings) {
  const Process& process = choice.process;
  if (process.drainage == Drainage::needed || find_process(process.name) == nullptr ||
      !is_default(choice, Limit::wall))
    return choice;
  choice.limits.at(Limit::wall) = {std::max(1, settings.perimeters) * settings.line_width, "docs/slicers.md",
                                   "perimeters, for modifiers"};
  return choice;
}

ProcessChoice held_up_by_infill(ProcessChoice choice) {
  if (find_process(choice.process.name) == nullptr) return choice;
  const auto is_given = [&](Limit limit) {
    return choice.limits.contains(limit) && !is_default(choice, limit);
  };
  if (is_given(Limit::overhang) || is_given(Limit::bridge)) return choice;
  choice.limits.erase(Limit::overhang);
  choice.limits.erase(Limit::bridge);
  return choice;
}

ProcessChoice with_tubes(ProcessChoice choice, const Limits& given) {
  const Limits all = all_limits(choice.process, given);
  const auto add = [&](Limit limit, const char* tubes) {
    if (!all.contains(limit)) {
      throw UsageError(
          fmt::format("process {}: --drain needs the diameter of {}", choice.process.name, tubes),
          fmt::format("give {}", row_of(limit).option));
    }
    return (choice.limits[limit] = all.at(limit)).value;
  };
  const double channel = add(Limit::channel, "channels"), hole = add(Limit::escape_hole, "escape holes");
  if (hole < channel) {
    throw UsageError(
        fmt::format("escape holes of {:g} mm are narrower than channels of {:g} mm", hole, channel),
        "give a larger --hole-diameter or a smaller --channel-diameter");
  }
  return choice;
}

ProcessChoice with_plugs(ProcessChoice choice, const Limits& given) {
  const Limits all = all_limits(choice.process, given);
  for (const LimitRow& row : limit_rows()) {
    if (row.group != LimitGroup::plugs) continue;
    if (!all.contains(row.limit))
      throw UsageError(fmt::format("process {}: --plugs needs a {}", choice.process.name, row.name),
                       fmt::format("give {}", row.option));
    choice.limits[row.limit] = all.at(row.limit);
  }
  return choice;
}

PackingLimits packing_limits(const ProcessChoice& choice) {
  const auto value = [&](Limit limit) { return choice.limits.at(limit).value; };
  const bool limits_ceilings = choice.limits.contains(Limit::bridge);
  Overhang overhang{.up = choice.direction.up};
  if (limits_ceilings) {
    overhang.degrees = value(Limit::overhang);
    overhang.bridge = value(Limit::bridge);
  }
  Roof roof = make_roof(overhang);
  if (!limits_ceilings) roof.widest_ball = Roof{}.widest_ball;
  return {.wall = value(Limit::wall),
          .gap = value(Limit::gap),
          .min_radius = value(Limit::min_radius),
          .max_radius = value(Limit::max_radius),
          .roof = roof};
}

DrainageRequest drainage_request(const ProcessChoice& choice, std::vector<Vec3d> escape_holes) {
  const double channel = choice.limits.at(Limit::channel).value;
  const double hole = choice.limits.at(Limit::escape_hole).value;
  // What leaves by a hole came through channels, so one as wide as these will do where the usual width does not fit.
  const bool may_be_narrower = is_default(choice, Limit::escape_hole) && hole > channel;
  return {.channel_radius = channel / 2,
          .hole_radius = hole / 2,
          .narrow_hole_radius = may_be_narrower ? channel / 2 : 0,
          .escape_holes = std::move(escape_holes)};
}

void warn_of_trapped_material(const Process& process, Monitor& monitor) {
  if (process.drainage == Drainage::not_needed) return;
  monitor.notice(
      fmt::format("the voids are sealed: a print by {} keeps its liquid or powder in them, and saves "
                  "nothing; --drain joins "
                  "them and opens them by escape holes",
                  process.name));
}

std::string process_names() {
  std::string names;
  for (const Process& process : processes()) names += (names.empty() ? "" : ", ") + process.name;
  return names;
}

std::string processes_that(const std::function<bool(const Process&)>& condition) {
  std::vector<std::string> names;
  for (const Process& process : processes())
    if (condition(process)) names.push_back(process.name);
  return listed(names, "and");
}

std::string processes_in_words() {
  std::string text;
  for (const Process& process : processes()) text += in_words(process.name, process) + figures_of(process);
  return text + own_processes_in_words();
}

}  // namespace aerate
