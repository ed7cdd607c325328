#include "check/outer_surface.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "check/check_failure.h"
#include "check/measure_errors.h"
#include "check/same_triangles.h"
#include "check/tube_cut.h"

namespace aerate {
namespace {

// Triangles are cut that are a thousandth of a millimetre beyond a hole's prism.
constexpr double kCutMargin = 2e-3;

// The model's triangles that are not in the outer part, ascending: all others are, in their order.
std::vector<std::uint32_t> find_cut(const Mesh& read_back, const Mesh& model, std::size_t kept_count,
                                    Monitor& monitor) {
  const std::size_t most = std::min(kept_count, model.triangles.size());
  std::size_t kept = find_difference(read_back, model, most, monitor);
  std::vector<std::uint32_t> cut;
  for (std::size_t i = kept; i < model.triangles.size(); ++i) {
    if (kept < kept_count && has_same_corners(read_back, kept, model, i)) {
      ++kept;
    } else {
      cut.push_back(static_cast<std::uint32_t>(i));
    }
  }
  if (kept != kept_count) fail_check("triangle {} is not the one of the model", kept);
  return cut;
}

bool is_at_hole(const kernels::Facet& facet, const Expected& expected) {
  if (expected.drainage == nullptr) return false;
  const std::vector<EscapeHole>& holes = expected.drainage->holes;
  return std::any_of(holes.begin(), holes.end(), [&](const EscapeHole& hole) {
    return distance_to_facet(cut_of(hole.tube), facet) < hole.tube.radius + kCutMargin;
  });
}

void require_remnants_on_surface(const Mesh& read_back, const Expected& expected) {
  std::vector<Vec3d> corners;
  for (const SolidPart& part : expected.solid.of(PartKind::remnant))
    for (const Triangle& t : triangles_of(read_back, part))
      for (const std::uint32_t v : t) corners.push_back(to_double(read_back.positions[v]));
  double farthest = 0;
  for (const double distance : expected.surface.distances(corners)) farthest = std::max(farthest, distance);
  if (farthest > kRoundingShare * std::max(1.0, largest_coordinate(expected.model)))
    fail_check("the outer surface beside a hole is {:.3g} mm from the model's", farthest);
}

}  // namespace

std::size_t check_outer_surface(const Mesh& read_back, const Expected& expected, Monitor& monitor) {
  if (!expected.inspection.closed()) fail_check("the outer surface is not closed");
  const std::size_t kept_count = expected.solid.of(PartKind::outer).front().triangle_count;
  const std::vector<std::uint32_t> cut = find_cut(read_back, expected.model, kept_count, monitor);
  for (const std::uint32_t i : cut) {
    if (!is_at_hole(facet_of(expected.model, expected.model.triangles[i]), expected))
      fail_check("triangle {} of the model was cut away from every escape hole", i);
  }
  require_remnants_on_surface(read_back, expected);
  return cut.size();
}

}  // namespace aerate
