#include <algorithm>
#include <cmath>
#include <filesystem>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <vector>

#include "core/mesh.h"
#include "files/formats.h"
#include "tests/support/caught.h"
#include "tests/support/files.h"
#include "tests/support/process.h"
#include "tests/support/shapes.h"
#include "tests/support/temporary_folder.h"

// What a slicer makes of a hollowed model: the filament it needs falls by what the report says.
namespace aerate::test {
namespace {

using Json = nlohmann::json;

constexpr const char* kSlicer = "prusa-slicer";

// Filament for a model printed solid, cm3, as the slicer writes it into the G-code.
double filament_cm3(const std::filesystem::path& model, const std::filesystem::path& folder) {
  const auto gcode = folder / (model.stem().string() + ".gcode");
  const ProcessResult result =
      run({kSlicer, "--export-gcode", "--fill-density", "100%", "--fill-pattern", "rectilinear",
           "--layer-height", "0.2", "--skirts", "0", "--output", gcode, model});
  if (result.exit_code != 0) {
    ADD_FAILURE() << "the slicer failed on " << model << ": " << result.err;
    return 0;
  }
  constexpr const char* kLine = "; filament used [cm3] = ";
  std::istringstream lines(read_bytes(gcode));
  for (std::string line; std::getline(lines, line);) {
    if (line.starts_with(kLine)) return std::stod(line.substr(std::string(kLine).size()));
  }
  ADD_FAILURE() << "no filament figure in " << gcode;
  return 0;
}

struct Sliced {
  double removed_fraction = 0;   // as the report says
  double filament_fraction = 0;  // as the slicer says
};

// Hollows a model, slices it before and after, and compares.
Sliced expect_filament_to_fall_as_reported(const TemporaryFolder& folder, const std::filesystem::path& model,
                                           const std::vector<std::string>& limits) {
  const auto hollow = folder.path() / "hollow.stl";
  std::vector<std::string> command{AERATE_EXECUTABLE, "hollow", model, "-o", hollow, "--json", "-"};
  command.insert(command.end(), limits.begin(), limits.end());
  const ProcessResult result = run(command);
  EXPECT_EQ(result.exit_code, 0) << result.err;
  if (result.exit_code != 0) return {};
  const Json report = Json::parse(result.out);

  const double solid_cm3 = filament_cm3(model, folder.path());
  const double hollow_cm3 = filament_cm3(hollow, folder.path());
  Sliced sliced;
  sliced.removed_fraction = report["volume"]["removed_percent"].get<double>() / 100;
  sliced.filament_fraction = 1 - hollow_cm3 / solid_cm3;
  // A tenth of the measured change, or one point of the solid, whichever is more.
  const double allowed = std::max(0.1 * sliced.filament_fraction, 0.01);
  EXPECT_NEAR(sliced.filament_fraction, sliced.removed_fraction, allowed);
  std::printf("%s: filament %.2f -> %.2f cm3 (-%.2f %%), report -%.2f %%\n", model.filename().c_str(),
              solid_cm3, hollow_cm3, 100 * sliced.filament_fraction, 100 * sliced.removed_fraction);
  return sliced;
}

// The value of a line "name = value" of what the slicer tells about a file; empty if it does not tell it.
std::string told_by_slicer(const std::filesystem::path& model, const std::string& name) {
  const ProcessResult result = run({kSlicer, "--info", model});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  std::istringstream lines(result.out);
  for (std::string line; std::getline(lines, line);) {
    if (!line.starts_with(name + " =")) continue;
    const std::size_t value = line.find_first_not_of(' ', name.size() + 2);
    return value == std::string::npos ? "" : line.substr(value);
  }
  return "";
}

class Slicer : public testing::Test {
 protected:
  void SetUp() override {
    if (!is_installed(kSlicer)) GTEST_SKIP() << kSlicer << " is not installed: nothing was sliced";
  }

  // A mesh as a file with true normals, which the slicer wants.
  std::filesystem::path model(const std::string& name, const Mesh& mesh) const {
    const auto path = folder_.path() / name;
    write_mesh(mesh, path, MeshFormat::stl);
    return path;
  }

  TemporaryFolder folder_;
};

TEST_F(Slicer, BlockWithALargeVoidLosesTwoFifths) {
  const auto block = model("block.stl", make_box({0, 0, 0}, {30, 30, 30}));
  const Sliced sliced =
      expect_filament_to_fall_as_reported(folder_, block,
                                          {"--packing", "adaptive", "--wall", "0.8", "--gap", "0.8",
                                           "--max-radius", "20", "--min-radius", "1.5"});
  EXPECT_GT(sliced.filament_fraction, 0.4);
}

TEST_F(Slicer, BracketWithALatticeOfVoids) {
  expect_filament_to_fall_as_reported(folder_, std::filesystem::path(AERATE_SAMPLES) / "bracket.stl",
                                      {"--packing", "hexagonal", "--max-radius", "3.5"});
}

TEST_F(Slicer, PawnInObjFormat) {
  // The slicer reads OBJ as well; the result is STL.
  const Sliced sliced = expect_filament_to_fall_as_reported(
      folder_, std::filesystem::path(AERATE_SAMPLES) / "pawn.obj",
      {"--packing", "adaptive", "--wall", "0.8", "--max-radius", "10", "--min-radius", "1.5"});
  EXPECT_GT(sliced.filament_fraction, 0.1);
}

TEST_F(Slicer, DrainedVoidsNeedNoRepairAndAreLeftEmpty) {
  const auto block = model("block.stl", make_box({0, 0, 0}, {30, 28, 26}));
  for (const char* process : {"sla", "sls", "metal"}) {
    SCOPED_TRACE(process);
    const Sliced sliced = expect_filament_to_fall_as_reported(folder_, block, {"--process", process});
    EXPECT_GT(sliced.filament_fraction, 0.2);
    const auto hollow = folder_.path() / "hollow.stl";
    EXPECT_EQ(told_by_slicer(hollow, "manifold"), "yes");
    // Voids, channels and holes are one surface with the outside: nothing is sealed.
    EXPECT_EQ(told_by_slicer(hollow, "number_of_parts"), "1");
    for (const char* repair : {"open_edges", "degenerate_facets", "edges_fixed", "facets_removed",
                               "facets_reversed", "backwards_edges"})
      EXPECT_EQ(told_by_slicer(hollow, repair), "");
  }
}

TEST_F(Slicer, OverlappingBoxesHaveVoidsOnlyWhereTheSlicerLeavesThem) {
  // Half of the volume is in both boxes: a void there would be filled, and the report would promise too much.
  const Mesh boxes = join(make_box({0, 0, 0}, {24, 16, 16}), make_box({12, 0, 0}, {36, 16, 16}));
  const auto overlapping = model("overlapping.stl", boxes);
  const Sliced sliced = expect_filament_to_fall_as_reported(
      folder_, overlapping,
      {"--packing", "adaptive", "--wall", "0.8", "--max-radius", "10", "--min-radius", "1.5"});
  EXPECT_GT(sliced.filament_fraction, 0.1);

  // United first, the whole inside takes voids, and the slicer leaves those too.
  const Sliced united =
      expect_filament_to_fall_as_reported(folder_, overlapping,
                                          {"--packing", "adaptive", "--wall", "0.8", "--max-radius", "10",
                                           "--min-radius", "1.5", "--surface", "remesh"});
  EXPECT_GT(united.filament_fraction, sliced.filament_fraction);
}

}  // namespace
}  // namespace aerate::test
