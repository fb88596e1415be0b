// The stress list for triangles and uvs: extreme meshes, and what every method of mesh_frames() makes of
// them. docs/reports/stress-list.md says for each group what is done about it.
#include <cmath>
#include <functional>
#include <limits>
#include <ostream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include <darboux/error.h>
#include <darboux/mesh_frames.h>

namespace darboux::test::stress_list_test {
namespace {

constexpr double inf = std::numeric_limits<double>::infinity(),
                 nan = std::numeric_limits<double>::quiet_NaN();

// Two triangles over a square in the plane z = 0, uv = (x, y): t = (1, 0, 0), n = (0, 0, 1).
Mesh square() {
  Mesh mesh;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
  mesh.normals.assign(4, {0, 0, 1});
  mesh.uvs = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  return mesh;
}

enum class Right {
  refused,     // MeshError
  flagged,     // the first triangle is counted as degenerate, and every frame is orthonormal
  exact,       // the frames of the square, in double to 1e-12; in float where its range holds
  orthonormal  // numbers: every frame is orthonormal
};

struct Stress {
  int group;
  const char* name;
  std::function<void(Mesh&)> change;  // of the square
  Right right;
};
void PrintTo(const Stress& s, std::ostream* out) {
  *out << "group " << s.group << ": " << s.name;
}

std::function<void(Mesh&)> scaled(double by) {
  return [by](Mesh& m) {
    for (Vec3<double>& p : m.positions) p = by * p;
  };
}
std::function<void(Mesh&)> uvs_scaled(double by) {
  return [by](Mesh& m) {
    for (Vec2<double>& uv : m.uvs) uv = {by * uv.x, by * uv.y};
  };
}

const std::vector<Stress> stress_list{
    {19, "two corners equal", [](Mesh& m) { m.positions[1] = m.positions[0]; }, Right::flagged},
    {19, "three collinear",
     [](Mesh& m) {
       m.positions[1] = {0.5, 0.5, 0};
     },
     Right::flagged},
    {19, "all in one place",
     [](Mesh& m) {
       m.positions.assign(4, {0, 0, 0});
     },
     Right::flagged},
    {20, "all uvs equal",
     [](Mesh& m) {
       m.uvs.assign(4, {0.5, 0.5});
     },
     Right::flagged},
    {20, "uvs on a line",
     [](Mesh& m) {
       m.uvs[1] = {0.5, 0.5};
     },
     Right::flagged},
    {21, "one triangle mirrored in uv",
     [](Mesh& m) {
       m.uvs[3] = {1, 0};
     },
     Right::orthonormal},
    {22, "uv jumps over the seam",
     [](Mesh& m) {
       m.uvs[1] = m.uvs[2] = {0.01, 0.5};
     },
     Right::orthonormal},
    {23, "uv is not a number", [](Mesh& m) { m.uvs[2].x = nan; }, Right::refused},
    {23, "uv is infinite", [](Mesh& m) { m.uvs[2].y = inf; }, Right::refused},
    {23, "uvs times 1e15", uvs_scaled(1e15), Right::exact},
    {23, "uvs times 1e-15", uvs_scaled(1e-15), Right::exact},
    {23, "uvs times 1e30", uvs_scaled(1e30), Right::exact},
    {23, "uvs times 1e-300", uvs_scaled(1e-300), Right::orthonormal},
    {24, "sliver of 1 to 1e8",
     [](Mesh& m) {
       for (Vec3<double>& p : m.positions) p.y *= 1e-8;
     },
     Right::exact},
    {25, "a vertex that no triangle uses",
     [](Mesh& m) {
       m.positions.push_back({5, 5, 5});
       m.normals.push_back({0, 0, 1});
       m.uvs.push_back({5, 5});
     },
     Right::exact},
    {25, "three triangles at an edge",
     [](Mesh& m) {
       m.triangles.push_back({0, 1, 3});
     },
     Right::orthonormal},
    {25, "a triangle twice", [](Mesh& m) { m.triangles.push_back(m.triangles[0]); }, Right::exact},
    {26, "a normal is zero",
     [](Mesh& m) {
       m.normals[0] = {0, 0, 0};
     },
     Right::orthonormal},
    {26, "a normal is not a number", [](Mesh& m) { m.normals[0].z = nan; }, Right::refused},
    {27, "positions times 1e15", scaled(1e15), Right::exact},
    {27, "positions times 1e-15", scaled(1e-15), Right::exact},
    {27, "positions times 1e30", scaled(1e30), Right::exact},
    {27, "positions times 1e-30", scaled(1e-30), Right::exact},
    {27, "a position is infinite", [](Mesh& m) { m.positions[1].x = inf; }, Right::refused},
    {28, "an index beyond the vertices", [](Mesh& m) { m.triangles[0][1] = 4; }, Right::refused},
    {28, "the index 2^32 - 1", [](Mesh& m) { m.triangles[0][1] = 0xffffffff; }, Right::refused},
    {28, "no triangle", [](Mesh& m) { m.triangles.clear(); }, Right::exact},
    {28, "one triangle", [](Mesh& m) { m.triangles.pop_back(); }, Right::exact},
};

class StressList : public ::testing::TestWithParam<Stress> {};
INSTANTIATE_TEST_SUITE_P(Meshes, StressList, ::testing::ValuesIn(stress_list), [](const auto& info) {
  return "group" + std::to_string(info.param.group) + "_" + std::to_string(info.index);
});

bool orthonormal(const CornerFrame& f) {
  return std::fabs(norm(f.t) - 1) < 1e-6 && std::fabs(dot(f.t, f.n)) < 1e-6;
}

TEST_P(StressList, EveryMethodGivesTheRightAnswerOrTheRightRefusal) {
  const Stress& s = GetParam();
  Mesh mesh = square();
  s.change(mesh);
  for (const FrameMethod& method : frame_methods()) {
    SCOPED_TRACE(method.name);
    if (s.right == Right::refused) {
      EXPECT_THROW(mesh_frames(mesh, method), MeshError);
      continue;
    }
    const MeshFrames found = mesh_frames(mesh, method);
    ASSERT_EQ(found.of_corner.size(), mesh.corners());
    EXPECT_TRUE(s.right != Right::flagged || found.degenerate_triangles + found.degenerate_uv_triangles > 0);
    // Squares of float's range.
    const bool in_range =
        !method.single_precision || (std::string(s.name).find("1e30") == std::string::npos &&
                                     std::string(s.name).find("1e-30") == std::string::npos &&
                                     std::string(s.name).find("1e-15") == std::string::npos &&
                                     std::string(s.name).find("1e8") == std::string::npos);
    for (std::size_t c = 0; c < mesh.corners(); ++c) {
      const CornerFrame& f = found.corner(c);
      const bool zero_normal = s.group == 26 && method.needs_normals && mesh.triangles[c / 3][c % 3] == 0;
      EXPECT_TRUE(zero_normal || orthonormal(f))
          << "corner " << c << ": " << f.t.x << ' ' << f.t.y << ' ' << f.t.z;
      // On the sliver lengths along u and v differ.
      const bool suits = s.group != 24 || method.tangent_chart != Chart::conformal;
      if (s.right == Right::exact && in_range && suits) {
        EXPECT_FALSE(f.fallback) << c;
        EXPECT_NEAR(f.t.x, 1, method.single_precision ? 1e-6 : 1e-12) << c;
      }
    }
  }
}

}  // namespace
}  // namespace darboux::test::stress_list_test
