#include <filesystem>

#include "files/load.h"
#include "kernels/cuda_device.h"
#include "packing/adaptive.h"
#include "packing/hexagonal.h"
#include "tests/cuda/same_bits.h"

// Jobs of real size, which would take a simulated device hours.

namespace aerate {
namespace {

using Kind = DeviceRequest::Kind;

class LargeGpu : public ::testing::Test {
 protected:
  void SetUp() override {
    const kernels::CudaDevices found = kernels::find_cuda_devices();
    if (found.devices.empty()) GTEST_SKIP() << "needs a GPU: " << found.problem;
    if (found.devices[0].name == "ptxvm") GTEST_SKIP() << "needs a GPU: this device is simulated";
  }

  static std::filesystem::path model(const char* file) {
    return std::filesystem::path(AERATE_SHARED) / "models" / file;
  }

  Monitor monitor_;
};

TEST_F(LargeGpu, HexagonalOnTheLargestDragon) {
  if (!std::filesystem::exists(model("dragon-871k.stl"))) GTEST_SKIP() << "the model is not there";
  const Mesh dragon = load_model(model("dragon-871k.stl")).mesh;
  const PackingLimits limits{0, 0, 0, 0.05};
  test::expect_same_packing(pack_hexagonal(dragon, limits, monitor_, {.kind = Kind::cuda}),
                            pack_hexagonal(dragon, limits, monitor_, {.kind = Kind::cpu}));
}

TEST_F(LargeGpu, AdaptiveOnADragonWithPrintLimits) {
  if (!std::filesystem::exists(model("dragon-47k-100mm.stl"))) GTEST_SKIP() << "the model is not there";
  const Mesh dragon = load_model(model("dragon-47k-100mm.stl")).mesh;
  const PackingLimits limits{1.2, 0.8, 0.5, 10};
  test::expect_same_packing(pack_adaptive(dragon, limits, {}, monitor_, {.kind = Kind::cuda}),
                            pack_adaptive(dragon, limits, {}, monitor_, {.kind = Kind::cpu}));
}

}  // namespace
}  // namespace aerate
