#include <cmath>
#include <gtest/gtest.h>
#include <numbers>
#include <vector>

#include "printing/economics.h"
#include "tests/support/shapes.h"

namespace aerate::test {
namespace {

constexpr double kPi = std::numbers::pi;

// A block with spherical voids on a line along x, `pitch` apart; its walls are 12 mm from them.
Mesh block_with_voids(float radius, int count, float pitch) {
  const float margin = radius + 12;
  Mesh solid =
      make_box({-margin, -margin, -margin}, {pitch * static_cast<float>(count - 1) + margin, margin, margin});
  for (int i = 0; i < count; ++i)
    solid = join(solid, moved(turned_inside_out(make_uv_sphere(static_cast<double>(radius), 60, 90)),
                              {pitch * static_cast<float>(i), 0, 0}));
  return solid;
}

FilamentUse use_of_voids(float radius, int count, float pitch) {
  const float margin = radius + 12;
  const Mesh whole =
      make_box({-margin, -margin, -margin}, {pitch * static_cast<float>(count - 1) + margin, margin, margin});
  const PrintSettings settings;
  return filament_use(block_with_voids(radius, count, pitch), settings, 0.4) -
         filament_use(whole, settings, 0.4);
}

TEST(Economics, ALoneVoidCostsTheSameByItsFormulaAndOnTheRaster) {
  for (const float radius : {2.0F, 4.0F, 8.0F}) {
    SCOPED_TRACE(radius);
    const FilamentUse formula = use_of_lone_void(static_cast<double>(radius), PrintSettings{});
    const FilamentUse raster = use_of_voids(radius, 1, 0);
    const double size = -formula.sparse_mm3;
    EXPECT_NEAR(raster.wall_mm3, formula.wall_mm3, 0.02 * size);
    EXPECT_NEAR(raster.solid_mm3, formula.solid_mm3, 0.05 * size);
    EXPECT_NEAR(raster.sparse_mm3, formula.sparse_mm3, 0.05 * size);
    EXPECT_NEAR(raster.edge_mm3, formula.edge_mm3, 0.05 * size);
  }
}

TEST(Economics, WhatNeighboursShareIsCountedOnce) {
  const PrintSettings sparse = PrintSettings{.infill = 0.15};
  const double alone = use_of_voids(2, 4, 30).volume_mm3(sparse);
  const double together = use_of_voids(2, 4, 4.9F).volume_mm3(sparse);
  EXPECT_GT(together, 0);
  EXPECT_LT(together, 0.95 * alone);
}

TEST(Economics, VoidsSaveInASolidPrintAndCostInASparseOne) {
  EXPECT_LT(use_of_voids(3, 1, 0).volume_mm3(PrintSettings{.infill = 1}), 0);
  EXPECT_GT(use_of_voids(3, 1, 0).volume_mm3(PrintSettings{.infill = 0.15}), 0);
  EXPECT_LT(use_of_voids(14, 1, 0).volume_mm3(PrintSettings{.infill = 0.4}), 0);
}

TEST(Economics, TheBreakEvenRadiusFallsWithTheInfill) {
  double last = 1e9;
  for (const double infill : {0.05, 0.15, 0.3, 0.5, 0.8, 1.0}) {
    const auto radius = break_even_radius(PrintSettings{.infill = infill});
    ASSERT_TRUE(radius.has_value());
    EXPECT_LT(*radius, last);
    last = *radius;
  }
  EXPECT_LT(last, 0.62);  // solid: every void that slicers keep
  EXPECT_NEAR(*break_even_radius(PrintSettings{.infill = 0.5}), 4.6, 0.5);
  // More walls cost more.
  PrintSettings thick = PrintSettings{.infill = 0.5};
  thick.perimeters = 4;
  EXPECT_GT(*break_even_radius(thick), *break_even_radius(PrintSettings{.infill = 0.5}));
  EXPECT_FALSE(break_even_radius(PrintSettings{.infill = 0}).has_value());
}

TEST(Economics, AtTheBreakEvenInfillNothingIsSavedOrLost) {
  PrintSettings settings;
  for (const InfillPattern pattern : {InfillPattern::gyroid, InfillPattern::lines}) {
    settings.pattern = pattern;
    const FilamentUse difference = use_of_lone_void(5, settings);
    const auto infill = break_even_infill(difference, settings);
    ASSERT_TRUE(infill.has_value());
    settings.infill = *infill;
    EXPECT_NEAR(difference.volume_mm3(settings), 0, 1e-6 * -difference.sparse_mm3);
    settings.infill = *infill + 0.02;
    EXPECT_LT(difference.volume_mm3(settings), 0);
  }
  EXPECT_GT(*break_even_infill(2.0, settings), *break_even_infill(8.0, settings));
}

TEST(Economics, SmallVoidsMakeAPrintLonger) {
  const FilamentUse whole{SparseUse{.edge_mm3 = 800, .sparse_mm3 = 40000, .full_mm3 = 41000}, 4000, 2000, {}};
  const FilamentUse hollow{
      SparseUse{.edge_mm3 = 2000, .sparse_mm3 = 8000, .full_mm3 = 10000}, 12000, 9000, {}};
  const std::vector<Sphere> voids(100, Sphere{{0, 0, 0}, 3, SphereKind::adaptive});
  EXPECT_EQ(time_change(whole, hollow, voids, PrintSettings{.infill = 0.15}), TimeChange::longer);
  EXPECT_EQ(time_change(whole, whole, {}, PrintSettings{.infill = 0.15}), TimeChange::same);
  FilamentUse less = whole;
  less.full_mm3 = 20000;
  EXPECT_EQ(time_change(whole, less, {}, PrintSettings{.infill = 1}), TimeChange::shorter);
}

}  // namespace
}  // namespace aerate::test
