#include "pipeline/stand.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <fmt/format.h>
#include <map>
#include <numeric>
#include <set>
#include <string>
#include <tuple>
#include <utility>

#include "core/error.h"
#include "core/listed.h"
#include "core/upright.h"
#include "kernels/constants.h"
#include "kernels/roof.h"

namespace aerate {
namespace {

// Results that are made for one model.
constexpr std::size_t kMostTries = 10;

// Where a choice cannot be made, or was made before, the next is for a margin that is larger by this share.
constexpr double kStep = 0.02;

// Of so many voids all choices are looked at.
constexpr std::size_t kFew = 14;

// A choice has to be better than this by what is computed of it before it is made, mm.
constexpr double kRoundingOfMargin = 1e-9;

// Of what is left while voids are left out one by one.
class Remainder {
 public:
  Remainder(const Footprint& footprint, const Weight& solid, std::span<const Weight> voids)
      : footprint_(footprint),
        voids_(voids),
        is_made_(voids.size(), true),
        made_(voids.size()),
        volume_(solid.volume),
        x_(solid.volume * solid.x),
        y_(solid.volume * solid.y) {
    for (const Weight& one : voids) add(one, -1);
  }

  std::size_t made() const { return made_; }
  double volume() const { return volume_; }
  double margin() const { return margin_of(volume_, x_, y_); }

  void leave_out(std::uint32_t i) { turn(i, false); }
  void make(std::uint32_t i) { turn(i, true); }
  bool is_made(std::uint32_t i) const { return is_made_[i]; }

  // Makes a void again if it does no harm.
  void make_if_it_stands(std::uint32_t i, double needed) {
    turn(i, true);
    if (margin() < needed) turn(i, false);
  }

  // The void farthest from the nearest edge of the footprint, if the centre of mass comes away from that edge without it.
  std::optional<std::uint32_t> best_to_leave_out() {
    const double x = x_ / volume_, y = y_ / volume_;
    const Footprint::Edge edge = footprint_.nearest_edge(x, y);
    std::vector<std::uint32_t>& order = farthest_first_[edge.number];
    const auto inside = [&](const Weight& one) { return edge.inward_x * one.x + edge.inward_y * one.y; };
    if (order.empty()) {
      order.resize(voids_.size());
      std::iota(order.begin(), order.end(), 0U);
      // The last is the next to be left out.
      std::ranges::stable_sort(
          order, [&](std::uint32_t a, std::uint32_t b) { return inside(voids_[a]) < inside(voids_[b]); });
    }
    while (!order.empty() && !is_made_[order.back()]) order.pop_back();
    if (order.empty() || inside(voids_[order.back()]) <= edge.inward_x * x + edge.inward_y * y)
      return std::nullopt;
    return order.back();
  }

  // By looking at each: where no void draws it to the nearest edge, the one without which it is farthest inside.
  std::uint32_t least_harm() const {
    std::uint32_t best = 0;
    double best_margin = -kInfinity;
    for (std::uint32_t i = 0; i < voids_.size(); ++i) {
      if (!is_made_[i]) continue;
      const Weight& one = voids_[i];
      const double margin = margin_of(volume_ + one.volume, x_ + one.volume * one.x, y_ + one.volume * one.y);
      if (margin > best_margin) std::tie(best, best_margin) = std::pair(i, margin);
    }
    return best;
  }

 private:
  double margin_of(double volume, double x, double y) const {
    return footprint_.margin(x / volume, y / volume);
  }
  void add(const Weight& one, double sign) {
    volume_ += sign * one.volume;
    x_ += sign * one.volume * one.x;
    y_ += sign * one.volume * one.y;
  }
  void turn(std::uint32_t i, bool made) {
    add(voids_[i], made ? -1 : 1);
    is_made_[i] = made;
    if (made)
      ++made_;
    else
      --made_;
  }

  const Footprint& footprint_;
  std::span<const Weight> voids_;
  std::vector<bool> is_made_;
  std::size_t made_;
  double volume_, x_, y_;
  std::map<std::size_t, std::vector<std::uint32_t>> farthest_first_;  // by edge; what is left to leave out
};

StandingChoice chosen(const Remainder& left, std::size_t count) {
  StandingChoice choice{std::vector<std::uint32_t>(), left.margin()};
  for (std::uint32_t i = 0; i < count; ++i) {
    if (left.is_made(i)) choice.voids->push_back(i);
  }
  return choice;
}

// All choices of those voids, each one void from the one before (F. Gray's code).
StandingChoice best_of_all(const Footprint& footprint, const Weight& solid, std::span<const Weight> voids,
                           std::span<const std::uint32_t> few, double needed) {
  Remainder left(footprint, solid, voids);
  for (std::uint32_t i = 0; i < voids.size(); ++i) left.leave_out(i);
  StandingChoice best{std::nullopt, -kInfinity};
  double least = kInfinity;
  for (std::uint32_t number = 1; number < 1U << few.size(); ++number) {
    const std::uint32_t i = few[static_cast<std::size_t>(std::countr_zero(number))];
    if (left.is_made(i))
      left.leave_out(i);
    else
      left.make(i);
    if (left.margin() < needed) {
      if (!best.voids) best.best_margin = std::max(best.best_margin, left.margin());
    } else if (left.volume() < least) {
      best = chosen(left, voids.size());
      least = left.volume();
    }
  }
  return best;
}

// `largest_first`: all of the voids.
StandingChoice by_leaving_out(const Footprint& footprint, const Weight& solid, std::span<const Weight> voids,
                              std::span<const std::uint32_t> largest_first, double needed) {
  Remainder left(footprint, solid, voids);
  double best_margin = left.margin();
  while (left.made() > 0 && left.margin() < needed) {
    const auto best = left.best_to_leave_out();
    left.leave_out(best ? *best : left.least_harm());
    if (left.made() > 0) best_margin = std::max(best_margin, left.margin());
  }
  if (left.margin() >= needed) {
    for (const std::uint32_t i : largest_first) {
      if (!left.is_made(i)) left.make_if_it_stands(i, needed);
    }
    if (left.made() > 0) return chosen(left, voids.size());
  }
  return {std::nullopt, best_margin};
}

Weight weight_of(const VolumeMoments& moments, const UprightFrame& frame) {
  const Vec3d centre = frame.to_frame(moments.first_moment * (1 / moments.volume));
  return {std::abs(moments.volume), centre.x, centre.y};
}

std::vector<Weight> weights_of(const MadeVoids& made, const UprightFrame& frame) {
  std::vector<Weight> weights;
  weights.reserve(made.count());
  if (made.cells) {
    for (const CellVoid& piece : made.cells->voids)
      weights.push_back(weight_of(volume_moments(piece.surface), frame));
  } else {
    // A roof is above the middle of its ball.
    for (const Sphere& sphere : made.packing.spheres) {
      const Vec3d centre = frame.to_frame(sphere.centre);
      weights.push_back({void_volume(made.packing.limits.roof, sphere.radius), centre.x, centre.y});
    }
  }
  return weights;
}

// Less those voids it is what is left: so it has no channels and holes, nor what surfaces are inside their shapes, which are
// then there with any choice.
Weight solid_for(const Weight& left, std::span<const Weight> voids) {
  double volume = left.volume, x = left.volume * left.x, y = left.volume * left.y;
  for (const Weight& one : voids) {
    volume += one.volume;
    x += one.volume * one.x;
    y += one.volume * one.y;
  }
  return {volume, x / volume, y / volume};
}

std::vector<Weight> some_of(std::span<const Weight> voids, std::span<const std::uint32_t> chosen) {
  std::vector<Weight> some;
  some.reserve(chosen.size());
  for (const std::uint32_t i : chosen) some.push_back(voids[i]);
  return some;
}

std::string file_of(const PreparedModel& model) {
  return model.input.path.filename().string();
}

Footprint require_footprint(const PreparedModel& model, const UprightFrame& frame) {
  if (model.inspection.parts_overlap())
    throw UsageError(
        file_of(model) +
            ": --stand needs a centre of mass, which parts of the model that overlap do not have",
        "unite them with --surface remesh");
  auto footprint = footprint_of(frame.is_the_models_own() ? model.mesh : turned_upright(model.mesh, frame));
  if (!footprint)
    throw NothingToRemoveError(file_of(model) + ": --stand: the model stands on a tip or an edge, 0 mm wide",
                               "turn it with --up, or leave out --stand");
  return std::move(*footprint);
}

std::string in_words(double margin) {
  return fmt::format("{:.2f} mm {}", std::abs(margin), margin < 0 ? "outside of" : "inside");
}

// `best`: how far inside the centre of mass comes with any choice.
NothingToRemoveError cannot_stand(const PreparedModel& model, const StandFacts& facts, double best) {
  return NothingToRemoveError(
      fmt::format("{}: --stand {:g}: the centre of mass has to be {:.2f} mm inside what the model stands on; "
                  "it is {} that without voids, {} with all {}, and {} it with those chosen best, {:.2f} mm "
                  "too little",
                  file_of(model), facts.asked, facts.needed, in_words(facts.margin_before),
                  in_words(facts.margin_with_all), counted(facts.all_voids, "void", "voids"), in_words(best),
                  facts.needed - best),
      "give a smaller or negative margin, smaller voids (--max-radius) to choose from, or leave out --stand");
}

}  // namespace

double needed_margin(double before, double asked) {
  constexpr double kAsItStood = 0.99;
  const double stood = std::max(before, 0.0);
  return std::max(0.0, (asked > 0 ? 1 : kAsItStood) * stood + asked);
}

StandingChoice choose_standing(const Footprint& footprint, const Weight& solid, std::span<const Weight> voids,
                               double needed) {
  std::vector<std::uint32_t> order(voids.size());
  std::iota(order.begin(), order.end(), 0U);
  if (voids.size() <= kFew) return best_of_all(footprint, solid, voids, order, needed);
  std::ranges::stable_sort(
      order, [&](std::uint32_t a, std::uint32_t b) { return voids[a].volume > voids[b].volume; });
  StandingChoice choice = by_leaving_out(footprint, solid, voids, order, needed);
  if (choice.voids) return choice;
  StandingChoice of_few = best_of_all(footprint, solid, voids, std::span(order).first(kFew), needed);
  of_few.best_margin = std::max(of_few.best_margin, choice.best_margin);
  return of_few;
}

MadeVoids to_stand(const PreparedModel& model, double asked, Vec3d up, MadeVoids all,
                   const MakeSome& make_some, StandFacts& facts, Monitor& monitor) {
  const UprightFrame frame(up);
  const Footprint footprint = require_footprint(model, frame);
  const auto margin_of = [&](const Weight& weight) { return footprint.margin(weight.x, weight.y); };
  const Weight left_by_all = weight_of(volume_moments(all.carved.solid.mesh), frame);
  facts = {.asked = asked,
           .needed = 0,
           .margin_before = margin_of(weight_of(volume_moments(model.mesh), frame)),
           .margin_with_all = margin_of(left_by_all),
           .all_voids = all.count()};
  facts.needed = needed_margin(facts.margin_before, asked);
  std::optional<MadeVoids> best;
  double nearest = facts.margin_with_all;
  if (facts.margin_with_all >= facts.needed) {
    best = std::move(all);
  } else {
    const std::vector<Weight> voids = weights_of(all, frame);
    Weight solid = solid_for(left_by_all, voids);
    double best_left = kInfinity, aimed = facts.needed;
    std::set<std::vector<std::uint32_t>> tried;
    while (tried.size() < kMostTries) {
      const StandingChoice choice = choose_standing(footprint, solid, voids, aimed + kRoundingOfMargin);
      nearest = std::max(nearest, std::min(choice.best_margin, facts.needed));
      if (!choice.voids) break;
      const bool is_new = tried.insert(*choice.voids).second;
      if (!is_new && best) break;
      auto made = is_new ? attempt(make_some, *choice.voids, monitor) : std::nullopt;
      if (!made) {
        aimed += kStep * (1 + facts.needed);
        continue;
      }
      const Weight left = weight_of(volume_moments(made->carved.solid.mesh), frame);
      if (margin_of(left) >= facts.needed && left.volume < best_left) {
        best_left = left.volume;
        best = std::move(made);
      }
      // The next choice reckons with what this one showed: voids that do not drain without others, and tubes.
      solid = solid_for(left, some_of(voids, *choice.voids));
    }
  }
  if (!best) throw cannot_stand(model, facts, nearest);
  for (const std::string& text : best->notices) monitor.notice(text);
  return std::move(*best);
}

}  // namespace aerate
