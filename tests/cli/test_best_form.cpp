#include <algorithm>
#include <filesystem>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "tests/cli/job.h"
#include "tests/support/blocks.h"

// What voids are where the command line does not say.
namespace aerate::test {
namespace {

using Json = nlohmann::json;

Json report_of(std::vector<std::string> command) {
  command.insert(command.end(), {"--json", "-"});
  const ProcessResult result = run(command);
  EXPECT_EQ(result.exit_code, 0) << result.err;
  return result.exit_code == 0 ? Json::parse(result.out) : Json();
}

Json without_time(Json report) {
  for (const char* key : {"stages", "notices", "seconds", "peak_memory_bytes", "input", "output"})
    report.erase(key);
  return report;
}

double filament_of(const Json& report) {
  return report.at("print").at("filament_after_mm3").get<double>();
}

TEST(BestForm, OfAPrintThatIsDescribedTakesTheLeastFilament) {
  const Job job;
  const std::string block = job.input("block.stl", make_box({0, 0, 0}, {40, 40, 40}));
  const auto job_with = [&](std::vector<std::string> options) {
    options.insert(options.end(), {"--infill", "100"});
    return report_of(job.hollow(block, options));
  };
  const Json unasked = job_with({});
  const double spheres = filament_of(job_with({"--shape", "spheres"}));
  const double cells = filament_of(job_with({"--shape", "cells"}));
  EXPECT_NE(spheres, cells);
  EXPECT_EQ(filament_of(unasked), std::min(spheres, cells));
  ASSERT_EQ(unasked["notices"].size(), 1U);
  EXPECT_NE(unasked["notices"][0].get<std::string>().find("voids are cells"), std::string::npos);
}

TEST(BestForm, IsTheOtherWhereThePreferredCannotBeMade) {
  const Job job;
  // Spheres below roofs find no place for holes of 5 mm here.
  const std::string bar = job.input("bar.stl", make_box({0, 0, 0}, {10, 10, 60}));
  EXPECT_EQ(run(job.hollow(bar, {"--process", "metal", "--shape", "spheres"})).exit_code, 5);
  const Json unasked = report_of(job.hollow(bar, {"--process", "metal"}));
  EXPECT_EQ(unasked["voids"]["shape"], "cells");
  const std::string why = unasked["notices"].back().get<std::string>();
  EXPECT_NE(why.find("since with --shape spheres no place was found"), std::string::npos) << why;
  const Json asked = report_of(job.hollow(bar, {"--process", "metal", "--shape", "cells"}));
  EXPECT_EQ(without_time(unasked), without_time(asked));
}

// The flat of a wall between two cells of 6 x 6 mm is too small for a window of 3.5 mm: without the wall two holes will do.
TEST(BestForm, HasLargerCellsWhereThatSavesHoles) {
  const Job job;
  const std::string bar = job.input("bar.stl", make_box({0, 0, 0}, {60, 10, 10}));
  const Json usual = report_of(job.hollow(bar, {"--process", "sla", "--cell-size", "33"}));
  const Json unasked = report_of(job.hollow(bar, {"--process", "sla"}));
  EXPECT_GE(usual["drainage"]["networks"], 2);
  EXPECT_LT(unasked["drainage"]["holes"].size(), usual["drainage"]["holes"].size());
  EXPECT_GT(unasked["volume"]["removed_mm3"].get<double>(), 0.3 * 6000);
  EXPECT_NE(unasked["notices"].dump().find("--shape cells --cell-size 33"), std::string::npos);
}

// Two cells of one group, whose pools take a third hole.
TEST(BestForm, HasLargerCellsWherePoolsTakeHoles) {
  const Job job;
  const std::string box = job.input("box.stl", make_box({0, 0, 0}, {70, 40, 20}));
  const Json usual = report_of(job.hollow(box, {"--process", "sla", "--cell-size", "33"}));
  EXPECT_EQ(usual["drainage"]["networks"], 1);
  EXPECT_GT(usual["drainage"]["holes"].size(), 2U);
  const Json unasked = report_of(job.hollow(box, {"--process", "sla"}));
  EXPECT_EQ(unasked["drainage"]["holes"].size(), 2U);
  EXPECT_GT(unasked["volume"]["removed_mm3"], usual["volume"]["removed_mm3"]);
}

// Two regions that no cell joins, each with the two holes that it needs: larger cells are the same.
TEST(BestForm, IsThePreferredWhereOthersAreNoBetter) {
  const Job job;
  const std::string pair =
      job.input("pair.stl", make_blocks({std::vector<float>{0, 20, 26, 46}, {0, 3, 20}, {0, 20}},
                                        [](int x, int y, int) { return x != 1 || y == 0; }));
  const Json unasked = report_of(job.hollow(pair, {"--process", "sla"}));
  EXPECT_EQ(unasked["drainage"]["networks"], 2);
  EXPECT_TRUE(unasked["notices"].empty()) << unasked["notices"].dump();
}

// Two legs of 40 mm, 12 mm thick and 30 mm wide.
Mesh angle_of_12() {
  return make_blocks({std::vector<float>{0, 12, 40}, {0, 30}, {0, 12, 40}},
                     [](int x, int, int z) { return x == 0 || z == 0; });
}

// A smaller gap or wall, or a wider range of radii, is more freedom.
TEST(BestForm, OfMoreFreedomRemovesNoLess) {
  const Job job;
  const std::vector<std::string> models{job.input("bar.stl", make_box({0, 0, 0}, {60, 10, 10})),
                                        job.input("plate.stl", make_box({0, 0, 0}, {40, 40, 12})),
                                        job.input("cube.stl", block()),
                                        job.input("ball.stl", make_uv_sphere(16, 24, 48)),
                                        job.input("ring.stl", make_torus(20, 9, 48, 24)),
                                        job.input("angle.stl", angle_of_12())};
  const std::vector<std::vector<std::string>> freer{
      {"--gap", "0.5"}, {"--gap", "0.8"}, {"--max-radius", "20"}, {"--min-radius", "2"}};
  for (const std::string& model : models) {
    for (const std::vector<std::string>& process :
         {std::vector<std::string>{"--process", "sla"}, {"--process", "metal", "--shape", "spheres"}}) {
      std::vector<std::string> plain = job.hollow(model, process);
      plain.insert(plain.end(), {"--json", "-"});
      const ProcessResult first = run(plain);
      if (first.exit_code != 0) continue;
      const double unasked = Json::parse(first.out)["volume"]["removed_percent"].get<double>();
      for (const std::vector<std::string>& options : freer) {
        double usual = unasked;
        // Cells larger than those that were asked for are not made.
        if (options[0] == "--max-radius" && process[1] == std::string("sla")) {
          std::vector<std::string> of_33 = process;
          of_33.insert(of_33.end(), {"--cell-size", "33"});
          usual = report_of(job.hollow(model, of_33))["volume"]["removed_percent"].get<double>();
        }
        std::vector<std::string> all = process;
        all.insert(all.end(), options.begin(), options.end());
        const double removed = report_of(job.hollow(model, all))["volume"]["removed_percent"].get<double>();
        EXPECT_GE(removed, usual - 0.3)
            << model << " " << process[1] << " " << options[0] << " " << options[1];
      }
    }
  }
}

TEST(BestForm, IsThePreferredWhereThatLeavesLittleOut) {
  const Job job;
  const std::string block = job.input("block.stl", make_box({0, 0, 0}, {40, 40, 40}));
  const Json unasked = report_of(job.hollow(block, {"--process", "sla"}));
  EXPECT_EQ(unasked["voids"]["shape"], "cells");
  EXPECT_TRUE(unasked["notices"].empty());
}

TEST(BestForm, IsNotLookedForWhereTheShapeIsAskedFor) {
  const Job job;
  const std::string bar = job.input("bar.stl", make_box({0, 0, 0}, {10, 10, 60}));
  const ProcessResult refused = run(job.hollow(bar, {"--process", "metal", "--shape", "spheres"}));
  EXPECT_NE(refused.err.find("escape holes"), std::string::npos) << refused.err;
  EXPECT_FALSE(std::filesystem::exists(job.output()));
}

// The reason of the form that was preferred, where none can be made.
TEST(BestForm, RefusesForThePreferred) {
  const Job job;
  const std::string thin = job.input("thin.stl", make_box({0, 0, 0}, {40, 40, 2}));
  for (const char* process : {"sla", "metal"}) {
    const ProcessResult refused = run(job.hollow(thin, {"--process", process}));
    EXPECT_EQ(refused.exit_code, 5);
    EXPECT_NE(refused.err.find("thinner than twice the wall"), std::string::npos) << refused.err;
  }
}

}  // namespace
}  // namespace aerate::test
