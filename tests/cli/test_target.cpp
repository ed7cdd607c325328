#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <fmt/format.h>
#include <functional>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <numbers>
#include <numeric>
#include <string>
#include <vector>

#include "pipeline/target.h"
#include "tests/cli/job.h"
#include "tests/support/caught.h"

// Results that stop at a mass or a share of the volume.
namespace aerate::test {
namespace {

using Json = nlohmann::json;

constexpr int kUsage = 2, kNothing = 5;

double sum_of(const std::vector<double>& volumes, const std::vector<std::uint32_t>& chosen) {
  double sum = 0;
  for (const std::uint32_t i : chosen) sum += volumes[i];
  return sum;
}

TEST(Target, TheFewestThatReachASumAreTaken) {
  const std::vector<double> volumes{3, 10, 4, 7, 1};
  using Indices = std::vector<std::uint32_t>;
  EXPECT_EQ(fewest_that_reach(volumes, 9), Indices{1});
  // The last is the smallest that will do.
  EXPECT_EQ(fewest_that_reach(volumes, 3.5), Indices{2});
  EXPECT_EQ(fewest_that_reach(volumes, 11), (Indices{1, 4}));
  EXPECT_EQ(fewest_that_reach(volumes, 14), (Indices{1, 2}));
  EXPECT_EQ(fewest_that_reach(volumes, 18), (Indices{1, 3, 4}));
  EXPECT_EQ(fewest_that_reach(volumes, 25), (Indices{0, 1, 2, 3, 4}));
  EXPECT_EQ(fewest_that_reach(volumes, 26), (Indices{0, 1, 2, 3, 4}));
}

// By brute force: no choice of fewer reaches the sum.
TEST(Target, NoFewerVoidsWouldDo) {
  const std::vector<double> volumes{2.5, 0.7, 9, 3.1, 1.2, 4.4, 0.3, 6.6};
  for (int tenths = 1; tenths < 277; tenths += 4) {
    const double sum = 0.1 * tenths;
    const auto chosen = fewest_that_reach(volumes, sum);
    EXPECT_GE(sum_of(volumes, chosen), sum);
    std::vector<double> largest = volumes;
    std::ranges::sort(largest, std::greater<>());
    EXPECT_LT(std::accumulate(largest.begin(),
                              largest.begin() + static_cast<std::ptrdiff_t>(chosen.size()) - 1, 0.0),
              sum);
  }
}

Json json_of(std::vector<std::string> command) {
  command.insert(command.end(), {"--json", "-"});
  const ProcessResult result = run(command);
  EXPECT_EQ(result.exit_code, 0) << result.err;
  return result.exit_code == 0 ? Json::parse(result.out) : Json();
}

std::vector<std::string> with(std::vector<std::string> options, const std::vector<std::string>& more) {
  options.insert(options.end(), more.begin(), more.end());
  return options;
}

TEST(Target, SealedVoidsReachASavingWithNoMoreThanIsNeeded) {
  for (const std::string shape : {"spheres", "cells"}) {
    const Job job;
    const auto model = job.input("block.stl", make_box({0, 0, 0}, {60, 40, 30}));
    const std::vector<std::string> options{"--shape", shape, "--max-radius", "8"};
    const Json all = json_of(job.hollow(model, options));
    const Json some = json_of(job.hollow(model, with(options, {"--target-saving", "20"})));
    const double reached = some["volume"]["removed_percent"].get<double>();
    EXPECT_GE(reached, 20);
    // Without any of its voids it would not be enough.
    const double radius = some["voids"]["min_radius_mm"].get<double>();
    const double beyond = (reached - 20) / 100 * 60 * 40 * 30;
    EXPECT_LT(beyond, (shape == "cells" ? 3.0 : 1.2) * 4 / 3 * std::numbers::pi * std::pow(radius, 3));
    EXPECT_LT(some["voids"]["count"].get<int>(), all["voids"]["count"].get<int>());
    EXPECT_EQ(some["target"]["voids_to_choose_from"], all["voids"]["count"]);
    EXPECT_NEAR(some["target"]["most_saving_percent"].get<double>(),
                all["volume"]["removed_percent"].get<double>(), 1e-3);
    EXPECT_EQ(some["target"]["saving_percent"], 20);
    EXPECT_TRUE(some["target"]["mass_g"].is_null());
    EXPECT_TRUE(all["target"].is_null());
  }
}

TEST(Target, TheMassIsThatOfTheMaterial) {
  const Job job;
  const auto model = job.input("block.stl", block());
  // 27 cm3 of 2 g/cm3.
  const Json report =
      json_of(job.hollow(model, {"--density", "2", "--target-mass", "45", "--max-radius", "3"}));
  EXPECT_LE(report["material"]["mass_after_g"].get<double>(), 45);
  EXPECT_GE(report["material"]["mass_after_g"].get<double>(), 44.9);
  EXPECT_EQ(report["target"]["mass_g"], 45);
}

TEST(Target, DrainedVoidsReachItAsTheyDrain) {
  for (const std::string shape : {"spheres", "cells"}) {
    const Job job;
    const auto model = job.input("block.stl", make_box({0, 0, 0}, {80, 40, 30}));
    std::vector<std::string> options{"--process", "sls", "--shape", shape};
    if (shape == "cells") options.insert(options.end(), {"--cell-size", "21"});
    const Json all = json_of(job.hollow(model, options));
    const double half = all["volume"]["removed_percent"].get<double>() / 2;
    const Json some = json_of(job.hollow(model, with(options, {"--target-saving", std::to_string(half)})));
    EXPECT_GE(some["volume"]["removed_percent"].get<double>(), half);
    EXPECT_LT(some["voids"]["count"].get<int>(), all["voids"]["count"].get<int>());
    EXPECT_EQ(some["drainage"]["sealed_cavities"], 0);
    EXPECT_LE(some["volume"]["removed_percent"].get<double>(), 1.5 * half);
  }
}

// What no cells of the usual size reach, larger ones may.
TEST(Target, IsReachedByLargerCellsWhereTheUsualOnesDoNot) {
  const Job job;
  const auto model = job.input("block.stl", make_box({0, 0, 0}, {60, 40, 20}));
  const std::vector<std::string> sla{"--process", "sla"};
  const ProcessResult refused =
      run(job.hollow(model, with(sla, {"--cell-size", "33", "--target-saving", "66"})));
  EXPECT_EQ(refused.exit_code, 5) << refused.err;
  EXPECT_TRUE(contains(refused.err, "--max-voids 1")) << refused.err;
  const Json reached = json_of(job.hollow(model, with(sla, {"--target-saving", "66"})));
  EXPECT_GE(reached["volume"]["removed_percent"].get<double>(), 66);
  EXPECT_NE(reached["notices"].dump().find("since with --shape cells --cell-size 33"), std::string::npos);
}

TEST(Target, WhatCannotBeReachedIsRefusedWithTheMost) {
  const Job job;
  const auto model = job.input("block.stl", block());
  const Json all = json_of(job.hollow(model));
  const auto refused = [&](const std::vector<std::string>& options, int exit_code) {
    std::filesystem::remove(job.output());
    const ProcessResult result = run(job.hollow(model, options));
    EXPECT_EQ(result.exit_code, exit_code) << result.err;
    EXPECT_EQ(entries_of(job.outputs()), std::vector<std::string>{});
    return result.err;
  };
  const std::string most =
      fmt::format("{:.1f}", std::floor(10 * all["volume"]["removed_percent"].get<double>()) / 10);
  EXPECT_TRUE(contains(refused({"--target-saving", "80"}, kNothing), most));
  EXPECT_TRUE(contains(refused({"--target-mass", "5"}, kNothing), "at least"));
  EXPECT_TRUE(contains(refused({"--target-mass", "500"}, kUsage), "without voids"));
  EXPECT_TRUE(contains(refused({"--target-mass", "20", "--target-saving", "20"}, kUsage), "two targets"));
  EXPECT_TRUE(contains(refused({"--target-mass", "20", "--infill", "20%"}, kUsage), "solid material"));
  refused({"--target-saving", "0"}, kUsage);
  refused({"--target-saving", "101"}, kUsage);
}

}  // namespace
}  // namespace aerate::test
