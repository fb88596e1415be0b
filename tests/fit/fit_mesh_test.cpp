#include <algorithm>
#include <cmath>
#include <iostream>
#include <random>

#include <gtest/gtest.h>

#include <darboux/catalogue.h>
#include <darboux/error.h>
#include <darboux/fit_mesh.h>
#include <darboux/sample_mesh.h>

#include "fit/fit_kinds.h"
#include "mesh/triangle_signs.h"
#include "random_pose.h"

namespace darboux::fit_mesh_test {
namespace {

std::vector<AnySurface> fitted_surfaces() {
  std::vector<AnySurface> list;
  for (const std::string_view kind : fitted_kinds()) list.push_back(make_surface(kind));
  return list;
}

// The first of all kinds that fits, else the nearest. \param mesh consistent
MeshFit fit_any_kind(const Mesh& mesh) {
  return fit_kinds(mesh, std::nullopt, fitted_kinds(), UvMaps::any, triangle_signs(mesh)).value();
}

constexpr std::uint64_t seed = 11;

// Parameters that are numbers, not lengths.
bool is_shape(std::string_view parameter) {
  return parameter == "turns" || parameter == "extent";
}

double value(const AnySurface& surface, std::string_view name) {
  for (const ParameterValue& p : surface.parameters())
    if (p.name == name) return p.value;
  ADD_FAILURE() << "no parameter " << name;
  return 0;
}

// The mesh's uvs under a convention: stored so that convention.surface_uv(stored) is the surface's.
void store_as(Mesh& mesh, const UvConvention& convention) {
  Eigen::Matrix2d m;
  m << convention.affine[0], convention.affine[1], convention.affine[2], convention.affine[3];
  const Eigen::Vector2d offset(convention.affine[4], convention.affine[5]);
  for (auto& uv : mesh.uvs) {
    const Eigen::Vector2d stored = m.inverse() * (Eigen::Vector2d(uv.x, uv.y) - offset);
    uv = {stored[0], stored[1]};
  }
}

// Every surface, random parameters, poses and scales from 1e-6 to 1e6: noise-free data give everything back.
TEST(Fit, RecoversPlacementAndParameters) {
  std::cout << "seed " << seed << '\n';
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> uniform(0, 1);
  for (int trial = 0; trial < 10; ++trial)
    for (const AnySurface& kind : fitted_surfaces()) {
      const double scale = std::pow(10, 12 * uniform(random) - 6);
      SurfaceSpecification specification{std::string(kind.info().name), {}};
      for (const ParameterValue& p : kind.parameters())
        specification.parameters.emplace_back(p.name, is_shape(p.name)
                                                          ? 0.7 + 0.6 * uniform(random)
                                                          : scale * (0.2 + uniform(random)) *
                                                                (p.name == "major_radius"   ? 3
                                                                 : p.name == "inner_radius" ? 0.15
                                                                                            : 1));
      const AnySurface surface = make_surface(specification);
      Mesh mesh = sample_mesh(surface, {.columns = 16, .rows = 9, .jitter = 0.2, .seed = random()});
      const double offset = 10 * scale;
      place(mesh, random_pose(random, offset));
      const MeshFit fit = fit_surface(mesh, {specification.name, {}});
      ASSERT_TRUE(fit.fits) << surface.specification();
      EXPECT_EQ(fit.surface.uv.name, "as stored") << surface.specification();
      // Positions are rounded to u of the offset (some 30 scales); the fit averages that, it must not add to
      // it.
      const double tolerance = 64 * 0x1p-53 * 4 * offset;
      EXPECT_LE(fit.rms, tolerance) << surface.specification();
      for (const ParameterValue& p : surface.parameters())
        EXPECT_NEAR(value(fit.surface.surface, p.name), p.value,
                    is_shape(p.name) ? tolerance / scale : tolerance)
            << surface.specification();
      EXPECT_GT(fit.surface.placement.linear().determinant(), 0);
      // The placement, up to the surface's own symmetries: the truth at every vertex's uv is the stored
      // normal.
      for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
        const Truth truth = fit.surface.truth(mesh.uvs[v]);
        EXPECT_LE(norm(truth.position - mesh.positions[v]), 2 * tolerance);
        EXPECT_LE(norm(truth.normal - mesh.normals[v]), 1e-11);
        EXPECT_LE(norm(truth.tangent - mesh.tangents[v].xyz()), 1e-11);
      }
      const MeshFit recognised = fit_any_kind(mesh);
      EXPECT_TRUE(recognised.fits);
      EXPECT_EQ(recognised.surface.surface.info().name, kind.info().name);
    }
}

// Each convention is found, or one that the surface's symmetry makes equal and that comes before it.
TEST(Fit, NamesTheUvConvention) {
  for (const AnySurface& surface : fitted_surfaces())
    for (const UvConvention& convention : uv_conventions()) {
      std::mt19937_64 random(seed);
      Mesh mesh = sample_mesh(surface, {.columns = 16, .rows = 9});
      place(mesh, random_pose(random, 1));
      store_as(mesh, convention);
      const MeshFit fit = fit_any_kind(mesh);
      ASSERT_EQ(fit.surface.surface.info().name, surface.info().name) << convention.name;
      ASSERT_TRUE(fit.fits) << surface.info().name << ", " << convention.name;
      const bool named = fit.surface.uv.name == convention.name;
      const bool equivalent =
          std::find(fit.equivalent.begin(), fit.equivalent.end(), convention.name) != fit.equivalent.end();
      EXPECT_TRUE(named || equivalent)
          << surface.info().name << ", " << convention.name << " taken for " << fit.surface.uv.name;
      for (std::size_t v = 0; v < mesh.positions.size(); ++v)
        EXPECT_LE(norm(fit.surface.truth(mesh.uvs[v]).position - mesh.positions[v]), 1e-13);
    }
}

TEST(Fit, HoldsWhatIsGiven) {
  Mesh mesh = sample_mesh(Torus{1.0, 0.4}, {.columns = 16, .rows = 8});
  const MeshFit right = fit_surface(mesh, parse_specification("torus:minor_radius=0.4"));
  EXPECT_TRUE(right.fits);
  EXPECT_EQ(value(right.surface.surface, "minor_radius"), 0.4);
  const MeshFit wrong = fit_surface(mesh, parse_specification("torus:minor_radius=0.3"));
  EXPECT_FALSE(wrong.fits);
  EXPECT_EQ(value(wrong.surface.surface, "minor_radius"), 0.3);
  EXPECT_GT(wrong.rms, 0.05);
  EXPECT_TRUE(fit_surface(mesh, {"torus", {}}, Eigen::Isometry3d::Identity()).fits);
  Eigen::Isometry3d shifted = Eigen::Isometry3d::Identity();
  shifted.translation().x() = 0.1;
  EXPECT_FALSE(fit_surface(mesh, {"torus", {}}, shifted).fits);
}

TEST(Fit, RefusesOtherShapes) {
  // The seven that have no other as their limit.
  std::vector<AnySurface> surfaces = fitted_surfaces();
  surfaces.erase(surfaces.begin() + 7, surfaces.end());
  for (const AnySurface& surface : surfaces)
    for (const AnySurface& other : surfaces) {
      // A sphere is an ellipsoid.
      if (surface.info().name == other.info().name ||
          (surface.info().name == "sphere" && other.info().name == "ellipsoid"))
        continue;
      const Mesh mesh = sample_mesh(surface, {.columns = 16, .rows = 9});
      try {
        EXPECT_FALSE(fit_surface(mesh, {std::string(other.info().name), {}}).fits)
            << surface.info().name << " taken for " << other.info().name;
      } catch (const MeshError&) {
        // Also an answer: no convention even starts.
      }
    }
  // A sphere stretched by one per cent is no sphere.
  Mesh mesh = sample_mesh(Sphere{1.0}, {.columns = 16, .rows = 9});
  for (auto& p : mesh.positions) p.x *= 1.01;
  EXPECT_FALSE(fit_surface(mesh, {"sphere", {}}).fits);
  const MeshFit stretched = fit_any_kind(mesh);
  EXPECT_TRUE(stretched.fits);
  EXPECT_EQ(stretched.surface.surface.info().name, "ellipsoid");
  // Nor is one with a dent anything.
  for (auto& p : mesh.positions)
    if (p.z > 0.5) p.z -= 0.1 * (p.z - 0.5);
  EXPECT_FALSE(fit_any_kind(mesh).fits);
}

TEST(Fit, ErrorsAreClear) {
  Mesh mesh = sample_mesh(Sphere{1.0}, {.columns = 8, .rows = 5});
  EXPECT_THROW(fit_surface(mesh, {"sphre", {}}), ParameterError);
  EXPECT_THROW(fit_surface(mesh, {"sphere", {{"radius", -1.0}}}), ParameterError);
  EXPECT_THROW(fit_surface(mesh, {"sphere", {{"size", 1.0}}}), ParameterError);
  Mesh no_uvs = mesh;
  no_uvs.uvs.clear();
  EXPECT_THROW(fit_any_kind(no_uvs), MeshError);
  Mesh point = mesh;
  for (auto& p : point.positions) p = {1, 2, 3};
  EXPECT_THROW(fit_any_kind(point), MeshError);
  Mesh nothing;
  nothing.uvs.clear();
  EXPECT_THROW(fit_any_kind(nothing), MeshError);
  const Mesh good = mesh;
  mesh.uvs.resize(10);
  EXPECT_THROW(fit_surface(mesh, {"sphere", {}}), MeshError);
  mesh = good;
  mesh.triangles[3][1] = 4000000000;
  EXPECT_THROW(fit_surface(mesh, {"sphere", {}}), MeshError);
  mesh = good;
  const MeshFit fit = fit_surface(mesh, {"sphere", {}});
  EXPECT_THROW(truths(no_uvs, fit), MeshError);
  for (const Eigen::Vector3d& scale : {Eigen::Vector3d(3, 1, 1), Eigen::Vector3d(-1, 1, 1)}) {
    Eigen::Isometry3d placement = Eigen::Isometry3d::Identity();
    placement.linear() = scale.asDiagonal();
    EXPECT_THROW(fit_surface(mesh, {"sphere", {}}, placement), ParameterError);
    EXPECT_THROW(fit_surface(mesh, make_surface("sphere"), placement), ParameterError);
    EXPECT_THROW(fit_positions(mesh, std::nullopt, placement), ParameterError);
  }
  // NaN positions are passed over, the rest decides.
  mesh.positions[7].x = NAN;
  EXPECT_TRUE(fit_any_kind(mesh).fits);
}

// A half-turn takes these to themselves with their sides exchanged: under a flip or an affine map that fits,
// too, n was on the wrong side, and normal maps were baked inside out. Uvs are floats, as files store them:
// their roundings hid which of many maps that linear equations leave alike is rigid.
TEST(Fit, AnExactSurfaceIsOnTheSideOfTheMesh) {
  const UvConvention maps[] = {{"flip v", {1, 0, 0, -1, 0, 1}},
                               {"flip u", {-1, 0, 0, 1, 1, 0}},
                               {"affine", {1 / 0.9, 0, 0, 1 / 0.9, -0.05 / 0.9, -0.05 / 0.9}},
                               {"affine", {2, 0, 0, 2, -0.5, -0.5}}};
  for (const char* name : {"plane:width=2,depth=1", "enneper", "bilinear-patch", "monkey-saddle",
                           "hyperbolic-paraboloid:semi_axis_x=2"})
    for (const UvConvention& map : maps) {
      SCOPED_TRACE(std::string(name) + ' ' + std::string(map.name) + ' ' + std::to_string(map.affine[0]));
      const AnySurface surface = make_surface(name);
      Mesh mesh = sample_mesh(surface, {.columns = 24, .rows = 16});
      store_as(mesh, map);
      const auto round = [](double& x) { x = static_cast<float>(x); };
      for (auto& p : mesh.positions) round(p.x), round(p.y), round(p.z);
      for (auto& uv : mesh.uvs) round(uv.x), round(uv.y);
      const MeshFit fit = fit_surface(mesh, surface);
      ASSERT_TRUE(fit.fits) << fit.rms_relative;
      for (std::size_t v = 0; v < mesh.positions.size(); ++v)
        ASSERT_GT(dot(fit.surface.truth(mesh.uvs[v]).normal, mesh.normals[v]), 0.99) << v;
      // Without normals the triangles tell.
      mesh.normals.clear();
      const MeshFit by_triangles = fit_surface(mesh, surface);
      EXPECT_TRUE(by_triangles.surface.placement.isApprox(fit.surface.placement, 1e-6));
    }
}

// More vertices than the fit looks at, in rows whose length its stride could keep step with.
TEST(Fit, SamplesKeepNoStepWithRows) {
  const Mesh mesh = sample_mesh(Torus{1.0, 0.4}, {.columns = 8, .rows = 4095});
  ASSERT_EQ(mesh.positions.size(), 9u * 4096u);
  EXPECT_TRUE(fit_any_kind(mesh).fits);
  const MeshFit fit = fit_surface(mesh, {"torus", {}});
  EXPECT_NEAR(value(fit.surface.surface, "major_radius"), 1, 1e-12);
}

// Stored uvs that are an affine image of the surface's, none of the eight swaps and flips: everything comes
// back, and what scale and offset share with lengths and placement goes to these.
TEST(Fit, FindsAffineUvs) {
  struct Case {
    std::string surface;
    std::array<double, 6> of_surface;  // M and offset: stored -> surface
    Vec2<double> to{1, 1};             // stored uvs run from 0 to this
  };
  const std::vector<Case> cases{
      {"torus", {1, 0, 0, 1, 0, 0.25}},                       // v stored from another circle
      {"torus", {1, 0, 0, 0.5, 0, 0}, {1, 2}},                // v stored from 0 to 2
      {"torus", {0.5, 0, 0, 0.5, 0, 0.1}},                    // a quarter, stored as a whole
      {"torus", {1, 0.5, 0, 1, 0, 0}},                        // sheared
      {"torus", {0, 1, 0.5, 0, 0, 0.3}},                      // swapped and scaled
      {"sphere", {0.25, 0, 0, 0.5, 0, 0.25}},                 // a patch
      {"sphere", {1, 0.3, 0, 1, 0, 0}},                       // sheared
      {"cylinder", {1, 1, 0, 1, 0, 0}},                       // sheared by a turn
      {"cylinder", {0.3, 0, 0, 1, 0, 0}},                     // a strip
      {"cone", {1, 0, 0, 0.6, 0, 0}},                         // a frustum
      {"plane", {1, 0.4, 0, 1, 0, 0}},                        // a parallelogram
      {"disk", {0.5, 0, 0, 1, 0, 0}},                         // half of it
      {"ellipsoid", {0.5, 0, 0, 0.8, 0.1, 0.1}},              // a patch
      {"elliptic-paraboloid", {1, 0, 0, 0.5, 0, 0.25}},       // a band, its offset told and its scale not
      {"hyperbolic-paraboloid", {0.5, 0, 0, 0.5, 0.2, 0.1}},  // a patch
      {"two-sheet-hyperboloid", {0.5, 0, 0, 0.5, 0, 0.3}},    // a patch
  };
  for (const Case& c : cases) {
    std::mt19937_64 random(seed);
    PlacedSurface truth{
        make_surface(c.surface == "ellipsoid" ? "ellipsoid:semi_axis_x=1,semi_axis_y=0.8,semi_axis_z=0.6"
                                              : c.surface),
        random_pose(random, 1),
        {"truth", c.of_surface}};
    Mesh mesh = sample_mesh(Plane{1.0, 1.0}, {.columns = 24, .rows = 24});
    for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
      mesh.uvs[v] = {c.to.x * mesh.uvs[v].x, c.to.y * mesh.uvs[v].y};
      mesh.positions[v] = truth.position(mesh.uvs[v]);
    }
    for (const bool declared : {true, false}) {
      const MeshFit fit = declared ? fit_surface(mesh, {c.surface, {}}) : fit_any_kind(mesh);
      ASSERT_TRUE(fit.fits) << c.surface << " " << fit.rms_relative;
      if (!declared && fit.surface.surface.info().name != c.surface) {
        ADD_FAILURE() << c.surface << " taken for " << fit.surface.surface.specification(6);
        continue;
      }
      EXPECT_EQ(fit.surface.uv.name, "affine") << c.surface;
      for (std::size_t v = 0; v < mesh.positions.size(); ++v)
        EXPECT_LE(norm(fit.surface.truth(mesh.uvs[v]).position - mesh.positions[v]), 1e-12) << c.surface;
      if (c.surface == "cone") {  // the radius is the one at stored v = 0
        EXPECT_NEAR(value(fit.surface.surface, "radius"), 1, 1e-12);
        EXPECT_NEAR(fit.surface.uv.affine[3], 0.6, 1e-12);
      }
    }
  }
}

// Twelve numbers are no more than a surface and an affine map of its uvs have: through a quad such surfaces
// go as a rule.
TEST(Fit, NoAffineMapForAQuad) {
  Mesh quad;
  quad.positions = {{1, 0, 0}, {0, -0.1, 0.1}, {0, -1.5, 0.3}, {-1, 0, 0}};
  quad.uvs = {{0.7, 2.1}, {0.4, 0.6}, {1.5, 0.3}, {-0.1, -0.8}};
  quad.triangles = {{0, 1, 2}, {3, 2, 1}};
  const MeshFit fit = fit_any_kind(quad);
  EXPECT_FALSE(fit.fits);
  EXPECT_NE(fit.surface.uv.name, "affine") << fit.surface.surface.specification(6);
}

// A cylinder stored with v from 0 to 3 is one whose height is that of one unit of v.
TEST(Fit, LengthsAbsorbWhatTheyCan) {
  Mesh mesh = sample_mesh(Cylinder{1.0, 6.0}, {.columns = 24, .rows = 8});
  for (auto& uv : mesh.uvs) uv.y *= 3;
  const MeshFit fit = fit_any_kind(mesh);
  ASSERT_TRUE(fit.fits);
  EXPECT_EQ(fit.surface.uv.name, "as stored");
  EXPECT_NEAR(value(fit.surface.surface, "height"), 2, 1e-13);
}

// All vertices count, also where there are more than the fit looks at first.
TEST(Fit, EveryVertexCounts) {
  Mesh mesh = sample_mesh(Sphere{1.0}, {.columns = 200, .rows = 100});
  for (std::size_t v = 0; v < mesh.positions.size(); ++v)
    if (mesh.uvs[v].y > 0.5) mesh.positions[v] = 1.00002 * mesh.positions[v];
  const MeshFit fit = fit_surface(mesh, {"sphere", {}});
  ASSERT_TRUE(fit.fits);
  // Least squares for z = radius: symmetric halves would give 1.00001; whatever it is, no sphere near it is
  // better.
  const auto rms = [&](double radius) {
    double sum = 0;
    const AnySurface sphere{Sphere{radius}};
    for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
      const auto d =
          from_eigen(fit.surface.placement * to_eigen(sphere.jet(mesh.uvs[v].x, mesh.uvs[v].y).position)) -
          mesh.positions[v];
      sum += dot(d, d);
    }
    return std::sqrt(sum / static_cast<double>(mesh.positions.size()));
  };
  const double radius = value(fit.surface.surface, "radius");
  EXPECT_NEAR(rms(radius), fit.rms, 1e-15);
  EXPECT_LT(rms(radius), rms(radius + 1e-8));
  EXPECT_LT(rms(radius), rms(radius - 1e-8));
}

// Points on a line are no thin cylinder.
// As many unknowns as coordinates, or more: no noise is told, and none is stated.
TEST(Fit, FewVerticesStateNoNoise) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  for (std::uint32_t n = 4; n <= 6; ++n) {
    Mesh mesh;
    for (std::uint32_t i = 0; i < n; ++i) {
      mesh.positions.push_back({normal(random), normal(random), normal(random)});
      mesh.uvs.push_back({normal(random), normal(random)});
      mesh.triangles.push_back({0, 1, i});
    }
    for (const char* kind : {"ellipsoid", "helicoid", "plane"}) {
      const MeshFit fit = fit_surface(mesh, {kind, {}});
      EXPECT_FALSE(fit.fits) << kind;
      EXPECT_EQ(fit.sigma, 0) << kind << ", " << n;
    }
  }
}

TEST(Fit, HugeUvsAreNoCrash) {
  for (const AnySurface& kind : fitted_surfaces())
    for (const double huge : {1e50, 1e90, 1e200}) {
      Mesh mesh = sample_mesh(kind, {.columns = 8, .rows = 8});
      mesh.uvs[20] = {huge, huge};
      try {
        const MeshFit fit = fit_surface(mesh, {std::string(kind.info().name), {}});
        EXPECT_EQ(fit.fits, huge > 1e100) << kind.info().name;  // such a uv says nothing
        EXPECT_TRUE(std::isfinite(fit.rms)) << kind.info().name << ", " << huge;
      } catch (const MeshError&) {
      }
    }
}

TEST(Fit, ALineIsNoSurface) {
  Mesh mesh = sample_mesh(Cylinder{1.0, 1.0}, {.columns = 8, .rows = 8});
  for (std::size_t v = 0; v < mesh.positions.size(); ++v) mesh.positions[v] = {mesh.uvs[v].x, 0, 0};
  EXPECT_FALSE(fit_any_kind(mesh).fits);
}

}  // namespace
}  // namespace darboux::fit_mesh_test
