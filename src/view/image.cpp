#include "view/image.h"

#include <algorithm>
#include <cmath>

namespace aerate {
namespace {

struct PixelBox {
  int x0, y0, x1, y1;  // last ones included
};

PixelBox box_within(const Image& image, double x0, double y0, double x1, double y1) {
  const auto whole = [](double value, int most) {
    return static_cast<int>(std::clamp(std::floor(value), -1.0, static_cast<double>(most)));
  };
  return {std::max(whole(x0, image.width()), 0), std::max(whole(y0, image.height()), 0),
          std::min(whole(x1, image.width()), image.width() - 1),
          std::min(whole(y1, image.height()), image.height() - 1)};
}

// How much of a pixel is on the inner side of an edge `depth` pixels from its middle.
double covered(double depth) {
  return std::clamp(depth + 0.5, 0.0, 1.0);
}

// share_at(middle of a pixel) says how much of it is covered.
template <typename ShareAt>
void cover(Image& image, const PixelBox& box, Colour colour, const ShareAt& share_at) {
  for (int y = box.y0; y <= box.y1; ++y)
    for (int x = box.x0; x <= box.x1; ++x) image.blend(x, y, colour, share_at(PixelPoint{x + 0.5, y + 0.5}));
}

}  // namespace

Colour mixed(Colour first, Colour second, double share) {
  const auto mix = [share](std::uint8_t a, std::uint8_t b) {
    return static_cast<std::uint8_t>(std::clamp(a + (b - a) * share + 0.5, 0.0, 255.0));
  };
  return {mix(first.red, second.red), mix(first.green, second.green), mix(first.blue, second.blue)};
}

void Image::blend(int x, int y, Colour colour, double share) {
  if (share <= 0 || x < 0 || y < 0 || x >= width_ || y >= height_) return;
  Colour& pixel = pixels_[index(x, y)];
  pixel = mixed(pixel, colour, std::min(share, 1.0));
}

void fill_rectangle(Image& image, PixelPoint corner, double width, double height, Colour colour) {
  const double x1 = corner.x + width, y1 = corner.y + height;
  const auto overlap = [](double middle, double from, double to) {
    return std::clamp(std::min(middle + 0.5, to) - std::max(middle - 0.5, from), 0.0, 1.0);
  };
  cover(image, box_within(image, corner.x, corner.y, x1, y1), colour,
        [&](PixelPoint p) { return overlap(p.x, corner.x, x1) * overlap(p.y, corner.y, y1); });
}

void draw_line(Image& image, PixelPoint from, PixelPoint to, double width, Colour colour, double share) {
  const double reach = width / 2 + 1;
  const double dx = to.x - from.x, dy = to.y - from.y, extent = dx * dx + dy * dy;
  const PixelBox box = box_within(image, std::min(from.x, to.x) - reach, std::min(from.y, to.y) - reach,
                                  std::max(from.x, to.x) + reach, std::max(from.y, to.y) + reach);
  cover(image, box, colour, [&](PixelPoint p) {
    const double along =
        extent > 0 ? std::clamp(((p.x - from.x) * dx + (p.y - from.y) * dy) / extent, 0.0, 1.0) : 0.0;
    const double ox = p.x - from.x - along * dx, oy = p.y - from.y - along * dy;
    return share * covered(width / 2 - std::sqrt(ox * ox + oy * oy));
  });
}

void fill_disc(Image& image, PixelPoint centre, double radius, Colour colour) {
  draw_line(image, centre, centre, 2 * radius, colour);
}

void fill_polygon(Image& image, std::span<const PixelPoint> corners, Colour colour) {
  if (corners.size() < 3) return;
  double x0 = corners[0].x, x1 = x0, y0 = corners[0].y, y1 = y0, area = 0;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const PixelPoint a = corners[i], b = corners[(i + 1) % corners.size()];
    x0 = std::min(x0, a.x);
    x1 = std::max(x1, a.x);
    y0 = std::min(y0, a.y);
    y1 = std::max(y1, a.y);
    area += a.x * b.y - a.y * b.x;
  }
  const double side = area > 0 ? 1 : -1;
  cover(image, box_within(image, x0 - 1, y0 - 1, x1 + 1, y1 + 1), colour, [&](PixelPoint p) {
    double depth = 1;
    for (std::size_t i = 0; i < corners.size(); ++i) {
      const PixelPoint a = corners[i], b = corners[(i + 1) % corners.size()];
      const double dx = b.x - a.x, dy = b.y - a.y, extent = std::sqrt(dx * dx + dy * dy);
      if (extent > 0) depth = std::min(depth, side * (dx * (p.y - a.y) - dy * (p.x - a.x)) / extent);
    }
    return covered(depth);
  });
}

}  // namespace aerate
