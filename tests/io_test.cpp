// Files: what is read, what is written, and that a second reader agrees bit for bit.
#include <bit>
#include <cmath>
#include <limits>

#include <Eigen/LU>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <darboux/io.h>

#define TINYGLTF_NO_INCLUDE_JSON
#include <tiny_gltf.h>

#include <darboux/error.h>

#include "io_files.h"

namespace darboux {
namespace {

using test::Builder;
using test::Json;
using test::TempFolder;
using Triangles = std::vector<Triangle>;

const std::string data = DARBOUX_TEST_DATA "/";
const std::string shared = DARBOUX_SHARED "/";
const float nan_f = std::numeric_limits<float>::quiet_NaN();
const float inf_f = std::numeric_limits<float>::infinity();

std::uint32_t bits(double x) {
  return std::bit_cast<std::uint32_t>(static_cast<float>(x));
}

Asset read(const Builder& builder) {
  const TempFolder folder;
  return read_asset(test::write_bytes(folder / "made.glb", builder.glb()));
}

// ---- the second reader

bool ignore_image(tinygltf::Image*, const int, std::string*, std::string*, int, int, const unsigned char*,
                  int, void*) {
  return true;
}

tinygltf::Model load_second(const std::string& path) {
  tinygltf::TinyGLTF loader;
  loader.SetImageLoader(ignore_image, nullptr);
  tinygltf::Model model;
  std::string error, warning;
  EXPECT_TRUE(loader.LoadBinaryFromFile(&model, &error, &warning, path)) << error;
  EXPECT_EQ(error, "");
  EXPECT_EQ(warning, "");
  return model;
}

std::vector<std::uint32_t> second_floats(const tinygltf::Model& model, int accessor_index) {
  const auto& accessor = model.accessors.at(static_cast<std::size_t>(accessor_index));
  const auto& view = model.bufferViews.at(static_cast<std::size_t>(accessor.bufferView));
  const auto& buffer = model.buffers.at(static_cast<std::size_t>(view.buffer)).data;
  const auto stride = static_cast<std::size_t>(accessor.ByteStride(view));
  const auto components =
      static_cast<std::size_t>(tinygltf::GetNumComponentsInType(static_cast<std::uint32_t>(accessor.type)));
  EXPECT_EQ(accessor.componentType, TINYGLTF_COMPONENT_TYPE_FLOAT);
  std::vector<std::uint32_t> values(accessor.count * components);
  for (std::size_t i = 0; i < accessor.count; ++i)
    std::memcpy(&values[i * components], buffer.data() + view.byteOffset + accessor.byteOffset + i * stride,
                components * 4);
  return values;
}

std::vector<std::uint32_t> second_indices(const tinygltf::Model& model, int accessor_index) {
  const auto& accessor = model.accessors.at(static_cast<std::size_t>(accessor_index));
  const auto& view = model.bufferViews.at(static_cast<std::size_t>(accessor.bufferView));
  const auto& buffer = model.buffers.at(static_cast<std::size_t>(view.buffer)).data;
  const bool narrow = accessor.componentType == TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT;
  EXPECT_TRUE(narrow || accessor.componentType == TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT);
  std::vector<std::uint32_t> values(accessor.count, 0);
  for (std::size_t i = 0; i < accessor.count; ++i)
    std::memcpy(&values[i], buffer.data() + view.byteOffset + accessor.byteOffset + i * (narrow ? 2 : 4),
                narrow ? 2 : 4);
  return values;
}

std::vector<std::uint32_t> own_bits(const Mesh& mesh, const std::string& attribute, int texcoord) {
  std::vector<std::uint32_t> values;
  if (attribute == "POSITION")
    for (const auto& a : mesh.positions) values.insert(values.end(), {bits(a.x), bits(a.y), bits(a.z)});
  if (attribute == "NORMAL")
    for (const auto& a : mesh.normals) values.insert(values.end(), {bits(a.x), bits(a.y), bits(a.z)});
  if (attribute == "TEXCOORD_" + std::to_string(texcoord))
    for (const auto& a : mesh.uvs) values.insert(values.end(), {bits(a.x), bits(a.y)});
  if (attribute == "TANGENT")
    for (const auto& a : mesh.tangents)
      values.insert(values.end(), {bits(a.x), bits(a.y), bits(a.z), bits(a.w)});
  return values;
}

/// Compares every attribute and index of a file as the library and as tinygltf read it.
void expect_second_reader_agrees(const std::string& path) {
  SCOPED_TRACE(path);
  const Asset asset = read_asset(path);
  const tinygltf::Model model = load_second(path);
  std::size_t count = 0, compared = 0;
  for (const auto& mesh : model.meshes) count += mesh.primitives.size();
  ASSERT_EQ(asset.primitives.size() + asset.skipped.size(), count);
  ASSERT_FALSE(asset.primitives.empty());
  for (const Primitive& own : asset.primitives) {
    const auto& second = model.meshes.at(own.mesh).primitives.at(own.primitive);
    EXPECT_EQ(own.name, model.meshes.at(own.mesh).name);
    for (const std::string attribute : {"POSITION", "NORMAL", "TANGENT", "TEXCOORD_0"}) {
      const auto found = second.attributes.find(attribute);
      const auto expected = found == second.attributes.end() ? std::vector<std::uint32_t>{}
                                                             : second_floats(model, found->second);
      EXPECT_EQ(own_bits(own.data, attribute, own.texcoord), expected) << attribute;
      compared += expected.size();
    }
    std::vector<std::uint32_t> indices;
    for (const Triangle& t : own.data.triangles) indices.insert(indices.end(), t.begin(), t.end());
    EXPECT_EQ(indices, second_indices(model, second.indices));
  }
  EXPECT_GT(compared, 0u);
}

TEST(ReadGltf, SecondReaderAgrees) {
  for (const char* name :
       {"torus_016.three.glb", "torus_016.none.glb", "sphere_016.none.glb", "cylinder_016.three.glb"})
    expect_second_reader_agrees(data + name);
}

TEST(ReadGltf, SecondReaderAgreesOnSharedFiles) {
  if (!std::filesystem::exists(shared + "meshes"))
    GTEST_SKIP() << shared << "meshes is not here: files of other tools are not compared";
  for (const char* folder : {"meshes/three", "meshes/khronos"})
    for (const auto& entry : std::filesystem::directory_iterator(shared + folder))
      if (entry.path().extension() == ".glb") expect_second_reader_agrees(entry.path().string());
}

TEST(ReadGltf, TorusIsATorus) {
  const Asset asset = read_asset(data + "torus_016.three.glb");
  ASSERT_EQ(asset.primitives.size(), 1u);
  EXPECT_TRUE(asset.skipped.empty());
  const Primitive& primitive = asset.primitives[0];
  EXPECT_EQ(primitive.texcoord, 0);
  ASSERT_EQ(primitive.instances.size(), 1u);
  EXPECT_EQ(primitive.instances[0], Eigen::Matrix4d::Identity());
  const Mesh& mesh = primitive.data;
  EXPECT_EQ(mesh.positions.size(), 33u * 17u);
  EXPECT_EQ(mesh.normals.size(), mesh.positions.size());
  EXPECT_EQ(mesh.uvs.size(), mesh.positions.size());
  EXPECT_EQ(mesh.tangents.size(), mesh.positions.size());
  EXPECT_EQ(mesh.triangles.size(), 2u * 32u * 16u);
  for (const auto& p : mesh.positions) {
    const double tube = std::hypot(std::hypot(p.x, p.y) - 1, p.z);
    EXPECT_NEAR(tube, 0.4, 2e-7);  // float rounding of coordinates up to 1.4
  }
  for (const auto& t : mesh.tangents) EXPECT_EQ(std::abs(t.w), 1.0);
}

// ---- accessors

TEST(ReadGltf, FloatBitsAreKept) {
  const float denormal = std::numeric_limits<float>::denorm_min();
  Builder b;
  const auto position =
      b.positions({1.1f, -0.0f, denormal, nan_f, inf_f, -inf_f, std::numeric_limits<float>::max(), 0, 3});
  const auto tangent = b.packed<float>("VEC4", 5126, 3, {1, 0, 0, -1, 0, 1, 0, 1, 0, 0, 0.25f, -0.0f});
  b.primitive({{"POSITION", position}, {"TANGENT", tangent}});
  const Mesh mesh = read(b).primitives.at(0).data;
  EXPECT_EQ(own_bits(mesh, "POSITION", 0),
            (std::vector<std::uint32_t>{bits(1.1f), 0x80000000u, 1u, bits(nan_f), 0x7F800000u, 0xFF800000u,
                                        0x7F7FFFFFu, 0, bits(3)}));
  EXPECT_EQ(mesh.tangents[0].w, -1.0);
  EXPECT_EQ(mesh.tangents[1].w, 1.0);
  EXPECT_TRUE(std::signbit(mesh.tangents[2].w));
}

TEST(ReadGltf, InterleavedAccessors) {
  Builder b;
  // Two floats of padding, then position, 4 bytes of colour, uv: 24 bytes a vertex.
  const auto view =
      b.view(test::pack<float>({-1, -1, 0, 1, 2, -9, 0.5f, 0.25f, 3, 4, 5, -9, 0.75f, 1, 6, 7, 8, -9, 0, 1}),
             {{"byteStride", 24}});
  const auto position = b.accessor("VEC3", 5126, 3, {{"bufferView", view}, {"byteOffset", 8}});
  const auto uv = b.accessor("VEC2", 5126, 3, {{"bufferView", view}, {"byteOffset", 24}});
  b.primitive({{"POSITION", position}, {"TEXCOORD_0", uv}});
  // The last uv ends with the view: one byte more would not fit.
  b.json["bufferViews"][view]["byteLength"] = 24 + 2 * 24 + 8;
  b.json["buffers"][0]["byteLength"] = 24 + 2 * 24 + 8;
  const Mesh mesh = read(b).primitives.at(0).data;
  EXPECT_EQ(mesh.positions, (std::vector<Vec3<double>>{{0, 1, 2}, {3, 4, 5}, {6, 7, 8}}));
  EXPECT_EQ(mesh.uvs, (std::vector<Vec2<double>>{{0.5, 0.25}, {0.75, 1}, {0, 1}}));
}

TEST(ReadGltf, NormalisedIntegers) {
  Builder b;
  b.json["extensionsRequired"] = {"KHR_mesh_quantization"};
  const auto position = b.packed<std::int16_t>("VEC3", 5122, 3, {-32768, -32767, 32767, 0, 1, 2, 3, 4, 5},
                                               {{"normalized", true}});
  const auto normal =
      b.packed<std::int8_t>("VEC3", 5120, 3, {-128, -127, 127, 0, 1, -1, 64, 0, 0}, {{"normalized", true}});
  const auto uv = b.packed<std::uint8_t>("VEC2", 5121, 3, {0, 255, 51, 1, 2, 3}, {{"normalized", true}});
  const auto tangent = b.packed<std::uint16_t>("VEC4", 5123, 3, {65535, 0, 1, 65535, 0, 0, 0, 0, 0, 0, 0, 0},
                                               {{"normalized", true}});
  b.primitive({{"POSITION", position}, {"NORMAL", normal}, {"TEXCOORD_0", uv}, {"TANGENT", tangent}});
  const auto plain = b.packed<std::int16_t>("VEC3", 5122, 3, {-32768, -7, 7, 0, 1, 2, 3, 4, 5});
  b.primitive({{"POSITION", plain}});
  const Asset asset = read(b);
  const Mesh& mesh = asset.primitives.at(0).data;
  EXPECT_EQ(mesh.positions[0], (Vec3<double>{-1, -1, 1}));
  EXPECT_EQ(mesh.positions[1], (Vec3<double>{0, 1 / 32767.0, 2 / 32767.0}));
  EXPECT_EQ(mesh.normals[0], (Vec3<double>{-1, -1, 1}));
  EXPECT_EQ(mesh.normals[2].x, 64 / 127.0);
  EXPECT_EQ(mesh.uvs[0], (Vec2<double>{0, 1}));
  EXPECT_EQ(mesh.uvs[1], (Vec2<double>{51 / 255.0, 1 / 255.0}));
  EXPECT_EQ(mesh.tangents[0], (Vec4<double>{1, 0, 1 / 65535.0, 1}));
  EXPECT_EQ(asset.primitives.at(1).data.positions[0], (Vec3<double>{-32768, -7, 7}));
}

TEST(ReadGltf, SparseAccessors) {
  Builder b;
  const auto sparse = [&](std::initializer_list<std::uint16_t> indices, std::initializer_list<float> values) {
    const auto index_view = b.view(test::pack(indices));
    const auto value_view = b.view(test::pack(values));
    return Json{{"count", indices.size()},
                {"indices", {{"bufferView", index_view}, {"componentType", 5123}}},
                {"values", {{"bufferView", value_view}}}};
  };
  const auto over_values = sparse({1, 3}, {10, 11, 12, 30, 31, 32});
  const auto position =
      b.packed<float>("VEC3", 5126, 4, {0, 0, 0, 1, 1, 1, 2, 2, 2, 3, 3, 3}, {{"sparse", over_values}});
  const auto over_zeros = sparse({2}, {0, 0, 1});
  const auto normal = b.accessor("VEC3", 5126, 4, {{"sparse", over_zeros}});
  const auto uv = b.accessor("VEC2", 5126, 4, Json::object());
  b.primitive({{"POSITION", position}, {"NORMAL", normal}, {"TEXCOORD_0", uv}}, {{"mode", 5}});
  const Mesh mesh = read(b).primitives.at(0).data;
  EXPECT_EQ(mesh.positions, (std::vector<Vec3<double>>{{0, 0, 0}, {10, 11, 12}, {2, 2, 2}, {30, 31, 32}}));
  EXPECT_EQ(mesh.normals, (std::vector<Vec3<double>>{{0, 0, 0}, {0, 0, 0}, {0, 0, 1}, {0, 0, 0}}));
  EXPECT_EQ(mesh.uvs, (std::vector<Vec2<double>>(4)));
}

// ---- primitives

TEST(ReadGltf, IndicesAndModes) {
  Builder b;
  const auto position = b.positions({0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0, 0, 2, 0, 1, 2, 0});
  const auto u8 = b.packed<std::uint8_t>("SCALAR", 5121, 5, {0, 1, 3, 2, 4});
  const auto u16 = b.packed<std::uint16_t>("SCALAR", 5123, 5, {0, 1, 3, 2, 4});
  const auto u32 = b.packed<std::uint32_t>("SCALAR", 5125, 3, {5, 1, 0});
  const Json attributes = {{"POSITION", position}};
  b.primitive(attributes, {{"indices", u8}, {"mode", 5}});
  b.primitive(attributes, {{"indices", u16}, {"mode", 6}});
  b.primitive(attributes, {{"indices", u32}});
  b.primitive(attributes);
  b.primitive(attributes, {{"mode", 0}});
  b.primitive(attributes, {{"mode", 3}});
  b.json["meshes"].push_back({{"primitives", {{{"attributes", attributes}, {"mode", 4}}}}});
  const Asset asset = read(b);
  ASSERT_EQ(asset.primitives.size(), 5u);
  EXPECT_EQ(asset.primitives[0].data.triangles, (Triangles{{0, 1, 3}, {1, 2, 3}, {3, 2, 4}}));
  EXPECT_EQ(asset.primitives[1].data.triangles, (Triangles{{1, 3, 0}, {3, 2, 0}, {2, 4, 0}}));
  EXPECT_EQ(asset.primitives[2].data.triangles, (Triangles{{5, 1, 0}}));
  EXPECT_EQ(asset.primitives[3].data.triangles, (Triangles{{0, 1, 2}, {3, 4, 5}}));
  EXPECT_EQ(asset.primitives[3].primitive, 3u);
  EXPECT_EQ(asset.primitives[4].mesh, 1u);
  EXPECT_EQ(asset.primitives[4].primitive, 0u);
  EXPECT_EQ(asset.primitives[4].name, "");
  EXPECT_EQ(asset.primitives[0].name, "made by hand");
  ASSERT_EQ(asset.skipped.size(), 2u);
  EXPECT_EQ(asset.skipped[0].primitive, 4u);
  EXPECT_EQ(asset.skipped[0].reason, "mode 0 (points) has no triangles");
  EXPECT_EQ(asset.skipped[1].reason, "mode 3 (line strip) has no triangles");
}

TEST(ReadGltf, TexcoordOfTheNormalTexture) {
  Builder b;
  const auto position = b.positions({0, 0, 0, 1, 0, 0, 1, 1, 0});
  const auto uv0 = b.packed<float>("VEC2", 5126, 3, {0, 0, 0, 0, 0, 0});
  const auto uv1 = b.packed<float>("VEC2", 5126, 3, {1, 1, 1, 1, 1, 1});
  b.json["materials"] =
      Json::parse(R"([{"normalTexture": {"index": 0, "texCoord": 1}}, {"normalTexture": {"index": 0}}, {},
    {"normalTexture": {"index": 0, "extensions": {"KHR_texture_transform": {"texCoord": 1}}}}])");
  const Json both = {{"POSITION", position}, {"TEXCOORD_0", uv0}, {"TEXCOORD_1", uv1}};
  b.primitive(both, {{"material", 0}});
  b.primitive(both, {{"material", 1}});
  b.primitive(both, {{"material", 2}});
  b.primitive(both);
  b.primitive(both, {{"material", 3}});
  b.primitive({{"POSITION", position}, {"TEXCOORD_0", uv0}}, {{"material", 0}});
  b.primitive({{"POSITION", position}}, {{"material", 0}});
  const Asset asset = read(b);
  std::vector<int> sets;
  for (const Primitive& p : asset.primitives) {
    sets.push_back(p.texcoord);
    if (p.texcoord >= 0) {
      EXPECT_EQ(p.data.uvs.at(0).x, p.texcoord);
    }
  }
  EXPECT_EQ(sets, (std::vector<int>{1, 0, 0, 0, 1, 0, -1}));
  EXPECT_TRUE(asset.primitives[6].data.uvs.empty());
}

// ---- nodes

Builder one_triangle() {
  Builder b;
  b.primitive({{"POSITION", b.positions({0, 0, 0, 1, 0, 0, 0, 1, 0})}});
  return b;
}

TEST(ReadGltf, WorldMatrices) {
  Builder b = one_triangle();
  // A quarter turn about z, scaled by 2, 3, 4, moved; below it a matrix; beside it a node of another scene.
  b.json["nodes"] = Json::parse(R"([
    {"translation": [10, 20, 30], "rotation": [0, 0, 0.7071067811865476, 0.7071067811865476], "scale": [2, 3, 4], "children": [1]},
    {"mesh": 0, "matrix": [1,0,0,0, 0,1,0,0, 0,0,1,0, 1,1,1,1], "children": [3]},
    {"mesh": 0, "translation": [100, 0, 0]},
    {"mesh": 0, "scale": [-1, 1, 1]}])");
  b.json["scenes"] = Json::parse(R"([{"nodes": [2]}, {"nodes": [0]}])");
  b.json["scene"] = 1;
  const auto instances = read(b).primitives.at(0).instances;
  ASSERT_EQ(instances.size(), 2u);
  const Eigen::Vector4d p = instances[0] * Eigen::Vector4d(1, 2, 3, 1);
  // (1, 2, 3) + (1, 1, 1) = (2, 3, 4), scaled (4, 9, 16), turned (-9, 4, 16), moved (1, 24, 46)
  EXPECT_TRUE(p.isApprox(Eigen::Vector4d(1, 24, 46, 1), 1e-15)) << p.transpose();
  EXPECT_LT(instances[1].determinant(), 0);

  b.json.erase("scene");  // the first scene
  EXPECT_EQ(read(b).primitives.at(0).instances.at(0)(0, 3), 100);
  b.json.erase("scenes");  // all trees of nodes
  EXPECT_EQ(read(b).primitives.at(0).instances.size(), 3u);
  b.json.erase("nodes");
  EXPECT_TRUE(read(b).primitives.at(0).instances.empty());
}

TEST(ReadGltf, ADeepHierarchyIsNoRecursion) {
  Builder b = one_triangle();
  b.json["nodes"] = Json::array();
  const std::size_t depth = 20000;
  for (std::size_t i = 1; i < depth; ++i)
    b.json["nodes"].push_back({{"children", {i}}, {"translation", {1, 0, 0}}});
  b.json["nodes"].push_back({{"mesh", 0}});
  EXPECT_EQ(read(b).primitives.at(0).instances.at(0)(0, 3), depth - 1);
}

// ---- buffers elsewhere

TEST(ReadGltf, BuffersInFilesAndDataUris) {
  const TempFolder folder;
  Builder b = one_triangle();
  test::write_bytes(folder / "a b%.bin", b.bin);
  b.json["buffers"][0]["uri"] = "a%20b%25.bin";
  const Asset external = read_asset(test::write_bytes(folder / "external.gltf", b.json.dump()));
  EXPECT_EQ(external.primitives.at(0).data.positions[1], (Vec3<double>{1, 0, 0}));

  // 36 bytes: (0,0,0) (1,0,0) (0,1,0), encoded by Python's base64.
  b.json["buffers"][0]["uri"] =
      "data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA";
  const Asset inside = read_asset(test::write_bytes(folder / "inside.gltf", "\xEF\xBB\xBF " + b.json.dump()));
  EXPECT_EQ(inside.primitives.at(0).data.positions, external.primitives.at(0).data.positions);
}

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
  document.save_glb(elsewhere / "scene.glb");
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

// ---- rewriting

TEST(Rewrite, TangentsAreAppendedAndAllElseIsKept) {
  const TempFolder folder;
  Builder b = one_triangle();
  b.bin += "xy";  // a chunk whose end is no multiple of 4 until it is padded
  b.json["extras"] = Json::parse(
      R"({"z": 0.1, "a": [1e-310, 5e-324, 1.7976931348623157e308, -0.0, 0.30000000000000004, 3.0, null, true],
          "big": 9007199254740993, "biggest": 18446744073709551615, "negative": -9223372036854775808, "text": "ä\u0001\"\\"})");
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
  std::vector<std::uint32_t> source, indices;  // one vertex a corner
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
}  // namespace darboux
