#include "printing/slicers/gcode_match.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <fmt/format.h>
#include <iterator>
#include <limits>
#include <map>
#include <span>
#include <string_view>
#include <utility>

#include "core/listed.h"
#include "printing/slicers/text_file.h"

namespace aerate {
namespace {

constexpr double kCell = 1;            // mm: some line widths
constexpr double kStep = 0.25;         // mm: lines are spread in pieces of at most this
constexpr double kLargestBed = 3000;   // mm
constexpr double kOutline = 0.02;      // mm that two runs' outlines may differ by
constexpr double kLongestPrint = 1e8;  // mm of lines: a fortnight at 80 mm/s

struct Box {
  double x_min = std::numeric_limits<double>::infinity(), y_min = x_min;
  double x_max = -x_min, y_max = -x_min;

  void include(double x, double y) {
    x_min = std::min(x_min, x);
    x_max = std::max(x_max, x);
    y_min = std::min(y_min, y);
    y_max = std::max(y_max, y);
  }
};

Box box_of(std::span<const ExtrusionMove> moves, Box box = {}) {
  for (const ExtrusionMove& move : moves) {
    box.include(move.from_x, move.from_y);
    box.include(move.x, move.y);
  }
  return box;
}

// Above the first layer, if there is more than that.
Box box_of_upper_layers(std::span<const ExtrusionMove> moves) {
  if (moves.empty()) return {};
  const auto layer_of = [](const ExtrusionMove& move) { return layer_at(move.z); };
  const std::int64_t first = layer_of(*std::ranges::min_element(moves, {}, layer_of));
  std::vector<ExtrusionMove> upper;
  std::ranges::copy_if(moves, std::back_inserter(upper),
                       [&](const ExtrusionMove& move) { return layer_of(move) > first; });
  return upper.empty() ? box_of(moves) : box_of(upper);
}

// Moves by layer.
using Layers = std::map<std::int64_t, std::vector<ExtrusionMove>>;

Layers layers_of(const std::vector<ExtrusionMove>& moves) {
  Layers layers;
  auto at = layers.end();
  for (const ExtrusionMove& move : moves) {
    const std::int64_t height = layer_at(move.z);
    if (at == layers.end() || at->first != height) at = layers.try_emplace(height).first;
    at->second.push_back(move);
  }
  return layers;
}

// A layer's filament, added to or taken from cells. Each piece of a line goes to the four nearest cells by
// its distance to them, so that a line on the border of two does not jump with the last decimal. The cells
// are those of the whole print: a layer costs no more than what it touches.
class Grid {
 public:
  explicit Grid(const Box& box) : x_(box.x_min), y_(box.y_min), columns_(count(box.x_max - box.x_min)) {
    cells_.resize(columns_ * count(box.y_max - box.y_min));
  }

  void add(std::span<const ExtrusionMove> moves, double sign) {
    for (const ExtrusionMove& move : moves) {
      const double dx = move.x - move.from_x, dy = move.y - move.from_y;
      const auto pieces = static_cast<std::size_t>(std::max(1.0, std::ceil(std::hypot(dx, dy) / kStep)));
      const double share = 1 / static_cast<double>(pieces);
      for (std::size_t i = 0; i < pieces; ++i) {
        const double t = (static_cast<double>(i) + 0.5) * share;
        add_piece(move.from_x + dx * t, move.from_y + dy * t, sign * move.filament * share);
      }
    }
  }

  // The sum of what is in the cells, whatever its sign; they are empty then.
  double take_magnitudes() {
    std::sort(touched_.begin(), touched_.end());
    double sum = 0;
    for (const std::size_t cell : touched_) sum += std::abs(std::exchange(cells_[cell], 0));
    touched_.clear();
    return sum;
  }

 private:
  // With one cell more, for pieces at the far border.
  static std::size_t count(double length) { return static_cast<std::size_t>(length / kCell) + 2; }

  void add_piece(double x, double y, double filament) {
    const double u = (x - x_) / kCell, v = (y - y_) / kCell;
    const auto column = static_cast<std::size_t>(u), row = static_cast<std::size_t>(v);
    const double right = u - static_cast<double>(column), up = v - static_cast<double>(row);
    const std::size_t cell = row * columns_ + column;
    add_to(cell, filament * (1 - right) * (1 - up));
    add_to(cell + 1, filament * right * (1 - up));
    add_to(cell + columns_, filament * (1 - right) * up);
    add_to(cell + columns_ + 1, filament * right * up);
  }

  void add_to(std::size_t cell, double filament) {
    if (filament == 0) return;
    if (cells_[cell] == 0) touched_.push_back(cell);
    cells_[cell] += filament;
  }

  double x_, y_;
  std::size_t columns_;
  std::vector<double> cells_;
  std::vector<std::size_t> touched_;  // each that is not empty, at least once
};

double filament_of(std::span<const ExtrusionMove> moves) {
  double sum = 0;
  for (const ExtrusionMove& move : moves) sum += move.filament;
  return sum;
}

double length_of(std::span<const ExtrusionMove> moves) {
  double sum = 0;
  for (const ExtrusionMove& move : moves) sum += std::hypot(move.x - move.from_x, move.y - move.from_y);
  return sum;
}

bool is_on_a_bed(const Box& box) {
  return box.x_max - box.x_min <= kLargestBed && box.y_max - box.y_min <= kLargestBed;
}

std::string words_for(std::int64_t layer) {
  if (layer == kBeforeFirstLayer) return "before the first layer";
  if (layer == kAfterLastLayer) return "after the last layer";
  return fmt::format("after the layer at z = {:.2f} mm", static_cast<double>(layer) / 100);
}

using CommandsOfLayers = std::map<std::int64_t, std::vector<PrintCommand>>;

// Those of a layer, with the travels that leave the box.
std::vector<PrintCommand> commands_in(const CommandsOfLayers& all, std::int64_t layer, const PrintBox& box) {
  const auto found = all.find(layer);
  if (found == all.end()) return {};
  std::vector<PrintCommand> commands = found->second;
  std::erase_if(commands, [&](const PrintCommand& command) {
    return command.leaves_to && box.distance(*command.leaves_to) < kOutOfPrint;
  });
  return commands;
}

std::string line_of(const PrintCommand& command) {
  return fmt::format("line {} of it, \"{}\"", command.line, on_one_line(command.text));
}

// Of filament by layer, mm.
std::optional<std::string> difference_in_feeds(const std::map<std::int64_t, double>& a,
                                               const std::map<std::int64_t, double>& b, const char* what) {
  constexpr double kTolerance = 1;  // mm
  const auto at = [](const auto& feeds, std::int64_t layer) {
    const auto found = feeds.find(layer);
    return found == feeds.end() ? 0 : found->second;
  };
  for (const auto* feeds : {&a, &b}) {
    for (const auto& [layer, unused] : *feeds) {
      const double in_a = at(a, layer), in_b = at(b, layer);
      if (std::abs(in_a - in_b) > kTolerance)
        return fmt::format("{:.1f} mm of filament {} instead of {:.1f} {}", in_b, what, in_a,
                           words_for(layer));
    }
  }
  return std::nullopt;
}

double relative_difference(double a, double b) {
  return a == b ? 0 : std::abs(a - b) / std::max(std::abs(a), std::abs(b));
}

// What varied from run to run of PrusaSlicer 2.5 with one model and the same settings is in docs/slicers.md;
// these are about twice that.
constexpr double kTooLittle = 0.05;        // mm of filament in a feature that nothing is said of
constexpr double kFeatureFilament = 0.02;  // relative
constexpr double kSpeedInALayer = 0.3;     // relative
constexpr double kPerimeterSpeed = 0.1;    // the same
constexpr double kTimeInAll = 0.03;        // relative, of a feature
constexpr double kFanSpeed = 13;           // of 255
constexpr double kAcceleration = 0.02;     // relative
constexpr double kBegins = 0.1;            // relative, beside one

double speed_tolerance(std::string_view feature) {
  const bool is_perimeter = feature.starts_with("Perimeter") || feature.starts_with("External perimeter");
  return is_perimeter ? kPerimeterSpeed : kSpeedInALayer;
}

// What is different in a feature of a layer that both prints have; nothing if it is the same.
std::optional<std::string> difference_in_feature(std::string_view feature, const FeatureTotals& a,
                                                 const FeatureTotals& b) {
  if (std::abs(a.filament - b.filament) > kTooLittle + kFeatureFilament * a.filament)
    return fmt::format("takes {:.2f} mm of filament instead of {:.2f}", b.filament, a.filament);
  if (std::min(a.filament, b.filament) < kTooLittle) return std::nullopt;
  const double speed_a = a.length / a.minutes / 60, speed_b = b.length / b.minutes / 60;
  if (a.minutes > 0 && b.minutes > 0 && relative_difference(speed_a, speed_b) > speed_tolerance(feature))
    return fmt::format("is printed at {:.1f} mm/s instead of {:.1f}", speed_b, speed_a);
  if (std::abs(a.fan - b.fan) > kFanSpeed)
    return fmt::format("has the fan at {:.0f} of 255 instead of {:.0f}", b.fan, a.fan);
  if (relative_difference(a.acceleration, b.acceleration) > kAcceleration)
    return fmt::format("has accelerations of {:.0f} mm/s2 instead of {:.0f}", b.acceleration, a.acceleration);
  const auto begins_a = static_cast<double>(a.begins), begins_b = static_cast<double>(b.begins);
  if (std::abs(begins_a - begins_b) > 1 + kBegins * std::max(begins_a, begins_b))
    return fmt::format("is {} lines instead of {}", b.begins, a.begins);
  return std::nullopt;
}

// Sums over the layers.
struct FeatureSums {
  double minutes_a = 0, minutes_b = 0;
};

std::optional<std::string> difference_in_all(const std::map<std::string, FeatureSums>& sums) {
  for (const auto& [feature, sum] : sums) {
    if (relative_difference(sum.minutes_a, sum.minutes_b) > kTimeInAll)
      return fmt::format("the feature \"{}\" takes {:.1f} minutes instead of {:.1f}", feature, sum.minutes_b,
                         sum.minutes_a);
  }
  return std::nullopt;
}

std::optional<std::string> difference_in_features(const PrintLog& a, const PrintLog& b) {
  std::map<std::string, FeatureSums> sums;
  const FeatureTotals none;
  const auto of = [&](const PrintLog& log, const auto& key) -> const FeatureTotals& {
    const auto found = log.features.find(key);
    return found == log.features.end() ? none : found->second;
  };
  for (const PrintLog* log : {&a, &b}) {
    for (const auto& [key, totals] : log->features) {
      if (log == &b && a.features.contains(key)) continue;  // seen already
      const auto& [layer, feature] = key;
      const FeatureTotals &in_a = of(a, key), &in_b = of(b, key);
      if (const auto difference = difference_in_feature(feature, in_a, in_b))
        return fmt::format("at z = {:.2f} mm the feature \"{}\" {}", static_cast<double>(layer) / 100,
                           feature, *difference);
      FeatureSums& sum = sums[feature];
      sum.minutes_a += in_a.minutes;
      sum.minutes_b += in_b.minutes;
    }
  }
  return difference_in_all(sums);
}

}  // namespace

double outline_distance(const std::vector<ExtrusionMove>& moves_a,
                        const std::vector<ExtrusionMove>& moves_b) {
  const Box a = box_of(moves_a), b = box_of(moves_b);
  return std::max({std::abs(a.x_min - b.x_min), std::abs(a.x_max - b.x_max), std::abs(a.y_min - b.y_min),
                   std::abs(a.y_max - b.y_max)});
}

std::optional<BedPlace> shift_of(const std::vector<ExtrusionMove>& moves_a,
                                 const std::vector<ExtrusionMove>& moves_b) {
  // Less moves next to no filament; coordinates have three decimals.
  constexpr double kSamePlace = 0.004;  // mm
  const Box a = box_of_upper_layers(moves_a), b = box_of_upper_layers(moves_b);
  const auto grown_by = [](double min_a, double max_a, double min_b, double max_b) {
    return std::abs((max_a - min_a) - (max_b - min_b));
  };
  const double grown =
      std::max(grown_by(a.x_min, a.x_max, b.x_min, b.x_max), grown_by(a.y_min, a.y_max, b.y_min, b.y_max));
  const BedPlace shift{(a.x_min + a.x_max - b.x_min - b.x_max) / 2,
                       (a.y_min + a.y_max - b.y_min - b.y_max) / 2};
  // Neither holds for boxes of nothing.
  if (!(grown <= kOutline) || !(std::max(std::abs(shift.x), std::abs(shift.y)) > kSamePlace))
    return std::nullopt;
  return shift;
}

PrintDifference compare_prints(const std::vector<ExtrusionMove>& a, const std::vector<ExtrusionMove>& b) {
  PrintDifference difference;
  const Box box = box_of(b, box_of(a));
  if (!is_on_a_bed(box) || length_of(a) > kLongestPrint || length_of(b) > kLongestPrint)
    return {.layers_in_one = 0, .filament = 1, .worst_layer = 1, .worst_z = 0};
  Grid grid(box);
  const Layers layers_a = layers_of(a), layers_b = layers_of(b);
  for (const auto& layer : layers_b) difference.layers_in_one += layers_a.contains(layer.first) ? 0u : 1u;
  double all = 0, displaced = 0;
  for (const auto& [height, moves] : layers_a) {
    const auto other = layers_b.find(height);
    if (other == layers_b.end()) {
      ++difference.layers_in_one;
      continue;
    }
    // What differs is counted twice, where it is missing and where it is too much; so is the filament.
    const double filament = filament_of(moves) + filament_of(other->second);
    grid.add(moves, 1);
    grid.add(other->second, -1);
    const double here = grid.take_magnitudes();
    all += filament;
    displaced += here;
    if (here / filament <= difference.worst_layer) continue;
    difference.worst_layer = here / filament;
    difference.worst_z = static_cast<double>(height) / 100;
  }
  difference.filament = all > 0 ? displaced / all : 0;
  return difference;
}

std::optional<std::string> difference_of(const std::vector<ExtrusionMove>& a,
                                         const std::vector<ExtrusionMove>& b) {
  // From run to run PrusaSlicer 2.5 moved up to 0.04 % of the filament, 0.8 % in the worst layer (seams at
  // random), and never the outline. A shift of 0.01 mm moves 0.3 %.
  constexpr double kFilament = 0.0015, kInOneLayer = 0.03;
  if (a.empty() || b.empty()) return "one of them extrudes nothing";
  if (const double distance = outline_distance(a, b); distance > kOutline)
    return fmt::format("its outline is {:.2f} mm off", distance);
  if (!is_on_a_bed(box_of(a)))
    return fmt::format("it is larger than {:g} mm, more than can be compared", kLargestBed);
  if (length_of(a) > kLongestPrint)
    return fmt::format("its lines are longer than {:g} mm, more than can be compared", kLongestPrint);
  const PrintDifference difference = compare_prints(a, b);
  if (difference.layers_in_one > 0)
    return counted(difference.layers_in_one, "layer is at another height", "layers are at other heights");
  if (difference.worst_layer > kInOneLayer)
    return fmt::format("{:.1f} % of the filament is elsewhere at z = {:.2f} mm", 100 * difference.worst_layer,
                       difference.worst_z);
  if (difference.filament > kFilament)
    return fmt::format("{:.2f} % of the filament is elsewhere", 100 * difference.filament);
  return std::nullopt;
}

std::optional<std::string> difference_in_commands(const PrintLog& a, const PrintLog& b) {
  for (const CommandsOfLayers* all : {&a.commands, &b.commands}) {
    for (const auto& [layer, unused] : *all) {
      // One box for both: a place may be as far from it as the limit.
      const auto in_a = commands_in(a.commands, layer, a.box), in_b = commands_in(b.commands, layer, a.box);
      const auto [at_a, at_b] = std::mismatch(in_a.begin(), in_a.end(), in_b.begin(), in_b.end());
      if (at_a != in_a.end()) return fmt::format("{} {}, would be lost", line_of(*at_a), words_for(layer));
      if (at_b != in_b.end())
        return fmt::format("\"{}\" {} is not in it", on_one_line(at_b->text), words_for(layer));
    }
  }
  for (const auto& [acceleration, command] : a.travel_accelerations) {
    if (!b.travel_accelerations.contains(acceleration)) return line_of(command) + " would be lost";
  }
  if (auto difference = difference_in_feeds(a.purged, b.purged, "goes through the standing nozzle"))
    return difference;
  if (auto difference = difference_in_feeds(a.kept_back, b.kept_back, "stays retracted")) return difference;
  if (a.tells_progress != b.tells_progress) return "only one of them tells progress (M73)";
  return std::nullopt;
}

std::optional<std::string> difference_of(const PrintLog& a, const PrintLog& b) {
  if (auto difference = difference_in_commands(a, b)) return difference;
  return difference_in_features(a, b);
}

}  // namespace aerate
