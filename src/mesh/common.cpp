#include "mesh/common.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <tbb/parallel_for.h>
#include <utility>
#include <vector>

#include "core/facet_distance.h"
#include "kernels/constants.h"
#include "mesh/line_crossings.h"
#include "mesh/r2_sequence.h"

namespace aerate {
namespace {

// Triangles this near to each other may be taken to meet, mm.
constexpr double kMeeting = 1e-6;

using Corners = std::array<Vec3f, 3>;

Vec3d middle_of(const Corners& corners) {
  return (to_double(corners[0]) + to_double(corners[1]) + to_double(corners[2])) * (1.0 / 3);
}

bool is_near(Vec3d p, const SurfaceIndex& model, double distance) {
  return model.bvh().nearest(p, distance * distance).facet != kNone;
}

// Whether a piece that the surface passes is not cut any further: for being small, or for lying in the surface.
bool is_last(const Corners& corners, const SurfaceIndex& model, double precision) {
  const Vec3d a = to_double(corners[0]), b = to_double(corners[1]), c = to_double(corners[2]);
  const double longest = std::max({length_squared(b - a), length_squared(c - b), length_squared(a - c)});
  if (longest <= precision * precision) return true;
  return is_near(middle_of(corners), model, precision) &&
         std::ranges::all_of(corners, [&](Vec3f p) { return is_near(to_double(p), model, precision); });
}

// In two, at the middle of the longest edge.
std::array<Corners, 2> halves_of(const Corners& corners) {
  const auto edge = [&](std::size_t i) {
    return length_squared(to_double(corners[(i + 1) % 3]) - to_double(corners[i]));
  };
  std::size_t longest = 0;
  for (const std::size_t i : {std::size_t{1}, std::size_t{2}})
    if (edge(i) > edge(longest)) longest = i;
  const Vec3f a = corners[longest], b = corners[(longest + 1) % 3], c = corners[(longest + 2) % 3];
  const Vec3f middle = to_float((to_double(a) + to_double(b)) * 0.5);
  return {Corners{a, middle, c}, Corners{middle, b, c}};
}

void add_within(const Corners& whole, const SurfaceIndex& model, double precision,
                std::vector<Corners>& found) {
  std::vector<Corners> open{whole};
  while (!open.empty()) {
    const Corners corners = open.back();
    open.pop_back();
    const kernels::Facet facet{corners[0], corners[1], corners[2]};
    if (distance_to_surface(facet, model.bvh(), kMeeting) >= kMeeting) {
      if (model.winding().winding_number(middle_of(corners)) != 0) found.push_back(corners);
    } else if (is_last(corners, model, precision)) {
      found.push_back(corners);
    } else {
      for (const Corners& half : halves_of(corners)) open.push_back(half);
    }
  }
}

// How much of a line is in the first two bodies, and in none of the others.
double common_length(std::span<const kernels::WindingView> bodies, double x, double y) {
  std::vector<std::pair<LineCrossing, std::size_t>> crossings;
  for (std::size_t body = 0; body < bodies.size(); ++body)
    for_each_crossing(bodies[body], x, y,
                      [&](const LineCrossing& crossing) { crossings.emplace_back(crossing, body); });
  std::ranges::sort(crossings, {}, [](const auto& crossing) { return crossing.first.z; });
  std::vector<int> windings(bodies.size(), 0);
  double sum = 0;
  for (std::size_t i = 0; i + 1 < crossings.size(); ++i) {
    windings[crossings[i].second] -= crossings[i].first.sign;
    const bool is_common = windings[0] != 0 && windings[1] != 0 &&
                           std::all_of(windings.begin() + 2, windings.end(), [](int w) { return w == 0; });
    if (is_common) sum += crossings[i + 1].first.z - crossings[i].first.z;
  }
  return sum;
}

}  // namespace

Mesh surface_within(const Mesh& mesh, const SurfaceIndex& model, double precision) {
  std::vector<std::vector<Corners>> found(mesh.triangles.size());
  tbb::parallel_for(std::size_t{0}, found.size(), [&](std::size_t i) {
    const kernels::Facet facet = facet_of(mesh, mesh.triangles[i]);
    add_within({facet.a, facet.b, facet.c}, model, precision, found[i]);
  });
  Mesh within;
  for (const std::vector<Corners>& pieces : found) {
    for (const Corners& corners : pieces) {
      const auto first = static_cast<std::uint32_t>(within.positions.size());
      within.positions.insert(within.positions.end(), corners.begin(), corners.end());
      within.triangles.push_back({first, first + 1, first + 2});
    }
  }
  return within;
}

double common_volume(const kernels::WindingView& body, const kernels::WindingView& model,
                     std::span<const kernels::WindingView> others) {
  std::vector<kernels::WindingView> bodies{body, model};
  bodies.insert(bodies.end(), others.begin(), others.end());
  const Vec3d lower = max_of(body.box.lower, model.box.lower);
  const Vec3d size = min_of(body.box.upper, model.box.upper) - lower;
  if (!(size.x > 0 && size.y > 0 && size.z > 0)) return 0;
  constexpr std::size_t kBlocks = 256, kLinesPerBlock = 128;
  std::vector<double> sums(kBlocks, 0);
  tbb::parallel_for(std::size_t{0}, kBlocks, [&](std::size_t block) {
    for (std::size_t i = block * kLinesPerBlock; i < (block + 1) * kLinesPerBlock; ++i) {
      const auto [x, y] = r2_point(i, 0.5);
      sums[block] += common_length(bodies, lower.x + size.x * x, lower.y + size.y * y);
    }
  });
  double sum = 0;
  for (const double block : sums) sum += block;
  return sum * size.x * size.y / static_cast<double>(kBlocks * kLinesPerBlock);
}

}  // namespace aerate
