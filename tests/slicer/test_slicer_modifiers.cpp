#include <algorithm>
#include <cmath>
#include <filesystem>
#include <gtest/gtest.h>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "core/mesh.h"
#include "files/formats.h"
#include "files/load.h"
#include "tests/slicer/slicing.h"
#include "tests/support/caught.h"
#include "tests/support/shapes.h"
#include "tests/support/temporary_folder.h"

// What PrusaSlicer makes of a 3MF with modifiers: less filament than solid, where voids cost walls.
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

// How far from the axis the nearest extrusion is, by height in hundredths of a millimetre.
std::map<long, double> empty_radii(const std::vector<ExtrusionMove>& moves, double x, double y) {
  std::map<long, double> radii;
  for (const ExtrusionMove& move : moves) {
    const double dx = move.x - move.from_x, dy = move.y - move.from_y;
    const double along =
        ((x - move.from_x) * dx + (y - move.from_y) * dy) / std::max(dx * dx + dy * dy, 1e-12);
    const double t = std::clamp(along, 0.0, 1.0);
    const double distance = std::hypot(move.from_x + t * dx - x, move.from_y + t * dy - y);
    const auto [at, is_new] = radii.try_emplace(std::lround(100 * move.z), distance);
    if (!is_new) at->second = std::min(at->second, distance);
  }
  return radii;
}

// The height over which the empty space in a print narrows from 6.5 to 3.2 mm round the axis, mm.
double height_of_narrowing(const std::map<long, double>& radii) {
  long wide = 0, narrow = 0;
  for (const auto& [height, radius] : radii) {
    if (radius >= 6.5) wide = height;
    if (radius >= 3.2) narrow = height;
  }
  EXPECT_GT(wide, 0);
  return static_cast<double>(narrow - wide) / 100;
}

TEST_F(Modifiers, CeilingsUnderModifiersHaveRoofs) {
  // One void of r = 10 in the middle. What the slicer leaves empty narrows as the void does: by 45 degrees
  // under a roof, so over 3.3 mm; over 1.9 mm in a sphere.
  const auto block = model("block.stl", make_box({0, 0, 0}, {22.6F, 22.6F, 28}));
  const auto narrowing = [&](const std::string& bridge) {
    const auto modified =
        hollow(block, {"--as", "modifiers", "--shape", "spheres", "--max-voids", "1", "--bridge", bridge});
    const auto gcode = folder_.path() / "out.gcode";
    slice_with_prusa(modified, gcode,
                     {"--fill-density", "80%", "--fill-pattern", "rectilinear", "--layer-height", "0.2",
                      "--skirts", "0", "--center", "50,50"});
    return height_of_narrowing(empty_radii(extrusion_moves(read_bytes(gcode)), 50, 50));
  };
  const double roofed = narrowing("5"), sphere = narrowing("30");
  std::printf("the empty space narrows over %.2f mm under a roof, over %.2f mm in a sphere\n", roofed,
              sphere);
  EXPECT_GT(roofed, 3.0);
  EXPECT_LT(sphere, 2.4);
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

TEST_F(Modifiers, LightningInThemHoldsUpTopsForLittle) {
  const auto block = model("block.stl", make_box({0, 0, 0}, {24, 24, 24}));
  const auto lightning = folder_.path() / "lightning.3mf";
  ASSERT_EQ(run({AERATE_EXECUTABLE, "hollow", block, "-o", lightning, "--as", "modifiers",
                 "--modifier-pattern", "lightning"})
                .exit_code,
            0);
  const auto empty = folder_.path() / "empty.3mf";
  ASSERT_EQ(run({AERATE_EXECUTABLE, "hollow", block, "-o", empty, "--as", "modifiers", "--max-voids", "1",
                 "--bridge", "1000"})
                .exit_code,
            0);
  const auto of_height = [&](const std::filesystem::path& path, double height) {
    const auto gcode = folder_.path() / "out.gcode";
    slice_with_prusa(path, gcode,
                     {"--fill-density", "15%", "--fill-pattern", "gyroid", "--layer-height", "0.3",
                      "--first-layer-height", "0.3", "--skirts", "0"});
    double sum = 0;
    for (const ExtrusionMove& move : extrusion_moves(read_bytes(gcode)))
      if (std::abs(move.z - height) < 0.01) sum += move.filament;
    return sum;
  };
  // The same shape, empty in one of them: below the top there are lines to hold it, and down in the block few.
  EXPECT_GT(of_height(lightning, 21), 1.1 * of_height(empty, 21));
  EXPECT_LT(filament(lightning, "15%"), 0.8 * filament(block, "15%"));
  EXPECT_GT(filament(lightning, "15%"), filament(empty, "15%"));
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
