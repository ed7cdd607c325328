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

// Each span that begins or ends, each passage at its sill; by height.
std::vector<AirEvent> rising_events(const AirColumns& columns, std::size_t orientation);

// Spans that fill as one, from a lowest floor or from where two such hollows run over into each other: the join tree of
// their heights (packing/cells/node_pools.h has it for nodes). Hollows less deep than a column is wide are not told apart.
struct AirHollows {
  std::vector<std::uint32_t> parent;   // by hollow; kNone for a topmost one
  std::vector<std::uint32_t> of_span;  // that it begins in
};
AirHollows hollows_of(const AirColumns& columns, std::size_t orientation);

}  // namespace aerate
