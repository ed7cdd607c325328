#include <cmath>
#include <gtest/gtest.h>
#include <numbers>
#include <tbb/global_control.h>

#include "core/error.h"
#include "core/monitor.h"
#include "packing/largest_places.h"
#include "packing/verify.h"
#include "tests/support/clearance.h"
#include "tests/support/shapes.h"

namespace aerate {
namespace {

TEST(LargestInscribedSphere, IsThatOfABoxAndOfATorus) {
  Monitor monitor;
  const SurfaceIndex box(test::make_box({0, 0, 0}, {4, 10, 30}));
  const Sphere in_box = largest_inscribed_sphere(box, monitor);
  EXPECT_NEAR(in_box.radius, 2.0, 0.02);
  const Mesh torus = test::make_torus(20, 3, 128, 64);
  const Sphere in_torus = largest_inscribed_sphere(SurfaceIndex(torus), monitor);
  EXPECT_NEAR(in_torus.radius, 3.0 * std::cos(std::numbers::pi / 64), 0.03);
  EXPECT_NEAR(test::distance_to_surface(torus, in_torus.centre), in_torus.radius, 1e-9);
}

TEST(LargestInscribedSphere, LookingForItCanBeInterrupted) {
  class StoppedLater : public Monitor {
   public:
    void check_interrupted() override {
      if (++polls_ > 20) throw InterruptedError();
    }

   private:
    int polls_ = 0;
  } monitor;
  const SurfaceIndex box(test::make_box({0, 0, 0}, {4, 10, 30}));
  EXPECT_THROW(largest_inscribed_sphere(box, monitor), InterruptedError);
}

PackingLimits limits_of(double wall, double gap, double least, double largest) {
  PackingLimits limits;
  limits.wall = wall;
  limits.gap = gap;
  limits.min_radius = least;
  limits.max_radius = largest;
  return limits;
}

TEST(LargestPlaces, FillARingAndKeepAllLimits) {
  Monitor monitor;
  const SurfaceIndex torus(test::make_torus(20, 3, 128, 64));
  const PackingLimits limits = limits_of(0.5, 0.4, 2.3, 2.4);
  const std::vector<Sphere> places = largest_places(torus, limits, {}, monitor);
  // As many as the ring has room for, if each takes the place of one and a half.
  EXPECT_GE(places.size(), static_cast<std::size_t>(2 * std::numbers::pi * 20 / (1.5 * 5.2)));
  Packing packing{places, limits, {}, {}};
  EXPECT_FALSE(find_fault(torus, packing));
  EXPECT_EQ(verify_packing(torus, packing).spheres.size(), places.size());
  // The same for any threads.
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  const std::vector<Sphere> again = largest_places(torus, limits, {}, monitor);
  ASSERT_EQ(again.size(), places.size());
  for (std::size_t i = 0; i < places.size(); ++i) {
    EXPECT_EQ(again[i].centre.x, places[i].centre.x);
    EXPECT_EQ(again[i].radius, places[i].radius);
  }
}

TEST(LargestPlaces, EndWhereTheyAreToldTo) {
  Monitor monitor;
  const SurfaceIndex box(test::make_box({0, 0, 0}, {10, 10, 40}));
  const PackingLimits limits = limits_of(1, 0.5, 3, 3.5);
  const auto count = [&](const PackingStop& stop) {
    return largest_places(box, limits, stop, monitor).size();
  };
  EXPECT_GE(count({}), 4U);
  EXPECT_EQ(count({.max_count = 2}), 2U);
  EXPECT_EQ(count({.target_density = 0.06, .volume = 4000}), 2U);  // 3.5 mm: 180 mm3 each
  EXPECT_EQ(largest_places(box, limits_of(1, 0.5, 4.2, 5), {}, monitor).size(), 0U);
}

}  // namespace
}  // namespace aerate
