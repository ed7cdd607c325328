#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <numbers>
#include <tbb/global_control.h>

#include "printing/filament_use.h"
#include "printing/shell_rules.h"
#include "tests/support/shapes.h"

namespace aerate::test {
namespace {

constexpr double kPi = std::numbers::pi;

// A block whose sides lean inwards, by `step` from one layer of 0.2 mm to the next; its bottom is a square.
Mesh tapered_block(float side, float height, float step) {
  Mesh mesh = make_box({0, 0, 0}, {side, side, height});
  const float by = step * height / 0.2F;
  for (Vec3f& p : mesh.positions) {
    if (p.z == 0) continue;
    p.x += p.x == 0 ? by : -by;
    p.y += p.y == 0 ? by : -by;
  }
  return mesh;
}

TEST(FilamentUse, ABlockHasWallsSkinsAndInfillOfItsOwnSize) {
  const double side = 30;
  const Mesh block = make_box({0, 0, 0}, {30, 30, 30});
  PrintSettings settings = PrintSettings{.infill = 0.2};
  settings.pattern = InfillPattern::lines;
  const FilamentUse use = filament_use(block, settings);
  // Two loops at their middles, as a slicer lays them.
  const double spacing = 0.45 - 0.2 * (1 - kPi / 4);
  const double loops = 4 * (side - 0.45) + 4 * (side - 0.45 - 2 * spacing);
  EXPECT_NEAR(use.wall_mm3, loops * spacing * side, 0.02 * loops * spacing * side);
  const double inside = side - 2 * (0.225 + 1.5 * spacing) + 2 * 0.25 * spacing;
  EXPECT_NEAR(use.solid_mm3, 9 * 0.2 * inside * inside, 0.02 * 9 * 0.2 * inside * inside);
  // Lines of sparse infill end half a spacing inside of that, and are joined there.
  const double lines = inside - spacing, height = side - 9 * 0.2;
  EXPECT_NEAR(use.sparse_mm3, height * lines * lines, 0.02 * height * lines * lines);
  const double joints = 4 * lines * spacing * height;
  EXPECT_NEAR(use.edge_mm3, joints, 0.1 * joints);
  EXPECT_NEAR(use.volume_mm3(settings),
              use.wall_mm3 + use.solid_mm3 + joined_share(0.2, settings.pattern) * use.edge_mm3 +
                  0.2 * use.sparse_mm3,
              1e-6);
  EXPECT_NEAR(use.volume_mm3(PrintSettings{.infill = 1}), side * side * side, 0.02 * side * side * side);
}

// As many lines as fit from corner to corner, spread evenly, that get no wider by that (PrusaSlicer 2.5 prints 42.60 cm3 of
// infill and skins in a cube of 36 mm, whose space for them is 42.92, and 117.35 in one of 50 mm with 117.78).
TEST(FilamentUse, FullInfillHasWholeLinesThatGetNoWider) {
  const double spacing = 0.45 - 0.2 * (1 - kPi / 4);
  double least = 1;
  for (const double side : {20.0, 24.1, 36.0, 50.0}) {
    SCOPED_TRACE(side);
    const auto edge = static_cast<float>(side);
    const FilamentUse use = filament_use(make_box({0, 0, 0}, {edge, edge, 10}), PrintSettings{.infill = 1});
    const double inside = side - 2 * (0.225 + 1.5 * spacing) + 2 * 0.25 * spacing;
    const double lines = std::sqrt(2.0) * inside / spacing, printed = std::floor(lines) / lines;
    const double space = (10 - 9 * 0.2) * inside * inside;
    EXPECT_NEAR(use.full_mm3, printed * space, 5e-3 * space);
    least = std::min(least, printed);
  }
  EXPECT_LT(least, 0.9925);
}

// One contour's lines lack what is beside the round side of the outer one, however many lines there are (PrusaSlicer 2.5, a
// tube of 20 x 20 x 6 mm with sides of 1 mm: 436.8 mm3 of 456; of 2 mm: 845.7 of 864).
TEST(FilamentUse, WallsThatMeetFillTheSpaceBetweenTheirOuterLines) {
  for (const float thickness : {1.0F, 1.6F, 2.0F}) {
    SCOPED_TRACE(thickness);
    const Mesh tube =
        join(make_box({0, 0, 0}, {20, 20, 6}),
             turned_inside_out(make_box({thickness, thickness, 0}, {20 - thickness, 20 - thickness, 6})));
    const FilamentUse use = filament_use(tube, PrintSettings{.infill = 1});
    const double t = thickness, inner = 20 - 2 * t;
    const double contours = 4 * 20 + 4 * inner, volume = 6 * (400 - inner * inner);
    const double round_edge = 0.2 * (1 - kPi / 4) / 2;
    EXPECT_NEAR(use.volume_mm3(PrintSettings{.infill = 1}), volume - 6 * contours * round_edge,
                0.02 * volume);
    EXPECT_LT(use.volume_mm3(PrintSettings{.infill = 1}) - use.wall_mm3, 0.02 * volume);
  }
}

TEST(FilamentUse, ModifiersTakeInfillAndLinesAreJoinedAlongTheirBorder) {
  const Mesh block = make_box({0, 0, 0}, {30, 30, 30}), modifier = make_box({8, 8, 8}, {22, 22, 22});
  PrintSettings settings = PrintSettings{.infill = 0.2};
  const FilamentUse whole = filament_use(block, settings, 0.25);
  const FilamentUse use = filament_use(block, settings, 0.25, modifier);
  EXPECT_NEAR(use.wall_mm3, whole.wall_mm3, 0.01 * whole.wall_mm3);
  EXPECT_NEAR(use.solid_mm3, whole.solid_mm3, 0.02 * whole.solid_mm3);
  // Lines end half a spacing from the border, on both sides of it.
  const double spacing = 0.45 - 0.2 * (1 - kPi / 4), side = 14;
  const auto squared = [](double x) { return x * x; };
  EXPECT_NEAR(use.modified.sparse_mm3, squared(side - spacing) * side, 0.02 * squared(side) * side);
  const double left = whole.sparse_mm3 - squared(side + spacing) * side;
  EXPECT_NEAR(use.sparse_mm3, left, 0.02 * whole.sparse_mm3);
  EXPECT_NEAR(use.border_mm3, 4 * side * spacing * side, 0.1 * 4 * side * spacing * side);
  EXPECT_NEAR(use.modified.border_mm3, 4 * side * spacing * side, 0.1 * 4 * side * spacing * side);
  // Empty ones take nothing, full ones fill their space.
  settings.modifier_infill = 0;
  EXPECT_EQ(use.modified.volume_mm3(0, settings), 0);
  EXPECT_NEAR(use.modified.volume_mm3(1, settings), squared(side) * side, 0.02 * squared(side) * side);
  EXPECT_LT(use.volume_mm3(settings), whole.volume_mm3(settings));
}

TEST(FilamentUse, WhereABlockLiesDoesNotMatter) {
  const Mesh block = make_box({0, 0, 0}, {30, 20, 10});
  const PrintSettings settings = PrintSettings{.infill = 0.3};
  const double here = filament_use(block, settings).volume_mm3(settings);
  const double there = filament_use(moved(block, {123.4F, -56.7F, 8.9F}), settings).volume_mm3(settings);
  EXPECT_NEAR(there, here, 0.01 * here);
}

TEST(FilamentUse, TheNumberOfThreadsDoesNotMatter) {
  const Mesh solid = join(make_box({0, 0, 0}, {30, 20, 20}),
                          moved(turned_inside_out(make_uv_sphere(6, 60, 90)), {12, 10, 10}));
  const PrintSettings settings;
  const auto use_with = [&](std::size_t threads) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    return filament_use(solid, settings);
  };
  const FilamentUse one = use_with(1), four = use_with(4);
  EXPECT_EQ(one.wall_mm3, four.wall_mm3);
  EXPECT_EQ(one.solid_mm3, four.solid_mm3);
  EXPECT_EQ(one.edge_mm3, four.edge_mm3);
  EXPECT_EQ(one.sparse_mm3, four.sparse_mm3);
}

// A face at the middle of a layer belongs to what is below it, as in PrusaSlicer 2.5 (measured with boxes of
// 7.7, 10.1, 12.3, 16.5 and 20.9 mm).
TEST(FilamentUse, AFaceAtTheMiddleOfALayerCountsAsItsTop) {
  for (const float height : {7.7F, 10.1F, 16.5F}) {
    SCOPED_TRACE(height);
    const PrintSettings settings = PrintSettings{.infill = 1};
    const double printed = filament_use(make_box({0, 0, 0}, {20, 20, height}), settings).volume_mm3(settings);
    const double higher =
        filament_use(make_box({0, 0, 0}, {20, 20, height + 0.05F}), settings).volume_mm3(settings);
    EXPECT_NEAR(printed, higher, 1e-3 * printed);
    const Mesh plate = join(make_box({5, 5, 0}, {15, 15, 25}), make_box({0, 0, 0}, {20, 20, height}));
    const Mesh thicker =
        join(make_box({5, 5, 0}, {15, 15, 25}), make_box({0, 0, 0}, {20, 20, height + 0.05F}));
    EXPECT_NEAR(filament_use(plate, settings).volume_mm3(settings),
                filament_use(thicker, settings).volume_mm3(settings), 1e-3 * printed);
  }
}

TEST(FilamentUse, WhatIsTooNarrowForInfillIsWall) {
  const PrintSettings settings = PrintSettings{.infill = 0.2};
  const ShellRules rules = shell_rules(settings);
  const auto use_of_plate = [&](double thickness) {
    return filament_use(make_box({0, 0, 0}, {40, static_cast<float>(thickness), 20}), settings);
  };
  const FilamentUse walls = use_of_plate(2 * rules.wall + 0.5 * rules.widened_walls);
  EXPECT_LT(walls.solid_mm3 + walls.sparse_mm3 + walls.full_mm3, 0.01 * walls.wall_mm3);
  const FilamentUse filled = use_of_plate(2 * rules.wall + 3 * rules.widened_walls);
  EXPECT_GT(filled.solid_mm3 + filled.sparse_mm3 + filled.full_mm3, 0.1 * filled.wall_mm3);
}

// Four layers further down, a wall that leans has moved by four steps: a shell of at least 1.05 spacings is
// printed there, a narrower one is not.
TEST(FilamentUse, ShellsAlongLeaningWallsHaveALeastWidth) {
  PrintSettings settings = PrintSettings{.infill = 0.2};
  settings.bottom_layers = 0;  // which would look the other way
  const ShellRules rules = shell_rules(settings);
  const double side = 60, height = 20, top_height = settings.top_layers * settings.layer_height;
  for (const double width : {0.8 * rules.least_shell, 1.2 * rules.least_shell}) {
    SCOPED_TRACE(width);
    const double step = width / (settings.top_layers - 1);
    const double solid = filament_use(tapered_block(60, 20, static_cast<float>(step)), settings).solid_mm3;
    const double leant = step * height / settings.layer_height;  // of each side, from bottom to top
    const double upper = side - 2 * leant - 2 * rules.fill;
    const double top = top_height * upper * upper;
    const double printed = width > rules.least_shell ? width + rules.widening : 0;
    const double shells = 4 * (side - leant - 2 * rules.fill - printed) * printed * (height - top_height);
    EXPECT_NEAR(solid, top + shells, 0.08 * top + 0.1 * shells);
  }
}

// Steps of a gentle slope that leave infill free are skin, 3 mm wider than what is free, which casts a shadow
// on the layers below; a slope a little steeper leaves none free.
TEST(FilamentUse, AGentleSlopeThatLeavesInfillFreeIsSkin) {
  PrintSettings settings{.infill = 0.2, .top_layers = 5, .bottom_layers = 0};
  const ShellRules rules = shell_rules(settings);
  const double side = 80, height = 6, h = settings.layer_height;
  for (const double step : {rules.fill - 0.05, rules.fill + 0.05}) {
    SCOPED_TRACE(step);
    const double solid = filament_use(tapered_block(80, 6, static_cast<float>(step)), settings).solid_mm3;
    // Of each layer's ring, from where its infill begins.
    const double skin = step > rules.fill ? rules.skin_margin : 0;
    const double ring = settings.top_layers * step + skin + rules.shadow - rules.fill + rules.widening;
    double expected = 0;
    for (int k = 0; k < std::lround(height / h); ++k) {
      const double outer = side - 2 * step * (k + 0.5) - 2 * rules.fill;
      const bool is_top = k >= std::lround(height / h) - settings.top_layers;
      const double inner = is_top ? 0 : std::max(0.0, outer - 2 * ring);
      expected += h * (outer * outer - inner * inner);
    }
    EXPECT_NEAR(solid, expected, 0.05 * expected);
  }
}

// From 2.6 on skins grow by a spacing, shadows next to nothing, and shells may be narrower.
TEST(FilamentUse, RulesSince26HaveNarrowerSkinsAndShells) {
  PrintSettings settings{.infill = 0.2, .top_layers = 5, .bottom_layers = 0};
  settings.rules = SolidRules::prusa_2_6;
  const ShellRules rules = shell_rules(settings);
  EXPECT_NEAR(rules.skin_margin, rules.spacing, 1e-9);
  const double side = 80, height = 6, h = settings.layer_height;
  const auto layers = std::lround(height / h);
  const double step = rules.fill + 0.05;
  const double solid = filament_use(tapered_block(80, 6, static_cast<float>(step)), settings).solid_mm3;
  // Of each layer's ring, from where its infill begins: what the layers above leave free, or the skin beyond.
  const double shell = (settings.top_layers - 1) * step + step + rules.shadow + rules.widening - rules.fill;
  double expected = 0;
  for (int k = 0; k < layers; ++k) {
    const double outer = side - 2 * step * (k + 0.5) - 2 * rules.fill;
    const double inner = k >= layers - settings.top_layers ? 0 : std::max(0.0, outer - 2 * shell);
    expected += h * (outer * outer - inner * inner);
  }
  EXPECT_NEAR(solid, expected, 0.05 * expected);
  settings.rules = SolidRules::prusa_2_5;
  EXPECT_GT(filament_use(tapered_block(80, 6, static_cast<float>(step)), settings).solid_mm3, 1.2 * solid);
}

// Where no surface leaves infill free, only "enabled" fills along walls that lean.
TEST(FilamentUse, VerticalShellsCanBeLeftToWhatLooksUpOrDown) {
  const auto solid_of = [](VerticalShells shells, double step) {
    PrintSettings settings{.infill = 0.2, .bottom_layers = 0};
    settings.rules = SolidRules::prusa_2_6;
    settings.vertical_shells = shells;
    return filament_use(tapered_block(60, 20, static_cast<float>(step)), settings).solid_mm3;
  };
  const double steep = 0.2, straight = 0.0;
  const double top = solid_of(VerticalShells::enabled, straight);
  EXPECT_NEAR(solid_of(VerticalShells::partial, straight), top, 0.02 * top);
  EXPECT_NEAR(solid_of(VerticalShells::disabled, straight), top, 0.02 * top);
  const double enabled = solid_of(VerticalShells::enabled, steep);
  EXPECT_LT(solid_of(VerticalShells::partial, steep), enabled);
  EXPECT_LE(solid_of(VerticalShells::disabled, steep), 1.02 * solid_of(VerticalShells::partial, steep));
}

// As the slicer's profiles have it: at least 0.7 mm under what looks up and 0.5 mm over what looks down.
TEST(FilamentUse, SolidLayersHaveALeastThickness) {
  const Mesh block = make_box({0, 0, 0}, {30, 30, 20});
  const auto solid_of = [&](int top, int bottom, double layer_height) {
    const PrintSettings settings{
        .infill = 0.2, .layer_height = layer_height, .top_layers = top, .bottom_layers = bottom};
    return filament_use(block, settings).solid_mm3;
  };
  EXPECT_EQ(solid_of(1, 1, 0.2), solid_of(4, 3, 0.2));
  EXPECT_EQ(solid_of(5, 4, 0.1), solid_of(7, 5, 0.1));
  EXPECT_LT(solid_of(4, 3, 0.2), solid_of(5, 3, 0.2));
  EXPECT_EQ(solid_of(0, 0, 0.2), 0);
}

TEST(FilamentUse, NothingTakesNothing) {
  EXPECT_EQ(filament_use(Mesh{}, PrintSettings{}).volume_mm3(PrintSettings{}), 0);
}

}  // namespace
}  // namespace aerate::test
