#include "printing/slicers/gcode_machine.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace aerate {
namespace {

constexpr double kFullTurn = 2 * std::numbers::pi;

double within_bounds(double value) {
  return std::clamp(value, -GcodeMachine::kLargestCoordinate, GcodeMachine::kLargestCoordinate);
}

// X, Y, Z, E and I, J by their places; nothing for other letters.
std::optional<std::size_t> axis_of(char letter) {
  const std::size_t axis = std::string_view("XYZEIJ").find(letter);
  return axis == std::string_view::npos ? std::nullopt : std::optional(axis);
}

}  // namespace

std::string_view command_in(std::string_view line) {
  return without_blanks(line.substr(0, line.find(';')));
}

std::optional<CommandWord> command_word(std::string_view command) {
  constexpr double kLargestCode = 1e6;
  if (command.empty()) return std::nullopt;
  CommandWord word{.letter = command.front(), .code = 0, .rest = command.substr(1)};
  const std::optional<double> number = take_number(word.rest);
  if (!number || std::abs(*number) > kLargestCode) return std::nullopt;
  word.code = static_cast<int>(*number);
  return word;
}

bool GcodeMachine::run(std::string_view line) {
  moved_ = false;
  const auto word = command_word(command_in(line));
  if (!word) return false;
  if (word->letter == 'M' && word->code == 82) relative_filament_ = false;
  if (word->letter == 'M' && word->code == 83) relative_filament_ = true;
  if (word->letter != 'G') return false;
  if (word->code == 90) relative_ = relative_filament_ = false;
  if (word->code == 91) relative_ = relative_filament_ = true;
  if (word->code == 92) set_position(word->rest);
  if (word->code < 0 || word->code > 3) return false;
  turn_ = word->code == 2 ? -1 : word->code == 3 ? 1 : 0;
  moved_ = true;
  return move(word->rest);
}

void GcodeMachine::set_position(std::string_view rest) {
  for_each_word(rest, [&](char letter, double value) {
    if (const auto axis = axis_of(letter); axis && *axis < axes_.size()) axes_[*axis] = within_bounds(value);
  });
}

bool GcodeMachine::move(std::string_view rest) {
  before_ = axes_;
  centre_offset_ = {};
  for_each_word(rest, [&](char letter, double value) {
    if (letter == 'F') feed_ = std::max(within_bounds(value), 0.0);
    const auto axis = axis_of(letter);
    if (!axis) return;
    if (*axis > kFilament) {
      centre_offset_[*axis - kFilament - 1] = within_bounds(value);
      return;
    }
    const bool relative = *axis == kFilament ? relative_filament_ : relative_;
    axes_[*axis] = within_bounds(relative ? axes_[*axis] + value : value);
  });
  if (centre_offset_ == std::array<double, 2>{}) turn_ = 0;  // given by its radius: taken as straight
  fed_ = axes_[kFilament] - before_[kFilament];
  return travelled() && fed_ > 0;
}

bool GcodeMachine::travelled() const {
  return moved_ && (turn_ != 0 || axes_[0] != before_[0] || axes_[1] != before_[1] || axes_[2] != before_[2]);
}

double GcodeMachine::arc_radius() const {
  return std::hypot(centre_offset_[0], centre_offset_[1]);
}

double GcodeMachine::arc_angle() const {
  const double centre_x = before_[0] + centre_offset_[0], centre_y = before_[1] + centre_offset_[1];
  const double angle = std::atan2(axes_[1] - centre_y, axes_[0] - centre_x) -
                       std::atan2(-centre_offset_[1], -centre_offset_[0]);
  return turn_ * angle <= 0 ? angle + turn_ * kFullTurn : angle;
}

double GcodeMachine::length() const {
  if (turn_ != 0) return std::abs(arc_angle()) * arc_radius();
  return std::hypot(axes_[0] - before_[0], axes_[1] - before_[1]);
}

void GcodeMachine::append_moves(std::vector<ExtrusionMove>& moves, std::size_t most_chords) const {
  constexpr double kLongestChord = 1;  // mm
  const double from_x = before_[0], from_y = before_[1];
  const double wanted = turn_ == 0 ? 1 : std::max(std::ceil(length() / kLongestChord), 1.0);
  if (turn_ == 0 || wanted > static_cast<double>(most_chords)) {
    moves.push_back({from_x, from_y, axes_[0], axes_[1], axes_[2], fed_});
    return;
  }
  const double centre_x = from_x + centre_offset_[0], centre_y = from_y + centre_offset_[1];
  const double radius = arc_radius(), angle = arc_angle();
  const double begin = std::atan2(from_y - centre_y, from_x - centre_x);
  const auto chords = static_cast<std::size_t>(wanted);
  const auto count = static_cast<double>(chords);
  double x = from_x, y = from_y;
  for (std::size_t i = 1; i <= chords; ++i) {
    const double to = begin + angle * static_cast<double>(i) / count;
    const double next_x = i == chords ? axes_[0] : centre_x + radius * std::cos(to);
    const double next_y = i == chords ? axes_[1] : centre_y + radius * std::sin(to);
    moves.push_back({x, y, next_x, next_y, axes_[2], fed_ / count});
    x = next_x;
    y = next_y;
  }
}

}  // namespace aerate
