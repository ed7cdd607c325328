#include <algorithm>
#include <functional>
#include <gtest/gtest.h>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "check/check_written.h"
#include "check/crossings.h"
#include "core/error.h"
#include "core/overhang.h"
#include "files/weld.h"
#include "mesh/outward_shells.h"
#include "packing/adaptive.h"
#include "packing/plan_drainage.h"
#include "packing/tube_through.h"
#include "pipeline/drain.h"
#include "pipeline/keep_solid.h"
#include "pipeline/solid_file.h"
#include "printing/carve_drained.h"
#include "tests/support/caught.h"
#include "tests/support/files.h"
#include "tests/support/shapes.h"
#include "tests/support/temporary_folder.h"

namespace aerate {
namespace {

using test::contains;
using test::message_of;

// A block that drains; a test damages the result, or what is expected of it, and looks whether that is found.
class CheckDrained : public testing::Test {
 protected:
  struct Sound {
    Mesh model;
    Packing packing;
    DrainagePlan plan;
    Solid solid;
  };

  CheckDrained() : CheckDrained(sound_block()) {}
  explicit CheckDrained(const Sound& sound)
      : model_(sound.model), packing_(sound.packing), plan_(sound.plan), solid_(sound.solid) {}

  // Made once for all tests.
  static const Sound& sound_block() {
    static const Sound sound = drain(test::make_box({0, 0, 0}, {40, 30, 30}));
    return sound;
  }

  static Sound drain(Mesh model) {
    Sound sound{std::move(model), {}, {}, {}};
    Monitor silent;
    const Packing packing = pack_adaptive(sound.model, kLimits, {}, silent);
    const SurfaceIndex surface(sound.model);
    const OutwardShells outward(sound.model, inspect(sound.model), surface);
    const PlannedDrainage planned = plan_drainage(
        {surface, outward.winding()}, packing,
        {.channel_radius = 1.75, .hole_radius = 1.75, .escape_holes = {}},
        [&](const EscapeHole& hole) {
          return may_be_cut(sound.model, surface, {hole.tube, packing.spheres[hole.from]}, kLimits.roof,
                            kTolerance) &&
                 !is_crossed_near(sound.model, surface, hole.tube);
        },
        silent);
    sound.packing = packing;
    sound.packing.spheres.clear();
    for (const std::uint32_t i : planned.kept) sound.packing.spheres.push_back(packing.spheres[i]);
    sound.plan = planned.plan;
    sound.solid =
        carve_drained(sound.model, surface, sound.packing, sound.plan, {.tolerance = kTolerance}, silent);
    return sound;
  }

  OutputFacts check() { return check(as_read_back(solid_.mesh)); }
  OutputFacts check(const Mesh& written) {
    Monitor silent;
    return check_written(written,
                         {.solid = solid_,
                          .model = model_,
                          .surface = SurfaceIndex(model_),
                          .inspection = inspect(model_),
                          .packing = packing_,
                          .drainage = &plan_,
                          .tolerance = tolerance_,
                          .kept = kept_ ? &*kept_ : nullptr},
                         silent);
  }
  // A region that stays solid half a millimetre beside the middle or the end of a tube.
  void keep_beside(const Tube& tube, double share) {
    PreparedModel model;
    model.mesh = model_;
    model.inspection = inspect(model_);
    const Vec3d at = tube.start + (tube.end - tube.start) * share;
    const Vec3d centre = at + frame_of(tube, {0, 0, 1}).across * (tube.radius + 1);
    const std::vector<RegionRequest> regions{{"", BallRegion{centre, 0.5}}};
    Monitor silent;
    kept_ = keep_solid(model, regions, {.load = {}, .weld = {}, .wall = kLimits.wall}, silent);
  }
  void carve() {
    Monitor silent;
    solid_ = carve_drained(model_, SurfaceIndex(model_), packing_, plan_, {.tolerance = tolerance_}, silent);
  }
  void expect_found(const std::string& said) {
    EXPECT_TRUE(contains(message_of<FailureError>([&] { check(); }), said));
  }

  static constexpr PackingLimits kLimits{.wall = 2, .gap = 1, .min_radius = 2.5, .max_radius = 6};
  static constexpr double kTolerance = 0.05;

  double tolerance_ = kTolerance;
  std::optional<KeptSolid> kept_;
  Mesh model_;
  Packing packing_;
  DrainagePlan plan_;
  Solid solid_;
};

TEST_F(CheckDrained, MeasuresASoundResult) {
  const OutputFacts facts = check();
  EXPECT_EQ(facts.void_count, packing_.spheres.size());
  EXPECT_EQ(facts.drainage->sealed_cavities, 0U);
  EXPECT_EQ(facts.drainage->cavities_of_model, 0U);
  EXPECT_GE(facts.drainage->channel_wall, 2 - 0.025);
  EXPECT_GE(facts.clearances.wall, 2);
  EXPECT_GE(facts.clearances.gap.value(), 1 - 1e-6);
  EXPECT_NEAR(facts.volume_before, 36000, 1e-6);
  EXPECT_NEAR(facts.volume_after, signed_volume(solid_.mesh), 1e-3);
  EXPECT_LE(facts.void_deviation, tolerance_);
  EXPECT_GT(facts.drainage->cut_triangles, 0U);
}

TEST_F(CheckDrained, AMovedTriangleOfTheOuterSurface) {
  solid_.mesh.positions[solid_.mesh.triangles[0][0]].x += 0.01F;
  expect_found("is not the one of the model");
}

TEST_F(CheckDrained, AChannelOrAHoleBesideWhatStaysSolid) {
  keep_beside(plan_.channels[0].tube, 0.5);
  expect_found("beside a region that stays solid");
  keep_beside(plan_.holes[0].tube, 1);
  expect_found("beside a region that stays solid");
}

TEST_F(CheckDrained, AnOpenEdge) {
  solid_.mesh.triangles.pop_back();
  --solid_.parts.back().triangle_count;
  expect_found("open edges");
}

TEST_F(CheckDrained, AMovedVoid) {
  packing_.spheres[0].centre.x += 0.5;
  expect_found("void 0: it ");
}

TEST_F(CheckDrained, ATubeThatIsTooWide) {
  plan_.holes[0].tube.radius -= 0.2;
  expect_found("escape hole 0: it reaches");
}

TEST_F(CheckDrained, AWallThatIsTooThin) {
  packing_.limits.wall = 2.2;
  expect_found("the limit 2.2 mm");
}

TEST_F(CheckDrained, AGapThatIsTooThin) {
  packing_.limits.gap = 1.2;
  expect_found("1.2 mm");
}

TEST_F(CheckDrained, CutsAwayFromHoles) {
  // Every hole as if it came out elsewhere, outside the model.
  for (EscapeHole& hole : plan_.holes) {
    hole.tube.start = hole.tube.start + Vec3d{0, 0, 200};
    hole.tube.end = hole.tube.end + Vec3d{0, 0, 200};
  }
  expect_found("was cut away from every escape hole");
}

// The same voids without their channels and holes: shells of their own.
TEST_F(CheckDrained, SealedVoids) {
  plan_.channels.clear();
  plan_.holes.clear();
  carve();
  expect_found(std::to_string(packing_.spheres.size()) + " cavities are sealed");
}

TEST_F(CheckDrained, AVoidThatNoChannelJoins) {
  const std::uint32_t last = plan_.channels.back().to;
  std::erase_if(plan_.channels, [&](const Channel& c) { return c.from == last || c.to == last; });
  std::erase_if(plan_.holes, [&](const EscapeHole& hole) { return hole.from == last; });
  carve();
  expect_found("sealed");
}

TEST_F(CheckDrained, AChannelThatWasForgotten) {
  const DrainagePlan whole = plan_;
  plan_.channels.pop_back();
  carve();
  plan_ = whole;
  expect_found("were planned");
}

TEST_F(CheckDrained, MoreIsRemovedThanPlanned) {
  for (Sphere& ball : packing_.spheres) ball.radius += 0.02;
  tolerance_ = 0.2;
  EXPECT_NO_THROW(check());  // coarser by that, but within what is expected
  tolerance_ = 0.001;
  expect_found("inside its planned shape");
}

// Two voids with roofs, joined by a level channel, each with a hole below it.
class CheckDrainedRoofs : public CheckDrained {
 protected:
  void carve(double channel_radius) {
    packing_.limits.roof = make_roof({.degrees = 45, .bridge = 2, .up = {0, 0, 1}});
    packing_.spheres = {{{12, 15, 11}, 6, SphereKind::adaptive}, {{28, 15, 11}, 6, SphereKind::adaptive}};
    plan_ = {};
    plan_.roof = packing_.limits.roof;
    plan_.network_count = 1;
    const std::vector<VoidShape> voids = shapes_of(packing_.spheres, packing_.limits.roof);
    plan_.channels.push_back(
        {0, 1,
         tube_between(voids[0], voids[1], voids[0].centre(), voids[1].centre(), channel_radius).value()});
    for (std::uint32_t i = 0; i < 2; ++i) {
      Tube tube = tube_out_of(voids[i], voids[i].centre(), {0, 0, -1}, 1, 2.5).value();
      tube.end.z = 0;
      plan_.holes.push_back({i, tube, 0});
    }
    CheckDrained::carve();
  }
};

TEST_F(CheckDrainedRoofs, CeilingsAreMeasured) {
  carve(1.4);
  const OutputFacts facts = check();
  EXPECT_EQ(facts.roof_count, 2U);
  ASSERT_TRUE(facts.ceilings.has_value());
  EXPECT_EQ(facts.ceilings->count, 3U);  // two flat tops and the channel's
  EXPECT_NEAR(facts.ceilings->widest, 2, tolerance_);
  EXPECT_EQ(facts.drainage->sealed_cavities, 0U);
}

TEST_F(CheckDrainedRoofs, AChannelThatIsWiderThanTheBridge) {
  carve(2);
  expect_found("a ceiling is 2.");
}

// A plan that its result does not follow: the job fails, and what was there before is left alone.
TEST_F(CheckDrained, WhatFailsIsNeverWritten) {
  const test::TemporaryFolder folder;
  const auto write = [&](const std::string& name) {
    Monitor silent;
    AnnouncedFile pending(folder.path() / name, silent);
    write_beside(
        solid_, &pending, {}, [&](const Mesh& written) { check(written); }, silent);
    pending.file().commit();
  };
  write("sound.stl");
  const auto sound = test::read_bytes(folder.path() / "sound.stl");
  EXPECT_EQ(sound.size(), 84 + 50 * solid_.mesh.triangles.size());

  // A channel that leads elsewhere than planned.
  plan_.channels.front().tube.end = plan_.channels.front().tube.end + Vec3d{0, 0, 1};
  EXPECT_THROW(write("broken.stl"), FailureError);
  EXPECT_THROW(write("sound.stl"), FailureError);
  EXPECT_EQ(test::entries_of(folder.path()), std::vector<std::string>{"sound.stl"});
  EXPECT_EQ(test::read_bytes(folder.path() / "sound.stl"), sound);
}

// A model with a cavity of its own beside the voids.
class CheckDrainedWithCavity : public CheckDrained {
 protected:
  CheckDrainedWithCavity()
      : CheckDrained(drain(test::join(test::make_box({0, 0, 0}, {40, 30, 60}),
                                      test::turned_inside_out(test::make_box({3, 3, 3}, {37, 27, 30}))))) {}
};

TEST_F(CheckDrainedWithCavity, KeepsItAsItIsAndCountsIt) {
  const OutputFacts facts = check();
  EXPECT_EQ(facts.drainage->cavities_of_model, 1U);
  EXPECT_EQ(facts.drainage->sealed_cavities, 0U);
}

TEST_F(CheckDrainedWithCavity, AHoleIntoTheCavityIsSealed) {
  Monitor silent;
  // The network opened downwards into the cavity alone.
  const SurfaceIndex surface(model_);
  const kernels::HostWinding nothing(model_.positions, {});
  const PlannedDrainage planned = plan_drainage(
      {surface, nothing.view()}, packing_,
      {.channel_radius = 1.75, .hole_radius = 1.75, .escape_holes = {{20, 15, 30}, {12, 15, 30}}},
      [](const EscapeHole&) { return true; }, silent);
  std::vector<Sphere> kept;
  for (const std::uint32_t i : planned.kept) kept.push_back(packing_.spheres[i]);
  packing_.spheres = kept;
  plan_ = planned.plan;
  carve();
  expect_found("sealed");
}

}  // namespace
}  // namespace aerate
