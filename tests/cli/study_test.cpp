// Studies of `converge` and `stability`: results files, resuming, shards, `merge`.
#include <chrono>
#include <csignal>
#include <cstdio>
#include <random>
#include <thread>

#include <sys/wait.h>
#include <unistd.h>

#include "cli.h"

namespace darboux::test::study_test {
namespace {

class StudyCli : public Cli {
 protected:
  StudyCli() {
    write_bytes(path("study.json"),
                R"({"command": "converge", "surfaces": ["torus", "sphere"], "methods": ["average", "cubic"],)"
                R"( "meshes": ["jittered", "regular"], "resolutions": [8, 12, 16, 24], "seed": 7})");
  }

  // What a study found, without its times.
  std::string numbers(const std::string& options) const {
    Json document = json("darboux converge --study study.json --json " + options);
    for (Json& study : document["studies"]) study.erase("seconds");
    return document["studies"].dump();
  }

  // Starts the tool, and kills it after so long. Whether it was still running.
  bool killed(std::chrono::microseconds after) const {
    const pid_t child = ::fork();
    if (child == 0) {
      if (::chdir(path("").c_str()) != 0 || !std::freopen("/dev/null", "w", stdout)) std::_Exit(99);
      ::execl(DARBOUX_TOOL, "darboux", "converge", "--study", "study.json", "--results", "r.jsonl",
              "--threads", "2", nullptr);
      std::_Exit(99);
    }
    std::this_thread::sleep_for(after);
    ::kill(child, SIGKILL);
    int status = 0;
    ::waitpid(child, &status, 0);
    EXPECT_FALSE(WIFEXITED(status) && WEXITSTATUS(status) == 99);
    return WIFSIGNALED(status);
  }
};

// DARBOUX_KILLS=100 makes it a hundred.
TEST_F(StudyCli, KilledAtRandomAndResumedTheNumbersAreTheSame) {
  const std::string expected = numbers("");
  const char* const wanted = std::getenv("DARBOUX_KILLS");
  const int kills = wanted ? std::atoi(wanted) : 20;
  std::mt19937_64 random(1);  // NOLINT: the same times every time
  int done = 0;
  for (int i = 0; done < kills && i < 20 * kills; ++i) {
    done += killed(std::chrono::microseconds(std::uniform_int_distribution<int>(500, 60000)(random)));
    if (i % 4 == 3) {
      EXPECT_EQ(numbers("--results r.jsonl"), expected) << "after " << done << " kills";
      fs::remove(path("r.jsonl"));
    }
  }
  EXPECT_EQ(done, kills);
  EXPECT_EQ(numbers("--results r.jsonl"), expected);
}

// Whatever byte the file ends at, the rest is done again, and what is written then can be read again.
TEST_F(StudyCli, ResumesResultsThatEndAnywhere) {
  const std::string expected = numbers("--results all.jsonl");
  const std::string all = read_bytes(path("all.jsonl"));
  for (std::size_t size = 0; size < all.size(); size += all.size() / 23) {
    write_bytes(path("r.jsonl"), all.substr(0, size));
    for (const char* time : {"first", "second"})
      EXPECT_EQ(numbers("--results r.jsonl"), expected) << size << ", " << time;
  }
}

TEST_F(StudyCli, ThreadsAndShardsGiveTheBitsOfOneProcess) {
  const std::string expected = numbers("");
  EXPECT_EQ(numbers("--threads 3"), expected);
  std::string files;
  for (int i = 1; i <= 7; ++i) {
    const std::string file = "s" + std::to_string(i) + ".jsonl";
    good("darboux converge --study study.json --shard " + std::to_string(i) + "/7 --results " + file);
    files = file + ' ' + files;  // in any order
  }
  good("darboux merge " + files + " -o merged.jsonl");
  EXPECT_EQ(numbers("--results merged.jsonl"), expected);
  // Nothing was left to do: no second header, no run.
  EXPECT_EQ(good("darboux merge merged.jsonl"), read_bytes(path("merged.jsonl")));
  const std::string shard = read_bytes(path("s1.jsonl"));
  refused("darboux merge s2.jsonl s1.jsonl -o ./s1.jsonl", {"./s1.jsonl", "another file"});
  EXPECT_EQ(read_bytes(path("s1.jsonl")), shard);
}

TEST_F(StudyCli, StabilityIsResumedAndMergedToTheBit) {
  write_bytes(path("sweeps.json"),
              R"({"command": "stability", "surfaces": ["cone", "bezier-patch"], "points": 5})");
  const std::string run = "darboux stability --study sweeps.json ";
  const auto curves = [&](const std::string& options) {
    return json(run + "--json " + options)["curves"].dump();
  };
  const std::string expected = curves("");
  EXPECT_GT(expected.size(), 10000u);
  EXPECT_EQ(curves("--threads 3"), expected);
  std::string files;
  for (int i = 1; i <= 3; ++i) {
    const std::string file = "s" + std::to_string(i) + ".jsonl";
    good(run + "--shard " + std::to_string(i) + "/3 --results " + file);
    files += file + ' ';
  }
  good("darboux merge " + files + " -o merged.jsonl");
  EXPECT_EQ(curves("--results merged.jsonl"), expected);
  const std::string all = read_bytes(path("merged.jsonl"));
  write_bytes(path("cut.jsonl"), all.substr(0, all.size() / 2));
  EXPECT_EQ(curves("--results cut.jsonl"), expected);
  refused("darboux converge --study study.json --results merged.jsonl",
          {"merged.jsonl", "results of converge"});
  for (const auto& [text, part] : {std::pair{R"("sweeps": ["poles"])", "/sweeps/0"},
                                   {R"("routes": ["single"])", "/routes/0"},
                                   {R"("points": 1)", "/points"},
                                   {R"("samples": 0)", "/samples"},
                                   {R"("meshes": ["jittered"])", "/meshes"}}) {
    write_bytes(path("wrong.json"), std::string(R"({"command": "stability", )") + text + "}");
    refused("darboux stability --study wrong.json", {"wrong.json", part});
  }
  write_bytes(path("wrong.json"), R"({"command": "converge"})");
  refused("darboux stability --study wrong.json", {"/command", "stability"});
}

// Within its bounds: status 0, and every format says so; an unknown name lists the known.
TEST_F(StudyCli, StabilityWritesWhatIsAskedFor) {
  const std::string run = "darboux stability sphere --points 4 --samples 1 --sweeps scale,turns ";
  EXPECT_NE(good(run).find("all within it"), std::string::npos);
  const Json document = json(run + "--json");
  EXPECT_TRUE(document["holds"].get<bool>());
  expect_keys(document["curves"][0], {"surface", "sweep", "route", "quantity", "x", "error_u", "condition",
                                      "bound_u", "within_bound", "worst"});
  const std::string csv = good(run + "--csv -");
  std::size_t rows = 0;
  for (const Json& curve : document["curves"]) rows += curve["x"].size();
  EXPECT_EQ(lines(csv).size(), rows + 1);
  EXPECT_EQ(written_in_all_formats(run, "| sphere |")["curves"], document["curves"]);
  refused("darboux stability --sweeps poles", {"poles", "pole_distance"});
  refused("darboux stability --routes single", {"single", "naive"});
  refused("darboux stability nope", {"nope", "torus"});
  refused("darboux stability --format svg", {"--format", "-o"});
  refused("darboux stability --preset slow", {"quick, standard or full"});
  refused(run + "--json --csv -", {"standard output"});
}

// The Markdown has what the CSV has of the tangents: errors and run times by resolution.
TEST_F(StudyCli, TheMarkdownOfConvergeHasErrorsAndTimes) {
  const Json document = json(
      "darboux converge --surfaces torus --methods face,area --meshes regular --resolutions 4,6,8 -o "
      "tables.md --csv "
      "all.csv "
      "--results r.jsonl --json");
  const std::string text = read_bytes(path("tables.md"));
  EXPECT_NE(text.find("\n| method, class | 4 | 6 | 8 |\n|---|---|---|---|\n"), std::string::npos) << text;
  EXPECT_NE(text.find("\n| method | 4 | 6 | 8 |\n|---|---|---|---|\n"), std::string::npos) << text;
  std::size_t studies = 0;
  for (const Json& study : document["studies"]) {
    if (study["quantity"] != "tangent") continue;
    ++studies;
    for (const bool errors : {true, false}) {
      std::string row = "\n| " + study["method"].get<std::string>();
      if (errors) row += ", " + study["class"].get<std::string>();
      row += " |";
      for (const Json& x : study[errors ? "rms_deg" : "seconds"]) {
        char number[40];
        std::snprintf(number, sizeof number, " %.3g |", x.get<double>());
        row += number;
      }
      EXPECT_NE(text.find(row + '\n'), std::string::npos) << row << " in " << text;
    }
  }
  EXPECT_EQ(studies, 4u);  // two methods, interior and seam
}

// What was asked for and does not exist is no success.
TEST_F(StudyCli, StabilitySaysWhichSweepsASurfaceDoesNotHave) {
  refused("darboux stability plane --sweeps pole_distance", {"--sweeps", "none of pole_distance for plane:"});
  refused("darboux stability sphere --sweeps pole_distance --routes face",
          {"--sweeps", "pole_distance", "sphere"});
  const std::string some =
      good("darboux stability plane sphere --points 2 --samples 1 --sweeps pole_distance");
  EXPECT_NE(some.find("\nleft out: plane"), std::string::npos) << some;
  EXPECT_NE(some.find(" has no pole_distance\n"), std::string::npos) << some;
  EXPECT_EQ(some.find("left out: sphere"), std::string::npos) << some;
  const std::string quick = " --points 2 --samples 1";
  EXPECT_NE(good("darboux stability sphere --sweeps scale,jitter --routes double" + quick)
                .find("\nleft out: none of the routes answers jitter\n"),
            std::string::npos);
  EXPECT_EQ(good("darboux stability plane" + quick).find("left out"), std::string::npos);
}

TEST_F(StudyCli, MergeRefusesWhatIsNotOneStudy) {
  const std::string run = "darboux converge --study study.json ";
  for (const char* shard : {"1/3", "2/3", "3/3"})
    good(run + "--shard " + shard + " --results s" + shard[0] + ".jsonl");
  refused("darboux merge s1.jsonl s3.jsonl", {"s1.jsonl", "all of 3 shards", "shard 2"});
  refused("darboux merge s1.jsonl s2.jsonl s3.jsonl s2.jsonl", {"every shard once", "2/3"});
  good(run + "--seed 8 --shard 3/3 --results foreign.jsonl");
  refused("darboux merge s1.jsonl s2.jsonl foreign.jsonl", {"foreign.jsonl", "expected a shard of converge"});
  good(run + "--shard 3/4 --results other.jsonl");
  refused("darboux merge s1.jsonl s2.jsonl other.jsonl", {"other.jsonl", "one of 3 shards", "3/4"});
  const std::string third = read_bytes(path("s3.jsonl"));
  write_bytes(path("cut.jsonl"), third.substr(0, third.size() - 9));
  refused("darboux merge s1.jsonl s2.jsonl cut.jsonl", {"cut.jsonl", "all jobs of shard 3/3", "resume"});
  // The second job of a shard that is followed by the 2^64th.
  Json header = Json::parse(lines(third)[0]);
  header["shard"] = "1/9223372036854775808";
  header["jobs"] = 18446744073709551615u;
  write_bytes(path("most.jsonl"), header.dump() + "\n{\"job\":0,\"key\":\"a\",\"result\":1}\n" +
                                      "{\"job\":9223372036854775808,\"key\":\"b\",\"result\":1}\n");
  refused("ulimit -t 10; darboux merge most.jsonl", {"most.jsonl", "none that is shard 2"});
  for (const char* jobs : {"-1", "1e300", "\"1\""}) {
    header["jobs"] = Json::parse(jobs);
    write_bytes(path("jobs.jsonl"), header.dump() + '\n');
    refused("darboux merge jobs.jsonl", {"jobs.jsonl", "line 1: expected jobs to be a whole number"});
  }
  refused("darboux merge nowhere.jsonl", {"nowhere.jsonl"});
  refused("darboux merge study.json", {"study.json"});
  EXPECT_FALSE(fs::exists(path("merged.jsonl")));
}

TEST_F(StudyCli, RefusesResultsOfAnotherStudyAndLeavesThem) {
  const std::string run = "darboux converge --study study.json --results r.jsonl ";
  good(run);
  const std::string before = read_bytes(path("r.jsonl"));
  refused(run + "--seed 8", {"r.jsonl", "expected results of converge"});
  refused(run + "--shard 1/2", {"r.jsonl", "shard 1/2", "shard 1/1"});
  EXPECT_EQ(read_bytes(path("r.jsonl")), before);
  const auto refused_after = [&](const std::string& from, const std::string& to, const std::string& part) {
    std::string text = before;
    text.replace(text.find(from), from.size(), to);
    write_bytes(path("r.jsonl"), text);
    refused(run, {"r.jsonl", part});
    EXPECT_EQ(read_bytes(path("r.jsonl")), text);
  };
  refused_after(R"("version":")", R"("version":"9)", "results of darboux 0.");
  refused_after(R"("darboux_results":1)", R"("darboux_results":2)", "results of format 1");
  refused_after(R"({"job":)", R"({"jab":)", "line 3");
  refused_after(R"({"job":)", R"({"job:)", "line 3");
  refused_after(R"("job":0)", R"("job":1)", "every job once");
  for (const char* text : {"hello", "hello\n"}) {
    write_bytes(path("r.jsonl"), text);
    refused(run, {"r.jsonl", "line 1"});
    EXPECT_EQ(read_bytes(path("r.jsonl")), text);
  }
  refused("darboux converge --study study.json --results /dev/full", {"/dev/full", "No space left"});
}

// No output may replace another, nor what is read.
TEST_F(StudyCli, RefusesTwoThingsInOneFile) {
  const std::string study = read_bytes(path("study.json"));
  for (const std::string options :
       {"--results r.jsonl -o r.jsonl", "--results r.jsonl --csv ./r.jsonl", "-o study.json",
        "--csv study.json", "-o p.svg --picture ./p.svg", "--results study.json"}) {
    SCOPED_TRACE(options);
    const Result r = sh("darboux converge --study study.json " + options);
    EXPECT_EQ(r.status, 2);
    expect_one_line(r.err);
    EXPECT_NE(r.err.find("expected another file than that of -"), std::string::npos) << r.err;
    EXPECT_EQ(read_bytes(path("study.json")), study);
    EXPECT_FALSE(fs::exists(path("r.jsonl")) || fs::exists(path("p.svg")));
  }
}

TEST_F(StudyCli, NamesThePathOfWhatIsWrongInAStudy) {
  const std::vector<std::pair<const char*, std::vector<std::string>>> wrong{
      {R"({"command": "converge", "meshs": []})",
       {"/meshs", "one of the keys", "resolutions", "an unknown one"}},
      {R"({"command": "validate"})", {"/command", "converge"}},
      {R"({"surfaces": ["torus"]})", {"an object with command", "one without"}},
      {R"({"command": "converge", "methods": ["face", "nope"]})", {"/methods/1", "nope", "average"}},
      {R"({"command": "converge", "surfaces": ["nope"]})", {"/surfaces/0", "nope", "torus"}},
      {R"({"command": "converge", "meshes": ["nope"]})", {"/meshes/0", "nope", "jittered"}},
      {R"({"command": "converge", "meshes": []})", {"/meshes"}},
      {R"({"command": "converge", "resolutions": [8, 8, 16]})", {"/resolutions/1", "grow", "got 8"}},
      {R"({"command": "converge", "resolutions": [8, 16]})", {"/resolutions", "at least three"}},
      {R"({"command": "converge", "resolutions": [8, 16, 2.5e9]})", {"/resolutions/2"}},
      {R"({"command": "converge", "v_range": [0.5, 0.5]})", {"/v_range"}},
      {R"({"command": "converge", "seed": -1})", {"/seed"}},
      {R"({"command": "converge", "preset": "slow"})", {"/preset: expected quick, standard or full"}},
      {R"([])", {"an object, got array"}},
      {R"({"command": "converge")", {"JSON"}}};
  for (const auto& [text, parts] : wrong) {
    write_bytes(path("wrong.json"), text);
    std::vector<std::string> all = parts;
    all.emplace_back("wrong.json");
    refused("darboux converge --study wrong.json", all);
  }
  for (const char* shard : {"0/3", "4/3", "1", "1/0", "a/b", "1/3x"})
    refused("darboux converge --study study.json --results r.jsonl --shard " + std::string(shard),
            {"--shard", "1 <= I <= N"});
  refused("darboux converge --study study.json --shard 1/2", {"--results"});
  EXPECT_FALSE(fs::exists(path("r.jsonl")));
}

}  // namespace
}  // namespace darboux::test::study_test
