#include <algorithm>
#include <cmath>
#include <string>

#include "printing/slicers/gcode.h"
#include "printing/slicers/gcode_match.h"
#include "printing/slicers/print_settings_file.h"
#include "printing/slicers/slicers.h"
#include "tests/fuzz/fuzz_input.h"

namespace {

// Places of a print that is small enough to be compared with another.
bool is_printable(const aerate::ExtrusionMove& move) {
  constexpr double kHalfOfBed = 1500;  // mm
  return std::max({std::abs(move.from_x), std::abs(move.from_y), std::abs(move.x), std::abs(move.y)}) <
         kHalfOfBed;
}

// True if the second text is the first with the comments before one of its lines or after them all. The text
// may hold the same comments already, at a line's begin or not.
bool is_inserted_as_lines(std::string_view comments, std::string_view gcode, std::string_view with) {
  for (std::size_t at = with.find(comments); at != std::string_view::npos; at = with.find(comments, at + 1)) {
    std::string_view before = with.substr(0, at);
    const std::string_view after = with.substr(at + comments.size());
    if (!before.empty() && !before.ends_with('\n')) continue;
    const bool ends_the_last_line = after.empty() && !before.empty() && !gcode.ends_with('\n');
    if (ends_the_last_line) before.remove_suffix(1);
    if (gcode.size() == before.size() + after.size() && gcode.starts_with(before) && gcode.ends_with(after))
      return true;
  }
  return false;
}

}  // namespace

// What the hook and `aerate slice` read of G-code and of settings.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using aerate::fuzz::require;
  const std::string_view gcode = aerate::fuzz::text_of(data, size);
  return aerate::fuzz::run([&] {
    const std::vector<aerate::ExtrusionMove> moves = aerate::extrusion_moves(gcode);
    require(aerate::extrudes(gcode) == !moves.empty(), "G-code extrudes if it has moves that do");
    for (const aerate::ExtrusionMove& move : moves) {
      require(std::isfinite(move.x) && std::isfinite(move.y) && std::isfinite(move.z), "places are finite");
      require(move.filament > 0, "moves that extrude take filament");
    }
    const auto difference = aerate::difference_of(moves, moves);
    if (!moves.empty() && std::ranges::all_of(moves, is_printable))
      require(!difference, "a print is the same as itself");
    const aerate::GcodeOrigin origin = aerate::origin_of(gcode);
    if (origin.slicer != nullptr) aerate::figures_of(gcode, *origin.slicer);
    aerate::setting_in(gcode, "layer_height");
    aerate::names_post_processing(gcode);

    constexpr std::string_view kComment = "; aerate = begin\n; aerate = end\n";
    require(is_inserted_as_lines(kComment, gcode, aerate::with_comments(gcode, kComment)),
            "comments begin a line and the rest stays");
    require(aerate::with_thumbnails_of(std::string(gcode), gcode) == gcode,
            "its own pictures change nothing");
    const aerate::PrintSettings print = aerate::print_settings_in(gcode, "settings").settings;
    require(print.infill >= 0 && print.infill <= 1 && print.line_width > 0 && print.layer_height > 0,
            "a print that was read can be printed");
  });
}
