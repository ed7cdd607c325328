#pragma once

#include <cstddef>
#include <span>
#include <string>

#include "core/mesh.h"
#include "core/packing.h"

// What a packing is worth, whoever made it: how much it fills, and which limits it breaks.

namespace aerate::bench {

struct Violations {
  std::size_t wall = 0, gap = 0, winding = 0;

  std::size_t all() const { return wall + gap + winding; }
};

// How many spheres come nearer to the surface or to each other than they may by more than `slack` mm, or lie
// outside. The slack is 0 for us, and for a peer what its fp32 centres and radii explain.
Violations count_violations(const Mesh& mesh, std::span<const Sphere> spheres, const PackingLimits& limits,
                            double slack);

// As a cell under kViolationsTitle.
inline constexpr const char* kViolationsTitle = "broken: walls, gaps, winding";
std::string to_cell(const Violations& violations);

// Says on the error output how many are broken in all; false if any are.
bool report_broken(std::size_t broken);

// Percent of the model's volume.
double density_of(const Mesh& mesh, std::span<const Sphere> spheres);

}  // namespace aerate::bench
