#include <algorithm>
#include <cstdint>
#include <numeric>
#include <random>
#include <vector>

#include "kernels/atomic.h"
#include "kernels/exec_cpu.h"
#include "kernels/exec_cuda.h"
#include "tests/cuda/cuda_test.h"

// The CUDA executor's own operations beside those of the serial one.

namespace aerate::kernels {
namespace {

using ExecCuda = test::CudaTest;

template <typename T>
std::span<const T> span_of(const std::vector<T>& values) {
  return values;
}

std::vector<std::uint32_t> random_values(std::size_t count, std::uint32_t below) {
  std::mt19937 random(7);
  std::vector<std::uint32_t> values(count);
  for (std::uint32_t& value : values) value = static_cast<std::uint32_t>(random() % below);
  return values;
}

struct Square {
  View<const std::uint32_t> in;
  View<std::uint64_t> out;

  AERATE_HD void operator()(std::size_t i) const {
    out[i] = static_cast<std::uint64_t>(in[i]) * in[i] + static_cast<std::uint64_t>(i);
  }
};

struct AddAll {
  View<const std::uint32_t> in;
  View<std::uint32_t> sum;

  AERATE_HD void operator()(std::size_t i) const { atomic_add(sum[0], in[i]); }
};

TEST_F(ExecCuda, BringsBackWhatItWasGiven) {
  const CudaExecutor cuda(0);
  for (const std::size_t count : {0, 1, 1000}) {
    const std::vector<std::uint32_t> values = random_values(count, 1000);
    const CudaBuffer<std::uint32_t> buffer = cuda.upload(span_of(values));
    EXPECT_EQ(buffer.size(), count);
    EXPECT_EQ(cuda.download(buffer.view()), values);
  }
}

TEST_F(ExecCuda, RunsEveryIndexOnce) {
  const CudaExecutor cuda(0);
  for (const std::size_t count : {0, 1, 255, 256, 257, 5000}) {
    const std::vector<std::uint32_t> values = random_values(count, 1u << 31);
    const auto in = cuda.upload(span_of(values));
    auto out = cuda.allocate<std::uint64_t>(count);
    cuda.for_each_index(count, Square{in.view(), out.view()});
    std::vector<std::uint64_t> expected(count);
    SerialExecutor{}.for_each_index(count, Square{{values.data(), count}, {expected.data(), count}});
    EXPECT_EQ(cuda.download(out.view()), expected);
  }
}

TEST_F(ExecCuda, AddsAtomically) {
  const CudaExecutor cuda(0);
  const std::vector<std::uint32_t> values = random_values(3000, 1000);
  const auto in = cuda.upload(span_of(values));
  auto sum = cuda.allocate<std::uint32_t>(1);
  cuda.for_each_index(1, SetAll<std::uint32_t>{sum.view(), 0});
  cuda.for_each_index(values.size(), AddAll{in.view(), sum.view()});
  EXPECT_EQ(cuda.download(sum.view())[0], std::accumulate(values.begin(), values.end(), 0u));
}

void expect_same_scan(const std::vector<std::uint32_t>& values) {
  const CudaExecutor cuda(0);
  const auto in = cuda.upload(span_of(values));
  auto out = cuda.allocate<std::uint32_t>(values.size());
  const std::uint64_t sum = cuda.exclusive_scan(in.view(), out.view());
  std::vector<std::uint32_t> expected(values.size());
  const std::uint64_t expected_sum =
      SerialExecutor{}.exclusive_scan({values.data(), values.size()}, {expected.data(), expected.size()});
  EXPECT_EQ(sum, expected_sum);
  EXPECT_EQ(cuda.download(out.view()), expected);
  auto in_place = cuda.upload(span_of(values));
  EXPECT_EQ(cuda.exclusive_scan(in_place.view(), in_place.view()), expected_sum);
  EXPECT_EQ(cuda.download(in_place.view()), expected);
}

TEST_F(ExecCuda, Scans) {
  for (const std::size_t count : {0, 1, 2, 33, 9000}) expect_same_scan(random_values(count, 50));
}

// The sum has 64 bits even where the offsets have 32.
TEST_F(ExecCuda, ScansPast32Bits) {
  expect_same_scan(std::vector<std::uint32_t>(5000, 0xf0000000u));
}

// Each step adds what the one before left at the next place: wrong at once if steps overlap.
struct AddNext {
  View<std::uint32_t> even, odd;

  AERATE_HD void operator()(unsigned step, std::size_t i) const {
    const View<std::uint32_t> from = step % 2 == 0 ? even : odd;
    const View<std::uint32_t> to = step % 2 == 0 ? odd : even;
    to[i] = from[i] + from[(i + 1) % from.size];
  }
};

template <typename Executor>
std::vector<std::uint32_t> add_next(const Executor& executor, const std::vector<std::uint32_t>& values) {
  auto even = executor.upload(span_of(values));
  auto odd = executor.template allocate<std::uint32_t>(values.size());
  executor.for_each_step(6, values.size(), AddNext{even.view(), odd.view()});
  return executor.download(View<const std::uint32_t>(even.view()));
}

// In one block and in several.
TEST_F(ExecCuda, RunsStepsOneAfterTheOther) {
  for (const std::size_t count : {1, 255, 3000, 9000}) {
    const std::vector<std::uint32_t> values = random_values(count, 1000);
    const std::vector<std::uint32_t> expected = add_next(SerialExecutor{}, values);
    EXPECT_EQ(add_next(CudaExecutor(0), values), expected);
    EXPECT_EQ(add_next(TbbExecutor{}, values), expected);
  }
}

struct TallyByKind {
  View<const std::uint32_t> kinds;

  AERATE_HD Tally operator()(std::size_t i) const {
    return {kinds[i] == 0 ? 1u : 0u, kinds[i] == 1 ? 1u : 0u, kinds[i]};
  }
};

struct ListByKind {
  View<const std::uint32_t> kinds;
  View<std::uint32_t> zeros, ones, sums;

  AERATE_HD void operator()(std::size_t i, Tally before) const {
    if (kinds[i] == 0) zeros[before.first] = static_cast<std::uint32_t>(i);
    if (kinds[i] == 1) ones[before.second] = static_cast<std::uint32_t>(i);
    sums[i] = before.third;
  }
};

struct Selected {
  std::vector<std::uint32_t> zeros, ones, sums;
  std::uint32_t total = 0;

  friend bool operator==(const Selected&, const Selected&) = default;
};

template <typename Executor>
Selected select_by_kind(const Executor& executor, const std::vector<std::uint32_t>& kinds) {
  const auto uploaded = executor.upload(span_of(kinds));
  auto zeros = executor.template allocate<std::uint32_t>(kinds.size());
  auto ones = executor.template allocate<std::uint32_t>(kinds.size());
  auto sums = executor.template allocate<std::uint32_t>(kinds.size());
  const Tally total = executor.select(kinds.size(), TallyByKind{uploaded.view()},
                                      ListByKind{uploaded.view(), zeros.view(), ones.view(), sums.view()});
  return {executor.download(View<const std::uint32_t>{zeros.view().data, total.first}),
          executor.download(View<const std::uint32_t>{ones.view().data, total.second}),
          executor.download(View<const std::uint32_t>(sums.view())), total.third};
}

// In one block and in several.
TEST_F(ExecCuda, SelectsInOrder) {
  for (const std::size_t count : {0, 1, 256, 257, 4096, 4097, 20000}) {
    const std::vector<std::uint32_t> kinds = random_values(count, 4);
    const Selected expected = select_by_kind(SerialExecutor{}, kinds);
    EXPECT_EQ(expected.zeros.size(), std::count(kinds.begin(), kinds.end(), 0u));
    EXPECT_TRUE(std::is_sorted(expected.ones.begin(), expected.ones.end()));
    EXPECT_EQ(expected.total, std::accumulate(kinds.begin(), kinds.end(), 0u));
    EXPECT_EQ(select_by_kind(CudaExecutor(0), kinds), expected) << count;
    EXPECT_EQ(select_by_kind(TbbExecutor{}, kinds), expected) << count;
  }
}

void expect_same_sort(std::vector<std::uint64_t> keys) {
  std::vector<std::uint32_t> values(keys.size());
  std::iota(values.begin(), values.end(), 0u);
  const CudaExecutor cuda(0);
  auto device_keys = cuda.upload(span_of(keys));
  auto device_values = cuda.upload(span_of(values));
  cuda.sort_pairs(device_keys.view(), device_values.view());
  SerialExecutor{}.sort_pairs({keys.data(), keys.size()}, {values.data(), values.size()});
  EXPECT_EQ(cuda.download(device_keys.view()), keys);
  EXPECT_EQ(cuda.download(device_values.view()), values);
}

std::vector<std::uint64_t> keys_with_ties(std::size_t count) {
  const std::vector<std::uint32_t> high = random_values(count, 5);
  const std::vector<std::uint32_t> low = random_values(count, 50);
  std::vector<std::uint64_t> keys(count);
  for (std::size_t i = 0; i < count; ++i) keys[i] = (std::uint64_t{high[i]} << 60) + low[i];
  return keys;
}

TEST_F(ExecCuda, SortsByKeyAndTiesByValue) {
  for (const std::size_t count : {0, 1, 2, 3000, 20000}) expect_same_sort(keys_with_ties(count));
}

TEST_F(ExecCuda, BuffersMoveAndOutliveTheirExecutor) {
  CudaBuffer<std::uint32_t> kept;
  const std::vector<std::uint32_t> values{1, 2, 3};
  {
    const CudaExecutor cuda(0);
    CudaBuffer<std::uint32_t> other = cuda.upload(span_of(values));
    kept = cuda.allocate<std::uint32_t>(100);
    kept = std::move(other);
  }
  EXPECT_EQ(kept.size(), 3U);
  EXPECT_EQ(CudaExecutor(0).download(kept.view()), values);
}

TEST_F(ExecCuda, SaysWhatItCannotAllocateAndGoesOn) {
  const CudaExecutor cuda(0);
  try {
    cuda.allocate<std::byte>(std::size_t{1} << 50);
    FAIL() << "a petabyte was allocated";
  } catch (const CudaError& error) {
    EXPECT_EQ(error.kind(), CudaError::Kind::out_of_memory);
    EXPECT_NE(std::string(error.what()).find("1125899906842624 bytes"), std::string::npos) << error.what();
    EXPECT_FALSE(error.hint().empty());
  }
  const std::vector<std::uint32_t> values{4, 5};
  EXPECT_EQ(cuda.download(cuda.upload(span_of(values)).view()), values);
}

TEST_F(ExecCuda, GivesBackWhatItAllocated) {
  const CudaExecutor cuda(0);
  const std::size_t before = cuda.free_bytes();
  {
    const auto buffer = cuda.allocate<std::byte>(std::size_t{1} << 20);
    EXPECT_LE(cuda.free_bytes(), before - buffer.size());
  }
  EXPECT_GE(cuda.free_bytes(), before);
}

TEST_F(ExecCuda, RefusesADeviceThatIsNotThere) {
  try {
    const CudaExecutor cuda(1000);
    FAIL() << "there are not 1001 devices";
  } catch (const CudaError& error) {
    EXPECT_EQ(error.kind(), CudaError::Kind::no_device);
    EXPECT_NE(std::string(error.what()).find("cudaSetDevice(1000)"), std::string::npos) << error.what();
  }
}

struct WriteNowhere {
  AERATE_HD void operator()(std::size_t i) const { *reinterpret_cast<int*>(16 + 4 * i) = 1; }
};

// Leaves the device unusable, so it runs in a process of its own. Its message goes to standard error.
TEST_F(ExecCuda, NamesTheKernelThatFailed) {
  GTEST_FLAG_SET(death_test_style, "threadsafe");
  const auto fault = [] {
    try {
      const CudaExecutor cuda(0);
      const auto buffer = cuda.allocate<std::uint32_t>(1);
      cuda.for_each_index(1, WriteNowhere{});
      cuda.download(buffer.view());
    } catch (const CudaError& error) {
      std::fprintf(stderr, "%s\n%s\n", error.what(), error.hint().c_str());
      std::_Exit(7);
    }
  };
  EXPECT_EXIT(fault(), ::testing::ExitedWithCode(7), "WriteNowhere.*failed.*illegal");
}

}  // namespace
}  // namespace aerate::kernels
