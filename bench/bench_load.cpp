// Time to load a binary STL file against the floor: reading its bytes, decoding the corners and welding them.
//
//   bench_load MODEL.stl [REPETITIONS]

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <limits>
#include <vector>

#include "files/input_file.h"
#include "files/load.h"
#include "files/weld.h"

namespace {

constexpr std::size_t kHeaderBytes = 84;
constexpr std::size_t kFacetBytes = 50;
constexpr std::size_t kNormalBytes = 12;

aerate::Mesh read_directly(const char* path) {
  const aerate::InputFile bytes = aerate::read_file(path);
  std::uint32_t count = 0;
  std::memcpy(&count, bytes.data.get() + kHeaderBytes - sizeof(count), sizeof(count));
  if (bytes.size != kHeaderBytes + count * kFacetBytes) {
    std::fprintf(stderr, "bench_load: %s is not a binary STL file\n", path);
    std::exit(2);
  }
  std::vector<aerate::Vec3f> corners(std::size_t{count} * 3);
  for (std::size_t i = 0; i < count; ++i) {
    std::memcpy(&corners[3 * i], bytes.data.get() + kHeaderBytes + i * kFacetBytes + kNormalBytes,
                3 * sizeof(aerate::Vec3f));
  }
  return aerate::weld(corners);
}

template <typename F>
double seconds(const F& f) {
  const auto start = std::chrono::steady_clock::now();
  f();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 2) {
    std::fprintf(stderr, "usage: bench_load MODEL.stl [REPETITIONS]\n");
    return 2;
  }
  try {
    const int repetitions = argc > 2 ? std::max(1, std::atoi(argv[2])) : 5;
    double floor = std::numeric_limits<double>::infinity();
    double load = floor;
    std::size_t triangles = 0, vertices = 0;
    // Alternating, so that both see the same machine; the least of each is the one that was disturbed least.
    for (int i = 0; i < repetitions; ++i) {
      floor = std::min(floor, seconds([&] { triangles = read_directly(argv[1]).triangles.size(); }));
      load = std::min(load, seconds([&] { vertices = aerate::load_model(argv[1]).mesh.positions.size(); }));
    }
    std::printf("%zu triangles, %zu vertices: read, decode and weld %.3f s, load_model %.3f s: ratio %.2f\n",
                triangles, vertices, floor, load, load / floor);
    return 0;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "bench_load: %s\n", error.what());
    return 1;
  }
}
