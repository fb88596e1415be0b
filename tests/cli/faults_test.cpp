// Every call that can fail fails once, in turn, over each command on small inputs: an error of one line and
// exit 2, or the whole output where the tool can do without; never a part of it, and nothing else is left.
#include <algorithm>
#include <cstdio>
#include <map>
#include <set>
#include <sstream>

#include <fcntl.h>
#include <sched.h>
#include <sys/personality.h>
#include <sys/wait.h>
#include <unistd.h>

#include "cli.h"
#include "sanitized.h"

namespace darboux::test::faults_test {
namespace {

struct Command {
  std::vector<std::string> arguments;
  std::vector<std::string> outputs;
  bool measures = false;  // times, and ways that fail: exit 1
};

const std::vector<Command> commands{
    {{"eval", "torus", "--grid", "8x8", "--format", "csv", "-o", "o.csv"}, {"o.csv"}},
    {{"mesh", "torus", "--grid", "8x8", "-o", "o.glb"}, {"o.glb"}},
    {{"tangents", "in.glb", "-o", "o.glb"}, {"o.glb"}},
    {{"validate", "in.glb", "--sarif", "o.sarif", "--junit", "o.xml"}, {"o.sarif", "o.xml"}},
    {{"validate", "in.glb", "--paint", "o.glb", "--report", "o.html"}, {"o.glb", "o.html"}},
    {{"validate", "in.obj"}, {}},
    {{"compare", "in.glb", "in.glb"}, {}},
    {{"plan", "in.glb", "--sarif", "o.sarif"}, {"o.sarif"}},
    {{"scene", "scene.json", "-o", "o.glb", "--render", "o.png"}, {"o.glb", "o.png"}},
    {{"fit", "points.xyz", "--frames", "o.csv"}, {"o.csv"}},
    {{"merge", "results.jsonl", "-o", "o.jsonl"}, {"o.jsonl"}},
    {{"bake", "--surface", "sphere", "--mesh", "in.glb", "--size", "16x8", "-o", "o.png"}, {"o.png"}},
    {{"bake", "--surface", "sphere", "--mesh", "in.glb", "--size", "8x8", "-o", "o.exr"}, {"o.exr"}},
    {{"normalmap", "map.png", "--from", "tangent", "--to", "object", "--mesh", "in.glb", "-o", "o.png",
      "--report", "r.png"},
     {"o.png", "r.png"}},
    {{"normalmap", "map.exr", "--from", "tangent", "--to", "object", "--mesh", "in.glb", "-o", "o.tga"},
     {"o.tga"}},
    {{"normalmap", "map.tga", "--from", "tangent", "--mesh", "in.glb", "--size", "20x20", "--render",
      "o.png"},
     {"o.png"}},
    {{"normalmap", "--compare", "map.png", "map.tga", "--report", "o.png"}, {"o.png"}},
};

// Without reports, which hold the time of day.
const std::vector<Command> studies{
    {{"surfaces"}, {}},
    {{"check", "plane", "--points", "5"}, {}},
    {{"stability", "plane", "--sweeps", "scale", "--routes", "double"}, {}},
    {{"converge", "--surfaces", "plane", "--methods", "face", "--meshes", "regular", "--resolutions",
      "6,8,10"},
     {}},
    {{"work-precision", "plane", "--methods", "naive", "--rounds", "3", "--points", "16", "--checked", "4"},
     {},
     true},
};

// Why a process ended.
struct End {
  bool by_signal = false;
  int status = 0;
  std::string out, err;
};

// DARBOUX_FAULTS_LEAKS=1: memory that is not given back ends the tool with a status of its own. It takes the
// leak sanitizer, which looks at the process as a debugger does.
bool finds_leaks() {
  return std::getenv("DARBOUX_FAULTS_LEAKS") != nullptr;
}
constexpr int status_of_leaks = 77;
// Constructors of nlohmann::json and OpenEXR that throw leave what they have made: what has them on the stack
// does not count. It takes whole stacks, which are slow.
constexpr const char* but_of_libraries =
    ":fast_unwind_on_malloc=0:print_suppressions=0:suppressions=suppressions";

class Faults : public Cli {
 protected:
  void SetUp() override {
    Cli::SetUp();
    DARBOUX_SKIP_IF_SANITIZED("the allocator is not that of the library that faults");
    fs::copy_file(DARBOUX_SOURCE "/docs/examples/scene.json", path("scene.json"));
    good("darboux mesh sphere --grid 8x6 -o in.glb --quiet");
    for (const std::string name : {"map.png", "map.exr", "map.tga"})
      good("darboux bake --surface sphere --mesh in.glb --size 16x8 --quiet -o " + name);
    good("darboux eval sphere --grid 6x6 --attributes position --format csv -o points.csv");
    write_bytes(path("in.obj"),
                "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\nvn 0 0 1\nf 1/1/1 2/2/1 3/3/1\n");
    std::string points;
    for (int i = 0; i < 40; ++i) {
      const double a = 0.7 * i, z = (i % 9 - 4) / 5.0, r = std::sqrt(1 - z * z);
      points += std::to_string(r * std::cos(a)) + ' ' + std::to_string(r * std::sin(a)) + ' ' +
                std::to_string(z) + '\n';
    }
    write_bytes(path("points.xyz"), points);
    good(
        "darboux converge --surfaces torus --methods face --meshes regular --resolutions 6,8,10 --results "
        "results.jsonl");
    fs::remove(path("points.csv"));
    write_bytes(path("suppressions"), "leak:nlohmann::\nleak:Imf_\n");
    given_ = names();
  }

  // Those of namespace darboux, for the kind "own".
  void list_own_functions() {
    std::istringstream lines(
        sh("nm --defined-only --numeric-sort --print-size " DARBOUX_TOOL
           " | sed -nE 's/^([0-9a-f]+) ([0-9a-f]+) [tTwWuU] (_Z+NK?7darboux.*|main)$/\\1 \\2/p'")
            .out);
    std::vector<std::uint64_t> functions;
    for (std::uint64_t begin = 0, size = 0; lines >> std::hex >> begin >> size;) {
      if (!functions.empty() && begin == functions[functions.size() - 2]) continue;  // another name
      functions.insert(functions.end(), {begin, begin + size});
    }
    ASSERT_GT(functions.size(), 2000u) << DARBOUX_TOOL " has no symbols";
    write_bytes(path("own"), {reinterpret_cast<const char*>(functions.data()), functions.size() * 8});
    given_.insert("own");
  }

  std::set<std::string> names() const {
    std::set<std::string> result;
    for (const auto& entry : fs::directory_iterator(path("")))
      result.insert(entry.path().filename().string());
    return result;
  }
  std::map<std::string, std::string> outputs() const {
    std::map<std::string, std::string> result;
    for (const std::string& name : names())
      if (!given_.contains(name) && name != "large.glb" && name != "count" && name != "out" &&
          name != "err" && name != "stack")
        result[name] = read_bytes(path(name));
    return result;
  }
  void remove_outputs() const {
    for (const auto& [name, content] : outputs()) fs::remove(path(name));
  }

  // Runs the command with the fault, on one processor and without address randomisation: stacks are the same
  // every time.
  End run(const Command& command, const std::string& fault, const std::string& leaks = "") const {
    std::fflush(stdout);  // or the child prints it too
    const pid_t child = ::fork();
    if (child == 0) {
      cpu_set_t permitted, one;
      ::sched_getaffinity(0, sizeof permitted, &permitted);
      int first = 0;
      while (first < CPU_SETSIZE - 1 && !CPU_ISSET(first, &permitted)) ++first;
      CPU_ZERO(&one);
      CPU_SET(first, &one);
      ::sched_setaffinity(0, sizeof one, &one);
      ::personality(ADDR_NO_RANDOMIZE);
      if (::chdir(path("").c_str()) != 0 || !std::freopen("out", "w", stdout) ||
          !std::freopen("err", "w", stderr))
        std::_Exit(99);
      std::string libraries = DARBOUX_FAULTS_LIBRARY;
      if (finds_leaks()) libraries += ":" DARBOUX_LEAK_SANITIZER;
      ::setenv("LD_PRELOAD", libraries.c_str(), 1);
      ::setenv("LSAN_OPTIONS",
               ("handle_segv=0:handle_abort=0:exitcode=" + std::to_string(status_of_leaks) + leaks).c_str(),
               1);
      ::setenv("DARBOUX_FAULT", fault.c_str(), 1);
      ::setenv("DARBOUX_FAULT_COUNT", path("count").c_str(), 1);
      ::setenv("DARBOUX_FAULT_OWN", path("own").c_str(), 1);
      ::setenv("DARBOUX_FAULT_STACK", path("stack").c_str(), 1);
      std::vector<char*> arguments{const_cast<char*>("darboux")};
      for (const std::string& text : command.arguments) arguments.push_back(const_cast<char*>(text.c_str()));
      arguments.push_back(nullptr);
      ::execv(DARBOUX_TOOL, arguments.data());
      std::_Exit(99);
    }
    int status = 0;
    ::waitpid(child, &status, 0);
    return {WIFSIGNALED(status), WIFSIGNALED(status) ? WTERMSIG(status) : WEXITSTATUS(status),
            read_bytes(path("out")), read_bytes(path("err"))};
  }

  // The innermost functions that the tool was in when it crashed.
  std::string crash_stack() const {
    return sh("addr2line -f -C -e " DARBOUX_TOOL " $(cat stack) | head -4").out;
  }
  // Two end the program. The destructor of nlohmann::json allocates and must not throw, and its operator[] of
  // null leaves an object behind that cannot be destroyed. The timers of Ceres allocate in their destructors.
  bool crashed_in_a_library() const {
    const std::string functions = crash_stack();
    return functions.find("nlohmann::") != std::string::npos ||
           functions.find("ceres::") != std::string::npos;
  }

  // An output is what it should be; reports of files that could not be read say so, in whole.
  static void expect_whole(const std::string& name, const std::string& content, const std::string& wanted,
                           bool after_error) {
    if (content == wanted) return;
    const std::string extension = fs::path(name).extension();
    EXPECT_TRUE(after_error && (extension == ".sarif" || extension == ".xml" || extension == ".html"))
        << name << " of " << content.size() << " bytes in place of " << wanted.size();
    if (extension == ".sarif") {
      EXPECT_FALSE(Json::parse(content, nullptr, false).is_discarded()) << name;
    } else {
      const std::string end = wanted.substr(wanted.rfind("</"));
      EXPECT_TRUE(content.ends_with(end))
          << name << " ends with "
          << content.substr(content.size() - std::min<std::size_t>(content.size(), 20));
    }
  }

  static std::string without_seconds(std::string text) {
    if (const std::size_t at = text.find("\nseconds: "); at != std::string::npos)
      text.erase(at, text.find('\n', at + 1) - at);
    return text;
  }
  // What is printed is the same, but for times.
  static void expect_result(const Command& command, const End& end, const End& clean) {
    if (!command.measures) {
      EXPECT_EQ(end.status, clean.status) << end.err;
      EXPECT_EQ(without_seconds(end.out), without_seconds(clean.out));
    } else if (end.status != clean.status) {
      EXPECT_EQ(end.status, 1) << end.err;
      EXPECT_NE(end.out.find("1 failed"), std::string::npos) << end.out;
    }
  }

  void put_old_outputs(const Command& command) const {
    for (const std::string& name : command.outputs) write_bytes(path(name), "old");
  }

  // \param most points of each command that fail, spread evenly \param over_old outputs are there before
  void each_fails(const std::string& kind, std::size_t most, bool over_old = false,
                  const std::vector<Command>& run_commands = commands) const {
    if (finds_leaks()) {
      ASSERT_EQ(run(run_commands.front(), "leak:0").status, status_of_leaks) << DARBOUX_LEAK_SANITIZER;
      remove_outputs();
    }
    std::size_t points = 0, failed = 0, errors = 0, crashes = 0, of_libraries = 0;
    for (const Command& command : run_commands) {
      if (over_old) put_old_outputs(command);
      const End clean = run(command, kind + ":0");
      ASSERT_FALSE(clean.by_signal);
      ASSERT_LT(clean.status, 2) << command.arguments[0] << ": " << clean.err;
      const std::size_t there = std::stoul(read_bytes(path("count")));
      if (kind == "own") {
        ASSERT_GT(there, 100u) << "the list of functions is not that of the tool";
      }
      const auto whole = outputs();
      ASSERT_EQ(whole.size(), command.outputs.size());
      remove_outputs();
      const std::size_t step = std::max<std::size_t>(1, (there + most - 1) / most);
      points += there;
      for (std::size_t k = 1 + step / 2; k <= there; k += step) {
        SCOPED_TRACE(command.arguments[0] + " " + (command.arguments.size() > 1 ? command.arguments[1] : "") +
                     ", " + kind + " " + std::to_string(k) + " of " + std::to_string(there));
        if (over_old) put_old_outputs(command);
        const std::string fault = kind + ":" + std::to_string(k);
        End end = run(command, fault);
        ++failed;
        if (!end.by_signal && end.status == status_of_leaks) {
          remove_outputs();
          if (over_old) put_old_outputs(command);
          end = run(command, fault, but_of_libraries);
          ++of_libraries;
        }
        if (end.by_signal) {
          EXPECT_TRUE(crashed_in_a_library()) << "signal " << end.status << ' ' << end.err << crash_stack();
          // It was written before, or is not there.
          for (const auto& [name, content] : outputs())
            EXPECT_TRUE(whole.contains(name) && content == whole.at(name)) << name;
          remove_outputs();
          ++crashes;
          continue;
        }
        if (end.status == 2) {
          ++errors;
          // A library that is linked in may speak before.
          const std::size_t last = end.err.rfind('\n', end.err.size() - 2);
          expect_one_line(last == std::string::npos ? end.err : end.err.substr(last + 1));
        } else {
          expect_result(command, end, clean);
        }
        for (const auto& [name, content] : outputs()) {
          if (over_old && end.status == 2 && content == "old") continue;
          EXPECT_TRUE(whole.contains(name)) << name << " is left";
          if (whole.contains(name)) expect_whole(name, content, whole.at(name), end.status == 2);
        }
        if (over_old && end.status == 2) {
          for (const std::string& name : command.outputs)
            EXPECT_TRUE(fs::exists(path(name))) << "the old " << name << " is lost";
        }
        if (end.status < 2) {
          EXPECT_EQ(outputs().size(), whole.size()) << "an output is lost";
        }
        remove_outputs();
      }
    }
    std::printf(
        "%s: %zu points, %zu failed once, %zu errors of one line, %zu ends in nlohmann::json or Ceres, %zu "
        "with memory lost in nlohmann::json or OpenEXR%s\n",
        kind.c_str(), points, failed, errors, crashes, of_libraries,
        finds_leaks() ? "" : " (not looked for)");
    EXPECT_GT(points, 0u);
  }

 private:
  std::set<std::string> given_;
};

// DARBOUX_FAULTS=1000000: every one.
std::size_t wanted() {
  const char* const text = std::getenv("DARBOUX_FAULTS");
  return text ? static_cast<std::size_t>(std::atoi(text)) : 3;
}

TEST_F(Faults, Allocations) {
  each_fails("new", wanted());
}
// From each distinct stack of functions of this repository, whatever libraries are between.
TEST_F(Faults, AllocationsOfOwnCode) {
  list_own_functions();
  each_fails("own", wanted());
}
TEST_F(Faults, AllocationsOfOwnCodeInStudies) {
  list_own_functions();
  each_fails("own", wanted(), false, studies);
}
TEST_F(Faults, AllocationsOfC) {
  each_fails("malloc", wanted());
}
TEST_F(Faults, Writes) {
  each_fails("write", wanted());
}
TEST_F(Faults, Reads) {
  each_fails("read", wanted());
}
TEST_F(Faults, Opens) {
  each_fails("open", wanted());
}
TEST_F(Faults, Links) {
  each_fails("linkat", wanted());
}
TEST_F(Faults, Renames) {
  each_fails("rename", wanted(), true);  // which only replaced outputs need
}
// Large meshes are mapped.
TEST_F(Faults, Maps) {
  good("darboux mesh torus --grid 400x200 -o large.glb --quiet");
  each_fails("mmap", wanted(), false, {{{"tangents", "large.glb", "-o", "o.glb"}, {"o.glb"}}});
}
TEST_F(Faults, Syncs) {
  each_fails("fsync", wanted());
}
TEST_F(Faults, Processes) {
  for (const char* kind : {"fork", "pipe2"}) each_fails(kind, wanted());
}

}  // namespace
}  // namespace darboux::test::faults_test
