// `validate`: its keys, the evidence of meshes that other tools made, its verdicts.
#include "cli.h"

namespace darboux::test::validate_test {
namespace {

// ---- validate: meshes that other tools made ---------------------------------------------------------------

TEST_F(Cli, ValidateHasTheContractsKeys) {
  const Json document = json("darboux validate data/torus_016.three.glb --json");
  expect_keys(document, {"files", "verdict"});
  expect_keys(document["files"][0], {"file", "verdict", "meshes"});
  EXPECT_EQ(document["files"][0]["file"], "data/torus_016.three.glb");
  EXPECT_EQ(document["verdict"], "pass");
  const Json mesh = only_mesh(document);
  expect_keys(mesh,
              {"mesh", "primitive", "name", "corners", "surface", "uv", "reference", "handedness",
               "zero_tangents", "non_unit", "non_orthogonal", "non_finite", "degenerate_triangles",
               "degenerate_uv_triangles", "classes", "findings", "references", "frame_uncertainty_deg"});
  EXPECT_EQ(mesh["reference"], "analytic");
  expect_keys(mesh["surface"], {"name", "parameters", "placement", "fit_rms", "fit_rms_relative", "sigma",
                                "covariance", "centre"});
  EXPECT_EQ(mesh["surface"]["placement"].size(), 16u);
  EXPECT_EQ(mesh["surface"]["placement"][15].get<double>(), 1);
  EXPECT_LT(mesh["surface"]["fit_rms_relative"].get<double>(), 1e-6);
  expect_keys(mesh["uv"], {"convention", "affine", "equivalent", "texcoord"});
  EXPECT_EQ(mesh["uv"]["convention"], "as stored");
  EXPECT_EQ(mesh["uv"]["affine"].size(), 6u);
  EXPECT_EQ(mesh["uv"]["texcoord"], 0);
  expect_keys(mesh["handedness"], {"convention", "consistent", "wrong"});
  for (const auto& [name, c] : mesh["classes"].items()) {
    expect_keys(c, {"corners", "normal_deg", "tangent_deg", "bitangent_deg", "worst",
                    "normal_uncertainty_deg", "tangent_uncertainty_deg"});
    expect_keys(c["worst"], {"vertex", "u", "v"});
    for (const char* quantity : {"normal_deg", "tangent_deg", "bitangent_deg"})
      expect_keys(c[quantity], {"max", "rms", "p95"});
    for (const char* quantity : {"normal_uncertainty_deg", "tangent_uncertainty_deg"})
      expect_keys(c[quantity], {"max", "rms", "infinite"});
  }
  expect_keys(mesh["references"], {"local", "mikktspace"});
  const Json& mikktspace = mesh["references"]["mikktspace"];
  expect_keys(mikktspace, {"equal_bits", "classes"});
  for (const auto& [name, c] : mikktspace["classes"].items()) {
    expect_keys(c, {"corners", "tangent_deg", "bitangent_deg", "worst"});
    EXPECT_FALSE(c.contains("tangent_uncertainty_deg")) << name;
  }
  for (const Json& finding : mesh["findings"])
    expect_keys(finding, {"code", "severity", "count", "message", "to_do"});
  EXPECT_EQ(mesh["surface"]["covariance"].size(), 8u);
  EXPECT_EQ(mesh["surface"]["covariance"][7].size(), 8u);
}

// A fitted torus: how well its frames are known stands beside their error; floats leave some 1e-6 degrees.
TEST_F(Cli, ValidateReportsItsUncertainty) {
  const Json mesh =
      only_mesh(json("darboux validate data/torus_032.three.glb --reference analytic,local --json"));
  for (const char* direction : {"normal", "tangent"}) {
    const Json& whole = mesh["frame_uncertainty_deg"][direction];
    expect_keys(whole, {"max", "rms", "infinite"});
    EXPECT_GT(whole["rms"].get<double>(), 0);
    EXPECT_GE(whole["max"].get<double>(), whole["rms"].get<double>());
    EXPECT_LT(whole["max"].get<double>(), 1e-5);
    EXPECT_EQ(whole["infinite"], 0);
    const Json& interior = mesh["classes"]["interior"][std::string(direction) + "_uncertainty_deg"];
    EXPECT_LT(interior["rms"].get<double>(), 1e-5);
  }
  expect_keys(mesh["references"], {"local"});
  const Json& local = mesh["references"]["local"];
  expect_keys(local, {"classes", "compared", "agreement"});
  EXPECT_GE(local["agreement"].get<double>(), 0.93);
  EXPECT_GT(local["classes"]["interior"]["tangent_uncertainty_deg"]["rms"].get<double>(), 1e-3);
  EXPECT_LT(local["classes"]["interior"]["tangent_deg"]["rms"].get<double>(), 1);
  EXPECT_NE(good("darboux validate data/torus_032.three.glb --reference analytic,local")
                .find("local and analytic agree"),
            std::string::npos);
  // Four triangles on each side do not tell: the analytic angles are not taken for local ones.
  good("darboux mesh plane --grid 2x2 -o few.glb");
  const std::string few = good("darboux validate few.glb --reference analytic,local");
  EXPECT_NE(few.find("local: nothing to compare at interior corners"), std::string::npos) << few;
  EXPECT_EQ(few.find("nan"), std::string::npos) << few;
  // A mesh of no known surface is assessed by the local reference.
  const Json folded = only_mesh(
      json("darboux validate data/jittertorus_016.mikk.glb --reference local,mikktspace --json", 1));
  EXPECT_EQ(folded["reference"], "local");
  EXPECT_GT(folded["frame_uncertainty_deg"]["tangent"]["rms"].get<double>(), 1e-3);
  EXPECT_FALSE(folded["references"]["local"].contains("agreement"));
}

TEST_F(Cli, ValidateTakesAListOfReferences) {
  const std::string one = "darboux validate data/torus_016.three.glb --json --reference ";
  EXPECT_EQ(good(one + "local,analytic"), good(one + "analytic,local"));
  EXPECT_EQ(good(one + "analytic,mikktspace,local,triangles"),
            good("darboux validate data/torus_016.three.glb --json"));
  EXPECT_TRUE(only_mesh(json(one + "analytic"))["references"].empty());
  // Each of the others alone.
  const Json local = json(one + "local", 1);
  EXPECT_EQ(local["verdict"], "undetermined") << "neighbours make warnings only";
  const Json triangles = json(one + "triangles");
  EXPECT_EQ(triangles["verdict"], "pass");
  EXPECT_EQ(only_mesh(triangles)["reference"], "triangles");
  EXPECT_EQ(only_mesh(triangles)["references"]["triangles"]["outside"], 0);
  EXPECT_EQ(only_mesh(local)["surface"], nullptr);
  EXPECT_EQ(only_mesh(local)["reference"], "local");
  EXPECT_LT(only_mesh(local)["references"]["local"]["classes"]["interior"]["tangent_deg"]["rms"], 1);
  EXPECT_EQ(json("darboux validate data/plainsphere_016.three.glb --json --reference local", 1)["verdict"],
            "fail");
  const Json mikktspace = only_mesh(json(one + "mikktspace", 1));
  EXPECT_EQ(mikktspace["reference"], "mikktspace");
  EXPECT_EQ(mikktspace["frame_uncertainty_deg"], nullptr);
  // three.js and MikkTSpace differ by 0.29 degrees inside the torus.
  const Json strict = json(one + "mikktspace --max-angle 0.2", 1);
  EXPECT_EQ(only_mesh(strict)["findings"][0]["code"], "TANGENT_NOT_MIKKTSPACE");
  EXPECT_EQ(only_mesh(strict)["findings"][0]["severity"], "warning");
  const Json lenient = json("darboux validate data/torus_016.three.glb --json --max-angle 2");
  EXPECT_FALSE(has_finding(only_mesh(lenient), "TANGENT_NOT_MIKKTSPACE"));
  for (const std::string list : {"potato", "analytic,potato", "analytic,"})
    refused(one + list, {"--reference", "expected analytic, triangles, local and mikktspace"});
  refused(one + "''", {"--reference", "expected a value, got an empty one"});
  refused(one + "local --surface torus", {"--reference", "--surface"});
  refused(one + "local --placement identity", {"--reference", "--placement"});
}

// What MikkTSpace wrote has its bits.
TEST_F(Cli, ValidateSaysWhatIsExactlyMikkTSpace) {
  good("darboux tangents data/torus_016.none.glb -o mikk.glb");
  EXPECT_EQ(only_mesh(json("darboux validate mikk.glb --json"))["references"]["mikktspace"]["equal_bits"], 1);
  const Json other = only_mesh(json("darboux validate data/torus_016.three.glb --json"));
  EXPECT_LT(other["references"]["mikktspace"]["equal_bits"].get<double>(), 0.1);
}

// Surfaces in one primitive: each is recognised, through its uvs or from its positions.
TEST_F(Cli, ValidateAssessesParts) {
  const Json halves = json("darboux validate data/mirrortorus_016.mikk.glb --json");
  EXPECT_EQ(halves["files"][0]["meshes"].size(), 2u);
  std::size_t part = 0, corners = 0;
  for (const Json& mesh : halves["files"][0]["meshes"]) {
    EXPECT_EQ(mesh["part"], part++);
    EXPECT_EQ(mesh["surface"]["name"], "torus");
    EXPECT_EQ(mesh["uv"]["convention"], "affine");
    EXPECT_EQ(mesh["handedness"]["convention"], "gltf");
    corners += mesh["corners"].get<std::size_t>();
  }
  EXPECT_EQ(corners, 3072u);
}

struct Expected {
  std::string file, surface;
  std::vector<std::pair<std::string, double>> parameters;
  std::string convention;
  // Degrees, in the printed digits of the evidence; negative: not asked.
  double interior_max, interior_rms, seam_max;
};

// The same to the printed digits: two significant ones, so half a unit of the second.
void expect_printed(const Json& value, double printed, const std::string& what) {
  if (printed < 0) return;
  const double unit = std::pow(10.0, std::floor(std::log10(printed)) - 1);
  EXPECT_NEAR(value.get<double>(), printed, 0.5 * unit * (1 + 1e-9)) << what;
}

TEST_F(Cli, ValidateReproducesTheEvidence) {
  const std::vector<Expected> table{
      {"torus_016.three", "torus", {{"major_radius", 1}, {"minor_radius", 0.4}}, "raw", .29, .19, 5.6},
      {"torus_032.three", "torus", {{"major_radius", 1}, {"minor_radius", 0.4}}, "raw", .076, .048, 2.8},
      {"torus_032.mikk", "torus", {{"major_radius", 1}, {"minor_radius", 0.4}}, "gltf", -1, -1, 2.8},
      {"torus_032.assimp", "torus", {{"major_radius", 1}, {"minor_radius", 0.4}}, "gltf", .40, .29, -1},
      {"sphere_016.three", "sphere", {{"radius", 1}}, "raw", .82, .39, -1},
      {"sphere_032.three", "sphere", {{"radius", 1}}, "raw", .45, .16, 2.8},
      {"sphere_032.mikk", "sphere", {{"radius", 1}}, "gltf", -1, -1, 2.8},
      {"cylinder_016.three", "cylinder", {{"radius", 1}, {"height", 2}}, "raw", -1, -1, -1},
      {"cylinder_032.three", "cylinder", {{"radius", 1}, {"height", 2}}, "raw", -1, -1, -1},
      {"cylinder_016.mikk", "cylinder", {{"radius", 1}, {"height", 2}}, "gltf", -1, -1, -1},
      {"jittertorus_016.mikk", "torus", {{"major_radius", 1}, {"minor_radius", 0.4}}, "gltf", 1.7, .50, -1},
  };
  for (const Expected& e : table) {
    SCOPED_TRACE(e.file);
    const Json mesh = only_mesh(json("darboux validate data/" + e.file + ".glb --json"));
    EXPECT_EQ(mesh["surface"]["name"], e.surface);
    for (const auto& [name, value] : e.parameters)
      EXPECT_NEAR(mesh["surface"]["parameters"][name].get<double>(), value, 1e-6) << name;
    EXPECT_EQ(mesh["handedness"]["convention"], e.convention);
    EXPECT_EQ(mesh["handedness"]["consistent"].get<double>(), 1);
    EXPECT_EQ(mesh["handedness"]["wrong"], 0);
    const Json& interior = mesh["classes"]["interior"];
    expect_printed(interior["tangent_deg"]["max"], e.interior_max, "interior max");
    expect_printed(interior["tangent_deg"]["rms"], e.interior_rms, "interior rms");
    if (e.seam_max > 0) expect_printed(mesh["classes"]["seam"]["tangent_deg"]["max"], e.seam_max, "seam max");
    // What is exact by symmetry is left with the noise of float32.
    if (e.interior_max < 0) {
      EXPECT_LT(interior["tangent_deg"]["max"].get<double>(), 1e-4);
    }
    EXPECT_LT(interior["normal_deg"]["max"].get<double>(), 1e-4);
  }
}

// The command that mends is printed, as a shell reads it, and mends.
TEST_F(Cli, ValidateNamesTheCommandThatMends) {
  good("cp data/plainsphere_016.three.glb \"it's zero.glb\"");
  const std::string text = good("darboux validate \"it's zero.glb\"", 1), mark = "new tangents: ";
  const std::size_t at = text.find(mark);
  ASSERT_NE(at, std::string::npos) << text;
  const std::string command = text.substr(at + mark.size(), text.find('\n', at) - at - mark.size());
  EXPECT_EQ(command, "darboux tangents 'it'\\''s zero.glb' -o mended.glb");
  good(command);
  EXPECT_NE(good("darboux validate mended.glb").find("mended.glb: pass"), std::string::npos);
  // Where it would write the same again, it is not.
  EXPECT_EQ(good("darboux validate mended.glb --surface sphere --max-angle 1", 1).find(mark),
            std::string::npos);
}

TEST_F(Cli, ValidateTellsTheVerdictsApart) {
  const Json zero = only_mesh(json("darboux validate data/plainsphere_016.three.glb --json", 1));
  ASSERT_FALSE(zero["findings"].empty());
  EXPECT_EQ(zero["findings"][0]["code"], "TANGENT_ZERO");
  EXPECT_EQ(zero["findings"][0]["severity"], "error");
  EXPECT_EQ(zero["findings"][0]["count"], 2);
  EXPECT_EQ(zero["zero_tangents"], 2);

  // A frustum is a cone with an affine v.
  const Json cone = only_mesh(json("darboux validate data/cone_016.three.glb --json"));
  EXPECT_EQ(cone["surface"]["name"], "cone");
  EXPECT_EQ(cone["uv"]["convention"], "affine");
  EXPECT_NEAR(cone["uv"]["affine"][3], 0.5, 1e-6);

  const Json declared = json("darboux validate data/cone_016.three.glb --surface cylinder --json", 1);
  EXPECT_EQ(declared["verdict"], "fail");
  EXPECT_TRUE(has_finding(only_mesh(declared), "SURFACE_MISMATCH"));
  EXPECT_EQ(only_mesh(declared)["surface"], nullptr);

  // The limit decides on a declared surface: seam corners are 5.6 degrees off, interior ones 0.29. On a
  // recognised one what lies at a seam, inside the cone of its triangles, is a warning.
  const std::string file = "darboux validate data/torus_016.three.glb --json";
  EXPECT_EQ(json(file + " --max-angle 1.8")["verdict"], "pass");
  const std::string torus = file + " --surface torus --max-angle ";
  EXPECT_EQ(json(torus + "2")["verdict"], "pass");
  EXPECT_TRUE(has_finding(only_mesh(json(torus + "1.8", 1)), "TANGENT_ANGLE"));

  // Over several files the highest status counts.
  good("darboux validate data/torus_016.three.glb data/sphere_016.three.glb");
  good("darboux validate data/torus_016.three.glb data/plainsphere_016.three.glb", 1);
  const Result missing =
      sh("darboux validate data/cone_016.three.glb missing.glb data/torus_016.three.glb --json");
  EXPECT_EQ(missing.status, 2);
  EXPECT_EQ(Json::parse(missing.out)["files"].size(), 3u);
  expect_one_line(missing.err);
}

// Meshes that lack what a verdict is made of are assessed by what they have.
TEST_F(Cli, ValidateCopesWithMissingAttributes) {
  for (const std::string file :
       {"torus_016.none.glb", "sphere_016.none.glb", "torus_016.obj", "sphere_016.obj"}) {
    const Json mesh = only_mesh(json("darboux validate data/" + file + " --json"));
    EXPECT_TRUE(has_finding(mesh, "TANGENT_MISSING")) << file;
    EXPECT_EQ(mesh["handedness"]["convention"], "none") << file;
    EXPECT_FALSE(mesh["classes"]["interior"].contains("tangent_deg")) << file;
    EXPECT_LT(mesh["classes"]["interior"]["normal_deg"]["max"].get<double>(), 1e-4) << file;
  }
  // One attribute taken out of the torus at a time: the accessor stays, the primitive no longer names it.
  const auto without = [&](const std::vector<std::string>& attributes) {
    Glb glb = split_glb(read_bytes(path("data/torus_016.three.glb")));
    for (const std::string& name : attributes)
      glb.json["meshes"][0]["primitives"][0]["attributes"].erase(name);
    write_bytes(path("without.glb"), make_glb(glb.json.dump(), glb.bin));
  };
  without({"TEXCOORD_0"});
  // Without uvs the positions tell the surface, and so the normals.
  const Json no_uv = json("darboux validate without.glb --json");
  EXPECT_TRUE(has_finding(only_mesh(no_uv), "UV_MISSING"));
  EXPECT_EQ(only_mesh(no_uv)["surface"]["name"], "torus");
  EXPECT_EQ(only_mesh(no_uv)["uv"]["convention"], "unknown");
  EXPECT_LT(only_mesh(no_uv)["classes"]["interior"]["normal_deg"]["max"].get<double>(), 1e-4);
  EXPECT_FALSE(only_mesh(no_uv)["classes"]["interior"].contains("tangent_deg"));
  without({"TEXCOORD_0", "NORMAL", "TANGENT"});
  EXPECT_EQ(json("darboux validate without.glb --json")["verdict"], "nothing");
  without({"NORMAL"});
  const Json no_normals = only_mesh(json("darboux validate without.glb --json"));
  EXPECT_FALSE(no_normals["classes"]["interior"].contains("normal_deg"));
  EXPECT_FALSE(no_normals["classes"]["interior"].contains("bitangent_deg"));
  EXPECT_NEAR(no_normals["classes"]["interior"]["tangent_deg"]["rms"].get<double>(), .19, .005);
  without({"TANGENT"});
  EXPECT_TRUE(has_finding(only_mesh(json("darboux validate without.glb --json")), "TANGENT_MISSING"));

  // A valid file with nothing to assess.
  write_bytes(path("nothing.gltf"), R"({"asset": {"version": "2.0"}})");
  const Json nothing = json("darboux validate nothing.gltf --json");
  EXPECT_EQ(nothing["verdict"], "nothing");
  EXPECT_TRUE(nothing["files"][0]["meshes"].empty());
}

TEST_F(Cli, ThreadsDoNotChangeTheReport) {
  const std::string files = "data/torus_016.three.glb data/sphere_016.three.glb data/cylinder_016.three.glb";
  EXPECT_EQ(good("darboux validate --json " + files), good("darboux validate --json --threads 3 " + files));
}

// ---- surroundings -----------------------------------------------------------------------------------------

// Every file other tools made gets a verdict, and one JSON document.
TEST_F(Cli, AssessesEveryMeshOfTheEvidence) {
  const fs::path three = fs::path(DARBOUX_SHARED) / "meshes/three";
  if (!fs::is_directory(three)) GTEST_SKIP() << three << " is not there";
  std::size_t assessed = 0;
  fs::create_directory_symlink(three, path("three"));
  for (const auto& entry : fs::directory_iterator(three)) {
    const std::string name = entry.path().filename().string();
    const Result r = sh("darboux validate 'three/" + name + "' --json");
    SCOPED_TRACE(name);
    EXPECT_TRUE(r.status == 0 || r.status == 1) << r.status;
    EXPECT_EQ(r.err, "");
    const Json document = Json::parse(r.out, nullptr, false);
    ASSERT_FALSE(document.is_discarded());
    const std::string verdict = document["verdict"];
    EXPECT_EQ(r.status, verdict == "pass" ? 0 : 1);
    EXPECT_TRUE(verdict == "pass" || verdict == "fail" || verdict == "undetermined") << verdict;
    const bool known =
        name.rfind("torus", 0) == 0 || name.rfind("sphere", 0) == 0 || name.rfind("cylinder", 0) == 0;
    if (known) {
      EXPECT_EQ(only_mesh(document)["surface"]["name"], name.substr(0, name.find('_')));
      const bool mikk = name.find(".mikk.") != std::string::npos,
                 three_js = name.find(".three.") != std::string::npos;
      if (mikk || three_js) {
        EXPECT_EQ(only_mesh(document)["handedness"]["convention"], mikk ? "gltf" : "raw");
        EXPECT_EQ(verdict, "pass");
      }
    }
    ++assessed;
  }
  EXPECT_GT(assessed, 30u);
}

}  // namespace
}  // namespace darboux::test::validate_test
