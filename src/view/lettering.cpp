#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "view/image.h"

namespace aerate {
namespace {

// Strokes of the printable characters from '!' on, on a grid on which capitals are 12 high: baseline at 4, capitals up to 16,
// small letters to 12, tails down to 0. A point is two digits of base 36. '-' joins points by straight lines, '~' by a
// quadratic B-spline that ends in the first and the last, 'o' by a closed one.
constexpr std::array<std::string_view, 94> kStrokes{
    "-0g08 -0405",                            // !
    "-0g0d -3g3d",                            // "
    "-243g -647g -0898 -0c9c",                // #
    "~8d7g4g0g0d0a4a8a8784441407 -4h43",      // $
    "o0c4c4g0g o64a4a868 -149g",              // %
    "~842d2g6g6d0904548a",                    // &
    "-0g0d",                                  // '
    "~3h0e0633",                              // (
    "~0h3e3603",                              // )
    "-3g3a -0e6c -0c6e",                      // *
    "-0989 -4d45",                            // +
    "-1402",                                  // ,
    "-0959",                                  // -
    "-0405",                                  // .
    "-036h",                                  // /
    "o04848g0g",                              // 0
    "-1d4g44",                                // 1
    "~0d0g4g8g8c8904 -0484",                  // 2
    "~0e1g4g8g8d8a4a ~4a8a8784441406",        // 3
    "-646g0888",                              // 4
    "-7g1g0a ~0a2b4b8b8884441406",            // 5
    "o04848b0b ~7f6g4g0g0a07",                // 6
    "-0g8g34",                                // 7
    "o1a7a7g1g o04848a0a",                    // 8
    "o09898g0g ~8d8a84442415",                // 9
    "-0405 -0b0c",                            // :
    "-1402 -1b1c",                            // ;
    "-7e0974",                                // <
    "-0b8b -0787",                            // =
    "-0e7904",                                // >
    "~0d0g3g7g7d3a38 -3435",                  // ?
    "o04b4bg0g o37878d3d",                    // @
    "-044g84 -1878",                          // A
    "-040g ~0g4g7g7d7a4a0a ~0a4a8a87844404",  // B
    "~8d7g4g0g0a04447487",                    // C
    "-040g ~0g3g8g8a843404",                  // D
    "-8g0g0484 -0a6a",                        // E
    "-8g0g04 -0a6a",                          // F
    "~8d7g4g0g0a04448489 -8959",              // G
    "-040g -848g -0a8a",                      // H
    "-040g",                                  // I
    "~6g6a64340407",                          // J
    "-040g -8g09 -3b84",                      // K
    "-0g0474",                                // L
    "-040g58aga4",                            // M
    "-040g848g",                              // N
    "o04949g0g",                              // O
    "-040g ~0g4g8g8c894909",                  // P
    "o04949g0g -5893",                        // Q
    "-040g ~0g4g8g8c894909 -4984",            // R
    "~8d7g4g0g0d0a4a8a8784441407",            // S
    "-0g8g -4g44",                            // T
    "~0g08044484888g",                        // U
    "-0g448g",                                // V
    "-0g346e94cg",                            // W
    "-0g84 -048g",                            // X
    "-0g4a8g -4a44",                          // Y
    "-0g8g0484",                              // Z
    "-3h0h0333",                              // [
    "-0h63",                                  // backslash
    "-0h3h3303",                              // ]
    "-0c3g6c",                                // ^
    "-0383",                                  // _
    "-0g2e",                                  // `
    "o04747c0c -7c74",                        // a
    "-0g04 o04747c0c",                        // b
    "~7a6c4c0c0804446476",                    // c
    "-7g74 o04747c0c",                        // d
    "-0878 ~787c0c0804446476",                // e
    "~6g2g2c24 -0c5c",                        // f
    "o04747c0c ~7c7470301002",                // g
    "-0g04 ~090c3c7c7974",                    // h
    "-0c04 -0f0g",                            // i
    "~3c333000 -3f3g",                        // j
    "-0g04 -6c07 -2964",                      // k
    "~0g060424",                              // l
    "-0c04 ~090c3c5c5954 ~595c8caca9a4",      // m
    "-0c04 ~090c3c7c7974",                    // n
    "o04747c0c",                              // o
    "-0c00 o04747c0c",                        // p
    "-7c70 o04747c0c",                        // q
    "-0c04 ~090c3c5c",                        // r
    "~6a5c3c0c0a0838686664341406",            // s
    "~2f262454 -0c5c",                        // t
    "~0c0704347477 -7c74",                    // u
    "-0c346c",                                // v
    "-0c245b84ac",                            // w
    "-0c64 -046c",                            // x
    "-0c34 -6c10",                            // y
    "-0c6c0464",                              // z
    "-3h1g1b0a191433",                        // {
    "-0h02",                                  // |
    "-0h2g2b3a292403",                        // }
    "~091c3b58788b",                          // ~
};
constexpr std::string_view kBox = "-040g6g6404";
constexpr double kBaseline = 4, kCapital = 12, kBetween = 3.4, kSpace = 6;

struct Segment {
  PixelPoint from, to;
};

struct Glyph {
  std::vector<Segment> segments;
  double width = 0;
};

int digit(char c) {
  return c <= '9' ? c - '0' : c - 'a' + 10;
}

PixelPoint middle(PixelPoint a, PixelPoint b) {
  return {(a.x + b.x) / 2, (a.y + b.y) / 2};
}

void add_curve(std::vector<PixelPoint>& line, PixelPoint from, PixelPoint control, PixelPoint to) {
  constexpr int kSteps = 6;
  for (int step = 1; step <= kSteps; ++step) {
    const double t = static_cast<double>(step) / kSteps, s = 1 - t;
    line.push_back({s * s * from.x + 2 * s * t * control.x + t * t * to.x,
                    s * s * from.y + 2 * s * t * control.y + t * t * to.y});
  }
}

// The points of a stroke as a chain.
std::vector<PixelPoint> chain_of(std::string_view stroke) {
  std::vector<PixelPoint> points;
  for (std::size_t i = 1; i + 1 < stroke.size(); i += 2)
    points.push_back({static_cast<double>(digit(stroke[i])), static_cast<double>(digit(stroke[i + 1]))});
  if (stroke[0] == '-' || points.size() < 3) return points;
  std::vector<PixelPoint> line;
  const std::size_t count = points.size();
  if (stroke[0] == 'o') {
    line.push_back(middle(points[count - 1], points[0]));
    for (std::size_t i = 0; i < count; ++i)
      add_curve(line, line.back(), points[i], middle(points[i], points[(i + 1) % count]));
    return line;
  }
  line.push_back(points[0]);
  for (std::size_t i = 1; i + 1 < count; ++i)
    add_curve(line, line.back(), points[i],
              i + 2 == count ? points[i + 1] : middle(points[i], points[i + 1]));
  return line;
}

Glyph glyph_of(std::string_view strokes) {
  Glyph glyph;
  while (!strokes.empty()) {
    const std::size_t end = std::min(strokes.find(' '), strokes.size());
    const std::vector<PixelPoint> chain = chain_of(strokes.substr(0, end));
    for (std::size_t i = 0; i < chain.size(); ++i) {
      glyph.width = std::max(glyph.width, chain[i].x);
      if (i > 0) glyph.segments.push_back({chain[i - 1], chain[i]});
    }
    strokes.remove_prefix(std::min(end + 1, strokes.size()));
  }
  return glyph;
}

const Glyph& glyph_for(char c) {
  static const std::vector<Glyph> kGlyphs = [] {
    std::vector<Glyph> glyphs;
    glyphs.reserve(kStrokes.size() + 1);
    for (const std::string_view strokes : kStrokes) glyphs.push_back(glyph_of(strokes));
    glyphs.push_back(glyph_of(kBox));
    return glyphs;
  }();
  const auto place = static_cast<std::size_t>(static_cast<unsigned char>(c)) - '!';
  return kGlyphs[std::min(place, kStrokes.size())];
}

// Of a character in UTF-8 of several bytes only the first counts.
bool continues_character(char c) {
  return (static_cast<unsigned char>(c) & 0xC0U) == 0x80U;
}

double advance_of(char c) {
  if (continues_character(c)) return 0;
  return c == ' ' ? kSpace : glyph_for(c).width + kBetween;
}

double pen_of(const Lettering& lettering) {
  return std::max(lettering.size / (lettering.is_bold ? 5.5 : 8.0), lettering.is_bold ? 1.6 : 1.15);
}

double distance_to(const Segment& segment, PixelPoint p) {
  const double dx = segment.to.x - segment.from.x, dy = segment.to.y - segment.from.y;
  const double extent = dx * dx + dy * dy;
  const double px = p.x - segment.from.x, py = p.y - segment.from.y;
  const double along = extent > 0 ? std::clamp((px * dx + py * dy) / extent, 0.0, 1.0) : 0.0;
  const double ox = px - along * dx, oy = py - along * dy;
  return std::sqrt(ox * ox + oy * oy);
}

// Strokes that meet cover their pixels once.
void draw_glyph(Image& image, PixelPoint origin, const Glyph& glyph, const Lettering& lettering) {
  const double scale = lettering.size / kCapital, pen = pen_of(lettering) / 2;
  std::vector<Segment> segments;
  segments.reserve(glyph.segments.size());
  const auto placed = [&](PixelPoint p) {
    return PixelPoint{origin.x + p.x * scale, origin.y - (p.y - kBaseline) * scale};
  };
  for (const Segment& segment : glyph.segments)
    segments.push_back({placed(segment.from), placed(segment.to)});
  const int x0 = static_cast<int>(std::floor(origin.x - 2)),
            y0 = static_cast<int>(std::floor(origin.y - 14 * scale - 2));
  const int x1 = static_cast<int>(std::ceil(origin.x + glyph.width * scale + 2));
  const int y1 = static_cast<int>(std::ceil(origin.y + kBaseline * scale + 2));
  for (int y = y0; y <= y1; ++y)
    for (int x = x0; x <= x1; ++x) {
      double nearest = 1e9;
      for (const Segment& segment : segments)
        nearest = std::min(nearest, distance_to(segment, {x + 0.5, y + 0.5}));
      image.blend(x, y, lettering.colour, std::clamp(pen - nearest + 0.5, 0.0, 1.0));
    }
}

}  // namespace

double width_of_text(std::string_view text, const Lettering& lettering) {
  double width = 0;
  for (const char c : text) width += advance_of(c);
  return std::max(width - kBetween, 0.0) * lettering.size / kCapital;
}

void draw_text(Image& image, PixelPoint start, std::string_view text, const Lettering& lettering) {
  for (const char c : text) {
    if (c != ' ' && !continues_character(c)) draw_glyph(image, start, glyph_for(c), lettering);
    start.x += advance_of(c) * lettering.size / kCapital;
  }
}

std::string text_that_fits(std::string_view text, double width, const Lettering& lettering) {
  if (width_of_text(text, lettering) <= width) return std::string(text);
  constexpr std::string_view kMissing = "..";
  const double room = width - width_of_text(kMissing, lettering);
  std::size_t length = 0;
  double taken = 0;
  while (length < text.size()) {
    taken += advance_of(text[length]) * lettering.size / kCapital;
    if (taken > room) break;
    ++length;
  }
  while (length > 0 && continues_character(text[length])) --length;
  return std::string(text.substr(0, length)) + std::string(kMissing);
}

}  // namespace aerate
