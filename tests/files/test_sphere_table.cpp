#include <gtest/gtest.h>
#include <string>

#include "core/error.h"
#include "files/sphere_table.h"
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
  EXPECT_TRUE(test::contains(refusal("a.csv", header + "1,2,3,4,lattice,5\n"), "6 fields"));
  EXPECT_TRUE(test::contains(refusal("a.csv", header + "1,2,3,,lattice\n"), "''"));
  EXPECT_TRUE(test::contains(refusal("a.csv", header), "no spheres"));
  EXPECT_TRUE(test::contains(refusal("a.json", "{\"schema\": \"aerate.spheres\""), "parse error"));
  EXPECT_TRUE(test::contains(
      refusal("a.json", R"({"schema": "aerate.spheres", "unit": "inch", "spheres": []})"), "unit"));
  EXPECT_TRUE(test::contains(
      refusal("a.json", R"({"schema": "aerate.spheres", "unit": "mm", "spheres": [[1, 2, 3]]})"),
      "sphere 1"));
  EXPECT_TRUE(test::contains(refusal("a.json", "[1, 2, 3]"), "a.json"));
  const std::string ply = sphere_table(some_packing(), SphereFormat::ply);
  const std::string one_sphere =
      "ply\nformat ascii 1.0\nelement vertex 1\nproperty double x\nproperty double y\nproperty double z\n"
      "property double radius\nproperty uchar kind\nend_header\n1 2 3 4 ";
  EXPECT_EQ(read_sphere_table(folder_.write("a.ply", one_sphere + "0\n")).size(), 1U);
  for (const char* kind : {"9", "-1", "nan", "0.5", "lattice"}) {
    EXPECT_TRUE(test::contains(refusal("a.ply", one_sphere + kind + "\n"), "a.ply"));
  }
  EXPECT_TRUE(test::contains(refusal("a.ply", ply.substr(0, ply.size() / 2 + 60)), "a.ply"));
  EXPECT_THROW(read_sphere_table(folder_.path() / "none.csv"), InputError);
  EXPECT_THROW(read_sphere_table(folder_.path() / "s.txt"), UsageError);
}

// Other columns than ours may mean other things than millimetres.
TEST_F(SphereTable, OtherHeadersAreRefused) {
  for (const char* header :
       {"", "solid", "1,2,3,4,lattice", "x;y;z;radius;kind", "x,y,z,radius_inch", "x,y,z,r", "x,y,z,diameter",
        "z,y,x,radius,kind", "x,y,z,radius,kind,name", "X,Y,Z,RADIUS", "x,y,z"}) {
    const std::string message = refusal("a.csv", std::string(header) + "\n1,2,3,4,lattice\n");
    EXPECT_TRUE(test::contains(message, "a.csv: line 1: the header is not x,y,z,radius,kind")) << header;
  }
}

TEST_F(SphereTable, MarksAndLineEndsOfSpreadsheetsAreRead) {
  const auto csv = folder_.write("s.csv", "\xEF\xBB\xBFx,y,z,radius,kind\r\n1,2,3,4,lattice\r\n\r\n");
  ASSERT_EQ(read_sphere_table(csv).size(), 1U);
  EXPECT_EQ(read_sphere_table(csv)[0].kind, SphereKind::lattice);
  std::string ply = sphere_table(some_packing(), SphereFormat::ply);
  for (std::size_t end = ply.find('\n'); end != std::string::npos; end = ply.find('\n', end + 2)) {
    ply.insert(end, 1, '\r');
  }
  EXPECT_EQ(read_sphere_table(folder_.write("s.ply", ply)).size(), 3U);
}

TEST_F(SphereTable, LargeNumbersAreFinite) {
  const auto file = folder_.write("s.csv", "x,y,z,radius\n1e308,1e308,1e308,1e308\n");
  EXPECT_EQ(read_sphere_table(file).at(0).radius, 1e308);
}

}  // namespace
}  // namespace aerate
