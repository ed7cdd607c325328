#include "printing/plug_surface.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <string>
#include <string_view>

#include "core/drainage.h"

namespace aerate {
namespace {

constexpr double kFineness = 0.01;   // of the round side, mm
constexpr double kRingWidth = 0.25;  // of the outer end, mm
constexpr double kMostRings = 64;

// Engraved lines are so wide; below the least no printer shows them.
constexpr double kLeastLine = 0.25, kWidestLine = 1;
constexpr double kEngravedDepth = 0.4;
constexpr double kLeastMargin = 0.15;  // between number and rim

// Seven segments on three columns and five rows, from the top left.
constexpr std::array<std::string_view, 10> kDigits{
    "####.##.##.####", "..#..#..#..#..#", "###..#####..###", "###..####..####", "#.##.####..#..#",
    "####..###..####", "####..####.####", "###..#..#..#..#", "####.#####.####", "####.####..####"};
constexpr std::size_t kColumns = 3, kRows = 5;

// What is engraved, seen as it is read: rows from the top.
struct Bitmap {
  std::size_t columns = 0, rows = 0;
  std::vector<char> dark;

  // Outside there is nothing.
  bool is_dark(std::size_t column, std::size_t row) const {
    return column < columns && row < rows && dark[row * columns + column] != 0;
  }
};

// Whether digits read as another number when the plug is turned upside down.
bool is_ambiguous(const std::string& digits) {
  constexpr std::string_view kUpright = "0125689", kTurned = "0125986";
  std::string turned;
  for (auto digit = digits.rbegin(); digit != digits.rend(); ++digit) {
    const std::size_t found = kUpright.find(*digit);
    if (found == std::string_view::npos) return false;
    turned += kTurned[found];
  }
  return turned != digits;
}

// Digits a column apart; under them a line where they could be read upside down.
Bitmap bitmap_of(std::size_t number) {
  const std::string digits = std::to_string(number);
  Bitmap bitmap;
  bitmap.columns = digits.size() * (kColumns + 1) - 1;
  bitmap.rows = is_ambiguous(digits) ? kRows + 2 : kRows;
  bitmap.dark.assign(bitmap.columns * bitmap.rows, 0);
  for (std::size_t i = 0; i < digits.size(); ++i) {
    const std::string_view digit = kDigits[static_cast<std::size_t>(digits[i] - '0')];
    for (std::size_t cell = 0; cell < digit.size(); ++cell) {
      const std::size_t column = i * (kColumns + 1) + cell % kColumns;
      bitmap.dark[cell / kColumns * bitmap.columns + column] = digit[cell] == '#' ? 1 : 0;
    }
  }
  if (bitmap.rows > kRows)
    std::fill(bitmap.dark.end() - static_cast<std::ptrdiff_t>(bitmap.columns), bitmap.dark.end(), 1);
  return bitmap;
}

double half_diagonal(const Bitmap& bitmap) {
  return std::hypot(static_cast<double>(bitmap.columns), static_cast<double>(bitmap.rows)) / 2;
}

class PlugBuilder {
 public:
  explicit PlugBuilder(const PlugShape& shape)
      : shape_(shape),
        sides_(tube_sides(shape.radius, kFineness)),
        rings_(static_cast<std::size_t>(std::clamp(std::ceil(shape.radius / kRingWidth), 2.0, kMostRings))) {}

  std::optional<PlugSurface> build() {
    if (!find_rim() || !add_outer_end()) return std::nullopt;
    add_side();
    add_inner_end();
    return std::move(surface_);
  }

 private:
  using Index = std::uint32_t;

  double angle(std::size_t side) const {
    return 2 * std::numbers::pi * static_cast<double>(side) / static_cast<double>(sides_);
  }

  Index add(Vec3d position) {
    surface_.positions.push_back(position);
    return static_cast<Index>(surface_.positions.size() - 1);
  }

  // A vertex of the outer end; its height counts.
  std::optional<Index> add_above(double x, double y) {
    const std::optional<double> height = shape_.height(x, y);
    if (!height || !(*height >= kShortestPlug)) return std::nullopt;
    surface_.shortest = std::min(surface_.shortest, *height);
    surface_.longest = std::max(surface_.longest, *height);
    return add({x, y, *height});
  }

  // Where the cone of the side, as wide as the shape at the highest place of its rim, meets the outer end.
  bool find_rim() {
    rim_.assign(sides_, shape_.radius);
    double highest = -std::numeric_limits<double>::infinity();
    std::vector<double> heights(sides_);
    constexpr int kNewtonSteps = 8;  // each leaves a small share of the error: the side is steep
    for (int step = 0; step < kNewtonSteps; ++step) {
      for (std::size_t i = 0; i < sides_; ++i) {
        const auto height = shape_.height(rim_[i] * std::cos(angle(i)), rim_[i] * std::sin(angle(i)));
        if (!height) return false;
        heights[i] = *height;
      }
      if (step == 0) highest = *std::ranges::max_element(heights);
      for (std::size_t i = 0; i < sides_; ++i)
        rim_[i] = shape_.radius - std::max(0.0, highest - heights[i]) * shape_.tangent;
    }
    surface_.inner_radius = shape_.radius - highest * shape_.tangent;
    return surface_.inner_radius > kLeastMargin;
  }

  // Rings of triangles round the axis.
  bool add_outer_end() {
    surface_.shortest = std::numeric_limits<double>::infinity();
    const auto centre = add_above(0, 0);
    if (!centre) return false;
    for (std::size_t ring = 1; ring <= rings_; ++ring) {
      for (std::size_t i = 0; i < sides_; ++i) {
        const double distance = rim_[i] * static_cast<double>(ring) / static_cast<double>(rings_);
        if (!add_above(distance * std::cos(angle(i)), distance * std::sin(angle(i)))) return false;
      }
    }
    const auto at = [&](std::size_t ring, std::size_t i) {
      return ring == 0 ? *centre : static_cast<Index>(*centre + 1 + (ring - 1) * sides_ + i % sides_);
    };
    for (std::size_t i = 0; i < sides_; ++i) {
      surface_.triangles.push_back({at(0, 0), at(1, i), at(1, i + 1)});
      for (std::size_t ring = 1; ring < rings_; ++ring) {
        surface_.triangles.push_back({at(ring, i), at(ring + 1, i), at(ring + 1, i + 1)});
        surface_.triangles.push_back({at(ring, i), at(ring + 1, i + 1), at(ring, i + 1)});
      }
    }
    surface_.outer_end_triangles = surface_.triangles.size();
    first_of_rim_ = at(rings_, 0);
    return true;
  }

  void add_side() {
    first_below_ = static_cast<Index>(surface_.positions.size());
    const double radius = surface_.inner_radius;
    for (std::size_t i = 0; i < sides_; ++i)
      add({radius * std::cos(angle(i)), radius * std::sin(angle(i)), 0});
    for (std::size_t i = 0; i < sides_; ++i) {
      const auto next = static_cast<Index>((i + 1) % sides_), here = static_cast<Index>(i);
      surface_.triangles.push_back({first_of_rim_ + here, first_below_ + here, first_below_ + next});
      surface_.triangles.push_back({first_of_rim_ + here, first_below_ + next, first_of_rim_ + next});
    }
  }

  // Faces down, so that triangles that are counter-clockwise in the plane are turned.
  void add_face(Index a, Index b, Index c) { surface_.triangles.push_back({a, c, b}); }

  void add_inner_end() {
    const Bitmap bitmap = bitmap_of(shape_.number);
    const double inside = surface_.inner_radius * std::cos(std::numbers::pi / static_cast<double>(sides_));
    const double line = std::min(kWidestLine, (inside - kLeastMargin) / half_diagonal(bitmap));
    surface_.is_numbered = line >= kLeastLine;
    if (surface_.is_numbered) {
      add_number(bitmap, line);
      return;
    }
    for (std::size_t i = 1; i + 1 < sides_; ++i)
      add_face(first_below_, first_below_ + static_cast<Index>(i), first_below_ + static_cast<Index>(i + 1));
  }

  // A grid of squares, of which the dark ones are sunk. It is read from below, so left is towards +x.
  void add_number(const Bitmap& bitmap, double line) {
    const std::size_t across = bitmap.columns + 1;
    const double depth = std::min(kEngravedDepth, surface_.shortest / 2);
    std::array<std::vector<std::optional<Index>>, 2> corners;
    for (auto& level : corners) level.resize(across * (bitmap.rows + 1));
    const auto corner = [&](std::size_t column, std::size_t row, bool is_sunk) {
      std::optional<Index>& index = corners[is_sunk ? 1 : 0][row * across + column];
      if (!index)
        index = add({line * (static_cast<double>(bitmap.columns) / 2 - static_cast<double>(column)),
                     line * (static_cast<double>(bitmap.rows) / 2 - static_cast<double>(row)),
                     is_sunk ? depth : 0});
      return *index;
    };
    // The step between two squares along the edge from `a` to `b`, the first of them to the left as it is read.
    const auto add_step = [&](std::array<std::size_t, 2> a, std::array<std::size_t, 2> b, bool left,
                              bool right) {
      if (left == right) return;
      const Index low_a = corner(a[0], a[1], false), low_b = corner(b[0], b[1], false);
      const Index high_a = corner(a[0], a[1], true), high_b = corner(b[0], b[1], true);
      if (right) {
        surface_.triangles.push_back({low_a, high_a, high_b});
        surface_.triangles.push_back({low_a, high_b, low_b});
      } else {
        surface_.triangles.push_back({low_b, high_b, high_a});
        surface_.triangles.push_back({low_b, high_a, low_a});
      }
    };
    for (std::size_t row = 0; row <= bitmap.rows; ++row) {
      for (std::size_t column = 0; column <= bitmap.columns; ++column) {
        const bool is_sunk = bitmap.is_dark(column, row);
        if (column < bitmap.columns) {
          const bool above = row > 0 && bitmap.is_dark(column, row - 1);
          add_step({column, row}, {column + 1, row}, above, is_sunk);
        }
        if (row < bitmap.rows) {
          const bool before = column > 0 && bitmap.is_dark(column - 1, row);
          add_step({column, row + 1}, {column, row}, before, is_sunk);
        }
        if (column == bitmap.columns || row == bitmap.rows) continue;
        const Index a = corner(column, row, is_sunk), b = corner(column + 1, row, is_sunk);
        const Index c = corner(column + 1, row + 1, is_sunk), d = corner(column, row + 1, is_sunk);
        add_face(a, b, c);
        add_face(a, c, d);
      }
    }
    std::vector<Index> border;
    const auto add_border = [&](std::size_t column, std::size_t row) {
      border.push_back(corner(column, row, false));
    };
    for (std::size_t column = 0; column < bitmap.columns; ++column) add_border(column, 0);
    for (std::size_t row = 0; row < bitmap.rows; ++row) add_border(bitmap.columns, row);
    for (std::size_t column = bitmap.columns; column > 0; --column) add_border(column, bitmap.rows);
    for (std::size_t row = bitmap.rows; row > 0; --row) add_border(0, row);
    close_between(border);
  }

  // Twice the area of a triangle in the plane.
  double area(Index a, Index b, Index c) const {
    const Vec3d& p = surface_.positions[a];
    const Vec3d u = surface_.positions[b] - p, v = surface_.positions[c] - p;
    return u.x * v.y - u.y * v.x;
  }

  double angle_of(Index index) const {
    return std::atan2(surface_.positions[index].y, surface_.positions[index].x);
  }

  // The face between a border round the axis, counter-clockwise, and the rim of the inner end: both are convex, so
  // going round them at the same time meets no triangle twice.
  void close_between(const std::vector<Index>& border) {
    // From the side that is nearest to the border's beginning in angle.
    const auto start = static_cast<std::size_t>(
        std::llround((angle_of(border.front()) / (2 * std::numbers::pi) + 1) * static_cast<double>(sides_)));
    const auto outer = [&](std::size_t i) { return static_cast<Index>(first_below_ + (start + i) % sides_); };
    const auto inner = [&](std::size_t i) { return border[i % border.size()]; };
    const double origin = angle_of(border.front());
    const auto turned = [&](Index index, bool is_last) {
      const double angle = std::remainder(angle_of(index) - origin, 2 * std::numbers::pi);
      return angle < -1e-9 || is_last ? angle + 2 * std::numbers::pi : angle;
    };
    std::size_t i = 0, j = 0;
    while (i < border.size() || j < sides_) {
      const bool can_go_inside = i < border.size() && area(inner(i), outer(j), inner(i + 1)) > 0;
      const bool is_inside_next =
          can_go_inside && (j == sides_ || turned(inner(i + 1), i + 1 == border.size()) <=
                                               turned(outer(j + 1), j + 1 == sides_));
      if (is_inside_next) {
        add_face(inner(i), outer(j), inner(i + 1));
        ++i;
      } else {
        if (j == sides_) return;  // leaves the end open, which the check of the file tells
        add_face(inner(i), outer(j), outer(j + 1));
        ++j;
      }
    }
  }

  const PlugShape& shape_;
  std::size_t sides_, rings_;
  std::vector<double> rim_;  // distance of the outer rim from the axis
  Index first_of_rim_ = 0, first_below_ = 0;
  PlugSurface surface_;
};

}  // namespace

std::optional<PlugSurface> plug_surface(const PlugShape& shape) {
  return PlugBuilder(shape).build();
}

}  // namespace aerate
