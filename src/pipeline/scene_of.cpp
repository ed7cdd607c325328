#include "pipeline/scene_of.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <fmt/format.h>
#include <iterator>
#include <optional>
#include <span>
#include <string>
#include <tbb/parallel_for.h>
#include <utility>
#include <vector>

#include "core/ceiling.h"
#include "core/disjoint_sets.h"
#include "core/listed.h"
#include "core/printable.h"
#include "core/upright.h"
#include "kernels/constants.h"
#include "kernels/roof_distance.h"
#include "kernels/roofed_surface.h"
#include "kernels/winding.h"
#include "mesh/inspect.h"
#include "mesh/topology.h"
#include "pipeline/budget.h"
#include "pipeline/print_verdict.h"
#include "pipeline/support.h"
#include "printing/carve.h"
#include "printing/cells/shape_cells.h"

namespace aerate {
namespace {

std::string point(Vec3d p) {
  // Rounded first, so that nothing reads as -0.0.
  for (double* coordinate : {&p.x, &p.y, &p.z}) *coordinate = std::round(*coordinate * 10) / 10 + 0.0;
  return fmt::format("({:.1f}, {:.1f}, {:.1f}) mm", p.x, p.y, p.z);
}

// In the unit that people think in.
std::string volume(double mm3) {
  return std::abs(mm3) >= 1000 ? fmt::format("{:.1f} cm3", mm3 / 1000) : fmt::format("{:.1f} mm3", mm3);
}

std::string size_of(const Mesh& mesh) {
  const Box3f box = bounding_box(mesh);
  const Vec3d size = to_double(box.upper) - to_double(box.lower);
  return fmt::format("{:.4g} x {:.4g} x {:.4g} mm", size.x, size.y, size.z);
}

// 1234567 -> "1,234,567"
std::string grouped(std::size_t number) {
  std::string digits = fmt::format("{}", number);
  for (std::ptrdiff_t at = std::ssize(digits) - 3; at > 0; at -= 3)
    digits.insert(static_cast<std::size_t>(at), 1, ',');
  return digits;
}

std::string how_many(std::size_t count, const std::string& what) {
  return fmt::format("{} {}{}", grouped(count), what, count == 1 ? "" : "s");
}

std::string title_of(const InputFacts& input) {
  return printable(input.path.filename().string());
}

// Where a void comes nearest to a surface.
struct NearestPlace {
  double distance = kInfinity;
  Vec3d place{0, 0, 0};
};

// By the corners of its triangles.
NearestPlace nearest_of(const Mesh& mesh, const SolidPart& part, const kernels::TriangleBvhView& surface) {
  std::vector<std::uint32_t> corners;
  corners.reserve(3 * part.triangle_count);
  for (const Triangle& t : triangles_of(mesh, part)) corners.insert(corners.end(), t.begin(), t.end());
  std::ranges::sort(corners);
  corners.erase(std::unique(corners.begin(), corners.end()), corners.end());
  NearestPlace nearest;
  double least_squared = kInfinity;
  for (const std::uint32_t corner : corners) {
    const Vec3d p = to_double(mesh.positions[corner]);
    const kernels::NearestFacet found = surface.nearest(p, least_squared);
    if (!(found.distance_squared < least_squared)) continue;
    least_squared = found.distance_squared;
    nearest = {std::sqrt(least_squared), p};
  }
  return nearest;
}

// Measures the walls that are not known yet, and marks where the thinnest of all is.
void measure_walls(Scene& scene, const kernels::TriangleBvhView& surface) {
  const std::vector<SolidPart> parts = parts_of(scene, PartKind::void_surface);
  tbb::parallel_for(std::size_t{0}, parts.size(), [&](std::size_t i) {
    if (!scene.voids[i].wall) scene.voids[i].wall = nearest_of(scene.mesh, parts[i], surface).distance;
  });
  const char* const what = scene.void_use == VoidUse::modifiers ? "modifier"
                           : scene.void_use == VoidUse::found   ? "hollow"
                           : scene.void_use == VoidUse::removed ? "void"
                           : scene.has_spheres                  ? "sphere"
                                                                : "cell";
  const auto thinnest = std::ranges::min_element(
      scene.voids, [](const SceneVoid& a, const SceneVoid& b) { return *a.wall < *b.wall; });
  if (thinnest == scene.voids.end() || !std::isfinite(*thinnest->wall)) return;
  const auto part = static_cast<std::size_t>(thinnest - scene.voids.begin());
  const Vec3d place = nearest_of(scene.mesh, parts[part], surface).place;
  scene.marks.push_back({MarkKind::thinnest_wall, place,
                         fmt::format("thinnest wall: {:.2f} mm, beside {} {} at {}", *thinnest->wall, what,
                                     thinnest->number, point(place))});
}

std::vector<SceneVoid> voids_of_spheres(const Packing& packing, const SurfaceIndex& surface) {
  const Roof& roof = packing.limits.roof;
  std::vector<SceneVoid> voids(packing.spheres.size());
  tbb::parallel_for(std::size_t{0}, voids.size(), [&](std::size_t i) {
    const Sphere& sphere = packing.spheres[i];
    voids[i] = {i + 1, sphere.centre, sphere.radius, void_volume(roof, sphere.radius),
                kernels::distance_to_surface(surface.bvh(), roof, sphere.centre, sphere.radius)};
  });
  return voids;
}

std::vector<SceneVoid> voids_of_cells(const Packing& packing, const CellVoids& cells) {
  std::vector<SceneVoid> voids(cells.voids.size());
  tbb::parallel_for(std::size_t{0}, voids.size(), [&](std::size_t i) {
    const CellVoid& cell = cells.voids[i];
    const VolumeMoments moments = volume_moments(cell.surface);
    const Vec3d place =
        moments.volume != 0 ? moments.first_moment * (1 / moments.volume) : packing.spheres[cell.cell].centre;
    voids[i] = {i + 1, place, packing.spheres[cell.cell].radius, std::abs(moments.volume), std::nullopt};
  });
  return voids;
}

std::string radii_of(const std::vector<SceneVoid>& voids) {
  const auto [least, most] = std::ranges::minmax_element(
      voids, [](const SceneVoid& a, const SceneVoid& b) { return a.radius < b.radius; });
  const std::string from = fmt::format("{:.2f}", least->radius), to = fmt::format("{:.2f}", most->radius);
  return from == to ? from + " mm" : from + " to " + to + " mm";
}

void add_cup(Scene& scene, const AirCup& cup, double limit) {
  scene.marks.push_back(
      {MarkKind::cup, cup.place,
       fmt::format("cup: a layer closes in {:.0f} mm2 ({} {:g}) at {}", cup.area,
                   cup.area > limit ? "over the limit of" : "limit", limit, point(cup.place))});
}

void add_cups(Scene& scene, const std::optional<PrintedCups>& cups) {
  if (!cups) return;
  for (const AirCup& cup : cups->worst) add_cup(scene, cup, cups->limit.value);
}

// The middle of a ceiling, on the shell that it is part of.
Vec3d place_on(const Mesh& mesh, const SolidPart& part, const Ceiling& ceiling, const UprightFrame& frame) {
  double x = 0, y = 0;
  for (const auto& [from, to] : ceiling.rim) {
    x += from.x;
    y += from.y;
  }
  const auto count = static_cast<double>(std::max<std::size_t>(ceiling.rim.size(), 1));
  x /= count;
  y /= count;
  double height = -kInfinity, highest = -kInfinity;
  for (const Triangle& t : triangles_of(mesh, part)) {
    const Vec3d a = frame.to_frame(to_double(mesh.positions[t[0]]));
    const Vec3d b = frame.to_frame(to_double(mesh.positions[t[1]]));
    const Vec3d c = frame.to_frame(to_double(mesh.positions[t[2]]));
    highest = std::max({highest, a.z, b.z, c.z});
    const kernels::Facet facet{to_float(a), to_float(b), to_float(c)};
    if (kernels::winding_detail::line_crossing(facet, x, y) == 0) continue;
    const Vec3d normal = cross(b - a, c - a);
    if (normal.z != 0)
      height = std::max(height, a.z - (normal.x * (x - a.x) + normal.y * (y - a.y)) / normal.z);
  }
  if (height == -kInfinity) height = highest;
  return frame.x * x + frame.y * y + frame.z * height;
}

// Ceilings of voids that are wider than is bridged.
void add_wide_ceilings(Scene& scene, const Roof& roof, const std::string& who) {
  if (!roof.limits_ceilings()) return;
  scene.bridge = roof.bridge();
  const std::vector<SolidPart> parts = parts_of(scene, PartKind::void_surface);
  const UprightFrame frame(roof.up);
  struct Found {
    std::size_t part;
    double width;
    Vec3d place;
  };
  std::vector<std::vector<Found>> by_part(parts.size());
  tbb::parallel_for(std::size_t{0}, parts.size(), [&](std::size_t i) {
    for (const Ceiling& ceiling : ceilings_of(scene.mesh, triangles_of(scene.mesh, parts[i]), roof)) {
      const double most = roof.bridge() + scene.tolerance;
      if (ceiling.bound() <= most) continue;
      const double width = widest_disc(ceiling, most);
      if (width > most) by_part[i].push_back({i, width, place_on(scene.mesh, parts[i], ceiling, frame)});
    }
  });
  std::vector<Found> found;
  for (const std::vector<Found>& own : by_part) found.insert(found.end(), own.begin(), own.end());
  std::stable_sort(found.begin(), found.end(),
                   [](const Found& a, const Found& b) { return a.width > b.width; });
  for (const Found& each : found)
    scene.marks.push_back(
        {MarkKind::ceiling, each.place,
         fmt::format("ceiling {:.1f} mm wide in void {} ({} bridges {:g} mm) at {}", each.width,
                     scene.voids[each.part].number, who, roof.bridge(), point(each.place))});
}

const char* words_for_voids(const HollowReport& report) {
  return report.modifiers ? "modifier" : report.cells ? "cell" : "void";
}

void add_figures(Scene& scene, const HollowReport& report) {
  const OutputFacts& output = report.output;
  const auto add = [&](const char* name, std::string value) {
    scene.figures.push_back({name, std::move(value)});
  };
  add("model", size_of(scene.mesh));
  add(report.modifiers ? "in modifiers" : "removed",
      fmt::format("{} of {} ({:.1f} %)", volume(output.volume_removed), volume(output.volume_before),
                  100 * output.volume_removed / output.volume_before));
  if (!scene.voids.empty())
    add(report.modifiers ? "modifiers" : "voids",
        fmt::format("{}, radius {}", grouped(scene.voids.size()), radii_of(scene.voids)));
  if (report.modifiers) {
    add("infill in them", fmt::format("{:g} %{}", report.modifiers->infill_percent,
                                      report.modifiers->hold_lightning ? " lightning" : ""));
  } else {
    const MaterialUse use = material_use(report);
    add("material", fmt::format("{}{} {:.1f} -> {:.1f} g", report.material.name,
                                report.print && !use.predicted ? ", if printed solid:" : "",
                                use.mass_before_g, use.mass_after_g));
  }
  if (output.void_count > 0 && std::isfinite(output.clearances.wall))
    add("wall", fmt::format("{:.2f} mm at least (limit {:g})", output.clearances.wall, report.limits.wall));
  if (output.clearances.gap && output.void_count > 1)
    add("gap", fmt::format("{:.2f} mm at least (limit {:g})", *output.clearances.gap, report.limits.gap));
  if (report.drainage)
    add("drainage",
        fmt::format("{}, {}", counted(report.drainage->plan.channels.size(), "channel", "channels"),
                    counted(report.drainage->plan.holes.size(), "escape hole", "escape holes")));
  if (output.ceilings)
    add("ceilings", fmt::format("{:.1f} mm wide at most (bridge {:g})", output.ceilings->widest,
                                report.limits.roof.bridge()));
  add("process", report.process.process.name);
}

// What a page tells beside these.
void add_details(Scene& scene, const HollowReport& report) {
  const OutputFacts& output = report.output;
  const auto add = [&](const char* name, std::string value) {
    scene.details.push_back({name, std::move(value)});
  };
  if (report.print)
    for (const std::string& line : verdict_of(*report.print)) add("verdict", line);
  if (!report.modifiers)
    add("strength",
        fmt::format("{:.0f} % solid; stiffness about {:.0f} % (an upper bound, estimated)",
                    100 * output.volume_after / output.volume_before, 100 * report.balance.stiffness));
  if (report.balance.tips_over()) add("balance", "it stood by itself, and its voids tip it over");
  if (report.output.drainage) add("sealed", counted(output.drainage->sealed_cavities, "cavity", "cavities"));
  if (!report.output_path.empty())
    add("file", fmt::format("{}, {} triangles, {:.3g} MB", printable(report.output_path.filename().string()),
                            grouped(output.triangle_count), static_cast<double>(report.output_bytes) / 1e6));
  add("tolerance", fmt::format("{:.3g} mm", report.tolerance_used));
}

// Modifiers change nothing but what a print takes.
void add_changes(Scene& scene, const HollowReport& report) {
  const auto add = [&](const char* name, const char* unit, double before, double after) {
    scene.changes.push_back({name, unit, before, after});
  };
  if (report.modifiers) {
    if (report.print)
      add("Filament", "cm3", report.print->filament_before_mm3 / 1000,
          report.print->filament_after_mm3 / 1000);
    return;
  }
  add("Volume", "cm3", report.output.volume_before / 1000, report.output.volume_after / 1000);
  const MaterialUse use = material_use(report);
  const bool if_solid = report.print && !use.predicted;
  add(if_solid ? "Mass, if printed solid" : "Mass", "g", use.mass_before_g, use.mass_after_g);
  add(if_solid ? "Cost, if printed solid" : "Cost", "", use.cost_before, use.cost_after);
}

// What bounds the model itself.
Solid whole(const Mesh& mesh) {
  Solid solid{mesh, {}};
  solid.close_part(PartKind::outer);
  return solid;
}

// The sealed hollows of a closed model: inward shells within an outward one.
std::vector<std::uint32_t> hollow_shells(const Inspection& inspection, const std::vector<Shell>& shells) {
  constexpr double kLeast = 0.01;  // mm3: less is a fold of a scan
  std::vector<std::uint32_t> hollows;
  if (!inspection.closed()) return hollows;
  const auto holds = [](const Box3f& outer, const Box3f& inner) {
    return min_of(outer.lower, inner.lower) == outer.lower && max_of(outer.upper, inner.upper) == outer.upper;
  };
  for (std::uint32_t i = 0; i < shells.size(); ++i) {
    if (!(shells[i].volume < -kLeast)) continue;
    if (std::ranges::any_of(
            shells, [&](const Shell& other) { return other.volume > 0 && holds(other.box, shells[i].box); }))
      hollows.push_back(i);
  }
  return hollows;
}

// The model's own triangles, those of its sealed hollows last.
void take_read_mesh(Scene& scene, const Mesh& mesh, const Inspection& inspection) {
  scene.is_closed = inspection.closed();
  scene.void_use = VoidUse::found;
  const bool has_inward =
      std::ranges::any_of(inspection.shells, [](const Shell& each) { return each.volume < 0; });
  Solid solid = whole(mesh);
  if (has_inward && scene.is_closed) {
    const ShellLabels labels = label_shells(mesh, EdgeUses(mesh));
    const std::vector<Shell> shells = describe_shells(mesh, labels);
    const std::vector<std::uint32_t> hollows = hollow_shells(inspection, shells);
    std::vector<std::vector<Triangle>> of_hollow(shells.size());
    std::vector<char> is_hollow(shells.size(), 0);
    for (const std::uint32_t shell : hollows) is_hollow[shell] = 1;
    solid = {{mesh.positions, {}}, {}};
    solid.mesh.triangles.reserve(mesh.triangles.size());
    for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
      const std::uint32_t label = labels.of_triangle[i];
      const bool is_outside = label == kNone || is_hollow[label] == 0;
      (is_outside ? solid.mesh.triangles : of_hollow[label]).push_back(mesh.triangles[i]);
    }
    solid.close_part(PartKind::outer);
    for (const std::uint32_t shell : hollows) {
      const std::vector<Triangle>& own = of_hollow[shell];
      solid.mesh.triangles.insert(solid.mesh.triangles.end(), own.begin(), own.end());
      solid.close_part(PartKind::void_surface);
      const VolumeMoments moments = volume_moments(solid.mesh, own, to_double(shells[shell].box.lower));
      const double size = -moments.volume;
      constexpr double kBall = 4.0 / 3.0 * 3.14159265358979324;
      const Vec3d middle = (to_double(shells[shell].box.lower) + to_double(shells[shell].box.upper)) * 0.5;
      scene.voids.push_back({scene.voids.size() + 1, middle, std::cbrt(size / kBall), size, std::nullopt});
    }
  }
  scene.mesh = std::move(solid.mesh);
  scene.parts = std::move(solid.parts);
}

void add_open_edges(Scene& scene, const Mesh& mesh, const EdgeUses& uses) {
  std::vector<std::pair<BoundaryLoop, BoundaryChain>> rims;
  for (BoundaryChain& chain : chain_boundary(mesh, uses)) {
    const BoundaryLoop loop = describe_loop(mesh, chain);
    rims.emplace_back(loop, std::move(chain));
  }
  std::stable_sort(rims.begin(), rims.end(),
                   [](const auto& a, const auto& b) { return a.first.diameter > b.first.diameter; });
  for (const auto& [loop, chain] : rims) {
    SceneMark mark{MarkKind::hole_in_mesh,
                   loop.centre,
                   fmt::format("hole in the surface: {:.3g} mm across, {}, at {}", loop.diameter,
                               counted(loop.edge_count, "open edge", "open edges"), point(loop.centre)),
                   {}};
    const std::size_t count = chain.vertices.size();
    const std::size_t steps = chain.closed ? count : count - 1;
    for (std::size_t i = 0; i < steps; ++i)
      mark.lines.emplace_back(to_double(mesh.positions[chain.vertices[i]]),
                              to_double(mesh.positions[chain.vertices[(i + 1) % count]]));
    scene.marks.push_back(std::move(mark));
  }
}

// Edges that hang together are one mark.
void add_bad_edges(Scene& scene, const Mesh& mesh, const EdgeUses& uses) {
  struct Edge {
    std::uint32_t low, high;
    bool is_misoriented;
  };
  std::vector<Edge> edges;
  for (std::size_t row = 0; row < uses.row_count(); ++row)
    uses.for_each_edge(row, [&](std::uint32_t low, std::uint32_t high, std::span<const EdgeUse> edge) {
      const EdgeBalance balance = balance_of(mesh, low, edge);
      if (balance.is_misoriented() || balance.is_non_manifold())
        edges.push_back({low, high, balance.is_misoriented()});
    });
  DisjointSets sets(mesh.positions.size());
  for (const Edge& edge : edges) sets.join(edge.low, edge.high);
  std::stable_sort(edges.begin(), edges.end(),
                   [&](const Edge& a, const Edge& b) { return sets.root(a.low) < sets.root(b.low); });
  std::vector<SceneMark> marks;
  for (std::size_t begin = 0; begin < edges.size();) {
    std::size_t end = begin;
    std::size_t misoriented = 0;
    SceneMark mark{MarkKind::bad_edges, {0, 0, 0}, {}, {}};
    for (; end < edges.size() && sets.root(edges[end].low) == sets.root(edges[begin].low); ++end) {
      misoriented += edges[end].is_misoriented ? 1U : 0U;
      mark.lines.emplace_back(to_double(mesh.positions[edges[end].low]),
                              to_double(mesh.positions[edges[end].high]));
    }
    const auto& [from, to] = mark.lines[mark.lines.size() / 2];
    mark.place = (from + to) * 0.5;
    const std::size_t count = end - begin;
    mark.text = misoriented > 0 ? fmt::format("{} between triangles that face opposite ways, at {}",
                                              counted(count, "edge", "edges"), point(mark.place))
                                : fmt::format("{} with more than two triangles, at {}",
                                              counted(count, "edge", "edges"), point(mark.place));
    marks.push_back(std::move(mark));
    begin = end;
  }
  std::stable_sort(marks.begin(), marks.end(),
                   [](const SceneMark& a, const SceneMark& b) { return a.lines.size() > b.lines.size(); });
  std::ranges::move(marks, std::back_inserter(scene.marks));
}

void add_figures(Scene& scene, const InspectReport& report) {
  const Inspection& inspection = report.input.inspection;
  const auto add = [&](const char* name, std::string value) {
    scene.figures.push_back({name, std::move(value)});
  };
  add("model", size_of(scene.mesh));
  add("triangles", grouped(inspection.triangle_count));
  add("volume",
      inspection.closed() ? volume(inspection.filled_volume) : "not defined: the surface is not closed");
  add("shells", grouped(inspection.shells.size()));
  add("edges",
      fmt::format("{} open, {} misoriented, {} with more than 2 triangles", grouped(inspection.open_edges),
                  grouped(inspection.misoriented_edges), grouped(inspection.non_manifold_edges)));
  if (!scene.voids.empty()) add("hollows", grouped(scene.voids.size()) + " sealed");
  if (inspection.parts_overlap()) add("overlap", volume(inspection.overlapped_volume));
  if (report.self_intersections)
    add("crossings",
        counted(report.self_intersections->pair_count, "pair of triangles", "pairs of triangles"));
  if (report.drainage) add("drainage", report.drainage->verdict);
  add("use", report.use);
}

// What ceilings are held against where a model is only looked at.
ProcessChoice usual_limits(const InspectReport& report) {
  ProcessChoice choice = limits_under(
      report.drainage ? report.drainage->inquiry.process : processes().front(), {}, ProcessCheck::none);
  if (report.drainage) choice.direction = report.drainage->inquiry.direction;
  return choice;
}

void add_drainage_marks(Scene& scene, const DrainageFindings& findings) {
  if (findings.air && findings.air->found.wall) {
    const ThinWall& wall = *findings.air->found.wall;
    scene.marks.push_back(
        {MarkKind::thinnest_wall, wall.place,
         fmt::format("thinnest wall round a hollow: {:.2f} mm at {}", wall.thickness, point(wall.place))});
  }
  add_cups(scene, findings.cups);
}

}  // namespace

Scene scene_of(const HollowedModel& hollowed, const HollowReport& report) {
  Scene scene;
  scene.title = title_of(hollowed.model->input);
  scene.mesh = hollowed.carved.solid.mesh;
  scene.parts = hollowed.carved.solid.parts;
  scene.void_use = report.modifiers ? VoidUse::modifiers : VoidUse::removed;
  scene.voids = hollowed.cells ? voids_of_cells(hollowed.packing, *hollowed.cells)
                               : voids_of_spheres(hollowed.packing, hollowed.surface);
  const std::string what = words_for_voids(report);
  scene.is =
      fmt::format("{} {}", report.modifiers ? "with" : "hollowed by", how_many(scene.voids.size(), what));
  scene.has_spheres = !hollowed.cells;
  scene.up = hollowed.packing.limits.roof.up;
  if (report.print) scene.layer_height = report.print->settings.layer_height;
  scene.tolerance = hollowed.carved.tolerance;
  if (report.limits.roof.limits_ceilings()) scene.bridge = report.limits.roof.bridge();
  measure_walls(scene, hollowed.surface.bvh());
  if (scene.bridge && !report.output.ceilings)
    add_wide_ceilings(scene, report.limits.roof, report.process.process.name);
  add_cups(scene, report.cups);
  add_figures(scene, report);
  add_details(scene, report);
  add_changes(scene, report);
  return scene;
}

Scene scene_of(const PreparedModel& model, const SurfaceIndex& surface, const PackReport& report,
               const CellVoids* cells, Monitor& monitor) {
  Scene scene;
  scene.title = title_of(model.input);
  scene.void_use = VoidUse::packed;
  scene.up = report.limits.roof.up;
  Solid solid;
  if (cells != nullptr) {
    solid = carve_cells(model.mesh, *cells);
    scene.voids = voids_of_cells(report.packing, *cells);
    scene.tolerance = report.cells ? report.cells->tolerance : kCellTolerance;
  } else {
    // Spheres are exact; what is drawn of them takes no more memory than a result would.
    constexpr std::size_t kMostTriangles = 4000000;
    scene.tolerance =
        loosen_tolerance(report.packing, {HollowOptions{}.tolerance}, kMostTriangles).value_or(1);
    solid = carve_keeping_surface(model.mesh, report.packing, {scene.tolerance}, monitor);
    scene.voids = voids_of_spheres(report.packing, surface);
  }
  scene.mesh = std::move(solid.mesh);
  scene.parts = std::move(solid.parts);
  const std::string what = cells != nullptr ? "cell" : "sphere";
  scene.is = "packed with " + how_many(scene.voids.size(), what);
  scene.has_spheres = cells == nullptr;
  measure_walls(scene, surface.bvh());
  const double filled = model.inspection.filled_volume;
  double packed = 0;
  for (const SceneVoid& each : scene.voids) packed += each.volume;
  scene.figures = {
      {"model", size_of(model.mesh)},
      {cells != nullptr ? "cells" : "spheres",
       fmt::format("{}, radius {}", grouped(scene.voids.size()), radii_of(scene.voids))},
      {"packed", fmt::format("{} of {} ({:.1f} %)", volume(packed), volume(filled), 100 * packed / filled)},
      {"limits", fmt::format("wall {:g}, gap {:g} mm", report.limits.wall, report.limits.gap)},
      {"process", report.process.process.name},
      {"packing", report.method}};
  return scene;
}

Scene scene_of(const Mesh& mesh, const InspectReport& report) {
  const Inspection& inspection = report.input.inspection;
  Scene scene;
  scene.title = title_of(report.input);
  take_read_mesh(scene, mesh, inspection);
  scene.is = inspection.closed() ? "as it was read" : "as it was read: its surface is not closed";
  if (inspection.open_edges + inspection.non_manifold_edges + inspection.misoriented_edges > 0) {
    const EdgeUses uses(mesh);
    add_open_edges(scene, mesh, uses);
    add_bad_edges(scene, mesh, uses);
  }
  if (report.self_intersections)
    for (const Vec3d place : report.self_intersections->places)
      scene.marks.push_back({MarkKind::crossing, place, "triangles cross each other at " + point(place)});
  const ProcessChoice limits = usual_limits(report);
  scene.up = limits.direction.up;
  if (!scene.voids.empty()) {
    add_wide_ceilings(scene, packing_limits(limits).roof, limits.process.name);
    const kernels::HostTriangleBvh outside(scene.mesh.positions,
                                           triangles_of(scene.mesh, scene.parts.front()));
    measure_walls(scene, outside.view());
  }
  if (report.drainage) add_drainage_marks(scene, *report.drainage);
  add_figures(scene, report);
  return scene;
}

Scene scene_of(const Mesh& mesh, const InputFacts& input) {
  Scene scene;
  scene.title = title_of(input);
  take_read_mesh(scene, mesh, input.inspection);
  scene.is = "printed solid";
  scene.figures = {{"model", size_of(scene.mesh)}, {"volume", volume(input.inspection.filled_volume)}};
  return scene;
}

Scene scene_of(const Mesh& model_and_supports, const SupportReport& report) {
  Scene scene;
  scene.title = title_of(report.input);
  take_read_mesh(scene, model_and_supports, inspect(model_and_supports));
  scene.is = "with supports";
  scene.up = report.direction.up;
  scene.layer_height = report.rules.layer;
  const bool are_ridges = report.shape.kind == ToothKind::ridge;
  scene.figures = {
      {"size", size_of(scene.mesh)},
      {"overhangs",
       fmt::format("{}, {:.0f} mm2", grouped(report.overhangs.regions.size()), report.overhangs.area())},
      {"supports", report.foam.empty()
                       ? volume(report.facts.volume)
                       : fmt::format("{}, {} in it", volume(report.facts.volume), report.foam)},
      {"teeth", fmt::format("{} {}", grouped(report.tooth_count), are_ridges ? "ridges" : "cones")},
      {"contact", fmt::format("{:.0f} mm2", report.facts.contact_area)},
      {"process", report.process.name}};
  return scene;
}

}  // namespace aerate
