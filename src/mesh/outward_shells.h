#pragma once

#include <optional>

#include "core/mesh.h"
#include "core/surface_index.h"
#include "kernels/winding.h"
#include "mesh/inspect.h"

namespace aerate {

// Those shells of a model that bound it outside: all but those of its own cavities.
class OutwardShells {
 public:
  // `surface` is the model's, and must outlive this.
  OutwardShells(const Mesh& model, const Inspection& inspection, const SurfaceIndex& surface);

  // Winding numbers about them: 0 outside of all. Valid while this object lives.
  const kernels::WindingView& winding() const;

 private:
  const SurfaceIndex& surface_;
  std::optional<kernels::HostWinding> own_;  // if the model has cavities
};

}  // namespace aerate
