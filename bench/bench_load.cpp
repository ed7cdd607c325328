// Time to load a binary STL file against the floor: reading its bytes, decoding the corners and welding them.

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <fmt/format.h>
#include <limits>
#include <stdexcept>
#include <string>
#include <vector>

#include "bench/benchmark.h"
#include "files/input_file.h"
#include "files/load.h"
#include "files/weld.h"

namespace aerate::bench {
namespace {

constexpr std::size_t kHeaderBytes = 84;
constexpr std::size_t kFacetBytes = 50;
constexpr std::size_t kNormalBytes = 12;

Mesh read_directly(const std::string& path) {
  const InputFile bytes = read_file(path);
  std::uint32_t count = 0;
  std::memcpy(&count, bytes.data.get() + kHeaderBytes - sizeof(count), sizeof(count));
  if (bytes.size != kHeaderBytes + count * kFacetBytes) {
    throw std::runtime_error(path + " is not a binary STL file");
  }
  std::vector<Vec3f> corners(std::size_t{count} * 3);
  for (std::size_t i = 0; i < count; ++i) {
    std::memcpy(&corners[3 * i], bytes.data.get() + kHeaderBytes + i * kFacetBytes + kNormalBytes,
                3 * sizeof(Vec3f));
  }
  return weld(corners);
}

int run(const Arguments& arguments) {
  const std::string& model = arguments.positional[0];
  double floor = std::numeric_limits<double>::infinity();
  double load = floor;
  std::size_t triangles = 0, vertices = 0;
  // Alternating, so that both see the same machine; the least of each is the one that was disturbed least.
  const int repetitions = static_cast<int>(arguments.number(1, 5));
  for (int i = 0; i < repetitions; ++i) {
    floor = std::min(floor, seconds_of([&] { triangles = read_directly(model).triangles.size(); }));
    load = std::min(load, seconds_of([&] { vertices = load_model(model).mesh.positions.size(); }));
  }
  fmt::print("{} triangles, {} vertices: read, decode and weld {:.3f} s, load_model {:.3f} s: ratio {:.2f}\n",
             triangles, vertices, floor, load, load / floor);
  return 0;
}

}  // namespace
}  // namespace aerate::bench

int main(int argc, char** argv) {
  return aerate::bench::run_benchmark(argc, argv, {"MODEL.stl [REPETITIONS]", 1, 2}, aerate::bench::run);
}
