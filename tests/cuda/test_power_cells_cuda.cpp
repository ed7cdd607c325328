#include <vector>

#include "core/error.h"
#include "kernels/exec_cpu.h"
#include "kernels/packer.h"
#include "kernels/power_cells.h"
#include "packing/packing_cells.h"
#include "tests/cuda/cuda_test.h"
#include "tests/support/balls.h"
#include "tests/support/packing_of.h"
#include "tests/support/same_cells.h"

// Cells of power diagrams on a CUDA device beside the CPU: the same bytes.

namespace aerate {
namespace {

using kernels::Ball;
using kernels::PowerCells;
using PowerCellsCuda = test::CudaTest;

constexpr Box3d kBox{{0, 0, 0}, {10, 10, 10}};

void expect_same_on_cuda(const std::vector<Ball>& balls, double gap) {
  const kernels::PowerCellsInput input{balls, gap, kBox};
  const CellPlanes cpu = PowerCells::pack(kernels::SerialExecutor{}, input);
  EXPECT_GE(cpu.planes.size(), balls.size());
  test::expect_same_cells(kernels::pack_on_cuda<PowerCells>(0, input), cpu);
}

TEST_F(PowerCellsCuda, OfRandomBallsAreThoseOfTheCpu) {
  std::vector<Ball> balls;
  test::add_random_balls(balls, 300, kBox, 0.05, 0.8, 0.1, 1);
  expect_same_on_cuda(balls, 0.1);
}

TEST_F(PowerCellsCuda, OfALatticeAreThoseOfTheCpu) {
  expect_same_on_cuda(test::face_centred_balls(3, 10.0 / 3), 0);
}

TEST_F(PowerCellsCuda, OfALargeBallAmidSmallOnesAreThoseOfTheCpu) {
  std::vector<Ball> balls{{{5, 5, 5}, 4}};
  test::add_random_balls(balls, 400, kBox, 0.05, 0.3, 0.01, 2);
  expect_same_on_cuda(balls, 0.01);
}

TEST_F(PowerCellsCuda, OfAPackingAreThoseOfTheCpu) {
  Packing packing = test::packing_of({{{2, 5, 5}, 1, SphereKind::adaptive},
                                      {{5, 5, 5}, 1.5, SphereKind::adaptive},
                                      {{5, 8, 6}, 1, SphereKind::adaptive}});
  packing.limits.gap = 0.2;
  Monitor monitor;
  test::expect_same_cells(cells_of(packing, kBox, {.kind = DeviceRequest::Kind::cuda}, monitor),
                          cells_of(packing, kBox, {.kind = DeviceRequest::Kind::cpu}, monitor));
}

TEST_F(PowerCellsCuda, RefusesBallsThatOverlap) {
  const std::vector<Ball> balls{{{5, 5, 5}, 1}, {{5, 5, 5}, 1}};
  EXPECT_THROW(kernels::pack_on_cuda<PowerCells>(0, {balls, 0, kBox}), std::invalid_argument);
}

}  // namespace
}  // namespace aerate
