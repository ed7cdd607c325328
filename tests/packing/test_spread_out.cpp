#include <algorithm>
#include <cstddef>
#include <gtest/gtest.h>
#include <random>
#include <vector>

#include "packing/spread_out.h"

namespace aerate {
namespace {

std::vector<Sphere> random_spheres(std::size_t count) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> place(-50, 50), radius(1, 5);
  std::vector<Sphere> spheres;
  for (std::size_t i = 0; i < count; ++i)
    spheres.push_back({{place(random), place(random), place(random)}, radius(random), SphereKind::adaptive});
  return spheres;
}

}  // namespace

TEST(SpreadOut, KeepsSpheresThatAreFarApartAndOneNearEachThatGoes) {
  constexpr double kSpacing = 12;
  const std::vector<Sphere> all = random_spheres(2000);
  const std::vector<Sphere> kept = spread_out(all, kSpacing);
  EXPECT_GT(kept.size(), 100U);
  EXPECT_LT(kept.size(), 1000U);
  for (std::size_t i = 0; i < kept.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) EXPECT_GE(length(kept[i].centre - kept[j].centre), kSpacing);
  }
  for (const Sphere& sphere : all) {
    // Itself, or one that is no smaller.
    EXPECT_TRUE(std::ranges::any_of(kept, [&](const Sphere& other) {
      return length(other.centre - sphere.centre) < kSpacing && other.radius >= sphere.radius;
    }));
  }
}

TEST(SpreadOut, KeepsTheOrder) {
  const std::vector<Sphere> all = random_spheres(300);
  const std::vector<Sphere> kept = spread_out(all, 10);
  std::size_t at = 0;
  for (const Sphere& sphere : kept) {
    while (at < all.size() && !(all[at].centre == sphere.centre)) ++at;
    ASSERT_LT(at, all.size());
  }
}

TEST(SpreadOut, LeavesWhatIsFarApartAsItIs) {
  const std::vector<Sphere> far = {{{0, 0, 0}, 1, SphereKind::adaptive},
                                   {{10, 0, 0}, 3, SphereKind::adaptive}};
  EXPECT_EQ(spread_out(far, 10).size(), 2U);
  EXPECT_EQ(spread_out(far, 10.1).size(), 1U);
  EXPECT_TRUE(spread_out({}, 1).empty());
}

}  // namespace aerate
