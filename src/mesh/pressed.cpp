#include "mesh/pressed.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <map>
#include <utility>

namespace aerate {
namespace {

using Coordinate = float Vec3f::*;

// Cuts a mesh along a plane across an axis: none of its triangles is then on both sides.
class Cutter {
 public:
  Cutter(Mesh& mesh, Coordinate along, float height) : mesh_(mesh), along_(along), height_(height) {}

  void cut() {
    std::vector<Triangle> triangles;
    triangles.reserve(mesh_.triangles.size());
    for (const Triangle& t : mesh_.triangles) {
      const std::array sides{side_of(t[0]), side_of(t[1]), side_of(t[2])};
      const auto [least, most] = std::ranges::minmax(sides);
      if (least >= 0 || most <= 0)
        triangles.push_back(t);
      else
        add_pieces(t, sides, triangles);
    }
    mesh_.triangles = std::move(triangles);
  }

 private:
  int side_of(std::uint32_t v) const {
    const float at = mesh_.positions[v].*along_;
    return at < height_ ? -1 : at > height_ ? 1 : 0;
  }

  // From the lesser number to the greater, so that both triangles at the edge have the same vertex.
  std::uint32_t on_edge(std::uint32_t v, std::uint32_t w) {
    const auto [place, is_new] =
        cuts_.try_emplace(std::minmax(v, w), static_cast<std::uint32_t>(mesh_.positions.size()));
    if (!is_new) return place->second;
    const Vec3d a = to_double(mesh_.positions[std::min(v, w)]);
    const Vec3d b = to_double(mesh_.positions[std::max(v, w)]);
    const auto height = [&](std::uint32_t u) { return static_cast<double>(mesh_.positions[u].*along_); };
    const double from = height(std::min(v, w)), to = height(std::max(v, w));
    Vec3f at = to_float(a + (b - a) * ((static_cast<double>(height_) - from) / (to - from)));
    at.*along_ = height_;
    mesh_.positions.push_back(at);
    return place->second;
  }

  // The corners of a triangle that is cut, in their order, with those of the cut between them; fans of the parts.
  void add_pieces(const Triangle& t, const std::array<int, 3>& sides, std::vector<Triangle>& triangles) {
    std::vector<std::uint32_t> above, below;
    for (std::size_t i = 0; i < 3; ++i) {
      const std::size_t next = (i + 1) % 3;
      if (sides[i] >= 0) above.push_back(t[i]);
      if (sides[i] <= 0) below.push_back(t[i]);
      if (sides[i] * sides[next] >= 0) continue;
      const std::uint32_t cut = on_edge(t[i], t[next]);
      above.push_back(cut);
      below.push_back(cut);
    }
    for (const std::vector<std::uint32_t>* part : {&above, &below}) {
      for (std::size_t i = 2; i < part->size(); ++i)
        triangles.push_back({part->front(), (*part)[i - 1], (*part)[i]});
    }
  }

  Mesh& mesh_;
  Coordinate along_;
  float height_;
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> cuts_;
};

}  // namespace

Mesh pressed_into(const Box3f& box, const Mesh& mesh) {
  Mesh pressed = mesh;
  for (const Coordinate along : {&Vec3f::x, &Vec3f::y, &Vec3f::z}) {
    for (const float height : {box.lower.*along, box.upper.*along}) Cutter(pressed, along, height).cut();
  }
  for (Vec3f& p : pressed.positions) p = min_of(max_of(p, box.lower), box.upper);
  return pressed;
}

}  // namespace aerate
