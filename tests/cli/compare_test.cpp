// `compare` against its contract.
#include "cli.h"

namespace darboux::test::compare_test {
namespace {

const std::vector<std::string> pair_keys{"mesh",
                                         "primitive",
                                         "name",
                                         "mesh_b",
                                         "primitive_b",
                                         "corners",
                                         "corners_b",
                                         "matched",
                                         "unmatched",
                                         "unmatched_b",
                                         "texcoord",
                                         "tangents",
                                         "equal_bits",
                                         "tangent_deg",
                                         "equal_directions",
                                         "sign",
                                         "opposite_signs",
                                         "no_direction",
                                         "conventions",
                                         "matched_with_v_flipped",
                                         "worst",
                                         "same"};

TEST_F(Cli, CompareSaysWhenFilesAreTheSame) {
  for (const std::string name : {"torus_032.three.glb", "sphere_032.mikk.glb", "mirrortorus_016.mikk.glb"}) {
    const Json report = json("darboux compare data/" + name + " data/" + name + " --json");
    expect_keys(report, {"files", "max_angle_deg", "pairs", "only_a", "only_b", "same"});
    EXPECT_EQ(report["same"], true);
    ASSERT_EQ(report["pairs"].size(), 1u);
    const Json& pair = report["pairs"][0];
    expect_keys(pair, pair_keys);
    EXPECT_EQ(pair["matched"], pair["corners"]);
    EXPECT_EQ(pair["equal_bits"], 1.0);
    EXPECT_EQ(pair["sign"], "same");
    EXPECT_EQ(pair["tangent_deg"], (Json{{"max", 0.0}, {"rms", 0.0}, {"p95", 0.0}}));
    EXPECT_TRUE(pair["worst"].is_null());
  }
  EXPECT_EQ(good("darboux compare data/torus_032.three.glb data/torus_032.three.glb"),
            "same: a = data/torus_032.three.glb, b = data/torus_032.three.glb\n"
            "  mesh 0 primitive 0: same, all 12288 corners matched\n"
            "    bit-equal at 100 % of 12288 corners\n");
}

// `validate` measures otherwise: inside the mesh three.js is up to 0.0764 degrees from the truth, MikkTSpace
// up to 2.4e-5. At the seam, where both are farther off, they agree. So the largest angle is the first to
// within the second.
TEST_F(Cli, CompareTellsThreeJsFromMikkTSpace) {
  const std::string files = "data/torus_032.three.glb data/torus_032.mikk.glb";
  const Json report = json("darboux compare " + files + " --json", 1), pair = report["pairs"][0];
  EXPECT_EQ(report["same"], false);
  expect_keys(pair, pair_keys);
  EXPECT_EQ(pair["corners"], 12288);
  EXPECT_EQ(pair["matched"], 12288);
  EXPECT_EQ(pair["sign"], "opposite");
  EXPECT_EQ(pair["conventions"], (Json{"raw", "gltf"}));
  EXPECT_EQ(pair["equal_bits"], 0.0);
  EXPECT_GT(pair["equal_directions"], 0.0);
  EXPECT_GT(pair["tangent_deg"]["max"], 0.0763);
  EXPECT_LT(pair["tangent_deg"]["max"], 0.0765);
  EXPECT_LT(pair["tangent_deg"]["rms"], pair["tangent_deg"]["p95"]);
  expect_keys(pair["worst"], {"vertex", "vertex_b", "u", "v", "position", "deg", "tangent_a", "tangent_b"});
  EXPECT_EQ(pair["worst"]["deg"], pair["tangent_deg"]["max"]);
  const std::string text = good("darboux compare " + files, 1);
  EXPECT_NE(text.find("signs opposite everywhere (a writes raw, b gltf)"), std::string::npos) << text;
  // Signs are never excused; with equal signs an angle is.
  json("darboux compare " + files + " --max-angle 180 --json", 1);
  good("darboux tangents data/torus_016.none.glb -o mikk.glb --quiet");
  good("darboux tangents data/torus_016.none.glb -o average.glb --method average --quiet");
  const double most =
      json("darboux compare mikk.glb average.glb --json", 1)["pairs"][0]["tangent_deg"]["max"];
  EXPECT_GT(most, 0);
  good("darboux compare mikk.glb average.glb --max-angle " + std::to_string(most * 1.01));
  good("darboux compare mikk.glb average.glb --max-angle " + std::to_string(most * 0.99), 1);
}

// Another tool's MikkTSpace is this one, to the bit.
TEST_F(Cli, CompareFindsMikkTSpaceEqualToTheBit) {
  good("darboux tangents data/torus_032.three.glb -o ours.glb --quiet");
  good("darboux compare ours.glb data/torus_032.mikk.glb");
}

TEST_F(Cli, CompareSaysWhyNot) {
  const auto text = [&](const std::string& a, const std::string& b) {
    return good("darboux compare " + a + " " + b, 1);
  };
  const auto has = [](const std::string& text, const std::string& words) {
    EXPECT_NE(text.find(words), std::string::npos) << words << " in " << text;
  };
  has(text("data/torus_016.none.glb", "data/torus_016.three.glb"), "a has no tangents");
  const std::string neither = text("data/torus_016.none.glb", "data/torus_016.none.glb");
  has(neither, "neither has tangents");
  EXPECT_EQ(neither.find("nothing compared: a = "), 0u) << neither;
  has(text("data/sphere_016.three.glb", "data/torus_016.three.glb"),
      "2880 at positions that b does not have");
  write_bytes(path("none.gltf"), R"({"asset": {"version": "2.0"}})");
  has(text("none.gltf", "none.gltf"), "neither holds triangles");
  has(text("none.gltf", "data/torus_016.three.glb"), "mesh 0 primitive 0 of b has no counterpart, 3072");
  EXPECT_EQ(json("darboux compare none.gltf none.gltf --json", 1)["same"], false);
  EXPECT_EQ(lines(good("darboux compare none.gltf none.gltf --quiet", 1)).size(), 1u);
}

TEST_F(Cli, CompareTellsThatVIsFlippedAndAnotherUvSetIsRead) {
  const auto make = [&](const std::string& name, float top, bool second_set) {
    Builder b;
    const auto position = b.positions({0, 0, 0, 1, 0, 0, 0, 1, 0});
    const auto normal = b.packed<float>("VEC3", 5126, 3, {0, 0, 1, 0, 0, 1, 0, 0, 1});
    const auto tangent = b.packed<float>("VEC4", 5126, 3, {1, 0, 0, 1, 1, 0, 0, 1, 1, 0, 0, 1});
    const auto uv = b.packed<float>("VEC2", 5126, 3, {0, 1 - top, 1, 1 - top, 0, top});
    const auto other = b.packed<float>("VEC2", 5126, 3, {0, 0, 0.5, 0.25, 0.125, 0.75});
    Json more = Json::object();
    if (second_set) {
      b.json["materials"] = {{{"normalTexture", {{"index", 0}, {"texCoord", 1}}}}};
      b.json["textures"] = {Json::object()};
      more["material"] = 0;
    }
    b.primitive({{"POSITION", position},
                 {"NORMAL", normal},
                 {"TANGENT", tangent},
                 {"TEXCOORD_0", uv},
                 {"TEXCOORD_1", other}},
                more);
    write_bytes(path(name), b.glb());
  };
  make("up.glb", 1, false);
  make("down.glb", 0, false);
  make("second.glb", 1, true);
  std::string text = good("darboux compare up.glb down.glb", 1);
  EXPECT_NE(text.find("with v flipped in b (1 - v) 3 corners would match"), std::string::npos) << text;
  EXPECT_NE(text.find("3 at the same positions but other uvs\n"), std::string::npos) << text;
  text = good("darboux compare up.glb second.glb", 1);
  EXPECT_NE(text.find("TEXCOORD_0 in a, TEXCOORD_1 in b"), std::string::npos) << text;
  EXPECT_EQ(json("darboux compare up.glb second.glb --json", 1)["pairs"][0]["texcoord"], (Json{0, 1}));
}

// One triangle, as it is and as it is changed.
TEST_F(Cli, CompareNamesWhatOneFileLacks) {
  const auto make = [&](const std::string& name, std::initializer_list<float> tangents,
                        const std::vector<std::string>& without = {}) {
    Builder b;
    Json attributes{{"POSITION", b.positions({0, 0, 0, 1, 0, 0, 0, 1, 0})},
                    {"NORMAL", b.packed<float>("VEC3", 5126, 3, {0, 0, 1, 0, 0, 1, 0, 0, 1})},
                    {"TEXCOORD_0", b.packed<float>("VEC2", 5126, 3, {0, 0, 1, 0, 0, 1})},
                    {"TANGENT", b.packed<float>("VEC4", 5126, 3, tangents)}};
    for (const std::string& attribute : without) attributes.erase(attribute);
    b.primitive(attributes);
    b.primitive(attributes, {{"mode", 0}});
    write_bytes(path(name), b.glb());
  };
  make("whole.glb", {1, 0, 0, 1, 1, 0, 0, 1, 1, 0, 0, 1});
  make("no_uvs.glb", {1, 0, 0, 1, 1, 0, 0, 1, 1, 0, 0, 1}, {"TEXCOORD_0"});
  make("no_normals.glb", {1, 0, 0, 1, 1, 0, 0, 1, 1, 0, 0, 1}, {"NORMAL"});
  make("zero.glb", {1, 0, 0, 1, 0, 0, 0, 1, 1, 0, 0, -1});
  make("turned.glb", {1, 0, 0, 1, 1, 0, 0, 1, 0, 1, 0, 1});

  write_bytes(path("none.gltf"), R"({"asset": {"version": "2.0"}})");

  const auto expect_lines = [&](const std::string& files, const std::string& expected) {
    const std::string points = " not compared: mode 0 (points) has no triangles\n";
    const std::string text = good("darboux compare " + files, 1);
    EXPECT_EQ(text.substr(text.find('\n') + 1), "  mesh 0 primitive 0 (made by hand): not the same, " +
                                                    expected + "  mesh 0 primitive 1 of a" + points +
                                                    "  mesh 0 primitive 1 of b" + points);
  };
  const auto unmatched = [](const std::string& other, const std::string& lacks) {
    return "0 corners matched of 3 in a and 3 in b\n"
           "    unmatched in a: 3 at the same positions but other " +
           other + "\n    unmatched in b: 3 at the same positions but other " + other + "\n    " + lacks +
           '\n';
  };
  expect_lines("whole.glb no_uvs.glb", unmatched("uvs", "b has no uvs"));
  expect_lines("no_uvs.glb whole.glb", unmatched("uvs", "a has no uvs"));
  expect_lines("whole.glb no_normals.glb", unmatched("normals", "b has no normals"));
  expect_lines("no_normals.glb whole.glb", unmatched("normals", "a has no normals"));
  expect_lines("whole.glb zero.glb",
               "all 3 corners matched\n"
               "    bit-equal at 33.3 % of 3 corners, but for the sign at 66.7 %\n"
               "    tangents differ by 0 deg rms, 0 max at vertex 2 of a, uv 0 1, position 0 1 0\n"
               "    signs opposite at 1 corner\n"
               "    tangents that are zero or not finite, in a or in b, at 1 corner\n");
  expect_lines("whole.glb turned.glb",  // 90 / sqrt(3) = 52.0
               "all 3 corners matched\n"
               "    bit-equal at 66.7 % of 3 corners\n"
               "    tangents differ by 52 deg rms, 90 max at vertex 2 of a, uv 0 1, position 0 1 0\n"
               "    signs the same everywhere\n");

  const Json skipped{{{"mesh", 0}, {"primitive", 1}, {"reason", "mode 0 (points) has no triangles"}}},
      left_over{{{"mesh", 0}, {"primitive", 0}, {"name", "made by hand"}, {"corners", 3}}};
  Json report = json("darboux compare whole.glb none.gltf --json", 1);
  EXPECT_EQ(report["only_a"], left_over);
  EXPECT_EQ(report["only_b"], Json::array());
  EXPECT_EQ(report["skipped_a"], skipped);
  EXPECT_EQ(report["skipped_b"], Json::array());
  report = json("darboux compare none.gltf whole.glb --json", 1);
  EXPECT_EQ(report["only_a"], Json::array());
  EXPECT_EQ(report["only_b"], left_over);
  EXPECT_EQ(report["skipped_b"], skipped);
}

TEST_F(Cli, CompareRefusesWrongUsage) {
  refused("darboux compare", {"A"});
  refused("darboux compare data/torus_016.three.glb", {"B"});
  refused("darboux compare missing.glb data/torus_016.three.glb", {"missing.glb"});
  refused("darboux compare data/torus_016.three.glb missing.glb --json", {"missing.glb"});
  for (const std::string angle : {"-1", "nan", "181", "x", "inf"})
    refused("darboux compare data/torus_016.three.glb data/torus_016.three.glb --max-angle " + angle,
            {"--max-angle"});
}

}  // namespace
}  // namespace darboux::test::compare_test
