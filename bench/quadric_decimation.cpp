#include "bench/quadric_decimation.h"

#include <CGAL/Simple_cartesian.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/Surface_mesh_simplification/Policies/Edge_collapse/Bounded_normal_change_placement.h>
#include <CGAL/Surface_mesh_simplification/Policies/Edge_collapse/Count_stop_predicate.h>
#include <CGAL/Surface_mesh_simplification/Policies/Edge_collapse/GarlandHeckbert_plane_policies.h>
#include <CGAL/Surface_mesh_simplification/edge_collapse.h>
#include <cstdint>
#include <vector>

namespace aerate::bench {
namespace {

namespace simplification = CGAL::Surface_mesh_simplification;

using Kernel = CGAL::Simple_cartesian<double>;
using SurfaceMesh = CGAL::Surface_mesh<Kernel::Point_3>;
using Policies = simplification::GarlandHeckbert_plane_policies<SurfaceMesh, Kernel>;

SurfaceMesh to_cgal(const Mesh& mesh) {
  SurfaceMesh surface;
  std::vector<SurfaceMesh::Vertex_index> vertices;
  for (const Vec3f position : mesh.positions) {
    const Vec3d p = to_double(position);
    vertices.push_back(surface.add_vertex(Kernel::Point_3(p.x, p.y, p.z)));
  }
  for (const Triangle& t : mesh.triangles) surface.add_face(vertices[t[0]], vertices[t[1]], vertices[t[2]]);
  return surface;
}

Mesh from_cgal(SurfaceMesh& surface) {
  surface.collect_garbage();
  Mesh mesh;
  for (const auto v : surface.vertices()) {
    const Kernel::Point_3& p = surface.point(v);
    mesh.positions.push_back(to_float(Vec3d{p.x(), p.y(), p.z()}));
  }
  for (const auto face : surface.faces()) {
    Triangle t{};
    std::size_t corner = 0;
    for (const auto v : surface.vertices_around_face(surface.halfedge(face)))
      t[corner++] = static_cast<std::uint32_t>(v);
    mesh.triangles.push_back(t);
  }
  return mesh;
}

}  // namespace

Mesh decimate_by_quadrics(const Mesh& mesh, std::size_t triangles) {
  SurfaceMesh surface = to_cgal(mesh);
  const Policies policies(surface);
  const simplification::Bounded_normal_change_placement<Policies::Get_placement> placement(
      policies.get_placement());
  const simplification::Count_stop_predicate<SurfaceMesh> stop(3 * triangles / 2);
  simplification::edge_collapse(surface, stop,
                                CGAL::parameters::get_cost(policies.get_cost()).get_placement(placement));
  return from_cgal(surface);
}

}  // namespace aerate::bench
