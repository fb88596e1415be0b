// One vertex that is wrong in a mesh of a million triangles: found, named and counted, and nothing else is.
#include <algorithm>
#include <cmath>
#include <functional>
#include <iostream>
#include <numbers>
#include <random>

#include <gtest/gtest.h>

#include <darboux/sample_mesh.h>
#include <darboux/validate.h>

namespace darboux::one_among_a_million_test {
namespace {

// Exact, with the truth at each vertex.
struct Known {
  Mesh mesh;
  std::vector<Truth> truth;
};

const Known& known() {
  static const Known result = [] {
#ifdef DARBOUX_SHORT_TESTS
    constexpr int columns = 100, rows = 50;
    std::cout << "10 000 triangles\n";
#else
    constexpr int columns = 1000, rows = 500;
#endif
    const AnySurface torus = make_surface("torus:major_radius=1,minor_radius=0.4");
    Known k{sample_mesh(torus, {.columns = columns, .rows = rows}), {}};
    const PlacedSurface placed{torus};
    for (const Vec2<double>& uv : k.mesh.uvs) k.truth.push_back(placed.truth(uv));
    return k;
  }();
  return result;
}

std::size_t corners_of(const Mesh& mesh, std::uint32_t v) {
  std::size_t count = 0;
  for (const Triangle& triangle : mesh.triangles) count += std::ranges::count(triangle, v);
  return count;
}

MeshReport report_of(const Mesh& mesh) {
  ValidateOptions options;
  options.references = {.analytic = true, .mikktspace = false, .local = false, .triangles = false};
  return validate(mesh, known().truth, options);
}

const WorstCorner& worst_of(const MeshReport& report) {
  const ClassReport* worst = nullptr;
  for (const ClassReport& c : report.classes)
    if (!worst || c.tangent_deg->max > worst->tangent_deg->max) worst = &c;
  return *worst->worst;
}

void turn(Vec4<double>& t, const Vec3<double>& n, double degrees) {
  const double angle = degrees * std::numbers::pi / 180;
  const Vec3<double> turned = std::cos(angle) * t.xyz() + std::sin(angle) * cross(n, t.xyz());
  t = {turned.x, turned.y, turned.z, t.w};
}

// As text: code and count of everything found.
std::string found(const MeshReport& report) {
  std::string text;
  for (const Finding& f : report.findings) text += std::string(f.code) + " " + std::to_string(f.count) + " ";
  return text;
}

// A copy of the mesh and vertices drawn from it: at the seam one has up to three corners, elsewhere six.
class OneAmongAMillion : public testing::Test {
 protected:
  void for_each_seed(const std::function<void(Mesh, std::mt19937_64&)>& run) {
    for (const std::uint64_t seed : {1, 2}) {
      SCOPED_TRACE("seed " + std::to_string(seed));
      std::mt19937_64 random(seed);
      run(known().mesh, random);
    }
  }
  static std::uint32_t any_vertex(std::mt19937_64& random) {
    return static_cast<std::uint32_t>(random() % known().mesh.positions.size());
  }
};

TEST_F(OneAmongAMillion, FlippedSign) {
  for_each_seed([](Mesh mesh, std::mt19937_64& random) {
    const std::uint32_t v = any_vertex(random);
    mesh.tangents[v].w *= -1;
    const std::size_t corners = corners_of(mesh, v);
    const MeshReport report = report_of(mesh);
    EXPECT_EQ(found(report), "TANGENT_HANDEDNESS " + std::to_string(corners) + " ");
    EXPECT_EQ(report.verdict, Verdict::fail);
    EXPECT_EQ(report.handedness.convention, HandednessConvention::gltf);
    EXPECT_EQ(report.handedness.wrong, corners);
    const auto all = static_cast<double>(mesh.corners());
    EXPECT_DOUBLE_EQ(report.handedness.consistent, (all - static_cast<double>(corners)) / all);
  });
}

TEST_F(OneAmongAMillion, TangentOffByTwentyDegrees) {
  for_each_seed([](Mesh mesh, std::mt19937_64& random) {
    const std::uint32_t v = any_vertex(random);
    turn(mesh.tangents[v], mesh.normals[v], 20);
    const MeshReport report = report_of(mesh);
    EXPECT_EQ(found(report), "TANGENT_ANGLE " + std::to_string(corners_of(mesh, v)) + " ");
    EXPECT_EQ(report.verdict, Verdict::fail);
    EXPECT_NE(report.findings.front().message.find("worst 20 deg"), std::string::npos)
        << report.findings.front().message;
    const WorstCorner& worst = worst_of(report);
    EXPECT_EQ(worst.vertex, v);
    EXPECT_EQ(worst.uv, mesh.uvs[v]);
    for (const ClassReport& c : report.classes) {
      // The turn is exact to some roundings, as in Validate.MeasuresAKnownAngle.
      const bool its = c.worst->vertex == v;
      EXPECT_NEAR(c.tangent_deg->max, its ? 20 : 0, 1e-11);
      EXPECT_NEAR(c.bitangent_deg->max, its ? 20 : 0, 1e-11);
      const auto share = static_cast<double>(corners_of(mesh, v)) / static_cast<double>(c.corners);
      EXPECT_NEAR(c.tangent_deg->rms, its ? 20 * std::sqrt(share) : 0, 1e-11);
      EXPECT_LT(c.normal_deg->max, 1e-11);
    }
  });
}

TEST_F(OneAmongAMillion, ZeroTangent) {
  for_each_seed([](Mesh mesh, std::mt19937_64& random) {
    const std::uint32_t v = any_vertex(random);
    mesh.tangents[v] = {0, 0, 0, mesh.tangents[v].w};
    const std::size_t corners = corners_of(mesh, v);
    const MeshReport report = report_of(mesh);
    EXPECT_EQ(found(report), "TANGENT_ZERO " + std::to_string(corners) + " ");
    EXPECT_EQ(report.verdict, Verdict::fail);
    EXPECT_EQ(report.zero_tangents, corners);
    EXPECT_EQ(report.handedness.wrong, 0u);
  });
}

// All three at once, each under its own name.
TEST_F(OneAmongAMillion, OneOfEach) {
  for_each_seed([](Mesh mesh, std::mt19937_64& random) {
    const std::uint32_t a = any_vertex(random), b = any_vertex(random), c = any_vertex(random);
    ASSERT_TRUE(a != b && b != c && c != a);
    mesh.tangents[a] = {0, 0, 0, mesh.tangents[a].w};
    mesh.tangents[b].w *= -1;
    turn(mesh.tangents[c], mesh.normals[c], 20);
    const auto count = [&](std::uint32_t v) { return std::to_string(corners_of(mesh, v)) + " "; };
    const MeshReport report = report_of(mesh);
    EXPECT_EQ(found(report),
              "TANGENT_ZERO " + count(a) + "TANGENT_HANDEDNESS " + count(b) + "TANGENT_ANGLE " + count(c));
    EXPECT_EQ(worst_of(report).vertex, c);
  });
}

TEST_F(OneAmongAMillion, NoneIsNone) {
  EXPECT_EQ(found(report_of(known().mesh)), "");
  EXPECT_EQ(report_of(known().mesh).verdict, Verdict::pass);
}

}  // namespace
}  // namespace darboux::one_among_a_million_test
