// OBJ and FBX through assimp.
#include <span>
#include <string_view>

#include <assimp/DefaultLogger.hpp>
#include <assimp/IOSystem.hpp>
#include <assimp/Importer.hpp>
#include <assimp/LogStream.hpp>
#include <assimp/config.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include <darboux/error.h>

#include "child.h"
#include "files.h"
#include "mesh_files.h"
#include "packed.h"

namespace darboux::io {
namespace {

/// Lets assimp open nothing: materials, textures and caches have no part in a mesh.
class NoFiles : public Assimp::IOSystem {
 public:
  bool Exists(const char*) const override { return false; }
  char getOsSeparator() const override { return '/'; }
  Assimp::IOStream* Open(const char*, const char*) override { return nullptr; }
  void Close(Assimp::IOStream*) override {}
};

/// Keeps what assimp says of objects of an FBX that it drops.
class Dropped : public Assimp::LogStream {
 public:
  explicit Dropped(std::vector<std::string>& messages) : messages_(messages) {}
  void write(const char* message) override {
    constexpr std::size_t most = 16;
    const std::string_view text = message;
    const std::size_t at = text.find("FBX-");
    if (at != std::string_view::npos && messages_.size() < most)
      messages_.emplace_back(text.substr(at, text.find_last_not_of('\n') + 1 - at));
  }

 private:
  std::vector<std::string>& messages_;
};

Vec3<double> to_vec3(const aiVector3D& a) {
  return {a.x, a.y, a.z};
}

Primitive primitive_of(const aiMesh& from) {
  Primitive primitive;
  primitive.name = from.mName.C_Str();
  Mesh& mesh = primitive.data;
  for (std::size_t i = 0; i < from.mNumVertices; ++i) {
    mesh.positions.push_back(to_vec3(from.mVertices[i]));
    if (!from.HasNormals()) continue;
    mesh.normals.push_back(to_vec3(from.mNormals[i]));
    if (from.HasTangentsAndBitangents())
      mesh.tangents.push_back(
          with_side(mesh.normals[i], to_vec3(from.mTangents[i]), to_vec3(from.mBitangents[i])));
  }
  for (unsigned channel = 0; channel < from.GetNumUVChannels(); ++channel) {
    if (channel > 0 && mesh.tangents.empty()) break;
    std::vector<Vec2<double>> uvs;
    for (const aiVector3D& uv : std::span(from.mTextureCoords[channel], from.mNumVertices))
      uvs.push_back({uv.x, uv.y});
    if (channel == 0)
      mesh.uvs = std::move(uvs);
    else
      primitive.other_uvs.emplace_back(static_cast<int>(channel), std::move(uvs));
  }
  primitive.texcoord = mesh.uvs.empty() ? -1 : 0;
  for (const aiFace& face : std::span(from.mFaces, from.mNumFaces))
    if (face.mNumIndices == 3)
      mesh.triangles.push_back({face.mIndices[0], face.mIndices[1], face.mIndices[2]});
  return primitive;
}

// World matrices of the nodes that show each mesh.
std::vector<std::vector<Eigen::Matrix4d>> instances_of(const aiScene& scene) {
  std::vector<std::vector<Eigen::Matrix4d>> instances(scene.mNumMeshes);
  struct Visit {
    const aiNode* node;
    Eigen::Matrix4d parent;
  };
  std::vector<Visit> stack;
  if (scene.mRootNode != nullptr) stack.push_back({scene.mRootNode, Eigen::Matrix4d::Identity()});
  while (!stack.empty()) {
    const Visit visit = stack.back();
    stack.pop_back();
    Eigen::Matrix4d local;
    for (unsigned row = 0; row < 4; ++row)
      for (unsigned column = 0; column < 4; ++column)
        local(row, column) = visit.node->mTransformation[row][column];
    const Eigen::Matrix4d world = visit.parent * local;
    for (const unsigned mesh : std::span(visit.node->mMeshes, visit.node->mNumMeshes))
      instances.at(mesh).push_back(world);
    for (unsigned i = visit.node->mNumChildren; i > 0; --i)
      stack.push_back({visit.node->mChildren[i - 1], world});
  }
  return instances;
}

struct Imported {
  Asset asset;
  std::string refusal;  // empty where the file was read
};

Imported import(const std::string& bytes, const std::string& format) {
  Assimp::Importer importer;
  importer.SetIOHandler(new NoFiles);  // owned by the importer
  std::vector<std::string> dropped;
  Assimp::DefaultLogger::create("", Assimp::Logger::NORMAL, 0);
  Assimp::DefaultLogger::get()->attachStream(new Dropped(dropped), Assimp::Logger::Err);
  for (const char* unneeded : {AI_CONFIG_IMPORT_FBX_READ_MATERIALS, AI_CONFIG_IMPORT_FBX_READ_TEXTURES,
                               AI_CONFIG_IMPORT_FBX_READ_CAMERAS, AI_CONFIG_IMPORT_FBX_READ_LIGHTS,
                               AI_CONFIG_IMPORT_FBX_READ_ANIMATIONS, AI_CONFIG_IMPORT_FBX_READ_WEIGHTS})
    importer.SetPropertyBool(unneeded, false);
  const aiScene* scene =
      importer.ReadFileFromMemory(bytes.data(), bytes.size(), aiProcess_Triangulate, format.c_str());
  if (scene == nullptr)
    return {{}, "cannot be read by assimp (" + in_quotes(importer.GetErrorString()) + ")"};

  Imported result;
  const auto instances = instances_of(*scene);
  for (std::size_t m = 0; m < scene->mNumMeshes; ++m) {
    Primitive primitive = primitive_of(*scene->mMeshes[m]);
    if (primitive.data.triangles.empty()) {
      result.asset.skipped.push_back({m, 0, "points and lines have no triangles"});
      continue;
    }
    primitive.mesh = m;
    primitive.instances = instances[m];
    result.asset.primitives.push_back(std::move(primitive));
  }
  // Those have no number: they are counted on after the meshes.
  for (std::size_t i = 0; i < dropped.size(); ++i)
    result.asset.skipped.push_back(
        {scene->mNumMeshes + i, 0, "assimp drops an object (" + in_quotes(dropped[i]) + ")"});
  if (result.asset.primitives.empty())
    result.refusal = "has no faces" + (dropped.empty() ? "" : " (" + in_quotes(dropped[0]) + ")");
  return result;
}

}  // namespace

Asset read_with_assimp(const std::string& path, const std::string& bytes, const std::string& format) {
  const std::string permitted =
      std::string(", permitted is an ") + (format == "obj" ? "OBJ" : "FBX") + " with faces";
  if (bytes.empty()) throw FileError(path, "is empty" + permitted);
  // For each byte assimp has some 50 of its own, most for FBX in ASCII, of which it reads 1 MB in a second at least.
  const ChildLimits limits{(std::uint64_t{1} << 30) + 256 * bytes.size(),
                           static_cast<unsigned>(20 + bytes.size() / 500000)};
  Imported result;
  try {
    const std::string answer = in_child(
        [&] {
          Imported imported = import(bytes, format);
          Pack pack;
          visit(pack, imported.refusal, imported.asset);
          return std::move(pack.bytes);
        },
        limits);
    Unpack unpack{answer};
    visit(unpack, result.refusal, result.asset);
  } catch (const ChildFailure& failure) {
    result.refusal = std::string("cannot be read by assimp, which ") + failure.what();
  }
  if (!result.refusal.empty()) throw FileError(path, result.refusal + permitted);
  for (const Primitive& primitive : result.asset.primitives) check_consistent(primitive.data, path);
  return std::move(result.asset);
}

}  // namespace darboux::io
