// How findings count: --severity, --ignore, --strict, --exclude, --github, and what there is nothing to
// assess of.
#include <cstring>

#include <pugixml.hpp>

#include "cli.h"

namespace darboux::test::validate_policy_test {
namespace {

using Json = nlohmann::json;

class Policy : public Cli {
 protected:
  const std::string bad_ = "darboux validate data/plainsphere_016.three.glb",
                    raw_ = "darboux validate data/torus_016.three.glb";
  Json sarif_results() const { return Json::parse(read_bytes(path("out.sarif")))["runs"][0]["results"]; }
};

TEST_F(Policy, SeveritiesMakeTheVerdict) {
  EXPECT_EQ(json(bad_ + " --json", 1)["verdict"], "fail");
  EXPECT_EQ(json(bad_ + " --severity TANGENT_ZERO=warning --json")["verdict"], "pass");
  EXPECT_EQ(json(raw_ + " --json")["verdict"], "pass");
  EXPECT_EQ(json(raw_ + " --severity TANGENT_HANDEDNESS_CONVENTION=error --json", 1)["verdict"], "fail");
  EXPECT_EQ(json(raw_ + " --fail-on TANGENT_HANDEDNESS_CONVENTION --json", 1)["verdict"], "fail");
  EXPECT_EQ(json(raw_ + " --strict --json", 1)["verdict"], "fail");
  EXPECT_EQ(json("darboux validate data/torus_032.mikk.glb --strict --json")["verdict"], "pass");
  EXPECT_EQ(json(raw_ + " --strict --severity TANGENT_HANDEDNESS_CONVENTION=info --json")["verdict"], "pass");
  refused(raw_ + " --severity TANGENT_ZERO", {"--severity", "expected TANGENT_ZERO=error, warning or info"});
  refused(raw_ + " --severity NOTHING=error", {"--severity", "NOTHING"});
  refused(raw_ + " --ignore nothing", {"--ignore", "nothing"});
}

TEST_F(Policy, IgnoredFindingsAreCounted) {
  const Json document = json(bad_ + " --ignore TANGENT_ZERO --json");
  EXPECT_EQ(document["verdict"], "pass");
  EXPECT_EQ(document["ignored"]["TANGENT_ZERO"], 2);
  EXPECT_FALSE(document["totals"]["codes"].contains("TANGENT_ZERO"));
  EXPECT_NE(good(bad_ + " --ignore TANGENT_ZERO").find("ignored: TANGENT_ZERO (2)"), std::string::npos);
  write_bytes(path("options.toml"), "ignore = [\"TANGENT_ZERO\"]\nstrict = false\n");
  EXPECT_EQ(json(bad_ + " --config options.toml --json")["verdict"], "pass");
}

TEST_F(Policy, ExcludedFilesAreNotRead) {
  fs::create_directories(path("assets/old/deep"));
  for (const char* name : {"assets/a.glb", "assets/b.glb", "assets/old/c.glb", "assets/old/deep/d.glb"})
    fs::copy_file(path("data/torus_032.mikk.glb"), path(name));
  const auto files = [&](const std::string& options) {
    return json("darboux validate assets --json " + options)["totals"]["verdicts"]["pass"].get<int>();
  };
  EXPECT_EQ(files(""), 4);
  EXPECT_EQ(files("--exclude 'old/*'"), 2);
  EXPECT_EQ(files("--exclude 'b.glb' --exclude '*/d.glb'"), 2);
  // A folder's name matches what is in it; a leading ./ and a slash at the end change nothing.
  for (const char* pattern : {"old", "old/", "./old", "./old/", "./old/*", ".//old//"})
    EXPECT_EQ(files(std::string("--exclude '") + pattern + "'"), 2) << pattern;
  EXPECT_EQ(files("--exclude '*/deep'"), 3);

  // A pattern that matches nothing is named; the rest is assessed.
  const Result unused = sh("darboux validate assets --exclude od --exclude old");
  EXPECT_EQ(unused.status, 0);
  expect_one_line(unused.err);
  EXPECT_NE(unused.err.find("--exclude 'od' matches no"), std::string::npos) << unused.err;
  // That all is left out is said as such.
  const Result none = sh("darboux validate assets --exclude '*'");
  EXPECT_EQ(none.status, 2);
  EXPECT_NE(none.err.find("assets: expected mesh files that --exclude leaves, got none"), std::string::npos)
      << none.err;
}

TEST_F(Policy, AnnotationsOfGitHub) {
  const std::string out = good(bad_ + " --github", 1);
  EXPECT_NE(out.find("\n::error file=data/plainsphere_016.three.glb,title=TANGENT_ZERO::mesh 0 primitive 0: "
                     "tangents are zero"),
            std::string::npos)
      << out;
  EXPECT_NE(out.find("\n::warning file=data/plainsphere_016.three.glb,title=TANGENT_HANDEDNESS_CONVENTION::"),
            std::string::npos);
  refused(bad_ + " --github --json", {"--github", "--json"});
  refused(bad_ + " --json report.json", {"--json", "> report.json"});

  // With a baseline only what there is more of than then; the rest is counted.
  good(bad_ + " --json > old.json", 1);
  const std::string known = good(bad_ + " --github --baseline old.json");
  EXPECT_EQ(known.find("\n::error"), std::string::npos) << known;
  EXPECT_EQ(known.find("\n::warning"), std::string::npos) << known;
  EXPECT_NE(known.find("\n::notice title=darboux::2 findings are as in the baseline"), std::string::npos);
  Json old = Json::parse(read_bytes(path("old.json")));
  for (Json& finding : old["files"][0]["meshes"][0]["findings"])
    if (finding["code"] == "TANGENT_ZERO") finding["count"] = 1;
  write_bytes(path("less.json"), old.dump());
  const std::string more = good(bad_ + " --github --baseline less.json", 1);
  EXPECT_NE(more.find(",title=TANGENT_ZERO::"), std::string::npos) << more;
  EXPECT_EQ(more.find(",title=TANGENT_HANDEDNESS_CONVENTION::"), std::string::npos) << more;
}

// The summary reads alone: what was found and what to do, what failed, of the rest a line per reason.
TEST_F(Policy, TheEndOfTheTextSumsUp) {
  fs::create_directories(path("assets"));
  for (int k = 0; k < 14; ++k)
    fs::copy_file(path("data/plainsphere_016.three.glb"), path("assets/bad" + std::to_string(k) + ".glb"));
  for (const char* name : {"assets/good0.glb", "assets/good1.glb"})
    fs::copy_file(path("data/torus_032.mikk.glb"), path(name));
  fs::copy_file(path("data/torus_016.three.glb"), path("assets/raw.glb"));
  write_bytes(path("assets/broken.glb"), "glTF no more");
  write_bytes(path("assets/empty.gltf"), R"({"asset": {"version": "2.0"}})");
  write_bytes(path("assets/bare.obj"), "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  const std::string out = sh("darboux validate assets").out;
  // What passes without a finding has no line of its own.
  for (const char* name : {"good0", "good1", "empty", "bare"})
    EXPECT_EQ(out.find(name), std::string::npos) << name << " in " << out;
  EXPECT_NE(out.find("assets/raw.glb: pass, with warnings\n"), std::string::npos) << out;
  const std::size_t at = out.find("\nfound:\n");
  ASSERT_NE(at, std::string::npos) << out;
  const std::string end = out.substr(at);
  for (const char* part :
       {"  error TANGENT_ZERO: 28 in 14 files. To do: store any unit vector perpendicular",
        "  warning TANGENT_HANDEDNESS_CONVENTION: 43392 in 15 files. To do: negate w in glTF files",
        "\nfailed:\n  assets/bad0.glb: TANGENT_ZERO (2)\n", "\n  assets/bad13.glb: TANGENT_ZERO (2)\n",
        "\ncannot be read:\n  assets/broken.glb: ",
        "\nthe rest:\n  2 files: pass, nothing found\n  1 file: pass, with warnings\n"
        "  1 file: neither normals nor tangents to judge\n  1 file: no triangles to judge\n"
        "20 files: 2 nothing, 3 pass, 14 fail, 1 unreadable\n"})
    EXPECT_NE(end.find(part), std::string::npos) << part << " in " << end;
  EXPECT_EQ(end.find("more above"), std::string::npos);
}

// Also where it has more meshes than tables are printed of, and nothing is found in them.
TEST_F(Policy, OneFileHasItsVerdict) {
  Glb glb = split_glb(read_bytes(path("data/torus_032.mikk.glb")));
  for (int k = 0; k < 12; ++k) glb.json["meshes"].push_back(glb.json["meshes"][0]);
  write_bytes(path("many.glb"), make_glb(glb.json.dump(), glb.bin));
  EXPECT_EQ(good("darboux validate many.glb"),
            "many.glb: pass\n  13 meshes: 13 pass\n"
            "--details shows a table and the notes of each of the 13 meshes and parts\n");
}

// The text of one file ends with what to do, once for each kind of what was found, warnings too.
TEST_F(Policy, OneFileEndsWithWhatToDo) {
  const std::string both = good(bad_, 1),
                    todo = "\nto do:\n  TANGENT_ZERO: store any unit vector perpendicular";
  EXPECT_NE(both.find(todo), std::string::npos) << both;
  EXPECT_NE(both.find("\n  TANGENT_HANDEDNESS_CONVENTION: negate w"), std::string::npos) << both;
  const std::string out =
      good("darboux validate data/mirrortorus_016.mikk.glb --surface torus --max-angle 1", 1);
  const std::size_t at = out.find("\nto do:\n");
  ASSERT_NE(at, std::string::npos) << out;
  const std::size_t first = out.find("\n  TANGENT_ANGLE: ", at);
  EXPECT_NE(first, std::string::npos) << out;
  EXPECT_EQ(out.find("\n  TANGENT_ANGLE: ", first + 1), std::string::npos) << out;
  EXPECT_EQ(good("darboux validate data/torus_032.mikk.glb").find("to do"), std::string::npos);
}

// Angles that the verdict does not go by are named as such.
TEST_F(Policy, TheTableNamesItsReference) {
  const std::string file = "darboux validate data/jittertorus_016.mikk.glb --report page.html",
                    head = "bitangent max/rms (deg)", other = "  against local\n",
                    page = "<h4>Errors by class of vertices, in degrees";
  const std::string by_triangles = good(file + " --reference triangles,local");
  EXPECT_NE(by_triangles.find(head + other), std::string::npos) << by_triangles;
  EXPECT_NE(read_bytes(path("page.html")).find(page + ", against local</h4>"), std::string::npos);
  EXPECT_EQ(good(file).find("  against "), std::string::npos);
  EXPECT_NE(read_bytes(path("page.html")).find(page + "</h4>"), std::string::npos);
}

TEST_F(Policy, AFileWithoutUvsIsSaidToHaveNone) {
  Glb glb = split_glb(read_bytes(path("data/sphere_016.none.glb")));
  glb.json["meshes"][0]["primitives"][0]["attributes"].erase("TEXCOORD_0");
  write_bytes(path("no_uvs.glb"), make_glb(glb.json.dump(), glb.bin));
  const std::string out = good("darboux validate no_uvs.glb --report page.html");
  EXPECT_NE(out.find(", uvs none, w none, "), std::string::npos) << out;
  EXPECT_EQ(read_bytes(path("page.html")).find("the uvs are "), std::string::npos);
}

// One line says what became of a file of several parts, before their tables.
TEST_F(Policy, SeveralPartsBeginWithOneLine) {
  const std::string file = "darboux validate data/mirrortorus_016.mikk.glb";
  EXPECT_NE(good(file).find(": pass\n  2 parts: 2 pass\n  mesh 0 "), std::string::npos);
  const std::string out = good(file + " --surface torus --max-angle 1", 1);
  EXPECT_NE(out.find(": fail\n  2 parts: 2 fail; TANGENT_ANGLE "), std::string::npos) << out;
}

// A file whose tangents lean on their normals: at some corners as far as an error, at others as a warning.
class Leaning : public Policy {
 protected:
  Leaning() {
    Glb glb = split_glb(read_bytes(path("data/torus_032.mikk.glb")));
    const Json primitive = glb.json["meshes"][0]["primitives"][0];
    const auto at = [&](const char* name, std::size_t vertex, std::size_t bytes) {
      const Json accessor = glb.json["accessors"][primitive["attributes"][name].get<std::size_t>()];
      const Json view = glb.json["bufferViews"][accessor["bufferView"].get<std::size_t>()];
      return &glb.bin[view.value("byteOffset", std::size_t{0}) +
                      accessor.value("byteOffset", std::size_t{0}) +
                      vertex * view.value("byteStride", bytes)];
    };
    // t cos a + n sin a: |t.n| = sin a.
    const auto lean = [&](std::size_t vertex, float sine) {
      float t[3], n[3];
      std::memcpy(t, at("TANGENT", vertex, 16), sizeof t);
      std::memcpy(n, at("NORMAL", vertex, 12), sizeof n);
      for (int k = 0; k < 3; ++k) t[k] = t[k] * std::sqrt(1 - sine * sine) + n[k] * sine;
      std::memcpy(at("TANGENT", vertex, 16), t, sizeof t);
    };
    lean(100, 0.1f);
    lean(500, 0.5f);
    lean(501, 0.5f);
    write_bytes(path("leaning.glb"), make_glb(glb.json.dump(), glb.bin));
  }
  static std::size_t count(const Json& mesh, const std::string& severity) {
    std::size_t sum = 0;
    for (const Json& finding : mesh["findings"])
      if (finding["code"] == "TANGENT_NOT_ORTHOGONAL" && finding["severity"] == severity)
        sum += finding["count"].get<std::size_t>();
    return sum;
  }
  const std::string leaning_ = "darboux validate leaning.glb";
};

TEST_F(Leaning, ErrorsAndWarningsOfOneCodeAreCountedApart) {
  const Json document = json(leaning_ + " --json", 1);
  const std::size_t errors = count(only_mesh(document), "error"),
                    warnings = count(only_mesh(document), "warning");
  ASSERT_GT(errors, 0u);
  ASSERT_GT(warnings, 0u);
  const Json& totals = document["totals"];
  EXPECT_EQ(totals["codes"]["TANGENT_NOT_ORTHOGONAL"], errors + warnings);
  EXPECT_EQ(totals["codes_by_severity"]["TANGENT_NOT_ORTHOGONAL"],
            (Json{{"error", errors}, {"warning", warnings}}));
  // Each says its own limit.
  for (const Json& finding : document["files"][0]["meshes"][0]["findings"])
    if (finding["code"] == "TANGENT_NOT_ORTHOGONAL") {
      EXPECT_TRUE(finding["message"].get<std::string>().starts_with(
          finding["severity"] == "error"
              ? "tangents are not perpendicular to the normal (|t.n| up to 0.5, limit 0.26)"
              : "tangents are not perpendicular to the normal (|t.n| > 0.02; above 0.26 an error"))
          << finding;
    }
  // In the summary of a file among many, whichever came first.
  std::string many = leaning_;
  for (int k = 0; k < 12; ++k) many += " leaning.glb";
  const std::string out = good(many, 1);
  for (const auto& [severity, n] : {std::pair("error", errors), std::pair("warning", warnings)}) {
    const std::string line =
        "\n    " + std::string(severity) + " TANGENT_NOT_ORTHOGONAL (" + std::to_string(n) + "): ";
    EXPECT_NE(out.find(line), std::string::npos) << line << " in " << out;
  }
  // And in the page.
  sh(leaning_ + " data/torus_032.mikk.glb --report page.html");
  const std::string page = read_bytes(path("page.html")), code = "<bdi>TANGENT_NOT_ORTHOGONAL</bdi> ";
  EXPECT_NE(page.find(code + std::to_string(errors)), std::string::npos);
  EXPECT_NE(page.find("warnings: " + code + std::to_string(warnings)), std::string::npos);
  EXPECT_NE(page.find("data-codes=\"TANGENT_NOT_ORTHOGONAL"), std::string::npos);
  EXPECT_EQ(page.find("TANGENT_NOT_ORTHOGONAL TANGENT_NOT_ORTHOGONAL"), std::string::npos);
}

// In SARIF both have fingerprints and states of their own, also under options that make them equally severe.
TEST_F(Leaning, FingerprintsTellSeveritiesApart) {
  good(leaning_ + " --json > old.json", 1);
  Json old = Json::parse(read_bytes(path("old.json")));
  for (Json& finding : old["files"][0]["meshes"][0]["findings"])
    if (finding["code"] == "TANGENT_NOT_ORTHOGONAL" && finding["severity"] == "warning")
      finding["count"] = 1000;
  write_bytes(path("more.json"), old.dump());
  for (const std::string options : {"", " --strict"}) {
    sh(leaning_ + " --baseline more.json --sarif out.sarif" + options);
    std::vector<std::string> fingerprints, states;
    const Json results = sarif_results();
    for (const Json& result : results)
      if (result["ruleId"] == "TANGENT_NOT_ORTHOGONAL") {
        fingerprints.push_back(result["partialFingerprints"]["primaryLocationLineHash"]);
        states.push_back(result["baselineState"]);
      }
    EXPECT_EQ(fingerprints, (std::vector<std::string>{"TANGENT_NOT_ORTHOGONAL/mesh 0 primitive 0/error",
                                                      "TANGENT_NOT_ORTHOGONAL/mesh 0 primitive 0/warning"}));
    EXPECT_EQ(states, (std::vector<std::string>{"unchanged", "updated"}));
  }
}

// A warning of the baseline does not excuse an error of its code; one that an option raises is none.
TEST_F(Leaning, ErrorsAreComparedWithErrors) {
  good(leaning_ + " --json > old.json", 1);
  good(leaning_ + " --strict --json > strict.json", 1);
  for (const std::string baseline : {" --baseline old.json", " --baseline strict.json"}) {
    good(leaning_ + baseline);
    good(leaning_ + baseline + " --strict");
  }
  for (const char* file : {"old.json", "strict.json"}) {
    // As many corners then, but one of them an error.
    Json then = Json::parse(read_bytes(path(file)));
    std::size_t moved = 0;
    for (const std::string wanted : {"error", "warning"})
      for (Json& finding : then["files"][0]["meshes"][0]["findings"]) {
        const std::string own = finding.value("own_severity", finding["severity"].get<std::string>());
        if (finding["code"] != "TANGENT_NOT_ORTHOGONAL" || own != wanted) continue;
        const std::size_t n = finding["count"];
        if (wanted == "error") moved = n - 1;
        finding["count"] = wanted == "error" ? 1 : n + moved;
      }
    ASSERT_GT(moved, 0u);
    write_bytes(path("then.json"), then.dump());
    EXPECT_EQ(json(leaning_ + " --baseline then.json --json", 1)["worse"], true) << file;
  }
}

// What was known counts, in primitives too that come before the first finding of the code.
TEST_F(Policy, TheBaselinesCountsAreOfTheWholeFile) {
  Glb glb = split_glb(read_bytes(path("data/plainsphere_016.three.glb")));
  auto& primitives = glb.json["meshes"][0]["primitives"];
  const auto copy = primitives[0];
  primitives.push_back(copy);
  primitives[0]["attributes"].erase("TANGENT");
  write_bytes(path("two.glb"), make_glb(glb.json.dump(), glb.bin));
  Json old = json("darboux validate two.glb --json", 1);
  old["files"][0]["meshes"][0]["findings"].push_back(
      {{"code", "TANGENT_ZERO"}, {"severity", "error"}, {"count", 5}, {"message", ""}, {"to_do", ""}});
  write_bytes(path("old.json"), old.dump());
  std::string many = "darboux validate";
  for (int k = 0; k < 13; ++k) many += " two.glb";
  const std::string out = good(many + " --baseline old.json");
  EXPECT_NE(out.find("error TANGENT_ZERO (2 in 1 of them, 7 in the baseline)"), std::string::npos) << out;
}

// --strict lets nothing through that fails without it, and every output says why.
TEST_F(Policy, UndeterminedIsAFinding) {
  good("darboux mesh torus --grid 16x8 -o bare.glb");
  good("darboux validate bare.glb --json > passed.json");
  const std::string bare = "darboux validate bare.glb --reference mikktspace";
  const auto finding = [](const Json& document) {
    for (const Json& f : document["files"][0]["meshes"][0]["findings"])
      if (f["code"] == "UNDETERMINED") return f;
    return Json();
  };
  const Json plain = json(bare + " --json", 1), strict = json(bare + " --strict --json", 1);
  EXPECT_EQ(plain["verdict"], "undetermined");
  EXPECT_EQ(finding(plain)["severity"], "warning");
  EXPECT_EQ(strict["verdict"], "fail");
  EXPECT_EQ(finding(strict)["severity"], "error");
  EXPECT_EQ(finding(strict)["own_severity"], "warning");
  EXPECT_EQ(finding(strict)["count"], 1);
  EXPECT_EQ(json(bare + " --ignore UNDETERMINED --strict --json", 1)["verdict"], "undetermined");
  for (const std::string options : {"", " --strict", " --ignore UNDETERMINED"})
    for (const std::string baseline : {"", " --baseline passed.json"}) {
      SCOPED_TRACE(options + baseline);
      const std::string out =
          good(bare + options + baseline + " --junit out.xml --sarif out.sarif --github", 1);
      pugi::xml_document xml;
      ASSERT_TRUE(xml.load_file(path("out.xml").c_str()));
      const pugi::xml_node suite = xml.child("testsuites").child("testsuite");
      EXPECT_EQ(suite.attribute("failures").as_int(), 1);
      EXPECT_STREQ(suite.child("testcase").child("failure").attribute("type").value(), "UNDETERMINED");
      EXPECT_EQ(out.find("nothing is worse"), std::string::npos) << out;
      if (options == " --ignore UNDETERMINED") continue;
      const std::string level = options.empty() ? "warning" : "error";
      EXPECT_NE(out.find("\n::" + level + " file=bare.glb,title=UNDETERMINED::"), std::string::npos) << out;
      EXPECT_NE(out.find("\n    " + level + " UNDETERMINED (1"), std::string::npos) << out;
      std::vector<std::string> found;
      const Json results = sarif_results();
      for (const Json& result : results)
        if (result["ruleId"] == "UNDETERMINED") found.push_back(result["level"]);
      EXPECT_EQ(found, std::vector<std::string>{level});
    }
  const std::string two = "darboux validate bare.glb empty.gltf --reference mikktspace";
  write_bytes(path("empty.gltf"), R"({"asset": {"version": "2.0"}})");
  EXPECT_NE(good(two + " --strict", 1).find("\nfailed:\n  bare.glb: UNDETERMINED (1)"), std::string::npos);
  EXPECT_NE(good(two, 1).find("\nundetermined:\n  bare.glb: UNDETERMINED (1)\n"), std::string::npos);
  // What was undetermined may stay so, by reports of earlier versions too.
  Json old = plain;
  write_bytes(path("old.json"), old.dump());
  good(bare + " --baseline old.json --strict");
  Json& findings = old["files"][0]["meshes"][0]["findings"];
  for (std::size_t k = findings.size(); k-- > 0;)
    if (findings[k]["code"] == "UNDETERMINED") findings.erase(k);
  write_bytes(path("older.json"), old.dump());
  good(bare + " --baseline older.json --strict");
}

// A page of the installed documentation is no address for those who read a report.
TEST_F(Policy, SarifLinksToPagesOfTheWebOnly) {
  sh(bad_ + " --sarif out.sarif");
  const Json document = Json::parse(read_bytes(path("out.sarif"))),
             &rules = document["runs"][0]["tool"]["driver"]["rules"];
  EXPECT_GT(rules.size(), 40u);
  for (const Json& rule : rules) {
    EXPECT_FALSE(rule["help"]["text"].get<std::string>().empty());
    if (rule.contains("helpUri")) {
      EXPECT_EQ(rule["helpUri"].get<std::string>().rfind("http", 0), 0u);
    }
  }
}

TEST_F(Policy, WhereThereIsNothingToAssess) {
  write_bytes(path("empty.gltf"), R"({"asset": {"version": "2.0"}})");
  EXPECT_EQ(json("darboux validate empty.gltf --json")["verdict"], "nothing");
  const Json both = json("darboux validate empty.gltf data/torus_032.mikk.glb --json");
  EXPECT_EQ(both["verdict"], "pass");
  EXPECT_EQ(both["totals"]["verdicts"]["nothing"], 1);
  EXPECT_EQ(both["totals"]["verdicts"]["pass"], 1);
  EXPECT_EQ(both["schema_version"], 1);

  // In JUnit it is skipped, and said why; without a baseline nothing is as in one.
  const auto only_case = [&](const std::string& options, int status) {
    good("darboux validate empty.gltf --junit out.xml --sarif out.sarif" + options, status);
    pugi::xml_document xml;
    EXPECT_TRUE(xml.load_file(path("out.xml").c_str()));
    const pugi::xml_node node = xml.child("testsuites").child("testsuite").child("testcase").first_child();
    return std::string(node.name()) + ": " + node.attribute("message").value();
  };
  EXPECT_EQ(only_case("", 0), "skipped: holds no triangles to judge");
  Json old = json("darboux validate empty.gltf --json");
  write_bytes(path("old.json"), old.dump());
  EXPECT_EQ(only_case(" --baseline old.json", 0), "skipped: holds no triangles to judge");
  // Where it passed then it is worse, in every output.
  old["files"][0]["verdict"] = "pass";
  write_bytes(path("old.json"), old.dump());
  EXPECT_EQ(only_case(" --baseline old.json", 1).substr(0, 37), "failure: the file passed in the basel");
  EXPECT_EQ(json("darboux validate empty.gltf --baseline old.json --json", 1)["worse"], true);
  const Json results = sarif_results();
  ASSERT_EQ(results.size(), 1u);
  EXPECT_EQ(results[0]["ruleId"], "FILE_NOTHING_TO_JUDGE");
  EXPECT_EQ(results[0]["baselineState"], "new");
  EXPECT_NE(good("darboux validate empty.gltf --baseline old.json --github", 1)
                .find("\n::error file=empty.gltf,title=FILE_NOTHING_TO_JUDGE::"),
            std::string::npos);
}

TEST_F(Policy, ABudgetLeavesTheTrianglesComplete) {
  const Json mesh = only_mesh(json("darboux validate data/torus_032.mikk.glb --budget 1e-9 --json"));
  EXPECT_TRUE(has_finding(mesh, "BUDGET_SPENT"));
  EXPECT_EQ(mesh["reference"], "triangles");
  EXPECT_EQ(mesh["references"]["triangles"]["judged"], mesh["corners"]);
  refused("darboux validate data/torus_032.mikk.glb --budget 0", {"--budget", "expected seconds > 0, got 0"});
}

}  // namespace
}  // namespace darboux::test::validate_policy_test
