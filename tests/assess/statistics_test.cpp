// The statistics of a verdict against a second computation: second_opinion.h, with the formulas of
// second_shapes.h.
#include <filesystem>
#include <random>

#include <gtest/gtest.h>

#include <darboux/assess.h>
#include <darboux/io.h>
#include <darboux/sample_mesh.h>

#include "io_files.h"
#include "random_pose.h"
#include "second_shapes.h"

namespace darboux::statistics_test {
namespace {

using namespace test;

// ---- what is compared

// \param fitted whether the truth of the report is uncertain: no angle is then farther off than so many of
// the largest standard deviation, and neither is a maximum, an rms or a percentile of them. Eight, as the
// roundings of a row of a grid are equal, not independent as the fit takes them: 4.6 was met. At a pole the
// tangent's is infinite, as first order tells nothing.
void expect_equal(const MeshReport& report, const std::map<VertexClass, OfClass>& expected, bool fitted,
                  const std::string& what) {
  EXPECT_EQ(report.reference, ReferenceKind::analytic) << what;
  ASSERT_EQ(report.classes.size(), expected.size()) << what;
  for (const ClassReport& c : report.classes) {
    const std::string name =
        what + ", " + std::string(vertex_class_names[static_cast<std::size_t>(c.vertex_class)]);
    ASSERT_TRUE(expected.contains(c.vertex_class)) << name;
    const OfClass& e = expected.at(c.vertex_class);
    EXPECT_EQ(c.corners, e.corners) << name;
    // Doubles turn a unit vector by some 1e-16, which is 6e-15 degrees; a fit by what validate() takes for
    // rounding.
    const double rounding = fitted ? 1e-10 : 5e-14;
    const double normal = fitted ? 8 * c.normal_uncertainty_deg.max() : 0,
                 tangent = fitted && c.tangent_deg ? 8 * c.tangent_uncertainty_deg.max() : 0;
    EXPECT_TRUE(std::isfinite(normal)) << name;
    EXPECT_TRUE(std::isfinite(tangent) || c.vertex_class == VertexClass::pole) << name;
    expect_same(c.normal_deg, e.normal, rounding + normal, name + " normals");
    expect_same(c.tangent_deg, e.tangent, rounding + tangent, name + " tangents");
    expect_same(c.bitangent_deg, e.bitangent, rounding + normal + tangent, name + " bitangents");
  }
}

// ---- the meshes

AssessOptions declared(const Shape& shape) {
  AssessOptions options;
  options.surface = parse_specification(shape.specification);
  options.placement = shape.placement;
  options.references = {.analytic = true, .mikktspace = false, .local = false, .triangles = false};
  return options;
}

// By the surface declared, and by the surface found.
void expect_statistics(const std::string& path, const Shape& shape, const Eigen::Matrix3d& linear) {
  const Read mesh = second_read(path);
  const Truths truths = truths_of(mesh, shape, linear);
  const auto expected = second_opinion(mesh, truths.at, truths.pole, [](std::size_t) { return true; });
  const Mesh read = read_asset(path).primitives.at(0).data;
  AssessOptions options = declared(shape);
  expect_equal(assess(read, options).report, expected, shape.affine, path + " declared");
  options.surface.reset();
  options.placement.reset();
  expect_equal(assess(read, options).report, expected, true, path + " fitted");
}

int expect_statistics_in(const std::string& folder) {
  int files = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    const std::string name = entry.path().filename().string();
    if (entry.path().extension() != ".glb") continue;
    if (const auto shape = shape_of(name)) {
      expect_statistics(entry.path().string(), *shape, shape->placement.linear());
      ++files;
    }
  }
  return files;
}

TEST(ValidateStatistics, OfFilesOfOtherTools) {
  EXPECT_EQ(expect_statistics_in(DARBOUX_TEST_DATA), 15);
}

TEST(ValidateStatistics, OfAllFilesOfOtherTools) {
  const std::string folder = DARBOUX_SHARED "/meshes/three";
  if (!std::filesystem::exists(folder))
    GTEST_SKIP() << "SKIPPED: " << folder << " is absent, it is not compared";
  EXPECT_EQ(expect_statistics_in(folder), 31);
}

// Frames turned by some degrees, a few tangents left out.
void disturb(Mesh& mesh, std::mt19937_64& random) {
  std::normal_distribution<double> normal;
  for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
    const auto turned = [&](const Vec3<double>& a, double degrees) {
      const Eigen::Vector3d axis(normal(random), normal(random), normal(random));
      return from_eigen(
          Eigen::AngleAxisd(degrees * normal(random) * std::numbers::pi / 180, axis.normalized()) *
          to_eigen(a));
    };
    const auto inside = [](double x) { return x > 0 && x < 1; };  // on a seam one normal stays one
    if (inside(mesh.uvs[v].x) && inside(mesh.uvs[v].y)) mesh.normals[v] = turned(mesh.normals[v], 2);
    const Vec3<double> t = random() % 40 == 0 ? Vec3<double>{} : turned(mesh.tangents[v].xyz(), 5);
    mesh.tangents[v] = {t.x, t.y, t.z, mesh.tangents[v].w};
  }
}

// Written here: anywhere in space, jittered, mirrored, of both signs, with frames that are off by degrees.
TEST(ValidateStatistics, OfPlacedJitteredAndMirroredMeshes) {
  const test::TempFolder folder;
  const auto unit_sphere = [](const V2& p) { return ellipsoid(1, 1, 1, p); };
  const Shape shapes[] = {
      {"torus:major_radius=1,minor_radius=0.4", torus},
      {"sphere:radius=1", unit_sphere, Eigen::Isometry3d::Identity(), true},
      {"ellipsoid:semi_axis_x=1,semi_axis_y=0.5,semi_axis_z=0.75",
       [](const V2& p) { return ellipsoid(1, 0.5L, 0.75L, p); }, Eigen::Isometry3d::Identity(), true},
      {"cylinder:radius=1,height=2", [](const V2& p) { return cone(0, 2, p); }},
      {"cone:radius=1,height=0.5", [](const V2& p) { return cone(1, 0.5L, p); }}};
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    std::mt19937_64 random(seed);
    Shape shape = shapes[seed % 5];
    const bool mirrored = seed % 2 == 0;
    Mesh mesh = sample_mesh(make_surface(parse_specification(shape.specification)),
                            {.columns = 20,
                             .rows = 11,
                             .jitter = seed % 3 == 0 ? 0 : 0.3,
                             .seed = seed,
                             .v_last = shape.specification.starts_with("cone") ? 0.875 : 1,
                             .sign = seed % 4 < 2 ? SignConvention::raw : SignConvention::gltf,
                             .scale = {mirrored ? -1.0 : 1.0, 1, 1}});
    disturb(mesh, random);
    shape.placement = random_pose(random, 2);
    place(mesh, shape.placement);
    Eigen::Matrix3d linear = shape.placement.linear();
    if (mirrored) {
      // The mirror image in x of a surface of revolution is itself turned by half a turn, with u running
      // backwards.
      linear.col(0) *= -1;
      shape.placement.linear() =
          shape.placement.linear() * Eigen::Vector3d(-1, -1, 1).asDiagonal().toDenseMatrix();
    }
    const std::string path = folder / (std::to_string(seed) + ".glb");
    write_glb(path, mesh, "made here");
    SCOPED_TRACE(shape.specification + ", seed " + std::to_string(seed));
    expect_statistics(path, shape, linear);
  }
}

// u runs forth and back: two parts, each with an affine map of its own, which is fitted.
TEST(ValidateStatistics, OfTheHalvesOfAMirroredChart) {
  const std::string path = DARBOUX_TEST_DATA "/mirrortorus_016.mikk.glb";
  const Read mesh = second_read(path);
  std::vector<int> sign(mesh.positions.size(), 0);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    for (const std::size_t v : mesh.triangles[t]) sign[v] = uv_sign(mesh, t);
  std::vector<Directions> truth;
  for (std::size_t v = 0; v < sign.size(); ++v) {
    const Real half = mesh.uvs[v].x() / 2;
    truth.push_back(torus({sign[v] < 0 ? 1 - half : half, mesh.uvs[v].y()}));
    truth.back().t *= sign[v] < 0 ? -1 : 1;
  }
  const std::vector<bool> no_pole(sign.size(), false);
  for (const bool is_declared : {true, false}) {
    AssessOptions options;
    if (is_declared) options.surface = parse_specification("torus:major_radius=1,minor_radius=0.4");
    const std::vector<Assessment> parts = assess_parts(read_asset(path).primitives.at(0).data, options);
    ASSERT_EQ(parts.size(), 2u);
    for (const Assessment& part : parts) {
      const int of_part = uv_sign(mesh, 0) * (part.part == 0u ? 1 : -1);
      const auto expected =
          second_opinion(mesh, truth, no_pole, [&](std::size_t t) { return uv_sign(mesh, t) == of_part; });
      expect_equal(part.report, expected, true, "half " + std::to_string(*part.part));
    }
  }
}

// Corners that share no vertices, with MikkTSpace's own tangents.
TEST(ValidateStatistics, OfTheOraclesSoup) {
  const std::string stem = DARBOUX_SHARED "/meshes/oracle/torus";
  if (!std::filesystem::exists(stem + ".soup"))
    GTEST_SKIP() << "SKIPPED: " << stem << ".soup is absent, it is not compared";
  const std::string soup = test::read_bytes(stem + ".soup"), tangents = test::read_bytes(stem + ".tan");
  Mesh mesh;
  Read second;
  const std::size_t corners = 3 * test::u32_at(soup, 0);
  for (std::size_t c = 0; c < corners; ++c) {
    std::array<float, 8> a;
    std::array<float, 4> t;
    std::memcpy(a.data(), soup.data() + 4 + c * sizeof a, sizeof a);
    std::memcpy(t.data(), tangents.data() + c * sizeof t, sizeof t);
    mesh.positions.push_back({a[0], a[1], a[2]});
    mesh.normals.push_back({a[3], a[4], a[5]});
    mesh.uvs.push_back({a[6], a[7]});
    mesh.tangents.push_back({t[0], t[1], t[2], t[3]});
    second.positions.push_back({a[0], a[1], a[2]});
    second.normals.push_back({a[3], a[4], a[5]});
    second.uvs.push_back({a[6], a[7]});
    second.tangents.push_back({t[0], t[1], t[2], t[3]});
    if (c % 3 == 2) {
      const auto v = static_cast<std::uint32_t>(c);
      mesh.triangles.push_back({v - 2, v - 1, v});
      second.triangles.push_back({c - 2, c - 1, c});
    }
  }
  const Shape shape = *shape_of("torus_");
  const Truths truths = truths_of(second, shape, Eigen::Matrix3d::Identity());
  const auto expected = second_opinion(second, truths.at, truths.pole, [](std::size_t) { return true; });
  expect_equal(assess(mesh, declared(shape)).report, expected, false, "soup");
}

}  // namespace
}  // namespace darboux::statistics_test
