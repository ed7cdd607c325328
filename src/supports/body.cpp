#include "supports/body.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <tbb/parallel_for.h>

#include "core/facet_distance.h"
#include "kernels/nearest_point.h"
#include "mesh/topology.h"
#include "printing/level_set.h"
#include "supports/body_voxels.h"

namespace aerate {
namespace {

// Moves vertices away from the model until no triangle is nearer to it than `least`, as far as that can be done; what stands on the plate
// stays on it.
void move_clear(Mesh& mesh, const SurfaceIndex& model, double plate, double least) {
  constexpr int kRounds = 12;
  const double wanted = least + 0.01;
  std::vector<std::uint8_t> is_near(mesh.triangles.size(), 1);  // that have to be looked at
  for (int round = 0; round < kRounds; ++round) {
    tbb::parallel_for(std::size_t{0}, mesh.triangles.size(), [&](std::size_t i) {
      if (is_near[i] == 0) return;
      const kernels::Facet facet = facet_of(mesh, mesh.triangles[i]);
      is_near[i] = distance_to_surface(facet, model.bvh(), least) < least ? 1 : 0;
    });
    std::vector<std::uint8_t> moves(mesh.positions.size(), 0);
    bool is_any = false;
    for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
      if (is_near[i] == 0) continue;
      is_any = true;
      for (const std::uint32_t v : mesh.triangles[i]) moves[v] = 1;
    }
    if (!is_any) return;
    tbb::parallel_for(std::size_t{0}, mesh.positions.size(), [&](std::size_t v) {
      if (moves[v] == 0) return;
      const Vec3d at = to_double(mesh.positions[v]);
      const kernels::NearestFacet nearest = model.bvh().nearest(at, kInfinity);
      const Vec3d foot = kernels::nearest_point_on_facet(at, model.bvh().facets[nearest.facet]).point;
      Vec3d way = at - foot;
      const bool is_on_plate = at.z <= plate;
      if (is_on_plate) way.z = 0;
      const double length = std::sqrt(length_squared(way));
      if (length <= 0) return;
      // Of a triangle whose middle is what is near all corners go a little.
      constexpr double kLeastStep = 0.03;
      const double step = std::max(kLeastStep, wanted - std::sqrt(nearest.distance_squared));
      Vec3d moved = at + way * (step / length);
      moved.z = std::max(moved.z, plate);
      mesh.positions[v] = to_float(moved);
    });
    // Neighbours of what has moved.
    for (std::size_t i = 0; i < mesh.triangles.size(); ++i)
      for (const std::uint32_t v : mesh.triangles[i])
        if (moves[v] != 0) is_near[i] = 1;
  }
}

Mesh without_crumbs(const Mesh& mesh) {
  const EdgeUses uses(mesh);
  const ShellLabels labels = label_shells(mesh, uses);
  const std::vector<Shell> shells = describe_shells(mesh, labels);
  std::vector<Triangle> kept;
  kept.reserve(mesh.triangles.size());
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i)
    if (shells[labels.of_triangle[i]].volume > kCrumb) kept.push_back(mesh.triangles[i]);
  return submesh(mesh, kept);
}

}  // namespace

Mesh support_body(const SurfaceIndex& model, const Undersides& undersides, const TeethPlan& teeth,
                  const BodyShape& shape, Monitor& monitor) {
  constexpr int kBelow = 2;  // layers, of which the plate cuts off what smoothing rounds
  std::vector<CarriedPlace> carried;
  carried.reserve(teeth.carried.size());
  for (const std::uint32_t span : teeth.carried) {
    const Vec3d at = undersides.place(span);
    carried.push_back({at.x, at.y, at.z, undersides.spans[span].floor});
  }
  // Overhangs are looked at more closely than the body needs to be.
  const bool is_fine = undersides.spacing < shape.least_voxel;
  const Undersides coarser =
      is_fine ? columns_of(model.winding(), undersides.plate, shape.least_voxel) : Undersides{};
  const Undersides& columns = is_fine ? coarser : undersides;
  const double size = columns.spacing;
  std::vector<std::array<int, 3>> voxels = body_voxels(columns, model, carried, shape, teeth.reach, monitor);
  if (voxels.empty()) return {};
  const std::size_t above = voxels.size();
  for (std::size_t i = 0; i < above; ++i) {
    const std::array<int, 3> voxel = voxels[i];
    if (voxel[2] != 0) continue;
    for (int k = 1; k <= kBelow; ++k) voxels.push_back({voxel[0], voxel[1], -k});
  }
  // Voxels lie at whole multiples of their size.
  const Vec3d origin{columns.origin_x, columns.origin_y, columns.plate + 0.5 * size};
  // Facets of the surface cut corners of what voxels hold.
  const double free = shape.clearance + 0.25 * size;
  const auto taken = [&](Vec3d at, double more_than) {
    const Vec3d place = at + origin;
    const double below_plate = columns.plate - place.z;
    const double reach = free - std::max(more_than, below_plate);
    if (reach <= 0) return below_plate;
    const double nearest = std::sqrt(model.bvh().nearest(place, reach * reach).distance_squared);
    return std::max(free - nearest, below_plate);
  };
  const LevelSet smooth = LevelSet::of_voxels(voxels, size);
  monitor.check_interrupted();
  Mesh mesh = smooth.without(taken).surface();
  const double snap = 0.05 * size;
  for (Vec3f& p : mesh.positions) {
    Vec3d moved = to_double(p) + origin;
    if (moved.z < columns.plate + snap) moved.z = columns.plate;
    p = to_float(moved);
  }
  mesh = without_crumbs(mesh);
  monitor.check_interrupted();
  move_clear(mesh, model, to_double(to_float({0, 0, columns.plate})).z,
             shape.clearance - kClearanceTolerance);
  return mesh;
}

}  // namespace aerate
