#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/mesh.h"

namespace aerate::bench {

// One of the ten containers of the paper's Tables 1 to 4, with its figures. Lengths in its unit u, read as
// mm.
struct Container {
  std::string name;
  double max_radius;
  // By which a density is defined: the volume the paper's Table 1 prints for the analytic shapes (the
  // capsule's is that of other measures than it names), the mesh's own otherwise.
  std::optional<double> table_volume;
  double paper_density;              // percent
  double paper_brute_force_seconds;  // sequential
  double paper_indexed_seconds;      // sequential
  double paper_best_seconds;         // indexed, best of its graphics cards
  std::string model_file;            // in the models' folder; empty for the analytic ones
};

const std::vector<Container>& paper_containers();

// The analytic shapes with the paper's triangle counts (12, 62, 124, 832, 960, 1152), axis along y; the
// others are loaded from `model_folder`. Nullopt if that file is not there.
std::optional<Mesh> container_mesh(const Container& container, const std::string& model_folder);

}  // namespace aerate::bench
