// OBJ through assimp.
#include <algorithm>
#include <array>
#include <cctype>

#include <assimp/IOSystem.hpp>
#include <assimp/Importer.hpp>
#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include <darboux/error.h>

#include "gltf_file.h"

namespace darboux::io {
namespace {

/// Lets assimp open nothing: material libraries have no part in a mesh.
class NoFiles : public Assimp::IOSystem {
 public:
  bool Exists(const char*) const override { return false; }
  char getOsSeparator() const override { return '/'; }
  Assimp::IOStream* Open(const char*, const char*) override { return nullptr; }
  void Close(Assimp::IOStream*) override {}
};

Vec3<double> to_vec3(const aiVector3D& a) {
  return {a.x, a.y, a.z};
}

}  // namespace

Asset read_obj(const std::string& path, const std::string& bytes) {
  if (bytes.empty()) throw FileError(path, "is empty, permitted is an OBJ with faces");
  Assimp::Importer importer;
  importer.SetIOHandler(new NoFiles);  // owned by the importer
  const aiScene* scene =
      importer.ReadFileFromMemory(bytes.data(), bytes.size(), aiProcess_Triangulate, "obj");
  if (scene == nullptr)
    throw FileError(path, "cannot be read by assimp (" + in_quotes(importer.GetErrorString()) +
                              "), permitted is an OBJ with faces");

  Asset asset;
  for (std::size_t m = 0; m < scene->mNumMeshes; ++m) {
    const aiMesh& from = *scene->mMeshes[m];
    Primitive primitive;
    primitive.mesh = m;
    primitive.name = from.mName.C_Str();
    Mesh& mesh = primitive.data;
    for (std::size_t i = 0; i < from.mNumVertices; ++i) {
      mesh.positions.push_back(to_vec3(from.mVertices[i]));
      if (from.HasNormals()) mesh.normals.push_back(to_vec3(from.mNormals[i]));
      if (from.HasTextureCoords(0)) {
        const aiVector3D& uv = from.mTextureCoords[0][i];
        mesh.uvs.push_back({uv.x, uv.y});
      }
    }
    primitive.texcoord = mesh.uvs.empty() ? -1 : 0;
    for (const aiFace& face : std::span(from.mFaces, from.mNumFaces))
      if (face.mNumIndices == 3)
        mesh.triangles.push_back({face.mIndices[0], face.mIndices[1], face.mIndices[2]});
    if (mesh.triangles.empty()) {
      asset.skipped.push_back({m, 0, "points and lines have no triangles"});
      continue;
    }
    check_consistent(mesh, path);
    primitive.instances.push_back(Eigen::Matrix4d::Identity());
    asset.primitives.push_back(std::move(primitive));
  }
  if (asset.primitives.empty()) throw FileError(path, "has no faces, permitted is an OBJ with faces");
  return asset;
}

}  // namespace darboux::io

namespace darboux {

std::span<const std::string_view> asset_extensions() {
  static constexpr std::array<std::string_view, 3> list{".glb", ".gltf", ".obj"};
  return list;
}

Asset read_asset(const std::string& path) {
  std::string bytes = io::read_file(path);
  std::string extension = path.substr(std::min(path.rfind('.'), path.size()));
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  if (bytes.starts_with("glTF") || extension == ".glb" || extension == ".gltf")
    return io::read_gltf(io::load_gltf(path, std::move(bytes)));
  if (extension == ".obj") return io::read_obj(path, bytes);
  throw FileError(
      path, "is of no known kind, permitted are GLB by its content and .glb, .gltf and .obj by their names");
}

}  // namespace darboux
