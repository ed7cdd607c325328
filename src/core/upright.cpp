#include "core/upright.h"

#include <cmath>

namespace aerate {

UprightFrame::UprightFrame(Vec3d up) : z(up) {
  const double ax = std::abs(up.x), ay = std::abs(up.y), az = std::abs(up.z);
  const Vec3d aside = ax <= ay && ax <= az ? Vec3d{1, 0, 0} : ay <= az ? Vec3d{0, 1, 0} : Vec3d{0, 0, 1};
  const Vec3d across = aside - up * dot(aside, up);
  x = normalised(across);
  y = cross(z, x);
}

Mesh turned_upright(const Mesh& mesh, const UprightFrame& frame) {
  Mesh turned{{}, mesh.triangles};
  turned.positions.reserve(mesh.positions.size());
  for (const Vec3f& p : mesh.positions) turned.positions.push_back(to_float(frame.to_frame(to_double(p))));
  return turned;
}

}  // namespace aerate
