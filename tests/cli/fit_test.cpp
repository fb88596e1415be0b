// `fit`: the contract's keys, exit statuses, frames, refusals. What is found is tested with the library.

#include <array>
#include <functional>
#include <iomanip>
#include <random>

#include <darboux/io.h>

#include "cli.h"
#include "torus_points.h"

namespace darboux::test::fit_test {
namespace {

const std::string torus = "data/torus_points.xyz";

// "x y z\n"
std::string row_of(const Vec3<double>& p) {
  std::ostringstream text;
  text << std::setprecision(17) << p.x << ' ' << p.y << ' ' << p.z << '\n';
  return text.str();
}

// Everything but the time.
Json without_seconds(Json document) {
  document.erase("seconds");
  return document;
}

TEST_F(Cli, FitFindsTheTorusAndPrintsTheContractsKeys) {
  const Json fit = json("darboux fit " + torus + " --json");
  expect_keys(fit, {"surface", "usable", "reason", "sigma", "inliers", "outliers", "standard_errors",
                    "frame_uncertainty_deg", "candidates", "iterations", "seconds", "ignored", "rms", "seed",
                    "file", "intervals", "interval_method", "level"});
  EXPECT_EQ(fit["usable"], true);
  EXPECT_EQ(fit["interval_method"], "t");
  EXPECT_EQ(fit["level"], 0.95);
  for (const auto& [name, error] : fit["standard_errors"].items()) {
    const double low = fit["intervals"][name][0], high = fit["intervals"][name][1];
    // 270 points less 7 unknowns: Student's t is 1.969. Of a turn and a movement the bound is that of 1 to 3
    // dimensions with this sum of variances.
    if (name == "axis_deg" || name == "centre") {
      EXPECT_EQ(low, 0);
      EXPECT_GT(high, 1.5 * error.get<double>());
      EXPECT_LT(high, 1.97 * error.get<double>());
    } else {
      EXPECT_NEAR((high - low) / 2, 1.969 * error.get<double>(), 0.002 * error.get<double>());
      EXPECT_NEAR((high + low) / 2, fit["surface"]["parameters"][name], 1e-12);
    }
  }
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
  EXPECT_EQ(read_bytes(path("frames.csv")), frames);
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
    // Right-handed and orthonormal to rounding; the point lies along the normal, to the 6 decimals of the
    // file.
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
  const std::string unusable = good("darboux fit three.xyz", 1);
  EXPECT_NE(unusable.find("not usable"), std::string::npos);
  EXPECT_EQ(unusable.find("on the surface"), std::string::npos) << "there is none";
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

// A surface that crosses itself has two frames at the place of one vertex, a one-sided one two at its seam:
// the uv tells which.
TEST_F(Cli, FitTakesTheFrameOfEachPointsOwnUv) {
  good("darboux mesh klein-bottle --grid 60x40 -o bottle.glb");
  const Json fit = json("darboux fit bottle.glb --with-uv --frames frames.csv --json");
  ASSERT_EQ(fit["surface"]["name"], "klein-bottle");
  const auto rows = lines(read_bytes(path("frames.csv")));
  const Mesh mesh = read_asset(path("bottle.glb")).primitives.at(0).data;
  ASSERT_EQ(rows.size(), mesh.positions.size() + 1);
  for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
    const auto f = fields(rows[i + 1]);
    EXPECT_EQ(f[0], std::to_string(i));
    // The file holds floats.
    const auto off = [&](std::size_t k, const Vec3<double>& stored) {
      return norm(Vec3<double>{to_double(f[k]), to_double(f[k + 1]), to_double(f[k + 2])} - stored);
    };
    EXPECT_LT(off(3, mesh.positions[i]), 1e-5) << i;
    EXPECT_LT(off(12, mesh.normals[i]), 1e-5) << i;
  }
}

constexpr std::size_t torus_columns = 24, torus_rows = 12,
                      torus_vertices = (torus_columns + 1) * (torus_rows + 1);
constexpr double torus_noise = 0.01;

// The vertices of a noisy torus, the same at the seams, without triangles.
Mesh noisy_torus(std::uint64_t seed) {
  constexpr std::size_t columns = torus_columns, rows = torus_rows;
  std::mt19937_64 random(seed);
  std::normal_distribution<double> noise(0, torus_noise);
  const AnySurface surface = make_surface("torus:major_radius=1,minor_radius=0.4");
  Mesh mesh;
  for (std::size_t j = 0; j <= rows; ++j)
    for (std::size_t i = 0; i <= columns; ++i) {
      Vec3<double> p = surface.jet(static_cast<double>(i) / columns, static_cast<double>(j) / rows).position;
      p += {noise(random), noise(random), noise(random)};
      if (i == columns) p = mesh.positions[j * (columns + 1)];
      if (j == rows) p = mesh.positions[i];
      mesh.positions.push_back(p);
    }
  return mesh;
}

// It as a.xyz, a.ply, a.pcd, a.obj, a.stl and a.glb in a folder, with triangles where the format has them.
void write_in_every_format(Mesh& mesh, const std::function<std::string(const char*)>& path) {
  constexpr std::size_t columns = torus_columns, rows = torus_rows;
  std::string table, faces, list, facets;
  for (const Vec3<double>& p : mesh.positions) table += row_of(p), list += "v " + row_of(p);
  for (std::uint32_t j = 0; j < rows; ++j)
    for (std::uint32_t i = 0; i < columns; ++i) {
      const auto a = static_cast<std::uint32_t>(j * (columns + 1) + i);
      const std::uint32_t b = a + 1, c = b + columns + 1, d = c - 1;
      for (const Triangle& t : {Triangle{a, b, c}, Triangle{a, c, d}}) {
        mesh.triangles.push_back(t);
        faces += "f";
        facets += "facet normal 0 0 0\nouter loop\n";
        for (const std::uint32_t k : t) {
          faces += " " + std::to_string(k + 1);
          facets += "vertex " + row_of(mesh.positions[k]);
        }
        faces += "\n";
        facets += "endloop\nendfacet\n";
      }
    }
  const std::string count = std::to_string(torus_vertices);
  write_bytes(path("a.xyz"), table);
  write_bytes(path("a.ply"), "ply\nformat ascii 1.0\nelement vertex " + count +
                                 "\nproperty double x\nproperty double y\nproperty double z\nelement face 1\n"
                                 "property list uchar int vertex_indices\nend_header\n" +
                                 table + "3 0 1 2\n");
  write_bytes(path("a.pcd"),
              "FIELDS x y z\nSIZE 8 8 8\nTYPE F F F\nWIDTH " + count + "\nHEIGHT 1\nDATA ascii\n" + table);
  write_bytes(path("a.obj"), list + faces + "v 9 9 9\n");
  write_bytes(path("a.stl"), "solid\n" + facets + "endsolid\n");
  write_glb(path("a.glb"), mesh, "a");
}

// One torus in every format: 25 x 13 vertices at 24 x 12 places, and one that no face uses.
TEST_F(Cli, FitAssessesEveryVertexOfEveryFormat) {
  constexpr std::size_t vertices = torus_vertices, places = torus_columns * torus_rows;
  constexpr double sigma = torus_noise;
  constexpr std::uint64_t seed = 61;
  SCOPED_TRACE("seed " + std::to_string(seed));
  Mesh mesh = noisy_torus(seed);
  write_in_every_format(mesh, [this](const char* name) { return path(name); });
  struct Case {
    std::string file;
    std::size_t points, measured, unused = 0;
  };
  for (const Case& c : {Case{"a.xyz", vertices, places}, Case{"a.pcd", vertices, places},
                        Case{"a.ply", vertices, places}, Case{"a.glb", vertices, places},
                        Case{"a.obj", vertices, places, 1}, Case{"a.stl", 6 * places, places}}) {
    SCOPED_TRACE(c.file);
    const Json fit =
        json("darboux fit " + c.file + " --surface torus --noise 0.01 --frames frames.csv --json");
    ASSERT_EQ(fit["usable"], true) << fit["reason"];
    const std::size_t inliers = fit["inliers"], outliers = fit["outliers"];
    EXPECT_EQ(inliers + outliers, c.points);
    EXPECT_GE(inliers, c.points * 97 / 100);
    EXPECT_EQ(fit["ignored"], c.unused);
    EXPECT_EQ(fit["sigma"], sigma);
    EXPECT_EQ(fit["candidates"].size(), 1u);
    // With known noise the standard error tells how many points were counted: by their places.
    const double error = sigma / std::sqrt(c.measured);
    EXPECT_NEAR(fit["surface"]["parameters"]["minor_radius"], 0.4, 5 * error);
    EXPECT_NEAR(fit["standard_errors"]["minor_radius"].get<double>() / error, 1, 0.03);
    const auto frames = lines(read_bytes(path("frames.csv")));
    ASSERT_EQ(frames.size(), 1 + c.points + c.unused);
    std::size_t counted = 0;
    for (std::size_t i = 0; i + 1 < frames.size(); ++i) {
      const auto f = fields(frames[i + 1]);
      EXPECT_EQ(f[0], std::to_string(i));
      counted += f[17] == "1";
      if (i >= mesh.positions.size() || c.points != vertices) continue;
      EXPECT_NEAR(to_double(f[3]) + to_double(f[12]) * to_double(f[18]), mesh.positions[i].x, 1e-6);
    }
    EXPECT_EQ(counted, inliers);
  }
  EXPECT_NE(good("darboux fit a.obj").find(", 1 in no triangle"), std::string::npos);
}

TEST_F(Cli, FitCountsThePointsWhereNothingIsFitted) {
  for (const char* rows : {"1 2 3", "1 2 $i", "nan 1 $i"}) {
    good("for i in $(seq 500); do echo " + std::string(rows) + "; done > points.xyz");
    const Result r = sh("darboux fit points.xyz --json --quiet");
    EXPECT_EQ(r.status, 1);
    const Json fit = Json::parse(r.out);
    EXPECT_EQ(fit["inliers"], 0);
    EXPECT_EQ(fit["outliers"], rows[0] == 'n' ? 0 : 500);
    EXPECT_EQ(fit["ignored"], rows[0] == 'n' ? 500 : 0);
    EXPECT_TRUE(fit["sigma"].is_null());
    EXPECT_TRUE(fit["rms"].is_null());
  }
}

// What the libraries beneath log is not for the user.
TEST_F(Cli, FitOfANoisyPlaneIsSilent) {
  for (const std::uint64_t seed : {1, 2, 3, 4, 5}) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    std::mt19937_64 random(seed);
    std::uniform_real_distribution<double> along(0, 1);
    std::normal_distribution<double> noise(0, 0.01);
    std::string table;
    for (int i = 0; i < 500; ++i) table += row_of({along(random), along(random), noise(random)});
    write_bytes(path("plane.xyz"), table);
    EXPECT_EQ(sh("darboux fit plane.xyz --quiet --json").err, "");
  }
}

TEST_F(Cli, FitTakesTheKindsThatTheLibraryFits) {
  good("darboux eval enneper --grid 20x20 --attributes position --format csv -o enneper.csv");
  const Json fit = json("darboux fit enneper.csv --surface enneper --json");
  ASSERT_EQ(fit["usable"], true) << fit["reason"];
  EXPECT_EQ(fit["surface"]["name"], "enneper");
  EXPECT_EQ(fit["inliers"], 441);
  // Before any file is read or written.
  refused("darboux fit missing.xyz --surface superellipsoid --frames frames.csv",
          {"--surface: expected", "got 'superellipsoid'", "without uvs", "enneper"});
  refused("darboux fit missing.xyz --surface bezier-patch", {"--surface: ", "without uvs"});
  refused("darboux fit missing.xyz --with-uv --surface tube --frames frames.csv",
          {"--surface: expected", "got 'tube'", "with uvs", "klein-bottle"});
  EXPECT_FALSE(fs::exists(path("frames.csv")));
}

TEST_F(Cli, FitSaysWhatItPassedOver) {
  good("sed 's/$/ 200 10 30/' " + torus + " | grep -v '#' > colours.xyz");
  const Result r = sh("darboux fit colours.xyz");
  EXPECT_EQ(r.status, 0);
  expect_one_line(r.err);
  EXPECT_NE(r.err.find("colours.xyz: line 1: columns 4 to 6"), std::string::npos) << r.err;
  EXPECT_EQ(sh("darboux fit colours.xyz --quiet").err, "");
  good("sed -i 's/$/ 1 2/' colours.xyz");
  refused("darboux fit colours.xyz --with-uv", {"none with uvs", "columns 4 to 6"});
}

// Digits down to the standard error: metres of a national grid, and a scan in millimetres.
TEST_F(Cli, FitPrintsTheDigitsThatItKnows) {
  good("grep -v '#' " + torus +
       " | awk '{printf \"%.6f %.6f %.6f\\n\", $1 + 500000, $2 + 4600000, $3}' > far.xyz");
  const std::string text = good("darboux fit far.xyz");
  EXPECT_NE(text.find("(500000.996"), std::string::npos) << text;
  EXPECT_NE(text.find(", 4599998.000"), std::string::npos) << text;
}

// All rows of the apex but one are left out: its normal is nobody's, those of the others are still summed up.
TEST_F(Cli, FitSaysHowManyFramesAreNotKnown) {
  good(
      "darboux eval cone --grid 24x8 --attributes position --format csv | awk -F, 'NR == 1 || $2 != 1 || $1 "
      "== 0' > cone.csv");
  const std::string text = good("darboux fit cone.csv --surface cone");
  for (const char* word : {"normals", "tangents"}) {
    const std::size_t at = text.find(word);
    const std::string line = text.substr(at, text.find('\n', at) - at);
    EXPECT_NE(line.find(" deg rms, at most "), std::string::npos) << line;
    EXPECT_NE(line.find("; unknown at 1 point, "), std::string::npos) << line;
  }
  const Json spread = json("darboux fit cone.csv --surface cone --json")["frame_uncertainty_deg"]["normal"];
  EXPECT_EQ(spread["infinite"], 1);
  EXPECT_TRUE(spread["max"].is_null());
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
          {"--surface", "without parameters", "torus"});
  refused("darboux fit " + torus + " --surface potato", {"potato", "auto", "cylinder"});
  for (const std::string noise : {"0", "-1"})
    refused("darboux fit " + torus + " --noise=" + noise, {"--noise", "expected 0 < SIGMA, got " + noise});
  for (const std::string noise : {"nan", "inf", "x"})
    refused("darboux fit " + torus + " --noise=" + noise,
            {"--noise", "expected a finite number", "got '" + noise + "'"});
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
}  // namespace darboux::test::fit_test
