#include <filesystem>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "core/mesh.h"
#include "mesh/load.h"
#include "printing/write.h"
#include "tests/slicer/slicing.h"
#include "tests/support/caught.h"
#include "tests/support/shapes.h"
#include "tests/support/temporary_folder.h"

// What PrusaSlicer makes of a 3MF with modifiers: less filament at any infill, where voids cost walls.
namespace aerate::test {
namespace {

class Modifiers : public testing::Test {
 protected:
  void SetUp() override {
    if (!is_installed("prusa-slicer")) GTEST_SKIP() << "prusa-slicer is not installed: nothing was sliced";
  }

  std::filesystem::path hollow(const std::filesystem::path& model,
                               const std::vector<std::string>& options) const {
    const auto output = folder_.path() / "hollow.3mf";
    std::vector<std::string> command{
        AERATE_EXECUTABLE, "hollow", model,          "-o", output,         "--wall", "1.2",
        "--gap",           "0.9",    "--max-radius", "10", "--min-radius", "1.5"};
    command.insert(command.end(), options.begin(), options.end());
    const ProcessResult result = run(command);
    EXPECT_EQ(result.exit_code, 0) << result.err;
    return output;
  }

  double filament(const std::filesystem::path& model, const std::string& infill,
                  const std::string& pattern = "gyroid") const {
    return slice_with_prusa(model, folder_.path() / "out.gcode",
                            {"--fill-density", infill, "--fill-pattern", pattern, "--layer-height", "0.3",
                             "--skirts", "0"})
        .filament_mm.value_or(0);
  }

  // Measured shares of a model's filament that modifiers save.
  void expect_less(const std::string& name, const std::filesystem::path& model) const {
    const auto modified = hollow(model, {"--as", "modifiers"});
    for (const char* infill : {"15%", "50%"}) {
      const double solid = filament(model, infill), with_modifiers = filament(modified, infill);
      std::printf("%s, %s gyroid: filament %.1f -> %.1f mm (%+.2f %%)\n", name.c_str(), infill, solid,
                  with_modifiers, 100 * (with_modifiers / solid - 1));
      EXPECT_GT(solid, 0);
      EXPECT_LT(with_modifiers, solid) << name << " at " << infill;
    }
  }

  std::filesystem::path model(const std::string& name, const Mesh& mesh) const {
    const auto path = folder_.path() / name;
    write_mesh(mesh, path, MeshFormat::stl);
    return path;
  }
  std::filesystem::path sample(const std::string& name, float scale) const {
    Mesh mesh = load_model(std::filesystem::path(AERATE_SAMPLES) / name).mesh;
    for (Vec3f& p : mesh.positions) p = {p.x * scale, p.y * scale, p.z * scale};
    return model("sample.stl", mesh);
  }

  TemporaryFolder folder_;
};

TEST_F(Modifiers, BlockTakesLess) {
  expect_less("block", model("block.stl", make_box({0, 0, 0}, {24, 24, 24})));
}

TEST_F(Modifiers, TorusTakesLess) {
  expect_less("torus", model("torus.stl", make_torus(16, 7, 48, 32)));
}

TEST_F(Modifiers, PawnTakesLess) {
  expect_less("pawn", sample("pawn.obj", 0.8F));
}

TEST_F(Modifiers, BunnyTakesLess) {
  expect_less("bunny", sample("bunny.stl", 0.5F));
}

TEST_F(Modifiers, InfillInsideIsTheOneAskedFor) {
  const auto block = model("block.stl", make_box({0, 0, 0}, {24, 24, 24}));
  const double none = filament(hollow(block, {"--as", "modifiers"}), "50%");
  const double dense = filament(hollow(block, {"--as", "modifiers", "--modifier-infill", "80"}), "50%");
  const double same = filament(hollow(block, {"--as", "modifiers", "--modifier-infill", "50"}), "50%");
  EXPECT_LT(none, same);
  EXPECT_GT(dense, same);
  EXPECT_NEAR(same, filament(block, "50%"), 0.001 * same);
}

TEST_F(Modifiers, VoidsInA3mfAreThoseOfAnStl) {
  const auto block = model("block.stl", make_box({0, 0, 0}, {24, 24, 24}));
  const double solid = filament(block, "100%", "rectilinear");
  const auto as_3mf = hollow(block, {"--as", "voids"});
  const double voids_3mf = filament(as_3mf, "100%", "rectilinear");
  const auto as_stl = folder_.path() / "same.stl";
  write_mesh(load_model(as_3mf).mesh, as_stl, MeshFormat::stl);
  EXPECT_LT(voids_3mf, 0.8 * solid);
  EXPECT_NEAR(filament(as_stl, "100%", "rectilinear"), voids_3mf, 0.001 * solid);
}

}  // namespace
}  // namespace aerate::test
