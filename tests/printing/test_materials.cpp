#include <gtest/gtest.h>

#include "core/error.h"
#include "printing/materials.h"

namespace aerate {
namespace {

TEST(Materials, AreFoundInAnyCase) {
  EXPECT_EQ(find_material("PLA").density, 1.24);
  EXPECT_EQ(find_material("petg").density, 1.27);
  EXPECT_EQ(find_material("Abs").density, 1.04);
  EXPECT_EQ(find_material("RESIN").density, 1.10);
  EXPECT_EQ(find_material("pa12").density, 1.01);
  for (const Material& material : materials()) EXPECT_GT(material.price, 0) << material.name;
}

TEST(Materials, AnUnknownOneNamesThoseThereAre) {
  try {
    find_material("PLA+");
    FAIL() << "PLA+ is not a preset";
  } catch (const UsageError& error) {
    EXPECT_STREQ(error.what(), "unknown material \"PLA+\"");
    EXPECT_EQ(error.hint(),
              "use one of PLA, PETG, ABS, resin, PA12, AlSi10Mg, or give --density and --price");
  }
  EXPECT_THROW(find_material(""), UsageError);
  EXPECT_THROW(find_material("PL"), UsageError);
}

}  // namespace
}  // namespace aerate
