#include <bit>
#include <cmath>

#include "packing/hexagonal.h"
#include "tests/cuda/cuda_test.h"
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

void expect_same_bits(double a, double b, std::size_t sphere) {
  ASSERT_EQ(std::bit_cast<std::uint64_t>(a), std::bit_cast<std::uint64_t>(b)) << "sphere " << sphere;
}

void expect_same_packing(const Packing& a, const Packing& b) {
  ASSERT_EQ(a.spheres.size(), b.spheres.size());
  for (std::size_t i = 0; i < a.spheres.size(); ++i) {
    expect_same_bits(a.spheres[i].centre.x, b.spheres[i].centre.x, i);
    expect_same_bits(a.spheres[i].centre.y, b.spheres[i].centre.y, i);
    expect_same_bits(a.spheres[i].centre.z, b.spheres[i].centre.z, i);
    expect_same_bits(a.spheres[i].radius, b.spheres[i].radius, i);
    ASSERT_EQ(a.spheres[i].kind, b.spheres[i].kind) << "sphere " << i;
  }
  EXPECT_EQ(a.statistics.candidates, b.statistics.candidates);
  EXPECT_EQ(a.statistics.outside, b.statistics.outside);
  EXPECT_EQ(a.statistics.overlapped_region, b.statistics.overlapped_region);
  EXPECT_EQ(a.statistics.near_surface, b.statistics.near_surface);
  EXPECT_EQ(a.statistics.below_min_radius, b.statistics.below_min_radius);
}

void expect_same_on_cuda(const Mesh& mesh, const PackingLimits& limits, std::size_t least_spheres) {
  const Packing cpu = pack_on(Kind::cpu, mesh, limits);
  const Packing cuda = pack_on(Kind::cuda, mesh, limits);
  EXPECT_GE(cpu.spheres.size(), least_spheres);
  expect_same_packing(cpu, cuda);
  EXPECT_TRUE(cuda.device.name.starts_with("cuda:0")) << cuda.device.name;
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

}  // namespace
}  // namespace aerate
