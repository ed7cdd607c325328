#include "packing/air/air_events.h"

#include <algorithm>
#include <tuple>

namespace aerate {

std::vector<AirEvent> rising_events(const AirColumns& columns) {
  using Kind = AirEvent::Kind;
  std::vector<AirEvent> events;
  for (std::uint32_t i = 0; i < columns.spans.size(); ++i) {
    events.push_back({columns.spans[i].floor, Kind::begins, i, 0});
    events.push_back({columns.spans[i].ceiling, Kind::ends, i, 0});
    for (std::size_t k = columns.first_passage[i]; k < columns.first_passage[i + 1]; ++k) {
      const AirPassage& passage = columns.passages[k];
      if (passage.to > i) events.push_back({passage.lowest, Kind::passes, i, k});
    }
  }
  std::sort(events.begin(), events.end(), [](const AirEvent& a, const AirEvent& b) {
    return std::tie(a.height, a.kind, a.span, a.passage) < std::tie(b.height, b.kind, b.span, b.passage);
  });
  return events;
}

}  // namespace aerate
