#include "assimp_mesh.h"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <stdexcept>
#include <utility>

#include <assimp/BaseImporter.h>
#include <assimp/Importer.hpp>
#include <assimp/importerdesc.h>
#include <assimp/mesh.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>

namespace darboux::bench {
namespace {

// Reads nothing: hands arrays to assimp as the mesh of a scene. Its post-processing works on what an importer
// made.
class FromArrays : public Assimp::BaseImporter {
 public:
  explicit FromArrays(const MeshArrays& arrays) : arrays_(arrays) {}
  bool CanRead(const std::string&, Assimp::IOSystem*, bool) const override { return true; }

 protected:
  const aiImporterDesc* GetInfo() const override {
    static const aiImporterDesc description{"Arrays", "", "", "", 0, 0, 0, 0, 0, "arrays"};
    return &description;
  }
  void InternReadFile(const std::string&, aiScene* scene, Assimp::IOSystem*) override {
    auto mesh = std::make_unique<aiMesh>();
    const std::size_t vertices = arrays_.vertex_count(), triangles = arrays_.corner_count() / 3;
    mesh->mPrimitiveTypes = aiPrimitiveType_TRIANGLE;
    mesh->mNumVertices = static_cast<unsigned>(vertices);
    mesh->mVertices = new aiVector3D[vertices];
    mesh->mNormals = new aiVector3D[vertices];
    mesh->mTextureCoords[0] = new aiVector3D[vertices];
    mesh->mNumUVComponents[0] = 2;
    for (std::size_t v = 0; v < vertices; ++v) {
      const float *p = &arrays_.positions[3 * v], *n = &arrays_.normals[3 * v], *uv = &arrays_.uvs[2 * v];
      mesh->mVertices[v] = {p[0], p[1], p[2]};
      mesh->mNormals[v] = {n[0], n[1], n[2]};
      mesh->mTextureCoords[0][v] = {uv[0], uv[1], 0};
    }
    mesh->mNumFaces = static_cast<unsigned>(triangles);
    mesh->mFaces = new aiFace[triangles];
    for (std::size_t t = 0; t < triangles; ++t) {
      mesh->mFaces[t].mNumIndices = 3;
      mesh->mFaces[t].mIndices =
          new unsigned[3]{arrays_.vertex(3 * t), arrays_.vertex(3 * t + 1), arrays_.vertex(3 * t + 2)};
    }
    scene->mMaterials = new aiMaterial* [1] { new aiMaterial };
    scene->mNumMaterials = 1;
    scene->mMeshes = new aiMesh* [1] { mesh.release() };
    scene->mNumMeshes = 1;
    scene->mRootNode = new aiNode;
    scene->mRootNode->mMeshes = new unsigned[1]{0};
    scene->mRootNode->mNumMeshes = 1;
  }

 private:
  const MeshArrays& arrays_;
};

}  // namespace

struct AssimpMesh::Scene {
  Assimp::Importer importer;
  aiMesh* mesh = nullptr;  // the importer's
};

AssimpMesh::AssimpMesh(const MeshArrays& arrays) : arrays_(arrays), scene_(std::make_unique<Scene>()) {
  scene_->importer.RegisterLoader(new FromArrays(arrays));  // the importer's from now on
  const char nothing = 0;
  const aiScene* scene = scene_->importer.ReadFileFromMemory(&nothing, 1, 0, "arrays");
  if (scene == nullptr) throw std::runtime_error(scene_->importer.GetErrorString());
  scene_->mesh = scene->mMeshes[0];
}

AssimpMesh::~AssimpMesh() = default;

void AssimpMesh::make_tangents() {
  scene_->importer.ApplyPostProcessing(aiProcess_CalcTangentSpace);
  if (!scene_->mesh->HasTangentsAndBitangents()) throw std::runtime_error("assimp made no tangents");
}

void AssimpMesh::drop_tangents() {
  delete[] std::exchange(scene_->mesh->mTangents, nullptr);
  delete[] std::exchange(scene_->mesh->mBitangents, nullptr);
}

std::vector<float> AssimpMesh::tangents() const {
  const aiMesh& mesh = *scene_->mesh;
  std::vector<float> tangent4;
  for (std::size_t c = 0; c < arrays_.corner_count(); ++c) {
    const std::uint32_t v = arrays_.vertex(c);
    const aiVector3D t = mesh.mTangents[v], b = mesh.mBitangents[v], n = mesh.mNormals[v];
    for (const float x : {t.x, t.y, t.z, (n ^ t) * b < 0 ? -1.F : 1.F}) tangent4.push_back(x);
  }
  return tangent4;
}

}  // namespace darboux::bench
