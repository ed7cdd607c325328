#include "files/load.h"

#include <cmath>
#include <fmt/format.h>

#include "core/error.h"
#include "files/formats.h"
#include "files/input_file.h"
#include "files/mesh_arrays.h"
#include "files/part_writer.h"

namespace aerate {

double millimetres_per(LengthUnit unit) {
  switch (unit) {
    case LengthUnit::millimetre:
      return 1;
    case LengthUnit::centimetre:
      return 10;
    case LengthUnit::metre:
      return 1000;
    case LengthUnit::inch:
      return 25.4;
  }
  return 1;
}

namespace {

void require_scale(const LoadOptions& options) {
  for (const double scale : {options.scale.x, options.scale.y, options.scale.z})
    if (!std::isfinite(scale) || !(scale > 0))
      throw UsageError(fmt::format("the scale must be a positive number, not {:g}", scale));
}

}  // namespace

LoadedModel load_model(InputFile file, const MeshFormat& format, const LoadOptions& options) {
  require_scale(options);
  LoadedModel model = format.read(file, options);
  if (model.mesh.triangles.empty()) fail_to_read(file, "no triangles");
  model.format = format.name;
  return model;
}

LoadedModel load_model(const std::filesystem::path& path, const LoadOptions& options) {
  check_readable(path);
  const MeshFormat& format = format_to_read(path);
  return load_model(read_file(path), format, options);
}

LoadedModel load_model(const MeshArrays& arrays, const std::string& name, const LoadOptions& options) {
  require_scale(options);
  return {.mesh = mesh_of_arrays(arrays, name, millimetres_per_unit(options)), .format = "arrays"};
}

}  // namespace aerate
