#include <algorithm>
#include <cmath>
#include <cstddef>
#include <filesystem>
#include <fmt/core.h>
#include <string>
#include <utility>
#include <vector>

#include "bench/benchmark.h"
#include "bench/figures.h"
#include "bench/quadric_decimation.h"
#include "core/monitor.h"
#include "files/load.h"
#include "kernels/triangle_bvh.h"
#include "packing/packing_cells.h"
#include "pipeline/pack.h"
#include "printing/cells/cell_nodes.h"
#include "printing/cells/piece_surface.h"
#include "printing/cells/rolled_balls.h"
#include "printing/cells/shape_cells.h"

// How many triangles the voids of cells have, beside those that a quadric decimation of the same dense surfaces
// needs: to the same largest distance of the dense surface's vertices from the decimated one, and to the same root
// of the mean of their squares. Sealed voids of sla, the largest piece of each cell, tolerance 0.1 mm.

namespace aerate::bench {
namespace {

constexpr double kTolerance = 0.1, kFillet = 1.75;

struct Deviation {
  double most = 0, root_mean_square = 0;
};

// Of the vertices of one surface from the other.
Deviation deviation(const Mesh& dense, const Mesh& fewer) {
  std::vector<Vec3d> points;
  for (const Vec3f p : dense.positions) points.push_back(to_double(p));
  const std::vector<double> distances =
      kernels::HostTriangleBvh(fewer.positions, fewer.triangles).distances(points);
  Deviation result;
  double sum = 0;
  for (const double distance : distances) {
    result.most = std::max(result.most, distance);
    sum += distance * distance;
  }
  result.root_mean_square = std::sqrt(sum / static_cast<double>(distances.size()));
  return result;
}

// The fewest triangles, to a twentieth, with which a quadric decimation deviates by no more than that.
std::size_t fewest_triangles(const Mesh& dense, double Deviation::*measure, double most) {
  std::size_t too_few = 4, enough = dense.triangles.size();
  while (static_cast<double>(enough) > 1.05 * static_cast<double>(too_few)) {
    const auto middle =
        static_cast<std::size_t>(std::sqrt(static_cast<double>(too_few) * static_cast<double>(enough)));
    if (middle <= too_few || middle >= enough) break;
    const Mesh fewer = decimate_by_quadrics(dense, middle);
    (deviation(dense, fewer).*measure <= most ? enough : too_few) = middle;
  }
  return enough;
}

// The surface that a cell's largest void has before triangles are taken out.
Mesh dense_surface(const SurfaceIndex& surface, const NearFacets& near, const Packing& packing,
                   const CellVoids& cells, std::uint32_t cell, SharedWork& work) {
  const CellRegion region(cells.planes.of(cell), surface, near, packing.limits.wall);
  const CellNodes nodes = look_at_nodes(region, cells.planes.boxes[cell], kFillet, cells.lattice, work);
  const OpenedCell opened = open_cell(region, nodes, packing.spheres[cell], work);
  std::vector<std::int32_t> labels;
  const std::vector<NodePiece> pieces = find_pieces(nodes.box, opened.is_void, labels);
  const SurfacePlacer placer(region, kFillet, cells.lattice.spacing, 1e-5);
  PieceSurface piece = surface_of_piece(nodes.box, opened, nodes, labels, pieces.front().label, placer, work);
  Mesh mesh;
  for (const PlacedVertex& vertex : piece.vertices) mesh.positions.push_back(to_float(vertex.at));
  mesh.triangles = std::move(piece.triangles);
  return mesh;
}

PackedModel packed(const std::filesystem::path& model, Monitor& monitor) {
  PackingRequest request;
  request.method = &packing_method("adaptive");
  request.process = limits_under(*find_process("sla"), {{Limit::min_radius, {5}}, {Limit::max_radius, {10}}},
                                 ProcessCheck::strict);
  return pack_model(load_and_inspect({model}, {}, monitor), request, monitor);
}

void measure(const std::filesystem::path& model, Table& table) {
  Monitor monitor;
  const PackedModel packing = packed(model, monitor);
  const Box3f box = bounding_box(load_model(model).mesh);
  const CellShape shape{.fillet = kFillet, .tolerance = kTolerance};
  const Stopwatch watch;
  const CellVoids cells = shape_cells(
      packing.surface, packing.packing,
      cells_of(packing.packing, {to_double(box.lower), to_double(box.upper)}, {}, monitor), shape, monitor);
  const double seconds = watch.seconds();
  const NearFacets near(packing.surface.bvh());
  SharedWork work(monitor);
  std::size_t before = 0, ours = 0, to_most = 0, to_mean = 0;
  double most = 0;
  for (std::size_t i = 0; i < cells.voids.size(); ++i) {
    const CellVoid& one = cells.voids[i];
    // Pieces after the first begin from other nodes.
    if (i > 0 && cells.voids[i - 1].cell == one.cell) continue;
    const Mesh dense = dense_surface(packing.surface, near, packing.packing, cells, one.cell, work);
    const Deviation made = deviation(dense, one.surface);
    most = std::max(most, made.most);
    before += dense.triangles.size();
    ours += one.surface.triangles.size();
    to_most += fewest_triangles(dense, &Deviation::most, made.most);
    to_mean += fewest_triangles(dense, &Deviation::root_mean_square, made.root_mean_square);
  }
  const auto ratio = [&](std::size_t other) {
    return fmt::format("{:.2f}", static_cast<double>(ours) / static_cast<double>(other));
  };
  table.add({model.filename().string(), fmt::format("{:.2f}", seconds), grouped(static_cast<double>(before)),
             grouped(static_cast<double>(ours)), fmt::format("{:.3f}", most),
             grouped(static_cast<double>(to_most)), ratio(to_most), grouped(static_cast<double>(to_mean)),
             ratio(to_mean)});
}

int run(const Arguments& arguments) {
  Table table({"model", "shaped in, s", "dense", "triangles of voids", "deviation, mm",
               "quadrics to the same largest", "ratio", "to the same mean square", "ratio"});
  for (const std::string& model : arguments.positional) measure(model, table);
  return 0;
}

}  // namespace
}  // namespace aerate::bench

int main(int argc, char** argv) {
  return aerate::bench::run_benchmark(argc, argv, {"MODELS...", 1, aerate::bench::kAnyNumber},
                                      aerate::bench::run);
}
