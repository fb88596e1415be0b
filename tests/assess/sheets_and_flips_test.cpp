// Sheets that show both sides, normals turned round, and charts that meet at one uv.
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <string>

#include <gtest/gtest.h>

#include <darboux/assess.h>
#include <darboux/sample_mesh.h>

namespace darboux::sheets_and_flips_test {
namespace {

// Open and closed, each recognised.
constexpr std::array surfaces{"sphere",
                              "cylinder:radius=1,height=2",
                              "cone:radius=2,height=4",
                              "torus:major_radius=2,minor_radius=0.5",
                              "hyperbolic-paraboloid",
                              "ellipsoid:semi_axis_x=1,semi_axis_y=2,semi_axis_z=1.5"};

void turn_inside_out(Mesh& mesh) {
  for (Triangle& t : mesh.triangles) std::swap(t[1], t[2]);
  for (auto& n : mesh.normals) n = -n;
}

Mesh half_of(const std::string& surface, bool inside_out) {
  Mesh mesh = sample_mesh(make_surface(surface), {.columns = 12, .rows = 8, .v_last = 0.5});
  if (inside_out) turn_inside_out(mesh);
  return mesh;
}

Mesh corner_by_corner(const Mesh& mesh) {
  Mesh soup;
  for (const Triangle& t : mesh.triangles) {
    const auto first = static_cast<std::uint32_t>(soup.positions.size());
    soup.triangles.push_back({first, first + 1, first + 2});
    for (const std::uint32_t v : t) {
      soup.positions.push_back(mesh.positions[v]), soup.normals.push_back(mesh.normals[v]);
      soup.uvs.push_back(mesh.uvs[v]), soup.tangents.push_back(mesh.tangents[v]);
    }
  }
  return soup;
}

std::size_t errors(const MeshReport& report, std::string_view code) {
  std::size_t count = 0;
  for (const Finding& f : report.findings)
    if (f.severity == Severity::error && (code.empty() || f.code == code)) count += f.count;
  return count;
}

// One normal serves the triangles of both sides.
TEST(Sheets, TrianglesOfBothSidesOverTheSameVertices) {
  for (const std::string surface : surfaces)
    for (const bool inside_out : {false, true}) {
      SCOPED_TRACE(surface + (inside_out ? ", inside out" : ""));
      Mesh mesh = half_of(surface, inside_out);
      const Assessment once = assess(mesh);
      ASSERT_TRUE(once.fit);
      EXPECT_NE(once.report.verdict, Verdict::fail);
      const std::vector<Triangle> front = mesh.triangles;
      for (const auto& [a, b, c] : front) mesh.triangles.push_back({a, c, b});
      const Assessment both = assess(mesh);
      ASSERT_TRUE(both.fit);
      EXPECT_EQ(errors(both.report, ""), 0u);
      for (const Assessment& part : assess_parts(mesh)) EXPECT_EQ(errors(part.report, ""), 0u);
    }
}

// Whichever side of the surface is the mesh's outside.
TEST(Flips, NormalsTurnedRoundAreErrors) {
  for (const std::string surface : surfaces)
    for (const bool inside_out : {false, true})
      for (const std::size_t step : {3, 7, 20}) {
        SCOPED_TRACE(surface + (inside_out ? ", inside out, every " : ", every ") + std::to_string(step));
        Mesh mesh = half_of(surface, inside_out);
        std::vector<bool> flipped(mesh.positions.size(), false);
        for (std::size_t v = 0; v < flipped.size(); v += step)
          flipped[v] = true, mesh.normals[v] = -mesh.normals[v];
        std::size_t corners = 0;
        for (const Triangle& t : mesh.triangles)
          for (const std::uint32_t v : t) corners += flipped[v];
        const Assessment found = assess(mesh);
        EXPECT_EQ(errors(found.report, "NORMAL_ANGLE") + errors(found.report, "TANGENT_HANDEDNESS"), corners);
      }
}

// A triangle that is wound the wrong way agrees with a normal that is turned round; the others do not.
TEST(Flips, BesideATriangleThatIsWoundTheWrongWay) {
  for (const std::string surface : surfaces)
    for (const bool inside_out : {false, true})
      for (const bool declared : {false, true}) {
        SCOPED_TRACE(surface + (inside_out ? ", inside out" : "") + (declared ? ", declared" : ""));
        Mesh mesh = half_of(surface, inside_out);
        AssessOptions options;
        if (declared) options.surface = parse_specification(surface);
        // The first with four triangles or more.
        std::vector<std::size_t> triangles(mesh.positions.size(), 0);
        for (const Triangle& t : mesh.triangles)
          for (const std::uint32_t v : t) ++triangles[v];
        const auto turned = static_cast<std::uint32_t>(
            std::ranges::find_if(triangles, [](std::size_t n) { return n >= 4; }) - triangles.begin());
        Triangle& wrong = *std::ranges::find_if(
            mesh.triangles, [&](const Triangle& t) { return std::ranges::find(t, turned) != t.end(); });
        std::swap(wrong[1], wrong[2]);
        mesh.normals[turned] = -mesh.normals[turned];
        const MeshReport found = assess(mesh, options).report;
        EXPECT_GE(errors(found, "NORMAL_ANGLE") + errors(found, "TANGENT_HANDEDNESS"), triangles[turned]);
      }
}

// Corners that were meant to coincide, as JavaScript's sin(pi) leaves them: nobody sees what lies between.
TEST(Vanishing, TrianglesNeedNoNormals) {
  Mesh mesh = sample_mesh(make_surface("sphere"), {.columns = 12, .rows = 8});
  mesh.tangents.clear();
  const auto with_triangle = [&](double apart) {
    Mesh more = mesh;
    const auto first = static_cast<std::uint32_t>(more.positions.size());
    for (const Vec3<double>& p : {Vec3<double>{0, 0, 1}, {apart, 0, 1}, {0, 0.1, 0.995}}) {
      more.positions.push_back(p);
      more.normals.push_back({});
      more.uvs.push_back({0.5, 0.5});
    }
    more.triangles.push_back({first, first + 1, first + 2});
    std::size_t count = 0;
    for (const Assessment& part : assess_parts(more)) count += errors(part.report, "NORMAL_NOT_UNIT");
    return count;
  };
  EXPECT_EQ(with_triangle(1e-17), 0u);
  EXPECT_EQ(with_triangle(1e-12), 0u);
  EXPECT_EQ(with_triangle(1e-6), 3u);
}

// A column whose normals are blended into the base on which it stands: told, and no error. As far off all the
// way, they are one.
TEST(Blends, NormalsThatTurnTowardsABorder) {
  for (const bool soup : {false, true})
    for (const bool inside_out : {false, true})
      for (const bool blended : {true, false}) {
        SCOPED_TRACE(std::string(soup ? "a vertex per corner" : "shared vertices") +
                     (inside_out ? ", inside out" : "") + (blended ? ", blended" : ", alike"));
        Mesh mesh = sample_mesh(make_surface("cylinder:radius=1,height=4"), {.columns = 16, .rows = 24});
        if (inside_out) turn_inside_out(mesh);
        std::size_t edited = 0;
        for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
          const double row = std::round(24 * mesh.uvs[v].y);
          if (row > 2) continue;
          const double deg = blended ? 45 / (1 + row) : 20, a = deg * std::numbers::pi / 180;
          mesh.normals[v] = std::cos(a) * mesh.normals[v] + std::sin(a) * Vec3<double>{0, 0, 1};
          ++edited;
        }
        ASSERT_GT(edited, 0u);
        if (soup) mesh = corner_by_corner(mesh);
        const Assessment found = assess(mesh);
        ASSERT_TRUE(found.fit);
        EXPECT_EQ(errors(found.report, "") == 0, blended);
        EXPECT_TRUE(std::ranges::any_of(found.report.findings,
                                        [](const Finding& f) { return f.code == "NORMAL_ANGLE"; }));
      }
}

// Normals that turn beside a seam are no blend: the surface goes on there.
TEST(Blends, NotFromASeam) {
  Mesh mesh = sample_mesh(make_surface("cylinder:radius=1,height=4"), {.columns = 24, .rows = 8});
  for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
    const double column = std::fmod(std::round(24 * mesh.uvs[v].x), 24), row = std::round(8 * mesh.uvs[v].y);
    if (column > 2 || row < 2 || row > 6) continue;
    const double a = 45 / (1 + column) * std::numbers::pi / 180;
    mesh.normals[v] = std::cos(a) * mesh.normals[v] + std::sin(a) * Vec3<double>{0, 0, 1};
  }
  EXPECT_GT(errors(assess(mesh).report, "NORMAL_ANGLE"), 0u);
}

// Each face of a cube has the same square of a texture, so that at a corner of the cube its three charts have
// one uv, and three tangents.
TEST(Charts, ThatMeetAtOneUvAreASeam) {
  const Vec3<double> axes{1, 2, 1};
  constexpr int cells = 2;
  Mesh mesh;
  for (int face = 0; face < 6; ++face) {
    const auto first = static_cast<std::uint32_t>(mesh.positions.size());
    const int k = face / 2;
    const double side = face % 2 == 0 ? 1 : -1;
    for (int j = 0; j <= cells; ++j)
      for (int i = 0; i <= cells; ++i) {
        const double a = 2.0 * i / cells - 1, b = 2.0 * j / cells - 1;
        std::array<double, 3> c{}, da{};
        c[static_cast<std::size_t>(k)] = side;
        // Along a, b and outwards: right-handed on every face.
        c[static_cast<std::size_t>((k + 1) % 3)] = side * a, da[static_cast<std::size_t>((k + 1) % 3)] = side;
        c[static_cast<std::size_t>((k + 2) % 3)] = b;
        const Vec3<double> cube{c[0], c[1], c[2]}, along{da[0], da[1], da[2]};
        const double r = norm(cube);
        const Vec3<double> ball = cube / r, turn = along / r - dot(along, ball) / r * ball;
        mesh.positions.push_back({axes.x * ball.x, axes.y * ball.y, axes.z * ball.z});
        mesh.normals.push_back(unit(Vec3<double>{ball.x / axes.x, ball.y / axes.y, ball.z / axes.z}));
        const Vec3<double> t = unit(Vec3<double>{axes.x * turn.x, axes.y * turn.y, axes.z * turn.z});
        mesh.tangents.push_back({t.x, t.y, t.z, 1});
        mesh.uvs.push_back({static_cast<double>(i) / cells, static_cast<double>(j) / cells});
      }
    for (std::uint32_t j = 0; j < cells; ++j)
      for (std::uint32_t i = 0; i < cells; ++i) {
        const std::uint32_t p = first + j * (cells + 1) + i;
        mesh.triangles.push_back({p, p + 1, p + cells + 2});
        mesh.triangles.push_back({p, p + cells + 2, p + cells + 1});
      }
  }
  const MeshClasses classes = classify(mesh, {});
  EXPECT_EQ(classes.islands, 6);
  for (std::uint32_t v = 0; v < mesh.positions.size(); ++v) {
    const Vec2<double> uv = mesh.uvs[v];
    const bool inside = uv.x > 0 && uv.x < 1 && uv.y > 0 && uv.y < 1;
    EXPECT_EQ(classes.of_vertex[v], inside ? VertexClass::interior : VertexClass::seam) << v;
  }
  const Assessment found = assess(mesh);
  EXPECT_EQ(errors(found.report, ""), 0u);
}

}  // namespace
}  // namespace darboux::sheets_and_flips_test
