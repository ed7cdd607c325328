#pragma once

#include <cstddef>
#include <optional>
#include <span>

#include "core/mesh.h"
#include "core/monitor.h"
#include "core/surface_index.h"
#include "kernels/winding.h"
#include "supports/make_supports.h"

namespace aerate {

// What was measured on supports that were read back, beside their model.
struct SupportFacts {
  std::size_t triangle_count = 0;
  double volume = 0;        // of the body, mm3
  double contact_area = 0;  // of the model's underside, nearer to supports than the gap and half a layer, mm2
  double farthest = 0;      // an overhang from what holds it or a tooth, along the underside, mm
  std::optional<Vec3d> farthest_place;  // where that is
  double unsupported_area = 0;          // farther than the reach and a column, mm2
  // The same of the supports' own underside, which the model below and the plate hold; absent of a body with voids.
  std::optional<double> own_unsupported_area;
  double body_distance = kInfinity;   // least between body and model, mm; infinite without a body
  double tooth_distance = kInfinity;  // and between teeth and model, where a gap is left
  std::optional<double>
      footing_margin;  // the least of bodies that stand on the plate, mm: how far inside of their feet
};

//   written: the supports, upright, of whose triangles the first `body_triangles` are the body, which has voids or none
// Throws FailureError for what is not as it has to be: open or turned surfaces, a body in the model or nearer to it than
// its clearance but for kClearanceTolerance, teeth in the model where a gap was asked for; MeshError for bodies with a gap above that do not stand, and for what hangs below them. What is farther from a
// tooth than the reach is told, and no fault.
SupportFacts check_supports(const Mesh& written, std::size_t body_triangles, const SurfaceIndex& model,
                            const Undersides& undersides, const SupportRules& rules,
                            const SupportShape& shape, bool has_voids, Monitor& monitor);

// Of the bodies that stand on the plate, how far inside of its feet there and of what it stands on or leans on of the model each one's centre
// of mass is: the least, mm; nothing if none stands there, and minus infinity if one stands on nothing at all.
//   body: some triangles of the mesh, closed shells
//   undersides: of the model
std::optional<double> least_footing_margin(const Mesh& mesh, std::span<const Triangle> body,
                                           const Undersides& undersides, double clearance);

// How much of a model's underside is so near to what is below, and how far overhangs are from that and from what else holds them,
// whoever made it.
//   solid: the supports, closed
void measure_contact(const kernels::WindingView& solid, const kernels::WindingView& model,
                     const Undersides& undersides, double within, double reach, SupportFacts& facts);

}  // namespace aerate
