#include <algorithm>
#include <cmath>
#include <filesystem>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <vector>

#include "files/formats.h"
#include "printing/slicers/slicer_version.h"
#include "tests/support/files.h"
#include "tests/support/process.h"
#include "tests/support/shapes.h"
#include "tests/support/temporary_folder.h"

// Whether the filament that a report predicts is what a slicer then uses. A small part of what
// bench/bench_economics does for docs/economics.md.
namespace aerate::test {
namespace {

using Json = nlohmann::json;

constexpr const char* kSlicer = "prusa-slicer";

double filament_mm3(const std::filesystem::path& model, const std::string& infill,
                    const std::filesystem::path& folder) {
  const auto gcode = folder / "print.gcode";
  const ProcessResult result = run({kSlicer,
                                    "--export-gcode",
                                    "--fill-density",
                                    infill,
                                    "--fill-pattern",
                                    infill == "100%" ? "rectilinear" : "gyroid",
                                    "--perimeters",
                                    "2",
                                    "--extrusion-width",
                                    "0.45",
                                    "--layer-height",
                                    "0.2",
                                    "--top-solid-layers",
                                    "5",
                                    "--bottom-solid-layers",
                                    "4",
                                    "--ensure-vertical-shell-thickness=1",
                                    "--no-thick-bridges",
                                    "--no-extra-perimeters",
                                    "--first-layer-height",
                                    "0.2",
                                    "--first-layer-extrusion-width",
                                    "0.45",
                                    "--skirts",
                                    "0",
                                    "--infill-anchor",
                                    "2.5",
                                    "--infill-anchor-max",
                                    "12",
                                    "--solid-infill-below-area",
                                    "0",
                                    "--output",
                                    gcode,
                                    model});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  constexpr const char* kLine = "; filament used [mm] = ";
  std::istringstream lines(read_bytes(gcode));
  for (std::string line; std::getline(lines, line);) {
    if (line.starts_with(kLine))
      return std::stod(line.substr(std::string(kLine).size())) * 3.14159265 * 1.75 * 1.75 / 4;
  }
  ADD_FAILURE() << "no filament figure in " << gcode;
  return 0;
}

// As the program calls itself; whose rules hold is told by it.
SlicerVersion version_of_slicer() {
  return version_of("PrusaSlicer", run({kSlicer, "--help"}).out).value_or(SlicerVersion{2, 5, 0});
}

class EconomicsSlicer : public testing::Test {
 protected:
  void SetUp() override {
    if (!is_installed(kSlicer)) GTEST_SKIP() << kSlicer << " is not installed: nothing was sliced";
  }

  void expect_as_predicted(const std::filesystem::path& model, const std::vector<std::string>& limits,
                           const std::vector<std::string>& infills) const {
    const bool modifiers = std::ranges::find(limits, "modifiers") != limits.end();
    const auto hollow = folder_.path() / (modifiers ? "hollow.3mf" : "hollow.stl");
    for (const std::string& infill : infills) {
      SCOPED_TRACE(model.filename().string() + " at " + infill);
      std::vector<std::string> command{AERATE_EXECUTABLE,
                                       "hollow",
                                       model,
                                       "-o",
                                       hollow,
                                       "--json",
                                       "-",
                                       "--infill",
                                       infill,
                                       "--force",
                                       "--tolerance",
                                       "0.1",
                                       "--slicer-version",
                                       to_text(version_of_slicer())};
      command.insert(command.end(), limits.begin(), limits.end());
      const ProcessResult result = run(command);
      ASSERT_EQ(result.exit_code, 0) << result.err;
      const double predicted = Json::parse(result.out)["print"]["filament_change_percent"].get<double>();
      const double solid = filament_mm3(model, infill, folder_.path());
      const double change = 100 * (filament_mm3(hollow, infill, folder_.path()) / solid - 1);
      std::printf("%s at %s: %+.1f %%, predicted %+.1f %%\n", model.filename().c_str(), infill.c_str(),
                  change, predicted);
      EXPECT_EQ(change > 0, predicted > 0);
      EXPECT_NEAR(predicted, change, std::max(0.1 * std::abs(change), 1.5));
    }
  }

  TemporaryFolder folder_;
};

TEST_F(EconomicsSlicer, ABlockThatIsPrintedSolidAndSparse) {
  const auto block = folder_.path() / "block.stl";
  write_mesh(make_box({0, 0, 0}, {26, 26, 26}), block, MeshFormat::stl);
  expect_as_predicted(block, {"--shape", "spheres", "--min-radius", "1.5", "--max-radius", "8"},
                      {"100%", "20%"});
  // Sparse prints of cells, which would be refused, are heavier by more than a tenth beyond the prediction.
  expect_as_predicted(block, {"--shape", "cells", "--min-radius", "1.5", "--max-radius", "8"}, {"100%"});
}

// One kind that saves, and one whose infill costs more along its borders than it saves.
TEST_F(EconomicsSlicer, ModifiersInABlock) {
  const auto block = folder_.path() / "block.stl";
  write_mesh(make_box({0, 0, 0}, {26, 26, 26}), block, MeshFormat::stl);
  expect_as_predicted(block, {"--as", "modifiers"}, {"15%"});
  expect_as_predicted(block,
                      {"--as", "modifiers", "--shape", "spheres", "--min-radius", "0.62", "--max-radius", "2",
                       "--modifier-infill", "5"},
                      {"15%"});
}

// With the voids that the command makes of its own accord.
TEST_F(EconomicsSlicer, APawnThatIsPrintedSparse) {
  expect_as_predicted(std::filesystem::path(AERATE_SAMPLES) / "pawn.obj", {}, {"50%", "30%"});
}

}  // namespace
}  // namespace aerate::test
