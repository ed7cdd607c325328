#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "core/drainage.h"
#include "core/packing.h"
#include "core/surface_index.h"
#include "core/void_shape.h"
#include "packing/ray_facets.h"

namespace aerate {

// Where tubes may run: answers whether a tube keeps the wall from the model's surface, and the gap from voids
// that it does not join. For other tubes see PlacedTubes.
class TubeClearance {
 public:
  // No tube is longer than `longest`, mm. The surfaces must outlive this. `kept`: see DrainableModel.
  TubeClearance(const SurfaceIndex& surface, const Packing& packing, double longest, double widest_radius,
                const SurfaceIndex* kept = nullptr);
  TubeClearance(SurfaceIndex&& surface, const Packing& packing, double longest, double widest_radius,
                const SurfaceIndex* kept = nullptr) = delete;

  // Distance from a point to the model's surface; `limit` if it is farther.
  double to_surface(Vec3d point, double limit) const;

  // How far it is from a point along a direction (unit) to the surface; nullopt if more than `longest`. A ray
  // through an edge may miss both of its triangles.
  std::optional<double> first_hit(Vec3d start, Vec3d direction, double longest) const;

  // The same with the outward normal of the triangle that is met, 0 if that has no area.
  struct Hit {
    double along;
    Vec3d normal;
  };
  std::optional<Hit> first_hit_with_normal(Vec3d start, Vec3d direction, double longest) const;

  // Whether there is any: as first_hit, at less cost.
  bool is_hit(Vec3d start, Vec3d direction, double longest) const;

  // The point of the surface nearest to a point, and the outward normal of the triangle there.
  Vec3d nearest_on_surface(Vec3d point) const;
  Vec3d normal_near(Vec3d point) const;

  // Is no point of the axis nearer to the surface, nor to kept regions, than radius + wall? Exact but for `kWallSlack`, by which
  // tubes may be refused that would just do: distance changes by no more than the point moves, so a piece of
  // the axis is clear if its middle is clear by half its length.
  bool keeps_wall(const Tube& tube) const;

  // The same for a tube that comes out of the surface at its end. There the axis comes nearer, but no point
  // of it than `slope` (the least sine of its angle with the surface) times what is left of the way. Exact
  // but for `kWallSlack` as before, and for the last of the way that is shorter than that. From kept regions it
  // keeps the wall to where its cut ends.
  bool keeps_wall_on_way_out(const Tube& tube, double slope) const;

  // Is no point of the axis nearer to kept regions than radius + wall? Exact.
  bool keeps_off_kept(const Tube& tube) const;

  // Do voids other than those two keep the gap from the tube, which starts at void `from`?
  bool keeps_gap_to_voids(const Tube& tube, std::uint32_t from, std::uint32_t to) const;

  // Neighbours of a void, the nearest first; their balls are nearer than `longest`.
  struct Neighbour {
    double gap;
    std::uint32_t index;
  };
  std::span<const Neighbour> neighbours(std::uint32_t at) const;

  static constexpr double kWallSlack = 0.02;  // mm

 private:
  // Is every point of the axis at least min(most, slope * way to the end) from the surface?
  bool keeps_away(const Tube& tube, double most, double slope) const;

  kernels::TriangleBvhView bvh_;
  RayFacets rays_;
  const SurfaceIndex* kept_;
  std::vector<VoidShape> voids_;
  PackingLimits limits_;
  double roofs_ = 0;  // how far a void reaches beyond its ball at most
  double longest_;
  std::vector<std::vector<Neighbour>>
      neighbours_;  // by void; those too that only tubes to others may be near
};

}  // namespace aerate
