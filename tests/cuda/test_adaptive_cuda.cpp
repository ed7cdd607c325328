#include <filesystem>

#include "core/overhang.h"
#include "files/load.h"
#include "packing/adaptive.h"
#include "tests/cuda/cuda_test.h"
#include "tests/cuda/same_bits.h"
#include "tests/support/shapes.h"

// The adaptive packer on a CUDA device beside the CPU: the same bytes.

namespace aerate {
namespace {

using AdaptiveCuda = test::CudaTest;
using Kind = DeviceRequest::Kind;

void expect_same_on_cuda(const Mesh& mesh, const PackingLimits& limits, const PackingStop& options,
                         std::size_t least_spheres) {
  Monitor monitor;
  const Packing cpu = pack_adaptive(mesh, limits, options, monitor, {.kind = Kind::cpu});
  const Packing cuda = pack_adaptive(mesh, limits, options, monitor, {.kind = Kind::cuda});
  EXPECT_GE(cpu.spheres.size(), least_spheres);
  test::expect_same_packing(cuda, cpu);
  EXPECT_TRUE(cuda.device.name.starts_with("cuda:0 (")) << cuda.device.name;
}

TEST_F(AdaptiveCuda, PacksATorusAsTheCpuDoes) {
  const Mesh torus = test::make_torus(5, 2, 48, 24);
  expect_same_on_cuda(torus, {0, 0, 0.5, 10}, {}, 20);
  expect_same_on_cuda(torus, {0.2, 0.1, 0.4, 1.0}, {}, 20);
  expect_same_on_cuda(torus, {0.2, 0.1, 1.0, 1.0}, {}, 10);
}

TEST_F(AdaptiveCuda, PacksALatticeFirstWhereSpheresAreSmall) {
  expect_same_on_cuda(test::make_box({0, 0, 0}, {4, 4, 4}), {0, 0, 0.2, 0.4}, {}, 100);
}

TEST_F(AdaptiveCuda, PacksOverlappingPartsAsTheCpuDoes) {
  expect_same_on_cuda(
      test::join(test::make_box({0, 0, 0}, {10, 10, 10}), test::make_box({5, 5, 5}, {15, 15, 15})),
      {0.5, 0.3, 0.7, 4}, {}, 20);
}

TEST_F(AdaptiveCuda, PacksVoidsWithRoofsAsTheCpuDoes) {
  const Mesh torus = test::make_torus(5, 2, 48, 24);
  PackingLimits limits{0.2, 0.1, 0.5, 10, make_roof({.degrees = 45, .bridge = 0.8, .up = {0, 0, 1}})};
  ASSERT_TRUE(limits.roof.shapes(1.0));
  expect_same_on_cuda(torus, limits, {}, 20);
  limits.roof = make_roof({.degrees = 60, .bridge = 0, .up = {1, -2, 0.5}});
  expect_same_on_cuda(torus, limits, {}, 20);
  // Balls of the largest radius settle before the others are placed.
  limits.max_radius = 0.7;
  expect_same_on_cuda(test::make_box({0, 0, 0}, {6, 6, 6}), limits, {}, 20);
}

TEST_F(AdaptiveCuda, PacksLevelSquaresFirstAsTheCpuDoes) {
  PackingLimits limits{0.2, 0.1, 0.5, 0.9};
  limits.in_level_squares = true;
  limits.roof.up = {1, 0, 0};
  expect_same_on_cuda(test::make_box({0, 0, 0}, {6, 5, 5}), limits, {}, 12);
}

TEST_F(AdaptiveCuda, StopsAtACountAndADensityAsTheCpuDoes) {
  const Mesh torus = test::make_torus(5, 2, 48, 24);
  expect_same_on_cuda(torus, {0, 0, 0.1, 10}, {.max_count = 25}, 25);
  expect_same_on_cuda(torus, {0, 0, 0.1, 10}, {.target_density = 0.5}, 5);
}

TEST_F(AdaptiveCuda, KeepsTheDensestOfSeveralPackingsAsTheCpuDoes) {
  const Mesh torus = test::make_torus(5, 2, 48, 24);
  expect_same_on_cuda(torus, {0.1, 0.1, 0.5, 10}, {.effort = PackingEffort::best}, 10);
}

struct RealModel {
  const char* name;  // of the test
  const char* file;
  PackingLimits limits;
  std::size_t count;
};

// What a failure names.
void PrintTo(const RealModel& model, std::ostream* out) {
  *out << model.file;
}

class AdaptiveCudaOnModels : public AdaptiveCuda, public ::testing::WithParamInterface<RealModel> {};

TEST_P(AdaptiveCudaOnModels, PacksAsTheCpuDoes) {
  const std::filesystem::path file = std::filesystem::path(AERATE_SHARED) / "models" / GetParam().file;
  if (!std::filesystem::exists(file)) GTEST_SKIP() << file << " is not there";
  expect_same_on_cuda(load_model(file).mesh, GetParam().limits, {.max_count = GetParam().count},
                      GetParam().count);
}

INSTANTIATE_TEST_SUITE_P(, AdaptiveCudaOnModels,
                         ::testing::Values(RealModel{"Capsule", "capsule.stl", {0.1, 0.1, 0.05, 10}, 25},
                                           RealModel{"Bunny", "bunny-7202.stl", {0.1, 0.05, 0.05, 10}, 25}),
                         [](const auto& model) { return model.param.name; });

}  // namespace
}  // namespace aerate
