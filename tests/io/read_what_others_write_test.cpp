// Files that are not quite as the standard has them, or use what has no part in triangles: they are read.
#include <algorithm>
#include <cmath>
#include <functional>

#include <gtest/gtest.h>

#include <darboux/assess.h>
#include <darboux/io.h>

#include "io_files.h"

namespace darboux::read_what_others_write_test {
namespace {

using test::Builder;
using test::Json;
using test::TempFolder;

Asset read(const std::string& bytes, const std::string& name = "a.glb") {
  const TempFolder folder;
  return read_asset(test::write_bytes(folder / name, bytes));
}

Builder quad() {
  Builder b;
  const auto positions = b.positions({0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0});
  const auto uvs = b.packed<float>("VEC2", 5126, 4, {0, 0, 1, 0, 1, 1, 0, 1});
  const auto other = b.packed<float>("VEC2", 5126, 4, {0, 0, 2, 0, 2, 2, 0, 2});
  const auto indices = b.packed<std::uint16_t>("SCALAR", 5123, 6, {0, 1, 2, 0, 2, 3});
  b.primitive({{"POSITION", positions}, {"TEXCOORD_0", uvs}, {"TEXCOORD_1", other}}, {{"indices", indices}});
  return b;
}

TEST(ReadWhatOthersWrite, RequiredExtensionsThatLeaveTrianglesAlone) {
  for (const char* name : {"KHR_materials_iridescence", "KHR_materials_emissive_strength", "EXT_texture_avif",
                           "KHR_animation_pointer", "KHR_node_visibility", "ACME_nobody_knows"}) {
    Builder b = quad();
    b.json["extensionsRequired"] = {name};
    b.json["materials"] = {{{"extensions", {{name, Json::object()}}}}};
    EXPECT_EQ(read(b.glb()).primitives.at(0).data.triangles.size(), 2u) << name;
  }
}

TEST(ReadWhatOthersWrite, BytesBehindAGlb) {
  const std::string glb = quad().glb();
  for (const std::size_t more : {1u, 3u, 4u, 100u})
    EXPECT_EQ(read(glb + std::string(more, 'x')).primitives.size(), 1u) << more;
}

TEST(ReadWhatOthersWrite, IntegersWithAFraction) {
  Builder b = quad();
  std::string text = b.json.dump();
  for (const char* key : {"\"count\":", "\"componentType\":", "\"byteOffset\":", "\"bufferView\":"})
    for (std::size_t at = text.find(key); at != std::string::npos; at = text.find(key, at + 1))
      text.insert(text.find_first_of(",}", at), ".0");
  EXPECT_EQ(read(test::make_glb(text, b.bin)).primitives.at(0).data.triangles.size(), 2u);
}

TEST(ReadWhatOthersWrite, WholeTrianglesOfACount) {
  for (const std::size_t count : {5u, 4u, 3u, 2u, 1u}) {
    Builder b = quad();
    b.json["accessors"][3]["count"] = count;
    const Primitive p = read(b.glb()).primitives.at(0);
    EXPECT_EQ(p.data.triangles.size(), count / 3) << count;
    EXPECT_EQ(p.leftover_indices, count % 3) << count;
  }
  EXPECT_EQ(read(quad().glb()).primitives.at(0).leftover_indices, 0u);
}

TEST(ReadWhatOthersWrite, PrimitivesWithoutPositionAreSkipped) {
  Builder b = quad();
  b.primitive({{"TEXCOORD_0", 1}});
  const Asset asset = read(b.glb());
  EXPECT_EQ(asset.primitives.size(), 1u);
  ASSERT_EQ(asset.skipped.size(), 1u);
  EXPECT_EQ(asset.skipped[0].primitive, 1u);
  EXPECT_NE(asset.skipped[0].reason.find("POSITION"), std::string::npos);
}

TEST(ReadWhatOthersWrite, FacesOfAnObjThatNameMissingUvsAndNormals) {
  const std::string vertices = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";
  for (const char* faces : {"f 1/1 2/2 3/3\nf 1/1 3/3 4/4\n", "f 1/1/1 2/2/1 3/3/1\nf 1//7 3//7 4//7\n",
                            "f -4/-4 -3/-3 -2/-2 -1/-1\n"}) {
    const Mesh mesh = read(vertices + faces, "a.obj").primitives.at(0).data;
    EXPECT_EQ(mesh.triangles.size(), 2u) << faces;
    EXPECT_TRUE(mesh.uvs.empty()) << faces;
  }
  // What is there stays.
  const Mesh mesh = read(vertices + "vt 0 0\nvt 1 0\nvt 1 1\nvn 0 0 1\nf 1/1/1 2/2/1 3/3/1\n", "a.obj")
                        .primitives.at(0)
                        .data;
  EXPECT_EQ(mesh.uvs.size(), 3u);
  EXPECT_EQ(mesh.normals.size(), 3u);
}

TEST(ReadWhatOthersWrite, StepsOfIntegers) {
  Builder b = quad();
  const auto tangents =
      b.packed<std::int8_t>("VEC4", 5120, 4, {127, 0, 0, 127, 127, 0, 0, 127, 127, 0, 0, 127, 127, 0, 0, 127},
                            {{"normalized", true}});
  const auto positions = b.packed<std::int16_t>("VEC3", 5122, 4, {0, 0, 0, 9, 0, 0, 9, 9, 0, 0, 9, 0});
  const auto uvs = b.packed<std::uint16_t>("VEC2", 5123, 4, {0, 0, 65535, 0, 65535, 65535, 0, 65535},
                                           {{"normalized", true}});
  b.primitive({{"POSITION", positions}, {"TANGENT", tangents}, {"TEXCOORD_0", uvs}});
  const Asset asset = read(b.glb());
  const HalfSteps& floats = asset.primitives.at(0).data.half_steps;
  EXPECT_EQ(floats.position, 0);
  EXPECT_EQ(floats.uv, 0);
  const HalfSteps& steps = asset.primitives.at(1).data.half_steps;
  EXPECT_EQ(steps.position, 0.5);
  EXPECT_EQ(steps.tangent, 0.5 / 127);
  EXPECT_EQ(steps.uv, 0.5 / 65535);
  EXPECT_EQ(steps.normal, 0);
}

// Unit vectors to so many bits, that of the sign included, as gltf-transform's quantize stores them in 16
// bits: the bits repeated below themselves.
std::vector<std::int16_t> quantised(int bits, int vertices) {
  const int steps = (1 << (bits - 1)) - 1, shift = 16 - bits;
  std::vector<std::int16_t> result;
  for (int i = 0; i < vertices; ++i) {
    const double z = 0.97 * (2 * (i + 0.5) / vertices - 1), r = std::sqrt(1 - z * z);
    for (const double x : {r * std::cos(2.4 * i), r * std::sin(2.4 * i), z}) {
      const int q = static_cast<int>(std::lround(std::fabs(x) * steps));
      const int repeated = bits == 16 ? q : (q << shift) | (q >> (bits - 1 - shift));
      result.push_back(static_cast<std::int16_t>(x < 0 ? -repeated : repeated));
    }
  }
  return result;
}

// What gltf-transform's quantize and optimize write passed for normals of wrong length: 10 bits in 16 are off
// by up to 0.0017, where 16 bits would be off by 0.00003.
TEST(ReadWhatOthersWrite, StepsOfFewerBitsThanTheIntegersHave) {
  constexpr int vertices = 60;
  const auto step = [&](const std::vector<std::int16_t>& normals) {
    Builder b = quad();
    const auto n = static_cast<int>(normals.size() / 3);
    const auto stored = b.packed<std::int16_t>("VEC3", 5122, n, normals, {{"normalized", true}});
    const auto positions =
        b.packed<float>("VEC3", 5126, n, std::vector<float>(static_cast<std::size_t>(3 * n), 0));
    b.primitive({{"POSITION", positions}, {"NORMAL", stored}});
    return read(b.glb()).primitives.at(1).data.half_steps.normal;
  };
  for (const int bits : {9, 10, 11, 12, 13})
    EXPECT_EQ(step(quantised(bits, vertices)), 0.5 / ((1 << (bits - 1)) - 1)) << bits;
  EXPECT_EQ(step(quantised(16, vertices)), 0.5 / 32767);
  EXPECT_EQ(step(quantised(10, 2)), 0.5 / 511) << "few numbers";
  const std::int16_t diagonal = 23149;  // 361 / 511, of a box that was turned by 45 degrees
  EXPECT_EQ(step({diagonal, diagonal, 0, diagonal, -diagonal, 0, 0, 0, 32767}), 0.5 / 511) << "one magnitude";
  // Too few numbers to tell.
  EXPECT_EQ(step({32767, 0, 0, 0, -32767, 0, 0, 0, 32767}), 0.5 / 32767);
  std::vector<std::int16_t> one_apart = quantised(10, vertices);
  one_apart[7] = static_cast<std::int16_t>(one_apart[7] + 20);
  EXPECT_EQ(step(one_apart), 0.5 / 32767) << "one number is no multiple";
}

// Floats that were signed bytes; and positions and uvs on a grid, which are exact though multiples of 1 /
// 255.
TEST(ReadWhatOthersWrite, StepsOfDirectionsAlone) {
  constexpr int vertices = 40;
  std::vector<std::uint16_t> uvs, grid;
  std::vector<float> normals;
  for (int i = 0; i < 2 * vertices; ++i) uvs.push_back(static_cast<std::uint16_t>(257 * i));
  for (int i = 0; i < 3 * vertices; ++i) grid.push_back(static_cast<std::uint16_t>(257 * (7 * i % 256)));
  for (const std::int16_t x : quantised(8, vertices)) normals.push_back(static_cast<float>((x >> 8) / 127.0));
  Builder b = quad();
  const Json normalized = {{"normalized", true}};
  b.primitive({{"POSITION", b.packed<std::uint16_t>("VEC3", 5123, vertices, grid, normalized)},
               {"NORMAL", b.packed<float>("VEC3", 5126, vertices, normals)},
               {"TEXCOORD_0", b.packed<std::uint16_t>("VEC2", 5123, vertices, uvs, normalized)}});
  const HalfSteps steps = read(b.glb()).primitives.at(1).data.half_steps;
  EXPECT_EQ(steps.uv, 0.5 / 65535);
  EXPECT_EQ(steps.position, 0.5 / 65535);
  EXPECT_EQ(steps.normal, 0.5 / 127);
}

// Half floats, and bytes without a sign that 2 x / 255 - 1 spread, are floats in glTF: their lengths are off
// by up to 0.0004 and 0.007.
TEST(ReadWhatOthersWrite, StepsOfFloatsOfLowerPrecision) {
  constexpr int vertices = 40;
  const std::vector<std::int16_t> fine = quantised(16, vertices);
  const auto step = [&](const std::function<double(double)>& rounded) {
    std::vector<float> normals;
    for (const std::int16_t x : fine) normals.push_back(static_cast<float>(rounded(x / 32767.0)));
    Builder b = quad();
    const auto n = b.packed<float>("VEC3", 5126, vertices, normals);
    const auto positions = b.packed<float>("VEC3", 5126, vertices,
                                           std::vector<float>(static_cast<std::size_t>(3 * vertices), 0));
    b.primitive({{"POSITION", positions}, {"NORMAL", n}});
    return read(b.glb()).primitives.at(1).data.half_steps.normal;
  };
  const auto significant = [](double x, int bits) {
    const double unit = x == 0 ? 1 : std::ldexp(1.0, std::ilogb(x) + 1 - bits);
    return std::round(x / unit) * unit;
  };
  EXPECT_EQ(step([&](double x) { return significant(x, 11); }), 0x1p-12);
  EXPECT_EQ(step([&](double x) { return significant(x, 12); }), 0);
  EXPECT_EQ(step([](double x) { return std::round((x + 1) / 2 * 255) / 255 * 2 - 1; }), 0.5 / 127);
  EXPECT_EQ(step([](double x) {
              const float code = static_cast<float>(std::round((x + 1) / 2 * 255)), unit = 2.0f / 255;
              const float product = code * unit;
              return static_cast<double>(product - 1);
            }),
            0.5 / 127);
  EXPECT_EQ(step([](double x) { return std::round(x * 255) / 255; }), 0.5 / 255);
  EXPECT_EQ(step([](double x) { return x; }), 0);
}

// Few decimals of unit vectors are steps too: 3 × 0.577² = 0.9988 is no wrong length.
TEST(ReadWhatOthersWrite, StepsOfDecimals) {
  const std::string faces = "v 0 0 0\nv 1 0 0\nv 1 1 0\nf 1//1 2//2 3//3\n";
  const auto step = [&](const std::string& normals) {
    return read(normals + faces, "a.obj").primitives.at(0).data.half_steps.normal;
  };
  EXPECT_EQ(step("vn 0.577 0.577 0.577\nvn 0 0.707 0.707\nvn 0 0 1\n"), 0.5e-3);
  EXPECT_EQ(step("vn 0.58 0.58 0.58\nvn 0 0.71 0.71\nvn 0 0 1\n"), 0.5e-2);
  EXPECT_EQ(step("vn 0.57735 0.57735 0.57735\nvn 0 0.7071 0.7071\nvn 0 0 1\n"), 0);
  EXPECT_EQ(step("vn 1 0 0\nvn 0 -1 0\nvn 0 0 1\n"), 0) << "exact";
  EXPECT_EQ(step("vn 0.6 0.8 0\nvn 0 -1 0\nvn 0 0 1\n"), 0) << "exact";
  EXPECT_EQ(step("vn 5.77 5.77 5.77\nvn 0 0.71 0.71\nvn 0 0 1\n"), 0) << "no unit vectors";
  // A float holds what was meant: 0.577 in a GLB is a length of 0.9994.
  Builder b = quad();
  const auto normals =
      b.packed<float>("VEC3", 5126, 4, {0.577F, 0.577F, 0.577F, 0, 0.707F, 0.707F, 0, 0, 1, 0, 0, 1});
  const auto positions = b.packed<float>("VEC3", 5126, 4, {0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0});
  b.primitive({{"POSITION", positions}, {"NORMAL", normals}});
  EXPECT_EQ(read(b.glb()).primitives.at(1).data.half_steps.normal, 0);
  const Mesh mesh = read("vn 0.577 0.577 0.577\nvn 0.408 0.408 0.816\nvn 0 0.707 0.707\n" + faces, "a.obj")
                        .primitives.at(0)
                        .data;
  const MeshReport report = assess(mesh).report;
  EXPECT_TRUE(
      std::ranges::none_of(report.findings, [](const Finding& f) { return f.code == "NORMAL_NOT_UNIT"; }));
}

TEST(ReadWhatOthersWrite, TheUvSetThatTheMaterialNames) {
  Builder b = quad();
  const Primitive none = read(b.glb()).primitives.at(0);
  EXPECT_EQ(none.texcoord, 0);
  EXPECT_FALSE(none.names_uv_set);
  EXPECT_FALSE(none.texture_transform);
  EXPECT_FALSE(none.missing_texcoord);
  b.json["materials"] = Json::parse(R"([{"normalTexture": {"index": 0, "texCoord": 5}}])");
  b.json["meshes"][0]["primitives"][0]["material"] = 0;
  const Primitive lacks = read(b.glb()).primitives.at(0);
  EXPECT_EQ(lacks.texcoord, 0);
  EXPECT_EQ(lacks.missing_texcoord, 5);
  EXPECT_FALSE(lacks.names_uv_set);
  b.json["materials"] =
      Json::parse(R"([{"normalTexture": {"index": 0, "texCoord": 0, "extensions": {"KHR_texture_transform":
      {"offset": [0.25, 0.5], "rotation": 0.5, "scale": [2, 3], "texCoord": 1}}}}])");
  b.json["meshes"][0]["primitives"][0]["material"] = 0;
  const Primitive p = read(b.glb()).primitives.at(0);
  EXPECT_EQ(p.texcoord, 1);
  EXPECT_TRUE(p.names_uv_set);
  EXPECT_FALSE(p.missing_texcoord);
  ASSERT_TRUE(p.texture_transform);
  // The extension's own matrices: translation times rotation times scale.
  const double c = std::cos(0.5), s = std::sin(0.5);
  const std::array<double, 6> expected{2 * c, 3 * s, -2 * s, 3 * c, 0.25, 0.5};
  for (std::size_t k = 0; k < 6; ++k) EXPECT_NEAR((*p.texture_transform)[k], expected[k], 1e-15) << k;
}

}  // namespace
}  // namespace darboux::read_what_others_write_test
