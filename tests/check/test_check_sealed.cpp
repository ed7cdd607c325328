#include <cmath>
#include <gtest/gtest.h>
#include <numbers>
#include <span>
#include <string>
#include <tbb/global_control.h>
#include <utility>
#include <vector>

#include "check/check_written.h"
#include "core/error.h"
#include "core/overhang.h"
#include "files/weld.h"
#include "printing/carve.h"
#include "tests/support/caught.h"
#include "tests/support/shapes.h"

namespace aerate {
namespace {

using test::contains;
using test::message_of;

// A box with two voids; a test damages it and looks whether that is found.
class CheckSealed : public testing::Test {
 protected:
  CheckSealed() {
    Monitor silent;
    solid_ = carve_keeping_surface(model_, packing_, {.tolerance = tolerance_}, silent);
  }

  OutputFacts check(const Mesh& written) const {
    Monitor silent;
    return check(written, silent);
  }
  OutputFacts check(const Mesh& written, Monitor& monitor) const {
    return check_written(written,
                         {.solid = solid_,
                          .model = model_,
                          .surface = SurfaceIndex(model_),
                          .inspection = inspect(model_),
                          .packing = packing_,
                          .drainage = nullptr,
                          .tolerance = tolerance_},
                         monitor);
  }
  OutputFacts check() const { return check(as_read_back(solid_.mesh)); }
  void expect_found(const std::string& said) const {
    EXPECT_TRUE(contains(message_of<FailureError>([&] { check(); }), said));
  }
  std::span<Triangle> void_triangles(std::size_t i) {
    const SolidPart& part = solid_.of(PartKind::void_surface)[i];
    return std::span(solid_.mesh.triangles).subspan(part.first_triangle, part.triangle_count);
  }

  Mesh model_ = test::make_box({0, 0, 0}, {30, 30, 30});
  Packing packing_{.spheres = {{{8, 8, 8}, 4, SphereKind::lattice}, {{20, 20, 20}, 6, SphereKind::lattice}},
                   .limits = {.wall = 1, .gap = 1, .min_radius = 0.5, .max_radius = 6},
                   .statistics = {},
                   .device = {}};
  double tolerance_ = 0.05;
  Solid solid_;
};

TEST_F(CheckSealed, MeasuresASoundResult) {
  const OutputFacts facts = check();
  const double planned = 4.0 / 3.0 * std::numbers::pi * (64 + 216);
  EXPECT_EQ(facts.void_count, 2U);
  EXPECT_EQ(facts.outer_triangle_count, 12U);
  EXPECT_EQ(facts.triangle_count, 12 + facts.void_triangle_count);
  EXPECT_NEAR(facts.volume_before, 27000, 1e-6);
  EXPECT_LT(facts.volume_removed, planned);
  EXPECT_GT(facts.volume_removed, planned * 0.97);
  EXPECT_NEAR(facts.volume_after, facts.volume_before - facts.volume_removed, 1e-4);
  // The measured balls are the planned ones to within fp32: the nearest faces are 8 - 4 and 10 - 6 mm away.
  EXPECT_NEAR(facts.clearances.wall, 4, 1e-4);
  EXPECT_NEAR(facts.clearances.gap.value(), std::sqrt(3 * 144.0) - 10, 1e-4);
  EXPECT_LE(facts.largest_radius, 6);
  EXPECT_NEAR(facts.smallest_radius, 4, 1e-4);
  EXPECT_GT(facts.void_deviation, 0);
  EXPECT_LE(facts.void_deviation, tolerance_);
  ASSERT_TRUE(facts.centre_of_mass_before && facts.centre_of_mass_after);
  EXPECT_NEAR(facts.centre_of_mass_before->x, 15, 1e-9);
  const double moment = 4.0 / 3.0 * std::numbers::pi * (64 * 8 + 216 * 20);
  EXPECT_NEAR(facts.centre_of_mass_after->x, (27000 * 15 - moment) / (27000 - planned), 0.01);
}

TEST_F(CheckSealed, MeasuresVoidsWithRoofs) {
  packing_.spheres = {{{9, 9, 9}, 6, SphereKind::adaptive}, {{22, 22, 22}, 2, SphereKind::adaptive}};
  packing_.limits.roof = make_roof({});
  Monitor silent;
  solid_ = carve_keeping_surface(model_, packing_, {.tolerance = tolerance_}, silent);
  const OutputFacts facts = check();
  const double planned = void_volume(packing_.limits.roof, 6) + void_volume(packing_.limits.roof, 2);
  EXPECT_LT(facts.volume_removed, planned);
  EXPECT_GT(facts.volume_removed, planned * 0.97);
  EXPECT_EQ(facts.roof_count, 1U);
  EXPECT_LE(facts.largest_radius, 6);
  EXPECT_NEAR(facts.largest_radius, 6, 1e-4);
  EXPECT_LE(facts.void_deviation, tolerance_);
  EXPECT_NEAR(facts.clearances.wall, 3, 1e-4);
  ASSERT_TRUE(facts.ceilings);
  EXPECT_LE(facts.ceilings->widest, 5 + tolerance_);
  EXPECT_GT(facts.ceilings->widest, 4.8);
}

TEST_F(CheckSealed, FindsAVoidWithoutTheRoofThatWasPlanned) {
  packing_.limits.roof = make_roof({});
  expect_found("void 0: it has radius 4.58");
}

TEST_F(CheckSealed, FindsAVoidThatReachesAboveItsRoof) {
  packing_.limits.roof = make_roof({});
  Monitor silent;
  solid_ = carve_keeping_surface(model_, packing_, {.tolerance = tolerance_}, silent);
  Vec3f* highest = nullptr;
  for (const Triangle& t : void_triangles(1))
    for (const std::uint32_t v : t)
      if (highest == nullptr || solid_.mesh.positions[v].z > highest->z) highest = &solid_.mesh.positions[v];
  highest->z += 0.001F;
  expect_found("void 1: it has radius 6.00");
}

TEST_F(CheckSealed, FindsACeilingThatIsTooWide) {
  // No roof is asked for, and yet the bridge is narrower than these balls need.
  packing_.limits.roof = make_roof({.bridge = 8.6});
  packing_.limits.roof.cosine /= 2;
  expect_found("a ceiling is ");
}

TEST_F(CheckSealed, FindsAFileThatDiffersFromTheResult) {
  Mesh moved = as_read_back(solid_.mesh);
  moved.positions[20].x = std::nextafter(moved.positions[20].x, 100.0F);
  EXPECT_TRUE(contains(message_of<FailureError>([&] { check(moved); }), "is not the one of the result"));
  Mesh shorter = as_read_back(solid_.mesh);
  shorter.triangles.pop_back();
  EXPECT_TRUE(contains(message_of<FailureError>([&] { check(shorter); }), "triangles instead of"));
  Mesh longer = as_read_back(solid_.mesh);
  longer.triangles.push_back(longer.triangles.back());
  EXPECT_TRUE(contains(message_of<FailureError>([&] { check(longer); }), "too many"));
}

TEST_F(CheckSealed, FindsAChangedOuterSurface) {
  solid_.mesh.positions[solid_.mesh.triangles[0][0]].x += 1e-5F;
  expect_found("is not the one of the model");
}

TEST_F(CheckSealed, FindsACutThatNoHoleExplains) {
  solid_.parts.front().triangle_count -= 2;
  solid_.parts.insert(solid_.parts.begin() + 1, {PartKind::remnant, 10, 2});
  expect_found("although no hole was planned");
}

TEST_F(CheckSealed, FindsAnOpenVoid) {
  solid_.mesh.triangles.pop_back();
  solid_.parts.back().triangle_count -= 1;
  expect_found("void 1: it is open");
}

TEST_F(CheckSealed, FindsAnOutwardVoid) {
  for (Triangle& t : void_triangles(0)) std::swap(t[1], t[2]);
  expect_found("void 0: it is not oriented inward");
}

TEST_F(CheckSealed, FindsATwistedTriangle) {
  std::swap(void_triangles(1)[5][0], void_triangles(1)[5][1]);
  expect_found("opposite ways");
}

TEST_F(CheckSealed, FindsAVoidThatIsTooLarge) {
  const std::uint32_t vertex = void_triangles(0)[3][0];
  const Vec3d outward = to_double(solid_.mesh.positions[vertex]) - packing_.spheres[0].centre;
  solid_.mesh.positions[vertex] = to_float(packing_.spheres[0].centre + outward * 1.0001);
  expect_found("void 0: it has radius 4.000");
}

TEST_F(CheckSealed, FindsAVoidThatIsTooSmall) {
  tolerance_ /= 3;
  expect_found("inside its planned shape");
}

TEST_F(CheckSealed, FindsABrokenWallOrGap) {
  packing_.limits.wall = 4.01;
  expect_found("the wall is");
  packing_.limits.wall = 1;
  packing_.limits.gap = 10.8;
  expect_found("the gap is");
}

TEST_F(CheckSealed, FindsVoidsThatTouch) {
  // The second void becomes the first once more.
  const auto first = void_triangles(0);
  const std::vector<Triangle> copy(first.begin(), first.end());
  solid_.mesh.triangles.resize(solid_.parts.back().first_triangle);
  solid_.mesh.triangles.insert(solid_.mesh.triangles.end(), copy.begin(), copy.end());
  solid_.parts.back().triangle_count = copy.size();
  packing_.spheres[1] = packing_.spheres[0];
  expect_found("void 1 touches another surface");
}

TEST_F(CheckSealed, FindsAMissingVoid) {
  packing_.spheres.push_back({{25, 5, 5}, 2, SphereKind::lattice});
  expect_found("3 voids, 0 channels and 0 holes were planned; 2, 0 and 0 made");
}

TEST_F(CheckSealed, OverlappingPartsAreCountedOnce) {
  model_ = test::join(model_, test::make_box({25, 0, 0}, {60, 30, 30}));
  packing_.spheres[1].centre = {17, 17, 17};
  Monitor silent;
  solid_ = carve_keeping_surface(model_, packing_, {.tolerance = tolerance_}, silent);
  const OutputFacts facts = check();
  EXPECT_FALSE(facts.centre_of_mass_before);
  EXPECT_NEAR(facts.volume_before, 60 * 30 * 30, 60 * 30 * 30 * 0.01);
}

TEST_F(CheckSealed, FactsDoNotDependOnThreads) {
  packing_.spheres.clear();
  for (int i = 0; i < 400; ++i) {
    const auto at = [](int k) { return 2.0 + 3.0 * k; };
    packing_.spheres.push_back(
        {{at(i % 8), at(i / 8 % 8), at(i / 64)}, 0.7 + 0.001 * (i % 99), SphereKind::lattice});
  }
  packing_.limits = {.wall = 0.5, .gap = 0.5, .min_radius = 0.5, .max_radius = 1};
  Monitor silent;
  solid_ = carve_keeping_surface(model_, packing_, {.tolerance = tolerance_}, silent);
  const Mesh written = as_read_back(solid_.mesh);
  const OutputFacts parallel = check(written);
  const tbb::global_control one_thread(tbb::global_control::max_allowed_parallelism, 1);
  const OutputFacts serial = check(written);
  EXPECT_EQ(parallel.void_count, 400U);
  EXPECT_EQ(parallel.volume_removed, serial.volume_removed);
  EXPECT_EQ(parallel.volume_after, serial.volume_after);
  EXPECT_EQ(parallel.clearances.gap, serial.clearances.gap);
  EXPECT_EQ(parallel.void_deviation, serial.void_deviation);
}

TEST_F(CheckSealed, NamesTheFirstOfSeveralFaults) {
  for (const std::size_t i : {1U, 0U}) {
    for (Triangle& t : void_triangles(i)) std::swap(t[1], t[2]);
  }
  expect_found("void 0: it is not oriented inward");
}

TEST_F(CheckSealed, StopsWhenAskedTo) {
  class Stopping final : public Monitor {
   public:
    void check_interrupted() override { throw InterruptedError(); }
  } stopping;
  EXPECT_THROW(check(as_read_back(solid_.mesh), stopping), InterruptedError);
}

}  // namespace
}  // namespace aerate
