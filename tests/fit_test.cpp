#include <algorithm>
#include <cmath>
#include <iostream>
#include <random>

#include <gtest/gtest.h>

#include <darboux/catalogue.h>
#include <darboux/error.h>
#include <darboux/fit.h>
#include <darboux/sample_mesh.h>

#include "random_pose.h"

namespace darboux {
namespace {

std::vector<AnySurface> fitted_surfaces() {
  std::vector<AnySurface> list;
  for (const std::string_view kind : fitted_kinds()) list.push_back(make_surface(kind));
  return list;
}

constexpr std::uint64_t seed = 11;

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
  for (int trial = 0; trial < 30; ++trial)
    for (const AnySurface& kind : fitted_surfaces()) {
      const double scale = std::pow(10, 12 * uniform(random) - 6);
      SurfaceSpecification specification{std::string(kind.info().name), {}};
      for (const ParameterValue& p : kind.parameters())
        specification.parameters.emplace_back(p.name, scale * (0.2 + uniform(random)) *
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
      // Positions are rounded to u of the offset (some 30 scales); the fit averages that, it must not add to it.
      const double tolerance = 64 * 0x1p-53 * 4 * offset;
      EXPECT_LE(fit.rms, tolerance) << surface.specification();
      for (const ParameterValue& p : surface.parameters())
        EXPECT_NEAR(value(fit.surface.surface, p.name), p.value, tolerance) << surface.specification();
      EXPECT_GT(fit.surface.placement.linear().determinant(), 0);
      // The placement, up to the surface's own symmetries: the truth at every vertex's uv is the stored normal.
      for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
        const Truth truth = fit.surface.truth(mesh.uvs[v]);
        EXPECT_LE(norm(truth.position - mesh.positions[v]), 2 * tolerance);
        EXPECT_LE(norm(truth.normal - mesh.normals[v]), 1e-11);
        EXPECT_LE(norm(truth.tangent - mesh.tangents[v].xyz()), 1e-11);
      }
      const MeshFit recognised = fit_any_surface(mesh);
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
      const MeshFit fit = fit_any_surface(mesh);
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
  for (const AnySurface& surface : fitted_surfaces())
    for (const AnySurface& other : fitted_surfaces()) {
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
  const MeshFit stretched = fit_any_surface(mesh);
  EXPECT_TRUE(stretched.fits);
  EXPECT_EQ(stretched.surface.surface.info().name, "ellipsoid");
  // Nor is one with a dent anything.
  for (auto& p : mesh.positions)
    if (p.z > 0.5) p.z -= 0.1 * (p.z - 0.5);
  EXPECT_FALSE(fit_any_surface(mesh).fits);
}

TEST(Fit, ErrorsAreClear) {
  Mesh mesh = sample_mesh(Sphere{1.0}, {.columns = 8, .rows = 5});
  EXPECT_THROW(fit_surface(mesh, {"sphre", {}}), ParameterError);
  EXPECT_THROW(fit_surface(mesh, {"sphere", {{"radius", -1.0}}}), ParameterError);
  EXPECT_THROW(fit_surface(mesh, {"sphere", {{"size", 1.0}}}), ParameterError);
  Mesh no_uvs = mesh;
  no_uvs.uvs.clear();
  EXPECT_THROW(fit_any_surface(no_uvs), MeshError);
  Mesh point = mesh;
  for (auto& p : point.positions) p = {1, 2, 3};
  EXPECT_THROW(fit_any_surface(point), MeshError);
  Mesh nothing;
  nothing.uvs.clear();
  EXPECT_THROW(fit_any_surface(nothing), MeshError);
  // NaN positions are passed over, the rest decides.
  mesh.positions[7].x = NAN;
  EXPECT_TRUE(fit_any_surface(mesh).fits);
}

// More vertices than the fit looks at, in rows whose length its stride could keep step with.
TEST(Fit, SamplesKeepNoStepWithRows) {
  const Mesh mesh = sample_mesh(Torus{1.0, 0.4}, {.columns = 8, .rows = 4095});
  ASSERT_EQ(mesh.positions.size(), 9u * 4096u);
  EXPECT_TRUE(fit_any_surface(mesh).fits);
  const MeshFit fit = fit_surface(mesh, {"torus", {}});
  EXPECT_NEAR(value(fit.surface.surface, "major_radius"), 1, 1e-12);
}

// Points on a line are no thin cylinder.
TEST(Fit, ALineIsNoSurface) {
  Mesh mesh = sample_mesh(Cylinder{1.0, 1.0}, {.columns = 8, .rows = 8});
  for (std::size_t v = 0; v < mesh.positions.size(); ++v) mesh.positions[v] = {mesh.uvs[v].x, 0, 0};
  EXPECT_FALSE(fit_any_surface(mesh).fits);
}

}  // namespace
}  // namespace darboux
