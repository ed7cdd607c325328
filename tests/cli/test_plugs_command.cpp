#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "tests/cli/job.h"
#include "tests/support/caught.h"

// --plugs: a second output, which is there with the first or not at all.
namespace aerate::test {
namespace {

using Json = nlohmann::json;
using Names = std::vector<std::string>;

constexpr int kFailure = 1;
constexpr int kUsage = 2;

Mesh block_of_50() {
  return make_box({0, 0, 0}, {50, 40, 40});
}

Names spheres_of(const std::string& process) {
  return {"--process", process, "--shape", "spheres"};
}

ProcessResult run_with_plugs(const Job& job, const std::string& plugs, const Names& more) {
  Names command = job.hollow(job.input("block.stl", block_of_50()), {"--plugs", plugs});
  command.insert(command.end(), more.begin(), more.end());
  return run(command);
}

Json inspected(const std::filesystem::path& path) {
  const ProcessResult result =
      run({AERATE_EXECUTABLE, "inspect", path, "--self-intersections", "--json", "-"});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  return Json::parse(result.out);
}

TEST(PlugsCommand, EachHoleHasItsPlugInTheReportAndInTheFile) {
  for (const char* process : {"sla", "sls", "metal"}) {
    for (const char* name : {"plugs.stl", "plugs.3mf"}) {
      const Job job;
      Names more = spheres_of(process);
      more.insert(more.end(), {"--json", "-"});
      const ProcessResult result = run_with_plugs(job, job.output(name), more);
      ASSERT_EQ(result.exit_code, 0) << result.err;
      const Json drainage = Json::parse(result.out).at("drainage");
      const Json& plugs = drainage.at("plugs");
      ASSERT_EQ(plugs["count"], drainage["holes"].size());
      const Json file = inspected(job.output(name));
      EXPECT_EQ(file["input"]["shells"], plugs["count"]);
      EXPECT_TRUE(file["input"]["closed"].get<bool>());
      EXPECT_EQ(file["self_intersections"]["pairs"], 0);
      EXPECT_EQ(file["input"]["box"]["lower_mm"][2], 0);
      EXPECT_NEAR(file["input"]["signed_volume_mm3"].get<double>(), plugs["volume_mm3"].get<double>(), 1e-2);
      // In the order of their numbers, each within its hole.
      double last = 0;
      int number = 0;
      for (const Json& hole : drainage["holes"]) {
        const Json& plug = hole.at("plug");
        EXPECT_EQ(plug["number"], ++number);
        EXPECT_TRUE(plug["is_engraved"].get<bool>());
        EXPECT_GT(plug["place_mm"][0].get<double>(), last);
        EXPECT_LE(plug["diameter_mm"].get<double>(),
                  hole["diameter_mm"].get<double>() - 2 * plugs["clearance_mm"].get<double>() + 1e-3);
        EXPECT_LT(plug["inner_diameter_mm"], plug["diameter_mm"]);
        last = plug["place_mm"][0];
      }
    }
  }
}

TEST(PlugsCommand, TheModelIsTheSameWithAndWithoutPlugs) {
  const Job with, without;
  ASSERT_EQ(run_with_plugs(with, with.output("plugs.stl"), spheres_of("sla")).exit_code, 0);
  ASSERT_EQ(run(without.hollow(without.input("block.stl", block_of_50()), spheres_of("sla"))).exit_code, 0);
  EXPECT_EQ(read_bytes(with.output()), read_bytes(without.output()));
}

TEST(PlugsCommand, LimitsAreThoseGivenOrOfTheProcess) {
  const Job job;
  Names more = spheres_of("sls");
  more.insert(more.end(), {"--plug-clearance", "0.4", "--json", "-"});
  const ProcessResult result = run_with_plugs(job, job.output("plugs.stl"), more);
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const Json report = Json::parse(result.out);
  EXPECT_NEAR(report["drainage"]["plugs"]["clearance_mm"].get<double>(), 0.4, 1e-4);
  EXPECT_EQ(report["drainage"]["plugs"]["taper_degrees"], 2);
  Names origins;
  for (const Json& limit : report["process"]["limits"])
    if (limit["limit"].get<std::string>().starts_with("plug-")) origins.push_back(limit["origin"]);
  EXPECT_EQ(origins, (Names{"command line", "default of sls"}));
}

TEST(PlugsCommand, BadInputLeavesNeitherFile) {
  const Job job;
  const auto refused = [&](const std::string& plugs, const Names& more, int exit_code,
                           const std::string& said) {
    const ProcessResult result = run_with_plugs(job, plugs, more);
    EXPECT_EQ(result.exit_code, exit_code) << result.err;
    EXPECT_TRUE(contains(result.err, said));
    EXPECT_EQ(entries_of(job.outputs()), Names{});
  };
  const Names sla = spheres_of("sla");
  const std::string plugs = job.output("plugs.stl"), model = job.folder() / "block.stl";
  refused(plugs, {}, kUsage, "--plugs is for voids that drain");
  refused(plugs, {"--process", "sla", "--no-drain"}, kUsage, "--plugs is for voids that drain");
  refused(plugs, {"--as", "modifiers"}, kUsage, "--as modifiers leaves no holes");
  refused(job.output(), sla, kUsage, "would be written twice");
  refused(job.outputs().string() + "/./out.stl", sla, kUsage, "would be written twice");
  refused(model, sla, kUsage, "the output is the model itself");
  refused(job.output("plugs.step"), sla, kUsage, "plugs.step");
  refused(job.folder() / "nowhere" / "plugs.stl", sla, kFailure, "nowhere");
  refused(plugs, {"--process", "sla", "--json", plugs}, kUsage, "would replace");
  refused(plugs, {"--process", "sla", "--shape", "spheres", "--plug-clearance", "1.7"}, kUsage,
          "no escape hole has room for a plug");
  refused(plugs, {"--process", "sla", "--plug-taper", "31"}, kUsage, "31 degrees is too much");
  const ProcessResult alone =
      run(job.hollow(job.input("block.stl", block_of_50()), {"--process", "sla", "--plug-taper", "3"}));
  EXPECT_EQ(alone.exit_code, kUsage);
  EXPECT_TRUE(contains(alone.err, "--plug-taper is for plugs"));
}

TEST(PlugsCommand, WhatWasThereStaysIfThereIsNoRoom) {
  const Job job;
  std::ofstream(job.output()) << "old model";
  std::ofstream(job.output("plugs.stl")) << "old plugs";
  Names more = spheres_of("sla");
  more.insert(more.end(), {"--plug-clearance", "1.7"});
  EXPECT_EQ(run_with_plugs(job, job.output("plugs.stl"), more).exit_code, kUsage);
  EXPECT_EQ(read_bytes(job.output()), "old model");
  EXPECT_EQ(read_bytes(job.output("plugs.stl")), "old plugs");
}

}  // namespace
}  // namespace aerate::test
