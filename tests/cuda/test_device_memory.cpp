#include <cstdlib>
#include <cstring>
#include <functional>
#include <string>

#include "core/error.h"
#include "kernels/exec_cpu.h"
#include "packing/adaptive.h"
#include "packing/hexagonal.h"
#include "packing/run_on_device.h"
#include "tests/cuda/cuda_test.h"
#include "tests/cuda/same_bits.h"
#include "tests/support/adaptive_input.h"
#include "tests/support/hexagonal_input.h"
#include "tests/support/shapes.h"

// Packing on devices that are too small for the job, which only a simulated device can be made to be: each
// ctest run of this program has its own PTXVM_MEMORY_LIMIT.

namespace aerate {
namespace {
struct PackerThatFailsOnCuda {
  using Input = kernels::PackerInput;
  using Result = std::string;

  template <typename Executor>
  static std::string pack(const Executor& /*executor*/, const Input& /*input*/) {
    return "cpu";
  }
};
}  // namespace

namespace kernels {
template <>
std::string pack_on_cuda<PackerThatFailsOnCuda>(int /*device*/, const PackerInput& /*input*/) {
  throw CudaError(CudaError::Kind::out_of_memory, "no room", "buy some");
}
}  // namespace kernels

namespace {

using Kind = DeviceRequest::Kind;

class DeviceMemory : public test::CudaTest {
 protected:
  void SetUp() override {
    test::CudaTest::SetUp();
    if (IsSkipped()) return;
    const char* limit = std::getenv("PTXVM_MEMORY_LIMIT");
    bytes_ = kernels::find_cuda_devices().devices[0].memory_bytes;
    if (limit == nullptr || std::to_string(bytes_) != limit)
      GTEST_SKIP() << "needs a simulated device of limited memory";
  }

  std::size_t bytes_ = 0;
  const Mesh torus_ = test::make_torus(5, 2, 48, 24);
  const PackingLimits limits_{0, 0, 0, 0.5};
};

class NoticeBoard : public Monitor {
 public:
  void notice(std::string_view text) override { text_ += text; }
  const std::string& text() const { return text_; }

 private:
  std::string text_;
};

// What the torus needs: strips of it with their index, and its whole index with the first cells.
constexpr std::size_t kLeastForHexagonal = 120 << 10;
constexpr std::size_t kLeastForAdaptive = 900 << 10;
constexpr std::size_t kLeastForPieces = 1400 << 10;  // a longer job

// Enough work for the model to choose the device.
constexpr WorkEstimate kMuchWork{1e6, 0};

// The same packing if the device has `least` bytes or more, else a refusal that names the memory.
void expect_same_or_refused(std::size_t bytes, std::size_t least, const Packing& expected,
                            const std::function<Packing()>& pack) {
  try {
    const Packing packing = pack();
    EXPECT_GE(bytes, least) << "less memory is enough by now: test with less";
    test::expect_same_packing(packing, expected);
  } catch (const FailureError& error) {
    EXPECT_LT(bytes, least) << error.what();
    EXPECT_NE(std::string(error.what()).find("memory"), std::string::npos) << error.what();
    EXPECT_NE(error.hint().find("--device cpu"), std::string::npos) << error.hint();
  }
}

TEST_F(DeviceMemory, HexagonalPackingIsTheSameOrSaysWhyNot) {
  Monitor monitor;
  const Packing expected = pack_hexagonal(torus_, limits_, monitor, {.kind = Kind::cpu});
  ASSERT_GT(expected.spheres.size(), 1500U);
  expect_same_or_refused(bytes_, kLeastForHexagonal, expected,
                         [&] { return pack_hexagonal(torus_, limits_, monitor, {.kind = Kind::cuda}); });
}

TEST_F(DeviceMemory, HexagonalPackingTakesStripsWhereTheIndexDoesNotFit) {
  if (bytes_ < kLeastForHexagonal) return;  // refused, as the test before shows
  const kernels::HexagonalInput input = test::hexagonal_input(torus_, 0.5);
  const kernels::HexagonalResult whole = kernels::HexagonalPacking::pack(kernels::TbbExecutor{}, input);
  const kernels::HexagonalResult result = kernels::pack_on_cuda<kernels::HexagonalPacking>(0, input);
  test::expect_same_spheres(result.spheres, whole.spheres);
  EXPECT_EQ(result.state_counts, whole.state_counts);
  EXPECT_EQ(result.strips > 1, bytes_ < whole.index_bytes + torus_.triangles.size() * sizeof(kernels::Facet))
      << result.strips << " strips";
}

TEST_F(DeviceMemory, AdaptivePackingIsTheSameOrSaysWhyNot) {
  Monitor monitor;
  const PackingLimits limits{0.1, 0.05, 0.3, 0.8};
  const PackingStop options{.max_count = 120};
  const Packing expected = pack_adaptive(torus_, limits, options, monitor, {.kind = Kind::cpu});
  ASSERT_EQ(expected.spheres.size(), 120U);
  expect_same_or_refused(bytes_, kLeastForAdaptive, expected, [&] {
    return pack_adaptive(torus_, limits, options, monitor, {.kind = Kind::cuda});
  });
}

// Not all cells, searches and places at once, which need more than these devices have.
TEST_F(DeviceMemory, AdaptivePackingWorksInPieces) {
  if (bytes_ < kLeastForPieces) return;
  kernels::AdaptiveInput input = test::adaptive_input(torus_);
  input.parameters.min_radius = 0.3;
  input.parameters.max_count = 100;
  const kernels::AdaptiveResult whole = kernels::AdaptivePacking<>::pack(kernels::TbbExecutor{}, input);
  const kernels::AdaptiveResult result = kernels::pack_on_cuda<kernels::AdaptivePacking<>>(0, input);
  EXPECT_LT(result.most_at_a_time, 4000U);
  EXPECT_GT(result.search_count, result.most_at_a_time);
  ASSERT_EQ(result.balls.size(), whole.balls.size());
  EXPECT_EQ(std::memcmp(result.balls.data(), whole.balls.data(), whole.balls.size() * sizeof(kernels::Ball)),
            0);
}

TEST_F(DeviceMemory, AutomaticChoiceFallsBackToTheCpuAndSaysSo) {
  NoticeBoard board;
  const auto [result, use] =
      run_on_device<PackerThatFailsOnCuda>({.kind = Kind::automatic}, kMuchWork, board, {});
  EXPECT_EQ(result, "cpu");
  EXPECT_NE(board.text().find("no room"), std::string::npos) << board.text();
  EXPECT_EQ(use.name, "cpu");
  EXPECT_NE(use.reason.find("no room"), std::string::npos) << use.reason;
}

}  // namespace
}  // namespace aerate
