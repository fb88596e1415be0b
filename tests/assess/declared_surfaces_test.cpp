// Every mesh that sample_mesh() makes of a surface passes where that surface is declared, whatever its kind.
#include <functional>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include <darboux/assess.h>
#include <darboux/error.h>
#include <darboux/sample_mesh.h>

#include "random_meshes.h"
#include "thinning.h"

namespace darboux::declared_surfaces_test {
namespace {

struct Variant {
  const char* name;
  std::function<void(SampleMeshOptions&)> change;
};

// As `darboux validate --surface` does.
AssessOptions declared(const AnySurface& surface) {
  AssessOptions options;
  const auto& fitted = fitted_kinds();
  if (std::find(fitted.begin(), fitted.end(), surface.info().name) != fitted.end())
    options.surface = SurfaceSpecification{std::string(surface.info().name), {}};
  else
    options.exact_surface = surface;
  return options;
}

std::string findings(const std::vector<Assessment>& assessments) {
  std::string text;
  for (const Assessment& j : assessments)
    for (const Finding& f : j.report.findings)
      text += "\n  " + std::string(severity_names[static_cast<std::size_t>(f.severity)]) + ' ' +
              std::string(f.code) + " (" + std::to_string(f.count) + "): " + f.message;
  return text;
}

void expect_pass(const AnySurface& surface, const Mesh& mesh, const AssessOptions& options) {
  const std::vector<Assessment> assessments = assess_parts(mesh, options);
  for (const Assessment& j : assessments)
    ASSERT_EQ(j.report.verdict, Verdict::pass) << surface.info().name << findings(assessments);
  // Of a mirrored mesh one half may go by its triangles.
  const std::optional<MeshFit>& fit = assessments.front().fit;
  ASSERT_TRUE(fit && fit->fits && fit->surface.surface.info().name == surface.info().name)
      << surface.info().name << findings(assessments);
}

// Positions in single precision far from the origin: their roundings were taken for another surface. What is
// declared wrongly is told all the same.
TEST(DeclaredSurfaces, PassFarFromTheOrigin) {
  const Eigen::Vector3d direction(1, 0.004, -0.6);
  for (const AnySurface& surface : all_surfaces())
    for (const double far : {200.0, 50000.0})
      for (const bool tiled : {false, true}) {
        if (tiled && !declared(surface).surface) continue;  // affine maps are sought for fitted kinds
        SCOPED_TRACE(std::to_string(far) + (tiled ? ", tiled" : ""));
        Mesh mesh = sample_mesh(surface, {});
        for (Vec3<double>& p : mesh.positions) p += from_eigen(far * direction);
        if (tiled)
          for (Vec2<double>& uv : mesh.uvs) uv = {4 * uv.x, 2 * uv.y};
        test::round_to_floats(mesh);
        expect_pass(surface, mesh, declared(surface));
        const AnySurface other = make_surface(surface.info().name == "sphere" ? "torus" : "sphere");
        for (const Assessment& j : assess_parts(mesh, declared(other)))
          EXPECT_NE(j.report.verdict, Verdict::pass) << surface.info().name;
      }
}

// Islands of an atlas are small, and lie anywhere; uvs of another tile begin at any whole number. Tangents
// that are turned are told all the same.
TEST(DeclaredSurfaces, PassAnywhereInAnAtlas) {
  struct Map {
    double scale_u, scale_v, u, v;
  };
  int first = 0;
  for (const AnySurface& surface : all_surfaces()) {
    if (!declared(surface).surface) continue;
    int combination = first++;
    Mesh first_tile = sample_mesh(surface, {});
    test::round_to_floats(first_tile);
    const std::string of_the_first_tile = findings(assess_parts(first_tile, declared(surface)));
    for (const Map& map : {Map{0.125, 1, 0, 0}, Map{0.05, 0.3, 0.62, 0.11}, Map{1, 1, 0, 0.25},
                           Map{0.5, 0.5, 0, 0.5}, Map{0.03, 0.04, 0.5, 0.25}, Map{0.125, 1, 0, 1},
                           Map{0.25, 0.1, 3, -1}, Map{1, 1, 0, -1}, Map{1, 1, 2, 3}, Map{1, -1, 0, 0}}) {
      if (!test::is_taken(combination++)) continue;
      SCOPED_TRACE(::testing::Message() << map.scale_u << ' ' << map.scale_v << ' ' << map.u << ' ' << map.v);
      Mesh mesh = sample_mesh(surface, {});
      for (Vec2<double>& uv : mesh.uvs) uv = {map.scale_u * uv.x + map.u, map.scale_v * uv.y + map.v};
      for (Vec4<double>& t : mesh.tangents) t.w *= map.scale_v < 0 ? -1 : 1;
      test::round_to_floats(mesh);
      expect_pass(surface, mesh, declared(surface));
      const bool tile = map.scale_u == 1 && map.scale_v == 1 && map.v == std::floor(map.v);
      if (tile && surface.info().v == Coordinate::half_turn) {
        EXPECT_EQ(findings(assess_parts(mesh, declared(surface))), of_the_first_tile) << surface.info().name;
        EXPECT_EQ(findings(assess_parts(mesh, {})), findings(assess_parts(first_tile, {})))
            << surface.info().name;
      }
      for (std::size_t i = 0; i < mesh.tangents.size(); ++i) {
        const Vec3<double> t = mesh.tangents[i].xyz(), b = cross(mesh.normals[i], t);
        const Vec3<double> turned = std::cos(0.25) * t + std::sin(0.25) * b;  // by 14 degrees
        mesh.tangents[i] = {turned.x, turned.y, turned.z, mesh.tangents[i].w};
      }
      EXPECT_EQ(assess(mesh, declared(surface)).report.verdict, Verdict::fail) << surface.info().name;
    }
  }
}

// Rounded uvs may give a disk an inner radius of a few roundings, of either sign: the tangents of its centre
// have no direction all the same.
TEST(DeclaredSurfaces, RoundingsAtADisksCentreGiveNoDirection) {
  const AnySurface disk = make_surface("disk");
  for (int k = 0; k < 40; ++k) {
    const double scale = k % 2 == 0 ? 1 : 0.04;
    SCOPED_TRACE(k);
    Mesh mesh = sample_mesh(disk, {.columns = 16, .rows = 8});
    for (std::size_t i = 0; i < mesh.uvs.size(); ++i) {
      if (mesh.uvs[i].y == 1) mesh.tangents[i] = {0.6, 0.8, 0, mesh.tangents[i].w};
      mesh.uvs[i] = {scale * mesh.uvs[i].x + 0.0723 * k, 0.0341 * k - scale * mesh.uvs[i].y};
      mesh.tangents[i].w *= -1;
    }
    test::round_to_floats(mesh);
    expect_pass(disk, mesh, declared(disk));
  }
}

// Uvs of an unwrapper, of a map projection, or of no use: the positions tell the declared surface, and other
// ones apart from it.
TEST(DeclaredSurfaces, PassUnderUvsThatAreNotTheirs) {
  struct Map {
    const char* name;
    Vec2<double> (*of)(const Vec2<double>&);
  };
  for (const char* name : {"sphere", "torus", "cylinder", "cone", "plane", "disk", "ellipsoid"})
    for (const Map& map : {Map{"none",
                               [](const Vec2<double>&) {
                                 return Vec2<double>{0, 0};
                               }},
                           Map{"quadratic",
                               [](const Vec2<double>& p) {
                                 return Vec2<double>{p.x, 0.5 * (p.y + p.y * p.y)};
                               }},
                           Map{"small", [](const Vec2<double>& p) {
                                 return Vec2<double>{0.5 + 0.001 * p.x, 0.001 * p.y};
                               }}}) {
      SCOPED_TRACE(std::string(name) + ' ' + map.name);
      const AnySurface surface = make_surface(name);
      Mesh mesh = sample_mesh(surface, {.columns = 24, .rows = 12});
      for (Vec2<double>& uv : mesh.uvs) uv = map.of(uv);
      if (std::string_view(map.name) == "none") mesh.tangents.clear();
      test::round_to_floats(mesh);
      const std::vector<Assessment> assessments = assess_parts(mesh, declared(surface));
      ASSERT_EQ(assessments.size(), 1u);
      EXPECT_EQ(assessments[0].report.verdict, Verdict::pass) << findings(assessments);
      ASSERT_TRUE(assessments[0].fit && assessments[0].fit->fits) << findings(assessments);
      const std::string_view other = std::string_view(name) == "sphere" ? "torus" : "sphere";
      const Assessment wrong = assess(mesh, declared(make_surface(other)));
      EXPECT_NE(wrong.report.verdict, Verdict::pass) << findings({wrong});
    }
}

// Halves of a mirrored mesh have charts of their own: their tangents are judged by these, as they are without
// a declaration, not by the triangles alone.
TEST(DeclaredSurfaces, HalvesOfAMirroredMeshKeepTheirCharts) {
  for (const char* name : {"torus", "sphere"}) {
    const AnySurface surface = make_surface(name);
    Mesh mesh = sample_mesh(surface, {.columns = 48, .rows = 24, .mirror = true});
    for (const Assessment& half : assess_parts(mesh, declared(surface)))
      EXPECT_EQ(half.report.verdict, Verdict::pass) << name << findings({half});
    for (Vec4<double>& t : mesh.tangents) {
      const std::size_t i = static_cast<std::size_t>(&t - mesh.tangents.data());
      const Vec3<double> turned = std::cos(0.25) * t.xyz() + std::sin(0.25) * cross(mesh.normals[i], t.xyz());
      t = {turned.x, turned.y, turned.z, t.w};
    }
    const std::vector<Assessment> assessments = assess_parts(mesh, declared(surface));
    EXPECT_TRUE(std::any_of(assessments.begin(), assessments.end(),
                            [](const Assessment& a) {
                              return a.report.verdict == Verdict::fail && a.fit &&
                                     a.fit->chart != UvChart::unknown;
                            }))
        << name << findings(assessments);
  }
}

TEST(DeclaredSurfaces, EveryReferenceMeshPasses) {
  const Variant variants[] = {
      {"grid", [](auto&) {}},
      {"12x12", [](auto& o) { o.columns = o.rows = 12; }},
      {"sheared", [](auto& o) { o.shear = 1; }},
      {"jittered", [](auto& o) { o.jitter = 0.15; }},
      {"random diagonals", [](auto& o) { o.random_diagonals = true; }},
      {"half-cell poles", [](auto& o) { o.pole = PolePlacement::half_cell; }},
      {"shared poles", [](auto& o) { o.pole = PolePlacement::shared; }},
      {"shared seam", [](auto& o) { o.shared_seam = true; }},
      {"mirrored", [](auto& o) { o.mirror = true; }},
      {"steeply sheared", [](auto& o) { o.shear = -3.25; }},
      {"jittered and sheared", [](auto& o) { o.jitter = 0.3, o.shear = 0.5; }},
      {"degenerate", [](auto& o) { o.degenerate = 30; }},
      {"degenerate uvs", [](auto& o) { o.degenerate_uvs = 30; }},
      {"a part", [](auto& o) { o.v_first = 0.2, o.v_last = 0.7; }},
      {"6x4", [](auto& o) { o.columns = 6, o.rows = 4; }},
      {"lantern", [](auto& o) { o.topology = MeshTopology::lantern; }},
      {"icosphere", [](auto& o) { o.topology = MeshTopology::icosphere; }},
      {"cube-sphere", [](auto& o) { o.topology = MeshTopology::cube_sphere; }},
      {"raw sign", [](auto& o) { o.sign = SignConvention::raw; }},
  };
  for (const AnySurface& surface : all_surfaces()) {
    for (const Variant& variant : variants) {
      SCOPED_TRACE(variant.name);
      // Its partials are infinite along the seam, so that the triangles whose uvs jump decide there.
      if (variant.name == std::string("shared seam") && surface.info().name == "superellipsoid") continue;
      SampleMeshOptions options;
      variant.change(options);
      Mesh mesh;
      try {
        mesh = sample_mesh(surface, options);
      } catch (const ParameterError&) {  // not of this surface
        continue;
      }
      test::round_to_floats(mesh);
      expect_pass(surface, mesh, declared(surface));
    }
  }
}

// Wherever the mesh lies, and with a placement that is given.
TEST(DeclaredSurfaces, AnyPlacement) {
  std::mt19937_64 random(1);
  for (const AnySurface& surface : all_surfaces()) {
    Mesh mesh = sample_mesh(surface, {});
    const Eigen::Isometry3d pose = random_pose(random, 3);
    darboux::place(mesh, pose);
    AssessOptions options = declared(surface);
    expect_pass(surface, mesh, options);
    options.placement = pose;
    expect_pass(surface, mesh, options);
    options.placement = pose * Eigen::Translation3d(0.3, 0.1, 0.2);
    EXPECT_EQ(assess(mesh, options).report.verdict, Verdict::fail)
        << surface.info().name << ": a placement that is another's";
  }
}

// A surface that is known but for its place is not one of another size.
TEST(DeclaredSurfaces, AnExactSurfaceIsNoOther) {
  const AnySurface surface = make_surface("superellipsoid:exponent_u=0.7");
  const Mesh mesh = sample_mesh(surface, {});
  AssessOptions options;
  options.exact_surface = surface;
  EXPECT_EQ(assess(mesh, options).report.verdict, Verdict::pass);
  for (const char* other :
       {"superellipsoid:exponent_u=0.71", "superellipsoid:exponent_u=0.7,semi_axis_z=0.99"}) {
    options.exact_surface = make_surface(other);
    const Assessment j = assess(mesh, options);
    EXPECT_EQ(j.report.verdict, Verdict::fail) << other;
    EXPECT_FALSE(j.fit && j.fit->fits) << other;
  }
}

}  // namespace
}  // namespace darboux::declared_surfaces_test
