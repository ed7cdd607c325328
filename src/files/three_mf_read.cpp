#include <algorithm>
#include <fmt/ranges.h>
#include <map>
#include <set>
#include <utility>

#include "files/formats.h"
#include "files/input_file.h"
#include "files/own_file.h"
#include "files/part_writer.h"
#include "files/three_mf.h"
#include "files/three_mf_model.h"
#include "files/three_mf_package.h"

namespace aerate {
namespace {

// What no sane file exceeds: a file can nest components so that a few bytes become endlessly many parts.
constexpr std::size_t kMostParts = 100000;  // objects that are shown, each as often as it is
constexpr int kDeepest = 64;                // components in components
// Triangles that are shown, unless the file itself holds more.
constexpr std::size_t kMostTrianglesShown = std::size_t{1} << 25;

// What an object shows, with all that its components do.
struct Extent {
  std::size_t parts = 0, triangles = 0;
  int depth = 0;  // of components
};

// An object by the model part that holds it; the path is empty for the package's model.
struct Found {
  const std::string* path;
  const ModelObject* object;
};

class Reader3mf {
 public:
  explicit Reader3mf(const InputFile& file) : file_(file), package_(file), model_(package_.model()) {}

  LoadedModel build(const LoadOptions& options) {
    take_volumes_apart(options);
    const ModelPart& model = part({});
    const Vec3d factor = millimetres_per_unit(options, model.unit, file_.name);
    require_something_to_print(model);
    require_modest(model);
    LoadedModel loaded{.mesh = {}, .format = {}, .part_count = 0, .notices = {}};
    Welder welder(0);
    for (const ObjectReference& item : model.items)
      add_item(find({}, item), item.transform, factor, welder, loaded);
    loaded.mesh = std::move(welder).finish();
    if (loaded.mesh.triangles.empty()) fail_without_triangles();
    for (auto& [name, own] : modifier_welders_) {
      loaded.modifiers.push_back({name, std::move(own).finish()});
      if (loaded.modifiers.back().mesh.triangles.empty())
        fail_to_read(file_, "modifier '{}' has no triangles", name);
    }
    loaded.notices = notices(model);
    return loaded;
  }

 private:
  // Model parts are read when something of them is shown.
  const ModelPart& part(const std::string& path) {
    const auto [place, is_new] = parts_.try_emplace(path);
    if (!is_new) return place->second;
    const std::string& name = path.empty() ? model_ : path;
    const std::string where = fmt::format("{}: '{}' in the 3MF package", file_.name, name);
    place->second = read_model_part(where, [&](const auto& block) { package_.read(name, block); });
    if (place->second.unit.millimetres != part({}).unit.millimetres)
      fail_to_read(file_, "parts of the 3MF package are in different units");
    for (const auto& [id, object] : place->second.objects) triangles_held_ += object.mesh.triangles.size();
    return place->second;
  }

  [[noreturn]] void fail_at(const std::string& path, const ObjectReference& named,
                            const std::string& why) const {
    fail_to_read(file_, "'{}' in the 3MF package, line {}: {}", path.empty() ? model_ : path, named.line,
                 why);
  }

  // The object that is named in the part `path`.
  Found find(const std::string& path, const ObjectReference& named) {
    const std::string& in = named.path.empty() ? path : named.path;
    if (!named.path.empty() && !package_.has(in))
      fail_at(path, named, fmt::format("object {} is in a part that is missing", named.id));
    const ModelPart& holder = part(in);
    const auto object = holder.objects.find(named.id);
    if (object == holder.objects.end()) fail_at(path, named, fmt::format("there is no object {}", named.id));
    return {&parts_.find(in)->first, &object->second};
  }

  // Whether an object is of the model; supports, surfaces without volume and the like are not.
  static bool is_model(const ModelObject& object) { return object.type == "model"; }

  void require_something_to_print(const ModelPart& model) const {
    if (!model.items.empty()) return;
    if (model.items_not_printed > 0)
      fail_to_read(file_, "nothing to print: all {} items of its build are marked as not to be printed",
                   model.items_not_printed);
    fail_to_read(file_, "nothing to print: no triangles, since its build has no items");
  }

  // Judges what would be shown before anything is: in time by what the file holds, not by what it shows.
  void require_modest(const ModelPart& model) {
    Extent all;
    for (const ObjectReference& item : model.items) add_extent(all, {}, item);
    if (all.triangles > std::max(kMostTrianglesShown, triangles_held_))
      fail_to_read(file_, "components that make more than {} triangles of {}", kMostTrianglesShown,
                   triangles_held_);
  }

  void add_extent(Extent& sum, const std::string& path, const ObjectReference& named) {
    const Found found = find(path, named);
    const Extent shown = extent(found, path, named);
    sum.parts += shown.parts;
    sum.triangles += shown.triangles;
    sum.depth = std::max(sum.depth, shown.depth + 1);
    if (sum.parts > kMostParts) fail_to_read(file_, "more than {} parts", kMostParts);
    if (sum.depth > kDeepest) fail_to_read(file_, "components nested deeper than {}", kDeepest);
  }

  Extent extent(const Found& found, const std::string& path, const ObjectReference& named) {
    if (const auto known = extents_.find(found.object); known != extents_.end()) return known->second;
    if (!open_.insert(found.object).second)
      fail_at(path, named, fmt::format("object {} is a component of itself", named.id));
    if (open_.size() > kDeepest + 1) fail_to_read(file_, "components nested deeper than {}", kDeepest);
    Extent all{.parts = 1, .triangles = found.object->mesh.triangles.size(), .depth = 0};
    for (const ObjectReference& component : found.object->components) add_extent(all, *found.path, component);
    open_.erase(found.object);
    return extents_[found.object] = all;
  }

  // Of the volumes that are not part of the model only those that this program adds and modifiers that were asked for
  // may be there.
  void take_volumes_apart(const LoadOptions& options) {
    std::vector<std::string> unwanted;
    for (OtherVolume& volume : package_.other_volumes(options.volume_lists)) {
      if (volume.is_own) {
        volumes_apart_.push_back(std::move(volume));
        continue;
      }
      const bool is_wanted = volume.is_modifier && std::ranges::find(options.wanted_modifiers, volume.name) !=
                                                       options.wanted_modifiers.end();
      if (!is_wanted) {
        unwanted.push_back(fmt::format("{} '{}'", volume.kind, volume.name));
        continue;
      }
      modifier_welders_.try_emplace(volume.name, 0);
      volumes_apart_.push_back(std::move(volume));
    }
    if (unwanted.empty()) return;
    throw InputError(
        fmt::format("{}: a slicer's project with {} not part of the model ({})", file_.name,
                    unwanted.size() == 1 ? "a volume that is" : "volumes that are",
                    fmt::join(unwanted, ", ")),
        "take such volumes out, or export the model alone (in PrusaSlicer: File, Export, Export Plate as "
        "STL); "
        "modifiers that 'aerate hollow' is to keep solid may stay, with --keep-solid NAME for each");
  }

  // Where a triangle of an object, or one of its components, goes that is not of the model.
  template <typename Belongs>
  Welder* welder_apart(std::uint32_t object, const Belongs& belongs) {
    for (const OtherVolume& volume : volumes_apart_)
      if (volume.object == object && belongs(volume.triangles))
        return volume.is_own ? &left_out_triangles_ : &modifier_welders_.find(volume.name)->second;
    return nullptr;
  }

  // What the build shows: only of such objects do projects list volumes.
  void add_item(const Found& found, const Affine& transform, Vec3d factor, Welder& welder,
                LoadedModel& loaded) {
    const ModelObject& object = *found.object;
    if (volumes_apart_.empty() || !is_model(object))
      return add_object(found, transform, factor, welder, loaded);
    for (const ObjectReference& component : object.components) {
      Welder* const apart =
          welder_apart(object.id, [&](const VolumeTriangles& t) { return t.component == component.id; });
      const std::size_t parts = loaded.part_count;
      add_object(find(*found.path, component), transform * component.transform, factor,
                 apart != nullptr ? *apart : welder, loaded);
      if (apart != nullptr) loaded.part_count = parts;
    }
    if (!object.components.empty()) return;
    ++loaded.part_count;
    const std::vector<Vec3f>& p = object.mesh.positions;
    for (std::size_t i = 0; i < object.mesh.triangles.size(); ++i) {
      Welder* const apart = welder_apart(
          object.id, [&](const VolumeTriangles& t) { return !t.component && i >= t.first && i <= t.last; });
      const auto& [a, b, c] = object.mesh.triangles[i];
      PartWriter(apart != nullptr ? *apart : welder, transform, factor, file_.name)
          .add_triangle(p[a], p[b], p[c]);
    }
  }

  void add_object(const Found& found, const Affine& transform, Vec3d factor, Welder& welder,
                  LoadedModel& loaded) {
    const ModelObject& object = *found.object;
    if (!is_model(object)) {
      left_out_.insert({object.type, object.id});
      return;
    }
    for (const ObjectReference& component : object.components)
      add_object(find(*found.path, component), transform * component.transform, factor, welder, loaded);
    if (!object.components.empty()) return;
    if (object.mesh.triangles.empty()) {
      empty_.insert(object.id);
      return;
    }
    ++loaded.part_count;
    PartWriter part(welder, transform, factor, file_.name);
    const std::vector<Vec3f>& p = object.mesh.positions;
    for (const auto& [a, b, c] : object.mesh.triangles) part.add_triangle(p[a], p[b], p[c]);
  }

  [[noreturn]] void fail_without_triangles() const {
    if (left_out_.empty()) fail_to_read(file_, "no triangles");
    const auto& [type, id] = *left_out_.begin();
    throw InputError(
        fmt::format("{}: no triangles of a model: object {} is of type '{}'", file_.name, id, type),
        "in a 3MF the objects that are solid are of type 'model'");
  }

  std::vector<std::string> notices(const ModelPart& model) const {
    std::vector<std::string> said;
    if (model.items_not_printed > 0) {
      said.push_back(fmt::format("{} of {} items of the build are not to be printed, and left out",
                                 model.items_not_printed, model.items_not_printed + model.items.size()));
    }
    const auto others = [](std::size_t count) {
      return count > 1 ? fmt::format(" (and so for {} more)", count - 1) : std::string();
    };
    if (!left_out_.empty()) {
      const auto& [type, id] = *left_out_.begin();
      said.push_back(fmt::format("object {} is of type '{}', no part of the model, and left out{}", id, type,
                                 others(left_out_.size())));
    }
    for (const OtherVolume& volume : volumes_apart_)
      if (volume.is_own)
        said.push_back(fmt::format("'{}' is no part of the model, and left out", volume.name));
    if (!empty_.empty())
      said.push_back(fmt::format("object {} has no triangles{}", *empty_.begin(), others(empty_.size())));
    return said;
  }

  const InputFile& file_;
  ThreeMfPackage package_;
  std::string model_;
  std::map<std::string, ModelPart> parts_;  // by path; places stay when others are added
  std::size_t triangles_held_ = 0;
  std::map<const ModelObject*, Extent> extents_;
  std::set<const ModelObject*> open_;  // whose components are being looked at
  std::set<std::pair<std::string, std::uint32_t>> left_out_;
  std::set<std::uint32_t> empty_;
  std::vector<OtherVolume> volumes_apart_;  // those that are left out, and modifiers that were asked for
  Welder left_out_triangles_{0};            // of the former
  std::map<std::string, Welder> modifier_welders_;  // by their names
};

LoadedModel read_3mf(InputFile& file, const LoadOptions& options) {
  return Reader3mf(file).build(options);
}

void write_3mf(const Mesh& mesh, OutputFile& file) {
  file.write(to_3mf(mesh));
}

Mesh read_written_3mf(OwnFile& file) {
  return load_model(file.path()).mesh;
}

}  // namespace

std::vector<Mesh> read_3mf_meshes(const std::filesystem::path& path) {
  const std::string text = read_3mf_entry(path, kThreeMfModel);
  ModelPart part = read_model_part(
      path.string(), [&](const auto& block) { block(text); }, MeshesOfCura::take);
  std::vector<Mesh> meshes;
  for (auto& [id, object] : part.objects)
    if (object.components.empty()) meshes.push_back(std::move(object.mesh));
  if (meshes.empty()) throw not_as_written(path, "there is no mesh");
  return meshes;
}

constinit const MeshFormat MeshFormat::three_mf{"3MF", ".3mf", read_3mf, write_3mf, read_written_3mf};

}  // namespace aerate
