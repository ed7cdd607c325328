#include "kernels/winding.h"

#include <memory>
#include <utility>

#include "kernels/exec_cpu.h"

namespace aerate::kernels {

Box3d bounding_box(View<const Facet> facets) {
  Box3f box = empty_box();
  for (std::size_t i = 0; i < facets.size; ++i) box = united(box, box_of(facets[i]));
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

}  // namespace aerate::kernels
