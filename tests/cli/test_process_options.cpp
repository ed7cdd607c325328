#include <filesystem>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "tests/cli/job.h"
#include "tests/support/caught.h"

// --process: presets, what overrides them, files of the user's own, and limits that cannot be printed.
namespace aerate::test {
namespace {

using Json = nlohmann::json;

constexpr int kUsage = 2;
constexpr int kUnreadable = 3;
constexpr int kNothing = 5;

Mesh cube_of_40() {
  return make_box({0, 0, 0}, {40, 40, 40});
}

Json report_of(const Job& job, const std::vector<std::string>& arguments) {
  std::vector<std::string> command = job.hollow(job.input("cube.stl", cube_of_40()), arguments);
  command.insert(command.end(), {"--json", "-"});
  const ProcessResult result = run(command);
  EXPECT_EQ(result.exit_code, 0) << result.err;
  return result.exit_code == 0 ? Json::parse(result.out) : Json();
}

Json origin_of(const Json& report, const std::string& limit) {
  for (const Json& entry : report.at("process").at("limits"))
    if (entry.at("limit") == limit) return entry;
  ADD_FAILURE() << "no limit " << limit;
  return {};
}

void expect_refused(const Job& job, const std::vector<std::string>& arguments, int exit_code,
                    const std::vector<std::string>& said) {
  const ProcessResult result = run(job.hollow(job.input("cube.stl", cube_of_40()), arguments));
  EXPECT_EQ(result.exit_code, exit_code) << result.err;
  for (const std::string& part : said) EXPECT_TRUE(contains(result.err, part));
  EXPECT_EQ(entries_of(job.outputs()), std::vector<std::string>{});
}

TEST(ProcessOptions, ListNamesEveryFigureAndItsSource) {
  for (const char* command : {"hollow", "pack"}) {
    const ProcessResult result = run({AERATE_EXECUTABLE, command, "--process", "list"});
    EXPECT_EQ(result.exit_code, 0) << result.err;
    for (const char* part :
         {"fdm: ", "sla: ", "sls: ", "metal: ", "escape-hole", "Hubs", "Formlabs", "overhang"})
      EXPECT_TRUE(contains(result.out, part));
  }
}

// Which processes have no such limit, in the help as in the list.
TEST(ProcessOptions, HelpAndListAgreeOnCeilings) {
  const std::string help = run({AERATE_EXECUTABLE, "hollow", "--help"}).out;
  EXPECT_TRUE(contains(help, "none for sls; ceilings are limited where"));          // --overhang
  EXPECT_TRUE(contains(help, "none for sla and sls; ceilings are limited where"));  // --bridge
  const std::string list = run({AERATE_EXECUTABLE, "hollow", "--process", "list"}).out;
  const auto has = [&](const std::string& process, const std::string& limit) {
    const std::size_t begin = list.find(process + ": ");
    const std::size_t next = list.find("\n", list.find("escape-hole", begin));
    return list.substr(begin, next - begin).find("\n  " + limit + " ") != std::string::npos;
  };
  EXPECT_TRUE(has("sla", "overhang"));
  EXPECT_FALSE(has("sla", "bridge"));
  EXPECT_FALSE(has("sls", "overhang"));
  EXPECT_FALSE(has("sls", "bridge"));
  EXPECT_TRUE(has("metal", "overhang"));
  EXPECT_TRUE(has("metal", "bridge"));
}

TEST(ProcessOptions, WithoutAnyItIsFdm) {
  const Job job;
  const Json report = report_of(job, {});
  EXPECT_EQ(report["process"]["name"], "fdm");
  EXPECT_EQ(report["limits"]["wall_mm"], 1.2);
  EXPECT_EQ(origin_of(report, "wall")["origin"], "default of fdm");
  EXPECT_EQ(report["material"]["name"], "PLA");
  // But for what the voids cost a sparse print.
  ASSERT_EQ(report["notices"].size(), 1U);
  EXPECT_TRUE(contains(report["notices"][0], "at 15 % infill this print takes"));
}

TEST(ProcessOptions, VoidsGetRoofsWhereTheProcessLimitsCeilings) {
  const Job job;
  const Json wide = report_of(job, {"--max-radius", "9"});
  EXPECT_EQ(wide["limits"]["overhang_degrees"], 45);
  EXPECT_NEAR(wide["limits"]["bridge_mm"].get<double>(), 5, 1e-12);
  EXPECT_EQ(origin_of(wide, "bridge")["origin"], "default of fdm");
  EXPECT_EQ(wide["process"]["up"]["direction"], "+z");
  EXPECT_EQ(wide["process"]["up"]["origin"], "default");
  EXPECT_GE(wide["ceilings"]["roofs"], 1);
  EXPECT_EQ(wide["ceilings"]["flatter_than_degrees"], 50);
  EXPECT_LE(wide["ceilings"]["widest_mm"], 5.05);
  EXPECT_GE(report_of(job, {})["ceilings"]["roofs"], 1);
  EXPECT_EQ(report_of(job, {"--max-radius", "3.53"})["ceilings"]["roofs"], 0);
  EXPECT_GE(report_of(job, {"--process", "metal"})["ceilings"]["roofs"], 1);
  for (const char* process : {"sla", "sls"}) {
    const Json report = report_of(job, {"--process", process});
    EXPECT_EQ(report["ceilings"], nullptr) << process;
    EXPECT_EQ(report["limits"]["bridge_mm"], nullptr) << process;
  }
}

TEST(ProcessOptions, OverhangBridgeAndDirectionCanBeGiven) {
  const Job job;
  const auto config = job.input("aerate.toml", "up = \"-y\"\nbridge = 8\n");
  const Json report = report_of(job, {"--max-radius", "9", "--overhang", "30", "--config", config});
  EXPECT_EQ(origin_of(report, "overhang")["value"], 30);
  EXPECT_EQ(origin_of(report, "overhang")["origin"], "command line");
  EXPECT_EQ(origin_of(report, "bridge")["origin"], "configuration file");
  EXPECT_EQ(report["process"]["up"]["direction"], "-y");
  EXPECT_EQ(report["process"]["up"]["origin"], "configuration file");
  EXPECT_EQ(report["limits"]["up"], Json::array({0, -1, 0}));
  EXPECT_LE(report["ceilings"]["widest_mm"], 8.05);
  EXPECT_GE(report["ceilings"]["roofs"], 1);
  const Json free = report_of(job, {"--max-radius", "9", "--bridge", "20"});
  EXPECT_EQ(free["ceilings"]["roofs"], 0);
  EXPECT_EQ(
      report_of(job, {"--process", "sls", "--overhang", "45", "--bridge", "3"})["limits"]["overhang_degrees"],
      45);
}

TEST(ProcessOptions, LimitsForCeilingsThatMakeNoRoofAreRefused) {
  const Job job;
  expect_refused(job, {"--overhang", "90"}, kUsage, {"90 degrees from the vertical"});
  expect_refused(job, {"--overhang", "0"}, kUsage, {"--overhang"});
  expect_refused(job, {"--bridge", "-1"}, kUsage, {"--bridge"});
  expect_refused(job, {"--up", "0,0,0"}, kUsage, {"no direction", "x,y,z"});
  expect_refused(job, {"--up", "sideways"}, kUsage, {"no direction"});
  expect_refused(job, {"--process", "sls", "--bridge", "5"}, kUsage, {"sls", "--overhang"});
  expect_refused(job, {"--packing", "hexagonal", "--max-radius", "5"}, kUsage,
                 {"no room for roofs", "--max-radius 3.53", "--bridge 10"});
  expect_refused(job, {"--packing", "hexagonal", "--max-radius", "3", "--effort", "best"}, kUsage,
                 {"--effort best is for adaptive", "leave out --packing hexagonal"});
  expect_refused(job, {"--effort", "great"}, kUsage, {"--effort", "best"});
  const auto without_roofs = job.input("spheres.csv", "x,y,z,radius,kind\n20,20,28,9.5,adaptive\n");
  expect_refused(job, {"--spheres", without_roofs, "--max-radius", "10"}, kUnreadable,
                 {"with the roofs that", "--bridge"});
}

TEST(ProcessOptions, ALatticeIsMadeOfSpheresThatNeedNoRoofUnlessTheirSizeIsGiven) {
  const Job job;
  const Json report = report_of(job, {"--packing", "hexagonal"});
  EXPECT_EQ(report["limits"]["max_radius_mm"], 3.53);
  EXPECT_TRUE(contains(report["process"].dump(), "the largest of a lattice that need no roof"));
  EXPECT_EQ(report["ceilings"]["roofs"], 0);
  EXPECT_GE(report["voids"]["count"], 1);
  const Json wide = report_of(job, {"--packing", "hexagonal", "--bridge", "12"});
  EXPECT_EQ(wide["limits"]["max_radius_mm"], 8.48);
}

TEST(ProcessOptions, WhereOnlyTheRoofFindsNoRoomTheErrorSaysSo) {
  const Job job;
  // The cube of 40 mm holds a ball of 18.8 mm beside the wall, and no roof above it.
  expect_refused(job, {"--min-radius", "18.5"}, kNothing, {"18.8 mm fits", "without the roof", "--bridge"});
}

TEST(ProcessOptions, WhatStandsIsSeenInTheDirectionOfThePrint) {
  const Job job;
  const Json upright = report_of(job, {"--max-radius", "9"});
  const Json lying = report_of(job, {"--max-radius", "9", "--up", "1,0,0"});
  // A cube stands on any of its faces.
  const auto margin = [](const Json& report) {
    return report["strength_and_balance"]["footing_margin_before_mm"].get<double>();
  };
  EXPECT_NEAR(margin(upright), 20, 1e-6);
  EXPECT_NEAR(margin(lying), 20, 1e-6);
  EXPECT_EQ(report_of(job, {"--max-radius", "9", "--up",
                            "1,1,1"})["strength_and_balance"]["footing_margin_before_mm"],
            nullptr);
}

TEST(ProcessOptions, APresetSetsItsLimitsAndSaysThatSealedVoidsTrapMaterial) {
  const Job job;
  const Json report = report_of(job, {"--process", "sla", "--no-drain", "--shape", "spheres"});
  EXPECT_EQ(report["limits"]["wall_mm"], 2.0);
  EXPECT_EQ(report["limits"]["gap_mm"], 1.0);
  EXPECT_EQ(report["limits"]["min_radius_mm"], 2.5);
  EXPECT_EQ(report["limits"]["max_radius_mm"], 10.0);
  EXPECT_GE(report["measured"]["wall_mm"], 2.0);
  EXPECT_EQ(report["material"]["name"], "resin");
  EXPECT_TRUE(contains(report["notices"].dump(), "sealed"));
  EXPECT_TRUE(contains(origin_of(report, "wall")["source"].get<std::string>(), "i.materialise"));
}

TEST(ProcessOptions, EveryLimitCanBeOverriddenAndTheReportSaysByWhat) {
  const Job job;
  const auto config = job.input("aerate.toml", "wall = 3\ngap = 2\n");
  const Json report = report_of(job, {"--process", "sls", "--config", config, "--wall", "2.5", "--min-radius",
                                      "3.5", "--material", "PETG"});
  EXPECT_EQ(report["limits"]["wall_mm"], 2.5);
  EXPECT_EQ(origin_of(report, "wall")["origin"], "command line");
  EXPECT_EQ(report["limits"]["gap_mm"], 2.0);
  EXPECT_EQ(origin_of(report, "gap")["origin"], "configuration file");
  EXPECT_EQ(origin_of(report, "min-radius")["origin"], "command line");
  EXPECT_EQ(origin_of(report, "max-radius")["origin"], "of cells of 33 mm, default of sls");
  EXPECT_EQ(report["material"]["name"], "PETG");

  const ProcessResult text = run(job.hollow(job.folder() / "cube.stl", {"--wall", "2.5"}));
  EXPECT_TRUE(contains(text.out, "wall 2.5 mm (command line)"));
  EXPECT_TRUE(contains(text.out, "(default of fdm)"));
}

TEST(ProcessOptions, AProcessOfTheUsersOwn) {
  const Job job;
  const auto file = job.input("mine.json",
                              R"({"base": "sla", "title": "bench-top resin", "wall": 1.5,
                                  "gap": {"value": 0.8, "source": "data sheet"}, "least-wall": 0.4})");
  const Json report = report_of(job, {"--process", file});
  EXPECT_EQ(report["process"]["name"], "mine");
  EXPECT_EQ(report["limits"]["wall_mm"], 1.5);
  EXPECT_EQ(report["limits"]["gap_mm"], 0.8);
  EXPECT_EQ(report["limits"]["max_radius_mm"], (33 - 0.8) / 2);
  EXPECT_EQ(origin_of(report, "gap")["source"], "mine.json: data sheet");
  EXPECT_TRUE(report["process"]["drainage_needed"].get<bool>());
}

// The base's cells would be larger than what the file says of voids.
TEST(ProcessOptions, AProcessFileSaysHowLargeCellsAre) {
  const Job job;
  const auto largest = [&](const std::string& file) {
    const Json report = report_of(job, {"--process", job.input("mine.json", file), "--no-drain"});
    return report["limits"]["max_radius_mm"].get<double>();
  };
  EXPECT_EQ(largest(R"({"base": "sla", "max-radius": 7})"), 7);
  EXPECT_EQ(largest(R"({"base": "sla", "cell-size": 15})"), 7);
  EXPECT_EQ(largest(R"({"base": "sla", "max-radius": 9, "cell-size": 15})"), 7);
}

// A configuration folder with these process files, and the environment that says so.
std::vector<std::pair<std::string, std::string>> configured(
    const Job& job, const std::vector<std::pair<std::string, std::string>>& files) {
  const auto folder = job.folder() / "config";
  std::filesystem::create_directories(folder / "aerate" / "processes");
  for (const auto& [name, text] : files) job.input("config/aerate/processes/" + name, text);
  return {{"XDG_CONFIG_HOME", folder.string()}};
}

TEST(ProcessOptions, AProcessOfTheUsersOwnIsFoundByItsName) {
  const Job job;
  const auto environment =
      configured(job, {{"mine.json", R"({"base": "sls", "wall": 1.5})"}, {"fdm.json", R"({"wall": 9})"}});
  const auto model = job.input("cube.stl", cube_of_40());
  const auto wall_of = [&](const std::string& name, const auto& variables) {
    const ProcessResult result =
        run(job.hollow(model, {"--process", name, "--no-drain", "--json", "-"}), variables);
    EXPECT_EQ(result.exit_code, 0) << result.err;
    return result.exit_code == 0 ? Json::parse(result.out)["limits"]["wall_mm"].get<double>() : 0;
  };
  EXPECT_EQ(wall_of("mine", environment), 1.5);
  EXPECT_EQ(wall_of("fdm", environment), 1.2);  // the built-in one goes first
  EXPECT_EQ(wall_of(job.folder() / "config/aerate/processes/fdm.json", environment), 9);
  // Without that variable, or with one that is no full path, it is ~/.config.
  std::filesystem::create_directories(job.folder() / ".config");
  std::filesystem::rename(job.folder() / "config/aerate", job.folder() / ".config/aerate");
  const std::string home = job.folder();
  EXPECT_EQ(wall_of("mine", std::vector<std::pair<std::string, std::string>>{{"XDG_CONFIG_HOME", "config"},
                                                                             {"HOME", home}}),
            1.5);
  const ProcessResult inspected =
      run({AERATE_EXECUTABLE, "inspect", "--drainage", "--process", "mine", model},
          {{"XDG_CONFIG_HOME", ""}, {"HOME", home}});
  EXPECT_EQ(inspected.exit_code, 0) << inspected.err;
}

TEST(ProcessOptions, UnknownNamesAndBrokenFilesOfTheUsersOwn) {
  const Job job;
  const auto environment =
      configured(job, {{"broken.json", "{\"wall\": "}, {"walls.json", R"({"walls": 1})"}});
  const auto model = job.input("cube.stl", cube_of_40());
  const auto refused = [&](const std::string& name, int exit_code, const std::vector<std::string>& said) {
    const ProcessResult result = run(job.hollow(model, {"--process", name}), environment);
    EXPECT_EQ(result.exit_code, exit_code) << result.err;
    for (const std::string& part : said) EXPECT_TRUE(contains(result.err, part));
    EXPECT_EQ(entries_of(job.outputs()), std::vector<std::string>{});
  };
  refused("laser", kUsage, {"laser", "fdm, sla, sls, metal", "config/aerate/processes"});
  refused("broken", kUnreadable, {"config/aerate/processes/broken.json", "JSON"});
  refused("walls", kUsage, {"config/aerate/processes/walls.json", "unknown key \"walls\""});
  // They are in nobody else's way.
  EXPECT_EQ(run(job.hollow(model, {"--process", "fdm"}), environment).exit_code, 0);
}

TEST(ProcessOptions, TheProcessFileThatANameChoosesIsNeverReplaced) {
  const Job job;
  const auto environment = configured(job, {{"mine.json", R"({"wall": 1.5})"}});
  const std::string file = job.folder() / "config/aerate/processes/mine.json";
  const ProcessResult result = run(
      job.hollow(job.input("cube.stl", cube_of_40()), {"--process", "mine", "--json", file}), environment);
  EXPECT_EQ(result.exit_code, kUsage) << result.err;
  EXPECT_TRUE(contains(result.err, "process file"));
}

TEST(ProcessOptions, TheListHasTheUsersOwnAfterTheBuiltInOnes) {
  const Job job;
  const auto list = [](const auto& variables) {
    const ProcessResult result = run({AERATE_EXECUTABLE, "hollow", "--process", "list"}, variables);
    EXPECT_EQ(result.exit_code, 0) << result.err;
    return result.out;
  };
  const auto environment =
      configured(job, {{"mine.json", R"({"title": "the bench-top printer", "wall": 1.5})"},
                       {"broken.json", "{\"wall\": "},
                       {"thin.json", R"({"wall": 0.1})"},
                       {"fdm.json", R"({"wall": 9})"},
                       {"notes.txt", "no process"}});
  const std::string text = list(environment);
  const std::size_t mine = text.find("\nmine: the bench-top printer;");
  ASSERT_NE(mine, std::string::npos) << text;
  EXPECT_LT(text.find("\nmetal: "), mine);
  const auto folder = job.folder() / "config/aerate/processes";
  for (const std::string& part :
       {"  file           " + (folder / "mine.json").string(), std::string("1.5 mm: mine.json"),
        "broken: broken: " + (folder / "broken.json").string() + ": not JSON",
        std::string("thin: broken: thin: wall 0.1 mm"),
        std::string("fdm: the built-in process of this name")})
    EXPECT_TRUE(contains(text, part));
  EXPECT_FALSE(text.find("notes") != std::string::npos);
  // What is no folder is told, and the built-in ones are there all the same.
  std::filesystem::remove_all(folder);
  job.input("config/aerate/processes", "a file");
  const std::string without = list(environment);
  EXPECT_TRUE(contains(without, folder.string() + ": process files cannot be looked for"));
  EXPECT_TRUE(contains(without, "metal: "));
  std::filesystem::remove(folder);
  EXPECT_FALSE(list(environment).find("config") != std::string::npos);
}

TEST(ProcessOptions, LimitsThatTheProcessCannotPrint) {
  const Job job;
  expect_refused(job, {"--process", "fdm", "--gap", "0.3"}, kUsage,
                 {"gap 0.3 mm", "0.45 mm", "extrusion line"});
  expect_refused(job, {"--process", "fdm", "--wall", "0.3"}, kUsage, {"wall 0.3 mm", "nozzle"});
  expect_refused(job, {"--process", "metal", "--wall", "0.3"}, kUsage, {"wall 0.3 mm", "metal"});
  // Who names no process may want it for something else.
  EXPECT_EQ(run(job.hollow(job.folder() / "cube.stl", {"--gap", "0.3"})).exit_code, 0);
}

TEST(ProcessOptions, UnknownProcesses) {
  const Job job;
  expect_refused(job, {"--process", "laser"}, kUsage, {"laser", "fdm, sla, sls, metal"});
  expect_refused(job, {"--process", "./nowhere.json"}, kUnreadable, {"nowhere.json"});
  expect_refused(job, {"--process", job.input("broken.json", "{\"wall\": ")}, kUnreadable,
                 {"broken.json", "JSON"});
}

TEST(ProcessOptions, ContradictionsInAProcessFile) {
  const Job job;
  const auto refused = [&](const std::string& content, const std::vector<std::string>& said) {
    expect_refused(job, {"--process", job.input("own.json", content)}, kUsage, said);
  };
  refused(R"({"min-radius": 4, "max-radius": 3})", {"min-radius 4 mm", "max-radius 3 mm"});
  refused(R"({"wall": 0.2})", {"wall 0.2 mm", "0.4 mm"});
  refused(R"({"walls": 1})", {"unknown key \"walls\""});
  refused(R"({"wall": "thick"})", {"\"wall\" is not a number"});
  refused(R"({"wall": -1})", {"-1", "out of range"});
  refused(R"({"gap": {"source": "nobody"}})", {"\"gap\""});
  refused(R"({"base": "laser"})", {"laser"});
  refused(R"({"base": "sls", "bridge": 3})", {"both \"overhang\" and \"bridge\"", "no \"overhang\""});
  refused(R"({"base": "sls", "overhang": 45})", {"no \"bridge\""});
  refused(R"({"drainage": "yes"})", {"drainage"});
  refused(R"({"material": "unobtainium"})", {"unobtainium"});
  refused("[1, 2]", {"one JSON object"});
}

}  // namespace
}  // namespace aerate::test
