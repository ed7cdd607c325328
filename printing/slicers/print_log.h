#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace aerate {

// A layer is known by the height of its extrusions, in hundredths of a millimetre.
std::int64_t layer_at(double z);
inline constexpr std::int64_t kBeforeFirstLayer = std::numeric_limits<std::int64_t>::min();
inline constexpr std::int64_t kAfterLastLayer = std::numeric_limits<std::int64_t>::max();

// A line that is neither a move nor a comment: a colour change, a pause, a temperature, a tool, a message,
// G-code of the user's own. The lines that mark objects count among them, comments though they are.
struct PrintCommand {
  std::size_t line = 0;  // counted from 1
  std::string text;      // without the comment behind it

  bool operator==(const PrintCommand& other) const { return text == other.text; }
};

// How a feature (";TYPE:") is printed in a layer by a tool. The means are weighted by filament.
struct FeatureTotals {
  double filament = 0;      // mm
  double length = 0;        // mm
  double minutes = 0;       // at the feed rates asked for
  double fan = 0;           // mean speed of the fan, 0 to 255
  double acceleration = 0;  // mean of what M204 sets, mm/s2
  std::size_t begins = 0;   // lines and loops that begin: of loops, seams
};

// What a print does beside putting filament in places.
struct PrintLog {
  // By the layer that was extruded last. Fan and acceleration are not here but in the features' totals
  // (except for the fan before the first and after the last layer), since their lines come and go with the
  // order of lines within a layer. Retractions (G10, G11) and progress (M73) are not here either.
  std::map<std::int64_t, std::vector<PrintCommand>> commands;
  std::map<std::pair<std::int64_t, std::string>, FeatureTotals> features;
  bool tells_progress = false;  // M73
};

// O(bytes).
PrintLog log_of_print(std::string_view gcode);

}  // namespace aerate
