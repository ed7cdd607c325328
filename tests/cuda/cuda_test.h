#pragma once

#include <gtest/gtest.h>

#include "kernels/cuda_device.h"

namespace aerate::test {

// Tests that run kernels: on any CUDA device, a simulated one included.
class CudaTest : public ::testing::Test {
 protected:
  void SetUp() override {
    const kernels::CudaDevices found = kernels::find_cuda_devices();
    if (found.devices.empty()) GTEST_SKIP() << "no CUDA device: " << found.problem;
  }
};

}  // namespace aerate::test
