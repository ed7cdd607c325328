#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "core/mesh.h"
#include "files/formats.h"
#include "files/load.h"
#include "files/three_mf.h"
#include "printing/slicers/slicers.h"
#include "tests/slicer/fake_slicer.h"
#include "tests/slicer/slicing.h"
#include "tests/support/caught.h"
#include "tests/support/shapes.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/zip.h"

// `aerate slice` and `aerate hook` with real slicers.
namespace aerate::test {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

#define AERATE_NEEDS(program) \
  if (!is_installed(program)) GTEST_SKIP() << program << " is not installed: nothing was sliced"

class Slicing : public testing::Test {
 protected:
  Slicing() { fs::create_directory(outputs()); }

  fs::path outputs() const { return folder_.path() / "outputs"; }
  fs::path output() const { return outputs() / "out.gcode"; }

  fs::path model(const std::string& name, const Mesh& mesh) const {
    const auto path = folder_.path() / name;
    write_mesh(mesh, path, MeshFormat::stl);
    return path;
  }
  fs::path block() const { return model("block.stl", make_box({0, 0, 0}, {22, 20, 18})); }
  // Unlike its mirror image, and unlike itself when turned.
  static Mesh tetrahedron() {
    Mesh mesh;
    mesh.positions = {{0, 0, 0}, {24, 0, 0}, {0, 16, 0}, {0, 0, 9}};
    mesh.triangles = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}};
    return mesh;
  }

  ProcessResult slice(const fs::path& model, const std::string& slicer,
                      std::vector<std::string> options) const {
    std::vector<std::string> command{AERATE_EXECUTABLE, "slice",        model, "--slicer",     slicer, "-o",
                                     output(),          "--max-radius", "8",   "--min-radius", "2"};
    command.insert(command.end(), options.begin(), options.end());
    return run(command);
  }

  TemporaryFolder folder_;
};

// --- aerate slice ---

TEST_F(Slicing, PicksTheFormThatTakesTheLeastByPrusaSlicersFigures) {
  AERATE_NEEDS("prusa-slicer");
  const fs::path config =
      folder_.write("my settings.ini",
                    "fill_density = 40%\nfill_pattern = gyroid\nlayer_height = 0.3\n"
                    "filament_density = 1.24\nfilament_cost = 25\npost_process = /bin/false\n");
  const ProcessResult result = slice(block(), "prusa-slicer", {"--config", config, "--json", "-"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_TRUE(contains(result.err, "post-processing programs of the settings are not run"));
  const Json report = Json::parse(result.out);
  ASSERT_EQ(report["forms"].size(), 4u);
  std::map<std::string, double> filament;
  for (const Json& form : report["forms"]) {
    filament[form["form"]] = form["filament_mm"];
    for (const char* figure : {"filament_cm3", "filament_g", "cost", "seconds"})
      EXPECT_GT(form[figure], 0) << figure;
    EXPECT_EQ(form["layers"], 60) << form["form"];
  }
  const std::string written = read_bytes(output());
  const double least = std::min({filament["solid"], filament["voids"], filament["modifiers"]});
  EXPECT_DOUBLE_EQ(figures_of(written, prusa_slicer()).filament_mm.value(), least);
  EXPECT_DOUBLE_EQ(filament.at(report["output"]["form"]), least);
  EXPECT_LT(least, filament["solid"]);
  EXPECT_EQ(setting_in(written, "fill_density").value(), "40%");
  EXPECT_EQ(setting_in(written, "fill_pattern").value(), "gyroid");
}

// As the slicer's own profiles of 0.2 mm have it, but for the height of layers.
const char* const kSparseSettings =
    "fill_density = 15%\nfill_pattern = gyroid\nlayer_height = 0.3\nfirst_layer_height = 0.3\n"
    "perimeters = 2\ntop_solid_layers = 4\nbottom_solid_layers = 3\n"
    "ensure_vertical_shell_thickness = 1\nsolid_infill_below_area = 0\nthick_bridges = 0\n";

TEST_F(Slicing, SaysFirstThatAPatternOfTheSlicerTakesLess) {
  AERATE_NEEDS("prusa-slicer");
  const fs::path config = folder_.write("sparse.ini", kSparseSettings);
  const std::vector<std::string> options{"--config", config, "--shape", "spheres", "--wall", "1.2"};
  const ProcessResult result = slice(block(), "prusa-slicer", options);
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_TRUE(result.out.starts_with("least       lightning infill, a setting of prusa-slicer: "))
      << result.out;
  EXPECT_TRUE(contains(result.out, "holds up tops, no strength"));
  EXPECT_TRUE(contains(result.out, "what was written is "));
  EXPECT_TRUE(contains(result.out, "15 % gyroid"));
  // It is the user's to choose: the print stays what the settings say.
  EXPECT_EQ(setting_in(read_bytes(output()), "fill_pattern").value(), "gyroid");
}

TEST_F(Slicing, FormsThatAreHopelessAreNotSliced) {
  AERATE_NEEDS("prusa-slicer");
  const fs::path config = folder_.write("sparse.ini", kSparseSettings);
  const ProcessResult text = slice(block(), "prusa-slicer", {"--config", config, "--compare", "forms"});
  ASSERT_EQ(text.exit_code, 0) << text.err;
  EXPECT_TRUE(contains(text.out, "%, not sliced\n")) << text.out;
  const Json report = Json::parse(
      slice(block(), "prusa-slicer", {"--config", config, "--compare", "forms", "--json", "-"}).out);
  ASSERT_EQ(report["forms"].size(), 2u);
  ASSERT_EQ(report["not_sliced"].size(), 1u);
  EXPECT_EQ(report["not_sliced"][0]["form"], "voids");
  const double predicted = report["not_sliced"][0]["predicted_percent"];
  // Who insists gets it, and it is as bad as that.
  const Json voids =
      Json::parse(slice(block(), "prusa-slicer", {"--config", config, "--as", "voids", "--json", "-"}).out);
  ASSERT_EQ(voids["output"]["form"], "voids");
  EXPECT_NEAR(-voids["forms"][1]["filament_saved_percent"].get<double>(), predicted, 0.1 * predicted);
}

TEST_F(Slicing, ComparesAllPatternsAndModifiersThatHoldLightning) {
  AERATE_NEEDS("prusa-slicer");
  const fs::path config = folder_.write("sparse.ini", kSparseSettings);
  const ProcessResult result =
      slice(block(), "prusa-slicer", {"--config", config, "--compare", "patterns", "--json", "-"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const Json report = Json::parse(result.out);
  std::map<std::string, double> filament;
  for (const Json& form : report["forms"]) {
    filament[form["form"]] = form["filament_mm"];
    EXPECT_FALSE(form["good_for"].get<std::string>().empty()) << form["form"];
  }
  for (const char* form :
       {"lightning", "adaptivecubic", "supportcubic", "modifiers", "lightning-modifiers"}) {
    ASSERT_TRUE(filament.contains(form)) << form;
    EXPECT_LT(filament[form], filament["solid"]) << form;
  }
  const auto least = std::ranges::min_element(filament, {}, [](const auto& form) { return form.second; });
  EXPECT_EQ(report["least"], least->first);
  const std::string chosen = report["output"]["form"];
  EXPECT_DOUBLE_EQ(filament[chosen], std::min(filament["modifiers"], filament["lightning-modifiers"]));
}

TEST_F(Slicing, WritesThePatternThatWasAskedFor) {
  AERATE_NEEDS("prusa-slicer");
  const fs::path config = folder_.write("sparse.ini", kSparseSettings);
  const ProcessResult result =
      slice(block(), "prusa-slicer", {"--config", config, "--as", "supportcubic", "--json", "-"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(Json::parse(result.out)["output"]["form"], "supportcubic");
  EXPECT_EQ(setting_in(read_bytes(output()), "fill_pattern").value(), "supportcubic");
  EXPECT_EQ(slice(block(), "slic3r", {"--as", "lightning"}).exit_code, 2);
}

TEST_F(Slicing, PatternsThatTheSlicerFailsWithAreSkipped) {
  const FakeSlicer fake(folder_);
  for (const char* form : {"solid", "voids", "modifiers"}) fake.hands_out(form, fake_gcode(1000));
  const ProcessResult result =
      slice(block(), "prusa-slicer", {"--slicer-path", fake.program(), "--json", "-"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const Json report = Json::parse(result.out);
  EXPECT_EQ(report["not_sliced"][0]["form"], "lightning");
  EXPECT_TRUE(contains(report["not_sliced"][0]["why"].get<std::string>(), "failed with status 1"));
  EXPECT_EQ(slice(block(), "prusa-slicer", {"--slicer-path", fake.program(), "--as", "lightning"}).exit_code,
            1);
}

TEST_F(Slicing, APatternThatIsThePrintsOwnOrOfASolidPrintIsNotSliced) {
  const FakeSlicer fake(folder_);
  const auto with = [](std::string gcode, const std::string& line) {
    const std::string infill = "; fill_density = 60%\n";
    return gcode.replace(gcode.find(infill), infill.size(), line);
  };
  for (const char* form : {"voids", "modifiers"}) fake.hands_out(form, fake_gcode(900));
  const auto patterns = [&](const std::string& lines) {
    fake.hands_out("solid", with(fake_gcode(1000), lines));
    const ProcessResult result =
        slice(block(), "prusa-slicer", {"--slicer-path", fake.program(), "--json", "-"});
    EXPECT_EQ(result.exit_code, 0) << result.err;
    Json report = Json::parse(result.out);
    return report["not_sliced"];
  };
  EXPECT_EQ(patterns("; fill_density = 15%\n; fill_pattern = lightning\n"), Json::array());
  EXPECT_EQ(patterns("; fill_density = 100%\n")[0]["why"], "not sliced: no pattern of 100 % infill");
}

TEST_F(Slicing, WritesTheSolidPrintWhenNothingTakesLess) {
  AERATE_NEEDS("slic3r");
  // Small voids at sparse infill: their walls cost more than they save.
  const fs::path config =
      folder_.write("sparse.ini", "fill_density = 5%\nlayer_height = 0.3\npost_process = /bin/false\n");
  const fs::path narrow = model("narrow.stl", make_box({0, 0, 0}, {12, 12, 12}));
  const ProcessResult result =
      slice(narrow, "slic3r", {"--config", config, "--modifier-infill", "5", "--json", "-"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const Json report = Json::parse(result.out);
  ASSERT_EQ(report["forms"].size(), 3u);
  EXPECT_EQ(report["output"]["form"], "solid");
  EXPECT_GT(report["forms"][1]["filament_mm"], report["forms"][0]["filament_mm"]);
  EXPECT_EQ(figures_of(read_bytes(output()), slic3r()).filament_mm.value(),
            report["forms"][0]["filament_mm"]);
}

TEST_F(Slicing, Slic3rPrintsVoids) {
  AERATE_NEEDS("slic3r");
  const fs::path config =
      folder_.write("dense.ini", "fill_density = 100%\nfill_pattern = rectilinear\nlayer_height = 0.3\n");
  const ProcessResult result = slice(block(), "slic3r", {"--config", config, "--json", "-"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const Json report = Json::parse(result.out);
  ASSERT_EQ(report["forms"][1]["form"], "voids");
  EXPECT_GT(report["forms"][1]["filament_saved_percent"], 5);
}

TEST_F(Slicing, Slic3rPrintsModifiers) {
  AERATE_NEEDS("slic3r");
  const fs::path config = folder_.write("sparse.ini", kSparseSettings);
  const ProcessResult result =
      slice(block(), "slic3r", {"--config", config, "--as", "modifiers", "--json", "-"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const Json report = Json::parse(result.out);
  EXPECT_EQ(report["output"]["form"], "modifiers");
  const double saved = report["forms"][1]["filament_saved_percent"];
  std::printf("Slic3r: modifiers save %.1f %%\n", saved);
  EXPECT_GT(saved, 10);
  // It has no such infill.
  const ProcessResult lightning = slice(block(), "slic3r", {"--as", "lightning-modifiers"});
  EXPECT_EQ(lightning.exit_code, 2);
  EXPECT_TRUE(contains(lightning.err, "no lightning"));
}

TEST_F(Slicing, ShowsAllThatAFailingSlicerPrinted) {
  const FakeSlicer fake(folder_);
  fake.behave("echo first; echo second >&2; echo third; exit 3");
  const ProcessResult result = slice(block(), "prusa-slicer", {"--slicer-path", fake.program()});
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_TRUE(
      contains(result.err, "failed with status 3 on block.stl; it printed:\n  first\n  second\n  third\n"));
  EXPECT_EQ(entries_of(outputs()), std::vector<std::string>{});
}

TEST_F(Slicing, FormsThatTheSlicerPutsElsewhereAreLeftOut) {
  const FakeSlicer fake(folder_);
  fake.behave(FakeSlicer::as_version("2.9.4"));
  fake.hands_out("solid", fake_gcode(1000));
  fake.hands_out("voids", fake_gcode(900));
  fake.hands_out("modifiers", fake_gcode(800, 81.4));
  const std::vector<std::string> options{"--slicer-path", fake.program(), "--compare", "forms"};
  const ProcessResult result = slice(block(), "prusa-slicer", options);
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_TRUE(contains(result.out, "elsewhere, 81.4 mm off")) << result.out;
  EXPECT_EQ(read_bytes(output()), fake_gcode(900));
  EXPECT_TRUE(contains(read_bytes(fake.folder() / "arguments"), "|--dont-arrange|--center|125,105|"));
  fs::remove(output());
  const ProcessResult asked =
      slice(block(), "prusa-slicer", {"--slicer-path", fake.program(), "--as", "modifiers"});
  EXPECT_EQ(asked.exit_code, 1);
  EXPECT_TRUE(contains(asked.err, "elsewhere, 81.4 mm off"));
  EXPECT_EQ(entries_of(outputs()), std::vector<std::string>{});
}

TEST_F(Slicing, TheBedOfTheSettingsIsTheOneThatCounts) {
  const FakeSlicer fake(folder_);
  fake.behave(FakeSlicer::as_version("2.9.4"));
  for (const char* form : {"solid", "voids", "modifiers"}) fake.hands_out(form, fake_gcode(1000));
  const fs::path first =
      folder_.write("first.ini", "bed_shape = 0x0,100x0,100x100,0x100\nlayer_height = 0.3\n");
  const fs::path second = folder_.write("second.ini", "bed_shape = 0x0,180x0,180x180,0x180\n");
  const ProcessResult result = slice(block(), "prusa-slicer",
                                     {"--slicer-path", fake.program(), "--compare", "forms", "--config",
                                      first, "--config", second, "--json", "-"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(Json::parse(result.out)["slicer"]["version"].get<std::string>(), "2.9.4");
  EXPECT_TRUE(contains(read_bytes(fake.folder() / "arguments"), "|--center|90,90|"));
}

TEST_F(Slicing, RefusesProcessesThatPrintNoFilament) {
  const FakeSlicer fake(folder_);
  for (const char* process : {"sla", "sls", "metal"}) {
    const ProcessResult result = run({AERATE_EXECUTABLE, "slice", block(), "--slicer", "prusa-slicer",
                                      "--slicer-path", fake.program(), "-o", output(), "--process", process});
    EXPECT_EQ(result.exit_code, 2) << result.err;
    EXPECT_TRUE(contains(result.err, std::string("process ") + process + " prints no filament"));
    EXPECT_TRUE(contains(result.err, "aerate hollow"));
  }
  EXPECT_EQ(entries_of(outputs()), std::vector<std::string>{});
}

TEST_F(Slicing, WritesTheSolidPrintWhenNothingCanBeRemoved) {
  const FakeSlicer fake(folder_);
  fake.hands_out("solid", fake_gcode(1000));
  const fs::path plate = model("plate.stl", make_box({0, 0, 0}, {20, 20, 1}));
  const ProcessResult result = slice(plate, "prusa-slicer", {"--slicer-path", fake.program()});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_TRUE(contains(result.err, "nothing to remove"));
  EXPECT_TRUE(contains(result.err, "the solid model is what was written"));
  EXPECT_EQ(read_bytes(output()), fake_gcode(1000));
  fs::remove(output());
  EXPECT_EQ(slice(plate, "prusa-slicer", {"--slicer-path", fake.program(), "--as", "voids"}).exit_code, 5);
  EXPECT_EQ(entries_of(outputs()), std::vector<std::string>{});
}

TEST_F(Slicing, RefusesToWriteOverItsSettings) {
  const FakeSlicer fake(folder_);
  std::ofstream(output()) << "fill_density = 40%\n";
  const ProcessResult result =
      slice(block(), "prusa-slicer", {"--slicer-path", fake.program(), "--config", output()});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_TRUE(contains(result.err, "the output is the file of settings"));
  EXPECT_EQ(read_bytes(output()), "fill_density = 40%\n");
}

TEST_F(Slicing, RefusesToGiveGcodeTheNameOfAModel) {
  const FakeSlicer fake(folder_);
  const fs::path part = block(), other = outputs() / "part.STL";
  const ProcessResult result = run({AERATE_EXECUTABLE, "slice", part, "--slicer", "prusa-slicer",
                                    "--slicer-path", fake.program(), "-o", other});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_TRUE(contains(result.err, "give a name such as part.gcode"));
  EXPECT_EQ(entries_of(outputs()), std::vector<std::string>{});
}

TEST_F(Slicing, SaysThatBinaryGcodeCannotBeRead) {
  const FakeSlicer fake(folder_);
  fake.hands_out("solid", fake_gcode(1000));
  fake.hands_out("voids", "GCDE and so on");
  const ProcessResult result = slice(block(), "prusa-slicer", {"--slicer-path", fake.program()});
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_TRUE(contains(result.err, "binary_gcode = 0"));
}

TEST_F(Slicing, RefusesWhatIsMissing) {
  const FakeSlicer fake(folder_);
  EXPECT_EQ(slice(block(), "prusa-slicer", {"--slicer-path", "/none"}).exit_code, 2);
  const ProcessResult result =
      slice(block(), "prusa-slicer", {"--slicer-path", fake.program(), "--config", "/none.ini"});
  EXPECT_EQ(result.exit_code, 3);
  EXPECT_TRUE(contains(result.err, "/none.ini: no settings"));
  EXPECT_EQ(entries_of(outputs()), std::vector<std::string>{});
}

// --- aerate hook, called by PrusaSlicer ---

TEST_F(Slicing, PrusaSlicerCallsTheHookAndGetsTheBetterGcode) {
  AERATE_NEEDS("prusa-slicer");
  const fs::path odd = folder_.path() / "it's a model";
  fs::create_directory(odd);
  const fs::path part = odd / "block (1).stl";
  fs::copy_file(block(), part);
  const std::vector<std::string> options{"--fill-density", "40%", "--fill-pattern", "gyroid",
                                         "--layer-height", "0.3"};
  const GcodeFigures solid = slice_with_prusa(part, folder_.path() / "solid.gcode", options);

  std::string line = run({AERATE_EXECUTABLE, "hook", "--print-setup", "prusa-slicer", "--model", part}).out;
  line.pop_back();
  auto hooked = options;
  hooked.insert(hooked.end(), {"--post-process", line + " --max-radius 8 --min-radius 2"});
  const GcodeFigures figures = slice_with_prusa(part, output(), hooked);
  const std::string gcode = read_bytes(output());
  EXPECT_TRUE(contains(gcode, "; aerate_result = modifiers\n"));
  EXPECT_LT(figures.filament_mm.value(), solid.filament_mm.value());
  EXPECT_TRUE(contains(gcode, "(solid " + std::to_string(solid.filament_mm.value()).substr(0, 6)));
  EXPECT_TRUE(contains(setting_in(gcode, "post_process").value(), "hook --model"));

  // The slicer still reads its settings from it.
  const auto again = folder_.path() / "again.gcode";
  const ProcessResult loaded = run(
      {"prusa-slicer", "--load", output(), "--post-process", "", "--export-gcode", "--output", again, part});
  EXPECT_EQ(loaded.exit_code, 0) << loaded.err;
  EXPECT_EQ(setting_in(read_bytes(again), "fill_density").value(), "40%");
}

TEST_F(Slicing, TheHookRefusesModelsThatDoNotStandAsInTheFile) {
  AERATE_NEEDS("prusa-slicer");
  const fs::path part = model("part.stl", tetrahedron());
  Mesh mirrored = tetrahedron();
  for (Vec3f& p : mirrored.positions) p.x = -p.x;
  const fs::path mirror = model("mirror.stl", turned_inside_out(mirrored));
  const fs::path other = model("other.stl", make_box({0, 0, 0}, {8, 8, 8}));
  const std::vector<std::vector<std::string>> cases{
      {"--rotate", "30", part},    {"--scale", "1.02", part},  {mirror},
      {"--center", "70,70", part}, {"--rotate-x", "90", part}, {"--duplicate", "2", part},
      {"--merge", part, other}};
  // From 2.8 on a model that was moved on the plate is followed (with_newer_slicer.sh).
  const bool follows = std::getenv("AERATE_PRUSA_SLICER") != nullptr;
  for (const auto& arguments : cases) {
    if (follows && arguments.front() == "--center") continue;
    std::vector<std::string> command{"prusa-slicer", "--export-gcode", "--layer-height",
                                     "0.3",          "--output",       output()};
    command.insert(command.end(), arguments.begin(), arguments.end());
    ASSERT_EQ(run(command).exit_code, 0) << arguments.front();
    const std::string before = read_bytes(output());
    const ProcessResult result = run({AERATE_EXECUTABLE, "hook", "--strict", "--model", part, output()});
    EXPECT_EQ(result.exit_code, 3) << arguments.front() << ": " << result.err;
    EXPECT_TRUE(contains(result.err, "does not give the same G-code")) << arguments.front();
    EXPECT_EQ(read_bytes(output()), before) << arguments.front();
    EXPECT_EQ(entries_of(outputs()), std::vector<std::string>{"out.gcode"});
  }
}

TEST_F(Slicing, AHookThatCannotDoItsWorkCostsNoPrint) {
  AERATE_NEEDS("prusa-slicer");
  const fs::path part = model("part.stl", tetrahedron());
  const auto sliced_with = [&](const std::string& options) {
    return run({"prusa-slicer", "--export-gcode", "--post-process",
                std::string(AERATE_EXECUTABLE) + " hook --model /none.stl" + options, "--output", output(),
                part});
  };
  EXPECT_EQ(sliced_with("").exit_code, 0);
  EXPECT_TRUE(contains(read_bytes(output()), "; aerate_result = unchanged\n; aerate_remark = /none.stl: "));
  fs::remove(output());
  const ProcessResult strict = sliced_with(" --strict");
  EXPECT_NE(strict.exit_code, 0);
  EXPECT_TRUE(contains(strict.out + strict.err, "/none.stl"));
}

// The command line of PrusaSlicer 2.5 reads the name that it is told, and takes it away, but does not rename its output.
TEST_F(Slicing, TheHookFindsTheModelByTheNameOfThePrint) {
  AERATE_NEEDS("prusa-slicer");
  const fs::path part = block();
  const ProcessResult result = run(
      {"prusa-slicer", "--export-gcode", "--fill-density", "40%", "--layer-height", "0.3", "--post-process",
       std::string(AERATE_EXECUTABLE) + " hook --model-folder " + part.parent_path().string() +
           " --max-radius 8 --min-radius 2 --name-saving",
       "--output", outputs() / (part.stem().string() + "_0.3mm.gcode"), part});
  ASSERT_EQ(result.exit_code, 0) << result.out << result.err;
  const std::vector<std::string> names = entries_of(outputs());
  ASSERT_EQ(names, std::vector<std::string>{part.stem().string() + "_0.3mm.gcode"});
  EXPECT_TRUE(contains(read_bytes(outputs() / names[0]), "; aerate_result = modifiers\n"));
}

TEST_F(Slicing, AProjectKeepsItsPlace) {
  AERATE_NEEDS("prusa-slicer");
  // A block somewhere on the bed, as a project says it: the hook does not put it into the middle.
  const fs::path part = model("part.stl", make_box({30, 40, 0}, {52, 60, 18}));
  const fs::path project = folder_.path() / "project.3mf";
  write_mesh(make_box({30, 40, 0}, {52, 60, 18}), project, MeshFormat::three_mf);
  const std::vector<std::string> options{"--dont-arrange", "--fill-density", "40%", "--fill-pattern",
                                         "gyroid",         "--layer-height", "0.3"};
  slice_with_prusa(part, output(), options);
  const ProcessResult result = run(
      {AERATE_EXECUTABLE, "hook", "--model", project, "--max-radius", "8", "--min-radius", "2", output()});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const std::string gcode = read_bytes(output());
  EXPECT_TRUE(contains(gcode, "; aerate_result = modifiers\n"));
}

TEST_F(Slicing, AProjectOfPrusaSlicerItself) {
  AERATE_NEEDS("prusa-slicer");
  // Turned and larger than in its file; the package names a thumbnail that it does not have.
  const fs::path project = folder_.path() / "project.3MF";
  const ProcessResult exported =
      run({"prusa-slicer", "--export-3mf", "--rotate", "30", "--scale", "1.1", "--center", "100,100",
           "--output", folder_.path() / "made.3mf", block()});
  ASSERT_EQ(exported.exit_code, 0) << exported.err;
  fs::rename(folder_.path() / "made.3mf", project);
  slice_with_prusa(
      project, output(),
      {"--dont-arrange", "--fill-density", "40%", "--fill-pattern", "gyroid", "--layer-height", "0.3"});
  const ProcessResult result = run(
      {AERATE_EXECUTABLE, "hook", "--model", project, "--max-radius", "8", "--min-radius", "2", output()});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_TRUE(contains(read_bytes(output()), "; aerate_result = modifiers\n"));
}

// --- what a mesh does not carry ---

const std::vector<std::string> kDense{
    "--layer-height", "0.3",         "--first-layer-height", "0.3",
    "--perimeters",   "2",           "--fill-density",       "100%",
    "--fill-pattern", "rectilinear", "--bed-shape",          "0x0,200x0,200x200,0x200"};

std::vector<std::string> dense_with(const std::vector<std::string>& more) {
  std::vector<std::string> options = kDense;
  options.insert(options.end(), more.begin(), more.end());
  return options;
}

fs::path project(const std::string& name) {
  return fs::path(AERATE_TEST_DATA) / "projects" / (name + ".3mf");
}

TEST_F(Slicing, TheHookLosesNothingThatAProjectHas) {
  AERATE_NEEDS("prusa-slicer");
  // What the message says of the project, and of its G-code where the model is given as a mesh.
  struct Case {
    std::string name, in_project, in_gcode;
    std::vector<std::string> options;
  };
  const fs::path block = model("block.stl", make_box({0, 0, 0}, {30, 30, 20})),
                 small = model("small.stl", make_box({0, 0, 0}, {16, 16, 12}));
  const std::vector<Case> cases{
      {"colour_change",
       "colour changes, pauses or G-code between layers",
       "\"M600\" after the layer at z = 5.70 mm",
       {}},
      {"object_speed", "settings of the object (external_perimeter_speed = 10)", "is printed at", {}},
      {"range_speed", "settings of layers", "layers are at other heights", {}},
      {"extruder2",
       "settings of the object (extruder = 2)",
       "would be lost",
       {"--single-extruder-multi-material", "--nozzle-diameter", "0.4,0.4", "--temperature", "200,240",
        "--first-layer-temperature", "200,245"}},
      {"painted_seam", "painted seams", "", {}}};
  for (const Case& each : cases) {
    SCOPED_TRACE(each.name);
    std::vector<std::string> options = dense_with(each.options);
    options.emplace_back("--dont-arrange");
    slice_with_prusa(project(each.name), output(), options);
    const std::string before = read_bytes(output());
    const ProcessResult result = run({AERATE_EXECUTABLE, "hook", "--strict", "--model", project(each.name),
                                      "--max-radius", "5", output()});
    EXPECT_EQ(result.exit_code, 3) << result.err;
    EXPECT_TRUE(contains(result.err, "the project has " + each.in_project + ", which would be lost"));
    EXPECT_EQ(read_bytes(output()), before);
    if (each.in_gcode.empty()) continue;
    const ProcessResult as_mesh =
        run({AERATE_EXECUTABLE, "hook", "--strict", "--model", each.name == "extruder2" ? small : block,
             "--max-radius", "5", output()});
    EXPECT_EQ(as_mesh.exit_code, 3) << as_mesh.err;
    EXPECT_TRUE(contains(as_mesh.err, each.in_gcode));
    EXPECT_EQ(read_bytes(output()), before);
  }
}

TEST_F(Slicing, TheHookKeepsTheNameOfTheObject) {
  AERATE_NEEDS("prusa-slicer");
  const fs::path start = folder_.write(
      "vars.ini",
      "start_gcode = G28\\nM117 [input_filename_base] {total_layer_count}\\n\ngcode_label_objects = 1\n");
  // A project whose object has another name than its file, the same without labels, and a mesh.
  const fs::path part = model("it's a <part> & more.stl", make_box({0, 0, 0}, {16, 16, 12}));
  struct Case {
    fs::path model;
    std::string label, place;
  };
  for (const Case& each : {Case{project("small"), "block", "--dont-arrange"},
                           Case{part, "it's a <part> & more.stl", "--scale=1"}}) {
    for (const std::string labels : {"1", "0"}) {
      SCOPED_TRACE(each.label + labels);
      slice_with_prusa(each.model, output(),
                       dense_with({"--load", start, each.place, "--gcode-label-objects=" + labels}));
      const ProcessResult result =
          run({AERATE_EXECUTABLE, "hook", "--model", each.model, "--max-radius", "5", output()});
      ASSERT_EQ(result.exit_code, 0) << result.err;
      const std::string gcode = read_bytes(output());
      EXPECT_TRUE(contains(gcode, "; aerate_result = modifiers\n"));
      EXPECT_TRUE(contains(gcode, "\nM117 " + fs::path(each.label).stem().string() + " 40\n"));
      const std::string label = "\n; printing object " + each.label + " id:0 copy 0\n";
      EXPECT_EQ(gcode.find(label) != std::string::npos, labels == "1");
    }
  }
}

TEST_F(Slicing, TheSettingsInAProjectAreUsed) {
  AERATE_NEEDS("prusa-slicer");
  const ProcessResult result = slice(project("with_settings"), "prusa-slicer", {"--json", "-"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_TRUE(contains(result.err, "the settings in the project are used"));
  EXPECT_NEAR(Json::parse(result.out)["forms"][0]["filament_mm"].get<double>(), 1292.73, 0.5);
  if (!is_installed("slic3r")) return;
  const ProcessResult refused = slice(project("with_settings"), "slic3r", {});
  EXPECT_EQ(refused.exit_code, 3);
  EXPECT_TRUE(contains(refused.err, "the settings in the project are prusa-slicer's and not read"));
  const fs::path config = folder_.write("own.ini", "layer_height = 0.3\n");
  EXPECT_TRUE(contains(slice(project("with_settings"), "slic3r", {"--config", config}).err,
                       "the settings in the project are prusa-slicer's and not used"));
}

TEST_F(Slicing, ABundleOfPresetsIsNoFileOfSettings) {
  const FakeSlicer fake(folder_);
  const fs::path bundle = folder_.write("bundle.ini", "# generated\n\n[print:my]\nlayer_height = 0.3\n");
  for (const char* slicer : {"prusa-slicer", "slic3r"}) {
    const ProcessResult result =
        slice(block(), slicer, {"--slicer-path", fake.program(), "--config", bundle});
    EXPECT_EQ(result.exit_code, 3) << result.err;
    EXPECT_TRUE(contains(result.err, "is a bundle of presets ([print:my])"));
  }
  EXPECT_EQ(entries_of(outputs()), std::vector<std::string>{});
}

TEST_F(Slicing, FilesWithoutSettingsAreRefused) {
  const FakeSlicer fake(folder_);
  struct Case {
    std::string slicer, file, text, said;
  };
  for (const Case& each :
       {Case{"prusa-slicer", "a.ini", "", "is empty"}, Case{"slic3r", "a.ini", "", "is empty"},
        Case{"prusa-slicer", "a.3mf", "PK\x03\x04", "is a project"},
        Case{"prusa-slicer", "a.json", "{\"wall_loops\": \"2\"}", "is JSON"},
        Case{"orca-slicer", "a.json", "{}", "holds no settings"},
        Case{"orca-slicer", "a.json", "wall_loops = 2", "is no JSON object"},
        Case{"cura-engine", "a.txt", "layer height\n", "holds no settings"}}) {
    const ProcessResult result =
        slice(block(), each.slicer,
              {"--slicer-path", fake.program(), "--config", folder_.write(each.file, each.text)});
    EXPECT_EQ(result.exit_code, 3) << each.said << result.err;
    EXPECT_TRUE(contains(result.err, each.said));
  }
  EXPECT_EQ(entries_of(outputs()), std::vector<std::string>{});
}

// Slicers say nothing of them, and print with their defaults.
TEST_F(Slicing, SettingsThatTheSlicerDoesNotKnow) {
  for (const char* slicer : {"prusa-slicer", "slic3r"}) {
    if (!is_installed(slicer)) continue;
    const ProcessResult none =
        slice(block(), slicer, {"--config", folder_.write("bad.ini", "fill_densty = 15%\n")});
    EXPECT_EQ(none.exit_code, 3) << none.err;
    EXPECT_TRUE(contains(none.err, "knows none of its settings (fill_densty (is fill_density meant?))"));
    EXPECT_EQ(entries_of(outputs()), std::vector<std::string>{});
    const ProcessResult some =
        slice(block(), slicer,
              {"--config", folder_.write("some.ini", "layer_height = 0.3\na = 1\nb = 2\nc = 3\nd = 4\n")});
    EXPECT_EQ(some.exit_code, 0) << some.err;
    EXPECT_TRUE(contains(
        some.err, "4 of 5 settings are not known to " + std::string(slicer) + " and not used: a, b, c, .."));
    fs::remove(output());
  }
}

TEST_F(Slicing, AProjectOfAnotherSlicerNeedsSettings) {
  const FakeSlicer fake(folder_);
  fake.hands_out("solid", fake_gcode(1000));
  fake.hands_out("voids", fake_gcode(900));
  fake.hands_out("modifiers", fake_gcode(950));
  const auto project = [&](const char* entry, const char* text) {
    const fs::path path = folder_.path() / "plain.3mf";
    write_mesh(make_box({0, 0, 0}, {22, 20, 18}), path, MeshFormat::three_mf);
    const auto model = read_3mf_entry(path, kThreeMfModel);
    return folder_.write("project.3mf",
                         make_zip({{"[Content_Types].xml", read_3mf_entry(path, "[Content_Types].xml")},
                                   {"_rels/.rels", read_3mf_entry(path, "_rels/.rels")},
                                   {kThreeMfModel, model},
                                   {entry, text}}));
  };
  const fs::path orca = project("Metadata/project_settings.config", "{\"wall_loops\": \"3\"}");
  const std::vector<std::string> with_fake{"--slicer-path", fake.program()};
  const ProcessResult refused = slice(orca, "prusa-slicer", with_fake);
  EXPECT_EQ(refused.exit_code, 3);
  EXPECT_TRUE(contains(refused.err, "the settings in the project are orca-slicer's and not read"));
  EXPECT_TRUE(contains(refused.err, "--config"));
  EXPECT_EQ(entries_of(outputs()), std::vector<std::string>{});
  std::vector<std::string> configured = with_fake;
  configured.insert(configured.end(), {"--config", folder_.write("my.ini", "perimeters = 3\n")});
  const ProcessResult given = slice(orca, "prusa-slicer", configured);
  EXPECT_EQ(given.exit_code, 0) << given.err;
  EXPECT_TRUE(contains(given.err, "orca-slicer's and not used"));
}

TEST_F(Slicing, Slic3rRunsNoProgramOfTheSettings) {
  AERATE_NEEDS("slic3r");
  const fs::path mark = folder_.path() / "mark",
                 script = folder_.write("script.sh", "#!/bin/sh\ntouch '" + mark.string() + "'\n");
  fs::permissions(script, fs::perms::owner_all);
  for (const char* blank : {"", " ", "\t", "\v", "\f", "\r"}) {
    const fs::path config = folder_.write("settings.ini", std::string("layer_height = 0.3\n") + blank +
                                                              "post_process = " + script.string() + "\n");
    const ProcessResult result = slice(block(), "slic3r", {"--config", config});
    EXPECT_EQ(result.exit_code, 0) << result.err;
    EXPECT_TRUE(contains(result.err, "post-processing programs of the settings are not run"));
    EXPECT_FALSE(fs::exists(mark)) << static_cast<int>(blank[0]);
  }
}

TEST_F(Slicing, GcodeThatIsCutOffIsNotWritten) {
  // As slicers leave it that do not mind that the disk is full.
  const FakeSlicer fake(folder_);
  const std::string whole = fake_gcode(1000);
  fake.hands_out("voids", whole);
  fake.hands_out("modifiers", whole);
  for (const std::size_t size : {whole.size() - 5, whole.size() / 2}) {
    fake.hands_out("solid", whole.substr(0, size));
    const ProcessResult result = slice(block(), "prusa-slicer", {"--slicer-path", fake.program()});
    EXPECT_EQ(result.exit_code, 1) << result.err;
    EXPECT_TRUE(contains(result.err, "wrote G-code whose end is missing"));
    EXPECT_EQ(entries_of(outputs()), std::vector<std::string>{});
  }
}

TEST_F(Slicing, TheHookKnowsARoundModelAgainThoughItsSeamsMove) {
  AERATE_NEEDS("prusa-slicer");
  // PrusaSlicer puts the seams of one and the same model elsewhere from run to run.
  Mesh bunny = load_model(fs::path(AERATE_SAMPLES) / "bunny.stl").mesh;
  for (Vec3f& p : bunny.positions) p = {0.4F * p.x, 0.4F * p.y, 0.4F * p.z};
  const fs::path part = model("bunny.stl", bunny);
  slice_with_prusa(part, output(),
                   {"--fill-density", "15%", "--fill-pattern", "gyroid", "--layer-height", "0.3",
                    "--seam-position", "random"});
  const ProcessResult result =
      run({AERATE_EXECUTABLE, "hook", "--model", part, "--as", "modifiers", "--min-radius", "2", output()});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_TRUE(contains(read_bytes(output()), "; aerate_result = modifiers\n"));
}

// --- CuraEngine ---

fs::path cura_definition() {
  for (const char* folder : {AERATE_CURA_DEFINITIONS, "/usr/share/cura/resources/definitions"}) {
    const fs::path file = fs::path(folder) / "fdmprinter.def.json";
    if (fs::exists(file)) return file;
  }
  return {};
}

TEST_F(Slicing, CuraEngineLeavesTheVoidsLayerByLayer) {
  AERATE_NEEDS("CuraEngine");
  if (cura_definition().empty())
    GTEST_SKIP() << "no definitions for CuraEngine: scripts/install-dependencies --checks fetches them";
  const fs::path solid = model("solid.stl", make_box({0, 0, 0}, {20, 20, 20})),
                 hollow = folder_.path() / "hollow.stl";
  // One void in the middle, from 2 to 18 mm; a sphere, since a roof would be too high.
  ASSERT_EQ(run({AERATE_EXECUTABLE, "hollow", solid, "-o", hollow, "--wall", "2", "--max-radius", "8",
                 "--min-radius", "7", "--bridge", "20"})
                .exit_code,
            0);
  // Lines side by side, so that what is filled is seen in the length.
  const fs::path settings =
      folder_.write("settings.txt", "layer_height=0.2\ninfill_pattern=lines\ninfill_line_distance=0.4\n");
  Monitor monitor;
  const SlicerProfile cura = cura_engine();
  std::map<std::string, std::map<int, double>> fed;  // by height, hundredths of a millimetre
  for (const fs::path& file : {solid, hollow}) {
    const fs::path gcode = folder_.path() / (file.stem().string() + ".gcode");
    const Slicer slicer = find_slicer(cura, {});
    const GcodeFigures figures = aerate::slice(
        slicer,
        {.model = file, .gcode = gcode, .settings = {{cura_definition(), settings}}, .scratch = outputs()},
        monitor);
    EXPECT_GT(figures.seconds.value(), 60);
    EXPECT_GT(figures.filament_cm3.value(), 1);
    for (const ExtrusionMove& move : extrusion_moves(read_bytes(gcode)))
      fed[file.stem()][static_cast<int>(std::lround(move.z * 100))] += move.filament;
  }
  ASSERT_GT(fed["solid"].size(), 90u);
  std::size_t through_the_void = 0;
  for (const auto& [layer, length] : fed["solid"]) {
    const double height = layer / 100.0, hollow_length = fed["hollow"][layer];
    // Radius of the void at this height.
    const double square = 64 - (height - 10) * (height - 10);
    if (height > 0.5 && height < 1.5) {
      EXPECT_NEAR(hollow_length, length, 0.01 * length) << height;
    }
    if (square < 9) continue;
    ++through_the_void;
    // The void's disk is missing, but for the walls round it (two lines of 0.4 mm).
    const double radius = std::sqrt(square), missing = 3.14159 * radius * radius / 400;
    EXPECT_LT(hollow_length, length * (1 - 0.5 * missing)) << height;
    EXPECT_GT(hollow_length, length * (1 - 1.3 * missing)) << height;
  }
  EXPECT_GT(through_the_void, 60u);
}

TEST_F(Slicing, CuraEngineByTheCommand) {
  AERATE_NEEDS("CuraEngine");
  if (cura_definition().empty())
    GTEST_SKIP() << "no definitions for CuraEngine: scripts/install-dependencies --checks fetches them";
  const fs::path settings =
      folder_.write("settings.txt", "# dense\nlayer_height=0.3\ninfill_line_distance = 0.4\n");
  const ProcessResult result =
      slice(block(), "cura-engine", {"--config", cura_definition(), "--config", settings, "--json", "-"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const Json report = Json::parse(result.out);
  ASSERT_EQ(report["forms"].size(), 3u);
  EXPECT_EQ(report["forms"][1]["form"], "voids");
  EXPECT_GT(report["forms"][1]["filament_saved_percent"], 5);
  const std::string gcode = read_bytes(output());
  EXPECT_TRUE(gcode.starts_with(";FLAVOR:Marlin\n"));
  EXPECT_FALSE(contains(gcode, ";TIME:6666"));  // the header with the true figures is in
  const auto written = std::ranges::find_if(
      report["forms"], [&](const Json& form) { return form["form"] == report["output"]["form"]; });
  EXPECT_DOUBLE_EQ(figures_of(gcode, cura_engine()).seconds.value(), (*written)["seconds"].get<double>());
}

TEST_F(Slicing, CuraEnginePrintsLightning) {
  AERATE_NEEDS("CuraEngine");
  if (cura_definition().empty())
    GTEST_SKIP() << "no definitions for CuraEngine: scripts/install-dependencies --checks fetches them";
  const fs::path settings =
      folder_.write("settings.txt", "layer_height=0.3\ninfill_pattern=gyroid\ninfill_line_distance=2.7\n");
  const ProcessResult result =
      slice(block(), "cura-engine",
            {"--config", cura_definition(), "--config", settings, "--as", "lightning", "--json", "-"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const Json report = Json::parse(result.out);
  EXPECT_EQ(report["output"]["form"], "lightning");
  EXPECT_GT(report["forms"][1]["filament_saved_percent"], 10);
}

TEST_F(Slicing, CuraEnginePrintsModifiers) {
  AERATE_NEEDS("CuraEngine");
  if (cura_definition().empty())
    GTEST_SKIP() << "no definitions for CuraEngine: scripts/install-dependencies --checks fetches them";
  const fs::path settings =
      folder_.write("settings.txt", "layer_height=0.3\ninfill_pattern=gyroid\ninfill_line_distance=2.7\n");
  std::map<std::string, double> saved;
  for (const char* form : {"modifiers", "lightning-modifiers"}) {
    const ProcessResult result =
        slice(block(), "cura-engine",
              {"--config", cura_definition(), "--config", settings, "--as", form, "--json", "-"});
    ASSERT_EQ(result.exit_code, 0) << result.err;
    const Json report = Json::parse(result.out);
    EXPECT_EQ(report["output"]["form"], form);
    saved[form] = report["forms"][1]["filament_saved_percent"];
    EXPECT_EQ(report["forms"][1]["layers"], report["forms"][0]["layers"]);
    std::printf("CuraEngine: %s save %.1f %%\n", form, saved[form]);
    EXPECT_GT(saved[form], 10);
  }
}

// Two files are not centred one by one: the cell of a tower at one end of a long part is in the tower.
TEST_F(Slicing, CuraEngineKeepsModifiersWhereTheyAre) {
  AERATE_NEEDS("CuraEngine");
  if (cura_definition().empty())
    GTEST_SKIP() << "no definitions for CuraEngine: scripts/install-dependencies --checks fetches them";
  const fs::path settings =
      folder_.write("settings.txt", "layer_height=0.3\ninfill_pattern=lines\ninfill_line_distance=0.8\n");
  const fs::path part =
      model("part.stl", join(make_box({0, 0, 0}, {16, 16, 16}), make_box({40, 0, 0}, {42, 16, 4})));
  const ProcessResult result = slice(part, "cura-engine",
                                     {"--config", cura_definition(), "--config", settings, "--as",
                                      "modifiers", "--max-voids", "1", "--bridge", "1000"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const std::vector<ExtrusionMove> moves = extrusion_moves(read_bytes(output()));
  const auto in_layers = [&](double from, double to, const auto& look) {
    for (const ExtrusionMove& move : moves)
      if (move.z >= from && move.z <= to) look(move);
  };
  double left = 1e9, front = 1e9;
  in_layers(1, 3, [&](const ExtrusionMove& move) {
    left = std::min({left, move.x, move.from_x});
    front = std::min({front, move.y, move.from_y});
  });
  // Nothing is printed near the tower's axis.
  const double x = left + 8, y = front + 8;
  double nearest = 1e9;
  in_layers(7, 9, [&](const ExtrusionMove& move) {
    for (int i = 0; i <= 20; ++i) {
      const double t = i / 20.0;
      nearest = std::min(nearest, std::hypot(move.from_x + t * (move.x - move.from_x) - x,
                                             move.from_y + t * (move.y - move.from_y) - y));
    }
  });
  EXPECT_GT(nearest, 5);
}

}  // namespace
}  // namespace aerate::test
