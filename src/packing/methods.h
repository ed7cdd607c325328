#pragma once

#include <cstddef>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "core/device.h"
#include "core/mesh.h"
#include "core/monitor.h"
#include "core/packing.h"

namespace aerate {

// How much is searched: `best` packs in several ways and keeps what removes most. docs/packing.md has what that
// takes and brings.
enum class PackingEffort { normal, best };

// When a packing stops that could go on: at the first of
struct PackingStop {
  std::size_t max_count = std::numeric_limits<std::size_t>::max();  // so many spheres,
  double target_density = 1.0;  // this share, in (0, 1), of the model's volume,
  // which is this, mm3, for a model whose shells overlap; else what its surface bounds.
  std::optional<double> volume = std::nullopt;
  PackingEffort effort = PackingEffort::normal;  // until then
};

// What a packing is going to take, about, and what to say where that is too much.
struct MemoryNeed {
  double bytes = 0;
  std::string job;   // what needs it
  std::string hint;  // what to change
};

// A way of packing, as a row: the command line, the budget, the pipeline and the reports know no more of it.
struct PackingMethod {
  std::string_view name;     // for --packing and in reports
  std::string_view summary;  // for --packing's help
  // Places are those of a lattice: they have no room for roofs, and the packing ends when they are full. Else
  // a sphere may be anywhere, and the packing stops where it is told to.
  bool on_lattice = false;
  // From the model's size and the limits, before work starts.
  MemoryNeed (*memory)(const Mesh& mesh, const PackingLimits& limits, const PackingStop& stop) = nullptr;
  // mesh: closed (Inspection::closed). The result does not depend on the device or the number of threads. It
  // is meant to go through `verify_packing` before it is used.
  Packing (*pack)(const Mesh& mesh, const PackingLimits& limits, const PackingStop& stop, Monitor& monitor,
                  const DeviceRequest& device) = nullptr;
};

// All there are, the default first.
std::span<const PackingMethod> packing_methods();

// By its name. Throws UsageError for one that is unknown.
const PackingMethod& packing_method(std::string_view name);

}  // namespace aerate
