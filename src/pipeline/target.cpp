#include "pipeline/target.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <numeric>
#include <string>
#include <utility>

#include "core/error.h"
#include "core/mesh.h"
#include "kernels/roof.h"
#include "pipeline/held_notices.h"

namespace aerate {
namespace {

// Results that are made for one target.
constexpr int kMostSealed = 6, kMostDrained = 10;

// A part of a stage, which does not begin others.
class Trial final : public Monitor {
 public:
  explicit Trial(Monitor& inner) : inner_(inner) {}

  void notice(std::string_view text) override { inner_.notice(text); }
  void check_interrupted() override { inner_.check_interrupted(); }

 private:
  Monitor& inner_;
};

double volume_before(const PreparedModel& model) {
  return model.inspection.parts_overlap() ? model.inspection.filled_volume : signed_volume(model.mesh);
}

double removed_by(const MadeVoids& made, const PreparedModel& model) {
  return signed_volume(model.mesh) - signed_volume(made.carved.solid.mesh);
}

std::vector<double> volumes_of(const MadeVoids& made) {
  std::vector<double> volumes;
  if (made.cells) {
    for (const CellVoid& piece : made.cells->voids) volumes.push_back(std::abs(signed_volume(piece.surface)));
  } else {
    for (const Sphere& sphere : made.packing.spheres)
      volumes.push_back(void_volume(made.packing.limits.roof, sphere.radius));
  }
  return volumes;
}

// What has to be removed, mm3.
double needed_for(const SavingTarget& target, const Material& material, double before) {
  if (target.kind == SavingTarget::Kind::share) return target.value * before;
  const double grams_per_mm3 = material.density_g_cm3 / 1000;
  const double needed = before - target.value / grams_per_mm3;
  if (needed > 0) return needed;
  throw UsageError(fmt::format("--target-mass {:g} g: the model has {:.4g} g without voids ({:g} g/cm3)",
                               target.value, before * grams_per_mm3, material.density_g_cm3),
                   "give less than that");
}

NothingToRemoveError out_of_reach(const SavingTarget& target, const Material& material,
                                  const std::string& file, double removed, double before, std::size_t count) {
  const std::string voids = count == 1 ? "the one void there is" : fmt::format("all {} voids", count);
  // Rounded so that what is said can be reached.
  const std::string what =
      target.kind == SavingTarget::Kind::share
          ? fmt::format("--target-saving {:g} %: {} save {:.2f} % at most", 100 * target.value, voids,
                        std::floor(1e4 * removed / before) / 100)
          : fmt::format("--target-mass {:g} g: with {} the model has {:.6g} g at least", target.value, voids,
                        std::ceil((before - removed) * material.density_g_cm3) / 1000);
  return NothingToRemoveError(
      file + ": " + what,
      "give that, a smaller --wall, --gap or --min-radius, or larger cells (--shape cells --max-voids 1)");
}

}  // namespace

std::optional<MadeVoids> attempt(const MakeSome& make_some, std::span<const std::uint32_t> voids,
                                 Monitor& monitor) {
  try {
    Trial trial(monitor);
    HeldNotices held(trial);
    MadeVoids made = make_some(voids, held);
    made.notices = held.take();
    return made;
  } catch (const NothingToRemoveError&) {
    return std::nullopt;
  }
}

std::vector<std::uint32_t> fewest_that_reach(std::span<const double> volumes, double sum) {
  std::vector<std::uint32_t> order(volumes.size());
  std::iota(order.begin(), order.end(), 0U);
  std::ranges::stable_sort(order, [&](std::uint32_t a, std::uint32_t b) { return volumes[a] > volumes[b]; });
  std::size_t count = 0;
  double before_last = 0, reached = 0;
  while (count < order.size() && reached < sum) {
    before_last = reached;
    reached += volumes[order[count++]];
  }
  if (count > 0 && reached >= sum) {
    std::size_t last = count - 1;
    while (last + 1 < order.size() && before_last + volumes[order[last + 1]] >= sum) ++last;
    std::swap(order[count - 1], order[last]);
  }
  order.resize(count);
  std::ranges::sort(order);
  return order;
}

MadeVoids to_target(const PreparedModel& model, const SavingTarget& target, const Material& material,
                    MadeVoids all, const MakeSome& make_some, TargetFacts& facts, Monitor& monitor) {
  const double before = volume_before(model), most = removed_by(all, model);
  facts = {target, all.count(), most};
  const double needed = needed_for(target, material, before);
  if (most < needed)
    throw out_of_reach(target, material, model.input.path.filename().string(), most, before, all.count());

  const std::vector<double> volumes = volumes_of(all);
  const double sum = std::accumulate(volumes.begin(), volumes.end(), 0.0);
  const bool drains = all.drainage.has_value();
  MadeVoids best = std::move(all);
  double best_removed = most;
  // Voids that add up to `low` were too few, to `high` they do.
  double low = needed, high = sum;
  double asked = needed;
  for (int tries = 0; tries < (drains ? kMostDrained : kMostSealed); ++tries) {
    const std::vector<std::uint32_t> chosen = fewest_that_reach(volumes, asked);
    if (chosen.size() == volumes.size()) break;
    auto made = attempt(make_some, chosen, monitor);
    const double removed = made ? removed_by(*made, model) : 0;
    if (removed >= needed) {
      if (removed < best_removed || made->count() < best.count()) {
        best = std::move(*made);
        best_removed = removed;
      }
      if (!drains || asked <= needed) break;
      high = asked;
    } else {
      low = asked;
    }
    // Surfaces of voids are a little inside them: sealed ones lack just that.
    asked = drains ? (low + high) / 2 : asked + (needed - removed) * (1 + 1e-9);
  }
  for (const std::string& text : best.notices) monitor.notice(text);
  return best;
}

}  // namespace aerate
