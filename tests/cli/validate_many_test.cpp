// `validate` over many files: folders, baselines, a file of options, and what CI systems read.
#include <fstream>

#include <pugixml.hpp>

#include "cli.h"

namespace darboux::test::validate_many_test {
namespace {

class CliMany : public Cli {
 protected:
  // assets/: good.glb (pass), deep/bad.glb (fail: two tangents are zero) and deep/note.txt.
  CliMany() {
    fs::create_directories(path("assets/deep"));
    fs::copy_file(path("data/torus_016.three.glb"), path("assets/good.glb"));
    fs::copy_file(path("data/plainsphere_016.three.glb"), path("assets/deep/bad.glb"));
    std::ofstream(path("assets/deep/note.txt")) << "no mesh\n";
  }
  void write(const std::string& name, const std::string& text) const { std::ofstream(path(name)) << text; }
};

TEST_F(CliMany, AFolderStandsForItsMeshFiles) {
  const Json folder = json("darboux validate assets --json --threads 2", 1);
  EXPECT_EQ(folder, json("darboux validate assets/deep/bad.glb assets/good.glb --json", 1));
  ASSERT_EQ(folder["files"].size(), 2u);
  EXPECT_EQ(folder["files"][0]["file"], "assets/deep/bad.glb");
  const std::string text = good("darboux validate assets", 1);
  EXPECT_NE(text.find("\n2 files: 1 pass, 1 fail\n"), std::string::npos) << text;
}

TEST_F(CliMany, BrokenFilesArePassedOver) {
  write("assets/broken.glb", "glTF no more");
  const Result r = sh("darboux validate assets --json");
  EXPECT_EQ(r.status, 2);
  expect_one_line(r.err);
  EXPECT_NE(r.err.find("assets/broken.glb: "), std::string::npos);
  const Json document = Json::parse(r.out);
  ASSERT_EQ(document["files"].size(), 3u);
  EXPECT_EQ(document["verdict"], "fail");
  EXPECT_EQ(document["files"][0]["file"], "assets/broken.glb");
  EXPECT_TRUE(document["files"][0].contains("error"));
  EXPECT_EQ(document["files"][2]["verdict"], "pass");
  EXPECT_NE(sh("darboux validate assets").out.find("\n3 files: 1 pass, 1 fail, 1 unreadable\n"),
            std::string::npos);

  fs::create_directory(path("empty"));
  const Result empty = sh("darboux validate empty assets/good.glb");
  EXPECT_EQ(empty.status, 2);
  EXPECT_NE(empty.err.find("empty: expected mesh files"), std::string::npos) << empty.err;
  EXPECT_NE(empty.out.find("assets/good.glb: pass"), std::string::npos);
}

// More than a dozen tables are not printed unless asked for; the findings are.
TEST_F(CliMany, ManyMeshesAreSummarised) {
  for (int k = 0; k < 12; ++k)
    fs::copy_file(path("assets/good.glb"), path("assets/copy" + std::to_string(k) + ".glb"));
  const std::string brief = good("darboux validate assets", 1);
  EXPECT_EQ(brief.find("interior"), std::string::npos) << brief;
  EXPECT_NE(
      brief.find(
          "\nassets/copy11.glb: pass, with warnings\n    warning TANGENT_HANDEDNESS_CONVENTION (3072): "),
      std::string::npos)
      << brief;
  EXPECT_NE(brief.find("\n    error TANGENT_ZERO (2): "), std::string::npos) << brief;
  EXPECT_NE(brief.find("\n14 files: 13 pass, 1 fail\n"), std::string::npos) << brief;
  const std::string details = good("darboux validate assets --details", 1);
  std::size_t tables = 0;
  for (const std::string& line : lines(details)) tables += line.starts_with("    interior ");
  EXPECT_EQ(tables, 14u);
}

// A baseline: what was found then does not count, what is new or more does.
TEST_F(CliMany, OnlyWhatGotWorseThanTheBaselineCounts) {
  good("darboux validate assets --json > old.json", 1);
  const Json same = json("darboux validate assets --baseline old.json --json");
  EXPECT_EQ(same["verdict"], "fail");
  EXPECT_EQ(same["worse"], false);
  for (const Json& file : same["files"]) {
    EXPECT_EQ(file["worse"], false);
    for (const Json& mesh : file["meshes"])
      for (const Json& finding : mesh["findings"])
        EXPECT_EQ(finding["baseline"], finding["count"]) << finding;
  }
  const std::string text = good("darboux validate assets --baseline old.json");
  EXPECT_NE(text.find("nothing is worse than in the baseline\n"), std::string::npos) << text;
  EXPECT_NE(text.find("\nfailed:\n  assets/deep/bad.glb: TANGENT_ZERO (2) (no worse than in the baseline)\n"),
            std::string::npos)
      << text;

  // One less in the baseline is one more now.
  Json old = Json::parse(read_bytes(path("old.json")));
  for (Json& finding : old["files"][0]["meshes"][0]["findings"])
    if (finding["code"] == "TANGENT_ZERO") finding["count"] = 1;
  write("less.json", old.dump());
  const Json more = json("darboux validate assets --baseline less.json --json", 1);
  EXPECT_EQ(more["worse"], true);
  EXPECT_EQ(more["files"][0]["worse"], true);
  EXPECT_EQ(more["files"][1]["worse"], false);
  // A warning that is raised to an error was known.
  good("darboux validate assets --baseline old.json --fail-on TANGENT_HANDEDNESS_CONVENTION");
  // Tangents that nothing could assess then may stay so; those of a mesh that passed may not.
  good("darboux mesh torus --grid 16x8 -o assets/bare.glb");
  const std::string bare_only = "darboux validate assets/bare.glb --reference mikktspace --json";
  Json bare = json(bare_only, 1);
  EXPECT_EQ(bare["verdict"], "undetermined");
  write("bare.json", bare.dump());
  EXPECT_EQ(json(bare_only + " --baseline bare.json")["worse"], false);
  bare["files"][0]["verdict"] = bare["files"][0]["meshes"][0]["verdict"] = "pass";
  write("bare.json", bare.dump());
  EXPECT_EQ(json(bare_only + " --baseline bare.json --junit out.xml", 1)["worse"], true);
  pugi::xml_document xml;
  ASSERT_TRUE(xml.load_file(path("out.xml").c_str()));
  EXPECT_EQ(xml.child("testsuites").child("testsuite").attribute("failures").as_int(), 1);
  fs::remove(path("assets/bare.glb"));
  // A new file counts, one that is gone does not.
  fs::rename(path("assets/deep/bad.glb"), path("assets/renamed.glb"));
  EXPECT_EQ(json("darboux validate assets --baseline old.json --json", 1)["worse"], true);
  fs::remove(path("assets/renamed.glb"));
  good("darboux validate assets --baseline old.json");
  // A file that could not be read then may stay so; one that could may not.
  write("assets/broken.glb", "glTF no more");
  EXPECT_EQ(sh("darboux validate assets --baseline old.json").status, 2);
  sh("darboux validate assets --json > broken.json");
  EXPECT_EQ(sh("darboux validate assets --baseline broken.json").status, 0);
  // Nor is it worse if it can be read now, whatever is found: in JUnit as in the exit status.
  for (const char* now :
       {"data/sphere_016.none.glb", "data/plainsphere_016.three.glb", "data/mirrortorus_016.mikk.glb"}) {
    fs::copy_file(path(now), path("assets/broken.glb"), fs::copy_options::overwrite_existing);
    EXPECT_EQ(sh("darboux validate assets --baseline broken.json --junit out.xml").status, 0) << now;
    pugi::xml_document xml;
    ASSERT_TRUE(xml.load_file(path("out.xml").c_str()));
    for (const pugi::xml_node suite : xml.child("testsuites").children("testsuite"))
      EXPECT_EQ(suite.attribute("failures").as_int() + suite.attribute("errors").as_int(), 0) << now;
  }
}

TEST_F(CliMany, RefusesABaselineThatIsNone) {
  refused("darboux validate assets --baseline gone.json", {"gone.json", "no file"});
  write("text.json", "no json");
  refused("darboux validate assets --baseline text.json", {"text.json", "JSON"});
  for (const char* wrong :
       {"[]", "{}", R"({"files": 3})", R"({"files": [{"file": 1}]})",
        R"({"files": [{"file": "assets/good.glb", "verdict": "perhaps", "meshes": []}]})",
        R"({"files": [{"file": "assets/good.glb", "verdict": "fail", "meshes": [{"mesh": 0,
                                "primitive": 0, "findings": [{"code": "TANGENT_ZERO", "count": -1}]}]}]})"}) {
    write("wrong.json", wrong);
    refused("darboux validate assets --baseline wrong.json", {"wrong.json"});
  }
}

TEST_F(CliMany, OptionsComeFromAFileToo) {
  write("ci.toml",
        "# what CI checks\nfiles = [\"assets/good.glb\"]\nmax-angle = 7.5\nreference = \"analytic\"\njson = "
        "true\n"
        "fail-on = [\"TANGENT_NOT_MIKKTSPACE\", \"TANGENT_ZERO\"]\n");
  EXPECT_EQ(json("darboux validate --config ci.toml"),
            json("darboux validate assets/good.glb --max-angle 7.5 --reference analytic --fail-on "
                 "TANGENT_NOT_MIKKTSPACE,TANGENT_ZERO --json"));
  // The command line goes before it.
  EXPECT_EQ(json("darboux validate assets/deep/bad.glb --config ci.toml", 1)["files"][0]["file"],
            "assets/deep/bad.glb");
  for (const auto& [text, part] : std::vector<std::pair<std::string, std::string>>{
           {"max-angel = 2", "'max-angel'"},
           {"max-angle = 2\nmax-angle = 3", "received 2"},
           {"max-angle = two", "max-angle"},
           {"max-angle = -2", "--max-angle"},
           {"[validate]\nmax-angle = 2", "section [validate]"},
           {"fail-on = [\"NO_SUCH\"]", "'NO_SUCH'"},
           {"strict = []", "expected a value of strict, got none"},
           {"strict=[\"", "expected a value of strict, got none"},
           {"config = \"ci.toml\"", "'config'"}}) {
    write("wrong.toml", text + '\n');
    refused("darboux validate assets/good.glb --config wrong.toml", {part});
  }
  refused("darboux validate assets --config gone.toml", {"gone.toml", "no file"});
}

TEST_F(CliMany, SarifNamesEveryFindingToActOn) {
  write("assets/a #%1.glb", "glTF no more");
  const Json document = Json::parse(sh("darboux validate assets --json --sarif out.sarif").out);
  const Json sarif = Json::parse(read_bytes(path("out.sarif")));
  EXPECT_EQ(sarif["version"], "2.1.0");
  ASSERT_EQ(sarif["runs"].size(), 1u);
  const Json& run = sarif["runs"][0];
  EXPECT_EQ(run["tool"]["driver"]["name"], "darboux");
  std::vector<std::string> rules;
  for (const Json& rule : run["tool"]["driver"]["rules"]) {
    // GitHub requires the first four.
    expect_keys(rule, {"id", "shortDescription", "fullDescription", "help", "defaultConfiguration"});
    rules.push_back(rule["id"]);
  }
  std::vector<std::string> wanted{"assets/a%20%23%251.glb FILE_UNREADABLE error"}, given;
  for (const Json& file : document["files"])
    for (const Json& mesh : file["meshes"])
      for (const Json& finding : mesh["findings"])
        if (finding["severity"] != "info")
          wanted.push_back(file["file"].get<std::string>() + ' ' + finding["code"].get<std::string>() + ' ' +
                           finding["severity"].get<std::string>());
  for (const Json& result : run["results"]) {
    expect_keys(result, {"ruleId", "level", "message", "locations", "partialFingerprints"});
    const Json& location = result["locations"][0]["physicalLocation"];
    EXPECT_EQ(location["region"]["startLine"], 1);
    EXPECT_NE(std::find(rules.begin(), rules.end(), result["ruleId"]), rules.end()) << result["ruleId"];
    given.push_back(location["artifactLocation"]["uri"].get<std::string>() + ' ' +
                    result["ruleId"].get<std::string>() + ' ' + result["level"].get<std::string>());
  }
  EXPECT_EQ(given, wanted);
  EXPECT_GE(wanted.size(), 4u);

  // With a baseline: unchanged; new where that file was not there.
  sh("darboux validate assets/deep --json > old.json");
  sh("darboux validate assets/deep assets/good.glb --baseline old.json --sarif out.sarif");
  const Json compared = Json::parse(read_bytes(path("out.sarif")));
  for (const Json& result : compared["runs"][0]["results"])
    EXPECT_EQ(result["baselineState"],
              result["locations"][0]["physicalLocation"]["artifactLocation"]["uri"] == "assets/good.glb"
                  ? "new"
                  : "unchanged")
        << result;
}

TEST_F(CliMany, JUnitHasATestCaseForEveryMesh) {
  // XML has neither control characters nor U+FFFF.
  write("assets/<&\"\x01\xff\xef\xbf\xbf>.glb", "glTF no more");
  EXPECT_EQ(sh("darboux validate assets --junit out.xml").status, 2);
  pugi::xml_document xml;
  const pugi::xml_parse_result parsed = xml.load_file(path("out.xml").c_str());
  ASSERT_TRUE(parsed) << parsed.description();
  const std::string bytes = read_bytes(path("out.xml"));
  EXPECT_EQ(bytes.find('\x01'), std::string::npos);
  EXPECT_EQ(bytes.find("&#x01;"), std::string::npos);
  EXPECT_EQ(bytes.find('\xff'), std::string::npos);
  EXPECT_EQ(bytes.find("\xef\xbf\xbf"), std::string::npos);
  std::vector<std::string> texts;
  for (const pugi::xml_node suite : xml.child("testsuites").children("testsuite")) {
    EXPECT_EQ(suite.attribute("tests").as_int(), 1);
    const pugi::xml_node test = suite.child("testcase");
    texts.push_back(std::string(test.attribute("name").value()) + ": " +
                    (test.child("error")     ? test.child("error").attribute("type").value()
                     : test.child("failure") ? test.child("failure").attribute("type").value()
                                             : "passed"));
    EXPECT_EQ(suite.attribute("failures").as_int(), test.child("failure") ? 1 : 0);
    EXPECT_EQ(suite.attribute("errors").as_int(), test.child("error") ? 1 : 0);
  }
  EXPECT_EQ(texts, (std::vector<std::string>{"file: FILE_UNREADABLE", "mesh 0 primitive 0: TANGENT_ZERO",
                                             "mesh 0 primitive 0: passed"}));

  sh("darboux validate assets/deep --json > old.json");
  good("darboux validate assets/deep --baseline old.json --junit out.xml");
  ASSERT_TRUE(xml.load_file(path("out.xml").c_str()));
  const pugi::xml_node test = xml.child("testsuites").child("testsuite").child("testcase");
  EXPECT_FALSE(test.child("failure"));
  EXPECT_NE(std::string(test.child("system-out").text().get()).find("TANGENT_ZERO (2)"), std::string::npos);

  // JSON cannot hold that file's name, but its baseline knows it.
  sh("darboux validate assets --json > old.json");
  EXPECT_EQ(sh("darboux validate assets --baseline old.json --junit out.xml").status, 0);
  ASSERT_TRUE(xml.load_file(path("out.xml").c_str()));
  const pugi::xml_node suite = xml.child("testsuites").child("testsuite");
  EXPECT_TRUE(suite.child("testcase").child("skipped"));
  EXPECT_EQ(suite.attribute("skipped").as_int(), 1);
  EXPECT_EQ(suite.attribute("errors").as_int(), 0);
}

// Refused before anything is assessed, and nothing is left behind.
TEST_F(CliMany, RefusesFilesThatCannotBeWritten) {
  for (const std::string option : {"--sarif", "--junit", "--report"}) {
    refused("darboux validate assets " + option + " gone/out", {"gone"});
    refused("darboux validate assets " + option + " assets", {"assets"});
    refused("darboux validate assets " + option + " ./assets/good.glb", {option, "judged"});
  }
  EXPECT_FALSE(fs::exists(path("gone")));
  refused("darboux validate assets --sarif x --junit x", {"--junit", "--sarif"});
  for (const std::string option : {"--sarif", "--junit"})
    refused("darboux validate assets " + option + " -", {option});
}

}  // namespace
}  // namespace darboux::test::validate_many_test
