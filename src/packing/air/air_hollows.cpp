#include "packing/air/air_hollows.h"

#include <algorithm>
#include <tuple>
#include <utility>

#include "core/disjoint_sets.h"
#include "kernels/constants.h"

namespace aerate {
namespace {

class HollowTree {
 public:
  HollowTree(std::size_t spans, double least_depth)
      : least_depth_(least_depth), sets_(spans), of_span_(spans, kNone), of_set_(spans, kNone) {}

  void begin(std::uint32_t span, double height) { of_span_[span] = of_set_[span] = add(height); }

  void join(std::uint32_t a, std::uint32_t b, double height) {
    const std::uint32_t in_a = sets_.root(a), in_b = sets_.root(b);
    if (in_a == in_b) return;
    const std::uint32_t joined = joined_at(of_set_[in_a], of_set_[in_b], height);
    sets_.join(a, b);
    of_set_[sets_.root(a)] = joined;
  }

  // With those left out that are the same as others.
  AirHollows take() {
    std::vector<std::uint32_t> number(parent_.size(), kNone);
    std::uint32_t count = 0;
    for (std::uint32_t i = 0; i < parent_.size(); ++i) {
      if (same_as_[i] == i) number[i] = count++;
    }
    AirHollows hollows;
    for (std::uint32_t i = 0; i < parent_.size(); ++i) {
      if (same_as_[i] != i) continue;
      hollows.parent.push_back(parent_[i] == kNone ? kNone : number[final_of(parent_[i])]);
    }
    hollows.of_span = std::move(of_span_);
    for (std::uint32_t& hollow : hollows.of_span) hollow = number[final_of(hollow)];
    return hollows;
  }

 private:
  std::uint32_t add(double bottom) {
    const auto number = static_cast<std::uint32_t>(parent_.size());
    parent_.push_back(kNone);
    same_as_.push_back(number);
    bottom_.push_back(bottom);
    return number;
  }

  std::uint32_t joined_at(std::uint32_t deeper, std::uint32_t other, double height) {
    if (bottom_[other] < bottom_[deeper]) std::swap(deeper, other);
    if (!(height - bottom_[other] >= least_depth_)) {
      same_as_[other] = deeper;
      return deeper;
    }
    const std::uint32_t above = add(bottom_[deeper]);
    parent_[deeper] = parent_[other] = above;
    return above;
  }

  std::uint32_t final_of(std::uint32_t hollow) {
    while (same_as_[hollow] != hollow) hollow = same_as_[hollow] = same_as_[same_as_[hollow]];
    return hollow;
  }

  double least_depth_;
  DisjointSets sets_;
  std::vector<std::uint32_t> of_span_, of_set_;  // of a set by its root
  std::vector<std::uint32_t> parent_, same_as_;
  std::vector<double> bottom_;
};

}  // namespace

std::vector<AirEvent> rising_events(const AirColumns& columns, std::size_t orientation) {
  using Kind = AirEvent::Kind;
  std::vector<AirEvent> events;
  for (std::uint32_t i = 0; i < columns.spans.size(); ++i) {
    events.push_back({columns.spans[i].floor_in(orientation), Kind::begins, i, 0});
    events.push_back({columns.spans[i].ceiling_in(orientation), Kind::ends, i, 0});
    for (std::size_t k = columns.first_passage[i]; k < columns.first_passage[i + 1]; ++k) {
      const AirPassage& passage = columns.passages[k];
      if (passage.to > i) events.push_back({passage.sill_in(orientation), Kind::passes, i, k});
    }
  }
  std::sort(events.begin(), events.end(), [](const AirEvent& a, const AirEvent& b) {
    return std::tie(a.height, a.kind, a.span, a.passage) < std::tie(b.height, b.kind, b.span, b.passage);
  });
  return events;
}

AirHollows hollows_of(const AirColumns& columns, std::size_t orientation) {
  HollowTree tree(columns.spans.size(), columns.spacing);
  for (const AirEvent& event : rising_events(columns, orientation)) {
    if (event.kind == AirEvent::Kind::begins) tree.begin(event.span, event.height);
    if (event.kind == AirEvent::Kind::passes)
      tree.join(event.span, columns.passages[event.passage].to, event.height);
  }
  return tree.take();
}

}  // namespace aerate
