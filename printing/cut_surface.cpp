#include "printing/cut_surface.h"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Polygon_mesh_processing/connected_components.h>
#include <CGAL/Polygon_mesh_processing/corefinement.h>
#include <CGAL/Polygon_mesh_processing/polygon_soup_to_polygon_mesh.h>
#include <CGAL/Surface_mesh.h>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <set>

namespace aerate {
namespace {

namespace pmp = CGAL::Polygon_mesh_processing;
using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Point = Kernel::Point_3;
using SurfaceMesh = CGAL::Surface_mesh<Point>;
using EdgeFlags = SurfaceMesh::Property_map<SurfaceMesh::Edge_index, bool>;
using FaceNumbers = SurfaceMesh::Property_map<SurfaceMesh::Face_index, std::size_t>;

// The surface faces the prism's end by at least this cosine.
constexpr double kLeastFacing = 0.05;

// Triangles this much beyond the prism are taken along, so that none that it meets is missed, mm.
constexpr double kMargin = 1e-3;

Point to_point(Vec3f p) {
  return {static_cast<double>(p.x), static_cast<double>(p.y), static_cast<double>(p.z)};
}

Vec3f rounded(const Point& p) {
  return to_float(Vec3d{p.x(), p.y(), p.z()});
}

// Twice the area of a triangle as seen along the axis, against it.
double facing_area(Vec3d axis, Vec3f a, Vec3f b, Vec3f c) {
  return dot(axis, cross(to_double(b) - to_double(a), to_double(c) - to_double(a)));
}

// Does a triangle face away from the prism's axis?
bool faces_outward(const CuttingPrism& prism, Vec3f a, Vec3f b, Vec3f c) {
  const Vec3d from_start = (to_double(a) + to_double(b) + to_double(c)) * (1.0 / 3) - prism.start;
  const Vec3d outward = from_start - prism.axis * dot(from_start, prism.axis);
  return dot(cross(to_double(b) - to_double(a), to_double(c) - to_double(a)), outward) > 0;
}

// The triangles as a mesh of its own, with the vertices that they have in the whole one.
struct Patch {
  SurfaceMesh surface;
  std::vector<std::uint32_t> vertices;
};

std::optional<Patch> take_patch(const Mesh& mesh, std::span<const std::uint32_t> triangles, Vec3d axis) {
  Patch patch;
  std::map<std::uint32_t, std::size_t> local;
  std::vector<Point> points;
  std::vector<std::array<std::size_t, 3>> faces;
  for (const std::uint32_t index : triangles) {
    const Triangle& t = mesh.triangles[index];
    const Vec3f a = mesh.positions[t[0]], b = mesh.positions[t[1]], c = mesh.positions[t[2]];
    const Vec3d normal = cross(to_double(b) - to_double(a), to_double(c) - to_double(a));
    if (!(dot(normal, axis) > kLeastFacing * length(normal))) return std::nullopt;
    std::array<std::size_t, 3> face{};
    for (std::size_t corner = 0; corner < 3; ++corner) {
      const auto [place, is_new] = local.emplace(t[corner], points.size());
      if (is_new) {
        points.push_back(to_point(mesh.positions[t[corner]]));
        patch.vertices.push_back(t[corner]);
      }
      face[corner] = place->second;
    }
    faces.push_back(face);
  }
  if (faces.empty() || !pmp::is_polygon_soup_a_polygon_mesh(faces)) return std::nullopt;
  pmp::polygon_soup_to_polygon_mesh(points, faces, patch.surface);
  if (patch.surface.number_of_vertices() != points.size()) return std::nullopt;
  return patch;
}

// Vertices: the ring, then the other ends of its lines. Closed, facing outward.
SurfaceMesh make_prism(const CuttingPrism& prism) {
  SurfaceMesh mesh;
  std::vector<SurfaceMesh::Vertex_index> ring, top;
  for (const Vec3f p : prism.ring) ring.push_back(mesh.add_vertex(to_point(p)));
  for (const Vec3f p : prism.ring) {
    const double along = dot(to_double(p) - prism.start, prism.axis);
    const Vec3d end = to_double(p) + prism.axis * (prism.length - along);
    top.push_back(mesh.add_vertex({end.x, end.y, end.z}));
  }
  for (std::size_t i = 0; i < ring.size(); ++i) {
    const std::size_t next = (i + 1) % ring.size();
    mesh.add_face(ring[i], ring[next], top[next]);
    mesh.add_face(ring[i], top[next], top[i]);
    if (i > 0 && next > 0) {
      mesh.add_face(ring[0], ring[next], ring[i]);
      mesh.add_face(top[0], top[i], top[next]);
    }
  }
  return mesh;
}

std::array<SurfaceMesh::Vertex_index, 3> corners_of(const SurfaceMesh& mesh, SurfaceMesh::Face_index face) {
  const auto h = mesh.halfedge(face);
  return {mesh.source(h), mesh.target(h), mesh.target(mesh.next(h))};
}

// Parts of a mesh between its marked edges; nullopt unless there are two.
std::optional<FaceNumbers> two_parts(SurfaceMesh& mesh, const EdgeFlags& marked) {
  FaceNumbers parts = mesh.add_property_map<SurfaceMesh::Face_index, std::size_t>("f:part", 0).first;
  const std::size_t count =
      pmp::connected_components(mesh, parts, CGAL::parameters::edge_is_constrained_map(marked));
  if (count != 2) return std::nullopt;
  return parts;
}

class Cut {
 public:
  Cut(const Mesh& mesh, std::span<const std::uint32_t> near, const CuttingPrism& prism)
      : mesh_(mesh), near_(near), prism_(prism) {}

  std::optional<SurfaceCut> make() {
    auto patch = take_patch(mesh_, near_, prism_.axis);
    if (!patch) return std::nullopt;
    SurfaceMesh prism = make_prism(prism_);
    EdgeFlags on_patch = patch->surface.add_property_map<SurfaceMesh::Edge_index, bool>("e:cut", false).first;
    EdgeFlags on_prism = prism.add_property_map<SurfaceMesh::Edge_index, bool>("e:cut", false).first;
    try {
      pmp::corefine(patch->surface, prism,
                    CGAL::parameters::edge_is_constrained_map(on_patch).throw_on_self_intersection(true),
                    CGAL::parameters::edge_is_constrained_map(on_prism));
    } catch (const pmp::Corefinement::Self_intersection_exception&) {
      return std::nullopt;
    }
    for (const auto edge : patch->surface.edges()) {
      if (on_patch[edge] && patch->surface.is_border(edge)) return std::nullopt;
    }
    if (!add_surface(*patch, on_patch) || !add_sides(prism, on_prism)) return std::nullopt;
    return std::move(cut_);
  }

 private:
  std::uint32_t ring_base() const {
    return static_cast<std::uint32_t>(mesh_.positions.size() + cut_.new_positions.size());
  }
  Vec3f position(std::uint32_t index) const {
    if (index < mesh_.positions.size()) return mesh_.positions[index];
    const std::size_t beyond = index - mesh_.positions.size();
    return beyond < cut_.new_positions.size() ? cut_.new_positions[beyond]
                                              : prism_.ring[beyond - cut_.new_positions.size()];
  }

  // Is the point inside the prism, as seen along its axis? Anywhere near its sides the answer may be wrong.
  bool is_within(Vec3d point) const {
    for (std::size_t i = 0; i < prism_.ring.size(); ++i) {
      const Vec3d a = to_double(prism_.ring[i]);
      const Vec3d b = to_double(prism_.ring[(i + 1) % prism_.ring.size()]);
      if (dot(prism_.axis, cross(b - a, point - a)) < 0) return false;
    }
    return true;
  }

  // Which of two parts of the patch is inside the prism: the one that its largest triangle tells.
  std::size_t inside_part(const SurfaceMesh& surface, const FaceNumbers& parts) const {
    std::array<double, 2> largest{0, 0};
    std::array<bool, 2> is_inside{false, false};
    for (const auto face : surface.faces()) {
      const auto c = corners_of(surface, face);
      const Vec3f p = rounded(surface.point(c[0])), q = rounded(surface.point(c[1])),
                  r = rounded(surface.point(c[2]));
      const double area = facing_area(prism_.axis, p, q, r);
      if (area <= largest[parts[face]]) continue;
      largest[parts[face]] = area;
      is_inside[parts[face]] = is_within((to_double(p) + to_double(q) + to_double(r)) * (1.0 / 3));
    }
    if (is_inside[0] == is_inside[1]) return 2;
    return is_inside[0] ? 0 : 1;
  }

  bool add_surface(Patch& patch, const EdgeFlags& marked) {
    const auto parts = two_parts(patch.surface, marked);
    if (!parts) return false;
    const std::size_t inside = inside_part(patch.surface, *parts);
    if (inside > 1) return false;
    std::vector<std::uint32_t> indices = patch.vertices;
    for (std::size_t i = patch.vertices.size(); i < patch.surface.number_of_vertices(); ++i) {
      const Point& point = patch.surface.point(SurfaceMesh::Vertex_index(static_cast<std::uint32_t>(i)));
      indices.push_back(ring_base());
      cut_.new_positions.push_back(rounded(point));
    }
    for (std::uint32_t i = 0; i < indices.size(); ++i)
      index_of_.emplace(patch.surface.point(SurfaceMesh::Vertex_index(i)), indices[i]);

    std::set<Triangle> untouched;
    for (const std::uint32_t i : near_) untouched.insert(first_lowest(mesh_.triangles[i]));
    std::set<Triangle> still_there;
    for (const auto face : patch.surface.faces()) {
      if ((*parts)[face] == inside) continue;
      const auto corners = corners_of(patch.surface, face);
      const Triangle t = first_lowest({indices[corners[0]], indices[corners[1]], indices[corners[2]]});
      if (untouched.contains(t)) {
        still_there.insert(t);
        continue;
      }
      if (!(facing_area(prism_.axis, position(t[0]), position(t[1]), position(t[2])) > 0)) return false;
      cut_.surface.push_back(t);
    }
    for (const std::uint32_t i : near_) {
      if (!still_there.contains(first_lowest(mesh_.triangles[i]))) cut_.removed.push_back(i);
    }
    std::sort(cut_.surface.begin(), cut_.surface.end());
    return true;
  }

  bool add_sides(SurfaceMesh& prism, const EdgeFlags& marked) {
    const auto parts = two_parts(prism, marked);
    if (!parts) return false;
    const std::size_t sides = prism_.ring.size();
    const auto part_of = [&](std::size_t vertex) {
      return (
          *parts)[prism.face(prism.halfedge(SurfaceMesh::Vertex_index(static_cast<std::uint32_t>(vertex))))];
    };
    const std::size_t inside = part_of(0);
    for (std::size_t i = 0; i < sides; ++i) {
      if (part_of(i) != inside || part_of(sides + i) == inside) return false;
    }
    const auto is_on_ring = [sides](SurfaceMesh::Vertex_index v) { return std::size_t{v} < sides; };
    for (const auto face : prism.faces()) {
      if ((*parts)[face] != inside) continue;
      const auto corners = corners_of(prism, face);
      if (std::all_of(corners.begin(), corners.end(), is_on_ring)) continue;
      Triangle t{};
      for (std::size_t i = 0; i < 3; ++i) {
        if (is_on_ring(corners[i])) {
          t[i] = ring_base() + static_cast<std::uint32_t>(corners[i]);
          continue;
        }
        const auto found = index_of_.find(prism.point(corners[i]));
        if (found == index_of_.end()) return false;
        t[i] = found->second;
      }
      if (!faces_outward(prism_, position(t[0]), position(t[1]), position(t[2]))) return false;
      cut_.sides.push_back(first_lowest({t[0], t[2], t[1]}));
    }
    std::sort(cut_.sides.begin(), cut_.sides.end());
    return true;
  }

  static Triangle first_lowest(Triangle t) {
    std::rotate(t.begin(), std::min_element(t.begin(), t.end()), t.end());
    return t;
  }

  const Mesh& mesh_;
  std::span<const std::uint32_t> near_;
  const CuttingPrism& prism_;
  std::map<Point, std::uint32_t> index_of_;
  SurfaceCut cut_;
};

}  // namespace

Segment axis_of(const CuttingPrism& prism) {
  return {prism.start, prism.start + prism.axis * prism.length};
}

double reach_of(const CuttingPrism& prism) {
  return prism.radius + kMargin;
}

bool may_be_cut(const Mesh& mesh, std::span<const std::uint32_t> near, const CuttingPrism& prism) {
  return take_patch(mesh, near, prism.axis).has_value();
}

std::optional<SurfaceCut> cut_surface(const Mesh& mesh, std::span<const std::uint32_t> near,
                                      const CuttingPrism& prism) {
  return Cut(mesh, near, prism).make();
}

}  // namespace aerate
