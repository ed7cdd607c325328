#include "pipeline/model_of_print.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <fmt/format.h>
#include <system_error>
#include <vector>

#include "core/error.h"
#include "core/listed.h"
#include "core/mesh.h"
#include "files/formats.h"
#include "kernels/constants.h"
#include "pipeline/prepare.h"
#include "printing/slicers/gcode.h"

namespace aerate {
namespace {

namespace fs = std::filesystem;

// How far apart the heights of a model and of its print may be, mm: layers are cut at whole heights.
constexpr double kLayer = 1;

// Outlines of prints are a line inside of the model's.
constexpr double kLine = 1;

// In the order of their names.
std::vector<fs::path> models_in(const fs::path& folder) {
  std::error_code error;
  std::vector<fs::path> models;
  for (fs::directory_iterator at(folder, error), end; !error && at != end; at.increment(error)) {
    std::error_code unknown;
    if (at->is_regular_file(unknown) && is_a_models_name(at->path())) models.push_back(at->path());
  }
  if (error)
    throw InputError(fmt::format("{}: {}", folder.string(), error.message()),
                     "give the folder of your models as --model-folder");
  std::ranges::sort(models);
  return models;
}

std::vector<fs::path> named_as_object(const std::vector<fs::path>& models, const std::string& name) {
  std::vector<fs::path> found;
  for (const fs::path& model : models)
    if (model.filename() == name || model.stem() == name) found.push_back(model);
  return found;
}

// Those with the longest name that another begins with.
std::vector<fs::path> named_as_output(const std::vector<fs::path>& models, const std::string& output) {
  const std::string whole = fs::path(output).filename().string();
  std::size_t longest = 1;
  std::vector<fs::path> found;
  for (const fs::path& model : models) {
    const std::string stem = model.stem().string();
    if (stem.size() < longest || !whole.starts_with(stem)) continue;
    if (stem.size() > longest) found.clear();
    longest = stem.size();
    found.push_back(model);
  }
  return found;
}

bool may_have_size(const fs::path& path, Vec3d size, const LoadOptions& load, Monitor& monitor) {
  try {
    const Box3f box = bounding_box(load_and_inspect({path}, load, monitor).mesh);
    const Vec3d own = to_double(box.upper) - to_double(box.lower);
    return std::abs(own.z - size.z) <= kLayer && own.x <= size.x + kLine && own.y <= size.y + kLine;
  } catch (const InputError&) {
    return false;
  }
}

std::string names_of(const std::vector<fs::path>& models) {
  std::vector<std::string> names;
  names.reserve(models.size());
  for (const fs::path& model : models) names.push_back(model.filename().string());
  return listed(names, "and");
}

}  // namespace

Vec3d size_of_print(std::string_view gcode) {
  Box3d box{{kInfinity, kInfinity, kInfinity}, {-kInfinity, -kInfinity, -kInfinity}};
  for (const ExtrusionMove& move : extrusion_moves(gcode)) {
    box.lower = {std::min({box.lower.x, move.from_x, move.x}), std::min({box.lower.y, move.from_y, move.y}),
                 0};
    box.upper = {std::max({box.upper.x, move.from_x, move.x}), std::max({box.upper.y, move.from_y, move.y}),
                 std::max(box.upper.z, move.z)};
  }
  return box.upper.z > -kInfinity ? box.upper - box.lower : Vec3d{0, 0, 0};
}

fs::path model_of_print(const fs::path& folder, const PrintNames& names, Vec3d size, const LoadOptions& load,
                        Monitor& monitor) {
  const std::vector<fs::path> models = models_in(folder);
  std::vector<fs::path> found;
  if (names.object) found = named_as_object(models, *names.object);
  if (found.empty()) found = named_as_output(models, names.output);
  const std::string called = names.object ? *names.object : fs::path(names.output).filename().string();
  if (found.empty())
    throw InputError(
        fmt::format("{}: no model is called as the print is{}", folder.string(),
                    called.empty() ? std::string(", which has no name") : fmt::format(" ('{}')", called)),
        "switch labels of objects on in the slicer's settings, or give the file as --model");
  if (found.size() > 1) {
    const std::vector<fs::path> all = found;
    std::erase_if(found, [&](const fs::path& path) { return !may_have_size(path, size, load, monitor); });
    if (found.size() != 1)
      throw InputError(fmt::format("{}: {} are called as the print is ('{}'), and {} of them have its size",
                                   folder.string(), names_of(all), called,
                                   found.empty() ? std::string("none") : std::to_string(found.size())),
                       "give the file as --model");
  }
  return found.front();
}

}  // namespace aerate
