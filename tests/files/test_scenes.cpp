#include <array>
#include <filesystem>
#include <gtest/gtest.h>
#include <random>
#include <string>

#include "core/error.h"
#include "core/mesh.h"
#include "files/load.h"
#include "tests/support/caught.h"
#include "tests/support/files.h"
#include "tests/support/temporary_folder.h"

// Formats that hold scenes of several nodes. The files scene.* of tests/data (made by make-scenes there) all
// show a ball of 80 facets and radius 10 mm, and the same mirrored in x and moved by 30 mm.
namespace aerate::test {
namespace {

constexpr std::array kScenes{"scene.glb", "scene.gltf", "scene.3ds"};

std::string scene(const std::string& name) {
  return read_bytes(std::filesystem::path(AERATE_TEST_DATA) / name);
}

class Scenes : public testing::Test {
 protected:
  LoadedModel load(const std::string& name, const std::string& content,
                   const LoadOptions& options = {}) const {
    return load_model(folder_.write(name, content), options);
  }
  std::string refusal(const std::string& name, const std::string& content) const {
    return message_of<InputError>([&] { load(name, content); });
  }
  // Of the text file with one passage changed.
  std::string changed(const std::string& old, const std::string& with) const {
    std::string text = scene("scene.gltf");
    const std::size_t at = text.find(old);
    EXPECT_NE(at, std::string::npos) << old;
    return at == std::string::npos ? text : text.replace(at, old.size(), with);
  }

  TemporaryFolder folder_;
};

TEST_F(Scenes, PartsStandWhereTheirNodesPutThemRightSideOut) {
  for (const char* name : kScenes) {
    const LoadedModel model = load(name, scene(name));
    EXPECT_EQ(model.part_count, 2u) << name;
    EXPECT_EQ(model.mesh.triangles.size(), 160u) << name;
    EXPECT_EQ(model.mesh.positions.size(), 84u) << name;
    EXPECT_NEAR(signed_volume(model.mesh), 2 * 3658.712, 0.01) << name;  // of an inscribed polyhedron
    const Box3f box = bounding_box(model.mesh);
    EXPECT_NEAR(box.lower.x, -10, 1e-4) << name;
    EXPECT_NEAR(box.upper.x, 40, 1e-4) << name;
    EXPECT_NEAR(box.lower.z, -10, 1e-4) << name;
    EXPECT_NEAR(box.upper.y, 10, 1e-4) << name;
  }
}

TEST_F(Scenes, NestingIsBoundedAndNoMessageIsLong) {
  constexpr std::size_t kDeep = 200'000;
  const std::string nested = std::string(kDeep, '[') + std::string(kDeep, ']');
  for (const std::string key : {"scene", "extensionsRequired"}) {
    const std::string text = R"({"asset":{"version":"2.0"},")" + key + "\":" + nested + "}";
    EXPECT_TRUE(contains(refusal("deep.gltf", text), "nested more than 64 deep")) << key;
  }
  EXPECT_LT(refusal("long.gltf", "{\"" + std::string(1'000'000, 'x') + "\n\":1}").size(), 1000U);
}

TEST_F(Scenes, GltfIsInMetresAnd3dsInAnyUnit) {
  const std::string glb = scene("scene.glb");
  EXPECT_TRUE(contains(
      message_of<UsageError>([&] { load("scene.glb", glb, {.unit = LengthUnit::millimetre}); }), "meter"));
  const auto width = [&](const char* name, const LoadOptions& options) {
    const Box3f box = bounding_box(load(name, scene(name), options).mesh);
    return box.upper.x - box.lower.x;
  };
  EXPECT_NEAR(width("scene.glb", {.unit = LengthUnit::metre, .scale = {0.5, 0.5, 0.5}}), 25, 1e-4);
  EXPECT_NEAR(width("scene.3ds", {.unit = LengthUnit::inch}), 50 * 25.4, 1e-2);
}

TEST_F(Scenes, GeometryInAnotherFileIsRefusedByName) {
  const std::string text = scene("scene.gltf");
  const std::size_t start = text.find("data:"), end = text.find('"', start);
  for (const char* uri : {"ball.bin", "/etc/passwd", "file:///etc/passwd", "https://example.org/ball.bin"}) {
    folder_.write("ball.bin", std::string(984, '\0'));
    const std::string message = refusal("scene.gltf", text.substr(0, start) + uri + text.substr(end));
    EXPECT_TRUE(contains(message, std::string("in another file, '") + uri + "'")) << message;
  }
}

TEST_F(Scenes, CutOffFilesAreRefused) {
  for (const char* name : kScenes) {
    const std::string whole = scene(name);
    for (std::size_t size = 1; size < whole.size(); size += 29) refusal(name, whole.substr(0, size));
    refusal(name, whole.substr(0, whole.size() - 1));
  }
}

TEST_F(Scenes, StripsFansAndCornersWithoutIndicesBecomeTriangles) {
  const std::string indices = R"("indices": 1)";
  EXPECT_EQ(load("a.gltf", changed(indices, R"("indices": 1, "mode": 5)")).mesh.triangles.size(), 2 * 238u);
  EXPECT_EQ(load("a.gltf", changed(indices, R"("indices": 1, "mode": 6)")).mesh.triangles.size(), 2 * 238u);
  EXPECT_EQ(load("a.gltf", changed(", " + indices, "")).mesh.triangles.size(), 2 * 14u);
  EXPECT_TRUE(contains(refusal("a.gltf", changed(indices, R"("indices": 1, "mode": 1)")), "no triangles"));
}

TEST_F(Scenes, GltfThatPromisesWhatItHasNotIsRefused) {
  const auto refused = [&](const char* old, const char* with, const char* said) {
    const std::string message = refusal("a.gltf", changed(old, with));
    EXPECT_TRUE(contains(message, said)) << message;
  };
  refused(R"("version": "2.0")", R"("version": "1.0")", "version 1.0");
  refused(R"("count": 42)", R"("count": 4000000000)", "reaches beyond");
  refused(R"("count": 42)", R"("count": 12)", "out of range");
  refused(R"("count": 240)", R"("count": 239)", "no whole number of triangles");
  refused(R"("byteLength": 504)", R"("byteLength": 5040)", "beyond its buffer");
  refused(R"("byteLength": 984)", R"("byteLength": 9840)", "has only 984");
  refused(R"("count": 42)", R"("sparse": {}, "count": 42)", "sparse");
  refused(R"("componentType": 5126)", R"("componentType": 5122)", "no floats");
  refused(R"({"mesh": 0})", R"({"mesh": 1})", "mesh 1 of 1");
  refused(R"({"mesh": 0})", R"({"mesh": 0, "children": [0]})", "two places");
  refused(R"({"mesh": 0})", R"({"mesh": 0, "scale": [1, 1]})", "not 3 numbers");
  refused(R"("scene": 0)", R"("scene": 3)", "not as glTF 2.0 has it");
  refused(R"("scene": 0)", R"("extensionsRequired": ["KHR_draco_mesh_compression"], "scene": 0)", "draco");
}

TEST_F(Scenes, NodesAreBounded) {
  std::string deep;
  for (int i = 3; i < 1000; ++i) deep += R"(, {"children": [)" + std::to_string(i + 1) + "]}";
  const std::string children = R"({"children": [1, 2]})";
  const std::string last = "1]}]";
  std::string text = changed(children, R"({"children": [1, 3]})");
  text.insert(text.find(last) + last.size() - 1, deep + ", {}");
  EXPECT_TRUE(contains(refusal("deep.gltf", text), "nested deeper than 256"));

  // A million triangles, which 40 nodes show.
  std::string roots = "0", nodes = R"({"mesh": 0})";
  for (int i = 1; i < 40; ++i) {
    roots += ", " + std::to_string(i);
    nodes += R"(, {"mesh": 0})";
  }
  const std::string many =
      R"({"asset": {"version": "2.0"}, "scenes": [{"nodes": [)" + roots + R"(]}], "nodes": [)" + nodes +
      R"(], "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}], "accessors": [)"
      R"({"bufferView": 0, "componentType": 5126, "count": 1, "type": "VEC3"},)"
      R"({"bufferView": 0, "componentType": 5121, "count": 3000000, "type": "SCALAR"}],)"
      R"("bufferViews": [{"buffer": 0, "byteLength": 3000000}],)"
      R"("buffers": [{"byteLength": 3000000, "uri": "data:;base64,)" +
      std::string(4000000, 'A') + R"("}]})";
  EXPECT_TRUE(contains(refusal("many.gltf", many), "instances of more than 33554432 triangles"));
}

TEST_F(Scenes, ThreeDsThatPromisesWhatItHasNotIsRefused) {
  std::string bytes = scene("scene.3ds");
  const std::size_t faces = bytes.rfind("\x20\x41");
  bytes[faces + 8] = 42;  // the first vertex of a triangle
  EXPECT_TRUE(contains(refusal("a.3ds", bytes), "vertex 42 of a triangle is out of range"));
  bytes[faces + 6] = 81;  // triangles
  EXPECT_TRUE(contains(refusal("a.3ds", bytes), "promises 81 records"));
}

// Whatever is wrong, it is said: no crash, and nothing that takes time or memory beyond the file's own.
TEST_F(Scenes, AlteredFilesAreReadOrRefused) {
  for (const char* name : kScenes) {
    const std::string whole = scene(name);
    std::mt19937 random(1);
    for (int i = 0; i < 300; ++i) {
      std::string bytes = whole;
      for (unsigned change = 0; change <= random() % 3; ++change) {
        const std::size_t at = random() % bytes.size();
        if (random() % 2 == 0) {
          bytes[at] = static_cast<char>(random());
        } else {
          bytes.replace(at, random() % 8, bytes.substr(random() % bytes.size(), random() % 8));
        }
      }
      try {
        load(name, bytes);
      } catch (const InputError&) {
      }
    }
  }
}

}  // namespace
}  // namespace aerate::test
