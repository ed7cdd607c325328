#include "packing/air/air_cups.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>

#include "core/disjoint_sets.h"
#include "kernels/constants.h"
#include "packing/air/air_events.h"

namespace aerate {
namespace {

// Cups are looked at so often while the print grows: about as often as there are layers.
constexpr double kLayer = 0.05;  // mm
constexpr double kMostLayers = 10000;

// A connected set of spans below a level.
struct Enclosed {
  bool is_outside = false;
  Vec3d bottom{0, 0, kInfinity};  // its lowest place
  double open_count = 0;          // of its spans, those that go on above the level
  double open_floors = 0;         // sum of their floors
  double closed_volume = 0;
  Vec3d middle{0, 0, 0};  // sum over its open spans
  AirCup widest;
};

class Growth {
 public:
  Growth(const AirColumns& columns, double base)
      : columns_(columns), base_(base), sets_(columns.spans.size()), enclosed_(columns.spans.size()) {}

  void apply(const AirEvent& event) {
    switch (event.kind) {
      case AirEvent::Kind::begins:
        return begin(event.span, event.height);
      case AirEvent::Kind::passes:
        return join(event.span, columns_.passages[event.passage].to);
      case AirEvent::Kind::ends:
        return end(event.span, event.height);
    }
  }

  void look_at_layer(double height) {
    std::erase_if(active_, [&](std::uint32_t i) { return sets_.root(i) != i || enclosed_[i].is_outside; });
    for (const std::uint32_t i : active_) {
      Enclosed& cup = enclosed_[i];
      const double area = columns_.area() * cup.open_count;
      if (height - cup.bottom.z < columns_.spacing || !(area > 0) || area < cup.widest.area) continue;
      const Vec3d middle = cup.middle * (1 / cup.open_count);
      cup.widest = {area,
                    cup.closed_volume + columns_.area() * (cup.open_count * height - cup.open_floors),
                    height - base_,
                    {middle.x, middle.y, height},
                    cup.bottom};
    }
  }

  std::vector<AirCup> take() {
    for (const std::uint32_t i : active_) {
      if (sets_.root(i) == i && !enclosed_[i].is_outside) finish(enclosed_[i]);
    }
    std::stable_sort(finished_.begin(), finished_.end(),
                     [](const AirCup& a, const AirCup& b) { return a.area > b.area; });
    return std::move(finished_);
  }

 private:
  void begin(std::uint32_t span, double height) {
    Enclosed& own = enclosed_[span];
    own.is_outside = height == -kInfinity;
    if (own.is_outside) return;
    own.bottom = columns_.at(span, height);
    own.open_floors = height;
    own.open_count = 1;
    own.middle = columns_.at(span, 0);
    active_.push_back(span);
  }

  void join(std::uint32_t a, std::uint32_t b) {
    a = sets_.root(a);
    b = sets_.root(b);
    if (a == b) return;
    sets_.join(a, b);
    const std::uint32_t into = sets_.root(a);
    Enclosed &whole = enclosed_[into], &other = enclosed_[into == a ? b : a];
    if (whole.is_outside || other.is_outside) {
      finish(whole);
      finish(other);
      whole.is_outside = true;
      return;
    }
    if (other.widest.area > whole.widest.area) std::swap(whole.widest, other.widest);
    finish(other);
    if (other.bottom.z < whole.bottom.z) whole.bottom = other.bottom;
    whole.open_count += other.open_count;
    whole.open_floors += other.open_floors;
    whole.closed_volume += other.closed_volume;
    whole.middle = whole.middle + other.middle;
  }

  void end(std::uint32_t span, double height) {
    Enclosed& cup = enclosed_[sets_.root(span)];
    if (cup.is_outside) return;
    const double floor = columns_.spans[span].floor;
    cup.open_count -= 1;
    cup.open_floors -= floor;
    cup.closed_volume += columns_.area() * (height - floor);
    cup.middle = cup.middle - columns_.at(span, 0);
  }

  void finish(Enclosed& cup) {
    if (cup.widest.area > 0) finished_.push_back(cup.widest);
    cup.widest = {};
  }

  const AirColumns& columns_;
  double base_;  // height of the lowest layer
  DisjointSets sets_;
  std::vector<Enclosed> enclosed_;  // by the root of its set
  std::vector<std::uint32_t> active_;
  std::vector<AirCup> finished_;
};

}  // namespace

std::vector<AirCup> cups_of(const AirColumns& columns) {
  const std::vector<AirEvent> events = rising_events(columns);
  double lowest = kInfinity, highest = -kInfinity;
  for (const AirSpan& span : columns.spans) {
    for (const double height : {span.floor, span.ceiling}) {
      if (height == kInfinity || height == -kInfinity) continue;
      lowest = std::min(lowest, height);
      highest = std::max(highest, height);
    }
  }
  Growth growth(columns, lowest);
  const double layer = std::max(kLayer, (highest - lowest) / kMostLayers);
  std::size_t next = 0;
  for (std::size_t i = 0; next < events.size(); ++i) {
    const double height = lowest + layer * static_cast<double>(i);
    while (next < events.size() && events[next].height <= height) growth.apply(events[next++]);
    if (height > highest) break;
    growth.look_at_layer(height);
  }
  return growth.take();
}

}  // namespace aerate
