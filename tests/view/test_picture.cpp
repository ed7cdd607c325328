#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <gtest/gtest.h>
#include <optional>
#include <png.h>
#include <string>
#include <tbb/global_control.h>
#include <tbb/task_arena.h>
#include <vector>

#include "core/error.h"
#include "tests/support/shapes.h"
#include "view/picture.h"
#include "view/png_bytes.h"

namespace aerate::test {
namespace {

using namespace picture_colours;

Scene scene_with(const Mesh& outer) {
  Solid solid{outer, {}};
  solid.close_part(PartKind::outer);
  Scene scene;
  scene.title = "box.stl";
  scene.is = "for a test";
  scene.mesh = std::move(solid.mesh);
  scene.parts = std::move(solid.parts);
  scene.figures = {{"volume", "8 cm3"}, {"process", "fdm"}};
  return scene;
}

void add_ball(Scene& scene, Vec3d centre, double radius, PartKind kind = PartKind::void_surface) {
  const Mesh ball = moved(turned_inside_out(make_uv_sphere(radius, 24, 48)), to_float(centre));
  scene.mesh = join(scene.mesh, ball);
  scene.parts.push_back({kind, scene.parts.back().end(), ball.triangles.size()});
  if (kind != PartKind::void_surface) return;
  scene.voids.push_back({scene.voids.size() + 1, centre, radius, 0, std::nullopt});
}

// A cube of 20 mm with a void of 5 mm in its middle.
Scene cube_with_ball() {
  Scene scene = scene_with(make_box({-10, -10, -10}, {10, 10, 10}));
  add_ball(scene, {0, 0, 0}, 5);
  return scene;
}

Picture draw_picture(const Scene& scene, const PictureRequest& request) {
  Monitor monitor;
  return aerate::draw_picture(scene, request, monitor);
}

PictureRequest cut(CutAxis axis, double share, PictureColour colour = PictureColour::radius) {
  PictureRequest request;
  request.axis = axis;
  request.share = share;
  request.colour = colour;
  request.width = 640;
  request.height = 512;
  return request;
}

Colour colour_at(const Picture& picture, Vec3d place) {
  const PixelPoint p = picture.frame.pixel_of(place);
  return picture.image.at(static_cast<int>(p.x), static_cast<int>(p.y));
}

// On the straight way from one colour to another, but for rounding.
bool is_between(Colour colour, Colour from, Colour to) {
  for (int step = 0; step <= 100; ++step) {
    const Colour mix = mixed(from, to, step / 100.0);
    if (std::abs(mix.red - colour.red) <= 2 && std::abs(mix.green - colour.green) <= 2 &&
        std::abs(mix.blue - colour.blue) <= 2)
      return true;
  }
  return false;
}

bool is_hatched(Colour colour) {
  return is_between(colour, kSolid, kHatch);
}

TEST(Picture, ShowsWhatIsSolidInThePlaneHatchedAndVoidsOpen) {
  const Scene scene = cube_with_ball();
  for (const CutAxis axis : {CutAxis::x, CutAxis::y, CutAxis::z}) {
    const Picture picture = draw_picture(scene, cut(axis, 0.5));
    // A circle's worth of places in the plane of the cut, in the void, beside it and outside.
    int inked = 0, plain = 0;
    for (int i = 0; i < 360; ++i) {
      const double u = std::cos(i * 0.0174533), v = std::sin(i * 0.0174533);
      const auto at = [&](double radius) {
        const double a = radius * u, b = radius * v;
        return axis == CutAxis::x ? Vec3d{0, a, b} : axis == CutAxis::y ? Vec3d{a, 0, b} : Vec3d{a, b, 0};
      };
      for (const double inside : {0.0, 2.5, 4.6}) {
        const Colour colour = colour_at(picture, at(inside));
        EXPECT_FALSE(is_hatched(colour)) << i << ' ' << inside;
        // The colour of the scale's middle, lit.
        EXPECT_GT(colour.green, colour.red) << i;
      }
      for (const double beside : {5.5, 7.0, 9.5}) {
        const Colour colour = colour_at(picture, at(beside));
        EXPECT_TRUE(is_hatched(colour)) << i << ' ' << beside;
        (colour == kSolid ? plain : inked) += 1;
      }
    }
    EXPECT_GT(inked, 100);
    EXPECT_GT(plain, 300);
    // Outside, on the side to which nothing of the cube slants.
    EXPECT_EQ(colour_at(picture, axis == CutAxis::x   ? Vec3d{0, -10.5, 0}
                                 : axis == CutAxis::y ? Vec3d{-10.5, 0, 0}
                                                      : Vec3d{-10.5, 0, 0}),
              kPaper);
  }
}

TEST(Picture, ShowsThePlaneThatWasAskedFor) {
  const Scene scene = cube_with_ball();
  // 8 mm from the middle there is no void.
  const Picture picture = draw_picture(scene, cut(CutAxis::y, 0.9));
  EXPECT_TRUE(is_hatched(colour_at(picture, {0, 8, 0})));
  // Lengths in the plane are true.
  const PixelPoint a = picture.frame.pixel_of({-10, 8, -10}), b = picture.frame.pixel_of({10, 8, 10});
  EXPECT_NEAR(b.x - a.x, 20 * picture.frame.pixels_per_mm(), 1e-9);
  EXPECT_NEAR(a.y - b.y, 20 * picture.frame.pixels_per_mm(), 1e-9);
}

TEST(Picture, IsNotCutAtTheEnds) {
  const Scene scene = cube_with_ball();
  for (const CutAxis axis : {CutAxis::x, CutAxis::y, CutAxis::z})
    for (const double share : {0.0, 1.0}) {
      const Picture picture = draw_picture(scene, cut(axis, share));
      EXPECT_TRUE(picture.cut.is_whole());
      const double at = share > 0 ? 10 : -10;
      const Colour colour = colour_at(picture, axis == CutAxis::x   ? Vec3d{at, 0, 0}
                                               : axis == CutAxis::y ? Vec3d{0, at, 0}
                                                                    : Vec3d{0, 0, at});
      // Grey, however it is lit.
      EXPECT_FALSE(is_hatched(colour));
      EXPECT_NE(colour, kPaper);
      EXPECT_LT(std::abs(colour.red - colour.green), 12);
    }
}

// Three voids in one plane across y, of which no plane across x or z shows more than two.
TEST(Picture, IsCutWhereMostVoidShows) {
  Scene scene = scene_with(make_box({0, 0, 0}, {32, 16, 32}));
  for (const Vec3d centre : {Vec3d{6, 5, 6}, {16, 5, 26}, {26, 5, 15}}) add_ball(scene, centre, 4);
  PictureRequest request;
  const Picture picture = draw_picture(scene, request);
  EXPECT_EQ(picture.cut.axis, CutAxis::y);
  EXPECT_NEAR(picture.cut.share, 5.0 / 16, 1.0 / 32);
  // Along one axis, the largest of its voids.
  add_ball(scene, {6, 10, 15}, 5);
  request.axis = CutAxis::z;
  EXPECT_NEAR(draw_picture(scene, request).cut.share, 15.0 / 32, 1.0 / 32);
}

TEST(Picture, MarksStandAtTheirPlaces) {
  Scene scene = cube_with_ball();
  const Vec3d seen{-5, 0, 0}, hidden{-8, 4, -8};
  scene.marks.push_back({MarkKind::thinnest_wall, seen, "thinnest wall", {}});
  scene.marks.push_back({MarkKind::cup, hidden, "cup", {}});
  const Picture with = draw_picture(scene, cut(CutAxis::y, 0.5));
  EXPECT_EQ(colour_at(with, seen), kInk);
  // What is behind the cut face is a ring round its place.
  EXPECT_EQ(colour_at(with, hidden), kPaper);
  const PixelPoint middle = with.frame.pixel_of(hidden);
  EXPECT_GT(with.image.at(static_cast<int>(middle.x), static_cast<int>(middle.y) - 2).blue,
            with.image.at(static_cast<int>(middle.x), static_cast<int>(middle.y) - 2).red + 20);
  // Far from the marks the model is as it was.
  scene.marks.clear();
  const Picture without = draw_picture(scene, cut(CutAxis::y, 0.5));
  EXPECT_NE(colour_at(without, seen), kInk);
}

TEST(Picture, DefectsAreDrawnAlongTheirEdges) {
  Scene scene = scene_with(make_box({-10, -10, -10}, {10, 10, 10}));
  SceneMark rim{MarkKind::hole_in_mesh, {0, -10, 0}, "hole", {}};
  rim.lines = {{{-6, -10, 6}, {6, -10, 6}}, {{6, -10, 6}, {6, -10, -6}}};
  scene.marks.push_back(rim);
  PictureRequest request;
  const Picture picture = draw_picture(scene, request);
  // Without voids the default is the whole model from the side on which the defect is.
  EXPECT_TRUE(picture.cut.is_whole());
  EXPECT_EQ(picture.cut.axis, CutAxis::y);
  EXPECT_EQ(picture.cut.share, 0);
  // One that is only seen from behind.
  Scene turned = scene;
  turned.marks.front().lines = {{{-6, 10, 6}, {6, 10, 6}}};
  const Picture from_behind = draw_picture(turned, request);
  EXPECT_EQ(from_behind.cut.axis, CutAxis::y);
  EXPECT_EQ(from_behind.cut.share, 1);
  for (const Vec3d place : {Vec3d{-3, -10, 6}, {3, -10, 6}, {6, -10, -3}}) {
    const Colour colour = colour_at(picture, place);
    EXPECT_GT(colour.red, 180);
    EXPECT_LT(colour.green, 40);
  }
}

// Of a surface that is not closed nothing is solid: one looks in and sees its inner side.
TEST(Picture, AnOpenSurfaceHasNoCutFace) {
  Scene scene = scene_with(make_box({-10, -10, -10}, {10, 10, 10}));
  scene.mesh.triangles.pop_back();
  scene.parts.front().triangle_count -= 1;
  scene.is_closed = false;
  const Picture picture = draw_picture(scene, cut(CutAxis::y, 0.5));
  for (const Vec3d place : {Vec3d{0, 0, 0}, {-7, 0, 7}, {7, 0, -7}}) {
    const Colour colour = colour_at(picture, place);
    EXPECT_FALSE(is_hatched(colour));
    EXPECT_GT(colour.red, colour.blue + 40);  // kInside, lit
  }
}

TEST(Picture, ModifiersAreFilledInTheCut) {
  Scene scene = cube_with_ball();
  scene.void_use = VoidUse::modifiers;
  const Picture picture = draw_picture(scene, cut(CutAxis::y, 0.5));
  const Colour tint = mixed(kPaper, scale_colour(0.5), 0.55);
  for (const Vec3d place : {Vec3d{0, 0, 0}, {3, 0, 1}, {-2, 0, -3}})
    EXPECT_TRUE(is_between(colour_at(picture, place), tint, kHatch));
  EXPECT_TRUE(is_hatched(colour_at(picture, {8, 0, 0})));
}

TEST(Picture, ChannelsAndHolesHaveColoursOfTheirOwn) {
  Scene scene = scene_with(make_box({-10, -10, -10}, {10, 10, 10}));
  add_ball(scene, {-5, 0, 0}, 4, PartKind::channel);
  add_ball(scene, {5, 0, 0}, 4, PartKind::hole);
  const Picture picture = draw_picture(scene, cut(CutAxis::y, 0.5));
  const Colour channel = colour_at(picture, {-5, 0, 0}), hole = colour_at(picture, {5, 0, 0});
  EXPECT_GT(channel.blue, channel.green);
  EXPECT_GT(channel.red, channel.green);
  EXPECT_GT(hole.red, 2 * hole.blue);
  EXPECT_GT(hole.red, hole.green + 20);
}

TEST(Picture, ColoursTellHowMuchIsLeft) {
  Scene scene = scene_with(make_box({-10, -10, -10}, {10, 10, 10}));
  add_ball(scene, {-4, 0, 0}, 5);  // 1 mm from the left side, 9 from the right
  scene.voids.back().wall = 1;
  const Picture picture = draw_picture(scene, cut(CutAxis::y, 0.5, PictureColour::thickness));
  const Colour thin = colour_at(picture, {-8.7, 0, 0}), thick = colour_at(picture, {0.5, 0, 0});
  EXPECT_GT(thin.red, thin.blue + 20);      // yellow
  EXPECT_GT(thick.blue, thick.green + 20);  // violet
}

TEST(Picture, IsTheSameForAnyNumberOfThreads) {
  Scene scene = cube_with_ball();
  scene.voids.back().wall = 5;
  scene.marks.push_back({MarkKind::thinnest_wall, {-5, 0, 0}, "thinnest wall", {}});
  for (const PictureColour colour : {PictureColour::radius, PictureColour::thickness}) {
    std::vector<std::string> bytes;
    for (const int threads : {1, 2, 5}) {
      const tbb::global_control control(tbb::global_control::max_allowed_parallelism,
                                        static_cast<std::size_t>(threads));
      tbb::task_arena arena(threads);
      arena.execute(
          [&] { bytes.push_back(png_of(draw_picture(scene, cut(CutAxis::x, 0.4, colour)).image)); });
    }
    EXPECT_EQ(bytes[0], bytes[1]);
    EXPECT_EQ(bytes[0], bytes[2]);
  }
}

// Whatever their size, and with more to say than there is room for.
TEST(Picture, IsDrawnAtAnySize) {
  Scene scene = cube_with_ball();
  scene.title = std::string(300, 'x');
  for (int i = 0; i < 40; ++i) {
    scene.figures.push_back({"figure", std::string(200, 'w')});
    scene.marks.push_back({MarkKind::crossing, {0.0 + i, 0, 0}, "\xc3\xa4 crossing \x7f", {}});
  }
  for (const auto& [width, height] :
       {std::pair{kLeastPictureSide, kLeastPictureSide}, {900, 160}, {160, 900}}) {
    PictureRequest request;
    request.width = width;
    request.height = height;
    const Picture picture = draw_picture(scene, request);
    EXPECT_EQ(picture.image.width(), width);
    EXPECT_EQ(picture.image.height(), height);
    EXPECT_TRUE(std::ranges::any_of(picture.image.pixels(), [](Colour c) { return !(c == kPaper); }));
  }
}

TEST(Picture, StopsWhenItIsToldTo) {
  struct Stopped : Monitor {
    void check_interrupted() override { throw InterruptedError(); }
  } stopped;
  EXPECT_THROW(aerate::draw_picture(cube_with_ball(), cut(CutAxis::y, 0.5), stopped), InterruptedError);
}

TEST(Png, IsReadAsItWasWritten) {
  Image image(61, 47, kPaper);
  for (int y = 0; y < image.height(); ++y)
    for (int x = 0; x < image.width(); ++x)
      image.set(x, y,
                {static_cast<std::uint8_t>(4 * x), static_cast<std::uint8_t>(5 * y),
                 static_cast<std::uint8_t>(x * y)});
  const std::string bytes = png_of(image);
  png_image read{};
  read.version = PNG_IMAGE_VERSION;
  ASSERT_NE(png_image_begin_read_from_memory(&read, bytes.data(), bytes.size()), 0);
  EXPECT_EQ(read.width, 61U);
  EXPECT_EQ(read.height, 47U);
  read.format = PNG_FORMAT_RGB;
  std::vector<Colour> pixels(61 * 47);
  ASSERT_NE(png_image_finish_read(&read, nullptr, pixels.data(), 0, nullptr), 0);
  EXPECT_EQ(pixels, image.pixels());
}

TEST(Lettering, FitsTextIntoItsRoom) {
  const Lettering body;
  const std::string text = "a wall of 1.2 mm";
  EXPECT_EQ(text_that_fits(text, 1000, body), text);
  const std::string cut = text_that_fits(text, 60, body);
  EXPECT_LT(cut.size(), text.size());
  EXPECT_TRUE(cut.ends_with(".."));
  EXPECT_LE(width_of_text(cut, body), 60);
  // No character of several bytes is cut in two.
  EXPECT_EQ(text_that_fits("\xc3\xa4\xc3\xa4\xc3\xa4\xc3\xa4\xc3\xa4\xc3\xa4", 42, body).size() % 2, 0U);
}

// Each has ink of its own, within its room.
TEST(Lettering, HasEveryPrintableCharacter) {
  std::vector<std::vector<Colour>> seen;
  for (char c = '!'; c <= '~'; ++c) {
    Image image(40, 40, kPaper);
    const Lettering large{20, kInk, false};
    draw_text(image, {8, 28}, std::string(1, c), large);
    EXPECT_TRUE(std::ranges::any_of(image.pixels(), [](Colour colour) { return colour.red < 60; })) << c;
    for (const std::vector<Colour>& other : seen) EXPECT_FALSE(image.pixels() == other) << c;
    seen.push_back(image.pixels());
  }
}

}  // namespace
}  // namespace aerate::test
