#include <filesystem>

#include "core/error.h"
#include "files/load.h"
#include "kernels/exec_cpu.h"
#include "packing/hexagonal.h"
#include "tests/cuda/cuda_test.h"
#include "tests/cuda/same_bits.h"
#include "tests/support/hexagonal_input.h"
#include "tests/support/shapes.h"

// The whole hexagonal packer on a CUDA device beside the CPU: the same bytes.

namespace aerate {
namespace {

using HexagonalCuda = test::CudaTest;
using Kind = DeviceRequest::Kind;

Packing pack_on(Kind kind, const Mesh& mesh, const PackingLimits& limits) {
  Monitor monitor;
  return pack_hexagonal(mesh, limits, monitor, {.kind = kind});
}

void expect_same_on_cuda(const Mesh& mesh, const PackingLimits& limits, std::size_t least_spheres) {
  const Packing cpu = pack_on(Kind::cpu, mesh, limits);
  const Packing cuda = pack_on(Kind::cuda, mesh, limits);
  EXPECT_GE(cpu.spheres.size(), least_spheres);
  test::expect_same_packing(cuda, cpu);
  EXPECT_TRUE(cuda.device.name.starts_with("cuda:0 (")) << cuda.device.name;
  EXPECT_EQ(cuda.device.reason, "asked for");
}

TEST_F(HexagonalCuda, PacksATorusAsTheCpuDoes) {
  const Mesh torus = test::make_torus(5, 2, 48, 24);
  expect_same_on_cuda(torus, {0, 0, 0, 0.6}, 1000);
  expect_same_on_cuda(torus, {0.2, 0.1, 0.05, 0.7}, 300);
}

TEST_F(HexagonalCuda, PacksOverlappingPartsAsTheCpuDoes) {
  expect_same_on_cuda(
      test::join(test::make_box({0, 0, 0}, {10, 10, 10}), test::make_box({5, 5, 5}, {15, 15, 15})),
      {0, 0, 0, 0.7}, 100);
}

TEST_F(HexagonalCuda, PacksInSlabsAsTheCpuDoesAtOnce) {
  const Mesh torus = test::make_torus(5, 2, 48, 24);
  kernels::HexagonalInput input = test::hexagonal_input(torus, 0.6);
  const kernels::HexagonalResult cpu = kernels::HexagonalPacking::pack(kernels::SerialExecutor{}, input);
  input.most_slots = 777;
  const kernels::HexagonalResult cuda = kernels::pack_on_cuda<kernels::HexagonalPacking>(0, input);
  EXPECT_EQ(cuda.slots_at_a_time, 777U);
  test::expect_same_spheres(cuda.spheres, cpu.spheres);
  EXPECT_EQ(cuda.state_counts, cpu.state_counts);
}

struct RealModel {
  const char* name;  // of the test
  const char* file;
  PackingLimits limits;
  std::size_t least_spheres;
};

// What a failure names.
void PrintTo(const RealModel& model, std::ostream* out) {
  *out << model.file;
}

class HexagonalCudaOnModels : public HexagonalCuda, public ::testing::WithParamInterface<RealModel> {};

TEST_P(HexagonalCudaOnModels, PacksAsTheCpuDoes) {
  const std::filesystem::path file = std::filesystem::path(AERATE_SHARED) / "models" / GetParam().file;
  if (!std::filesystem::exists(file)) GTEST_SKIP() << file << " is not there";
  expect_same_on_cuda(load_model(file).mesh, GetParam().limits, GetParam().least_spheres);
}

INSTANTIATE_TEST_SUITE_P(
    , HexagonalCudaOnModels,
    ::testing::Values(RealModel{"Cone", "cone.stl", {0, 0, 0, 0.5}, 500},
                      RealModel{"CapsuleWithWallAndGap", "capsule.stl", {0.1, 0.1, 0.05, 0.6}, 200},
                      RealModel{"Bunny", "bunny-7202.stl", {0, 0, 0, 0.5}, 500},
                      RealModel{"BunnyWithWallAndGap", "bunny-7202.stl", {0.1, 0.05, 0.02, 0.4}, 500},
                      RealModel{"Dino", "dino.off", {0, 0, 0, 0.05}, 500},
                      RealModel{"Dragon", "dragon-21782.stl", {0, 0, 0, 0.2}, 500}),
    [](const auto& model) { return model.param.name; });

TEST_F(HexagonalCuda, StopsWhenItsCallerDoes) {
  const Mesh torus = test::make_torus(5, 2, 48, 24);
  kernels::HexagonalInput input = test::hexagonal_input(torus, 0.6);
  input.most_slots = 777;
  input.progress = [](double share) {
    if (share > 0.2) throw InterruptedError();
  };
  EXPECT_THROW(kernels::pack_on_cuda<kernels::HexagonalPacking>(0, input), InterruptedError);
}

TEST_F(HexagonalCuda, RefusesADeviceThatIsNotThere) {
  Monitor monitor;
  const Mesh box = test::make_box({0, 0, 0}, {1, 1, 1});
  try {
    pack_hexagonal(box, {0, 0, 0, 0.2}, monitor, {.kind = Kind::cuda, .index = 1000});
    FAIL() << "there are not 1001 devices";
  } catch (const FailureError& error) {
    EXPECT_NE(std::string(error.what()).find("no CUDA device 1000"), std::string::npos) << error.what();
    EXPECT_FALSE(error.hint().empty());
  }
}

}  // namespace
}  // namespace aerate
