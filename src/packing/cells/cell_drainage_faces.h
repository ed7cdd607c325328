#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "core/cells.h"
#include "core/drainage.h"

namespace aerate {

// A point of a plane: x across, y downwards.
struct Flat {
  double x, y;
};

// A face counts as flat as far as it is no deeper than this behind its plane, mm: less than a window's tube
// reaches beyond it (kWindowInset). Taking triangles out of a surface leaves few that lie on the plane
// exactly.
inline constexpr double kFlatWithin = 0.05;

// The part of a void's surface that lies on a plane of its cell, in the plane's own coordinates.
struct FlatFace {
  std::vector<std::array<Flat, 3>> triangles;
  std::vector<std::array<Flat, 2>> rim;  // edges of which only one side is flat
};

// `frame`: about the plane's normal. Triangles count of which no corner is deeper than kFlatWithin.
FlatFace flat_face(const Mesh& surface, const CellPlane& plane, const TubeFrame& frame);

// Where a disc lies in both of two faces.
class DiscPlaces {
 public:
  // `step` between places that are looked at, mm: made larger for faces that take too many.
  DiscPlaces(const FlatFace& a, const FlatFace& b, double radius, double step);

  // Up to six, at least `spacing` apart from each other, by how low they are (the largest y), how high, and
  // how near to the middle. `is_level`: the face has no low end, so those near the middle come first.
  std::vector<Flat> choose(double spacing, bool is_level) const;

 private:
  bool fits(Flat at) const;
  bool is_in_both(Flat at) const;
  Flat slid(Flat from, double direction) const;
  void rasterise(const FlatFace& face, unsigned char bit, std::vector<unsigned char>& mask) const;
  std::vector<Flat> eroded(const std::vector<unsigned char>& mask) const;

  const FlatFace& a_;
  const FlatFace& b_;
  double radius_, step_;
  Flat origin_{0, 0};
  std::size_t columns_ = 0, rows_ = 0;
  std::vector<Flat> places_;
  Flat middle_{0, 0};
};

}  // namespace aerate
