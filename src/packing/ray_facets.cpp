#include "packing/ray_facets.h"

#include <algorithm>
#include <cmath>
#include <tbb/parallel_for.h>

#include "kernels/constants.h"

namespace aerate {
namespace {

// Empty boxes are farther than any ray is long, without an overflow.
constexpr float kFar = 1e19F;

// After T. Moeller and B. Trumbore, "Fast, minimum storage ray/triangle intersection" (1997); infinite if it is not met.
double along_ray(Vec3d start, Vec3d direction, const kernels::Facet& facet) {
  const Vec3d a = to_double(facet.a);
  const Vec3d ab = to_double(facet.b) - a, ac = to_double(facet.c) - a;
  const Vec3d p = cross(direction, ac);
  const double determinant = dot(ab, p);
  if (determinant == 0) return kInfinity;
  const Vec3d from_a = start - a;
  const double u = dot(from_a, p) / determinant;
  if (!(u >= 0 && u <= 1)) return kInfinity;
  const Vec3d q = cross(from_a, ab);
  const double v = dot(direction, q) / determinant;
  const double t = dot(ac, q) / determinant;
  const bool is_met = v >= 0 && u + v <= 1 && t > 0;
  if (!is_met) return kInfinity;
  return t;
}

}  // namespace

struct RayFacets::Ray {
  Vec3f least, most;  // the start, less and more what fp32 may round coordinates by
  Vec3f per_length;   // 1 / direction

  Ray(Vec3d start, Vec3d direction, double largest) {
    const double error =
        std::ldexp(std::max({largest, std::abs(start.x), std::abs(start.y), std::abs(start.z)}), -21);
    const Vec3d around{error, error, error};
    least = to_float(start - around);
    most = to_float(start + around);
    // No axis along which the ray does not move at all.
    constexpr double kLeast = 1e-18;
    const auto inverse = [](double x) {
      return static_cast<float>(1 / (std::abs(x) < kLeast ? std::copysign(kLeast, x) : x));
    };
    per_length = {inverse(direction.x), inverse(direction.y), inverse(direction.z)};
  }
};

RayFacets::RayFacets(const kernels::TriangleBvhView& bvh) : bvh_(bvh) {
  if (bvh.facets.size == 0) return;
  int levels = 0;
  while ((bvh.first_leaf >> levels) > 1) ++levels;
  roots_ = levels % 2 == 0 ? 1 : 2;
  first_leaf_ = (bvh.first_leaf - 1) / 3;
  boxes_.resize(first_leaf_ + std::size_t{bvh.first_leaf});
  // Every other level of the hierarchy, from that of the leaves up.
  for (std::uint32_t first = bvh.first_leaf; first > 0; first /= 4) {
    const std::size_t at = (first - 1) / 3;
    tbb::parallel_for(std::size_t{0}, std::size_t{first}, [&](std::size_t i) {
      for (std::size_t child = 0; child < 4; ++child) {
        Box3f box = kernels::empty_box();
        if (first < bvh.first_leaf) {
          box = bvh.boxes[4 * (first + i) + child];
        } else if (4 * i + child < bvh.facets.size) {
          box = kernels::box_of(bvh.facets[4 * i + child]);
        }
        set_box(boxes_[at + i], child, box);
      }
    });
  }
  const Box3f& all = bvh.boxes[1];
  for (const Vec3f p : {all.lower, all.upper}) {
    const Vec3d q = to_double(p);
    largest_ = std::max({largest_, std::abs(q.x), std::abs(q.y), std::abs(q.z)});
  }
}

void RayFacets::set_box(Boxes& boxes, std::size_t i, const Box3f& box) const {
  const bool is_empty = box.lower.x > box.upper.x;
  boxes.lower_x[i] = is_empty ? kFar : box.lower.x;
  boxes.lower_y[i] = is_empty ? kFar : box.lower.y;
  boxes.lower_z[i] = is_empty ? kFar : box.lower.z;
  boxes.upper_x[i] = is_empty ? kFar : box.upper.x;
  boxes.upper_y[i] = is_empty ? kFar : box.upper.y;
  boxes.upper_z[i] = is_empty ? kFar : box.upper.z;
}

// Calls visit(facet) for those that may be met before `longest`, which may become less meanwhile.
template <typename Visit>
void RayFacets::walk(const Ray& ray, const double& longest, Visit visit) const {
  if (boxes_.empty()) return;
  // More than differences and products are rounded by.
  constexpr float kSlack = 1 + 2e-6F;
  constexpr double kLongest = 1e30;
  const auto smaller = [](Floats a, Floats b) { return a < b ? a : b; };
  const auto larger = [](Floats a, Floats b) { return a > b ? a : b; };
  std::array<Entry, 64> pending;  // three more for each level
  std::size_t count = 0;
  for (std::uint32_t root = 0; root < roots_; ++root) pending[count++] = {root, 0};
  while (count > 0) {
    const Entry entry = pending[--count];
    const float most = static_cast<float>(std::min(longest, kLongest)) * kSlack;
    if (entry.enters > most) continue;
    const Boxes& boxes = boxes_[entry.node];
    Floats enters{}, leaves = Floats{} + most;
    const auto clip = [&](Floats lower, Floats upper, float least, float greatest, float per_length) {
      const Floats a = (lower - greatest) * per_length, b = (upper - least) * per_length;
      enters = larger(enters, smaller(a, b));
      leaves = smaller(leaves, larger(a, b));
    };
    clip(boxes.lower_x, boxes.upper_x, ray.least.x, ray.most.x, ray.per_length.x);
    clip(boxes.lower_y, boxes.upper_y, ray.least.y, ray.most.y, ray.per_length.y);
    clip(boxes.lower_z, boxes.upper_z, ray.least.z, ray.most.z, ray.per_length.z);
    const Flags may_meet = enters <= leaves * kSlack;
    if (entry.node >= first_leaf_) {
      for (std::uint32_t i = 0; i < 4; ++i) {
        const std::uint32_t facet = 4 * (entry.node - first_leaf_) + i;
        if (may_meet[i] != 0 && facet < bvh_.facets.size && visit(facet)) return;
      }
      continue;
    }
    const std::size_t first = count;
    for (std::uint32_t i = 0; i < 4; ++i) {
      if (may_meet[i] == 0) continue;
      // The nearest last, to be looked at first.
      std::size_t place = count++;
      for (; place > first && pending[place - 1].enters < enters[i]; --place)
        pending[place] = pending[place - 1];
      pending[place] = {4 * entry.node + roots_ + i, enters[i]};
    }
  }
}

std::optional<RayFacets::Hit> RayFacets::first_hit(Vec3d start, Vec3d direction, double longest) const {
  Hit nearest{longest, kNone};
  walk(Ray(start, direction, largest_), nearest.along, [&](std::uint32_t i) {
    const double along = along_ray(start, direction, bvh_.facets[i]);
    if (along < nearest.along) nearest = {along, i};
    return false;
  });
  if (nearest.facet == kNone) return std::nullopt;
  return nearest;
}

bool RayFacets::is_hit(Vec3d start, Vec3d direction, double longest) const {
  bool is_met = false;
  walk(Ray(start, direction, largest_), longest, [&](std::uint32_t i) {
    is_met = along_ray(start, direction, bvh_.facets[i]) < longest;
    return is_met;
  });
  return is_met;
}

}  // namespace aerate
