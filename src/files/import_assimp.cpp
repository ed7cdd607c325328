#include <algorithm>
#include <assimp/Importer.hpp>
#include <assimp/postprocess.h>
#include <assimp/scene.h>
#include <fmt/format.h>
#include <utility>
#include <vector>

#include "core/error.h"
#include "files/import.h"

namespace aerate {
namespace {

Affine to_affine(const aiMatrix4x4& m) {
  using Rows = Eigen::Matrix<ai_real, 4, 4, Eigen::RowMajor>;
  static_assert(sizeof(m) == sizeof(Rows));
  return Affine(Eigen::Map<const Rows>(&m.a1).topRows<3>().cast<double>());
}

std::size_t count_faces(const aiScene& scene) {
  std::size_t faces = 0;
  for (unsigned int m = 0; m < scene.mNumMeshes; ++m) faces += scene.mMeshes[m]->mNumFaces;
  return faces;
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
  throw InputError(fmt::format("{}: face {} uses a vertex that is not there", name, face + 1));
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
    throw InputError(
        fmt::format("{}: its polygons could not be triangulated: {}", name, importer.GetErrorString()));
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

void add_node(const aiScene& scene, const aiNode& node, const Affine& parent, double factor,
              const std::string& name, Welder& welder, ImportedModel& model) {
  const Affine transform = parent * to_affine(node.mTransformation);
  PartWriter part(welder, transform, factor, name);
  const std::size_t before = welder.triangle_count();
  for (unsigned int m = 0; m < node.mNumMeshes; ++m) add_mesh(*scene.mMeshes[node.mMeshes[m]], part, name);
  if (welder.triangle_count() != before) ++model.part_count;
  for (unsigned int child = 0; child < node.mNumChildren; ++child) {
    add_node(scene, *node.mChildren[child], transform, factor, name, welder, model);
  }
}

// No vertices are joined by assimp: 5.2 gives an STL facet's normal to its corners, and then takes corners of
// different facets for different vertices.
ImportedModel take_over(Assimp::Importer& importer, const FileFacts& facts, double factor,
                        const std::string& name) {
  const aiScene* scene = importer.GetScene();
  if (scene == nullptr)
    throw InputError(fmt::format("{}: cannot be read: {}", name, importer.GetErrorString()));
  const std::size_t faces = count_faces(*scene);
  if (facts.face_count && faces != *facts.face_count) {
    throw InputError(fmt::format("{}: only {} of {} faces could be read", name, faces, *facts.face_count));
  }
  ImportedModel model;
  for (unsigned int m = 0; m < scene->mNumMeshes; ++m)
    model.vertices_in_file += scene->mMeshes[m]->mNumVertices;
  if (facts.vertex_count) model.vertices_in_file = *facts.vertex_count;
  if (needs_triangulation(*scene)) scene = triangulate(importer, name);
  Welder welder(faces);
  if (scene->mRootNode != nullptr)
    add_node(*scene, *scene->mRootNode, Affine::Identity(), factor, name, welder, model);
  model.mesh = std::move(welder).finish();
  return model;
}

}  // namespace

ImportedModel import_with_assimp(const FileBytes& bytes, const std::string& extension, const FileFacts& facts,
                                 double factor, const std::string& name) {
  Assimp::Importer importer;
  importer.ReadFileFromMemory(bytes.data.get(), bytes.size, 0, extension.c_str());
  return take_over(importer, facts, factor, name);
}

ImportedModel import_with_assimp(const std::filesystem::path& path, const FileFacts& facts, double factor) {
  Assimp::Importer importer;
  importer.ReadFile(path.string(), 0);
  return take_over(importer, facts, factor, path.string());
}

}  // namespace aerate
