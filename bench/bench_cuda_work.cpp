#include <cstdint>
#include <fmt/format.h>

#include "bench/benchmark.h"
#include "packing/methods.h"
#include "tests/support/shapes.h"

// One packing on a CUDA device, for scripts/cuda-work, which counts the instructions that a simulated device
// executes: packs a torus of 2 RINGS^2 triangles with that largest (on a lattice) or smallest radius.

namespace aerate::bench {
namespace {

int run(const Arguments& arguments) {
  const PackingMethod& method = packing_method(arguments.positional[0]);
  const auto rings = static_cast<std::uint32_t>(arguments.number(1, 0));
  const double radius = arguments.number(2, 0);
  const PackingLimits limits =
      method.on_lattice ? PackingLimits{0, 0, 0, radius} : PackingLimits{0, 0, radius, 10};
  const Mesh torus = test::make_torus(5, 2, rings, rings);
  Monitor monitor;
  const Packing packing = method.pack(torus, limits, {}, monitor, {.kind = DeviceRequest::Kind::cuda});
  fmt::print("facets {} places {} spheres {}\n", torus.triangles.size(), packing.statistics.candidates,
             packing.spheres.size());
  return 0;
}

}  // namespace
}  // namespace aerate::bench

int main(int argc, char** argv) {
  return aerate::bench::run_benchmark(argc, argv, {"PACKING RINGS RADIUS", 3, 3}, aerate::bench::run);
}
