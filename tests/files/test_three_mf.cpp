#include <algorithm>
#include <cmath>
#include <filesystem>
#include <gtest/gtest.h>
#include <random>
#include <string>
#include <vector>

#include "core/error.h"
#include "files/formats.h"
#include "files/load.h"
#include "files/three_mf.h"
#include "tests/support/caught.h"
#include "tests/support/same_corners.h"
#include "tests/support/shapes.h"
#include "tests/support/temporary_folder.h"

namespace aerate::test {
namespace {

class ThreeMf : public testing::Test {
 protected:
  std::filesystem::path file(const std::string& bytes) const { return folder_.write("model.3mf", bytes); }
  TemporaryFolder folder_;
};

// Triangle by triangle, corner by corner.
TEST_F(ThreeMf, KeepsTheBitsOfCoordinatesOfAnySize) {
  std::mt19937 random(7);
  std::uniform_real_distribution<float> mantissa(-1, 1);
  std::uniform_int_distribution<int> exponent(-20, 14);
  Mesh mesh;
  for (std::uint32_t i = 0; i < 3000; ++i) {
    const auto coordinate = [&] { return std::ldexp(mantissa(random), exponent(random)); };
    mesh.positions.push_back({coordinate(), coordinate(), coordinate()});
    if (i % 3 == 2) mesh.triangles.push_back({i - 2, i - 1, i});
  }
  const LoadedModel read = load_model(file(to_3mf(mesh)));
  EXPECT_EQ(read.format, "3MF");
  EXPECT_EQ(read.part_count, 1u);
  expect_same_corners(read.mesh, mesh);
}

TEST_F(ThreeMf, KeepsTrianglesThatNameAVertexTwice) {
  // The format forbids them; slicers read them, and so does this reader.
  Mesh mesh = make_box({0, 0, 0}, {1, 2, 3});
  mesh.triangles.insert(mesh.triangles.begin() + 3, Triangle{4, 4, 5});
  mesh.triangles.push_back({2, 6, 2});
  expect_same_corners(load_model(file(to_3mf(mesh))).mesh, mesh);
}

TEST_F(ThreeMf, SaysThatItsUnitIsTheMillimetre) {
  const auto path = file(to_3mf(make_box({0, 0, 0}, {1, 2, 3})));
  LoadOptions inches;
  inches.unit = LengthUnit::inch;
  EXPECT_TRUE(contains(message_of<UsageError>([&] { load_model(path, inches); }), "millimeter"));
}

TEST_F(ThreeMf, ComponentsAreTheMeshInOrder) {
  const Mesh boxes = join(make_box({0, 0, 0}, {20, 20, 20}), make_box({8, 8, 8}, {12, 12, 12}));
  ThreeMfExtras extras;
  extras.component_triangles = {12, 12};
  const LoadedModel read = load_model(file(to_3mf(boxes, extras)));
  EXPECT_EQ(read.part_count, 2u);
  expect_same_corners(read.mesh, boxes);
}

TEST_F(ThreeMf, BytesDependOnWhatIsWrittenAlone) {
  const Mesh mesh = make_box({0, 0, 0}, {1, 2, 3});
  const std::string once = to_3mf(mesh, {.application = "a program", .entries = {{"Metadata/a", "b"}}});
  setenv("TZ", "Asia/Tokyo", 1);
  tzset();
  const std::string again = to_3mf(mesh, {.application = "a program", .entries = {{"Metadata/a", "b"}}});
  unsetenv("TZ");
  tzset();
  EXPECT_EQ(once, again);
}

TEST_F(ThreeMf, GivesEntriesBack) {
  const auto path = file(
      to_3mf(make_box({0, 0, 0}, {1, 2, 3}), {.application = "a program", .entries = {{"Metadata/a", "b"}}}));
  EXPECT_EQ(read_3mf_entry(path, "Metadata/a"), "b");
  EXPECT_TRUE(contains(read_3mf_entry(path, kThreeMfModel), "<metadata name=\"Application\">a program<"));
  EXPECT_TRUE(contains(message_of<FailureError>([&] { read_3mf_entry(path, "Metadata/c"); }),
                       "model.3mf: is not the 3MF package that was written: Metadata/c is missing"));
  EXPECT_TRUE(contains(message_of<FailureError>([&] { read_3mf_entry(file("no archive"), "a"); }),
                       "not a zip archive"));
}

}  // namespace
}  // namespace aerate::test
