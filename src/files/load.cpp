#include "files/load.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <iterator>
#include <utility>

#include "core/error.h"
#include "files/file_check.h"
#include "files/import.h"
#include "files/text_scan.h"

namespace aerate {
namespace {

std::string lower_case_extension(const std::filesystem::path& path) {
  std::string extension = path.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(), to_lower_ascii);
  return extension.empty() ? extension : extension.substr(1);
}

FileFacts check(FileBytes& bytes, const std::string& extension, const std::string& name) {
  if (extension == "stl") return check_stl(bytes, name);
  if (extension == "obj") return check_obj(bytes, name);
  if (extension == "ply") return check_ply(bytes, name);
  return check_off(bytes, name);
}

ImportedModel import_checked(const std::filesystem::path& path, const std::string& extension, double factor,
                             const std::string& name) {
  if (extension == "stl") {
    if (const auto facts = check_binary_stl(path)) return import_with_assimp(path, *facts, factor);
  }
  FileBytes bytes = read_file(path);
  const FileFacts facts = check(bytes, extension, name);
  return import_with_assimp(bytes, extension, facts, factor, name);
}

}  // namespace

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

LoadedModel load_model(const std::filesystem::path& path, const LoadOptions& options) {
  if (!std::isfinite(options.scale) || !(options.scale > 0)) {
    throw UsageError(fmt::format("the scale must be a positive number, not {:g}", options.scale));
  }
  const std::string name = path.string();
  const std::string extension = lower_case_extension(path);
  check_readable(path);
  ImportedModel imported;
  if (extension == "3mf") {
    FileBytes bytes = read_file(path);
    check_3mf(bytes, name);
    if (options.other_volumes == OtherVolumes::refuse) require_model_parts_only(bytes, name);
    imported = import_3mf(bytes, options.unit, options.scale, name);
  } else if (extension == "stl" || extension == "obj" || extension == "ply" || extension == "off") {
    const double factor = millimetres_per(options.unit.value_or(LengthUnit::millimetre)) * options.scale;
    imported = import_checked(path, extension, factor, name);
  } else {
    throw InputError(extension.empty()
                         ? fmt::format("{}: the name has no ending that says what it is", name)
                         : fmt::format("{}: '.{}' is not a format that can be read", name, extension),
                     "use STL, OBJ, PLY, OFF or 3MF");
  }
  if (imported.mesh.triangles.empty()) throw InputError(fmt::format("{}: no triangles", name));

  LoadedModel model;
  model.mesh = std::move(imported.mesh);
  std::transform(extension.begin(), extension.end(), std::back_inserter(model.format),
                 [](char c) { return c >= 'a' && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : c; });
  model.part_count = imported.part_count;
  model.vertices_in_file = imported.vertices_in_file;
  return model;
}

}  // namespace aerate
