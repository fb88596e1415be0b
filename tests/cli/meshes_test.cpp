// `mesh`, `tangents` and `converge`, and what validate says of meshes they wrote.
#include <darboux/io.h>

#include "append_mesh.h"
#include "cli.h"

namespace darboux::test::meshes_test {
namespace {

// ---- round trips ------------------------------------------------------------------------------------------

TEST_F(Cli, ValidatePassesWhatMeshWrites) {
  const std::string torus = "torus:major_radius=1,minor_radius=0.4";
  for (const std::string options :
       {"", "--sign raw", "--jitter .25", "--jitter .25 --seed 9 --diagonal random"}) {
    SCOPED_TRACE(options);
    const Json written = json("darboux mesh " + torus + " --grid 32x16 -o m.glb --json " + options);
    expect_keys(written, {"file", "surface", "vertices", "triangles"});
    EXPECT_EQ(written["triangles"], 2 * 32 * 16);
    EXPECT_EQ(written["vertices"], 33 * 17);
    const Json mesh = only_mesh(json("darboux validate m.glb --json"));
    EXPECT_EQ(mesh["surface"]["name"], "torus");
    EXPECT_EQ(mesh["handedness"]["convention"], options == "--sign raw" ? "raw" : "gltf");
    for (const char* quantity : {"normal_deg", "tangent_deg", "bitangent_deg"})
      EXPECT_LT(mesh["classes"]["interior"][quantity]["max"].get<double>(), 1e-4) << quantity;
    EXPECT_LT(mesh["classes"]["seam"]["tangent_deg"]["max"].get<double>(), 1e-4);
    EXPECT_EQ(mesh["findings"].size(), options == "--sign raw" ? 1u : 0u) << mesh["findings"];
    EXPECT_EQ(has_finding(mesh, "TANGENT_HANDEDNESS_CONVENTION"), options == "--sign raw");
  }
  for (const std::string surface : {"sphere:radius=2", "cylinder:radius=2,height=5"}) {
    good("darboux mesh " + surface + " --grid 32x16 -o m.glb");
    const Json mesh = only_mesh(json("darboux validate m.glb --json"));
    EXPECT_NEAR(mesh["surface"]["parameters"]["radius"].get<double>(), 2, 1e-6) << surface;
    EXPECT_LT(mesh["classes"]["interior"]["tangent_deg"]["max"].get<double>(), 1e-4) << surface;
  }
  // Vertices shared across the seam: uvs jump back inside triangles, which is said.
  good("darboux mesh " + torus + " --grid 32x16 -o m.glb --seam shared");
  EXPECT_TRUE(has_finding(only_mesh(json("darboux validate m.glb --json")), "HANDEDNESS_MIXED"));
  // Uvs that are an affine image of the surface's are recognised, and folded ones in their two halves.
  good("darboux mesh " + torus + " --grid 32x16 -o m.glb --shear 0.5");
  const Json sheared = only_mesh(json("darboux validate m.glb --json"));
  EXPECT_EQ(sheared["uv"]["convention"], "affine");
  EXPECT_LT(sheared["classes"]["interior"]["tangent_deg"]["max"].get<double>(), 1e-4);
  good("darboux mesh " + torus + " --grid 32x16 -o m.glb --mirror");
  const Json folded = json("darboux validate m.glb --json");
  ASSERT_EQ(folded["files"][0]["meshes"].size(), 2u);
  for (const Json& half : folded["files"][0]["meshes"]) {
    EXPECT_EQ(half["surface"]["name"], "torus");
    EXPECT_LT(half["classes"]["interior"]["tangent_deg"]["max"].get<double>(), 1e-4);
  }
  good("darboux mesh " + torus + " --grid 32x16 -o m.glb --no-tangents");
  EXPECT_TRUE(has_finding(only_mesh(json("darboux validate m.glb --json")), "TANGENT_MISSING"));
}

// A part whose w are all of the other convention than those of the rest of the file.
TEST_F(Cli, ValidateComparesTheSignsOfParts) {
  good("darboux mesh torus --grid 32x16 -o torus.glb");
  good("darboux mesh sphere --grid 24x12 -o sphere.glb");
  const Mesh torus = read_asset(path("torus.glb")).primitives.at(0).data;
  Mesh sphere = read_asset(path("sphere.glb")).primitives.at(0).data;
  for (auto& p : sphere.positions) p.x += 5;
  for (const double w : {1.0, -1.0}) {
    for (auto& t : sphere.tangents) t.w *= w;
    Mesh both = torus;
    append(both, sphere);
    write_glb(path("both.glb"), both, "both");
    const Json meshes = json("darboux validate both.glb --json")["files"][0]["meshes"];
    ASSERT_EQ(meshes.size(), 2u);
    for (const Json& mesh : meshes) {
      const bool differs = w < 0 && mesh["surface"]["name"] == "sphere";
      EXPECT_EQ(has_finding(mesh, "HANDEDNESS_MIXED"), differs) << mesh;
      for (const Json& f : mesh["findings"])
        if (f["code"] == "HANDEDNESS_MIXED") {
          EXPECT_EQ(f["severity"], "warning");
          EXPECT_EQ(f["count"], mesh["corners"]);
          EXPECT_NE(f["message"].get<std::string>().find("raw in mesh 0 primitive 0 part 1"),
                    std::string::npos)
              << f;
        }
    }
    EXPECT_EQ(sh("darboux validate both.glb").status, 0);
  }
}

TEST_F(Cli, MeshRepeatsItself) {
  const std::string command = "darboux mesh torus --grid 16x8 --jitter .2 --diagonal random --quiet";
  EXPECT_EQ(good(command + " --seed 5 -o a.glb"), "");
  good(command + " --seed 5 -o b.glb");
  good(command + " --seed 6 -o c.glb");
  EXPECT_EQ(read_bytes(path("a.glb")), read_bytes(path("b.glb")));
  EXPECT_NE(read_bytes(path("a.glb")), read_bytes(path("c.glb")));
  EXPECT_EQ(good(command + " --seed 5 -o -"), read_bytes(path("a.glb")));
}

// three.js averages as `average` does: the statistics are the same.
TEST_F(Cli, TangentsOfTheAverageMethodMatchThreeJs) {
  const Json written = json("darboux tangents data/torus_016.none.glb -o avg.glb --method average --json");
  expect_keys(written, {"file", "method", "sign", "primitives", "skipped"});
  EXPECT_EQ(written["primitives"][0]["fallback_corners"], 0);
  const Json ours = only_mesh(json("darboux validate avg.glb --json"));
  const Json theirs = only_mesh(json("darboux validate data/torus_016.three.glb --json"));
  EXPECT_EQ(ours["handedness"]["convention"], "gltf");
  EXPECT_EQ(theirs["handedness"]["convention"], "raw");
  EXPECT_EQ(keys(ours["classes"]), keys(theirs["classes"]));
  for (const auto& [name, c] : ours["classes"].items()) {
    EXPECT_EQ(c["corners"], theirs["classes"][name]["corners"]) << name;
    for (const char* statistic : {"max", "rms", "p95"})
      EXPECT_NEAR(c["tangent_deg"][statistic].get<double>(),
                  theirs["classes"][name]["tangent_deg"][statistic].get<double>(), 1e-4)
          << name << ' ' << statistic;
  }
  good("darboux tangents data/torus_016.none.glb -o raw.glb --method average --sign raw");
  EXPECT_EQ(only_mesh(json("darboux validate raw.glb --json"))["handedness"]["convention"], "raw");
}

TEST_F(Cli, TangentsListsItsMethodsAndEachRuns) {
  const Json methods = json("darboux tangents --list --json")["methods"];
  ASSERT_GE(methods.size(), 5u);
  for (const Json& m : methods) {
    expect_keys(m, {"name", "summary"});
    good("darboux tangents data/torus_016.none.glb -o m.glb --method " + m["name"].get<std::string>());
    const Json mesh = only_mesh(Json::parse(sh("darboux validate m.glb --max-angle 180 --json").out));
    EXPECT_EQ(mesh["handedness"]["consistent"].get<double>(), 1) << m["name"];
    EXPECT_EQ(mesh["corners"], 3072) << m["name"];
    EXPECT_EQ(mesh["zero_tangents"], 0) << m["name"];
    EXPECT_EQ(mesh["non_finite"], 0) << m["name"];
  }
}

// ---- converge, at first depth -----------------------------------------------------------------------------

TEST_F(Cli, ConvergeHasTheContractsKeys) {
  const Json document = json(
      "darboux converge --surfaces torus --methods face,average --meshes regular --resolutions 8..32 -o "
      "r.html "
      "--csv r.csv --json");
  ASSERT_FALSE(document["studies"].empty());
  for (const Json& s : document["studies"])
    expect_keys(s, {"surface", "mesh", "method", "class", "quantity", "resolutions", "h", "max_deg",
                    "rms_deg", "seconds", "order", "order_ci", "expected_order", "floor_deg", "verdict"});
  EXPECT_TRUE(fs::exists(path("r.html")));
  EXPECT_TRUE(fs::exists(path("r.csv")));
}

}  // namespace
}  // namespace darboux::test::meshes_test
