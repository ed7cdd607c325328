#pragma once

#include <optional>
#include <string_view>

namespace aerate {

// A place on the build plate, mm.
struct BedPlace {
  double x = 0, y = 0;
};

// Where slicers put a model that is alone: the middle of the box round a bed of corners such as "0x0,250x0,250x210,0x210".
// Nothing for a text that is no such list.
std::optional<BedPlace> middle_of_bed(std::string_view corners);

}  // namespace aerate
