#include <gtest/gtest.h>

#include "core/mesh.h"
#include "tests/support/shapes.h"

namespace aerate {
namespace {

TEST(MeshMoments, CubeFarFromTheOriginKeepsItsVolumeAndCentroid) {
  const Mesh cube = test::make_box({1000, 2000, -3000}, {1002, 2003, -2995});
  const VolumeMoments moments = volume_moments(cube);
  EXPECT_NEAR(moments.volume, 30.0, 1e-9);
  EXPECT_NEAR(moments.first_moment.x / moments.volume, 1001.0, 1e-9);
  EXPECT_NEAR(moments.first_moment.y / moments.volume, 2001.5, 1e-9);
  EXPECT_NEAR(moments.first_moment.z / moments.volume, -2997.5, 1e-9);
  EXPECT_NEAR(surface_area(cube), 2 * (2 * 3 + 3 * 5 + 5 * 2), 1e-9);
}

}  // namespace
}  // namespace aerate
