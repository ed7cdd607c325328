#include <gtest/gtest.h>

#include "core/error.h"
#include "kernels/cuda_device.h"
#include "packing/device_choice.h"
#include "packing/hexagonal.h"
#include "packing/run_on_device.h"
#include "tests/support/shapes.h"

namespace aerate {
namespace {

using Kind = DeviceRequest::Kind;

TEST(Device, ParsesWhatTheCommandLineTakes) {
  EXPECT_EQ(parse_device("auto")->kind, Kind::automatic);
  EXPECT_EQ(parse_device("cpu")->kind, Kind::cpu);
  EXPECT_EQ(parse_device("cuda")->kind, Kind::cuda);
  EXPECT_EQ(parse_device("cuda")->index, 0);
  EXPECT_EQ(parse_device("cuda:12")->kind, Kind::cuda);
  EXPECT_EQ(parse_device("cuda:12")->index, 12);
  for (const char* text : {"", "gpu", "CUDA", "cuda:", "cuda:x", "cuda:-1", "cuda:1x", "cuda:99999999999"}) {
    EXPECT_FALSE(parse_device(text).has_value()) << text;
  }
}

TEST(Device, DescribesTheCpuFirst) {
  const std::vector<std::string> lines = describe_devices();
  ASSERT_GE(lines.size(), 2U);
  EXPECT_TRUE(lines[0].starts_with("cpu: ")) << lines[0];
  EXPECT_TRUE(lines[1].starts_with("cuda")) << lines[1];
}

TEST(Device, SmallJobsStayOnTheCpuAndSayWhy) {
  Monitor monitor;
  const Packing packing = pack_hexagonal(test::make_box({0, 0, 0}, {10, 10, 10}), {0, 0, 0, 1.0}, monitor);
  EXPECT_EQ(packing.device.name, "cpu");
  EXPECT_FALSE(packing.device.reason.empty());
}

TEST(Device, CudaIsARequestThatHoldsOrFails) {
  if (!kernels::find_cuda_devices().devices.empty()) GTEST_SKIP() << "this machine has a CUDA device";
  Monitor monitor;
  try {
    pack_hexagonal(test::make_box({0, 0, 0}, {10, 10, 10}), {0, 0, 0, 1.0}, monitor, {.kind = Kind::cuda});
    FAIL() << "packed on a device that is not there";
  } catch (const FailureError& error) {
    EXPECT_NE(std::string(error.what()).find("CUDA"), std::string::npos) << error.what();
    EXPECT_NE(error.hint().find("--device cpu"), std::string::npos) << error.hint();
  }
}

TEST(Device, LargeJobsStayOnTheCpuWithoutADevice) {
  if (!kernels::find_cuda_devices().devices.empty()) GTEST_SKIP() << "this machine has a CUDA device";
  const DeviceChoice choice = choose_device({.kind = Kind::automatic}, {1e6, 0});
  EXPECT_EQ(choice.request.kind, Kind::cpu);
  EXPECT_NE(choice.use.reason.find("no CUDA"), std::string::npos) << choice.use.reason;
}

}  // namespace
}  // namespace aerate
