// The command line as other people's scripts use it: help, exit statuses, errors in one line.
#include <cmath>
#include <cstdio>

#include <darboux/image_files.h>

#include "cli.h"

namespace darboux::test::usage_test {
namespace {

// ---- help -------------------------------------------------------------------------------------------------

TEST_F(Cli, KnowsTheContractsSubcommands) {
  const auto names = subcommands();
  for (const char* name : {"surfaces", "eval", "check", "mesh", "tangents", "validate", "converge",
                           "stability", "work-precision", "fit", "compare", "scene", "normalmap", "bake"})
    EXPECT_NE(std::find(names.begin(), names.end(), name), names.end()) << name;
}

// Each help ends with an example, and the example runs on the files it names.
// The library knows arguments by other names than the command line.
TEST_F(Cli, ErrorsNameTheOptionThatWasGiven) {
  const std::string converge = "darboux converge --surfaces torus --methods ";
  refused(converge + "nope", {"darboux: --methods: expected one of", "got 'nope'"});
  refused(converge + "face --resolutions 4", {"darboux: --resolutions: expected at least 3"});
  refused("darboux check points", {"darboux: points: unknown surface"});
}

TEST_F(Cli, EveryHelpEndsWithAnExampleThatRuns) {
  good("darboux mesh torus --grid 32x16 -o torus.glb --quiet");
  good(
      "cp data/torus_016.none.glb in.glb; cp data/torus_points.xyz points.xyz; cp torus.glb a.glb; cp "
      "torus.glb b.glb");
  fs::copy_file(DARBOUX_SOURCE "/docs/examples/scene.json", path("scene.json"));
  write_image(path("tangent.png"), Image(32, 32, 3, SampleType::u8));
  for (const char* i : {"1", "2"})
    good("darboux converge --surfaces torus --methods face --resolutions 4,6,8 --shard " + std::string(i) +
         "/2 --results shard-" + i + ".jsonl");
  std::vector<std::string> names = subcommands();
  ASSERT_GE(names.size(), 7u);
  names.emplace_back("");
  for (const std::string& name : names) {
    const std::string help = good("darboux " + name + " --help");
    const std::size_t heading = help.rfind("\nExample:\n");
    ASSERT_NE(heading, std::string::npos) << name;
    const auto rest = lines(help.substr(heading + 10));
    ASSERT_FALSE(rest.empty()) << name;
    const std::string& example = rest[0];
    EXPECT_EQ(example.rfind("  darboux " + name, 0), 0u) << example;
    // The tool's own help goes on after it; a subcommand's does not.
    for (std::size_t i = 1; !name.empty() && i < rest.size(); ++i) EXPECT_EQ(rest[i], "") << name;
    good(example);
  }
}

TEST_F(Cli, TellsItsVersion) {
  EXPECT_EQ(good("darboux --version").rfind("darboux 0.", 0), 0u);
}

// ---- usage errors -----------------------------------------------------------------------------------------

TEST_F(Cli, RefusesWrongUsageInOneLine) {
  refused("darboux", {"command line: expected a command first, its options after it, got none"});
  refused("darboux --threads 2 eval torus --at 0,0",
          {"a command first", "got '--threads', see darboux --help"});
  refused("darboux");
  refused("darboux nonsense", {"nonsense", "validate", "eval"});
  refused("darboux check sphere --seed -1", {"--seed"});
  refused("darboux eval sphere --at 0,0 --attributes normal,normal", {"normal", "twice"});
  refused("darboux converge -o same.html --csv same.html", {"--csv", "-o"});
  refused("darboux mesh sphere --grid 8x4 -o - --json", {"standard output"});
  refused("darboux eval", {"SURFACE"});
  refused("darboux eval sphere --at 0,0 --no-such-option", {"--no-such-option"});
  refused("darboux eval sphere --at 0,0 --threads 0", {"--threads"});
  refused("darboux eval sphere --at 0,0 --threads x", {"--threads"});
  refused("darboux eval sphere --at 0,0 --format xml", {"--format", "table", "json", "csv"});
  refused("darboux eval sphere --at 0,0 --attributes nope", {"nope", "tangent4", "position"});
  refused("darboux eval sphere", {"--at", "--grid", "--input"});
  refused("darboux eval sphere --at 0,0 --grid 2x2", {"--at", "--grid", "--input"});
  refused("darboux check --points 0", {"--points"});
  refused("darboux mesh sphere -o x.glb", {"--grid"});
  refused("darboux mesh sphere --grid 4x4", {"--output"});
  refused("darboux tangents", {"--list"});
  refused("darboux validate", {"FILES"});
  refused("darboux validate x.glb --reference nope", {"--reference", "analytic"});
  refused("darboux converge --methods nope", {"nope", "average"});
  refused("darboux converge --meshes nope", {"nope", "regular"});
  refused("darboux converge --surfaces nope", {"nope", "torus"});
  refused("darboux converge --resolutions 8", {"resolutions"});
  refused("darboux converge --resolutions x", {"--resolutions", "'x'"});
}

TEST_F(Cli, RefusesUnknownSurfacesAndParametersWithTheKnownOnes) {
  for (const std::string command :
       {"eval SURFACE --at 0,0", "check SURFACE", "mesh SURFACE --grid 4x4 -o x.glb",
        "validate data/torus_016.three.glb --surface SURFACE", "converge --surfaces SURFACE"}) {
    const auto with = [&](const std::string& surface) {
      std::string text = command;
      return "darboux " + text.replace(text.find("SURFACE"), 7, surface);
    };
    refused(with("potato"), {"potato", "sphere", "torus", "cylinder"});
    refused(with("torus:radius=1"), {"torus", "'radius'", "major_radius", "minor_radius"});
    refused(with("torus:minor_radius=0"), {"torus", "0 < minor_radius", "got 0"});
    refused(with("sphere:radius=-1"), {"sphere", "0 < radius", "got -1"});
    refused(with("sphere:radius=nan"), {"sphere", "radius", "nan"});
    refused(with("sphere:radius=inf"), {"sphere", "radius", "inf"});
    refused(with("sphere:radius=one"), {"radius", "'one'", "number"});
    refused(with("sphere:radius="), {"radius", "number"});
    refused(with("sphere:radius"), {"radius"});
  }
  refused("darboux eval '' --at 0,0", {"sphere", "torus"});
  refused("darboux eval sphere: --at 0,0", {"radius"});
  refused("darboux eval torus:minor_radius=1,minor_radius=2 --at 0,0", {"minor_radius", "a second one"});
  EXPECT_FALSE(fs::exists(path("x.glb")));
}

// The parser's own texts are in its own words.
TEST_F(Cli, OptionsSayWhatTheyExpect) {
  for (const auto& [command, words] :
       {std::pair{"validate x.glb --max-angle 5deg", "--max-angle: expected a number, got '5deg'"},
        {"validate x.glb --max-angle", "--max-angle: expected a value, got none"},
        {"validate x.glb --json=r.json", "--json: expected no value, got 'r.json'"},
        {"normalmap a.png --to world", "--to: expected one of object, tangent, got 'world'"},
        {"work-precision --compare a", "--compare: expected at least 2 values, got 1"},
        {"fit", "expected FILE, got none"},
        {"fit a.xyz b.xyz", "got 'b.xyz' after its FILE"}})
    refused(std::string("darboux ") + command, {words});
}

TEST_F(Cli, HelpAndSurfacesTakeNames) {
  EXPECT_EQ(good("darboux help eval"), good("darboux eval --help"));
  EXPECT_EQ(good("darboux help"), good("darboux --help"));
  EXPECT_EQ(good("darboux help help"), good("darboux --help"));
  EXPECT_EQ(good("darboux help surfaces --pages"), good("darboux surfaces --help"));  // and writes nothing
  EXPECT_EQ(good("darboux surfaces torus").find("torus: "), 0u);
  EXPECT_EQ(json("darboux surfaces torus disk --json")["surfaces"].size(), 2u);
  refused("darboux surfaces trus", {"did you mean torus?"});
  refused("darboux surfaces torus --pages pages", {"--pages: expected no names of surfaces beside it"});
}

// --quiet: of what is judged the verdict, a line each; of what is written nothing.
TEST_F(Cli, QuietLeavesTheVerdict) {
  const std::string good_file = "data/torus_032.mikk.glb", bad_file = "data/plainsphere_016.three.glb";
  EXPECT_EQ(good("darboux validate --quiet " + good_file), good_file + ": pass\n");
  EXPECT_EQ(good("darboux validate --details --quiet " + bad_file + ' ' + good_file, 1),
            bad_file + ": fail\n" + good_file + ": pass\n");
  good("darboux validate --json " + bad_file + " > old.json", 1);
  EXPECT_EQ(good("darboux validate --quiet --baseline old.json " + bad_file),
            bad_file + ": fail (no worse than in the baseline)\n");
  EXPECT_EQ(good("darboux plan --quiet " + good_file), good_file +
                                                           ": ok, no primitive needs TANGENT; 1 stores it "
                                                           "unused (34.3 kB of 128 kB of geometry)\n");
  EXPECT_EQ(good("darboux check sphere --points 10 --quiet"), "all passed\n");
  EXPECT_EQ(good("darboux fit data/torus_032.mikk.glb --quiet"), "data/torus_032.mikk.glb: torus\n");
  for (const std::string command :
       {"compare data/torus_016.three.glb data/torus_016.three.glb",
        "stability sphere --sweeps turns --points 2", "work-precision sphere --rounds 3 --methods naive",
        "converge torus --methods face --resolutions 4,6,8",
        "converge torus --methods face --resolutions 4,6,8 -o page.html"})
    EXPECT_EQ(lines(good("darboux " + command + " --quiet")).size(), 1u) << command;
  for (const std::string command :
       {"mesh torus --grid 12x6 -o m.glb", "tangents data/torus_016.none.glb -o t.glb",
        "bake --surface torus --mesh m.glb --size 8x8 -o n.png", "merge shard.jsonl -o all.jsonl"}) {
    if (command.starts_with("merge")) {
      EXPECT_EQ(good("darboux converge torus --methods face --meshes regular --resolutions 4,6,8 --shard 1/1 "
                     "--results "
                     "shard.jsonl --quiet"),
                "");
    }
    EXPECT_EQ(good("darboux " + command + " --quiet"), "") << command;
  }
  const std::vector<std::string> check = lines(good("darboux normalmap --check n.png --quiet"));
  ASSERT_EQ(check.size(), 1u);
  EXPECT_EQ(check[0], "n.png: nothing wrong");
  EXPECT_EQ(good("darboux normalmap --compare n.png n.png --quiet"), "same\n");
}

TEST_F(Cli, NamesWhatANameThatIsNearWasMeantToBe) {
  refused("darboux eval Torus --at 0,0",
          {"Torus: unknown surface (did you mean torus?), known are sphere, "});
  refused("darboux check moebius_strip", {"did you mean moebius-strip?"});
  refused("darboux fit nothing.xyz --surface Cylinder", {"did you mean cylinder?"});
  refused("darboux eval kink.surface --at 0,0", {"formula:file=kink.surface"});
  refused("darboux check shpere", {"did you mean sphere?"});
  refused("darboux check klein", {"did you mean klein-bottle?"});  // a word of the name
  refused("darboux check mobius", {"did you mean moebius-strip?"});
  refused("darboux check patch", {"did you mean bilinear-patch, bezier-patch or bspline-patch?"});
  refused("darboux check paraboloid", {"did you mean elliptic-paraboloid or hyperbolic-paraboloid?"});
  refused("darboux check torus:majr_radius=2", {"'majr_radius' (did you mean major_radius?), known are"});
  refused("darboux eval torus --att position --bar", {"command line: expected options and arguments of eval, "
                                                      "got '--att' (did you mean --at?), 'position', '--bar'",
                                                      "see darboux eval --help"});
  refused("darboux eval torus --at 0.3 0.7",
          {"got '0.7' (the numbers of one value are joined by commas, as 0.3,0.7)"});
  refused("darboux eval torus --attribute=position",
          {"got '--attribute=position' (did you mean --attributes?)"});
  refused("darboux check torus --points 1e3",
          {"--points: expected a whole number from 1 to 100000000, got '1e3'"});
  refused("darboux eval torus --threads 0", {"--threads: expected a whole number from 1 to 1024, got '0'"});
  refused("darboux eval formula:x=u,y=v --at 0,0",
          {"expected formula:file=FILE, where FILE has lines such as"});
  refused("darboux valdate x.glb", {"unknown command (did you mean validate?), known are surfaces, "});
  refused("darboux work_precision", {"did you mean work-precision?"});
  for (const char* far : {"eval potato --at 0,0", "eval x --at 0,0", "nonsense", "eval '' --at 0,0"})
    EXPECT_EQ(sh(std::string("darboux ") + far).err.find("did you mean"), std::string::npos) << far;
}

// A name that says another format than what would be written is refused before any work.
TEST_F(Cli, RefusesNamesOfOtherFormats) {
  const std::string converge = "converge torus --methods face --meshes regular --resolutions 4,6,8 ";
  refused("darboux " + converge + "-o s.csv", {"-o", ".htm, .html, .md, .svg, .json", "--csv", "'s.csv'"});
  for (const std::string& command :
       {converge + "-o OUT.txt", std::string("stability sphere --sweeps turns --points 2 -o OUT.csv"),
        std::string("work-precision sphere --rounds 3 --methods naive -o OUT.pdf"),
        converge + "--picture OUT.png", std::string("validate data/torus_016.three.glb --report OUT.pdf"),
        std::string("validate data/torus_016.three.glb --paint OUT.obj"),
        std::string("mesh sphere --grid 4x4 -o OUT.ply"),
        std::string("tangents data/torus_016.none.glb -o OUT.obj"),
        std::string("eval sphere --at 0,0 -o OUT.html"), converge + "--csv OUT.html",
        converge + "--results OUT.csv", std::string("merge shard.jsonl -o OUT.html"),
        std::string("validate data/torus_016.three.glb --sarif OUT.html"),
        std::string("validate data/torus_016.three.glb --junit OUT.json"),
        std::string("plan data/torus_016.three.glb --sarif OUT.txt"),
        std::string("fit data/torus_points.xyz --frames OUT.json")}) {
    const std::string extension = command.substr(command.find(" OUT") + 4);
    refused("darboux " + command, {"expected a name ", extension});
    EXPECT_FALSE(fs::exists(path("OUT" + extension)));
  }
  good("darboux " + converge + "-o s.txt --format md");
  // Names of no known format, as of mktemp, are written as those without an extension.
  for (const std::string page : {"page", "page.htm", "page.HTM", "tmp.Ab12"}) {
    good("darboux " + converge + "-o " + page);
    EXPECT_NE(read_bytes(path(page)).find("<!DOCTYPE html>"), std::string::npos) << page;
  }
  good("darboux " + converge + "--picture tmp.Ab13");
  EXPECT_NE(read_bytes(path("tmp.Ab13")).find("<svg"), std::string::npos);
  for (const std::string page : {"verdict.htm", "tmp.Ab14"}) {
    good("darboux validate data/torus_016.three.glb --report " + page);
    EXPECT_NE(read_bytes(path(page)).find("<!DOCTYPE html>"), std::string::npos) << page;
  }
}

TEST_F(Cli, ConvergeTakesSurfacesAsArguments) {
  const std::string rest = " --methods face --meshes regular --resolutions 4,6,8 --json",
                    converge = "darboux converge ";
  const auto studies = [&](const std::string& surfaces) {
    Json list = json(converge + surfaces + rest)["studies"];
    for (Json& study : list) study.erase("seconds");
    return list;
  };
  const Json wanted = studies("--surfaces torus:major_radius=1,minor_radius=0.4,sphere");
  EXPECT_EQ(wanted[0]["surface"], "torus:major_radius=1,minor_radius=0.4");
  EXPECT_EQ(studies("torus:major_radius=1,minor_radius=0.4 sphere"), wanted);
  EXPECT_EQ(studies("torus:major_radius=1,minor_radius=0.4 --surfaces sphere"), wanted);
  refused("darboux converge nope", {"nope", "torus"});
}

// Standard input has no other files beside it, and no end to go back from.
// What is below what is expected is listed with the order between the finest meshes, which tells whether it
// still rises.
TEST_F(Cli, ConvergeListsOrdersBelowWhatIsExpected) {
  const std::string run =
      "darboux converge pseudosphere --methods average --meshes jittered --resolutions 8..64 ";
  const auto text = sh(run);
  EXPECT_EQ(text.status, 1);
  const Json document = Json::parse(sh(run + "--json").out);
  std::size_t slower = 0;
  for (const Json& s : document["studies"]) {
    if (s["verdict"] != "slower") continue;
    ++slower;
    const Json &h = s["h"], &rms = s["rms_deg"];
    const std::size_t n = h.size() - 1;
    char between[80];
    std::snprintf(between, sizeof between, "%.2f between the two finest meshes used",
                  std::log(rms[n - 1].get<double>() / rms[n].get<double>()) /
                      std::log(h[n - 1].get<double>() / h[n].get<double>()));
    EXPECT_NE(text.out.find(between), std::string::npos) << between << '\n' << text.out;
  }
  EXPECT_GT(slower, 0U);
  EXPECT_NE(text.out.find("--resolutions 16..128"), std::string::npos) << text.out;
}

TEST_F(Cli, SaysWhatToDoWithStandardInput) {
  for (const std::string command :
       {"validate IN", "plan IN", "tangents IN -o out.glb", "compare IN data/torus_016.obj"})
    for (const auto& [in, got] :
         {std::pair<std::string, std::string>{"-", "write standard input to a file first"},
          {"/dev/stdin", "a device or a pipe: write it to a file first"}}) {
      std::string text = command;
      text = "cat data/torus_016.none.glb | darboux " + text.replace(text.find("IN"), 2, in);
      const Result r = sh(text);
      EXPECT_EQ(r.status, 2) << text;
      EXPECT_NE(r.err.find(got), std::string::npos) << text << '\n' << r.err;
    }
}

// The extension of -o says the format, as that of --input does.
TEST_F(Cli, EvalWritesWhatTheNameOfItsOutputSays) {
  for (const std::string format : {"json", "csv", "f32", "f64", "npy"}) {
    good("darboux eval torus --grid 3x2 -o by_name." + format);
    good("darboux eval torus --grid 3x2 --format " + format + " -o asked.bin");
    EXPECT_EQ(read_bytes(path("by_name." + format)), read_bytes(path("asked.bin"))) << format;
  }
  const std::string table = good("darboux eval torus --grid 3x2");
  for (const std::string name : {"table.txt", "table", "tmp.Ab12"}) {
    good("darboux eval torus --grid 3x2 -o " + name);
    EXPECT_EQ(read_bytes(path(name)), table) << name;
  }
  good("darboux eval torus --grid 3x2 --format csv -o other.html");
  EXPECT_EQ(read_bytes(path("other.html")), read_bytes(path("by_name.csv")));
}

TEST_F(Cli, SceneSaysHowOtherFormatsBecomeGltf) {
  refused("darboux scene data/torus_016.obj", {"torus_016.obj", "convert .obj to .glb first"});
}

TEST_F(Cli, TangentsSaysHowOtherFormatsBecomeGltf) {
  refused("darboux tangents data/torus_016.obj -o out.glb",
          {"torus_016.obj", "expected a GLB", "convert .obj to .glb first", "assimp export IN.obj OUT.glb"});
  write_bytes(path("broken.glb"), "nothing");
  EXPECT_EQ(sh("darboux tangents broken.glb -o out.glb").err.find("convert"), std::string::npos);
}

TEST_F(Cli, RefusesPointsThatAreNotTwoFiniteNumbers) {
  for (const std::string point :
       {"x,0", "0,x", "0", "0,0,0", "''", ",", "nan,0", "0,inf", "1e999,0", "0x1,0", "0;0"})
    refused("darboux eval sphere --at " + (point == "0;0" ? "'0;0'" : point), {"--at"});
  refused("darboux eval sphere --at", {"--at"});
  for (const std::string grid : {"0x4", "4x0", "4", "axb", "-1x2", "4x4x4", "99999999999x1", "4X4", "''"})
    refused("darboux eval sphere --grid=" + grid, {"--grid"});
  good("printf 'u,v\\n0,0\\n0.5,half\\n' > bad.csv");
  const Result bad = sh("darboux eval sphere --input bad.csv --format csv -o out.csv");
  EXPECT_EQ(bad.status, 2);
  EXPECT_NE(bad.err.find("bad.csv:3"), std::string::npos) << bad.err;
  EXPECT_FALSE(fs::exists(path("out.csv")));
  refused("darboux eval sphere --input missing.csv -o out.csv", {"missing.csv"});
  refused("darboux eval sphere --input data -o out.csv", {"data"});
}

TEST_F(Cli, RefusesMeshOptionsOutOfRange) {
  const std::string mesh = "darboux mesh torus --grid 8x4 -o x.glb ";
  refused(mesh + "--jitter 0.5", {"jitter", "0.5"});
  refused(mesh + "--jitter -0.1", {"jitter"});
  refused(mesh + "--jitter nan", {"jitter", "nan"});
  refused(mesh + "--jitter x", {"--jitter"});
  refused(mesh + "--shear inf", {"shear"});
  refused(mesh + "--seam none", {"--seam", "split", "shared"});
  refused(mesh + "--sign left", {"--sign", "raw", "gltf"});
  refused(mesh + "--diagonal none", {"--diagonal"});
  refused("darboux mesh torus --grid 7x4 -o x.glb --mirror", {"mirror", "even"});
  refused("darboux mesh torus --grid 2x4 -o x.glb --seam shared", {"seam", "3 columns"});
  refused("darboux mesh torus --grid 4x2 -o x.glb --seam shared", {"seam", "3 rows"});
  refused("darboux mesh torus --grid 0x4 -o x.glb", {"--grid"});
  refused("darboux mesh torus --grid 2000000000x2000000000 -o x.glb", {"grid"});
  EXPECT_FALSE(fs::exists(path("x.glb")));
}

TEST_F(Cli, RefusesValidateOptionsOutOfRange) {
  const std::string validate = "darboux validate data/torus_016.three.glb ";
  for (const std::string angle : {"0", "-1", "nan", "181", "x", "inf"})
    refused(validate + "--max-angle " + angle, {"--max-angle"});
  refused(validate + "--placement somewhere", {"--placement", "identity"});
  refused(validate + "--placement 1,2,3", {"--placement"});
  refused(validate + "--placement 1,0,0,0,0,1,0,0,0,0,x,0,0,0,0,1", {"--placement", "'x'"});
  refused(validate + "--placement -1,0,0,0,0,1,0,0,0,0,1,0,0,0,0,1", {"--placement", "determinant"});
  refused(validate + "--placement 2,0,0,0,0,2,0,0,0,0,2,0,0,0,0,1", {"--placement", "rigid"});
}

TEST_F(Cli, RefusesTangentsItCannotCompute) {
  refused("darboux tangents data/torus_016.none.glb -o x.glb --method nope",
          {"nope", "average", "angle", "face"});
  refused("darboux tangents data/torus_016.none.glb --method area", {"-o"});
  refused("darboux tangents -o x.glb --method area", {"--list"});
  write_bytes(path("no_uvs.gltf"), R"({"asset": {"version": "2.0"}})");
  EXPECT_EQ(sh("darboux tangents no_uvs.gltf -o empty.glb --method area").status, 1)
      << "nothing could be done";
  refused("darboux tangents data/torus_016.obj -o x.glb --method area", {"torus_016.obj", "glTF"});
  refused("darboux tangents missing.glb -o x.glb --method area", {"missing.glb"});
  EXPECT_FALSE(fs::exists(path("x.glb")));
}

// ---- files that cannot be read or written -----------------------------------------------------------------

TEST_F(Cli, RefusesFilesThatAreNotMeshes) {
  good("head -c 100 data/torus_016.three.glb > truncated.glb");
  good("head -c 20000 data/torus_016.three.glb > truncated_late.glb");
  good(": > empty.glb");
  good("echo hello > text.glb");
  good("echo hello > text.obj");
  good("echo '{\"asset\": {\"version\": \"1.0\"}}' > old.gltf");
  good("echo '{\"asset\": ' > broken.gltf");

  Builder triangle;
  const std::size_t positions = triangle.positions({0, 0, 0, 1, 0, 0, 0, 1, 0});
  const auto with_indices = [&](std::initializer_list<std::uint16_t> indices) {
    Builder b = triangle;
    b.primitive({{"POSITION", positions}},
                {{"indices", b.packed<std::uint16_t>("SCALAR", 5123, 3, indices)}});
    return b;
  };
  write_bytes(path("index.glb"), with_indices({0, 1, 3}).glb());
  Builder huge = with_indices({0, 1, 2});
  huge.json["accessors"][0]["count"] = 4000000000u;
  write_bytes(path("huge.glb"), huge.glb());
  huge.json["accessors"][0]["count"] = std::numeric_limits<std::uint64_t>::max();
  write_bytes(path("huger.glb"), huge.glb());
  huge.json["accessors"][0]["count"] = -1;
  write_bytes(path("negative.glb"), huge.glb());

  for (const std::string name :
       {"missing.glb", "truncated.glb", "truncated_late.glb", "empty.glb", "text.glb", "text.obj", "old.gltf",
        "broken.gltf", "index.glb", "huge.glb", "huger.glb", "negative.glb"}) {
    refused("darboux validate " + name, {name});
    if (name != "text.obj") refused("darboux tangents " + name + " -o x.glb --method area", {name});
    // With --json the document comes all the same, and names the error.
    const Result r = sh("darboux validate " + name + " --json");
    EXPECT_EQ(r.status, 2) << name;
    expect_one_line(r.err);
    const Json document = Json::parse(r.out, nullptr, false);
    ASSERT_FALSE(document.is_discarded()) << r.out;
    EXPECT_EQ(document["verdict"], "fail");
    EXPECT_EQ(document["files"][0]["file"], name);
    EXPECT_EQ(document["files"][0]["verdict"], "fail");
    EXPECT_NE(r.err.find(document["files"][0]["error"].get<std::string>()), std::string::npos);
  }
  for (const std::string command : {"tangents data -o x.glb", "compare data data/torus_016.obj"})
    refused("darboux " + command, {"data", "got a folder"});  // validate reads what is in it
  EXPECT_FALSE(fs::exists(path("x.glb")));
}

TEST_F(Cli, RefusesOutputsThatCannotBeWritten) {
  good("echo text > file");
  for (const std::string command :
       {"eval sphere --grid 4x4 --format csv -o OUT", "mesh sphere --grid 8x4 -o OUT",
        "tangents data/torus_016.none.glb --method average -o OUT",
        "converge --surfaces torus --methods face --meshes regular --resolutions 4,6,8 -o OUT",
        "converge --surfaces torus --methods face --meshes regular --resolutions 4,6,8 --csv OUT",
        "stability sphere --sweeps turns --points 2 -o OUT",
        "stability sphere --sweeps turns --points 2 --csv OUT",
        "work-precision sphere --rounds 3 --methods naive -o OUT",
        "work-precision sphere --rounds 3 --methods naive --csv OUT"}) {
    const auto to = [&](const std::string& out) {
      std::string text = command;
      return "darboux " + text.replace(text.find("OUT"), 3, out);
    };
    for (const std::string out : {"missing/out", "file/out", "/dev/full", "data"}) refused(to(out), {out});
    // An old file stays when there is no new one, and nothing is left beside it.
    EXPECT_EQ(read_bytes(path("file")), "text\n");
  }
  std::size_t entries = 0;
  for ([[maybe_unused]] const auto& entry : fs::directory_iterator(path(""))) ++entries;
  EXPECT_EQ(entries, 2u) << "data and file, and nothing else";
}

TEST_F(Cli, SaysSoWhenStandardOutputIsFull) {
  for (const std::string command :
       {"surfaces", "surfaces --json", "eval sphere --at 0,0", "eval sphere --grid 100x100 --format csv",
        "check sphere --points 10", "check sphere --points 10 --json", "validate data/torus_016.three.glb",
        "validate data/torus_016.three.glb --json", "tangents --list", "mesh sphere --grid 8x4 -o x.glb",
        "--help", "eval --help", "--version"}) {
    const Result r = sh("darboux " + command + " >/dev/full");
    EXPECT_EQ(r.status, 2) << command;
    expect_one_line(r.err);
  }
}

}  // namespace
}  // namespace darboux::test::usage_test
