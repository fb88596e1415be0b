// glTF files that are read, and that a second reader agrees bit for bit.
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

namespace darboux::io_test {
namespace {

using namespace test;
using Triangles = std::vector<Triangle>;

const std::string data = DARBOUX_TEST_DATA "/";
const std::string shared = DARBOUX_SHARED "/";
const float nan_f = std::numeric_limits<float>::quiet_NaN();
const float inf_f = std::numeric_limits<float>::infinity();

Asset read(const Builder& builder) {
  const TempFolder folder;
  return read_asset(test::write_bytes(folder / "made.glb", builder.glb()));
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
  // Two floats of padding, then position, 4 bytes of colour, uv: 24 bytes per vertex.
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

TEST(ReadGltf, WorldMatrices) {
  Builder b = one_triangle();
  // A quarter turn about z, scaled by 2, 3, 4, moved; below it a matrix; beside it a node of another scene.
  b.json["nodes"] = Json::parse(R"([
    {"translation": [10, 20, 30], "rotation": [0, 0, 0.7071067811865476, 0.7071067811865476],
      "scale": [2, 3, 4], "children": [1]},
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
  EXPECT_EQ(read(b).primitives.at(0).instances[0](0, 3), 100);
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
  EXPECT_EQ(read(b).primitives.at(0).instances[0](0, 3), depth - 1);
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

}  // namespace
}  // namespace darboux::io_test
