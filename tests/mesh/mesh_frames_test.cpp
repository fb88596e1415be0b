#include <algorithm>
#include <cmath>
#include <fstream>
#include <iterator>
#include <numbers>
#include <random>
#include <string>

#include <gtest/gtest.h>

#include <darboux/any_surface.h>
#include <darboux/error.h>
#include <darboux/fragments.h>
#include <darboux/frame.h>
#include <darboux/mesh_frames.h>
#include <darboux/sample_mesh.h>
#include <darboux/torus.h>

#include "refusal_of.h"

namespace darboux::mesh_frames_test {
namespace {

constexpr double degrees = 180 / std::numbers::pi;

using Points = std::array<Vec3<double>, 3>;
using Uvs = std::array<Vec2<double>, 3>;

double angle_deg(const Vec3<double>& a, const Vec3<double>& b) {
  return degrees * angle_between(a, b);
}

Mesh one_triangle(const Points& p, const Uvs& uv) {
  const Vec3<double> n = unit(cross(p[1] - p[0], p[2] - p[0]));
  return {{p.begin(), p.end()}, {n, n, n}, {uv.begin(), uv.end()}, {}, {{0, 1, 2}}};
}

// On an affine chart P = O + u T + v B every method that uses T and B must return them exactly.
TEST(SolveTriangle, RecoversAnAffineChart) {
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> uniform(-1, 1);
  const auto vector = [&] { return Vec3<double>{uniform(random), uniform(random), uniform(random)}; };
  for (int i = 0; i < 1000; ++i) {
    const Vec3<double> origin = vector(), t = vector(), b = vector();
    Uvs uv;
    Points p;
    for (int k = 0; k < 3; ++k) {
      uv[k] = {uniform(random), uniform(random)};
      p[k] = origin + uv[k].x * t + uv[k].y * b;
    }
    const auto solved = solve_triangle(p, uv);
    ASSERT_TRUE(solved);
    // Positions err by 2u, edges by 4u; the solve multiplies by |e1||e2| over the uv determinant.
    const double det = std::fabs(signed_uv_area2(uv[0], uv[1], uv[2]));
    const double tolerance = 64 * 0x1p-53 / det;
    EXPECT_LE(norm(solved->t - t), tolerance);
    EXPECT_LE(norm(solved->b - b), tolerance);
  }
}

// The definition of the fragment's gradients: i·T = 1, i·B = 0, i·n = 0, and the same of j.
TEST(FragmentGradients, AreDualToTheTangents) {
  const Points p{{{0, 0, 0}, {2, 0.3, 0}, {0.4, 1.5, 0.2}}};
  const Uvs uv{{{0, 0}, {1, 0.2}, {0.1, 0.9}}};
  const auto solved = solve_triangle(p, uv);
  const Vec3<double> n = unit(cross(p[1] - p[0], p[2] - p[0]));
  const auto gradients = fragment_gradients(p, uv, n);
  ASSERT_TRUE(solved && gradients);
  constexpr double tolerance = 32 * 0x1p-53;  // two solves of well-conditioned 3x3 and 2x2 systems
  EXPECT_NEAR(dot(gradients->t, solved->t), 1, tolerance);
  EXPECT_NEAR(dot(gradients->t, solved->b), 0, tolerance);
  EXPECT_NEAR(dot(gradients->b, solved->t), 0, tolerance);
  EXPECT_NEAR(dot(gradients->b, solved->b), 1, tolerance);
  EXPECT_NEAR(dot(gradients->t, n), 0, tolerance);
  EXPECT_NEAR(dot(gradients->b, n), 0, tolerance);
}

// Why the two forms of the fragment frame differ, one cause at a time.
TEST(FragmentForms, AgreeOnlyOnAnOrthogonalChartWithTheFaceNormal) {
  const auto chart = [](double angle) {  // T along x, B at that angle to it, triangle in the plane z = 0
    return Points{{{0, 0, 0}, {1, 0, 0}, {std::cos(angle / degrees), std::sin(angle / degrees), 0}}};
  };
  const Uvs uv{{{0, 0}, {1, 0}, {0, 1}}};
  const Vec3<double> face_normal{0, 0, 1};
  const auto disagreement = [&](const Points& p, const Vec3<double>& n) {
    return angle_deg(fragment_gradients(p, uv, n)->t, solve_triangle(p, uv)->t);
  };
  // Neither cause: the same direction, to a few roundings.
  EXPECT_LT(disagreement(chart(90), face_normal), 1e-13);
  // Cause one, the chart: the gradient of u is across B, so at 105 degrees it stands 15 degrees from T.
  EXPECT_NEAR(disagreement(chart(105), face_normal), 15, 1e-12);
  EXPECT_NEAR(disagreement(chart(60), face_normal), 30, 1e-12);
  // Cause two, the normal: tilted by 20 degrees towards T, the plane across it tilts T's gradient as much.
  const Vec3<double> tilted{std::sin(20 / degrees), 0, std::cos(20 / degrees)};
  EXPECT_NEAR(disagreement(chart(90), tilted), 20, 1e-12);
}

// Where unit vectors cancel but for rounding, there is no direction: a fallback, and said so.
TEST(FragmentForms, RoundingIsNoDirection) {
  const Points p{{{0, 0, 0}, {1, 0.7, 0.3}, {0.2, 1, 0.4}}};
  const Uvs uv{{{0, 0}, {1, 0.1}, {0.2, 1}}};
  const Vec3<double> t = unit(solve_triangle(p, uv)->t), n = unit(Vec3<double>{-0.3, 0.1, 1});
  const std::array<double, 3> thirds{1.0 / 3, 1.0 / 3, 1.0 / 3}, tenths{0.1, 0.2, 0.7};
  const auto with = [&](const std::array<Vec3<double>, 3>& ts, const std::array<Vec3<double>, 3>& ns) {
    TriangleFrames result{p, uv, {}};
    for (std::size_t k = 0; k < 3; ++k) result.frames[k] = {ts[k], {}, ns[k], 1, false};
    return result;
  };
  const auto turned = [](double turns) {  // unit vectors that add up to zero, but for rounding
    const double angle = 0.4 + 2 * std::numbers::pi * turns;
    return unit(std::cos(angle) * unit(Vec3<double>{1, 2, 3}) +
                std::sin(angle) * unit(Vec3<double>{3, 0, -1}));
  };
  const TriangleFrames along_n = with({t, t, t}, {t, t, t}),
                       cancelled_t = with({turned(0), turned(1.0 / 3), turned(2.0 / 3)}, {n, n, n}),
                       cancelled_n = with({t, t, t}, {turned(0), turned(1.0 / 3), turned(2.0 / 3)}),
                       good = with({t, t, t}, {n, n, n});
  for (const FragmentForm form :
       {FragmentForm::projected, FragmentForm::interpolated, FragmentForm::interpolated_raw}) {
    for (const auto& weights : {thirds, tenths}) {
      EXPECT_TRUE(fragment_frame(form, along_n, weights).fallback);
      EXPECT_FALSE(fragment_frame(form, good, weights).fallback);
    }
    EXPECT_EQ(fragment_frame(form, cancelled_t, thirds).fallback, form != FragmentForm::projected);
    EXPECT_TRUE(fragment_frame(form, cancelled_n, thirds).fallback);
  }
}

TEST(FrameMethods, AllReturnTheAxesOnAFlatSquare) {
  constexpr double tolerance = 8 * 0x1p-53;  // of the few roundings of a 2x2 solve
  const auto near = [](const Vec3<double>& a, double x, double y, double z) {
    return norm(a - Vec3<double>{x, y, z}) <= tolerance;
  };
  for (const FrameMethod& method : frame_methods()) {
    const Mesh mesh = one_triangle({{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}}, {{{0, 0}, {1, 0}, {0, 1}}});
    const MeshFrames result = mesh_frames(mesh, method);
    // Mirrored uvs: u runs the other way, the sign turns, b stays.
    const Mesh mirrored = one_triangle({{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}}, {{{0, 0}, {-1, 0}, {0, 1}}});
    const MeshFrames of_mirrored = mesh_frames(mirrored, method);
    for (std::size_t c = 0; c < 3; ++c) {
      EXPECT_TRUE(near(result.corner(c).t, 1, 0, 0)) << method.name;
      EXPECT_TRUE(near(of_mirrored.corner(c).t, -1, 0, 0)) << method.name;
      for (const MeshFrames* frames : {&result, &of_mirrored}) {
        EXPECT_TRUE(near(frames->corner(c).b, 0, 1, 0)) << method.name;
        EXPECT_TRUE(near(frames->corner(c).n, 0, 0, 1)) << method.name;
        EXPECT_EQ(frames->corner(c).sign, frames == &result ? 1 : -1) << method.name;
        EXPECT_FALSE(frames->corner(c).fallback) << method.name;
      }
    }
  }
}

// The weights, on two triangles that share vertex 0 in the plane z = 0: T turns by a known angle between
// them.
TEST(FrameMethods, WeightAsTheySay) {
  // Triangle A: u along x, right angle at vertex 0, legs 1 and 1. Triangle B: u along y, 45 degrees at vertex
  // 0, area 2.
  Mesh mesh;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {-2, 0, 0}, {-2, -2, 0}};
  mesh.normals.assign(5, {0, 0, 1});
  mesh.uvs = {{0, 0}, {0.5, 0}, {0, 1}, {0, 2}, {-2, 2}};  // A: T = (2,0,0). B: u along y, T = (0,1,0)
  mesh.triangles = {{0, 1, 2}, {0, 3, 4}};
  const auto t = [&](const char* method) { return mesh_frames(mesh, find_frame_method(method)).corner(0).t; };
  const auto expect_direction = [](const Vec3<double>& t, double x, double y) {
    EXPECT_NEAR(t.x, x / std::hypot(x, y), 4e-16);
    EXPECT_NEAR(t.y, y / std::hypot(x, y), 4e-16);
  };
  expect_direction(t("average"), 2, 1);
  expect_direction(t("unit"), 1, 1);
  expect_direction(t("area"), 0.5, 2);
  expect_direction(t("angle"), 90, 45);
  expect_direction(t("max"), 1, 1 / std::sqrt(2.0) / 2 / std::sqrt(8.0));
  expect_direction(t("face"), 1, 0);
}

// By the sine of the angle between the edges alone: 8u is the most that counts as none, whatever their
// lengths and wherever they point.
TEST(MeshFrames, DegenerateTrianglesAreToldByTheirAngle) {
  for (const int i : {-1060, -700, -510, -480, -250, 0, 250, 510, 700, 1000})
    for (const int j : {-1060, -700, -510, -480, -250, 0, 250, 510, 700, 1000})
      for (int k = 0; k <= 60; ++k) {
        const double a = std::ldexp(1.0, i), b = std::ldexp(1.0, j), height = std::ldexp(1.0, j - k);
        const bool expected = k >= 50 || height == 0;  // 8u = 2^-50
        EXPECT_EQ(is_degenerate({0, 0, 0}, {a, 0, 0}, {b, height, 0}), expected) << i << ' ' << j << ' ' << k;
        EXPECT_EQ(is_degenerate({0, 0, 0}, {0, -b, height}, {0, 0, 0}), true);
        EXPECT_EQ(is_degenerate(Vec2<double>{0, 0}, {b, height}, {a, 0}), expected)
            << i << ' ' << j << ' ' << k;
      }
  // Rounding the corners turns the edges by a few u.
  std::mt19937_64 random(11);
  std::uniform_real_distribution<double> uniform(-1, 1);
  for (int i = 0; i < 1000; ++i) {
    const auto any = [&] { return unit(Vec3<double>{uniform(random), uniform(random), uniform(random)}); };
    const Vec3<double> d = any(), across = unit(cross(d, any()));
    const double a = std::ldexp(1.0, static_cast<int>(200 * uniform(random))), b = 3 * uniform(random);
    for (const int k : {20, 28, 29, 30, 31, 32, 40, 46})
      EXPECT_FALSE(is_degenerate({0, 0, 0}, a * d, b * (d + std::ldexp(1.0, -k) * across))) << i << ' ' << k;
    EXPECT_TRUE(is_degenerate({0, 0, 0}, a * d, std::ldexp(1.0, i % 100) * d)) << i;
  }
}

TEST(FrameMethods, NeverGiveNaNForDegenerateTriangles) {
  struct Case {
    const char* name;
    Points p;
    Uvs uv;
    std::size_t degenerate, degenerate_uv;
  };
  const Uvs good{{{0, 0}, {1, 0}, {0, 1}}};
  const Points square{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}};
  const Case cases[] = {
      {"two equal", {{{0, 0, 0}, {0, 0, 0}, {0, 1, 0}}}, good, 1, 0},
      {"all equal", {{{1, 2, 3}, {1, 2, 3}, {1, 2, 3}}}, good, 1, 0},
      {"collinear", {{{0, 0, 0}, {1, 1, 1}, {2, 2, 2}}}, good, 1, 0},
      {"height 1e-20", {{{0, 0, 0}, {1, 0, 0}, {0.5, 1e-20, 0}}}, good, 1, 0},
      {"all uvs equal", square, {{{0.5, 0.5}, {0.5, 0.5}, {0.5, 0.5}}}, 0, 1},
      {"collinear uvs", square, {{{0, 0}, {0.5, 0.5}, {1, 1}}}, 0, 1},
      {"tiny but good",
       {{{0, 0, 0}, {1e-30, 0, 0}, {0, 1e-30, 0}}},
       {{{0, 0}, {1e-30, 0}, {0, 1e-30}}},
       0,
       0},
      {"huge but good", {{{0, 0, 0}, {1e30, 0, 0}, {0, 1e30, 0}}}, {{{0, 0}, {1e30, 0}, {0, 1e30}}}, 0, 0},
  };
  for (const FrameMethod& method : frame_methods())
    for (const Case& c : cases) {
      Mesh mesh = one_triangle(c.p, c.uv);
      for (auto& n : mesh.normals)
        if (n == Vec3<double>{}) n = {0, 0, 1};
      const MeshFrames result = mesh_frames(mesh, method);
      EXPECT_EQ(result.degenerate_triangles, c.degenerate) << method.name << ", " << c.name;
      EXPECT_EQ(result.degenerate_uv_triangles, c.degenerate_uv) << method.name << ", " << c.name;
      const bool served = c.degenerate + c.degenerate_uv == 0;
      // MikkTSpace works on triangles without area in its own way: only those with equal corners are left
      // out.
      if (served || !method.single_precision) {
        EXPECT_EQ(result.fallback_corners, served ? 0u : 3u) << method.name << ", " << c.name;
      }
      for (std::size_t k = 0; k < 3; ++k) {
        EXPECT_NEAR(norm(result.corner(k).t), 1, method.single_precision ? 2e-7 : 1e-15)
            << method.name << ", " << c.name;
        EXPECT_EQ(std::fabs(result.corner(k).sign), 1) << method.name << ", " << c.name;
      }
    }
}

// MikkTSpace's own (1, 0, 0) would lean on these normals.
TEST(FrameMethods, FallbacksLieAcrossTheNormal) {
  Mesh mesh = one_triangle({{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}}, {{{0.5, 0.5}, {0.5, 0.5}, {0.5, 0.5}}});
  mesh.normals = {unit(Vec3<double>{1, 0, 2}), unit(Vec3<double>{2, 1, 2}), unit(Vec3<double>{-3, 1, 1})};
  for (const FrameMethod& method : frame_methods()) {
    const MeshFrames frames = mesh_frames(mesh, method);
    for (std::size_t c = 0; c < 3; ++c) {
      const CornerFrame& f = frames.corner(c);
      EXPECT_TRUE(f.fallback) << method.name;
      const double rounding = method.single_precision ? 2e-7 : 1e-15;
      EXPECT_NEAR(norm(f.t), 1, rounding) << method.name;
      EXPECT_NEAR(dot(f.t, f.n), 0, rounding) << method.name;
      if (method.needs_normals) {
        EXPECT_NEAR(dot(f.t, mesh.normals[c]), 0, rounding) << method.name;
      }
    }
  }
}

// A degenerate triangle beside good ones must not change what they give.
TEST(FrameMethods, DegenerateTrianglesAreLeftOutOfAverages) {
  for (const FrameMethod& method : frame_methods()) {
    Mesh mesh = one_triangle({{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}}, {{{0, 0}, {1, 0}, {0, 1}}});
    mesh.positions.push_back({0, 0, 0});
    mesh.normals.push_back({0, 0, 1});
    mesh.uvs.push_back({0.3, 0.9});
    mesh.triangles.push_back({0, 3, 1});
    const MeshFrames result = mesh_frames(mesh, method);
    EXPECT_EQ(result.degenerate_triangles, 1u);
    for (std::size_t c = 0; c < 3; ++c)
      EXPECT_LE(norm(result.corner(c).t - Vec3<double>{1, 0, 0}), 8 * 0x1p-53) << method.name;
  }
}

TEST(FrameMethods, BadMeshesAreRefused) {
  const FrameMethod& average = find_frame_method("average");
  Mesh mesh = one_triangle({{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}}, {{{0, 0}, {1, 0}, {0, 1}}});
  Mesh no_uvs = mesh, no_normals = mesh, bad_index = mesh;
  no_uvs.uvs.clear();
  no_normals.normals.clear();
  bad_index.triangles[0][1] = 3;
  EXPECT_THROW(mesh_frames(no_uvs, average), MeshError);
  EXPECT_THROW(mesh_frames(no_normals, average), MeshError);
  EXPECT_THROW(mesh_frames(bad_index, average), MeshError);
  EXPECT_NO_THROW(mesh_frames(no_normals, find_frame_method("face")));
  EXPECT_NO_THROW(mesh_frames(Mesh{}, average));
  try {
    find_frame_method("magic");
    FAIL() << "an unknown method must be refused";
  } catch (const ParameterError& e) {
    EXPECT_NE(std::string(e.what()).find("average"), std::string::npos)
        << "the message lists the known methods";
  }
}

TEST(FrameMethods, NameTheirSourcesAndCosts) {
  std::ifstream file(DARBOUX_SOURCE "/docs/references.bib");
  const std::string references{std::istreambuf_iterator<char>(file), {}};
  for (const FrameMethod& method : frame_methods()) {
    EXPECT_TRUE(method.source == "Darboux" ||
                references.find('{' + std::string(method.source) + ',') != std::string::npos)
        << method.name << ": " << method.source;
    EXPECT_TRUE(method.cost.starts_with("linear, about ")) << method.name;
  }
}

TEST(FrameMethods, RefuseWhatIsNotFinite) {
  const Mesh good = sample_mesh(Torus{1.0, 0.4}, {.columns = 8, .rows = 6});
  constexpr std::size_t v = 9 * 3 + 4;
  for (const double bad : {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()})
    for (const FrameMethod& method : frame_methods()) {
      const auto refused = [&](auto change, const std::string& words) {
        Mesh mesh = good;
        change(mesh);
        EXPECT_NE(test::refusal_of<MeshError>([&] { mesh_frames(mesh, method); }).find(words),
                  std::string::npos)
            << method.name;
      };
      refused([&](Mesh& mesh) { mesh.positions[v].x = bad; },
              "position of vertex 31: expected finite numbers");
      refused([&](Mesh& mesh) { mesh.normals[v].y = bad; }, "normal of vertex 31: expected finite numbers");
      refused([&](Mesh& mesh) { mesh.uvs[v].x = bad; }, "uv of vertex 31: expected finite numbers");
    }
}

// So small that products vanish: a flagged fallback, never NaN.
TEST(FrameMethods, NeverGiveNaNForTinyData) {
  for (const FrameMethod& method : frame_methods()) {
    const Mesh tiny_uvs =
        one_triangle({{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}}, {{{0, 0}, {1e-170, 0}, {0, 1e-170}}});
    const Mesh tiny = one_triangle({{{0, 0, 0}, {1e-170, 0, 0}, {0, 1e-170, 0}}}, {{{0, 0}, {1, 0}, {0, 1}}});
    for (const Mesh* mesh : {&tiny_uvs, &tiny})
      for (std::size_t c = 0; c < 3; ++c) {
        const MeshFrames result = mesh_frames(*mesh, method);
        EXPECT_NEAR(norm(result.corner(c).t), 1, method.single_precision ? 2e-7 : 1e-15) << method.name;
        EXPECT_NEAR(norm(result.corner(c).n), 1, 1e-15) << method.name;
      }
  }
}

// t, b and n are unit at every corner. In the first mesh the normal of vertex 1 lies along dpdu: MikkTSpace
// projects it to rounding, t is along n, and n x t is of any length. In the second t' is of length 1e-40, in
// the third not a number, in the fourth (1, 0, 0) stands for no triangle.
TEST(FrameMethods, AreUnitWhateverTheNormals) {
  std::vector<Mesh> meshes;
  meshes.push_back(one_triangle({{{0.25, 0.75, 0.5}, {0.5, 1, -1}, {-0.5, -0.5, -0.5}}},
                                {{{0, 0.25}, {-0.5, 0}, {-1, 0}}}));
  meshes[0].normals[1] = unit(Vec3<double>{-2, -3, 1});
  for (const double tiny : {1e-40, 1e-30}) {
    meshes.push_back(one_triangle({{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}}, {{{0, 0}, {1, 0}, {0, 1}}}));
    for (Vec3<double>& n : meshes.back().normals) n = {1, tiny, 0};
  }
  meshes.push_back(one_triangle({{{0, 0, 0}, {0, 0, 0}, {0, 1, 0}}}, {{{0, 0}, {1, 0}, {0, 1}}}));
  for (Vec3<double>& n : meshes.back().normals) n = unit(Vec3<double>{3, 0, 1});
  std::mt19937 random(1);
  const auto quarters = [&] { return 0.25 * (static_cast<int>(random() % 9) - 4); };
  for (int k = 0; k < 2000; ++k) {
    Points p;
    Uvs uv;
    for (Vec3<double>& x : p) x = {quarters(), quarters(), quarters()};
    for (Vec2<double>& x : uv) x = {quarters(), quarters()};
    meshes.push_back(one_triangle(p, uv));
    for (Vec3<double>& n : meshes.back().normals) n = unit(Vec3<double>{quarters(), quarters(), quarters()});
  }
  for (const FrameMethod& method : frame_methods()) {
    const double tolerance = method.single_precision ? 3e-7 : 1e-15;
    for (std::size_t m = 0; m < meshes.size(); ++m) {
      const MeshFrames frames = mesh_frames(meshes[m], method);
      for (std::size_t c = 0; c < 3; ++c) {
        const CornerFrame& frame = frames.corner(c);
        for (const Vec3<double>& a : {frame.t, frame.b, frame.n})
          ASSERT_NEAR(norm(a), 1, tolerance) << method.name << ", mesh " << m << ", corner " << c;
      }
    }
  }
}

// MikkTSpace computes in single precision: far below its range nothing changes, above it the reason is said.
TEST(FrameMethods, MikkTSpaceTakesDoubles) {
  const Mesh plain = sample_mesh(Torus{1.0, 0.4}, {.columns = 16, .rows = 8});
  const FrameMethod& method = find_frame_method("mikktspace");
  Mesh tiny = plain, huge = plain;
  for (auto& p : tiny.positions) p = 0x1p-300 * p;
  const MeshFrames expected = mesh_frames(plain, method), found = mesh_frames(tiny, method);
  for (std::size_t c = 0; c < plain.corners(); ++c) EXPECT_EQ(found.corner(c).t, expected.corner(c).t);
  huge.positions[5].y = 1e40;
  EXPECT_NE(test::refusal_of<MeshError>([&] {
              mesh_frames(huge, method);
            }).find("position of vertex 5: expected magnitudes up to 3.4e38 for mikktspace, got 1e+40"),
            std::string::npos);
}

TEST(FrameMethods, ThreadsDoNotMatter) {
  const Mesh mesh = sample_mesh(Torus{1.0, 0.4}, {.columns = 90, .rows = 60, .jitter = 0.2});
  for (const FrameMethod& method : frame_methods()) {
    const MeshFrames one = mesh_frames(mesh, method), three = mesh_frames(mesh, method, 3);
    ASSERT_EQ(one.of_corner, three.of_corner) << method.name;
    for (std::size_t f = 0; f < one.frames.size(); ++f) {
      EXPECT_EQ(one.frames[f].t, three.frames[f].t) << method.name;
      EXPECT_EQ(one.frames[f].b, three.frames[f].b) << method.name;
    }
  }
}

// The hub of a fan over a disk, and its rim, where P(u, v) = (u, v, bend (u² - v² + u)).
Mesh fan(std::uint32_t triangles, double bend) {
  Mesh mesh;
  for (std::uint32_t k = 0; k <= triangles; ++k) {
    const double angle = 2 * std::numbers::pi * k / triangles;
    const Vec2<double> uv = k == 0 ? Vec2<double>{0, 0} : Vec2<double>{std::cos(angle), std::sin(angle)};
    mesh.uvs.push_back(uv);
    mesh.positions.push_back({uv.x, uv.y, bend * (uv.x * uv.x - uv.y * uv.y + uv.x)});
    mesh.normals.push_back(unit(Vec3<double>{-bend * (2 * uv.x + 1), bend * 2 * uv.y, 1}));
    if (k > 0) mesh.triangles.push_back({0, k, k % triangles + 1});
  }
  return mesh;
}

// Linear in the triangles: every vertex of the rim is two edges from every other, the square of them would
// take minutes.
TEST(FrameMethods, AFanOfManyTrianglesEnds) {
  constexpr std::uint32_t triangles = 100000;
  constexpr double edge = 2 * std::numbers::pi / triangles;
  const Mesh flat = fan(triangles, 0), bent = fan(triangles, 0.25);
  for (const FrameMethod& method : frame_methods()) {
    const MeshFrames frames = mesh_frames(flat, method);
    EXPECT_EQ(frames.fallback_corners, 0u) << method.name;
    // Edges of the rim err by 4u; in float 2^-29 of their number remains after the mean.
    const double tolerance =
        method.single_precision ? 0x1p-22 / edge / std::sqrt(triangles) : 4 * 0x1p-53 / edge;
    EXPECT_LE(norm(frames.corner(0).t - Vec3<double>{1, 0, 0}), tolerance) << method.name;
  }
  for (const char* name : {"quadratic", "cubic"}) {
    const MeshFrames one = mesh_frames(bent, find_frame_method(name)),
                     two = mesh_frames(bent, find_frame_method(name), 2);
    double greatest = 0;
    for (std::size_t c = 0; c < bent.corners(); ++c) {
      const auto [u, v] = bent.uvs[bent.triangles[c / 3][c % 3]];
      greatest = std::max(greatest, norm(one.corner(c).t - unit(Vec3<double>{1, 0, 0.25 * (2 * u + 1)})));
      ASSERT_EQ(one.corner(c).t, two.corner(c).t);
    }
    EXPECT_LE(greatest, 1e-12) << name;  // exact on a quadratic, but for a condition of up to 10^3
  }
}

// Weights are areas and their inverses: they stay within range where the mesh is very small or very large.
TEST(FrameMethods, WeightsDoNotDependOnTheScale) {
  const Mesh mesh = sample_mesh(Torus{1.0, 0.4}, {.columns = 12, .rows = 8, .jitter = 0.2});
  for (const char* name : {"area", "max"}) {
    const MeshFrames plain = mesh_frames(mesh, find_frame_method(name));
    for (const int exponent : {-1000, -570, -515, 515, 570, 1000}) {
      Mesh changed = mesh;
      for (Vec3<double>& p : changed.positions) p = std::ldexp(1.0, exponent) * p;
      const MeshFrames frames = mesh_frames(changed, find_frame_method(name));
      for (std::size_t c = 0; c < mesh.corners(); ++c) {
        EXPECT_FALSE(frames.corner(c).fallback) << name << " 2^" << exponent;
        EXPECT_LE(norm(frames.corner(c).t - plain.corner(c).t), 64 * 0x1p-53) << name << " 2^" << exponent;
      }
    }
  }
}

// A triangle without area in uv has no winding; where its vertices are served, its corners are.
TEST(FrameMethods, CornersWithoutUvAreaTakeTheFramesOfTheirVertices) {
  for (const double mirror : {1.0, -1.0}) {
    Mesh mesh = one_triangle({{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}}, {{{0, 0}, {mirror, 0}, {0, 1}}});
    mesh.positions.push_back({1, 1, 0});
    mesh.normals.push_back({0, 0, 1});
    mesh.uvs.push_back({mirror, 0});
    mesh.triangles.push_back({1, 3, 0});
    for (const char* name : {"average", "procrustes", "quadratic", "cubic"}) {
      const MeshFrames frames = mesh_frames(mesh, find_frame_method(name));
      EXPECT_EQ(frames.degenerate_uv_triangles, 1u);
      for (const std::size_t c : {3u, 5u}) {
        EXPECT_FALSE(frames.corner(c).fallback) << name;
        EXPECT_LE(norm(frames.corner(c).t - Vec3<double>{mirror, 0, 0}), 8 * 0x1p-53) << name;
        EXPECT_EQ(frames.corner(c).sign, mirror) << name;
      }
      EXPECT_TRUE(frames.corner(4).fallback) << name;
    }
  }
}

// The rotation is found again where the uvs are an image of the positions under one, whatever the scale.
TEST(FrameMethods, ProcrustesFindsTheRotation) {
  Mesh mesh = sample_mesh(make_surface("plane"), {.columns = 4, .rows = 4, .jitter = 0.3});
  const Vec3<double> t = unit(Vec3<double>{1, 2, -1}), b = unit(Vec3<double>{1, 0, 1}), n = cross(t, b);
  for (const double scale : {1e-30, 3.0})
    for (const double mirror : {1.0, -1.0}) {
      for (std::size_t v = 0; v < mesh.positions.size(); ++v)
        mesh.positions[v] = scale * (mesh.uvs[v].x * t + mirror * mesh.uvs[v].y * b);
      mesh.normals.assign(mesh.positions.size(), n);
      const MeshFrames frames = mesh_frames(mesh, find_frame_method("procrustes"));
      for (const std::uint32_t f : frames.of_corner) {
        EXPECT_LE(norm(frames.frames[f].t - t), 32 * 0x1p-53);
        EXPECT_LE(norm(frames.frames[f].b - mirror * b), 32 * 0x1p-53);
      }
    }
}

}  // namespace
}  // namespace darboux::mesh_frames_test
