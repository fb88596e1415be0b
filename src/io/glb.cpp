// A mesh as a new GLB.
#include <algorithm>
#include <array>
#include <cmath>

#include <darboux/error.h>
#include <darboux/io.h>

#include "base/text.h"
#include "gltf_file.h"

namespace darboux {
namespace {

using io::Json;

std::vector<float> flatten(const std::vector<Vec2<double>>& values) {
  std::vector<float> flat;
  flat.reserve(values.size() * 2);
  for (const auto& a : values)
    for (const double x : {a.x, a.y}) flat.push_back(static_cast<float>(x));
  return flat;
}
std::vector<float> flatten(const std::vector<Vec3<double>>& values) {
  std::vector<float> flat;
  flat.reserve(values.size() * 3);
  for (const auto& a : values)
    for (const double x : {a.x, a.y, a.z}) flat.push_back(static_cast<float>(x));
  return flat;
}
std::vector<float> flatten(const std::vector<Vec4<double>>& values) {
  std::vector<float> flat;
  flat.reserve(values.size() * 4);
  for (const auto& a : values)
    for (const double x : {a.x, a.y, a.z, a.w}) flat.push_back(static_cast<float>(x));
  return flat;
}

/// Appends an accessor of float vectors and returns its index.
std::size_t append_floats(GltfFile& file, const std::vector<float>& values, std::size_t components) {
  std::string bytes(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(float));
  const std::size_t view = file.append_view(io::Piece::of(std::move(bytes)), 0, io::vertex_target);
  return file.append_accessor({{"bufferView", view},
                               {"componentType", io::component_f32},
                               {"count", values.size() / components},
                               {"type", "VEC" + std::to_string(components)}});
}

GltfFile new_file(const std::string& path) {
  GltfFile file;
  file.path = path;
  file.json = {{"asset", {{"version", "2.0"}, {"generator", "Darboux"}}},
               {"scene", 0},
               {"scenes", Json::array({{{"nodes", Json::array()}}})}};
  return file;
}

// Appends the mesh with a node of its own.
void append_mesh(GltfFile& file, const Mesh& mesh, const std::string& name, const std::string& extras_json) {
  check_consistent(mesh, name);
  if (mesh.triangles.empty()) throw MeshError(name, expected_got("at least one triangle", "none"));

  const std::vector<float> positions = flatten(mesh.positions);
  std::array<float, 3> least{}, greatest{};
  for (std::size_t i = 0; i < positions.size(); ++i) {
    const float x = positions[i];
    if (!std::isfinite(x))
      throw MeshError(name, "position of vertex " + std::to_string(i / 3) + ": " +
                                expected_got("finite floats", shortest(static_cast<double>(x))));
    least[i % 3] = i < 3 ? x : std::min(least[i % 3], x);
    greatest[i % 3] = i < 3 ? x : std::max(greatest[i % 3], x);
  }

  const std::size_t number = file.json.contains("meshes") ? file.json["meshes"].size() : 0;
  file.json["scenes"][0]["nodes"].push_back(number);
  file.json["nodes"].push_back({{"mesh", number}});
  Json attributes;
  const std::size_t position = append_floats(file, positions, 3);
  file.json["accessors"][position]["min"] = least;
  file.json["accessors"][position]["max"] = greatest;
  attributes["POSITION"] = position;
  if (!mesh.normals.empty()) attributes["NORMAL"] = append_floats(file, flatten(mesh.normals), 3);
  if (!mesh.uvs.empty()) attributes["TEXCOORD_0"] = append_floats(file, flatten(mesh.uvs), 2);
  if (!mesh.tangents.empty()) attributes["TANGENT"] = append_floats(file, flatten(mesh.tangents), 4);
  const std::span<const std::uint32_t> indices(mesh.triangles.front().data(), mesh.corners());
  Json primitive = {{"attributes", attributes}, {"indices", file.append_indices(indices)}};

  Json mesh_json;
  if (!name.empty()) mesh_json["name"] = name;
  mesh_json["primitives"] = Json::array({primitive});
  if (!extras_json.empty()) mesh_json["extras"] = io::parse_extras("write_glb", extras_json);
  file.json["meshes"].push_back(mesh_json);
}

}  // namespace

Json io::parse_extras(const char* subject, const std::string& text) {
  try {
    Json extras = parse_json("extras_json", text);
    if (extras.is_object()) return extras;
  } catch (const FileError& error) {
    throw ParameterError(subject, error.what());
  }
  throw ParameterError(subject, "extras_json: " + expected_got("a JSON object", in_quotes(text)));
}

void write_glb(const std::string& path, const Mesh& mesh, const std::string& name,
               const std::string& extras_json) {
  GltfFile file = new_file(path);
  append_mesh(file, mesh, name, extras_json);
  write_file(path, file.to_glb());
}

GltfDocument GltfDocument::of(const Asset& asset, const std::string& path) {
  auto file = std::make_unique<GltfFile>(new_file(path));
  for (const Primitive& p : asset.primitives) append_mesh(*file, p.data, p.name, {});
  return GltfDocument(std::move(file));
}

}  // namespace darboux
