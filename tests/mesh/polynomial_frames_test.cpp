// Frames by least-squares polynomials: what they are exact on, and what must not change them.
#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include <darboux/any_surface.h>
#include <darboux/mesh_frames.h>
#include <darboux/sample_mesh.h>

namespace darboux::polynomial_frames_test {
namespace {

// A polynomial chart of the method's degree is recovered, at borders and corners too, and on triangles of
// their own.
TEST(PolynomialFrames, PolynomialsAreExactOnPolynomials) {
  std::mt19937_64 random(20261122);
  std::uniform_real_distribution<double> uniform(-1, 1);
  for (const int degree : {2, 3}) {
    std::array<Vec3<double>, 10> c;
    for (Vec3<double>& x : c) x = {uniform(random), uniform(random), uniform(random)};
    c[1] = c[1] + Vec3<double>{6, 0, 0}, c[2] = c[2] + Vec3<double>{0, 6, 0};  // far from singular
    const auto at = [&](double u, double v, int du, int dv) {
      Vec3<double> sum{};
      std::size_t k = 0;
      for (int n = 0; n <= degree; ++n)
        for (int j = 0; j <= n; ++j, ++k) {
          const int i = n - j;
          if (i < du || j < dv) continue;
          sum += (du != 0 ? i : 1) * (dv != 0 ? j : 1) * std::pow(u, i - du) * std::pow(v, j - dv) * c[k];
        }
      return sum;
    };
    Mesh mesh = sample_mesh(make_surface("plane"),
                            {.columns = 7, .rows = 6, .jitter = 0.2, .random_diagonals = true});
    for (std::size_t v = 0; v < mesh.positions.size(); ++v)
      mesh.positions[v] = at(mesh.uvs[v].x, mesh.uvs[v].y, 0, 0);
    Mesh soup;
    for (const Triangle& triangle : mesh.triangles) {
      const auto first = static_cast<std::uint32_t>(soup.positions.size());
      soup.triangles.push_back({first, first + 1, first + 2});
      for (const std::uint32_t v : triangle) {
        soup.positions.push_back(mesh.positions[v]);
        soup.uvs.push_back(mesh.uvs[v]);
      }
    }
    for (const Mesh* m : {&mesh, &soup}) {
      const MeshFrames frames = mesh_frames(*m, find_frame_method(degree == 2 ? "quadratic" : "cubic"));
      for (std::size_t k = 0; k < m->corners(); ++k) {
        const auto [u, v] = m->uvs[m->triangles[k / 3][k % 3]];
        // A condition of up to 10^3 (a smaller pivot is refused) and powers of distances of up to 4 edges.
        EXPECT_LE(norm(frames.corner(k).t - unit(at(u, v, 1, 0))), 1e-11);
        EXPECT_LE(norm(frames.corner(k).b - unit(at(u, v, 0, 1))), 1e-11);
      }
    }
  }
}

// A cube blown up to a sphere, each face with the uvs [0, 1]². At some corners of the cube faces meet in
// equal uvs: no polynomial may take neighbours from two of them.
TEST(PolynomialFrames, ChartsThatMeetInEqualUvsStayApart) {
  constexpr int n = 16;
  constexpr std::array<Vec3<double>, 3> x{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
  Mesh apart;
  std::vector<Vec3<double>> dpdu;
  for (int face = 0; face < 6; ++face) {
    const double side = face < 3 ? 1 : -1;
    const Vec3<double> c = side * x[static_cast<std::size_t>(face % 3)],
                       a = x[static_cast<std::size_t>((face + 1) % 3)], b = cross(c, a);
    const auto first = static_cast<std::uint32_t>(apart.positions.size());
    for (int j = 0; j <= n; ++j)
      for (int i = 0; i <= n; ++i) {
        const double u = i / double{n}, v = j / double{n};
        const Vec3<double> p = unit(c + (2 * u - 1) * a + (2 * v - 1) * b);
        apart.positions.push_back(p);
        apart.normals.push_back(p);
        apart.uvs.push_back({u, v});
        dpdu.push_back(unit(a - dot(a, p) * p));
        if (i == n || j == n) continue;
        const std::uint32_t v00 = first + static_cast<std::uint32_t>(j * (n + 1) + i), v10 = v00 + 1,
                            v01 = v00 + n + 1, v11 = v01 + 1;
        apart.triangles.push_back({v00, v10, v11});
        apart.triangles.push_back({v00, v11, v01});
      }
  }
  Mesh shared = apart;  // one vertex for all that are equal
  std::size_t joined = 0;
  for (Triangle& triangle : shared.triangles)
    for (std::uint32_t& v : triangle)
      for (std::uint32_t w = 0; w < v; ++w)
        if (norm(apart.positions[v] - apart.positions[w]) < 1e-12 && apart.uvs[v] == apart.uvs[w])
          v = w, ++joined;
  EXPECT_GT(joined, 0u);
  // One-sided at the edges of the cube, where h = 1/16: the next derivative times h² (0.023 in another
  // program) or h³ (0.012). At a corner dpdu and dpdv are 120 degrees apart, and the nearest orthonormal
  // pair is turned by 15 degrees, 0.26, and more by neighbours on one side (0.316).
  constexpr std::pair<const char*, double> bounds[] = {
      {"quadratic", 0.03}, {"cubic", 0.02}, {"procrustes", 0.35}};
  for (const Mesh* mesh : {&apart, &shared})
    for (const auto& [method, bound] : bounds) {
      const MeshFrames frames = mesh_frames(*mesh, find_frame_method(method));
      double worst = 0;
      for (std::size_t k = 0; k < mesh->corners(); ++k)
        worst = std::fmax(worst, norm(frames.corner(k).t - dpdu[apart.triangles[k / 3][k % 3]]));
      EXPECT_LE(worst, bound) << method;
    }
}

// The polynomials that are nearest do not depend on the chart's scales, shear and turn: nor may the choice of
// their degree.
TEST(PolynomialFrames, PolynomialsFollowAffineMapsOfTheChart) {
  struct Map {
    double uu, uv, vu, vv;
    bool same_t, same_b;  // t is parallel to the map's where vu = 0, b where uv = 0
  };
  std::vector<Map> maps{{100, 0, 0, 1, true, true},
                        {1, 0, 0, 100, true, true},
                        {-1, 0, 0, 1, true, true},
                        {0.6, -0.8, 0.8, 0.6, false, false},
                        {0.6, 0.8, 0.8, -0.6, false, false}};
  for (const double shear : {0.0, 1.0, 5.0, 20.0, 50.0})
    for (const double reversed : {1.0, -1.0}) {
      maps.push_back({reversed, shear, 0, 1, true, shear == 0});
      maps.push_back({1, 0, shear, reversed, shear == 0, true});
    }
  constexpr int rows = 12;
  const Mesh mesh = sample_mesh(make_surface("ellipsoid"), {.columns = 2 * rows,
                                                            .rows = rows,
                                                            .jitter = 0.15,
                                                            .random_diagonals = true,
                                                            .seed = 5,
                                                            .v_first = 0.2,
                                                            .v_last = 0.8});
  for (const char* name : {"quadratic", "cubic"}) {
    const FrameMethod& method = find_frame_method(name);
    const MeshFrames plain = mesh_frames(mesh, method);
    for (const Map& map : maps) {
      Mesh mapped = mesh;
      for (Vec2<double>& uv : mapped.uvs) uv = {map.uu * uv.x + map.uv * uv.y, map.vu * uv.x + map.vv * uv.y};
      const MeshFrames frames = mesh_frames(mapped, method);
      // A mapped uv is rounded by 2u of its size, over an edge of 1/(2 rows); the fit's condition is below
      // 10^3.
      const double size = std::max({1.0, std::fabs(map.uv), std::fabs(map.vu)});
      const double tolerance = 1e3 * 4 * 0x1p-53 * size * 2 * rows;
      double t = 0, b = 0, n = 0;
      for (std::size_t c = 0; c < mesh.corners(); ++c) {
        const CornerFrame &before = plain.corner(c), &after = frames.corner(c);
        n = std::max(n, norm(after.n - before.n));
        if (map.same_t) t = std::max(t, norm(after.t - (map.uu < 0 ? -1.0 : 1.0) * before.t));
        if (map.same_b) b = std::max(b, norm(after.b - (map.vv < 0 ? -1.0 : 1.0) * before.b));
      }
      EXPECT_LE(std::max({t, b, n}), tolerance)
          << name << ", map " << map.uu << ' ' << map.uv << ' ' << map.vu << ' ' << map.vv;
    }
  }
}

}  // namespace
}  // namespace darboux::polynomial_frames_test
