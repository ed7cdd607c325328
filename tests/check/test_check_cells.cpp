#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <gtest/gtest.h>
#include <span>
#include <string>
#include <tbb/global_control.h>
#include <utility>
#include <variant>
#include <vector>

#include "check/check_pieces.h"
#include "check/check_written.h"
#include "core/error.h"
#include "core/overhang.h"
#include "files/weld.h"
#include "packing/packing_cells.h"
#include "printing/cells/carve_drained_cells.h"
#include "printing/cells/shape_cells.h"
#include "tests/support/caught.h"
#include "tests/support/shapes.h"

namespace aerate {
namespace {

using test::contains;
using test::message_of;

constexpr double kTolerance = 0.1;

struct Sound {
  Mesh model;
  Packing packing;
  CellVoids cells;
  DrainagePlan plan;  // of those that drain
  Solid solid;
};

// Spheres in a row along x, in a block that their cells fill.
Sound shape_row(std::size_t count, double fillet) {
  Sound sound;
  sound.model = test::make_box({0, 0, 0}, {15 * static_cast<float>(count), 20, 20});
  sound.packing.limits = {.wall = 2, .gap = 1, .min_radius = 2.5, .max_radius = 8};
  for (std::size_t i = 0; i < count; ++i)
    sound.packing.spheres.push_back({{7.5 + 15.0 * static_cast<double>(i), 10, 10}, 5, SphereKind::adaptive});
  Monitor silent;
  const Box3f box = bounding_box(sound.model);
  sound.cells = shape_cells(SurfaceIndex(sound.model), sound.packing,
                            cells_of(sound.packing, {to_double(box.lower), to_double(box.upper)}, {}, silent),
                            {.fillet = fillet, .tolerance = kTolerance}, silent);
  return sound;
}

// A block with cells; a test damages the result, or what is expected of it, and looks whether that is found.
class CheckCells : public testing::Test {
 protected:
  explicit CheckCells(Sound sound, bool drains) : sound_(std::move(sound)), drains_(drains) {}

  template <typename Check>
  auto held_against_expected(const Check& check) const {
    const SurfaceIndex surface(sound_.model);
    const Inspection inspection = inspect(sound_.model);
    return check(Expected{.solid = sound_.solid,
                          .model = sound_.model,
                          .surface = surface,
                          .inspection = inspection,
                          .packing = sound_.packing,
                          .cells = &sound_.cells,
                          .drainage = drains_ ? &sound_.plan : nullptr,
                          .tolerance = tolerance_});
  }
  OutputFacts check(const Mesh& written) const {
    Monitor silent;
    return check(written, silent);
  }
  OutputFacts check(const Mesh& written, Monitor& monitor) const {
    return held_against_expected(
        [&](const Expected& expected) { return check_written(written, expected, monitor); });
  }
  OutputFacts check() const { return check(as_read_back(mesh())); }
  void expect_found(const std::string& said) const {
    EXPECT_TRUE(contains(message_of<FailureError>([&] { check(); }), said));
  }

  const Mesh& mesh() const { return sound_.solid.mesh; }
  Mesh& mesh() { return sound_.solid.mesh; }
  PackingLimits& limits() { return sound_.packing.limits; }
  CellVoids& cells() { return sound_.cells; }
  std::span<Triangle> triangles_of_void(std::size_t i) {
    const SolidPart& part = sound_.solid.of(PartKind::void_surface)[i];
    return std::span(mesh().triangles).subspan(part.first_triangle, part.triangle_count);
  }
  // The vertex of a void that is farthest in a direction.
  Vec3f& farthest(std::size_t i, Vec3d direction) {
    std::uint32_t best = triangles_of_void(i)[0][0];
    for (const Triangle& t : triangles_of_void(i)) {
      for (const std::uint32_t v : t)
        if (dot(direction, to_double(mesh().positions[v])) >
            dot(direction, to_double(mesh().positions[best])))
          best = v;
    }
    return mesh().positions[best];
  }
  void move_void(std::size_t i, Vec3d by) {
    std::vector<std::uint32_t> vertices;
    for (const Triangle& t : triangles_of_void(i)) vertices.insert(vertices.end(), t.begin(), t.end());
    std::ranges::sort(vertices);
    vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
    for (const std::uint32_t v : vertices)
      mesh().positions[v] = to_float(to_double(mesh().positions[v]) + by);
  }
  // Nothing is asked of where a void's vertices are with respect to other cells.
  void forget_planes() {
    std::ranges::fill(cells().planes.first, 0U);
    cells().planes.planes.clear();
  }
  // Of a void, the two vertices with the smallest triangles round them in its halves along z.
  std::array<std::uint32_t, 2> smallest_fans(std::size_t i) {
    std::vector<double> areas(mesh().positions.size());
    for (const Triangle& t : triangles_of_void(i)) {
      const Vec3d a = to_double(mesh().positions[t[0]]);
      const double area =
          length(cross(to_double(mesh().positions[t[1]]) - a, to_double(mesh().positions[t[2]]) - a));
      for (const std::uint32_t v : t) areas[v] += area;
    }
    std::array<std::uint32_t, 2> best{};
    for (std::uint32_t v = 0; v < areas.size(); ++v) {
      std::uint32_t& half = best[mesh().positions[v].z < 10 ? 0 : 1];
      if (areas[v] > 0 && (half == 0 || areas[v] < areas[half])) half = v;
    }
    return best;
  }

  Sound sound_;
  bool drains_;
  double tolerance_ = kTolerance;
};

class CheckSealedCells : public CheckCells {
 protected:
  CheckSealedCells() : CheckCells(sound_pair(), false) {}

  static const Sound& sound_pair() {
    static const Sound sound = [] {
      Sound pair = shape_row(2, 1);
      pair.solid = carve_cells(pair.model, pair.cells);
      return pair;
    }();
    return sound;
  }
};

TEST_F(CheckSealedCells, MeasuresASoundResult) {
  const OutputFacts facts = check();
  EXPECT_EQ(facts.void_count, 2U);
  EXPECT_EQ(facts.outer_triangle_count, 12U);
  EXPECT_EQ(facts.void_triangle_count, mesh().triangles.size() - 12);
  EXPECT_NEAR(facts.volume_before, 12000, 1e-6);
  EXPECT_NEAR(facts.volume_after, signed_volume(mesh()), 1e-3);
  EXPECT_NEAR(facts.volume_removed, 12000 - signed_volume(mesh()), 1e-3);
  const double planned = cells().voids[0].planned_volume + cells().voids[1].planned_volume;
  EXPECT_NEAR(facts.volume_removed, planned, 0.02 * planned);
  EXPECT_GT(planned, 0.97 * 2 * 12.5 * 16 * 16);
  EXPECT_GE(facts.clearances.wall, 2);
  EXPECT_LE(facts.clearances.wall, 2.001);
  EXPECT_GE(facts.clearances.gap.value(), 1);
  EXPECT_LE(facts.clearances.gap.value(), 1.001);
  EXPECT_EQ(facts.smallest_radius, 5);
  EXPECT_LE(facts.void_deviation, 1.6 * kTolerance);
  EXPECT_GT(facts.void_deviation, 0);
  EXPECT_FALSE(facts.drainage.has_value());
  EXPECT_NEAR(facts.centre_of_mass_after.value().x, 15, 0.01);
}

TEST_F(CheckSealedCells, FactsDoNotDependOnThreads) {
  const Mesh written = as_read_back(mesh());
  const OutputFacts parallel = check(written);
  const tbb::global_control one_thread(tbb::global_control::max_allowed_parallelism, 1);
  const OutputFacts serial = check(written);
  EXPECT_EQ(parallel.volume_removed, serial.volume_removed);
  EXPECT_EQ(parallel.volume_after, serial.volume_after);
  EXPECT_EQ(parallel.clearances.wall, serial.clearances.wall);
  EXPECT_EQ(parallel.clearances.gap, serial.clearances.gap);
  EXPECT_EQ(parallel.void_deviation, serial.void_deviation);
}

TEST_F(CheckSealedCells, FindsAFileThatDiffersFromTheResult) {
  Mesh moved = as_read_back(mesh());
  moved.positions[20].x = std::nextafter(moved.positions[20].x, 100.0F);
  EXPECT_TRUE(contains(message_of<FailureError>([&] { check(moved); }), "is not the one of the result"));
  Mesh shorter = as_read_back(mesh());
  shorter.triangles.pop_back();
  EXPECT_TRUE(contains(message_of<FailureError>([&] { check(shorter); }), "triangles instead of"));
}

TEST_F(CheckSealedCells, FindsAMissingVoid) {
  cells().voids.push_back(cells().voids.back());
  expect_found("3 voids, 0 channels and 0 holes were planned; 2, 0 and 0 made");
}

TEST_F(CheckSealedCells, FindsAVertexBeyondAPlane) {
  farthest(0, {1, 0, 0}).x += 0.001F;
  expect_found("void 0: it passes the plane towards void 1");
}

TEST_F(CheckSealedCells, FindsAVertexTooNearTheModel) {
  farthest(1, {0, 0, 1}).z += 0.001F;
  expect_found("the wall is 1.99");
}

TEST_F(CheckSealedCells, FindsAWallOrAGapThatIsTooThin) {
  limits().wall = 2.01;
  expect_found("the limit 2.01 mm");
  limits().wall = 2;
  limits().gap = 1.01;
  expect_found("the gap between voids 0 and 1 is 1.0");
}

TEST_F(CheckSealedCells, FindsAVoidThatWasMovedTowardsAnother) {
  move_void(1, {-0.01, 0, 0});
  for (CellPlane& plane : cells().planes.planes) plane.offset += 0.02;
  expect_found("the gap between voids 0 and 1 is 0.99");
}

// The voids without the model, as they are read back from a file of their own.
class CheckPieces : public CheckSealedCells {
 protected:
  CheckPieces() { sound_.solid = carve_cells({}, sound_.cells); }
  PieceFacts check_alone(const Mesh& written) const {
    Monitor silent;
    return held_against_expected(
        [&](const Expected& expected) { return check_pieces(written, expected, silent); });
  }
  void expect_found_alone(const std::string& said) const {
    EXPECT_TRUE(contains(message_of<FailureError>([&] { check_alone(as_read_back(mesh())); }), said));
  }
};

TEST_F(CheckPieces, MeasuresASoundResult) {
  const PieceFacts facts = check_alone(as_read_back(mesh()));
  EXPECT_EQ(facts.piece_count, sound_.cells.voids.size());
  EXPECT_EQ(facts.triangle_count, mesh().triangles.size());
  double volume = 0;
  for (const CellVoid& piece : sound_.cells.voids) volume -= signed_volume(piece.surface);
  EXPECT_NEAR(facts.volume, volume, 1e-6 * volume);
  EXPECT_GE(facts.clearances.wall, limits().wall - 1e-6);
  EXPECT_GE(facts.clearances.gap.value(), limits().gap - 1e-6);
  EXPECT_FALSE(facts.ceilings.has_value());
  // Ceilings of cells without roofs are wider than this bridge.
  limits().roof = make_roof({.degrees = 45, .bridge = 3, .up = {0, 0, 1}});
  expect_found_alone("the bridge");
}

TEST_F(CheckPieces, FindsWhatDiffersFromThePieces) {
  Mesh written = as_read_back(mesh());
  written.triangles.pop_back();
  EXPECT_THROW(check_alone(written), FailureError);
  written = as_read_back(mesh());
  std::swap(written.triangles[5][1], written.triangles[5][2]);
  EXPECT_THROW(check_alone(written), FailureError);
  cells().voids.pop_back();
  expect_found_alone("pieces were planned");
}

TEST_F(CheckPieces, FindsPiecesTooNearTheModelOrTurned) {
  farthest(0, {0, 0, 1}).z += 0.5F;
  expect_found_alone("the wall");
  for (Triangle& t : triangles_of_void(0)) std::swap(t[1], t[2]);
  expect_found_alone("not oriented inward");
}

TEST_F(CheckSealedCells, FindsAVoidThatIsTurnedInsideOut) {
  for (Triangle& t : triangles_of_void(1)) std::swap(t[1], t[2]);
  expect_found("void 1: it is not oriented inward");
}

TEST_F(CheckSealedCells, NamesTheFirstOfSeveralFaults) {
  for (const std::size_t i : {1U, 0U}) {
    for (Triangle& t : triangles_of_void(i)) std::swap(t[1], t[2]);
  }
  expect_found("void 0: it is not oriented inward");
}

TEST_F(CheckSealedCells, FindsAnOpenVoid) {
  mesh().triangles.pop_back();
  --sound_.solid.parts.back().triangle_count;
  expect_found("void 1: it is open");
}

TEST_F(CheckSealedCells, FindsATwistedTriangle) {
  std::swap(triangles_of_void(1)[5][0], triangles_of_void(1)[5][1]);
  expect_found("void 1: ");
}

TEST_F(CheckSealedCells, FindsAVertexThatPinchesAVoid) {
  const auto [a, b] = smallest_fans(0);
  mesh().positions[b] = mesh().positions[a];
  expect_found("void 0: a vertex pinches it");
}

// Two vertices change places: the triangles round each reach through the void to the other.
TEST_F(CheckSealedCells, FindsAVoidThatRunsThroughItself) {
  const auto [a, b] = smallest_fans(0);
  std::swap(mesh().positions[a], mesh().positions[b]);
  expect_found("pairs of triangles of voids run through each other");
}

TEST_F(CheckSealedCells, FindsAnotherEulerCharacteristic) {
  cells().voids[1].euler = 0;
  expect_found("void 1: its Euler characteristic is 2, planned was 0");
}

TEST_F(CheckSealedCells, FindsVoidsThatShareAVertex) {
  forget_planes();
  farthest(1, {-1, 0, 0}) = farthest(0, {1, 0, 0});
  expect_found("void 1 touches another surface");
}

TEST_F(CheckSealedCells, FindsAVoidThatTouchesTheModel) {
  forget_planes();
  farthest(0, {-1, -1, -1}) = mesh().positions[0];
  expect_found("void 0 touches another surface");
}

TEST_F(CheckSealedCells, FindsAnotherVolume) {
  cells().voids[1].planned_volume *= 1.1;
  expect_found("void 1: it has ");
  cells().voids[1].planned_volume /= 1.1 * 1.1;
  expect_found("void 1: it has ");
}

TEST_F(CheckSealedCells, StopsWhenAskedTo) {
  class Stopping final : public Monitor {
   public:
    void check_interrupted() override { throw InterruptedError(); }
  } stopping;
  EXPECT_THROW(check(as_read_back(mesh()), stopping), InterruptedError);
}

// One void that is a plain box, its corners far from what its faces are near to.
class CheckBoxVoid : public CheckCells {
 protected:
  CheckBoxVoid() : CheckCells({}, false) {
    limits() = {.wall = 2, .gap = 1, .min_radius = 1, .max_radius = 9};
  }

  void expect_of(Mesh model, const Mesh& void_surface) {
    sound_.model = std::move(model);
    sound_.packing.spheres = {{{15, 15, 15}, 5, SphereKind::adaptive}};
    CellVoid piece;
    piece.surface = test::turned_inside_out(void_surface);
    piece.planned_volume = signed_volume(void_surface);
    cells().voids = {std::move(piece)};
    cells().planes = {{0, 0}, {}, {{{0, 0, 0}, {30, 30, 30}}}};
    sound_.solid = carve_cells(sound_.model, cells());
  }
};

// A block of 30 mm with a dent from above, a point at its deepest.
Mesh dented_block(float deepest) {
  Mesh mesh = test::make_box({0, 0, 0}, {30, 30, 30});
  mesh.positions.push_back({15, 15, deepest});
  std::erase_if(mesh.triangles, [&](const Triangle& t) {
    return std::ranges::all_of(t, [&](std::uint32_t v) { return mesh.positions[v].z == 30; });
  });
  for (const auto& [a, b] : {std::pair{4U, 5U}, {5U, 7U}, {7U, 6U}, {6U, 4U}})
    mesh.triangles.push_back({a, b, 8});
  return mesh;
}

TEST_F(CheckBoxVoid, FindsATriangleTooNearTheModelThoughNoVertexIs) {
  const Mesh inside = test::make_box({5, 5, 5}, {25, 25, 21});
  expect_of(dented_block(23.5F), inside);
  EXPECT_NEAR(check().clearances.wall, 2.1, 1e-6);  // and no more is looked for
  expect_of(dented_block(22.75F), inside);
  expect_found("the wall is 1.75 mm, the limit 2 mm");
}

TEST_F(CheckBoxVoid, FindsAVoidWhereThePartsOverlap) {
  const Mesh overlapping =
      test::join(test::make_box({0, 0, 0}, {30, 30, 30}), test::make_box({10, 0, 0}, {40, 30, 30}));
  expect_of(overlapping, test::make_box({13, 5, 5}, {27, 25, 25}));
  expect_found("void 0: it is where the winding number is 2");
}

TEST_F(CheckBoxVoid, FindsAVoidOutsideOfTheModel) {
  expect_of(test::make_box({0, 0, 0}, {30, 30, 30}), test::make_box({35, 5, 5}, {45, 25, 25}));
  expect_found("void 0: it is where the winding number is 0");
}

TEST_F(CheckBoxVoid, PiecesOfOneCellKeepTheGapAsWell) {
  expect_of(test::make_box({0, 0, 0}, {30, 30, 30}), test::make_box({5, 5, 5}, {14, 25, 25}));
  CellVoid second = cells().voids[0];
  for (Vec3f& p : second.surface.positions) p.x += 10;
  cells().voids.push_back(second);
  sound_.solid = carve_cells(sound_.model, cells());
  EXPECT_NEAR(check().clearances.gap.value(), 1, 1e-6);
  limits().gap = 1.25;
  expect_found("the gap between voids 0 and 1 is 1 mm, the limit 1.25 mm");
}

// Three cells in a row, with windows and holes.
class CheckDrainedCells : public CheckCells {
 protected:
  CheckDrainedCells() : CheckCells(sound_row(), true) {}

  static const Sound& sound_row() {
    static const Sound sound = drain(shape_row(3, 1.75));
    return sound;
  }

  // A window in the middle of each wall, a hole below the first void and one above the last.
  static Sound drain(Sound sound) {
    constexpr double kRadius = 1.75, kBeyond = 0.25;
    const auto at = [](double x, double z) { return Vec3d{x, 10, z}; };
    for (std::uint32_t i = 0; i < 2; ++i) {
      const double wall = 15 * (i + 1.0);
      const Tube tube{at(wall - 0.5 - kBeyond, 10), at(wall + 0.5 + kBeyond, 10), kRadius};
      sound.plan.channels.push_back({i, i + 1, tube});
    }
    sound.plan.holes.push_back({0, {at(7.5, 2 + kBeyond), at(7.5, 0), kRadius}, 0});
    sound.plan.holes.push_back({2, {at(37.5, 18 - kBeyond), at(37.5, 20), kRadius}, 0});
    sound.plan.network_count = 1;
    carve(sound);
    return sound;
  }

  static void carve(Sound& sound) {
    Monitor silent;
    auto carved = carve_drained_cells(sound.model, SurfaceIndex(sound.model), sound.cells, sound.plan,
                                      kTolerance, silent);
    sound.solid = std::get<Solid>(std::move(carved));
  }
  DrainagePlan& plan() { return sound_.plan; }
};

TEST_F(CheckDrainedCells, MeasuresASoundResult) {
  const OutputFacts facts = check();
  EXPECT_EQ(facts.void_count, 3U);
  ASSERT_TRUE(facts.drainage.has_value());
  EXPECT_EQ(facts.drainage->sealed_cavities, 0U);
  EXPECT_EQ(facts.drainage->cavities_of_model, 0U);
  EXPECT_GT(facts.drainage->cut_triangles, 0U);
  EXPECT_GE(facts.drainage->channel_wall, 2 - 0.025);
  EXPECT_GE(facts.clearances.wall, 2 - 1e-7);
  EXPECT_GE(facts.clearances.gap.value(), 1 - 1e-7);
  EXPECT_NEAR(facts.volume_before, 45 * 20 * 20, 1e-6);
  EXPECT_NEAR(facts.volume_after, signed_volume(mesh()), 1e-3);
  double planned = 0;
  for (const CellVoid& piece : cells().voids) planned += piece.planned_volume;
  EXPECT_GT(facts.volume_removed, planned);  // with windows and holes
  EXPECT_LT(facts.volume_removed, 1.03 * planned);
}

// A void that is cut as before is not cut again: nobody sees that.
TEST_F(CheckDrainedCells, CarvedByTheCarverOfOtherPlans) {
  const SurfaceIndex surface(sound_.model);
  const CellVoids all = sound_.cells;
  Monitor silent;
  CellCarver carver(sound_.model, surface, all, kTolerance);
  const auto expect_own = [&](const std::vector<std::uint32_t>& kept, const DrainagePlan& plan) {
    CellVoids some = all;
    some.voids.clear();
    for (const std::uint32_t i : kept) some.voids.push_back(all.voids[i]);
    const auto shared = std::get<Solid>(carver.carve(kept, plan, silent));
    const auto own =
        std::get<Solid>(carve_drained_cells(sound_.model, surface, some, plan, kTolerance, silent));
    EXPECT_EQ(shared.mesh.positions, own.mesh.positions);
    EXPECT_EQ(shared.mesh.triangles, own.mesh.triangles);
  };
  expect_own({0, 1, 2}, plan());
  expect_own({0, 1, 2}, plan());
  // Of the middle void another wall is opened elsewhere, and the first void has another hole.
  DrainagePlan moved = plan();
  for (Vec3d* end : {&moved.channels[1].tube.start, &moved.channels[1].tube.end}) end->z += 2;
  for (Vec3d* end : {&moved.holes[0].tube.start, &moved.holes[0].tube.end}) end->y -= 1.5;
  expect_own({0, 1, 2}, moved);
  expect_own({0, 1, 2}, plan());
  // Without the last.
  DrainagePlan fewer = plan();
  fewer.channels.pop_back();
  fewer.holes[1] = fewer.holes[0];
  fewer.holes[1].from = 1;
  for (Vec3d* end : {&fewer.holes[1].tube.start, &fewer.holes[1].tube.end}) end->x += 15;
  expect_own({0, 1}, fewer);
  fewer = plan();
  fewer.channels = {plan().channels[1]};
  fewer.channels[0].from = 0;
  fewer.channels[0].to = 1;
  fewer.holes[0].from = 0;
  for (Vec3d* end : {&fewer.holes[0].tube.start, &fewer.holes[0].tube.end}) end->x += 15;
  fewer.holes[1].from = 1;
  expect_own({1, 2}, fewer);
}

TEST_F(CheckDrainedCells, AMovedTriangleOfTheOuterSurface) {
  mesh().positions[mesh().triangles[0][0]].x += 0.01F;
  expect_found("is not the one of the model");
}

TEST_F(CheckDrainedCells, AnOpenEdge) {
  mesh().triangles.pop_back();
  --sound_.solid.parts.back().triangle_count;
  expect_found("open edges");
}

TEST_F(CheckDrainedCells, AVertexBeyondAPlane) {
  for (CellPlane& plane : cells().planes.planes) plane.offset -= 0.01;
  expect_found("void 0: it passes the plane towards void 1");
}

TEST_F(CheckDrainedCells, AWallThatIsTooThin) {
  limits().wall = 2.05;
  expect_found("the wall is 2");
}

TEST_F(CheckDrainedCells, AGapThatIsTooThin) {
  limits().gap = 1.05;
  expect_found("the gap between voids 0 and 1 is 1");
}

TEST_F(CheckDrainedCells, AWindowOrAHoleThatIsTooWide) {
  plan().channels[0].tube.radius -= 0.2;
  expect_found("channel 0: it reaches");
  plan() = sound_row().plan;
  plan().holes[0].tube.radius -= 0.2;
  expect_found("escape hole 0: it reaches");
}

TEST_F(CheckDrainedCells, AWindowElsewhereThanPlanned) {
  Tube& tube = plan().channels[0].tube;
  tube.start.z += 0.5;
  tube.end.z += 0.5;
  expect_found("channel 0: it reaches");
}

TEST_F(CheckDrainedCells, AWindowThatWasForgotten) {
  const DrainagePlan whole = plan();
  plan().channels.pop_back();
  carve(sound_);
  plan() = whole;
  expect_found("were planned");
}

TEST_F(CheckDrainedCells, AVoidThatNoWindowJoins) {
  const std::uint32_t last = 2;
  std::erase_if(plan().channels, [&](const Channel& c) { return c.from == last || c.to == last; });
  std::erase_if(plan().holes, [&](const EscapeHole& hole) { return hole.from == last; });
  carve(sound_);
  expect_found("sealed");
}

TEST_F(CheckDrainedCells, SealedVoids) {
  plan().channels.clear();
  plan().holes.clear();
  carve(sound_);
  expect_found("3 cavities are sealed");
}

TEST_F(CheckDrainedCells, AnotherEulerCharacteristic) {
  cells().voids[1].euler = 0;
  expect_found("voids, channels and holes do not join as planned");
}

TEST_F(CheckDrainedCells, ATubeNearerToAnotherVoidThanTheGap) {
  Tube& tube = plan().channels[0].tube;
  // Through the second void, to its wall with the third.
  tube.end = tube.end + direction_of(tube) * 14;
  expect_found("from void 2, the gap is 1 mm");
}

TEST_F(CheckDrainedCells, AnotherVolume) {
  cells().voids[0].planned_volume *= 1.25;
  expect_found("mm3 are removed, planned were");
  cells().voids[0].planned_volume /= 1.25 * 1.25;
  expect_found("mm3 are removed, planned were");
}

TEST_F(CheckDrainedCells, AVoidThatRunsThroughItself) {
  const auto [a, b] = smallest_fans(1);
  std::swap(mesh().positions[a], mesh().positions[b]);
  expect_found("run through each other");
}

TEST_F(CheckDrainedCells, CutsAwayFromHoles) {
  for (EscapeHole& hole : plan().holes) {
    hole.tube.start = hole.tube.start + Vec3d{0, 0, 200};
    hole.tube.end = hole.tube.end + Vec3d{0, 0, 200};
  }
  expect_found("was cut away from every escape hole");
}

}  // namespace
}  // namespace aerate
