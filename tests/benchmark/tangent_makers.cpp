#include "tangent_makers.h"

#include <chrono>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <fstream>
#include <memory>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include <assimp/BaseImporter.h>
#include <assimp/Importer.hpp>
#include <assimp/importerdesc.h>
#include <assimp/mesh.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include <darboux/mikktspace.h>

#include "torus_file.h"

namespace darboux::bench {
namespace {

// The largest size that this process has had in memory since the last reset, where Linux lets one reset it.
double peak_bytes() {
  std::ifstream status("/proc/self/status");
  for (std::string word; status >> word;)
    if (word == "VmHWM:") {
      double kibibytes = 0;
      status >> kibibytes;
      return 1024 * kibibytes;
    }
  throw std::runtime_error("/proc/self/status: no VmHWM");
}
void reset_peak() {
  std::ofstream("/proc/self/clear_refs") << "5";
}

// Time and memory of the first call; then calls until half a second has passed in all, then those that are timed, for a fifth
// of one.
// call() returns the seconds that count; output_bytes are those that a call itself allocates for its results.
template <class Call>
Sample sample(double output_bytes, Call&& call) {
  reset_peak();
  const double before = peak_bytes();
  const double first = call();
  Sample result{0, first, peak_bytes() - before - output_bytes};
  for (double passed = first; passed < 0.5;) passed += call();
  int calls = 0;
  for (; result.seconds < 0.2; ++calls) result.seconds += call();
  result.seconds /= calls;
  return result;
}

template <class F>
double seconds(F&& f) {
  using Clock = std::chrono::steady_clock;
  const auto from = Clock::now();
  f();
  return std::chrono::duration<double>(Clock::now() - from).count();
}

Sample measure_darboux(const MeshArrays& arrays, int threads, std::vector<float>& tangent4) {
  const MikkMesh mesh{arrays.positions, arrays.normals, arrays.uvs, arrays.corners, {}};
  tangent4.assign(4 * arrays.corner_count(), 0);
  return sample(0, [&] { return seconds([&] { mikktspace(mesh, tangent4, {.threads = threads}); }); });
}

// Reads nothing: hands arrays to assimp as the mesh of a scene. Its post-processing works on what an importer made.
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

Sample measure_assimp(const MeshArrays& arrays, std::vector<float>& tangent4) {
  Assimp::Importer importer;
  importer.RegisterLoader(new FromArrays(arrays));  // the importer's from now on
  const char nothing = 0;
  const aiScene* scene = importer.ReadFileFromMemory(&nothing, 1, 0, "arrays");
  if (scene == nullptr) throw std::runtime_error(importer.GetErrorString());
  aiMesh& mesh = *scene->mMeshes[0];
  // A mesh that has tangents is left alone.
  const auto call = [&] {
    delete[] std::exchange(mesh.mTangents, nullptr);
    delete[] std::exchange(mesh.mBitangents, nullptr);
    const double time = seconds([&] { importer.ApplyPostProcessing(aiProcess_CalcTangentSpace); });
    if (!mesh.HasTangentsAndBitangents()) throw std::runtime_error("assimp made no tangents");
    return time;
  };
  const Sample result = sample(2.0 * sizeof(aiVector3D) * mesh.mNumVertices, call);
  for (std::size_t c = 0; c < arrays.corner_count(); ++c) {
    const std::uint32_t v = arrays.vertex(c);
    const aiVector3D t = mesh.mTangents[v], b = mesh.mBitangents[v], n = mesh.mNormals[v];
    for (const float x : {t.x, t.y, t.z, (n ^ t) * b < 0 ? -1.F : 1.F}) tangent4.push_back(x);
  }
  return result;
}

}  // namespace

Sample measure_maker(const std::string& maker, const std::filesystem::path& mesh,
                     const std::filesystem::path& tangents) {
  const MeshArrays arrays = read_mesh_arrays(mesh);
  std::vector<float> tangent4;
  Sample result{};
  if (maker == "assimp")
    result = measure_assimp(arrays, tangent4);
  else if (maker == "darboux-1" || maker == "darboux-2")
    result = measure_darboux(arrays, maker.back() - '0', tangent4);
  else
    throw std::runtime_error("no maker " + maker);
  if (!tangents.empty()) write_floats(tangent4, tangents);
  return result;
}

}  // namespace darboux::bench
