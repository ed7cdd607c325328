#include <CGAL/Box_intersection_d/Box_with_info_d.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/box_intersection_d.h>
#include <algorithm>
#include <array>
#include <cstdint>
#include <tbb/blocked_range.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>
#include <utility>
#include <vector>

#include "mesh/inspect.h"
#include "mesh/topology.h"

namespace aerate {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Point = Kernel::Point_3;
using Box = CGAL::Box_intersection_d::Box_with_info_d<double, 3, std::uint32_t>;
using Pair = std::pair<std::uint32_t, std::uint32_t>;

constexpr std::size_t kPlaces = 8;
constexpr std::size_t kBatch = std::size_t{1} << 18;

class IntersectionTest {
 public:
  explicit IntersectionTest(const Mesh& mesh) : mesh_(mesh) {}

  Point point(std::uint32_t vertex) const {
    const Vec3d p = to_double(mesh_.positions[vertex]);
    return {p.x, p.y, p.z};
  }

  // Whether the triangles have a point in common that is not on a vertex or an edge that they share.
  bool operator()(const Pair& pair) const {
    Triangle a = mesh_.triangles[pair.first];
    Triangle b = mesh_.triangles[pair.second];
    switch (bring_shared_vertices_to_front(a, b)) {
      case 0:
        return CGAL::do_intersect(triangle(a), triangle(b));
      case 1:
        // Beside the shared corner, an intersection ends at the opposite side of one of the two.
        return CGAL::do_intersect(triangle(a), opposite_side(b)) ||
               CGAL::do_intersect(triangle(b), opposite_side(a));
      case 2:
        // Folded onto each other: coplanar, and on the same side of the shared edge.
        return CGAL::coplanar(point(a[0]), point(a[1]), point(a[2]), point(b[2])) &&
               CGAL::coplanar_orientation(point(a[0]), point(a[1]), point(a[2]), point(b[2])) ==
                   CGAL::POSITIVE;
      default:
        return true;  // the same three corners
    }
  }

  Vec3d centre(const Pair& pair) const {
    Vec3d sum{0, 0, 0};
    for (const std::uint32_t triangle : {pair.first, pair.second}) {
      for (const std::uint32_t vertex : mesh_.triangles[triangle])
        sum = sum + to_double(mesh_.positions[vertex]);
    }
    return sum * (1.0 / 6.0);
  }

 private:
  static std::size_t bring_shared_vertices_to_front(Triangle& a, Triangle& b) {
    std::size_t shared = 0;
    for (std::size_t i = 0; i < 3; ++i) {
      for (std::size_t j = shared; j < 3; ++j) {
        if (a[i] != b[j]) continue;
        std::swap(a[shared], a[i]);
        std::swap(b[shared], b[j]);
        ++shared;
        break;
      }
    }
    return shared;
  }

  Kernel::Triangle_3 triangle(const Triangle& t) const { return {point(t[0]), point(t[1]), point(t[2])}; }
  Kernel::Segment_3 opposite_side(const Triangle& t) const { return {point(t[1]), point(t[2])}; }

  const Mesh& mesh_;
};

// Tests candidates in batches, on all threads, and keeps the first few pairs that intersect.
class Collector {
 public:
  explicit Collector(const IntersectionTest& test) : test_(test) { batch_.reserve(kBatch); }

  void add(std::uint32_t a, std::uint32_t b) {
    batch_.emplace_back(std::min(a, b), std::max(a, b));
    if (batch_.size() == kBatch) flush();
  }

  SelfIntersections finish() {
    flush();
    SelfIntersections result;
    result.pair_count = count_;
    for (const Pair& pair : first_) result.places.push_back(test_.centre(pair));
    return result;
  }

 private:
  void flush() {
    tbb::enumerable_thread_specific<std::vector<Pair>> found;
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, batch_.size(), 512),
                      [&](const tbb::blocked_range<std::size_t>& range) {
                        std::vector<Pair>& mine = found.local();
                        for (std::size_t i = range.begin(); i != range.end(); ++i) {
                          if (test_(batch_[i])) mine.push_back(batch_[i]);
                        }
                      });
    for (const std::vector<Pair>& some : found) {
      count_ += some.size();
      first_.insert(first_.end(), some.begin(), some.end());
    }
    std::sort(first_.begin(), first_.end());
    if (first_.size() > kPlaces) first_.resize(kPlaces);
    batch_.clear();
  }

  const IntersectionTest& test_;
  std::vector<Pair> batch_, first_;
  std::size_t count_ = 0;
};

}  // namespace

SelfIntersections find_self_intersections(const Mesh& mesh) {
  const IntersectionTest test(mesh);
  std::vector<Box> boxes;
  boxes.reserve(mesh.triangles.size());
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const Triangle& triangle = mesh.triangles[t];
    if (has_no_area(mesh, triangle)) continue;
    boxes.emplace_back(
        test.point(triangle[0]).bbox() + test.point(triangle[1]).bbox() + test.point(triangle[2]).bbox(),
        static_cast<std::uint32_t>(t));
  }
  Collector collector(test);
  std::vector<const Box*> order;
  order.reserve(boxes.size());
  for (const Box& box : boxes) order.push_back(&box);
  CGAL::box_self_intersection_d(
      order.begin(), order.end(), [&](const Box* a, const Box* b) { collector.add(a->info(), b->info()); },
      std::ptrdiff_t{2000});
  return collector.finish();
}

}  // namespace aerate
