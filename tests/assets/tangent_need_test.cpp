// Which primitives need a tangent frame: one small document per rule, and the same rules from a whole file.
#include <filesystem>

#include <gtest/gtest.h>

#include <darboux/tangent_need.h>

#include "generated_gltf.h"
#include "io_files.h"
#include "refusal_of.h"

namespace darboux::tangent_need_test {
namespace {

using test::Json;
using test::TempFolder;

// Accessors without data: 0 POSITION, 1 NORMAL, 2 TANGENT, 3 TEXCOORD, 4 indices of 2 triangles, 5 another
// TANGENT, 6 a morph target's.
Json document(Json material = Json::object()) {
  const auto vec = [](const char* type) {
    return Json{{"componentType", 5126}, {"count", 4}, {"type", type}};
  };
  Json accessors = Json::array({vec("VEC3"), vec("VEC3"), vec("VEC4"), vec("VEC2"),
                                Json{{"componentType", 5123}, {"count", 6}, {"type", "SCALAR"}}, vec("VEC4"),
                                vec("VEC3")});
  Json attributes{{"POSITION", 0}, {"NORMAL", 1}, {"TANGENT", 2}, {"TEXCOORD_0", 3}};
  Json primitive{{"attributes", attributes}, {"indices", 4}, {"material", 0}};
  return {{"asset", {{"version", "2.0"}}},
          {"accessors", accessors},
          {"materials", Json::array({std::move(material)})},
          {"meshes", Json::array({{{"name", "m"}, {"primitives", Json::array({primitive})}}})},
          {"nodes", Json::array({{{"mesh", 0}}})},
          {"scenes", Json::array({{{"nodes", Json::array({0})}}})}};
}

Json texture(int set = 0) {
  return {{"index", 0}, {"texCoord", set}};
}
Json extension(const char* name, Json value) {
  return {{"extensions", {{name, std::move(value)}}}};
}
Json& primitive_of(Json& json) {
  return json["meshes"][0]["primitives"][0];
}
Json& attributes_of(Json& json) {
  return primitive_of(json)["attributes"];
}

TangentNeeds plan(const Json& json, NeedLevel level = NeedLevel::spec) {
  const TempFolder folder;
  return tangent_need(test::write_bytes(folder / "a.gltf", json.dump()), level);
}
PrimitiveNeed only(const Json& json, NeedLevel level = NeedLevel::spec) {
  const TangentNeeds needs = plan(json, level);
  EXPECT_EQ(needs.primitives.size(), 1u);
  return needs.primitives.at(0);
}

struct Row {
  const char* what;
  Json material;
  std::vector<std::string> rules, pointers;
  bool derivable;
};

// Rules of the glTF 2.0 specification and its extensions, read in their texts: those that mention tangents.
const std::vector<Row>& rows() {
  static const std::vector<Row> result{
      {"nothing", Json::object(), {}, {}, false},
      {"base colour, occlusion and emission alone",
       {{"pbrMetallicRoughness", {{"baseColorTexture", texture()}}},
        {"occlusionTexture", texture()},
        {"emissiveTexture", texture()}},
       {},
       {},
       false},
      {"normal texture",
       {{"normalTexture", texture()}},
       {"normal_texture"},
       {"/materials/0/normalTexture"},
       true},
      {"clearcoat without a normal texture",
       extension("KHR_materials_clearcoat", {{"clearcoatFactor", 1}}),
       {},
       {},
       false},
      {"clearcoat's normal texture",
       extension("KHR_materials_clearcoat", {{"clearcoatFactor", 1}, {"clearcoatNormalTexture", texture()}}),
       {"clearcoat_normal_texture"},
       {"/materials/0/extensions/KHR_materials_clearcoat/clearcoatNormalTexture"},
       true},
      {"anisotropy without a texture",
       extension("KHR_materials_anisotropy", {{"anisotropyStrength", 0.5}}),
       {"anisotropy"},
       {"/materials/0/extensions/KHR_materials_anisotropy"},
       false},
      {"anisotropy's texture",
       extension("KHR_materials_anisotropy", {{"anisotropyStrength", 0.5}, {"anisotropyTexture", texture()}}),
       {"anisotropy"},
       {"/materials/0/extensions/KHR_materials_anisotropy/anisotropyTexture"},
       false},
      {"anisotropy with a normal texture",
       {{"normalTexture", texture()},
        {"extensions", {{"KHR_materials_anisotropy", {{"anisotropyStrength", 0.5}}}}}},
       {"normal_texture", "anisotropy"},
       {"/materials/0/normalTexture", "/materials/0/extensions/KHR_materials_anisotropy"},
       true},
      {"anisotropy with the clearcoat's normal texture alone",
       {{"extensions",
         {{"KHR_materials_anisotropy", {{"anisotropyStrength", 0.5}}},
          {"KHR_materials_clearcoat", {{"clearcoatFactor", 1}, {"clearcoatNormalTexture", texture()}}}}}},
       {"clearcoat_normal_texture", "anisotropy"},
       {"/materials/0/extensions/KHR_materials_clearcoat/clearcoatNormalTexture",
        "/materials/0/extensions/KHR_materials_anisotropy"},
       false},
      {"packed normals",
       extension("MSFT_packing_normalRoughnessMetallic", {{"normalRoughnessMetallicTexture", texture()}}),
       {"packed_normal_texture"},
       {"/materials/0/extensions/MSFT_packing_normalRoughnessMetallic/normalRoughnessMetallicTexture"},
       true},
      {"packed occlusion with normals",
       extension("MSFT_packing_occlusionRoughnessMetallic", {{"normalTexture", texture()}}),
       {"packed_normal_texture"},
       {"/materials/0/extensions/MSFT_packing_occlusionRoughnessMetallic/normalTexture"},
       true},
      {"unlit, with a normal texture for other viewers",
       {{"normalTexture", texture()}, {"extensions", {{"KHR_materials_unlit", Json::object()}}}},
       {},
       {},
       false},
      {"iridescence, sheen, transmission, volume, specular, dispersion",
       {{"extensions",
         {{"KHR_materials_iridescence", {{"iridescenceTexture", texture()}}},
          {"KHR_materials_sheen", {{"sheenColorTexture", texture()}}},
          {"KHR_materials_transmission", {{"transmissionTexture", texture()}}},
          {"KHR_materials_volume", {{"thicknessTexture", texture()}}},
          {"KHR_materials_specular", {{"specularTexture", texture()}}},
          {"KHR_materials_dispersion", {{"dispersion", 0.1}}}}}},
       {},
       {},
       false}};
  return result;
}

TEST(TangentNeed, EveryRuleOfTheTable) {
  for (const Row& row : rows()) {
    SCOPED_TRACE(row.what);
    Json json = document(row.material);
    for (const bool carried : {true, false}) {
      if (!carried) attributes_of(json).erase("TANGENT");
      const PrimitiveNeed p = only(json);
      std::vector<std::string> rules, pointers;
      for (const NeedReason& r : p.reasons) {
        rules.push_back(r.rule);
        pointers.push_back(r.pointer);
        EXPECT_TRUE(json.contains(Json::json_pointer(r.pointer))) << r.pointer;
      }
      EXPECT_EQ(rules, row.rules);
      EXPECT_EQ(pointers, row.pointers);
      EXPECT_EQ(p.need, row.rules.empty() ? (carried ? TangentNeed::idle : TangentNeed::none)
                                          : (carried ? TangentNeed::needed : TangentNeed::missing));
      EXPECT_EQ(p.carried, carried);
      EXPECT_EQ(p.derivable, row.derivable);
      EXPECT_EQ(p.triangles, 2u);
      EXPECT_EQ(p.tangent_bytes, carried ? 64u : 0u);
      EXPECT_TRUE(p.in_scene);
    }
  }
}

TEST(TangentNeed, IsWhatReadersOfMeshesAreTold) {
  for (const Row& row : rows()) {
    SCOPED_TRACE(row.what);
    test::Builder b;
    const auto position = b.positions({0, 0, 0, 1, 0, 0, 0, 1, 0});
    b.primitive({{"POSITION", position}});
    b.json["materials"] = Json::array({row.material});
    b.json["meshes"][0]["primitives"][0]["material"] = 0;
    const TempFolder folder;
    const GltfDocument whole = GltfDocument::load(test::write_bytes(folder / "a.glb", b.glb()));
    EXPECT_EQ(whole.asset().primitives.at(0).needs_tangents, !row.rules.empty());
    EXPECT_EQ(tangent_need(whole).primitives.at(0).need,
              row.rules.empty() ? TangentNeed::none : TangentNeed::missing);
  }
}

TEST(TangentNeed, OfAVariantCountsLikeThePrimitivesOwn) {
  Json json = document();
  json["materials"].push_back({{"normalTexture", texture(1)}});
  primitive_of(json)["extensions"]["KHR_materials_variants"]["mappings"] = Json::array(
      {{{"material", 0}, {"variants", Json::array({0})}}, {{"material", 1}, {"variants", Json::array({1})}}});
  PrimitiveNeed p = only(json);
  EXPECT_EQ(p.need, TangentNeed::needed);
  ASSERT_EQ(p.reasons.size(), 1u);
  EXPECT_EQ(p.reasons[0].pointer, "/materials/1/normalTexture");
  EXPECT_EQ(p.reasons[0].texcoord, 1);
  EXPECT_FALSE(p.derivable) << "TEXCOORD_1 is missing";
  // An unlit material whose variant is lit needs a frame too.
  json["materials"][0]["extensions"]["KHR_materials_unlit"] = Json::object();
  EXPECT_EQ(only(json).need, TangentNeed::needed);
}

TEST(TangentNeed, NamesTheUvsOfTheTexture) {
  Json map = texture(0);
  map["extensions"]["KHR_texture_transform"] = {{"rotation", 0.5}, {"texCoord", 2}};
  Json json = document({{"normalTexture", map}});
  const PrimitiveNeed p = only(json);
  EXPECT_EQ(p.reasons.at(0).texcoord, 2);
  EXPECT_TRUE(p.reasons.at(0).transform);
  EXPECT_FALSE(p.derivable);
  attributes_of(json)["TEXCOORD_2"] = 3;
  EXPECT_TRUE(only(json).derivable);
}

TEST(TangentNeed, TangentsWithoutNormalsAreIdle) {
  Json json = document({{"normalTexture", texture()}});
  attributes_of(json).erase("NORMAL");
  PrimitiveNeed p = only(json);
  EXPECT_EQ(p.need, TangentNeed::idle);
  EXPECT_FALSE(p.derivable);
  attributes_of(json).erase("TANGENT");
  EXPECT_EQ(only(json).need, TangentNeed::missing);
}

TEST(TangentNeed, PointsAndLinesReadNoneStripsAndFansCount) {
  const std::size_t triangles[] = {0, 0, 0, 0, 2, 4, 4};
  Json json = document({{"normalTexture", texture()}});
  for (std::size_t mode = 0; mode <= 6; ++mode) {
    SCOPED_TRACE(mode);
    primitive_of(json)["mode"] = mode;
    const PrimitiveNeed p = only(json);
    EXPECT_EQ(p.need, mode < 4 ? TangentNeed::idle : TangentNeed::needed);
    EXPECT_EQ(p.triangles, triangles[mode]);
  }
}

TEST(TangentNeed, FactorsOfZeroSwitchOffUnlessAnimated) {
  struct Case {
    Json material;
    const char* pointer;  // of the factor
  };
  Json flat = texture();
  flat["scale"] = 0;
  const Case cases[] = {
      {{{"normalTexture", flat}}, "/materials/0/normalTexture/scale"},
      {extension("KHR_materials_clearcoat", {{"clearcoatNormalTexture", texture()}}),
       "/materials/0/extensions/KHR_materials_clearcoat/clearcoatFactor"},
      {extension("KHR_materials_clearcoat", {{"clearcoatFactor", 1}, {"clearcoatNormalTexture", flat}}),
       "/materials/0/extensions/KHR_materials_clearcoat/clearcoatNormalTexture/scale"},
      {extension("KHR_materials_anisotropy", {{"anisotropyTexture", texture()}}),
       "/materials/0/extensions/KHR_materials_anisotropy/anisotropyStrength"}};
  for (const Case& c : cases) {
    SCOPED_TRACE(c.pointer);
    Json json = document(c.material);
    EXPECT_EQ(only(json).need, TangentNeed::needed) << "spec";
    EXPECT_EQ(only(json, NeedLevel::factors).need, TangentNeed::idle);
    json["animations"] = Json::array(
        {{{"channels",
           Json::array({{{"sampler", 0},
                         {"target",
                          {{"path", "pointer"},
                           {"extensions", {{"KHR_animation_pointer", {{"pointer", c.pointer}}}}}}}}})},
          {"samplers", Json::array()}}});
    EXPECT_EQ(only(json, NeedLevel::factors).need, TangentNeed::needed);
    json["animations"][0]["channels"][0]["target"]["extensions"]["KHR_animation_pointer"]["pointer"] =
        "/materials/1/normalTexture/scale";
    EXPECT_EQ(only(json, NeedLevel::factors).need, TangentNeed::idle) << "another material's";
  }
  Json json = document({{"normalTexture", texture()}});
  EXPECT_EQ(only(json, NeedLevel::factors).need, TangentNeed::needed) << "a scale of 1 by default";
}

TEST(TangentNeed, AFlatNormalTextureStillGivesAnisotropyItsFrame) {
  Json flat = texture();
  flat["scale"] = 0;
  Json json = document({{"normalTexture", flat},
                        {"extensions", {{"KHR_materials_anisotropy", {{"anisotropyStrength", 0.5}}}}}});
  for (const NeedLevel level : {NeedLevel::spec, NeedLevel::factors})
    EXPECT_TRUE(only(json, level).derivable);
}

TEST(TangentNeed, ScenesAreFollowedThroughNodesInCirclesToo) {
  Json json = document();
  json["meshes"].push_back(json["meshes"][0]);
  json["meshes"].push_back(json["meshes"][0]);
  json["nodes"] = Json::parse(R"([{"children": [1]}, {"mesh": 1, "children": [0]}, {"mesh": 2}])");
  const TangentNeeds needs = plan(json);
  EXPECT_FALSE(needs.primitives.at(0).in_scene);
  EXPECT_TRUE(needs.primitives.at(1).in_scene);
  EXPECT_FALSE(needs.primitives.at(2).in_scene);
  json.erase("scenes");
  for (const PrimitiveNeed& p : plan(json).primitives) EXPECT_FALSE(p.in_scene);
}

TEST(TangentNeed, BytesOfSharedAccessorsCountOnce) {
  Json json = document({{"normalTexture", texture()}});
  json["materials"].push_back(Json::object());
  Json idle = primitive_of(json);
  idle["material"] = 1;
  json["meshes"][0]["primitives"].push_back(idle);  // shares TANGENT with one that needs it
  TangentNeeds needs = plan(json);
  EXPECT_EQ(needs.totals.needed, 1u);
  EXPECT_EQ(needs.totals.idle, 1u);
  EXPECT_EQ(needs.totals.carried, 2u);
  EXPECT_EQ(needs.totals.tangent_bytes, 64u);
  EXPECT_EQ(needs.totals.idle_bytes, 0u);
  EXPECT_EQ(needs.totals.geometry_bytes, 4u * (12 + 12 + 16 + 8) + 12);
  // Of its own, with a morph target's.
  json["meshes"][0]["primitives"][1]["attributes"]["TANGENT"] = 5;
  json["meshes"][0]["primitives"][1]["targets"] = Json::array({{{"TANGENT", 6}}});
  needs = plan(json);
  EXPECT_EQ(needs.primitives[1].tangent_bytes, 64u + 48);
  EXPECT_EQ(needs.totals.tangent_bytes, 64u + 64 + 48);
  EXPECT_EQ(needs.totals.idle_bytes, 64u + 48);
}

TEST(TangentNeed, ReadsTheDocumentAlone) {
  // Neither buffers nor images are there.
  Json json = document({{"normalTexture", texture()}});
  json["buffers"] = Json::array({{{"uri", "nowhere.bin"}, {"byteLength", 1000000}}});
  json["images"] = Json::array({{{"uri", "nowhere.png"}}});
  EXPECT_EQ(only(json).need, TangentNeed::needed);
  const TempFolder folder;
  const std::string glb = test::make_glb(json.dump(), std::string(64, 'x'));  // not the bytes that it needs
  const std::string whole = test::write_bytes(folder / "a.glb", glb);
  EXPECT_EQ(tangent_need(whole).primitives.at(0).need, TangentNeed::needed);
  // A file that is cut off is refused, though nothing that is read is lost.
  const std::string cut = test::write_bytes(folder / "b.glb", glb.substr(0, glb.size() - 60));
  EXPECT_NE(test::refusal_of<FileError>([&] { tangent_need(cut); }).find("cut off"), std::string::npos);
}

TEST(TangentNeed, RefusesWhatContradictsItself) {
  const auto refusal = [](const Json& json) { return test::refusal_of<FileError>([&] { plan(json); }); };
  const Json good = document({{"normalTexture", texture()}});
  Json json = good;
  primitive_of(json)["material"] = 7;
  EXPECT_NE(refusal(json).find("meshes[0].primitives[0].material: expected 0 to 0"), std::string::npos)
      << refusal(json);
  json = good;
  attributes_of(json)["TANGENT"] = 70;
  EXPECT_NE(refusal(json).find("TANGENT"), std::string::npos) << refusal(json);
  json = good;
  json["nodes"][0]["mesh"] = -1;
  EXPECT_NE(refusal(json).find("nodes[0].mesh"), std::string::npos) << refusal(json);
  json = good;
  json["accessors"][0]["type"] = "VEC9";
  EXPECT_NE(refusal(json).find("VEC9"), std::string::npos) << refusal(json);
  json = good;
  json["accessors"][1]["count"] = std::uint64_t{1} << 60;  // whose bytes would wrap round 2^64
  EXPECT_NE(refusal(json).find("accessors[1].count"), std::string::npos) << refusal(json);
  json = good;
  attributes_of(json) = 3;
  EXPECT_NE(refusal(json).find("attributes"), std::string::npos) << refusal(json);
  const TempFolder folder;
  for (const std::string& bytes :
       {std::string("glTF"), std::string("glTF\2\0\0\0\xff\0\0\0\xff\xff\xff\x7fJSON", 20)})
    EXPECT_NE(test::refusal_of<FileError>([&] {
                tangent_need(test::write_bytes(folder / "short.glb", bytes));
              }).find("short.glb"),
              std::string::npos);
}

TEST(TangentNeed, FindsWhatWasDropped) {
  Json before = document({{"name", "steel"}, {"normalTexture", texture()}});
  before["meshes"].push_back(before["meshes"][0]);
  before["meshes"][1]["name"] = "other";
  Json after = before;
  EXPECT_TRUE(dropped_tangents(plan(before), plan(after)).empty());
  after["meshes"][1]["primitives"][0]["attributes"].erase("TANGENT");
  std::swap(after["meshes"][0], after["meshes"][1]);
  const TangentNeeds old = plan(before), now = plan(after);
  const std::vector<DroppedTangents> dropped = dropped_tangents(old, now);
  ASSERT_EQ(dropped.size(), 1u);
  EXPECT_EQ(dropped[0].before->mesh, 1u);
  EXPECT_EQ(dropped[0].after->mesh, 0u);
  // Names are gone: the material's says which.
  for (Json& mesh : after["meshes"]) mesh.erase("name");
  const TangentNeeds nameless = plan(after);
  EXPECT_EQ(dropped_tangents(old, nameless).size(), 1u);
  // What did not have it before was not dropped, nor what needs it no more.
  before["meshes"][1]["primitives"][0]["attributes"].erase("TANGENT");
  EXPECT_TRUE(dropped_tangents(plan(before), now).empty());
  after["materials"][0].erase("normalTexture");
  EXPECT_TRUE(dropped_tangents(old, plan(after)).empty());
}

// Documents of primitives in one mesh or in meshes of their own, named or not: 'n' needs and has TANGENT, 'm'
// lacks it, 'i' has it for nothing, '-' neither, 'x' needs it and has lost NORMAL.
Json primitives(const std::string& letters, bool own_meshes, bool names) {
  Json json = document({{"name", "steel"}, {"normalTexture", texture()}});
  json["materials"].push_back({{"name", "plain"}});
  const Json one = primitive_of(json);
  json["meshes"] = Json::array();
  json["nodes"] = json["scenes"] = Json::array();
  for (std::size_t k = 0; k < letters.size(); ++k) {
    Json p = one;
    const char c = letters[k];
    if (c == 'm' || c == '-') p["attributes"].erase("TANGENT");
    if (c == 'x') p["attributes"].erase("NORMAL");
    if (c == 'i' || c == '-') p["material"] = 1;
    if (own_meshes || k == 0) {
      json["meshes"].push_back({{"primitives", Json::array()}});
      if (names) json["meshes"].back()["name"] = own_meshes ? "m" + std::to_string(k) : "m";
    }
    json["meshes"].back()["primitives"].push_back(std::move(p));
  }
  return json;
}

TEST(TangentNeed, CountsWhatWasDroppedAmongPrimitivesThatAreAlike) {
  struct Case {
    const char *before, *after;
    std::size_t dropped;
  };
  for (const Case& c : {Case{"nm", "nm", 0},
                        {"nm", "mn", 0},
                        {"nm", "mm", 1},
                        {"nnn", "mmn", 2},
                        {"nnn", "n", 0},
                        {"nn", "m", 1},
                        {"nx", "nx", 0},
                        {"nn", "nx", 1},
                        {"n-", "n-", 0},
                        {"ni", "mi", 1},
                        {"m", "m", 0},
                        {"", "m", 0},
                        {"n", "", 0}})
    for (const bool own_meshes : {false, true})
      for (const bool names : {false, true}) {
        SCOPED_TRACE(std::string(c.before) + " " + c.after + (own_meshes ? " own" : "") +
                     (names ? " named" : ""));
        const TangentNeeds before = plan(primitives(c.before, own_meshes, names));
        // Names of their own tell which of them lost it, though another gained it.
        const bool swapped = own_meshes && names && std::string(c.after) == "mn";
        EXPECT_EQ(dropped_tangents(before, plan(primitives(c.after, own_meshes, names))).size(),
                  swapped ? 1 : c.dropped);
        // Merged and renamed.
        EXPECT_EQ(dropped_tangents(before, plan(primitives(c.after, !own_meshes, !names))).size(), c.dropped);
      }
}

TEST(TangentNeed, CountsTheVerticesThatMikkTSpaceSplits) {
  const TempFolder folder;
  const std::string path = test::write_bytes(folder / "a.glb", test::generated_gltf().glb());
  TangentNeeds needs = tangent_need(path);
  count_splits(path, needs);
  // By hand: 24 corners of mesh 0 primitive 0 share 9 vertices, and its tangents differ at three of them.
  for (const PrimitiveNeed& p : needs.primitives) {
    if (p.mesh == 0 && p.primitive == 0) {
      EXPECT_EQ(p.splits, 3u);
    } else {
      EXPECT_FALSE(p.splits) << p.mesh << ' ' << p.primitive;
    }
  }
}

}  // namespace
}  // namespace darboux::tangent_need_test
