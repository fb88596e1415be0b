// `eval`: coordinates and numbers bit for bit, columns, what it reads, formats, and that it streams.
#include <array>
#include <cstring>
#include <regex>

#include <darboux/christoffel.h>
#include <darboux/curvature.h>
#include <darboux/forms.h>
#include <darboux/shape_operator.h>

#include "cli.h"

namespace darboux::test::eval_test {
namespace {

using Points = std::vector<std::array<double, 2>>;

// Bare numbers as bytes, and back.
template <class T>
std::string packed(const Points& points) {
  std::string bytes;
  for (const auto& [u, v] : points) bytes += pack({static_cast<T>(u), static_cast<T>(v)});
  return bytes;
}
template <class T>
std::vector<T> unpacked(const std::string& bytes) {
  EXPECT_EQ(bytes.size() % sizeof(T), 0u);
  std::vector<T> values(bytes.size() / sizeof(T));
  std::memcpy(values.data(), bytes.data(), values.size() * sizeof(T));
  return values;
}

// A .npy file, put together independently of the tool's own.
std::string npy(const std::string& dictionary, const std::string& data, char version = 1) {
  const std::string text = dictionary + std::string(7, ' ') + '\n';
  std::string length = {static_cast<char>(text.size() & 0xff), static_cast<char>(text.size() >> 8)};
  if (version != 1) length += std::string(2, '\0');
  return "\x93NUMPY" + std::string{version, '\0'} + length + text + data;
}
std::string pairs_npy(std::size_t n, const std::string& data) {
  return npy("{'descr': '<f8', 'fortran_order': False, 'shape': (" + std::to_string(n) + ", 2), }", data);
}

// Singular, outside the domain, with signs of zero, and none too short for its decimal form.
const Points some_points{{0.1, 0.30000000000000004}, {-0.25, 0.5}, {-0.0, 1.0},   {0.0, -0.0},
                         {1.0 / 3, 2.0 / 3},         {5e-324, 0},  {1e22, 0.123}, {0.7, 1.5}};

std::string csv_of(const Points& points) {
  std::string text;
  char line[80];
  for (const auto& [u, v] : points) {
    std::snprintf(line, sizeof line, "%.17g,%.17g\n", u, v);
    text += line;
  }
  return text;
}

// ---- eval -------------------------------------------------------------------------------------------------

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

// Forms, derivatives of the normal, Christoffel symbols and the condition: the library's bits in every
// format, and the equations that tie them together.
TEST_F(Cli, EvalPrintsTheForms) {
  const std::string names = "dndu,dndv,first_form,second_form,christoffel,condition";
  for (const AnySurface& surface : all_surfaces()) {
    const std::string name(surface.info().name);
    SCOPED_TRACE(name);
    const std::string eval = "darboux eval " + name + " --at 0.37,0.41 ";
    const Json s = json(eval + "--json")["samples"][0];
    const Sample<double> at = surface.sample(0.37, 0.41);
    const auto d = normal_derivatives(surface, at.u, at.v, at.jet, at.frame);
    const auto I = first_form(at.jet);
    const auto II = second_form(surface, at.u, at.v, at.jet, at.frame);
    const auto g = christoffel(surface, at.u, at.v, at.jet, at.frame);
    EXPECT_EQ(s["dndu"], Json::array({d.dndu.x, d.dndu.y, d.dndu.z}));
    EXPECT_EQ(s["dndv"], Json::array({d.dndv.x, d.dndv.y, d.dndv.z}));
    EXPECT_EQ(s["first_form"], Json::array({I.E, I.F, I.G}));
    EXPECT_EQ(s["second_form"], Json::array({II.L, II.M, II.N}));
    EXPECT_EQ(s["christoffel"],
              Json::array({Json::array({g.u[0], g.u[1], g.u[2]}), Json::array({g.v[0], g.v[1], g.v[2]})}));
    const double sine = norm(cross(unit(at.jet.dpdu), unit(at.jet.dpdv)));
    EXPECT_NEAR(s["condition"].get<double>() * sine, 1, 1e-12);
    // The same in CSV and as bare numbers.
    const auto csv = lines(good(eval + "--format csv --attributes " + names));
    const auto header = fields(csv[0]), row = fields(csv[1]);
    ASSERT_EQ(header,
              fields("u,v,dndu_x,dndu_y,dndu_z,dndv_x,dndv_y,dndv_z,first_form_E,first_form_F,first_form_G,"
                     "second_form_L,second_form_M,second_form_N,christoffel_u_uu,christoffel_u_uv,"
                     "christoffel_u_vv,christoffel_v_uu,christoffel_v_uv,christoffel_v_vv,condition,status"));
    const std::string numbers = good(eval + "--format f64 --attributes " + names);
    ASSERT_EQ(numbers.size(), 19 * sizeof(double));
    std::size_t k = 0;
    for (const Json& list : {s["dndu"], s["dndv"], s["first_form"], s["second_form"], s["christoffel"][0],
                             s["christoffel"][1], Json::array({s["condition"]})})
      for (const Json& x : list) {
        double bare = 0;
        std::memcpy(&bare, numbers.data() + k * sizeof(double), sizeof bare);
        EXPECT_TRUE(same_bits(bare, x)) << k;
        EXPECT_TRUE(same_bits(to_double(row[2 + k]), x)) << k;
        ++k;
      }
    // Weingarten: L = -dndu · dpdu, M = -dndu · dpdv, N = -dndv · dpdv; and n turns within the tangent
    // plane.
    const double size = norm(at.jet.d2pdu2) + norm(at.jet.d2pduv) + norm(at.jet.d2pdv2);
    EXPECT_NEAR(II.L, -dot(d.dndu, at.jet.dpdu), 1e-12 * size);
    EXPECT_NEAR(II.M, -dot(d.dndu, at.jet.dpdv), 1e-12 * size);
    EXPECT_NEAR(II.N, -dot(d.dndv, at.jet.dpdv), 1e-12 * size);
    EXPECT_NEAR(dot(d.dndu, at.frame.n), 0, 1e-12 * norm(d.dndu));
  }
  // CSV without --attributes has the columns that it always had.
  EXPECT_EQ(good("darboux eval torus --at 0.3,0.7 --format csv").find("first_form"), std::string::npos);
  EXPECT_EQ(json("darboux eval sphere --at 0.2,0 --json")["samples"][0]["condition"], nullptr);
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
  // The status of a CSV row is its last field, bits joined by '|'; umbilic only where directions are asked
  // for.
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

// On a terminal, where nothing is known of the rest, seconds count; the line is cleared at the end.
TEST_F(Cli, ProgressIsDrawnWhileACommandWaits) {
  if (sh("script --version").status != 0) GTEST_SKIP() << "SKIPPED: script is not there, no terminal is made";
  const auto on_a_terminal = [&](const std::string& options) {
    write_bytes(path("command"),
                "(sleep 3; echo 0.25,0.5) | darboux eval torus --input - --format csv -o o.csv" + options);
    return good("script -qec 'bash command' /dev/null </dev/null");
  };
  const std::string drawn = on_a_terminal("");
  EXPECT_NE(drawn.find("\reval [....................."), std::string::npos) << drawn;
  EXPECT_TRUE(std::regex_search(drawn, std::regex(" %, [1-9] s"))) << drawn;
  EXPECT_NE(drawn.find("\r\x1b[K"), std::string::npos) << drawn;
  EXPECT_EQ(on_a_terminal(" --quiet").find("eval ["), std::string::npos);
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
  for (const std::string text :
       {"u,v\n0.25,0.5\n", "u, v\r\n0.25, 0.5\r\n", "\xEF\xBB\xBFu,v\n0.25,0.5\n",
        "# points\n\nname,v,u\nx,0.5,0.25\n", "0.25 0.5\n", "0.25\t0.5\n", "u;v\n0.25;0.5\n",
        "u v\n 0.25   0.5 \n", "\"u\",\"v\"\n\"0.25\",\"0.5\"\n"}) {
    write_bytes(path("headed.csv"), text);
    EXPECT_EQ(good("darboux eval torus --input headed.csv --format csv"), plain) << text;
  }
  write_bytes(path("commas.csv"), "u;v\n0,25;0,5\n");
  refused("darboux eval torus --input commas.csv", {"'0,25;0,5', with decimal commas; write decimal points"});
}

TEST_F(Cli, JsonFlagAndFormatAreTheSame) {
  EXPECT_EQ(good("darboux eval torus --at 0.1,0.2 --json"),
            good("darboux eval torus --at 0.1,0.2 --format json"));
}

// ---- formats ----------------------------------------------------------------------------------------------

// What --at says of the points, every file of them gives, in every format: the library's own bits.
TEST_F(Cli, EvalGivesTheSameBitsFromEveryFormatIntoEvery) {
  const std::string eval = "darboux eval sphere:radius=1.7 --attributes tangent4,position,mean_curvature ";
  std::vector<double> expected;
  const AnySurface sphere = make_surface("sphere:radius=1.7");
  std::string at;
  for (const auto& [u, v] : some_points) {
    const Sample<double> s = sphere.sample(u, v);
    const Vec4<double> t = tangent4(s.frame);
    expected.insert(expected.end(), {t.x, t.y, t.z, t.w, s.jet.position.x, s.jet.position.y, s.jet.position.z,
                                     curvature(sphere, u, v, s.jet, s.frame).mean});
    at += " --at " + csv_of({{u, v}});
    at.pop_back();
  }
  const std::string document = good(eval + at + " --json"), table = good(eval + at + " --format csv");
  write_bytes(path("in.csv"), csv_of(some_points));
  write_bytes(path("frames.csv"), table);
  write_bytes(path("in.f64"), packed<double>(some_points));
  write_bytes(path("in.npy"), pairs_npy(some_points.size(), packed<double>(some_points)));
  write_bytes(path("in.json"), document);
  Json array = Json::array();
  for (const auto& [u, v] : some_points)
    array.push_back({{"x", {1e300, nullptr, {{"u", 2}}, "u"}}, {"v", v}, {"u", u}});
  write_bytes(path("array.json"), array.dump());
  for (const std::string name : {"in.csv", "frames.csv", "in.f64", "in.npy", "in.json", "array.json"}) {
    SCOPED_TRACE(name);
    const std::string input = eval + "--input " + name + ' ';
    EXPECT_EQ(good(input + "--json"), document);
    EXPECT_EQ(good(input + "--format csv"), table);
    const std::string format = name.substr(name.find('.') + 1);
    EXPECT_EQ(good("cat " + name + " | " + eval + "--input - --input-format " + format + " --json"),
              document);
    const auto numbers = unpacked<double>(good(input + "--format f64"));
    ASSERT_EQ(numbers.size(), expected.size());
    for (std::size_t i = 0; i < numbers.size(); ++i)
      EXPECT_TRUE(same_bits(numbers[i], expected[i])) << i << ": " << numbers[i] << ' ' << expected[i];
  }
}

TEST_F(Cli, EvalWritesNpyWithTheNumberOfRowsAlsoFromAPipe) {
  write_bytes(path("in.csv"), csv_of(some_points));
  write_bytes(path("in.json"), good("darboux eval torus --input in.csv --json"));
  const std::string eval = "darboux eval torus --attributes normal,handedness,principal_curvatures ";
  const std::string numbers = good(eval + "--input in.csv --format f64");
  EXPECT_EQ(numbers.size(), some_points.size() * 6 * 8);
  const std::string file = good(eval + "--input in.csv --format npy");
  EXPECT_EQ(file.substr(0, 10), std::string("\x93NUMPY\x01\x00\x76\x00", 10));
  EXPECT_EQ(file.substr(10, 118),
            "{'descr': '<f8', 'fortran_order': False, 'shape': (8, 6), }" + std::string(58, ' ') + "\n");
  EXPECT_EQ(file.substr(128), numbers);
  good(eval + "--input in.csv --format npy -o out.npy");
  EXPECT_EQ(read_bytes(path("out.npy")), file);
  EXPECT_EQ(good("cat in.csv | " + eval + "--input - --format npy | cat"), file);
  EXPECT_EQ(good("cat in.json | " + eval + "--input - --input-format json --format npy"), file);
  // Two numbers per row are points.
  good("darboux eval torus --grid 7x3 --attributes principal_curvatures --format npy -o uv.npy");
  good("darboux eval torus --grid 7x3 --attributes principal_curvatures --format f64 -o uv.f64");
  EXPECT_EQ(good(eval + "--input uv.npy --format csv"), good(eval + "--input uv.f64 --format csv"));
}

TEST_F(Cli, EvalStoresDoublesAsF32) {
  const AnySurface torus = make_surface("torus:major_radius=1.1,minor_radius=0.3");
  const std::string eval = "darboux eval torus:major_radius=1.1,minor_radius=0.3 --attributes normal,dpdu ";
  bool rounding_shows = false;
  write_bytes(path("in.csv"), csv_of(some_points));
  write_bytes(path("in.f32"), packed<float>(some_points));
  for (const std::string name : {"in.csv", "in.f32"}) {
    std::vector<float> expected;
    for (const auto& [u, v] : some_points) {
      const float u_stored = static_cast<float>(u), v_stored = static_cast<float>(v);
      const bool stored = name == "in.f32";
      const Sample<double> s = torus.sample(stored ? u_stored : u, stored ? v_stored : v);
      const Vec3<double>&n = s.frame.n, &d = s.jet.dpdu;
      for (const double x : {n.x, n.y, n.z, d.x, d.y, d.z}) expected.push_back(static_cast<float>(x));
      rounding_shows |= expected[expected.size() - 3] != torus.sample_in_float(u_stored, v_stored).jet.dpdu.x;
    }
    const auto numbers = unpacked<float>(good(eval + "--format f32 --input " + name));
    ASSERT_EQ(numbers.size(), expected.size());
    for (std::size_t i = 0; i < numbers.size(); ++i)
      EXPECT_EQ(std::bit_cast<std::uint32_t>(numbers[i]), std::bit_cast<std::uint32_t>(expected[i]))
          << name << ' ' << i << ": " << numbers[i] << ' ' << expected[i];
  }
  EXPECT_TRUE(rounding_shows) << "formulas run in float would pass this test";
  // A file of floats, read as it is and put to double precision.
  const auto csv = lines(good("darboux eval torus --input in.f32 --attributes position --format csv"));
  EXPECT_TRUE(same_bits(to_double(fields(csv[1])[0]), static_cast<double>(0.1f))) << csv[1];
  write_bytes(path("in.npy"), npy("{\"shape\": (8, 2), \"fortran_order\": False, \"descr\": \"<f4\"}",
                                  packed<float>(some_points), 2));
  EXPECT_EQ(lines(good("darboux eval torus --input in.npy --attributes position --format csv")), csv);
}

TEST_F(Cli, EvalOfNoPointsWritesWhatComesBeforeThem) {
  write_bytes(path("none.csv"), "");
  write_bytes(path("headed.csv"), "u,v\n");
  write_bytes(path("none.f32"), "");
  write_bytes(path("none.f64"), "");
  write_bytes(path("none.npy"), pairs_npy(0, ""));
  write_bytes(path("none.json"), "[]");
  write_bytes(path("document.json"), R"({"surface": {"u": 1}, "samples": []})");
  for (const std::string name :
       {"none.csv", "headed.csv", "none.f32", "none.f64", "none.npy", "none.json", "document.json"}) {
    const std::string eval = "darboux eval torus --attributes normal --input " + name + " --format ";
    EXPECT_EQ(good(eval + "csv"), "u,v,normal_x,normal_y,normal_z,status\n") << name;
    EXPECT_EQ(json(eval + "json")["samples"], Json::array()) << name;
    EXPECT_EQ(good(eval + "table") + good(eval + "f32") + good(eval + "f64"), "") << name;
    const std::string file = good(eval + "npy");
    EXPECT_EQ(file.size(), 128u) << name;
    EXPECT_NE(file.find("'shape': (0, 3)"), std::string::npos) << name;
  }
}

TEST_F(Cli, EvalKeepsRowsThatAreNoNumbers) {
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  constexpr double infinity = std::numeric_limits<double>::infinity();
  const Points points{{0.25, 0.5}, {nan, 0.5}, {0.25, -infinity}, {0.5, 0.5}};
  write_bytes(path("in.csv"), csv_of(points));
  write_bytes(path("in.f64"), packed<double>(points));
  write_bytes(path("in.f32"), packed<float>(points));
  const std::string plain = good("darboux eval torus --at 0.25,0.5 --at 0.5,0.5 --format csv");
  for (const std::string name : {"in.csv", "in.f64", "in.f32"}) {
    const auto csv = lines(good("darboux eval torus --format csv --input " + name));
    ASSERT_EQ(csv.size(), 5u);
    EXPECT_EQ(csv[0] + '\n' + csv[1] + '\n' + csv[4] + '\n', plain);
    EXPECT_EQ(fields(csv[2])[0], "nan");
    EXPECT_EQ(fields(csv[3])[1], "-inf");
    for (const std::size_t row : {2u, 3u}) {
      EXPECT_EQ(fields(csv[row]).back(), "non_finite_input");
      EXPECT_EQ(fields(csv[row])[20], "nan") << csv[0];
    }
    EXPECT_EQ(good("darboux eval torus --format f64 --input " + name).size(), 4 * 42 * 8u);
  }
  // JSON says null for both, and null is read as NaN.
  good("darboux eval torus --json --input in.f64 -o in.json");
  const Json samples = json("darboux eval torus --json --input in.json")["samples"];
  ASSERT_EQ(samples.size(), 4u);
  EXPECT_EQ(samples[2]["u"], 0.25);
  EXPECT_EQ(samples[2]["v"], nullptr);
  EXPECT_EQ(samples[2]["status"], Json::array({"non_finite_input"}));
}

// The status of text is that of all that is known of the point, whatever is asked for: here d2pdu2 alone
// overflows.
TEST_F(Cli, EvalFlagsOverflowOfWhatIsNotAskedFor) {
  const std::string eval = "darboux eval sphere:radius=1e307 --at 0.1,0.5 --format csv --attributes ";
  EXPECT_EQ(fields(lines(good(eval + "d2pdu2"))[1])[2], "-inf");
  EXPECT_EQ(good(eval + "dpdu,d2pduv,d2pdv2").find("inf"), std::string::npos);
  EXPECT_EQ(fields(lines(good(eval + "normal"))[1]).back(), "overflow");
}

TEST_F(Cli, EvalReadsWholeNumbersInJson) {
  write_bytes(path("in.json"), R"([{"u": -0, "v": 0}, {"u": 1, "v": -2}])");
  const auto csv = lines(good("darboux eval torus --input in.json --attributes handedness --format csv"));
  EXPECT_EQ(csv[1].substr(0, 5), "-0,0,");
  EXPECT_EQ(csv[2].substr(0, 5), "1,-2,");
}

TEST_F(Cli, EvalRefusesInputsThatAreNotWhole) {
  const std::string eval = "darboux eval torus --format csv -o out.csv --input ";
  const std::string data = packed<double>({{0.1, 0.2}, {0.3, 0.4}});
  const auto refuse_file = [&](const std::string& name, const std::string& bytes,
                               std::vector<std::string> parts) {
    write_bytes(path(name), bytes);
    parts.push_back(name);
    parts.emplace_back("expected");
    refused(eval + name, parts);
    parts[parts.size() - 2] = "standard input";
    refused("cat " + name + " | " + eval + "- --input-format " + name.substr(name.find('.') + 1), parts);
    EXPECT_FALSE(fs::exists(path("out.csv")));
  };
  refuse_file("cut.f64", data.substr(0, 24), {"24 bytes", "16"});
  refuse_file("cut.f64", data.substr(0, 31), {"31 bytes", "16"});
  refuse_file("cut.f32", data.substr(0, 12), {"12 bytes", "8"});
  refuse_file("cut.npy", pairs_npy(2, data.substr(0, 24)), {"24 bytes", "32"});
  refuse_file("cut.npy", pairs_npy(2, data.substr(0, 16)), {"16 bytes", "32"});
  refuse_file("long.npy", pairs_npy(1, data), {"32 bytes", "16"});

  const auto header = [&](const std::string& name, const std::string& dictionary, char version,
                          const std::string& part) {
    refuse_file(name + ".npy", npy(dictionary, data, version), {"header", part, "'<f8'", "(n, 2)"});
  };
  const std::string begin = "{'descr': '<f8', 'fortran_order': False, 'shape': ";
  header("version", begin + "(2, 2), }", 3, "version 3");
  header("shape", begin + "(4,), }", 1, "(4,)");
  header("shape", begin + "(2, 3), }", 1, "(2, 3)");
  header("shape", begin + "(1, 2, 2), }", 1, "(1, 2, 2)");
  header("shape", begin + "(-2, 2), }", 1, "dictionary");
  header("huge", begin + "(2305843009213693952, 2), }", 1, "2305843009213693952");
  header("huge", begin + "(99999999999999999999, 2), }", 1, "dictionary");
  header("order", "{'descr': '<f8', 'fortran_order': True, 'shape': (2, 2), }", 1, "Fortran");
  header("big", "{'descr': '>f8', 'fortran_order': False, 'shape': (2, 2), }", 1, ">f8");
  header("integers", "{'descr': '<i8', 'fortran_order': False, 'shape': (2, 2), }", 1, "<i8");
  header("struct", "{'descr': [('u', '<f8')], 'fortran_order': False, 'shape': (2, 2), }", 1, "dictionary");
  header("missing", "{'descr': '<f8', 'shape': (2, 2), }", 1, "dictionary");
  header("words", "hello", 1, "dictionary");
  header("open", begin + "(2, 2), ", 1, "dictionary");
  header("more", begin + "(2, 2), } 1", 1, "dictionary");
  refuse_file("text.npy", "u,v\n0.1,0.2\n", {"header", "begin"});
  refuse_file("empty.npy", "", {"header", "begin"});
  refuse_file("cut_header.npy", pairs_npy(2, data).substr(0, 30), {"header", "cut off"});
  refuse_file("cut_length.npy", std::string("\x93NUMPY\x02\x00\x10\x00", 10), {"header", "cut off"});
  refuse_file("large.npy", std::string("\x93NUMPY\x02\x00\xff\xff\xff\xff", 12), {"header", "4294967295"});

  refuse_file("empty.json", "", {"JSON"});
  refuse_file("cut.json", R"([{"u": 0, "v": 0}, {"u": 0,)", {"JSON"});
  refuse_file("two.json", "[] []", {"JSON"});
  refuse_file("huge.json", R"([{"u": 1e999, "v": 0}])", {"1e999"});
  refuse_file("object.json", R"({"surface": {}})", {"no samples"});
  refuse_file("number.json", "3", {"no samples"});
  refuse_file("nested.json", R"({"a": {"samples": [{"u": 0, "v": 0}]}})", {"no samples"});
  refuse_file("numbers.json", R"([{"u": 0, "v": 0}, 7])", {"sample 1", "no object"});
  refuse_file("arrays.json", "[[0, 0]]", {"sample 0", "no object"});
  refuse_file("missing.json", R"([{"u": 0, "v": 0}, {"u": 0}])", {"sample 1", "one without u or v"});
  refuse_file("before.json", R"([{"v": 0, "x": {"u": 0}}])", {"sample 0", "one without u or v"});
  for (const std::string value : {"\"0\"", "true", "[0]", "{}"})
    refuse_file("value.json", "[{\"v\": 0, \"u\": " + value + "}]", {"sample 0", "no number"});
  // A row that is wrong after thousands that are right: nothing is left all the same.
  std::string rows;
  for (int i = 0; i < 20000; ++i) rows += "0.25,0.5\n";
  refuse_file("late.csv", rows + "0.25\n", {":20001"});
}

TEST_F(Cli, EvalRefusesFormatsItDoesNotKnow) {
  write_bytes(path("uv.txt"), "0.25,0.5\n");
  write_bytes(path("uv"), "0.25,0.5\n");
  refused("darboux eval torus --input uv", {"uv", ".csv", ".json", ".f32", ".f64", ".npy", "--input-format"});
  const std::string expected = good("darboux eval torus --at 0.25,0.5");
  good("cp uv.txt uv.tsv");
  for (const char* input : {"uv --input-format csv", "uv.txt", "uv.tsv", "uv.txt --input-format csv"})
    EXPECT_EQ(good(std::string("darboux eval torus --input ") + input), expected);
  good("cp uv.txt UV.CSV");
  EXPECT_EQ(good("darboux eval torus --input UV.CSV"), expected);
  refused("darboux eval torus --input uv --input-format table", {"--input-format", "csv", "json", "npy"});
  refused("darboux eval torus --at 0,0 --input-format csv", {"--input-format", "--input"});
  refused("darboux eval torus --at 0,0 --format csv -o a.npy",
          {"-o: expected a name that ends in .csv", "'a.npy'"});
  refused("darboux eval torus --at 0,0 --json --format csv",
          {"--json: expected no --format but json beside it"});
  refused("darboux eval torus --at 0,0 --format f16", {"--format", "f32", "f64", "npy"});
  for (const std::string format : {"csv", "json", "f32", "f64", "npy"}) {
    refused("darboux eval torus --input missing --input-format " + format, {"missing"});
    refused("darboux eval torus --input data --input-format " + format, {"data", "folder"});
  }
}

// ---- many points ------------------------------------------------------------------------------------------

// Rows that go to the batch in pieces give what narrow grids give at the same u.
TEST_F(Cli, EvalOfAWideGridIsThatOfANarrowOne) {
  for (const std::string format : {"f64", "f32"}) {
    const std::string eval = "darboux eval torus --attributes position,tangent4 --format " + format;
    const std::string narrow = good(eval + " --grid 4096x2"), wide = good(eval + " --grid 131072x2");
    const std::size_t row = 7 * (format == "f64" ? 8 : 4), step = 32;
    ASSERT_EQ(narrow.size(), 4097 * 3 * row);
    ASSERT_EQ(wide.size(), 131073 * 3 * row);
    for (std::size_t j = 0; j < 3; ++j)
      for (std::size_t i = 0; i <= 4096; ++i)
        ASSERT_EQ(narrow.substr((j * 4097 + i) * row, row), wide.substr((j * 131073 + step * i) * row, row))
            << format << ' ' << i << ' ' << j;
  }
  const auto csv = lines(good("darboux eval torus --grid 70000x1 --attributes handedness --format csv"));
  ASSERT_EQ(csv.size(), 1 + 2 * 70001u);
  for (const std::size_t i : {0u, 1u, 65535u, 65536u, 65537u, 70000u}) {
    EXPECT_EQ(to_double(fields(csv[1 + i])[0]), static_cast<double>(i) / 70000) << i;
    EXPECT_EQ(to_double(fields(csv[1 + i])[1]), 0) << i;
    EXPECT_EQ(to_double(fields(csv[70002 + i])[0]), static_cast<double>(i) / 70000) << i;
    EXPECT_EQ(to_double(fields(csv[70002 + i])[1]), 1) << i;
  }
}

// More points than numbers of 32 bits count: the header's are right, and the work begins at once.
TEST_F(Cli, EvalCountsPointsIn64Bits) {
  const std::string header =
      sh("darboux eval torus --grid 1000000000x1000000000 --attributes handedness --format npy | head -c 128")
          .out;
  EXPECT_NE(header.find("'shape': (1000000002000000001, 1)"), std::string::npos) << header;
}

TEST_F(Cli, EvalDoesNotDependOnThreads) {
  // The sphere's poles and 300 x 100 cells: several blocks, statuses among them.
  for (const std::string format : {"csv", "json", "table", "f32", "f64", "npy"}) {
    const std::string eval =
        "darboux eval sphere --grid 300x100 --attributes normal,mean_curvature --format ";
    const std::string one = good(eval + format + " --threads 1");
    ASSERT_GT(one.size(), 30000 * 4 * 4u) << format;
    for (const std::string threads : {"2", "3", "64"})
      EXPECT_TRUE(good(eval + format + " --threads " + threads) == one) << format << ' ' << threads;
  }
  good("darboux eval torus --grid 200x150 --format csv -o in.csv");
  const std::string eval = "darboux eval sphere --attributes normal --input in.csv --format ";
  for (const std::string format : {"csv", "npy"})
    EXPECT_TRUE(good(eval + format) == good(eval + format + " --threads 2")) << format;
}

// The most memory the tool has held, in KiB, when it has read `rows` rows from a pipe that is still open.
class StreamedMemory : public Cli {
 protected:
  long memory_after(std::size_t rows, const std::string& format) const {
    std::string text;
    if (format == "csv")
      for (std::size_t i = 0; i < rows; ++i) text += "0." + std::to_string(100000 + i % 900000) + ",0.5\n";
    else
      text.assign(rows * 16, '\0');
    write_bytes(path("in"), text);
    // The pipe is opened for both ways so that nobody waits for a tool that has ended.
    const std::string out = good(
        "rm -f pipe && mkfifo pipe && exec 3<>pipe && { darboux eval torus --input pipe --input-format " +
        format +
        " --attributes position,normal --format f64 -o out.f64 3>&- & } && tool=$! && timeout 300 cat in >&3 "
        "&&"
        " sed -n 's/VmHWM:[^0-9]*\\([0-9]*\\) kB/\\1/p' /proc/$tool/status && exec 3>&- && wait $tool");
    EXPECT_EQ(fs::file_size(path("out.f64")), rows * 6 * 8);
    return std::strtol(out.c_str(), nullptr, 10);
  }
};

TEST_F(StreamedMemory, DoesNotGrowWithTheRows) {
  for (const std::string format : {"csv", "f64"}) {
    const long few = memory_after(50000, format), many = memory_after(2000000, format);
    EXPECT_GT(few, 1000) << format;
    // The points alone would take 30 MiB, the results 90 MiB.
    EXPECT_LT(many, few + 16 * 1024) << format;
  }
}

}  // namespace
}  // namespace darboux::test::eval_test
