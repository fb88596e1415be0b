// NeedLevel::pixels: a flat normal map needs no frame, and only what is stored without loss says that it is
// flat.
#include <filesystem>
#include <fstream>

#include <gtest/gtest.h>

#include <darboux/tangent_need.h>

#include "generated_gltf.h"
#include "io_files.h"
#include "png_bytes.h"

namespace darboux::flat_normal_maps_test {
namespace {

using test::Json;
using test::png_bytes;
using test::TempFolder;

using Samples = std::vector<std::uint16_t>;

// `texels` of one colour, `last` in the last place.
Samples colour(std::size_t texels, Samples rgb, Samples last = {}) {
  Samples result;
  for (std::size_t i = 0; i < texels; ++i) {
    const Samples& texel = i + 1 == texels && !last.empty() ? last : rgb;
    result.insert(result.end(), texel.begin(), texel.end());
  }
  return result;
}

Json document(Json material = {{"normalTexture", {{"index", 0}}}}) {
  const auto vec = [](const char* type) {
    return Json{{"componentType", 5126}, {"count", 3}, {"type", type}};
  };
  Json primitive{{"attributes", {{"POSITION", 0}, {"NORMAL", 1}, {"TANGENT", 2}, {"TEXCOORD_0", 3}}},
                 {"material", 0}};
  return {{"asset", {{"version", "2.0"}}},
          {"accessors", Json::array({vec("VEC3"), vec("VEC3"), vec("VEC4"), vec("VEC2")})},
          {"materials", Json::array({std::move(material)})},
          {"textures", Json::array({{{"source", 0}}})},
          {"images", Json::array({{{"uri", "map.png"}}})},
          {"meshes", Json::array({{{"primitives", Json::array({primitive})}}})}};
}

// The primitive at level pixels, with the image in map.png where there is one.
PrimitiveNeed planned(const Json& json, const std::string& image, NeedLevel level = NeedLevel::pixels) {
  const TempFolder folder;
  if (!image.empty()) test::write_bytes(folder / "map.png", image);
  return tangent_need(test::write_bytes(folder / "a.gltf", json.dump()), level).primitives.at(0);
}

void expect_kept(const PrimitiveNeed& p, const std::string& note) {
  EXPECT_EQ(p.need, TangentNeed::needed);
  ASSERT_FALSE(p.reasons.empty());
  EXPECT_NE(p.reasons[0].note.find(note), std::string::npos) << p.reasons[0].note;
}

TEST(FlatNormalMaps, NeedNoFrame) {
  const std::string flat = png_bytes(4, 3, colour(12, {128, 128, 255}));
  EXPECT_EQ(planned(document(), flat).need, TangentNeed::idle);
  for (const NeedLevel level : {NeedLevel::spec, NeedLevel::factors})
    EXPECT_EQ(planned(document(), flat, level).need, TangentNeed::needed) << "only pixels looks at images";
}

// Half a code from (0, 0, 1) in x and y is what 8 bits have for it; a whole code more is a direction.
TEST(FlatNormalMaps, OneTexelThatTiltsIsEnough) {
  struct Case {
    Samples last;
    bool flat;
  };
  for (const auto& [last, flat] :
       {Case{{127, 128, 255}, true}, Case{{127, 127, 254}, true}, Case{{129, 128, 255}, false},
        Case{{128, 126, 255}, false}, Case{{128, 128, 253}, false}}) {
    SCOPED_TRACE(last[0] * 1000000 + last[1] * 1000 + last[2]);
    const PrimitiveNeed p = planned(document(), png_bytes(5, 5, colour(25, {128, 128, 255}, last)));
    EXPECT_EQ(p.need, flat ? TangentNeed::idle : TangentNeed::needed);
    for (const NeedReason& r : p.reasons) EXPECT_EQ(r.note, "") << "it was looked at";
  }
}

TEST(FlatNormalMaps, OfAllLayoutsOfPng) {
  struct Case {
    const char* what;
    test::PngLayout layout;
    Samples flat, tilted;
    std::vector<std::uint8_t> palette;
  };
  const Case cases[] = {
      {"16 bits", {16, PNG_COLOR_TYPE_RGB}, {32768, 32767, 65535}, {33100, 32768, 65535}, {}},
      {"8 bits in 16", {16, PNG_COLOR_TYPE_RGB}, {0x8080, 0x7f7f, 0xffff}, {0x8181, 0x8080, 0xffff}, {}},
      {"with alpha", {8, PNG_COLOR_TYPE_RGB_ALPHA}, {128, 128, 255, 7}, {140, 128, 255, 7}, {}},
      {"interlaced", {8, PNG_COLOR_TYPE_RGB, true}, {128, 128, 255}, {128, 90, 255}, {}},
      {"palette", {8, PNG_COLOR_TYPE_PALETTE}, {0}, {1}, {128, 127, 255, 0, 128, 255}},
      {"grey", {8, PNG_COLOR_TYPE_GRAY}, {}, {128}, {}}};
  for (const Case& c : cases) {
    SCOPED_TRACE(c.what);
    if (!c.flat.empty()) {
      EXPECT_EQ(planned(document(), png_bytes(9, 7, colour(63, c.flat), c.layout, c.palette)).need,
                TangentNeed::idle);
    }
    EXPECT_EQ(planned(document(), png_bytes(9, 7, colour(63, c.flat.empty() ? c.tilted : c.flat, c.tilted),
                                            c.layout, c.palette))
                  .need,
              TangentNeed::needed);
  }
}

TEST(FlatNormalMaps, WhatCannotBeLookedAtStaysNeeded) {
  const std::string flat = png_bytes(4, 4, colour(16, {128, 128, 255}));
  expect_kept(planned(document(), ""), "cannot be read");
  expect_kept(planned(document(), "\xff\xd8\xff\xe0 JFIF"), "not a PNG");
  expect_kept(planned(document(), flat.substr(0, flat.size() - 30)), "ends early");
  std::string corrupt = flat;
  char& checksum = corrupt[corrupt.size() - 13];  // of the texels, before the 12 bytes of IEND
  checksum = static_cast<char>(checksum ^ 0x55);
  expect_kept(planned(document(), corrupt), "cannot be read");
  corrupt = flat;
  corrupt[45] = static_cast<char>(corrupt[45] ^ 0x55);  // texels that are others, or none
  EXPECT_EQ(planned(document(), corrupt).need, TangentNeed::needed);
  Json json = document();
  json["textures"][0].erase("source");
  expect_kept(planned(json, flat), "texture 0 has no image");
  json.erase("textures");
  expect_kept(planned(json, flat), "texture 0 is not there");
  // A viewer that knows WebP draws another image.
  json = document();
  json["textures"][0]["extensions"]["EXT_texture_webp"]["source"] = 1;
  json["images"].push_back({{"uri", "map.webp"}});
  expect_kept(planned(json, flat), "image 1 cannot be read");
}

// A header that promises 2^30 texels and has none costs nothing.
TEST(FlatNormalMaps, HugeImagesAreRefusedBeforeAnythingIsAllocated) {
  const std::string small = png_bytes(1, 1, {128, 128, 255});
  std::string bytes = small.substr(0, 16);
  for (const std::uint32_t n : {32768u, 32768u})
    for (int shift = 24; shift >= 0; shift -= 8) bytes += static_cast<char>(n >> shift & 255);
  bytes += small.substr(24, 5);
  const std::uint32_t crc = [&] {  // of the type and its data, the polynomial of PNG's specification
    std::uint32_t value = 0xffffffff;
    for (const char c : bytes.substr(12)) {
      value ^= static_cast<unsigned char>(c);
      for (int bit = 0; bit < 8; ++bit) value = (value >> 1) ^ ((value & 1) != 0 ? 0xedb88320u : 0u);
    }
    return ~value;
  }();
  for (int shift = 24; shift >= 0; shift -= 8) bytes += static_cast<char>(crc >> shift & 255);
  bytes += small.substr(33);
  expect_kept(planned(document(), bytes), "32768 x 32768");
}

TEST(FlatNormalMaps, InBuffersAndDataUris) {
  const std::string flat = png_bytes(4, 4, colour(16, {128, 128, 255}));
  const TempFolder folder;
  Json json = document();
  json["images"] = Json::array({{{"bufferView", 0}, {"mimeType", "image/png"}}});
  json["bufferViews"] = Json::array({{{"buffer", 0}, {"byteOffset", 4}, {"byteLength", flat.size()}}});
  json["buffers"] = Json::array({{{"byteLength", flat.size() + 4}}});
  const std::string glb = test::write_bytes(folder / "a.glb", test::make_glb(json.dump(), "skip" + flat));
  EXPECT_EQ(tangent_need(glb, NeedLevel::pixels).primitives.at(0).need, TangentNeed::idle);
  json["buffers"][0]["uri"] = "a.bin";
  const std::string gltf = test::write_bytes(folder / "a.gltf", json.dump());
  expect_kept(tangent_need(gltf, NeedLevel::pixels).primitives.at(0), "cannot be read");
  test::write_bytes(folder / "a.bin", "skip" + flat);
  EXPECT_EQ(tangent_need(gltf, NeedLevel::pixels).primitives.at(0).need, TangentNeed::idle);
  test::write_bytes(folder / "a.bin", "skip" + flat.substr(0, 20));
  expect_kept(tangent_need(gltf, NeedLevel::pixels).primitives.at(0), "cannot be read");
}

TEST(FlatNormalMaps, PackedOnesHaveXAndYAlone) {
  Json json = document(
      {{"extensions",
        {{"MSFT_packing_normalRoughnessMetallic", {{"normalRoughnessMetallicTexture", {{"index", 0}}}}}}}});
  EXPECT_EQ(planned(json, png_bytes(2, 2, colour(4, {127, 128, 30}))).need, TangentNeed::idle);
  EXPECT_EQ(planned(json, png_bytes(2, 2, colour(4, {127, 130, 30}))).need, TangentNeed::needed);
}

// Viewers multiply x and y by the scale before they take the direction.
TEST(FlatNormalMaps, AreScaled) {
  const std::string nearly = png_bytes(4, 4, colour(16, {127, 127, 255})),
                    exact = png_bytes(4, 4, colour(16, {32768, 32767, 65535}), {.bits = 16});
  const auto scaled = [](double scale) {
    return document({{"normalTexture", {{"index", 0}, {"scale", scale}}}});
  };
  EXPECT_EQ(planned(scaled(0.5), nearly).need, TangentNeed::idle);
  EXPECT_EQ(planned(scaled(-1), nearly).need, TangentNeed::idle);
  EXPECT_EQ(planned(scaled(4), nearly).need, TangentNeed::needed);
  EXPECT_EQ(planned(scaled(-20), nearly).need, TangentNeed::needed);
  EXPECT_EQ(planned(scaled(20), exact).need, TangentNeed::idle);
  Json animated = scaled(1);
  animated["animations"] =
      Json::parse(R"([{"samplers": [], "channels": [{"sampler": 0, "target": {"path": "pointer",
    "extensions": {"KHR_animation_pointer": {"pointer": "/materials/0/normalTexture/scale"}}}}]}])");
  expect_kept(planned(animated, nearly), "its scale is animated");
}

TEST(FlatNormalMaps, LeaveAnisotropyItsFrame) {
  const PrimitiveNeed p =
      planned(document({{"normalTexture", {{"index", 0}}},
                        {"extensions", {{"KHR_materials_anisotropy", {{"anisotropyStrength", 0.5}}}}}}),
              png_bytes(2, 2, colour(4, {128, 128, 255})));
  EXPECT_EQ(p.need, TangentNeed::needed);
  ASSERT_EQ(p.reasons.size(), 1u);
  EXPECT_EQ(p.reasons[0].rule, "anisotropy");
  EXPECT_TRUE(p.derivable) << "from the uvs of the normal texture, flat or not";
}

}  // namespace
}  // namespace darboux::flat_normal_maps_test
