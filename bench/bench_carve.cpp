// Figures of printing's stages: void surfaces against the least number of triangles, remeshed models against
// the models, and writing.

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fmt/core.h>
#include <fstream>
#include <limits>
#include <sstream>
#include <string>
#include <vector>

#include "bench/benchmark.h"
#include "bench/surface_samples.h"
#include "files/formats.h"
#include "files/load.h"
#include "kernels/point_triangle.h"
#include "kernels/triangle_bvh.h"
#include "printing/carve.h"
#include "printing/remesh.h"
#include "printing/shells.h"

namespace aerate::bench {
namespace {

constexpr int kRepetitions = 5;

// The process's peak memory since `reset`, from Linux's accounting; 0 elsewhere.
class PeakMemory {
 public:
  static void reset() { std::ofstream("/proc/self/clear_refs") << "5"; }
  static double mebibytes() {
    std::ifstream status("/proc/self/status");
    for (std::string word; status >> word;) {
      double kibibytes = 0;
      if (word == "VmHWM:" && status >> kibibytes) return kibibytes / 1024;
    }
    return 0;
  }
};

// The signed distance of a void's surface from its sphere, mm: corners, edges and the depths of its
// triangles, which are exact.
void print_sphere(double radius, double tolerance) {
  const Sphere sphere{{51.7, 48.2, 33.3}, radius, SphereKind::lattice};
  Monitor monitor;
  Packing packing;
  packing.spheres = {sphere};
  const Mesh mesh = carve_keeping_surface({}, packing, {tolerance}, monitor).mesh;
  double lowest = std::numeric_limits<double>::infinity(), highest = -lowest;
  for (const Triangle& t : mesh.triangles) {
    const kernels::Facet facet{mesh.positions[t[0]], mesh.positions[t[1]], mesh.positions[t[2]]};
    const double nearest = std::sqrt(kernels::distance_squared_to_facet(sphere.centre, facet));
    lowest = std::min(lowest, nearest - radius);
    for (const Vec3f& corner : {facet.a, facet.b, facet.c}) {
      highest = std::max(highest, length(to_double(corner) - sphere.centre) - radius);
    }
  }
  const double least_triangles = 4.84 * radius / tolerance;
  const double volume = 4.0 / 3.0 * 3.14159265358979 * radius * radius * radius;
  fmt::print("{:8.2f} {:10.3f} {:10} {:12.2f} {:11.5f} {:11.6f} {:10.1f}\n", radius, tolerance,
             mesh.triangles.size(), static_cast<double>(mesh.triangles.size()) / least_triangles, lowest,
             highest, -100 * signed_volume(mesh) / volume);
}

void print_spheres() {
  fmt::print("Void surfaces (tolerance: within [-tolerance, 0] mm of the planned sphere)\n\n");
  fmt::print("{:>8} {:>10} {:>10} {:>12} {:>11} {:>11} {:>10}\n", "r mm", "tolerance", "triangles",
             "x 4.84 r/t", "lowest mm", "highest mm", "volume %");
  for (const double tolerance : {0.05, 0.02, 0.1}) {
    for (const double radius : {0.62, 1.0, 3.0, 9.5, 30.0}) print_sphere(radius, tolerance);
  }

  fmt::print("\nCarving many voids, 0.62..2.62 mm, tolerance 0.05 mm\n\n{:>10} {:>12} {:>10}\n", "voids",
             "triangles", "seconds");
  for (const int count : {3000, 100000}) {
    Packing packing;
    for (int i = 0; i < count; ++i) {
      packing.spheres.push_back({{6.0 * (i % 50), 6.0 * (i / 50 % 50), 6.0 * (i / 2500)},
                                 0.62 + 2.0 * i / count,
                                 SphereKind::lattice});
    }
    Monitor monitor;
    std::size_t triangles = 0;
    const double time = least_seconds(kRepetitions, [&] {
      triangles = carve_keeping_surface({}, packing, {0.05}, monitor).mesh.triangles.size();
    });
    fmt::print("{:10} {:12} {:10.3f}\n", count, triangles, time);
  }
}

struct Deviation {
  double largest = 0, root_mean_square = 0;
};

Deviation deviation(const Mesh& from, const Mesh& to) {
  const kernels::HostTriangleBvh bvh(to.positions, to.triangles);
  Deviation result;
  double squares = 0;
  const std::vector<double> distances = bvh.distances(sample_surface(from, 500'000).points);
  for (const double distance : distances) {
    result.largest = std::max(result.largest, distance);
    squares += distance * distance;
  }
  result.root_mean_square = std::sqrt(squares / static_cast<double>(distances.size()));
  return result;
}

void print_remeshed(const std::string& path, const std::vector<double>& voxel_sizes) {
  const Mesh model = load_model(path).mesh;
  const double volume = signed_volume(model);
  fmt::print("\nRemeshed: {}, {} triangles, {} shells, {:.0f} mm3\n\n",
             std::filesystem::path(path).filename().string(), model.triangles.size(), count_shells(model),
             volume);
  fmt::print("{:>8} {:>10} {:>7} {:>9} {:>9} {:>10} {:>10} {:>10} {:>10} {:>9} {:>9}\n", "voxel mm",
             "triangles", "shells", "volume %", "seconds", "to model:", "rms mm", "from it:", "rms mm",
             "peak MiB", "estimate");
  for (const double voxel_size : voxel_sizes) {
    Monitor monitor;
    Mesh surface;
    const double before = PeakMemory::mebibytes();
    PeakMemory::reset();
    const double idle = PeakMemory::mebibytes();
    const double time = seconds_of([&] {
      surface = ModelLevelSet(model, voxel_size, std::numeric_limits<double>::max(), monitor).surface();
    });
    const double peak = before > 0 ? PeakMemory::mebibytes() - idle : 0;
    const Deviation to_model = deviation(surface, model), from_model = deviation(model, surface);
    fmt::print("{:8.2f} {:10} {:7} {:9.3f} {:9.2f} {:10.4f} {:10.5f} {:10.4f} {:10.5f} {:9.0f} {:9.0f}\n",
               voxel_size, surface.triangles.size(), count_shells(surface),
               100 * signed_volume(surface) / volume, time, to_model.largest, to_model.root_mean_square,
               from_model.largest, from_model.root_mean_square, peak,
               ModelLevelSet::estimated_bytes(model, voxel_size) / (1024 * 1024));
  }
}

// A sheet of 2,000,000 triangles.
Mesh make_sheet() {
  constexpr std::uint32_t kSide = 1001;
  Mesh mesh;
  for (std::uint32_t y = 0; y < kSide; ++y) {
    for (std::uint32_t x = 0; x < kSide; ++x) {
      mesh.positions.push_back({static_cast<float>(x) / 10, static_cast<float>(y) / 10,
                                static_cast<float>(std::sin(0.1 * x) * std::cos(0.1 * y))});
    }
  }
  for (std::uint32_t y = 0; y + 1 < kSide; ++y) {
    for (std::uint32_t x = 0; x + 1 < kSide; ++x) {
      const std::uint32_t corner = y * kSide + x;
      mesh.triangles.push_back({corner, corner + 1, corner + kSide + 1});
      mesh.triangles.push_back({corner, corner + kSide + 1, corner + kSide});
    }
  }
  return mesh;
}

void print_writing() {
  const Mesh mesh = make_sheet();
  const ScratchFolder folder;
  fmt::print("\nWriting {} triangles (to the page cache, without flushing)\n\n{:>8} {:>10} {:>10}\n",
             mesh.triangles.size(), "format", "MB", "seconds");
  for (const char* ending : {".stl", ".obj", ".ply"}) {
    const std::filesystem::path path = folder.path() / (std::string("sheet") + ending);
    const double time = least_seconds(kRepetitions, [&] { write_mesh(mesh, path, format_to_write(path)); });
    fmt::print("{:>8} {:10.1f} {:10.3f}\n", ending,
               static_cast<double>(std::filesystem::file_size(path)) / 1e6, time);
  }
}

int run(const Arguments& arguments) {
  std::vector<double> voxel_sizes;  // mm, as in 0.5,0.3,0.2
  std::istringstream list(arguments.text(0, ""));
  for (std::string size; std::getline(list, size, ',');) voxel_sizes.push_back(std::stod(size));
  print_spheres();
  for (std::size_t i = 1; i < arguments.positional.size(); ++i)
    print_remeshed(arguments.positional[i], voxel_sizes);
  print_writing();
  return 0;
}

}  // namespace
}  // namespace aerate::bench

int main(int argc, char** argv) {
  return aerate::bench::run_benchmark(
      argc, argv, {"[VOXEL_SIZES MODEL.stl...]", 0, aerate::bench::kAnyNumber}, aerate::bench::run);
}
