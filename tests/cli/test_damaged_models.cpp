#include <array>
#include <cstdint>
#include <filesystem>
#include <gtest/gtest.h>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "files/load.h"
#include "mesh/inspect.h"
#include "tests/cli/job.h"
#include "tests/support/caught.h"

// Models as exports and editors damage them: what can be mended is mended and said, and nothing is lost.
namespace aerate::test {
namespace {

// Triangles with a rounding of their own, as STL.
std::string with_corners_apart(const Mesh& mesh, double by) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> shift(-by, by);
  Mesh soup;
  for (const Triangle& triangle : mesh.triangles) {
    const auto first = static_cast<std::uint32_t>(soup.positions.size());
    for (const std::uint32_t v : triangle)
      soup.positions.push_back(
          to_float(to_double(mesh.positions[v]) + Vec3d{shift(random), shift(random), shift(random)}));
    soup.triangles.push_back({first, first + 1, first + 2});
  }
  return to_binary_stl(soup);
}

// A block whose sides are 6 x 6 squares each.
Mesh finely_divided_block() {
  constexpr int kSquares = 6;
  constexpr float kSide = 30;
  Mesh mesh;
  const auto add_side = [&](Vec3f origin, Vec3f u, Vec3f v) {
    const auto first = static_cast<std::uint32_t>(mesh.positions.size());
    for (int i = 0; i <= kSquares; ++i)
      for (int j = 0; j <= kSquares; ++j)
        mesh.positions.push_back(origin + u * (static_cast<float>(i) / kSquares) +
                                 v * (static_cast<float>(j) / kSquares));
    for (std::uint32_t i = 0; i < kSquares; ++i) {
      for (std::uint32_t j = 0; j < kSquares; ++j) {
        const std::uint32_t a = first + i * (kSquares + 1) + j, b = a + kSquares + 1;
        mesh.triangles.push_back({a, b, b + 1});
        mesh.triangles.push_back({a, b + 1, a + 1});
      }
    }
  };
  const Vec3f x{kSide, 0, 0}, y{0, kSide, 0}, z{0, 0, kSide}, far = x + y + z;
  for (const auto& [u, v] : {std::pair{y, x}, {z, y}, {x, z}}) {
    add_side({0, 0, 0}, u, v);
    add_side(far, v * -1.0f, u * -1.0f);
  }
  return mesh;
}

double volume_of(const std::filesystem::path& file) {
  return signed_volume(load_model(file).mesh);
}

TEST(DamagedModel, CracksOfNoWidthAreClosedAndSaid) {
  const Job job;
  const auto sound = job.input("sound.stl", block());
  const auto cracked = job.input("cracked.stl", with_corners_apart(block(), 1e-5));
  ASSERT_EQ(run(job.hollow(sound)).exit_code, 0);
  const double expected = volume_of(job.output());
  const ProcessResult result = run(job.hollow(cracked));
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_TRUE(contains(result.err, "cracks are closed"));
  EXPECT_TRUE(contains(result.out, "kept as they were"));
  EXPECT_NEAR(volume_of(job.output()), expected, 0.01 * expected);
  EXPECT_TRUE(inspect(load_model(job.output()).mesh).closed());
}

TEST(DamagedModel, CracksStayOpenWhereThatIsAskedForAndAreNotTakenForHoles) {
  for (const char* surface : {"keep", "auto", "remesh"}) {
    const Job job;
    const auto cracked = job.input("cracked.stl", with_corners_apart(block(), 1e-5));
    const ProcessResult result =
        run(job.hollow(cracked, {"--weld", "0", "--surface", surface, "--max-hole", "100"}));
    EXPECT_EQ(result.exit_code, 4) << result.err;
    EXPECT_TRUE(contains(result.err, "cracked"));
    EXPECT_TRUE(contains(result.err, "--weld"));
    EXPECT_EQ(entries_of(job.outputs()), std::vector<std::string>{});
  }
}

TEST(DamagedModel, WiderCracksAreToldWithTheWeldThatClosesThem) {
  // Just above what is joined unasked, a part of the edges meets by chance.
  for (const double by : {2e-4, 3e-4, 5e-4, 0.01}) {
    const Job job;
    const auto cracked = job.input("cracked.stl", with_corners_apart(finely_divided_block(), by));
    const ProcessResult refused = run(job.hollow(cracked));
    if (refused.exit_code == 0) continue;
    ASSERT_EQ(refused.exit_code, 4) << refused.err;
    const std::size_t at = refused.err.find("--weld ");
    ASSERT_NE(at, std::string::npos) << refused.err;
    const std::string weld = refused.err.substr(at + 7, refused.err.find('\n', at) - at - 7);
    EXPECT_EQ(run(job.hollow(cracked, {"--weld", weld})).exit_code, 0) << by << ": " << weld;
  }
}

// The hint's number must do, for any size of the hole.
TEST(DamagedModel, TheHintsMaxHoleIsEnough) {
  for (const float side : {30.0F, 44.7F, 71.0F}) {
    const Job job;
    Mesh open = make_box({0, 0, 0}, {side, side, 90});
    std::erase_if(open.triangles, [&](const Triangle& t) {
      return open.positions[t[0]].z == 90 && open.positions[t[1]].z == 90 && open.positions[t[2]].z == 90;
    });
    const auto model = job.input("open.stl", open);
    const ProcessResult refused = run(job.hollow(model));
    ASSERT_EQ(refused.exit_code, 4) << refused.err;
    const std::size_t at = refused.err.find("--max-hole ");
    ASSERT_NE(at, std::string::npos) << refused.err;
    const std::string limit = refused.err.substr(at + 11, refused.err.find('\n', at) - at - 11);
    const ProcessResult closed = run(
        job.hollow(model, {"--surface", "remesh", "--max-hole", limit, "--voxel", "1", "--min-radius", "4"}));
    EXPECT_EQ(closed.exit_code, 0) << limit << ": " << closed.err;
  }
}

TEST(DamagedModel, BodiesInOnePlaceAreOne) {
  const Job job;
  const auto model = job.input("twice.stl", join(block(), block()));
  const ProcessResult result = run(job.hollow(model));
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_TRUE(contains(result.err, "taken once"));
  EXPECT_TRUE(contains(result.out, "of 27000"));
}

// A cavity twice and a body in it once are a hollow, which one cavity less would fill.
TEST(DamagedModel, DoublesGoOnlyWhereWhatIsSolidStaysSo) {
  const Mesh inner = make_box({10, 10, 10}, {20, 20, 20});
  const Mesh cavity = turned_inside_out(inner);
  const Job job;
  const auto model = job.input("hollow.stl", join(join(join(block(), cavity), cavity), inner));
  const ProcessResult result = run({AERATE_EXECUTABLE, "inspect", model});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_FALSE(contains(result.out, "taken once"));
}

TEST(DamagedModel, InspectSaysWhatHollowWillDo) {
  const auto use = [](const Mesh& mesh, const std::vector<std::string>& options = {}) {
    const Job job;
    std::vector<std::string> command{AERATE_EXECUTABLE, "inspect", job.input("m.stl", mesh)};
    command.insert(command.end(), options.begin(), options.end());
    const ProcessResult result = run(command);
    EXPECT_EQ(result.exit_code, 0) << result.err;
    return result.out.substr(std::min(result.out.find("\nuse "), result.out.size()));
  };
  EXPECT_TRUE(contains(use(block()), "can keep this surface as it is"));
  EXPECT_TRUE(contains(use(make_box({0, 0, 0}, {20, 20, 0})), "flat"));
  EXPECT_TRUE(contains(use(join(block(), block())), "mended: bodies"));
  EXPECT_TRUE(contains(use(turned_inside_out(block())), "inside out"));
  Mesh open = block();
  open.triangles.pop_back();
  EXPECT_TRUE(contains(use(open), "--max-hole"));
}

TEST(DamagedModel, SizesThatNothingIsPrintedInAreRefusedAtOnce) {
  for (const float side : {1e-30F, 1e-5F, 1e9F, 1e15F, 1e37F}) {
    for (const char* surface : {"keep", "remesh"}) {
      const Job job;
      const auto model = job.input("size.stl", make_box({0, 0, 0}, {side, side, side}));
      const ProcessResult result = run(job.hollow(model, {"--surface", surface}));
      EXPECT_EQ(result.exit_code, 4) << result.err;
      EXPECT_TRUE(contains(result.err, "--unit"));
    }
  }
}

TEST(DamagedModel, AModelFarFromTheOriginIsTheUsersToMove) {
  const Job job;
  const auto model = job.input("far.stl", moved(block(), {200000, 0, 0}));
  const ProcessResult result = run(job.hollow(model));
  EXPECT_EQ(result.exit_code, 2) << result.err;
  EXPECT_TRUE(contains(result.err, "nearer to the origin"));
}

// Rods thinner than a voxel are most of what there is to lose.
TEST(DamagedModel, RemeshingThatLosesPartsIsRefusedOrFiner) {
  Mesh model = block();
  for (int i = 0; i < 12; ++i) {
    const float x = 1 + 2 * static_cast<float>(i);
    model = join(model, make_box({x, 5, 30}, {x + 0.4F, 5.4F, 60}));
  }
  const Job job;
  const auto file = job.input("rods.stl", model);
  const ProcessResult refused = run(job.hollow(file, {"--surface", "remesh", "--voxel", "1"}));
  EXPECT_EQ(refused.exit_code, 4) << refused.err;
  EXPECT_TRUE(contains(refused.err, "too coarse"));
  EXPECT_EQ(entries_of(job.outputs()), std::vector<std::string>{});
  const ProcessResult finer = run(job.hollow(file, {"--surface", "remesh"}));
  EXPECT_EQ(finer.exit_code, 0) << finer.err;
}

}  // namespace
}  // namespace aerate::test
