#include "files/three_mf_model.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>
#include <utility>

#include "core/error.h"
#include "files/text_scan.h"
#include "files/xml_stream.h"

namespace aerate {
namespace {

constexpr std::string_view kCore = "http://schemas.microsoft.com/3dmanufacturing/core/2015/02";
constexpr std::string_view kProduction = "http://schemas.microsoft.com/3dmanufacturing/production/2015/06";
constexpr std::string_view kMaterials = "http://schemas.microsoft.com/3dmanufacturing/material/2015/02";
constexpr std::string_view kTriangleSets =
    "http://schemas.microsoft.com/3dmanufacturing/trianglesets/2021/07";

// Extensions that leave the shape as the core says it, or that are applied.
constexpr std::array kHonoured{kCore, kProduction, kMaterials, kTriangleSets};

// Extensions by the words in their namespaces, for messages.
constexpr std::array<std::pair<std::string_view, const char*>, 7> kExtensionNames{{
    {"/beamlattice/", "beam lattices"},
    {"/slice/", "slices"},
    {"/securecontent/", "secure content"},
    {"/booleanoperations/", "boolean operations"},
    {"/displacement/", "displacement"},
    {"/volumetric/", "volumetric data"},
    {"/implicit/", "implicit functions"},
}};

constexpr std::array<std::string_view, 5> kObjectTypes{"model", "support", "solidsupport", "surface",
                                                       "other"};

constexpr std::array kUnits{UnitOfFile{"micron", 0.001},  UnitOfFile{"millimeter", 1},
                            UnitOfFile{"centimeter", 10}, UnitOfFile{"inch", 25.4},
                            UnitOfFile{"foot", 304.8},    UnitOfFile{"meter", 1000}};

// By the name of the setting of Cura that makes an object one of these.
constexpr std::array<std::pair<std::string_view, const char*>, 4> kMeshesOfCura{
    {{":infill_mesh", "an infill mesh"},
     {":cutting_mesh", "a cutting mesh"},
     {":support_mesh", "a support mesh"},
     {":anti_overhang_mesh", "a support blocker"}}};

// What a file can make of a few bytes each.
constexpr std::size_t kMostReferences = 1000000;

// Where in the part an element stands; all that is none of these is passed over with what is in it.
enum class Place {
  document,
  model,
  resources,
  object,
  mesh,
  vertices,
  vertex,
  triangles,
  triangle,
  components,
  component,
  build,
  item,
  foreign
};

struct Nesting {
  Place outer;
  std::string_view name;
  Place place;
};

// Those that come most often first.
constexpr std::array<Nesting, 12> kNestings{{
    {Place::triangles, "triangle", Place::triangle},
    {Place::vertices, "vertex", Place::vertex},
    {Place::document, "model", Place::model},
    {Place::model, "resources", Place::resources},
    {Place::resources, "object", Place::object},
    {Place::object, "mesh", Place::mesh},
    {Place::mesh, "vertices", Place::vertices},
    {Place::mesh, "triangles", Place::triangles},
    {Place::object, "components", Place::components},
    {Place::components, "component", Place::component},
    {Place::model, "build", Place::build},
    {Place::build, "item", Place::item},
}};

Place place_in(Place outer, std::string_view name) {
  for (const Nesting& nesting : kNestings)
    if (nesting.outer == outer && nesting.name == name) return nesting.place;
  return Place::foreign;
}

// Of a long text its beginning.
std::string shown(std::string_view text) {
  constexpr std::size_t kMost = 60;
  return text.size() <= kMost ? std::string(text) : std::string(text.substr(0, kMost)) + "...";
}

std::string extension_in_words(std::string_view name) {
  for (const auto& [word, what] : kExtensionNames)
    if (name.find(word) != std::string_view::npos) return what;
  return fmt::format("'{}'", shown(name));
}

// The next run of characters that are no white space, as XML has it.
std::string_view take_word(std::string_view& text) {
  constexpr std::string_view kSpace = " \t\r\n";
  text.remove_prefix(std::min(text.find_first_not_of(kSpace), text.size()));
  const std::string_view word = text.substr(0, text.find_first_of(kSpace));
  text.remove_prefix(word.size());
  return word;
}

// A number may have a plus before it.
std::string_view without_plus(std::string_view word) {
  if (word.starts_with('+') && !word.starts_with("+-")) word.remove_prefix(1);
  return word;
}

// The nearest fp32: 0 for what is too small for one, infinite for what is too large.
std::optional<float> parse_float(std::string_view word) {
  word = without_plus(word);
  if (const auto number = parse_number<float>(word)) return number;
  const auto wide = parse_number<double>(word);
  return wide ? std::optional(static_cast<float>(*wide)) : std::nullopt;
}

class ModelPartReader final : public XmlStream {
 public:
  ModelPartReader(const std::string& where, MeshesOfCura meshes) : where_(where), meshes_(meshes) {}

  ModelPart take() && { return std::move(part_); }

 protected:
  void begin(const XmlElement& element) override {
    const bool is_core = element.prefix.empty() || namespace_of(element.prefix) == kCore;
    const Place place = is_core ? place_in(places_.back(), element.name) : Place::foreign;
    if (place == Place::foreign) note_foreign(element);
    places_.push_back(place);
    switch (place) {
      case Place::vertex:
        return add_vertex(element);
      case Place::triangle:
        return add_triangle(element);
      case Place::model:
        return begin_model(element);
      case Place::object:
        return begin_object(element);
      case Place::mesh:
      case Place::components:
        return begin_shape(element);
      case Place::component:
        return add_reference(element, object().components);
      case Place::item:
        return add_item(element);
      default:
        return;
    }
  }

  void end() override {
    const Place place = places_.back();
    places_.pop_back();
    if (place == Place::mesh) require_vertices();
    if (place == Place::object) end_object();
  }

  [[noreturn]] void refuse(const std::string& why) override { fail("{}", why); }

 private:
  std::string here() const { return fmt::format("{}, line {}, column {}", where_, line(), column()); }

  template <typename... Arguments>
  [[noreturn]] void fail(fmt::format_string<Arguments...> what, Arguments&&... arguments) const {
    throw InputError(fmt::format("{}: {}", here(), fmt::format(what, std::forward<Arguments>(arguments)...)),
                     "export the model again, or save it anew in a slicer");
  }

  // For what cannot be left away without another shape.
  template <typename... Arguments>
  [[noreturn]] void fail_unread(fmt::format_string<Arguments...> what, Arguments&&... arguments) const {
    throw InputError(fmt::format("{}: {}", here(), fmt::format(what, std::forward<Arguments>(arguments)...)),
                     "export the model as a plain mesh, such as STL");
  }

  static std::optional<std::string_view> find(const XmlElement& element, std::string_view attribute) {
    for (const XmlAttribute& a : element.attributes)
      if (a.name == attribute) return a.value;
    return std::nullopt;
  }

  // The attribute's one word, read by parse(word) -> optional.
  template <typename Parse>
  auto value_of(const XmlElement& element, std::string_view attribute, const char* what,
                const Parse& parse) const {
    const auto text = find(element, attribute);
    if (!text) fail("<{}> has no {}", shown(element.name), attribute);
    std::string_view rest = *text;
    const std::string_view word = take_word(rest);
    const auto value = parse(word);
    if (!value || !take_word(rest).empty()) fail("{}=\"{}\" is not {}", attribute, shown(*text), what);
    return *value;
  }

  float number(const XmlElement& element, std::string_view attribute) const {
    const float value = value_of(element, attribute, "a number", parse_float);
    if (!std::isfinite(value))
      fail("{}=\"{}\" is NaN, infinite or too large", attribute, *find(element, attribute));
    return value;
  }
  std::uint32_t index(const XmlElement& element, std::string_view attribute) const {
    return value_of(element, attribute, "a whole number",
                    [](std::string_view word) { return parse_number<std::uint32_t>(without_plus(word)); });
  }

  ModelObject& object() { return *object_; }

  void begin_model(const XmlElement& element) {
    if (const auto unit = find(element, "unit")) {
      const auto known = std::ranges::find(kUnits, *unit, &UnitOfFile::name);
      if (known == kUnits.end()) fail("unknown unit '{}'", shown(*unit));
      part_.unit = *known;
    }
    if (const auto required = find(element, "requiredextensions")) require_honoured(*required);
  }

  void require_honoured(std::string_view prefixes) const {
    for (std::string_view prefix = take_word(prefixes); !prefix.empty(); prefix = take_word(prefixes)) {
      const std::string_view name = namespace_of(prefix);
      if (std::ranges::find(kHonoured, name) != kHonoured.end()) continue;
      const std::string extension = name.empty()
                                        ? fmt::format("'{}', whose namespace is not declared", shown(prefix))
                                        : extension_in_words(name);
      fail_unread("the model requires an extension of 3MF that is not read: {}", extension);
    }
  }

  void begin_object(const XmlElement& element) {
    const std::uint32_t id = index(element, "id");
    const auto [place, is_new] = part_.objects.try_emplace(id);
    if (!is_new) fail("there are two objects of id {}", id);
    if (part_.objects.size() > kMostReferences) fail("more than {} objects", kMostReferences);
    object_ = &place->second;
    object_->id = id;
    if (const auto type = find(element, "type")) object_->type = *type;
    if (std::ranges::find(kObjectTypes, object_->type) == kObjectTypes.end())
      fail("object {} is of a type that 3MF does not have: '{}'", id, shown(object_->type));
    has_shape_ = false;
    foreign_shape_.clear();
  }

  void begin_shape(const XmlElement& element) {
    if (std::exchange(has_shape_, true))
      fail("object {} has more than one shape, the second a <{}>", object().id, element.name);
    highest_index_ = 0;
  }

  void end_object() {
    if (!has_shape_ && !foreign_shape_.empty())
      fail_unread("object {} is a <{}>, which is not read", object().id, foreign_shape_);
    if (!has_shape_) fail("object {} has neither a mesh nor components", object().id);
    object_ = nullptr;
  }

  // What would change the shape if it were understood.
  void note_foreign(const XmlElement& element) {
    if (places_.back() == Place::document) fail("a <{}> is not a 3MF model", shown(element.name));
    if (places_.back() == Place::mesh && element.name == "beamlattice")
      fail_unread("object {} has a beam lattice, which is not read", object().id);
    if (object_ != nullptr && element.name == "metadata") require_part_of_model(element);
    if (places_.back() != Place::object || element.name == "metadatagroup") return;
    foreign_shape_ = element.prefix.empty()
                         ? shown(element.name)
                         : fmt::format("{}:{}", shown(element.prefix), shown(element.name));
  }

  // Cura has such settings only of objects that are what they say.
  void require_part_of_model(const XmlElement& element) const {
    const std::string_view name = find(element, "name").value_or("");
    for (const auto& [setting, what] : kMeshesOfCura) {
      if (meshes_ == MeshesOfCura::take || !name.ends_with(setting)) continue;
      throw InputError(fmt::format("{}: object {} is {} of Cura, which is not part of the model", here(),
                                   object_->id, what),
                       "take it out in Cura, or export the model alone");
    }
  }

  void add_vertex(const XmlElement& element) {
    object().mesh.positions.push_back({number(element, "x"), number(element, "y"), number(element, "z")});
  }

  void add_triangle(const XmlElement& element) {
    const Triangle triangle{index(element, "v1"), index(element, "v2"), index(element, "v3")};
    highest_index_ = std::max({highest_index_, triangle[0], triangle[1], triangle[2]});
    object().mesh.triangles.push_back(triangle);
  }

  // Once all are there, in whatever order.
  void require_vertices() const {
    const std::size_t count = object_->mesh.positions.size();
    if (object_->mesh.triangles.empty() || highest_index_ < count) return;
    fail("a triangle of object {} uses vertex {}, and there are {}", object_->id, highest_index_, count);
  }

  ObjectReference reference(const XmlElement& element) const {
    ObjectReference named;
    named.id = index(element, "objectid");
    named.line = line();
    if (const auto text = find(element, "transform")) named.transform = transform_in(*text);
    for (const XmlAttribute& attribute : element.attributes) {
      const std::size_t colon = attribute.name.find(':');
      if (colon == std::string_view::npos || attribute.name.substr(colon + 1) != "path") continue;
      const std::string_view name = namespace_of(attribute.name.substr(0, colon));
      if (name == kProduction || name.empty()) named.path = attribute.value;
    }
    return named;
  }

  void add_reference(const XmlElement& element, std::vector<ObjectReference>& references) {
    if (++references_ > kMostReferences) fail("more than {} components and items", kMostReferences);
    references.push_back(reference(element));
  }

  void add_item(const XmlElement& element) {
    const std::string_view printable = find(element, "printable").value_or("1");
    if (printable == "0" || printable == "false") {
      ++part_.items_not_printed;
    } else {
      add_reference(element, part_.items);
    }
  }

  // Rows of a matrix that is multiplied by a point from the left.
  Affine transform_in(std::string_view text) const {
    Affine transform = Affine::Identity();
    std::string_view rest = text;
    for (int row = 0; row < 4; ++row) {
      for (int column = 0; column < 3; ++column) {
        const auto value = parse_float(take_word(rest));
        if (!value || !std::isfinite(*value)) fail("transform=\"{}\" is not twelve numbers", shown(text));
        transform(column, row) = static_cast<double>(*value);
      }
    }
    if (!take_word(rest).empty()) fail("transform=\"{}\" is more than twelve numbers", shown(text));
    if (transform.linear().determinant() == 0) fail("transform=\"{}\" leaves nothing of a body", shown(text));
    return transform;
  }

  const std::string& where_;
  MeshesOfCura meshes_;
  ModelPart part_;
  std::vector<Place> places_{Place::document};
  ModelObject* object_ = nullptr;  // the one being read
  bool has_shape_ = false;
  std::string foreign_shape_;  // what it has of an extension
  std::uint32_t highest_index_ = 0;
  std::size_t references_ = 0;
};

}  // namespace

ModelPart read_model_part(
    const std::string& where,
    const std::function<void(const std::function<void(std::string_view)>& block)>& for_each_block,
    MeshesOfCura meshes) {
  ModelPartReader reader(where, meshes);
  for_each_block([&](std::string_view bytes) { reader.read(bytes); });
  reader.finish();
  return std::move(reader).take();
}

}  // namespace aerate
