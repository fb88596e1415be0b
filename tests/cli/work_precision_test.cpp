// `work-precision` by running the tool: what it writes, resuming, two runs compared; and what all report
// commands record of themselves. No test looks at how long anything took.
#include "cli.h"

namespace darboux::test::work_precision_test {
namespace {

class WorkCli : public Cli {
 protected:
  static constexpr const char* small =
      "darboux work-precision sphere torus --rounds 3 --points 64 --checked 64 --resolutions 4,8 ";

  // The samples without what is measured by the clock.
  static std::string errors(Json document) {
    for (Json& s : document["samples"]) {
      for (const char* key : {"rounds_ns", "time_low_ns", "time_high_ns", "on_front", "best_of_family"})
        s.erase(key);
      for (const char* key : {"time_ns", "seconds"}) s["metrics"].erase(key);
    }
    return document["samples"].dump();
  }
};

TEST_F(WorkCli, WritesWhatIsAskedFor) {
  const std::string run = small;
  const std::string text = good(run);
  for (const char* part : {"sphere at points", "torus on jittered meshes", "naive", "none failed"})
    EXPECT_NE(text.find(part), std::string::npos) << part;
  const Json document = json(run + "--json");
  EXPECT_TRUE(document["holds"].get<bool>());
  EXPECT_EQ(document["study"]["resolutions"], Json({4, 8}));
  const std::size_t samples = document["samples"].size();
  EXPECT_GT(samples, 60u);
  for (const Json& s : document["samples"]) {
    EXPECT_EQ(s["rounds_ns"].size(), 3u);
    EXPECT_TRUE(s["failure"].is_null());
    EXPECT_EQ(s["metrics"].contains("position_max"), s["domain"] == "evaluation");
  }
  const std::string csv = good(run + "--csv -");
  EXPECT_EQ(lines(csv).size(), samples + 1);
  EXPECT_EQ(errors(written_in_all_formats(run, "## sphere at points")), errors(document));
  // Two of one kind are told apart.
  const std::string two =
      good("darboux work-precision torus torus:minor_radius=0.4 --rounds 3 --points 64 --methods naive");
  EXPECT_NE(two.find("torus:major_radius=1,minor_radius=0.4 at points"), std::string::npos) << two;
}

TEST_F(WorkCli, RefusesWhatIsNotThere) {
  refused("darboux work-precision --methods simd", {"simd", "naive", "mikktspace"});
  refused("darboux work-precision --methods darbox",
          {"did you mean darboux?", "naive", "fragment-solve", "cubic"});
  refused("darboux work-precision nope", {"nope", "torus"});
  refused("darboux work-precision --meshes nope", {"nope", "jittered"});
  refused("darboux work-precision --y time", {"--y", "frame_max"});
  refused("darboux work-precision --rounds 2", {"--rounds"});
  refused("darboux work-precision --timeout 0", {"--timeout"});
  refused("darboux work-precision --resolutions 1,4", {"--resolutions", "numbers from 2"});
  refused("darboux work-precision --preset slow", {"quick, standard or full"});
  refused("darboux work-precision --json --csv -", {"standard output"});
  write_bytes(path("wrong.json"), R"({"command": "work-precision", "rounds": 1})");
  refused("darboux work-precision --study wrong.json", {"wrong.json", "/rounds"});
}

// What takes too long is told, and the rest is measured.
TEST_F(WorkCli, TimeOutsAreFailuresThatAreNamed) {
  const Json document = json(std::string(small) + "--methods naive,face --timeout 1e-9 --json", 1);
  EXPECT_FALSE(document["holds"].get<bool>());
  for (const Json& s : document["samples"]) {
    EXPECT_TRUE(s["metrics"].empty());
    EXPECT_NE(s["failure"].get<std::string>().find("timed out"), std::string::npos);
  }
  EXPECT_NE(good(std::string(small) + "--methods naive --timeout 1e-9", 1).find("2 failed"),
            std::string::npos);
}

// Errors of resumed and merged runs are those of one process, to the bit.
TEST_F(WorkCli, IsResumedAndMerged) {
  const std::string run = small;
  const std::string expected = errors(json(run + "--json"));
  std::string files;
  for (int i = 1; i <= 3; ++i) {
    const std::string file = "s" + std::to_string(i) + ".jsonl";
    good(run + "--shard " + std::to_string(i) + "/3 --results " + file);
    files += file + ' ';
  }
  good("darboux merge " + files + " -o merged.jsonl");
  EXPECT_EQ(errors(json(run + "--json --results merged.jsonl")), expected);
  const std::string all = read_bytes(path("merged.jsonl"));
  write_bytes(path("cut.jsonl"), all.substr(0, all.size() / 2));
  EXPECT_EQ(errors(json(run + "--json --results cut.jsonl")), expected);
  EXPECT_EQ(errors(json(run + "--json --threads 2")), expected);
  // What is there is not measured again: the same times.
  EXPECT_EQ(json(run + "--json --results merged.jsonl")["samples"],
            json(run + "--json --results merged.jsonl")["samples"]);
}

TEST_F(WorkCli, ComparesTwoRuns) {
  Json before = json(
      "darboux work-precision sphere torus --rounds 5 --points 64 --checked 64 --resolutions 4,8 --methods "
      "naive,face --json");
  for (Json& s : before["samples"]) s["rounds_ns"] = Json(std::vector<double>{10, 11, 12, 13, 14});
  Json after = before;
  const auto write = [&] {
    write_bytes(path("before.json"), before.dump());
    write_bytes(path("after.json"), after.dump());
  };
  write();
  const std::string compare = "darboux work-precision --compare before.json after.json ";
  EXPECT_NE(good(compare).find("6 measurements in both: 6 the same within 10 %"), std::string::npos);
  for (Json& s : before["samples"]) s["rounds_ns"] = Json(std::vector<double>{10, 11, 12, 13, 14});
  after = before;
  after["samples"][0]["rounds_ns"] = Json(std::vector<double>{20, 21, 22, 23, 24});
  after["samples"][1]["metrics"]["tangent_max"] = 3;
  after["samples"].erase(5);
  write();
  const Json pairs = json(compare + "--json", 1);
  EXPECT_FALSE(pairs["holds"].get<bool>());
  EXPECT_EQ(pairs["only_before"], 1);
  EXPECT_EQ(pairs["pairs"].size(), 5u);
  EXPECT_EQ(pairs["pairs"][0]["verdict"], "slower");
  EXPECT_NEAR(pairs["pairs"][0]["time_ratio"].get<double>(), 22. / 12, 0.1);
  EXPECT_EQ(pairs["pairs"][1]["verdict"], "less exact");
  EXPECT_EQ(pairs["pairs"][1]["error_metric"], "tangent_max");
  EXPECT_EQ(pairs["pairs"][2]["verdict"], "same");
  const std::string text = good(compare, 1);
  for (const char* part : {"slower: ", "less exact: ", "5 measurements in both", "1 only before"})
    EXPECT_NE(text.find(part), std::string::npos) << part << '\n' << text;
  refused("darboux work-precision --compare before.json", {"--compare"});
  refused("darboux work-precision --compare before.json nowhere.json", {"nowhere.json"});
  refused(compare + "-o page.html", {"--compare"});
  refused(compare + "--rounds 5", {"--compare", "--rounds"});
  refused(compare + "--tolerance nan", {"--tolerance", "nan"});
  refused("darboux work-precision --tolerance 1", {"--tolerance", "--compare"});
  refused("darboux work-precision --timeout inf", {"--timeout", "seconds above 0"});
  refused("darboux work-precision --resolutions 64..8", {"numbers that grow"});
  refused("darboux work-precision --resolutions 8,8", {"numbers that grow", "8,8"});
  // Another machine and another version are said, and compared all the same.
  after["provenance"]["machine"] = "abacus";
  after["provenance"]["version"] = "9.9.9";
  write();
  const std::string noted = good(compare, 1);
  EXPECT_NE(noted.find("note: version: 0."), std::string::npos) << noted;
  EXPECT_NE(noted.find("abacus after"), std::string::npos) << noted;
  EXPECT_EQ(json(compare + "--json", 1)["notes"].size(), 2u);
  // Times that are none.
  for (const Json& bad : {Json(0), Json(-1), Json("12")}) {
    Json broken = after;
    broken["samples"][2]["rounds_ns"][1] = bad;
    write_bytes(path("broken.json"), broken.dump());
    refused("darboux work-precision --compare before.json broken.json", {"broken.json", "sample 2"});
  }
  // A surface that was read from a file with other contents.
  before["study"]["inputs"]["my.surface"] = "1";
  after["study"]["inputs"]["my.surface"] = "2";
  write();
  refused(compare, {"after.json", "my.surface"});
  after["study"]["inputs"]["my.surface"] = "1";
  after["study"]["seed"] = 9;
  write();
  refused(compare, {"after.json", "seed"});
  write_bytes(path("other.json"), R"({"curves": []})");
  refused("darboux work-precision --compare before.json other.json", {"other.json", "without samples"});
  write_bytes(path("other.json"), R"({"samples": [{"surface": "torus"}]})");
  refused("darboux work-precision --compare before.json other.json", {"other.json", "sample 0"});
  write_bytes(path("other.json"), R"({"samples": []})");
  refused("darboux work-precision --compare before.json other.json", {"other.json", "study"});
}

// ---- of all report commands -------------------------------------------------------------------------------

// The line that a report records runs the same again: the same study, the same files.
TEST_F(WorkCli, TheRecordedLineRunsTheSameAgain) {
  fs::create_directory(path("a folder"));
  write_bytes(path("a folder/my.surface"), "x = u\ny = v\nz = u^2 - v^2\n");
  const std::string surface = "'formula:file=a folder/my.surface'";
  for (const std::string& command :
       std::vector<std::string>{"converge --surfaces " + surface +
                                    ",torus --methods face,average --meshes regular --resolutions 4,6,8 "
                                    "--picture picture.svg",
                                "stability " + surface + " torus --sweeps condition --points 2 --samples 1",
                                "work-precision " + surface +
                                    " torus --rounds 3 --points 64 --methods darboux --y partials_max"}) {
    SCOPED_TRACE(command);
    const Result first =
        sh("darboux " + command + " --results r.jsonl -o report.x --format md --csv rows.csv --json");
    ASSERT_LE(first.status, 1) << first.err;
    const Json document = Json::parse(first.out);
    const std::string line = document["provenance"]["command"];
    std::vector<std::pair<std::string, std::string>> written;
    for (const char* file : {"report.x", "rows.csv", "picture.svg"})
      if (fs::exists(path(file))) {
        written.emplace_back(file, read_bytes(path(file)));
        fs::remove(path(file));
      }
    EXPECT_GE(written.size(), 2u);
    // From the results that are there, times too are the same; only the line with the date is not.
    const Result again = sh(line + " --json");
    EXPECT_EQ(again.status, first.status) << line << '\n' << again.err;
    EXPECT_EQ(Json::parse(again.out)["study"], document["study"]) << line;
    for (const auto& [file, bytes] : written) {
      const std::string now = read_bytes(path(file));
      EXPECT_EQ(now.substr(0, now.rfind("\nMade by")), bytes.substr(0, bytes.rfind("\nMade by"))) << file;
    }
    fs::remove(path("r.jsonl"));
    fs::remove(path("picture.svg"));
  }
}

TEST_F(WorkCli, AFormatWithoutAFileIsRefused) {
  for (const char* command : {"converge", "stability", "work-precision"}) {
    refused(std::string("darboux ") + command + " --format svg", {"--format", "-o"});
    refused(std::string("darboux ") + command + " --format pdf -o x", {"--format", "html"});
  }
}

}  // namespace
}  // namespace darboux::test::work_precision_test
