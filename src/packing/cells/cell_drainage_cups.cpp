#include <algorithm>
#include <cstddef>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "kernels/constants.h"
#include "packing/cells/cell_drainage_stages.h"

// Where a layer of a print closes in what is below it. Air gets out of a hollow below its spill height nowhere but through the
// layer that is printed, so what of a basin lies at its spill height, seen from above, is what is sucked at.

namespace aerate {
namespace {

// Holes beyond those that drain.
constexpr int kMostHoles = 4;

// A hole is worth it that takes off this share of what is above the limit.
constexpr double kLeastGain = 0.25;

// Cups for which a place is looked for before none is found to be worth it.
constexpr int kMostCupsTried = 4;

constexpr int kMostRoundsOfWindows = 4;

// What is less does not count, mm2.
constexpr double kLeastArea = 1;

// What is no deeper is not sucked at, mm.
constexpr double kShallow = 0.5;

// A layer, or two, mm.
constexpr double kLayer = 0.1;

struct Cup {
  double area = 0;  // mm2
  std::vector<Basin::Part> hollows;
};

// Of a piece, what a layer takes up that ends at a height, mm2.
double area_at(const VoidHollows::Piece& piece, double height) {
  return (piece_below(piece, kUpright, height) - piece_below(piece, kUpright, height - kLayer)) / kLayer;
}

// Those of a draft, the widest first.
std::vector<Cup> cups_of(const CellDrainageTask& task, const CellDraft& draft) {
  const HollowFlood flood = task.pools.flood(passages_of(task, draft), kUpright);
  std::vector<Cup> cups;
  for (Basin& basin : task.pools.basins(flood, kUpright, draft.is_kept)) {
    Cup cup;
    double deepest = 0;
    for (const Basin::Part& part : basin.hollows) {
      const VoidHollows& own = task.hollows[part.in];
      const double height = flood.height[task.pools.vertex(part.in, part.hollow, kUpright)];
      deepest = std::max(deepest, height - own.in(kUpright).bottom[part.hollow]);
      for (const VoidHollows::Piece& piece : own.pieces()) {
        if (piece.upright == part.hollow) cup.area += area_at(piece, height);
      }
    }
    if (deepest <= kShallow) continue;
    cup.hollows = std::move(basin.hollows);
    cups.push_back(std::move(cup));
  }
  std::ranges::stable_sort(cups, [](const Cup& a, const Cup& b) { return a.area > b.area; });
  return cups;
}

// What is above the limit, mm2.
double excess_of(const std::vector<Cup>& cups, double limit) {
  double excess = 0;
  for (const Cup& cup : cups) excess += std::max(0.0, cup.area - limit);
  return excess;
}

std::optional<CellDraft> with_one_more_hole(CellDrainageTask& task, const CellDraft& draft, double limit) {
  const std::vector<Cup> cups = cups_of(task, draft);
  const double before = excess_of(cups, limit);
  int tries = 0;
  for (const Cup& cup : cups) {
    if (cup.area <= limit || ++tries > kMostCupsTried) break;
    CellDraft opened = draft;
    if (!open_hollows(task, opened, cup.hollows, kUpright)) continue;
    CellHole hole = *opened.holes.back();
    hole.hole.purpose = HolePurpose::cup;
    opened.holes.back() = std::make_shared<const CellHole>(std::move(hole));
    if (excess_of(cups_of(task, opened), limit) <= (1 - kLeastGain) * before) return opened;
  }
  return std::nullopt;
}

// With windows that make cups less wide, but for those that do nothing for them.
CellDraft with_lower_windows(CellDrainageTask& task, CellDraft draft, double limit) {
  const std::size_t first = draft.windows.size();
  for (int round = 0; round < kMostRoundsOfWindows; ++round) {
    const double before = excess_of(cups_of(task, draft), limit);
    if (before <= 0) break;
    task.monitor.check_interrupted();
    CellDraft lower = with_windows_that_lower(task, draft, kUpright);
    if (excess_of(cups_of(task, lower), limit) >= before - kLeastArea) break;
    draft = std::move(lower);
  }
  double with_all = excess_of(cups_of(task, draft), limit);
  for (std::size_t i = draft.windows.size(); i-- > first;) {
    task.monitor.check_interrupted();
    CellDraft fewer = draft;
    fewer.windows.erase(fewer.windows.begin() + static_cast<std::ptrdiff_t>(i));
    const double without_one = excess_of(cups_of(task, fewer), limit);
    if (without_one > with_all + kLeastArea) continue;
    draft = std::move(fewer);
    with_all = without_one;
  }
  return draft;
}

}  // namespace

double widest_cup(const CellDrainageTask& task, const CellDraft& draft) {
  const std::vector<Cup> cups = cups_of(task, draft);
  return cups.empty() ? 0 : cups.front().area;
}

// Windows first: they do not show.
CellDraft open_cups(CellDrainageTask& task, CellDraft draft) {
  const double limit = task.request.widest_cup;
  if (!(limit < kInfinity)) return draft;
  draft = with_lower_windows(task, std::move(draft), limit);
  const int most = task.request.escape_holes.size() < 2 ? kMostHoles : 0;
  for (int more = 0; more < most; ++more) {
    auto opened = with_one_more_hole(task, draft, limit);
    if (!opened) break;
    draft = with_lower_windows(task, std::move(*opened), limit);
  }
  return draft;
}

}  // namespace aerate
