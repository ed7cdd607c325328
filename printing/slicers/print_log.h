#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace aerate {

// A layer is known by the height of its extrusions, in hundredths of a millimetre.
std::int64_t layer_at(double z);
inline constexpr std::int64_t kBeforeFirstLayer = std::numeric_limits<std::int64_t>::min();
inline constexpr std::int64_t kAfterLastLayer = std::numeric_limits<std::int64_t>::max();

struct PrintPlace {
  double x = 0, y = 0, z = 0;  // mm
};

// A box round places.
struct PrintBox {
  bool empty() const { return least_.x > most_.x; }
  void include(const PrintPlace& place);
  // How far a place is outside, mm, along the axis where it is the most; not above 0 inside.
  double distance(const PrintPlace& place) const;

 private:
  static constexpr double kNone = std::numeric_limits<double>::infinity();
  PrintPlace least_{kNone, kNone, kNone}, most_{-kNone, -kNone, -kNone};
};

// A line that is neither a move nor a comment: a colour change, a pause, a temperature, a tool, a message,
// G-code of the user's own. The lines that mark objects count among them, comments though they are; and so do
// travels that no slicer makes of its own: out of the print, and by G91.
struct PrintCommand {
  std::size_t line = 0;                      // counted from 1
  std::string text;                          // without the comment behind it
  std::optional<PrintPlace> leaves_to = {};  // of a travel out of the print

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
  // Filament that goes through the standing nozzle beyond what was retracted, and that stays retracted while
  // it prints on, mm; by layer, and where it is more than a slicer's restart after a retraction.
  std::map<std::int64_t, double> purged, kept_back;
  // The lines of M204 that set another acceleration for travels, by that. Slicers write them at any travel.
  std::map<double, PrintCommand> travel_accelerations;
  PrintBox box;                 // of the extrusions of the slicer's own
  bool tells_progress = false;  // M73
};

// Travels that leave the box by less than this are the slicer's, mm: along a skirt, over it, round a corner.
inline constexpr double kOutOfPrint = 5;

// O(bytes).
PrintLog log_of_print(std::string_view gcode);

}  // namespace aerate
