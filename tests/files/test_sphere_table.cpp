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
    const auto file = folder_.write(name, sphere_table(packing, sphere_format_to_write(name), {}));
    const std::vector<Sphere> read = read_sphere_table(file);
    ASSERT_EQ(read.size(), packing.spheres.size()) << name;
    for (std::size_t i = 0; i < read.size(); ++i) {
      EXPECT_EQ(read[i].centre, packing.spheres[i].centre) << name;
      EXPECT_EQ(read[i].radius, packing.spheres[i].radius) << name;
      EXPECT_EQ(read[i].kind, packing.spheres[i].kind) << name;
    }
  }
}

// Programs that simulate grains read these (tests/python); here is what they hold, to the letter.
TEST_F(SphereTable, ForParaViewIsPolyDataInFullPrecision) {
  const std::string text = sphere_table(some_packing(), SphereFormat::vtk, {});
  EXPECT_TRUE(test::contains(text, R"(<Piece NumberOfPoints="3" NumberOfVerts="3")"));
  EXPECT_TRUE(test::contains(text, "\n0.3333333333333333 -2e-17 100000\n5 6 7\n-5 0.1 7\n</DataArray>"));
  EXPECT_TRUE(test::contains(text, "Name=\"radius\" format=\"ascii\">\n0.1\n1.2345678901234567\n2\n<"));
  EXPECT_TRUE(test::contains(text, "Name=\"kind\" format=\"ascii\">\n0\n3\n4\n<"));
  EXPECT_TRUE(test::contains(text, "Name=\"connectivity\" format=\"ascii\">\n0\n1\n2\n<"));
  EXPECT_TRUE(test::contains(text, "Name=\"offsets\" format=\"ascii\">\n1\n2\n3\n<"));
  EXPECT_TRUE(test::contains(text, "Name=\"unit\" NumberOfTuples=\"1\" format=\"ascii\">\n109 109 0\n<"));
}

TEST_F(SphereTable, ForLammpsAreDiametersInTheModelsBox) {
  EXPECT_EQ(sphere_table(some_packing(), SphereFormat::lammps, {{-8, -1, 0}, {6, 7.5f, 2e5f}}),
            "spheres packed by aerate: lengths in mm, density 1 (give yours: set type 1 density D)\n\n"
            "3 atoms\n1 atom types\n\n-8 6 xlo xhi\n-1 7.5 ylo yhi\n0 200000 zlo zhi\n\nAtoms # sphere\n\n"
            "1 1 0.2 1 0.3333333333333333 -2e-17 100000\n2 1 2.4691357802469134 1 5 6 7\n3 1 4 1 -5 0.1 7\n");
}

TEST_F(SphereTable, ForYadeAreLinesOfFourNumbers) {
  EXPECT_EQ(sphere_table(some_packing(), SphereFormat::yade, {}),
            "#format x_y_z_r\n# lengths in mm\n0.3333333333333333 -2e-17 100000 0.1\n"
            "5 6 7 1.2345678901234567\n-5 0.1 7 2\n");
}

TEST_F(SphereTable, WhatIsForOtherProgramsIsOnlyWritten) {
  for (const char* name : {"s.vtp", "s.data", "s.txt"}) {
    const auto file = folder_.write(name, sphere_table(some_packing(), sphere_format_to_write(name), {}));
    const std::string message = test::message_of<UsageError>([&] { read_sphere_table(file); });
    EXPECT_TRUE(test::contains(message, "spheres cannot be read from ." + std::string(name).substr(2)));
    EXPECT_TRUE(test::contains(message, "ends in .csv, .json or .ply"));
  }
  EXPECT_TRUE(test::contains(test::message_of<UsageError>([] { sphere_format_to_write("s.xyz"); }),
                             ".ply, .vtp (ParaView), .data (LAMMPS) or .txt (YADE)"));
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
  const std::string ply = sphere_table(some_packing(), SphereFormat::ply, {});
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
  std::string ply = sphere_table(some_packing(), SphereFormat::ply, {});
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
