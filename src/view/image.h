#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

// A picture in memory, and what is drawn on it with smooth edges. Pixels; x to the right, y down, whole numbers at pixels'
// corners.

namespace aerate {

struct Colour {
  std::uint8_t red = 255, green = 255, blue = 255;

  friend bool operator==(const Colour&, const Colour&) = default;
};

// `share` of the second, the rest of the first.
Colour mixed(Colour first, Colour second, double share);

struct PixelPoint {
  double x = 0, y = 0;
};

class Image {
 public:
  Image(int width, int height, Colour background)
      : width_(width),
        height_(height),
        pixels_(static_cast<std::size_t>(width) * static_cast<std::size_t>(height), background) {}

  int width() const { return width_; }
  int height() const { return height_; }
  const std::vector<Colour>& pixels() const { return pixels_; }
  Colour at(int x, int y) const { return pixels_[index(x, y)]; }
  void set(int x, int y, Colour colour) { pixels_[index(x, y)] = colour; }
  // Covers so much of a pixel; nothing where there is none.
  void blend(int x, int y, Colour colour, double share);

 private:
  std::size_t index(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) + static_cast<std::size_t>(x);
  }

  int width_, height_;
  std::vector<Colour> pixels_;
};

void fill_rectangle(Image& image, PixelPoint corner, double width, double height, Colour colour);

// With round ends. `share`: how much it covers.
void draw_line(Image& image, PixelPoint from, PixelPoint to, double width, Colour colour, double share = 1);

void fill_disc(Image& image, PixelPoint centre, double radius, Colour colour);

// Convex, in either direction.
void fill_polygon(Image& image, std::span<const PixelPoint> corners, Colour colour);

// Letters are strokes of a round pen, as on technical drawings (ISO 3098), so that they need no font file and look the same on
// every machine. Printable ASCII; other characters are boxes. `size`: height of capitals.
struct Lettering {
  double size = 10;
  Colour colour = {0, 0, 0};
  bool is_bold = false;
};
double width_of_text(std::string_view text, const Lettering& lettering);
// From `start`, left and on the baseline.
void draw_text(Image& image, PixelPoint start, std::string_view text, const Lettering& lettering);
// As much of the text as so many pixels hold, with ".." where something is missing.
std::string text_that_fits(std::string_view text, double width, const Lettering& lettering);

}  // namespace aerate
