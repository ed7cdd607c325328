#pragma once

#include <string>

#include "core/packing.h"

namespace aerate {

// A packing as a table: a line "x,y,z,radius,kind", then one line a sphere, in mm in the model's own
// coordinates, each number in the shortest form that reads back to the same fp64.
std::string sphere_table_csv(const Packing& packing);

// "lattice", "interstice", ...
const char* name_of(SphereKind kind);

}  // namespace aerate
