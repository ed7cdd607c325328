#include <algorithm>
#include <filesystem>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "tests/cli/job.h"
#include "tests/support/caught.h"

// --drain-cavities: cavities that a model has itself are opened.
namespace aerate::test {
namespace {

using Json = nlohmann::json;

constexpr int kUsage = 2, kNothing = 5;

// A block of 70 x 40 x 40 mm with a cavity at its end, and room for voids beside it.
Mesh block_with(const Mesh& cavity) {
  return join(make_box({0, 0, 0}, {70, 40, 40}), turned_inside_out(cavity));
}

Mesh with_box() {
  return block_with(make_box({45, 10, 10}, {65, 30, 35}));
}

Mesh ball_at(Vec3f place, double radius) {
  return moved(make_uv_sphere(radius, 24, 48), place);
}

Json json_of(std::vector<std::string> command) {
  command.insert(command.end(), {"--json", "-"});
  const ProcessResult result = run(command);
  EXPECT_EQ(result.exit_code, 0) << result.err;
  return result.exit_code == 0 ? Json::parse(result.out) : Json();
}

// What another way of looking at the written file finds.
Json inspected(const Job& job) {
  return json_of({AERATE_EXECUTABLE, "inspect", "--drainage", "--process", "sla", job.output()})["drainage"];
}

void expect_drained(const Job& job, const Json& report) {
  EXPECT_EQ(report["drainage"]["sealed_cavities"], 0);
  EXPECT_EQ(report["drainage"]["cavities_of_model"], 0);
  const Json found = inspected(job);
  EXPECT_EQ(found["sealed"]["count"], 0) << found["verdict"];
  EXPECT_TRUE(found["drains"].get<bool>()) << found["verdict"];
}

TEST(OpenCavities, EachGetsALowAndAHighHoleAndTheFileDrains) {
  for (const std::string shape : {"cells", "spheres"}) {
    const Job job;
    const auto model = job.input("block.stl", with_box());
    const std::vector<std::string> options{"--process", "sla", "--shape", shape};
    if (shape == "spheres") {
      const Json closed = json_of(job.hollow(model, options));
      EXPECT_EQ(closed["opened_cavities"], nullptr);
      EXPECT_TRUE(contains(closed["notices"].dump(), "the model itself has 1 sealed cavity"));
      std::filesystem::remove(job.output());
    }
    const Json report =
        json_of(job.hollow(model, {"--process", "sla", "--shape", shape, "--drain-cavities"}));
    ASSERT_FALSE(report.is_null());
    const Json& opened = report["opened_cavities"];
    EXPECT_EQ(opened["count"], 1);
    EXPECT_NEAR(opened["volume_mm3"].get<double>(), 20 * 20 * 25, 1e-6);
    const Json& holes = opened["cavities"][0]["holes"];
    ASSERT_EQ(holes.size(), 2U);
    EXPECT_LT(holes[0]["place_mm"][2], 15);
    EXPECT_GT(holes[1]["place_mm"][2], 30);
    double removed = 0;
    for (const Json& hole : holes) {
      EXPECT_EQ(hole["diameter_mm"], 3.5);
      removed += 3.14159 / 4 * 3.5 * 3.5 * hole["length_mm"].get<double>();
    }
    EXPECT_NEAR(opened["removed_by_holes_mm3"].get<double>(), removed, 0.2 * removed);
    EXPECT_FALSE(contains(report["notices"].dump(), "the model itself has"));
    EXPECT_GT(report["voids"]["count"], 0);
    // Voids beside the cavity and its holes keep the wall.
    EXPECT_GE(report["measured"]["wall_mm"].get<double>(), 2 - 1e-6);
    EXPECT_GT(opened["hollows_mm3"].get<double>(), 20 * 20 * 25);
    EXPECT_LT(opened["pools_of_file"]["after_both_percent"].get<double>(), 3);
    expect_drained(job, report);
  }
}

TEST(OpenCavities, RoundOnesAndSeveralAndThinWalls) {
  const Job job;
  // One is 2 mm below the surface, one 1.2 mm.
  const Mesh two = join(block_with(ball_at({57, 20, 20}, 10)), turned_inside_out(ball_at({8.2F, 20, 20}, 7)));
  const auto model = job.input("two.stl", two);
  const Json report =
      json_of(job.hollow(model, {"--process", "sla", "--shape", "spheres", "--drain-cavities"}));
  ASSERT_FALSE(report.is_null());
  const Json& opened = report["opened_cavities"];
  EXPECT_EQ(opened["count"], 2);
  EXPECT_EQ(opened["holes"], 4);
  EXPECT_GT(opened["cavities"][0]["volume_mm3"], opened["cavities"][1]["volume_mm3"]);
  expect_drained(job, report);
}

TEST(OpenCavities, HolesComeOutWhereTheyMay) {
  const Job job;
  const auto model = job.input("block.stl", with_box());
  const Json report = json_of(job.hollow(model, {"--process", "sla", "--shape", "spheres", "--drain-cavities",
                                                 "--holes-on", "right", "--holes-on", "left"}));
  ASSERT_FALSE(report.is_null());
  for (const Json& hole : report["opened_cavities"]["cavities"][0]["holes"]) {
    EXPECT_NEAR(hole["place_mm"][0].get<double>(), 70, 1e-3);
    EXPECT_GT(hole["outwards"][0], 0.5);
  }
  EXPECT_EQ(report["opened_cavities"]["holes"], 2);
  expect_drained(job, report);
}

TEST(OpenCavities, HolesKeepOffWhatStaysSolid) {
  const Job job;
  const auto model = job.input("block.stl", with_box());
  // All of the wall on the right and behind.
  const Json report =
      json_of(job.hollow(model, {"--process", "sla", "--shape", "spheres", "--drain-cavities", "--keep-solid",
                                 "box:66,0,0,70,40,40", "--keep-solid", "box:45,31,0,66,40,40"}));
  ASSERT_FALSE(report.is_null());
  for (const Json& hole : report["opened_cavities"]["cavities"][0]["holes"]) {
    EXPECT_LT(hole["place_mm"][0], 66 - 3.5 / 2);
    EXPECT_LT(hole["place_mm"][1], 31 - 3.5 / 2);
  }
  expect_drained(job, report);
}

TEST(OpenCavities, OneThatNoHoleLeadsOutOfIsNamed) {
  const Job job;
  const auto refused = [&](const Mesh& mesh, const std::vector<std::string>& options, int exit_code) {
    std::vector<std::string> all{"--process", "sla", "--shape", "spheres", "--drain-cavities"};
    all.insert(all.end(), options.begin(), options.end());
    const ProcessResult result = run(job.hollow(job.input("model.stl", mesh), all));
    EXPECT_EQ(result.exit_code, exit_code) << result.err;
    EXPECT_EQ(entries_of(job.outputs()), std::vector<std::string>{});
    return result.err;
  };
  const Mesh small = block_with(make_box({55, 19, 19}, {57, 21, 21}));
  const std::string why = refused(small, {}, kNothing);
  for (const char* part : {"model.stl", "(56.00, 20.00, 20.00)", "8.000 mm3", "--hole-diameter"})
    EXPECT_TRUE(contains(why, part));
  EXPECT_TRUE(
      contains(refused(with_box(), {"--no-drain"}, kUsage), "--drain-cavities is for voids that drain"));
  const ProcessResult modifiers = run({AERATE_EXECUTABLE, "hollow", job.input("box.stl", with_box()), "-o",
                                       job.output("out.3mf"), "--as", "modifiers", "--drain-cavities"});
  EXPECT_EQ(modifiers.exit_code, kUsage);
  EXPECT_TRUE(contains(modifiers.err, "--drain-cavities"));
}

// A model that is all wall has no room for voids.
TEST(OpenCavities, AHollowModelIsOpenedThoughNoVoidFits) {
  const Job job;
  const Mesh shell =
      join(make_box({0, 0, 0}, {34, 34, 34}), turned_inside_out(make_box({2, 2, 2}, {32, 32, 32})));
  const auto model = job.input("shell.stl", shell);
  EXPECT_EQ(run(job.hollow(model, {"--process", "sla", "--shape", "spheres"})).exit_code, kNothing);
  const Json report =
      json_of(job.hollow(model, {"--process", "sla", "--shape", "spheres", "--drain-cavities"}));
  ASSERT_FALSE(report.is_null());
  EXPECT_EQ(report["voids"]["count"], 0);
  EXPECT_EQ(report["opened_cavities"]["holes"], 2);
  EXPECT_TRUE(contains(report["notices"].dump(), "no voids are made"));
  const Json found = inspected(job);
  EXPECT_TRUE(found["drains"].get<bool>()) << found["verdict"];
  EXPECT_EQ(found["holes"].size(), 2U);
  EXPECT_NEAR(found["thinnest_wall_mm"].get<double>(), 2, 0.05);
  const ProcessResult text =
      run(job.hollow(model, {"--process", "sla", "--shape", "spheres", "--drain-cavities"}));
  EXPECT_EQ(text.exit_code, 0);
  EXPECT_FALSE(text.out.find("inf") != std::string::npos) << text.out;
}

TEST(OpenCavities, AModelWithoutAnyIsHollowedAsEver) {
  const Job job;
  const auto model = job.input("block.stl", make_box({0, 0, 0}, {60, 40, 40}));
  const Json plain = json_of(job.hollow(model, {"--process", "sla", "--shape", "spheres"}));
  const std::string bytes = read_bytes(job.output());
  const Json report =
      json_of(job.hollow(model, {"--process", "sla", "--shape", "spheres", "--drain-cavities"}));
  EXPECT_EQ(report["opened_cavities"]["count"], 0);
  EXPECT_TRUE(contains(report["notices"].dump(), "no sealed cavity of its own"));
  EXPECT_EQ(read_bytes(job.output()), bytes);
}

}  // namespace
}  // namespace aerate::test
