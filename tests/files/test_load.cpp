#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>
#include <limits>
#include <random>
#include <sstream>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/error.h"
#include "core/mesh.h"
#include "files/load.h"
#include "tests/files/load_test.h"
#include "tests/support/binary_stl.h"
#include "tests/support/caught.h"
#include "tests/support/same_corners.h"
#include "tests/support/shapes.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/zip.h"

namespace aerate {
namespace {

using test::contains;
using test::expect_same_corners;
using test::Load;
using test::make_box;
using test::message_of;
using test::odd_box;
using test::TemporaryFolder;
using test::to_binary_stl;

constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();
constexpr float kInfinity = std::numeric_limits<float>::infinity();

std::string to_text_stl(const Mesh& mesh, const std::string& name) {
  std::ostringstream out;
  out.precision(9);
  out << "solid " << name << "\n";
  for (const Triangle& t : mesh.triangles) {
    out << "  facet normal 0 0 0\n    outer loop\n";
    for (const std::uint32_t v : t) {
      const Vec3f p = mesh.positions[v];
      out << "      vertex " << p.x << " " << p.y << " " << p.z << "\n";
    }
    out << "    endloop\n  endfacet\n";
  }
  out << "endsolid " << name << "\n";
  return out.str();
}

// ---- STL

TEST_F(Load, BinaryStlKeepsBitsAndTriangleOrder) {
  const LoadedModel model = load("box.stl", to_binary_stl(odd_box()));
  EXPECT_EQ(model.format, "STL");
  EXPECT_EQ(model.part_count, 1u);
  EXPECT_EQ(model.mesh.positions.size(), 8u);
  expect_same_corners(model.mesh, odd_box());
}

TEST_F(Load, BinaryStlThatBeginsWithSolidIsBinary) {
  const LoadedModel model = load("box.stl", to_binary_stl(odd_box(), "solid made by some exporter"));
  expect_same_corners(model.mesh, odd_box());
}

TEST_F(Load, HeaderOfBinaryStlMayHoldAnything) {
  for (const std::string header :
       {"COLOR=\xff\xff\xff\xff", "\xef\xbb\xbfname", "\xff\xfe\x01", "\x01\x02"}) {
    expect_same_corners(load("box.stl", to_binary_stl(odd_box(), header)).mesh, odd_box());
  }
}

TEST_F(Load, DegenerateAndRepeatedTrianglesOfStlStay) {
  Mesh mesh = odd_box();
  mesh.triangles.insert(mesh.triangles.begin() + 3,
                        {Triangle{1, 1, 2}, Triangle{0, 0, 0}, mesh.triangles[0]});
  const LoadedModel model = load("box.stl", to_binary_stl(mesh));
  expect_same_corners(model.mesh, mesh);
}

TEST_F(Load, ExtensionCountsInAnyCase) {
  EXPECT_EQ(load("BOX.STL", to_binary_stl(odd_box())).mesh.triangles.size(), 12u);
  EXPECT_EQ(load("box.Stl", to_text_stl(odd_box(), "x")).mesh.triangles.size(), 12u);
}

TEST_F(Load, TextStl) {
  const Mesh box = make_box({-1, 0.5f, 2}, {1.25f, 3, 4});
  const LoadedModel model = load("box.stl", to_text_stl(box, "box"));
  EXPECT_EQ(model.format, "STL");
  EXPECT_EQ(model.part_count, 1u);
  EXPECT_EQ(model.mesh.positions.size(), 8u);
  expect_same_corners(model.mesh, box);
}

TEST_F(Load, TextStlMayNameItsSolidsAnyhowAndWriteInCapitals) {
  const Mesh box = make_box({0, 0, 0}, {1, 2, 3});
  for (const std::string name : {"", "W\xc3\xbcrfel", "facet vertex 1 2 3", "my solid box",
                                 "a-very-very-long-name-of-more-than-a-word"}) {
    expect_same_corners(load("box.stl", to_text_stl(box, name)).mesh, box);
  }
  expect_same_corners(load("box.stl", "\xef\xbb\xbf" + to_text_stl(box, "box")).mesh, box);
  std::string capitals = to_text_stl(box, "box");
  for (char& c : capitals) c = static_cast<char>(std::toupper(c));
  expect_same_corners(load("box.stl", capitals).mesh, box);
}

TEST_F(Load, TextStlOfSeveralSolidsIsJoined) {
  const Mesh a = make_box({0, 0, 0}, {1, 1, 1});
  const Mesh b = make_box({5, 0, 0}, {6, 1, 1});
  const LoadedModel model = load("two.stl", to_text_stl(a, "first one") + to_text_stl(b, "second"));
  EXPECT_EQ(model.part_count, 2u);
  expect_same_corners(model.mesh, test::join(a, b));
}

TEST_F(Load, TruncatedBinaryStlSaysBothNumbers) {
  const std::string bytes = to_binary_stl(odd_box()).substr(0, 84 + 50 * 7 + 20);
  const std::string message = input_error("cut.stl", bytes);
  EXPECT_TRUE(contains(message, "12 triangles"));
  EXPECT_TRUE(contains(message, "684 bytes"));
  EXPECT_TRUE(contains(message, "454 bytes"));
  EXPECT_TRUE(contains(message, "truncated"));
}

TEST_F(Load, TruncatedBinaryStlThatBeginsWithSolidIsNotTakenForText) {
  const std::string bytes = to_binary_stl(odd_box(), "solid box").substr(0, 300);
  EXPECT_TRUE(contains(input_error("cut.stl", bytes), "truncated"));
}

TEST_F(Load, SizeOfBinaryStlDecidesWhatItHoldsAndSaysSo) {
  for (const int promised : {0, 11, 13, -1}) {
    std::string bytes = to_binary_stl(odd_box());
    std::memcpy(bytes.data() + 80, &promised, sizeof(promised));
    const LoadedModel model = load("count.stl", bytes);
    expect_same_corners(model.mesh, odd_box());
    ASSERT_EQ(model.notices.size(), 1u);
    EXPECT_TRUE(contains(model.notices[0], "holds 12"));
  }
  EXPECT_TRUE(load("count.stl", to_binary_stl(odd_box())).notices.empty());
}

TEST_F(Load, StlWithoutTriangles) {
  EXPECT_TRUE(contains(input_error("none.stl", to_binary_stl(Mesh{})), "no triangles"));
  EXPECT_TRUE(contains(input_error("none.stl", "solid nothing\nendsolid nothing\n"), "no triangles"));
}

TEST_F(Load, TruncatedTextStl) {
  const std::string text = to_text_stl(odd_box(), "box");
  const std::size_t last_facet = text.rfind("endfacet");
  for (const std::size_t size : {last_facet, last_facet + 3, text.rfind("endsolid") + 4})
    EXPECT_TRUE(contains(input_error("cut.stl", text.substr(0, size)), "after triangle 12")) << size;
  EXPECT_TRUE(contains(input_error("cut.stl", text.substr(0, text.size() / 2)), "truncated"));
}

TEST_F(Load, TextStlWithAFacetOfTwoOrFourVerticesNamesTheLine) {
  std::string text = to_text_stl(odd_box(), "box");
  const std::size_t vertex = text.find("      vertex");
  const std::string line = text.substr(vertex, text.find('\n', vertex) + 1 - vertex);
  EXPECT_TRUE(contains(input_error("four.stl", std::string(text).insert(vertex, line)), "line 7"));
  EXPECT_TRUE(contains(input_error("two.stl", std::string(text).erase(vertex, line.size())),
                       "triangle of 2 vertices"));
}

TEST_F(Load, NotFiniteCoordinatesNameTheTriangle) {
  for (const float bad : {kNaN, kInfinity, -kInfinity}) {
    Mesh mesh = odd_box();
    mesh.positions.push_back({0, bad, 0});
    mesh.triangles[4][1] = 8;
    const std::string message = input_error("bad.stl", to_binary_stl(mesh));
    EXPECT_TRUE(contains(message, "triangle 5"));
    EXPECT_TRUE(contains(message, "NaN or infinite"));
    EXPECT_TRUE(contains(input_error("bad.stl", to_text_stl(mesh, "box")), "triangle 5"));
  }
}

// ---- units and scale

TEST_F(Load, UnitAndScaleAreAppliedInDoubleAndRoundedOnce) {
  const std::string bytes = to_binary_stl(odd_box());
  const std::array<std::pair<LengthUnit, double>, 4> units{{{LengthUnit::millimetre, 1.0},
                                                            {LengthUnit::centimetre, 10.0},
                                                            {LengthUnit::metre, 1000.0},
                                                            {LengthUnit::inch, 25.4}}};
  for (const auto& [unit, factor] : units) {
    for (const double scale : {1.0, 0.3, 7.1}) {
      Mesh expected = odd_box();
      for (Vec3f& p : expected.positions) p = to_float(to_double(p) * (factor * scale));
      expect_same_corners(load("box.stl", bytes, {.unit = unit, .scale = {scale, scale, scale}}).mesh,
                          expected);
    }
  }
}

TEST_F(Load, EachAxisHasAScaleOfItsOwn) {
  const Vec3d scale{1.02, 0.97, 3};
  Mesh expected = odd_box();
  for (Vec3f& p : expected.positions) {
    const Vec3d at = to_double(p) * 25.4;
    p = to_float({at.x * scale.x, at.y * scale.y, at.z * scale.z});
  }
  const LoadOptions options{.unit = LengthUnit::inch, .scale = scale};
  const double volume = signed_volume(odd_box()) * 25.4 * 25.4 * 25.4 * scale.x * scale.y * scale.z;
  for (const auto& [name, bytes] : {std::pair{"binary.stl", to_binary_stl(odd_box())},
                                    std::pair{"text.stl", to_text_stl(odd_box(), "box")}}) {
    const Mesh mesh = load(name, bytes, options).mesh;
    EXPECT_NEAR(signed_volume(mesh), volume, 1e-5 * volume) << name;
  }
  expect_same_corners(load("binary.stl", to_binary_stl(odd_box()), options).mesh, expected);
}

TEST_F(Load, UnusableScaleIsAUsageError) {
  const std::filesystem::path path = write("box.stl", to_binary_stl(odd_box()));
  for (const double scale :
       {0.0, -1.0, std::numeric_limits<double>::infinity(), std::numeric_limits<double>::quiet_NaN()}) {
    for (const Vec3d scales :
         {Vec3d{scale, scale, scale}, Vec3d{scale, 1, 1}, Vec3d{1, scale, 1}, Vec3d{1, 1, scale}})
      EXPECT_TRUE(contains(message_of<UsageError>([&] { load_model(path, {.unit = {}, .scale = scales}); }),
                           "scale"));
  }
}

TEST_F(Load, OverflowThroughScaleIsAnInputError) {
  const std::filesystem::path path = write("box.stl", to_binary_stl(odd_box()));
  const std::string message = message_of<InputError>([&] {
    load_model(path, {.unit = {}, .scale = {1e39, 1e39, 1e39}});
  });
  EXPECT_TRUE(contains(message, "too large"));
  EXPECT_TRUE(contains(message, "--scale"));
}

// ---- OBJ, PLY, OFF

TEST_F(Load, ObjWithQuadsAndSeveralObjects) {
  const LoadedModel model = load_model(std::filesystem::path(AERATE_TEST_DATA) / "two_boxes_quads.obj");
  EXPECT_EQ(model.format, "OBJ");
  EXPECT_EQ(model.part_count, 2u);
  EXPECT_EQ(model.mesh.triangles.size(), 24u);
  EXPECT_EQ(model.mesh.positions.size(), 16u);
  EXPECT_NEAR(signed_volume(model.mesh), 1.0 + 8.0, 1e-6);
}

TEST_F(Load, ObjWithRelativeIndicesNormalsPointsAndLines) {
  const LoadedModel model =
      load("mixed.obj",
           "# a comment\nmtllib nowhere.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nvn 0 0 1\n"
           "usemtl red\nf 1//1 3//1 2//1\nl 1 2\nf -4 -3 -1\nusemtl blue\nf 2 3 4\nf 3 1 4\np 1\n");
  EXPECT_EQ(model.mesh.triangles.size(), 4u);
  EXPECT_EQ(model.mesh.positions.size(), 4u);
  EXPECT_NEAR(signed_volume(model.mesh), 1.0 / 6.0, 1e-7);
}

TEST_F(Load, BadObj) {
  EXPECT_TRUE(contains(input_error("range.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 4\n"), "line 4"));
  EXPECT_TRUE(contains(input_error("back.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf -4 2 3\n"), "line 4"));
  EXPECT_TRUE(contains(input_error("word.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf one 2 3\n"), "'one'"));
  EXPECT_TRUE(contains(input_error("cut.obj", "v 0 0 0\nv 1 0 0\nv 0 1"), "line 3"));
  EXPECT_TRUE(contains(input_error("points.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\n"), "no faces"));
  EXPECT_TRUE(
      contains(input_error("lines.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2\nl 1 2\n"), "no triangles"));
  EXPECT_TRUE(contains(input_error("nan.obj", "v 0 0 0\nv 1 0 0\nv 0 nan 0\nf 1 2 3\n"), "triangle 1"));
}

constexpr std::string_view kTextPly =
    "ply\nformat ascii 1.0\ncomment made by hand\nelement vertex 4\nproperty float x\nproperty float y\n"
    "property float z\nproperty uchar red\nelement face 3\nproperty list uchar int vertex_indices\n"
    "property uchar quality\nend_header\n0 0 0 255\n1 0 0 255\n1 1 0 255\n0 1 0 255\n"
    "4 0 1 2 3 7\n3 0 2 1 7\n3 0 3 2 7\n";

std::string binary_ply(bool big_endian) {
  std::string bytes =
      std::string("ply\nformat binary_") + (big_endian ? "big" : "little") +
      "_endian 1.0\nelement vertex 8\nproperty double x\nproperty double y\nproperty double z\n"
      "element face 12\nproperty list uchar uint vertex_index\nend_header\n";
  const auto append = [&](auto value) {
    std::array<char, sizeof(value)> raw{};
    std::memcpy(raw.data(), &value, raw.size());
    if (big_endian) std::reverse(raw.begin(), raw.end());
    bytes.append(raw.data(), raw.size());
  };
  const Mesh box = odd_box();
  for (const Vec3f p : box.positions) {
    append(static_cast<double>(p.x));
    append(static_cast<double>(p.y));
    append(static_cast<double>(p.z));
  }
  for (const Triangle& t : box.triangles) {
    append(std::uint8_t{3});
    for (const std::uint32_t v : t) append(v);
  }
  return bytes;
}

TEST_F(Load, TextPlyWithAQuad) {
  const LoadedModel model = load("open.ply", kTextPly);
  EXPECT_EQ(model.format, "PLY");
  EXPECT_EQ(model.mesh.triangles.size(), 4u);
  EXPECT_NEAR(surface_area(model.mesh), 2.0, 1e-6);
}

TEST_F(Load, FacesOfPlyWithoutCornersAreLeftOut) {
  std::string text(kTextPly);
  text.replace(text.find("4 0 1 2 3 7"), 11, "0 7");
  EXPECT_EQ(load("hollow.ply", text).mesh.triangles.size(), 2u);
}

TEST_F(Load, TextCoordinatesAreReadToTheLastPlace) {
  std::mt19937 random(9);
  std::uniform_real_distribution<float> coordinate(-100, 100);
  std::ostringstream text;
  text.precision(9);
  std::vector<Vec3f> corners;
  for (int i = 0; i < 3000; ++i) {
    const Vec3f p = corners.emplace_back(Vec3f{coordinate(random), coordinate(random), coordinate(random)});
    text << "v " << p.x << " " << p.y << " " << p.z << "\n";
  }
  for (int i = 1; i < 3000; i += 3) text << "f " << i << " " << i + 1 << " " << i + 2 << "\n";
  const Mesh mesh = load("soup.obj", text.str()).mesh;
  const auto within_one_place = [](float a, float b) { return a == b || a == std::nextafter(b, a); };
  ASSERT_EQ(mesh.positions.size(), corners.size());
  for (std::size_t i = 0; i < corners.size(); ++i) {
    EXPECT_TRUE(within_one_place(mesh.positions[i].x, corners[i].x));
    EXPECT_TRUE(within_one_place(mesh.positions[i].y, corners[i].y));
    EXPECT_TRUE(within_one_place(mesh.positions[i].z, corners[i].z));
  }
}

TEST_F(Load, BinaryPlyOfEitherByteOrderKeepsBits) {
  for (const bool big_endian : {false, true}) {
    const LoadedModel model = load("box.ply", binary_ply(big_endian));
    expect_same_corners(model.mesh, odd_box());
  }
}

TEST_F(Load, BadPly) {
  for (const bool big_endian : {false, true}) {
    const std::string bytes = binary_ply(big_endian);
    EXPECT_TRUE(contains(input_error("cut.ply", bytes.substr(0, bytes.size() - 5)), "after 11 of 12"));
    EXPECT_TRUE(
        contains(input_error("cut.ply", bytes.substr(0, bytes.size() - 12 * 13 - 30)), "after 6 of 8"));
    std::string index = bytes;
    index[index.size() - 4] = index[index.size() - 1] = 100;
    EXPECT_TRUE(contains(input_error("index.ply", index), "out of range"));
  }
  std::string text(kTextPly);
  EXPECT_TRUE(contains(input_error("cut.ply", text.substr(0, text.size() - 10)), "after 2 of 3"));
  EXPECT_TRUE(contains(input_error("cut.ply", text.substr(0, 100)), "header"));
  EXPECT_TRUE(contains(input_error("short.ply", text.substr(0, text.size() - 6) + "\n"), "face 2"));
  std::string huge = text;
  huge.replace(huge.find("face 3"), 6, "face 900000000");
  EXPECT_TRUE(contains(input_error("huge.ply", huge), "after 3 of 900000000"));
  std::string nan = text;
  nan.replace(nan.find("1 1 0 255"), 9, "1 nan 0 255");
  EXPECT_TRUE(contains(input_error("nan.ply", nan), "triangle 1"));
  std::string cloud = text.substr(0, text.find("4 0 1 2 3"));
  cloud.replace(cloud.find("face 3"), 6, "face 0");
  EXPECT_TRUE(contains(input_error("cloud.ply", cloud), "no faces"));
}

constexpr std::string_view kOff =
    "OFF # a tetrahedron\n# by hand\n4 4 6\n\n0 0 0\n1 0 0 # here\n0 1 0\n0 0 1\n"
    "3 0 2 1\n3 0 1 3 255 0 0\n# one more\n3 1 2 3\n3 0 3 2\n";

TEST_F(Load, OffWithCommentsAndBlankLines) {
  const LoadedModel model = load("tetrahedron.off", kOff);
  EXPECT_EQ(model.format, "OFF");
  EXPECT_EQ(model.mesh.triangles.size(), 4u);
  EXPECT_NEAR(signed_volume(model.mesh), 1.0 / 6.0, 1e-7);
}

TEST_F(Load, OffVariants) {
  EXPECT_EQ(load("counts.off", "OFF 3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2").mesh.triangles.size(), 1u);
  EXPECT_EQ(
      load("colours.off", "COFF\n3 1 0\n0 0 0 255 0 0 255\n1 0 0 0 255 0 255\n0 1 0 0 0 255 255\n3 0 1 2\n")
          .mesh.triangles.size(),
      1u);
  EXPECT_EQ(load("quad.off", "OFF\r\n4 1 0\r\n0 0 0\r\n1 0 0\r\n1 1 0\r\n0 1 0\r\n4 0 1 2 3\r\n")
                .mesh.triangles.size(),
            2u);
}

TEST_F(Load, BadOff) {
  const std::string text(kOff);
  EXPECT_TRUE(contains(input_error("cut.off", text.substr(0, text.rfind("3 0 3 2"))), "3 of 4 faces"));
  EXPECT_TRUE(contains(input_error("cut.off", text.substr(0, text.find("0 1 0"))), "2 of 4 vertices"));
  EXPECT_TRUE(
      contains(input_error("range.off", text.substr(0, text.rfind("3 0 3 2")) + "3 0 4 2\n"), "line 13"));
  EXPECT_TRUE(contains(input_error("magic.off", "OBJ\n1 1 1\n"), "no OFF file"));
  EXPECT_TRUE(contains(input_error("huge.off", "OFF\n4000000000 4000000000 0\n0 0 0\n"), "truncated"));
  EXPECT_TRUE(contains(input_error("many.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n10 0 1 2 0 1 2 0 1 2 0\n"),
                       "10 corners"));
  EXPECT_TRUE(contains(input_error("word.off", "OFF\n3 1 0\n0 0 0\n1 x 0\n0 1 0\n3 0 1 2\n"), "word.off"));
}

// ---- files that are not models

TEST_F(Load, MissingDirectoryAndEmpty) {
  const std::filesystem::path missing = folder_.path() / "nowhere.stl";
  EXPECT_TRUE(contains(message_of<InputError>([&] { load_model(missing); }), "no such file"));
  const std::filesystem::path directory = folder_.path() / "folder.stl";
  std::filesystem::create_directory(directory);
  EXPECT_TRUE(contains(message_of<InputError>([&] { load_model(directory); }), "a directory"));
  for (const char* name : {"empty.stl", "empty.obj", "empty.ply", "empty.off", "empty.3mf"}) {
    EXPECT_TRUE(contains(input_error(name, ""), "empty"));
  }
}

TEST_F(Load, UnknownExtension) {
  EXPECT_TRUE(contains(input_error("model.step", "ISO-10303-21;"), "'.step'"));
  EXPECT_TRUE(contains(input_error("model", "solid"), "no ending"));
}

TEST_F(Load, RandomBytesUnderEveryExtension) {
  std::mt19937 random(1);
  std::uniform_int_distribution<int> any_byte(0, 255), text_byte(32, 126);
  for (const char* name : {"noise.stl", "noise.obj", "noise.ply", "noise.off", "noise.3mf", "noise.glb",
                           "noise.gltf", "noise.3ds"}) {
    for (const std::size_t size :
         {std::size_t{1}, std::size_t{20}, std::size_t{84}, std::size_t{1000}, std::size_t{100000}}) {
      std::string bytes(size, '\0'), text(size, '\0');
      for (char& c : bytes) c = static_cast<char>(any_byte(random));
      for (char& c : text) c = static_cast<char>(text_byte(random));
      input_error(name, bytes);
      input_error(name, text);
      for (const std::string magic :
           {"solid ", "ply\nformat ascii 1.0\n", "OFF\n", "PK\x03\x04", "v 0 0 0\nf 1 1 2\n"}) {
        input_error(name, magic + bytes);
      }
    }
  }
}

// ---- real files

std::filesystem::path shared_model(const std::string& name) {
  return std::filesystem::path(AERATE_SHARED) / "models" / name;
}

TEST(LoadReal, ColouredOff) {
  const std::filesystem::path path = shared_model("dino.off");
  if (!std::filesystem::exists(path)) GTEST_SKIP() << path << " is not there";
  const LoadedModel model = load_model(path);
  EXPECT_EQ(model.mesh.triangles.size(), 7828u);
  EXPECT_EQ(model.mesh.positions.size(), 3916u);
  EXPECT_GT(signed_volume(model.mesh), 0.0);
}

TEST(LoadReal, LargeStlIsReadBitForBit) {
  const std::filesystem::path path = shared_model("dragon-871k.stl");
  if (!std::filesystem::exists(path)) GTEST_SKIP() << path << " is not there";
  const Mesh mesh = load_model(path).mesh;
  ASSERT_EQ(mesh.triangles.size(), 871414u);
  std::ifstream file(path, std::ios::binary);
  std::string bytes(std::filesystem::file_size(path), '\0');
  ASSERT_TRUE(file.read(bytes.data(), static_cast<std::streamsize>(bytes.size())));
  std::size_t different = 0;
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    std::array<Vec3f, 3> corners{};
    std::memcpy(corners.data(), bytes.data() + 84 + 50 * i + 12, sizeof(corners));
    for (std::size_t corner = 0; corner < 3; ++corner) {
      if (!(mesh.positions[mesh.triangles[i][corner]] == corners[corner])) ++different;
    }
  }
  EXPECT_EQ(different, 0u);
}

}  // namespace
}  // namespace aerate
