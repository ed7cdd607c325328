#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string_view>
#include <vector>

#include "printing/slicers/gcode.h"
#include "printing/slicers/text_file.h"

namespace aerate {

// The command of a line: without its comment, without blanks round it.
std::string_view command_in(std::string_view line);

// Letter and whole number at the front of a command ("G1 X2": G and 1, the rest " X2"); nothing for anything
// else, names such as START_PRINT among it.
struct CommandWord {
  char letter = 0;
  int code = 0;
  std::string_view rest;
};
std::optional<CommandWord> command_word(std::string_view command);

// Calls f(letter, value) for each word "X1.5" of a command's rest; others are left out.
template <typename F>
void for_each_word(std::string_view rest, const F& f) {
  for (rest = trimmed(rest); !rest.empty(); rest = trimmed(rest)) {
    const char letter = rest.front();
    rest.remove_prefix(1);
    if (const std::optional<double> value = take_number(rest)) f(letter, *value);
  }
}

// Follows a machine's position through G-code. No position or feed is beyond kLargestCoordinate, whatever the
// text says, so that sums and casts of them are safe.
class GcodeMachine {
 public:
  static constexpr double kLargestCoordinate = 1e7;  // mm: ten kilometres

  // Returns true if the line was a move that extruded.
  bool run(std::string_view line);

  // Whether the line that `run` was given last was a move, extruding or not.
  bool moved() const { return moved_; }
  // Whether it went to another place.
  bool travelled() const;

  // Whether places are given from where it stood (G91).
  bool relative() const { return relative_; }

  // Where it is, and what `run` reported.
  double x() const { return axes_[0]; }
  double y() const { return axes_[1]; }
  double z() const { return axes_[2]; }
  double filament() const { return fed_; }
  double feed() const { return feed_; }  // mm per minute; 0 where none was given yet
  double length() const;                 // mm, along the arc

  // The same as moves, appended: one, or the chords of an arc if at most `most_chords` do.
  void append_moves(std::vector<ExtrusionMove>& moves, std::size_t most_chords) const;

 private:
  static constexpr std::size_t kFilament = 3;

  void set_position(std::string_view rest);
  bool move(std::string_view rest);
  double arc_angle() const;  // signed; only of an arc
  double arc_radius() const;

  std::array<double, 4> axes_{}, before_{};
  std::array<double, 2> centre_offset_{};  // of an arc, from where it begins
  int turn_ = 0;                           // 1 counterclockwise, -1 clockwise, 0 straight
  double fed_ = 0;
  double feed_ = 0;
  bool relative_ = false;
  bool relative_filament_ = false;
  bool moved_ = false;
};

}  // namespace aerate
