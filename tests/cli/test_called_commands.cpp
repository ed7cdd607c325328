#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <vector>

#include "cli/called_commands.h"
#include "core/error.h"
#include "files/formats.h"
#include "tests/support/caught.h"
#include "tests/support/shapes.h"
#include "tests/support/temporary_folder.h"

// What the Python module calls, without Python: sanitizers see it here.
namespace aerate::cli {
namespace {

using nlohmann::json;
using test::contains;
using test::message_of;

const CalledCommand& command(const std::string& name) {
  return *std::ranges::find(called_commands(), name, &CalledCommand::name);
}

class CalledCommands : public testing::Test {
 protected:
  CalledCommands() {
    for (const Vec3f& p : cube_.positions)
      for (const float coordinate : {p.x, p.y, p.z}) vertices_.push_back(coordinate);
    for (const Triangle& t : cube_.triangles) triangles_.insert(triangles_.end(), t.begin(), t.end());
    arrays_ = {vertices_, triangles_};
    write_mesh(cube_, file_, MeshFormat::stl);
  }

  CalledResult of_file(const char* name, const std::vector<std::string>& arguments) {
    return command(name).run({file_, nullptr, arguments}, monitor_);
  }
  CalledResult of_arrays(const char* name, const std::vector<std::string>& arguments) {
    return command(name).run({"cube", &arrays_, arguments}, monitor_);
  }
  std::string refusal(const char* name, const std::vector<std::string>& arguments) {
    return message_of<UsageError>([&] { of_file(name, arguments); });
  }

  const Mesh cube_ = test::make_box({0, 0, 0}, {20, 20, 20});
  std::vector<double> vertices_;
  std::vector<std::int64_t> triangles_;
  const test::TemporaryFolder folder_;
  const std::filesystem::path file_ = folder_.path() / "cube.stl";
  MeshArrays arrays_;
  Monitor monitor_;
};

TEST_F(CalledCommands, HaveTheOptionsOfTheProgramButForItsReport) {
  for (const CalledCommand& each : called_commands()) {
    std::set<std::string> names;
    for (const CalledOption& option : each.options()) names.insert(option.name);
    EXPECT_TRUE(names.contains("unit") && names.contains("config")) << each.name;
    EXPECT_FALSE(names.contains("help") || names.contains("json") || names.contains("quiet")) << each.name;
    EXPECT_EQ(names.contains("output"),
              std::string(each.name) == "pack" || std::string(each.name) == "hollow");
    EXPECT_EQ(names.contains("weld"), std::string(each.name) != "load");
  }
}

TEST_F(CalledCommands, HollowWithoutAFileMakesWhatTheFileHolds) {
  const std::filesystem::path output = folder_.path() / "result.ply";
  for (const std::vector<std::string>& options : {std::vector<std::string>{"--max-radius=4"},
                                                  {"--process=sla"},
                                                  {"--surface=remesh", "--voxel=0.8", "--max-voids=9"}}) {
    std::vector<std::string> with_output = options;
    with_output.push_back("--output=" + output.string());
    const CalledResult written = of_file("hollow", with_output);
    const Mesh read = read_back(output, MeshFormat::ply, monitor_);
    for (const CalledResult& result : {written, of_file("hollow", options), of_arrays("hollow", options)}) {
      EXPECT_EQ(result.mesh.positions, read.positions);
      EXPECT_EQ(result.mesh.triangles, read.triangles);
    }
    const json with = json::parse(written.report), without = json::parse(of_arrays("hollow", options).report);
    EXPECT_EQ(with["output"]["path"], output.string());
    EXPECT_TRUE(without["output"]["path"].is_null() && without["output"]["bytes"].is_null());
    EXPECT_EQ(without["measured"], with["measured"]);
    EXPECT_EQ(without["volume"], with["volume"]);
  }
}

TEST_F(CalledCommands, PackWithoutAFileMakesSpheresAndPieces) {
  const CalledResult spheres = of_arrays("pack", {"--max-voids=7"});
  EXPECT_EQ(spheres.spheres.size(), 7U);
  EXPECT_TRUE(spheres.mesh.triangles.empty());
  const std::filesystem::path output = folder_.path() / "cells.ply";
  of_file("pack", {"--shape=cells", "--output=" + output.string()});
  const CalledResult cells = of_arrays("pack", {"--shape=cells"});
  const Mesh read = read_back(output, MeshFormat::ply, monitor_);
  EXPECT_EQ(cells.mesh.positions, read.positions);
  EXPECT_EQ(cells.mesh.triangles, read.triangles);
  EXPECT_TRUE(json::parse(cells.report)["output"]["path"].is_null());
}

TEST_F(CalledCommands, InspectAndLoadTakeFilesAndArrays) {
  json file = json::parse(of_file("inspect", {}).report)["input"];
  json arrays = json::parse(of_arrays("inspect", {}).report)["input"];
  EXPECT_EQ(arrays["path"], "cube");
  for (json* input : {&file, &arrays}) {
    input->erase("path");
    input->erase("format");
  }
  EXPECT_EQ(file, arrays);
  EXPECT_EQ(of_file("load", {"--unit=cm"}).mesh.positions, of_arrays("load", {"--unit=cm"}).mesh.positions);
}

TEST_F(CalledCommands, ViewsAreMadeWithoutAResult) {
  const std::filesystem::path picture = folder_.path() / "cut.png";
  of_arrays("hollow", {"--max-radius=4", "--picture=" + picture.string()});
  EXPECT_GT(std::filesystem::file_size(picture), 1000U);
}

TEST_F(CalledCommands, WhatNeedsAFileIsRefusedWithoutOne) {
  EXPECT_TRUE(contains(refusal("hollow", {"--as=modifiers"}), "modifiers are parts of a file"));
  EXPECT_TRUE(contains(refusal("hollow", {"--support-blockers"}), "support blockers are parts of a file"));
}

TEST_F(CalledCommands, WhatTheProgramRefusesIsRefused) {
  EXPECT_TRUE(contains(refusal("hollow", {"--wall=thick"}), "'thick' is not a number"));
  EXPECT_TRUE(contains(refusal("hollow", {"--json=report.json"}), "--json: the report is what"));
  for (const char* name : {"hollow", "pack"})
    EXPECT_TRUE(contains(refusal(name, {"--output="}), "--output: 1 required FILE missing"));
  EXPECT_TRUE(contains(refusal("pack", {"--process=list"}), "--process list is for the command line"));
  EXPECT_TRUE(contains(refusal("load", {"--weld=1"}), "--weld"));
  EXPECT_TRUE(contains(refusal("hollow", {"--output=" + file_.string()}), "the output is the model itself"));
  const std::filesystem::path output = folder_.path() / "cube";
  EXPECT_TRUE(contains(refusal("hollow", {"--output=" + output.string()}), "cannot write"));
  EXPECT_THROW(command("hollow").run({folder_.path() / "none.stl", nullptr, {}}, monitor_), InputError);
}

// Arrays are called by a name that a file may have.
TEST_F(CalledCommands, ArraysAreNoInputFile) {
  command("hollow").run({file_, &arrays_, {"--max-radius=4", "--output=" + file_.string()}}, monitor_);
  EXPECT_GT(read_back(file_, MeshFormat::stl, monitor_).triangles.size(), cube_.triangles.size());
}

}  // namespace
}  // namespace aerate::cli
