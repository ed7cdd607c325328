#include <cmath>
#include <gtest/gtest.h>
#include <limits>
#include <numbers>
#include <random>

#include "core/error.h"
#include "core/overhang.h"
#include "kernels/point_triangle.h"
#include "kernels/roof_distance.h"

// Roofs against brute force: closed forms against many points along the spine, volumes against slices.
namespace aerate {
namespace {

using kernels::distance_between;
using kernels::distance_to_facet;
using kernels::lateral_depth;
using kernels::radius_beside;
using kernels::radius_within;
using kernels::SpineReach;

class Random {
 public:
  double between(double low, double high) { return std::uniform_real_distribution<>(low, high)(engine_); }
  Vec3d in_cube(double half) { return {between(-half, half), between(-half, half), between(-half, half)}; }
  kernels::Facet facet(double half, double extent) {
    const Vec3d corner = in_cube(half);
    return {to_float(corner), to_float(corner + in_cube(extent)), to_float(corner + in_cube(extent))};
  }

 private:
  std::mt19937_64 engine_{20};
};

std::vector<Roof> roofs() {
  return {make_roof({}), make_roof({.degrees = 30, .bridge = 2}), make_roof({.degrees = 60, .bridge = 8}),
          make_roof({.degrees = 45, .bridge = 0, .up = {1, 0, 0}}),
          make_roof({.degrees = 50, .bridge = 4, .up = {1, -2, 0.5}})};
}

double distance(Vec3d p, const kernels::Facet& facet) {
  return std::sqrt(kernels::distance_squared_to_facet(p, facet));
}

// Least of function(t) over [0, end], which is convex: by golden section.
template <typename Function>
double least_along(double end, Function function) {
  constexpr double kGolden = 0.6180339887498949;
  double low = 0, high = end;
  for (int i = 0; i < 60; ++i) {
    const double span = kGolden * (high - low);
    (function(high - span) < function(low + span) ? high : low) =
        function(high - span) < function(low + span) ? low + span : high - span;
  }
  return std::min({function(0.0), function(end), function((low + high) / 2)});
}

double slow_distance(const Roof& roof, Vec3d centre, double radius, const kernels::Facet& facet) {
  return least_along(roof.spine(radius), [&](double t) {
    return distance(centre + roof.up * t, facet) - (radius - t * roof.sine);
  });
}

double slow_distance(const Roof& roof, Vec3d a, double radius_a, Vec3d b, double radius_b) {
  return least_along(roof.spine(radius_a), [&](double t) {
    return least_along(roof.spine(radius_b), [&](double u) {
      return length(a + roof.up * t - b - roof.up * u) - (radius_a - t * roof.sine) -
             (radius_b - u * roof.sine);
    });
  });
}

TEST(Roof, IsAsHighAsAPrinterNeeds) {
  const Roof roof = make_roof({.degrees = 45, .bridge = 5});
  EXPECT_NEAR(roof.widest_ball, 3.5355, 1e-4);
  EXPECT_NEAR(roof.top(9.5), 10.935, 1e-3);
  EXPECT_NEAR(roof.bridge(), 5, 1e-12);
  EXPECT_EQ(roof.top(3.5), 3.5);
  EXPECT_FALSE(roof.shapes(3.5355));
  EXPECT_TRUE(roof.shapes(3.536));
  EXPECT_NEAR(make_roof({.degrees = 45, .bridge = 0}).top(9.5), 13.435, 1e-3);
  EXPECT_NEAR(overhang_degrees(make_roof({.degrees = 37})), 37, 1e-12);
}

TEST(Roof, NoneLeavesBalls) {
  const Roof none;
  EXPECT_EQ(none.top(50), 50);
  EXPECT_EQ(none.spine(50), 0);
  EXPECT_NEAR(void_volume(none, 2), 4.0 / 3.0 * std::numbers::pi * 8, 1e-12);
}

TEST(Roof, RefusesWhatIsNoRoof) {
  for (const double degrees : {0.0, -5.0, 90.0, 120.0, std::nan("")}) {
    EXPECT_THROW(make_roof({.degrees = degrees}), UsageError) << degrees;
  }
  EXPECT_THROW(make_roof({.bridge = -1}), UsageError);
  EXPECT_THROW(make_roof({.bridge = std::numeric_limits<double>::infinity()}), UsageError);
  EXPECT_THROW(make_roof({.up = {0, 0, 0}}), UsageError);
}

TEST(Roof, VolumeIsThatOfItsSlices) {
  for (const Roof& roof : roofs()) {
    for (const double radius : {0.5, 3.6, 5.0, 9.5, 20.0}) {
      const double top = roof.top(radius);
      constexpr int kSlices = 200000;
      const double step = (top + radius) / kSlices;
      double volume = 0;
      for (int i = 0; i < kSlices; ++i) {
        const double z = -radius + (i + 0.5) * step;
        const double aside = roof.shapes(radius) && z > roof.shoulder(radius)
                                 ? (radius - z * roof.sine) / roof.cosine
                                 : std::sqrt(std::max(0.0, radius * radius - z * z));
        volume += std::numbers::pi * aside * aside * step;
      }
      EXPECT_NEAR(void_volume(roof, radius), volume, 1e-5 * volume);
    }
  }
}

// Points of the shape's surface, from its definition: a ball, a cone that touches it, a flat top.
Vec3d surface_point(const Roof& roof, double radius, Random& random) {
  const Vec3d any = std::abs(roof.up.x) < 0.9 ? Vec3d{1, 0, 0} : Vec3d{0, 1, 0};
  const Vec3d x = cross(roof.up, any) * (1 / length(cross(roof.up, any)));
  const Vec3d y = cross(roof.up, x);
  const double z = random.between(-radius, roof.top(radius));
  const double aside = roof.shapes(radius) && z > roof.shoulder(radius)
                           ? (radius - z * roof.sine) / roof.cosine
                           : std::sqrt(std::max(0.0, radius * radius - z * z));
  const double turn = random.between(0, 2 * std::numbers::pi);
  return (x * std::cos(turn) + y * std::sin(turn)) * aside + roof.up * z;
}

TEST(Roof, RadiusFitsTheSurface) {
  Random random;
  for (const Roof& roof : roofs()) {
    for (const double radius : {3.0, 6.0, 12.0}) {
      for (int i = 0; i < 4000; ++i) {
        const Vec3d p = surface_point(roof, radius, random);
        if (roof.shapes(radius)) {
          ASSERT_NEAR(lateral_radius(roof, {1, 2, 3}, p + Vec3d{1, 2, 3}), radius, 1e-9);
          // The room that is kept holds the shape.
          ASSERT_LE(least_along(roof.spine(radius),
                                [&](double t) { return length(p - roof.up * t) - (radius - t * roof.sine); }),
                    1e-9);
        }
      }
    }
  }
}

TEST(Roof, DistanceToFacetsIsThatOfBruteForce) {
  Random random;
  for (const Roof& roof : roofs()) {
    for (int i = 0; i < 1500; ++i) {
      const Vec3d centre = random.in_cube(4);
      const kernels::Facet facet = random.facet(25, i % 2 == 0 ? 4 : 30);
      const double radius = random.between(0.5, 14);
      ASSERT_NEAR(distance_to_facet(roof, centre, radius, facet), slow_distance(roof, centre, radius, facet),
                  1e-6)
          << i;
    }
  }
}

TEST(Roof, TheLargestRadiusTouches) {
  Random random;
  int with_roof = 0;
  for (const Roof& roof : roofs()) {
    for (int i = 0; i < 1500; ++i) {
      const Vec3d foot = random.in_cube(4);
      const kernels::Facet facet = random.facet(25, i % 2 == 0 ? 4 : 30);
      const double wall = random.between(0, 2);
      const SpineReach reach = radius_within(roof, foot, facet, wall);
      if (reach.value <= 0) continue;
      if (reach.height > 0) ++with_roof;
      ASSERT_NEAR(slow_distance(roof, foot, reach.value, facet), wall, 1e-6) << i;
      ASSERT_LT(slow_distance(roof, foot, reach.value * 1.01, facet), wall);
      ASSERT_LE(reach.height, roof.spine(reach.value) + 1e-9);
      ASSERT_NEAR(distance(foot + roof.up * reach.height, facet),
                  reach.value - reach.height * roof.sine + wall, 1e-9);
    }
  }
  EXPECT_GT(with_roof, 500);
}

TEST(Roof, DistanceBetweenVoidsIsThatOfBruteForce) {
  Random random;
  int above = 0, below = 0;
  for (const Roof& roof : roofs()) {
    for (int i = 0; i < 200; ++i) {
      const Vec3d a = random.in_cube(15), b = random.in_cube(15);
      const double radius_a = random.between(0.5, 12), radius_b = random.between(0.5, 12);
      ASSERT_NEAR(distance_between(roof, a, radius_a, b, radius_b),
                  slow_distance(roof, a, radius_a, b, radius_b), 1e-6);
      ASSERT_NEAR(distance_between(roof, a, radius_a, b, radius_b),
                  distance_between(roof, b, radius_b, a, radius_a), 1e-12);
      const double gap = random.between(0, 1);
      const SpineReach reach = radius_beside(roof, a, b, radius_b, gap);
      if (reach.value <= 0) continue;
      if (reach.height > 0) ++above;
      if (reach.height < 0) ++below;
      ASSERT_NEAR(slow_distance(roof, a, reach.value, b, radius_b), gap, 1e-6);
      ASSERT_LT(slow_distance(roof, a, reach.value * 1.01, b, radius_b), gap);
    }
  }
  EXPECT_GT(above, 40);
  EXPECT_GT(below, 40);
}

// The search of the packer relies on it: the radius changes by no more than the foot moves.
TEST(Roof, RadiusIsLipschitz) {
  Random random;
  for (const Roof& roof : roofs()) {
    for (int i = 0; i < 1500; ++i) {
      const kernels::Facet facet = random.facet(25, 20);
      const Vec3d foot = random.in_cube(10), other = foot + random.in_cube(2);
      const double walked = length(other - foot) * (1 + 1e-9) + 1e-9;
      ASSERT_LE(
          std::abs(radius_within(roof, foot, facet, 1).value - radius_within(roof, other, facet, 1).value),
          walked);
      const Vec3d centre = random.in_cube(20);
      ASSERT_LE(std::abs(radius_beside(roof, foot, centre, 6, 1).value -
                         radius_beside(roof, other, centre, 6, 1).value),
                walked);
    }
  }
}

TEST(Roof, DepthIsThatOfTheDeepestPoint) {
  Random random;
  for (const Roof& roof : roofs()) {
    for (int i = 0; i < 300; ++i) {
      const Vec3d centre = random.in_cube(1);
      const kernels::Facet facet = random.facet(8, 8);
      double least = 1e9;
      for (int k = 0; k < 3000; ++k) {
        double u = random.between(0, 1), v = random.between(0, 1);
        if (u + v > 1) u = 1 - u, v = 1 - v;
        const Vec3d a = to_double(facet.a);
        least = std::min(
            least,
            lateral_radius(roof, centre, a + (to_double(facet.b) - a) * u + (to_double(facet.c) - a) * v));
      }
      const double depth = lateral_depth(roof, centre, 10, facet);
      EXPECT_GE(depth, 10 - least - 1e-9);
      EXPECT_LE(depth, 10 - least + 0.3);
    }
  }
}

}  // namespace
}  // namespace aerate
