// The command line as other people's scripts use it: exit statuses, errors, keys, numbers, and the verdict on meshes
// that other tools made. Every test runs the tool through a shell, in a folder of its own that holds `data`.
#include <bit>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <limits>
#include <sstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <sys/wait.h>

#include <darboux/any_surface.h>

#include "io_files.h"

namespace darboux::test {
namespace {

namespace fs = std::filesystem;

struct Result {
  int status;
  std::string out, err;
};

class Cli : public ::testing::Test {
 protected:
  Cli() {
    fs::create_directory(folder_ / "work");
    fs::create_directory_symlink(DARBOUX_TEST_DATA, folder_ / "work/data");
    fs::create_directory(folder_ / "bin");
    fs::create_symlink(DARBOUX_TOOL, folder_ / "bin/darboux");
  }

  // Runs a shell command, in which `darboux` is the tool.
  Result sh(const std::string& command) const {
    const std::string script = "cd '" + path("") + "' && export PATH='" + (folder_ / "bin") +
                               "':\"$PATH\" && { " + command + "\n} >'" + (folder_ / "out") + "' 2>'" +
                               (folder_ / "err") + "' </dev/null";
    const int status = std::system(script.c_str());
    return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, read_bytes(folder_ / "out"),
            read_bytes(folder_ / "err")};
  }

  // Runs a command that must end with this status, without a word on stderr.
  std::string good(const std::string& command, int status = 0) const {
    const Result r = sh(command);
    EXPECT_EQ(r.status, status) << command << '\n' << r.out << r.err;
    EXPECT_EQ(r.err, "") << command;
    return r.out;
  }

  // The same for a command whose whole stdout is one JSON document.
  Json json(const std::string& command, int status = 0) const {
    const std::string out = good(command, status);
    const Json result = Json::parse(out, nullptr, false);
    EXPECT_FALSE(result.is_discarded()) << command << '\n' << out;
    return result;
  }

  // Runs a command that must be refused: status 2, one line on stderr that begins with "darboux: " and holds all of
  // `parts`, nothing on stdout.
  void refused(const std::string& command, const std::vector<std::string>& parts = {}) const {
    SCOPED_TRACE(command);
    const Result r = sh(command);
    EXPECT_EQ(r.status, 2);
    EXPECT_EQ(r.out, "");
    expect_one_line(r.err);
    for (const std::string& part : parts)
      EXPECT_NE(r.err.find(part), std::string::npos) << part << " in " << r.err;
  }
  static void expect_one_line(const std::string& err) {
    EXPECT_EQ(err.rfind("darboux: ", 0), 0u) << err;
    EXPECT_EQ(std::count(err.begin(), err.end(), '\n'), 1) << err;
    EXPECT_EQ(err.back(), '\n');
  }

  std::string path(const std::string& name) const { return folder_ / ("work/" + name); }

  // The names of the subcommands, from the tool's own help.
  std::vector<std::string> subcommands() const {
    std::istringstream help(good("darboux --help"));
    std::vector<std::string> names;
    bool list = false;
    for (std::string line; std::getline(help, line);) {
      if (line == "Subcommands:")
        list = true;
      else if (line.empty())
        list = false;
      else if (list && line[2] != ' ')
        names.push_back(line.substr(2, line.find(' ', 2) - 2));
    }
    return names;
  }

 private:
  TempFolder folder_;
};

std::vector<std::string> keys(const Json& object) {
  std::vector<std::string> result;
  for (const auto& [key, value] : object.items()) result.push_back(key);
  return result;
}

// Every key is there; more may be.
void expect_keys(const Json& object, const std::vector<std::string>& wanted) {
  for (const std::string& key : wanted) EXPECT_TRUE(object.contains(key)) << key << " in " << object.dump();
}

bool same_bits(double a, double b) {
  return std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b);
}

std::vector<std::string> lines(const std::string& text) {
  std::vector<std::string> result;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) result.push_back(line);
  return result;
}

std::vector<std::string> fields(const std::string& line) {
  std::vector<std::string> result(1);
  for (const char c : line)
    if (c == ',')
      result.emplace_back();
    else
      result.back() += c;
  return result;
}

double to_double(const std::string& text) {
  double value = std::numeric_limits<double>::quiet_NaN();
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  EXPECT_TRUE(error == std::errc{} && end == text.data() + text.size()) << text;
  return value;
}

// ---- help ----------------------------------------------------------------------------------------------------------

TEST_F(Cli, KnowsTheContractsSubcommands) {
  const auto names = subcommands();
  for (const char* name : {"surfaces", "eval", "check", "mesh", "tangents", "validate", "converge"})
    EXPECT_NE(std::find(names.begin(), names.end(), name), names.end()) << name;
}

// Each help ends with an example, and the example runs on the files it names.
TEST_F(Cli, EveryHelpEndsWithAnExampleThatRuns) {
  good("darboux mesh torus --grid 32x16 -o torus.glb --quiet");
  good("cp data/torus_016.none.glb in.glb");
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

// ---- usage errors --------------------------------------------------------------------------------------------------

TEST_F(Cli, RefusesWrongUsageInOneLine) {
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
  refused("darboux mesh sphere", {"--grid"});
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
    refused(with("torus:minor_radius=0"), {"torus", "minor_radius = 0 ", "0 < minor_radius"});
    refused(with("sphere:radius=-1"), {"sphere", "radius = -1 ", "0 < radius"});
    refused(with("sphere:radius=nan"), {"sphere", "radius", "nan"});
    refused(with("sphere:radius=inf"), {"sphere", "radius", "inf"});
    refused(with("sphere:radius=one"), {"radius", "'one'", "number"});
    refused(with("sphere:radius="), {"radius", "number"});
    refused(with("sphere:radius"), {"radius"});
  }
  refused("darboux eval '' --at 0,0", {"sphere", "torus"});
  refused("darboux eval sphere: --at 0,0", {"radius"});
  refused("darboux eval torus:minor_radius=1,minor_radius=2 --at 0,0", {"minor_radius", "twice"});
  EXPECT_FALSE(fs::exists(path("x.glb")));
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
  refused("darboux mesh torus --grid 2x4 -o x.glb --seam shared", {"seam", "3"});
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

// ---- files that cannot be read or written --------------------------------------------------------------------------

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
        "broken.gltf", "index.glb", "huge.glb", "huger.glb", "negative.glb", "data"}) {
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
  EXPECT_FALSE(fs::exists(path("x.glb")));
}

TEST_F(Cli, RefusesOutputsThatCannotBeWritten) {
  good("echo text > file");
  for (const std::string command :
       {"eval sphere --grid 4x4 --format csv -o OUT", "mesh sphere --grid 8x4 -o OUT",
        "tangents data/torus_016.none.glb --method average -o OUT",
        "converge --surfaces torus --methods face --meshes regular --resolutions 4,6,8 -o OUT",
        "converge --surfaces torus --methods face --meshes regular --resolutions 4,6,8 --csv OUT"}) {
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

// ---- eval ----------------------------------------------------------------------------------------------------------

TEST_F(Cli, EvalEchoesCoordinatesBitForBit) {
  const std::vector<std::pair<double, double>> points{
      {0.1, 0.30000000000000004},     {-0.25, 0.5},       {-0.0, 1.0},       {5e-324, 1e-300},
      {1e22, 1.7976931348623157e308}, {1.0 / 3, 2.0 / 3}, {123456.789, -4.9}};
  std::string command = "darboux eval torus:major_radius=1,minor_radius=0.4";
  for (const auto& [u, v] : points) {
    char text[128];
    std::snprintf(text, sizeof text, " --at %.17g,%.17g", u, v);
    command += text;
  }
  const Json samples = json(command + " --json")["samples"];
  const auto csv = lines(good(command + " --format csv"));
  ASSERT_EQ(samples.size(), points.size());
  ASSERT_EQ(csv.size(), points.size() + 1);
  for (std::size_t i = 0; i < points.size(); ++i) {
    EXPECT_TRUE(same_bits(samples[i]["u"], points[i].first)) << samples[i]["u"];
    EXPECT_TRUE(same_bits(samples[i]["v"], points[i].second)) << samples[i]["v"];
    EXPECT_TRUE(same_bits(to_double(fields(csv[i + 1])[0]), points[i].first)) << csv[i + 1];
    EXPECT_TRUE(same_bits(to_double(fields(csv[i + 1])[1]), points[i].second)) << csv[i + 1];
  }
}

// What is printed reads back to the library's own bits.
TEST_F(Cli, EvalPrintsTheLibrarysNumbers) {
  const Json document =
      json("darboux eval torus:major_radius=1,minor_radius=0.4 --at 0.3,0.7 --at -0.25,0.5 --json");
  EXPECT_EQ(document["surface"]["name"], "torus");
  EXPECT_EQ(keys(document["surface"]["parameters"]),
            (std::vector<std::string>{"major_radius", "minor_radius"}));
  EXPECT_EQ(document["surface"]["parameters"]["minor_radius"].get<double>(), 0.4);
  const AnySurface torus = make_surface("torus:major_radius=1,minor_radius=0.4");
  for (const Json& s : document["samples"]) {
    expect_keys(s, {"u", "v", "status", "position", "dpdu", "dpdv", "d2pdu2", "d2pduv", "d2pdv2", "tangent",
                    "bitangent", "normal", "handedness", "gaussian_curvature", "mean_curvature",
                    "principal_curvatures", "principal_directions"});
    const Sample<double> truth = torus.sample(s["u"], s["v"]);
    const auto expect_vector = [&](const char* key, const Vec3<double>& a) {
      EXPECT_TRUE(same_bits(s[key][0], a.x) && same_bits(s[key][1], a.y) && same_bits(s[key][2], a.z))
          << key << s[key];
    };
    expect_vector("position", truth.jet.position);
    expect_vector("dpdu", truth.jet.dpdu);
    expect_vector("dpdv", truth.jet.dpdv);
    expect_vector("d2pdu2", truth.jet.d2pdu2);
    expect_vector("d2pduv", truth.jet.d2pduv);
    expect_vector("d2pdv2", truth.jet.d2pdv2);
    expect_vector("tangent", truth.frame.t);
    expect_vector("bitangent", truth.frame.b);
    expect_vector("normal", truth.frame.n);
    EXPECT_EQ(s["handedness"].get<double>(), 1);
    EXPECT_EQ(s["status"], Json::array({"regular"}));
    ASSERT_EQ(s["principal_curvatures"].size(), 2u);
    EXPECT_GE(s["principal_curvatures"][0].get<double>(), s["principal_curvatures"][1].get<double>());
    EXPECT_NEAR(s["mean_curvature"].get<double>() * 2,
                s["principal_curvatures"][0].get<double>() + s["principal_curvatures"][1].get<double>(),
                1e-13);
    ASSERT_EQ(s["principal_directions"].size(), 2u);
    EXPECT_EQ(s["principal_directions"][1].size(), 3u);
  }
}

TEST_F(Cli, EvalReportsStatusAndNull) {
  const Json samples = json("darboux eval sphere --at 0.25,0 --at 0.25,0.5 --at 0.25,1.5 --json")["samples"];
  EXPECT_EQ(samples[0]["status"], Json::array({"dpdu_zero", "limit_frame", "umbilic"}));
  EXPECT_EQ(samples[0]["tangent"], Json::array({-1.0, 0.0, 0.0}));
  // The curvature at a pole is its limit; at the apex of a cone there is none.
  EXPECT_NEAR(samples[0]["gaussian_curvature"].get<double>(), 1, 1e-14);
  EXPECT_NEAR(samples[0]["mean_curvature"].get<double>(), -1, 1e-14);
  const Json apex = json("darboux eval cone --at 0.25,1 --json")["samples"][0];
  EXPECT_EQ(apex["mean_curvature"], nullptr);
  EXPECT_NE(apex["normal"][0], nullptr);
  EXPECT_EQ(samples[1]["status"], Json::array({"umbilic"}));
  EXPECT_NE(samples[2]["status"].dump().find("outside_domain"), std::string::npos);
  // The status of a CSV row is its last field, bits joined by '|'; umbilic only where directions are asked for.
  const auto csv =
      lines(good("darboux eval sphere --at 0.25,0 --at 0.25,0.5 --attributes normal --format csv"));
  EXPECT_EQ(fields(csv[1]).back(), "dpdu_zero|limit_frame");
  EXPECT_EQ(fields(csv[2]).back(), "regular");
  // JSON has no infinity.
  const Json overflow = json("darboux eval sphere:radius=1e308 --at 0.1,0.3 --json")["samples"][0];
  EXPECT_NE(overflow["status"].dump().find("overflow"), std::string::npos);
  EXPECT_NE(overflow["d2pdu2"].dump().find("null"), std::string::npos) << overflow["d2pdu2"];
}

TEST_F(Cli, EvalGridIsOrderedAndCsvHasTheColumnsAskedFor) {
  const auto csv =
      lines(good("darboux eval sphere --grid 4x2 --attributes tangent4,position,handedness --format csv"));
  EXPECT_EQ(
      csv[0],
      "u,v,tangent4_x,tangent4_y,tangent4_z,tangent4_w,position_x,position_y,position_z,handedness,status");
  ASSERT_EQ(csv.size(), 1 + 5 * 3u);
  std::size_t row = 1;
  for (int j = 0; j <= 2; ++j)
    for (int i = 0; i <= 4; ++i, ++row) {
      const auto f = fields(csv[row]);
      ASSERT_EQ(f.size(), 11u);
      EXPECT_EQ(to_double(f[0]), i / 4.0);
      EXPECT_EQ(to_double(f[1]), j / 2.0);
      EXPECT_EQ(to_double(f[5]), -1) << "w in the gltf convention";
    }
  const std::string header = lines(good("darboux eval sphere --at 0.1,0.2 --format csv"))[0];
  EXPECT_NE(header.find(",principal_curvatures_1,principal_curvatures_2,principal_directions_1_x,"
                        "principal_directions_1_y,principal_directions_1_z,principal_directions_2_x,"
                        "principal_directions_2_y,principal_directions_2_z,status"),
            std::string::npos)
      << header;
}

TEST_F(Cli, EvalReadsWhatItWrites) {
  const std::string grid = good("darboux eval torus --grid 5x3 --attributes position --format csv");
  good("darboux eval torus --grid 5x3 --attributes position --format csv -o grid.csv");
  EXPECT_EQ(read_bytes(path("grid.csv")), grid);
  EXPECT_EQ(good("darboux eval torus --input grid.csv --attributes position --format csv"), grid);
  EXPECT_EQ(good("cat grid.csv | darboux eval torus --input - --attributes position --format csv"), grid);
  good("printf '0.25,0.5\\n' > plain.csv");
  EXPECT_EQ(lines(good("darboux eval torus --input plain.csv --attributes position --format csv")).size(),
            2u);
}

TEST_F(Cli, EvalReadsHeadersAsSpreadsheetsWriteThem) {
  write_bytes(path("plain.csv"), "0.25,0.5\n");
  const std::string plain = good("darboux eval torus --input plain.csv --format csv");
  for (const std::string text : {"u,v\n0.25,0.5\n", "u, v\r\n0.25, 0.5\r\n", "\xEF\xBB\xBFu,v\n0.25,0.5\n",
                                 "# points\n\nname,v,u\nx,0.5,0.25\n"}) {
    write_bytes(path("headed.csv"), text);
    EXPECT_EQ(good("darboux eval torus --input headed.csv --format csv"), plain) << text;
  }
}

TEST_F(Cli, JsonFlagAndFormatAreTheSame) {
  EXPECT_EQ(good("darboux eval torus --at 0.1,0.2 --json"),
            good("darboux eval torus --at 0.1,0.2 --format json"));
}

// ---- surfaces, check -----------------------------------------------------------------------------------------------

TEST_F(Cli, SurfacesHasTheContractsKeys) {
  const Json all = json("darboux surfaces --json")["surfaces"];
  ASSERT_EQ(all.size(), all_surfaces().size());
  for (const Json& s : all) {
    expect_keys(
        s, {"name", "summary", "parameters", "periodic_u", "periodic_v", "orientable", "singular", "facts"});
    EXPECT_FALSE(s["facts"].empty()) << s["name"];
    for (const Json& p : s["parameters"])
      expect_keys(p, {"name", "default", "minimum", "maximum", "meaning"});
    // Every name alone evaluates.
    good("darboux eval " + s["name"].get<std::string>() + " --at 0.3,0.7");
  }
  EXPECT_EQ(all[0]["name"], "sphere");
  EXPECT_EQ(all[0]["periodic_u"], true);
  EXPECT_EQ(all[0]["periodic_v"], false);
  EXPECT_EQ(all[0]["singular"], Json::array({"v=0", "v=1"}));
  EXPECT_EQ(all[0]["parameters"][0]["maximum"], nullptr) << "infinity";
}

TEST_F(Cli, CheckPassesForTheCatalogueAndRepeats) {
  const Json document = json("darboux check --points 200 --seed 7 --json");
  EXPECT_EQ(document["passed"], true);
  for (const Json& c : document["checks"]) {
    expect_keys(c, {"surface", "route", "quantity"});
    if (c.contains("skipped")) {
      EXPECT_FALSE(c["skipped"].get<std::string>().empty());
      continue;
    }
    expect_keys(c, {"points", "max_error", "bound", "passed", "worst"});
    expect_keys(c["worst"], {"u", "v"});
    EXPECT_GT(c["points"].get<int>(), 0) << c;
    EXPECT_LE(c["max_error"].get<double>(), c["bound"].get<double>()) << c;
  }
  EXPECT_EQ(document, json("darboux check --points 200 --seed 7 --threads 3 --json"));
  EXPECT_NE(document, json("darboux check --points 200 --seed 8 --json"));
  EXPECT_EQ(json("darboux check torus:minor_radius=0.4 --points 5 --json")["checks"][0]["surface"], "torus");
}

// ---- validate: meshes that other tools made ------------------------------------------------------------------------

// The one judged primitive of a file.
Json only_mesh(const Json& document) {
  EXPECT_EQ(document["files"].size(), 1u);
  EXPECT_EQ(document["files"][0]["meshes"].size(), 1u) << document;
  return document["files"][0]["meshes"][0];
}

bool has_finding(const Json& mesh, const std::string& code) {
  for (const Json& f : mesh["findings"])
    if (f["code"] == code) return true;
  return false;
}

TEST_F(Cli, ValidateHasTheContractsKeys) {
  const Json document = json("darboux validate data/torus_016.three.glb --json");
  expect_keys(document, {"files", "verdict"});
  expect_keys(document["files"][0], {"file", "verdict", "meshes"});
  EXPECT_EQ(document["files"][0]["file"], "data/torus_016.three.glb");
  EXPECT_EQ(document["verdict"], "pass");
  const Json mesh = only_mesh(document);
  expect_keys(mesh, {"mesh", "primitive", "name", "corners", "surface", "uv", "reference", "handedness",
                     "zero_tangents", "non_unit", "non_orthogonal", "non_finite", "degenerate_triangles",
                     "degenerate_uv_triangles", "classes", "findings"});
  EXPECT_EQ(mesh["reference"], "analytic");
  expect_keys(mesh["surface"], {"name", "parameters", "placement", "fit_rms", "fit_rms_relative"});
  EXPECT_EQ(mesh["surface"]["placement"].size(), 16u);
  EXPECT_EQ(mesh["surface"]["placement"][15].get<double>(), 1);
  EXPECT_LT(mesh["surface"]["fit_rms_relative"].get<double>(), 1e-6);
  expect_keys(mesh["uv"], {"convention", "affine", "equivalent", "texcoord"});
  EXPECT_EQ(mesh["uv"]["convention"], "as stored");
  EXPECT_EQ(mesh["uv"]["affine"].size(), 6u);
  EXPECT_EQ(mesh["uv"]["texcoord"], 0);
  expect_keys(mesh["handedness"], {"convention", "consistent", "wrong"});
  for (const auto& [name, c] : mesh["classes"].items()) {
    expect_keys(c, {"corners", "normal_deg", "tangent_deg", "bitangent_deg", "worst"});
    expect_keys(c["worst"], {"vertex", "u", "v"});
    for (const char* quantity : {"normal_deg", "tangent_deg", "bitangent_deg"})
      expect_keys(c[quantity], {"max", "rms", "p95"});
  }
}

struct Expected {
  std::string file, surface;
  std::vector<std::pair<std::string, double>> parameters;
  std::string convention;
  // Degrees, in the printed digits of the evidence; negative: not asked.
  double interior_max, interior_rms, seam_max;
};

// The same to the printed digits: two significant ones, so half a unit of the second.
void expect_printed(const Json& value, double printed, const std::string& what) {
  if (printed < 0) return;
  const double unit = std::pow(10.0, std::floor(std::log10(printed)) - 1);
  EXPECT_NEAR(value.get<double>(), printed, 0.5 * unit * (1 + 1e-9)) << what;
}

TEST_F(Cli, ValidateReproducesTheEvidence) {
  const std::vector<Expected> table{
      {"torus_016.three", "torus", {{"major_radius", 1}, {"minor_radius", 0.4}}, "raw", .29, .19, 5.6},
      {"torus_032.three", "torus", {{"major_radius", 1}, {"minor_radius", 0.4}}, "raw", .076, .048, 2.8},
      {"torus_032.mikk", "torus", {{"major_radius", 1}, {"minor_radius", 0.4}}, "gltf", -1, -1, 2.8},
      {"torus_032.assimp", "torus", {{"major_radius", 1}, {"minor_radius", 0.4}}, "gltf", .40, .29, -1},
      {"sphere_016.three", "sphere", {{"radius", 1}}, "raw", .82, .39, -1},
      {"sphere_032.three", "sphere", {{"radius", 1}}, "raw", .45, .16, 2.8},
      {"sphere_032.mikk", "sphere", {{"radius", 1}}, "gltf", -1, -1, 2.8},
      {"cylinder_016.three", "cylinder", {{"radius", 1}, {"height", 2}}, "raw", -1, -1, -1},
      {"cylinder_032.three", "cylinder", {{"radius", 1}, {"height", 2}}, "raw", -1, -1, -1},
      {"cylinder_016.mikk", "cylinder", {{"radius", 1}, {"height", 2}}, "gltf", -1, -1, -1},
      {"jittertorus_016.mikk", "torus", {{"major_radius", 1}, {"minor_radius", 0.4}}, "gltf", 1.7, .50, -1},
  };
  for (const Expected& e : table) {
    SCOPED_TRACE(e.file);
    const Json mesh = only_mesh(json("darboux validate data/" + e.file + ".glb --json"));
    EXPECT_EQ(mesh["surface"]["name"], e.surface);
    for (const auto& [name, value] : e.parameters)
      EXPECT_NEAR(mesh["surface"]["parameters"][name].get<double>(), value, 1e-6) << name;
    EXPECT_EQ(mesh["handedness"]["convention"], e.convention);
    EXPECT_EQ(mesh["handedness"]["consistent"].get<double>(), 1);
    EXPECT_EQ(mesh["handedness"]["wrong"], 0);
    const Json& interior = mesh["classes"]["interior"];
    expect_printed(interior["tangent_deg"]["max"], e.interior_max, "interior max");
    expect_printed(interior["tangent_deg"]["rms"], e.interior_rms, "interior rms");
    if (e.seam_max > 0) expect_printed(mesh["classes"]["seam"]["tangent_deg"]["max"], e.seam_max, "seam max");
    // What is exact by symmetry is left with the noise of float32.
    if (e.interior_max < 0) {
      EXPECT_LT(interior["tangent_deg"]["max"].get<double>(), 1e-4);
    }
    EXPECT_LT(interior["normal_deg"]["max"].get<double>(), 1e-4);
  }
}

TEST_F(Cli, ValidateTellsTheVerdictsApart) {
  const Json zero = only_mesh(json("darboux validate data/plainsphere_016.three.glb --json", 1));
  ASSERT_FALSE(zero["findings"].empty());
  EXPECT_EQ(zero["findings"][0]["code"], "TANGENT_ZERO");
  EXPECT_EQ(zero["findings"][0]["severity"], "error");
  EXPECT_EQ(zero["findings"][0]["count"], 2);
  EXPECT_EQ(zero["zero_tangents"], 2);

  const Json cone = json("darboux validate data/cone_016.three.glb --json", 1);
  EXPECT_EQ(cone["verdict"], "undetermined");
  EXPECT_EQ(only_mesh(cone)["surface"], nullptr);
  EXPECT_EQ(only_mesh(cone)["reference"], "none");
  EXPECT_TRUE(has_finding(only_mesh(cone), "SURFACE_UNKNOWN"));

  const Json declared = json("darboux validate data/cone_016.three.glb --surface cylinder --json", 1);
  EXPECT_EQ(declared["verdict"], "fail");
  EXPECT_TRUE(has_finding(only_mesh(declared), "SURFACE_MISMATCH"));

  // The limit decides: seam corners are 5.6 degrees off, interior ones 0.29.
  const std::string torus = "darboux validate data/torus_016.three.glb --json --max-angle ";
  EXPECT_EQ(json(torus + "2")["verdict"], "pass");
  EXPECT_TRUE(has_finding(only_mesh(json(torus + "1.8", 1)), "TANGENT_ANGLE"));

  // Over several files the highest status counts.
  good("darboux validate data/torus_016.three.glb data/sphere_016.three.glb");
  good("darboux validate data/torus_016.three.glb data/cone_016.three.glb", 1);
  const Result missing =
      sh("darboux validate data/cone_016.three.glb missing.glb data/torus_016.three.glb --json");
  EXPECT_EQ(missing.status, 2);
  EXPECT_EQ(Json::parse(missing.out)["files"].size(), 3u);
  expect_one_line(missing.err);
}

// Meshes that lack what a verdict is made of are judged by what they have.
TEST_F(Cli, ValidateCopesWithMissingAttributes) {
  for (const std::string file :
       {"torus_016.none.glb", "sphere_016.none.glb", "torus_016.obj", "sphere_016.obj"}) {
    const Json mesh = only_mesh(json("darboux validate data/" + file + " --json"));
    EXPECT_TRUE(has_finding(mesh, "TANGENT_MISSING")) << file;
    EXPECT_EQ(mesh["handedness"]["convention"], "none") << file;
    EXPECT_FALSE(mesh["classes"]["interior"].contains("tangent_deg")) << file;
    EXPECT_LT(mesh["classes"]["interior"]["normal_deg"]["max"].get<double>(), 1e-4) << file;
  }
  // One attribute taken out of the torus at a time: the accessor stays, the primitive no longer names it.
  const auto without = [&](const std::vector<std::string>& attributes) {
    Glb glb = split_glb(read_bytes(path("data/torus_016.three.glb")));
    for (const std::string& name : attributes)
      glb.json["meshes"][0]["primitives"][0]["attributes"].erase(name);
    write_bytes(path("without.glb"), make_glb(glb.json.dump(), glb.bin));
  };
  without({"TEXCOORD_0"});
  const Json no_uv = json("darboux validate without.glb --json", 1);
  EXPECT_EQ(no_uv["verdict"], "undetermined");
  EXPECT_TRUE(has_finding(only_mesh(no_uv), "UV_MISSING"));
  EXPECT_EQ(only_mesh(no_uv)["uv"], nullptr);
  without({"TEXCOORD_0", "NORMAL", "TANGENT"});
  EXPECT_EQ(json("darboux validate without.glb --json", 1)["verdict"], "undetermined");
  without({"NORMAL"});
  const Json no_normals = only_mesh(json("darboux validate without.glb --json"));
  EXPECT_FALSE(no_normals["classes"]["interior"].contains("normal_deg"));
  EXPECT_FALSE(no_normals["classes"]["interior"].contains("bitangent_deg"));
  EXPECT_NEAR(no_normals["classes"]["interior"]["tangent_deg"]["rms"].get<double>(), .19, .005);
  without({"TANGENT"});
  EXPECT_TRUE(has_finding(only_mesh(json("darboux validate without.glb --json")), "TANGENT_MISSING"));

  // A valid file with nothing to judge.
  write_bytes(path("nothing.gltf"), R"({"asset": {"version": "2.0"}})");
  const Json nothing = json("darboux validate nothing.gltf --json", 1);
  EXPECT_EQ(nothing["verdict"], "undetermined");
  EXPECT_TRUE(nothing["files"][0]["meshes"].empty());
}

TEST_F(Cli, ThreadsDoNotChangeTheReport) {
  const std::string files = "data/torus_016.three.glb data/sphere_016.three.glb data/cylinder_016.three.glb";
  EXPECT_EQ(good("darboux validate --json " + files), good("darboux validate --json --threads 3 " + files));
}

// ---- round trips ---------------------------------------------------------------------------------------------------

TEST_F(Cli, ValidatePassesWhatMeshWrites) {
  const std::string torus = "torus:major_radius=1,minor_radius=0.4";
  for (const std::string options :
       {"", "--sign raw", "--jitter .25", "--jitter .25 --seed 9 --diagonal random"}) {
    SCOPED_TRACE(options);
    const Json written = json("darboux mesh " + torus + " --grid 32x16 -o m.glb --json " + options);
    expect_keys(written, {"file", "surface", "vertices", "triangles"});
    EXPECT_EQ(written["triangles"], 2 * 32 * 16);
    EXPECT_EQ(written["vertices"], 33 * 17);
    const Json mesh = only_mesh(json("darboux validate m.glb --json"));
    EXPECT_EQ(mesh["surface"]["name"], "torus");
    EXPECT_EQ(mesh["handedness"]["convention"], options == "--sign raw" ? "raw" : "gltf");
    for (const char* quantity : {"normal_deg", "tangent_deg", "bitangent_deg"})
      EXPECT_LT(mesh["classes"]["interior"][quantity]["max"].get<double>(), 1e-4) << quantity;
    EXPECT_LT(mesh["classes"]["seam"]["tangent_deg"]["max"].get<double>(), 1e-4);
    EXPECT_TRUE(mesh["findings"].empty()) << mesh["findings"];
  }
  for (const std::string surface : {"sphere:radius=2", "cylinder:radius=2,height=5"}) {
    good("darboux mesh " + surface + " --grid 32x16 -o m.glb");
    const Json mesh = only_mesh(json("darboux validate m.glb --json"));
    EXPECT_NEAR(mesh["surface"]["parameters"]["radius"].get<double>(), 2, 1e-6) << surface;
    EXPECT_LT(mesh["classes"]["interior"]["tangent_deg"]["max"].get<double>(), 1e-4) << surface;
  }
  // Vertices shared across the seam: uvs jump back inside triangles, which is said.
  good("darboux mesh " + torus + " --grid 32x16 -o m.glb --seam shared");
  EXPECT_TRUE(has_finding(only_mesh(json("darboux validate m.glb --json")), "HANDEDNESS_MIXED"));
  // Uvs that are an affine image of the surface's are not recognised: no verdict, and no wrong one.
  for (const std::string options : {"--shear 0.5", "--mirror"}) {
    good("darboux mesh " + torus + " --grid 32x16 -o m.glb " + options);
    EXPECT_EQ(json("darboux validate m.glb --json", 1)["verdict"], "undetermined") << options;
  }
  good("darboux mesh " + torus + " --grid 32x16 -o m.glb --no-tangents");
  EXPECT_TRUE(has_finding(only_mesh(json("darboux validate m.glb --json")), "TANGENT_MISSING"));
}

TEST_F(Cli, MeshRepeatsItself) {
  const std::string command = "darboux mesh torus --grid 16x8 --jitter .2 --diagonal random --quiet";
  EXPECT_EQ(good(command + " --seed 5 -o a.glb"), "");
  good(command + " --seed 5 -o b.glb");
  good(command + " --seed 6 -o c.glb");
  EXPECT_EQ(read_bytes(path("a.glb")), read_bytes(path("b.glb")));
  EXPECT_NE(read_bytes(path("a.glb")), read_bytes(path("c.glb")));
  EXPECT_EQ(good(command + " --seed 5 -o -"), read_bytes(path("a.glb")));
}

// three.js averages as `average` does: the statistics are the same.
TEST_F(Cli, TangentsOfTheAverageMethodMatchThreeJs) {
  const Json written = json("darboux tangents data/torus_016.none.glb -o avg.glb --method average --json");
  expect_keys(written, {"file", "method", "sign", "primitives", "skipped"});
  EXPECT_EQ(written["primitives"][0]["fallback_corners"], 0);
  const Json ours = only_mesh(json("darboux validate avg.glb --json"));
  const Json theirs = only_mesh(json("darboux validate data/torus_016.three.glb --json"));
  EXPECT_EQ(ours["handedness"]["convention"], "gltf");
  EXPECT_EQ(theirs["handedness"]["convention"], "raw");
  EXPECT_EQ(keys(ours["classes"]), keys(theirs["classes"]));
  for (const auto& [name, c] : ours["classes"].items()) {
    EXPECT_EQ(c["corners"], theirs["classes"][name]["corners"]) << name;
    for (const char* statistic : {"max", "rms", "p95"})
      EXPECT_NEAR(c["tangent_deg"][statistic].get<double>(),
                  theirs["classes"][name]["tangent_deg"][statistic].get<double>(), 1e-4)
          << name << ' ' << statistic;
  }
  good("darboux tangents data/torus_016.none.glb -o raw.glb --method average --sign raw");
  EXPECT_EQ(only_mesh(json("darboux validate raw.glb --json"))["handedness"]["convention"], "raw");
}

TEST_F(Cli, TangentsListsItsMethodsAndEachRuns) {
  const Json methods = json("darboux tangents --list --json")["methods"];
  ASSERT_GE(methods.size(), 5u);
  for (const Json& m : methods) {
    expect_keys(m, {"name", "summary"});
    good("darboux tangents data/torus_016.none.glb -o m.glb --method " + m["name"].get<std::string>());
    const Json mesh = only_mesh(Json::parse(sh("darboux validate m.glb --max-angle 180 --json").out));
    EXPECT_EQ(mesh["handedness"]["consistent"].get<double>(), 1) << m["name"];
    EXPECT_EQ(mesh["corners"], 3072) << m["name"];
    EXPECT_EQ(mesh["zero_tangents"], 0) << m["name"];
    EXPECT_EQ(mesh["non_finite"], 0) << m["name"];
  }
}

// ---- converge, at first depth --------------------------------------------------------------------------------------

TEST_F(Cli, ConvergeHasTheContractsKeys) {
  const Json document = json(
      "darboux converge --surfaces torus --methods face,average --meshes regular --resolutions 8..32 -o "
      "r.html "
      "--csv r.csv --json");
  ASSERT_FALSE(document["studies"].empty());
  for (const Json& s : document["studies"])
    expect_keys(s, {"surface", "mesh", "method", "class", "quantity", "resolutions", "h", "max_deg",
                    "rms_deg", "seconds", "order", "order_ci", "expected_order", "floor_deg", "verdict"});
  EXPECT_TRUE(fs::exists(path("r.html")));
  EXPECT_TRUE(fs::exists(path("r.csv")));
}

// ---- surroundings --------------------------------------------------------------------------------------------------

// Every file other tools made gets a verdict, and one JSON document.
TEST_F(Cli, JudgesEveryMeshOfTheEvidence) {
  const fs::path three = fs::path(DARBOUX_SHARED) / "meshes/three";
  if (!fs::is_directory(three)) GTEST_SKIP() << three << " is not there";
  std::size_t judged = 0;
  fs::create_directory_symlink(three, path("three"));
  for (const auto& entry : fs::directory_iterator(three)) {
    const std::string name = entry.path().filename().string();
    const Result r = sh("darboux validate 'three/" + name + "' --json");
    SCOPED_TRACE(name);
    EXPECT_TRUE(r.status == 0 || r.status == 1) << r.status;
    EXPECT_EQ(r.err, "");
    const Json document = Json::parse(r.out, nullptr, false);
    ASSERT_FALSE(document.is_discarded());
    const std::string verdict = document["verdict"];
    EXPECT_EQ(r.status, verdict == "pass" ? 0 : 1);
    EXPECT_TRUE(verdict == "pass" || verdict == "fail" || verdict == "undetermined") << verdict;
    const bool known =
        name.rfind("torus", 0) == 0 || name.rfind("sphere", 0) == 0 || name.rfind("cylinder", 0) == 0;
    if (known) {
      EXPECT_EQ(only_mesh(document)["surface"]["name"], name.substr(0, name.find('_')));
      const bool mikk = name.find(".mikk.") != std::string::npos,
                 three_js = name.find(".three.") != std::string::npos;
      if (mikk || three_js) {
        EXPECT_EQ(only_mesh(document)["handedness"]["convention"], mikk ? "gltf" : "raw");
        EXPECT_EQ(verdict, "pass");
      }
    }
    ++judged;
  }
  EXPECT_GT(judged, 30u);
}

// ---- surfaces from files -------------------------------------------------------------------------------------------

const char* const neck =
    "a = 2   # radius of the neck; length\nt = 2*v - 1\n"
    "x = a*cosh(t)*cos(2*pi*u)\ny = a*cosh(t)*sin(2*pi*u)\nz = a*t\n";

TEST_F(Cli, AFormulaGoesWhereverASurfaceIsAskedFor) {
  write_bytes(path("my.surface"), neck);
  const Json document = json("darboux eval formula:file=my.surface --at 0.3,0.7 --json");
  EXPECT_EQ(document["surface"],
            Json::parse(R"({"name": "formula", "file": "my.surface", "parameters": {"a": 2}})"));
  const Json sample = document["samples"][0];
  const double rho = 2 * std::cosh(0.4);
  EXPECT_NEAR(std::hypot(sample["position"][0].get<double>(), sample["position"][1].get<double>()), rho,
              1e-14);
  EXPECT_NEAR(sample["mean_curvature"], 0, 1e-14);
  EXPECT_NEAR(sample["gaussian_curvature"], -4 / std::pow(rho, 4), 1e-14);
  EXPECT_EQ(sample["status"], Json::array({"regular"}));
  EXPECT_EQ(json("darboux eval formula:file=my.surface,a=3 --at 0.3,0.5 --json")["samples"][0]["position"][2],
            0);

  const Json checks = json("darboux check formula:file=my.surface,a=3 --points 50 --json");
  EXPECT_TRUE(checks["passed"].get<bool>());
  good("darboux mesh formula:file=my.surface --grid 8x4 -o neck.glb");
  EXPECT_NE(read_bytes(path("neck.glb")).find("formula:file=my.surface,a=2"), std::string::npos);
  good(
      "darboux converge --surfaces 'formula:file=my.surface,a=3,sphere' --methods area --meshes regular "
      "--resolutions 8..32 -o report.html");

  // A comma belongs to the path unless a NAME= follows it.
  write_bytes(path("my,own.surface"), neck);
  EXPECT_EQ(
      json("darboux eval formula:file=my,own.surface,a=3 --at 0,0 --json")["surface"]["parameters"]["a"], 3);
}

TEST_F(Cli, AFormulaWithoutAValueIsNull) {
  write_bytes(path("nowhere.surface"), "x = u\ny = v\nz = log(u - 2)\n");
  const Json sample = json("darboux eval formula:file=nowhere.surface --at 0.3,0.7 --json")["samples"][0];
  EXPECT_TRUE(sample["position"][2].is_null());
  EXPECT_TRUE(sample["normal"][0].is_null());
  EXPECT_EQ(sample["status"], Json::array({"no_frame", "overflow"}));
  EXPECT_FALSE(
      json("darboux check formula:file=nowhere.surface --points 50 --json", 1)["passed"].get<bool>());
  good("darboux check formula:file=nowhere.surface --points 50", 1);
}

TEST_F(Cli, NetsAndProfilesComeFromFiles) {
  write_bytes(path("net.json"), R"({"points": [[[0,0,0],[0,1,0]], [[1,0,0],[1,1,1]]]})");
  write_bytes(path("profile.json"), R"({"points": [[0.5, 0], [1, 0.5], [0.75, 1]]})");
  const Json net = json("darboux eval bezier-patch:file=net.json --at 0.5,0.5 --json");
  EXPECT_EQ(net["surface"], Json::parse(R"({"name": "bezier-patch", "file": "net.json", "parameters": {}})"));
  EXPECT_EQ(net["samples"][0]["position"], Json::parse("[0.5, 0.5, 0.25]"));
  EXPECT_EQ(
      json("darboux eval surface-of-revolution:file=profile.json --at 0,1 --json")["samples"][0]["position"],
      Json::parse("[0.75, 0.0, 1.0]"));
  good("darboux check surface-of-revolution:file=profile.json --points 50");
  good("darboux check bezier-patch --points 50");
}

TEST_F(Cli, RefusesBadSurfaceFilesInOneLine) {
  write_bytes(path("my.surface"), neck);
  write_bytes(path("unknown.surface"), "x = u\ny = v\nz = radius\n");
  write_bytes(path("net.json"), R"({"points": [[[0,0,0],[0,1]], [[1,0,0],[1,1,1]]]})");
  for (const std::string command :
       {"darboux eval --at 0,0 ", "darboux check ", "darboux mesh --grid 2x2 -o x.glb "}) {
    refused(command + "formula", {"formula", "names no file", "formula:file=FILE"});
    refused(command + "formula:", {"formula", "no value"});
    refused(command + "formula:file=none", {"none: does not exist"});
    refused(command + "formula:file=.", {".: is a folder"});
    refused(command + "formula:a=2", {"names no file"});
    refused(command + "formula:file=my.surface,b=2", {"unknown parameter 'b'", "known are a"});
    refused(command + "formula:file=my.surface,a=two", {"formula: a", "two", "number"});
    refused(command + "formula:file=my.surface,a=2,a=3", {"'a' is given twice"});
    refused(command + "formula:file=my.surface,file=my.surface", {"'file' is given twice"});
    refused(command + "formula:file=unknown.surface",
            {"unknown.surface:3: unknown name 'radius'", "column 5"});
    refused(command + "bezier-patch:file=net.json", {"net.json: points[0][1] has 2 coordinates"});
    refused(command + "bezier-patch:file=net.json,a=2", {"unknown parameter 'a'", "file"});
    refused(command + "bezier-patch:radius=2", {"unknown parameter 'radius'", "file"});
    refused(command + "torus:file=net.json", {"unknown parameter 'file'", "major_radius"});
  }
  refused("darboux eval \"$(printf 'formula:file=a\\nb')\" --at 0,0", {"a?b: does not exist"});
  // A path that is not UTF-8 still makes valid JSON.
  json(
      "name=$(printf '\\377.surface'); cp my.surface \"$name\"; darboux eval \"formula:file=$name\" --at 0,0 "
      "--json");
}

}  // namespace
}  // namespace darboux::test
