#pragma once

#include <string>
#include <vector>

#include "core/packing.h"
#include "kernels/vec.h"

namespace aerate {

// Tables of spheres for programs that simulate grains, as rows of sphere_table.h; millimetres, each number in the shortest form
// that reads back to the same fp64. `model` is the model's box.

// VTK XML PolyData, for ParaView: points with a vertex each, their arrays `radius` and `kind`, and a field `unit`.
std::string vtk_spheres(const std::vector<Sphere>& spheres, const Box3f& model);

// A data file of LAMMPS, atom_style sphere (id type diameter density x y z): all of type 1 and density 1, in the model's box.
std::string lammps_spheres(const std::vector<Sphere>& spheres, const Box3f& model);

// Text of YADE (ymport.text): x y z radius.
std::string yade_spheres(const std::vector<Sphere>& spheres, const Box3f& model);

}  // namespace aerate
