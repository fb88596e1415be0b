// Normal maps on the meshes of files: there and back, and what a glTF says of its texture.
#include <algorithm>
#include <array>
#include <filesystem>

#include <gtest/gtest.h>

#include <darboux/error.h>
#include <darboux/normal_map_files.h>

#include "base/base64.h"
#include "io_files.h"
#include "map_meshes.h"
#include "png_bytes.h"
#include "refusal_of.h"
#include "second_normal_map.h"

namespace darboux::test::normal_map_files_test {
namespace {

struct ThereAndBack {
  std::size_t texels = 0, conflicts = 0, wrong = 0, above_10 = 0;
  double condition = 0;
};

ThereAndBack there_and_back(const MapPiece& piece, MapDecode decode, SampleType type, int size) {
  const Image map = random_directions(size, size, type, 7);
  NormalMapOptions options;
  options.from = MapSpace::object;
  options.to = MapSpace::tangent;
  options.decode = decode;
  options.keep_length = true;
  const NormalMapResult there = convert_normal_map(map, std::span(&piece, 1), options);
  ThereAndBack result{.texels = there.covered, .conflicts = there.conflicts, .condition = there.condition};
  if (there.conflicts != 0) return result;
  std::swap(options.from, options.to);
  const NormalMapResult back = convert_normal_map(there.image, std::span(&piece, 1), options);
  const Returned r = returned(map, there, back.image, SecondNormalMap(piece, options, size, size));
  result.wrong = r.wrong, result.above_10 = r.above_10;
  return result;
}

// Tangents as three.js, assimp and MikkTSpace make them; mirrored halves are moved apart first.
TEST(NormalMapFiles, ThereAndBackWithOtherPeoplesTangents) {
  const std::string data = DARBOUX_TEST_DATA "/";
  for (const char* name : {"sphere_016.three.glb", "torus_016.three.glb", "cylinder_016.three.glb",
                           "cone_016.three.glb", "torus_032.assimp.glb", "sphere_032.mikk.glb",
                           "jittertorus_016.mikk.glb", "mirrortorus_016.mikk.glb"}) {
    auto pieces = normal_map_pieces(data + name);
    ASSERT_EQ(pieces.size(), 1u);
    if (std::string(name).starts_with("mirror")) move_halves_apart(pieces[0].mesh);
    for (const MapDecode decode : {MapDecode::mikktspace, MapDecode::gltf_viewer})
      for (const SampleType type : {SampleType::u8, SampleType::u16}) {
        const ThereAndBack r = there_and_back(pieces[0], decode, type, 40);
        EXPECT_EQ(r.conflicts, 0u) << name;
        EXPECT_EQ(r.wrong, 0u) << name;
        EXPECT_GT(r.texels, 300u) << name;
        std::printf("%s: %zu texels, condition up to %.3g, %zu above 10\n", name, r.texels, r.condition,
                    r.above_10);
      }
  }
}

// Keeps the triangles whose texels no triangle before them has; one on the edge counts for both sides.
void drop_overlaps(Mesh& mesh, int size) {
  std::vector<bool> taken(static_cast<std::size_t>(size) * static_cast<std::size_t>(size));
  std::vector<Triangle> kept;
  for (const Triangle& triangle : mesh.triangles) {
    std::array<Vec2<double>, 3> p;
    for (std::size_t k = 0; k < 3; ++k) p[k] = static_cast<double>(size) * mesh.uvs[triangle[k]];
    const auto edge = [&](std::size_t k, double x, double y) {
      const Vec2<double>&a = p[k], &b = p[(k + 1) % 3];
      return (b.x - a.x) * (y - a.y) - (b.y - a.y) * (x - a.x);
    };
    std::vector<std::size_t> texels;
    bool free = true;
    for (int y = 0; y < size; ++y)
      for (int x = 0; x < size; ++x) {
        const auto [low, high] =
            std::minmax({edge(0, x + 0.5, y + 0.5), edge(1, x + 0.5, y + 0.5), edge(2, x + 0.5, y + 0.5)});
        if (low < 0 && high > 0) continue;
        texels.push_back(static_cast<std::size_t>(y * size + x));
        free = free && !taken[texels.back()];
      }
    if (!free) continue;
    for (const std::size_t texel : texels) taken[texel] = true;
    kept.push_back(triangle);
  }
  mesh.triangles = kept;
}

// Its mirrored parts share texels: refused as a whole. Of each such pair one part goes there and back.
TEST(NormalMapFiles, ThereAndBackOnTheKhronosMirrorTest) {
  const std::string path = DARBOUX_SHARED "/meshes/khronos/NormalTangentMirrorTest.glb";
  if (!std::filesystem::exists(path)) GTEST_SKIP() << path << " is not there";
  constexpr int size = 128;
  auto pieces = normal_map_pieces(path);
  ASSERT_EQ(pieces.size(), 1u);
  EXPECT_GT(there_and_back(pieces[0], MapDecode::mikktspace, SampleType::u8, size).conflicts, 1000u);
  const std::size_t all = pieces[0].mesh.triangles.size();
  drop_overlaps(pieces[0].mesh, size);
  const ThereAndBack r = there_and_back(pieces[0], MapDecode::mikktspace, SampleType::u8, size);
  std::printf("%zu of %zu triangles, %zu texels, condition up to %.3g, %zu above 10\n",
              pieces[0].mesh.triangles.size(), all, r.texels, r.condition, r.above_10);
  EXPECT_EQ(r.conflicts, 0u);
  EXPECT_EQ(r.wrong, 0u);
  EXPECT_GT(r.texels, 1000u);
  EXPECT_LT(r.above_10, r.texels / 10) << "the bound is looked at";
}

// ---- what a glTF says -------------------------------------------------------------------------------------

// A triangle with two uv sets and a material whose normal texture is as given.
std::string textured(const TempFolder& folder, const Json& texture, const Json& sampler,
                     const Json& node = {}) {
  Builder b;
  const auto positions = b.positions({0, 0, 0, 1, 0, 0, 0, 1, 0});
  const auto normals = b.packed<float>("VEC3", 5126, 3, {0, 0, 1, 0, 0, 1, 0, 0, 1});
  const auto first = b.packed<float>("VEC2", 5126, 3, {0, 0, 1, 0, 0, 1});
  const auto second = b.packed<float>("VEC2", 5126, 3, {0, 0, 0.5f, 0, 0, 0.5f});
  b.primitive({{"POSITION", positions}, {"NORMAL", normals}, {"TEXCOORD_0", first}, {"TEXCOORD_1", second}},
              {{"material", 0}});
  b.json["materials"] = {{{"normalTexture", texture}}};
  b.json["textures"] = {{{"sampler", 0}}};
  b.json["samplers"] = {sampler};
  if (!node.is_null()) b.json["nodes"] = node;
  return write_bytes(folder / "textured.glb", b.glb());
}

TEST(NormalMapFiles, TakesTheUvSetTransformAndWrapOfTheNormalTexture) {
  const TempFolder folder;
  const Json plain{{"index", 0}, {"texCoord", 1}};
  MapPiece piece = normal_map_pieces(textured(folder, plain, {{"wrapS", 33071}, {"wrapT", 33648}})).at(0);
  EXPECT_EQ(piece.mesh.uvs[1], (Vec2<double>{0.5, 0}));
  EXPECT_EQ(piece.wrap, (std::array{MapWrap::clamp, MapWrap::mirror}));
  EXPECT_FALSE(piece.v_up);

  Json moved = plain;
  moved["extensions"]["KHR_texture_transform"] = {
      {"offset", {0.25, 0.5}}, {"scale", {2, 3}}, {"texCoord", 0}};
  piece = normal_map_pieces(textured(folder, moved, Json::object())).at(0);
  EXPECT_EQ(piece.mesh.uvs[1], (Vec2<double>{2.25, 0.5}));
  EXPECT_EQ(piece.mesh.uvs[2], (Vec2<double>{0.25, 3.5}));
  EXPECT_EQ(piece.wrap, (std::array{MapWrap::repeat, MapWrap::repeat}));
  piece = normal_map_pieces(folder / "textured.glb", {.wrap = MapWrap::mirror, .v_up = true}).at(0);
  EXPECT_EQ(piece.wrap, (std::array{MapWrap::mirror, MapWrap::mirror}));
  EXPECT_TRUE(piece.v_up);
}

TEST(NormalMapFiles, TakesTheScaleOfTheNormalTexture) {
  const TempFolder folder;
  const Json sampler = Json::object();
  EXPECT_EQ(normal_map_pieces(textured(folder, {{"index", 0}}, sampler)).at(0).scale, 1);
  const std::string path = textured(folder, {{"index", 0}, {"scale", 0.25}}, sampler);
  EXPECT_EQ(normal_map_pieces(path).at(0).scale, 0.25);
  EXPECT_EQ(normal_map_pieces(path, {.scale = 1}).at(0).scale, 1);
}

// Two primitives, whose materials have the normal textures that are given, of images that are there in three
// ways.
std::string with_images(const TempFolder& folder, const Json& first, const Json& second,
                        const std::string& png) {
  Builder b;
  const auto positions = b.positions({0, 0, 0, 1, 0, 0, 0, 1, 0});
  const auto uvs = b.packed<float>("VEC2", 5126, 3, {0, 0, 1, 0, 0, 1});
  b.primitive({{"POSITION", positions}, {"TEXCOORD_0", uvs}}, {{"material", 0}});
  b.primitive({{"POSITION", positions}, {"TEXCOORD_0", uvs}}, {{"material", 1}});
  b.json["materials"] = {first, second};
  write_bytes(folder / "beside.png", png);
  b.json["images"] = {{{"bufferView", b.view(png)}, {"mimeType", "image/png"}},
                      {{"uri", "data:image/png;base64," + base64(png)}},
                      {{"uri", "beside.png"}}};
  b.json["textures"] = {{{"source", 0}}, {{"source", 1}}, {{"source", 2}}, {{"source", 9}}};
  return write_bytes(folder / "images.glb", b.glb());
}

TEST(NormalMapFiles, FindsTheImagesOfNormalTextures) {
  const TempFolder folder;
  const auto material = [](int texture) { return Json{{"normalTexture", {{"index", texture}}}}; };
  const std::string png = png_bytes(2, 1, {1, 2, 3, 250, 251, 252});
  for (int k = 0; k < 3; ++k) {
    const std::string path = with_images(folder, material(k), Json::object(), png);
    const auto textures = normal_textures(path);
    ASSERT_EQ(textures.size(), 1u);
    EXPECT_EQ(textures[0].primitive, 0u);
    EXPECT_EQ(textures[0].image, static_cast<std::size_t>(k));
    EXPECT_EQ(gltf_image_bytes(path, textures[0].image), png) << k;
    EXPECT_EQ(textures[0].file, k == 2 ? folder / "beside.png" : std::string()) << k;
  }
  const auto two = normal_textures(with_images(folder, material(2), material(1), png));
  ASSERT_EQ(two.size(), 2u);
  EXPECT_EQ(two[1].primitive, 1u);
  EXPECT_EQ(two[1].image, 1u);
  const auto refused = [&](const Json& first, const char* part) {
    const std::string path = with_images(folder, first, Json::object(), png);
    const std::string refusal = refusal_of<FileError>([&] { normal_textures(path); });
    EXPECT_NE(refusal.find(part), std::string::npos) << refusal;
  };
  refused(material(3), "images");
  refused(material(4), "a texture 4, which /materials/0/normalTexture names");
}

TEST(NormalMapFiles, TakesTheNodesMatrixWhereThereIsOne) {
  const TempFolder folder;
  const Json texture{{"index", 0}}, none = Json::object();
  textured(folder, texture, none, {{{"mesh", 0}, {"scale", {2, 3, 4}}}});
  const MapPieceOptions world{.world = true};
  EXPECT_EQ(normal_map_pieces(folder / "textured.glb", world).at(0).to_world,
            Eigen::Matrix3d(Eigen::Vector3d(2, 3, 4).asDiagonal()));
  EXPECT_EQ(normal_map_pieces(folder / "textured.glb").at(0).to_world, Eigen::Matrix3d::Identity());
  textured(folder, texture, none, {{{"mesh", 0}}, {{"mesh", 0}, {"scale", {2, 2, 2}}}});
  const std::string refusal =
      refusal_of<FileError>([&] { normal_map_pieces(folder / "textured.glb", world); });
  EXPECT_NE(refusal.find("2 nodes that differ"), std::string::npos) << refusal;
  Json nodes = Json::array();
  nodes.push_back({{"name", "shows nothing"}});
  textured(folder, texture, none, nodes);
  EXPECT_EQ(normal_map_pieces(folder / "textured.glb").size(), 1u);
  const std::string unshown =
      refusal_of<FileError>([&] { normal_map_pieces(folder / "textured.glb", world); });
  EXPECT_NE(unshown.find("expected a node that shows it, got none"), std::string::npos) << unshown;
}

TEST(NormalMapFiles, TakesTheSignAndTheOriginOfVAsAsked) {
  const std::string path = DARBOUX_TEST_DATA "/torus_016.three.glb";
  const MapPiece gltf = normal_map_pieces(path).at(0),
                 raw = normal_map_pieces(path, {.sign = SignConvention::raw}).at(0);
  EXPECT_EQ(raw.mesh.tangents[7].w, -gltf.mesh.tangents[7].w);
  EXPECT_TRUE(normal_map_pieces(DARBOUX_TEST_DATA "/torus_016.obj").at(0).v_up) << "v of an OBJ runs up";
}

TEST(NormalMapFiles, TakesThePrimitivesThatAreNamed) {
  const std::string path = DARBOUX_TEST_DATA "/torus_016.three.glb";
  EXPECT_EQ(normal_map_pieces(path, {.only = {{0, 0}}}).size(), 1u);
  EXPECT_EQ(normal_map_pieces(path, {.only = {{0, std::nullopt}}}).size(), 1u);
  const std::string refusal = refusal_of<FileError>([&] { normal_map_pieces(path, {.only = {{0, 1}}}); });
  EXPECT_NE(refusal.find("named"), std::string::npos) << refusal;
}

}  // namespace
}  // namespace darboux::test::normal_map_files_test
