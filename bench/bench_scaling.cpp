#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <ctime>
#include <fmt/format.h>
#include <functional>
#include <numbers>
#include <stdexcept>
#include <string>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>
#include <vector>

#include "bench/benchmark.h"
#include "bench/figures.h"
#include "core/monitor.h"
#include "core/packing.h"
#include "kernels/constants.h"
#include "packing/adaptive.h"
#include "packing/hexagonal.h"
#include "packing/verify.h"

// How time and memory grow: with triangles (a wavy ball of 10 mm, up to ten million of them) and with spheres
// (in such a ball of 20,000 triangles, up to five million), both packings; and what the index of triangles
// takes. Every row is a process of its own, so that its peak of memory is its own, and every sphere is
// verified.
// The arguments are the most of each, in millions. Exit status 1 if a sphere breaks a limit.

namespace aerate::bench {
namespace {

constexpr DeviceRequest kCpu{DeviceRequest::Kind::cpu, 0};

// A ball proper would be a case of its own: all its triangles are nearest to its centre.
double wavy_radius(double theta, double phi) {
  return 10 * (1 + 0.15 * std::sin(3 * theta) * std::cos(2 * phi + 1));
}

// About so many triangles: 2 segments (rings - 1), with twice as many segments as rings.
Mesh make_wavy_ball(double triangles) {
  const auto rings = static_cast<std::uint32_t>(std::lround(std::sqrt(triangles / 4))) + 1;
  const std::uint32_t segments = 2 * rings;
  Mesh mesh;
  mesh.positions.push_back({0, 0, 10});
  for (std::uint32_t r = 1; r < rings; ++r) {
    for (std::uint32_t s = 0; s < segments; ++s) {
      const double theta = std::numbers::pi * r / rings;
      const double phi = 2 * std::numbers::pi * s / segments;
      const double radius = wavy_radius(theta, phi);
      mesh.positions.push_back(
          to_float({radius * std::sin(theta) * std::cos(phi), radius * std::sin(theta) * std::sin(phi),
                    radius * std::cos(theta)}));
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

struct Row {
  double triangles, spheres, density, seconds, processor_seconds;
  double index_bytes, index_references, index_cells;
  double corrected;   // spheres that verification dropped or made smaller
  double peak_bytes;  // of the process, the model included
};

using Pack = std::function<Packing(const Mesh&, Monitor&)>;

Row measure(const Mesh& mesh, const Pack& pack) {
  Monitor monitor;
  const Stopwatch watch;
  const std::clock_t processor_start = std::clock();
  const Packing packing = pack(mesh, monitor);
  Row row{};
  row.processor_seconds = static_cast<double>(std::clock() - processor_start) / CLOCKS_PER_SEC;
  row.seconds = watch.seconds();
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  row.peak_bytes = 1024.0 * static_cast<double>(usage.ru_maxrss);
  row.triangles = static_cast<double>(mesh.triangles.size());
  row.spheres = static_cast<double>(packing.spheres.size());
  row.density = 100 * total_volume(packing) / std::abs(signed_volume(mesh));
  row.index_bytes = static_cast<double>(packing.statistics.index_bytes);
  row.index_references = static_cast<double>(packing.statistics.index_references);
  row.index_cells = static_cast<double>(packing.statistics.index_cells);
  const Packing verified = verify_packing(SurfaceIndex(mesh), packing);
  row.corrected = static_cast<double>(verified.statistics.dropped_by_verification +
                                      verified.statistics.shrunk_by_verification);
  return row;
}

// `measure` in a process of its own. Nothing may have started threads in this one.
Row measure_apart(double triangles, const Pack& pack) {
  std::array<int, 2> ends{};
  if (pipe(ends.data()) != 0) throw std::runtime_error("bench_scaling: no pipe");
  const pid_t child = fork();
  if (child < 0) throw std::runtime_error("bench_scaling: no process");
  if (child == 0) {
    const Row row = measure(make_wavy_ball(triangles), pack);
    const bool written = write(ends[1], &row, sizeof row) == sizeof row;
    _exit(written ? 0 : 1);
  }
  close(ends[1]);
  Row row{};
  const bool complete = read(ends[0], &row, sizeof row) == sizeof row;
  close(ends[0]);
  int status = 0;
  waitpid(child, &status, 0);
  if (!complete || status != 0) throw std::runtime_error("bench_scaling: a measurement failed");
  return row;
}

struct Case {
  double triangles;
  Pack pack;
};

// By how much y grows with x: the exponent of a power of x, by least squares.
double exponent(const std::vector<Row>& rows, double Row::*x, double Row::*y) {
  double n = 0, sx = 0, sy = 0, sxx = 0, sxy = 0;
  for (const Row& row : rows) {
    const double u = std::log(row.*x), v = std::log(row.*y);
    n += 1, sx += u, sy += v, sxx += u * u, sxy += u * v;
  }
  return (n * sxy - sx * sy) / (n * sxx - sx * sx);
}

// All series, and what is to be told of them.
struct Growth {
  std::string text;     // Markdown
  std::string summary;  // rows of README's table
  double corrected = 0;
};

struct Series {
  std::string title;
  double Row::*size;  // what grows
  std::string unit;   // of it
};

std::vector<std::string> cells_of(const Row& row, double Row::*size) {
  return {grouped(row.triangles),
          grouped(row.spheres),
          fmt::format("{:.2f}", row.density),
          fmt::format("{:.3f}", row.seconds),
          fmt::format("{:.3f}", row.processor_seconds),
          fmt::format("{:.2f}", 1e6 * row.processor_seconds / row.*size),
          fmt::format("{:.0f}", row.peak_bytes / 1e6),
          fmt::format("{:.0f}", row.peak_bytes / row.*size),
          fmt::format("{:.1f}", row.index_bytes / 1e6),
          fmt::format("{:.0f}", row.corrected)};
}

// Bytes of the index for a reference of a cell to a triangle, beside the 8 of each cell; 0 if there is none.
double bytes_per_reference(const std::vector<Row>& rows) {
  double most = 0;
  for (const Row& row : rows) {
    if (row.index_references > 0) {
      most = std::max(most, (row.index_bytes - 8 * row.index_cells) / row.index_references);
    }
  }
  return most;
}

void measure_series(const Series& series, const std::vector<Case>& cases, Growth& growth) {
  const std::string title = fmt::format("**{}**\n\n", series.title);
  fmt::print("\n{}", title);
  Table table({"triangles", "spheres", "density %", "seconds", "processor s",
               fmt::format("us / {}", series.unit), "peak MB", fmt::format("bytes / {}", series.unit),
               "index MB", "corrected"});
  std::vector<Row> rows;
  for (const Case& c : cases) {
    const Row row = rows.emplace_back(measure_apart(c.triangles, c.pack));
    table.add(cells_of(row, series.size));
    growth.corrected += row.corrected;
  }
  const double time = exponent(rows, series.size, &Row::processor_seconds);
  std::string remarks = fmt::format("Processor time grows with {}s ^ {:.2f}, the process's memory ^ {:.2f}.",
                                    series.unit, time, exponent(rows, series.size, &Row::peak_bytes));
  if (const double bytes = bytes_per_reference(rows); bytes > 0) {
    remarks += fmt::format(" Index: 8 bytes a cell, and at most {:.2f} a reference.", bytes);
  }
  fmt::print("\n{}\n", remarks);
  growth.text +=
      fmt::format("{}{}{}\n{}\n", growth.text.empty() ? "" : "\n", title, table.markdown(), remarks);
  growth.summary += fmt::format(
      "| {}, up to {:.2g} million {}s | {:.1f} s, {:.0f} MB; processor time grows with {}s ^ {:.2f} |\n",
      series.title.substr(0, series.title.find(',')), rows.back().*series.size / 1e6, series.unit,
      rows.back().seconds, rows.back().peak_bytes / 1e6, series.unit, time);
}

Pack hexagonal(double radius) {
  return [radius](const Mesh& mesh, Monitor& monitor) {
    return pack_hexagonal(mesh, {0, 0, 0, radius}, monitor, kCpu);
  };
}

Pack adaptive(double least, double largest) {
  return [least, largest](const Mesh& mesh, Monitor& monitor) {
    return pack_adaptive(mesh, {0, 0, least, largest}, {}, monitor, kCpu);
  };
}

std::vector<Case> with_triangles(double most, const Pack& pack) {
  std::vector<Case> cases;
  for (const double share : {0.03, 0.1, 0.3, 1.0}) cases.push_back({share * most, pack});
  return cases;
}

// Spheres grow with the inverse cube of their radii.
template <typename PackOf>
std::vector<Case> with_spheres(double most, double spheres_at_scale_1, PackOf pack_of) {
  constexpr double kTriangles = 20000;
  std::vector<Case> cases;
  for (const double share : {0.03, 0.1, 0.3, 1.0}) {
    cases.push_back({kTriangles, pack_of(std::cbrt(spheres_at_scale_1 / (share * most)))});
  }
  return cases;
}

Growth measure_growth(double triangles, double spheres, double adaptive_spheres) {
  Growth growth;
  measure_series({"Hexagonal, R = 1 mm: more triangles", &Row::triangles, "triangle"},
                 with_triangles(triangles, hexagonal(1)), growth);
  measure_series({"Adaptive, r >= 0.4 mm: more triangles", &Row::triangles, "triangle"},
                 with_triangles(triangles, adaptive(0.4, kInfinity)), growth);
  // So many spheres there are, about, at scale 1.
  measure_series({"Hexagonal, 20,000 triangles: more spheres", &Row::spheres, "sphere"},
                 with_spheres(spheres, 5e6, [](double scale) { return hexagonal(0.0925 * scale); }), growth);
  measure_series({"Adaptive, 20,000 triangles, radii of 1 : 4.4: more spheres", &Row::spheres, "sphere"},
                 with_spheres(adaptive_spheres, 0.25e6,
                              [](double scale) { return adaptive(0.045 * scale, 0.2 * scale); }),
                 growth);
  return growth;
}

int run(const Arguments& arguments) {
  const Growth growth = measure_growth(1e6 * arguments.number(0, 10), 1e6 * arguments.number(1, 5),
                                       1e6 * arguments.number(2, 2.5));
  if (growth.corrected > 0) {
    fmt::print(stderr, "{} spheres broke a limit\n", growth.corrected);
    return 1;
  }
  write_figures(arguments, growth.text, growth.summary);
  return 0;
}

}  // namespace
}  // namespace aerate::bench

int main(int argc, char** argv) {
  return aerate::bench::run_benchmark(
      argc, argv, {"[TRIANGLES [SPHERES [ADAPTIVE_SPHERES]]]", 0, 3, aerate::bench::Tables::written},
      aerate::bench::run);
}
