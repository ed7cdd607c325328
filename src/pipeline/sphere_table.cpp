#include "pipeline/sphere_table.h"

#include <fmt/format.h>
#include <iterator>

namespace aerate {

const char* name_of(SphereKind kind) {
  switch (kind) {
    case SphereKind::lattice:
      return "lattice";
    case SphereKind::interstice:
      return "interstice";
    case SphereKind::tetrahedral:
      return "tetrahedral";
    case SphereKind::replacement:
      return "replacement";
    case SphereKind::adaptive:
      return "adaptive";
  }
  return "unknown";
}

std::string sphere_table_csv(const Packing& packing) {
  std::string table = "x,y,z,radius,kind\n";
  for (const Sphere& sphere : packing.spheres) {
    fmt::format_to(std::back_inserter(table), "{},{},{},{},{}\n", sphere.centre.x, sphere.centre.y,
                   sphere.centre.z, sphere.radius, name_of(sphere.kind));
  }
  return table;
}

}  // namespace aerate
