// The kinds of meshes that `darboux mesh` writes beside plain grids, and what validate says of them.
#include "cli.h"

namespace darboux::test::reference_meshes_test {
namespace {

class ReferenceMeshes : public Cli {
 protected:
  Json validated(const std::string& arguments, int status = 0) const {
    SCOPED_TRACE(arguments);
    good("darboux mesh " + arguments + " --quiet -o m.glb");
    return only_mesh(json("darboux validate m.glb --json", status));
  }
};

TEST_F(ReferenceMeshes, ValidateRecognisesAndPassesThem) {
  struct Case {
    std::string arguments, surface, convention = "gltf";
  };
  const std::string ellipsoid = "ellipsoid:semi_axis_x=1,semi_axis_y=0.7,semi_axis_z=0.5";
  for (const Case& c :
       {Case{"sphere --topology icosphere --subdivisions 12", "sphere"},
        {"sphere --topology cube-sphere --subdivisions 12", "sphere"},
        {"sphere:radius=3 --topology icosphere --subdivisions 12 --sign raw", "sphere", "raw"},
        {ellipsoid + " --topology cube-sphere --subdivisions 12", "ellipsoid"},
        {"cylinder --topology lantern --grid 24x12", "cylinder"},
        {"cylinder --topology lantern --grid 16x256", "cylinder"},
        {"sphere --grid 32x16 --pole half-cell", "sphere"},
        {"sphere --grid 32x16 --pole shared", "sphere"},
        {"sphere --grid 32x16 --scale 1,0.7,0.5", "ellipsoid"},
        {"sphere --grid 32x16 --scale -2,2,2", "sphere"},
        {"torus --grid 32x16 --scale 3,3,3", "torus"},
        {"sphere --grid 64x32 --degenerate 6", "sphere"},
        {"cylinder --topology lantern --grid 24x12 --degenerate 6", "cylinder"}}) {
    const Json mesh = validated(c.arguments);
    EXPECT_EQ(mesh["surface"]["name"], c.surface) << c.arguments;
    EXPECT_EQ(mesh["handedness"]["convention"], c.convention) << c.arguments;
    EXPECT_EQ(mesh["handedness"]["wrong"], 0) << c.arguments;
    for (const auto& [name, statistics] : mesh["classes"].items())
      for (const char* quantity : {"normal_deg", "tangent_deg"})
        EXPECT_LT(statistics[quantity]["max"].get<double>(), 1e-3) << c.arguments << ' ' << name;
    EXPECT_EQ(mesh["degenerate_triangles"], c.arguments.find("--degenerate 6") != std::string::npos ? 6 : 0)
        << c.arguments;
    EXPECT_EQ(mesh["degenerate_uv_triangles"], 0) << c.arguments;
    for (const Json& finding : mesh["findings"]) EXPECT_NE(finding["severity"], "error") << finding;
  }
}

// Triangles whose uvs do not name the place hang on no part, and are the rest; all are counted.
TEST_F(ReferenceMeshes, ValidateCountsDegenerateUvs) {
  good("darboux mesh torus --grid 32x16 --degenerate-uvs 5 --degenerate 3 -o m.glb");
  int degenerate = 0, degenerate_uvs = 0;
  const Json document = json("darboux validate m.glb --json");
  for (const Json& mesh : document["files"][0]["meshes"]) {
    degenerate += mesh["degenerate_triangles"].get<int>();
    degenerate_uvs += mesh["degenerate_uv_triangles"].get<int>();
  }
  EXPECT_EQ(degenerate, 3);
  EXPECT_EQ(degenerate_uvs, 5);
}

TEST_F(ReferenceMeshes, RepeatThemselvesByteForByte) {
  for (const std::string arguments :
       {"sphere --topology icosphere --subdivisions 6", "sphere --topology cube-sphere --subdivisions 6",
        "cylinder --topology lantern --grid 8x5", "sphere --grid 9x5 --pole half-cell --scale 1,-2,3",
        "sphere --grid 9x5 --degenerate 4 --degenerate-uvs 3"}) {
    const std::string once = good("darboux mesh " + arguments + " -o -");
    EXPECT_EQ(once.substr(0, 4), "glTF") << arguments;
    EXPECT_EQ(once, good("darboux mesh " + arguments + " -o -")) << arguments;
  }
}

// A formula's pole is not one point to the bit: sin(pi) is 1.2e-16. Its triangles are left out all the same.
TEST_F(ReferenceMeshes, FormulasHavePolesUpToRounding) {
  write_bytes(path("ball.surface"), "x = cos(2*pi*u)*sin(pi*v)\ny = sin(2*pi*u)*sin(pi*v)\nz = -cos(pi*v)\n");
  for (const std::string pole : {"per-column", "half-cell"}) {
    const std::string options = " --grid 16x8 -o m.glb --json --pole " + pole;
    const Json formula = json("darboux mesh formula:file=ball.surface" + options);
    const Json sphere = json("darboux mesh sphere" + options);
    EXPECT_EQ(sphere["triangles"], 2 * 16 * 7);
    for (const char* count : {"triangles", "vertices"}) EXPECT_EQ(formula[count], sphere[count]) << pole;
  }
  // NaN is no pole: it is said, not left out.
  write_bytes(path("torn.surface"), "x = log(u - 0.3)\ny = log(u - 0.3)\nz = log(u - 0.3)\n");
  refused("darboux mesh formula:file=torn.surface --grid 16x8 -o m.glb", {"expected finite"});
}

// Four rows of u = 0.5, between cells 3 and 4 of eight.
TEST_F(ReferenceMeshes, FormulasSayHowManyCellsAreLeftOut) {
  write_bytes(path("pole.surface"), "x = u\ny = v\nz = 1/(u - 0.5)\n");
  const std::string command = "darboux mesh formula:file=pole.surface -o m.glb --grid ";
  Result r = sh(command + "8x4 --json");
  EXPECT_EQ(r.status, 0);
  EXPECT_EQ(Json::parse(r.out)["dropped_cells"], 8);
  EXPECT_EQ(Json::parse(r.out)["triangles"], 2 * (8 - 2) * 4);
  EXPECT_EQ(r.err,
            "darboux: formula: expected all cells of the grid to be finite and to have area, got 8 of 32 "
            "that are left out or have one triangle left\n");
  EXPECT_EQ(sh(command + "8x4 --quiet").err, "");
  EXPECT_EQ(json(command + "9x4 --json")["dropped_cells"], 0);
}

// The file says how it was made.
TEST_F(ReferenceMeshes, FilesSayHowTheyWereMade) {
  const std::string file =
      good("darboux mesh sphere --topology icosphere --subdivisions 6 --scale -1,2,1 --degenerate 2 -o -");
  for (const char* part : {R"("topology":"icosphere")", R"("subdivisions":6)", R"("scale":[-1.0,2.0,1.0])",
                           R"("degenerate":2)", R"("degenerate_uvs":0)", R"("pole":"per-column")"})
    EXPECT_NE(file.find(part), std::string::npos) << part;
}

TEST_F(ReferenceMeshes, RefuseWrongUsageInOneLine) {
  const auto mesh = [](const std::string& arguments) { return "darboux mesh " + arguments + " -o x.glb"; };
  refused(mesh("sphere --topology geodesic --subdivisions 4"), {"--topology", "icosphere", "lantern"});
  refused(mesh("sphere --topology icosphere"), {"icosphere", "--subdivisions"});
  refused(mesh("sphere --topology icosphere --grid 8x4 --subdivisions 4"), {"icosphere", "--grid"});
  refused(mesh("sphere --grid 8x4 --subdivisions 4"), {"grid", "--subdivisions"});
  refused(mesh("sphere --topology icosphere --subdivisions 0"), {"--subdivisions"});
  refused(mesh("sphere --topology icosphere --subdivisions 4000"), {"--subdivisions"});
  refused(mesh("sphere --topology cube-sphere --subdivisions 3"), {"subdivisions", "even"});
  refused(mesh("torus --topology icosphere --subdivisions 4"), {"torus", "sphere"});
  refused(mesh("torus --grid 8x4 --pole shared"), {"pole", "torus"});
  refused(mesh("sphere --grid 8x4 --pole north"), {"--pole", "half-cell"});
  for (const std::string scale : {"2", "1,2", "1,2,3,4", "1,x,1", "1,,1", "1,inf,1"})
    refused(mesh("sphere --grid 8x4 --scale " + scale), {"--scale"});
  refused(mesh("sphere --grid 8x4 --scale 1,0,1"), {"scale", "0"});
  refused(mesh("sphere --grid 8x4 --degenerate -1"), {"--degenerate"});
  refused(mesh("sphere --grid 8x4 --degenerate 99"), {"degenerate", "99", "48"});
  refused(mesh("sphere --grid 8x4 --degenerate-uvs x"), {"--degenerate-uvs"});
  refused(mesh("sphere --grid 8x4 --degenerate 99999999999"), {"--degenerate", "0 to 2147483647"});
  refused(mesh("sphere --grid 8x4 --jitter 0.1 --seed 18446744073709551616"),
          {"--seed", "0 to 18446744073709551615"});
  // Errors of the library name the option as it was typed.
  refused(mesh("sphere --grid 8x4 --jitter 0.7"), {"darboux: --jitter: expected", "got 0.7"});
  refused(mesh("sphere --grid 8x4 --degenerate-uvs 99"), {"darboux: --degenerate-uvs: expected", "got 99"});
  refused(mesh("torus --grid 1x1"), {"darboux: --grid: expected", "got 1x1"});
  // Two segments each way lie on a line; a radius of 1e-60 is no float.
  for (const char* none : {"torus --grid 2x2", "sphere:radius=1e-60 --grid 16x8"})
    refused(mesh(none), {"darboux: mesh: expected triangles with an area", "got none"});
  refused(mesh("sphere --grid 8x4 --shear 1e300"), {"--shear", "1000"});
  refused(mesh("sphere --grid 8x4 --scale 1,1e31,1"), {"--scale", "1e30"});
  refused(mesh("sphere"), {"--grid NxM", "64x32"});
  for (const char* name : {"x.gltf", "X.GLTF"})
    refused(std::string("darboux mesh sphere --grid 8x4 -o ") + name, {name, "GLB", ".gltf"});
  EXPECT_FALSE(fs::exists(path("x.glb")));
}

// Cells of a grid that are not whole: those about an infinity of a formula. Triangles without area at a pole
// of the chart leave the other half of their cell, and are not counted.
TEST_F(Cli, SaysHowManyCellsAMeshDropped) {
  write_bytes(path("pole.surface"), "x = u\ny = v\nz = 1/((u-0.5)*(u-0.5) + (v-0.5)*(v-0.5))\n");
  const std::string mesh = "darboux mesh formula:file=pole.surface --grid 8x8 -o out.glb ";
  const Result r = sh(mesh);
  EXPECT_EQ(r.status, 0);
  expect_one_line(r.err);
  EXPECT_NE(r.err.find("got 4 of 64"), std::string::npos) << r.err;  // those about (0.5, 0.5)
  good(mesh + "--quiet");
  EXPECT_EQ(json(mesh + "--quiet --json")["dropped_cells"], 4);
  for (const char* surface : {"sphere", "cone", "torus"})
    EXPECT_EQ(json("darboux mesh " + std::string(surface) + " --grid 8x8 -o out.glb --json")["dropped_cells"],
              0);
}

}  // namespace
}  // namespace darboux::test::reference_meshes_test
