// `eval`: coordinates and numbers bit for bit, columns, what it reads.
#include "cli.h"

namespace darboux::test {
namespace {

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

}  // namespace
}  // namespace darboux::test
