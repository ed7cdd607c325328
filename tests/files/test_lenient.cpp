#include <array>
#include <cstring>
#include <filesystem>
#include <gtest/gtest.h>
#include <regex>
#include <string>
#include <string_view>
#include <sys/stat.h>

#include "core/error.h"
#include "core/mesh.h"
#include "files/formats.h"
#include "files/input_file.h"
#include "files/load.h"
#include "tests/support/binary_stl.h"
#include "tests/support/caught.h"
#include "tests/support/same_corners.h"
#include "tests/support/shapes.h"
#include "tests/support/temporary_folder.h"

// What programs write that is not quite as a format has it: read whole where nothing has to be guessed, else
// refused with the place. Nothing that a file promises is lost.
namespace aerate::test {
namespace {

// A tetrahedron of volume 1/6 in each format.
constexpr std::string_view kStl =
    "solid t\nfacet normal 0 0 -1\nouter loop\nvertex 0 0 0\nvertex 0 1 0\nvertex 1 0 0\nendloop\nendfacet\n"
    "facet normal 0 -1 0\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 0 1\nendloop\nendfacet\n"
    "facet normal -1 0 0\nouter loop\nvertex 0 0 0\nvertex 0 0 1\nvertex 0 1 0\nendloop\nendfacet\n"
    "facet normal 1 1 1\nouter loop\nvertex 1 0 0\nvertex 0 1 0\nvertex 0 0 1\nendloop\nendfacet\n"
    "endsolid t\n";
constexpr std::string_view kObj = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n";
constexpr std::string_view kPly =
    "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
    "element face 4\nproperty list uchar int vertex_indices\nend_header\n"
    "0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n";
constexpr std::string_view kOff =
    "OFF\n4 4 6\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n";

struct Seed {
  const MeshFormat& format;
  std::string_view text;
};
constexpr std::array kSeeds{Seed{MeshFormat::stl, kStl}, Seed{MeshFormat::obj, kObj},
                            Seed{MeshFormat::ply, kPly}, Seed{MeshFormat::off, kOff}};

std::string replaced(std::string_view text, const std::string& pattern, const std::string& with) {
  std::string result = std::regex_replace(std::string(text), std::regex(pattern), with);
  EXPECT_NE(result, text) << pattern;
  return result;
}

LoadedModel load(const MeshFormat& format, std::string_view bytes) {
  return load_model(file_in_memory("model", bytes), format);
}

void expect_tetrahedron(const MeshFormat& format, std::string_view bytes) {
  SCOPED_TRACE(bytes);
  const LoadedModel model = load(format, bytes);
  EXPECT_EQ(model.mesh.triangles.size(), 4u);
  EXPECT_EQ(model.mesh.positions.size(), 4u);
  EXPECT_NEAR(signed_volume(model.mesh), 1.0 / 6.0, 1e-7);
}

std::string refusal(const MeshFormat& format, std::string_view bytes) {
  return message_of<InputError>([&] { load(format, bytes); });
}

TEST(Lenient, SeedsAreReadAndSoAreTheyAfterTheMarkOfUtf8) {
  for (const Seed& seed : kSeeds) {
    expect_tetrahedron(seed.format, seed.text);
    expect_tetrahedron(seed.format, "\xef\xbb\xbf" + std::string(seed.text));
  }
}

TEST(Lenient, NumbersAreReadWholeOrRefusedWithTheirLine) {
  for (const Seed& seed : kSeeds) {
    const std::size_t at = seed.text.find("0 1 0");
    const auto line =
        1 + std::count(seed.text.begin(), seed.text.begin() + static_cast<std::ptrdiff_t>(at), '\n');
    for (const std::string number : {"20,5", "20mm", "1.#qnan", "-nan(ind)", "0x10", "1e", "--1", ".",
                                     "1.2.3", "100000000000000000000", "1e99999"}) {
      std::string text(seed.text);
      text.replace(at + 2, 1, number);
      const std::string message = refusal(seed.format, text);
      EXPECT_TRUE(contains(message, number.substr(0, 20) + "' is no number"));
      EXPECT_TRUE(contains(message, "line " + std::to_string(line) + ":"));
    }
    for (const std::string number : {"1.", "+1", "1.0e0", "1E+00", "10.e-1", "01"})
      expect_tetrahedron(seed.format, replaced(seed.text, "0 1 0", "0 " + number + " 0"));
    const LoadedModel half = load(seed.format, replaced(seed.text, "0 1 0", "0 .5 0"));
    EXPECT_NEAR(signed_volume(half.mesh), 1.0 / 12.0, 1e-7) << seed.format.name;
  }
}

TEST(Lenient, MessagesAreShortHoweverLongTheWords) {
  const std::string word(1'000'000, 'x');
  for (const Seed& seed : kSeeds) {
    for (const char* place : {"0 1 0", "3 0 2 1", "1 3 2", "endloop", "end_header", "OFF", "outer"}) {
      std::string text(seed.text);
      const std::size_t at = text.find(place);
      if (at == std::string::npos) continue;
      EXPECT_LT(refusal(seed.format, text.replace(at, 1, word)).size(), 400u) << seed.format.name << place;
    }
  }
}

// ---- STL

TEST(Lenient, NormalsOfTextStlMayBeAnything) {
  for (const std::string number : {"nan", "-nan(ind)", "1.#QNAN", "-1.#IND000e+000", "inf", "0,5", "-"})
    expect_tetrahedron(MeshFormat::stl, replaced(kStl, "normal 0 0 -1", "normal " + number + " 0 " + number));
  EXPECT_TRUE(contains(refusal(MeshFormat::stl, replaced(kStl, "normal 0 0 -1", "normal 0 0")), "line 3"));
}

TEST(Lenient, TextStlAsProgramsWriteIt) {
  const std::string text(kStl);
  expect_tetrahedron(MeshFormat::stl, "\n\r\n  " + text);
  expect_tetrahedron(MeshFormat::stl, text + "\n; exported by something\n");
  expect_tetrahedron(MeshFormat::stl, text + std::string(100, '\0'));
  expect_tetrahedron(MeshFormat::stl, text + text.substr(text.find("endsolid")));
  expect_tetrahedron(MeshFormat::stl, replaced(text, "endloop", "end loop"));
  expect_tetrahedron(MeshFormat::stl, replaced(text, "end(facet|solid)", "end $1"));
  for (const std::string comment : {"# a facet", "; vertex 1 2 3", "// solid"})
    expect_tetrahedron(MeshFormat::stl, replaced(text, "outer", comment + "\nouter"));
}

TEST(Lenient, TextStlWithoutItsEndIsReadWithANotice) {
  const std::string text(kStl, 0, kStl.find("endsolid"));
  expect_tetrahedron(MeshFormat::stl, text);
  EXPECT_EQ(load(MeshFormat::stl, text).notices.size(), 1u);
  EXPECT_TRUE(load(MeshFormat::stl, kStl).notices.empty());
  const LoadedModel two = load(MeshFormat::stl, text + std::string(kStl));
  EXPECT_EQ(two.part_count, 2u);
  EXPECT_EQ(two.mesh.triangles.size(), 8u);
}

TEST(Lenient, TextStlOnOneLineSaysThatAllOfItIsAName) {
  EXPECT_TRUE(
      contains(refusal(MeshFormat::stl, replaced(kStl, "\n", " ")), "line 1: no triangle follows 'solid'"));
}

// ---- OBJ

TEST(Lenient, NoPartOfAnObjIsLostForWhatIsNoSurface) {
  std::string two(kObj);
  two += "o B\nv 5 0 0\nv 6 0 0\nv 5 1 0\nv 5 0 1\n";
  for (const std::string corner : {"$1/$1/$1", "$1/$1", "$1//$1", "$1/0/0", "$1/7/1"}) {
    for (const std::string others : {"", "vt 0 0\n", "vn 0 0 1\n", "vt 0 0\nvn 0 0 1\n"}) {
      std::string faces = "f 5 7 6\nf 5 6 8\nf 5 8 7\nf 6 7 8\n";
      faces = std::regex_replace(faces, std::regex("([0-9])"), corner);
      const LoadedModel model = load(MeshFormat::obj, "o A\n" + others + two + faces);
      EXPECT_EQ(model.mesh.triangles.size(), 8u) << corner << others;
      EXPECT_EQ(model.part_count, 2u);
      EXPECT_NEAR(signed_volume(model.mesh), 2.0 / 6.0, 1e-6);
    }
  }
}

TEST(Lenient, ObjAsProgramsWriteIt) {
  for (const std::string more : {" 1 0 0", " 1 0 0 0.5", " 1", " # here", "#here", "  \r", " \\\n"})
    expect_tetrahedron(MeshFormat::obj, replaced(kObj, "(v [^\n]*)", "$1" + more));
  for (const std::string more : {" # here", "#here", "  \r", " \\\n"})
    expect_tetrahedron(MeshFormat::obj, replaced(kObj, "(f [^\n]*)", "$1" + more));
  expect_tetrahedron(MeshFormat::obj, replaced(kObj, "(f . .)", "$1 \\\n"));
  expect_tetrahedron(MeshFormat::obj, replaced(kObj, "\n", "\n  "));
  expect_tetrahedron(MeshFormat::obj, "# C:\\models\\\n" + std::string(kObj));
  expect_tetrahedron(MeshFormat::obj, replaced(kObj, "f 1 3 2", "f 01 003 2"));
  EXPECT_TRUE(contains(refusal(MeshFormat::obj, replaced(kObj, "v 0 1 0", "v 0 1 0 1 2")), "a vertex of 5"));
}

TEST(Lenient, FilesOfMaterialsAreNeverOpened) {
  const TemporaryFolder folder;
  // Whoever opens it waits for ever.
  const std::filesystem::path pipe = folder.path() / "pipe.mtl";
  ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
  for (const std::string& name : {pipe.string(), std::string("pipe.mtl")}) {
    const auto path = folder.write("m.obj", "mtllib " + name + "\nusemtl x\n" + std::string(kObj));
    EXPECT_EQ(load_model(path).mesh.triangles.size(), 4u);
  }
}

TEST(Lenient, PipesAndDevicesAreNoModels) {
  const TemporaryFolder folder;
  for (const MeshFormat* format : kMeshFormats) {
    const std::filesystem::path pipe = folder.path() / (std::string("pipe") + format->ending);
    ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
    const std::filesystem::path device = folder.path() / (std::string("device") + format->ending);
    std::filesystem::create_symlink("/dev/zero", device);
    for (const auto& path : {pipe, device}) {
      EXPECT_TRUE(contains(message_of<InputError>([&] { load_model(path); }), "not a regular file"));
    }
  }
}

// ---- PLY

// The tetrahedron, binary, with another first byte.
std::string binary_ply(char first_byte, const std::string& line_end) {
  std::string bytes = replaced(kPly, "ascii", "binary_little_endian");
  bytes = std::regex_replace(bytes.substr(0, bytes.find("0 0 0")), std::regex("\n"), line_end);
  const std::array<float, 12> coordinates{0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1};
  const std::size_t data = bytes.size();
  bytes.append(reinterpret_cast<const char*>(coordinates.data()), sizeof(coordinates));
  bytes[data] = first_byte;
  for (const Triangle& t : {Triangle{0, 2, 1}, Triangle{0, 1, 3}, Triangle{0, 3, 2}, Triangle{1, 2, 3}}) {
    bytes += '\3';
    bytes.append(reinterpret_cast<const char*>(t.data()), sizeof(t));
  }
  return bytes;
}

TEST(Lenient, DataOfBinaryPlyMayBeginWithAnyByte) {
  for (int byte = 0; byte < 256; ++byte) {
    for (const std::string line_end : {"\n", "\r\n"})
      expect_tetrahedron(MeshFormat::ply, binary_ply(static_cast<char>(byte), line_end));
  }
}

TEST(Lenient, TextPlyMayHaveBlankLines) {
  expect_tetrahedron(MeshFormat::ply, replaced(kPly, "end_header", "end_header\n"));
  expect_tetrahedron(MeshFormat::ply, replaced(kPly, "\n3 ", "\n \r\n3 "));
}

TEST(Lenient, ElementsOfPlyThatAreNoSurfaceAreLeftOut) {
  const std::string header =
      replaced(kPly, "element face", "element light 2\nproperty float q\nelement face");
  expect_tetrahedron(MeshFormat::ply, replaced(header, "\n3 0 2 1", "\n0.5\nnan\n3 0 2 1"));
}

TEST(Lenient, TriangleStripsOfPlyAreTriangles) {
  const std::string header =
      replaced(kPly.substr(0, kPly.find("3 0 2 1")), "element face 4", "element tristrips 1");
  // A tetrahedron is one strip of four triangles; -1 begins another strip, a repeated vertex turns it.
  for (const std::string strip :
       {"6 0 2 1 3 0 2", "9 0 2 1 -1 2 3 1 0 -1", "9 0 2 1 3 -1 1 3 0 2", "7 0 2 1 3 0 0 2"}) {
    SCOPED_TRACE(strip);
    const LoadedModel model = load(MeshFormat::ply, header + strip + "\n");
    if (strip.front() == '6') expect_tetrahedron(MeshFormat::ply, header + strip + "\n");
    for (const Triangle& t : model.mesh.triangles) {
      EXPECT_NE(t[0], t[1]);
      EXPECT_NE(t[1], t[2]);
    }
  }
  EXPECT_EQ(load(MeshFormat::ply, header + "7 0 2 1 -1 1 2 3\n").mesh.triangles.size(), 2u);
  EXPECT_TRUE(contains(refusal(MeshFormat::ply, header + "3 0 2 4\n"), "vertex 4 is out of range"));
}

// ---- OFF

TEST(Lenient, NumbersOfOffMayBeSpreadOverLines) {
  expect_tetrahedron(MeshFormat::off, replaced(kOff, "\n3 (.) (.) ", "\n3\n$1 # a corner\n\n$2\n"));
  expect_tetrahedron(MeshFormat::off, replaced(kOff, "0 1 0\n", "0\n1\n0\n"));
  expect_tetrahedron(MeshFormat::off, replaced(kOff, "4 4 6", "4\n4\n6"));
  expect_tetrahedron(MeshFormat::off, replaced(kOff, "4 4 6", "4 4"));
}

TEST(Lenient, OffSaysWhatItsVerticesHave) {
  const std::string more = replaced(kOff, "(\n[01] . .)(?=\n)", "$1 0.5 0.25 1 1");
  for (const std::string keyword : {"OFF", "COFF", "NOFF", "CNOFF", "STOFF", "STCNOFF"})
    expect_tetrahedron(MeshFormat::off, std::regex_replace(more, std::regex("OFF"), keyword));
  expect_tetrahedron(MeshFormat::off, replaced(replaced(kOff, "(\n[01] . .)(?=\n)", "$1 1"), "OFF", "4OFF"));
  EXPECT_TRUE(contains(refusal(MeshFormat::off, replaced(kOff, "OFF", "nOFF")), "dimensions"));
}

TEST(Lenient, OffWithoutItsKeywordIsRefusedAtOnce) {
  for (const std::string keyword : {"OFF500000000", "OFF88888888888888", "XOFF", "off"})
    EXPECT_TRUE(contains(refusal(MeshFormat::off, replaced(kOff, "OFF", keyword)), "no OFF file")) << keyword;
}

// A header that promises less than there is leaves the rest out, and that is said.
TEST(Lenient, WhatFollowsBeyondAHeadersPromiseIsSaid) {
  const LoadedModel of_off = load(MeshFormat::off, replaced(kOff, "4 4 6", "4 2 6"));
  EXPECT_EQ(of_off.mesh.triangles.size(), 2u);
  ASSERT_EQ(of_off.notices.size(), 1u);
  EXPECT_TRUE(contains(of_off.notices[0], "line 9"));
  EXPECT_TRUE(load(MeshFormat::ply, std::string(kPly) + "\n").notices.empty());
  EXPECT_EQ(load(MeshFormat::ply, replaced(kPly, "face 4", "face 3")).notices.size(), 1u);
}

TEST(Lenient, BytesAfterTheTrianglesOfABinaryStlAreSaid) {
  const Mesh box = make_box({0, 0, 0}, {1, 2, 3});
  const LoadedModel model = load(MeshFormat::stl, to_binary_stl(box) + "a comment");
  expect_same_corners(model.mesh, box);
  ASSERT_EQ(model.notices.size(), 1u);
  EXPECT_TRUE(contains(model.notices[0], "9 bytes follow"));
}

// The fourth number of a vertex is a curve's weight.
TEST(Lenient, WeightsOfObjVerticesDoNotMoveThem) {
  const LoadedModel model = load(MeshFormat::obj, "v 2 0 0 2\nv 0 2 0 0.5\nv 0 0 2 1\nf 1 2 3\n");
  ASSERT_EQ(model.mesh.positions.size(), 3u);
  EXPECT_EQ(model.mesh.positions[0], (Vec3f{2, 0, 0}));
  EXPECT_EQ(model.mesh.positions[1], (Vec3f{0, 2, 0}));
}

}  // namespace
}  // namespace aerate::test
