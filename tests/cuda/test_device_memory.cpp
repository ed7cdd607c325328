#include <cstdlib>
#include <string>

#include "core/error.h"
#include "kernels/hexagonal_cuda.h"
#include "packing/hexagonal.h"
#include "packing/run_on_device.h"
#include "tests/cuda/cuda_test.h"
#include "tests/cuda/same_bits.h"
#include "tests/support/shapes.h"

// Packing on devices that are too small for the job, which only a simulated device can be made to be: each
// ctest run of this program has its own PTXVM_MEMORY_LIMIT.

namespace aerate {
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

// Enough work for the model to choose the device.
constexpr WorkEstimate kMuchWork{1e6, 0};

TEST_F(DeviceMemory, GivesTheSamePackingOrSaysWhyNot) {
  Monitor monitor;
  const Packing expected = pack_hexagonal(torus_, limits_, monitor, {.kind = Kind::cpu});
  ASSERT_GT(expected.spheres.size(), 1500U);
  constexpr std::size_t kTooLittle = 150 << 10;
  if (bytes_ > kTooLittle) {
    test::expect_same_packing(pack_hexagonal(torus_, limits_, monitor, {.kind = Kind::cuda}), expected);
    return;
  }
  try {
    pack_hexagonal(torus_, limits_, monitor, {.kind = Kind::cuda});
    FAIL() << "packed in " << bytes_ << " bytes";
  } catch (const FailureError& error) {
    EXPECT_NE(std::string(error.what()).find("memory"), std::string::npos) << error.what();
    EXPECT_NE(error.hint().find("--device cpu"), std::string::npos) << error.hint();
  }
}

TEST_F(DeviceMemory, AutomaticChoiceFallsBackToTheCpuAndSaysSo) {
  NoticeBoard board;
  DeviceUse use;
  const auto on_cpu = [](Kind) { return std::string("cpu"); };
  const auto on_cuda = [&](int) -> std::string {
    throw kernels::CudaError(kernels::CudaError::Kind::out_of_memory, "no room", "buy some");
  };
  EXPECT_EQ(run_on_device({.kind = Kind::automatic}, kMuchWork, board, use, on_cpu, on_cuda), "cpu");
  EXPECT_NE(board.text().find("no room"), std::string::npos) << board.text();
  EXPECT_EQ(use.name, "cpu");
  EXPECT_NE(use.reason.find("no room"), std::string::npos) << use.reason;
}

}  // namespace
}  // namespace aerate
