#include "printing/slicers/print_log.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <optional>
#include <utility>

#include "printing/slicers/gcode.h"
#include "printing/slicers/gcode_machine.h"
#include "printing/slicers/text_file.h"

namespace aerate {
namespace {

// Repetier's sets the acceleration of prints by M201 and that of travels by M202; of others these are limits.
enum class Firmware { any, repetier };

Firmware firmware_of(std::string_view gcode) {
  return setting_in(gcode, "gcode_flavor") == "repetier" ? Firmware::repetier : Firmware::any;
}

// How a command enters the log.
enum class CommandKind { listed, fan, acceleration, position, progress, tool };

bool has_word(const CommandWord& command, std::string_view letters) {
  return command.rest.find_first_of(letters) != std::string_view::npos;
}

bool has_only(const CommandWord& command, std::string_view letters) {
  constexpr std::string_view kOfNumbers = "0123456789.+- ";
  return command.rest.find_first_not_of(std::string(letters).append(kOfNumbers)) == std::string_view::npos;
}

CommandKind kind_of(const CommandWord& command, Firmware firmware) {
  if (command.letter == 'T') return CommandKind::tool;
  if (command.letter == 'G' && command.code == 92)
    return has_word(command, "E") && !has_word(command, "XYZ") ? CommandKind::position : CommandKind::listed;
  if (command.letter == 'G' && (command.code == 10 || command.code == 11) && !has_word(command, "PLRXYZ"))
    return CommandKind::position;  // a retraction
  if (command.letter != 'M') return CommandKind::listed;
  if (command.code == 73) return CommandKind::progress;
  if (command.code == 204) return has_only(command, "SPT") ? CommandKind::acceleration : CommandKind::listed;
  if (firmware == Firmware::repetier && (command.code == 201 || command.code == 202) &&
      has_only(command, "XY"))
    return CommandKind::acceleration;
  // A fan of another number is no business of the slicer's cooling.
  if ((command.code == 106 || command.code == 107) && !has_word(command, "P")) return CommandKind::fan;
  return CommandKind::listed;
}

std::optional<double> word_of(const CommandWord& command, char wanted) {
  std::optional<double> found;
  for_each_word(command.rest, [&](char letter, double value) {
    if (letter == wanted) found = std::clamp(value, 0.0, GcodeMachine::kLargestCoordinate);
  });
  return found;
}

// The name of an object stands in a comment in PrusaSlicer's labels.
bool marks_object(std::string_view line) {
  return line.starts_with("; printing object ") || line.starts_with("; stop printing object ");
}

class LogMaker {
 public:
  explicit LogMaker(Firmware firmware) : firmware_(firmware) {}

  void read(std::string_view line) {
    ++line_;
    constexpr std::string_view kFeature = ";TYPE:";
    if (line.starts_with(kFeature)) {
      feature_ = line.substr(kFeature.size());
      extruding_ = false;
    } else if (marks_object(line)) {
      add_command(line);
    } else if (machine_.run(line)) {
      add_extrusion();
    } else if (machine_.moved()) {
      add_move(line);
    } else if (const std::string_view command = command_in(line); !command.empty()) {
      read_command(command);
    }
  }

  PrintLog finish() {
    end_purge(kAfterLastLayer);
    // The lines after the last extrusion end the print.
    auto& last = log_.commands[layer_];
    const auto end = last.begin() + static_cast<std::ptrdiff_t>(commands_at_extrusion_);
    log_.commands[kAfterLastLayer].assign(end, last.end());
    last.erase(end, last.end());
    for (auto& [layer, commands] : log_.commands) {
      std::erase_if(commands, [&](const PrintCommand& command) { return stays_near(command); });
      if (layer != kBeforeFirstLayer && layer != kAfterLastLayer)
        std::erase_if(commands, [this](const PrintCommand& command) {
          const auto word = command_word(command.text);
          return word && kind_of(*word, firmware_) == CommandKind::fan;
        });
    }
    for (auto& [key, totals] : log_.features) {
      totals.fan /= totals.filament;
      totals.acceleration /= totals.filament;
    }
    std::erase_if(log_.commands, [](const auto& commands) { return commands.second.empty(); });
    return std::move(log_);
  }

 private:
  void add_command(std::string_view text) {
    log_.commands[layer_].push_back({line_, std::string(without_blanks(text))});
  }

  void set_acceleration(const CommandWord& word, std::string_view text) {
    const bool of_travels = word.code == 202;
    for_each_word(word.rest, [&](char letter, double value) {
      value = std::clamp(value, 0.0, GcodeMachine::kLargestCoordinate);
      if (letter == 'T' || of_travels) {
        log_.travel_accelerations.try_emplace(value, PrintCommand{line_, std::string(text)});
      } else {
        acceleration_ = value;
      }
    });
  }

  void read_command(std::string_view text) {
    const auto word = command_word(text);
    switch (word ? kind_of(*word, firmware_) : CommandKind::listed) {
      case CommandKind::progress:
        log_.tells_progress = true;
        return;
      case CommandKind::position:
        return;
      case CommandKind::acceleration:
        set_acceleration(*word, text);
        return;
      case CommandKind::fan:
        fan_ = word->code == 106 ? word_of(*word, 'S').value_or(kFullFan) : 0;
        break;
      case CommandKind::tool:
        tool_ = word->code;
        break;
      case CommandKind::listed:
        break;
    }
    add_command(text);
  }

  PrintPlace place() const { return {machine_.x(), machine_.y(), machine_.z()}; }

  // Whether a travel does not leave the print, as far as that is known. With less than the full distance, so
  // that two prints with boxes that are not quite the same keep the same travels.
  bool stays_near(const PrintCommand& travel) const {
    return travel.leaves_to && (log_.box.empty() || log_.box.distance(*travel.leaves_to) < kOutOfPrint / 2);
  }

  void add_move(std::string_view line) {
    move_filament(machine_.filament());
    if (!machine_.travelled()) return;
    extruding_ = false;
    if (machine_.relative()) {
      add_command(command_in(line));
    } else if (log_.box.distance(place()) > kOutOfPrint / 2) {
      log_.commands[layer_].push_back({line_, std::string(command_in(line)), place()});
    }
  }

  void move_filament(double fed) {
    retracted_ -= fed;
    if (retracted_ < 0) purged_ -= std::exchange(retracted_, 0);
  }

  void end_purge(std::int64_t layer) {
    constexpr double kRestart = 1;  // mm: slicers may give back a little more or less than was retracted
    const double purged = std::exchange(purged_, 0);
    if (purged > kRestart) log_.purged[layer] += purged;
    if (retracted_ < kRestart) retracted_ = 0;
    if (retracted_ > 0 && layer != kAfterLastLayer) log_.kept_back[layer] = retracted_;
  }

  void add_extrusion() {
    end_purge(layer_);
    constexpr std::string_view kCustom = "Custom";  // G-code of the settings: a line along the bed's edge
    if (!feature_.empty() && feature_ != kCustom) log_.box.include(place());
    layer_ = layer_at(machine_.z());
    commands_at_extrusion_ = log_.commands[layer_].size();
    FeatureTotals& totals =
        log_.features[{layer_, tool_ == 0 ? feature_ : fmt::format("{} by T{}", feature_, tool_)}];
    if (!extruding_) ++totals.begins;
    extruding_ = true;
    const double filament = machine_.filament(), length = machine_.length();
    totals.filament += filament;
    totals.length += length;
    if (machine_.feed() > 0) totals.minutes += length / machine_.feed();
    totals.fan += filament * fan_;
    totals.acceleration += filament * acceleration_;
  }

  static constexpr double kFullFan = 255;

  Firmware firmware_;
  PrintLog log_;
  GcodeMachine machine_;
  std::size_t line_ = 0;
  std::int64_t layer_ = kBeforeFirstLayer;
  std::size_t commands_at_extrusion_ = 0;  // of that layer
  std::string feature_;
  int tool_ = 0;
  double fan_ = 0, acceleration_ = 0;
  double retracted_ = 0, purged_ = 0;  // mm; since the last extrusion
  bool extruding_ = false;
};

}  // namespace

void PrintBox::include(const PrintPlace& place) {
  least_ = {std::min(least_.x, place.x), std::min(least_.y, place.y), std::min(least_.z, place.z)};
  most_ = {std::max(most_.x, place.x), std::max(most_.y, place.y), std::max(most_.z, place.z)};
}

double PrintBox::distance(const PrintPlace& place) const {
  return std::max({least_.x - place.x, place.x - most_.x, least_.y - place.y, place.y - most_.y,
                   least_.z - place.z, place.z - most_.z});
}

std::int64_t layer_at(double z) {
  return std::llround(z * 100);
}

PrintLog log_of_print(std::string_view gcode) {
  LogMaker maker(firmware_of(gcode));
  for_each_line(gcode, [&](std::string_view line) {
    maker.read(line);
    return true;
  });
  return maker.finish();
}

}  // namespace aerate
