#include <algorithm>
#include <cmath>
#include <filesystem>
#include <gtest/gtest.h>
#include <random>
#include <string>
#include <vector>

#include "core/error.h"
#include "files/load.h"
#include "files/three_mf.h"
#include "files/write.h"
#include "tests/support/caught.h"
#include "tests/support/shapes.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/zip.h"

namespace aerate::test {
namespace {

class ThreeMf : public testing::Test {
 protected:
  std::filesystem::path file(const std::string& bytes) const { return folder_.write("model.3mf", bytes); }
  TemporaryFolder folder_;
};

// Triangle by triangle, corner by corner.
void expect_same_corners(const Mesh& read, const Mesh& written) {
  ASSERT_EQ(read.triangles.size(), written.triangles.size());
  for (std::size_t i = 0; i < read.triangles.size(); ++i) {
    for (std::size_t corner = 0; corner < 3; ++corner) {
      const Vec3f a = read.positions[read.triangles[i][corner]];
      const Vec3f b = written.positions[written.triangles[i][corner]];
      ASSERT_TRUE(a == b) << "triangle " << i;
    }
  }
}

// A box with one void: the void's shell is inward, as in every solid.
Solid box_with_a_void() {
  const Mesh outer = make_box({0, 0, 0}, {20, 20, 20});
  const Mesh shell = turned_inside_out(make_box({8, 8, 8}, {12, 12, 12}));
  Solid solid;
  solid.mesh = join(outer, shell);
  solid.parts = {{PartKind::outer, 0, outer.triangles.size()}};
  solid.close_part(PartKind::void_surface);
  return solid;
}

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
  // The format forbids them, and lib3mf drops such a triangle.
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

TEST_F(ThreeMf, BytesDependOnTheMeshAlone) {
  const Solid solid = box_with_a_void();
  for (const ThreeMfFlavor flavor : {ThreeMfFlavor::prusa, ThreeMfFlavor::orca}) {
    const std::string once = to_3mf(solid.mesh, modifier_parts(solid, 0), flavor);
    setenv("TZ", "Asia/Tokyo", 1);
    tzset();
    const std::string again = to_3mf(solid.mesh, modifier_parts(solid, 0), flavor);
    unsetenv("TZ");
    tzset();
    EXPECT_EQ(once, again);
  }
}

TEST_F(ThreeMf, NamesTheModelAndItsModifiersForBothFlavors) {
  const Solid solid = box_with_a_void();
  const Mesh bodies = with_void_shells_turned(solid.mesh, solid);
  for (const ThreeMfFlavor flavor : {ThreeMfFlavor::prusa, ThreeMfFlavor::orca}) {
    const auto parts = modifier_parts(solid, 12.5);
    const auto path = file(to_3mf(bodies, parts, flavor));
    EXPECT_EQ(read_3mf_parts(path, flavor), parts) << name_of(flavor);
    expect_same_corners(load_model(path, {.unit = {}, .other_volumes = OtherVolumes::take_as_bodies}).mesh,
                        bodies);
    // As a model it would print the voids.
    EXPECT_TRUE(contains(message_of<InputError>([&] { load_model(path); }), "not part of the model"));
  }
}

TEST_F(ThreeMf, ModifiersAreBodiesOfTheirOwn) {
  const Solid solid = box_with_a_void();
  const Mesh bodies = with_void_shells_turned(solid.mesh, solid);
  EXPECT_DOUBLE_EQ(signed_volume(solid.mesh), 8000 - 64);
  EXPECT_DOUBLE_EQ(signed_volume(bodies), 8000 + 64);
  EXPECT_EQ(with_void_shells_turned(bodies, solid).triangles, solid.mesh.triangles);
}

TEST_F(ThreeMf, NoticesPartsThatAreNotThoseMeant) {
  const Solid solid = box_with_a_void();
  auto parts = modifier_parts(solid, 0);
  parts[1].first_triangle += 1;
  parts[1].triangle_count -= 1;
  const auto path = file(to_3mf(solid.mesh, parts, ThreeMfFlavor::prusa));
  EXPECT_NE(read_3mf_parts(path, ThreeMfFlavor::prusa), modifier_parts(solid, 0));
  EXPECT_NE(modifier_parts(solid, 0), modifier_parts(solid, 10));
}

TEST_F(ThreeMf, RefusesPackagesThatAreNotItsOwn) {
  EXPECT_TRUE(
      contains(message_of<FailureError>([&] { read_3mf_parts(file("no archive"), ThreeMfFlavor::prusa); }),
               "not a zip archive"));
  const auto plain = file(to_3mf(make_box({0, 0, 0}, {1, 1, 1})));
  EXPECT_TRUE(contains(message_of<FailureError>([&] { read_3mf_parts(plain, ThreeMfFlavor::prusa); }),
                       "Slic3r_PE_model.config is missing"));
  const auto garbled = file(make_zip({{"Metadata/Slic3r_PE_model.config", "<config><object>"}}));
  EXPECT_TRUE(contains(message_of<FailureError>([&] { read_3mf_parts(garbled, ThreeMfFlavor::prusa); }),
                       "Slic3r_PE_model.config: "));
}

}  // namespace
}  // namespace aerate::test
