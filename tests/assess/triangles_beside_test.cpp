// Surfaces that are cut into primitives, as at the borders of materials: averages at a primitive's border may
// be over the others' triangles too.
#include "assets/triangles_beside.h"

#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include <darboux/assess.h>
#include <darboux/error.h>
#include <darboux/frame.h>
#include <darboux/io.h>

#include "said.h"

namespace darboux::triangles_beside_test {
namespace {

using test::said;
using V = Vec3<double>;

// A smooth octahedron, flattened, with averages of all its triangles for normals; each triangle k is one of
// primitive k % primitives.
std::vector<Primitive> flattened(std::size_t primitives) {
  const V x{1, 0, 0}, y{0, 1, 0}, z{0, 0, 0.05};
  const V corner[] = {x, y, -x, -y, z, -z};
  const Triangle faces[] = {{0, 1, 4}, {1, 2, 4}, {2, 3, 4}, {3, 0, 4},
                            {1, 0, 5}, {2, 1, 5}, {3, 2, 5}, {0, 3, 5}};
  V normals[6] = {};
  for (const Triangle& t : faces)
    for (std::size_t k = 0; k < 3; ++k) {
      const V &p = corner[t[k]], a = corner[t[(k + 1) % 3]] - p, b = corner[t[(k + 2) % 3]] - p;
      normals[t[k]] = normals[t[k]] + std::atan2(norm(cross(a, b)), dot(a, b)) * unit(cross(a, b));
    }
  std::vector<Primitive> result(primitives);
  for (std::size_t t = 0; t < 8; ++t) {
    Primitive& p = result[t % primitives];
    p.primitive = t % primitives;
    Mesh& mesh = p.data;
    const auto first = static_cast<std::uint32_t>(mesh.positions.size());
    mesh.triangles.push_back({first, first + 1, first + 2});
    for (const std::uint32_t v : faces[t]) {
      mesh.positions.push_back(corner[v]);
      mesh.normals.push_back(unit(normals[v]));
    }
  }
  return result;
}

TEST(TrianglesBeside, AreThoseThatShareAVertex) {
  const std::vector<Primitive> primitives = flattened(4);
  const std::vector<Mesh> beside = triangles_beside(primitives);
  ASSERT_EQ(beside.size(), 4U);
  for (std::size_t i = 0; i < 4; ++i) {
    // Each primitive has two triangles, k and k + 4, whose vertices all others share.
    EXPECT_EQ(beside[i].triangles.size(), 6U);
    EXPECT_EQ(beside[i].normals.size(), beside[i].positions.size());
    EXPECT_NO_THROW(check_consistent(beside[i], "beside"));
  }
  std::vector<Primitive> apart = primitives;
  for (std::size_t i = 0; i < 4; ++i) apart[i].mesh = i;
  for (const Mesh& mesh : triangles_beside(apart)) EXPECT_TRUE(mesh.triangles.empty());
  for (Primitive& p : apart) p.name = "Cube";
  EXPECT_EQ(triangles_beside(apart)[0].triangles.size(), 6U);
}

// Coats, and passes of a renderer.
TEST(TrianglesBeside, TheSameTrianglesAreNotBeside) {
  for (const std::size_t count : {2, 20}) {
    std::vector<Primitive> same(count, flattened(1)[0]);
    for (std::size_t i = 0; i < same.size(); ++i) same[i].primitive = i;
    for (const Mesh& mesh : triangles_beside(same)) EXPECT_TRUE(mesh.triangles.empty());
  }
}

// A quad's far half does not touch the other primitive.
TEST(TrianglesBeside, BothHalvesOfAQuadAre) {
  std::vector<Primitive> two(2);
  two[1].primitive = 1;
  two[0].data.positions = {{0, 0, 0}, {0, 1, 0}, {-1, 0, 0}};
  two[0].data.triangles = {{0, 1, 2}};
  two[1].data.positions = {{1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0, 2, 0}};
  two[1].data.triangles = {{0, 1, 2}, {1, 3, 2}};
  for (Primitive& p : two) p.data.normals.assign(p.data.positions.size(), V{0, 0, 1});
  EXPECT_EQ(triangles_beside(two)[0].triangles.size(), 2U);
  two[1].data.positions.push_back({1, 2, 0});
  two[1].data.normals.push_back({0, 0, 1});
  two[1].data.triangles = {{2, 0, 1}, {1, 0, 4}};
  EXPECT_EQ(triangles_beside(two)[0].triangles.size(), 1U);
  two[1].data.triangles = {{2, 0, 4}, {2, 4, 3}, {0, 1, 4}};
  EXPECT_EQ(triangles_beside(two)[0].triangles.size(), 2U);
  two[1].data.triangles = {{0, 2, 1}, {0, 1, 4}};
  EXPECT_EQ(triangles_beside(two)[0].triangles.size(), 2U) << "a quad 0 2 1 4, of which one half touches";
}

// Alone, each primitive has normals that are no averages of its own triangles, as many as 80 degrees away.
TEST(TrianglesBeside, AveragesOverAllPrimitivesAreRight) {
  const std::vector<Primitive> primitives = flattened(4);
  const std::vector<Mesh> beside = triangles_beside(primitives);
  std::string alone, together;
  for (std::size_t i = 0; i < primitives.size(); ++i) {
    alone += said(assess(primitives[i].data).report);
    AssessOptions options;
    options.beside = &beside[i];
    together += said(assess(primitives[i].data, options).report);
    EXPECT_NE(assess(primitives[i].data, options).report.verdict, Verdict::fail);
  }
  EXPECT_NE(alone, "");
  EXPECT_EQ(together, "");
}

TEST(TrianglesBeside, HaveTheMeshsAttributes) {
  const std::vector<Primitive> primitives = flattened(2);
  Mesh other = primitives[1].data;
  other.normals.clear();
  AssessOptions options;
  options.beside = &other;
  EXPECT_THROW(assess(primitives[0].data, options), MeshError);
}

}  // namespace
}  // namespace darboux::triangles_beside_test
