#include "pipeline/mesh_part.h"

#include <cstdint>
#include <unordered_map>

namespace aerate {
namespace {

bool may_be_near(const Box3d& box, Vec3f a, Vec3f b, Vec3f c) {
  const Vec3d least = to_double(min_of(a, min_of(b, c)));
  const Vec3d most = to_double(max_of(a, max_of(b, c)));
  return least.x <= box.upper.x && least.y <= box.upper.y && least.z <= box.upper.z &&
         most.x >= box.lower.x && most.y >= box.lower.y && most.z >= box.lower.z;
}

}  // namespace

Mesh part_near(const Mesh& mesh, const Segment& segment, double reach) {
  const Vec3d margin{reach, reach, reach};
  const Box3d box{min_of(segment.start, segment.end) - margin, max_of(segment.start, segment.end) + margin};
  Mesh part;
  std::unordered_map<std::uint32_t, std::uint32_t> number_of;
  for (const Triangle& t : mesh.triangles) {
    const Vec3f a = mesh.positions[t[0]], b = mesh.positions[t[1]], c = mesh.positions[t[2]];
    if (!may_be_near(box, a, b, c) || distance_to_facet(segment, {a, b, c}) >= reach) continue;
    Triangle own{};
    for (std::size_t corner = 0; corner < 3; ++corner) {
      const auto [place, is_new] =
          number_of.emplace(t[corner], static_cast<std::uint32_t>(part.positions.size()));
      if (is_new) part.positions.push_back(mesh.positions[t[corner]]);
      own[corner] = place->second;
    }
    part.triangles.push_back(own);
  }
  return part;
}

}  // namespace aerate
