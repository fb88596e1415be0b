#include <array>
#include <random>

#include <gtest/gtest.h>

#include <darboux/catalogue.h>
#include <darboux/mesh_classes.h>
#include <darboux/sample_mesh.h>
#include <darboux/weld.h>

namespace darboux {
namespace {

TEST(Weld, GroupsWhatIsWithinTheTolerance) {
  const std::vector<Vec3<double>> points{{0, 0, 0},    {1, 0, 0},   {1e-9, 0, 0}, {1, 1e-9, -1e-9},
                                         {1e-7, 0, 0}, {NAN, 0, 0}, {NAN, 0, 0}};
  EXPECT_EQ(weld(points, 1e-8), (std::vector<std::uint32_t>{0, 1, 0, 1, 4, 5, 6}));
  EXPECT_EQ(weld(points, 1e-6), (std::vector<std::uint32_t>{0, 1, 0, 1, 0, 5, 6}));
  EXPECT_EQ(weld(points, 0), (std::vector<std::uint32_t>{0, 1, 2, 3, 4, 5, 6}));
  EXPECT_TRUE(weld({}, 1).empty());
}

// Against every pair, on random points with near-duplicates on both sides of cell borders.
TEST(Weld, EqualsTheQuadraticSearch) {
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> uniform(-1, 1);
  constexpr double tolerance = 1e-3;
  std::vector<Vec3<double>> points;
  for (int i = 0; i < 300; ++i) {
    const Vec3<double> p{uniform(random), uniform(random), 0};
    points.push_back(p);
    points.push_back({p.x + 0.9 * tolerance * uniform(random), p.y + 0.9 * tolerance * uniform(random), 0});
  }
  std::vector<std::uint32_t> expected(points.size());
  for (std::uint32_t i = 0; i < points.size(); ++i) expected[i] = i;
  for (bool changed = true; changed;) {
    changed = false;
    for (std::size_t i = 0; i < points.size(); ++i)
      for (std::size_t j = 0; j < points.size(); ++j) {
        const Vec3<double> d = points[i] - points[j];
        if (std::fabs(d.x) > tolerance || std::fabs(d.y) > tolerance || expected[j] >= expected[i]) continue;
        expected[i] = expected[j];
        changed = true;
      }
  }
  EXPECT_EQ(weld(points, tolerance), expected);
}

struct Counts {
  std::array<int, 6> of{};
  int operator[](VertexClass c) const { return of[static_cast<std::size_t>(c)]; }
};

Counts count(const AnySurface& surface, const SampleMeshOptions& options) {
  const Mesh mesh = sample_mesh(surface, options);
  std::vector<bool> pole;
  for (const auto& uv : mesh.uvs) pole.push_back(has(surface.frame(uv.x, uv.y).status, Status::dpdu_zero));
  Counts counts;
  for (const VertexClass c : classify(mesh, pole).of_vertex) ++counts.of[static_cast<std::size_t>(c)];
  return counts;
}

TEST(Classify, NamesThePartsOfGrids) {
  const SampleMeshOptions o{.columns = 8, .rows = 6};
  const Counts torus = count(Torus{1.0, 0.4}, o);
  EXPECT_EQ(torus[VertexClass::seam], 2 * 9 + 2 * 5);  // both rows v = 0, 1 and both columns u = 0, 1
  EXPECT_EQ(torus[VertexClass::interior], 7 * 5);
  const Counts sphere = count(Sphere{1.0}, o);
  EXPECT_EQ(sphere[VertexClass::pole], 16);
  EXPECT_EQ(sphere[VertexClass::seam], 2 * 5);
  EXPECT_EQ(sphere[VertexClass::pole_ring], 2 * 7);
  EXPECT_EQ(sphere[VertexClass::interior], 3 * 7);
  const Counts cylinder = count(Cylinder{1.0, 1.0}, o);
  EXPECT_EQ(cylinder[VertexClass::seam], 2 * 7);
  EXPECT_EQ(cylinder[VertexClass::border], 2 * 7);
  EXPECT_EQ(cylinder[VertexClass::interior], 7 * 5);
  // A fold has the same uv on both sides, but uv area of the other sign.
  SampleMeshOptions mirrored = o;
  mirrored.mirror = true;
  const Counts folded = count(Cylinder{1.0, 1.0}, mirrored);
  EXPECT_EQ(folded[VertexClass::seam], 2 * 7 + 2 * 7);
}

TEST(Classify, FindsCreasesAndIslands) {
  // A unit cube's two faces at a right angle: four vertices each, the common edge doubled.
  Mesh mesh;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {1, 0, 0}, {1, 0, -1}, {1, 1, -1}, {1, 1, 0}};
  mesh.normals = {{0, 0, 1}, {0, 0, 1}, {0, 0, 1}, {0, 0, 1}, {1, 0, 0}, {1, 0, 0}, {1, 0, 0}, {1, 0, 0}};
  mesh.uvs = {{0, 0}, {1, 0}, {1, 1}, {0, 1}, {0, 0}, {1, 0}, {1, 1}, {0, 1}};
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}, {4, 5, 6}, {4, 6, 7}};
  const MeshClasses classes = classify(mesh, {});
  for (const std::uint32_t v : {1u, 2u, 4u, 7u}) EXPECT_EQ(classes.of_vertex[v], VertexClass::crease);
  for (const std::uint32_t v : {0u, 3u, 5u, 6u}) EXPECT_EQ(classes.of_vertex[v], VertexClass::border);
  EXPECT_EQ(classes.islands, 2);
  EXPECT_EQ(classes.island_of_triangle, (std::vector<std::int32_t>{0, 0, 1, 1}));
  // Continuing uvs over the edge joins the islands; mirroring one triangle parts it again.
  mesh.uvs[4] = {1, 0}, mesh.uvs[5] = {2, 0}, mesh.uvs[6] = {2, 1}, mesh.uvs[7] = {1, 1};
  EXPECT_EQ(classify(mesh, {}).islands, 1);
  mesh.uvs[6] = {0.5, -1};
  EXPECT_GT(classify(mesh, {}).islands, 1);
}

// The same mesh as triangle soup has the same classes at the same corners.
TEST(Classify, DoesNotDependOnIndexing) {
  for (const AnySurface& surface : all_surfaces()) {
    const Mesh mesh = sample_mesh(surface, {.columns = 10, .rows = 6, .jitter = 0.2});
    Mesh soup;
    std::vector<bool> pole, soup_pole;
    for (const auto& uv : mesh.uvs) pole.push_back(has(surface.frame(uv.x, uv.y).status, Status::dpdu_zero));
    for (const Triangle& triangle : mesh.triangles) {
      const auto base = static_cast<std::uint32_t>(soup.positions.size());
      for (const std::uint32_t v : triangle) {
        soup.positions.push_back(mesh.positions[v]);
        soup.normals.push_back(mesh.normals[v]);
        soup.uvs.push_back(mesh.uvs[v]);
        soup_pole.push_back(pole[v]);
      }
      soup.triangles.push_back({base, base + 1, base + 2});
    }
    const MeshClasses indexed = classify(mesh, pole), flat = classify(soup, soup_pole);
    EXPECT_EQ(indexed.islands, flat.islands);
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
      for (int k = 0; k < 3; ++k)
        EXPECT_EQ(indexed.of_vertex[mesh.triangles[t][k]], flat.of_vertex[soup.triangles[t][k]])
            << surface.info().name;
  }
}

// Ranges are those of the data in use: vertices that no triangle uses, and infinities, change no class.
TEST(Classify, IgnoresUnreferencedAndInfiniteData) {
  const Mesh good = sample_mesh(Torus{1.0, 0.4}, {.columns = 16, .rows = 8});
  const std::vector<VertexClass> expected = classify(good, {}).of_vertex;
  const auto same_but_last = [&](const Mesh& mesh) {
    std::vector<VertexClass> found = classify(mesh, {}).of_vertex;
    found.resize(expected.size());
    EXPECT_EQ(found, expected);
  };
  for (const Vec3<double> far : {Vec3<double>{1e30, 0, 0}, Vec3<double>{INFINITY, 0, 0}}) {
    Mesh mesh = good;
    mesh.positions.push_back(far);
    mesh.normals.push_back({0, 0, 1});
    mesh.uvs.push_back({1e9, -INFINITY});
    mesh.tangents.push_back({1, 0, 0, 1});
    same_but_last(mesh);
  }
  // In use, an infinite position is torn off; all else stays what it was, but for the vertices around it.
  Mesh torn = good;
  torn.positions[17 * 4 + 5].x = INFINITY;
  const std::vector<VertexClass> classes = classify(torn, {}).of_vertex;
  for (std::uint32_t v = 0; v < classes.size(); ++v)
    if (expected[v] == VertexClass::seam) {
      EXPECT_EQ(classes[v], VertexClass::seam) << v;
    }
}

// A fan whose centre has another uv in every triangle: no two triangles share position and uv over an edge.
TEST(Classify, TellsTheIslandsOfALargeFanApart) {
  Mesh mesh;
  constexpr std::uint32_t n = 100;
  for (std::uint32_t i = 0; i < n; ++i) {
    const auto rim = [](std::uint32_t k) { return Vec3<double>{std::cos(0.06 * k), std::sin(0.06 * k), 0}; };
    mesh.positions.insert(mesh.positions.end(), {{0, 0, 0}, rim(i), rim(i + 1)});
    mesh.normals.insert(mesh.normals.end(), 3, {0, 0, 1});
    mesh.uvs.insert(mesh.uvs.end(), {{(i + 0.5) / n, 1}, {1.0 * i / n, 0}, {(i + 1.0) / n, 0}});
    mesh.triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
  }
  EXPECT_EQ(classify(mesh, {}).islands, static_cast<std::int32_t>(n));
}

}  // namespace
}  // namespace darboux
