#include "files/assimp_import.h"

#include <algorithm>
#include <assimp/IOSystem.hpp>
#include <assimp/Importer.hpp>
#include <assimp/postprocess.h>
#include <assimp/scene.h>
#include <fmt/format.h>
#include <string>
#include <utility>
#include <vector>

#include "files/input_file.h"
#include "files/part_writer.h"

namespace aerate {
namespace {

// A disk without files: materials and textures stay where they are.
class NoFiles final : public Assimp::IOSystem {
 public:
  bool Exists(const char*) const override { return false; }
  char getOsSeparator() const override { return '/'; }
  Assimp::IOStream* Open(const char*, const char*) override { return nullptr; }
  void Close(Assimp::IOStream*) override {}
};

Affine to_affine(const aiMatrix4x4& m) {
  using Rows = Eigen::Matrix<ai_real, 4, 4, Eigen::RowMajor>;
  static_assert(sizeof(m) == sizeof(Rows));
  return Affine(Eigen::Map<const Rows>(&m.a1).topRows<3>().cast<double>());
}

// assimp quotes the rest of a file.
std::string last_error(const Assimp::Importer& importer) {
  return fmt::format("{:.200}", importer.GetErrorString());
}

bool has_polygons(const aiMesh& mesh) {
  // assimp's flag is also set for faces without any corners, which its triangulation does not survive alone.
  if ((mesh.mPrimitiveTypes & aiPrimitiveType_POLYGON) == 0) return false;
  return std::any_of(mesh.mFaces, mesh.mFaces + mesh.mNumFaces,
                     [](const aiFace& face) { return face.mNumIndices > 3; });
}

bool needs_triangulation(const aiScene& scene) {
  return std::any_of(scene.mMeshes, scene.mMeshes + scene.mNumMeshes,
                     [](const aiMesh* mesh) { return has_polygons(*mesh); });
}

[[noreturn]] void fail_missing_vertex(const std::string& name, unsigned int face) {
  fail_to_read(name, "face {} uses a vertex that is not there", face + 1);
}

// Triangles that a mesh has once every polygon of n corners has become n - 2 of them. Checks what
// triangulation relies on.
std::size_t count_triangles(const aiMesh& mesh, const std::string& name) {
  std::size_t triangles = 0;
  for (unsigned int f = 0; f < mesh.mNumFaces; ++f) {
    const aiFace& face = mesh.mFaces[f];
    for (unsigned int corner = 0; corner < face.mNumIndices; ++corner) {
      if (face.mIndices[corner] >= mesh.mNumVertices) fail_missing_vertex(name, f);
    }
    if (face.mNumIndices >= 3) triangles += face.mNumIndices - 2;
  }
  return triangles;
}

// Replaces polygons by triangles.
const aiScene* triangulate(Assimp::Importer& importer, const std::string& name) {
  const aiScene* scene = importer.GetScene();
  std::vector<std::size_t> expected(scene->mNumMeshes);
  for (unsigned int m = 0; m < scene->mNumMeshes; ++m)
    expected[m] = count_triangles(*scene->mMeshes[m], name);
  scene = importer.ApplyPostProcessing(aiProcess_Triangulate);
  if (scene == nullptr || scene->mNumMeshes != expected.size()) {
    fail_to_read(name, "its polygons could not be triangulated: {}", last_error(importer));
  }
  for (unsigned int m = 0; m < scene->mNumMeshes; ++m) {
    const std::size_t triangles = count_triangles(*scene->mMeshes[m], name);
    if (triangles != expected[m]) {
      throw InputError(fmt::format("{}: a polygon could not be triangulated ({} triangles of {})", name,
                                   triangles, expected[m]),
                       "triangulate the model in the program that made it");
    }
  }
  return scene;
}

void add_mesh(const aiMesh& mesh, PartWriter& part, const std::string& name) {
  const auto corner = [&](unsigned int index) {
    const aiVector3D& v = mesh.mVertices[index];
    return Vec3f{v.x, v.y, v.z};
  };
  for (unsigned int f = 0; f < mesh.mNumFaces; ++f) {
    const aiFace& face = mesh.mFaces[f];
    // Points and lines have no part in a surface.
    if (face.mNumIndices != 3) continue;
    const unsigned int a = face.mIndices[0], b = face.mIndices[1], c = face.mIndices[2];
    if (a >= mesh.mNumVertices || b >= mesh.mNumVertices || c >= mesh.mNumVertices)
      fail_missing_vertex(name, f);
    part.add_triangle(corner(a), corner(b), corner(c));
  }
}

void add_node(const aiScene& scene, const aiNode& node, const Affine& parent, Vec3d factor,
              const std::string& name, Welder& welder, LoadedModel& model) {
  const Affine transform = parent * to_affine(node.mTransformation);
  PartWriter part(welder, transform, factor, name);
  const std::size_t before = welder.triangle_count();
  for (unsigned int m = 0; m < node.mNumMeshes; ++m) add_mesh(*scene.mMeshes[node.mMeshes[m]], part, name);
  if (welder.triangle_count() != before) ++model.part_count;
  for (unsigned int child = 0; child < node.mNumChildren; ++child) {
    add_node(scene, *node.mChildren[child], transform, factor, name, welder, model);
  }
}

}  // namespace

// No vertices are joined by assimp: 5.2 gives an STL facet's normal to its corners, and then takes corners of
// different facets for different vertices.
LoadedModel import_with_assimp(const std::string& name, const PlainFile& file, const char* extension,
                               Vec3d factor, const Affine& placement) {
  if (file.triangles == 0) fail_to_read(name, "no triangles");
  Assimp::Importer importer;
  importer.SetIOHandler(new NoFiles);  // which takes it over
  const aiScene* scene = importer.ReadFileFromMemory(file.bytes.data(), file.bytes.size(), 0, extension);
  if (scene == nullptr) fail_to_read(name, "cannot be read: {}", last_error(importer));
  if (needs_triangulation(*scene)) scene = triangulate(importer, name);
  LoadedModel model{.mesh = {}, .format = {}, .part_count = 0, .notices = file.notices};
  Welder welder(file.triangles);
  if (scene->mRootNode != nullptr)
    add_node(*scene, *scene->mRootNode, placement, factor, name, welder, model);
  model.mesh = std::move(welder).finish();
  if (model.mesh.triangles.size() != file.triangles) {
    fail_to_read(name, "only {} of {} triangles could be read", model.mesh.triangles.size(), file.triangles);
  }
  return model;
}

}  // namespace aerate
