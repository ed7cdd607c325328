#include <filesystem>
#include <gtest/gtest.h>
#include <string>

#include "core/error.h"
#include "pipeline/model_of_print.h"
#include "tests/support/binary_stl.h"
#include "tests/support/caught.h"
#include "tests/support/shapes.h"
#include "tests/support/temporary_folder.h"

namespace aerate {
namespace {

using test::contains;

struct Quiet final : Monitor {};

class ModelOfPrint : public testing::Test {
 protected:
  void add(const std::string& name, float height) const {
    static_cast<void>(folder_.write(name, test::to_binary_stl(test::make_box({0, 0, 0}, {20, 20, height}))));
  }
  std::string found(const PrintNames& names, Vec3d size = {24, 24, 20}) {
    return model_of_print(folder_.path(), names, size, {}, monitor_).filename().string();
  }
  std::string refusal(const PrintNames& names, Vec3d size = {24, 24, 20}) {
    return test::message_of<InputError>([&] { static_cast<void>(found(names, size)); });
  }

  test::TemporaryFolder folder_;
  Quiet monitor_;
};

TEST_F(ModelOfPrint, IsCalledAsTheObject) {
  add("a.stl", 20);
  add("b.stl", 20);
  EXPECT_EQ(found({"b.stl", "a_0.2mm.gcode"}), "b.stl");
  EXPECT_EQ(found({"b", ""}), "b.stl");
  EXPECT_EQ(found({std::nullopt, "a_0.2mm.gcode"}), "a.stl");
  EXPECT_EQ(found({"renamed", "/out/b_0.2mm.gcode"}), "b.stl");
  EXPECT_TRUE(contains(refusal({"renamed", "c.gcode"}), "no model is called as the print is ('renamed')"));
  EXPECT_TRUE(contains(refusal({std::nullopt, ""}), "which has no name"));
}

TEST_F(ModelOfPrint, HasTheLongestName) {
  add("part.stl", 20);
  add("part_lid.stl", 20);
  EXPECT_EQ(found({std::nullopt, "part_lid_0.2mm.gcode"}), "part_lid.stl");
  EXPECT_EQ(found({std::nullopt, "part_0.2mm.gcode"}), "part.stl");
}

TEST_F(ModelOfPrint, OfSeveralHasTheSizeOfThePrint) {
  add("part.stl", 20);
  add("part.STL", 35);
  EXPECT_EQ(found({std::nullopt, "part.gcode"}), "part.stl");
  EXPECT_EQ(found({std::nullopt, "part.gcode"}, {20, 20, 35}), "part.STL");
  EXPECT_TRUE(contains(refusal({std::nullopt, "part.gcode"}, {20, 20, 50}), "none of them have its size"));
  EXPECT_TRUE(contains(refusal({std::nullopt, "part.gcode"}, {10, 20, 20}), "none of them have its size"));
  add("part.Stl", 20.5F);
  EXPECT_TRUE(contains(refusal({std::nullopt, "part.gcode"}), "2 of them have its size"));
}

TEST(SizeOfPrint, IsThatOfAllExtrusions) {
  const Vec3d size =
      size_of_print("M83\nG1 X5 Y6 Z0.2\nG1 X15 Y6 E1\nG1 X200 Y200\nG1 Z3\nG1 X15 Y36\nG1 X12 Y36 E1\n");
  EXPECT_EQ(size.x, 10);
  EXPECT_EQ(size.y, 30);
  EXPECT_EQ(size.z, 3);
  EXPECT_EQ(size_of_print("G28\n").x, 0);
}

}  // namespace
}  // namespace aerate
