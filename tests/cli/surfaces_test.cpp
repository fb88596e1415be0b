// `surfaces` and `check`, and surfaces from files wherever one is asked for.
#include <algorithm>

#include "cli.h"

namespace darboux::test::surfaces_test {
namespace {

// ---- surfaces, check --------------------------------------------------------------------------------------

TEST_F(Cli, SurfacesHasTheContractsKeys) {
  const Json all = json("darboux surfaces --json")["surfaces"];
  ASSERT_EQ(all.size(), all_surfaces().size());
  for (const Json& s : all) {
    expect_keys(
        s, {"name", "summary", "parameters", "periodic_u", "periodic_v", "orientable", "singular", "facts"});
    EXPECT_FALSE(s["facts"].empty()) << s["name"];
    for (const Json& p : s["parameters"])
      expect_keys(p, {"name", "default", "minimum", "maximum", "meaning"});
    // Every name alone evaluates.
    good("darboux eval " + s["name"].get<std::string>() + " --at 0.3,0.7");
  }
  EXPECT_EQ(all[0]["name"], "sphere");
  EXPECT_EQ(all[0]["periodic_u"], true);
  EXPECT_EQ(all[0]["periodic_v"], false);
  EXPECT_EQ(all[0]["singular"], Json::array({"v=0", "v=1"}));
  EXPECT_EQ(all[0]["parameters"][0]["maximum"], nullptr) << "infinity";
}

TEST_F(Cli, CheckPassesForTheCatalogueAndRepeats) {
  const Json document = json("darboux check --points 50 --seed 7 --json");
  EXPECT_EQ(document["passed"], true);
  for (const Json& c : document["checks"]) {
    expect_keys(c, {"surface", "route", "quantity"});
    if (c.contains("skipped")) {
      EXPECT_FALSE(c["skipped"].get<std::string>().empty());
      continue;
    }
    expect_keys(c, {"points", "max_error", "bound", "passed", "worst"});
    expect_keys(c["worst"], {"u", "v"});
    EXPECT_GT(c["points"].get<int>(), 0) << c;
    EXPECT_LE(c["max_error"].get<double>(), c["bound"].get<double>()) << c;
  }
  EXPECT_EQ(document, json("darboux check --points 50 --seed 7 --threads 3 --json"));
  const std::string torus = "darboux check torus --points 50 --json --seed ";
  EXPECT_NE(json(torus + '7'), json(torus + '8'));
  EXPECT_EQ(json("darboux check torus:minor_radius=0.4 --points 5 --json")["checks"][0]["surface"], "torus");
}

// A table per route, of roundings: those of double or of float, by the route's name. The numbers are those of
// the JSON, to two digits.
TEST_F(Cli, CheckWritesTablesOfMarkdown) {
  const std::string command =
      "darboux check sphere bilinear-patch --points 20 --routes curvature,high_precision_float ";
  const Json checks = json(command + "--json")["checks"];
  std::string route, text = good(command + "--markdown");
  std::vector<std::string> quantities;
  std::size_t cells = 0, left_out = 0;
  for (const std::string& line : lines(text)) {
    if (line.starts_with("## ")) route = line.substr(3);
    if (!line.starts_with("| ")) continue;
    std::vector<std::string> row;
    for (std::size_t at = 2; at < line.size();) {
      const std::size_t end = std::min(line.find(" |", at), line.size());
      row.push_back(line.substr(at, end - at));
      at = end + 3;
    }
    if (row[0] == "surface") {
      quantities = row;
      continue;
    }
    ASSERT_EQ(row.size(), quantities.size()) << line;
    const double rounding = route == "curvature" ? 0x1p-53 : 0x1p-24;
    for (std::size_t k = 1; k < row.size(); ++k) {
      const auto found = std::find_if(checks.begin(), checks.end(), [&](const Json& c) {
        return c["surface"] == row[0] && c["route"] == route && c["quantity"] == quantities[k] &&
               !c.contains("skipped");
      });
      if (row[k] == "–") {
        EXPECT_EQ(found, checks.end()) << route << ' ' << line;
        ++left_out;
        continue;
      }
      ASSERT_NE(found, checks.end()) << route << ' ' << line;
      const std::size_t between = row[k].find(" / ");
      const double error = (*found)["max_error"], bound = (*found)["bound"];
      EXPECT_NEAR(to_double(row[k].substr(0, between)) * rounding, error, 0.06 * error) << line;
      EXPECT_NEAR(to_double(row[k].substr(between + 3)) * rounding, bound, 0.06 * bound) << line;
      ++cells;
    }
  }
  const auto done =
      std::count_if(checks.begin(), checks.end(), [](const Json& c) { return !c.contains("skipped"); });
  EXPECT_EQ(cells, static_cast<std::size_t>(done));
  EXPECT_GT(left_out, 0u) << text;

  write_bytes(path("nowhere.surface"), "x = u\ny = v\nz = log(u - 2)\n");
  text = good("darboux check formula:file=nowhere.surface --points 20 --routes dual --markdown", 1);
  EXPECT_NE(text.find("\n| formula | **FAILED** "), std::string::npos) << text;
}

// ---- surfaces from files ----------------------------------------------------------------------------------

const char* const neck =
    "a = 2   # radius of the neck; length\nt = 2*v - 1\n"
    "x = a*cosh(t)*cos(2*pi*u)\ny = a*cosh(t)*sin(2*pi*u)\nz = a*t\n";

// Kinds that are not fitted, and surfaces from files, are declared as they are: only their place is looked
// for.
TEST_F(Cli, AMeshPassesByTheSurfaceItWasMadeOf) {
  write_bytes(path("my.surface"), neck);
  for (const std::string surface :
       {"graph", "superellipsoid:exponent_u=0.8", "bspline-patch", "formula:file=my.surface,a=3", "torus"}) {
    good("darboux mesh " + surface + " --grid 12x12 -o m.glb");
    for (const char* more : {"", " --placement identity"}) {
      const Json mesh = only_mesh(json("darboux validate m.glb --surface " + surface + more + " --json"));
      EXPECT_EQ(mesh["verdict"], "pass") << surface;
      EXPECT_EQ(mesh["reference"], "analytic") << surface;
      EXPECT_EQ(mesh["surface"]["name"], surface.substr(0, surface.find(':')));
    }
  }
  good("darboux mesh formula:file=my.surface --grid 12x12 -o m.glb");
  const Json other =
      only_mesh(json("darboux validate m.glb --surface formula:file=my.surface,a=3 --json", 1));
  EXPECT_EQ(other["verdict"], "fail");
  EXPECT_EQ(other["findings"][0]["code"], "SURFACE_MISMATCH");
  refused("darboux validate m.glb --surface formula:file=none.surface", {"none.surface"});
  refused("darboux validate m.glb --surface graph:slope=1", {"graph", "slope"});
}

// A route that does not apply proves nothing.
TEST_F(Cli, CheckSaysWhereNothingWasChecked) {
  write_bytes(path("my.surface"), neck);
  const std::string command = "darboux check formula:file=my.surface --points 10 --routes ";
  EXPECT_EQ(good(command + "implicit --quiet", 1), "nothing checked: each route was skipped\n");
  EXPECT_EQ(json(command + "implicit --json", 1)["passed"], false);
  EXPECT_EQ(good(command + "implicit,gauss --quiet"), "all passed\n");
}

TEST_F(Cli, AFormulaGoesWhereverASurfaceIsAskedFor) {
  write_bytes(path("my.surface"), neck);
  const Json document = json("darboux eval formula:file=my.surface --at 0.3,0.7 --json");
  EXPECT_EQ(document["surface"],
            Json::parse(R"({"name": "formula", "file": "my.surface", "parameters": {"a": 2}})"));
  const Json sample = document["samples"][0];
  const double rho = 2 * std::cosh(0.4);
  EXPECT_NEAR(std::hypot(sample["position"][0].get<double>(), sample["position"][1].get<double>()), rho,
              1e-14);
  EXPECT_NEAR(sample["mean_curvature"], 0, 1e-14);
  EXPECT_NEAR(sample["gaussian_curvature"], -4 / std::pow(rho, 4), 1e-14);
  EXPECT_EQ(sample["status"], Json::array({"regular"}));
  EXPECT_EQ(json("darboux eval formula:file=my.surface,a=3 --at 0.3,0.5 --json")["samples"][0]["position"][2],
            0);

  const Json checks = json("darboux check formula:file=my.surface,a=3 --points 50 --json");
  EXPECT_TRUE(checks["passed"].get<bool>());
  good("darboux mesh formula:file=my.surface --grid 8x4 -o neck.glb");
  EXPECT_NE(read_bytes(path("neck.glb")).find("formula:file=my.surface,a=2"), std::string::npos);
  good(
      "darboux converge --surfaces 'formula:file=my.surface,a=3,sphere' --methods area --meshes regular "
      "--resolutions 8..32 -o report.html");

  // A comma belongs to the path unless a NAME= follows it.
  write_bytes(path("my,own.surface"), neck);
  EXPECT_EQ(
      json("darboux eval formula:file=my,own.surface,a=3 --at 0,0 --json")["surface"]["parameters"]["a"], 3);
}

TEST_F(Cli, AFormulaWithoutAValueIsNull) {
  write_bytes(path("nowhere.surface"), "x = u\ny = v\nz = log(u - 2)\n");
  const Json sample = json("darboux eval formula:file=nowhere.surface --at 0.3,0.7 --json")["samples"][0];
  EXPECT_TRUE(sample["position"][2].is_null());
  EXPECT_TRUE(sample["normal"][0].is_null());
  EXPECT_EQ(sample["status"], Json::array({"no_frame", "overflow"}));
  EXPECT_FALSE(
      json("darboux check formula:file=nowhere.surface --points 50 --json", 1)["passed"].get<bool>());
  good("darboux check formula:file=nowhere.surface --points 50", 1);
}

TEST_F(Cli, NetsAndProfilesComeFromFiles) {
  write_bytes(path("net.json"), R"({"points": [[[0,0,0],[0,1,0]], [[1,0,0],[1,1,1]]]})");
  write_bytes(path("profile.json"), R"({"points": [[0.5, 0], [1, 0.5], [0.75, 1]]})");
  const Json net = json("darboux eval bezier-patch:file=net.json --at 0.5,0.5 --json");
  EXPECT_EQ(net["surface"], Json::parse(R"({"name": "bezier-patch", "file": "net.json", "parameters": {}})"));
  EXPECT_EQ(net["samples"][0]["position"], Json::parse("[0.5, 0.5, 0.25]"));
  EXPECT_EQ(
      json("darboux eval surface-of-revolution:file=profile.json --at 0,1 --json")["samples"][0]["position"],
      Json::parse("[0.75, 0.0, 1.0]"));
  good("darboux check surface-of-revolution:file=profile.json --points 50");
  good("darboux check bezier-patch --points 50");
}

TEST_F(Cli, RefusesBadSurfaceFilesInOneLine) {
  write_bytes(path("my.surface"), neck);
  write_bytes(path("unknown.surface"), "x = u\ny = v\nz = radius\n");
  write_bytes(path("net.json"), R"({"points": [[[0,0,0],[0,1]], [[1,0,0],[1,1,1]]]})");
  for (const std::string command :
       {"darboux eval --at 0,0 ", "darboux check ", "darboux mesh --grid 2x2 -o x.glb "}) {
    refused(command + "formula", {"formula", "expected formula:file=FILE", "got no file"});
    refused(command + "formula:", {"formula", "no value"});
    refused(command + "formula:file=none", {"none: expected a readable file"});
    refused(command + "formula:file=.", {".: expected a file, got a folder"});
    refused(command + "formula:a=2", {"got no file"});
    refused(command + "formula:file=my.surface,b=2", {"unknown parameter 'b'", "known are a"});
    refused(command + "formula:file=my.surface,a=two", {"formula: a", "two", "number"});
    refused(command + "formula:file=my.surface,a=2,a=3", {"'a': expected one value"});
    refused(command + "formula:file=my.surface,file=my.surface", {"'file': expected one value"});
    refused(command + "formula:file=unknown.surface",
            {"unknown.surface:3: unknown name 'radius'", "column 5"});
    refused(command + "bezier-patch:file=net.json",
            {"net.json: points[0][1]: expected 3 coordinates", "got 2"});
    refused(command + "bezier-patch:file=net.json,a=2", {"unknown parameter 'a'", "file"});
    refused(command + "bezier-patch:radius=2", {"unknown parameter 'radius'", "file"});
    refused(command + "torus:file=net.json", {"unknown parameter 'file'", "major_radius"});
  }
  refused("darboux eval \"$(printf 'formula:file=a\\nb')\" --at 0,0", {"a\\x0Ab: expected a readable file"});
  // A path that is not UTF-8 still makes valid JSON.
  json(
      "name=$(printf '\\377.surface'); cp my.surface \"$name\"; darboux eval \"formula:file=$name\" --at 0,0 "
      "--json");
}

}  // namespace
}  // namespace darboux::test::surfaces_test
