// What the tool writes: whole documents, whatever its standard streams lead to.
#include <pugixml.hpp>

#include "cli.h"

namespace darboux::test {
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

}  // namespace
}  // namespace darboux::test
