/// \file generated_gltf.h
/// A glTF with everything that rewriting meshes must cope with: morph targets; quantised, sparse, interleaved
/// and shared accessors; a skin; an animation; a mirror fold at vertices.
#pragma once

#include "io_files.h"

namespace darboux::test {

/// The base's numbers, for tests that compute tangents on their own.
struct GeneratedMesh {
  static constexpr std::size_t vertices = 9;
  /// As stored: 16-bit, normalised; uvs unsigned.
  static constexpr std::int16_t positions[9][3] = {
      {-16384, -16384, 0}, {0, -16384, 900}, {16384, -16384, 0},  //
      {-16384, 0, 300},    {0, 0, 1200},     {16384, 0, 200},     //
      {-16384, 16384, 0},  {0, 16384, 1000}, {16384, 16384, 0}};
  static constexpr std::int16_t normals[3][3] = {
      {-9175, 0, 31456}, {0, 0, 32767}, {9175, 0, 31456}};  // a column
  static constexpr std::uint16_t us[3] = {60000, 0, 60000},
                                 vs[3] = {0, 30000, 65535};  // folded in the middle
  static constexpr std::uint16_t indices[24] = {0, 1, 4, 0, 4, 3, 1, 2, 5, 1, 5, 4,
                                                3, 4, 7, 3, 7, 6, 4, 5, 8, 4, 8, 7};
  static constexpr std::uint16_t few[6] = {4, 5, 8, 4, 8, 7}, strip[6] = {0, 1, 3, 4, 6, 7};
  /// What target 0 adds to positions at vertices 1 and 4, and target 1 to normals, everywhere.
  static constexpr float moved[2][3] = {{0.25f, 0, 0.25f}, {0, 0.125f, 0.5f}}, turned[3] = {0.25f, 0.5f, 0};
};

/// Images, materials, nodes, a skin, and an animation from the accessors `times` and `weights`: what a
/// rewritten file has to keep.
inline void add_surroundings(Builder& b, const Json& times, const Json& weights) {
  b.json.update(Json::parse(R"({
    "images": [{"uri": "data:image/png;base64,iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAYAAAAfFcSJAAAADUlEQVR42mNk+M9QDwADhgGAWjR9awAAAABJRU5ErkJggg=="}],
    "textures": [{"source": 0}],
    "materials": [{"normalTexture": {"index": 0}}, {"name": "plain", "extras": {"tiny": 1e-310}}],
    "nodes": [{"mesh": 0, "skin": 0, "weights": [0.1, 0.30000000000000004]}, {"mesh": 1}, {"name": "joint"}],
    "skins": [{"joints": [2]}], "scenes": [{"nodes": [0, 1, 2]}], "scene": 0})"));
  b.json["animations"] =
      Json::array({{{"samplers", {{{"input", times}, {"output", weights}}}},
                    {"channels", {{{"sampler", 0}, {"target", {{"node", 0}, {"path", "weights"}}}}}}}});
}

/// Mesh 0 has two primitives over the same accessors, with two targets each; mesh 1 a strip over them without
/// targets.
inline Builder generated_gltf() {
  using M = GeneratedMesh;
  Builder b;
  const Json vertex_target = {{"target", 34962}}, index_target = {{"target", 34963}};
  std::string interleaved;  // position, 2 bytes left out, normal, 2 bytes left out, uv: 20 bytes per vertex
  for (std::size_t i = 0; i < M::vertices; ++i) {
    const auto* p = M::positions[i];
    const auto* n = M::normals[i % 3];
    interleaved += pack<std::int16_t>({p[0], p[1], p[2], 77, n[0], n[1], n[2], 77}) +
                   pack<std::uint16_t>({M::us[i % 3], M::vs[i / 3]});
  }
  const auto vertex_view = b.view(interleaved, {{"byteStride", 20}, {"target", 34962}});
  const auto position = b.accessor("VEC3", 5122, 9,
                                   {{"bufferView", vertex_view},
                                    {"normalized", true},
                                    {"min", {-16384, -16384, 0}},
                                    {"max", {16384, 16384, 1200}}});
  const auto normal =
      b.accessor("VEC3", 5122, 9, {{"bufferView", vertex_view}, {"byteOffset", 8}, {"normalized", true}});
  const auto uv =
      b.accessor("VEC2", 5123, 9, {{"bufferView", vertex_view}, {"byteOffset", 16}, {"normalized", true}});
  std::string color, joint, weight, id, turned;
  for (std::uint8_t i = 0; i < 9; ++i) {
    color += pack<std::uint8_t>({i, 2, 3, 255});
    joint += pack<std::uint8_t>({0, 0, 0, 0});
    weight += pack<std::uint8_t>({255, 0, 0, 0});
    id += pack<float>({i * 0.1f});
    turned += pack<float>({M::turned[0], M::turned[1], M::turned[2]});
  }
  const auto attribute = [&](const std::string& bytes, const char* type, int component_type, Json more) {
    more["bufferView"] = b.view(bytes, vertex_target);
    return b.accessor(type, component_type, 9, more);
  };
  const auto color_accessor = attribute(color, "VEC4", 5121, {{"normalized", true}, {"extras", "kept"}});
  const auto joint_accessor = attribute(joint, "VEC4", 5121, Json::object());
  const auto weight_accessor = attribute(weight, "VEC4", 5121, {{"normalized", true}});
  const auto id_accessor = attribute(id, "SCALAR", 5126, Json::object());
  const auto turned_accessor = attribute(turned, "VEC3", 5126, Json::object());
  const auto places = b.view(pack<std::uint8_t>({1, 4}));
  const auto moves = b.view(pack<float>(
      {M::moved[0][0], M::moved[0][1], M::moved[0][2], M::moved[1][0], M::moved[1][1], M::moved[1][2]}));
  const auto moved_accessor = b.accessor("VEC3", 5126, 9,
                                         {{"min", {0, 0, 0}},
                                          {"max", {0.25, 0.125, 0.5}},
                                          {"sparse",
                                           {{"count", 2},
                                            {"indices", {{"bufferView", places}, {"componentType", 5121}}},
                                            {"values", {{"bufferView", moves}}}}}});
  const auto index_accessor = [&](auto& list) {
    std::string bytes;
    for (const std::uint16_t i : list) bytes += pack({i});
    return b.accessor("SCALAR", 5123, std::size(list), {{"bufferView", b.view(bytes, index_target)}});
  };
  const auto all = index_accessor(M::indices), few = index_accessor(M::few), strip = index_accessor(M::strip);
  const auto times = b.packed<float>("SCALAR", 5126, 2, {0, 1}, {{"min", {0}}, {"max", {1}}});
  const auto weights = b.packed<float>("SCALAR", 5126, 4, {0, 1, 1, 0});

  const Json attributes = {{"POSITION", position},       {"NORMAL", normal},
                           {"TEXCOORD_0", uv},           {"COLOR_0", color_accessor},
                           {"JOINTS_0", joint_accessor}, {"WEIGHTS_0", weight_accessor},
                           {"_ID", id_accessor}};
  const Json targets = {{{"POSITION", moved_accessor}}, {{"NORMAL", turned_accessor}}};
  b.primitive(
      attributes,
      {{"indices", all}, {"mode", 4}, {"material", 0}, {"targets", targets}, {"extras", {{"a", 0.1}}}});
  b.primitive(attributes, {{"indices", few}, {"material", 1}, {"targets", targets}});
  b.json["meshes"].push_back(
      {{"primitives",
        {{{"attributes", {{"POSITION", position}, {"NORMAL", normal}, {"TEXCOORD_0", uv}}},
          {"indices", strip},
          {"mode", 5}}}}});
  b.json["extensionsUsed"] = {"KHR_mesh_quantization"};
  b.json["extensionsRequired"] = {"KHR_mesh_quantization"};
  add_surroundings(b, times, weights);
  return b;
}

}  // namespace darboux::test
