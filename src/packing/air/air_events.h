#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "packing/air/air_columns.h"

namespace aerate {

// What happens while a level rises through the air.
struct AirEvent {
  enum class Kind : std::uint8_t { begins, passes, ends };  // in this order at one height
  double height;
  Kind kind;
  std::uint32_t span;
  std::size_t passage;  // of all, where it passes
};

// Each span that begins or ends, each passage at its lowest line; by height.
std::vector<AirEvent> rising_events(const AirColumns& columns);

}  // namespace aerate
