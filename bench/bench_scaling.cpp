#include <chrono>
#include <cmath>
#include <cstdint>
#include <fmt/format.h>
#include <limits>
#include <numbers>
#include <string>

#include "core/monitor.h"
#include "core/packing.h"
#include "packing/adaptive.h"
#include "packing/hexagonal.h"
#include "packing/verify.h"

// How time and memory grow: with triangles (a ball of 10 mm, up to ten million of them) and with spheres (in
// a ball, up to five million). Usage: bench_scaling [TRIANGLES [SPHERES]], the most of each, in millions.

namespace aerate::bench {
namespace {

constexpr double kUnlimited = std::numeric_limits<double>::infinity();

Mesh make_ball(std::size_t triangles) {
  // 2 segments (rings - 1) triangles, with twice as many segments as rings.
  const auto rings =
      static_cast<std::uint32_t>(std::lround(std::sqrt(static_cast<double>(triangles) / 4))) + 1;
  const std::uint32_t segments = 2 * rings;
  Mesh mesh;
  mesh.positions.push_back({0, 0, 10});
  for (std::uint32_t r = 1; r < rings; ++r) {
    for (std::uint32_t s = 0; s < segments; ++s) {
      const double theta = std::numbers::pi * r / rings;
      const double phi = 2 * std::numbers::pi * s / segments;
      mesh.positions.push_back(to_float({10 * std::sin(theta) * std::cos(phi),
                                         10 * std::sin(theta) * std::sin(phi), 10 * std::cos(theta)}));
    }
  }
  mesh.positions.push_back({0, 0, -10});
  const auto at = [&](std::uint32_t r, std::uint32_t s) { return 1 + (r - 1) * segments + s % segments; };
  const auto last = static_cast<std::uint32_t>(mesh.positions.size() - 1);
  for (std::uint32_t s = 0; s < segments; ++s) {
    mesh.triangles.push_back({0, at(1, s), at(1, s + 1)});
    mesh.triangles.push_back({last, at(rings - 1, s + 1), at(rings - 1, s)});
    for (std::uint32_t r = 1; r + 1 < rings; ++r) {
      mesh.triangles.push_back({at(r, s), at(r + 1, s), at(r + 1, s + 1)});
      mesh.triangles.push_back({at(r, s), at(r + 1, s + 1), at(r, s + 1)});
    }
  }
  return mesh;
}

template <typename Pack>
void print_row(const std::string& method, const Mesh& mesh, Pack pack) {
  const auto start = std::chrono::steady_clock::now();
  const Packing packing = pack();
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  const auto triangles = static_cast<double>(mesh.triangles.size());
  const auto spheres = static_cast<double>(packing.spheres.size());
  const double volume = 100 * total_volume(packing) / std::abs(signed_volume(mesh));
  const Packing verified = verify_packing(mesh, packing);
  const std::size_t corrected =
      verified.statistics.dropped_by_verification + verified.statistics.shrunk_by_verification;
  fmt::print("| {} | {} | {} | {:.2f} | {:.3f} | {:.2f} | {:.2f} | {:.1f} | {} |\n", method,
             mesh.triangles.size(), packing.spheres.size(), volume, seconds, 1e6 * seconds / triangles,
             1e6 * seconds / spheres, static_cast<double>(packing.statistics.index_bytes) / 1e6, corrected);
  std::fflush(stdout);
}

void print_both(const Mesh& mesh, double hexagonal_radius, double least_adaptive_radius,
                double largest_adaptive_radius) {
  Monitor monitor;
  const DeviceRequest cpu{DeviceRequest::Kind::cpu, 0};
  print_row("hexagonal", mesh, [&] {
    return pack_hexagonal(mesh, {0, 0, 0, hexagonal_radius}, monitor, cpu);
  });
  print_row("adaptive", mesh, [&] {
    return pack_adaptive(mesh, {0, 0, least_adaptive_radius, largest_adaptive_radius}, {}, monitor, cpu);
  });
}

}  // namespace
}  // namespace aerate::bench

int main(int argc, char** argv) {
  using namespace aerate::bench;
  const double most_triangles = argc > 1 ? std::atof(argv[1]) : 10;
  const double most_spheres = argc > 2 ? std::atof(argv[2]) : 5;
  fmt::print(
      "| method | triangles | spheres | density % | seconds | us / triangle | us / sphere | index MB | "
      "corrected by verification |\n| --- | --- | --- | --- | --- | --- | --- | --- | --- |\n");
  for (const double share : {0.01, 0.1, 0.3, 1.0}) {
    print_both(make_ball(static_cast<std::size_t>(share * most_triangles * 1e6)), 1.0, 0.4, kUnlimited);
  }
  // Places of the hexagonal packing grow with 1 / R^3; so do the balls of the adaptive one, of which there
  // are a tenth.
  const auto ball = make_ball(20000);
  for (const double share : {0.01, 0.1, 1.0}) {
    const double scale = std::cbrt(share * most_spheres / 5);
    print_both(ball, 0.093 / scale, 0.045 / scale, 0.2 / scale);
  }
}
