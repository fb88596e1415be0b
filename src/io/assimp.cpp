// OBJ and FBX through assimp.
#include <algorithm>
#include <charconv>
#include <cstdlib>
#include <cstring>
#include <optional>
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

#include "base/text.h"
#include "child.h"
#include "files.h"
#include "mesh_files.h"
#include "packed.h"

namespace darboux::io {
namespace {

/// Prevents assimp from opening other files: materials, textures and caches do not affect a mesh.
class NoFiles : public Assimp::IOSystem {
 public:
  bool Exists(const char*) const override { return false; }
  char getOsSeparator() const override { return '/'; }
  Assimp::IOStream* Open(const char*, const char*) override { return nullptr; }
  void Close(Assimp::IOStream*) override {}
};

/// Records assimp's log messages about objects of an FBX that it drops.
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

// World matrices of the nodes that reference each mesh.
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

/// The reason to reject a file whose polygons take long to triangulate: assimp visits all corners of a
/// polygon for each of them, in some 20 ns. Polygons of up to 16 corners, which take at least 2 bytes of a
/// file per corner, pass.
std::string long_to_cut(const aiScene& scene, std::size_t file_bytes) {
  const std::uint64_t most = 25'000'000 + 8 * std::uint64_t{file_bytes};
  std::uint64_t sum = 0;
  for (std::size_t m = 0; m < scene.mNumMeshes; ++m)
    for (const aiFace& face : std::span(scene.mMeshes[m]->mFaces, scene.mMeshes[m]->mNumFaces)) {
      if (face.mNumIndices < 5) continue;
      sum += std::uint64_t{face.mNumIndices} * face.mNumIndices;
      if (sum > most)
        return "has polygons whose corners, squared, sum to more than " + std::to_string(most) +
               ": with one of " + std::to_string(face.mNumIndices) + " in mesh " + std::to_string(m);
    }
  return "";
}

/// Moves the triangles that have a corner without a normal, to which assimp gives a zero normal, into a mesh
/// without normals. Each corner has a vertex of its own.
Mesh take_bare_triangles(Mesh& mesh) {
  Mesh bare, rest;
  for (const Triangle& triangle : mesh.triangles) {
    const bool is_bare = std::any_of(triangle.begin(), triangle.end(),
                                     [&](std::uint32_t v) { return mesh.normals[v] == Vec3<double>{}; });
    Mesh& to = is_bare ? bare : rest;
    Triangle own{};
    for (std::size_t k = 0; k < 3; ++k) {
      own[k] = static_cast<std::uint32_t>(to.positions.size());
      to.positions.push_back(mesh.positions[triangle[k]]);
      if (!is_bare) to.normals.push_back(mesh.normals[triangle[k]]);
      if (!mesh.uvs.empty()) to.uvs.push_back(mesh.uvs[triangle[k]]);
    }
    to.triangles.push_back(own);
  }
  if (!bare.triangles.empty()) mesh = std::move(rest);  // empty where all are
  return bare;
}

struct Imported {
  Asset asset;
  std::string refusal;  // empty where the file was read
};

/// \param bare_corners whether an OBJ has some faces without normals
Imported import(const std::string& bytes, AssimpFormat format, bool bare_corners) {
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
      importer.ReadFileFromMemory(bytes.data(), bytes.size(), 0, format == AssimpFormat::obj ? "obj" : "fbx");
  if (scene != nullptr) {
    if (std::string refusal = long_to_cut(*scene, bytes.size()); !refusal.empty())
      return {{}, std::move(refusal)};
    scene = importer.ApplyPostProcessing(aiProcess_Triangulate);
  }
  if (scene == nullptr)
    return {{}, "cannot be read by assimp (" + in_quotes(importer.GetErrorString()) + ")"};

  Imported result;
  auto instances = instances_of(*scene);
  for (std::size_t m = 0; m < scene->mNumMeshes; ++m) {
    Primitive primitive = primitive_of(*scene->mMeshes[m]);
    if (primitive.data.triangles.empty()) {
      result.asset.skipped.push_back({m, 0, "points and lines have no triangles"});
      continue;
    }
    primitive.mesh = m;
    primitive.instances = std::move(instances[m]);
    Mesh bare;
    if (bare_corners && !primitive.data.normals.empty()) bare = take_bare_triangles(primitive.data);
    if (primitive.data.triangles.empty()) std::swap(primitive.data, bare);
    Mesh first = std::move(primitive.data);
    if (!bare.triangles.empty()) {
      result.asset.primitives.push_back(primitive);
      result.asset.primitives.back().data = std::move(first);
      primitive.primitive = 1;
      first = std::move(bare);
    }
    primitive.data = std::move(first);
    result.asset.primitives.push_back(std::move(primitive));
  }
  // These have no number; they are numbered after the meshes.
  for (std::size_t i = 0; i < dropped.size(); ++i)
    result.asset.skipped.push_back(
        {scene->mNumMeshes + i, 0, "assimp drops an object (" + in_quotes(dropped[i]) + ")"});
  if (result.asset.primitives.empty())
    result.refusal = "has no faces" + (dropped.empty() ? "" : " (" + in_quotes(dropped[0]) + ")");
  return result;
}

/// The index behind the first or second slash of a face's corner, "7/3/5"; none if it is missing.
std::optional<long> index_of(std::string_view corner, int slashes) {
  for (; slashes > 0; --slashes) {
    const std::size_t slash = corner.find('/');
    if (slash == std::string_view::npos) return std::nullopt;
    corner.remove_prefix(slash + 1);
  }
  long value = 0;
  if (std::from_chars(corner.data(), corner.data() + corner.size(), value).ec != std::errc{})
    return std::nullopt;
  return value;
}

template <class F>
void for_each_line(std::string_view text, F f) {
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = std::min(text.find('\n', begin), text.size());
    f(text.substr(begin, end - begin));
    begin = end + 1;
  }
}

bool is_face(std::string_view line) {
  return line.starts_with("f ") || line.starts_with("f\t");
}

/// "7/3/5" and the like, of a face.
std::vector<std::string_view> corners_of(std::string_view line) {
  std::vector<std::string_view> corners;
  for (std::size_t at = 1; at < line.size();) {
    const std::size_t begin = line.find_first_not_of(" \t\r", at);
    if (begin == std::string_view::npos) break;
    const std::size_t end = std::min(line.find_first_of(" \t\r", begin), line.size());
    corners.push_back(line.substr(begin, end - begin));
    at = end;
  }
  return corners;
}

/// Whether an OBJ has faces without normals and stores no zero normal, so that a zero normal means none.
bool has_bare_corners(std::string_view text) {
  const auto is_index = [](std::string_view corner) {
    return corner[0] == '-' || (corner[0] >= '0' && corner[0] <= '9');
  };
  bool bare = false, zero = false;
  for_each_line(text, [&](std::string_view line) {
    line.remove_prefix(std::min(line.find_first_not_of(" \t"), line.size()));
    if (is_face(line) && !bare)
      for (const std::string_view corner : corners_of(line))
        bare = bare || (is_index(corner) && !index_of(corner, 2));
    if (line.starts_with("vn ") || line.starts_with("vn\t"))
      zero = zero || line.find_first_of("123456789naifNAIF", 2) == std::string_view::npos;
  });
  return bare && !zero;
}

/// An OBJ without the references of faces to missing uvs or normals: assimp would drop these faces.
std::string without_missing(const std::string& text) {
  const auto each_line = [&](auto f) { for_each_line(text, f); };
  long uvs = 0, normals = 0;
  each_line([&](std::string_view line) {
    uvs += line.starts_with("vt ") || line.starts_with("vt\t");
    normals += line.starts_with("vn ") || line.starts_with("vn\t");
  });
  const auto is_missing = [](std::optional<long> index, long count) {
    return index && std::labs(*index) > count;
  };
  bool any = false;
  each_line([&](std::string_view line) {
    if (is_face(line) && !any)
      for (const std::string_view corner : corners_of(line))
        any = any || is_missing(index_of(corner, 1), uvs) || is_missing(index_of(corner, 2), normals);
  });
  if (!any) return text;
  std::string result;
  each_line([&](std::string_view line) {
    bool no_uv = false, no_normal = false;
    if (is_face(line))
      for (const std::string_view corner : corners_of(line)) {
        no_uv = no_uv || is_missing(index_of(corner, 1), uvs);
        no_normal = no_normal || is_missing(index_of(corner, 2), normals);
      }
    if (!no_uv && !no_normal) {
      result.append(line) += '\n';
      return;
    }
    result += 'f';
    for (const std::string_view corner : corners_of(line)) {
      const auto uv = index_of(corner, 1), normal = index_of(corner, 2);
      result.append(" ").append(corner.substr(0, corner.find('/')));
      if (uv && !no_uv) result += '/' + std::to_string(*uv);
      if (normal && !no_normal) result += (uv && !no_uv ? "/" : "//") + std::to_string(*normal);
    }
    result += '\n';
  });
  return result;
}

/// Inserts a zero before numbers that begin with a point: assimp skips such numbers, and so their vertices.
std::string with_leading_zeros(const std::string& text) {
  std::string result;
  bool in_vertex = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (i == 0 || text[i - 1] == '\n') in_vertex = text[i] == 'v';
    if (in_vertex && text[i] == '.' && i > 0 && (text[i - 1] == ' ' || text[i - 1] == '\t')) result += '0';
    result += text[i];
  }
  return result;
}

/// The version of an FBX, 7400 for 7.4, where it states one.
std::optional<unsigned> fbx_version(std::string_view bytes) {
  constexpr std::string_view magic = "Kaydara FBX Binary  ";
  constexpr std::size_t at = 23;
  if (bytes.starts_with(magic) && bytes.size() >= at + 4) {
    std::uint32_t version;
    std::memcpy(&version, bytes.data() + at, sizeof version);
    return version;
  }
  const std::size_t key = bytes.substr(0, 4096).find("FBXVersion:");
  if (key == std::string_view::npos) return std::nullopt;
  const std::size_t digits = bytes.find_first_of("0123456789", key);
  unsigned version = 0;
  if (digits == std::string_view::npos ||
      std::from_chars(bytes.data() + digits, bytes.data() + bytes.size(), version).ec != std::errc{})
    return std::nullopt;
  return version;
}

}  // namespace

Asset read_with_assimp(const std::string& path, const std::string& bytes, AssimpFormat format,
                       const ReadOptions& options) {
  const std::string wanted =
      std::string("an ") + (format == AssimpFormat::obj ? "OBJ" : "FBX") + " with faces";
  if (bytes.empty()) throw FileError(path, expected_got(wanted, "an empty file"));
  if (format == AssimpFormat::fbx)
    if (const auto version = fbx_version(bytes); version && *version < 7100)
      throw FileError(path, "expected FBX 7.1 (2011) or later, got " + std::to_string(*version / 1000) + "." +
                                std::to_string(*version / 100 % 10) +
                                ": Autodesk's FBX Converter 2013 reads it and writes it anew");
  // assimp takes some 50 bytes per byte of the file, most for ASCII FBX, which it reads at 1 MB per second or
  // faster.
  const ChildLimits limits{(std::uint64_t{1} << 30) + 256 * bytes.size(),
                           static_cast<unsigned>(20 + bytes.size() / 500000), options.sandbox};
  Imported result;
  try {
    const std::string answer = in_child(
        [&] {
          const bool obj = format == AssimpFormat::obj;
          const std::string text = obj ? with_leading_zeros(without_missing(bytes)) : bytes;
          Imported imported = import(text, format, obj && has_bare_corners(text));
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
  if (!result.refusal.empty()) throw FileError(path, expected_got(wanted, "a file that " + result.refusal));
  for (Primitive& primitive : result.asset.primitives) {
    check_consistent(primitive.data, path);
    if (format == AssimpFormat::fbx) primitive.sign = SignConvention::raw;
  }
  return std::move(result.asset);
}

}  // namespace darboux::io
