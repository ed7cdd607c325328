#include "view/page.h"

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/error.h"
#include "view/built_files.h"
#include "view/deflate.h"
#include "view/page_geometry.h"

namespace aerate {
namespace {

using Json = nlohmann::json;

// Version of what web/src/scene.ts reads.
constexpr int kPageFormat = 1;

constexpr std::string_view kPage = "view.html";

// What the built page has in the place of its data.
constexpr std::string_view kDataGoesHere = "<!--data-->";

// As exact as anything that is shown of it, in few digits.
double shortened(double value) {
  constexpr double kResolved = 1e4;
  return std::round(value * kResolved) / kResolved;
}

void put(Json& list, Vec3d place) {
  for (const double value : {place.x, place.y, place.z}) list.push_back(shortened(value));
}

Json exact(Vec3d v) {
  return {v.x, v.y, v.z};
}

const char* name_of(VoidUse use) {
  switch (use) {
    case VoidUse::removed:
      return "removed";
    case VoidUse::modifiers:
      return "modifiers";
    case VoidUse::packed:
      return "packed";
    case VoidUse::found:
      return "found";
  }
  return "";
}

const char* name_of(MarkKind kind) {
  switch (kind) {
    case MarkKind::ceiling:
      return "ceiling";
    case MarkKind::thinnest_wall:
      return "wall";
    case MarkKind::cup:
      return "cup";
    case MarkKind::hole_in_mesh:
      return "hole in mesh";
    case MarkKind::bad_edges:
      return "bad edges";
    case MarkKind::crossing:
      return "crossing";
  }
  return "";
}

Json parts_in_columns(const std::vector<SolidPart>& parts) {
  Json kinds = Json::array(), triangles = Json::array();
  for (const SolidPart& part : parts) {
    kinds.push_back(static_cast<int>(part.kind));
    triangles.push_back(part.triangle_count);
  }
  return {{"kind", kinds}, {"triangles", triangles}};
}

// A column for each figure: names are written once.
Json voids_in_columns(const std::vector<SceneVoid>& voids) {
  Json number = Json::array(), place = Json::array(), radius = Json::array(), volume = Json::array(),
       wall = Json::array();
  for (const SceneVoid& each : voids) {
    number.push_back(each.number);
    put(place, each.place);
    radius.push_back(shortened(each.radius));
    volume.push_back(shortened(each.volume));
    wall.push_back(each.wall && std::isfinite(*each.wall) ? Json(shortened(*each.wall)) : Json());
  }
  return {{"number", number}, {"place", place}, {"radius", radius}, {"volume", volume}, {"wall", wall}};
}

Json list_of(const std::vector<SceneMark>& marks) {
  Json list = Json::array();
  for (const SceneMark& mark : marks) {
    Json place = Json::array(), lines = Json::array();
    put(place, mark.place);
    for (const auto& [from, to] : mark.lines) {
      put(lines, from);
      put(lines, to);
    }
    list.push_back({{"kind", name_of(mark.kind)}, {"place", place}, {"text", mark.text}, {"lines", lines}});
  }
  return list;
}

Json figures_of(const Scene& scene) {
  Json list = Json::array();
  for (const auto* figures : {&scene.figures, &scene.details})
    for (const SceneFigure& figure : *figures) list.push_back({figure.name, figure.value});
  return list;
}

Json list_of(const std::vector<SceneChange>& changes) {
  Json list = Json::array();
  for (const SceneChange& change : changes)
    list.push_back(
        {{"name", change.name}, {"unit", change.unit}, {"before", change.before}, {"after", change.after}});
  return list;
}

Json number_or_null(const std::optional<double>& number) {
  return number ? Json(*number) : Json();
}

// The lowest byte first.
std::string in_four_bytes(std::size_t number) {
  std::string bytes;
  for (unsigned shift = 0; shift < 32; shift += 8) bytes.push_back(static_cast<char>(number >> shift & 0xff));
  return bytes;
}

}  // namespace

std::string page_bytes(const Scene& scene, std::string_view program) {
  const PageGrid grid = page_grid(scene.mesh, scene.tolerance);
  const PageGeometry geometry = encode_geometry(scene.mesh, scene.parts, grid);
  const Json header = {
      {"format", kPageFormat},
      {"program", program},
      {"title", scene.title},
      {"is", scene.is},
      {"closed", scene.is_closed},
      {"use", name_of(scene.void_use)},
      {"grid", {{"origin", exact(grid.origin)}, {"step", grid.step}}},
      {"vertices", geometry.vertex_count},
      {"streams",
       {geometry.steps.size(), geometry.links.size(), geometry.x.size(), geometry.y.size(),
        geometry.z.size()}},
      {"parts", parts_in_columns(scene.parts)},
      {"voids", voids_in_columns(scene.voids)},
      {"marks", list_of(scene.marks)},
      {"figures", figures_of(scene)},
      {"changes", list_of(scene.changes)},
      {"up", exact(scene.up)},
      {"layerHeight", number_or_null(scene.layer_height)},
      {"tolerance", scene.tolerance},
      {"bridge", number_or_null(scene.bridge)},
  };
  // File names may hold any bytes; what is not UTF-8 is replaced.
  const std::string text = header.dump(-1, ' ', false, Json::error_handler_t::replace);
  return deflated(in_four_bytes(text.size()) + text + geometry.steps + geometry.links + geometry.x +
                  geometry.y + geometry.z);
}

std::string page_data(const Scene& scene, std::string_view program) {
  return base64(page_bytes(scene, program));
}

void require_page() {
  if (built_file(kPage)) return;
  throw UsageError(
      fmt::format("--view: this program was built without the page ({})", why_no_built_file(kPage)),
      "install node 18 or newer and npm (Debian: nodejs npm) and configure the build again, or give it the "
      "built page of a release: cmake -DAERATE_VIEW_PAGE=view.html");
}

std::string page_of(const Scene& scene, std::string_view program) {
  require_page();
  const std::string_view page = *built_file(kPage);
  const std::size_t at = page.find(kDataGoesHere);
  if (at == std::string_view::npos)
    throw FailureError("the page that this program was built with takes no data");
  std::string whole(page.substr(0, at));
  whole += page_data(scene, program);
  whole += page.substr(at + kDataGoesHere.size());
  return whole;
}

}  // namespace aerate
