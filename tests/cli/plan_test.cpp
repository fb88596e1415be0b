// `plan` against its contract.
#include "cli.h"
#include "generated_gltf.h"

namespace darboux::test::plan_test {
namespace {

// Mesh 0 primitive 0 reads a frame through TEXCOORD_0, the others read none; no TANGENT.
std::string made() {
  return generated_gltf().glb();
}

TEST_F(Cli, PlanSaysWhatIsMissingAndWhatIsIdle) {
  write_bytes(path("made.glb"), made());
  const Json report = json("darboux plan made.glb --json");
  expect_keys(report, {"files", "ok"});
  EXPECT_EQ(report["ok"], true) << "viewers make what is missing";
  const Json& file = report["files"][0];
  EXPECT_EQ(file["file"], "made.glb");
  expect_keys(file["totals"],
              {"needed", "carried", "missing", "idle", "tangent_bytes", "idle_bytes", "geometry_bytes"});
  const Json& p = file["primitives"][0];
  expect_keys(p, {"mesh", "primitive", "name", "need", "reasons", "carried", "derivable", "in_scene",
                  "triangles", "tangent_bytes", "splits"});
  EXPECT_EQ(p["need"], "missing");
  EXPECT_TRUE(p["splits"].is_null());
  expect_keys(p["reasons"][0], {"rule", "pointer", "texcoord", "transform", "derivable", "note"});
  EXPECT_EQ(p["reasons"][0]["pointer"], "/materials/0/normalTexture");
  EXPECT_EQ(json("darboux plan made.glb --splits --json")["files"][0]["primitives"][0]["splits"], 3);
  EXPECT_EQ(json("darboux plan made.glb --strict --json", 1)["ok"], false);

  good("darboux tangents made.glb -o all.glb");
  const Json all = json("darboux plan all.glb --strict --json")["files"][0];
  EXPECT_EQ(all["totals"]["needed"], 1);
  EXPECT_EQ(all["totals"]["idle"], all["totals"]["carried"].get<int>() - 1);
  EXPECT_NE(good("darboux plan all.glb").find("of TANGENT that nothing reads"), std::string::npos);
  good("darboux tangents made.glb -o needed.glb --only needed");
  const Json needed = json("darboux plan needed.glb --strict --json")["files"][0]["totals"];
  EXPECT_EQ(needed["needed"], 1);
  EXPECT_EQ(needed["idle"], 0);
}

// plan reads the document alone, and still sees that the rest is missing.
TEST_F(Cli, PlanRefusesAFileThatIsCutOff) {
  const std::string whole = made();
  write_bytes(path("cut.glb"), whole.substr(0, whole.size() - 8));
  refused("darboux plan cut.glb", {"cut.glb", std::to_string(whole.size()), "the file is cut off"});
}

TEST_F(Cli, PlanAtLevelPixelsSaysWhichImagesItCouldNotLookAt) {
  Builder b = generated_gltf();
  b.json["textures"] = Json::array({{{"source", 0}}});
  b.json["images"] = Json::array({{{"uri", "map.jpg"}}});
  write_bytes(path("made.glb"), b.glb());
  write_bytes(path("map.jpg"), "\xff\xd8\xff");
  const Json p = json("darboux plan made.glb --level pixels --json")["files"][0]["primitives"][0];
  EXPECT_EQ(p["need"], "missing");
  EXPECT_EQ(p["reasons"][0]["note"], "image 0 is not a PNG, so that its texels are not looked at");
  EXPECT_NE(good("darboux plan made.glb --level pixels").find("image 0 is not a PNG"), std::string::npos);
  EXPECT_NE(good("darboux plan made.glb --level pixels").find("1 normal map could not be looked at"),
            std::string::npos);
}

// `validate` and `plan` say the same of each primitive.
TEST_F(Cli, ValidateSaysWhetherTangentsAreNeededAndJudgesThoseAlone) {
  write_bytes(path("made.glb"), made());
  good("darboux tangents made.glb -o all.glb");
  const Json planned = json("darboux plan all.glb --json")["files"][0]["primitives"];
  std::map<std::pair<int, int>, bool> needed;
  for (const Json& p : planned) needed[{p["mesh"], p["primitive"]}] = !p["reasons"].empty();
  const Json all = Json::parse(sh("darboux validate all.glb --json").out)["files"][0];
  std::size_t judged = 0;
  for (const Json& m : all["meshes"]) {
    EXPECT_EQ(m["needs_tangents"], (needed.at({m["mesh"], m["primitive"]})));
    judged += m["needs_tangents"].get<bool>();
  }
  EXPECT_GT(judged, 0u);
  EXPECT_LT(judged, all["meshes"].size());
  const Json only = Json::parse(sh("darboux validate all.glb --only needed --json").out)["files"][0];
  EXPECT_EQ(only["meshes"].size(), judged);
  EXPECT_GT(only["skipped"].size(), all["skipped"].size());
  EXPECT_NE(sh("darboux validate all.glb --only needed").out.find("the material reads no tangents"),
            std::string::npos);
  // What is left out is no worse than it was.
  good("darboux tangents data/torus_032.mikk.glb -o idle.glb");
  good("darboux validate idle.glb --json > base.json");
  good("darboux validate idle.glb --only needed --baseline base.json");
  // Other formats do not say, and are judged whole.
  const Json obj = json("darboux validate data/sphere_016.obj --only needed --json")["files"][0];
  ASSERT_EQ(obj["meshes"].size(), 1u);
  EXPECT_TRUE(obj["meshes"][0]["needs_tangents"].is_null());
}

TEST_F(Cli, PlanFailsWhereViewersCannotMakeWhatIsMissing) {
  Builder b = generated_gltf();
  b.json["meshes"][0]["primitives"][0]["attributes"].erase("TEXCOORD_0");
  write_bytes(path("no_uvs.glb"), b.glb());
  EXPECT_NE(good("darboux plan no_uvs.glb", 1).find("viewers cannot make one"), std::string::npos);
}

TEST_F(Cli, PlanFindsWhatAToolBetweenDropped) {
  write_bytes(path("made.glb"), made());
  good("darboux tangents made.glb -o before.glb");
  const Json report = json("darboux plan made.glb --against before.glb --sarif log.sarif --json", 1);
  ASSERT_EQ(report["files"][0]["dropped"].size(), 1u);
  EXPECT_EQ(report["files"][0]["dropped"][0]["mesh"], 0);
  const Json log = Json::parse(read_bytes(path("log.sarif")));
  EXPECT_EQ(log["version"], "2.1.0");
  std::size_t dropped = 0;
  for (const Json& result : log["runs"][0]["results"]) dropped += result["ruleId"] == "TANGENT_DROPPED";
  EXPECT_EQ(dropped, 1u);
  EXPECT_TRUE(json("darboux plan before.glb --against before.glb --json")["files"][0]["dropped"].empty());
}

TEST_F(Cli, PlanReadsFoldersAndKeepsItShort) {
  const std::string text = good("darboux plan data");
  EXPECT_NE(text.find("\nall 16 files: no primitive needs TANGENT; 14 store it unused ("), std::string::npos)
      << text;
  EXPECT_EQ(text.find(".obj"), std::string::npos);
}

TEST_F(Cli, PlanTellsFilesApart) {
  write_bytes(path("made.glb"), made());
  fs::create_directory(path("some"));
  good("darboux tangents made.glb -o before.glb");
  good("darboux tangents made.glb -o some/needed.glb --only needed --quiet");
  for (const std::string name : {"some/one.glb", "some/two.glb"})
    write_bytes(path(name), one_triangle().glb());
  // A name that a stranger gave says nothing of its own.
  fs::copy_file(path("made.glb"), path("some/a\nall 9 files: fine.glb"));
  const std::string text = good("darboux plan some");
  EXPECT_EQ(text.find("\nall 9 files"), std::string::npos) << text;
  EXPECT_EQ(
      text.rfind("some/a\\x0Aall 9 files: fine.glb: 1 primitive needs TANGENT: 0 with it, 1 without\n", 0),
      0u)
      << text;
  EXPECT_NE(text.find("\n1 file has TANGENT where it is needed and nowhere else\n"
                      "2 files need no TANGENT and have none\n"
                      "all 4 files: 2 primitives need TANGENT: 1 with it, 1 without\n"),
            std::string::npos)
      << text;

  const std::string splits = good("darboux plan made.glb --splits");
  EXPECT_NE(splits.find("/materials/0/normalTexture, TEXCOORD_0; MikkTSpace splits 3 vertices\n"),
            std::string::npos)
      << splits;
  const std::string against = good("darboux plan made.glb --against before.glb", 1);
  EXPECT_NE(against.find("\n  dropped: mesh 0 primitive 0 (made by hand): the earlier file had the TANGENT"),
            std::string::npos)
      << against;
}

TEST_F(Cli, PlanShortensWhatCanBeLeftOut) {
  Builder b;
  const Json attributes{{"POSITION", b.positions({0, 0, 0, 1, 0, 0, 0, 1, 0})},
                        {"TANGENT", b.packed<float>("VEC4", 5126, 3, {1, 0, 0, 1, 1, 0, 0, 1, 1, 0, 0, 1})}};
  for (int i = 0; i < 6; ++i) b.primitive(attributes);
  write_bytes(path("idle.glb"), b.glb());
  const std::vector<std::string> text = lines(good("darboux plan idle.glb --sarif log.sarif"));
  ASSERT_EQ(text.size(), 6u);
  EXPECT_EQ(text[4],
            "  mesh 0 primitive 3 (made by hand): 48 bytes of TANGENT that nothing reads (in no scene)");
  EXPECT_EQ(text[5], "  and 2 more with TANGENT that nothing reads");
  const Json results = Json::parse(read_bytes(path("log.sarif")))["runs"][0]["results"];
  ASSERT_EQ(results.size(), 6u);
  for (const Json& result : results) EXPECT_EQ(result["ruleId"], "TANGENT_IDLE");
}

TEST_F(Cli, PlanRefuses) {
  refused("darboux plan", {"plan", "FILES"});
  refused("darboux plan data/torus_016.obj", {"torus_016.obj", "glTF"});
  refused("darboux plan data/torus_016.none.glb --level all", {"--level", "spec", "factors"});
  refused("darboux plan data --against data/torus_016.none.glb", {"--against", "one file"});
  // What is read is not written to.
  good("cp data/torus_016.none.glb before.glb");
  refused("darboux plan data/torus_016.none.glb --against before.glb --sarif before.glb", {"--sarif"});
  EXPECT_EQ(read_bytes(path("before.glb")), read_bytes(path("data/torus_016.none.glb")));
  fs::create_directory(path("empty"));
  EXPECT_EQ(sh("darboux plan empty").status, 2);
  const Result r = sh("darboux plan none.glb");
  EXPECT_EQ(r.status, 2);
  expect_one_line(r.err);
}

}  // namespace
}  // namespace darboux::test::plan_test
