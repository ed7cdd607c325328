#include "kernels/triangle_bvh.h"

#include "kernels/exec_cpu.h"
#include "kernels/winding.h"

namespace aerate::kernels {
namespace {

struct Distances {
  TriangleBvhView bvh;
  std::span<const Vec3d> points;
  View<double> distances;

  void operator()(std::size_t i) const {
    distances[i] = std::sqrt(bvh.nearest(points[i], kInfinity).distance_squared);
  }
};

}  // namespace

struct HostTriangleBvh::Impl {
  TbbExecutor executor;
  TriangleBvh<TbbExecutor> bvh;
};

HostTriangleBvh::HostTriangleBvh(std::span<const Vec3f> positions,
                                 std::span<const std::array<std::uint32_t, 3>> triangles)
    : impl_(std::make_unique<Impl>()) {
  const auto facets = gather_facets(impl_->executor, positions, triangles);
  const View<const Facet> view = facets.view();
  impl_->bvh = build_triangle_bvh(impl_->executor, view, bounding_box(view));
}

HostTriangleBvh::~HostTriangleBvh() = default;
HostTriangleBvh::HostTriangleBvh(HostTriangleBvh&&) noexcept = default;
HostTriangleBvh& HostTriangleBvh::operator=(HostTriangleBvh&&) noexcept = default;

const TriangleBvhView& HostTriangleBvh::view() const {
  return impl_->bvh.view;
}

std::vector<double> HostTriangleBvh::distances(std::span<const Vec3d> points) const {
  std::vector<double> result(points.size());
  impl_->executor.for_each_index(points.size(),
                                 Distances{impl_->bvh.view, points, {result.data(), result.size()}});
  return result;
}

}  // namespace aerate::kernels
