#include "kernels/winding.h"

#include <limits>
#include <memory>
#include <utility>

#include "kernels/exec_cpu.h"

namespace aerate::kernels {
namespace {

struct QueryWinding {
  WindingView winding;
  View<const Vec3d> points;
  View<int> numbers;

  void operator()(std::size_t i) const { numbers[i] = winding.winding_number(points[i]); }
};

}  // namespace

Box3d bounding_box(View<const Facet> facets) {
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  Box3f box{{kInfinity, kInfinity, kInfinity}, {-kInfinity, -kInfinity, -kInfinity}};
  for (std::size_t i = 0; i < facets.size; ++i) {
    box.lower = min_of(box.lower, min_of(facets[i].a, min_of(facets[i].b, facets[i].c)));
    box.upper = max_of(box.upper, max_of(facets[i].a, max_of(facets[i].b, facets[i].c)));
  }
  return {to_double(box.lower), to_double(box.upper)};
}

struct HostWinding::Impl {
  TbbExecutor executor;
  HostBuffer<Facet> facets;  // if they are its own
  WindingIndex<TbbExecutor> index;
};

HostWinding::HostWinding(View<const Facet> facets) : impl_(std::make_unique<Impl>()) {
  impl_->index = build_winding_index(impl_->executor, facets, bounding_box(facets));
}

HostWinding::HostWinding(std::span<const Vec3f> positions,
                         std::span<const std::array<std::uint32_t, 3>> triangles)
    : impl_(std::make_unique<Impl>()) {
  impl_->facets = gather_facets(impl_->executor, positions, triangles);
  const View<const Facet> facets = std::as_const(impl_->facets).view();
  impl_->index = build_winding_index(impl_->executor, facets, bounding_box(facets));
}

HostWinding::~HostWinding() = default;
HostWinding::HostWinding(HostWinding&&) noexcept = default;
HostWinding& HostWinding::operator=(HostWinding&&) noexcept = default;

const WindingView& HostWinding::view() const {
  return impl_->index.view;
}

std::vector<int> HostWinding::winding_numbers(std::span<const Vec3d> points) const {
  std::vector<int> numbers(points.size());
  impl_->executor.for_each_index(
      points.size(),
      QueryWinding{impl_->index.view, {points.data(), points.size()}, {numbers.data(), numbers.size()}});
  return numbers;
}

}  // namespace aerate::kernels
