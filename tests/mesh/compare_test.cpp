// What two meshes have in common, against meshes of which that is known, and against a second count.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <numeric>
#include <random>

#include <gtest/gtest.h>

#include <darboux/compare.h>
#include <darboux/error.h>
#include <darboux/sample_mesh.h>

#include "refusal_of.h"

namespace darboux::compare_test {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

Mesh sphere() {
  SampleMeshOptions options;
  options.columns = 16;
  options.rows = 9;
  return sample_mesh(make_surface("sphere"), options);
}

Mesh torus(bool mirror = false) {
  SampleMeshOptions options;
  options.columns = 12;
  options.rows = 8;
  options.mirror = mirror;
  options.jitter = 0.2;
  options.degenerate = 9;
  options.degenerate_uvs = 7;
  return sample_mesh(make_surface("torus"), options);
}

std::vector<Mesh> meshes() {
  return {sphere(), torus(), torus(true)};
}

// ---- the same mesh in other words -------------------------------------------------------------------------

Mesh shuffled(Mesh mesh, unsigned seed) {
  std::mt19937 random(seed);
  std::shuffle(mesh.triangles.begin(), mesh.triangles.end(), random);
  for (Triangle& t : mesh.triangles)
    std::rotate(t.begin(), t.begin() + static_cast<std::ptrdiff_t>(random() % 3), t.end());
  return mesh;
}

// New vertex i is old vertex source[i].
Mesh with_vertices(const Mesh& mesh, const std::vector<std::uint32_t>& source) {
  Mesh result;
  for (const std::uint32_t v : source) {
    result.positions.push_back(mesh.positions[v]);
    if (!mesh.normals.empty()) result.normals.push_back(mesh.normals[v]);
    if (!mesh.uvs.empty()) result.uvs.push_back(mesh.uvs[v]);
    if (!mesh.tangents.empty()) result.tangents.push_back(mesh.tangents[v]);
  }
  return result;
}

Mesh reindexed(const Mesh& mesh, unsigned seed) {
  std::vector<std::uint32_t> source(mesh.positions.size()), place(source.size());
  std::iota(source.begin(), source.end(), 0U);
  std::shuffle(source.begin(), source.end(), std::mt19937(seed));
  for (std::uint32_t i = 0; i < source.size(); ++i) place[source[i]] = i;
  Mesh result = with_vertices(mesh, source);
  for (const auto& [a, b, c] : mesh.triangles) result.triangles.push_back({place[a], place[b], place[c]});
  return result;
}

// A vertex for each corner.
Mesh split(const Mesh& mesh) {
  std::vector<std::uint32_t> source;
  for (const Triangle& t : mesh.triangles) source.insert(source.end(), t.begin(), t.end());
  Mesh result = with_vertices(mesh, source);
  for (std::uint32_t c = 0; c < source.size(); c += 3) result.triangles.push_back({c, c + 1, c + 2});
  return result;
}

Mesh moved(Mesh mesh, double by) {
  std::mt19937 random(3);
  const auto noise = [&] { return by * (static_cast<double>(random()) / 0x1p31 - 1); };
  for (auto& p : mesh.positions) p += Vec3<double>{noise(), noise(), noise()};
  for (auto& n : mesh.normals) n += Vec3<double>{noise(), noise(), noise()};
  for (auto& uv : mesh.uvs) uv = uv + Vec2<double>{noise(), noise()};
  return mesh;
}

void expect_same(const Mesh& a, const Mesh& b) {
  for (const auto& r : {compare(a, b), compare(b, a)}) {
    EXPECT_TRUE(r.same);
    EXPECT_EQ(r.matched, a.corners());
    EXPECT_EQ(r.unmatched_a.total() + r.unmatched_b.total(), 0u);
    EXPECT_EQ(r.equal_bits, a.corners());
    EXPECT_EQ(r.equal_directions, a.corners());
    EXPECT_EQ(r.sign, SignAgreement::same);
    ASSERT_TRUE(r.tangent_deg);
    EXPECT_EQ(r.tangent_deg->max, 0);
    EXPECT_FALSE(r.worst);
  }
}

TEST(Compare, AMeshIsItself) {
  for (const Mesh& mesh : meshes()) expect_same(mesh, mesh);
}

TEST(Compare, OrderStartIndicesAndSplitsDoNotMatter) {
  for (const Mesh& mesh : meshes())
    for (const unsigned seed : {1u, 2u}) {
      SCOPED_TRACE(seed);
      expect_same(mesh, shuffled(mesh, seed));
      expect_same(mesh, reindexed(mesh, seed));
      expect_same(mesh, split(mesh));
      expect_same(mesh, shuffled(reindexed(split(mesh), seed), seed));
    }
}

// The 1e-6 of the ranges: 2.4e-6 or more of positions, 1e-6 of uvs, 2e-6 of normals. Each vertex moves by up
// to 3e-7 in each number, two of them apart by 6e-7; farther than the tolerances by ten times it is another.
TEST(Compare, RoundingDoesNotMatterMoreDoes) {
  for (const Mesh& mesh : meshes()) {
    expect_same(mesh, moved(mesh, 3e-7));
    expect_same(mesh, shuffled(moved(split(mesh), 3e-7), 1));
    EXPECT_LT(compare(mesh, moved(mesh, 1e-4)).matched, mesh.corners() / 100);
  }
}

// Just inside and outside, one attribute at a time, on one triangle whose ranges are known.
TEST(Compare, ToleranceIsAMillionthOfTheRange) {
  Mesh mesh;
  mesh.positions = {{0, 0, 0}, {300, 0, 0}, {0, 400, 0}};  // diagonal 500
  mesh.normals = {{0, 0, 1}, {0, 0, 1}, {0, 0, 1}};
  mesh.uvs = {{0, 0}, {4, 0}, {0, 2}};  // larger side 4
  mesh.tangents = {{1, 0, 0, 1}, {1, 0, 0, 1}, {1, 0, 0, 1}};
  mesh.triangles = {{0, 1, 2}};
  const auto matched = [&](const auto& change) {
    Mesh other = mesh;
    change(other);
    return compare(mesh, other).matched;
  };
  // What is given: up to 1 the same, from 1.5 on another (positions).
  EXPECT_EQ(matched([](Mesh& m) { m.positions[0].x = 0.99 * 500e-6; }), 3u);
  EXPECT_EQ(matched([](Mesh& m) { m.positions[0].x = -0.99 * 500e-6; }), 3u);
  EXPECT_EQ(matched([](Mesh& m) { m.positions[0].z = 1.51 * 500e-6; }), 0u);
  EXPECT_EQ(matched([](Mesh& m) { m.normals[1].x = 0.99 * 2e-6; }), 3u);
  EXPECT_EQ(matched([](Mesh& m) { m.normals[1].y = 1.01 * 2e-6; }), 0u);
  EXPECT_EQ(matched([](Mesh& m) { m.uvs[2].x = 0.99 * 4e-6; }), 3u);
  EXPECT_EQ(matched([](Mesh& m) { m.uvs[2].y += 1.01 * 4e-6; }), 0u);
  EXPECT_EQ(matched([](Mesh& m) { m.uvs[0].x = -0.0; }), 3u);
}

// ---- planted changes --------------------------------------------------------------------------------------

Vec4<double> turned(const Vec4<double>& t, const Vec3<double>& n, double degrees) {
  const double angle = degrees * std::numbers::pi / 180;
  const Vec3<double> x = std::cos(angle) * t.xyz() + std::sin(angle) * cross(n, t.xyz());
  return {x.x, x.y, x.z, t.w};
}

// Corners k, 2k, 3k, ... are turned by 1, 2, 3, ... degrees.
TEST(Compare, CountsPlantedAnglesExactly) {
  for (const Mesh& mesh : meshes()) {
    const Mesh a = split(mesh);
    Mesh b = a;
    const std::size_t step = a.corners() / 10;
    std::vector<double> angles;
    for (std::size_t i = 1; i * step < a.corners() && i <= 9; ++i) {
      b.tangents[i * step] = turned(b.tangents[i * step], b.normals[i * step], static_cast<double>(i));
      angles.push_back(static_cast<double>(i));
    }
    double squares = 0;
    for (const double x : angles) squares += x * x;
    for (const Mesh& other : {b, shuffled(reindexed(b, 5), 6)}) {
      const MeshComparison r = compare(a, other), back = compare(other, a);
      EXPECT_EQ(r.matched, a.corners());
      EXPECT_FALSE(r.same);
      EXPECT_EQ(r.equal_bits, a.corners() - angles.size());
      EXPECT_EQ(r.equal_directions, r.equal_bits);
      EXPECT_EQ(r.sign, SignAgreement::same);
      // n is unit and across t to a few 1e-16, which the turn and the angle keep: 1e-12 degrees is ample.
      EXPECT_NEAR(r.tangent_deg->max, angles.back(), 1e-12);
      EXPECT_NEAR(r.tangent_deg->rms, std::sqrt(squares / static_cast<double>(a.corners())), 1e-12);
      ASSERT_TRUE(r.worst);
      EXPECT_EQ(r.worst->vertex_a, angles.size() * step);
      EXPECT_EQ(other.tangents[r.worst->vertex_b], b.tangents[angles.size() * step]);
      EXPECT_EQ(r.worst->deg, r.tangent_deg->max);
      EXPECT_EQ(back.worst->vertex_b, r.worst->vertex_a);
      EXPECT_FALSE(compare(a, other, {angles.back() - 0.001}).same);
      EXPECT_TRUE(compare(a, other, {angles.back() + 0.001}).same);
    }
  }
}

TEST(Compare, CountsSignsAndNamesTheConvention) {
  for (const Mesh& mesh : meshes()) {  // gltf's signs
    Mesh raw = mesh;
    for (auto& t : raw.tangents) t.w = -t.w;
    MeshComparison r = compare(mesh, raw);
    EXPECT_EQ(r.sign, SignAgreement::opposite);
    EXPECT_EQ(r.opposite_signs, mesh.corners());
    EXPECT_EQ(r.a_is_raw, std::optional(false));
    EXPECT_EQ(compare(raw, mesh).a_is_raw, std::optional(true));
    EXPECT_EQ(r.equal_bits, 0u);
    EXPECT_EQ(r.equal_directions, mesh.corners());
    EXPECT_EQ(r.tangent_deg->max, 0);
    EXPECT_FALSE(compare(mesh, raw, {180}).same) << "no angle excuses a sign";

    Mesh one = split(mesh);
    one.tangents[7].w = -one.tangents[7].w;
    r = compare(mesh, one, {180});
    EXPECT_EQ(r.sign, SignAgreement::mixed);
    EXPECT_EQ(r.opposite_signs, 1u);
    EXPECT_EQ(r.equal_bits, mesh.corners() - 1);
    EXPECT_FALSE(r.same);
    EXPECT_FALSE(r.a_is_raw);
  }
  // Opposite everywhere, and neither side follows a convention.
  Mesh a = split(sphere()), b = a;
  a.tangents[0].w = -a.tangents[0].w;
  for (std::size_t i = 0; i < b.tangents.size(); ++i) b.tangents[i].w = -a.tangents[i].w;
  EXPECT_EQ(compare(a, b).sign, SignAgreement::opposite);
  EXPECT_FALSE(compare(a, b).a_is_raw);
}

TEST(Compare, OneBitMatters) {
  Mesh a = split(sphere()), b = a;
  b.tangents[3].y = std::nextafter(b.tangents[3].y, 2);
  const MeshComparison r = compare(a, b);
  EXPECT_EQ(r.equal_bits, a.corners() - 1);
  EXPECT_FALSE(r.same);
  EXPECT_TRUE(compare(a, b, {1e-10}).same);
  a.tangents[3].y = 0.0;
  b.tangents[3].y = -0.0;
  EXPECT_EQ(compare(a, b).equal_bits, a.corners() - 1) << "0 and -0 are two values";
}

TEST(Compare, TangentsWithoutDirectionAreEqualByTheirBitsOnly) {
  Mesh a = split(sphere());
  a.tangents[0] = {nan, 0, 0, 1};
  a.tangents[1] = {0, 0, 0, 1};
  a.tangents[2] = {std::numeric_limits<double>::infinity(), 0, 0, nan};
  MeshComparison r = compare(a, shuffled(a, 1));
  EXPECT_TRUE(r.same);
  EXPECT_EQ(r.no_direction, 3u);
  EXPECT_EQ(r.equal_bits, a.corners());
  EXPECT_EQ(r.tangent_deg->max, 0);
  Mesh b = a;
  b.tangents[0] = {1, 0, 0, 1};
  b.tangents[1] = {0, 0, 0, -1};
  for (const auto& c : {compare(a, b, {180}), compare(b, a, {180})}) {
    EXPECT_FALSE(c.same);
    EXPECT_EQ(c.no_direction, 3u);
    EXPECT_EQ(c.equal_bits, a.corners() - 2);
    EXPECT_EQ(c.equal_directions, a.corners() - 1);
    EXPECT_EQ(c.tangent_deg->max, 0);
  }
}

// ---- what does not match, and why -------------------------------------------------------------------------

TEST(Compare, SaysWhyCornersDoNotMatch) {
  const Mesh a = split(torus());
  // A whole triangle stays unmatched where one of its corners differs; its other two are in no such triangle.
  const auto changed = [&](const auto& change) {
    Mesh b = a;
    change(b);
    const MeshComparison r = compare(a, b), back = compare(b, a);
    EXPECT_FALSE(r.same);
    EXPECT_EQ(r.matched, a.corners() - 3);
    EXPECT_EQ(r.unmatched_a.total(), 3u);
    EXPECT_EQ(r.unmatched_b.total(), 3u);
    EXPECT_EQ(back.unmatched_b.total(), 3u);
    EXPECT_EQ(back.unmatched_a.triangle, r.unmatched_b.triangle);
    return r;
  };
  MeshComparison r = changed([](Mesh& m) { m.positions[4].x += 0.01; });
  EXPECT_EQ(r.unmatched_b.position, 1u);
  EXPECT_EQ(r.unmatched_b.triangle, 2u);
  EXPECT_EQ(r.unmatched_a.triangle, 3u) << "other triangles of b still have the place";
  r = changed([](Mesh& m) { m.uvs[4].x += 0.01; });
  EXPECT_EQ(r.unmatched_b.uv, 1u);
  r = changed([](Mesh& m) { m.normals[4].x += 0.01; });
  EXPECT_EQ(r.unmatched_b.normal, 1u);
  r = changed([](Mesh& m) { m.normals[4].x += 0.01, m.uvs[4].y -= 0.01; });
  EXPECT_EQ(r.unmatched_b.uv_and_normal, 1u);
  r = changed([](Mesh& m) { m.positions[4].y = nan; });
  EXPECT_EQ(r.unmatched_b.not_finite, 3u);
  EXPECT_EQ(r.unmatched_a.triangle, 3u);
  r = changed([](Mesh& m) { std::swap(m.triangles[1][0], m.triangles[1][1]); });
  EXPECT_EQ(r.unmatched_b.triangle, 3u) << "the other winding is another triangle";
}

TEST(Compare, MoreThanTheOtherHasIsNotTheSame) {
  const Mesh a = sphere();
  Mesh more = a;
  more.triangles.push_back(a.triangles[7]);
  for (const bool swapped : {false, true}) {
    const MeshComparison r = swapped ? compare(more, a) : compare(a, more);
    EXPECT_FALSE(r.same);
    EXPECT_EQ(r.matched, a.corners());
    EXPECT_EQ(r.equal_bits, a.corners());
    EXPECT_EQ((swapped ? r.unmatched_a : r.unmatched_b).triangle, 3u);
    EXPECT_EQ((swapped ? r.unmatched_b : r.unmatched_a).total(), 0u);
  }
}

TEST(Compare, NotFiniteNumbersMatchNothing) {
  Mesh a = split(sphere());
  a.positions[0].x = nan;
  a.normals[3].y = std::numeric_limits<double>::infinity();
  a.uvs[6].x = -nan;
  const MeshComparison r = compare(a, a);
  EXPECT_EQ(r.matched, a.corners() - 9);
  EXPECT_EQ(r.unmatched_a.not_finite, 9u);
  EXPECT_FALSE(r.same);
  for (auto& p : a.positions) p = {nan, nan, nan};
  EXPECT_EQ(compare(a, a).unmatched_b.not_finite, a.corners());
  // Vertices that no triangle uses are nobody's business.
  Mesh b = sphere(), c = b;
  c.positions.push_back({nan, 1e30, 0});
  c.normals.push_back({nan, 0, 0});
  c.uvs.push_back({1e30, 0});
  c.tangents.push_back({});
  expect_same(b, moved(c, 3e-7));
}

TEST(Compare, TellsThatVIsFlipped) {
  const Mesh a = torus();
  Mesh b = shuffled(a, 4);
  for (auto& uv : b.uvs) uv.y = static_cast<double>(static_cast<float>(1 - uv.y));
  const MeshComparison r = compare(a, b);
  EXPECT_EQ(r.matched_with_v_flipped, a.corners());
  // A rounding of the float leaves what lies at v = 1/2, and what has no area there or so.
  EXPECT_LT(r.matched, a.corners() / 4);
  EXPECT_EQ(r.unmatched_a.position + r.unmatched_a.normal + r.unmatched_a.not_finite, 0u);
  Mesh other = a;
  for (auto& uv : other.uvs) uv.x = 2 * uv.x + 5;
  EXPECT_EQ(compare(a, other).matched_with_v_flipped, 0u);
  EXPECT_EQ(compare(a, other).unmatched_a.uv, a.corners());
  EXPECT_EQ(compare(a, a).matched_with_v_flipped, 0u) << "nothing to explain";
}

TEST(Compare, AnAttributeThatOneLacksIsAReason) {
  const Mesh a = torus();
  Mesh b = a, c = a, d = a;
  b.uvs.clear();
  c.normals.clear();
  d.tangents.clear();
  EXPECT_EQ(compare(a, b).unmatched_a.uv, a.corners());
  EXPECT_EQ(compare(a, b).matched_with_v_flipped, 0u);
  EXPECT_EQ(compare(c, a).unmatched_b.normal, a.corners());
  // What both lack keeps nothing apart.
  expect_same(b, shuffled(b, 1));
  expect_same(c, shuffled(c, 1));
  for (const auto& r : {compare(a, d), compare(d, d)}) {
    EXPECT_EQ(r.matched, a.corners());
    EXPECT_FALSE(r.same) << "no tangents";
    EXPECT_EQ(r.equal_bits, 0u);
    EXPECT_FALSE(r.tangent_deg);
    EXPECT_FALSE(r.tangents_b);
  }
}

TEST(Compare, NothingIsNotTheSame) {
  const Mesh empty, full = sphere();
  EXPECT_FALSE(compare(empty, empty).same);
  EXPECT_FALSE(compare(empty, full).same);
  EXPECT_EQ(compare(full, empty).unmatched_a.position, full.corners());
  Mesh no_triangles = full;
  no_triangles.triangles.clear();
  EXPECT_FALSE(compare(no_triangles, no_triangles).same);
  EXPECT_EQ(compare(no_triangles, full).unmatched_b.position, full.corners());
}

// ---- a second count ---------------------------------------------------------------------------------------

// Small random meshes with few values per number, so that most corners, triangles and tangents occur several
// times, also triangles in one point. The corners of each kind and, among them, of each tangent, are counted
// in maps.
TEST(Compare, DuplicatesArePairedAsOftenAsBothHaveThem) {
  using Corner = std::array<double, 24>;
  using Tangent = std::array<double, 4>;
  for (unsigned seed = 0; seed < 200; ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937 random(seed);
    const auto few = [&](unsigned n) { return static_cast<double>(random() % n) + 1; };
    const auto make = [&] {
      Mesh m;
      for (int v = 0; v < 12; ++v) {
        m.positions.push_back({few(2), few(2), 0});
        m.normals.push_back({0, 0, few(2)});
        m.uvs.push_back({few(2), 0});
        m.tangents.push_back({few(2), few(2), 0, few(2)});
      }
      for (unsigned t = 0; t < 20 + random() % 20; ++t)
        m.triangles.push_back({static_cast<std::uint32_t>(random() % 12),
                               static_cast<std::uint32_t>(random() % 12),
                               static_cast<std::uint32_t>(random() % 12)});
      return m;
    };
    const Mesh a = make(), b = make();
    std::map<Corner, std::map<Tangent, std::array<std::size_t, 2>>> kinds;
    for (const std::size_t side : {0, 1}) {
      const Mesh& m = side == 0 ? a : b;
      for (const Triangle& t : m.triangles)
        for (std::size_t k = 0; k < 3; ++k) {
          Corner corner;
          for (std::size_t i = 0; i < 3; ++i) {
            const std::uint32_t v = t[(k + i) % 3];
            const auto &p = m.positions[v], &n = m.normals[v];
            const std::array<double, 8> numbers{p.x, p.y, p.z, n.x, n.y, n.z, m.uvs[v].x, m.uvs[v].y};
            std::copy(numbers.begin(), numbers.end(), corner.begin() + static_cast<std::ptrdiff_t>(8 * i));
          }
          const auto& x = m.tangents[t[k]];
          ++kinds[corner][Tangent{x.x, x.y, x.z, x.w}][side];
        }
    }
    std::size_t matched = 0, equal = 0;
    for (const auto& [corner, tangents] : kinds) {
      std::array<std::size_t, 2> total{};
      for (const auto& [tangent, count] : tangents) {
        equal += std::min(count[0], count[1]);
        total[0] += count[0];
        total[1] += count[1];
      }
      matched += std::min(total[0], total[1]);
    }
    const MeshComparison r = compare(a, b), back = compare(b, a),
                         other = compare(shuffled(reindexed(a, seed), seed), split(b));
    EXPECT_EQ(r.matched, matched);
    EXPECT_EQ(r.equal_bits, equal);
    EXPECT_EQ(r.unmatched_a.total(), a.corners() - matched);
    EXPECT_EQ(r.unmatched_b.total(), b.corners() - matched);
    for (const MeshComparison& s : {back, other}) {
      EXPECT_EQ(s.matched, matched);
      EXPECT_EQ(s.equal_bits, equal);
      EXPECT_EQ(s.opposite_signs, r.opposite_signs);
      if (matched == 0) continue;
      EXPECT_EQ(s.tangent_deg->max, r.tangent_deg->max);
      EXPECT_EQ(s.tangent_deg->p95, r.tangent_deg->p95);
      // The order of a sum of up to 120 squares: a relative 120 · 2^-53.
      EXPECT_NEAR(s.tangent_deg->rms, r.tangent_deg->rms, 2e-14 * r.tangent_deg->rms);
    }
    EXPECT_EQ(back.unmatched_a.total(), r.unmatched_b.total());
  }
}

// Copies of one triangle whose tangents are a rounding away from those of the other mesh: each finds its own,
// though the orders differ and directions share components.
TEST(Compare, NearlyEqualTangentsOfDuplicatesFindEachOther) {
  Mesh a;
  for (const Vec4<double>& t : {Vec4<double>{0, 1, 0, 1}, {0, -1, 0, 1}, {0, 0, 1, 1}, {0, 0, -1, -1}}) {
    const auto first = static_cast<std::uint32_t>(a.positions.size());
    for (const Vec3<double>& p : {Vec3<double>{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}) {
      a.positions.push_back(p);
      a.tangents.push_back(t);
    }
    a.triangles.push_back({first, first + 1, first + 2});
  }
  Mesh b = a;
  for (std::size_t i = 0; i < b.tangents.size(); ++i) b.tangents[i].x = i % 2 == 0 ? 1e-7 : -1e-7;
  const MeshComparison r = compare(a, shuffled(b, 9));
  EXPECT_EQ(r.matched, 12u);
  EXPECT_NEAR(r.tangent_deg->max, 1e-7 * 180 / std::numbers::pi, 1e-12);
  EXPECT_EQ(r.sign, SignAgreement::same);
}

// A vertex far out makes all others lie within the tolerance, 10^5 of them: what has equal bits is still told
// apart, and the rest costs no comparison of each with each (this test would take minutes).
TEST(Compare, AVertexFarOutDoesNotBlurTheRest) {
  SampleMeshOptions options;
  options.columns = options.rows = 300;
  Mesh a = sample_mesh(make_surface("torus"), options), b = a;
  a.positions[0] = b.positions[0] = {1e9, 0, 0};
  b.tangents[50].w = -b.tangents[50].w;
  const MeshComparison r = compare(a, shuffled(b, 2));
  EXPECT_EQ(r.matched, a.corners());
  EXPECT_EQ(r.equal_bits, a.corners() - r.opposite_signs);
  EXPECT_GT(r.opposite_signs, 0u);
  for (auto& p : b.positions) p.z += 1e-7;
  EXPECT_EQ(compare(a, b).matched, a.corners());
}

TEST(Compare, RefusesWhatDoesNotFit) {
  const Mesh mesh = sphere();
  Mesh broken = mesh;
  broken.tangents.pop_back();
  EXPECT_NE(test::refusal_of<MeshError>([&] { compare(mesh, broken); }).find("second mesh"),
            std::string::npos);
  broken = mesh;
  broken.triangles[0][1] = 100000;
  EXPECT_NE(test::refusal_of<MeshError>([&] {
              compare(broken, mesh);
            }).find("first mesh: triangle 0: expected indices below"),
            std::string::npos);
  for (const double angle : {-1.0, 181.0, nan})
    EXPECT_NE(test::refusal_of([&] { compare(mesh, mesh, {angle}); }).find("0 <= degrees <= 180"),
              std::string::npos);
}

// ---- pieces of files --------------------------------------------------------------------------------------

struct Pieces {
  std::vector<Mesh> meshes;
  std::vector<NamedMesh> list;
  // A small triangle at each place along x.
  explicit Pieces(const std::vector<std::pair<std::string_view, double>>& pieces) {
    for (const auto& [name, x] : pieces) {
      Mesh m;
      m.positions = {{x, 0, 0}, {x + 1, 0, 0}, {x, 1, 0}};
      m.triangles = {{0, 1, 2}};
      meshes.push_back(m);
    }
    for (std::size_t i = 0; i < pieces.size(); ++i) list.push_back({i, 0, pieces[i].first, &meshes[i]});
  }
};

using Pairs = std::vector<std::pair<std::size_t, std::size_t>>;

TEST(PairMeshes, ByNameThenPlaceThenBox) {
  const auto pairs = [](const Pieces& a, const Pieces& b) { return pair_meshes(a.list, b.list); };
  const Pieces plain({{"", 0}, {"", 5}, {"", 9}});
  EXPECT_EQ(pairs(plain, plain).pairs, (Pairs{{0, 0}, {1, 1}, {2, 2}}));
  // Equal boxes: the place decides.
  const Pieces stacked({{"", 0}, {"", 0}, {"", 0}});
  EXPECT_EQ(pairs(stacked, stacked).pairs, (Pairs{{0, 0}, {1, 1}, {2, 2}}));
  // Boxes that agree: the place decides, though others are nearer.
  EXPECT_EQ(pairs(Pieces({{"", 0}, {"", 0.005}}), Pieces({{"", 0.004}, {"", 0.001}})).pairs,
            (Pairs{{0, 0}, {1, 1}}));
  // Another order without names, and with one more.
  const Pieces turned({{"", 9}, {"", 0}, {"", 5}}), more({{"", 7}, {"", 9.002}, {"", 9}, {"", 0}, {"", 5}});
  EXPECT_EQ(pairs(plain, turned).pairs, (Pairs{{0, 1}, {1, 2}, {2, 0}}));
  MeshPairs found = pairs(plain, more);
  EXPECT_EQ(found.pairs, (Pairs{{0, 3}, {1, 4}, {2, 2}}));
  EXPECT_EQ(found.only_a, std::vector<std::size_t>{});
  EXPECT_EQ(found.only_b, (std::vector<std::size_t>{0, 1}));
  found = pairs(more, plain);
  EXPECT_EQ(found.only_a.size(), 2u);
  EXPECT_EQ(found.only_b.size(), 0u);
  // Names tell, where they are told apart.
  const Pieces named({{"x", 0}, {"y", 0}, {"", 0}}), renamed({{"y", 3}, {"x", 0}, {"", 0}});
  EXPECT_EQ(pairs(named, renamed).pairs, (Pairs{{0, 1}, {1, 0}, {2, 2}}));
  const Pieces twins({{"x", 0}, {"x", 5}}), back({{"x", 5}, {"x", 0}});
  EXPECT_EQ(pairs(twins, back).pairs, (Pairs{{0, 1}, {1, 0}}));
  // Nothing fits: by place; nothing there: left over.
  const Pieces far({{"", 100}, {"", 200}});
  found = pairs(plain, far);
  EXPECT_EQ(found.pairs, (Pairs{{0, 0}, {1, 1}}));
  EXPECT_EQ(found.only_a, (std::vector<std::size_t>{2}));
  EXPECT_TRUE(pairs(Pieces({}), Pieces({})).pairs.empty());
  EXPECT_EQ(pairs(Pieces({}), far).only_b.size(), 2u);
}

TEST(PairMeshes, EmptyAndPointlikePiecesHaveNoDistance) {
  Pieces a({{"", 0}, {"", 0}}), b({{"", 0}, {"", 0}});
  for (Pieces* p : {&a, &b}) {
    p->meshes[0].triangles.clear();
    for (auto& x : p->meshes[1].positions) x = {1, 2, 3};
  }
  EXPECT_EQ(pair_meshes(a.list, b.list).pairs, (Pairs{{0, 0}, {1, 1}}));
  std::swap(b.list[0].data, b.list[1].data);
  EXPECT_EQ(pair_meshes(a.list, b.list).pairs, (Pairs{{0, 1}, {1, 0}}));
  for (auto& x : b.meshes[1].positions) x = {nan, 2, 3};
  EXPECT_EQ(pair_meshes(a.list, b.list).pairs.size(), 2u);
  b.list[1].data = nullptr;
  EXPECT_THROW(pair_meshes(a.list, b.list), MeshError);
}

}  // namespace
}  // namespace darboux::compare_test
