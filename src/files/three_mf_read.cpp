#include <Model/COM/NMR_DLLInterfaces.h>
#include <array>
#include <string_view>
#include <utility>

#include "files/formats.h"
#include "files/input_file.h"
#include "files/own_file.h"
#include "files/part_writer.h"
#include "files/three_mf.h"
#include "files/three_mf_package.h"

namespace aerate {
namespace {

// What no sane file exceeds: a file can nest components so that a few bytes become endlessly many parts.
constexpr std::size_t kMaxParts = 100000;
constexpr int kMaxDepth = 64;

// An object of lib3mf's C interface.
class Handle {
 public:
  Handle() = default;
  ~Handle() {
    if (object_ != nullptr) NMR::lib3mf_release(object_);
  }
  Handle(Handle&& other) noexcept : object_(std::exchange(other.object_, nullptr)) {}
  Handle& operator=(Handle&&) = delete;

  NMR::PLib3MFBase* get() const { return object_; }
  NMR::PLib3MFBase** receive() { return &object_; }

 private:
  NMR::PLib3MFBase* object_ = nullptr;
};

UnitOfFile unit_of_file(DWORD unit, const InputFile& file) {
  switch (unit) {
    case NMR::MODELUNIT_MICROMETER:
      return {"micron", 0.001};
    case NMR::MODELUNIT_MILLIMETER:
      return {"millimeter", 1};
    case NMR::MODELUNIT_CENTIMETER:
      return {"centimeter", 10};
    case NMR::MODELUNIT_INCH:
      return {"inch", 25.4};
    case NMR::MODELUNIT_FOOT:
      return {"foot", 304.8};
    case NMR::MODELUNIT_METER:
      return {"meter", 1000};
    default:
      fail_to_read(file, "unknown unit ({})", unit);
  }
}

Affine to_affine(const NMR::MODELTRANSFORM& transform) {
  using Fields = Eigen::Matrix<float, 3, 4, Eigen::RowMajor>;
  static_assert(sizeof(transform.m_fFields) == sizeof(Fields));
  return Affine(Eigen::Map<const Fields>(&transform.m_fFields[0][0]).cast<double>());
}

class Reader3mf {
 public:
  explicit Reader3mf(const InputFile& file) : file_(file) {
    require(NMR::lib3mf_createmodel(model_.receive()), model_);
    Handle reader;
    require(NMR::lib3mf_model_queryreader(model_.get(), "3mf", reader.receive()), model_);
    require(
        NMR::lib3mf_reader_readfrombuffer(reader.get(), reinterpret_cast<BYTE*>(file.data.get()), file.size),
        reader);
  }

  UnitOfFile unit() const {
    DWORD unit = 0;
    require(NMR::lib3mf_model_getunit(model_.get(), &unit), model_);
    return unit_of_file(unit, file_);
  }

  LoadedModel build(double factor) const {
    LoadedModel imported{.mesh = {}, .format = {}, .part_count = 0};
    Welder welder(0);
    Handle items;
    require(NMR::lib3mf_model_getbuilditems(model_.get(), items.receive()), model_);
    for (;;) {
      BOOL more = 0;
      require(NMR::lib3mf_builditemiterator_movenext(items.get(), &more), items);
      if (!more) break;
      Handle item, object;
      require(NMR::lib3mf_builditemiterator_getcurrent(items.get(), item.receive()), items);
      require(NMR::lib3mf_builditem_getobjectresource(item.get(), object.receive()), item);
      NMR::MODELTRANSFORM transform{};
      require(NMR::lib3mf_builditem_getobjecttransform(item.get(), &transform), item);
      add_object(object, to_affine(transform), factor, 0, welder, imported);
    }
    imported.mesh = std::move(welder).finish();
    return imported;
  }

 private:
  void add_object(const Handle& object, const Affine& transform, double factor, int depth, Welder& welder,
                  LoadedModel& imported) const {
    if (depth > kMaxDepth) fail_to_read(file_, "components nested deeper than {}", kMaxDepth);
    DWORD type = 0;
    require(NMR::lib3mf_object_gettype(object.get(), &type), object);
    // Supports, surfaces without volume and the like are not the model.
    if (type != NMR::MODELOBJECTTYPE_MODEL) return;
    BOOL is_mesh = 0;
    require(NMR::lib3mf_object_ismeshobject(object.get(), &is_mesh), object);
    if (is_mesh) {
      add_mesh(object, transform, factor, welder, imported);
      return;
    }
    DWORD count = 0;
    require(NMR::lib3mf_componentsobject_getcomponentcount(object.get(), &count), object);
    for (DWORD i = 0; i < count; ++i) {
      Handle component, child;
      require(NMR::lib3mf_componentsobject_getcomponent(object.get(), i, component.receive()), object);
      require(NMR::lib3mf_component_getobjectresource(component.get(), child.receive()), component);
      NMR::MODELTRANSFORM own{};
      require(NMR::lib3mf_component_gettransform(component.get(), &own), component);
      add_object(child, transform * to_affine(own), factor, depth + 1, welder, imported);
    }
  }

  void add_mesh(const Handle& object, const Affine& transform, double factor, Welder& welder,
                LoadedModel& imported) const {
    if (++imported.part_count > kMaxParts) fail_to_read(file_, "more than {} parts", kMaxParts);
    DWORD vertex_count = 0, triangle_count = 0;
    require(NMR::lib3mf_meshobject_getvertexcount(object.get(), &vertex_count), object);
    require(NMR::lib3mf_meshobject_gettrianglecount(object.get(), &triangle_count), object);
    if (triangle_count == 0) return;
    std::vector<NMR::MODELMESHVERTEX> vertices(vertex_count);
    std::vector<NMR::MODELMESHTRIANGLE> triangles(triangle_count);
    require(NMR::lib3mf_meshobject_getvertices(object.get(), vertices.data(), vertex_count, nullptr), object);
    require(
        NMR::lib3mf_meshobject_gettriangleindices(object.get(), triangles.data(), triangle_count, nullptr),
        object);
    PartWriter part(welder, transform, factor, file_.name);
    const auto corner = [&](DWORD index) {
      if (index >= vertex_count) fail_to_read(file_, "a triangle uses a vertex that is not there");
      const auto& p = vertices[index].m_fPosition;
      return Vec3f{p[0], p[1], p[2]};
    };
    for (const NMR::MODELMESHTRIANGLE& triangle : triangles) {
      part.add_triangle(corner(triangle.m_nIndices[0]), corner(triangle.m_nIndices[1]),
                        corner(triangle.m_nIndices[2]));
    }
  }

  void require(LIB3MFRESULT result, const Handle& object) const {
    if (result == 0) return;
    DWORD code = 0;
    LPCSTR message = nullptr;
    if (object.get() != nullptr) NMR::lib3mf_getlasterror(object.get(), &code, &message);
    fail_to_read(file_, "cannot be read as 3MF: {}",
                 message != nullptr && *message != '\0' ? message : "not a 3MF package");
  }

  const InputFile& file_;
  Handle model_;
};

LoadedModel read_3mf(InputFile& file, const LoadOptions& options) {
  check_3mf(file);
  require_model_parts_only(file, options.volume_lists);
  const Reader3mf reader(file);
  return reader.build(millimetres_per_unit(options, reader.unit(), file.name));
}

void write_3mf(const Mesh& mesh, OutputFile& file) {
  file.write(to_3mf(mesh));
}

Mesh read_written_3mf(OwnFile& file) {
  return load_model(file.path()).mesh;
}

}  // namespace

constinit const MeshFormat MeshFormat::three_mf{"3MF", ".3mf", read_3mf, write_3mf, read_written_3mf};

}  // namespace aerate
