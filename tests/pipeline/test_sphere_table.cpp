#include <gtest/gtest.h>
#include <string>

#include "core/error.h"
#include "pipeline/sphere_table.h"
#include "tests/support/caught.h"
#include "tests/support/temporary_folder.h"

namespace aerate {
namespace {

Packing some_packing() {
  Packing packing;
  packing.spheres = {{{1.0 / 3, -2e-17, 1e5}, 0.1, SphereKind::lattice},
                     {{5, 6, 7}, 1.2345678901234567, SphereKind::replacement},
                     {{-5, 0.1, 7}, 2, SphereKind::adaptive}};
  return packing;
}

class SphereTable : public ::testing::Test {
 protected:
  std::string refusal(const std::string& name, const std::string& text) const {
    return test::message_of<InputError>([&] { read_sphere_table(folder_.write(name, text)); });
  }

  test::TemporaryFolder folder_;
};

TEST_F(SphereTable, ReadsBackToTheSameBitsInEveryFormat) {
  const Packing packing = some_packing();
  for (const char* name : {"s.csv", "s.json", "s.PLY"}) {
    const auto file = folder_.write(name, sphere_table(packing, sphere_format_of(name)));
    const std::vector<Sphere> read = read_sphere_table(file);
    ASSERT_EQ(read.size(), packing.spheres.size()) << name;
    for (std::size_t i = 0; i < read.size(); ++i) {
      EXPECT_EQ(read[i].centre, packing.spheres[i].centre) << name;
      EXPECT_EQ(read[i].radius, packing.spheres[i].radius) << name;
      EXPECT_EQ(read[i].kind, packing.spheres[i].kind) << name;
    }
  }
}

TEST_F(SphereTable, KindMayBeMissing) {
  const std::vector<Sphere> read = read_sphere_table(folder_.write("s.csv", "x,y,z,radius\r\n1,2,3,4\r\n"));
  ASSERT_EQ(read.size(), 1U);
  EXPECT_EQ(read[0].radius, 4.0);
  EXPECT_EQ(read[0].kind, SphereKind::adaptive);
}

TEST_F(SphereTable, NonsenseIsRefusedWithItsPlace) {
  const std::string header = "x,y,z,radius,kind\n";
  EXPECT_TRUE(test::contains(refusal("a.csv", header + "1,2,3,4,lattice\n1,2,3\n"), "line 3"));
  EXPECT_TRUE(test::contains(refusal("a.csv", header + "1,2,nan,4,lattice\n"), "not finite"));
  EXPECT_TRUE(test::contains(refusal("a.csv", header + "1,2,3,-4,lattice\n"), "-4"));
  EXPECT_TRUE(test::contains(refusal("a.csv", header + "1,2,3,4,cube\n"), "cube"));
  EXPECT_TRUE(test::contains(refusal("a.csv", "solid\n"), "header"));
  EXPECT_TRUE(test::contains(refusal("a.csv", header), "no spheres"));
  EXPECT_TRUE(test::contains(refusal("a.json", "{\"schema\": \"aerate.spheres\""), "parse error"));
  EXPECT_TRUE(test::contains(
      refusal("a.json", R"({"schema": "aerate.spheres", "unit": "inch", "spheres": []})"), "unit"));
  EXPECT_TRUE(test::contains(
      refusal("a.json", R"({"schema": "aerate.spheres", "unit": "mm", "spheres": [[1, 2, 3]]})"),
      "sphere 1"));
  const std::string ply = sphere_table(some_packing(), SphereFormat::ply);
  EXPECT_TRUE(test::contains(refusal("a.ply", ply.substr(0, ply.size() / 2 + 60)), "a.ply"));
  EXPECT_THROW(read_sphere_table(folder_.path() / "none.csv"), InputError);
  EXPECT_THROW(read_sphere_table(folder_.path() / "s.txt"), UsageError);
}

}  // namespace
}  // namespace aerate
