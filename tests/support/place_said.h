#pragma once

#include <cstdio>
#include <optional>
#include <string>

#include "kernels/vec.h"

namespace aerate::test {

// The place that a refusal of another says can be taken, if it says one.
inline std::optional<Vec3d> place_said_in(const std::string& message) {
  const std::size_t hint = message.find("the nearest place");
  if (hint == std::string::npos) return std::nullopt;
  Vec3d place{};
  const std::size_t begin = message.find('(', hint);
  if (std::sscanf(message.c_str() + begin, "(%lf, %lf, %lf) mm", &place.x, &place.y, &place.z) != 3)
    return std::nullopt;
  return place;
}

}  // namespace aerate::test
