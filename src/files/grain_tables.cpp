#include "files/grain_tables.h"

#include <cstddef>
#include <fmt/format.h>
#include <iterator>
#include <string_view>

namespace aerate {
namespace {

// An array of `type`, one record a sphere.
template <typename Append>
void add_array(std::string& text, std::string_view attributes, const std::vector<Sphere>& spheres,
               const Append& append) {
  fmt::format_to(std::back_inserter(text), "<DataArray {} format=\"ascii\">\n", attributes);
  for (std::size_t i = 0; i < spheres.size(); ++i) append(std::back_inserter(text), i, spheres[i]);
  text += "</DataArray>\n";
}

}  // namespace

std::string vtk_spheres(const std::vector<Sphere>& spheres, const Box3f& /*model*/) {
  const std::size_t count = spheres.size();
  // Text is a list of its bytes there, and a 0.
  std::string text = fmt::format(
      "<?xml version=\"1.0\"?>\n<VTKFile type=\"PolyData\" version=\"1.0\" byte_order=\"LittleEndian\" "
      "header_type=\"UInt64\">\n<PolyData>\n<FieldData>\n<DataArray type=\"String\" Name=\"unit\" "
      "NumberOfTuples=\"1\" format=\"ascii\">\n{:d} {:d} 0\n</DataArray>\n</FieldData>\n"
      "<Piece NumberOfPoints=\"{}\" NumberOfVerts=\"{}\" NumberOfLines=\"0\" NumberOfStrips=\"0\" "
      "NumberOfPolys=\"0\">\n<PointData Scalars=\"radius\">\n",
      'm', 'm', count, count);
  add_array(text, "type=\"Float64\" Name=\"radius\"", spheres,
            [](auto out, std::size_t, const Sphere& sphere) { fmt::format_to(out, "{}\n", sphere.radius); });
  add_array(text, "type=\"UInt8\" Name=\"kind\"", spheres, [](auto out, std::size_t, const Sphere& sphere) {
    fmt::format_to(out, "{}\n", static_cast<unsigned>(sphere.kind));
  });
  text += "</PointData>\n<Points>\n";
  add_array(text, "type=\"Float64\" Name=\"Points\" NumberOfComponents=\"3\"", spheres,
            [](auto out, std::size_t, const Sphere& sphere) {
              fmt::format_to(out, "{} {} {}\n", sphere.centre.x, sphere.centre.y, sphere.centre.z);
            });
  text += "</Points>\n<Verts>\n";
  add_array(text, "type=\"Int64\" Name=\"connectivity\"", spheres,
            [](auto out, std::size_t i, const Sphere&) { fmt::format_to(out, "{}\n", i); });
  add_array(text, "type=\"Int64\" Name=\"offsets\"", spheres,
            [](auto out, std::size_t i, const Sphere&) { fmt::format_to(out, "{}\n", i + 1); });
  return text + "</Verts>\n</Piece>\n</PolyData>\n</VTKFile>\n";
}

std::string lammps_spheres(const std::vector<Sphere>& spheres, const Box3f& model) {
  const Vec3d lower = to_double(model.lower), upper = to_double(model.upper);
  std::string text = fmt::format(
      "spheres packed by aerate: lengths in mm, density 1 (give yours: set type 1 density D)\n\n{} atoms\n1 "
      "atom "
      "types\n\n{} {} xlo xhi\n{} {} ylo yhi\n{} {} zlo zhi\n\nAtoms # sphere\n\n",
      spheres.size(), lower.x, upper.x, lower.y, upper.y, lower.z, upper.z);
  for (std::size_t i = 0; i < spheres.size(); ++i) {
    const auto& [centre, radius, kind] = spheres[i];
    fmt::format_to(std::back_inserter(text), "{} 1 {} 1 {} {} {}\n", i + 1, 2 * radius, centre.x, centre.y,
                   centre.z);
  }
  return text;
}

std::string yade_spheres(const std::vector<Sphere>& spheres, const Box3f& /*model*/) {
  std::string text = "#format x_y_z_r\n# lengths in mm\n";
  for (const auto& [centre, radius, kind] : spheres)
    fmt::format_to(std::back_inserter(text), "{} {} {} {}\n", centre.x, centre.y, centre.z, radius);
  return text;
}

}  // namespace aerate
