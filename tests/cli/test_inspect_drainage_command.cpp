#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "tests/cli/job.h"
#include "tests/support/caught.h"
#include "tests/support/hollow_boxes.h"

// `inspect --drainage`, and what `hollow` says of its own results beside it.
namespace aerate::test {
namespace {

using Json = nlohmann::json;

Json json_of(std::vector<std::string> command) {
  command.insert(command.end(), {"--json", "-"});
  const ProcessResult result = run(command);
  EXPECT_EQ(result.exit_code, 0) << result.err;
  return result.exit_code == 0 ? Json::parse(result.out) : Json();
}

std::vector<std::string> inspect(const std::filesystem::path& model,
                                 const std::vector<std::string>& more = {}) {
  std::vector<std::string> command{AERATE_EXECUTABLE, "inspect", model, "--drainage"};
  command.insert(command.end(), more.begin(), more.end());
  return command;
}

double distance(const Json& a, const Json& b) {
  return std::hypot(a[0].get<double>() - b[0].get<double>(), a[1].get<double>() - b[1].get<double>(),
                    a[2].get<double>() - b[2].get<double>());
}

// What columns find of a result agrees with what its plan says: volumes within two hundredths of the voids.
void expect_agreement(const Json& planned, const Json& found) {
  const double voids = planned["volume"]["removed_mm3"];
  for (const char* pool : {"print_orientation_mm3", "upside_down_mm3", "after_both_mm3"})
    EXPECT_NEAR(found["drainage"]["pools"][pool].get<double>(),
                planned["drainage"]["pools"][pool].get<double>(), 0.02 * voids)
        << pool;
  double volume = 0;
  for (const Json& hollow : found["drainage"]["hollows"]) volume += hollow["volume_mm3"].get<double>();
  EXPECT_NEAR(volume, voids, 0.01 * voids);
  const Json& holes = found["drainage"]["holes"];
  EXPECT_EQ(holes.size(), planned["drainage"]["holes"].size());
  for (const Json& hole : planned["drainage"]["holes"]) {
    const bool is_found = std::ranges::any_of(holes, [&](const Json& other) {
      return distance(hole["place_mm"], other["place_mm"]) < 3 &&
             std::abs(hole["diameter_mm"].get<double>() - other["width_mm"].get<double>()) < 0.35;
    });
    EXPECT_TRUE(is_found) << hole;
  }
  EXPECT_EQ(found["drainage"]["drains"], true) << found["drainage"]["verdict"];
}

TEST(InspectDrainageCommand, AgreesWithThePlanOfCells) {
  const Job job;
  const Json planned = json_of(job.hollow(sample("bunny.stl"), {"--process", "sla", "--cell-size", "21"}));
  const Json found = json_of(inspect(job.output()));
  expect_agreement(planned, found);
  EXPECT_NEAR(found["drainage"]["thinnest_wall_mm"].get<double>(),
              planned["measured"]["wall_mm"].get<double>(), 0.2);
  // The same cups, on columns of another width.
  const double area = planned["cups"]["widest"]["area_mm2"];
  EXPECT_NEAR(found["drainage"]["cups"]["widest"]["area_mm2"].get<double>(), area, 0.05 * area + 2);
}

TEST(InspectDrainageCommand, AgreesWithThePlanOfSpheresAlongAnotherUp) {
  const Job job;
  const std::vector<std::string> up{"--process", "sls", "--up", "1,2,3"};
  std::vector<std::string> spheres = up;
  spheres.insert(spheres.end(), {"--shape", "spheres"});
  const Json planned =
      json_of(job.hollow(job.input("block.stl", make_box({0, 0, 0}, {50, 40, 40})), spheres));
  expect_agreement(planned, json_of(inspect(job.output(), up)));
  EXPECT_TRUE(planned["cups"].is_null());  // powder is pulled off nothing
}

TEST(InspectDrainageCommand, AHangingPrintIsTurnedRound) {
  const Job job;
  const auto box = job.input("box.stl", hollow_box({BoxHole::top}));
  const Json standing = json_of(inspect(box))["drainage"],
             hanging = json_of(inspect(box, {"--build", "hanging"}))["drainage"];
  EXPECT_EQ(standing["pools"]["print_orientation_mm3"], hanging["pools"]["upside_down_mm3"]);
  EXPECT_EQ(standing["pools"]["upside_down_mm3"], hanging["pools"]["print_orientation_mm3"]);
  EXPECT_EQ(standing["cups"], hanging["cups"]);
  EXPECT_TRUE(contains(standing["verdict"].get<std::string>(), "drains once it is turned over"));
  EXPECT_TRUE(contains(hanging["verdict"].get<std::string>(), "a suction cup of 9"));
}

TEST(InspectDrainageCommand, SuctionIsANoticeOfAHangingPrintAlone) {
  const Job job;
  const auto box = job.input("box.stl", hollow_box({BoxHole::top}));
  EXPECT_FALSE(contains(run(inspect(box)).err, "suction"));
  const ProcessResult hanging = run(inspect(box, {"--build", "hanging"}));
  EXPECT_TRUE(contains(hanging.err, "suction: 9"));
  EXPECT_TRUE(contains(hanging.err, "an escape hole near"));
  EXPECT_FALSE(contains(run(inspect(box, {"--build", "hanging", "--process", "sls"})).err, "suction"));
}

TEST(InspectDrainageCommand, HollowTellsOfSuctionWhereHolesAreAskedForOnTop) {
  const Job job;
  const auto block = job.input("block.stl", make_box({0, 0, 0}, {50, 40, 40}));
  const std::vector<std::string> on_top{"--process",     "sla",      "--escape-hole", "12,20,40",
                                        "--escape-hole", "38,20,40", "--build",       "hanging"};
  const ProcessResult result = run(job.hollow(block, on_top));
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_TRUE(contains(result.err, "suction: "));
  EXPECT_TRUE(contains(result.out, "suction where the layer is pulled off"));
}

TEST(InspectDrainageCommand, ASealedBoxDoesNotDrain) {
  const Job job;
  const Json found = json_of(inspect(job.input("box.stl", hollow_box({}))))["drainage"];
  EXPECT_EQ(found["drains"], false);
  EXPECT_EQ(found["sealed"]["count"], 1);
  EXPECT_NEAR(found["sealed"]["volume_mm3"].get<double>(), kHollowOfBox, 1e-3);
  EXPECT_EQ(found["verdict"], "does not drain: 1 sealed cavity of 27000.0 mm3");
}

TEST(InspectDrainageCommand, HollowTellsOfTheModelsOwnCavities) {
  const Job job;
  const Mesh cavity = turned_inside_out(make_box({5, 5, 5}, {15, 15, 15}));
  const auto model = job.input("block.stl", join(make_box({0, 0, 0}, {60, 40, 40}), cavity));
  const ProcessResult result = run(job.hollow(model, {"--process", "sla", "--shape", "spheres"}));
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_TRUE(contains(result.err,
                       "the model itself has 1 sealed cavity (1000.0 mm3, near (10.00, 10.00, 10.00) mm)"));
  EXPECT_FALSE(contains(run(job.hollow(model, {})).err, "sealed cavity"));  // filament leaves nothing in it
}

TEST(InspectDrainageCommand, AnOpenModelCannotBeTold) {
  const Job job;
  Mesh open = make_box({0, 0, 0}, {30, 30, 30});
  open.triangles.pop_back();
  const Json found = json_of(inspect(job.input("open.stl", open)))["drainage"];
  EXPECT_TRUE(found["drains"].is_null());
  EXPECT_TRUE(contains(found["verdict"].get<std::string>(), "cannot be told"));
}

TEST(InspectDrainageCommand, RefusesWhatSaysNothingOfDrainage) {
  const Job job;
  const auto box = job.input("box.stl", hollow_box({}));
  constexpr int kUsage = 2;
  const ProcessResult alone = run({AERATE_EXECUTABLE, "inspect", box, "--build", "hanging"});
  EXPECT_EQ(alone.exit_code, kUsage);
  EXPECT_TRUE(contains(alone.err, "add --drainage"));
  const ProcessResult filament = run(inspect(box, {"--process", "fdm"}));
  EXPECT_EQ(filament.exit_code, kUsage);
  EXPECT_TRUE(contains(filament.err, "fdm leaves nothing in voids"));
  const ProcessResult sealed = run(job.hollow(box, {"--no-drain", "--build", "hanging"}));
  EXPECT_EQ(sealed.exit_code, kUsage);
  EXPECT_TRUE(contains(sealed.err, "--build is for voids that drain"));
}

}  // namespace
}  // namespace aerate::test
