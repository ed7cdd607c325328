#include "pipeline/estimate.h"

#include <algorithm>
#include <cmath>

#include "core/surface_index.h"

namespace aerate {
namespace {

// Enough for a share to be within a percent or so.
constexpr std::size_t kPoints = 8000;
constexpr std::size_t kMostTries = 400'000;

// Point i of the R3 sequence, which fills a cube evenly as the R2 sequence fills a square (mesh/r2_sequence.h).
Vec3d r3_point(std::size_t i) {
  const auto fraction = [&](double step) {
    const double value = 0.5 + step * static_cast<double>(i);
    return value - std::floor(value);
  };
  return {fraction(0.8191725133961645), fraction(0.6710436067037893), fraction(0.5497004779019703)};
}

// What voids took of what is deeper than the wall, in percent over models of many shapes: bench/bench_estimate has them.
struct Taken {
  bool is_of_cells, drains, has_roofs;
  ShareRange share;
};
constexpr Taken kTaken[] = {
    {false, false, false, {0.35, 0.85}}, {false, false, true, {0.35, 0.85}}, {false, true, false, {0.3, 0.8}},
    {false, true, true, {0.3, 0.8}},     {true, false, false, {0.6, 1}},     {true, false, true, {0.5, 0.95}},
    {true, true, false, {0.6, 1.02}},    {true, true, true, {0.3, 0.9}},
};

ShareRange taken_by(const HollowOptions& options) {
  const bool has_roofs = options.packing.limits().roof.limits_ceilings();
  for (const Taken& taken : kTaken)
    if (taken.is_of_cells == options.cells.has_value() && taken.drains == options.drainage.has_value() &&
        taken.has_roofs == has_roofs)
      return taken.share;
  return {0, 1};
}

double length_factor(const LoadOptions& load) {
  return load.unit ? millimetres_per(*load.unit) : 1;
}

// A job that says how much it removes takes whole voids until that is reached.
ShareRange within_target(ShareRange range, const HollowOptions& options, double volume) {
  constexpr double kMoreThanAsked = 1.5;
  const auto& target = options.target;
  if (!target) return range;
  const double grams = volume * options.material.density_g_cm3 / 1000;
  const double share =
      target->kind == SavingTarget::Kind::share ? target->value : std::max(0.0, 1 - target->value / grams);
  return {std::min(share, range.to), std::min(kMoreThanAsked * share, range.to)};
}

}  // namespace

DepthSamples sample_depths(const Mesh& mesh, double volume) {
  DepthSamples samples{volume, {}};
  const Box3f box = bounding_box(mesh);
  const Vec3d low = to_double(box.lower), size = to_double(box.upper) - low;
  const SurfaceIndex surface(mesh);
  std::vector<Vec3d> inside;
  inside.reserve(kPoints);
  for (std::size_t i = 0; i < kMostTries && inside.size() < kPoints; ++i) {
    const Vec3d at = r3_point(i);
    const Vec3d point = low + Vec3d{at.x * size.x, at.y * size.y, at.z * size.z};
    if (surface.winding().winding_number(point) != 0) inside.push_back(point);
  }
  samples.depths = surface.distances(inside);
  std::ranges::sort(samples.depths);
  return samples;
}

double share_deeper(const DepthSamples& samples, double depth) {
  if (samples.depths.empty()) return 0;
  const auto first = std::ranges::upper_bound(samples.depths, depth);
  return static_cast<double>(samples.depths.end() - first) / static_cast<double>(samples.depths.size());
}

JobEstimate estimate_job(const DepthSamples& samples, std::span<const JobForm> forms) {
  const HollowOptions& first = forms.front().options;
  const Vec3d scale = first.load.scale;
  const double unit = length_factor(first.load);
  const auto [least, most] = std::minmax({unit * scale.x, unit * scale.y, unit * scale.z});
  JobEstimate estimate;
  estimate.solid_volume = samples.volume * unit * unit * unit * scale.x * scale.y * scale.z;
  bool is_first = true;
  for (const JobForm& form : forms) {
    const PackingLimits limits = form.options.packing.limits();
    const ShareRange deeper{share_deeper(samples, limits.wall / least),
                            share_deeper(samples, limits.wall / most)};
    // Without room for the smallest void there is none.
    const bool may_be_some = share_deeper(samples, (limits.wall + limits.min_radius) / most) > 0;
    const bool is_sure = share_deeper(samples, (limits.wall + limits.min_radius) / least) > 0;
    const ShareRange taken = taken_by(form.options);
    const bool is_limited = form.options.packing.stop.max_count != PackingStop{}.max_count ||
                            !form.options.keep_solid.empty() || form.options.stand;
    const ShareRange removed{is_sure && !is_limited ? taken.from * deeper.from : 0,
                             may_be_some ? taken.to * deeper.to : 0};
    if (is_first) estimate.deeper = deeper;
    if (is_first || form.tried == FormTrial::always || form.tried == FormTrial::for_more_volume)
      estimate.removed = is_first ? removed
                                  : ShareRange{std::min(estimate.removed.from, removed.from),
                                               std::max(estimate.removed.to, removed.to)};
    is_first = false;
  }
  estimate.removed = within_target(estimate.removed, first, estimate.solid_volume);
  return estimate;
}

}  // namespace aerate
