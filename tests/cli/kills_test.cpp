// The tool interrupted at any time: every output is whole or as it was, and nothing else is left behind.
#include <chrono>
#include <csignal>
#include <cstdio>
#include <map>
#include <random>
#include <regex>
#include <set>
#include <thread>

#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include "cli.h"
#include "sanitized.h"

namespace darboux::test::kills_test {
namespace {

// A command, and what it writes.
struct Writing {
  std::vector<std::string> arguments;
  std::vector<std::string> outputs;
};

const std::vector<Writing> writings{
    {{"eval", "torus", "--grid", "200x200", "--format", "csv", "-o", "o.csv"}, {"o.csv"}},
    {{"mesh", "torus", "--grid", "300x200", "-o", "o.glb"}, {"o.glb"}},
    {{"tangents", "in.glb", "-o", "o.glb"}, {"o.glb"}},
    {{"validate", "in.glb", "data", "--sarif", "o.sarif", "--junit", "o.xml"}, {"o.sarif", "o.xml"}},
    {{"validate", "in.glb", "--paint", "o.glb", "--report", "o.html"}, {"o.glb", "o.html"}},
    {{"fit", "data/torus_points.xyz", "--frames", "o.csv"}, {"o.csv"}},
    {{"plan", "in.glb", "data/torus_016.three.glb", "--sarif", "o.sarif"}, {"o.sarif"}},
    {{"scene", "scene.json", "-o", "o.glb", "--render", "o.png", "--render-skipped", "s.png"},
     {"o.glb", "o.png", "s.png"}},
    {{"converge", "--surfaces", "torus", "--methods", "face", "--resolutions", "8,12,16", "-o", "o.html",
      "--csv", "o.csv", "--picture", "o.svg"},
     {"o.html", "o.csv", "o.svg"}},
    {{"bake", "--surface", "torus", "--mesh", "low.glb", "--size", "200x100", "-o", "o.png", "--report",
      "r.png"},
     {"o.png", "r.png"}},
    {{"normalmap", "in.png", "--from", "tangent", "--to", "object", "--mesh", "low.glb", "-o", "o.png",
      "--report", "r.png"},
     {"o.png", "r.png"}},
    {{"merge", "results.jsonl", "-o", "o.jsonl"}, {"o.jsonl"}},
    {{"surfaces", "--pages", "."}, {}},  // a page and a picture of each surface
};

// The last has files without a name, and gives them none.
enum class FileSystem { with_tmpfile, without_tmpfile, without_names };

class Kills : public Cli {
 protected:
  Kills() {
    ::prctl(PR_SET_CHILD_SUBREAPER, 1);  // processes that outlive their parent become this one's
    fs::copy_file(DARBOUX_SOURCE "/docs/examples/scene.json", path("scene.json"));
    good("darboux mesh sphere --grid 128x64 -o in.glb --quiet");
    good("darboux mesh torus --grid 12x6 -o low.glb --quiet");
    good("darboux bake --surface torus --mesh low.glb --size 200x100 -o in.png --quiet");
    good("darboux converge --surfaces torus --methods face --resolutions 8,12,16 --results results.jsonl");
    given_ = names();
    for (const Writing& w : writings) {
      const auto start = std::chrono::steady_clock::now();
      run(w, FileSystem::with_tmpfile, 0, {});
      times_.push_back(
          std::chrono::duration_cast<std::chrono::microseconds>(std::chrono::steady_clock::now() - start));
      contents_.emplace_back();
      for (const std::string& name : outputs()) contents_.back()[name] = read_bytes(path(name));
      for (const std::string& name : w.outputs) EXPECT_TRUE(contents_.back().contains(name)) << name;
      EXPECT_FALSE(contents_.back().empty()) << w.arguments[0];
      remove_outputs();
    }
  }

  std::set<std::string> names() const {
    std::set<std::string> result;
    for (const auto& entry : fs::directory_iterator(path("")))
      result.insert(entry.path().filename().string());
    return result;
  }
  std::set<std::string> outputs() const {
    std::set<std::string> result = names();
    for (const std::string& name : given_) EXPECT_EQ(result.erase(name), 1u) << name;
    return result;
  }
  void remove_outputs() const {
    for (const std::string& name : outputs()) fs::remove(path(name));
  }

  pid_t start(const Writing& w, FileSystem system) const {
    const pid_t child = ::fork();
    if (child == 0) {
      if (::chdir(path("").c_str()) != 0 || !std::freopen("/dev/null", "w", stdout) ||
          !std::freopen("/dev/null", "w", stderr))
        std::_Exit(99);
      if (system != FileSystem::with_tmpfile) ::setenv("LD_PRELOAD", DARBOUX_WITHOUT_TMPFILE, 1);
      if (system == FileSystem::without_names) ::setenv("DARBOUX_NO_NAMES", "1", 1);
      std::vector<char*> arguments{const_cast<char*>("darboux")};
      for (const std::string& text : w.arguments) arguments.push_back(const_cast<char*>(text.c_str()));
      arguments.push_back(nullptr);
      ::execv(DARBOUX_TOOL, arguments.data());
      std::_Exit(99);
    }
    return child;
  }

  // Runs the command, and sends it a signal after so long unless that is 0. \returns its status
  int run(const Writing& w, FileSystem system, int signal, std::chrono::microseconds after) const {
    const pid_t child = start(w, system);
    if (signal != 0) {
      std::this_thread::sleep_for(after);
      ::kill(child, signal);
    }
    int status = 0;
    ::waitpid(child, &status, 0);
    EXPECT_FALSE(WIFEXITED(status) && WEXITSTATUS(status) > 1) << w.arguments[0];
    return status;
  }

  std::set<std::string> given_;
  std::vector<std::chrono::microseconds> times_;
  std::vector<std::map<std::string, std::string>> contents_;
};

// Waits for processes that the tool started to end. \returns whether they do, within a minute
bool all_end() {
  for (int i = 0; i < 6000; ++i) {
    pid_t ended = 0;
    do ended = ::waitpid(-1, nullptr, WNOHANG);
    while (ended > 0);
    if (ended < 0) return true;
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  return false;
}

// Without what differs from run to run: the time of day in a page of converge, and how long methods take, a
// list in its data and a column of its table. All else is compared.
std::string lasting(const std::string& name, const std::string& bytes) {
  static const std::regex times(R"("seconds":[\[\]0-9.e,+-]*|\d{4}-\d\d-\d\d \d\d:\d\d UTC)");
  if (name.ends_with(".html")) return std::regex_replace(bytes, times, "");
  constexpr std::size_t seconds = 10;  // from the end: its first column has commas
  if (!name.ends_with(".csv") || bytes.find(",seconds,") == std::string::npos) return bytes;
  std::string result;
  std::istringstream lines(bytes);
  for (std::string line; std::getline(lines, line);) {
    std::vector<std::string> words;
    std::istringstream fields(line);
    for (std::string word; std::getline(fields, word, ',');) words.push_back(word);
    if (words.size() > seconds) words.erase(words.end() - seconds);
    for (const std::string& word : words) result += word + ',';
    result += lines.eof() ? "" : "\n";
  }
  return result;
}

// DARBOUX_KILLS=500 makes it five hundred.
TEST_F(Kills, NoOutputIsBrokenAndNothingIsLeft) {
  const int systems = sanitized ? 1 : 2;  // under a sanitizer no other library is loaded first
  const std::vector<int> signals{SIGINT, SIGTERM, SIGKILL};
  const int kinds = static_cast<int>(writings.size());
  const char* const wanted = std::getenv("DARBOUX_KILLS");
  const int kills = wanted ? std::atoi(wanted) : 6 * kinds;
  std::mt19937_64 random(1);  // NOLINT: the same times every time
  int done = 0, between_names = 0, i = 0;
  for (; done < kills && i < 20 * kills; ++i) {
    const std::size_t k = static_cast<std::size_t>(i % kinds);
    const auto system = static_cast<FileSystem>(i / kinds % systems);
    const int signal = signals[static_cast<std::size_t>(i / (2 * kinds) % 3)];
    const bool replaced = i / (6 * kinds) % 2 == 0;
    SCOPED_TRACE(writings[k].arguments[0] + ", signal " + std::to_string(signal) +
                 (system == FileSystem::with_tmpfile ? "" : ", without O_TMPFILE") +
                 (replaced ? ", replaced" : ""));
    if (replaced)
      for (const auto& [name, content] : contents_[k]) write_bytes(path(name), "old " + name);
    const auto time = std::uniform_int_distribution<std::int64_t>(0, times_[k].count())(random);
    const int status = run(writings[k], system, signal, std::chrono::microseconds(time));
    if (WIFSIGNALED(status)) {
      EXPECT_EQ(WTERMSIG(status), signal);
      ++done;
    }
    for (const std::string& name : outputs()) {
      if (!contents_[k].contains(name)) {
        // Nobody can tidy up after SIGKILL: while a file has two names, or where all files have one.
        EXPECT_TRUE(signal == SIGKILL && name.starts_with(".darboux-")) << name;
        between_names += system == FileSystem::with_tmpfile;
        continue;
      }
      const std::string now = read_bytes(path(name));
      EXPECT_TRUE((replaced && now == "old " + name) ||
                  lasting(name, now) == lasting(name, contents_[k][name]))
          << name << " of " << now.size() << " bytes";
    }
    for (const auto& [name, content] : contents_[k])
      EXPECT_TRUE(!replaced || fs::exists(path(name))) << name << " is lost";
    EXPECT_TRUE(all_end()) << "a process is left";
    remove_outputs();
    if (HasFailure()) break;
  }
  std::printf("%d of %d runs killed, %d names left where files need none\n", done, i, between_names);
  EXPECT_EQ(done, kills);
  // A file that is replaced has two names for some 50 of the 100 000 microseconds of a run.
  EXPECT_LE(between_names, 1 + kills / 500);
}

// Where all files have names, every signal that ends a process and can be caught finds the unfinished one.
TEST_F(Kills, OnlySigkillLeavesAFileThatHasAName) {
  DARBOUX_SKIP_IF_SANITIZED("no other library is loaded first");
  const std::set<int> others{SIGKILL, SIGCHLD, SIGCONT, SIGSTOP,  SIGTSTP,
                             SIGTTIN, SIGTTOU, SIGURG,  SIGWINCH, SIGXFSZ};
  const Writing w{{"mesh", "torus", "--grid", "300x300", "-o", "o.glb"}, {"o.glb"}};
  run(w, FileSystem::without_tmpfile, 0, {});
  const std::string whole = read_bytes(path("o.glb"));
  remove_outputs();
  int caught = 0;
  for (int signal = 1; signal <= SIGRTMAX; ++signal) {
    if (others.contains(signal) || (signal > SIGSYS && signal != SIGRTMIN && signal != SIGRTMAX)) continue;
    SCOPED_TRACE(signal);
    const pid_t child = start(w, FileSystem::without_tmpfile);
    int status = 0;
    bool ended = false;
    while (outputs().empty() && !ended) ended = ::waitpid(child, &status, WNOHANG) == child;
    ::kill(child, signal);
    if (!ended) ::waitpid(child, &status, 0);
    if (WIFSIGNALED(status)) {
      EXPECT_EQ(WTERMSIG(status), signal);
      // Where this test had to wait for a core, the tool has already finished the file, and was about to end.
      const bool finished = outputs() == std::set<std::string>{"o.glb"} && read_bytes(path("o.glb")) == whole;
      EXPECT_TRUE(finished || outputs().empty()) << testing::PrintToString(outputs());
      caught += !finished;
    }
    remove_outputs();
  }
  EXPECT_GE(caught, 20);
}

// A file system that gives no name to a file without one costs a copy, and no output.
TEST_F(Kills, AFileThatGetsNoNameIsCopied) {
  DARBOUX_SKIP_IF_SANITIZED("no other library is loaded first");
  for (const bool replaced : {false, true})
    for (const std::size_t k : {0u, 1u, 4u}) {
      if (replaced)
        for (const auto& [name, content] : contents_[k]) {
          write_bytes(path(name), "old");
          fs::permissions(path(name), fs::perms::owner_read | fs::perms::owner_write);
        }
      const int status = run(writings[k], FileSystem::without_names, 0, {});
      EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) < 2);
      for (const std::string& name : outputs()) {
        EXPECT_EQ(read_bytes(path(name)), contents_[k].at(name)) << name;
        EXPECT_EQ((fs::status(path(name)).permissions() & fs::perms::group_read) == fs::perms::none,
                  replaced);
      }
      EXPECT_EQ(outputs().size(), contents_[k].size());
      remove_outputs();
    }
}

// Files that are read in a process of their own: it ends with the tool.
TEST_F(Kills, NoProcessOutlivesTheTool) {
  std::string obj;
  constexpr int n = 150;
  for (int i = 0; i <= n; ++i)
    for (int j = 0; j <= n; ++j) obj += "v " + std::to_string(i) + ' ' + std::to_string(j) + " 0\n";
  for (int i = 0; i < n; ++i)
    for (int j = 1; j <= n; ++j) {
      const int a = i * (n + 1) + j;
      for (const int k : {a, a + 1, a + n + 1}) obj += (k == a ? "f " : " ") + std::to_string(k);
      obj += '\n';
    }
  write_bytes(path("grid.obj"), obj);
  const Writing reading{{"validate", "grid.obj"}, {}};
  for (int i = 1; i <= 30; ++i) {
    run(reading, FileSystem::with_tmpfile, i % 2 == 0 ? SIGTERM : SIGKILL,
        std::chrono::milliseconds(10 + 5 * i));
    ASSERT_TRUE(all_end());
  }
}

// A command that the shell started in the background ignores SIGINT, under nohup SIGHUP, and goes on to.
TEST_F(Kills, IgnoredSignalsStayIgnored) {
  const auto before = std::signal(SIGINT, SIG_IGN);
  for (int i = 1; i <= 5; ++i) {
    const int status = run(writings[1], FileSystem::with_tmpfile, SIGINT, times_[1] * i / 6);
    EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 0);
    EXPECT_EQ(outputs(), std::set<std::string>{"o.glb"});
    remove_outputs();
  }
  std::signal(SIGINT, before);
}

// A reader that goes away ends the tool as any other; what it writes beside that is removed.
TEST_F(Kills, ABrokenPipeLeavesNothing) {
  for (const std::string preload : {"", "LD_PRELOAD=" DARBOUX_WITHOUT_TMPFILE " "}) {
    if (!preload.empty()) DARBOUX_SKIP_IF_SANITIZED("no other library is loaded first");
    const Result r =
        sh("{ " + preload + "darboux validate data --details --json --sarif o.sarif; echo $? >&2; } | true");
    EXPECT_EQ(r.err.find("141"), 0u) << r.err;
    EXPECT_EQ(outputs(), std::set<std::string>{});
  }
}

// Not a death, but an error: the file gets larger than the limit.
TEST_F(Kills, AFileThatGetsTooLargeIsAnError) {
  const Result r = sh("ulimit -f 100; darboux mesh torus --grid 300x200 -o o.glb");
  EXPECT_EQ(r.status, 2);
  expect_one_line(r.err);
  EXPECT_NE(r.err.find("o.glb"), std::string::npos) << r.err;
  EXPECT_EQ(outputs(), std::set<std::string>{});
}

}  // namespace
}  // namespace darboux::test::kills_test
