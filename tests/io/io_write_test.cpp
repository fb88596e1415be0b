// glTF files that are written or rewritten: what was there is kept, what is new is read by a second reader.
#include <bit>
#include <cmath>
#include <limits>

#include <Eigen/LU>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <darboux/error.h>
#include <darboux/io.h>

#include "io_files.h"
#include "second_reader.h"

namespace darboux::io_write_test {
namespace {

using namespace test;
using Triangles = std::vector<Triangle>;

const std::string data = DARBOUX_TEST_DATA "/";
const std::string shared = DARBOUX_SHARED "/";
const float nan_f = std::numeric_limits<float>::quiet_NaN();
const float inf_f = std::numeric_limits<float>::infinity();

TEST(Rewrite, AGltfBecomesASelfContainedGlb) {
  const TempFolder folder, elsewhere;
  Builder b = one_triangle();
  // The normals live in a second file, an image in a third, and one image is missing.
  const std::string normals = test::pack<float>({0, 0, 1, 0, 0, 1, 0, 0, 1});
  b.json["buffers"][0]["uri"] = "first.bin";
  b.json["buffers"].push_back({{"byteLength", 36}, {"uri", "second.bin"}, {"name", "kept"}});
  b.json["bufferViews"].push_back({{"buffer", 1}, {"byteLength", 36}});
  b.json["meshes"][0]["primitives"][0]["attributes"]["NORMAL"] =
      b.accessor("VEC3", 5126, 3, {{"bufferView", 1}});
  b.json["images"] =
      Json::parse(R"([{"uri": "a.png"}, {"uri": "missing.png"}, {"uri": "https://example.org/a.png"}])");
  test::write_bytes(folder / "first.bin", b.bin + "longer than stated");
  test::write_bytes(folder / "second.bin", normals);
  test::write_bytes(folder / "a.png", "\x89PNG\r\n\x1A\nrest");
  const std::string source = test::write_bytes(folder / "scene.gltf", b.json.dump());

  GltfDocument document = GltfDocument::load(source);
  const std::vector<Vec4<float>> tangents(3, {1, 0, 0, -1});
  document.set_tangents(0, 0, tangents);
  const std::vector<std::string> kept = document.save_glb(elsewhere / "scene.glb");
  ASSERT_EQ(kept.size(), 2u);
  EXPECT_NE(kept[0].find("missing.png"), std::string::npos) << kept[0];
  EXPECT_NE(kept[1].find("images[2]"), std::string::npos) << kept[1];
  const test::Glb glb = test::split_glb(test::read_bytes(elsewhere / "scene.glb"));
  EXPECT_FALSE(glb.json["buffers"][0].contains("uri"));
  EXPECT_TRUE(glb.bin.starts_with(b.bin + "longer than stated"));
  EXPECT_TRUE(
      glb.json["buffers"][1]["uri"].get<std::string>().starts_with("data:application/octet-stream;base64,"));
  EXPECT_EQ(glb.json["buffers"][1]["name"], "kept");
  EXPECT_EQ(glb.json["images"][0]["uri"], "data:image/png;base64,iVBORw0KGgpyZXN0");  // by Python's base64
  EXPECT_EQ(glb.json["images"][1]["uri"], "missing.png");
  EXPECT_EQ(glb.json["images"][2]["uri"], "https://example.org/a.png");
  const Mesh mesh = read_asset(elsewhere / "scene.glb").primitives.at(0).data;
  EXPECT_EQ(mesh.normals, (std::vector<Vec3<double>>(3, {0, 0, 1})));
  EXPECT_EQ(mesh.tangents, (std::vector<Vec4<double>>(3, {1, 0, 0, -1})));
}

// Whatever the names say. What is no image stays where it is.
TEST(Rewrite, ImagesAreToldByTheirFirstBytes) {
  const TempFolder folder;
  Builder b = one_triangle();
  b.json["images"] = Json::parse(
      R"([{"uri": "a.png"}, {"uri": "b.png"}, {"uri": "c.png"}, {"uri": "d.png"}, {"uri": "e.png"}])");
  test::write_bytes(folder / "a.png", "\xFF\xD8\xFFrest");
  test::write_bytes(folder / "b.png", "RIFFsizeWEBPrest");
  test::write_bytes(folder / "c.png", "\xABKTX 20\xBBrest");
  test::write_bytes(folder / "d.png", "RIFFsizeWAVErest");
  test::write_bytes(folder / "e.png", "");
  b.json["buffers"][0]["uri"] = "first.bin";
  test::write_bytes(folder / "first.bin", b.bin);
  GltfDocument document = GltfDocument::load(test::write_bytes(folder / "scene.gltf", b.json.dump()));
  document.set_tangents(0, 0, std::vector<Vec4<float>>(3, {1, 0, 0, -1}));
  const std::vector<std::string> kept = document.save_glb(folder / "scene.glb");
  ASSERT_EQ(kept.size(), 2u);
  EXPECT_TRUE(kept[0].starts_with("images[3] keeps its URI 'd.png'")) << kept[0];
  EXPECT_TRUE(kept[1].starts_with("images[4] keeps its URI 'e.png'")) << kept[1];
  const Json images = test::split_glb(test::read_bytes(folder / "scene.glb")).json["images"];
  // By Python's base64.
  EXPECT_EQ(images[0]["uri"], "data:image/jpeg;base64,/9j/cmVzdA==");
  EXPECT_EQ(images[1]["uri"], "data:image/webp;base64,UklGRnNpemVXRUJQcmVzdA==");
  EXPECT_EQ(images[2]["uri"], "data:image/ktx2;base64,q0tUWCAyMLtyZXN0");
  EXPECT_EQ(images[3]["uri"], "d.png");
  EXPECT_EQ(images[4]["uri"], "e.png");
}

// ---- rewriting

TEST(Rewrite, TangentsAreAppendedAndAllElseIsKept) {
  const TempFolder folder;
  Builder b = one_triangle();
  b.bin += "xy";  // a chunk whose end is no multiple of 4 until it is padded
  b.json["extras"] = Json::parse(
      R"({"z": 0.1, "a": [1e-310, 5e-324, 1.7976931348623157e308, -0.0, 0.30000000000000004, 3.0, null, true],
          "big": 9007199254740993, "biggest": 18446744073709551615, "negative": -9223372036854775808,
          "text": "ä\u0001\"\\"})");
  b.json["accessors"][0]["unknown"] = {{"nested", {1, 2, 3}}};
  b.json["meshes"][0]["primitives"][0]["extras"] = nullptr;
  b.json["zzz unknown"] = "kept";
  const std::string before_bytes = b.glb() + test::pack<std::uint32_t>({4, 0x21212121}) + "more";
  std::string source_bytes = before_bytes;
  const auto length = static_cast<std::uint32_t>(source_bytes.size());
  std::memcpy(source_bytes.data() + 8, &length, 4);
  const std::string source = test::write_bytes(folder / "in.glb", source_bytes);

  GltfDocument document = GltfDocument::load(source);
  document.save_glb(folder / "same.glb");
  const std::vector<Vec4<float>> tangents = {{1, 0, 0, 1}, {nan_f, inf_f, -0.0f, -1}, {0.1f, 0.2f, 0.3f, 1}};
  document.set_tangents(0, 0, tangents);
  EXPECT_EQ(document.asset().primitives.at(0).data.tangents.size(), 3u);
  document.save_glb(folder / "out.glb");

  // Rewritten without edits: the same values in the same order, the same bytes.
  const test::Glb before = test::split_glb(source_bytes),
                  same = test::split_glb(test::read_bytes(folder / "same.glb"));
  EXPECT_EQ(before.json.dump(), same.json.dump());
  EXPECT_EQ(before.bin, same.bin);
  EXPECT_TRUE(test::read_bytes(folder / "same.glb").ends_with("!!!!more"));

  const std::string out_bytes = test::read_bytes(folder / "out.glb");
  EXPECT_TRUE(out_bytes.ends_with("!!!!more"));
  test::Glb after = test::split_glb(out_bytes);
  EXPECT_TRUE(after.bin.starts_with(before.bin));
  EXPECT_EQ(after.json["buffers"][0]["byteLength"], after.bin.size());
  const std::string stored(reinterpret_cast<const char*>(tangents.data()), 48);
  const Json view = after.json["bufferViews"].back(), accessor = after.json["accessors"].back();
  EXPECT_EQ(after.bin.substr(view["byteOffset"], view["byteLength"]), stored);
  EXPECT_EQ(view["byteOffset"].get<std::size_t>() % 4, 0u);
  EXPECT_EQ(accessor["type"], "VEC4");
  EXPECT_EQ(accessor["componentType"], 5126);
  EXPECT_EQ(after.json["meshes"][0]["primitives"][0]["attributes"]["TANGENT"],
            after.json["accessors"].size() - 1);
  // With the additions taken off again the document is the old one.
  after.json["bufferViews"].erase(after.json["bufferViews"].size() - 1);
  after.json["accessors"].erase(after.json["accessors"].size() - 1);
  after.json["meshes"][0]["primitives"][0]["attributes"].erase("TANGENT");
  after.json["buffers"][0]["byteLength"] = before.json["buffers"][0]["byteLength"];
  EXPECT_EQ(after.json.dump(), before.json.dump());
  const double tiny = after.json["extras"]["a"][0];
  EXPECT_EQ(std::bit_cast<std::uint64_t>(tiny), std::bit_cast<std::uint64_t>(1e-310));
}

TEST(Rewrite, NoVariantHidesTheColours) {
  const TempFolder folder;
  Builder b = one_triangle();
  b.json["materials"] = Json::parse("[{}]");
  b.json["extensionsUsed"] = {"KHR_materials_variants"};
  b.json["extensions"]["KHR_materials_variants"]["variants"] = {{{"name", "red"}}};
  b.json["meshes"][0]["primitives"][0]["extensions"] = Json::parse(
      R"({"KHR_materials_variants": {"mappings": [{"material": 0, "variants": [0]}]}, "OTHER_one": {}})");
  GltfDocument document = GltfDocument::load(test::write_bytes(folder / "in.glb", b.glb()));
  document.set_colours(0, 0, std::vector<Vec3<float>>(3, {1, 0, 0}), "{}");
  document.save_glb(folder / "out.glb");
  const Json json = test::split_glb(test::read_bytes(folder / "out.glb")).json;
  EXPECT_EQ(json["meshes"][0]["primitives"][0]["extensions"].dump(), R"({"OTHER_one":{}})");
  EXPECT_EQ(json["meshes"][0]["primitives"][0]["material"], 1);
}

TEST(Rewrite, ReplacedTangentsAreReadByTheSecondReader) {
  const TempFolder folder;
  for (const char* name : {"torus_016.three.glb", "torus_016.none.glb", "cylinder_016.three.glb"}) {
    GltfDocument document = GltfDocument::load(data + name);
    const Mesh mesh = document.asset().primitives.at(0).data;
    std::vector<Vec4<float>> tangents(mesh.positions.size());
    for (std::size_t i = 0; i < tangents.size(); ++i)
      tangents[i] = {static_cast<float>(mesh.normals[i].y), 0.1f, static_cast<float>(i),
                     i % 2 == 0 ? 1.0f : -1.0f};
    document.set_tangents(0, 0, tangents);
    document.save_glb(folder / "out.glb");
    expect_second_reader_agrees(folder / "out.glb");
    const Mesh after = read_asset(folder / "out.glb").primitives.at(0).data;
    ASSERT_EQ(after.tangents.size(), tangents.size());
    for (std::size_t i = 0; i < tangents.size(); ++i)
      EXPECT_EQ(after.tangents[i],
                (Vec4<double>{tangents[i].x, tangents[i].y, tangents[i].z, tangents[i].w}));
    EXPECT_EQ(after.positions, mesh.positions);
    EXPECT_EQ(after.triangles, mesh.triangles);
    const test::Glb old_glb = test::split_glb(test::read_bytes(data + name));
    EXPECT_TRUE(test::split_glb(test::read_bytes(folder / "out.glb")).bin.starts_with(old_glb.bin));
  }
}

TEST(Rewrite, RemapCopiesEveryAttributeBitForBit) {
  const TempFolder folder;
  Builder b;
  const auto position = b.positions({0, 0, 0, 1, 0, nan_f, 1, 1, -0.0f, 0, 9, 0});
  b.json["accessors"][position]["min"] = {0, 0, 0};
  b.json["accessors"][position]["max"] = {1, 9, 0};
  // VEC3 of bytes is 3 bytes long: interleaved at 4 before, and at 4 after.
  const auto color_view = b.view(
      test::pack<std::uint8_t>({1, 2, 3, 99, 4, 5, 6, 99, 7, 8, 9, 99, 10, 11, 12, 99}), {{"byteStride", 4}});
  const auto color = b.accessor(
      "VEC3", 5121, 4,
      {{"bufferView", color_view}, {"normalized", true}, {"max", {10, 11, 12}}, {"min", {1, 2, 3}}});
  const auto joint =
      b.packed<std::uint16_t>("VEC4", 5123, 4, {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15});
  const auto custom = b.packed<std::int8_t>("SCALAR", 5120, 4, {-1, -2, -3, -4}, {{"extras", "kept"}});
  const auto sparse_indices = b.view(test::pack<std::uint8_t>({2}));
  const auto sparse_values = b.view(test::pack<float>({7, 8, 9}));
  const auto morph = b.accessor("VEC3", 5126, 4,
                                {{"sparse",
                                  {{"count", 1},
                                   {"indices", {{"bufferView", sparse_indices}, {"componentType", 5121}}},
                                   {"values", {{"bufferView", sparse_values}}}}}});
  b.primitive({{"POSITION", position}, {"COLOR_0", color}, {"JOINTS_0", joint}, {"_CUSTOM", custom}},
              {{"mode", 5}, {"targets", {{{"POSITION", morph}, {"NORMAL", morph}}}}});
  b.primitive({{"POSITION", position}, {"COLOR_0", color}}, {{"mode", 6}});
  const std::string source = test::write_bytes(folder / "in.glb", b.glb());

  GltfDocument document = GltfDocument::load(source);
  const Mesh untouched = document.asset().primitives.at(1).data;
  const std::vector<std::uint32_t> order = {2, 1, 0, 2, 2}, indices = {0, 1, 2, 3, 2, 4};
  document.remap_vertices(0, 0, order, indices);
  document.save_glb(folder / "out.glb");

  const Asset asset = read_asset(folder / "out.glb");
  const Mesh& mesh = asset.primitives.at(0).data;
  EXPECT_EQ(mesh.triangles, (Triangles{{0, 1, 2}, {3, 2, 4}}));
  EXPECT_EQ(own_bits(mesh, "POSITION", 0),
            (std::vector<std::uint32_t>{bits(1), bits(1), bits(-0.0f), bits(1), 0, bits(nan_f), 0, 0, 0,
                                        bits(1), bits(1), bits(-0.0f), bits(1), bits(1), bits(-0.0f)}));
  EXPECT_EQ(own_bits(asset.primitives.at(1).data, "POSITION", 0), own_bits(untouched, "POSITION", 0));
  EXPECT_EQ(asset.primitives.at(1).data.triangles, untouched.triangles);

  const test::Glb before = test::split_glb(test::read_bytes(source)),
                  glb = test::split_glb(test::read_bytes(folder / "out.glb"));
  EXPECT_TRUE(glb.bin.starts_with(before.bin));
  EXPECT_EQ(glb.json["meshes"][0]["primitives"][1], before.json["meshes"][0]["primitives"][1]);
  const Json& primitive = glb.json["meshes"][0]["primitives"][0];
  EXPECT_EQ(primitive["mode"], 4);
  const auto accessor = [&](const Json& attributes, const char* name) {
    return glb.json["accessors"].at(attributes.at(name).get<std::size_t>());
  };
  const auto bytes = [&](const Json& a) {
    const Json& view = glb.json["bufferViews"][a["bufferView"].get<std::size_t>()];
    EXPECT_FALSE(a.contains("byteOffset") || a.contains("sparse"));
    EXPECT_EQ(a["count"], 5);
    return glb.bin.substr(view["byteOffset"], view["byteLength"]);
  };
  const Json& attributes = primitive["attributes"];
  // Vertex 3, with its y of 9, is gone: the bounds follow. NaN has no part in them.
  EXPECT_EQ(accessor(attributes, "POSITION")["max"], Json({1, 1, 0}));
  EXPECT_EQ(accessor(attributes, "POSITION")["min"], Json({0, 0, 0}));
  EXPECT_EQ(bytes(accessor(attributes, "COLOR_0")),
            test::pack<std::uint8_t>({7, 8, 9, 0, 4, 5, 6, 0, 1, 2, 3, 0, 7, 8, 9, 0, 7, 8, 9, 0}));
  EXPECT_EQ(accessor(attributes, "COLOR_0")["max"], Json({7, 8, 9}));
  EXPECT_EQ(accessor(attributes, "COLOR_0")["normalized"], true);
  EXPECT_EQ(bytes(accessor(attributes, "JOINTS_0")),
            test::pack<std::uint16_t>({8, 9, 10, 11, 4, 5, 6, 7, 0, 1, 2, 3, 8, 9, 10, 11, 8, 9, 10, 11}));
  EXPECT_EQ(accessor(attributes, "_CUSTOM")["extras"], "kept");
  EXPECT_FALSE(accessor(attributes, "_CUSTOM").contains("min"));
  EXPECT_EQ(bytes(accessor(attributes, "_CUSTOM")),
            test::pack<std::int8_t>({-3, 0, 0, 0, -2, 0, 0, 0, -1, 0, 0, 0, -3, 0, 0, 0, -3, 0, 0, 0}));
  EXPECT_EQ(bytes(accessor(primitive["targets"][0], "POSITION")),
            test::pack<float>({7, 8, 9, 0, 0, 0, 0, 0, 0, 7, 8, 9, 7, 8, 9}));
  EXPECT_EQ(primitive["targets"][0]["POSITION"], primitive["targets"][0]["NORMAL"]);
}

TEST(Rewrite, RemapAndTangentsOnARealFile) {
  const TempFolder folder;
  GltfDocument document = GltfDocument::load(data + "torus_016.three.glb");
  const Mesh before = document.asset().primitives.at(0).data;
  std::vector<std::uint32_t> source, indices;  // one vertex per corner
  for (const Triangle& t : before.triangles) source.insert(source.end(), t.begin(), t.end());
  for (std::uint32_t i = 0; i < source.size(); ++i) indices.push_back(i);
  document.remap_vertices(0, 0, source, indices);
  document.set_tangents(0, 0, std::vector<Vec4<float>>(source.size(), {0, 0, 1, -1}));
  document.save_glb(folder / "out.glb");
  expect_second_reader_agrees(folder / "out.glb");
  const Mesh after = read_asset(folder / "out.glb").primitives.at(0).data;
  ASSERT_EQ(after.positions.size(), source.size());
  for (std::size_t i = 0; i < source.size(); ++i) {
    EXPECT_EQ(after.positions[i], before.positions[source[i]]);
    EXPECT_EQ(after.normals[i], before.normals[source[i]]);
    EXPECT_EQ(after.uvs[i], before.uvs[source[i]]);
  }
}

TEST(Rewrite, ArgumentsThatDoNotFitAreRefusedAndChangeNothing) {
  const TempFolder folder;
  GltfDocument document = GltfDocument::load(data + "torus_016.none.glb");
  document.save_glb(folder / "before.glb");
  const std::vector<Vec4<float>> few(3);
  const std::vector<std::uint32_t> good = {0, 1, 2}, past_end = {0, 1, 561}, pair = {0, 1},
                                   past_source = {0, 1, 3};
  EXPECT_THROW(document.set_tangents(0, 0, few), MeshError);
  EXPECT_THROW(document.set_tangents(0, 1, few), MeshError);
  EXPECT_THROW(document.set_tangents(1, 0, few), MeshError);
  EXPECT_THROW(document.remap_vertices(0, 0, past_end, good), MeshError);
  EXPECT_THROW(document.remap_vertices(0, 0, good, past_source), MeshError);
  EXPECT_THROW(document.remap_vertices(0, 0, good, pair), MeshError);
  EXPECT_THROW(document.remap_vertices(0, 0, {}, {}), MeshError);
  EXPECT_THROW(document.remap_vertices(5, 0, good, good), MeshError);
  document.save_glb(folder / "after.glb");
  EXPECT_EQ(test::read_bytes(folder / "before.glb"), test::read_bytes(folder / "after.glb"));
}

// ---- writing a mesh

Mesh small_mesh() {
  Mesh mesh;
  mesh.positions = {{0.1, -2, 0}, {1, 1e-50, 3}, {1.0 / 3, 5, -1}, {0, 0, 0}};
  mesh.normals = {{0, 0, 1}, {0, 1, 0}, {1, 0, 0}, {0.6, 0.8, 0}};
  mesh.uvs = {{0, 0}, {1, 0}, {0, 1}, {0.7, 0.3}};
  mesh.tangents = {{1, 0, 0, 1}, {1, 0, 0, -1}, {0, 1, 0, 1}, {nan_f, 0, 0, -1}};
  mesh.triangles = {{0, 1, 2}, {2, 1, 3}};
  return mesh;
}

TEST(WriteGlb, BothReadersGetTheFloats) {
  const TempFolder folder;
  const std::string path = folder / "mesh.glb";
  const Mesh mesh = small_mesh();
  write_glb(path, mesh, "small", R"({"surface": {"name": "torus", "major_radius": 0.1}})");
  expect_second_reader_agrees(path);
  const Asset asset = read_asset(path);
  const Primitive& primitive = asset.primitives.at(0);
  EXPECT_EQ(primitive.name, "small");
  EXPECT_EQ(primitive.instances.size(), 1u);
  EXPECT_EQ(primitive.data.triangles, mesh.triangles);
  for (const char* attribute : {"POSITION", "NORMAL", "TEXCOORD_0", "TANGENT"})
    EXPECT_EQ(own_bits(primitive.data, attribute, 0), own_bits(mesh, attribute, 0)) << attribute;
  const test::Glb glb = test::split_glb(test::read_bytes(path));
  EXPECT_EQ(glb.json["meshes"][0]["extras"]["surface"]["major_radius"], 0.1);
  const Json& position =
      glb.json["accessors"]
              [glb.json["meshes"][0]["primitives"][0]["attributes"]["POSITION"].get<std::size_t>()];
  EXPECT_EQ(position["min"], Json({0, -2, -1}));
  EXPECT_EQ(position["max"], Json({1, 5, 3}));
  for (const Json& view : glb.json["bufferViews"]) EXPECT_EQ(view["byteOffset"].get<std::size_t>() % 4, 0u);
  EXPECT_EQ(glb.json["buffers"][0]["byteLength"], glb.bin.size());
}

TEST(WriteGlb, OnlyTheAttributesThereAre) {
  const TempFolder folder;
  Mesh mesh = small_mesh();
  mesh.normals.clear();
  mesh.uvs.clear();
  mesh.tangents.clear();
  write_glb(folder / "mesh.glb", mesh, "");
  const Json json = test::split_glb(test::read_bytes(folder / "mesh.glb")).json;
  EXPECT_EQ(json["meshes"][0]["primitives"][0]["attributes"].size(), 1u);
  EXPECT_FALSE(json["meshes"][0].contains("name"));
  EXPECT_FALSE(json["meshes"][0].contains("extras"));
  expect_second_reader_agrees(folder / "mesh.glb");
}

TEST(WriteGlb, SixteenBitsWhereTheySuffice) {
  const TempFolder folder;
  for (const std::uint32_t largest : {65534u, 65535u, 65536u}) {
    Mesh mesh;
    mesh.positions.resize(largest + 1);
    mesh.positions.back() = {1, 2, 3};
    mesh.triangles = {{0, 1, largest}};
    write_glb(folder / "mesh.glb", mesh, "large");
    const Json json = test::split_glb(test::read_bytes(folder / "mesh.glb")).json;
    EXPECT_EQ(json["accessors"].back()["componentType"], largest < 65535 ? 5123 : 5125) << largest;
    EXPECT_EQ(read_asset(folder / "mesh.glb").primitives.at(0).data.triangles, mesh.triangles);
    expect_second_reader_agrees(folder / "mesh.glb");
  }
}

TEST(WriteGlb, WhatCannotBeWrittenIsRefused) {
  const TempFolder folder;
  const std::string path = folder / "mesh.glb";
  Mesh mesh = small_mesh();
  EXPECT_THROW(write_glb(path, mesh, "m", "[1]"), ParameterError);
  EXPECT_THROW(write_glb(path, mesh, "m", "{"), ParameterError);
  EXPECT_THROW(write_glb(path, mesh, "m", "{\"a\": \"\xFF\"}"), ParameterError);
  for (const double bad : {double{nan_f}, double{inf_f}, 1e39}) {
    mesh.positions[1].y = bad;
    EXPECT_THROW(write_glb(path, mesh, "m"), MeshError) << bad;
  }
  mesh = small_mesh();
  mesh.normals.pop_back();
  EXPECT_THROW(write_glb(path, mesh, "m"), MeshError);
  mesh = small_mesh();
  mesh.triangles[0][1] = 4;
  EXPECT_THROW(write_glb(path, mesh, "m"), MeshError);
  mesh.triangles.clear();
  EXPECT_THROW(write_glb(path, mesh, "m"), MeshError);
  EXPECT_THROW(write_glb(path, Mesh{}, "m"), MeshError);
  EXPECT_THROW(write_glb("/dev/full", small_mesh(), "m"), FileError);
  EXPECT_EQ(folder.files(), 0u);
}

TEST(WriteGlb, ANameThatIsNotUtf8IsReplaced) {
  const TempFolder folder;
  write_glb(folder / "mesh.glb", small_mesh(), "bad \xFF name");
  EXPECT_EQ(read_asset(folder / "mesh.glb").primitives.at(0).name, "bad \xEF\xBF\xBD name");
}

}  // namespace
}  // namespace darboux::io_write_test
