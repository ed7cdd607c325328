#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "view/image.h"
#include "view/picture.h"
#include "view/scene.h"

// What stands where on a picture, and all of it that is not the model itself.

namespace aerate {

struct PixelRoom {
  double x = 0, y = 0, width = 0, height = 0;

  PixelPoint middle() const { return {x + width / 2, y + height / 2}; }
};

// Values of the scale of colours at its ends.
struct ColourRange {
  double low = 0, high = 0;  // mm
  bool is_clipped = false;   // there are larger ones
  bool is_turned = false;    // small values stand out

  Colour colour_of(double value) const {
    const double share = high > low ? (value - low) / (high - low) : 0.5;
    return scale_colour(is_turned ? 1 - share : share);
  }
};

struct PictureLayout {
  double unit = 1;        // pixels to a point of a picture of 1,000 x 800
  PixelRoom view;         // of the model
  PixelRoom legend;       // right of it
  PixelRoom caption;      // below
  std::size_t marks = 0;  // so many have a number and a line in the caption

  Lettering body(Colour colour = picture_colours::kInk) const { return {9.5 * unit, colour, false}; }
  double line_height() const { return 19 * unit; }
};

PictureLayout layout_of(const Scene& scene, const PictureRequest& request);

// Title, scale bar, legend, figures, the marks in words.
struct CaptionContent {
  const Scene& scene;
  const Cut& cut;
  const PictureFrame& frame;
  PictureColour colour = PictureColour::radius;
  ColourRange range;
  bool shows_voids = false;   // is any coloured wall to be seen
  bool shows_inside = false;  // of a surface that is not closed
  bool has_hidden_marks = false;
};
void draw_captions(Image& image, const PictureLayout& layout, const CaptionContent& content);

// A mark's number on a disc in the colour of its kind, empty where its place is hidden.
void draw_mark_number(Image& image, PixelPoint centre, std::size_t number, MarkKind kind, bool is_hidden,
                      const PictureLayout& layout);
Colour colour_of(MarkKind kind);

// The pattern of lines of a cut face: how much of a pixel is ink.
double hatch_share(PixelPoint pixel, double unit, bool is_crossed);

}  // namespace aerate
