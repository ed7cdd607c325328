#include "view/scene.h"

#include <algorithm>
#include <iterator>

namespace aerate {

std::vector<SolidPart> parts_of(const Scene& scene, PartKind kind) {
  std::vector<SolidPart> parts;
  std::ranges::copy_if(scene.parts, std::back_inserter(parts),
                       [&](const SolidPart& part) { return part.kind == kind; });
  return parts;
}

}  // namespace aerate
