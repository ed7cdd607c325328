#include <array>
#include <cstdint>
#include <gtest/gtest.h>
#include <limits>
#include <string>
#include <vector>

#include "core/error.h"
#include "files/formats.h"
#include "files/load.h"
#include "tests/support/caught.h"
#include "tests/support/shapes.h"
#include "tests/support/temporary_folder.h"

namespace aerate {
namespace {

using test::contains;
using test::message_of;

struct OwnedArrays {
  std::vector<double> vertices;
  std::vector<std::int64_t> triangles;

  MeshArrays view() const { return {vertices, triangles}; }
};

OwnedArrays arrays_of(const Mesh& mesh) {
  OwnedArrays arrays;
  for (const Vec3f& p : mesh.positions)
    for (const float coordinate : {p.x, p.y, p.z}) arrays.vertices.push_back(coordinate);
  for (const Triangle& t : mesh.triangles)
    arrays.triangles.insert(arrays.triangles.end(), t.begin(), t.end());
  return arrays;
}

std::string refusal(const OwnedArrays& arrays, const LoadOptions& options = {}) {
  return message_of<InputError>([&] { static_cast<void>(load_model(arrays.view(), "plinth", options)); });
}

TEST(MeshArrays, AreReadAsAFileThatHoldsThem) {
  const test::TemporaryFolder folder;
  const Mesh box = test::make_box({-0.1f, 1.0f / 3.0f, -7.7f}, {2.3f, 4.1f, 1e-7f});
  const Mesh twice = test::join(box, test::moved(box, {4, 0, 0}));
  const OwnedArrays arrays = arrays_of(twice);
  const auto file = folder.path() / "model.stl";
  write_mesh(twice, file, MeshFormat::stl);
  const LoadOptions inches{.unit = LengthUnit::inch, .scale = {1, 1.02, 3}};
  for (const LoadOptions& options : std::array{LoadOptions{}, inches}) {
    const LoadedModel read = load_model(file, options);
    const LoadedModel model = load_model(arrays.view(), "plinth", options);
    EXPECT_EQ(model.mesh.positions, read.mesh.positions);
    EXPECT_EQ(model.mesh.triangles, read.mesh.triangles);
    EXPECT_EQ(model.format, "arrays");
    EXPECT_EQ(model.part_count, 1U);
    EXPECT_TRUE(model.notices.empty());
  }
}

TEST(MeshArrays, AreRoundedOnceAfterTheyWereConverted) {
  // 0.1 of an inch is 2.54 mm; 0.1 rounded to single precision first would give 2.5400002.
  const OwnedArrays arrays{{0.1, 0, 0, 1, 0, 0, 0, 1, 0}, {0, 1, 2}};
  EXPECT_EQ(load_model(arrays.view(), "a", {.unit = LengthUnit::inch}).mesh.positions[0].x, 2.54f);
}

TEST(MeshArrays, WithPlacesThatAreNoneAreRefusedByTheirRow) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  for (const double bad : {kNan, std::numeric_limits<double>::infinity(), 1e39, -1e300}) {
    OwnedArrays arrays = arrays_of(test::make_box({0, 0, 0}, {1, 1, 1}));
    arrays.vertices[3 * 5 + 1] = bad;
    EXPECT_TRUE(contains(refusal(arrays), "plinth: vertices[5] is ("));
  }
  OwnedArrays large = arrays_of(test::make_box({0, 0, 0}, {1, 1, 1}));
  large.vertices[0] = 3e38;
  EXPECT_TRUE(contains(refusal(large, {.unit = {}, .scale = {2, 2, 2}}), "vertices[0]"));
}

TEST(MeshArrays, WithRowsThatAreNotThereAreRefused) {
  for (const std::int64_t bad :
       {std::int64_t{8}, std::int64_t{-1}, std::numeric_limits<std::int64_t>::min(), std::int64_t{1} << 32}) {
    OwnedArrays arrays = arrays_of(test::make_box({0, 0, 0}, {1, 1, 1}));
    arrays.triangles[3 * 11 + 2] = bad;
    const std::string message = refusal(arrays);
    EXPECT_TRUE(contains(message, "plinth: triangles[11] is ("));
    EXPECT_TRUE(contains(message, "there are 8 vertices"));
  }
}

TEST(MeshArrays, WithoutTrianglesAreRefused) {
  EXPECT_TRUE(contains(refusal({}), "plinth: no triangles"));
  EXPECT_TRUE(contains(refusal({{0, 0, 0}, {}}), "plinth: no triangles"));
  EXPECT_THROW(load_model(arrays_of(test::make_box({0, 0, 0}, {1, 1, 1})).view(), "a",
                          {.unit = {}, .scale = {1, 0, 1}}),
               UsageError);
}

}  // namespace
}  // namespace aerate
