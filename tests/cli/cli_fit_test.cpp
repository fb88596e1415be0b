// `fit`: the contract's keys, exit statuses, frames, refusals. What is found is tested with the library.

#include <array>

#include "cli.h"
#include "torus_points.h"

namespace darboux::test {
namespace {

const std::string torus = "data/torus_points.xyz";

// Everything but the time.
Json without_seconds(Json document) {
  document.erase("seconds");
  return document;
}

TEST_F(Cli, FitFindsTheTorusAndPrintsTheContractsKeys) {
  const Json fit = json("darboux fit " + torus + " --json");
  expect_keys(fit, {"surface", "usable", "reason", "sigma", "inliers", "outliers", "standard_errors",
                    "frame_uncertainty_deg", "candidates", "iterations", "seconds", "ignored", "rms", "seed",
                    "file"});
  EXPECT_EQ(fit["usable"], true);
  ASSERT_EQ(fit["surface"]["name"], "torus");
  expect_keys(fit["surface"], {"name", "parameters", "placement"});
  expect_keys(fit["standard_errors"], {"major_radius", "minor_radius", "axis_deg", "centre"});
  // 5 standard errors: exceeded by chance in 6e-7 of all files, and this is one file.
  const double major = fit["surface"]["parameters"]["major_radius"],
               minor = fit["surface"]["parameters"]["minor_radius"];
  EXPECT_NEAR(major, 2, 5 * fit["standard_errors"]["major_radius"].get<double>());
  EXPECT_NEAR(minor, 0.5, 5 * fit["standard_errors"]["minor_radius"].get<double>());
  const Json placement = fit["surface"]["placement"];
  ASSERT_EQ(placement.size(), 16u);
  double off = 0, along = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    off += std::pow(placement[12 + k].get<double>() - std::array{1.0, -2.0, 0.5}[k], 2);
    along += placement[8 + k].get<double>() * std::array{0.48, 0.6, 0.64}[k];
  }
  EXPECT_LT(std::sqrt(off), 5 * std::sqrt(3) * fit["standard_errors"]["centre"].get<double>());
  EXPECT_GT(std::fabs(along), std::cos(0.01)) << "more than 5 times 0.02 / (2 sqrt(270 / 2)) radians";
  EXPECT_EQ(placement[15], 1);
  // 270 points were made on the torus, and some of the other 30 lie near it by chance.
  EXPECT_GE(fit["inliers"], 260);
  EXPECT_LE(fit["inliers"], 280);
  EXPECT_EQ(fit["inliers"].get<int>() + fit["outliers"].get<int>(), 300);
  EXPECT_EQ(fit["ignored"], 0);
  EXPECT_EQ(fit["seed"], 1);
  // Its standard error is 0.02 / sqrt(2 * 270) = 0.0009.
  EXPECT_NEAR(fit["sigma"], 0.02, 5 * 0.0009);
  for (const char* direction : {"normal", "tangent"}) {
    const Json spread = fit["frame_uncertainty_deg"][direction];
    EXPECT_GT(spread["rms"], 0);
    ASSERT_TRUE(spread["max"].is_number()) << "a torus has no poles";
    EXPECT_GE(spread["max"].get<double>(), spread["rms"].get<double>() * (1 - 1e-12));
    EXPECT_EQ(spread["infinite"], 0);
  }
  ASSERT_GE(fit["candidates"].size(), 1u);
  EXPECT_EQ(fit["candidates"][0]["name"], "torus");
  expect_keys(fit["candidates"][0], {"name", "bic", "rms"});
}

TEST_F(Cli, FitGivesTheSameBitsForTheSameSeed) {
  const auto run = [&](const std::string& options) {
    return without_seconds(json("darboux fit " + torus + " --json --frames frames.csv --seed " + options));
  };
  const Json first = run("7");
  const std::string frames = read_bytes(path("frames.csv"));
  EXPECT_EQ(first["seed"], 7);
  EXPECT_EQ(run("7").dump(), first.dump());
  EXPECT_EQ(read_bytes(path("frames.csv")), frames);
  EXPECT_EQ(run("7 --threads 2").dump(), first.dump());
}

TEST_F(Cli, FitWritesAFrameForEachPoint) {
  good("cp " + torus + " points.xyz; sed -i '5s/.*/nan 0 0/' points.xyz");
  const Result r = sh("darboux fit points.xyz --frames frames.csv --json");
  ASSERT_EQ(r.status, 0) << r.err;
  expect_one_line(r.err);
  EXPECT_NE(r.err.find("points.xyz: 1 point is not finite, ignored; the first at line 5"), std::string::npos)
      << r.err;
  EXPECT_EQ(sh("darboux fit points.xyz --json --quiet").err, "");
  const Json fit = Json::parse(r.out);
  EXPECT_EQ(fit["ignored"], 1);
  const auto rows = lines(read_bytes(path("frames.csv")));
  ASSERT_EQ(rows.size(), 301u);
  EXPECT_EQ(
      rows[0],
      "index,u,v,position_x,position_y,position_z,tangent_x,tangent_y,tangent_z,bitangent_x,bitangent_y,"
      "bitangent_z,normal_x,normal_y,normal_z,normal_deg,tangent_deg,inlier,distance,status");
  const auto points = torus_points();
  std::size_t inliers = 0;
  double squares = 0;
  for (std::size_t i = 0; i < 300; ++i) {
    SCOPED_TRACE(rows[i + 1]);
    const auto f = fields(rows[i + 1]);
    ASSERT_EQ(f.size(), 20u);
    EXPECT_EQ(f[0], std::to_string(i));
    const auto vec = [&](std::size_t k) {
      return Vec3<double>{to_double(f[k]), to_double(f[k + 1]), to_double(f[k + 2])};
    };
    if (i == 2) {  // line 5, after two comments
      EXPECT_EQ(f[17], "0");
      EXPECT_EQ(f[19], "non_finite_input");
      continue;
    }
    const Vec3<double> position = vec(3), t = vec(6), b = vec(9), n = vec(12), off = points[i] - position;
    // Right-handed and orthonormal to rounding; the point lies along the normal, to the 6 decimals of the file.
    EXPECT_NEAR(dot(cross(t, b), n), 1, 1e-12);
    EXPECT_NEAR(dot(off, t), 0, 2e-6);
    EXPECT_NEAR(dot(off, b), 0, 2e-6);
    EXPECT_NEAR(dot(off, n), to_double(f[18]), 2e-6);
    EXPECT_GT(to_double(f[15]), 0);
    if (f[17] != "1") continue;
    ++inliers;
    squares += std::pow(to_double(f[15]), 2);
  }
  EXPECT_EQ(inliers, fit["inliers"]);
  EXPECT_NEAR(std::sqrt(squares / static_cast<double>(inliers)),
              fit["frame_uncertainty_deg"]["normal"]["rms"], 1e-12);
}

TEST_F(Cli, FitSaysWhyItIsNotUsable) {
  good("printf '0 0 0\\n1 0 0\\n0 1 0\\n' > three.xyz; echo old > frames.csv");
  const Json fit = json("darboux fit three.xyz --json", 1);
  EXPECT_EQ(fit["usable"], false);
  EXPECT_TRUE(fit["surface"].is_null());
  EXPECT_TRUE(fit["frame_uncertainty_deg"].is_null());
  EXPECT_FALSE(fit["reason"].get<std::string>().empty());
  EXPECT_NE(good("darboux fit three.xyz", 1).find("not usable"), std::string::npos);
  const Result r = sh("darboux fit three.xyz --frames frames.csv");
  EXPECT_EQ(r.status, 1);
  expect_one_line(r.err);
  EXPECT_NE(r.err.find("frames.csv is not written"), std::string::npos) << r.err;
  EXPECT_EQ(read_bytes(path("frames.csv")), "old\n");
}

// Nodes of a grid with their uvs, as `eval` writes them.
TEST_F(Cli, FitReadsWhatEvalWrites) {
  good("darboux eval sphere:radius=3 --grid 12x8 --attributes position --format csv -o grid.csv");
  const Json fit = json("darboux fit grid.csv --with-uv --json");
  ASSERT_EQ(fit["surface"]["name"], "sphere");
  // Exact points: what is left is rounding.
  EXPECT_NEAR(fit["surface"]["parameters"]["radius"], 3, 1e-9);
}

TEST_F(Cli, FitPrintsForPeople) {
  const std::string text = good("darboux fit " + torus);
  EXPECT_EQ(text.rfind(torus + ": torus\n", 0), 0u) << text;
  for (const char* word : {"major_radius", "minor_radius", "±", "centre", "axis", "outliers", "noise",
                           "normals", "tangents", "tried", "bic"})
    EXPECT_NE(text.find(word), std::string::npos) << word << " in " << text;
}

TEST_F(Cli, FitRefusesWrongUsage) {
  refused("darboux fit", {"FILE"});
  refused("darboux fit " + torus + " " + torus, {torus});
  refused("darboux fit " + torus + " --surface torus:major_radius=2",
          {"--surface", "finds the parameters", "torus"});
  refused("darboux fit " + torus + " --surface potato", {"potato", "auto", "cylinder"});
  refused("darboux fit " + torus + " --surface enneper", {"enneper", "without uvs"});
  for (const std::string noise : {"0", "-1", "nan", "inf", "x"})
    refused("darboux fit " + torus + " --noise=" + noise, {"--noise", "permitted"});
  refused("darboux fit " + torus + " --seed -1", {"--seed"});
  refused("darboux fit " + torus + " --with-uv", {torus, "uvs"});
  refused("darboux fit " + torus + " --frames -", {"--frames"});
  for (const std::string out : {"missing/out.csv", "data"})
    refused("darboux fit " + torus + " --frames " + out, {out});
  refused("darboux fit missing.xyz", {"missing.xyz"});
  refused("darboux fit data", {"data", "folder"});
  good("printf '1 2 3\\n4 5\\n' > bad.xyz; printf '1 2 3\\n' > a.las; mkfifo pipe.xyz");
  refused("darboux fit bad.xyz --frames frames.csv", {"bad.xyz:2: ", "2 columns"});
  refused("darboux fit a.las", {"a.las", ".ply"});
  refused("darboux fit pipe.xyz", {"pipe"});
  EXPECT_FALSE(fs::exists(path("frames.csv")));
}

}  // namespace
}  // namespace darboux::test
