#include <algorithm>
#include <gtest/gtest.h>
#include <set>

#include "core/error.h"
#include "packing/methods.h"
#include "packing/verify.h"
#include "tests/support/shapes.h"

// What holds for every packing that --packing offers.

namespace aerate {
namespace {

using Kind = DeviceRequest::Kind;

class EveryPacking : public ::testing::TestWithParam<PackingMethod> {
 protected:
  Packing pack(const PackingLimits& limits, Kind kind = Kind::cpu) {
    Monitor monitor;
    return GetParam().pack(torus_, limits, {}, monitor, {.kind = kind});
  }

  const Mesh torus_ = test::make_torus(5, 2, 48, 24);
};

TEST_P(EveryPacking, KeepsItsLimits) {
  const PackingLimits limits{.wall = 0.2, .gap = 0.1, .min_radius = 0.1, .max_radius = 0.6};
  const Packing packing = pack(limits);
  EXPECT_GT(packing.spheres.size(), 50U);
  EXPECT_FALSE(find_fault(SurfaceIndex(torus_), packing).has_value());
  const Packing verified = verify_packing(SurfaceIndex(torus_), packing);
  EXPECT_EQ(verified.statistics.dropped_by_verification + verified.statistics.shrunk_by_verification, 0U);
}

TEST_P(EveryPacking, IsTheSameForAnyNumberOfThreads) {
  const PackingLimits limits{.wall = 0.1, .gap = 0, .min_radius = 0.1, .max_radius = 0.5};
  const Packing serial = pack(limits, Kind::cpu_one_thread), parallel = pack(limits);
  EXPECT_TRUE(std::ranges::equal(serial.spheres, parallel.spheres, [](const Sphere& a, const Sphere& b) {
    return a.centre == b.centre && a.radius == b.radius && a.kind == b.kind;
  }));
}

TEST_P(EveryPacking, SaysWhatItNeeds) {
  const PackingLimits limits{.wall = 0.1, .gap = 0, .min_radius = 0.1, .max_radius = 0.5};
  const MemoryNeed need = GetParam().memory(torus_, limits, {});
  EXPECT_GT(need.bytes, static_cast<double>(pack(limits).spheres.size() * sizeof(Sphere)));
  EXPECT_FALSE(need.job.empty());
  EXPECT_FALSE(need.hint.empty());
}

INSTANTIATE_TEST_SUITE_P(, EveryPacking,
                         ::testing::ValuesIn(packing_methods().begin(), packing_methods().end()),
                         [](const auto& method) { return std::string(method.param.name); });

TEST(PackingMethods, AreFoundByTheirNames) {
  std::set<std::string_view> names;
  for (const PackingMethod& method : packing_methods()) {
    EXPECT_EQ(&packing_method(method.name), &method);
    names.insert(method.name);
  }
  EXPECT_EQ(names.size(), packing_methods().size());
  EXPECT_THROW(packing_method("none"), UsageError);
}

}  // namespace
}  // namespace aerate
