#include <algorithm>
#include <array>
#include <limits>
#include <map>
#include <numeric>
#include <random>
#include <set>
#include <tuple>

#include <gtest/gtest.h>

#include <darboux/catalogue.h>
#include <darboux/error.h>
#include <darboux/mesh_classes.h>
#include <darboux/mesh_frames.h>
#include <darboux/sample_mesh.h>
#include <darboux/weld.h>

namespace darboux::mesh_classes_test {
namespace {

TEST(Weld, GroupsWhatIsWithinTheTolerance) {
  const std::vector<Vec3<double>> points{{0, 0, 0},    {1, 0, 0},   {1e-9, 0, 0}, {1, 1e-9, -1e-9},
                                         {1e-7, 0, 0}, {NAN, 0, 0}, {NAN, 0, 0}};
  EXPECT_EQ(weld(points, 1e-8), (std::vector<std::uint32_t>{0, 1, 0, 1, 4, 5, 6}));
  EXPECT_EQ(weld(points, 1e-6), (std::vector<std::uint32_t>{0, 1, 0, 1, 0, 5, 6}));
  EXPECT_EQ(weld(points, 0), (std::vector<std::uint32_t>{0, 1, 2, 3, 4, 5, 6}));
  EXPECT_TRUE(weld({}, 1).empty());
}

// The least member of each set of points joined by chains of `near` pairs.
template <class Near>
std::vector<std::uint32_t> chains(std::size_t n, Near near) {
  std::vector<std::uint32_t> first(n);
  std::iota(first.begin(), first.end(), 0u);
  for (bool changed = true; changed;) {
    changed = false;
    for (std::uint32_t i = 0; i < n; ++i)
      for (std::uint32_t j = 0; j < n; ++j)
        if (first[j] < first[i] && near(i, j)) first[i] = first[j], changed = true;
  }
  return first;
}

bool within(const Vec3<double>& a, const Vec3<double>& b, double tolerance) {
  return std::fabs(a.x - b.x) <= tolerance && std::fabs(a.y - b.y) <= tolerance &&
         std::fabs(a.z - b.z) <= tolerance;
}

// Against every pair, on random points with duplicates, near-duplicates on both sides of cell borders and
// chains of such: about the origin, far from it, at the ends of the double's range, and with numbers that are
// not finite.
TEST(Weld, EqualsTheQuadraticSearch) {
  constexpr double huge = std::numeric_limits<double>::max(),
                   least = std::numeric_limits<double>::denorm_min();
  struct Case {
    double centre, size, tolerance;
    bool one_far = false;
  };
  for (const auto& [centre, size, tolerance, one_far] :
       {Case{0, 1, 1e-2}, Case{0, 1, 0.1}, Case{0, 1, 0}, Case{1e6, 1, 1e-3}, Case{-1e9, 1e-6, 2e-7},
        Case{0, huge, 1e-2 * huge}, Case{0, huge, huge}, Case{0, huge, 0}, Case{0, 1e-308, 1e-310},
        Case{0, 1, least}, Case{0, 1, INFINITY},
        // crowded far below the tolerance, or below the finest cell
        Case{0, 1, 0.02}, Case{0, 1, 0.3}, Case{0, 1, 1}, Case{1e9, 1e-3, 1e-4}, Case{0, 1e-18, 1e-19, true},
        Case{0, 1e-18, 0, true}}) {
    std::mt19937_64 random(3);
    std::uniform_real_distribution<double> uniform(-1, 1);
    const auto move = [&](double x, double distance) {
      return std::clamp(x + distance * uniform(random), -huge, huge);
    };
    std::vector<Vec3<double>> points{{NAN, 0, 0},      {0.0, -0.0, 0.0}, {INFINITY, 0, 0},
                                     {INFINITY, 0, 0}, {NAN, 0, 0},      {-0.0, 0.0, 0.0}};
    for (int i = 0; i < 300; ++i) {
      const Vec3<double> p{move(centre, size), move(centre, size), i % 3 == 0 ? move(centre, size) : centre};
      const double d = std::isfinite(tolerance) ? 1.5 * tolerance : 0;
      const Vec3<double> q{move(p.x, d), move(p.y, d), move(p.z, d)};
      points.insert(points.end(), {p, q, i % 2 == 0 ? p : q});
    }
    if (one_far) points.push_back({1, 1e9, 0});
    std::shuffle(points.begin(), points.end(), random);
    const double used = std::isfinite(tolerance) ? tolerance : 0;
    const auto near = [&](std::uint32_t i, std::uint32_t j) { return within(points[i], points[j], used); };
    EXPECT_EQ(weld(points, tolerance), chains(points.size(), near))
        << "centre " << centre << ", size " << size << ", tolerance " << tolerance;
  }
}

// Against a sorted map, on as many points as make the table grow.
TEST(Weld, FindsEqualPointsOfMany) {
  std::mt19937_64 random(5);
  std::uniform_int_distribution<int> coordinate(0, 29);
  std::vector<Vec3<double>> points(60000);
  for (Vec3<double>& p : points)
    p = {0.1 * coordinate(random), 1.0 * coordinate(random), 7.0 * coordinate(random)};
  std::map<std::tuple<double, double, double>, std::uint32_t> first;
  std::vector<std::uint32_t> expected;
  for (std::uint32_t i = 0; i < points.size(); ++i)
    expected.push_back(first.try_emplace({points[i].x, points[i].y, points[i].z}, i).first->second);
  for (const double tolerance : {0.0, 1e-3, 0.09}) EXPECT_EQ(weld(points, tolerance), expected) << tolerance;
}

// One vertex so far away that the tolerance, a share of the size, is beyond all that the others differ by.
// Asking each pair would take minutes.
TEST(Weld, StandsOneVertexFarAway) {
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> uniform(0, 1);
  for (const double far : {1e9, 1e30}) {
    const double tolerance = 1e-8 * far;
    std::vector<Vec3<double>> points;
    for (int i = 0; i < 150000; ++i) {
      // Two crowds, each smaller than the tolerance, and apart along a diagonal by what only their nearest
      // points show.
      const double x = 0.9 * uniform(random), y = 0.9 * uniform(random), z = uniform(random);
      points.push_back({tolerance * (x + y < 0.9 ? x : 0.9 - x), tolerance * (x + y < 0.9 ? y : 0.9 - y), z});
      points.push_back({2.3 * tolerance - points.back().x, 2.3 * tolerance - points.back().y, z});
    }
    points.push_back({0, 0, far});
    const auto group = [&](double shift) {
      std::vector<Vec3<double>> moved = points;
      for (std::size_t i = 1; i < moved.size(); i += 2)
        moved[i].x -= shift * tolerance, moved[i].y -= shift * tolerance;
      const std::vector<std::uint32_t> first = weld(moved, tolerance);
      EXPECT_EQ(first.back(), points.size() - 1);
      for (std::size_t i = 2; i + 1 < points.size(); ++i)
        EXPECT_EQ(first[i], first[1] == 0 ? 0 : i % 2) << far << ", point " << i;
      return first[1];
    };
    // Points of the two hypotenuses are near if 2.3 - x - x' <= 1 for both coordinates: sums of 4.6 - 1.8 - 2
    // shift.
    EXPECT_EQ(group(0), 1u);
    EXPECT_EQ(group(0.41), 0u);
  }
}

// Crowds that are near along each axis by other points, and only so, whichever way they are halved first:
// asking pairs, or halving along z, would take minutes.
TEST(Weld, PartsCrowdsThatAreNearlyNear) {
  std::mt19937_64 random(8);
  std::uniform_real_distribution<double> uniform(0, 0.5);
  for (const double beyond : {5e-10, -5e-10}) {
    std::vector<Vec3<double>> points;
    for (int i = 0; i < 100000; ++i) {
      points.push_back(i % 2 == 0 ? Vec3<double>{1e-9, 0, uniform(random)}
                                  : Vec3<double>{0, 1e-9, uniform(random)});
      points.push_back({1 + beyond, 1 + beyond, uniform(random)});
    }
    // Of each of the first, one of x and y is 0, and so 1 + beyond away.
    const std::vector<std::uint32_t> first = weld(points, 1);
    for (std::size_t i = 0; i < points.size(); ++i)
      ASSERT_EQ(first[i], beyond > 0 ? i % 2 : 0) << "point " << i << ", " << beyond;
  }
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

// A mirror fold is one wherever in the order of vertices the sides come, and a vertex without uv area: here
// two quads that mirror each other in uv, and a sliver at the fold whose uvs are a line.
TEST(Classify, FindsFoldsBehindVerticesWithoutUvArea) {
  struct Side {
    Vec3<double> far;
    Vec2<double> uv;
  };
  const Side sides[] = {
      {{-1, 0, 0}, {1, 0}}, {{1, 0, 0}, {1, 0}}, {{0, 0, 0.5}, {0, 0.5}}};  // the last has none
  std::array<int, 3> order{0, 1, 2};
  do {
    Mesh mesh;
    for (const int k : order) {
      const auto base = static_cast<std::uint32_t>(mesh.positions.size());
      mesh.positions.insert(mesh.positions.end(), {{0, 0, 0}, {0, 0, 1}, sides[k].far});
      mesh.uvs.insert(mesh.uvs.end(), {{0, 0}, {0, 1}, sides[k].uv});
      mesh.normals.insert(mesh.normals.end(), 3, {0, 1, 0});
      if (k == 0)
        mesh.triangles.push_back({base, base + 1, base + 2});
      else
        mesh.triangles.push_back({base, base + 2, base + 1});
    }
    const std::vector<VertexClass> classes = classify(mesh, {}).of_vertex;
    for (std::uint32_t v = 0; v < classes.size(); ++v)
      EXPECT_EQ(classes[v] == VertexClass::seam, v % 3 != 2)
          << "vertex " << v << ", order " << order[0] << order[1] << order[2];
  } while (std::next_permutation(order.begin(), order.end()));
}

// ---- against the definition, pair by pair -----------------------------------------------------------------

double size_of_range(std::vector<double> x) {
  if (x.empty()) return 0;
  const auto [low, high] = std::minmax_element(x.begin(), x.end());
  return *high - *low;
}

// How far positions and uvs that count as the same may be apart.
std::pair<double, double> reference_tolerances(const Mesh& mesh, const std::set<std::uint32_t>& used) {
  std::vector<double> x, y, z, u, v;
  for (const std::uint32_t i : used) {
    const Vec3<double>& p = mesh.positions[i];
    if (!std::isfinite(p.x + p.y + p.z)) continue;
    x.push_back(p.x), y.push_back(p.y), z.push_back(p.z);
    if (mesh.uvs.empty() || !std::isfinite(mesh.uvs[i].x + mesh.uvs[i].y)) continue;
    u.push_back(mesh.uvs[i].x), v.push_back(mesh.uvs[i].y);
  }
  return {1e-6 * std::hypot(size_of_range(x), size_of_range(y), size_of_range(z)),
          1e-6 * std::max(size_of_range(u), size_of_range(v))};
}

// For each vertex the first at its place with its normal, itself a first.
std::vector<std::uint32_t> first_with_normal(const Mesh& mesh, const std::vector<std::uint32_t>& place) {
  std::vector<std::uint32_t> normal(place.size());
  for (std::uint32_t i = 0; i < normal.size(); ++i) {
    const auto fits = [&](std::uint32_t j) {
      return j == i || (place[j] == place[i] && normal[j] == j &&
                        (mesh.normals.empty() || within(mesh.normals[i], mesh.normals[j], 2e-6)));
    };
    while (!fits(normal[i])) ++normal[i];
  }
  return normal;
}

// Classes and islands from every pair of vertices and every pair of triangles. Which uv and normal a vertex
// has is asked of the first vertex of its place and normal. Less than 64 normals per place.
MeshClasses reference_classes(const Mesh& mesh, const std::vector<bool>& pole) {
  const auto n = static_cast<std::uint32_t>(mesh.positions.size());
  const auto triangles = static_cast<std::uint32_t>(mesh.triangles.size());
  std::set<std::uint32_t> used;
  for (const Triangle& triangle : mesh.triangles) used.insert(triangle.begin(), triangle.end());
  const auto tolerances = reference_tolerances(mesh, used);
  const double tolerance = tolerances.first, uv_tolerance = tolerances.second;

  const std::vector<std::uint32_t> place = chains(n, [&](std::uint32_t i, std::uint32_t j) {
    return used.contains(i) && used.contains(j) && within(mesh.positions[i], mesh.positions[j], tolerance);
  });
  const auto same_uv = [&](std::uint32_t i, std::uint32_t j) {
    return mesh.uvs.empty() || (std::fabs(mesh.uvs[i].x - mesh.uvs[j].x) <= uv_tolerance &&
                                std::fabs(mesh.uvs[i].y - mesh.uvs[j].y) <= uv_tolerance);
  };
  const std::vector<std::uint32_t> uv_place =
      chains(n, [&](std::uint32_t i, std::uint32_t j) { return place[i] == place[j] && same_uv(i, j); });

  std::vector<int> sign(triangles, 0);
  std::vector<bool> positive(n, false), negative(n, false);
  for (std::uint32_t t = 0; t < triangles && !mesh.uvs.empty(); ++t) {
    const auto& [a, b, c] = mesh.triangles[t];
    if (is_degenerate(mesh.uvs[a], mesh.uvs[b], mesh.uvs[c])) continue;
    sign[t] = signed_uv_area2(mesh.uvs[a], mesh.uvs[b], mesh.uvs[c]) > 0 ? 1 : -1;
    for (const std::uint32_t i : {a, b, c}) (sign[t] > 0 ? positive : negative)[i] = true;
  }
  const auto opposite = [&](std::uint32_t i, std::uint32_t j) {
    const auto only_negative = [&](std::uint32_t k) { return negative[k] && !positive[k]; };
    return (positive[i] && only_negative(j)) || (positive[j] && only_negative(i));
  };

  const std::vector<std::uint32_t> normal = first_with_normal(mesh, place);

  using Pair = std::pair<std::uint32_t, std::uint32_t>;
  const auto edges = [&](const std::vector<std::uint32_t>& id, std::uint32_t t) {
    std::vector<Pair> pairs;
    for (int k = 0; k < 3; ++k) {
      const Pair pair = std::minmax({id[mesh.triangles[t][k]], id[mesh.triangles[t][(k + 1) % 3]]});
      if (pair.first != pair.second) pairs.push_back(pair);
    }
    return pairs;
  };
  std::map<Pair, int> edge_count;
  std::set<std::uint32_t> ring, border;
  for (std::uint32_t t = 0; t < triangles; ++t) {
    for (const Pair& pair : edges(place, t)) ++edge_count[pair];
    const auto is_pole = [&](std::uint32_t i) { return !pole.empty() && pole[i]; };
    if (std::ranges::any_of(mesh.triangles[t], is_pole))
      for (const std::uint32_t i : mesh.triangles[t]) ring.insert(place[i]);
  }
  for (const auto& [pair, count] : edge_count)
    if (count == 1) border.insert({pair.first, pair.second});

  MeshClasses classes;
  for (std::uint32_t i = 0; i < n; ++i) {
    bool seam = false, crease = false;
    for (std::uint32_t j = 0; j < n; ++j) {
      const std::uint32_t first = normal[i];
      for (std::uint32_t k = 0; k < n && normal[j] == first; ++k)
        seam = seam || (normal[k] == first && opposite(j, k));
      seam = seam || (normal[j] == first && j != first && !same_uv(first, j));
      crease = crease || (place[j] == place[i] && normal[j] != first);
    }
    classes.of_vertex.push_back(!pole.empty() && pole[i]    ? VertexClass::pole
                                : seam                      ? VertexClass::seam
                                : crease                    ? VertexClass::crease
                                : ring.contains(place[i])   ? VertexClass::pole_ring
                                : border.contains(place[i]) ? VertexClass::border
                                                            : VertexClass::interior);
  }
  const std::vector<std::uint32_t> island = chains(triangles, [&](std::uint32_t s, std::uint32_t t) {
    const std::vector<Pair> a = edges(uv_place, s), b = edges(uv_place, t);
    return sign[s] == sign[t] && std::ranges::find_first_of(a, b) != a.end();
  });
  for (std::uint32_t t = 0; t < triangles; ++t)
    classes.island_of_triangle.push_back(sign[t] == 0     ? -1
                                         : island[t] == t ? classes.islands++
                                                          : classes.island_of_triangle[island[t]]);
  // Inside, where islands of one sign meet.
  for (std::uint32_t i = 0; i < n; ++i) {
    if (classes.of_vertex[i] != VertexClass::interior) continue;
    std::map<int, std::set<int>> of_sign;
    for (std::uint32_t t = 0; t < triangles; ++t)
      for (const std::uint32_t v : mesh.triangles[t])
        if (sign[t] != 0 && normal[v] == normal[i]) of_sign[sign[t]].insert(classes.island_of_triangle[t]);
    if (of_sign[1].size() > 1 || of_sign[-1].size() > 1) classes.of_vertex[i] = VertexClass::seam;
  }
  return classes;
}

void expect_equals_reference(const Mesh& mesh, const std::vector<bool>& pole, const std::string& what) {
  const MeshClasses found = classify(mesh, pole), expected = reference_classes(mesh, pole);
  EXPECT_EQ(found.of_vertex, expected.of_vertex) << what;
  EXPECT_EQ(found.islands, expected.islands) << what;
  EXPECT_EQ(found.island_of_triangle, expected.island_of_triangle) << what;
}

// Random triangles over few places, uvs and normals, so that nearly every edge has none or several neighbours
// and many triangles collapse; each number is moved by nothing, or by up to two tolerances, or is not finite.
TEST(Classify, EqualsTheDefinitionOnTangles) {
  for (std::uint32_t seed = 0; seed < 500; ++seed) {
    std::mt19937_64 random(seed);
    const auto chance = [&](double p) { return std::bernoulli_distribution(p)(random); };
    const auto number = [&](int range, double tolerance) -> double {
      const double x = std::uniform_int_distribution<int>(0, range)(random);
      if (chance(0.005)) return chance(0.5) ? NAN : INFINITY;
      return chance(0.7) ? x : x + tolerance * std::uniform_real_distribution<double>(-2, 2)(random);
    };
    const int n = std::uniform_int_distribution<int>(1, 60)(random), size = static_cast<int>(1 + seed % 3);
    Mesh mesh;
    std::vector<bool> pole;
    for (int i = 0; i < n; ++i) {
      mesh.positions.push_back({number(size, 2e-6), number(1, 2e-6), number(0, 2e-6)});
      if (seed % 7 != 0) mesh.uvs.push_back({number(size, 2e-6), number(1, 2e-6)});
      if (seed % 5 != 0) mesh.normals.push_back({number(seed % 2 == 0 ? 0 : 1, 2e-6), 1, 0});
      if (seed % 2 == 0) pole.push_back(chance(0.03));
    }
    std::uniform_int_distribution<std::uint32_t> any(0, static_cast<std::uint32_t>(n - 1));
    for (int t = std::uniform_int_distribution<int>(0, 40)(random); t > 0; --t)
      mesh.triangles.push_back({any(random), any(random), any(random)});
    expect_equals_reference(mesh, pole, "seed " + std::to_string(seed));
  }
}

// Surfaces with their poles, seams and folds: as sampled, and as soup in which some corners are moved, some
// triangles are doubled, turned over, or collapsed to an edge.
TEST(Classify, EqualsTheDefinitionOnDamagedSurfaces) {
  std::uint32_t seed = 0;
  for (const AnySurface& surface : all_surfaces()) {
    std::mt19937_64 random(++seed);
    const auto chance = [&](double p) { return std::bernoulli_distribution(p)(random); };
    const Mesh mesh = sample_mesh(surface, {.columns = 6, .rows = 4, .jitter = 0.2, .mirror = seed % 2 == 0});
    const auto is_pole = [&](const Mesh& m) {
      std::vector<bool> pole;
      for (const auto& uv : m.uvs) pole.push_back(has(surface.frame(uv.x, uv.y).status, Status::dpdu_zero));
      return pole;
    };
    const std::string what = std::string(surface.info().name) + ", seed " + std::to_string(seed);
    expect_equals_reference(mesh, is_pole(mesh), what);
    Mesh soup;
    for (Triangle triangle : mesh.triangles)
      for (int copies = chance(0.05) ? 2 : 1; copies > 0; --copies) {
        if (chance(0.05)) std::swap(triangle[0], triangle[1]);
        if (chance(0.05)) triangle[2] = triangle[1];
        const auto base = static_cast<std::uint32_t>(soup.positions.size());
        for (const std::uint32_t v : triangle) {
          const auto moved = [&](double x) {
            return chance(0.9) ? x : x + 2e-6 * std::uniform_real_distribution<double>(-1, 1)(random);
          };
          const Vec3<double>&p = mesh.positions[v], normal = mesh.normals[v];
          soup.positions.push_back({moved(p.x), moved(p.y), moved(p.z)});
          soup.normals.push_back({moved(normal.x), moved(normal.y), normal.z});
          soup.uvs.push_back({moved(mesh.uvs[v].x), moved(mesh.uvs[v].y)});
        }
        soup.triangles.push_back({base, base + 1, base + 2});
      }
    expect_equals_reference(soup, is_pole(soup), what + ", damaged");
  }
}

TEST(MeshClasses, WhatIsOutOfRangeIsRefused) {
  const Mesh good = sample_mesh(Sphere{1.0}, {.columns = 8, .rows = 5});
  EXPECT_THROW(classify(good, std::vector<bool>(3)), MeshError);
  Mesh mesh = good;
  mesh.triangles[3][1] = 4000000000;
  EXPECT_THROW(classify(mesh, {}), MeshError);
  mesh = good;
  mesh.uvs.pop_back();
  EXPECT_THROW(classify(mesh, {}), MeshError);
}

}  // namespace
}  // namespace darboux::mesh_classes_test
