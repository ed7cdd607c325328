#include <gtest/gtest.h>
#include <string>
#include <utility>
#include <vector>

#include "check/check_written.h"
#include "core/error.h"
#include "files/weld.h"
#include "pipeline/keep_solid.h"
#include "pipeline/prepare.h"
#include "printing/carve.h"
#include "tests/support/caught.h"
#include "tests/support/shapes.h"

namespace aerate {
namespace {

using test::contains;
using test::message_of;

// A box with two voids and regions that stay solid: voids that are there although they should not be are found.
class CheckKept : public testing::Test {
 protected:
  CheckKept() {
    model_.mesh = test::make_box({0, 0, 0}, {30, 30, 30});
    model_.inspection = inspect(model_.mesh);
  }

  OutputFacts check(std::vector<RegionRequest> regions) {
    Monitor silent;
    const auto kept =
        keep_solid(model_, regions, {.load = {}, .weld = {}, .wall = packing_.limits.wall}, silent);
    const Solid solid = carve_keeping_surface(model_.mesh, packing_, {.tolerance = 0.05}, silent);
    return check_written(as_read_back(solid.mesh),
                         {.solid = solid,
                          .model = model_.mesh,
                          .surface = SurfaceIndex(model_.mesh),
                          .inspection = model_.inspection,
                          .packing = packing_,
                          .drainage = nullptr,
                          .tolerance = 0.05,
                          .kept = kept ? &*kept : nullptr},
                         silent);
  }
  void expect_found(const RegionRequest& region, const std::string& said) {
    EXPECT_TRUE(contains(message_of<FailureError>([&] { check({region}); }), said));
  }

  PreparedModel model_;
  Packing packing_{.spheres = {{{8, 8, 8}, 4, SphereKind::lattice}, {{20, 20, 20}, 6, SphereKind::lattice}},
                   .limits = {.wall = 1, .gap = 1, .min_radius = 0.5, .max_radius = 6},
                   .statistics = {},
                   .device = {}};
};

TEST_F(CheckKept, TheLeastDistanceIsMeasured) {
  EXPECT_FALSE(check({}).kept_wall.has_value());
  // 20 - 6 - 1.5 from the second void, 13 - 8 - 4 from the first.
  const OutputFacts facts =
      check({{"", Box3d{{0, 0, 13}, {13, 30, 30}}}, {"", Box3d{{28, 0, 0}, {40, 9, 9}}}});
  EXPECT_NEAR(facts.kept_wall.value(), 1, 0.05);
  EXPECT_GE(facts.kept_wall.value(), 1 - 1e-5);
  EXPECT_NEAR(check({{"", BallRegion{{20, 20, 5}, 2}}}).kept_wall.value(), 7, 0.06);
}

TEST_F(CheckKept, AVoidThatIsTooNear) {
  expect_found({"", Box3d{{0, 0, 12.9}, {13, 30, 30}}}, "0.9");
  expect_found({"", BallRegion{{20, 20, 28}, 1.5}}, "beside a region that stays solid");
  // Through the middle of one, where no vertex is in it.
  expect_found({"", CylinderRegion{{20, 20, 0}, {20, 20, 30}, 0.01}}, "0 mm are left beside a region");
}

// As far inside as the wall asks for.
TEST_F(CheckKept, AVoidInARegion) {
  expect_found({"", Box3d{{1, 1, 1}, {14, 14, 14}}}, "taken out of a region that stays solid");
  expect_found({"", Box3d{{-1, -1, -1}, {31, 31, 31}}}, "taken out of a region that stays solid");
}

// What of a region is outside of the model may be near.
TEST_F(CheckKept, OutsideOfTheModelRegionsDoNotMatter) {
  packing_.spheres[0].centre = {8, 8, 5};
  const std::vector<RegionRequest> regions{{"", CylinderRegion{{18, 8, 4}, {-22, 8, -20}, 1}}};
  EXPECT_GT(check(regions).kept_wall.value(), 1);
}

}  // namespace
}  // namespace aerate
