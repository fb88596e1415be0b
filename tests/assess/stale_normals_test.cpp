// NORMAL_STALE where no surface is known: normals that were not transformed with the positions, or as
// positions are, are told by the planes of facets, by neighbours, and by averages; right ones are not.
#include <array>
#include <cmath>
#include <string>
#include <tuple>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include <darboux/any_surface.h>
#include <darboux/assess.h>
#include <darboux/sample_mesh.h>
#include <darboux/vertex_normals.h>

#include "finding_codes.h"
#include "random.h"
#include "random_meshes.h"

namespace darboux::stale_normals_test {
namespace {

using test::codes, test::joined, test::turn_by;

// On coarse meshes the exact normals, too, differ from the averages of the triangles': only of a column, and
// only a map that scales and explains nearly all is told.
TEST(StaleNormals, OfCoarseColumnsAreTold) {
  AssessOptions options;
  options.references.analytic = false;  // what is unknown is not looked for each time
  const auto is_told = [&](const Mesh& mesh) {
    const std::vector<Assessment> assessments = assess_parts(mesh, options);
    for (const Finding& f : assessments.front().report.findings)
      if (f.code == "NORMAL_STALE") {
        EXPECT_EQ(f.severity, Severity::warning);
        return true;
      }
    return false;
  };
  // A column of an ellipse, with the normals of the circle scaled by some power of the scale.
  const auto column = [](int rows, double scale, double power) {
    Mesh mesh;
    test::add_grid(mesh, 24, rows, [](double u, double v) { return test::on_ring(1, u, 2 * v); });
    for (Vec3<double>& p : mesh.positions) {
      mesh.normals.push_back(unit(Vec3<double>{p.x, std::pow(scale, power) * p.y, 0}));
      p.y *= scale;
    }
    return mesh;
  };
  for (const double scale : {1.7, 2.0, 3.0})
    for (const int rows : {1, 3}) {
      SCOPED_TRACE(std::to_string(rows) + " rows, " + std::to_string(scale));
      EXPECT_FALSE(is_told(column(rows, scale, -1)));
      EXPECT_TRUE(is_told(column(rows, scale, 0)));
      EXPECT_TRUE(is_told(column(rows, scale, 1)));
    }
  // Turned about the axis, as on the flanks of a ratchet.
  Mesh turned = column(1, 1, 0);
  for (Vec3<double>& n : turned.normals) n = unit(n + 0.36 * Vec3<double>{-n.y, n.x, 0});
  EXPECT_FALSE(is_told(turned));
  // A band that is blended into what adjoins it.
  Mesh band;
  test::add_grid(band, 24, 1, [](double u, double v) { return test::on_ring(1 + v, u, v); });
  for (const Vec3<double>& p : band.positions)
    band.normals.push_back(unit(Vec3<double>{p.x, p.y, -1.7 * std::hypot(p.x, p.y)}));
  EXPECT_FALSE(is_told(band));
  // A blade that is bent by 60 degrees, lit half as the ground.
  Mesh blade;
  test::add_grid(blade, 1, 12, [](double u, double v) {
    return Vec3<double>{0.1 * u, 2 * std::sin(v), 2 - 2 * std::cos(v)};
  });
  for (const Vec3<double>& p : blade.positions) {
    const double lit = std::asin(std::fmin(p.y / 2, 1)) / 2;
    blade.normals.push_back({0, -std::sin(lit), std::cos(lit)});
  }
  EXPECT_FALSE(is_told(blade));
}

// With three vertices of their own for each triangle, and its normal.
Mesh in_facets(const Mesh& from) {
  Mesh mesh;
  for (const Triangle& triangle : from.triangles) {
    const Vec3<double>&a = from.positions[triangle[0]], &b = from.positions[triangle[1]],
          &c = from.positions[triangle[2]];
    if (norm(cross(b - a, c - a)) == 0) continue;
    const auto first = static_cast<std::uint32_t>(mesh.positions.size());
    mesh.triangles.push_back({first, first + 1, first + 2});
    for (const Vec3<double>& p : {a, b, c}) {
      mesh.positions.push_back(p);
      mesh.normals.push_back(unit(cross(b - a, c - a)));
    }
  }
  return mesh;
}

// A box, and a torus in facets, turned or scaled without their normals: no surface is known, the planes of
// the facets are.
TEST(StaleNormals, OfFacetsAreTold) {
  Mesh corners;
  for (int k = 0; k < 8; ++k)
    corners.positions.push_back({k & 1 ? 1.0 : 0.0, k & 2 ? 2.0 : 0.0, k & 4 ? 3.0 : 0.0});
  for (const auto& [a, b, c, d] : {std::array<std::uint32_t, 4>{0, 2, 3, 1},
                                   {4, 5, 7, 6},
                                   {0, 1, 5, 4},
                                   {2, 6, 7, 3},
                                   {0, 4, 6, 2},
                                   {1, 3, 7, 5}}) {
    corners.triangles.push_back({a, b, c});
    corners.triangles.push_back({a, c, d});
  }
  const Mesh box = in_facets(corners),
             torus =
                 in_facets(sample_mesh(make_surface("torus:minor_radius=0.4"), {.columns = 16, .rows = 9}));
  const Eigen::Matrix3d turn = Eigen::AngleAxisd(0.8, Eigen::Vector3d(0, 0, 1)).toRotationMatrix(),
                        scale = Eigen::Vector3d(1, 3, 0.5).asDiagonal();
  for (const auto& [good, m, is_told] : {std::tuple{&box, turn, true},
                                         {&torus, turn, true},
                                         {&torus, scale, true},
                                         // Three directions may be anything under a linear map.
                                         {&box, Eigen::Matrix3d(scale * turn), false}}) {
    Mesh mesh = *good;
    EXPECT_FALSE(codes(assess_parts(mesh)).contains("NORMAL_STALE"));
    turn_by(mesh, m);
    EXPECT_EQ(codes(assess_parts(mesh)).contains("NORMAL_STALE"), is_told)
        << joined(codes(assess_parts(mesh)));
  }
}

// Walls are right under any scale along the axes; the roofs of houses side by side are not, and tell no scale
// along their ridges.
TEST(StaleNormals, OfRoofsAreTold) {
  test::Random random(284);
  Mesh corners;
  for (int house = 0; house < 12; ++house) {
    const double w = random.uniform(2, 3), h = random.uniform(2.5, 3.5), r = random.uniform(1, 2.5),
                 x = 8.0 * house;
    const auto first = static_cast<std::uint32_t>(corners.positions.size());
    for (const double z : {3.0, -3.0})
      for (const auto& [px, py] : {std::array{w, 0.0}, {w, h}, {0.0, h + r}, {-w, h}, {-w, 0.0}})
        corners.positions.push_back({x + px, py, z});
    const auto add = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
      corners.triangles.push_back({first + a, first + b, first + c});
    };
    for (std::uint32_t k = 1; k < 4; ++k) add(0, k, k + 1), add(5, 5 + k + 1, 5 + k);
    for (std::uint32_t k = 0; k < 4; ++k) add(k, k + 5, k + 6), add(k, k + 6, k + 1);
  }
  const Mesh village = in_facets(corners);
  for (const double y : {3.0, 0.4}) {
    Mesh mesh = village, stale = village, as_positions = village;
    turn_by(stale, Eigen::Vector3d(1, y, 1).asDiagonal());
    mesh.positions = as_positions.positions = stale.positions;
    for (Vec3<double>& n : mesh.normals) n = unit(Vec3<double>{n.x, n.y / y, n.z});
    for (Vec3<double>& n : as_positions.normals) n = unit(Vec3<double>{n.x, n.y * y, n.z});
    EXPECT_EQ(joined(codes(assess_parts(mesh))), "") << y;
    EXPECT_TRUE(codes(assess_parts(stale)).contains("NORMAL_STALE")) << y;
    EXPECT_TRUE(codes(assess_parts(as_positions)).contains("NORMAL_STALE")) << y;
  }
}

// Near 5 million metres single precision has steps of half a metre, which turn the planes of small triangles.
TEST(StaleNormals, AreNotThoseOfRoundedPositions) {
  test::Random random(286);
  for (int pyramid = 0; pyramid < 30; ++pyramid) {
    const double w = random.uniform(4, 8), h = random.uniform(3, 8), z = random.uniform(-0.25, 0.25);
    Mesh corners;
    corners.positions = {{w, 0, 5}, {-w, 0, 5}, {-w, 0, -5}, {w, 0, -5}, {0, h, z}};
    for (std::uint32_t k = 0; k < 4; ++k) corners.triangles.push_back({(k + 1) % 4, k, 4});
    Mesh mesh = in_facets(corners);
    for (Vec3<double>& p : mesh.positions) p.z = static_cast<float>(p.z - 5412345);
    EXPECT_FALSE(codes(assess_parts(mesh)).contains("NORMAL_STALE")) << pyramid;
    const Eigen::Matrix3d turn = Eigen::AngleAxisd(1, Eigen::Vector3d(0, 1, 0)).toRotationMatrix();
    for (Vec3<double>& n : mesh.normals) n = from_eigen(turn * to_eigen(n));
    EXPECT_TRUE(codes(assess_parts(mesh)).contains("NORMAL_STALE")) << pyramid;
  }
}

// Every second triangle of a smooth mesh, as files have them whose triangles alternate between two materials:
// each is a facet, whose normals are the surface's.
TEST(StaleNormals, AreNotThoseOfSingleTrianglesOfASmoothMesh) {
  for (const char* name : {"cylinder", "cone"})
    for (const int columns : {8, 16, 32}) {
      Mesh mesh =
          sample_mesh(make_surface(name), {.columns = columns, .rows = 1, .v_first = 0, .v_last = 0.8});
      for (std::size_t t = 1; t < mesh.triangles.size(); ++t)
        mesh.triangles.erase(mesh.triangles.begin() + static_cast<std::ptrdiff_t>(t));
      AssessOptions options;
      options.references.analytic = false;
      EXPECT_FALSE(codes(assess_parts(mesh, options)).contains("NORMAL_STALE")) << name << ' ' << columns;
    }
}

// Of smooth meshes that no surface is known of the neighbours tell it, with uvs and without: it passed.
TEST(StaleNormals, OfUnknownSurfacesAreTold) {
  const Eigen::Matrix3d turn = Eigen::AngleAxisd(0.5, Eigen::Vector3d(1, 2, 2) / 3).toRotationMatrix(),
                        scale = Eigen::Vector3d(1, 3, 1).asDiagonal();
  for (const char* name : {"monkey-saddle", "catenoid", "torus"})
    for (const bool with_uvs : {true, false}) {
      SCOPED_TRACE(std::string(name) + (with_uvs ? " with uvs" : " without uvs"));
      Mesh good = sample_mesh(make_surface(name), {.columns = 48, .rows = 24, .v_first = 0.1, .v_last = 0.9});
      good.tangents.clear();
      for (Vec3<double>& p : good.positions) p.z += 0.1 * std::sin(5 * p.x);  // no one's surface
      good.normals = vertex_normals(good, NormalWeight::max);
      if (!with_uvs) good.uvs.clear();
      EXPECT_EQ(joined(codes(assess_parts(good))), "");
      for (const Eigen::Matrix3d& m : {turn, scale}) {
        Mesh mesh = good;
        turn_by(mesh, m);
        EXPECT_TRUE(codes(assess_parts(mesh)).contains("NORMAL_STALE")) << joined(codes(assess_parts(mesh)));
      }
    }
}

}  // namespace
}  // namespace darboux::stale_normals_test
