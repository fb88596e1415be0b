// How findings count: --severity, --ignore, --strict, --exclude, --github, and what there is nothing to judge
// of.
#include "cli.h"

namespace darboux::test {
namespace {

using Json = nlohmann::json;

class Policy : public Cli {
 protected:
  const std::string bad_ = "darboux validate data/plainsphere_016.three.glb",
                    raw_ = "darboux validate data/torus_016.three.glb";
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
}

// The summary reads alone: what was found, what failed and what to do.
TEST_F(Policy, TheEndOfTheTextSumsUp) {
  const std::string out = good("darboux validate data/plainsphere_016.three.glb data/torus_032.mikk.glb", 1);
  const std::size_t at = out.find("\nfound:\n");
  ASSERT_NE(at, std::string::npos) << out;
  const std::string end = out.substr(at);
  for (const char* part :
       {"  error TANGENT_ZERO: 2 in 1 file\n", "failed or undetermined:\n  data/plainsphere_016.three.glb\n",
        "    TANGENT_ZERO (2), to do: ", "2 files: 1 pass, 1 fail\n"})
    EXPECT_NE(end.find(part), std::string::npos) << part << " in " << end;
}

TEST_F(Policy, WhereThereIsNothingToJudge) {
  write_bytes(path("empty.gltf"), R"({"asset": {"version": "2.0"}})");
  EXPECT_EQ(json("darboux validate empty.gltf --json")["verdict"], "nothing");
  const Json both = json("darboux validate empty.gltf data/torus_032.mikk.glb --json");
  EXPECT_EQ(both["verdict"], "pass");
  EXPECT_EQ(both["totals"]["verdicts"]["nothing"], 1);
  EXPECT_EQ(both["totals"]["verdicts"]["pass"], 1);
  EXPECT_EQ(both["schema_version"], 1);
}

TEST_F(Policy, ABudgetLeavesTheTrianglesComplete) {
  const Json mesh = only_mesh(json("darboux validate data/torus_032.mikk.glb --budget 1e-9 --json"));
  EXPECT_TRUE(has_finding(mesh, "BUDGET_SPENT"));
  EXPECT_EQ(mesh["reference"], "triangles");
  EXPECT_EQ(mesh["references"]["triangles"]["judged"], mesh["corners"]);
  refused("darboux validate data/torus_032.mikk.glb --budget 0", {"--budget", "expected seconds > 0, got 0"});
}

}  // namespace
}  // namespace darboux::test
