#include <gtest/gtest.h>

#include "core/error.h"
#include "printing/materials.h"
#include "tests/support/caught.h"

namespace aerate {
namespace {

using test::contains;
using test::message_of;

TEST(Materials, AreFoundInAnyCase) {
  EXPECT_EQ(choose_material("PLA").density_g_cm3, 1.24);
  EXPECT_EQ(choose_material("petg").density_g_cm3, 1.27);
  EXPECT_EQ(choose_material("Abs").density_g_cm3, 1.04);
  EXPECT_EQ(choose_material("RESIN").density_g_cm3, 1.10);
  EXPECT_EQ(choose_material("pa12").density_g_cm3, 1.01);
  for (const Material& material : materials()) EXPECT_GT(material.price_per_kg, 0) << material.name;
}

TEST(Materials, AnUnknownOneNamesThoseThereAre) {
  try {
    choose_material("PLA+");
    FAIL() << "PLA+ is not a preset";
  } catch (const UsageError& error) {
    EXPECT_STREQ(error.what(), "unknown material \"PLA+\"");
    EXPECT_EQ(error.hint(),
              "use one of PLA, PETG, ABS, resin, PA12, AlSi10Mg, or give --density and --price");
  }
  EXPECT_THROW(choose_material(""), UsageError);
  EXPECT_THROW(choose_material("PL"), UsageError);
}

TEST(Materials, FiguresCanBeOverridden) {
  EXPECT_EQ(choose_material("petg", {}).name, "PETG");
  const Material dear = choose_material("PLA", {.price = 90});
  EXPECT_EQ(dear.price_per_kg, 90);
  EXPECT_EQ(dear.density_g_cm3, choose_material("PLA").density_g_cm3);
  EXPECT_EQ(choose_material("oak", {.density_g_cm3 = 0.7, .price = 3}).density_g_cm3, 0.7);
  EXPECT_TRUE(
      contains(message_of<UsageError>([] { choose_material("oak", {.density_g_cm3 = 0.7}); }), "PLA"));
}

TEST(Materials, APriceMayBeThatOfALitre) {
  const Material resin = choose_material("resin", {.price = 60, .per = PriceUnit::litre});
  EXPECT_DOUBLE_EQ(resin.price_per_litre(), 60);
  EXPECT_DOUBLE_EQ(resin.price_per_kg * resin.density_g_cm3, 60);
  EXPECT_EQ(resin.priced_per, PriceUnit::litre);
  // The density that was given counts, of a material of its own too.
  EXPECT_DOUBLE_EQ(
      choose_material("resin", {.density_g_cm3 = 1.2, .price = 60, .per = PriceUnit::litre}).price_per_kg,
      50);
  EXPECT_DOUBLE_EQ(
      choose_material("wax", {.density_g_cm3 = 0.9, .price = 90, .per = PriceUnit::litre}).price_per_kg, 100);
  EXPECT_DOUBLE_EQ(choose_material("wax", {.density_g_cm3 = 0.9, .price = 90}).price_per_litre(), 81);
  EXPECT_EQ(choose_material("resin").priced_per, PriceUnit::kilogram);
}

// A litre of loose powder holds less of it than a litre of what is printed.
TEST(Materials, APriceMayBeThatOfPowderByBulk) {
  const Material powder = choose_material("PA12", {.price = 20, .per = PriceUnit::bulk_litre});
  EXPECT_DOUBLE_EQ(powder.price_per_kg, 20 / 0.425);
  EXPECT_DOUBLE_EQ(powder.price_per(PriceUnit::bulk_litre), 20);
  EXPECT_GT(powder.price_per_litre(), 40);
  const MaterialFigures loose{.bulk_density_g_cm3 = 0.5, .price = 20, .per = PriceUnit::bulk_litre};
  EXPECT_DOUBLE_EQ(choose_material("PA12", loose).price_per_kg, 40);
  // Loose powder is no denser than what is printed of it.
  EXPECT_THROW(choose_material("PA12", {.bulk_density_g_cm3 = 1.01}), UsageError);
  EXPECT_TRUE(contains(message_of<UsageError>(
                           [] { choose_material("AlSi10Mg", {.price = 20, .per = PriceUnit::bulk_litre}); }),
                       "bulk density of AlSi10Mg"));
}

}  // namespace
}  // namespace aerate
