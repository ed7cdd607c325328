#include "view/picture_layout.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace aerate {
namespace {

using namespace picture_colours;

constexpr std::size_t kMostMarks = 8;
constexpr double kMargin = 16;  // in units

double rounded_unit(const PictureRequest& request) {
  return std::clamp(std::min(request.width / 1000.0, request.height / 800.0), 0.62, 8.0);
}

std::size_t figure_rows(const Scene& scene, std::size_t columns) {
  return (scene.figures.size() + columns - 1) / columns;
}

const char* name_of(CutAxis axis) {
  return axis == CutAxis::x ? "x" : axis == CutAxis::y ? "y" : "z";
}

double extent_along(const Box3f& box, CutAxis axis) {
  const Vec3d size = to_double(box.upper) - to_double(box.lower);
  return axis == CutAxis::x ? size.x : axis == CutAxis::y ? size.y : size.z;
}

double low_end(const Box3f& box, CutAxis axis) {
  const Vec3d low = to_double(box.lower);
  return axis == CutAxis::x ? low.x : axis == CutAxis::y ? low.y : low.z;
}

// From where it is looked at, by name where that has one.
std::string side_of(const Scene& scene, const Cut& cut) {
  const std::string along = fmt::format("{}{}", cut.looks_along_axis ? "+" : "-", name_of(cut.axis));
  if (!(scene.up == Vec3d{0, 0, 1})) return "seen along " + along;
  const bool is_along = cut.looks_along_axis;
  const char* const side = cut.axis == CutAxis::x   ? (is_along ? "the left" : "the right")
                           : cut.axis == CutAxis::y ? (is_along ? "the front" : "behind")
                                                    : (is_along ? "below" : "above");
  return fmt::format("seen from {} (along {})", side, along);
}

std::string describe(const Scene& scene, const Cut& cut) {
  const std::string seen = side_of(scene, cut);
  if (cut.is_whole()) return "not cut, " + seen;
  const Box3f box = bounding_box(scene.mesh);
  const double place = low_end(box, cut.axis) + cut.share * extent_along(box, cut.axis);
  return fmt::format("cut at {} = {:.2f} mm ({:.0f} % of its extent), {}", name_of(cut.axis), place + 0.0,
                     100 * cut.share, seen);
}

void draw_title(Image& image, const PictureLayout& layout, const CaptionContent& content) {
  const double unit = layout.unit, width = image.width() - 2 * kMargin * unit;
  const Lettering title{13 * unit, kInk, true};
  const std::string name = text_that_fits(content.scene.title, width, title);
  draw_text(image, {kMargin * unit, 32 * unit}, name, title);
  const double after = width_of_text(name, title) + 14 * unit;
  if (after < width) {
    const Lettering is{11 * unit, kInk, false};
    draw_text(image, {kMargin * unit + after, 32 * unit}, text_that_fits(content.scene.is, width - after, is),
              is);
  }
  const Lettering faint = layout.body(kFaint);
  draw_text(image, {kMargin * unit, 54 * unit},
            text_that_fits(describe(content.scene, content.cut), width, faint), faint);
}

// 1, 2 or 5 times a power of ten, at most `most`.
double round_length(double most) {
  const double power = std::pow(10.0, std::floor(std::log10(most)));
  for (const double factor : {5.0, 2.0})
    if (factor * power <= most) return factor * power;
  return power;
}

void draw_scale_bar(Image& image, const PictureLayout& layout, const PictureFrame& frame) {
  const double unit = layout.unit, scale = frame.pixels_per_mm();
  const double length = round_length(0.28 * layout.view.width / scale);
  const double x = kMargin * unit, y = layout.caption.y - 14 * unit, thick = 5 * unit;
  constexpr int kFields = 4;
  const double field = length * scale / kFields;
  fill_rectangle(image, {x, y}, length * scale, thick, kInk);
  for (int i = 1; i < kFields; i += 2)
    fill_rectangle(image, {x + i * field + 0.8 * unit, y + unit}, field - 1.6 * unit, thick - 2 * unit,
                   kPaper);
  draw_text(image, {x + length * scale + 8 * unit, y + thick + 1.5 * unit}, fmt::format("{:g} mm", length),
            layout.body());
}

// Draws one thing below the other.
class Legend {
 public:
  Legend(Image& image, const PictureLayout& layout)
      : image_(image), layout_(layout), unit_(layout.unit), y_(layout.legend.y) {}

  bool has_room(double units) const { return y_ + units * unit_ <= layout_.legend.y + layout_.legend.height; }

  void colour_bar(const std::string& what, const ColourRange& range) {
    if (!has_room(178)) return;
    text(what, 0);
    y_ += 8 * unit_;
    const double height = 130 * unit_, width = 18 * unit_, x = layout_.legend.x;
    for (int row = static_cast<int>(y_); row < static_cast<int>(y_ + height); ++row)
      fill_rectangle(image_, {x, static_cast<double>(row)}, width, 1,
                     range.colour_of(range.high - (range.high - range.low) * (row + 0.5 - y_) / height));
    const int ticks = range.high > range.low ? 4 : 0;
    for (int tick = 0; tick <= ticks; ++tick) {
      const double share = ticks > 0 ? static_cast<double>(tick) / ticks : 0.5;
      const double value = range.low + share * (range.high - range.low);
      const double at = y_ + height * (1 - share);
      draw_line(image_, {x + width, at}, {x + width + 5 * unit_, at}, unit_, kInk);
      draw_text(image_, {x + width + 10 * unit_, at + 4.5 * unit_},
                fmt::format("{:.3g}{}", value, range.is_clipped && tick == ticks ? " and more" : ""),
                layout_.body());
    }
    y_ += height + 26 * unit_;
  }

  enum class Pattern { plain, hatched, crossed };

  void swatch(Colour colour, Pattern pattern, Colour ink, const std::string& what) {
    if (!has_room(22)) return;
    const double width = 18 * unit_, height = 13 * unit_, x = layout_.legend.x;
    fill_rectangle(image_, {x - unit_, y_ - unit_}, width + 2 * unit_, height + 2 * unit_, kInk);
    fill_rectangle(image_, {x, y_}, width, height, colour);
    if (pattern != Pattern::plain) {
      for (int py = static_cast<int>(std::ceil(y_)); py < static_cast<int>(y_ + height); ++py)
        for (int px = static_cast<int>(std::ceil(x)); px < static_cast<int>(x + width); ++px)
          image_.blend(px, py, ink, hatch_share({px + 0.5, py + 0.5}, unit_, pattern == Pattern::crossed));
    }
    text(what, width + 9 * unit_);
    y_ += 8 * unit_;
  }

  void mark(MarkKind kind, bool is_hidden, const std::string& what) {
    if (!has_room(22)) return;
    const PixelPoint centre{layout_.legend.x + 9 * unit_, y_ + 6 * unit_};
    fill_disc(image_, centre, 7 * unit_, colour_of(kind));
    if (is_hidden) fill_disc(image_, centre, 5.2 * unit_, kPaper);
    text(what, 27 * unit_);
    y_ += 8 * unit_;
  }

 private:
  void text(const std::string& words, double indent) {
    const Lettering body = layout_.body();
    draw_text(image_, {layout_.legend.x + indent, y_ + 11 * unit_},
              text_that_fits(words, layout_.legend.width - indent, body), body);
    y_ += 14 * unit_;
  }

  Image& image_;
  const PictureLayout& layout_;
  double unit_, y_;
};

bool has_part(const Scene& scene, PartKind kind) {
  return std::ranges::any_of(scene.parts, [&](const SolidPart& part) { return part.kind == kind; });
}

const char* words_for_voids(VoidUse use) {
  switch (use) {
    case VoidUse::removed:
      return "void";
    case VoidUse::modifiers:
      return "modifier";
    case VoidUse::packed:
      return "sphere";
    case VoidUse::found:
      return "hollow";
  }
  return "";
}

const char* words_for(MarkKind kind) {
  switch (kind) {
    case MarkKind::ceiling:
      return "ceiling too wide";
    case MarkKind::thinnest_wall:
      return "thinnest place";
    case MarkKind::cup:
      return "cup";
    case MarkKind::hole_in_mesh:
      return "open edges";
    case MarkKind::bad_edges:
      return "bad edges";
    case MarkKind::crossing:
      return "crossing triangles";
  }
  return "";
}

void draw_legend(Image& image, const PictureLayout& layout, const CaptionContent& content) {
  const Scene& scene = content.scene;
  Legend legend(image, layout);
  if (content.shows_voids)
    legend.colour_bar(content.colour == PictureColour::radius
                          ? fmt::format("{} radius, mm", words_for_voids(scene.void_use))
                          : "wall left, mm",
                      content.range);
  if (scene.is_closed && !content.cut.is_whole()) {
    const bool stays = scene.void_use == VoidUse::modifiers;
    legend.swatch(kSolid, Legend::Pattern::hatched, kHatch, stays ? "model" : "solid");
    if (stays)
      legend.swatch(mixed(kPaper, scale_colour(0.5), 0.55), Legend::Pattern::crossed, kHatch, "modifier");
  }
  if (has_part(scene, PartKind::channel)) legend.swatch(kChannel, Legend::Pattern::hatched, kInk, "channel");
  if (has_part(scene, PartKind::hole)) legend.swatch(kHole, Legend::Pattern::crossed, kInk, "escape hole");
  legend.swatch(kOuter, Legend::Pattern::plain, kInk, "surface");
  if (content.shows_inside) legend.swatch(kInside, Legend::Pattern::plain, kInk, "its inner side");
  std::vector<MarkKind> kinds;
  for (const SceneMark& mark : scene.marks)
    if (std::ranges::find(kinds, mark.kind) == kinds.end()) kinds.push_back(mark.kind);
  std::ranges::sort(kinds);
  for (const MarkKind kind : kinds) legend.mark(kind, false, words_for(kind));
  if (content.has_hidden_marks) legend.mark(MarkKind::thinnest_wall, true, "hidden or cut off");
}

void draw_figures(Image& image, const PictureLayout& layout, const Scene& scene) {
  const double unit = layout.unit;
  const Lettering faint = layout.body(kFaint), body = layout.body();
  fill_rectangle(image, {kMargin * unit, layout.caption.y + 4 * unit}, image.width() - 2 * kMargin * unit,
                 unit, kFaint);
  double names = 0;
  for (const SceneFigure& figure : scene.figures) names = std::max(names, width_of_text(figure.name, faint));
  const double width = layout.caption.width / 2, bottom = layout.caption.y + layout.caption.height;
  const std::size_t rows = figure_rows(scene, 2);
  const double first = layout.caption.y + 24 * unit;
  for (std::size_t i = 0; i < scene.figures.size(); ++i) {
    const double x = layout.caption.x + (i < rows ? 0 : width);
    const double y = first + layout.line_height() * static_cast<double>(i < rows ? i : i - rows);
    if (y > bottom) continue;
    draw_text(image, {x, y}, scene.figures[i].name, faint);
    const double indent = names + 10 * unit;
    draw_text(image, {x + indent, y},
              text_that_fits(scene.figures[i].value, width - indent - 10 * unit, body), body);
  }
  double y = first + layout.line_height() * static_cast<double>(rows);
  for (std::size_t i = 0; i < layout.marks && y <= bottom; ++i, y += layout.line_height()) {
    draw_mark_number(image, {layout.caption.x + 8 * unit, y - 4.5 * unit}, i + 1, scene.marks[i].kind, false,
                     layout);
    const bool is_last = i + 1 == layout.marks && layout.marks < scene.marks.size();
    const std::string more =
        is_last ? fmt::format(" (and {} more)", scene.marks.size() - layout.marks) : std::string();
    const double room = layout.caption.width - 22 * unit - width_of_text(more, body);
    draw_text(image, {layout.caption.x + 22 * unit, y},
              text_that_fits(scene.marks[i].text, room, body) + more, body);
  }
}

}  // namespace

Colour colour_of(MarkKind kind) {
  switch (kind) {
    case MarkKind::ceiling:
      return {184, 92, 0};
    case MarkKind::thinnest_wall:
      return kInk;
    case MarkKind::cup:
      return {0, 90, 160};
    case MarkKind::hole_in_mesh:
    case MarkKind::bad_edges:
    case MarkKind::crossing:
      break;
  }
  return {200, 0, 30};
}

PictureLayout layout_of(const Scene& scene, const PictureRequest& request) {
  PictureLayout layout;
  layout.unit = rounded_unit(request);
  const double unit = layout.unit, margin = kMargin * unit;
  const double top = 64 * unit, bar = 34 * unit, most = 0.42 * request.height;
  layout.marks = std::min(scene.marks.size(), kMostMarks);
  const std::size_t lines = figure_rows(scene, 2) + layout.marks;
  const double caption =
      std::min(14 * unit + layout.line_height() * static_cast<double>(lines) + margin / 2, most);
  const double legend = std::min(190 * unit, 0.32 * request.width);
  layout.caption = {margin, request.height - caption, request.width - 2 * margin, caption};
  const double height = std::max(request.height - caption - bar - top, 20.0);
  layout.view = {margin, top, std::max(request.width - 3 * margin - legend, 20.0), height};
  layout.legend = {request.width - margin - legend, top + 6 * unit, legend, height + bar - 10 * unit};
  return layout;
}

void draw_mark_number(Image& image, PixelPoint centre, std::size_t number, MarkKind kind, bool is_hidden,
                      const PictureLayout& layout) {
  const double unit = layout.unit, radius = 8.5 * unit;
  const Colour colour = colour_of(kind);
  fill_disc(image, centre, radius + 1.2 * unit, kPaper);
  fill_disc(image, centre, radius, colour);
  if (is_hidden) fill_disc(image, centre, radius - 1.8 * unit, kPaper);
  const Lettering digits{8.5 * unit, is_hidden ? colour : kPaper, true};
  const std::string text = fmt::format("{}", number);
  draw_text(image, {centre.x - width_of_text(text, digits) / 2, centre.y + 4.25 * unit}, text, digits);
}

double hatch_share(PixelPoint pixel, double unit, bool is_crossed) {
  const double spacing = 8 * unit, half_width = 0.55 * unit;
  const auto ink = [&](double along) {
    const double shift = along - spacing * std::floor(along / spacing);
    return std::clamp(half_width - std::min(shift, spacing - shift) + 0.5, 0.0, 1.0);
  };
  constexpr double kDiagonal = 0.70710678118654757;
  const double rising = ink((pixel.x + pixel.y) * kDiagonal);
  return is_crossed ? std::max(rising, ink((pixel.x - pixel.y) * kDiagonal)) : rising;
}

void draw_captions(Image& image, const PictureLayout& layout, const CaptionContent& content) {
  draw_title(image, layout, content);
  draw_scale_bar(image, layout, content.frame);
  draw_legend(image, layout, content);
  draw_figures(image, layout, content.scene);
}

}  // namespace aerate
