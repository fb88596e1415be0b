// What the tool writes: whole documents, whatever its standard streams lead to.
#include <pugixml.hpp>

#include "cli.h"

namespace darboux::test::outputs_test {
namespace {

// ---- closed standard streams
// --------------------------------------------------------------------------------

// A file that is opened while a standard stream is closed gets its number: nothing but the document may go
// there.
TEST_F(Cli, ClosedStandardStreamsPutNothingIntoOutputs) {
  const std::string eval = "darboux eval torus --grid 64x64 --format csv -o f.csv ";
  const std::vector<std::string> outputs{"f.sarif", "f.xml", "f.csv"};
  const auto run_all = [&](const std::string& streams) {
    for (const std::string& name : outputs) fs::remove(path(name));
    sh(eval + streams);
    return sh("darboux validate data/torus_016.three.glb missing.glb --sarif f.sarif --junit f.xml " +
              streams);
  };
  run_all("");
  std::vector<std::string> expected;
  for (const std::string& name : outputs) expected.push_back(read_bytes(path(name)));
  ASSERT_TRUE(Json::accept(expected[0]));
  ASSERT_TRUE(pugi::xml_document().load_string(expected[1].c_str()));
  for (const std::string streams :
       {"<&-", ">&-", "2>&-", "<&- >&-", "<&- 2>&-", ">&- 2>&-", "<&- >&- 2>&-"}) {
    SCOPED_TRACE(streams);
    EXPECT_EQ(run_all(streams).status, 2);  // one file is missing
    for (std::size_t i = 0; i < outputs.size(); ++i)
      EXPECT_TRUE(read_bytes(path(outputs[i])) == expected[i]) << outputs[i];
  }
}

// Nobody could read it: that is an output that cannot be written.
TEST_F(Cli, AClosedStandardOutputIsAnErrorWhereItIsWrittenTo) {
  for (const std::string command :
       {"darboux surfaces", "darboux eval sphere --at 0,0", "darboux mesh sphere --grid 4x4 -o -",
        "darboux validate data/torus_016.three.glb --json", "darboux --help"}) {
    const Result r = sh(command + " >&-");
    EXPECT_EQ(r.status, 2) << command;
    expect_one_line(r.err);
  }
  good("darboux mesh sphere --grid 4x4 -o x.glb --quiet >&-");
  EXPECT_EQ(sh("darboux eval sphere --input - <&-").status, 2);
}

// ---- documents on standard output
// -----------------------------------------------------------------------------

// By whatever name: the document is added to what stands there, and nothing else is.
TEST_F(Cli, OnStandardOutputStandsTheDocumentAlone) {
  fs::copy_file(DARBOUX_SOURCE "/docs/examples/scene.json", path("scene.json"));
  good("darboux converge --surfaces torus --methods face --resolutions 4,6,8 --results results.jsonl");
  const std::vector<std::string> commands{
      "darboux eval sphere --grid 4x4 --format csv -o OUT",
      "darboux mesh torus --grid 8x8 -o OUT",
      "darboux tangents data/torus_016.none.glb -o OUT",
      "darboux tangents data/torus_016.none.glb --only needed --drop-idle -o OUT",
      "darboux scene scene.json -o OUT",
      "darboux scene scene.json --render OUT",
      "darboux converge --surfaces torus --methods face --resolutions 4,6,8 --picture OUT",
      "darboux merge results.jsonl -o OUT"};
  for (const std::string& command : commands) {
    const auto to = [&](const std::string& output) {
      std::string text = command;
      return text.replace(text.find("OUT"), 3, output);
    };
    SCOPED_TRACE(command);
    sh("rm -f file; " + to("file"));
    const std::string document = read_bytes(path("file"));
    ASSERT_GT(document.size(), 100u);
    good("ln -sf /dev/stdout link");
    for (const std::string output : {"-", "/dev/stdout", "/dev/fd/1", "/proc/self/fd/1", "link"}) {
      good("echo before > out; { " + to(output) + "; } 2>/dev/null >> out; echo after >> out");
      EXPECT_TRUE(read_bytes(path("out")) == "before\n" + document + "after\n") << output;
    }
    good("{ " + to("/dev/stdout") + "; } 2>/dev/null | cmp - file");
  }
}

// The input is mapped, and what is written where it lies changes what is still to be read.
TEST_F(Cli, AnInputMayBeItsOwnOutput) {
  sh("darboux mesh torus --grid 300x300 -o in.glb; darboux tangents in.glb -o expected.glb");
  for (const std::string output : {"- 1<>same.glb", "/dev/fd/3 3<>same.glb", "same.glb"}) {
    SCOPED_TRACE(output);
    sh("cp in.glb same.glb; darboux tangents same.glb -o " + output);
    EXPECT_TRUE(read_bytes(path("same.glb")) == read_bytes(path("expected.glb")));
  }
}

TEST_F(Cli, StandardOutputIsRefusedWhereItIsTaken) {
  for (const std::string output : {"-", "/dev/stdout", "/dev/fd/1"})
    for (const std::string command :
         {"mesh sphere --grid 4x4 --json -o ", "tangents data/torus_016.none.glb --json -o ",
          "validate data/torus_016.three.glb --sarif ", "validate data/torus_016.three.glb --junit ",
          "validate data/torus_016.three.glb --paint ", "validate data/torus_016.three.glb --report ",
          "plan data/torus_016.three.glb --sarif ", "fit data/torus_points.xyz --frames ",
          "converge --surfaces torus --json -o "})
      refused("darboux " + command + output);
}

// ---- files that exist -------------------------------------------------------------------------------------

TEST_F(Cli, AFileThatIsReadOnlyIsKept) {
  for (const std::string command :
       {"mesh sphere --grid 4x4 -o out", "eval sphere --at 0,0 -o out",
        "tangents data/torus_016.none.glb -o out", "validate data/torus_016.three.glb --sarif out",
        "fit data/torus_points.xyz --frames out", "plan data/torus_016.three.glb --sarif out",
        "converge --surfaces torus --methods face --resolutions 4,6,8 --csv out"}) {
    good("rm -f out; echo old > out; chmod 444 out");
    refused("darboux " + command, {"out: cannot be replaced", "read-only"});
    EXPECT_EQ(read_bytes(path("out")), "old\n");
  }
}

}  // namespace
}  // namespace darboux::test::outputs_test
