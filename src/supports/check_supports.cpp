#include "supports/check_supports.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <fmt/format.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_reduce.h>
#include <utility>
#include <vector>

#include "check/check_failure.h"
#include "core/error.h"
#include "core/facet_distance.h"
#include "core/surface_index.h"
#include "mesh/inspect.h"
#include "mesh/topology.h"
#include "printing/footing.h"
#include "supports/body_voxels.h"
#include "supports/pixels.h"

namespace aerate {
namespace {

// Columns are told apart to half of one on each side.
constexpr double kColumnsOff = 1.5;
// What of supports' own underside may be held by nothing: corners that smoothing leaves, mm2.
constexpr double kMostOwn = 5;
// Of coordinates in a file, mm.
constexpr double kRounding = 1e-3;

// For some models nothing can be made that stands.
template <typename... Arguments>
[[noreturn]] void fail_to_stand(fmt::format_string<Arguments...> why, Arguments&&... arguments) {
  throw MeshError(
      "no supports were found that stand: " + fmt::format(why, std::forward<Arguments>(arguments)...),
      "print it another way --up, give a larger --stem, or let the slicer make supports there");
}

double least_distance(const Mesh& mesh, std::size_t first, std::size_t end, const SurfaceIndex& model,
                      double limit) {
  return tbb::parallel_reduce(
      tbb::blocked_range<std::size_t>(first, end), limit,
      [&](const tbb::blocked_range<std::size_t>& range, double least) {
        for (std::size_t i = range.begin(); i < range.end(); ++i)
          least = std::min(least, distance_to_surface(facet_of(mesh, mesh.triangles[i]), model.bvh(), least));
        return least;
      },
      [](double a, double b) { return std::min(a, b); });
}

void require_sound(const Mesh& mesh, bool has_voids) {
  const Inspection inspection = inspect(mesh);
  if (!inspection.closed())
    fail_check("{} of its edges are open and {} misoriented", inspection.open_edges,
               inspection.misoriented_edges);
  const auto inward =
      std::ranges::count_if(inspection.shells, [](const Shell& shell) { return shell.volume <= 0; });
  if (inward > 0 && !has_voids) fail_check("{} of its shells face inward", inward);
}

void require_above_plate(const Mesh& mesh, double plate) {
  for (const Vec3f& p : mesh.positions) {
    if (!std::isfinite(p.x) || !std::isfinite(p.y) || !(static_cast<double>(p.z) >= plate - kRounding))
      fail_check("it reaches below the plate, to ({:.2f}, {:.2f}, {:.2f}) mm", p.x, p.y, p.z);
  }
}

void require_outside(const Mesh& mesh, std::span<const Triangle> triangles, const kernels::WindingView& model,
                     const char* what) {
  for (const Triangle& t : triangles) {
    const Vec3d at = to_double(mesh.positions[t[0]]);
    if (model.winding_number(at) != 0)
      fail_check("{} is within the model at ({:.2f}, {:.2f}, {:.2f}) mm", what, at.x, at.y, at.z);
  }
}

// Of the model at a place beside the middle of a column.
double ceiling_near(const kernels::WindingView& model, double x, double y, double z, double nearest) {
  double best = z;
  for (const AirSpan& span : air_spans_at(model, x, y)) {
    if (std::abs(span.ceiling - z) > nearest) continue;
    best = span.ceiling;
    nearest = std::abs(span.ceiling - z);
  }
  return best;
}

// Whether something of a solid, given by its spans at a place, is so near below the model there, whose ceiling is about at `z`.
bool is_touched(const kernels::WindingView& model, double x, double y, double z, double nearest,
                const std::vector<AirSpan>& solid, double within) {
  std::optional<double> ceiling;
  for (std::size_t k = 0; k + 1 < solid.size(); ++k) {
    const double bottom = solid[k].ceiling, top = solid[k + 1].floor;
    if (bottom >= z || top < z - nearest - within) continue;
    if (!ceiling) ceiling = ceiling_near(model, x, y, z, nearest);
    if (top >= *ceiling - within) return true;
  }
  return false;
}

// Where the model keeps a body from tipping over: it stands there, or leans on a slope of the model that is too steep for teeth.
class HeldByModel {
 public:
  HeldByModel(const Undersides& columns, double clearance)
      : columns_(columns),
        clearance_(clearance),
        // Voxels are cut by the clearance, and smoothed.
        beside_(disc_of(clearance / columns.spacing + 1.5)) {}

  bool stands(Vec3d at) const {
    const auto column = columns_.column_at(at.x, at.y);
    return column && stands_on_model(columns_, *column, at.z, clearance_);
  }

  bool stands_or_leans(Vec3d at) const {
    if (stands(at)) return true;
    const auto column = columns_.column_at(at.x, at.y);
    if (!column || !std::isfinite(columns_.height_above_model(*column, at.z))) return false;
    return std::ranges::any_of(beside_, [&](std::pair<int, int> step) {
      const auto other =
          columns_.column_at(at.x + step.first * columns_.spacing, at.y + step.second * columns_.spacing);
      return other && columns_.is_solid(*other, at.z);
    });
  }

 private:
  const Undersides& columns_;
  double clearance_;
  std::vector<std::pair<int, int>> beside_;
};

}  // namespace

std::optional<double> least_footing_margin(const Mesh& mesh, std::span<const Triangle> body,
                                           const Undersides& columns, double clearance) {
  const double on_plate = columns.spacing / 2;  // by which smoothing rounds what stands there
  const Mesh alone = submesh(mesh, body);
  const EdgeUses uses(alone);
  const ShellLabels labels = label_shells(alone, uses);
  std::vector<std::vector<Triangle>> shells(labels.count);
  for (std::size_t i = 0; i < alone.triangles.size(); ++i)
    shells[labels.of_triangle[i]].push_back(alone.triangles[i]);
  const HeldByModel held(columns, clearance);
  std::optional<double> least;
  for (const std::vector<Triangle>& triangles : shells) {
    const Mesh shell = submesh(alone, triangles);
    const bool is_on_plate = static_cast<double>(bounding_box(shell).lower.z) <= columns.plate + 0.01;
    const VolumeMoments moments = volume_moments(shell);
    if (moments.volume <= 0) continue;  // a void in a body
    if (!is_on_plate) {
      const auto stands = [&](const Vec3f& p) { return held.stands(to_double(p)); };
      if (std::ranges::none_of(shell.positions, stands)) least = -kInfinity;
      continue;
    }
    std::vector<Footprint::Point> feet;
    for (const Vec3f& p : shell.positions) {
      const Vec3d at = to_double(p);
      if (at.z <= columns.plate + on_plate || held.stands_or_leans(at)) feet.push_back({at.x, at.y});
    }
    const Vec3d centre = moments.first_moment * (1 / moments.volume);
    const std::optional<Footprint> foot = footprint_around(std::move(feet));
    least = std::min(least.value_or(kInfinity), foot ? foot->margin(centre.x, centre.y) : -1);
  }
  return least;
}

void measure_contact(const kernels::WindingView& solid, const kernels::WindingView& model,
                     const Undersides& columns, double within, double reach, SupportFacts& facts) {
  constexpr int kSamples = 3;  // of a column, along each side
  const std::size_t count = columns.spans.size();
  std::vector<std::uint8_t> touched(count, 0);  // samples of each column
  tbb::parallel_for(std::size_t{0}, columns.first.size() - 1, [&](std::size_t column) {
    const std::uint32_t first = columns.first[column], end = columns.first[column + 1];
    const auto is_ceiling = [&](std::uint32_t i) {
      return columns.hold[i] != Hold::none && columns.spans[i].ceiling > columns.plate + within;
    };
    bool is_any = false;
    for (std::uint32_t i = first; i < end; ++i) is_any = is_any || is_ceiling(i);
    if (!is_any) return;
    const double middle_x = columns.x_at(static_cast<std::uint32_t>(column % columns.count_x));
    const double middle_y = columns.y_at(static_cast<std::uint32_t>(column / columns.count_x));
    for (int sx = 0; sx < kSamples; ++sx) {
      for (int sy = 0; sy < kSamples; ++sy) {
        const double x = middle_x + ((sx + 0.5) / kSamples - 0.5) * columns.spacing;
        const double y = middle_y + ((sy + 0.5) / kSamples - 0.5) * columns.spacing;
        const std::vector<AirSpan> spans = air_spans_at(solid, x, y);
        for (std::uint32_t i = first; i < end; ++i) {
          if (is_ceiling(i) &&
              is_touched(model, x, y, columns.spans[i].ceiling, 2 * columns.spacing, spans, within))
            ++touched[i];
        }
      }
    }
  });
  std::vector<std::uint8_t> is_held(count, 0);
  for (std::size_t i = 0; i < count; ++i) {
    // The plate is as near as supports would be.
    const bool is_on_plate =
        columns.hold[i] != Hold::none && columns.spans[i].ceiling <= columns.plate + within;
    is_held[i] = touched[i] > 0 || is_on_plate ? 1 : 0;
  }
  std::vector<Holder> held;
  facts.contact_area = 0;
  for (std::uint32_t i = 0; i < count; ++i) {
    facts.contact_area += columns.area() * touched[i] / (kSamples * kSamples);
    if (is_held[i] != 0) held.push_back(holder_in(columns, i));
  }
  const std::vector<double> distances = distances_from_hold(columns, held);
  facts.farthest = 0;
  facts.farthest_place.reset();
  facts.unsupported_area = 0;
  const auto look_at = [&](std::uint32_t span, double distance) {
    if (distance > reach + kColumnsOff * columns.spacing) facts.unsupported_area += columns.area();
    if (distance <= facts.farthest) return;
    facts.farthest = distance;
    facts.farthest_place = columns.place(span);
  };
  for (std::uint32_t i = 0; i < count; ++i) {
    if (columns.hold[i] == Hold::bridge) look_at(i, distances[i]);
  }
  for (const std::uint32_t tip : columns.tips) {
    if (columns.hold[tip] != Hold::bridge) look_at(tip, distances[tip]);
  }
}

SupportFacts check_supports(const Mesh& written, std::size_t body_triangles, const SurfaceIndex& model,
                            const Undersides& columns, const SupportRules& rules, const SupportShape& shape,
                            bool has_voids, Monitor& monitor) {
  require_sound(written, has_voids);
  require_above_plate(written, columns.plate);
  monitor.check_interrupted();
  SupportFacts facts;
  facts.triangle_count = written.triangles.size();
  const auto body = std::span(written.triangles).first(body_triangles);
  const auto teeth = std::span(written.triangles).subspan(body_triangles);
  const double limit = 2 * shape.body.clearance;
  if (!body.empty()) {
    require_outside(written, body, model.winding(), "the body");
    facts.volume = volume_moments(written, body, Vec3d{0, 0, columns.plate}).volume;
    facts.body_distance = least_distance(written, 0, body_triangles, model, limit);
    if (facts.body_distance < shape.body.clearance - kClearanceTolerance - kRounding)
      fail_check("the body is {:.3g} mm from the model, {:.3g} mm were asked for", facts.body_distance,
                 shape.body.clearance);
    facts.footing_margin = least_footing_margin(written, body, columns, shape.body.clearance);
    // What is joined to the model and to the plate cannot tip.
    if (shape.tooth.gap > 0 && facts.footing_margin && *facts.footing_margin < 0 &&
        std::isfinite(*facts.footing_margin))
      fail_to_stand("a body tips over: its centre of mass is {:.2f} mm outside of its foot",
                    -*facts.footing_margin);
  }
  monitor.check_interrupted();
  if (shape.tooth.gap > 0) {
    require_outside(written, teeth, model.winding(), "a tooth");
    facts.tooth_distance =
        least_distance(written, body_triangles, written.triangles.size(), model, 2 * shape.tooth.gap);
    // Gaps are measured along up: across a slope they are narrower.
    constexpr double kLeastShare = 0.3;
    if (facts.tooth_distance < kLeastShare * shape.tooth.gap)
      fail_check("a tooth is {:.3g} mm from the model, the gap is {:.3g} mm", facts.tooth_distance,
                 shape.tooth.gap);
  }
  monitor.check_interrupted();
  const kernels::HostWinding solid(written.positions, written.triangles);
  measure_contact(solid.view(), model.winding(), columns, shape.tooth.gap + rules.layer / 2, rules.reach,
                  facts);
  if (!has_voids) {
    const Undersides own = find_undersides(written, solid.view(), rules, columns.plate, columns.spacing);
    SupportFacts of_own;
    measure_contact(model.winding(), solid.view(), own, shape.tooth.gap + rules.layer / 2, rules.reach,
                    of_own);
    facts.own_unsupported_area = of_own.unsupported_area;
    if (of_own.unsupported_area > kMostOwn) {
      const Vec3d at = *of_own.farthest_place;
      fail_to_stand("{:.1f} mm2 of their own underside are held by nothing, near ({:.2f}, {:.2f}, {:.2f}) mm",
                    of_own.unsupported_area, at.x, at.y, at.z);
    }
  }
  if (shape.tooth.gap > 0 && facts.footing_margin == -kInfinity)
    fail_to_stand("a body has nothing to stand on: it ends above the model, which is too steep there");
  return facts;
}

}  // namespace aerate
