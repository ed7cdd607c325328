#include <array>
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstring>
#include <gtest/gtest.h>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <thread>
#include <vector>

#include "tests/cli/job.h"
#include "tests/support/caught.h"

// The cells of a packing, as `aerate pack --shape cells` writes and reports them.
namespace aerate::test {
namespace {

using Json = nlohmann::json;

constexpr int kUsage = 2, kNothingToRemove = 5, kInterrupted = 130;

std::vector<std::string> pack(const std::filesystem::path& model, const std::filesystem::path& output,
                              const std::vector<std::string>& arguments) {
  std::vector<std::string> command{AERATE_EXECUTABLE, "pack", model, "-o", output};
  command.insert(command.end(), arguments.begin(), arguments.end());
  return command;
}

std::vector<std::string> pack_cells(const std::filesystem::path& model, const std::filesystem::path& output,
                                    std::vector<std::string> arguments = {}) {
  arguments.insert(arguments.end(), {"--shape", "cells"});
  return pack(model, output, arguments);
}

Json report_of(std::vector<std::string> command) {
  command.insert(command.end(), {"--json", "-"});
  const ProcessResult result = run(command);
  EXPECT_EQ(result.exit_code, 0) << result.err;
  return result.exit_code == 0 ? Json::parse(result.out) : Json();
}

using Corners = std::array<std::array<float, 3>, 3>;

// The triangles of a binary STL from one on.
std::vector<Corners> triangles_from(const std::filesystem::path& path, std::size_t first) {
  const std::string bytes = read_bytes(path);
  std::vector<Corners> triangles;
  for (std::size_t at = 84 + 50 * first; at + 50 <= bytes.size(); at += 50) {
    Corners corners;
    std::memcpy(corners.data(), bytes.data() + at + 12, sizeof(corners));
    triangles.push_back(corners);
  }
  return triangles;
}

// Two boxes that cells fill quickly.
Mesh dumbbell() {
  return join(make_box({0, 0, 0}, {30, 30, 30}), make_box({50, 0, 0}, {75, 25, 40}));
}

TEST(PackCells, PiecesAreWhatHollowRemoves) {
  const Job job;
  const auto model = job.input("model.stl", dumbbell());
  const std::vector<std::vector<std::string>> cases{
      {"--process", "sla"},
      {"--process", "fdm"},
      {"--process", "sls", "--fillet", "2", "--cell-size", "14", "--tolerance", "0.2"}};
  for (const std::vector<std::string>& options : cases) {
    const Json packed = report_of(pack_cells(model, job.output("pieces.stl"), options));
    std::vector<std::string> sealed = options;
    sealed.insert(sealed.end(), {"--shape", "cells", "--no-drain"});
    const Json hollowed = report_of(job.hollow(model, sealed));
    ASSERT_FALSE(packed.is_null() || hollowed.is_null());
    const Json& pieces = packed["cells"]["pieces"];
    EXPECT_EQ(pieces["count"], hollowed["voids"]["count"]);
    EXPECT_NEAR(pieces["volume_mm3"].get<double>(), hollowed["volume"]["removed_mm3"].get<double>(), 1e-6);
    EXPECT_NEAR(pieces["volume_percent"].get<double>(), hollowed["volume"]["removed_percent"].get<double>(),
                1e-6);
    EXPECT_EQ(pieces["fillet_mm"], hollowed["voids"]["fillet_mm"]);
    EXPECT_EQ(pieces["tolerance_mm"], hollowed["voids"]["tolerance_used_mm"]);
    EXPECT_EQ(pieces["deviation_mm"], hollowed["voids"]["deviation_mm"]);
    EXPECT_EQ(pieces["measured"], hollowed["measured"]);
    EXPECT_EQ(pieces["ceilings"], hollowed["ceilings"]);
    EXPECT_EQ(packed["process"], hollowed["process"]);
    EXPECT_EQ(packed["packing"]["candidates"], hollowed["packing"]["candidates"]);
    EXPECT_EQ(packed["packing"]["density"], hollowed["packing"]["density"]);
    EXPECT_EQ(packed["limits"]["bridge_mm"], hollowed["limits"]["bridge_mm"]);

    // To the last bit, but that they face outward.
    const auto outward = triangles_from(job.output("pieces.stl"), 0);
    const auto inward =
        triangles_from(job.output(), hollowed["output"]["outer_triangles"].get<std::size_t>());
    ASSERT_EQ(outward.size(), pieces["triangles"].get<std::size_t>());
    ASSERT_EQ(outward.size(), inward.size());
    for (std::size_t i = 0; i < outward.size(); ++i)
      ASSERT_EQ(outward[i], (Corners{inward[i][0], inward[i][2], inward[i][1]})) << i;
  }
}

TEST(PackCells, PiecesAreClosedSolidsInEachFormat) {
  const Job job;
  const auto model = job.input("block.stl", block());
  for (const char* name : {"pieces.stl", "pieces.PLY", "pieces.obj", "pieces.3mf"}) {
    const Json report =
        report_of(pack_cells(model, job.output(name), {"--process", "sla", "--cell-size", "14"}));
    const Json pieces = report["cells"]["pieces"];
    EXPECT_EQ(report["output"]["bytes"], std::filesystem::file_size(job.output(name)));
    const Json found = report_of({AERATE_EXECUTABLE, "inspect", job.output(name)})["input"];
    EXPECT_TRUE(found["closed"].get<bool>()) << name;
    EXPECT_EQ(found["shells"], pieces["count"]) << name;
    EXPECT_EQ(found["non_manifold_edges"], 0) << name;
    EXPECT_EQ(found["overlapping_shells"], 0) << name;
    EXPECT_EQ(found["triangles"], pieces["triangles"]) << name;
    EXPECT_NEAR(found["signed_volume_mm3"].get<double>(), pieces["volume_mm3"].get<double>(), 1e-2) << name;
  }
}

// Each cell's planes hold its sphere, and those of two cells are the gap apart.
TEST(PackCells, PlanesAreThoseOfTheCells) {
  const Job job;
  const auto model = job.input("model.stl", dumbbell());
  const std::vector<std::string> options{"--cell-size", "12", "--gap", "0.7"};
  const Json report = report_of(pack_cells(model, job.output("cells.json"), options));
  EXPECT_TRUE(report["cells"]["pieces"].is_null());
  const Json file = Json::parse(read_bytes(job.output("cells.json")));
  EXPECT_EQ(file["schema"], "aerate.cells");
  EXPECT_EQ(file["schema_version"], 1);
  EXPECT_EQ(file["unit"], "mm");
  EXPECT_EQ(file["gap"], 0.7);
  EXPECT_EQ(file["wall"], report["limits"]["wall_mm"]);
  const Json& cells = file["cells"];
  ASSERT_EQ(cells.size(), report["cells"]["count"].get<std::size_t>());
  ASSERT_EQ(cells.size(), report["packing"]["spheres"].get<std::size_t>());
  std::size_t count = 0;
  for (std::size_t i = 0; i < cells.size(); ++i) {
    const Json& sphere = cells[i]["sphere"];
    for (const Json& plane : cells[i]["planes"]) {
      ++count;
      double length = 0, depth = plane[3].get<double>();
      for (std::size_t k = 0; k < 3; ++k) {
        length += plane[k].get<double>() * plane[k].get<double>();
        depth -= plane[k].get<double>() * sphere[k].get<double>();
      }
      EXPECT_NEAR(length, 1, 1e-12);
      EXPECT_GE(depth, sphere[3].get<double>() - 1e-9);
      const auto neighbour = plane[4].get<std::size_t>();
      ASSERT_LT(neighbour, cells.size());
      ASSERT_NE(neighbour, i);
      for (const Json& other : cells[neighbour]["planes"]) {
        if (other[4].get<std::size_t>() != i) continue;
        for (std::size_t k = 0; k < 3; ++k)
          EXPECT_NEAR(plane[k].get<double>(), -other[k].get<double>(), 1e-12);
        EXPECT_NEAR(-plane[3].get<double>() - other[3].get<double>(), 0.7, 1e-9);
      }
    }
  }
  EXPECT_GT(count, cells.size());
  EXPECT_EQ(report["cells"]["planes"], count);

  // The other table says the same.
  ASSERT_EQ(run(pack_cells(model, job.output("cells.csv"), options)).exit_code, 0);
  std::istringstream lines(read_bytes(job.output("cells.csv")));
  std::string line;
  std::getline(lines, line);
  EXPECT_EQ(line, "cell,x,y,z,radius,normal_x,normal_y,normal_z,offset,neighbour");
  for (std::size_t i = 0; i < cells.size(); ++i) {
    const Json& sphere = cells[i]["sphere"];
    for (const Json& plane : cells[i]["planes"]) {
      ASSERT_TRUE(std::getline(lines, line));
      const Json row = Json::parse("[" + line + "]");
      EXPECT_EQ(row, Json({i, sphere[0], sphere[1], sphere[2], sphere[3], plane[0], plane[1], plane[2],
                           plane[3], plane[4]}));
    }
  }
  EXPECT_FALSE(std::getline(lines, line));
}

TEST(PackCells, SameBytesForAnyThreadCount) {
  const Job job;
  const auto model = job.input("block.stl", block());
  for (const char* name : {"out.stl", "out.json"}) {
    std::vector<std::string> bytes;
    for (const char* threads : {"1", "2"}) {
      ASSERT_EQ(run(pack_cells(model, job.output(name), {"--threads", threads})).exit_code, 0);
      bytes.push_back(read_bytes(job.output(name)));
    }
    EXPECT_EQ(bytes[0], bytes[1]) << name;
  }
}

TEST(PackCells, SpheresAreTheDefaultAndKeepTheirReport) {
  const Job job;
  const auto model = job.input("block.stl", block());
  const Json report = report_of(pack(model, job.output("a.ply"), {}));
  EXPECT_TRUE(report["cells"].is_null());
  EXPECT_EQ(report["output"]["bytes"], std::filesystem::file_size(job.output("a.ply")));
  ASSERT_EQ(run(pack(model, job.output("b.ply"), {"--shape", "spheres"})).exit_code, 0);
  EXPECT_EQ(read_bytes(job.output("a.ply")), read_bytes(job.output("b.ply")));
  EXPECT_TRUE(contains(read_bytes(job.output("a.ply")), "comment spheres, mm"));
}

TEST(PackCells, TheTextTellsPiecesOrPlanes) {
  const Job job;
  const auto model = job.input("block.stl", block());
  const std::string pieces = run(pack_cells(model, job.output("p.stl"))).out;
  EXPECT_TRUE(contains(pieces, "% of the model), fillet 1 mm")) << pieces;
  EXPECT_TRUE(contains(pieces, "spheres     "));
  EXPECT_TRUE(contains(pieces, "p.stl: "));
  const std::string planes = run(pack_cells(model, job.output("p.csv"))).out;
  EXPECT_TRUE(contains(planes, "p.csv: ")) << planes;
  EXPECT_TRUE(contains(planes, " of "));
  EXPECT_FALSE(contains(planes, "pieces"));
}

void expect_refused(const Job& job, const std::vector<std::string>& command, int code,
                    const std::string& said) {
  const ProcessResult result = run(command);
  EXPECT_EQ(result.exit_code, code) << said;
  EXPECT_TRUE(contains(result.err, said)) << result.err;
  EXPECT_TRUE(contains(result.err, "hint: ")) << result.err;
  EXPECT_EQ(entries_of(job.outputs()), std::vector<std::string>{}) << said;
}

TEST(PackCells, OptionsThatHaveNoEffectAreRefused) {
  const Job job;
  const auto model = job.input("block.stl", block());
  const auto csv = job.output("out.csv");
  for (const char* option : {"--fillet", "--cell-size", "--tolerance"})
    expect_refused(job, pack(model, csv, {option, "1"}), kUsage,
                   option + std::string(" without --shape cells"));
  for (const char* option : {"--fillet", "--tolerance"})
    expect_refused(job, pack_cells(model, csv, {option, "0.2"}), kUsage, option + (" with " + csv.string()));
  expect_refused(job, pack_cells(model, job.output(), {"--tolerance", "9"}), kUsage, "--tolerance 9 mm");
  expect_refused(job, pack_cells(model, job.output(), {"--cell-size", "9", "--max-radius", "4"}), kUsage,
                 "--cell-size and --max-radius");
}

TEST(PackCells, SmallSpheresNeedAFineToleranceForPiecesAlone) {
  const Job job;
  const auto model = job.input("block.stl", make_box({0, 0, 0}, {8, 8, 8}));
  for (const std::vector<std::string>& small :
       {std::vector<std::string>{"--min-radius", "0.1"}, std::vector<std::string>{"--cell-size", "1.6"}}) {
    expect_refused(job, pack_cells(model, job.output(), small), kUsage, small[0] + " " + small[1] + " mm");
    ASSERT_EQ(run(pack_cells(model, job.output("out.csv"), small)).exit_code, 0);
    std::filesystem::remove(job.output("out.csv"));
  }
}

// The radius that follows from the size is not the user's.
TEST(PackCells, CellsTooSmallForTheToleranceAreToldBySize) {
  const Job job;
  const auto model = job.input("block.stl", make_box({0, 0, 0}, {8, 8, 8}));
  const auto of_size = [&](const char* size) {
    return pack_cells(model, job.output(), {"--cell-size", size, "--fillet", "0.3"});
  };
  const ProcessResult refused = run(of_size("1.6"));
  EXPECT_EQ(refused.exit_code, kUsage);
  EXPECT_TRUE(contains(refused.err, "hint: give a --cell-size of 1.8 mm or more")) << refused.err;
  EXPECT_FALSE(contains(refused.err, "--min-radius"));
  const Json report = report_of(of_size("1.8"));
  EXPECT_TRUE(contains(report["process"]["limits"].dump(), "half of the largest, for cells"));
  EXPECT_FALSE(contains(report["process"]["limits"].dump(), "\"limit\":\"min-radius\",\"origin\":\"default"));
}

TEST(PackCells, HintsNameNoOptionsOfOtherCommandsAsTheirOwn) {
  const Job job;
  Mesh open = block();
  open.triangles.pop_back();
  constexpr int kUnusable = 4;
  expect_refused(job, pack(job.input("open.stl", open), job.output("out.csv"), {}), kUnusable,
                 "'aerate hollow --surface remesh'");
}

TEST(PackCells, WhatCannotBeWrittenIsRefused) {
  const Job job;
  const auto model = job.input("block.stl", block());
  for (const char* name : {"out.txt", "out.vtp", "out.data", "out", "out.off"})
    expect_refused(job, pack_cells(model, job.output(name)), kUsage, "cells cannot be written as");
  expect_refused(job, pack_cells(model, job.output("out.vtp")), kUsage,
                 "or in .csv or .json for their planes");
  expect_refused(job, pack(model, job.output("out.stl"), {}), kUsage, "spheres cannot be written as .stl");
  expect_refused(job, pack(model, job.output("out.stl"), {}), kUsage, "hint: give --shape cells");
  expect_refused(job, pack(model, job.output("out.off"), {}), kUsage, "spheres cannot be written as .off");
  expect_refused(job, pack_cells(model, model), kUsage, "the output is the model itself");
}

TEST(PackCells, WhereNothingFitsNothingIsWritten) {
  const Job job;
  const auto model = job.input("block.stl", block());
  expect_refused(job, pack_cells(model, job.output(), {"--fillet", "14"}), kNothingToRemove,
                 "no cell takes a ball of --fillet 14 mm");
  for (const char* name : {"out.stl", "out.csv"})
    expect_refused(job, pack_cells(model, job.output(name), {"--wall", "16"}), kNothingToRemove,
                   "nothing to remove");
}

TEST(PackCells, AnInterruptLeavesNothingBehind) {
  const Job job;
  const auto model = job.input("cube.stl", make_box({0, 0, 0}, {90, 90, 90}));
  Process process(pack_cells(model, job.output(), {"--tolerance", "0.005"}));
  while (process.running() && entries_of(job.outputs()).empty())
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  std::this_thread::sleep_for(std::chrono::milliseconds(300));
  process.send(SIGINT);
  const ProcessResult result = process.wait();
  EXPECT_EQ(result.exit_code, kInterrupted) << result.err;
  EXPECT_TRUE(contains(result.err, "interrupted"));
  EXPECT_EQ(entries_of(job.outputs()), std::vector<std::string>{});
}

}  // namespace
}  // namespace aerate::test
