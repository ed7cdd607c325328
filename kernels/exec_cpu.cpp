#include "kernels/exec_cpu.h"

#include <algorithm>
#include <functional>

namespace aerate::kernels {
namespace {

struct Pair {
  std::uint64_t key;
  std::uint32_t value;

  friend bool operator<(const Pair& a, const Pair& b) {
    return a.key != b.key ? a.key < b.key : a.value < b.value;
  }
};

}  // namespace

std::uint64_t SerialExecutor::exclusive_scan(View<const std::uint32_t> in, View<std::uint32_t> out) const {
  std::uint64_t sum = 0;
  for (std::size_t i = 0; i < in.size; ++i) {
    const std::uint32_t value = in[i];
    out[i] = static_cast<std::uint32_t>(sum);
    sum += value;
  }
  return sum;
}

void SerialExecutor::sort_pairs(View<std::uint64_t> keys, View<std::uint32_t> values) const {
  std::vector<Pair> pairs(keys.size);
  for (std::size_t i = 0; i < keys.size; ++i) pairs[i] = {keys[i], values[i]};
  std::sort(pairs.begin(), pairs.end());
  for (std::size_t i = 0; i < keys.size; ++i) {
    keys[i] = pairs[i].key;
    values[i] = pairs[i].value;
  }
}

std::uint64_t TbbExecutor::exclusive_scan(View<const std::uint32_t> in, View<std::uint32_t> out) const {
  return tbb::parallel_scan(
      tbb::blocked_range<std::size_t>(0, in.size, std::size_t{1} << 14), std::uint64_t{0},
      [in, out](const tbb::blocked_range<std::size_t>& range, std::uint64_t sum, bool is_final) {
        for (std::size_t i = range.begin(); i != range.end(); ++i) {
          const std::uint32_t value = in[i];
          if (is_final) out[i] = static_cast<std::uint32_t>(sum);
          sum += value;
        }
        return sum;
      },
      std::plus<std::uint64_t>());
}

void TbbExecutor::sort_pairs(View<std::uint64_t> keys, View<std::uint32_t> values) const {
  HostBuffer<Pair> pairs(keys.size);
  const View<Pair> view = pairs.view();
  for_each_index(keys.size, [=](std::size_t i) { view[i] = {keys[i], values[i]}; });
  tbb::parallel_sort(view.data, view.data + view.size);
  for_each_index(keys.size, [=](std::size_t i) {
    keys[i] = view[i].key;
    values[i] = view[i].value;
  });
}

}  // namespace aerate::kernels
