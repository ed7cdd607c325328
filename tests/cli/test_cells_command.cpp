#include <cstddef>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "tests/cli/job.h"
#include "tests/support/caught.h"

// Voids that fill their cells, as the program makes and reports them.
namespace aerate::test {
namespace {

using Json = nlohmann::json;

constexpr int kUsage = 2;

Json json_of(std::vector<std::string> command) {
  command.insert(command.end(), {"--json", "-"});
  const ProcessResult result = run(command);
  EXPECT_EQ(result.exit_code, 0) << result.err;
  return result.exit_code == 0 ? Json::parse(result.out) : Json();
}

double removed_by(const Json& report) {
  return report.at("volume").at("removed_mm3").get<double>();
}

// What holds for every result, and what another program run makes of the file.
void expect_sound(const Job& job, const Json& report, std::size_t shells) {
  EXPECT_GE(report["measured"]["wall_mm"].get<double>(), report["limits"]["wall_mm"].get<double>() - 1e-6);
  EXPECT_GE(report["measured"]["gap_mm"].get<double>(), report["limits"]["gap_mm"].get<double>() - 1e-6);
  EXPECT_NEAR(report["volume"]["before_mm3"].get<double>() - report["volume"]["after_mm3"].get<double>(),
              removed_by(report), 1e-3);
  const ProcessResult result = run({AERATE_EXECUTABLE, "inspect", job.output(), "--json", "-"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const Json input = Json::parse(result.out).at("input");
  EXPECT_EQ(input["shells"], shells);
  EXPECT_TRUE(input["closed"].get<bool>());
  EXPECT_EQ(input["non_manifold_edges"], report["input"]["non_manifold_edges"]);
  EXPECT_NEAR(input["signed_volume_mm3"].get<double>(), report["volume"]["after_mm3"].get<double>(),
              1e-6 * report["volume"]["before_mm3"].get<double>());
}

TEST(CellsCommand, ADrainedBunnyIsLighterThanWithSpheres) {
  const Job job;
  const Json spheres = json_of(job.hollow(sample("bunny.stl"), {"--process", "sls", "--shape", "spheres"}));
  const Json cells = json_of(job.hollow(sample("bunny.stl"), {"--process", "sls", "--shape", "cells"}));
  expect_sound(job, cells, 1);
  EXPECT_EQ(cells["drainage"]["sealed_cavities"], 0);
  EXPECT_GE(cells["drainage"]["holes"].size(), 2U * cells["drainage"]["networks"].get<std::size_t>());
  EXPECT_LE(cells["drainage"]["pools"]["after_both_percent"].get<double>(), 1.0);
  EXPECT_GT(removed_by(cells), removed_by(spheres));
}

// Two cells, nearly all that is deeper than the wall.
TEST(CellsCommand, SealedCellsAreShellsOfTheirOwn) {
  const Job job;
  const Json report = json_of(job.hollow(
      job.input("block.stl", make_box({0, 0, 0}, {40, 20, 20})),
      {"--shape", "cells", "--no-drain", "--min-radius", "6", "--max-radius", "8", "--bridge", "20"}));
  expect_sound(job, report, 1 + report["voids"]["count"].get<std::size_t>());
  EXPECT_TRUE(report["drainage"].is_null());
  EXPECT_EQ(report["voids"]["tolerance_used_mm"], report["limits"].value("tolerance_mm", 0.1));
}

// In a bar no ball of more than 5 mm fits: of all the spheres that do there would be nine cells.
TEST(CellsCommand, InnerWallsAreAsFarApartInASlenderPartAsElsewhere) {
  const Job job;
  const std::string bar = job.input("bar.stl", make_box({0, 0, 0}, {120, 14, 14}));
  const Json spread = json_of(job.hollow(bar, {"--process", "sla", "--no-drain", "--cell-size", "21"}));
  const Json all =
      json_of(job.hollow(bar, {"--process", "sla", "--no-drain", "--max-radius", "10", "--min-radius", "4"}));
  EXPECT_LE(spread["voids"]["count"], 7);
  EXPECT_GE(spread["voids"]["count"], 4);
  EXPECT_GE(all["voids"]["count"], 9);
  EXPECT_GT(removed_by(spread), removed_by(all));
}

// Windows need what is flat of the faces that roofs leave.
TEST(CellsCommand, EdgesAreLessRoundedBelowRoofsThatDrain) {
  const Job job;
  const std::string cube = job.input("block.stl", make_box({0, 0, 0}, {40, 20, 20}));
  const Json drained = json_of(job.hollow(cube, {"--process", "metal", "--shape", "cells"}));
  EXPECT_NEAR(drained["voids"]["fillet_mm"].get<double>(), 0.7, 1e-9);
  EXPECT_LE(drained["ceilings"]["widest_mm"].get<double>(), 2.1);
  expect_sound(job, drained, 1);
  // Both cells get a roof that the surface shows to be narrow enough.
  EXPECT_EQ(drained["voids"]["count"], 2);
  EXPECT_GT(removed_by(drained), 0.55 * 40 * 20 * 20);
  const Json sealed = json_of(job.hollow(cube, {"--process", "metal", "--shape", "cells", "--no-drain"}));
  EXPECT_NEAR(sealed["voids"]["fillet_mm"].get<double>(), 1, 1e-9);
}

// The report on modifiers of a block.
Json modifiers_of(const std::vector<std::string>& options) {
  const Job job;
  std::vector<std::string> command{
      AERATE_EXECUTABLE, "hollow", job.input("block.stl", block()), "-o", job.output("out.3mf"), "--as",
      "modifiers"};
  command.insert(command.end(), options.begin(), options.end());
  Json report = json_of(std::move(command));
  EXPECT_EQ(read_bytes(job.output("out.3mf")).substr(0, 2), "PK");
  return report;
}

TEST(CellsCommand, ModifiersAreCellsBehindThePerimetersAndLeaveTheModelSolid) {
  const Json report = modifiers_of({});
  EXPECT_TRUE(report["drainage"].is_null());
  EXPECT_FALSE(report["modifiers"].is_null());
  EXPECT_EQ(report["voids"]["shape"], "cells");
  EXPECT_EQ(report["limits"]["wall_mm"], 0.9);
  EXPECT_GE(report["measured"]["wall_mm"].get<double>(), 0.9 - 1e-6);
  const Json three = modifiers_of({"--infill", "15%", "--perimeters", "3", "--line-width", "0.5"});
  EXPECT_EQ(three["limits"]["wall_mm"], 1.5);
  // Without the infill as well, and for lines wider than the process's own wall.
  const Json unknown = modifiers_of({"--perimeters", "3", "--line-width", "0.5"});
  EXPECT_EQ(unknown["limits"]["wall_mm"], 1.5);
  EXPECT_EQ(unknown["print"]["perimeters"], 3);
  EXPECT_FALSE(unknown["print"]["described"].get<bool>());
  const Json wide = modifiers_of({"--line-width", "1.3", "--gap", "1.3"});
  EXPECT_EQ(wide["limits"]["wall_mm"], 2.6);
}

TEST(CellsCommand, ModifiersKeepTheShapeAndTheWallThatAreAskedFor) {
  const Json spheres = modifiers_of({"--shape", "spheres"});
  EXPECT_EQ(spheres["voids"]["shape"], "spheres");
  EXPECT_EQ(spheres["limits"]["wall_mm"], 0.9);
  const Json lattice = modifiers_of({"--packing", "hexagonal", "--max-radius", "2"});
  EXPECT_EQ(lattice["voids"]["shape"], "spheres");
  const Json thick = modifiers_of({"--wall", "2"});
  EXPECT_EQ(thick["voids"]["shape"], "cells");
  EXPECT_EQ(thick["limits"]["wall_mm"], 2.0);
}

TEST(CellsCommand, TheTextCountsInTheSingularToo) {
  const Job job;
  const std::string block = job.input("block.stl", make_box({0, 0, 0}, {14, 14, 14}));
  const std::string one = run(job.hollow(block, {"--shape", "cells", "--max-voids", "1"})).out;
  EXPECT_TRUE(contains(one, "1 cell round a sphere, radius")) << one;
  const std::string bar = job.input("bar.stl", make_box({0, 0, 0}, {40, 14, 14}));
  const std::string some = run(job.hollow(bar, {"--shape", "cells"})).out;
  EXPECT_TRUE(contains(some, " cells round spheres, radius")) << some;
}

TEST(CellsCommand, AFilletIsOneOfCells) {
  const Job job;
  const ProcessResult result = run(job.hollow(job.input("block.stl", block()), {"--fillet", "1"}));
  EXPECT_EQ(result.exit_code, kUsage);
  EXPECT_TRUE(contains(result.err, "--fillet without --shape cells"));
  EXPECT_EQ(entries_of(job.outputs()), std::vector<std::string>{});
}

TEST(CellsCommand, CeilingsThatAreLimitedGetRoofs) {
  const Job job;
  const auto model = job.input("block.stl", make_box({0, 0, 0}, {30, 30, 30}));
  const std::vector<std::string> options{"--process", "fdm", "--shape", "cells"};
  const Json roofed = json_of(job.hollow(model, options));
  expect_sound(job, roofed, 1 + roofed["voids"]["count"].get<std::size_t>());
  EXPECT_LE(roofed["ceilings"]["widest_mm"].get<double>(),
            roofed["limits"]["bridge_mm"].get<double>() + roofed["voids"]["tolerance_used_mm"].get<double>());
  EXPECT_GE(roofed["ceilings"]["roofs"], 1);
  std::vector<std::string> without = options;
  without.insert(without.end(), {"--bridge", "30"});
  EXPECT_LT(removed_by(roofed), removed_by(json_of(job.hollow(model, without))));
}

TEST(CellsCommand, AFilletThatFitsNowhereLeavesNothingToRemove) {
  constexpr int kNothingToRemove = 5;
  const Job job;
  const ProcessResult result = run(job.hollow(job.input("block.stl", block()),
                                              {"--process", "sls", "--shape", "cells", "--fillet", "14"}));
  EXPECT_EQ(result.exit_code, kNothingToRemove);
  EXPECT_TRUE(contains(result.err, "no cell takes a ball of --fillet 14 mm"));
  EXPECT_EQ(entries_of(job.outputs()), std::vector<std::string>{});
}

TEST(CellsCommand, MaxTrianglesLoosensTheTolerance) {
  const Job job;
  const auto model = job.input("block.stl", block());
  const std::vector<std::string> options{"--process", "sls", "--shape", "cells"};
  const Json free = json_of(job.hollow(model, options));
  const auto triangles = free["output"]["triangles"].get<std::size_t>();
  const std::size_t most = triangles * 7 / 10;
  std::vector<std::string> limited = options;
  limited.insert(limited.end(), {"--max-triangles", std::to_string(most)});
  const Json report = json_of(job.hollow(model, limited));
  EXPECT_LE(report["output"]["triangles"].get<std::size_t>(), most);
  EXPECT_GT(report["voids"]["tolerance_used_mm"].get<double>(), 0.05);
  EXPECT_TRUE(contains(report["notices"].dump(), "to stay within " + std::to_string(most) + " triangles"));
}

// Coarser and coarser results are tried, some of which lose voids: nothing is said of them.
TEST(CellsCommand, TooFewTrianglesAreRefusedWithHowManyItTakes) {
  const Job job;
  const auto model = job.input("bar.stl", make_box({0, 0, 0}, {60, 30, 30}));
  const ProcessResult result =
      run(job.hollow(model, {"--process", "sls", "--shape", "cells", "--max-triangles", "20"}));
  EXPECT_EQ(result.exit_code, kUsage);
  EXPECT_TRUE(contains(result.err, "--max-triangles 20: the model has 12 triangles of its own"));
  EXPECT_TRUE(contains(result.err, "triangles or more"));
  EXPECT_FALSE(contains(result.err, "note:"));
  EXPECT_EQ(entries_of(job.outputs()), std::vector<std::string>{});
}

TEST(CellsCommand, TrianglesOfTheModelItselfAreTooMany) {
  const Job job;
  const ProcessResult result = run(
      job.hollow(sample("bunny.stl"), {"--process", "sls", "--shape", "cells", "--max-triangles", "7000"}));
  EXPECT_EQ(result.exit_code, kUsage);
  EXPECT_TRUE(contains(result.err, "the model has 7202 triangles of its own"));
}

TEST(CellsCommand, SameBytesForAnyThreadCount) {
  const Job job;
  const auto model = job.input("block.stl", block());
  std::vector<std::string> bytes;
  for (const char* threads : {"1", "2"}) {
    const ProcessResult result =
        run(job.hollow(model, {"--process", "sls", "--shape", "cells", "--threads", threads}));
    ASSERT_EQ(result.exit_code, 0) << result.err;
    bytes.push_back(read_bytes(job.output()));
  }
  EXPECT_EQ(bytes[0], bytes[1]);
}

}  // namespace
}  // namespace aerate::test
