#include "mesh/overlap.h"

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <tbb/parallel_for.h>

#include "kernels/constants.h"
#include "kernels/winding.h"
#include "mesh/line_crossings.h"
#include "mesh/r2_sequence.h"

namespace aerate {
namespace {

// Lines are summed up in blocks of fixed size, so that the sums do not depend on threads.
constexpr std::size_t kBlocks = 256;
constexpr std::size_t kLinesPerBlock = 256;

// Overlap along a line that is shorter than this share of the model's diagonal is what rounding makes of
// surfaces that touch.
constexpr double kRoundingShare = 1e-6;

struct LineSums {
  double overlapped = 0;
  double filled_excess = 0;
};

class LineMeasure {
 public:
  LineMeasure(const kernels::WindingView& winding, const ShellLabels& labels, double least_length,
              std::vector<std::uint8_t>& overlapping)
      : winding_(winding), labels_(labels), least_length_(least_length), overlapping_(overlapping) {}

  void add_line(double x, double y, LineSums& sums) {
    crossings_.clear();
    for_each_crossing(winding_, x, y, [&](const LineCrossing& crossing) { crossings_.push_back(crossing); });
    std::sort(crossings_.begin(), crossings_.end(), [](const LineCrossing& a, const LineCrossing& b) {
      return a.z != b.z ? a.z < b.z : a.facet < b.facet;
    });
    int winding = 0;
    for (std::size_t i = 0; i + 1 < crossings_.size(); ++i) {
      winding -= crossings_[i].sign;
      if (winding == 0 || winding == 1) continue;
      const double length = crossings_[i + 1].z - crossings_[i].z;
      if (length <= least_length_) continue;
      sums.overlapped += length;
      sums.filled_excess += length * (1 - winding);
      mark(crossings_[i].facet);
      mark(crossings_[i + 1].facet);
    }
  }

 private:
  void mark(std::uint32_t facet) {
    const std::uint32_t label = labels_.of_triangle[facet];
    if (label == kNone) return;
    std::atomic_ref<std::uint8_t>(overlapping_[label]).store(1, std::memory_order_relaxed);
  }

  const kernels::WindingView& winding_;
  const ShellLabels& labels_;
  double least_length_;
  std::vector<std::uint8_t>& overlapping_;
  std::vector<LineCrossing> crossings_;
};

}  // namespace

Overlap measure_overlap(const Mesh& mesh, const ShellLabels& labels) {
  const kernels::HostWinding host(mesh.positions, mesh.triangles);
  const kernels::WindingView& winding = host.view();
  const Vec3d size = winding.box.upper - winding.box.lower;

  std::vector<LineSums> sums(kBlocks);
  std::vector<std::uint8_t> overlapping(labels.count, 0);
  tbb::parallel_for(std::size_t{0}, kBlocks, [&](std::size_t block) {
    LineMeasure measure(winding, labels, kRoundingShare * length(size), overlapping);
    for (std::size_t i = block * kLinesPerBlock; i < (block + 1) * kLinesPerBlock; ++i) {
      const auto [x, y] = r2_point(i, 0.5);
      measure.add_line(winding.box.lower.x + size.x * x, winding.box.lower.y + size.y * y, sums[block]);
    }
  });

  const double area_per_line = size.x * size.y / static_cast<double>(kBlocks * kLinesPerBlock);
  Overlap overlap;
  for (const LineSums& block : sums) {
    overlap.volume += block.overlapped * area_per_line;
    overlap.filled_excess += block.filled_excess * area_per_line;
  }
  overlap.shells = static_cast<std::size_t>(std::count(overlapping.begin(), overlapping.end(), 1));
  return overlap;
}

}  // namespace aerate
