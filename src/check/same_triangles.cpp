#include "check/same_triangles.h"

#include <algorithm>
#include <tbb/blocked_range.h>
#include <tbb/parallel_reduce.h>

#include "check/check_failure.h"

namespace aerate {
namespace {

// Triangles that are compared between two questions to the monitor.
constexpr std::size_t kComparedPerPiece = std::size_t{1} << 22;

// The first of the triangles `first`..`last`-1 that differs; `last` if none does.
std::size_t difference_among(const Mesh& a, const Mesh& b, std::size_t first, std::size_t last) {
  return tbb::parallel_reduce(
      tbb::blocked_range<std::size_t>(first, last), last,
      [&](const tbb::blocked_range<std::size_t>& range, std::size_t found) {
        std::size_t i = range.begin();
        while (i != range.end() && has_same_corners(a, i, b, i)) ++i;
        return i == range.end() ? found : std::min(found, i);
      },
      [](std::size_t x, std::size_t y) { return std::min(x, y); });
}

}  // namespace

bool has_same_corners(const Mesh& a, std::size_t i, const Mesh& b, std::size_t j) {
  for (std::size_t corner = 0; corner < 3; ++corner) {
    if (!(a.positions[a.triangles[i][corner]] == b.positions[b.triangles[j][corner]])) return false;
  }
  return true;
}

std::size_t find_difference(const Mesh& a, const Mesh& b, std::size_t count, Monitor& monitor) {
  for (std::size_t first = 0; first < count; first += kComparedPerPiece) {
    monitor.check_interrupted();
    const std::size_t last = std::min(count, first + kComparedPerPiece);
    const std::size_t different = difference_among(a, b, first, last);
    if (different != last) return different;
  }
  return count;
}

void require_same_triangles(const Mesh& read_back, const Mesh& written, Monitor& monitor) {
  const std::size_t count = written.triangles.size();
  if (read_back.triangles.size() < count)
    fail_check("it has {} triangles instead of {}", read_back.triangles.size(), count);
  if (read_back.triangles.size() > count)
    fail_check("it has {} triangles too many", read_back.triangles.size() - count);
  const std::size_t different = find_difference(read_back, written, count, monitor);
  if (different != count) fail_check("triangle {} is not the one of the result", different);
}

}  // namespace aerate
