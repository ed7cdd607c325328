#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <vector>

#include "core/mesh.h"
#include "core/packing.h"
#include "core/solid.h"
#include "printing/ball_template.h"
#include "printing/cut_ball.h"
#include "printing/roof_top.h"

namespace aerate {

// The triangulation that a void gets: that of a ball, or of a cut ball with a cone and a flat top put on.
struct VoidTemplate {
  const BallTemplate* ball = nullptr;
  const CutBall* cut = nullptr;  // instead of `ball`

  RoofTop top = RoofTop::flat;  // how what the cut leaves open is closed

  std::size_t vertex_count() const;
  std::size_t triangle_count() const;

  // Writes the void's surface, turned inside out, into a mesh that has room for it from these on.
  void place(const Sphere& sphere, const Roof& roof, std::size_t first_vertex, std::size_t first_triangle,
             Mesh& mesh) const;
};

// Templates for the voids of a packing, each made when it is first asked for.
class VoidTemplates {
 public:
  explicit VoidTemplates(const Roof& roof);
  ~VoidTemplates();

  // For each sphere the coarsest template, about, that keeps the surface of its void within `tolerance` mm of
  // the planned one and its volume above 90 %. Valid while this object lives. Throws UsageError if fp32
  // cannot hold a void so exactly at its place, or if that took more than about a million triangles.
  std::vector<VoidTemplate> choose(std::span<const Sphere> spheres, double tolerance, Monitor& monitor);

 private:
  VoidTemplate choose_with_roof(const Sphere& sphere, double tolerance);
  const CutBall* cut(std::size_t level);

  Roof roof_;
  BallLadder ladder_;
  struct Cut;
  std::vector<std::unique_ptr<Cut>> cuts_;  // by level of the ladder
};

// The outer surface and those of the packing's voids, facing inward, by a template for each. All of a void's
// surface lies within its planned shape. Throws FailureError for more vertices than 32 bits can count.
Solid assemble(Mesh outer, const Packing& packing, std::span<const VoidTemplate> templates);

}  // namespace aerate
