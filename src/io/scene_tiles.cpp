#include "scene_tiles.h"

#include <cmath>
#include <span>

#include <darboux/error.h>

#include "base/text.h"
#include "gltf_file.h"

namespace darboux::io {
namespace {

// An attribute of a tile as floats, with its least and greatest.
struct TileFloats {
  std::vector<float> values;
  std::vector<float> least, greatest;

  TileFloats(const TileSamples& tile, Attribute a) {
    const std::size_t n = info_of(a).components;
    values.reserve(n * tile.size());
    for (std::size_t i = 0; i < tile.size(); ++i)
      for (const double x : tile(a, i)) values.push_back(static_cast<float>(x));
    for (std::size_t i = 0; i < values.size(); ++i) {
      if (i < n) {
        least.push_back(values[i]);
        greatest.push_back(values[i]);
      }
      least[i % n] = std::fmin(least[i % n], values[i]);
      greatest[i % n] = std::fmax(greatest[i % n], values[i]);
    }
  }
};

std::size_t append_tile_floats(GltfFile& file, const std::vector<float>& values, std::size_t components) {
  std::string bytes(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(float));
  return file.append_accessor(
      {{"bufferView", file.append_view(Piece::of(std::move(bytes)), 0, vertex_target)},
       {"componentType", component_f32},
       {"count", values.size() / components},
       {"type", "VEC" + std::to_string(components)}});
}

}  // namespace

SceneTiles::SceneTiles(const std::string& path, const Scene& scene, std::vector<std::string> surface_names)
    : scene_(scene), surface_names_(std::move(surface_names)), file_(std::make_unique<GltfFile>()) {
  file_->path = path;
  file_->json = {{"asset", {{"version", "2.0"}, {"generator", "Darboux"}}},
                 {"scene", 0},
                 {"scenes", Json::array({Json::object()})}};
}

SceneTiles::~SceneTiles() = default;

std::size_t SceneTiles::material(std::uint32_t index) {
  const auto [found, is_new] = materials_.emplace(index, materials_.size());
  if (is_new) {
    const SceneMaterial& m = scene_.materials[index];
    Json json = Json::object();
    if (!m.name.empty()) json["name"] = m.name;
    if (m.double_sided) json["doubleSided"] = true;
    if (m.see_through) json["alphaMode"] = "BLEND";
    file_->json["materials"].push_back(std::move(json));
  }
  return found->second;
}

void SceneTiles::add(const TileSamples& tile) {
  if (tile.tiles().empty() || tile.triangles().empty()) return;
  const ScenePatch& patch = tile.patch();
  const std::string name = surface_names_[patch.surface] + " " + std::to_string(patch.column) + "," +
                           std::to_string(patch.row) + " of " + std::to_string(1u << patch.level_u) + "x" +
                           std::to_string(1u << patch.level_v);
  const TileFloats positions(tile, Attribute::position);
  for (const float x : positions.values)
    if (!std::isfinite(x))
      throw MeshError("tile " + name, "position: " + expected_got("finite floats", shortest(double{x})));
  Json attributes;
  const std::size_t position = append_tile_floats(*file_, positions.values, 3);
  file_->json["accessors"][position]["min"] = positions.least;
  file_->json["accessors"][position]["max"] = positions.greatest;
  attributes["POSITION"] = position;
  if (patch.attributes.has(Attribute::normal))
    attributes["NORMAL"] = append_tile_floats(*file_, TileFloats(tile, Attribute::normal).values, 3);
  if (patch.attributes.has(Attribute::tangent4))
    attributes["TANGENT"] = append_tile_floats(*file_, TileFloats(tile, Attribute::tangent4).values, 4);
  std::vector<float> uvs;
  for (std::size_t i = 0; i < tile.size(); ++i)
    for (const double x : {tile.uv(i).x, tile.uv(i).y}) uvs.push_back(static_cast<float>(x));
  attributes["TEXCOORD_0"] = append_tile_floats(*file_, uvs, 2);
  const std::size_t indices = file_->append_indices(tile.triangles());

  std::map<std::uint32_t, std::size_t> meshes;  // by material
  for (const PlannedTile& planned : tile.tiles()) {
    const SceneInstance& instance = scene_.instances[planned.instance];
    const auto [mesh, is_new] = meshes.emplace(
        instance.material, file_->json.contains("meshes") ? file_->json["meshes"].size() : std::size_t{0});
    if (is_new)
      file_->json["meshes"].push_back(
          {{"name", name},
           {"primitives", Json::array({{{"attributes", attributes},
                                        {"indices", indices},
                                        {"material", material(instance.material)}}})}});
    Json node{{"mesh", mesh->second}, {"name", "instance " + std::to_string(planned.instance)}};
    const Eigen::Matrix4d m = instance.placement.matrix();
    if (m != Eigen::Matrix4d::Identity())
      node["matrix"] = std::vector<double>(m.data(), m.data() + 16);  // by columns
    file_->json["scenes"][0]["nodes"].push_back(file_->json.contains("nodes") ? file_->json["nodes"].size()
                                                                              : std::size_t{0});
    file_->json["nodes"].push_back(std::move(node));
  }
}

std::string SceneTiles::to_glb() const {
  return file_->to_glb();
}

}  // namespace darboux::io
