#include <gtest/gtest.h>

#include "printing/strength.h"

namespace aerate::test {
namespace {

TEST(Strength, IsThatOfTheMaterialWithoutVoidsAndNothingWithoutMaterial) {
  EXPECT_NEAR(stiffness_upper_bound(1.0), 1.0, 1e-12);
  EXPECT_EQ(stiffness_upper_bound(0.0), 0.0);
}

TEST(Strength, HasAClosedFormForAPoissonRatioOfAFifth) {
  // Bulk and shear modulus fall alike there, to (1 - v) / (1 + v) for a share v of voids.
  for (const double voids : {0.05, 0.2, 0.35, 0.6, 0.9})
    EXPECT_NEAR(stiffness_upper_bound(1 - voids, 0.2), (1 - voids) / (1 + voids), 1e-12);
}

TEST(Strength, IsBelowTheRuleOfMixturesAndFallsWithTheVoids) {
  double last = 1;
  for (double solid = 0.95; solid > 0; solid -= 0.05) {
    const double stiffness = stiffness_upper_bound(solid);
    EXPECT_LT(stiffness, solid);
    EXPECT_LT(stiffness, last);
    EXPECT_GT(stiffness, 0);
    last = stiffness;
  }
}

}  // namespace
}  // namespace aerate::test
