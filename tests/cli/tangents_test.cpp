// `tangents` against its contract.
#include "cli.h"
#include "generated_gltf.h"

namespace darboux::test::tangents_test {
namespace {

TEST_F(Cli, TangentsOfMikkTSpaceInGltfsSignAreTheDefault) {
  const Json written = json("darboux tangents data/torus_016.none.glb -o out.glb --json");
  EXPECT_EQ(written["file"], "out.glb");
  EXPECT_EQ(written["method"], "mikktspace");
  EXPECT_EQ(written["sign"], "gltf");
  EXPECT_TRUE(written["skipped"].empty());
  ASSERT_EQ(written["primitives"].size(), 1u);
  expect_keys(written["primitives"][0],
              {"mesh", "primitive", "name", "corners", "old_vertices", "vertices", "morph_targets",
               "degenerate_triangles", "degenerate_uv_triangles", "fallback_corners"});
  EXPECT_EQ(written["primitives"][0]["corners"], 3072);
  EXPECT_EQ(written["primitives"][0]["fallback_corners"], 0);
  good("darboux tangents data/torus_016.none.glb -o named.glb --method mikktspace --sign gltf --threads 2");
  EXPECT_EQ(read_bytes(path("out.glb")), read_bytes(path("named.glb")));
  const Json mesh = only_mesh(Json::parse(sh("darboux validate out.glb --json").out));
  EXPECT_EQ(mesh["handedness"]["convention"], "gltf");
  EXPECT_EQ(good("darboux tangents data/torus_016.none.glb -o - --quiet"), read_bytes(path("out.glb")));
  EXPECT_EQ(sh("darboux tangents data/torus_016.none.glb -o -").out, read_bytes(path("out.glb")))
      << "words among the bytes";
}

TEST_F(Cli, TangentsSaysWhatItLeavesAlone) {
  write_bytes(path("made.glb"), generated_gltf().glb());
  EXPECT_EQ(
      good("darboux tangents made.glb -o out.glb"),
      "mesh 0 primitive 0: 24 corners, 12 vertices (9 before: those whose corners have several tangents were "
      "split), 2 morph targets\n"
      "mesh 0 primitive 1: 6 corners, 9 vertices, 2 morph targets\n"
      "mesh 1 primitive 0: 12 corners, 9 vertices\n"
      "out.glb\n");
  const std::string only = good("darboux tangents made.glb -o out.glb --only needed");
  EXPECT_NE(only.find("mesh 0 primitive 1 left alone: its material reads no tangents\n"), std::string::npos);
  EXPECT_NE(only.find("mesh 1 primitive 0 left alone: its material reads no tangents\n"), std::string::npos);
  // Nothing needs them: that holds. Something does, and has no uvs: it does not.
  Builder b = generated_gltf();
  b.json["materials"][0].erase("normalTexture");
  write_bytes(path("unneeded.glb"), b.glb());
  EXPECT_TRUE(json("darboux tangents unneeded.glb -o out.glb --only needed --json")["primitives"].empty());
  b = generated_gltf();
  b.json["meshes"][0]["primitives"][0]["attributes"].erase("TEXCOORD_0");
  write_bytes(path("no_uvs.glb"), b.glb());
  EXPECT_EQ(json("darboux tangents no_uvs.glb -o out.glb --only needed --json", 1)["skipped"][0]["reason"],
            "has no uvs");
  const std::string none = ": no tangents were added: no primitive that needs them has the triangles";
  EXPECT_NE(good("darboux tangents no_uvs.glb -o out.glb --only needed", 1).find("out.glb" + none),
            std::string::npos);
  EXPECT_NE(sh("darboux tangents no_uvs.glb -o - --only needed").err.find("standard output" + none),
            std::string::npos);
  const Result quiet = sh("darboux tangents no_uvs.glb -o out.glb --only needed --quiet");
  EXPECT_EQ(quiet.status, 1);
  EXPECT_EQ(quiet.out, "");
  EXPECT_NE(quiet.err.find("out.glb" + none), std::string::npos);
  const Result unneeded = sh("darboux tangents unneeded.glb -o out.glb --only needed --quiet");
  EXPECT_EQ(unneeded.status, 0);
  EXPECT_EQ(unneeded.out + unneeded.err, "");
  EXPECT_EQ(good("darboux tangents unneeded.glb -o out.glb --only needed").find("no tangents were added"),
            std::string::npos);
  refused("darboux tangents made.glb -o out.glb --only some", {"--only", "needed"});
  refused("darboux tangents made.glb -o x.gltf", {"x.gltf", "GLB"});
}

TEST_F(Cli, TangentsDropsWhatNothingReads) {
  write_bytes(path("made.glb"), generated_gltf().glb());
  good("darboux tangents made.glb -o all.glb");
  const Json report = json("darboux tangents all.glb -o needed.glb --only needed --drop-idle --json");
  EXPECT_EQ(report["dropped"].size(), 2u);
  EXPECT_GT(report["dropped_bytes"], 0);
  const Json totals = json("darboux plan needed.glb --strict --json")["files"][0]["totals"];
  EXPECT_EQ(totals["needed"], 1);
  EXPECT_EQ(totals["idle"], 0);
  EXPECT_NE(good("darboux tangents all.glb -o needed.glb --only needed --drop-idle")
                .find("mesh 0 primitive 1: TANGENT dropped: nothing reads its tangents\n"),
            std::string::npos);
  refused("darboux tangents all.glb -o x.glb --drop-idle", {"--drop-idle", "--only needed"});
  EXPECT_FALSE(fs::exists(path("x.glb")));
}

// Two triangles of a square, whose second has no area in uv.
TEST_F(Cli, TangentsSaysWhereTheMethodHasNoDirection) {
  Builder b;
  b.primitive(
      {{"POSITION", b.positions({0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 0, 0, 1, 1, 0, 0, 1, 0})},
       {"NORMAL", b.packed<float>("VEC3", 5126, 6, {0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1})},
       {"TEXCOORD_0", b.packed<float>("VEC2", 5126, 6, {0, 0, 1, 0, 1, 1, 0, 0, 0, 0, 0, 0})}});
  write_bytes(path("folded.glb"), b.glb());
  EXPECT_EQ(good("darboux tangents folded.glb -o out.glb --method average"),
            "mesh 0 primitive 0: 6 corners, 6 vertices; at 3 corners the method has no direction: an "
            "arbitrary one was written\nout.glb\n");
}

// An extension that is not known may count accessors, so that none may move.
TEST_F(Cli, TangentsSaysWhyBytesStay) {
  Builder b;
  b.primitive({{"POSITION", b.positions({0, 0, 0, 1, 0, 0, 0, 1, 0})},
               {"TANGENT", b.packed<float>("VEC4", 5126, 3, {1, 0, 0, 1, 1, 0, 0, 1, 1, 0, 0, 1})}});
  b.json["extensionsUsed"] = {"EXT_of_others"};
  write_bytes(path("idle.glb"), b.glb());
  const auto text = [&](const std::string& of_bytes) {
    return "mesh 0 primitive 0: TANGENT dropped: nothing reads its tangents\n" + of_bytes +
           "\nmesh 0 primitive 0 left alone: its material reads no tangents\nout.glb\n";
  };
  const std::string command = "darboux tangents idle.glb -o out.glb --only needed --drop-idle";
  EXPECT_EQ(good(command), text("the bytes of dropped tangents stay in the file: extension \"EXT_of_others\" "
                                "may name accessors by number"));
  b.json.erase("extensionsUsed");
  write_bytes(path("idle.glb"), b.glb());
  EXPECT_EQ(good(command), text("dropped tangents make the buffers smaller by 48 bytes"));
}

TEST_F(Cli, TangentsOfAnimatedMorphSphereAreLeftAlone) {
  const std::string sphere = DARBOUX_SHARED "/meshes/khronos/AnimatedMorphSphere.glb";
  if (!fs::exists(sphere)) GTEST_SKIP() << sphere << " is not here";
  EXPECT_EQ(
      good("darboux tangents '" + sphere + "' -o out.glb", 1),
      "mesh 0 primitive 0 left alone: has no uvs\n"
      "out.glb: no tangents were added: no primitive has the triangles, normals and uvs that they need\n");
}

TEST_F(Cli, TangentsRefusesNumbersThatAreNotFinite) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  Builder b;
  const auto position = b.positions({0, 0, 0, 1, 0, 0, 0, 1, 0});
  const auto normal = b.packed<float>("VEC3", 5126, 3, {0, 0, 1, 0, 0, 1, 0, nan, 1});
  const auto uv = b.packed<float>("VEC2", 5126, 3, {0, 0, 1, 0, 0, 1});
  b.primitive({{"POSITION", position}, {"NORMAL", normal}, {"TEXCOORD_0", uv}});
  write_bytes(path("nan.glb"), b.glb());
  refused("darboux tangents nan.glb -o x.glb",
          {"nan.glb: meshes[0].primitives[0]: normal of vertex 2: expected finite numbers"});
  EXPECT_FALSE(fs::exists(path("x.glb")));
}

TEST_F(Cli, TangentsExplainsEveryMethod) {
  const std::string text = good("darboux tangents --list");
  const Json methods = json("darboux tangents --list --json")["methods"];
  for (const Json& m : methods) {
    expect_keys(m, {"name", "summary", "formula", "order_regular", "order_jittered", "tangent_charts",
                    "bitangent_charts", "source", "cost"});
    EXPECT_NE(text.find("\n" + m["name"].get<std::string>() + "\n    what      "), std::string::npos)
        << m["name"];
  }
  for (const std::string& line : lines(text)) EXPECT_LE(line.size(), 100u) << line;
}

}  // namespace
}  // namespace darboux::test::tangents_test
