#include "view/picture.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <tbb/parallel_for.h>
#include <vector>

#include "kernels/constants.h"
#include "kernels/triangle_bvh.h"
#include "view/picture_layout.h"
#include "view/scene_rays.h"
#include "view/section.h"

namespace aerate {
namespace {

using namespace picture_colours;

// Rows of a section to a row of pixels; as many points of a pixel are looked at where colours change.
constexpr int kRowsPerPixel = 4;
constexpr std::array<double, kRowsPerPixel> kAside{0.375, 0.875, 0.125, 0.625};

std::vector<Vec3d> corners_in_view(const Mesh& mesh, const Camera& camera) {
  std::vector<Vec3d> corners(mesh.positions.size());
  tbb::parallel_for(std::size_t{0}, corners.size(),
                    [&](std::size_t i) { corners[i] = camera.to_view(to_double(mesh.positions[i])); });
  return corners;
}

// Of what is behind the plane.
struct Extent {
  double x0 = kInfinity, y0 = kInfinity, x1 = -kInfinity, y1 = -kInfinity, depth = 0;

  void add(ViewPoint p) {
    x0 = std::min(x0, p.x);
    y0 = std::min(y0, p.y);
    x1 = std::max(x1, p.x);
    y1 = std::max(y1, p.y);
  }
};

Extent extent_of(const Mesh& mesh, const std::vector<Vec3d>& corners, const std::vector<SectionLine>& lines) {
  Extent extent;
  for (const Triangle& t : mesh.triangles)
    for (const std::uint32_t corner : t) {
      const Vec3d& p = corners[corner];
      if (p.z < 0) continue;
      extent.add({p.x, p.y});
      extent.depth = std::max(extent.depth, p.z);
    }
  for (const SectionLine& line : lines) {
    extent.add(line.from);
    extent.add(line.to);
  }
  if (!(extent.x0 <= extent.x1)) extent = {0, 0, 1, 1, 0};
  return extent;
}

PictureFrame frame_for(const Extent& extent, const Camera& camera, const PixelRoom& room) {
  const double width = std::max(extent.x1 - extent.x0, 1e-9), height = std::max(extent.y1 - extent.y0, 1e-9);
  const double scale = 0.97 * std::min(room.width / width, room.height / height);
  return {camera, {(extent.x0 + extent.x1) / 2, (extent.y0 + extent.y1) / 2}, room.middle(), scale};
}

// Some points of what is wrong with a model.
std::vector<Vec3d> points_of_defects(const Scene& scene) {
  constexpr std::size_t kMostPoints = 256;
  std::vector<Vec3d> points;
  for (const SceneMark& mark : scene.marks) {
    if (!is_defect(mark.kind)) continue;
    if (mark.lines.empty()) points.push_back(mark.place);
    for (const auto& [from, to] : mark.lines) points.push_back((from + to) * 0.5);
  }
  const std::size_t step = points.size() / kMostPoints + 1;
  std::vector<Vec3d> some;
  for (std::size_t i = 0; i < points.size(); i += step) some.push_back(points[i]);
  return some;
}

// The whole model from the side from which most of what is wrong is seen, from the front before others.
Cut whole_with_defects(const Scene& scene) {
  const Box3f box = bounding_box(scene.mesh);
  const double size = length(to_double(box.upper) - to_double(box.lower));
  const LineOfSight sight(scene.mesh);
  const std::vector<Vec3d> points = points_of_defects(scene);
  Cut best;
  std::ptrdiff_t most = -1;
  for (const Cut& cut : {cut_at(CutAxis::y, 0), cut_at(CutAxis::y, 1), cut_at(CutAxis::x, 1),
                         cut_at(CutAxis::x, 0), cut_at(CutAxis::z, 1), cut_at(CutAxis::z, 0)}) {
    const Camera camera(box, cut, scene.up);
    const Vec3d towards = normalised(camera.to_model({0, 0, 0}) - camera.to_model({0, 0, 1}));
    constexpr double kOff = 1e-4;  // of its size, to be clear of the surface itself
    const auto seen = std::ranges::count_if(
        points, [&](Vec3d p) { return sight.is_free(p + towards * (kOff * size), towards); });
    if (seen <= most) continue;
    most = seen;
    best = cut;
  }
  return best;
}

Cut cut_for(const Scene& scene, const PictureRequest& request) {
  if (request.axis && request.share) return cut_at(*request.axis, *request.share);
  constexpr std::array<CutAxis, 3> kAll{CutAxis::y, CutAxis::x, CutAxis::z};
  if (request.axis) return cut_with_most_void(scene, std::span(&*request.axis, 1));
  const bool has_defects =
      std::ranges::any_of(scene.marks, [](const SceneMark& mark) { return is_defect(mark.kind); });
  if (scene.voids.empty() && has_defects) return whole_with_defects(scene);
  return cut_with_most_void(scene, kAll);
}

// The scene's surface as it is seen along rays.
class Surface {
 public:
  Surface(const Scene& scene, const Camera& camera, const std::vector<Vec3d>& corners, double depth)
      : scene_(scene),
        camera_(camera),
        depth_(depth),
        rays_(scene.mesh, corners),
        void_of_(scene.parts.size(), kNone) {
    std::uint32_t count = 0;
    for (std::size_t i = 0; i < scene.parts.size(); ++i)
      if (scene.parts[i].kind == PartKind::void_surface && count < scene.voids.size()) void_of_[i] = count++;
  }

  std::optional<RayHit> first(ViewPoint p) const { return rays_.first(p.x, p.y); }

  std::size_t part_of(std::uint32_t triangle) const {
    const auto after = std::upper_bound(
        scene_.parts.begin(), scene_.parts.end(), triangle,
        [](std::uint32_t value, const SolidPart& part) { return value < part.first_triangle; });
    return static_cast<std::size_t>(after - scene_.parts.begin()) - 1;
  }
  // kNone for what is no void's wall.
  std::uint32_t void_of_part(std::size_t part) const { return void_of_[part]; }
  Vec3d place_of(ViewPoint p, const RayHit& hit) const { return camera_.to_model({p.x, p.y, hit.depth}); }

  // Into the room that one looks through, turned as the view is; `is_inside`: of a surface that faces away.
  Vec3d normal_at(ViewPoint p, const RayHit& hit, bool& is_inside) const {
    const kernels::Facet facet = facet_of(scene_.mesh, scene_.mesh.triangles[hit.triangle]);
    const Vec3d a = to_double(facet.a);
    Vec3d normal = camera_.turned(cross(to_double(facet.b) - a, to_double(facet.c) - a));
    const Vec3d towards = camera_.turned(camera_.to_model({0, 0, 0}) - camera_.to_model({0, 0, 1}));
    is_inside = dot(normal, towards) < 0;
    if (is_inside) normal = -normal;
    const std::uint32_t of = scene_.has_spheres ? void_of_[part_of(hit.triangle)] : kNone;
    // Facets of spheres are shown as what they stand for.
    if (of != kNone) {
      const SceneVoid& sphere = scene_.voids[of];
      const Vec3d inward = sphere.place - place_of(p, hit);
      const double distance = length(inward);
      if (std::abs(distance - sphere.radius) <= 2 * scene_.tolerance + 1e-3 * sphere.radius)
        normal = camera_.turned(inward);
    }
    const double size = length(normal);
    return size > 0 ? normal * (1 / size) : Vec3d{0, 0, -1};
  }

  // From 0 in the plane of the cut to 1 for what is farthest.
  double depth_share(const RayHit& hit) const {
    return depth_ > 0 ? std::clamp(hit.depth / depth_, 0.0, 1.0) : 0.0;
  }

 private:
  const Scene& scene_;
  const Camera& camera_;
  double depth_;
  SceneRays rays_;
  std::vector<std::uint32_t> void_of_;
};

// What is left between points of voids' walls and the model's surface, up to `most`: what is thicker is thick enough.
class WallLeft {
 public:
  WallLeft(const Scene& scene, double most)
      : bvh_(scene.mesh.positions, outer_triangles(scene)), most_squared_(most * most) {}

  // What is left at a point, and the facet that is nearest to it: one nearby is no farther from the next point than it is.
  struct Known {
    std::uint32_t facet = kNone;
    double left = 0;
  };
  // `known`, of any point, becomes that of this one.
  void find(Vec3d p, Known& known) const {
    const kernels::TriangleBvhView& bvh = bvh_.view();
    kernels::NearestFacet nearest{most_squared_, kNone};
    if (known.facet != kNone) {
      const double to_it = kernels::distance_squared_to_facet(p, bvh.facets[known.facet]);
      if (to_it < most_squared_) nearest = {to_it, known.facet};
    }
    nearest = bvh.nearer_than(p, nearest);
    known = {nearest.facet, std::sqrt(nearest.distance_squared)};
  }

 private:
  static std::vector<Triangle> outer_triangles(const Scene& scene) {
    std::vector<Triangle> triangles;
    for (const PartKind kind : {PartKind::outer, PartKind::remnant})
      for (const SolidPart& part : parts_of(scene, kind)) {
        const auto own = triangles_of(scene.mesh, part);
        triangles.insert(triangles.end(), own.begin(), own.end());
      }
    return triangles;
  }
  kernels::HostTriangleBvh bvh_;
  double most_squared_;
};

// From the thinnest wall of a void on; nothing where none is known.
std::optional<ColourRange> range_of_walls(const Scene& scene) {
  constexpr double kThick = 3, kLeast = 1e-3;
  double thinnest = kInfinity;
  for (const SceneVoid& each : scene.voids) thinnest = std::min(thinnest, each.wall.value_or(kInfinity));
  if (!(thinnest < kInfinity)) return std::nullopt;
  const double low = std::max(thinnest, kLeast);
  return ColourRange{.low = low, .high = kThick * low, .is_clipped = true, .is_turned = true};
}

ColourRange range_of_radii(const Scene& scene) {
  ColourRange range{kInfinity, 0};
  for (const SceneVoid& each : scene.voids) {
    range.low = std::min(range.low, each.radius);
    range.high = std::max(range.high, each.radius);
  }
  if (!(range.low <= range.high)) return {};
  // Of one size but for rounding.
  if (range.high - range.low < 1e-3 * range.high) range.low = range.high;
  return range;
}

// Calls f(row) for every row of a view, and asks the monitor between pieces.
template <typename F>
void for_each_row(int count, Monitor& monitor, const F& f) {
  constexpr int kAtOnce = 128;
  for (int first = 0; first < count; first += kAtOnce) {
    monitor.check_interrupted();
    tbb::parallel_for(first, std::min(count, first + kAtOnce), f);
  }
}

// What is seen of the model, pixel by pixel.
class View {
 public:
  View(const Scene& scene, PictureColour colour, const PictureFrame& frame, const PictureLayout& layout,
       const Surface& surface, const std::vector<SectionLine>& lines, Monitor& monitor)
      : scene_(scene),
        frame_(frame),
        layout_(layout),
        surface_(surface),
        x0_(static_cast<int>(layout.view.x)),
        y0_(static_cast<int>(layout.view.y)),
        width_(static_cast<int>(layout.view.width)),
        height_(static_cast<int>(layout.view.height)),
        rows_(scene, lines, height_of_row(height_ * kRowsPerPixel - 1),
              1 / (kRowsPerPixel * frame.pixels_per_mm()),
              static_cast<std::size_t>(height_) * kRowsPerPixel) {
    const auto walls = colour == PictureColour::thickness ? range_of_walls(scene) : std::nullopt;
    range_ = walls ? *walls : range_of_radii(scene);
    if (walls) walls_.emplace(scene, range_.high);
    look(monitor);
  }

  void draw(Image& image, Monitor& monitor) const {
    std::vector<Colour> middles(seen_.size(), kPaper);
    for_each_row(height_, monitor, [&](int y) {
      for (int x = 0; x < width_; ++x)
        middles[index(x, y)] = colour_of(pixel(x, y, 0.5, 0.5), seen_[index(x, y)]);
    });
    for_each_row(height_, monitor, [&](int y) {
      for (int x = 0; x < width_; ++x) {
        const bool is_smooth = !is_edge(x, y);
        image.set(x0_ + x, y0_ + y, is_smooth ? middles[index(x, y)] : mean_of_samples(x, y));
      }
    });
  }

  const ColourRange& range() const { return range_; }
  bool shows_walls_left() const { return walls_.has_value(); }
  bool shows_voids() const {
    return std::ranges::any_of(seen_, [](const Seen& seen) { return seen.of_void != kNone; });
  }
  bool shows_inside() const {
    return !scene_.is_closed && std::ranges::any_of(seen_, [](const Seen& seen) { return seen.is_inside; });
  }

  // Whether a place, in view coordinates, is before what is seen there.
  bool is_visible(Vec3d place) const {
    const double slack = 0.01 * std::max(surface_slack(), 1e-9);
    if (place.z < -slack) return false;
    const ViewPoint at{place.x, place.y};
    if (solid_at(at) != nullptr) return place.z <= slack;
    const auto hit = surface_.first(at);
    return !hit || hit->depth >= place.z - slack;
  }

 private:
  // What is seen at a point.
  struct Seen {
    std::uint32_t part = kNone;     // kNone: nothing
    std::uint32_t of_void = kNone;  // whose wall
    const SectionSpan* span = nullptr;
    bool is_inside = false;
    double light = 1;
    WallLeft::Known wall;  // where it is asked for
  };

  std::size_t index(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) + static_cast<std::size_t>(x);
  }
  PixelPoint pixel(int x, int y, double dx, double dy) const { return {x0_ + x + dx, y0_ + y + dy}; }
  double surface_slack() const { return (layout_.view.width + layout_.view.height) / frame_.pixels_per_mm(); }
  // Rows go up, pixels down.
  double height_of_row(int from_top) const {
    return frame_.in_view({0, y0_ + (from_top + 0.5) / kRowsPerPixel}).y;
  }
  const std::vector<SectionSpan>& row_at(double pixel_y) const {
    const int from_top = static_cast<int>(std::floor((pixel_y - y0_) * kRowsPerPixel));
    const int last = height_ * kRowsPerPixel - 1;
    return rows_.row(static_cast<std::size_t>(last - std::clamp(from_top, 0, last)));
  }
  const SectionSpan* solid_at(ViewPoint view) const {
    const PixelPoint on_picture = frame_.on_picture({view.x, view.y, 0});
    return span_at(row_at(on_picture.y), view.x);
  }

  // `known`: of a point nearby, if any
  Seen seen_at(PixelPoint on_picture, WallLeft::Known& known) const {
    Seen seen;
    const ViewPoint p = frame_.in_view(on_picture);
    seen.span = span_at(row_at(on_picture.y), p.x);
    if (seen.span != nullptr) {
      seen.part = seen.span->part;
      if (seen.span->kind == SectionSpan::Kind::modifier) seen.of_void = surface_.void_of_part(seen.part);
      return seen;
    }
    const auto hit = surface_.first(p);
    if (!hit) return seen;
    const std::size_t part = surface_.part_of(hit->triangle);
    seen.part = static_cast<std::uint32_t>(part);
    seen.of_void = surface_.void_of_part(part);
    // Light falls from the upper left, from before; what is deep in a void gets less of it.
    const Vec3d normal = surface_.normal_at(p, *hit, seen.is_inside);
    constexpr Vec3d kTowardsLight{-0.42, 0.62, -0.66};
    constexpr double kAmbient = 0.52;
    const double direct = std::max(dot(normal, kTowardsLight), 0.0);
    const PartKind kind = scene_.parts[part].kind;
    const double depth = kind == PartKind::outer || kind == PartKind::remnant ? 0.12 : 0.3;
    seen.light = (kAmbient + (1.08 - kAmbient) * direct) * (1 - depth * surface_.depth_share(*hit));
    if (walls_ && seen.of_void != kNone) {
      walls_->find(surface_.place_of(p, *hit), known);
      seen.wall = known;
    }
    return seen;
  }

  void look(Monitor& monitor) {
    seen_.resize(static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_));
    for_each_row(height_, monitor, [&](int y) {
      WallLeft::Known known;
      for (int x = 0; x < width_; ++x) seen_[index(x, y)] = seen_at(pixel(x, y, 0.5, 0.5), known);
    });
  }

  Colour colour_of(PixelPoint on_picture, const Seen& seen) const {
    if (seen.span != nullptr) return colour_of_cut(on_picture, seen);
    if (seen.part == kNone) return kPaper;
    return lit(colour_of_wall(on_picture, seen), seen.light);
  }

  Colour colour_of_cut(PixelPoint on_picture, const Seen& seen) const {
    switch (seen.span->kind) {
      case SectionSpan::Kind::solid:
        return mixed(kSolid, kHatch, hatch_share(on_picture, layout_.unit, false));
      case SectionSpan::Kind::overlap:
        return mixed(kSolid, kOverlap, hatch_share(on_picture, layout_.unit, true));
      case SectionSpan::Kind::modifier:
        break;
    }
    return mixed(mixed(kPaper, colour_of_void(seen), 0.55), kHatch,
                 hatch_share(on_picture, layout_.unit, true));
  }

  Colour colour_of_wall(PixelPoint on_picture, const Seen& seen) const {
    constexpr double kFaintly = 0.45;
    switch (scene_.parts[seen.part].kind) {
      case PartKind::outer:
      case PartKind::remnant:
        return seen.is_inside && !scene_.is_closed ? kInside : kOuter;
      case PartKind::channel:
        return mixed(kChannel, kInk, kFaintly * hatch_share(on_picture, layout_.unit, false));
      case PartKind::hole:
        return mixed(kHole, kInk, kFaintly * hatch_share(on_picture, layout_.unit, true));
      case PartKind::void_surface:
        break;
    }
    return seen.of_void == kNone ? kOuter : colour_of_void(seen);
  }

  Colour colour_of_void(const Seen& seen) const {
    // In a modifier's cut face there is no wall to measure.
    if (walls_) return seen.span != nullptr ? kOuter : range_.colour_of(seen.wall.left);
    return range_.colour_of(scene_.voids[seen.of_void].radius);
  }

  static Colour lit(Colour colour, double light) {
    const auto scaled = [light](std::uint8_t value) {
      return static_cast<std::uint8_t>(std::clamp(value * light + 0.5, 0.0, 255.0));
    };
    return {scaled(colour.red), scaled(colour.green), scaled(colour.blue)};
  }

  // Whether what is seen changes within the pixel or beside it.
  bool is_edge(int x, int y) const {
    const Seen& here = seen_[index(x, y)];
    if (scene_.is_closed && changes_within(x, y)) return true;
    if (here.span != nullptr) return false;
    constexpr double kVisible = 0.03;  // of light
    for (const auto& [dx, dy] : {std::pair{-1, 0}, {1, 0}, {0, -1}, {0, 1}}) {
      if (x + dx < 0 || y + dy < 0 || x + dx >= width_ || y + dy >= height_) continue;
      const Seen& there = seen_[index(x + dx, y + dy)];
      if (there.span != nullptr) continue;
      if (there.part != here.part) return true;
      if (std::abs(there.light - here.light) > kVisible) return true;
    }
    return false;
  }

  // Whether the rim of a cut face passes through the pixel.
  bool changes_within(int x, int y) const {
    const double left = frame_.in_view(pixel(x, y, 0, 0)).x, right = frame_.in_view(pixel(x, y, 1, 0)).x;
    const SectionSpan* const middle = seen_[index(x, y)].span;
    for (int sub = 0; sub < kRowsPerPixel; ++sub) {
      const auto& row = row_at(y0_ + y + (sub + 0.5) / kRowsPerPixel);
      const SectionSpan* const at_left = span_at(row, left);
      const SectionSpan* const at_right = span_at(row, right);
      if (at_left != at_right || (at_left == nullptr) != (middle == nullptr)) return true;
    }
    return false;
  }

  Colour mean_of_samples(int x, int y) const {
    int red = 0, green = 0, blue = 0;
    WallLeft::Known known = seen_[index(x, y)].wall;
    for (int sub = 0; sub < kRowsPerPixel; ++sub) {
      const PixelPoint p = pixel(x, y, kAside[static_cast<std::size_t>(sub)], (sub + 0.5) / kRowsPerPixel);
      const Seen seen = seen_at(p, known);
      // Lines of hatching are smooth about the middle.
      const Colour colour = colour_of(seen.span != nullptr ? pixel(x, y, 0.5, 0.5) : p, seen);
      red += colour.red;
      green += colour.green;
      blue += colour.blue;
    }
    const auto mean = [](int sum) {
      return static_cast<std::uint8_t>((sum + kRowsPerPixel / 2) / kRowsPerPixel);
    };
    return {mean(red), mean(green), mean(blue)};
  }

  const Scene& scene_;
  const PictureFrame& frame_;
  const PictureLayout& layout_;
  const Surface& surface_;
  int x0_, y0_, width_, height_;
  SectionRows rows_;
  std::optional<WallLeft> walls_;
  std::vector<Seen> seen_;
  ColourRange range_;
};

// The rim of what was cut, in the colour of what it bounds.
void draw_section(Image& image, const Scene& scene, const PictureFrame& frame, const PictureLayout& layout,
                  const std::vector<SectionLine>& lines) {
  for (const SectionLine& line : lines) {
    const PixelPoint from = frame.on_picture({line.from.x, line.from.y, 0});
    const PixelPoint to = frame.on_picture({line.to.x, line.to.y, 0});
    const PartKind kind = scene.parts[line.part].kind;
    const bool is_tube = kind == PartKind::channel || kind == PartKind::hole;
    const double width = (is_tube || !scene.is_closed ? 2.6 : 1.2) * layout.unit;
    const Colour colour = kind == PartKind::channel ? kChannel : kind == PartKind::hole ? kHole : kInk;
    draw_line(image, from, to, width, colour);
  }
}

bool is_on(const PixelRoom& room, PixelPoint p) {
  return p.x >= room.x && p.y >= room.y && p.x <= room.x + room.width && p.y <= room.y + room.height;
}

// Numbers stand beside their places, clear of each other.
class MarkNumbers {
 public:
  MarkNumbers(Image& image, const PictureLayout& layout) : image_(image), layout_(layout) {}

  void draw(PixelPoint place, std::size_t number, MarkKind kind, bool is_hidden) {
    const double unit = layout_.unit;
    const PixelPoint at = free_beside(place);
    draw_line(image_, place, at, 3.4 * unit, kPaper);
    draw_line(image_, place, at, 1.6 * unit, colour_of(kind));
    fill_disc(image_, place, 4.4 * unit, kPaper);
    fill_disc(image_, place, 3.2 * unit, colour_of(kind));
    if (is_hidden) fill_disc(image_, place, 1.8 * unit, kPaper);
    draw_mark_number(image_, at, number, kind, is_hidden, layout_);
    taken_.push_back(at);
    taken_.push_back(place);
  }

 private:
  PixelPoint free_beside(PixelPoint place) const {
    const double unit = layout_.unit;
    for (const double away : {26.0, 44.0, 64.0})
      for (const auto& [dx, dy] : {std::pair{0.7, -0.7},
                                   {-0.7, -0.7},
                                   {1.0, 0.0},
                                   {-1.0, 0.0},
                                   {0.7, 0.7},
                                   {-0.7, 0.7},
                                   {0.0, -1.0},
                                   {0.0, 1.0}}) {
        const PixelPoint at{place.x + away * dx * unit, place.y + away * dy * unit};
        const bool is_free = std::ranges::none_of(taken_, [&](PixelPoint other) {
          const double ox = other.x - at.x, oy = other.y - at.y;
          return ox * ox + oy * oy < 20 * 20 * unit * unit;
        });
        if (is_free && is_on(layout_.view, at)) return at;
      }
    return {place.x, place.y - 26 * unit};
  }

  Image& image_;
  const PictureLayout& layout_;
  std::vector<PixelPoint> taken_;
};

// True if a place is hidden.
bool draw_marks(Image& image, const Scene& scene, const PictureFrame& frame, const PictureLayout& layout,
                const View& view) {
  const double unit = layout.unit;
  for (const SceneMark& mark : scene.marks)
    for (const auto& [from, to] : mark.lines) {
      const PixelPoint a = frame.pixel_of(from), b = frame.pixel_of(to);
      const bool is_seen = view.is_visible(frame.camera().to_view((from + to) * 0.5));
      if (is_seen) draw_line(image, a, b, 4.6 * unit, kPaper);
      draw_line(image, a, b, (is_seen ? 2.8 : 1.2) * unit, colour_of(mark.kind), is_seen ? 1 : 0.5);
    }
  MarkNumbers numbers(image, layout);
  bool has_hidden = false;
  for (std::size_t i = 0; i < layout.marks; ++i) {
    const SceneMark& mark = scene.marks[i];
    const bool is_hidden = !view.is_visible(frame.camera().to_view(mark.place));
    has_hidden = has_hidden || is_hidden;
    numbers.draw(frame.pixel_of(mark.place), i + 1, mark.kind, is_hidden);
  }
  return has_hidden;
}

}  // namespace

Colour scale_colour(double share) {
  constexpr std::array<Colour, 10> kViridis{{{68, 1, 84},
                                             {72, 40, 120},
                                             {62, 74, 137},
                                             {49, 104, 142},
                                             {38, 130, 142},
                                             {31, 158, 137},
                                             {53, 183, 121},
                                             {110, 206, 88},
                                             {181, 222, 43},
                                             {253, 231, 37}}};
  const double place = std::clamp(share, 0.0, 1.0) * (kViridis.size() - 1);
  const auto below = std::min(static_cast<std::size_t>(place), kViridis.size() - 2);
  return mixed(kViridis[below], kViridis[below + 1], place - static_cast<double>(below));
}

Picture draw_picture(const Scene& scene, const PictureRequest& request, Monitor& monitor) {
  const Cut cut = cut_for(scene, request);
  const Camera camera(bounding_box(scene.mesh), cut, scene.up);
  const std::vector<Vec3d> corners = corners_in_view(scene.mesh, camera);
  const std::vector<SectionLine> lines = section_of(scene, corners);
  const Extent extent = extent_of(scene.mesh, corners, lines);
  const PictureLayout layout = layout_of(scene, request);
  const PictureFrame frame = frame_for(extent, camera, layout.view);
  const Surface surface(scene, camera, corners, extent.depth);
  const View view(scene, request.colour, frame, layout, surface, lines, monitor);

  Picture picture{Image(request.width, request.height, kPaper), frame, cut};
  view.draw(picture.image, monitor);
  draw_section(picture.image, scene, frame, layout, lines);
  const bool has_hidden_marks = draw_marks(picture.image, scene, frame, layout, view);
  draw_captions(picture.image, layout,
                {.scene = scene,
                 .cut = cut,
                 .frame = frame,
                 .colour = view.shows_walls_left() ? PictureColour::thickness : PictureColour::radius,
                 .range = view.range(),
                 .shows_voids = view.shows_voids(),
                 .shows_inside = view.shows_inside(),
                 .has_hidden_marks = has_hidden_marks});
  return picture;
}

}  // namespace aerate
