// A loop that ThreadSanitizer must complain about: what tests/tsan/tbb_edges.cpp tells it must not hide that.
#include <cstddef>
#include <cstdio>
#include <tbb/parallel_for.h>

int main() {
  std::size_t count = 0;
  tbb::parallel_for(std::size_t{0}, std::size_t{1'000'000}, [&](std::size_t) { ++count; });
  std::printf("%zu\n", count);
}
