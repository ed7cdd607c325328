#include <algorithm>
#include <array>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <string_view>
#include <vector>

#include "files/assimp_import.h"
#include "files/formats.h"
#include "files/input_file.h"
#include "files/raw_bytes.h"
#include "files/weld.h"

// glTF 2.0, as text (.gltf) or in its binary container (.glb). Source: "glTF 2.0 Specification", Khronos
// Group, 2021.
namespace aerate {
namespace {

using nlohmann::json;

constexpr const char* kMagic = "glTF";
constexpr std::uint32_t kVersion = 2;
constexpr std::uint32_t kJsonChunk = 0x4e4f534a, kBinaryChunk = 0x004e4942;

// glTF itself needs a dozen; what is deeper is no model, and would be taken apart by recursion.
constexpr int kDeepest = 64;

// Primitives share accessors, and each has its own copy once it is read.
constexpr std::size_t kMostValues = std::size_t{1} << 27;

enum ComponentType { uint8 = 5121, uint16 = 5123, uint32 = 5125, float32 = 5126 };

// What is drawn from the corners of a primitive; the four before these are points and lines.
enum Mode { triangles = 4, triangle_strip = 5, triangle_fan = 6 };

// An empty string for what is no base64.
std::string decode_base64(std::string_view text) {
  constexpr std::string_view kDigits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  while (text.ends_with('=')) text.remove_suffix(1);
  std::string bytes;
  bytes.reserve(text.size() / 4 * 3 + 3);
  std::uint32_t bits = 0;
  int count = 0;
  for (const char c : text) {
    const std::size_t digit = kDigits.find(c);
    if (digit == std::string_view::npos) return {};
    bits = bits << 6 | static_cast<std::uint32_t>(digit);
    count += 6;
    if (count < 8) continue;
    count -= 8;
    bytes += static_cast<char>(bits >> count & 0xff);
  }
  return bytes;
}

// Looks through a file and makes a plain one of it: the nodes and triangles of the scene that is shown, in
// one GLB without a word about looks, motion or other files. assimp trusts lengths, offsets, counts and
// types.
class GltfCheck {
 public:
  explicit GltfCheck(const InputFile& file) : file_(file) {}

  PlainFile run() {
    if (file_.size > kMostBytes) fail("more than {} bytes", kMostBytes);
    try {
      parse();
      read_buffers();
      copy_meshes();
      copy_nodes();
    } catch (const json::exception& error) {
      fail("not as glTF 2.0 has it: {:.200}", error.what());
    }
    return {plain_bytes(), triangle_count_};
  }

 private:
  void parse() {
    std::string_view text = file_.text();
    if (text.starts_with(kMagic)) text = open_container();
    document_ = json::parse(text, [this](int depth, json::parse_event_t, const json&) {
      if (depth > kDeepest) fail("nested more than {} deep", kDeepest);
      return true;
    });
    const std::string version = document_.at("asset").at("version").get<std::string>();
    if (!version.starts_with("2.")) fail("glTF of version {:.20}, not 2", version);
    for (const json& extension : list_in(document_, "extensionsRequired")) {
      const std::string name = extension.get<std::string>();
      if (name.find("draco") != std::string::npos || name.find("mesh") != std::string::npos)
        fail_with_hint(fmt::format("needs {:.60}, which is not read", name),
                       "export the model without compression or quantization");
    }
    plain_["asset"]["version"] = "2.0";
  }

  // The JSON of a GLB; keeps its binary chunk.
  std::string_view open_container() {
    constexpr std::size_t kHeader = 12, kChunkHeader = 8;
    const std::string_view all = file_.text();
    if (all.size() < kHeader) fail("cut off in its first {} bytes", kHeader);
    const auto version = value_at<std::uint32_t>(all.data() + 4);
    const auto length = value_at<std::uint32_t>(all.data() + 8);
    if (version != kVersion) fail("GLB of version {}, not {}", version, kVersion);
    if (length != all.size()) fail("its header promises {} bytes, it has {}: truncated?", length, all.size());
    std::string_view text;
    for (std::size_t at = kHeader; at + kChunkHeader <= all.size();) {
      const std::size_t size = value_at<std::uint32_t>(all.data() + at);
      const auto kind = value_at<std::uint32_t>(all.data() + at + 4);
      at += kChunkHeader;
      if (size > all.size() - at) fail("a chunk of {} bytes reaches beyond its end", size);
      if (kind == kJsonChunk && text.empty()) text = all.substr(at, size);
      if (kind == kBinaryChunk && binary_.empty()) binary_ = all.substr(at, size);
      at += size;
    }
    return text;
  }

  // Joins all buffers.
  void read_buffers() {
    for (const json& buffer : list_in(document_, "buffers")) {
      const std::size_t promised = whole(buffer.at("byteLength"));
      std::string decoded;
      std::string_view bytes = binary_;
      if (buffer.contains("uri")) {
        const std::string& uri = buffer.at("uri").get_ref<const std::string&>();
        constexpr std::string_view kEncoding = ";base64,";
        const std::size_t start = uri.find(kEncoding);
        if (!uri.starts_with("data:") || start == std::string::npos) {
          fail_with_hint(fmt::format("its geometry is in another file, '{:.200}'", uri),
                         "export the model as GLB, or as glTF with embedded data");
        }
        decoded = decode_base64(std::string_view(uri).substr(start + kEncoding.size()));
        bytes = decoded;
      }
      if (promised > bytes.size())
        fail("a buffer of {} bytes has only {}: truncated?", promised, bytes.size());
      starts_.push_back(data_.size());
      data_ += bytes.substr(0, promised);
      data_.append(-data_.size() % 4, '\0');
      sizes_.push_back(promised);
    }
  }

  // Copies an accessor of packed values of `size` bytes; gives its new number.
  std::size_t copy_accessor(const json& accessor, const char* type, std::size_t size) {
    if (accessor.at("type") != type) fail("an accessor of another type than {}", type);
    if (accessor.contains("sparse")) fail("sparse accessors are not read");
    const std::size_t count = whole(accessor.at("count"));
    const json& view = element("bufferViews", accessor.at("bufferView"));
    const std::size_t buffer = whole(view.at("buffer"));
    const std::size_t length = whole(view.at("byteLength")),
                      stride = whole(view.value("byteStride", json(size)));
    const std::size_t start = whole(view.value("byteOffset", json(0u)));
    const std::size_t offset = whole(accessor.value("byteOffset", json(0u)));
    if (buffer >= sizes_.size() || length > sizes_[buffer] || start > sizes_[buffer] - length)
      fail("a buffer view reaches beyond its buffer");
    if (stride < size || count == 0 || size > length || offset > length - size ||
        (count - 1) > (length - size - offset) / stride)
      fail("an accessor of {} values reaches beyond its buffer view of {} bytes", count, length);
    value_count_ += count;
    if (value_count_ > kMostValues) fail("accessors used for more than {} values", kMostValues);
    json plain_view = {{"buffer", 0}, {"byteOffset", starts_[buffer] + start}, {"byteLength", length}};
    if (stride != size) plain_view["byteStride"] = stride;
    plain_["bufferViews"].push_back(plain_view);
    plain_["accessors"].push_back({{"bufferView", plain_["bufferViews"].size() - 1},
                                   {"byteOffset", offset},
                                   {"componentType", accessor.at("componentType")},
                                   {"count", count},
                                   {"type", type}});
    return plain_["accessors"].size() - 1;
  }

  std::size_t copy_indices(const json& accessor, std::size_t vertex_count) {
    const std::size_t component = whole(accessor.at("componentType"));
    const std::size_t size = component == uint8 ? 1 : component == uint16 ? 2 : 4;
    if (size == 4 && component != uint32) fail("indices of type {}", component);
    const std::size_t number = copy_accessor(accessor, "SCALAR", size);
    const json& plain = plain_["accessors"][number];
    const json& view = plain_["bufferViews"][whole(plain["bufferView"])];
    if (view.contains("byteStride")) fail("indices that are not packed");
    const char* at = data_.data() + whole(view["byteOffset"]) + whole(plain["byteOffset"]);
    for (std::size_t i = 0; i < whole(plain["count"]); ++i, at += size) {
      std::uint32_t index = 0;
      std::copy_n(at, size, reinterpret_cast<char*>(&index));
      if (index >= vertex_count)
        fail("vertex {} of a triangle is out of range (0 to {})", index, vertex_count - 1);
    }
    return number;
  }

  void copy_meshes() {
    for (const json& mesh : list_in(document_, "meshes")) {
      json primitives = json::array();
      std::size_t count = 0;
      for (const json& primitive : mesh.at("primitives")) {
        const std::size_t mode = whole(primitive.value("mode", json(4u)));
        if (mode < triangles) continue;
        if (mode > triangle_fan) fail("a primitive of mode {}", mode);
        const json& positions = element("accessors", primitive.at("attributes").at("POSITION"));
        if (positions.at("componentType") != int{float32}) fail("positions that are no floats are not read");
        json plain = {{"mode", mode}};
        std::size_t corners = whole(positions.at("count"));
        plain["attributes"]["POSITION"] = copy_accessor(positions, "VEC3", sizeof(Vec3f));
        if (primitive.contains("indices")) {
          const json& indices = element("accessors", primitive.at("indices"));
          plain["indices"] = copy_indices(indices, corners);
          corners = whole(indices.at("count"));
        }
        if (corners < 3 || (mode == triangles && corners % 3 != 0))
          fail("{} corners are no whole number of triangles", corners);
        count += mode == triangles ? corners / 3 : corners - 2;
        primitives.push_back(plain);
      }
      triangles_of_mesh_.push_back(count);
      plain_["meshes"].push_back({{"primitives", primitives}});
    }
  }

  void copy_nodes() {
    const json& nodes = list_in(document_, "nodes");
    plain_["nodes"] = json::array();
    is_used_.resize(nodes.size());
    json roots = json::array();
    const json& scene = element("scenes", document_.value("scene", json(0u)));
    for (const json& root : list_in(scene, "nodes")) roots.push_back(copy_node(nodes, root, 0));
    plain_["scene"] = 0;
    plain_["scenes"].push_back({{"nodes", roots}});
  }

  std::size_t copy_node(const json& nodes, const json& number, int depth) {
    if (depth > kMaxNodeDepth) fail("nodes nested deeper than {}", kMaxNodeDepth);
    const json& node = nodes.at(whole(number));
    if (is_used_[whole(number)]) fail("node {} has two places in its scene", whole(number));
    is_used_[whole(number)] = true;
    json plain = json::object();
    for (const auto& [key, size] :
         {std::pair{"matrix", 16u}, {"translation", 3u}, {"rotation", 4u}, {"scale", 3u}})
      if (node.contains(key)) plain[key] = numbers(node.at(key), size);
    if (node.contains("mesh")) {
      const std::size_t mesh = whole(node.at("mesh"));
      if (mesh >= triangles_of_mesh_.size())
        fail("a node shows mesh {} of {}", mesh, triangles_of_mesh_.size());
      triangle_count_ += triangles_of_mesh_[mesh];
      if (triangle_count_ > kMostInstancedTriangles)
        fail("instances of more than {} triangles", kMostInstancedTriangles);
      if (triangles_of_mesh_[mesh] != 0) plain["mesh"] = mesh;
    }
    json children = json::array();
    for (const json& child : list_in(node, "children"))
      children.push_back(copy_node(nodes, child, depth + 1));
    if (!children.empty()) plain["children"] = children;
    plain_["nodes"].push_back(plain);
    return plain_["nodes"].size() - 1;
  }

  std::string plain_bytes() {
    plain_["buffers"].push_back({{"byteLength", data_.size()}});
    std::string text = plain_.dump();
    text.append(-text.size() % 4, ' ');
    std::string bytes = kMagic;
    const auto append = [&](std::size_t number) { append_bytes(bytes, static_cast<std::uint32_t>(number)); };
    append(kVersion);
    append(12 + 8 + text.size() + 8 + data_.size());
    append(text.size());
    append(kJsonChunk);
    bytes += text;
    append(data_.size());
    append(kBinaryChunk);
    bytes += data_;
    return bytes;
  }

  // Empty where there is none.
  static const json& list_in(const json& object, const char* name) {
    static const json kEmpty = json::array();
    return object.contains(name) ? object.at(name) : kEmpty;
  }

  std::size_t whole(const json& number) const {
    if (!number.is_number_unsigned()) fail("'{:.20}' instead of a whole number", number.dump());
    return number.get<std::size_t>();
  }

  const json& element(const char* list, const json& index) const {
    return document_.at(list).at(whole(index));
  }

  json numbers(const json& list, std::size_t size) const {
    if (!list.is_array() || list.size() != size ||
        !std::all_of(list.begin(), list.end(), [](const json& number) { return number.is_number(); }))
      fail("a node's transform is not {} numbers", size);
    return list;
  }

  template <typename... Arguments>
  [[noreturn]] void fail(fmt::format_string<Arguments...> what, Arguments&&... arguments) const {
    fail_to_read(file_, what, std::forward<Arguments>(arguments)...);
  }

  [[noreturn]] void fail_with_hint(const std::string& what, const char* hint) const {
    throw InputError(fmt::format("{}: {}", file_.name, what), hint);
  }

  const InputFile& file_;
  json document_, plain_;
  std::string_view binary_;
  std::string data_;                         // all buffers, one after another
  std::vector<std::size_t> starts_, sizes_;  // of the buffers in it
  std::vector<std::size_t> triangles_of_mesh_;
  std::vector<bool> is_used_;       // by node
  std::size_t triangle_count_ = 0;  // of all instances
  std::size_t value_count_ = 0;     // of all accessors, for each primitive that uses them
};

LoadedModel read_gltf(InputFile& file, const LoadOptions& options) {
  return import_with_assimp(file.name, GltfCheck(file).run(), "glb",
                            millimetres_per_unit(options, {"meter", 1000}, file.name));
}

}  // namespace

constinit const MeshFormat MeshFormat::glb{"GLB", ".glb", read_gltf};
constinit const MeshFormat MeshFormat::gltf{"glTF", ".gltf", read_gltf};

}  // namespace aerate
