#include <algorithm>
#include <cmath>
#include <filesystem>
#include <gtest/gtest.h>
#include <numbers>
#include <utility>
#include <vector>

#include "core/error.h"
#include "core/facet_distance.h"
#include "core/monitor.h"
#include "core/surface_index.h"
#include "files/load.h"
#include "mesh/inspect.h"
#include "mesh/topology.h"
#include "supports/check_supports.h"
#include "supports/make_supports.h"
#include "tests/support/caught.h"
#include "tests/support/shapes.h"

namespace aerate::test {
namespace {

// A model with its supports, made as the pipeline makes them.
struct Supported {
  explicit Supported(Mesh mesh, const char* process = "fdm", double plate = 0)
      : model(std::move(mesh)),
        index(model),
        rules(*support_rules(*find_process(process))),
        shape(usual_shape(rules)),
        undersides(find_undersides(model, index.winding(), rules, plate, column_spacing(model, rules))) {}

  void make() { supports = make_supports(index, undersides, rules, shape, monitor); }
  Mesh mesh() const { return joined(supports.body, supports.teeth); }
  SupportFacts check(const Mesh& written) {
    return check_supports(written, supports.body.triangles.size(), index, undersides, rules, shape, false,
                          monitor);
  }

  Mesh model;
  SurfaceIndex index;
  SupportRules rules;
  SupportShape shape;
  Undersides undersides;
  Monitor monitor;
  Supports supports;
};

// A stem with a beam across, 25 mm to either side.
Mesh tee() {
  return join(make_box({25, 0, 0}, {35, 20, 30}), make_box({0, 0, 30}, {60, 20, 36}));
}

// An arm over a foot of the model, by default as long as it.
Mesh shelf(float foot = 50) {
  Mesh mesh = join(make_box({0, 0, 0}, {foot, 20, 8}), make_box({0, 0, 8}, {10, 20, 36}));
  return join(mesh, make_box({10, 0, 30}, {50, 20, 36}));
}

TEST(MakeSupports, RidgesLeaveNoCeilingFarFromThem) {
  Supported made(tee());
  made.make();
  const SupportFacts facts = made.check(made.mesh());
  EXPECT_LE(facts.farthest, made.rules.reach + 1.5 * made.undersides.spacing);
  EXPECT_EQ(facts.unsupported_area, 0);
  // A tenth to a fifth of the 1000 mm2 touch.
  EXPECT_GT(facts.contact_area, 60);
  EXPECT_LT(facts.contact_area, 200);
  EXPECT_NEAR(facts.tooth_distance, made.shape.tooth.gap, 0.01);
  EXPECT_GT(facts.body_distance, 0.75);
  ASSERT_TRUE(facts.footing_margin);
  EXPECT_GT(*facts.footing_margin, 1);
}

// A table on a leg whose side leans out by 75 degrees below it, so that what goes down from the table is pushed away.
Mesh leaning_table() {
  Mesh leg = make_box({0, 0, 0}, {23, 20, 60});
  for (Vec3f& p : leg.positions)
    if (p.x > 0 && p.z > 0) p.x = 8;
  return join(leg, make_box({0, 0, 60}, {34, 20, 66}));
}

Mesh beside(Mesh mesh, float by) {
  for (Vec3f& p : mesh.positions) p.x += by;
  return mesh;
}

double body_volume(Mesh model) {
  Supported made(std::move(model));
  made.make();
  const SupportFacts facts = made.check(made.mesh());
  EXPECT_EQ(facts.unsupported_area, 0);
  EXPECT_GE(facts.footing_margin.value_or(0), 0);
  return facts.volume;
}

TEST(MakeSupports, WhatStandsOnThePlateAndOnTheModelNeedsNoWiderFoot) {
  EXPECT_LT(body_volume(shelf(40)), 1.1 * body_volume(shelf()));
}

TEST(MakeSupports, OnlyBodiesThatTipAreDrawnInLess) {
  const double leaning = body_volume(leaning_table()), other = body_volume(tee());
  EXPECT_GT(leaning, 10000);  // drawn in as others are it would fall over
  EXPECT_NEAR(body_volume(join(leaning_table(), beside(tee(), 60))), leaning + other, 0.05 * other);
}

// A wall that leans out by so many degrees below a table, whose edge is a little beyond the wall's foot: what goes straight down from it has little room there.
Mesh table_above_steep_wall(double degrees, float beyond) {
  const double height = 30 * std::tan(degrees * std::numbers::pi / 180);
  Mesh leg = make_box({-10, 0, 0}, {30, 15, static_cast<float>(height)});
  for (Vec3f& p : leg.positions)
    if (p.x > 0 && p.z > 0) p.x = 0;
  return join(
      leg, make_box({-10, 0, static_cast<float>(height)}, {30 + beyond, 15, static_cast<float>(height) + 4}));
}

TEST(MakeSupports, NoBodyEndsAboveASteepSlope) {
  for (const float beyond : {1.0F, 3.0F, 8.0F}) {
    Supported made(table_above_steep_wall(75, beyond));
    made.make();
    EXPECT_NEAR(static_cast<double>(bounding_box(made.supports.body).lower.z), 0, 1e-4) << beyond;
    const SupportFacts facts = made.check(made.mesh());
    EXPECT_EQ(facts.unsupported_area, 0) << beyond;
    EXPECT_GT(facts.footing_margin.value_or(-1), 0) << beyond;
  }
}

// The highest of separate pieces of a mesh, mm, that are more than six times as high as they are long; their vertices are apart.
double highest_needle(const Mesh& mesh) {
  const EdgeUses uses(mesh);
  const ShellLabels labels = label_shells(mesh, uses);
  std::vector<std::vector<Triangle>> pieces(labels.count);
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i)
    pieces[labels.of_triangle[i]].push_back(mesh.triangles[i]);
  double highest = 0;
  for (const std::vector<Triangle>& piece : pieces) {
    const Box3f box = bounding_box(submesh(mesh, piece));
    const Vec3d size = to_double(box.upper) - to_double(box.lower);
    if (size.z > 6 * std::hypot(size.x, size.y)) highest = std::max(highest, size.z);
  }
  return highest;
}

TEST(MakeSupports, NoToothIsANeedle) {
  // Pegs one above the other, whose bodies leave edges beside the pegs below.
  Mesh mesh = make_box({0, 0, 0}, {20, 20, 60});
  for (int i = 0; i < 9; ++i)
    for (int j = 0; j < 5; ++j) {
      const auto y = static_cast<float>(4 * j), z = static_cast<float>(6 * i),
                 end = static_cast<float>(24 + (i + j) % 3 * 3);
      mesh = join(mesh, make_box({19.9F, y + 1, z + 5}, {end, y + 3, z + 6.5F}));
    }
  Supported made(mesh);
  made.make();
  made.check(made.mesh());
  EXPECT_LE(highest_needle(made.supports.teeth), made.shape.tooth.most_alone);
}

TEST(MakeSupports, ASliverBesideTheModelStandsOnThePlate) {
  // 1 mm of a low shelf is beyond the model's foot; smoothing rounds the body below, which is as narrow as two voxels.
  Mesh mesh = join(make_box({0, 0, 0}, {20, 20, 2}), make_box({17, 0, 2}, {20, 20, 5}));
  Supported made(join(mesh, make_box({-1, 4, 3.1F}, {17, 11, 5})));
  made.make();
  EXPECT_GT(made.check(made.mesh()).footing_margin, 0.0);
}

TEST(MakeSupports, ABodyIsAsWideAsItsOwnHeightNeeds) {
  Mesh tall = tee();
  for (Vec3f& p : tall.positions) p.z *= 4;
  EXPECT_NEAR(body_volume(join(tall, beside(tee(), 80))), body_volume(tall) + body_volume(tee()),
              0.02 * body_volume(tee()));
}

Mesh turned_about_z(Mesh mesh, double degrees) {
  const double angle = degrees * std::numbers::pi / 180;
  for (Vec3f& p : mesh.positions) {
    const Vec3d at = to_double(p);
    p = to_float({std::cos(angle) * at.x - std::sin(angle) * at.y,
                  std::sin(angle) * at.x + std::cos(angle) * at.y, at.z});
  }
  return mesh;
}

TEST(MakeSupports, ABridgeThatIsTurnedTakesNoMore) {
  Supported straight(tee());
  straight.make();
  const SupportFacts least = straight.check(straight.mesh());
  for (const double degrees : {10.0, 30.0, 45.0, 100.0}) {
    Supported made(turned_about_z(tee(), degrees));
    made.make();
    const SupportFacts facts = made.check(made.mesh());
    EXPECT_EQ(facts.unsupported_area, 0) << degrees;
    EXPECT_LT(facts.contact_area, 1.1 * least.contact_area) << degrees;
    EXPECT_LT(made.supports.tip_area, 1.1 * straight.supports.tip_area) << degrees;
    EXPECT_LT(facts.volume, 1.1 * least.volume) << degrees;
  }
}

// A plate of 30 x 30 mm that nears the plate of the printer from 1 to 0 mm along x, and a wall at its low end.
TEST(MakeSupports, WhatNearlyLiesOnThePlateIsHeldByItOrByTeeth) {
  Mesh wedge = make_box({0, 0, 0}, {30, 30, 10});
  for (Vec3f& p : wedge.positions)
    if (p.z == 0) p.z = p.x / 30;
  Supported made(wedge);
  made.make();
  const SupportFacts facts = made.check(made.mesh());
  EXPECT_EQ(facts.unsupported_area, 0);
  // What is less than a gap and half a layer above the plate needs none, and what is just above that has some.
  const auto first = static_cast<double>(bounding_box(made.supports.teeth).lower.x);
  EXPECT_GT(first, 0.3 * 30);
  EXPECT_LT(first, 0.3 * 30 + made.rules.reach + made.undersides.spacing);
}

TEST(MakeSupports, AreClosedAndStandOnThePlate) {
  Supported made(tee());
  made.make();
  const Inspection inspection = inspect(made.mesh());
  EXPECT_TRUE(inspection.closed());
  EXPECT_EQ(inspection.non_manifold_edges, 0U);
  for (const Shell& shell : inspection.shells) EXPECT_GT(shell.volume, 0);
  const Box3f box = bounding_box(made.mesh());
  EXPECT_EQ(box.lower.z, 0);
  EXPECT_NEAR(static_cast<double>(box.upper.z), 30 - 0.2, 1e-4);
  // Drawn in: less than what a body straight down would take.
  EXPECT_LT(signed_volume(made.supports.body), 0.5 * 50 * 20 * 29);
}

TEST(MakeSupports, TakeTheGivenPlate) {
  Supported made(tee(), "fdm", -5);
  made.make();
  EXPECT_EQ(bounding_box(made.mesh()).lower.z, -5);
}

TEST(MakeSupports, StandOnTheModelWhereThePlateIsOutOfReach) {
  Supported made(shelf());
  made.make();
  EXPECT_GT(made.supports.foot_count, 2U);
  const SupportFacts facts = made.check(made.mesh());
  EXPECT_EQ(facts.unsupported_area, 0);
  EXPECT_NEAR(static_cast<double>(bounding_box(made.mesh()).lower.z), 8.2, 1e-4);
}

TEST(MakeSupports, ConesAreJoinedToTheModel) {
  for (const char* process : {"sla", "metal"}) {
    Supported made(tee(), process);
    made.make();
    const SupportFacts facts = made.check(made.mesh());
    EXPECT_EQ(facts.unsupported_area, 0);
    EXPECT_LE(facts.farthest, 1 + 1.5 * made.undersides.spacing);
    // They reach into the model by a tenth.
    EXPECT_NEAR(static_cast<double>(bounding_box(made.mesh()).upper.z), 30.1, 1e-4);
    EXPECT_GT(made.supports.tooth_count, 200U);
    EXPECT_NEAR(made.supports.tip_area, static_cast<double>(made.supports.tooth_count) * 3.1416 * 0.04, 1);
  }
}

TEST(MakeSupports, FineVoxelsKeepTheClearanceAboveAFloor) {
  Supported made(shelf(), "metal");
  made.make();
  const SupportFacts facts = made.check(made.mesh());
  EXPECT_GT(facts.body_distance, 0.7);
  EXPECT_EQ(facts.own_unsupported_area.value_or(-1), 0);
}

TEST(MakeSupports, KeepTheirClearanceFromFeaturesThinnerThanVoxels) {
  // A post and a fin of 0.15 mm below the beam, where columns do not see them.
  Mesh mesh = join(tee(), make_box({45.1F, 9.9F, 0}, {45.25F, 10.05F, 30}));
  mesh = join(mesh, make_box({5, 8, 12}, {20, 8.15F, 30}));
  for (const char* process : {"fdm", "metal"}) {
    Supported made(mesh, process);
    made.make();
    const SupportFacts facts = made.check(made.mesh());
    EXPECT_GE(facts.body_distance, 0.75) << process;
  }
}

TEST(MakeSupports, APointThatBeginsInTheAirGetsATooth) {
  Mesh spike;
  spike.positions = {{20, 5, 5}, {15, 0, 15}, {25, 0, 15}, {25, 10, 15}, {15, 10, 15}};
  spike.triangles = {{0, 2, 1}, {0, 3, 2}, {0, 4, 3}, {0, 1, 4}, {1, 2, 3}, {1, 3, 4}};
  Mesh mesh = join(make_box({0, 0, 0}, {10, 10, 20}), make_box({10, 0, 15}, {25, 10, 20}));
  Supported made(join(mesh, spike));
  made.make();
  const SupportFacts facts = made.check(made.mesh());
  EXPECT_LT(facts.unsupported_area, 0.5);
  const kernels::HostWinding solid(made.supports.teeth.positions, made.supports.teeth.triangles);
  // Under the column that is lowest.
  bool is_there = false;
  for (const double x : {-0.3, -0.15, 0.0, 0.15, 0.3})
    for (const double y : {-0.3, -0.15, 0.0, 0.15, 0.3})
      is_there = is_there || solid.view().winding_number({20 + x, 5 + y, 4.6}) != 0;
  EXPECT_TRUE(is_there);
}

TEST(MakeSupports, TheBunnyUpsideDownStandsOnThePlate) {
  // Feet of its body reach past the model.
  Monitor monitor;
  Mesh bunny = load_model(std::filesystem::path(AERATE_SAMPLES) / "bunny.stl").mesh;
  Mesh turned = bunny;
  for (Vec3f& p : turned.positions) p = {p.x, -p.y, -p.z};
  const float low = bounding_box(turned).lower.z;
  for (Vec3f& p : turned.positions) p.z -= low;
  Supported made(turned);
  made.make();
  const SupportFacts facts = made.check(made.mesh());
  EXPECT_LT(facts.unsupported_area, 0.5);
  EXPECT_LT(facts.own_unsupported_area.value_or(kInfinity), 1);
  EXPECT_GE(bounding_box(made.mesh()).lower.z, -1e-4F);
}

TEST(MakeSupports, NothingToDoIsSaid) {
  Supported made(make_box({0, 0, 0}, {20, 20, 20}));
  EXPECT_TRUE(contains(message_of<NothingToRemoveError>([&] { made.make(); }), "nothing needs supports"));
}

TEST(MakeSupports, AreTheSameEveryTime) {
  Supported a(tee()), b(tee());
  a.make();
  b.make();
  EXPECT_EQ(a.mesh().positions, b.mesh().positions);
  EXPECT_EQ(a.mesh().triangles, b.mesh().triangles);
}

class CheckSupports : public testing::Test {
 protected:
  CheckSupports() { made.make(); }

  std::string refusal(const Mesh& written) {
    return message_of<Error>([&] { static_cast<void>(made.check(written)); });
  }

  Supported made{tee()};
};

TEST_F(CheckSupports, RefuseOpenOnes) {
  Mesh open = made.mesh();
  open.triangles.pop_back();
  EXPECT_TRUE(contains(refusal(open), "edges are open"));
}

TEST_F(CheckSupports, RefuseTurnedOnes) {
  Mesh turned = made.mesh();
  for (Triangle& t : turned.triangles) std::swap(t[1], t[2]);
  EXPECT_TRUE(contains(refusal(turned), "face inward"));
}

TEST_F(CheckSupports, RefuseOnesBelowThePlate) {
  Mesh low = made.mesh();
  for (Vec3f& p : low.positions) p.z -= 1;
  EXPECT_TRUE(contains(refusal(low), "below the plate"));
}

TEST_F(CheckSupports, RefuseABodyThatIsALittleTooNear) {
  Mesh near = made.mesh();
  for (Vec3f& p : near.positions) p.z += 0.5F;  // 0.7 mm below the beam
  EXPECT_TRUE(contains(refusal(near), "0.8 mm were asked for"));
}

TEST_F(CheckSupports, RefuseABodyThatIsTooNear) {
  Mesh near = made.mesh();
  for (Vec3f& p : near.positions) p.z += 0.7F;
  EXPECT_TRUE(contains(refusal(near), "from the model"));
}

TEST_F(CheckSupports, RefuseTeethThatTouch) {
  Mesh touching = made.mesh();
  for (std::size_t i = made.supports.body.positions.size(); i < touching.positions.size(); ++i)
    touching.positions[i].z += 0.18F;
  EXPECT_TRUE(contains(refusal(touching), "a tooth is"));
}

TEST_F(CheckSupports, SeeWhatIsNotHeld) {
  const Mesh body_alone = made.supports.body;
  const SupportFacts facts = made.check(body_alone);
  EXPECT_GT(facts.unsupported_area, 700);
  EXPECT_EQ(facts.contact_area, 0);
  EXPECT_GT(facts.farthest, 20);
}

TEST_F(CheckSupports, RefuseABodyThatHangs) {
  Mesh hanging = made.mesh();
  for (Vec3f& p : hanging.positions) p.z = std::max(p.z, 20.0F);  // its lower half is gone
  made.supports.body.positions.clear();
  EXPECT_TRUE(contains(refusal(hanging), "held by nothing"));
}

TEST_F(CheckSupports, RefuseABodyThatStandsOnNothing) {
  // A block in the air: its underside is held by nothing, and so small that this alone would pass.
  made.supports.body = make_box({2, 2, 10}, {4, 4, 12});
  EXPECT_TRUE(contains(refusal(made.supports.body), "nothing to stand on"));
}

TEST_F(CheckSupports, RefuseABodyThatTipsOver) {
  // On a foot that is not under it.
  Mesh leaning = made.supports.body;
  for (Vec3f& p : leaning.positions) p.y -= p.z * 3;
  made.supports.body = leaning;
  EXPECT_TRUE(contains(refusal(leaning), "tips over"));
}

}  // namespace
}  // namespace aerate::test
