#include "files/cell_table.h"

#include <cstddef>
#include <fmt/format.h>
#include <iterator>
#include <utility>

#include "files/sphere_table.h"
#include "files/text_scan.h"

namespace aerate {
namespace {

std::string write_csv(const Packing& packing, const CellPlanes& planes) {
  std::string table = "cell,x,y,z,radius,normal_x,normal_y,normal_z,offset,neighbour\n";
  for (std::size_t cell = 0; cell < planes.size(); ++cell) {
    const auto& [centre, radius, kind] = packing.spheres[cell];
    const std::string sphere = fmt::format("{},{},{},{},{}", cell, centre.x, centre.y, centre.z, radius);
    if (planes.of(cell).empty()) table += sphere + ",,,,,\n";
    for (const auto& [normal, offset, neighbour] : planes.of(cell))
      fmt::format_to(std::back_inserter(table), "{},{},{},{},{},{}\n", sphere, normal.x, normal.y, normal.z,
                     offset, neighbour);
  }
  return table;
}

std::string write_json(const Packing& packing, const CellPlanes& planes) {
  std::string table = fmt::format(
      "{{\"schema\": \"aerate.cells\", \"schema_version\": 1, \"unit\": \"mm\", \"wall\": {}, \"gap\": {}, "
      "\"cells\": [",
      packing.limits.wall, packing.limits.gap);
  const auto out = std::back_inserter(table);
  const char* next_cell = "";
  for (std::size_t cell = 0; cell < planes.size(); ++cell) {
    const auto& [centre, radius, kind] = packing.spheres[cell];
    fmt::format_to(out, "{}\n{{\"sphere\": [{}, {}, {}, {}, \"{}\"], \"planes\": [",
                   std::exchange(next_cell, ","), centre.x, centre.y, centre.z, radius, name_of(kind));
    const char* next_plane = "";
    for (const auto& [normal, offset, neighbour] : planes.of(cell))
      fmt::format_to(out, "{}[{}, {}, {}, {}, {}]", std::exchange(next_plane, ", "), normal.x, normal.y,
                     normal.z, offset, neighbour);
    table += "]}";
  }
  return table + "\n]}\n";
}

}  // namespace

constinit const CellTableFormat CellTableFormat::csv{".csv", write_csv};
constinit const CellTableFormat CellTableFormat::json{".json", write_json};

std::optional<CellTableFormat> find_cell_table_format(const std::filesystem::path& path) {
  const std::string ending = ending_of(path);
  for (const CellTableFormat& format : {CellTableFormat::csv, CellTableFormat::json})
    if (ending == format.ending) return format;
  return std::nullopt;
}

std::string cell_table(const Packing& packing, const CellPlanes& planes, const CellTableFormat& format) {
  return format.write(packing, planes);
}

}  // namespace aerate
