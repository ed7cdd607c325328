#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/mesh.h"
#include "core/solid.h"

namespace aerate {

// Slicers keep what a part of an object is in a file of their own beside the 3MF model.
enum class ThreeMfFlavor {
  prusa,  // PrusaSlicer, SuperSlicer: one mesh, parts are ranges of its triangles (Slic3r_PE_model.config)
  orca,  // OrcaSlicer, Bambu Studio: a mesh for each part, put together as components (model_settings.config)
};

// As on the command line.
const char* name_of(ThreeMfFlavor flavor);

// Consecutive triangles of a mesh that a slicer treats as one part.
struct ThreeMfPart {
  std::string name;
  std::size_t first_triangle = 0;
  std::size_t triangle_count = 0;
  // Set for a modifier: not a body, but where the print has this infill instead of its own, percent.
  std::optional<double> infill_percent;

  bool operator==(const ThreeMfPart&) const = default;
};

// A 3MF package in millimetres with one object, for any program that reads 3MF. Decimals read back to the
// same fp32. The format forbids a triangle to name a vertex twice, so triangles without area get vertices of
// their own. The bytes depend on the mesh alone: no identifiers, dates of 1980.
std::string to_3mf(const Mesh& mesh);

// The same with parts, which cover the mesh in order: the first is the model, the others modifiers. (Source
// for both files: the slicers' own 3MF readers.)
std::string to_3mf(const Mesh& mesh, const std::vector<ThreeMfPart>& parts, ThreeMfFlavor flavor);

// A solid's mesh with its void shells turned outward, as bodies of their own, and back.
Mesh with_void_shells_turned(Mesh mesh, const Solid& solid);

// The parts of such a mesh: the model and one modifier that holds all voids (their shells are disjoint).
std::vector<ThreeMfPart> modifier_parts(const Solid& solid, double infill_percent);

// The parts that a package names, read back from its file. Throws FailureError for a package that is not as
// `to_3mf` makes them.
std::vector<ThreeMfPart> read_3mf_parts(const std::filesystem::path& path, ThreeMfFlavor flavor);

}  // namespace aerate
