#include <algorithm>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <numeric>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include "files/load.h"
#include "pipeline/stand.h"
#include "printing/footing.h"
#include "tests/cli/job.h"
#include "tests/support/caught.h"
#include "tests/support/counterweight.h"

// --stand: voids are left out until the model stands.
namespace aerate::test {
namespace {

using Json = nlohmann::json;

constexpr int kUsage = 2, kNothing = 5;

const Footprint kSquare({{-10, -10}, {10, -10}, {10, 10}, {-10, 10}});

double margin_with(const Weight& solid, const std::vector<Weight>& voids, std::uint32_t made) {
  double volume = solid.volume, x = solid.volume * solid.x, y = solid.volume * solid.y;
  for (std::uint32_t i = 0; i < voids.size(); ++i) {
    if ((made >> i & 1U) == 0) continue;
    volume -= voids[i].volume;
    x -= voids[i].volume * voids[i].x;
    y -= voids[i].volume * voids[i].y;
  }
  return kSquare.margin(x / volume, y / volume);
}

double volume_of(const std::vector<Weight>& voids, std::uint32_t made) {
  double volume = 0;
  for (std::uint32_t i = 0; i < voids.size(); ++i) volume += (made >> i & 1U) != 0 ? voids[i].volume : 0;
  return volume;
}

// By brute force, over random voids that draw the centre of mass aside.
TEST(Stand, NearlyAsMuchIsRemovedAsByTheBestChoice) {
  std::mt19937 random(7);
  const auto uniform = [&](double low, double high) {
    return low + (high - low) * static_cast<double>(random()) / static_cast<double>(std::mt19937::max());
  };
  double chosen_volume = 0, best_volume = 0;
  for (int round = 0; round < 60; ++round) {
    const Weight solid{1000, uniform(-4, 4), uniform(-4, 4)};
    std::vector<Weight> voids;
    // Of a few voids the best choice is found, of more one nearly as good.
    const bool are_few = round % 2 == 0;
    for (int i = 0; i < (are_few ? 11 : 16); ++i)
      voids.push_back({uniform(2, 600.0 / (are_few ? 11 : 16)), uniform(-12, 9), uniform(-9, 12)});
    const double before = kSquare.margin(solid.x, solid.y);
    const double needed = needed_margin(before, round % 3 == 0 ? 0.3 : 0);
    double best = -1;
    for (std::uint32_t made = 1; made < 1U << voids.size(); ++made) {
      if (margin_with(solid, voids, made) >= needed) best = std::max(best, volume_of(voids, made));
    }
    const StandingChoice choice = choose_standing(kSquare, solid, voids, needed);
    ASSERT_TRUE(choice.voids.has_value() || best < 0) << "round " << round;
    if (!choice.voids) {
      EXPECT_LT(choice.best_margin, needed);
      continue;
    }
    std::uint32_t made = 0;
    for (const std::uint32_t i : *choice.voids) made |= 1U << i;
    EXPECT_GE(margin_with(solid, voids, made), needed);
    EXPECT_NEAR(margin_with(solid, voids, made), choice.best_margin, 1e-9);
    EXPECT_TRUE(std::ranges::is_sorted(*choice.voids));
    if (are_few) {
      EXPECT_NEAR(volume_of(voids, made), best, 1e-9);
    }
    chosen_volume += volume_of(voids, made);
    best_volume += best;
  }
  EXPECT_GT(chosen_volume, 0.85 * best_volume);
}

TEST(Stand, AllVoidsAreMadeWhereTheyDoNoHarm) {
  const std::vector<Weight> voids{{10, 5, 5}, {20, -5, -5}, {30, 0, 1}};
  const StandingChoice choice = choose_standing(kSquare, {1000, 0, 0}, voids, 5);
  EXPECT_EQ(choice.voids.value(), (std::vector<std::uint32_t>{0, 1, 2}));
}

TEST(Stand, WhatIsNeededIsWhatThereWasAndNeverOutside) {
  EXPECT_DOUBLE_EQ(needed_margin(10, 0), 9.9);
  EXPECT_DOUBLE_EQ(needed_margin(10, 2), 12);
  EXPECT_DOUBLE_EQ(needed_margin(10, -4), 5.9);
  EXPECT_DOUBLE_EQ(needed_margin(10, -40), 0);
  EXPECT_DOUBLE_EQ(needed_margin(-3, 0), 0);
  EXPECT_DOUBLE_EQ(needed_margin(-3, 1.5), 1.5);
}

Json json_of(std::vector<std::string> command) {
  command.insert(command.end(), {"--json", "-"});
  const ProcessResult result = run(command);
  EXPECT_EQ(result.exit_code, 0) << result.err;
  return result.exit_code == 0 ? Json::parse(result.out) : Json();
}

// Of the written file, by itself.
double written_margin(const std::filesystem::path& path, const Mesh& model) {
  const VolumeMoments moments = volume_moments(load_model(path).mesh);
  return footing_margin(model, moments.first_moment * (1 / moments.volume)).value();
}

TEST(Stand, AModelThatItsVoidsTipOverKeepsStanding) {
  struct Case {
    std::vector<std::string> options;
    int asked;  // the foot has room for small voids alone, so that few large ones cannot stand quite as it stood
  };
  for (const auto& [options, asked] :
       {Case{{"--max-radius", "14"}, 0}, Case{{"--max-radius", "4", "--shape", "cells"}, 0},
        Case{{"--process", "sls", "--shape", "spheres"}, -1}}) {
    const Job job;
    const auto model = job.input("weight.stl", counterweight());
    const auto standing = [&](int margin) {
      std::vector<std::string> all = options;
      all.push_back(fmt::format("--stand={}", margin));
      return json_of(job.hollow(model, all));
    };
    const Json plain = json_of(job.hollow(model, options));
    const Json less = standing(asked - 1);
    const Json report = standing(asked);
    ASSERT_FALSE(report.is_null());
    const Json& stand = report["stand"];
    const double before = stand["margin_before_mm"].get<double>();
    const double needed = 0.99 * before + asked;
    EXPECT_GT(needed, 0);
    EXPECT_NEAR(stand["needed_margin_mm"].get<double>(), needed, 1e-9);
    const double after = written_margin(job.output(), counterweight());
    EXPECT_GE(after, needed - 1e-4);
    EXPECT_NEAR(after, stand["margin_after_mm"].get<double>(), 1e-3);
    EXPECT_FALSE(report["strength_and_balance"]["tips_over"].get<bool>());
    EXPECT_TRUE(plain["strength_and_balance"]["tips_over"].get<bool>());
    EXPECT_NEAR(stand["margin_with_all_mm"].get<double>(),
                plain["strength_and_balance"]["footing_margin_after_mm"].get<double>(), 1e-3);
    EXPECT_EQ(stand["voids_to_choose_from"], plain["voids"]["count"]);
    EXPECT_GE(stand["voids_left_out"].get<int>(), 1);
    EXPECT_EQ(report["voids"]["count"].get<int>() + stand["voids_left_out"].get<int>(),
              plain["voids"]["count"].get<int>());
    // Who asks for less gets more removed.
    EXPECT_GE(less["volume"]["removed_percent"].get<double>(),
              report["volume"]["removed_percent"].get<double>());
    EXPECT_EQ(plain["stand"], nullptr);
  }
}

TEST(Stand, WhatStandsAnywayIsLeftAsItIs) {
  const Job job;
  const auto model = job.input("block.stl", block());
  const Json plain = json_of(job.hollow(model));
  const std::string bytes = read_bytes(job.output());
  const Json report = json_of(job.hollow(model, {"--stand=-2"}));
  EXPECT_EQ(read_bytes(job.output()), bytes);
  EXPECT_EQ(report["stand"]["voids_left_out"], 0);
  const ProcessResult text = run(job.hollow(model, {"--stand=-2"}));
  EXPECT_TRUE(contains(text.out, "inside what it stands on"));
}

// An L that lies on its short side: voids in the arm alone let it stand.
TEST(Stand, AModelThatFallsOverSolidStandsWithVoidsWellChosen) {
  const Job job;
  const Mesh arm = make_box({0, 0, 30}, {75, 30, 60});
  const Mesh foot = make_box({0, 0, 0}, {30, 30, 30.5F});
  const auto model = job.input("arm.stl", join(foot, arm));
  const ProcessResult overlap = run(job.hollow(model, {"--stand"}));
  EXPECT_EQ(overlap.exit_code, kUsage);
  EXPECT_TRUE(contains(overlap.err, "overlap"));
  EXPECT_EQ(entries_of(job.outputs()), std::vector<std::string>{});

  const Json report = json_of(job.hollow(model, {"--stand", "--surface", "remesh"}));
  ASSERT_FALSE(report.is_null());
  EXPECT_LT(report["stand"]["margin_before_mm"].get<double>(), 0);
  EXPECT_GE(report["stand"]["margin_after_mm"].get<double>(), 0);
}

TEST(Stand, WhatCannotStandIsRefusedWithFigures) {
  const Job job;
  const auto refused = [&](const Mesh& mesh, const std::vector<std::string>& options, int exit_code) {
    const ProcessResult result = run(job.hollow(job.input("model.stl", mesh), options));
    EXPECT_EQ(result.exit_code, exit_code) << result.err;
    EXPECT_EQ(entries_of(job.outputs()), std::vector<std::string>{});
    return result.err;
  };
  const std::string why = refused(block(), {"--stand=14"}, kNothing);
  for (const char* part :
       {"model.stl", "29.00 mm inside", "15.00 mm inside that without voids", "too little"})
    EXPECT_TRUE(contains(why, part));
  EXPECT_TRUE(contains(refused(block(), {"--stand", "--up", "1,1,1"}, kNothing), "tip or an edge"));
  EXPECT_TRUE(
      contains(refused(block(), {"--stand", "--target-saving", "5"}, kUsage), "--stand and a target"));
  EXPECT_TRUE(contains(refused(block(), {"--stand=far"}, kUsage), "far"));
  const ProcessResult modifiers = run({AERATE_EXECUTABLE, "hollow", job.input("block.stl", block()), "-o",
                                       job.output("out.3mf"), "--as", "modifiers", "--stand"});
  EXPECT_EQ(modifiers.exit_code, kUsage);
  EXPECT_TRUE(contains(modifiers.err, "--stand with --as modifiers"));
}

}  // namespace
}  // namespace aerate::test
