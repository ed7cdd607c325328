#include <cstring>
#include <cuda_runtime_api.h>
#include <dlfcn.h>
#include <functional>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "kernels/cuda_device.h"
#include "kernels/power_cells.h"
#include "tests/cuda/cuda_test.h"
#include "tests/support/adaptive_input.h"
#include "tests/support/balls.h"
#include "tests/support/hexagonal_input.h"
#include "tests/support/shapes.h"

// Whatever call of a job fails: an error that names it and says what to try, and nothing left on the device.
// The calls that follow go through this program's own functions of the same names, which needs the shared
// runtime.

namespace {

struct Calls {
  std::map<std::string, int> count;  // by name
  std::string failing;               // which call is to fail ...
  int fail_from = -1;                // ... the how manyeth, and those after it
  cudaError_t error = cudaSuccess;
  cudaError_t pending = cudaSuccess;  // for cudaGetLastError
  int memory = 0, streams = 0, pools = 0;

  bool fails(const char* name) {
    const int number = count[name]++;
    if (failing != name || fail_from < 0 || number < fail_from) return false;
    pending = error;
    return true;
  }
};

Calls calls;

template <typename Function>
Function* real(const char* name) {
  return reinterpret_cast<Function*>(dlsym(RTLD_NEXT, name));
}

}  // namespace

extern "C" {

cudaError_t cudaGetLastError() {
  const cudaError_t pending = std::exchange(calls.pending, cudaSuccess);
  return pending != cudaSuccess ? pending : real<decltype(cudaGetLastError)>("cudaGetLastError")();
}

cudaError_t cudaMallocFromPoolAsync(void** memory, size_t bytes, cudaMemPool_t pool, cudaStream_t stream) {
  if (calls.fails(__func__)) return calls.error;
  const cudaError_t error =
      real<cudaError_t(void**, size_t, cudaMemPool_t, cudaStream_t)>(__func__)(memory, bytes, pool, stream);
  calls.memory += error == cudaSuccess ? 1 : 0;
  return error;
}

cudaError_t cudaFreeAsync(void* memory, cudaStream_t stream) {
  --calls.memory;
  return real<cudaError_t(void*, cudaStream_t)>(__func__)(memory, stream);
}

cudaError_t cudaMemPoolCreate(cudaMemPool_t* pool, const cudaMemPoolProps* properties) {
  if (calls.fails(__func__)) return calls.error;
  ++calls.pools;
  return real<cudaError_t(cudaMemPool_t*, const cudaMemPoolProps*)>(__func__)(pool, properties);
}

cudaError_t cudaMemPoolDestroy(cudaMemPool_t pool) {
  --calls.pools;
  return real<cudaError_t(cudaMemPool_t)>(__func__)(pool);
}

cudaError_t cudaMemPoolSetAttribute(cudaMemPool_t pool, cudaMemPoolAttr attribute, void* value) {
  if (calls.fails(__func__)) return calls.error;
  return real<cudaError_t(cudaMemPool_t, cudaMemPoolAttr, void*)>(__func__)(pool, attribute, value);
}

cudaError_t cudaMemPoolGetAttribute(cudaMemPool_t pool, cudaMemPoolAttr attribute, void* value) {
  if (calls.fails(__func__)) return calls.error;
  return real<cudaError_t(cudaMemPool_t, cudaMemPoolAttr, void*)>(__func__)(pool, attribute, value);
}

cudaError_t cudaMemGetInfo(size_t* free, size_t* total) {
  if (calls.fails(__func__)) return calls.error;
  return real<cudaError_t(size_t*, size_t*)>(__func__)(free, total);
}

cudaError_t cudaStreamCreateWithFlags(cudaStream_t* stream, unsigned flags) {
  if (calls.fails(__func__)) return calls.error;
  ++calls.streams;
  return real<cudaError_t(cudaStream_t*, unsigned)>(__func__)(stream, flags);
}

cudaError_t cudaStreamDestroy(cudaStream_t stream) {
  --calls.streams;
  return real<cudaError_t(cudaStream_t)>(__func__)(stream);
}

cudaError_t cudaStreamSynchronize(cudaStream_t stream) {
  if (calls.fails(__func__)) return calls.error;
  return real<cudaError_t(cudaStream_t)>(__func__)(stream);
}

cudaError_t cudaMemcpyAsync(void* to, const void* from, size_t bytes, cudaMemcpyKind kind,
                            cudaStream_t stream) {
  if (calls.fails(__func__)) return calls.error;
  return real<cudaError_t(void*, const void*, size_t, cudaMemcpyKind, cudaStream_t)>(__func__)(
      to, from, bytes, kind, stream);
}

// What the launch of a kernel compiles to.
cudaError_t __cudaLaunchKernel(cudaKernel_t kernel, dim3 grid, dim3 block, void** arguments, size_t shared,
                               cudaStream_t stream) {
  if (calls.fails(__func__)) return calls.error;
  return real<cudaError_t(cudaKernel_t, dim3, dim3, void**, size_t, cudaStream_t)>(__func__)(
      kernel, grid, block, arguments, shared, stream);
}

}  // extern "C"

namespace aerate::kernels {
namespace {

struct Failure {
  const char* call;
  cudaError_t error;
  CudaError::Kind kind;
  const char* named;       // in the message
  int in_destructors = 0;  // so many calls at the end, whose failure nobody needs to know of
};

constexpr Failure kFailures[] = {
    {"cudaMallocFromPoolAsync", cudaErrorMemoryAllocation, CudaError::Kind::out_of_memory,
     "cudaMallocFromPoolAsync of"},
    {"cudaMemPoolCreate", cudaErrorNotSupported, CudaError::Kind::failed, "cudaMemPoolCreate"},
    {"cudaMemPoolSetAttribute", cudaErrorInvalidValue, CudaError::Kind::failed, "cudaMemPoolSetAttribute"},
    {"cudaStreamCreateWithFlags", cudaErrorUnknown, CudaError::Kind::failed, "cudaStreamCreateWithFlags"},
    {"cudaMemPoolGetAttribute", cudaErrorInvalidValue, CudaError::Kind::failed, "cudaMemPoolGetAttribute"},
    {"cudaMemGetInfo", cudaErrorUnknown, CudaError::Kind::failed, "cudaMemGetInfo"},
    {"cudaStreamSynchronize", cudaErrorLaunchFailure, CudaError::Kind::failed, "after the kernel", 1},
    {"cudaMemcpyAsync", cudaErrorUnknown, CudaError::Kind::failed, "cudaMemcpyAsync of"},
    {"__cudaLaunchKernel", cudaErrorLaunchOutOfResources, CudaError::Kind::failed, ""},
};

class FailingCalls : public test::CudaTest {
 protected:
  void TearDown() override { calls = {}; }

  // Fails each call of the job from the k-th on, for at least a dozen values of k or all there are.
  void expect_no_call_is_missed(const std::function<void()>& job) {
    calls = {};
    job();
    const std::map<std::string, int> counts = calls.count;
    for (const Failure& failure : kFailures) {
      const auto found = counts.find(failure.call);
      ASSERT_NE(found, counts.end()) << failure.call << " is never called";
      const int count = found->second - failure.in_destructors;
      const int step = count / 24 + 1;
      for (int k = 0; k < count; k += step) {
        calls = {};
        calls.failing = failure.call;
        calls.fail_from = k;
        calls.error = failure.error;
        SCOPED_TRACE(std::string(failure.call) + ", call " + std::to_string(k));
        expect_failure(job, failure);
      }
    }
    calls = {};
    job();
  }

 private:
  void expect_failure(const std::function<void()>& job, const Failure& failure) {
    try {
      job();
      ADD_FAILURE() << "the job ended well";
    } catch (const CudaError& error) {
      EXPECT_EQ(error.kind(), failure.kind) << error.what();
      EXPECT_NE(std::string(error.what()).find(failure.named), std::string::npos) << error.what();
      EXPECT_NE(std::string(error.what()).find(cudaGetErrorName(failure.error)), std::string::npos)
          << error.what();
      EXPECT_FALSE(error.hint().empty());
    }
    EXPECT_EQ(calls.memory, 0) << "pieces of memory not freed";
    EXPECT_EQ(calls.streams, 0);
    EXPECT_EQ(calls.pools, 0);
    EXPECT_EQ(cudaPeekAtLastError(), cudaSuccess);
  }
};

TEST_F(FailingCalls, OfHexagonalPacking) {
  const Mesh box = test::make_box({0, 0, 0}, {4, 4, 4});
  const HexagonalInput input = test::hexagonal_input(box, 0.9);
  expect_no_call_is_missed([&] { ASSERT_GT(pack_on_cuda<HexagonalPacking>(0, input).spheres.size(), 5U); });
}

TEST_F(FailingCalls, OfAdaptivePacking) {
  const Mesh box = test::make_box({0, 0, 0}, {4, 4, 4});
  AdaptiveInput input = test::adaptive_input(box);
  input.parameters.min_radius = 0.4;
  expect_no_call_is_missed([&] { ASSERT_GT(pack_on_cuda<AdaptivePacking<>>(0, input).balls.size(), 5U); });
}

TEST_F(FailingCalls, OfCells) {
  constexpr Box3d kBox{{0, 0, 0}, {4, 4, 4}};
  std::vector<Ball> balls;
  test::add_random_balls(balls, 12, kBox, 0.2, 0.8, 0.1, 1);
  expect_no_call_is_missed([&] {
    ASSERT_GT(pack_on_cuda<PowerCells>(0, {balls, 0.1, kBox}).planes.size(), balls.size());
  });
}

}  // namespace
}  // namespace aerate::kernels
