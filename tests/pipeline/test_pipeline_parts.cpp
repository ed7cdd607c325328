#include <gtest/gtest.h>
#include <string>
#include <tbb/task_arena.h>
#include <vector>

#include "core/error.h"
#include "files/sphere_table.h"
#include "pipeline/budget.h"
#include "pipeline/job_log.h"
#include "pipeline/memory.h"
#include "pipeline/thread_limit.h"
#include "printing/carve.h"
#include "tests/support/caught.h"
#include "tests/support/packing_of.h"

namespace aerate {
namespace {

using test::contains;
using test::message_of;

TEST(Memory, FiguresAreInTheRangeOfRealMachines) {
  EXPECT_GT(available_memory_bytes(), 1e7);
  EXPECT_GT(peak_memory_bytes(), 1e6);
  EXPECT_LT(peak_memory_bytes(), 1e12);
}

TEST(Memory, PeakGrowsWithWhatIsUsed) {
  const double before = peak_memory_bytes();
  const std::vector<char> large(200'000'000, 'x');
  EXPECT_GT(peak_memory_bytes(), before + 1e8) << large[5];
}

TEST(Memory, BytesInWords) {
  EXPECT_EQ(format_bytes(999), "999 bytes");
  EXPECT_EQ(format_bytes(1500), "1.5 kB");
  EXPECT_EQ(format_bytes(3.24e9), "3.24 GB");
}

TEST(JobLog, KeepsStagesAndNoticesInOrder) {
  Monitor silent;
  JobLog log(silent);
  log.stage("load");
  log.stage("load");
  log.notice("two parts");
  log.stage("pack");
  const std::vector<StageCost> stages = log.finish();
  ASSERT_EQ(stages.size(), 2U);
  EXPECT_EQ(stages[0].name, "load");
  EXPECT_EQ(stages[1].name, "pack");
  EXPECT_GE(stages[0].seconds, 0);
  EXPECT_GT(stages[1].peak_bytes, 0);
  EXPECT_EQ(log.notices(), std::vector<std::string>{"two parts"});
}

TEST(ThreadLimit, HoldsAndPassesExceptionsOn) {
  for (const int threads : {1, 2, 8}) {
    int concurrency = 0;
    run_with_threads(threads, [&] { concurrency = tbb::this_task_arena::max_concurrency(); });
    EXPECT_EQ(concurrency, threads);
  }
  EXPECT_THROW(run_with_threads(2, [] { throw InterruptedError(); }), InterruptedError);
}

TEST(Budget, ToleranceIsLoosenedOnlyAsFarAsNeeded) {
  const Packing packing =
      test::packing_of({{{0, 0, 0}, 5, SphereKind::lattice}, {{20, 0, 0}, 2, SphereKind::lattice}});
  const double fine = 0.02;
  EXPECT_EQ(tolerance_for(packing, fine, 100, {}), fine);
  const std::size_t at_fine = estimate_void_triangles(packing, {.tolerance = fine});
  EXPECT_EQ(tolerance_for(packing, fine, 100, 100 + at_fine), fine);

  const double loosened = tolerance_for(packing, fine, 100, 100 + at_fine / 3);
  EXPECT_GT(loosened, fine);
  EXPECT_LE(estimate_void_triangles(packing, {.tolerance = loosened}), at_fine / 3);
  EXPECT_TRUE(
      contains(message_of<UsageError>([&] { tolerance_for(packing, fine, 100, 99); }), "100 triangles"));
}

TEST(Budget, VoidsBeyondMemoryAreRefusedWithAnEstimate) {
  Packing packing;
  packing.spheres.assign(1'000'000, {{0, 0, 0}, 5, SphereKind::lattice});
  const std::string said =
      message_of<UsageError>([&] { require_memory_for_voids(packing, 1e-3, 1'000'000); });
  EXPECT_TRUE(contains(said, "1000000 voids"));
  EXPECT_TRUE(contains(said, "are available"));
}

TEST(SphereTable, HasOneLineForEachSphere) {
  Packing packing;
  packing.spheres = {{{1.5, -2, 0.1}, 3, SphereKind::tetrahedral}};
  EXPECT_EQ(sphere_table(packing, SphereFormat::csv, {}), "x,y,z,radius,kind\n1.5,-2,0.1,3,tetrahedral\n");
}

}  // namespace
}  // namespace aerate
