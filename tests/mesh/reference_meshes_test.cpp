// The kinds of reference meshes beside the plain grid: spheres, lanterns, poles, scale, degenerate triangles.
#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <numbers>
#include <set>
#include <string>

#include <gtest/gtest.h>

#include <darboux/catalogue.h>
#include <darboux/error.h>
#include <darboux/mesh_frames.h>
#include <darboux/sample_mesh.h>
#include <darboux/weld.h>

#include "refusal_of.h"

namespace darboux::reference_meshes_test {
namespace {

constexpr double pi = std::numbers::pi;

struct Kind {
  std::string name;
  SampleMeshOptions options;
};

// One of each kind, all odd and even enough that nothing is symmetric by chance.
std::vector<Kind> kinds() {
  return {{"grid", {.columns = 14, .rows = 9}},
          {"icosphere", {.topology = MeshTopology::icosphere, .subdivisions = 7}},
          {"cube-sphere", {.topology = MeshTopology::cube_sphere, .subdivisions = 6}},
          {"lantern", {.topology = MeshTopology::lantern, .columns = 14, .rows = 9}},
          {"half-cell", {.columns = 14, .rows = 9, .pole = PolePlacement::half_cell}},
          {"shared pole", {.columns = 14, .rows = 9, .pole = PolePlacement::shared}}};
}

// Calls f(surface, kind) for all that go together; what does not is refused by name.
template <class F>
std::map<std::string, std::set<std::string>> for_each_permitted(F f) {
  std::map<std::string, std::set<std::string>> permitted;
  for (const AnySurface& surface : all_surfaces())
    for (const Kind& kind : kinds()) {
      SCOPED_TRACE(std::string(surface.info().name) + ", " + kind.name);
      try {
        sample_mesh(surface, kind.options);
      } catch (const ParameterError& error) {
        EXPECT_NE(std::string(error.what()).find(surface.info().name), std::string::npos) << error.what();
        continue;
      }
      permitted[kind.name].insert(std::string(surface.info().name));
      f(surface, kind);
    }
  return permitted;
}

Vec3<double> face_normal(const Mesh& mesh, const Triangle& triangle) {
  const auto& [a, b, c] = triangle;
  return cross(mesh.positions[b] - mesh.positions[a], mesh.positions[c] - mesh.positions[a]);
}

double area(const Mesh& mesh) {
  double sum = 0;
  for (const Triangle& triangle : mesh.triangles) sum += norm(face_normal(mesh, triangle)) / 2;
  return sum;
}

bool is_degenerate(const Mesh& mesh, const Triangle& triangle) {
  const auto& [a, b, c] = triangle;
  return darboux::is_degenerate(mesh.positions[a], mesh.positions[b], mesh.positions[c]);
}
bool is_degenerate_in_uv(const Mesh& mesh, const Triangle& triangle) {
  const auto& [a, b, c] = triangle;
  return darboux::is_degenerate(mesh.uvs[a], mesh.uvs[b], mesh.uvs[c]);
}
auto count(const Mesh& mesh, bool (*is)(const Mesh&, const Triangle&)) {
  return std::count_if(mesh.triangles.begin(), mesh.triangles.end(),
                       [&](const Triangle& t) { return is(mesh, t); });
}

// What a float file keeps.
Mesh in_float(Mesh mesh) {
  const auto narrow = [](double& x) { x = static_cast<double>(static_cast<float>(x)); };
  for (Vec3<double>& p : mesh.positions) narrow(p.x), narrow(p.y), narrow(p.z);
  for (Vec2<double>& p : mesh.uvs) narrow(p.x), narrow(p.y);
  return mesh;
}

// Stored data are the surface's own at the stored uv: shear undone by subtraction, scale component by
// component.
TEST(ReferenceMeshes, StoreTheTruth) {
  for (const double shear : {0.0, 0.5})
    for (const Vec3<double> scale :
         {Vec3<double>{1, 1, 1}, {2, 0.5, 0.25}, {-1, 1, 1}, {1, -3, 0.5}, {-1, 1, -2}, {-1, -1, -1}})
      for (const SignConvention sign : {SignConvention::gltf, SignConvention::raw})
        for_each_permitted([&](const AnySurface& surface, const Kind& kind) {
          SampleMeshOptions o = kind.options;
          o.shear = shear;
          o.scale = scale;
          o.sign = sign;
          const Mesh mesh = sample_mesh(surface, o);
          // The superellipsoid goes like a root of u at its quarter turns: a rounding of u is 1e-8 of the
          // position.
          const bool rough = shear != 0 && surface.info().name == "superellipsoid";
          for (std::size_t v = 0; !rough && v < mesh.positions.size(); ++v) {
            const double u = mesh.uvs[v].x - shear * mesh.uvs[v].y;  // off by one rounding of the sum
            const Sample<double> s = surface.sample(u, mesh.uvs[v].y);
            const auto [x, y, z] = s.jet.position;
            const Vec3<double> p{scale.x * x, scale.y * y, scale.z * z};
            const Vec3<double> t{scale.x * s.frame.t.x, scale.y * s.frame.t.y, scale.z * s.frame.t.z};
            const Vec3<double> n{s.frame.n.x / scale.x, s.frame.n.y / scale.y, s.frame.n.z / scale.z};
            // A rounding of u, 1e-16, times the steepest partial, below 100 over the catalogue and these
            // scales.
            EXPECT_LE(norm(mesh.positions[v] - p), 1e-14 * std::fmax(1, norm(p)));
            EXPECT_LE(norm(mesh.normals[v] - unit(n)), 1e-14);
            EXPECT_LE(norm(mesh.tangents[v].xyz() - unit(t)), 1e-14);
          }
        });
}

TEST(ReferenceMeshes, AreWoundAsTheirNormalsAndSignedAsTheirUvs) {
  for (const Vec3<double> scale :
       {Vec3<double>{1, 1, 1}, {-1, 1, 1}, {1, -1.5, 0.8}, {-1, 1, -1.5}, {-1, -1, -1}})
    for (const SignConvention sign : {SignConvention::gltf, SignConvention::raw})
      for_each_permitted([&](const AnySurface& surface, const Kind& kind) {
        SampleMeshOptions o = kind.options;
        // Fine enough that no triangle sees the surface's normal turn by a quarter turn, boxes' edges
        // included.
        o.columns = 48, o.rows = 29, o.subdivisions = 20;
        o.scale = scale;
        o.sign = sign;
        const bool one_apex = kind.name == "shared pole" && surface.info().name == "cone";
        const Mesh mesh = sample_mesh(surface, o);
        for (const Triangle& triangle : mesh.triangles) {
          const auto& [a, b, c] = triangle;
          const double raw = signed_uv_area2(mesh.uvs[a], mesh.uvs[b], mesh.uvs[c]) > 0 ? 1 : -1;
          for (const std::uint32_t v : triangle) {
            const bool apex = one_apex && mesh.uvs[v].y == 1;  // has the normal of one side only
            EXPECT_TRUE(apex || dot(face_normal(mesh, triangle), mesh.normals[v]) > 0);
            EXPECT_EQ(mesh.tangents[v].w, sign == SignConvention::raw ? raw : -raw);
          }
        }
      });
}

TEST(ReferenceMeshes, PermitTheSurfacesTheyName) {
  auto permitted = for_each_permitted([](const AnySurface&, const Kind&) {});
  EXPECT_EQ(permitted["grid"].size(), all_surfaces().size());
  const std::set<std::string> spheres{"ellipsoid", "sphere", "superellipsoid"};
  EXPECT_EQ(permitted["icosphere"], spheres);
  EXPECT_EQ(permitted["cube-sphere"], spheres);
  EXPECT_TRUE(permitted["lantern"].contains("cylinder"));
  EXPECT_FALSE(permitted["lantern"].contains("cone") || permitted["lantern"].contains("torus"));
  EXPECT_EQ(permitted["half-cell"], permitted["shared pole"]);
  for (const std::string surface : {"sphere", "ellipsoid", "superellipsoid", "cone", "elliptic-paraboloid"})
    EXPECT_TRUE(permitted["half-cell"].contains(surface)) << surface;
  EXPECT_FALSE(permitted["half-cell"].contains("torus"));
}

// Welded by position a sphere is closed: every edge has two triangles, once in each direction, and V - E + F
// = 2.
TEST(ReferenceMeshes, SpheresAreClosed) {
  for (const MeshTopology topology : {MeshTopology::icosphere, MeshTopology::cube_sphere})
    for (const int n : {1, 2, 3, 4, 5, 8, 17, 30}) {
      if (topology == MeshTopology::cube_sphere && n % 2 != 0) continue;
      const Mesh mesh = sample_mesh(Sphere{1.0}, {.topology = topology, .subdivisions = n});
      const std::size_t faces = (topology == MeshTopology::icosphere ? 20u : 12u) * n * n;
      EXPECT_EQ(mesh.triangles.size(), faces);
      const std::vector<std::uint32_t> place = weld(mesh.positions, 1e-12);  // copies have the same bits
      std::set<std::uint32_t> places(place.begin(), place.end());
      std::set<std::pair<std::uint32_t, std::uint32_t>> edges;
      for (const Triangle& t : mesh.triangles)
        for (int k = 0; k < 3; ++k) EXPECT_TRUE(edges.emplace(place[t[k]], place[t[(k + 1) % 3]]).second);
      for (const auto& [a, b] : edges) EXPECT_TRUE(edges.contains({b, a}));
      EXPECT_EQ(places.size() + faces, edges.size() / 2 + 2);
    }
}

TEST(ReferenceMeshes, NoTriangleOfASphereJumpsInUv) {
  for (const MeshTopology topology : {MeshTopology::icosphere, MeshTopology::cube_sphere})
    for (const int n : {2, 4, 10, 30}) {
      const Mesh mesh = sample_mesh(Sphere{1.0}, {.topology = topology, .subdivisions = n});
      const Mesh narrow = in_float(mesh);
      double uv_area = 0;
      for (const Triangle& t : mesh.triangles) {
        const auto [least, greatest] = std::minmax({mesh.uvs[t[0]].x, mesh.uvs[t[1]].x, mesh.uvs[t[2]].x});
        EXPECT_LE(greatest - least, 0.5);
        EXPECT_GT(signed_uv_area2(mesh.uvs[t[0]], mesh.uvs[t[1]], mesh.uvs[t[2]]), 0);
        uv_area += signed_uv_area2(mesh.uvs[t[0]], mesh.uvs[t[1]], mesh.uvs[t[2]]) / 2;
      }
      EXPECT_EQ(mesh.uvs, narrow.uvs) << "uvs that a float does not hold";
      // The uvs cover the square once, but for half of each cell at the poles: pole triangles are half a cell
      // of it each.
      double at_poles = 0;
      for (const Triangle& t : mesh.triangles)
        for (int k = 0; k < 3; ++k)
          if (const Vec2<double>& p = mesh.uvs[t[k]], &q = mesh.uvs[t[(k + 1) % 3]],
              &r = mesh.uvs[t[(k + 2) % 3]];
              r.y == 0 || r.y == 1)
            at_poles += std::fabs((q.x - p.x) * ((p.y + q.y) / 2 - r.y)) / 2;
      EXPECT_NEAR(uv_area + at_poles, 1, 1e-7);  // pole vertices are off the middle by up to 2^-24
      // Each pole vertex belongs to one triangle, in the middle of its other two.
      std::map<std::uint32_t, int> uses;
      for (const Triangle& t : mesh.triangles)
        for (int k = 0; k < 3; ++k)
          if (const double v = mesh.uvs[t[k]].y; v == 0 || v == 1) {
            ++uses[t[k]];
            const double mean = (mesh.uvs[t[(k + 1) % 3]].x + mesh.uvs[t[(k + 2) % 3]].x) / 2;
            EXPECT_NEAR(mesh.uvs[t[k]].x, mean, 0x1p-24);  // rounded to multiples of 2^-23
          }
      EXPECT_EQ(uses.size(), topology == MeshTopology::icosphere ? 10u : 12u);
      for (const auto& [v, number] : uses) EXPECT_EQ(number, 1);
    }
}

// The area of inscribed triangles converges with order 2 on every family of bounded angles.
TEST(ReferenceMeshes, AreaConverges) {
  const auto order = [](const AnySurface& surface, double truth, auto options) {
    const double coarse = truth - area(sample_mesh(surface, options(16)));
    const double fine = truth - area(sample_mesh(surface, options(32)));
    return std::log2(coarse / fine);
  };
  const auto grid = [](int n) { return SampleMeshOptions{.columns = 2 * n, .rows = n}; };
  const auto half_cell = [&](int n) {
    SampleMeshOptions o = grid(n);
    o.pole = PolePlacement::half_cell;
    return o;
  };
  const auto icosphere = [](int n) {
    return SampleMeshOptions{.topology = MeshTopology::icosphere, .subdivisions = n};
  };
  const auto cube_sphere = [](int n) {
    return SampleMeshOptions{.topology = MeshTopology::cube_sphere, .subdivisions = n};
  };
  // The next term of the error is two orders higher: 1/16² of the first.
  for (const auto& options :
       {std::function<SampleMeshOptions(int)>(grid), {half_cell}, {icosphere}, {cube_sphere}})
    EXPECT_NEAR(order(Sphere{1.0}, 4 * pi, options), 2, 0.02);
  EXPECT_NEAR(order(Torus{1.0, 0.4}, 4 * pi * pi * 0.4, grid), 2, 0.02);
  EXPECT_NEAR(order(Cylinder{1.0, 2.0}, 4 * pi, grid), 2, 0.02);
}

TEST(ReferenceMeshes, TheLanternsAreaDependsOnItsRows) {
  const double r = 1.5, h = 2;
  const auto lantern = [&](int m, int n) {
    return area(sample_mesh(Cylinder{r, h}, {.topology = MeshTopology::lantern, .columns = m, .rows = n}));
  };
  for (const auto& [m, n] : {std::pair{3, 1}, {5, 7}, {8, 64}, {40, 3}}) {
    const double truth = 2 * m * n * r * std::sin(pi / m) * std::hypot(h / n, r * (1 - std::cos(pi / m)));
    // 2mn triangles of equal area, each to a few roundings of the coordinates over its least height.
    EXPECT_NEAR(lantern(m, n), truth, 1e-13 * truth) << m << " x " << n;
  }
  EXPECT_NEAR(lantern(64, 64), 2 * pi * r * h, 2 * pi * r * h * 2e-3);  // n = m: error of order 1/m²
  const double limit = 2 * pi * r * std::sqrt(h * h + std::pow(pi, 4) * r * r / 4);
  // n = m²: another limit, up to sin(π/m) and 1 - cos(π/m), shares of π²/6m² and π²/12m²
  // below π/m and π²/2m².
  EXPECT_NEAR(lantern(32, 32 * 32), limit, limit * 2.5 / (32 * 32));
  EXPECT_GT(limit, 3 * 2 * pi * r * h);
  EXPECT_GT(lantern(8, 8 * 8 * 8), 4 * lantern(8, 8 * 8));  // n = m³: none
}

TEST(ReferenceMeshes, PolesHaveTheVerticesAskedFor) {
  const int columns = 14;
  for (const PolePlacement pole :
       {PolePlacement::per_column, PolePlacement::half_cell, PolePlacement::shared})
    for (const bool random_diagonals : {false, true}) {
      const Mesh mesh = sample_mesh(
          Sphere{1.0},
          {.columns = columns, .rows = 9, .pole = pole, .jitter = 0.2, .random_diagonals = random_diagonals});
      std::set<double> u[2];
      int vertices = 0;
      for (const Vec2<double>& uv : mesh.uvs)
        if (uv.y == 0 || uv.y == 1) u[uv.y > 0].insert(uv.x), ++vertices;
      if (pole == PolePlacement::shared) {
        EXPECT_EQ(vertices, 2);
        EXPECT_EQ(u[0], std::set{0.5});
        EXPECT_EQ(u[1], std::set{0.5});
      } else if (pole == PolePlacement::half_cell) {
        std::set<double> middles;
        for (int i = 0; i < columns; ++i) middles.insert((i + 0.5) / columns);
        EXPECT_EQ(u[0], middles);
        EXPECT_EQ(u[1], middles);
        EXPECT_EQ(vertices, 2 * columns);
      } else if (!random_diagonals) {
        EXPECT_EQ(vertices, 2 * columns);
        for (const double x : u[0]) EXPECT_EQ(std::rint(x * columns) / columns, x);
      }
      EXPECT_EQ(mesh.triangles.size(), 2u * columns * 8u);
    }
  // Each half of a mirrored mesh has its own pole.
  const Mesh mirrored = sample_mesh(
      Sphere{1.0}, {.columns = columns, .rows = 9, .pole = PolePlacement::shared, .mirror = true});
  EXPECT_EQ(std::count_if(mirrored.uvs.begin(), mirrored.uvs.end(), [](const auto& uv) { return uv.y == 1; }),
            2);
}

// A sphere scaled is an ellipsoid, by its own formulas; mirrored in x it is the ellipsoid at 1/2 - u, seen
// backwards.
TEST(ReferenceMeshes, AScaledSphereIsAnEllipsoid) {
  for (const double sign : {1.0, -1.0}) {
    const Mesh scaled = sample_mesh(Sphere{2.0}, {.columns = 12, .rows = 7, .scale = {sign, 0.35, 0.25}});
    const AnySurface ellipsoid = Ellipsoid{2.0, 0.7, 0.5};
    for (std::size_t i = 0; i < scaled.positions.size(); ++i) {
      const auto [u, v] = scaled.uvs[i];
      const Sample<double> s = ellipsoid.sample(sign > 0 ? u : 0.5 - u, v);
      EXPECT_LE(norm(scaled.positions[i] - s.jet.position), 1e-14);
      EXPECT_LE(norm(scaled.normals[i] - s.frame.n), 1e-14);
      EXPECT_LE(norm(scaled.tangents[i].xyz() - sign * s.frame.t), 1e-14);
      EXPECT_EQ(scaled.tangents[i].w, -sign);
    }
  }
}

TEST(ReferenceMeshes, HaveTheDegenerateTrianglesAskedFor) {
  for_each_permitted([](const AnySurface& surface, const Kind& kind) {
    if (kind.name == "shared pole") return;  // refused with degenerate triangles
    const Mesh sound = sample_mesh(surface, kind.options);
    for (const int asked : {1, 2, 3, 17}) {
      SampleMeshOptions o = kind.options;
      o.degenerate = asked;
      o.shear = 0.5;
      const Mesh mesh = sample_mesh(surface, o);
      EXPECT_EQ(mesh.triangles.size(), sound.triangles.size() + asked);
      EXPECT_EQ(count(mesh, is_degenerate), asked);
      const Mesh narrow = in_float(mesh);
      EXPECT_EQ(count(narrow, is_degenerate), asked);
      EXPECT_TRUE(std::equal(sound.triangles.begin(), sound.triangles.end(), mesh.triangles.begin()));
      double largest = 0;
      for (const Vec3<double>& p : sound.positions)
        largest = std::max({largest, std::fabs(p.x), std::fabs(p.y), std::fabs(p.z)});
      const double step = std::exp2(std::floor(std::log2(largest)) - 22);
      for (std::size_t v = 0; v < sound.positions.size(); ++v) {
        EXPECT_NEAR(mesh.uvs[v].y, sound.uvs[v].y, 0x1p-21);
        const Sample<double> s = surface.sample(mesh.uvs[v].x - 0.5 * mesh.uvs[v].y, mesh.uvs[v].y);
        const Vec3<double> moved = mesh.positions[v] - s.jet.position;
        EXPECT_LE(std::max({std::fabs(moved.x), std::fabs(moved.y), std::fabs(moved.z)}), 0.5 * step);
        EXPECT_EQ(mesh.normals[v], s.frame.n);
        EXPECT_EQ(mesh.tangents[v].xyz(), s.frame.t);
      }
      // The three kinds in turn.
      for (int k = 0; k < asked; ++k) {
        const auto& [a, b, c] = mesh.triangles[sound.triangles.size() + k];
        const std::set<std::uint32_t> vertices{a, b, c};
        EXPECT_EQ(vertices.size(), k % 3 == 2 ? 2u : 3u);
        const auto& p = mesh.positions;
        const bool twice = p[a] == p[b] || p[b] == p[c] || p[c] == p[a];
        EXPECT_EQ(twice, k % 3 != 0);
        EXPECT_TRUE(is_degenerate_in_uv(mesh, {a, b, c}));
        EXPECT_TRUE(is_degenerate_in_uv(narrow, {a, b, c}));
        if (k % 3 != 0) continue;
        EXPECT_EQ(p[b], (p[a] + p[c]) / 2.0);
        const Vec2<double> middle = (mesh.uvs[a] + mesh.uvs[c]) / 2.0;
        const Sample<double> s = surface.sample(middle.x - 0.5 * middle.y, middle.y);
        EXPECT_EQ(mesh.normals[b], s.frame.n);
        EXPECT_EQ(mesh.tangents[b].xyz(), s.frame.t);
      }
    }
  });
}

TEST(ReferenceMeshes, HaveTheDegenerateUvsAskedFor) {
  for_each_permitted([](const AnySurface& surface, const Kind& kind) {
    const Mesh sound = sample_mesh(surface, kind.options);
    const auto all = static_cast<int>(sound.triangles.size());
    for (const int asked : {1, 2, 17, all}) {
      SampleMeshOptions o = kind.options;
      o.degenerate_uvs = asked;
      const Mesh mesh = sample_mesh(surface, o);
      ASSERT_EQ(mesh.triangles.size(), sound.triangles.size());
      EXPECT_EQ(count(mesh, is_degenerate_in_uv), asked);
      EXPECT_EQ(count(mesh, is_degenerate), 0);
      std::set<std::uint32_t> used;
      int one_uv = 0;
      for (int t = 0; t < all; ++t) {
        for (int k = 0; k < 3; ++k) {
          const std::uint32_t was = sound.triangles[t][k], is = mesh.triangles[t][k];
          used.insert(is);
          EXPECT_EQ(mesh.positions[is], sound.positions[was]);
          EXPECT_EQ(mesh.normals[is], sound.normals[was]);
          EXPECT_EQ(mesh.tangents[is], sound.tangents[was]);
          EXPECT_TRUE(is_degenerate_in_uv(mesh, mesh.triangles[t]) || mesh.uvs[is] == sound.uvs[was]);
        }
        const auto& [a, b, c] = mesh.triangles[t];
        one_uv += mesh.uvs[a] == mesh.uvs[b] && mesh.uvs[b] == mesh.uvs[c];
      }
      EXPECT_EQ(one_uv, (asked + 1) / 2);
      EXPECT_EQ(used.size(), mesh.positions.size()) << "a vertex that no triangle uses";
    }
  });
}

TEST(ReferenceMeshes, RefuseWhatDoesNotGoTogether) {
  const auto refused = [](const AnySurface& surface, const SampleMeshOptions& o,
                          const std::vector<std::string>& parts) {
    const std::string message = test::refusal_of([&] { sample_mesh(surface, o); });
    for (const std::string& part : parts)
      EXPECT_NE(message.find(part), std::string::npos) << part << " in: " << message;
  };
  const SampleMeshOptions ico{.topology = MeshTopology::icosphere};
  const auto with = [](SampleMeshOptions o, auto change) {
    change(o);
    return o;
  };
  refused(Torus{}, ico, {"icosphere", "torus", "sphere"});
  refused(Cylinder{}, {.topology = MeshTopology::cube_sphere}, {"cube-sphere", "cylinder", "sphere"});
  refused(Sphere{}, {.topology = MeshTopology::cube_sphere, .subdivisions = 5},
          {"subdivisions", "5", "even"});
  refused(Sphere{}, with(ico, [](auto& o) { o.subdivisions = 0; }), {"subdivisions", "0", "1"});
  refused(Sphere{}, with(ico, [](auto& o) { o.subdivisions = 2001; }), {"subdivisions", "2001", "2000"});
  refused(Sphere{}, with(ico, [](auto& o) { o.jitter = 0.1; }), {"icosphere", "jitter", "grid"});
  refused(Sphere{}, with(ico, [](auto& o) { o.random_diagonals = true; }),
          {"icosphere", "diagonals", "grid"});
  refused(Sphere{}, with(ico, [](auto& o) { o.mirror = true; }), {"icosphere", "mirror", "grid"});
  refused(Sphere{}, with(ico, [](auto& o) { o.shared_seam = true; }), {"icosphere", "seam", "split"});
  refused(Sphere{}, with(ico, [](auto& o) { o.v_last = 0.5; }), {"icosphere", "v from 0 to 1"});
  refused(Sphere{}, with(ico, [](auto& o) { o.pole = PolePlacement::shared; }),
          {"icosphere", "pole", "grid"});
  refused(Sphere{}, {.topology = MeshTopology::lantern}, {"lantern", "sphere", "cylinder"});
  refused(Cone{}, {.topology = MeshTopology::lantern}, {"lantern", "cone", "cylinder"});
  refused(Cylinder{}, {.topology = MeshTopology::lantern, .columns = 2}, {"grid", "2", "3"});
  refused(Torus{}, {.pole = PolePlacement::half_cell}, {"pole", "torus", "sphere"});
  refused(Sphere{}, {.pole = PolePlacement::shared, .v_first = 0.1, .v_last = 0.9}, {"pole", "sphere"});
  refused(Sphere{}, {.scale = {1, 0, 1}}, {"scale", "0"});
  refused(Sphere{}, {.scale = {1, NAN, 1}}, {"scale", "nan"});
  refused(Sphere{}, {.scale = {1, 9e-31, 1}}, {"scale", "9e-31", "1e-30"});
  refused(Sphere{}, {.scale = {1, 1, -2e30}}, {"scale", "2e+30", "1e30"});
  refused(Sphere{}, {.scale = {1e-6, 1, 2e6}}, {"scale", "2e+06", "1e-06", "1e12"});
  refused(Sphere{}, {.shear = -1001}, {"shear", "-1001", "1000"});
  refused(Torus{}, {.columns = 1, .rows = 1}, {"grid", "1x1", "torus", "fine enough"});
  refused(Torus{}, {.columns = 100000, .rows = 501}, {"grid", "100000x501", "5e7"});
  refused(Sphere{}, {.degenerate = -1}, {"degenerate", "-1"});
  refused(Sphere{}, {.columns = 4, .rows = 4, .degenerate = 25}, {"degenerate", "25", "24"});
  refused(Sphere{}, {.shared_seam = true, .degenerate = 1}, {"degenerate", "split"});
  refused(Sphere{}, {.degenerate_uvs = -1}, {"degenerate-uvs", "-1"});
  refused(Sphere{}, {.columns = 4, .rows = 4, .degenerate_uvs = 25}, {"degenerate-uvs", "25", "24"});
}

}  // namespace
}  // namespace darboux::reference_meshes_test
