#include <charconv>
#include <cstring>
#include <fmt/format.h>
#include <string_view>

#include "core/error.h"
#include "packing/adaptive.h"
#include "packing/hexagonal.h"
#include "tests/support/shapes.h"

// One packing on a CUDA device, for scripts/cuda-work, which counts the instructions that a simulated device
// executes: cuda_work hexagonal|adaptive RINGS RADIUS packs a torus of 2 RINGS^2 triangles with that largest
// (hexagonal) or smallest (adaptive) radius.

namespace aerate {
namespace {

double number(const char* text) {
  double value = 0;
  const auto [end, error] = std::from_chars(text, text + std::strlen(text), value);
  if (error != std::errc() || *end != '\0') throw UsageError(std::string(text) + " is not a number");
  return value;
}

void run(std::string_view method, const char* rings_text, const char* radius_text) {
  const auto rings = static_cast<std::uint32_t>(number(rings_text));
  const double radius = number(radius_text);
  const Mesh torus = test::make_torus(5, 2, rings, rings);
  Monitor monitor;
  const DeviceRequest cuda{.kind = DeviceRequest::Kind::cuda};
  const Packing packing = method == "hexagonal" ? pack_hexagonal(torus, {0, 0, 0, radius}, monitor, cuda)
                                                : pack_adaptive(torus, {0, 0, radius, 10}, {}, monitor, cuda);
  fmt::print("facets {} places {} spheres {}\n", torus.triangles.size(), packing.statistics.candidates,
             packing.spheres.size());
}

}  // namespace
}  // namespace aerate

int main(int argc, char** argv) {
  if (argc != 4) {
    fmt::print(stderr, "usage: cuda_work hexagonal|adaptive RINGS RADIUS\n");
    return 2;
  }
  try {
    aerate::run(argv[1], argv[2], argv[3]);
  } catch (const aerate::Error& error) {
    fmt::print(stderr, "cuda_work: {}\n", error.what());
    return 1;
  }
  return 0;
}
