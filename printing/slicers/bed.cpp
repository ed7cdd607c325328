#include "printing/slicers/bed.h"

#include <algorithm>

#include "printing/slicers/text_file.h"

namespace aerate {

std::optional<BedPlace> middle_of_bed(std::string_view corners) {
  std::optional<BedPlace> least, most;
  for (std::string_view text = corners;;) {
    const auto x = take_number(text);
    if (!x || !text.starts_with('x')) return std::nullopt;
    text.remove_prefix(1);
    const auto y = take_number(text);
    if (!y) return std::nullopt;
    least = least ? BedPlace{std::min(least->x, *x), std::min(least->y, *y)} : BedPlace{*x, *y};
    most = most ? BedPlace{std::max(most->x, *x), std::max(most->y, *y)} : BedPlace{*x, *y};
    text = without_blanks(text);
    if (text.empty()) return BedPlace{(least->x + most->x) / 2, (least->y + most->y) / 2};
    if (!text.starts_with(',')) return std::nullopt;
    text.remove_prefix(1);
  }
}

}  // namespace aerate
