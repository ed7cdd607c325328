#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "core/packing.h"
#include "kernels/cell_planes.h"

namespace aerate {

// Cells as planes, in a file: millimetres in the model's own coordinates, each number in the shortest form that reads
// back to the same fp64. Cells are in the order of their spheres, and numbered from 0. (docs/cells.md)
struct CellTableFormat {
  const char* ending;
  std::string (*write)(const Packing& packing, const CellPlanes& planes);

  // A line "cell,x,y,z,radius,normal_x,normal_y,normal_z,offset,neighbour", then one line a plane, cell by cell. A
  // cell without planes has one line, whose last five fields are empty.
  static const CellTableFormat csv;
  // {"schema": "aerate.cells", "schema_version": 1, "unit": "mm", "wall": W, "gap": G, "cells": [{"sphere": [x, y, z,
  // radius, kind], "planes": [[normal_x, normal_y, normal_z, offset, neighbour], ...]}, ...]}
  static const CellTableFormat json;
};

// From the file name's ending (any case), if it is that of a table.
std::optional<CellTableFormat> find_cell_table_format(const std::filesystem::path& path);

// `planes` are those of the packing's spheres.
std::string cell_table(const Packing& packing, const CellPlanes& planes, const CellTableFormat& format);

}  // namespace aerate
