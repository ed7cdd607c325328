#include <algorithm>
#include <chrono>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <string>
#include <sys/stat.h>
#include <thread>
#include <vector>

#include "printing/slicers/slicers.h"
#include "tests/slicer/fake_slicer.h"
#include "tests/support/binary_stl.h"
#include "tests/support/caught.h"
#include "tests/support/files.h"
#include "tests/support/process.h"
#include "tests/support/shapes.h"
#include "tests/support/temporary_folder.h"

// `aerate hook` with a program that stands for the slicer: what it does with the file it was given.
namespace aerate::test {
namespace {

namespace fs = std::filesystem;
using Environment = std::vector<std::pair<std::string, std::string>>;

void wait_for(const fs::path& file) {
  for (int i = 0; i < 6000 && (!fs::exists(file) || fs::file_size(file) == 0); ++i)
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
}

// Gone, or a zombie that nobody has asked for yet.
bool ends_within(pid_t process, std::chrono::milliseconds time) {
  constexpr std::chrono::milliseconds kStep{10};
  for (; time.count() > 0; time -= kStep) {
    std::ifstream status("/proc/" + std::to_string(process) + "/stat");
    std::string text;
    std::getline(status, text);
    if (text.empty() || text.find(") Z ") != std::string::npos) return true;
    std::this_thread::sleep_for(kStep);
  }
  return false;
}

// Without the block that the hook puts in.
std::string without_comments(std::string gcode) {
  constexpr std::string_view kBegin = "; aerate = begin\n", kEnd = "; aerate = end\n";
  const std::size_t begin = gcode.find(kBegin), end = gcode.find(kEnd);
  if (begin != std::string::npos) gcode.erase(begin, end + kEnd.size() - begin);
  return gcode;
}

class Hook : public testing::Test {
 protected:
  Hook() : fake_(folder_) {
    fs::create_directory(scratch());
    fs::create_directory(folder_.path() / "print");
    model_ = folder_.write("block.stl", to_binary_stl(make_box({0, 0, 0}, {20, 20, 20})));
    fake_.hands_out("solid", fake_gcode(1000));
    fake_.hands_out("voids", fake_gcode(900));
    fake_.hands_out("modifiers", fake_gcode(800));
    write_gcode(fake_gcode(1000));
  }

  fs::path scratch() const { return folder_.path() / "scratch"; }
  fs::path gcode() const { return folder_.path() / "print" / name_; }

  void write_gcode(const std::string& text) {
    before_ = text;
    std::ofstream(gcode(), std::ios::binary) << text;
  }

  std::vector<std::string> command(const std::vector<std::string>& options) const {
    std::vector<std::string> all{AERATE_EXECUTABLE, "hook"};
    all.insert(all.end(), options.begin(), options.end());
    all.push_back(gcode());
    return all;
  }
  std::vector<std::string> with_model() const {
    // Spheres, which are quicker than cells.
    return {"--model",      model_,    "--slicer-path", fake_.program(),
            "--shape",      "spheres", "--max-radius",  "5",
            "--min-radius", "2"};
  }
  ProcessResult hook(const std::vector<std::string>& options, Environment environment = {}) const {
    if (std::ranges::count(environment, "TMPDIR", &Environment::value_type::first) == 0)
      environment.emplace_back("TMPDIR", scratch());
    return run(command(options), environment);
  }

  // The file is as it was, one line says why, and nothing is left behind.
  std::string expect_error(const ProcessResult& result, int exit_code) const {
    EXPECT_EQ(result.exit_code, exit_code) << result.err;
    EXPECT_EQ(read_bytes(gcode()), before_);
    EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
    EXPECT_TRUE(result.err.starts_with("aerate: error: ")) << result.err;
    expect_nothing_left();
    return result.err;
  }
  // With --strict; without it the slicer hears of no error, and gets its print back, but for a block of comments if it
  // can hold one. The message of the error.
  std::string expect_refused(std::vector<std::string> options, int exit_code,
                             const Environment& environment = {}) {
    const ProcessResult lenient = hook(options, environment);
    EXPECT_EQ(lenient.exit_code, 0) << lenient.err;
    EXPECT_EQ(without_comments(read_bytes(gcode())), without_comments(before_));
    EXPECT_EQ(std::count(lenient.err.begin(), lenient.err.end(), '\n'), 1) << lenient.err;
    EXPECT_TRUE(lenient.err.starts_with("aerate: note: the print stays as it is: ")) << lenient.err;
    expect_nothing_left();
    write_gcode(before_);
    options.push_back("--strict");
    const ProcessResult strict = hook(options, environment);
    std::string why = expect_error(strict, exit_code);
    // For bench/bench_hook_refusals.
    RecordProperty("refusal_" + std::to_string(++refusals_), std::to_string(exit_code) + " " + why);
    return why;
  }
  void expect_nothing_left() const {
    EXPECT_EQ(entries_of(scratch()), std::vector<std::string>{});
    EXPECT_EQ(entries_of(gcode().parent_path()), std::vector<std::string>{name_});
  }

  TemporaryFolder folder_;
  FakeSlicer fake_;
  fs::path model_;
  std::string name_ = "part.gcode.pp";
  std::string before_;
  int refusals_ = 0;
};

TEST_F(Hook, ReplacesTheGcodeByTheBestForm) {
  ::chmod(gcode().c_str(), 0640);
  const ProcessResult result = hook(with_model());
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(result.err, "");
  const std::string after = read_bytes(gcode());
  EXPECT_DOUBLE_EQ(figures_of(after, prusa_slicer()).filament_mm.value(), 800);
  EXPECT_TRUE(contains(after, "; aerate_result = modifiers\n"));
  EXPECT_TRUE(contains(after, "; aerate_filament_mm = 800.00 (solid 1000.00)\n"));
  // The first line stays the first, and the settings end the file.
  EXPECT_TRUE(after.starts_with("; generated by PrusaSlicer"));
  EXPECT_TRUE(after.ends_with("; prusaslicer_config = end\n"));
  EXPECT_LT(after.find("; aerate = end"), after.find("; prusaslicer_config = begin"));
  struct stat facts {};
  ASSERT_EQ(::stat(gcode().c_str(), &facts), 0);
  EXPECT_EQ(facts.st_mode & 0777, 0640u);
  expect_nothing_left();
}

TEST_F(Hook, KeepsThePostProcessingLineThatItBlankedForTheSlicer) {
  std::string blanked = fake_gcode(800);
  const std::string line = "; post_process = \"aerate hook\"\n";
  blanked.replace(blanked.find(line), line.size(), "; post_process = \n");
  fake_.hands_out("modifiers", blanked);
  ASSERT_EQ(hook(with_model()).exit_code, 0);
  EXPECT_EQ(setting_in(read_bytes(gcode()), "post_process").value(), "\"aerate hook\"");
}

TEST_F(Hook, BlanksPostProcessingForTheSlicer) {
  fake_.behave("printf '%s|' \"$@\" > '" + (folder_.path() / "arguments").string() + "'");
  ASSERT_EQ(hook(with_model()).exit_code, 0);
  EXPECT_TRUE(contains(read_bytes(folder_.path() / "arguments"), "|--post-process||"));
}

// From 2.8 on meshes are arranged and 3MF stays where its coordinates are, and binary G-code may be switched on.
TEST_F(Hook, TellsANewerSlicerWhereTheModelIsAndToWriteText) {
  const auto arguments = [&](const std::string& version) {
    fs::remove(fake_.folder() / "arguments");
    fake_.behave(FakeSlicer::as_version(version));
    write_gcode(fake_gcode(1000));
    EXPECT_EQ(hook(with_model()).exit_code, 0);
    EXPECT_TRUE(contains(read_bytes(gcode()), "; aerate_result = modifiers\n"));
    return read_bytes(fake_.folder() / "arguments");
  };
  const std::string newer = arguments("2.9.4");
  EXPECT_EQ(std::ranges::count(newer, '\n'), 3);
  std::size_t told = 0;
  for (std::size_t at = 0;
       (at = newer.find("|--dont-arrange|--center|125,105|--binary-gcode=0|", at)) != std::string::npos; ++at)
    ++told;
  EXPECT_EQ(told, 3u) << newer;
  const std::string older = arguments("2.7.4");
  EXPECT_FALSE(contains(older, "--center"));
  EXPECT_TRUE(contains(older, "|--binary-gcode=0|"));
}

// By the settings in the G-code.
TEST_F(Hook, PutsTheModelInTheMiddleOfThePrintsBed) {
  fake_.behave(FakeSlicer::as_version("2.9.4"));
  std::string print = fake_gcode(1000);
  const std::string line = "; layer_height";
  print.insert(print.find(line), "; bed_shape = 10x0,190x0,190x180,10x180\n");
  write_gcode(print);
  ASSERT_EQ(hook(with_model()).exit_code, 0);
  EXPECT_TRUE(contains(read_bytes(fake_.folder() / "arguments"), "|--center|100,90|"));
}

TEST_F(Hook, FindsAModelThatWasMovedOnThePlate) {
  fs::create_directory(fake_.folder() / "moved");
  for (const auto& [form, filament] : {std::pair("solid", 1000.0), {"voids", 900.0}, {"modifiers", 800.0}})
    fake_.hands_out(std::string("moved/") + form, fake_gcode(filament, 30));
  fake_.behave(FakeSlicer::as_version("2.9.4") +
               "case \"$*\" in *'--center 155,105 '*) cp \"$(dirname \"$0\")\"/moved/* \"$(dirname "
               "\"$0\")\";; esac\n");
  write_gcode(fake_gcode(1000, 30));
  const ProcessResult result = hook(with_model());
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_TRUE(contains(read_bytes(gcode()), "; aerate_result = modifiers\n"));
}

TEST_F(Hook, LeavesTheMovesWhenNoFormTakesLess) {
  fake_.hands_out("voids", fake_gcode(1200));
  fake_.hands_out("modifiers", fake_gcode(1000));
  const ProcessResult result = hook(with_model());
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const std::string after = read_bytes(gcode());
  EXPECT_TRUE(contains(after, "; aerate_result = unchanged\n"));
  EXPECT_EQ(without_comments(after), before_);
}

TEST_F(Hook, VoidsThatAreHopelessInTheSparsePrintAreNotSliced) {
  std::string sparse = fake_gcode(1000);
  sparse.replace(sparse.find("60%"), 3, "15%");
  fake_.hands_out("solid", sparse);
  fake_.hands_out("voids", "not G-code: slicing it would fail");
  write_gcode(sparse);
  auto options = with_model();
  options.insert(options.end(), {"--json", "-"});
  const ProcessResult result = hook(options);
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const auto report = nlohmann::json::parse(result.out);
  EXPECT_EQ(report["result"], "modifiers");
  ASSERT_EQ(report["not_sliced"].size(), 1u);
  EXPECT_EQ(report["not_sliced"][0]["form"], "voids");
  EXPECT_GT(report["not_sliced"][0]["predicted_percent"], 10);
}

TEST_F(Hook, ObeysTheFormAskedFor) {
  auto options = with_model();
  options.insert(options.end(), {"--as", "voids", "--json", "-"});
  const ProcessResult result = hook(options);
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const auto report = nlohmann::json::parse(result.out);
  EXPECT_EQ(report["schema"], "aerate.hook");
  EXPECT_EQ(report["result"], "voids");
  EXPECT_EQ(report["forms"].size(), 2u);
  EXPECT_DOUBLE_EQ(report["forms"][1]["filament_saved_percent"].get<double>(), 10);
}

TEST_F(Hook, OnlyAnnotatesWithoutAModel) {
  const ProcessResult result = hook({});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const std::string after = read_bytes(gcode());
  EXPECT_TRUE(contains(after, "; aerate_result = unchanged\n; aerate_remark = no model was given\n"));
  EXPECT_TRUE(contains(after, "; aerate_seconds = 317\n"));
  EXPECT_EQ(extrusion_moves(after).size(), extrusion_moves(before_).size());
  expect_nothing_left();
}

TEST_F(Hook, LeavesThePrintWhenNothingCanBeRemoved) {
  model_ = folder_.write("plate.stl", to_binary_stl(make_box({0, 0, 0}, {20, 20, 1})));
  const ProcessResult result = hook(with_model());
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_TRUE(contains(read_bytes(gcode()), "; aerate_remark = plate.stl: nothing to remove"));
}

TEST_F(Hook, RefusesAModelThatDoesNotGiveTheGcode) {
  fake_.hands_out("solid", fake_gcode(1000, 2.5));
  const std::string message = expect_refused(with_model(), 3);
  EXPECT_TRUE(contains(message, "does not give the same G-code"));
}

TEST_F(Hook, KeepsTheFileIfTheModelDoesNotGiveAllItsCommands) {
  // As a colour change and a pause that were set in the slicer's window are.
  std::string text = fake_gcode(1000);
  text.insert(text.find("; filament used"), "M600\nG1 X20 Y30 E1\n");
  std::string plain = fake_gcode(1000);
  plain.insert(plain.find("; filament used"), "G1 X20 Y30 E1\n");
  write_gcode(text);
  fake_.hands_out("solid", plain);
  const std::string message = expect_refused(with_model(), 3);
  EXPECT_TRUE(contains(message, "\"M600\" after the layer at z = 0.00 mm, would be lost"));
  EXPECT_TRUE(contains(message, "hollow the model first"));
}

TEST_F(Hook, KeepsTheFileIfEveryHollowedPrintDoesLess) {
  std::string text = fake_gcode(1000);
  text.insert(text.find("; filament used"), "M104 S230\nG1 X20 Y10 E1\n");
  write_gcode(text);
  fake_.hands_out("solid", text);
  const std::string message = expect_refused(with_model(), 1);
  EXPECT_TRUE(contains(message, "\"M104 S230\""));
  EXPECT_TRUE(contains(message, "the print with voids") && contains(message, "the print with modifiers"));
  // Nothing was set in the slicer's window: the solid print has it all.
  EXPECT_FALSE(contains(message, "slicer's window"));
}

TEST_F(Hook, LeavesOutAFormThatDoesLessAndTakesAnother) {
  // As supports inside a hollow bring labels that the original has not.
  std::string labelled = fake_gcode(700);
  labelled.insert(labelled.find("; filament used"), "; printing object a id:0 copy 0\nG1 X20 Y10 E1\n");
  fake_.hands_out("voids", labelled);
  const ProcessResult result = hook(with_model());
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const std::string after = read_bytes(gcode());
  EXPECT_TRUE(contains(after, "; aerate_result = modifiers\n"));
  EXPECT_TRUE(contains(after,
                       "; aerate_remark = the print with voids does not do all that the G-code does "
                       "(\"; printing object a id:0 copy 0\""));
  expect_nothing_left();
}

TEST_F(Hook, SaysWhichFormWasLeftOutIfTheOtherSavesNothing) {
  std::string paused = fake_gcode(700);
  paused.insert(paused.find("; filament used"), "M601\nG1 X20 Y10 E1\n");
  fake_.hands_out("voids", paused);
  fake_.hands_out("modifiers", fake_gcode(1000));
  const ProcessResult result = hook(with_model());
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const std::string after = read_bytes(gcode());
  EXPECT_TRUE(contains(after, "; aerate_result = unchanged\n"));
  EXPECT_TRUE(
      contains(after, "; aerate_remark = no hollowed form takes less filament; the print with voids"));
}

TEST_F(Hook, RefusesTheFormAskedForIfItDoesLess) {
  std::string paused = fake_gcode(700);
  paused.insert(paused.find("; filament used"), "M601\nG1 X20 Y10 E1\n");
  fake_.hands_out("voids", paused);
  auto options = with_model();
  options.insert(options.end(), {"--as", "voids"});
  EXPECT_TRUE(contains(expect_refused(options, 1), "\"M601\""));
}

TEST_F(Hook, NoCharacterOfAModelsNameEndsAComment) {
  model_ = folder_.write("evil\nM104 S999 ; \x1b[2J.stl", to_binary_stl(make_box({0, 0, 0}, {20, 20, 1})));
  const ProcessResult result = hook(with_model());
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const std::string after = read_bytes(gcode());
  EXPECT_TRUE(contains(after, "; aerate_remark = evil\\x0AM104 S999 ; \\x1B[2J.stl: nothing to remove"));
  EXPECT_FALSE(contains(after, "\nM104 S999"));
}

TEST_F(Hook, TheSlicerSeesNoLineFeedInTheNameOfTheModel) {
  // It would put it into its G-code.
  model_ = folder_.write("a\nM999.stl", read_bytes(model_));
  fake_.behave("printf '%s|' \"$@\" > '" + (folder_.path() / "arguments").string() + "'");
  ASSERT_EQ(hook(with_model()).exit_code, 0);
  EXPECT_FALSE(contains(read_bytes(folder_.path() / "arguments"), "\n"));
}

TEST_F(Hook, RefusesGcodeThatIsCutOff) {
  fake_.hands_out("voids", fake_gcode(900).substr(0, 200));
  EXPECT_TRUE(contains(expect_refused(with_model(), 1), "wrote G-code whose end is missing"));
}

TEST_F(Hook, RefusesAFormThatTheSlicerPutElsewhere) {
  fake_.hands_out("modifiers", fake_gcode(800, 2.5));
  EXPECT_TRUE(contains(expect_refused(with_model(), 1), "elsewhere"));
}

TEST_F(Hook, RefusesAProcessThatPrintsNoFilament) {
  std::vector<std::string> options = with_model();
  options.insert(options.end(), {"--process", "sla"});
  options.emplace_back("--strict");
  const ProcessResult result = hook(options);
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_TRUE(contains(result.err, "process sla prints no filament"));
  EXPECT_EQ(read_bytes(gcode()), before_);
  expect_nothing_left();
}

TEST_F(Hook, OptionsThatContradictEachOtherCostNoPrint) {
  std::vector<std::string> options = with_model();
  options.insert(options.end(), {"--process", "sla"});
  const ProcessResult result = hook(options);
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_TRUE(contains(result.err, "the print stays as it is"));
  const std::string after = read_bytes(gcode());
  EXPECT_TRUE(contains(after, "; aerate_result = unchanged\n; aerate_remark = "));
  EXPECT_TRUE(contains(after, "process sla prints no filament"));
  EXPECT_TRUE(contains(after, before_.substr(0, before_.find('\n'))));
  expect_nothing_left();
}

TEST_F(Hook, SaysInTheGcodeWhyThePrintStaysAsItIs) {
  fake_.hands_out("solid", fake_gcode(1000, 2.5));
  ASSERT_EQ(hook(with_model()).exit_code, 0);
  const std::string after = read_bytes(gcode());
  EXPECT_TRUE(contains(after, "; aerate_result = unchanged\n; aerate_remark = "));
  EXPECT_TRUE(contains(after, "does not give the same G-code"));
  const ProcessResult again = hook({"--json", "-"});
  EXPECT_EQ(again.exit_code, 0) << again.err;  // has been through already
  EXPECT_EQ(read_bytes(gcode()), after);
}

TEST_F(Hook, FindsTheModelInAFolderByTheNameOfTheOutput) {
  const fs::path models = folder_.path() / "models";
  fs::create_directory(models);
  fs::copy_file(model_, models / "block.stl");
  fs::copy_file(model_, models / "blo.stl");
  fs::copy_file(model_, models / "other.stl");
  std::vector<std::string> options = with_model();
  options[0] = "--model-folder";
  options[1] = models;
  const ProcessResult result = hook(options, {{"SLIC3R_PP_OUTPUT_NAME", "/out/block_0.2mm_PLA.gcode"}});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_TRUE(contains(read_bytes(gcode()), "; aerate_result = modifiers\n"));
  write_gcode(fake_gcode(1000));
  EXPECT_TRUE(contains(expect_refused(options, 3, {{"SLIC3R_PP_OUTPUT_NAME", "/out/cube_0.2mm.gcode"}}),
                       "no model is called as the print is ('cube_0.2mm.gcode')"));
  options[1] = models / "none";
  EXPECT_TRUE(contains(expect_refused(options, 3), "--model-folder"));
}

TEST_F(Hook, PutsTheSavingIntoTheNameOfTheOutputWhereAsked) {
  const Environment named{{"SLIC3R_PP_OUTPUT_NAME", "/out/part_0.2mm.gcode"}};
  ASSERT_EQ(hook(with_model(), named).exit_code, 0);
  expect_nothing_left();
  write_gcode(fake_gcode(1000));
  std::vector<std::string> options = with_model();
  options.push_back("--name-saving");
  ASSERT_EQ(hook(options, named).exit_code, 0);
  const fs::path name = gcode().string() + ".output_name";
  EXPECT_EQ(read_bytes(name), "part_0.2mm_aerate-20pct.gcode\n");
  fs::remove(name);
  // Nothing is saved, and without a slicer's name there is none to change.
  write_gcode(fake_gcode(1000));
  ASSERT_EQ(hook(options).exit_code, 0);
  fake_.hands_out("voids", fake_gcode(1200));
  fake_.hands_out("modifiers", fake_gcode(1000));
  write_gcode(fake_gcode(1000));
  ASSERT_EQ(hook(options, named).exit_code, 0);
  expect_nothing_left();
}

TEST_F(Hook, KeepsALog) {
  const fs::path log = folder_.path() / "aerate.log";
  std::vector<std::string> options = with_model();
  options.insert(options.end(), {"--log", log});
  ASSERT_EQ(hook(options).exit_code, 0);
  write_gcode(std::string("GCDE\1\0\0\0\0\0", 10));
  ASSERT_EQ(hook(options).exit_code, 0);
  const std::string text = read_bytes(log);
  EXPECT_TRUE(contains(text, "result      modifiers\n"));
  EXPECT_LT(text.find("result      modifiers\n"), text.find("the print stays as it is"));
  EXPECT_TRUE(contains(text, "binary G-code"));
}

TEST_F(Hook, RefusesAModelThatCannotBeHollowed) {
  Mesh open = make_box({0, 0, 0}, {20, 20, 20});
  open.triangles.pop_back();
  model_ = folder_.write("block.stl", to_binary_stl(open));
  const std::string message = expect_refused(with_model(), 4);
  EXPECT_TRUE(contains(message, "open") || contains(message, "hole")) << message;
}

TEST_F(Hook, RefusesBinaryGcode) {
  write_gcode(std::string("GCDE\1\0\0\0\0\0", 10));
  EXPECT_TRUE(contains(expect_refused(with_model(), 3), "switch off \"Supports binary G-code\""));
}

TEST_F(Hook, RefusesWhatIsNoGcodeOfASlicer) {
  write_gcode("G1 X1 Y1 E1\n");
  EXPECT_TRUE(contains(expect_refused({}, 3), "not G-code of a slicer"));
  write_gcode("");
  expect_refused({}, 3);
}

TEST_F(Hook, RefusesGcodeThatItHasBeenThrough) {
  ASSERT_EQ(hook({}).exit_code, 0);
  before_ = read_bytes(gcode());
  EXPECT_TRUE(contains(expect_refused({}, 3), "already"));
}

TEST_F(Hook, RefusesToBeCalledByTheSlicerThatItRuns) {
  EXPECT_TRUE(contains(expect_refused(with_model(), 2, {{"AERATE_SLICING", "1"}}), "aerate itself runs"));
  // And it tells that slicer.
  fake_.behave("[ \"$AERATE_SLICING\" = 1 ] || exit 9");
  EXPECT_EQ(hook(with_model()).exit_code, 0);
}

TEST_F(Hook, RefusesToResliceWithOrcaSlicer) {
  write_gcode(fake_gcode(1000, 0, "OrcaSlicer 2.1.1"));
  EXPECT_TRUE(contains(expect_refused(with_model(), 2), "OrcaSlicer 2.1.1 cannot be run again"));
}

TEST_F(Hook, RefusesWithoutTheSlicer) {
  EXPECT_TRUE(contains(expect_refused({"--model", model_}, 2, {{"PATH", folder_.path().string()}}),
                       "not on the search path"));
  EXPECT_TRUE(contains(expect_refused({"--model", model_, "--slicer-path", model_}, 2), "not a program"));
}

TEST_F(Hook, SaysWhichSlicerMadeTheGcodeIfThatIsWhatDiffers) {
  fake_.hands_out("solid", fake_gcode(1000, 2.5));
  write_gcode(fake_gcode(1000, 0, "PrusaSlicer 2.9.1"));
  const std::string message = expect_refused(with_model(), 3);
  EXPECT_TRUE(contains(message, "the G-code is by PrusaSlicer 2.9.1, and ")) << message;
  EXPECT_TRUE(contains(message, "is PrusaSlicer 2.5.0: give the program")) << message;
}

TEST_F(Hook, RefusesGcodeWithoutSettings) {
  std::string text = fake_gcode(1000);
  text.resize(text.find("; prusaslicer_config = begin"));
  write_gcode(text);
  EXPECT_TRUE(contains(expect_refused(with_model(), 3), "settings are not in it"));
}

TEST_F(Hook, RefusesOptionsInOneLine) {
  for (const std::vector<std::string>& options : {std::vector<std::string>{"--wal", "1"},
                                                  {"--wall", "-1"},
                                                  {"--strict", "--min-radius", "9", "--max-radius", "8"}})
    EXPECT_TRUE(contains(expect_error(hook(options), 2), "; ")) << options.front();
}

TEST_F(Hook, RefusesWithoutAPlaceForTemporaryFiles) {
  const std::string message = expect_refused(with_model(), 1, {{"TMPDIR", "/none"}});
  EXPECT_TRUE(contains(message, "temporary folder can be made in /none: No such file"));
}

TEST_F(Hook, KeepsThePicturesForThePrintersDisplay) {
  const std::string picture = "; thumbnail begin 16x16 8\n; iVBORw0K\n; thumbnail end\n";
  std::string text = fake_gcode(1000);
  text.insert(text.find('\n') + 1, "\n;\n" + picture + ";\n");
  write_gcode(text);
  ASSERT_EQ(hook(with_model()).exit_code, 0);
  const std::string after = read_bytes(gcode());
  EXPECT_TRUE(contains(after, "; aerate_result = modifiers\n"));
  EXPECT_TRUE(contains(after, picture));
}

TEST_F(Hook, RefusesAMissingModelAndAMissingFile) {
  expect_refused({"--model", folder_.path() / "none.stl", "--slicer-path", fake_.program()}, 3);
  const ProcessResult result = run({AERATE_EXECUTABLE, "hook", folder_.path() / "none.gcode"});
  EXPECT_EQ(result.exit_code, 3);
  EXPECT_TRUE(contains(result.err, "none.gcode"));
}

TEST_F(Hook, AnswersASlicerThatAsks) {
  fake_.behave("printf 'Continue(Y/N)?'; read answer; [ \"$answer\" = y ] || exit 0");
  EXPECT_EQ(hook(with_model()).exit_code, 0);
  EXPECT_TRUE(contains(read_bytes(gcode()), "; aerate_result = modifiers\n"));
}

TEST_F(Hook, RefusesWhenTheSlicerExitsWithoutGcode) {
  fake_.behave("echo 'Continue(Y/N)?'; exit 0");
  const std::string message = expect_refused(with_model(), 1);
  EXPECT_TRUE(contains(message, "wrote no G-code"));
  EXPECT_TRUE(contains(message, "Continue(Y/N)?"));
}

TEST_F(Hook, RefusesWhenTheSlicerFails) {
  fake_.behave("echo loading; echo slicing; echo 'no extrusions in the first layer' >&2; exit 7");
  const std::string message = expect_refused(with_model(), 1);
  EXPECT_TRUE(contains(message, "failed with status 7"));
  EXPECT_TRUE(contains(message, "no extrusions in the first layer"));
}

TEST_F(Hook, RefusesWhenTheSlicerCrashes) {
  fake_.behave("kill -SEGV $$");
  EXPECT_TRUE(contains(expect_refused(with_model(), 1), "failed with status 139"));
}

TEST_F(Hook, RefusesGcodeThatExtrudesNothing) {
  fake_.hands_out("voids", "; generated by PrusaSlicer\nG28\n");
  EXPECT_TRUE(contains(expect_refused(with_model(), 1), "extrudes nothing"));
}

TEST_F(Hook, TakesPathsWithBlanksAndQuotes) {
  fs::remove(gcode());
  name_ = "it's a \"part\" $HOME; (1).gcode";
  write_gcode(fake_gcode(1000));
  model_ = folder_.write("a 'block' & \"more\".stl", read_bytes(model_));
  const ProcessResult result = hook(with_model());
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_TRUE(contains(read_bytes(gcode()), "; aerate_result = modifiers\n"));
  expect_nothing_left();
}

TEST_F(Hook, InterruptionKillsTheSlicerAndLeavesTheFile) {
  const fs::path pid_file = folder_.path() / "pid";
  // A program that the slicer started is ended, too.
  fake_.behave("sleep 300 & echo $! > '" + pid_file.string() + "'; wait");
  Process process(command(with_model()), {{"TMPDIR", scratch()}});
  wait_for(pid_file);
  const pid_t sleeper = std::stoi(read_bytes(pid_file));
  process.send(SIGINT);
  const ProcessResult result = process.wait();
  EXPECT_EQ(result.exit_code, 130) << result.err;
  EXPECT_EQ(read_bytes(gcode()), before_);
  expect_nothing_left();
  EXPECT_TRUE(ends_within(sleeper, std::chrono::seconds(60)));
}

TEST_F(Hook, WhenItIsKilledTheSlicerEndsAndTheNextRunCleansUp) {
  const fs::path pid_file = folder_.path() / "pid";
  fake_.behave("sleep 300 & echo $! > '" + pid_file.string() + "'; wait");
  {
    Process process(command(with_model()), {{"TMPDIR", scratch()}});
    wait_for(pid_file);
    process.send(SIGKILL);
    EXPECT_EQ(process.wait().exit_code, 128 + SIGKILL);
  }
  EXPECT_TRUE(ends_within(std::stoi(read_bytes(pid_file)), std::chrono::seconds(60)));
  EXPECT_EQ(read_bytes(gcode()), before_);
  ASSERT_EQ(entries_of(scratch()).size(), 1u);
  // Of another kind, and not left by a process: both stay.
  fs::create_directory(scratch() / "aerate-other");
  fake_.behave("");
  ASSERT_EQ(hook(with_model()).exit_code, 0);
  EXPECT_EQ(entries_of(scratch()), std::vector<std::string>{"aerate-other"});
}

TEST_F(Hook, FoldersInUseStay) {
  const fs::path pid_file = folder_.path() / "pid";
  fake_.behave("echo $$ > '" + pid_file.string() + "'; exec sleep 300");
  Process process(command(with_model()), {{"TMPDIR", scratch()}});
  wait_for(pid_file);
  const std::vector<std::string> in_use = entries_of(scratch());
  ASSERT_EQ(in_use.size(), 1u);
  ASSERT_EQ(hook({}).exit_code, 0);  // makes a folder of its own, and removes it
  EXPECT_EQ(entries_of(scratch()), in_use);
  process.send(SIGTERM);
  EXPECT_EQ(process.wait().exit_code, 130);
}

TEST_F(Hook, PrintsTheLineToPaste) {
  const fs::path odd = folder_.write("it's a block.stl", "");
  const ProcessResult result =
      run({AERATE_EXECUTABLE, "hook", "--print-setup", "prusa-slicer", "--model", odd});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_TRUE(contains(result.out, " hook --model '" + folder_.path().string() + "/it'\\''s a block.stl'\n"));
  // A shell makes of it what was meant, with the file behind it.
  std::string line = result.out;
  line.pop_back();
  fs::rename(odd, model_);
  fs::copy_file(model_, odd, fs::copy_options::overwrite_existing);
  const ProcessResult shell = run({"/bin/sh", "-c", line + " '" + gcode().string() + "'"});
  EXPECT_EQ(shell.exit_code, 0);
  EXPECT_TRUE(contains(shell.err, "it's a block.stl"));
  EXPECT_EQ(without_comments(read_bytes(gcode())), before_);
}

TEST_F(Hook, PrintsNoLineThatCannotBePasted) {
  for (const char* name : {"a\nb.stl", "a;b.stl", "a\rb.stl", "a\x1b[2Jb.stl", "a\tb.stl", "a\x7f.stl"}) {
    const ProcessResult result =
        run({AERATE_EXECUTABLE, "hook", "--print-setup", "prusa-slicer", "--model", folder_.path() / name});
    EXPECT_EQ(result.exit_code, 2) << name;
    EXPECT_EQ(result.out, "");
    EXPECT_TRUE(contains(result.err, "rename it")) << result.err;
    EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
  }
}

TEST_F(Hook, SaysThatFuzzySkinIsRandom) {
  const auto with_skin = [](std::string text, const std::string& skin) {
    return text.insert(text.find("; layer_height"), "; fuzzy_skin = " + skin + "\n");
  };
  fake_.hands_out("solid", fake_gcode(1000, 0.05));
  write_gcode(with_skin(fake_gcode(1000), "external"));
  EXPECT_TRUE(contains(expect_refused(with_model(), 3), "fuzzy skin is random"));
  write_gcode(with_skin(fake_gcode(1000), "none"));
  EXPECT_FALSE(contains(expect_refused(with_model(), 3), "fuzzy skin"));
}

}  // namespace
}  // namespace aerate::test
