// The cone of a corner's own triangles: every average of them lies inside, and nothing else does.
#include <algorithm>
#include <array>
#include <cmath>
#include <iostream>
#include <numbers>
#include <random>

#include <gtest/gtest.h>

#include <darboux/any_surface.h>
#include <darboux/mesh_frames.h>
#include <darboux/mikktspace.h>
#include <darboux/sample_mesh.h>
#include <darboux/validate.h>
#include <darboux/vertex_normals.h>

#include "mesh/triangle_signs.h"
#include "mesh/vertex_joins.h"
#include "thinning.h"
#include "validate/consistent.h"

namespace darboux::cones_test {
namespace {

using Random = std::mt19937_64;

double uniform(Random& random, double low, double high) {
  return std::uniform_real_distribution<double>(low, high)(random);
}
int integer(Random& random, int low, int high) {
  return std::uniform_int_distribution<int>(low, high)(random);
}

// A crumpled grid of quads: seams, mirrored islands, slivers, steps of integers. Its quads and triangles cut
// along random diagonals.
struct Case {
  Mesh mesh;
  std::vector<std::uint32_t> quads;  // four vertices each
  bool mirror = false;               // triangles wind differently in uv
  bool folded = false;               // within a quad, along one diagonal or the other
};

Case random_case(Random& random) {
  Case result;
  Mesh& mesh = result.mesh;
  const int n = integer(random, 1, 5), m = integer(random, 1, 5);
  const double rough = uniform(random, 0, 0.5), bend = uniform(random, 0, 3),
               stretch = std::pow(10, uniform(random, -2, 2));
  const bool seam = integer(random, 0, 2) == 0, mirror = n % 2 == 0 && integer(random, 0, 1) == 0,
             sliver = integer(random, 0, 2) == 0;
  result.mirror = mirror;
  for (int j = 0; j <= m; ++j)
    for (int i = 0; i <= n; ++i) {
      const double x = i + rough * uniform(random, -0.4, 0.4), y = j + rough * uniform(random, -0.4, 0.4);
      mesh.positions.push_back(
          {x, stretch * y,
           bend * std::sin(0.7 * x) * std::cos(0.5 * y) + rough * uniform(random, -0.3, 0.3)});
      mesh.uvs.push_back({(mirror ? std::fabs(i - n / 2.0) : x) / n, y / m});
    }
  if (sliver && mesh.positions.size() > 4) {
    const std::size_t v =
        1 + static_cast<std::size_t>(integer(random, 0, static_cast<int>(mesh.positions.size()) - 2));
    mesh.positions[v] = mesh.positions[v - 1] + 1e-4 * (mesh.positions[v] - mesh.positions[v - 1]);
    if (integer(random, 0, 1)) mesh.uvs[v] = mesh.uvs[v - 1] + 1e-4 * (mesh.uvs[v] - mesh.uvs[v - 1]);
  }
  std::vector<std::array<std::uint32_t, 4>> quads;
  for (int j = 0; j < m; ++j)
    for (int i = 0; i < n; ++i) {
      const auto a = static_cast<std::uint32_t>(j * (n + 1) + i), up = static_cast<std::uint32_t>(n + 1);
      quads.push_back({a, a + 1, a + 1 + up, a + up});
    }
  for (const auto& [a, b, c, d] : quads) {
    if (integer(random, 0, 1)) {
      mesh.triangles.push_back({a, b, c});
      mesh.triangles.push_back({a, c, d});
    } else {
      mesh.triangles.push_back({a, b, d});
      mesh.triangles.push_back({b, c, d});
    }
    result.quads.insert(result.quads.end(), {a, b, c, d});
  }
  mesh.normals = vertex_normals(mesh, NormalWeight::angle);
  for (auto& p : mesh.normals)
    if (!detail::finite(p)) p = {0, 0, 1};
  if (seam) {  // the last row once more, elsewhere in uv
    const auto first = static_cast<std::uint32_t>(mesh.positions.size());
    const std::uint32_t row = static_cast<std::uint32_t>(m / 2 * (n + 1));
    for (int i = 0; i <= n; ++i) {
      const std::uint32_t v = row + static_cast<std::uint32_t>(i);
      mesh.positions.push_back(mesh.positions[v]);
      mesh.normals.push_back(mesh.normals[v]);
      mesh.uvs.push_back({mesh.uvs[v].x + 2, mesh.uvs[v].y});
    }
    for (std::uint32_t v = row + static_cast<std::uint32_t>(n) + 1; v < first; ++v) mesh.uvs[v].x += 2;
    const auto above = [&](std::uint32_t v) {
      return v >= row && v <= row + static_cast<std::uint32_t>(n) ? first + v - row : v;
    };
    for (std::size_t q = 0; q < quads.size(); ++q) {
      if (q / static_cast<std::size_t>(n) < static_cast<std::size_t>(m / 2)) continue;
      for (std::size_t k = 0; k < 4; ++k) result.quads[4 * q + k] = above(result.quads[4 * q + k]);
      for (std::size_t k = 0; k < 6; ++k) {
        std::uint32_t& v = mesh.triangles[2 * q + k / 3][k % 3];
        v = above(v);
      }
    }
  }
  // As files store them: floats, or integers.
  const bool integers = integer(random, 0, 2) == 0;
  const auto rounded = [&](double x, double step) {
    return static_cast<double>(static_cast<float>(integers ? step * std::nearbyint(x / step) : x));
  };
  if (integers) mesh.half_steps = {0.5 / 2048, 0.5 / 127, 0.5 / 4096, 0};
  for (auto& p : mesh.positions)
    p = {rounded(p.x, 1.0 / 2048), rounded(p.y, 1.0 / 2048), rounded(p.z, 1.0 / 2048)};
  for (auto& p : mesh.normals)
    p = {rounded(p.x, 1.0 / 127), rounded(p.y, 1.0 / 127), rounded(p.z, 1.0 / 127)};
  for (auto& p : mesh.uvs) p = {rounded(p.x, 1.0 / 4096), rounded(p.y, 1.0 / 4096)};
  const auto sign = [&](const Triangle& t) {
    return signed_uv_area2(mesh.uvs[t[0]], mesh.uvs[t[1]], mesh.uvs[t[2]]) > 0 ? 1 : -1;
  };
  for (std::size_t q = 0; q < result.quads.size(); q += 4) {
    const std::uint32_t a = result.quads[q], b = result.quads[q + 1], c = result.quads[q + 2],
                        d = result.quads[q + 3];
    const int first = sign({a, b, c});
    for (const Triangle& t : {Triangle{a, c, d}, Triangle{a, b, d}, Triangle{b, c, d}})
      result.folded = result.folded || sign(t) != first;
  }
  for (const Triangle& t : mesh.triangles)
    result.mirror = result.mirror || sign(t) != sign(mesh.triangles[0]);
  return result;
}

// Each corner a vertex of its own, with its tangent.
Mesh unindexed(const Mesh& mesh) {
  Mesh soup;
  soup.half_steps = mesh.half_steps;
  for (const Triangle& t : mesh.triangles) {
    const auto first = static_cast<std::uint32_t>(soup.positions.size());
    soup.triangles.push_back({first, first + 1, first + 2});
    for (const std::uint32_t v : t) {
      soup.positions.push_back(mesh.positions[v]);
      soup.normals.push_back(mesh.normals[v]);
      soup.uvs.push_back(mesh.uvs[v]);
    }
  }
  return soup;
}

TrianglesReport assessed(const Mesh& mesh, bool with_mikktspace = false) {
  ValidateOptions options;
  options.references = {.analytic = false, .mikktspace = with_mikktspace, .local = false, .triangles = true};
  return validate(mesh, std::nullopt, options).triangles.value_or(TrianglesReport{});
}

// Measured with the seed below, less a few hundredths.
constexpr double least_compared = 0.95;
constexpr std::array<double, 3> least_found{0.97, 0.92, 0.85};

std::size_t outside(const Mesh& mesh) {
  return assessed(mesh).outside;
}

// Tangents turned by an angle from the stored ones, and those of uvs that were swapped since.
enum class Wrong { negated, swapped, turned };
Mesh wronged(Mesh mesh, Wrong how) {
  for (std::size_t v = 0; v < mesh.tangents.size(); ++v) {
    const Vec4<double>& t = mesh.tangents[v];
    if (t.xyz() == Vec3<double>{}) continue;
    const Vec3<double> b = unit(cross(mesh.normals[v], t.xyz()));
    const Vec3<double> d = how == Wrong::negated   ? -t.xyz()
                           : how == Wrong::swapped ? b
                                                   : unit(std::cos(1.0) * t.xyz() + std::sin(1.0) * b);
    mesh.tangents[v] = {d.x, d.y, d.z, t.w};
  }
  return mesh;
}

TEST(Cones, HoldEveryAverage) {
  constexpr std::uint64_t seed = 97;
  // In long runs a law that is broken by one mesh in 10 000 holds for all of these once in 20.
  const int meshes = 30000 / test::thinning();
  int collapsed = 0;
  // Of MikkTSpace's: all corners, those assessed; of wrong ones, each of three kinds, those outside and those
  // not distinguished from right ones.
  std::size_t corners = 0, decided = 0;
  std::array<std::size_t, 3> found{}, missed{};
  std::cout << "seed " << seed << '\n';
  Random random(seed);
  for (int i = 0; i < meshes; ++i) {
    const Case c = random_case(random);
    for (const char* method : {"mikktspace", "average", "unit", "area", "angle"}) {
      // The others average over both sides of a fold of the uvs, which is a mistake.
      if (c.mirror && std::string_view(method) != "mikktspace") continue;
      const MeshFrames frames = mesh_frames(c.mesh, find_frame_method(method));
      Mesh soup = unindexed(c.mesh);
      for (std::size_t k = 0; k < c.mesh.corners(); ++k) {
        const CornerFrame& f = frames.corner(k);
        soup.tangents.push_back(f.fallback ? Vec4<double>{0, 0, 0, 1}
                                           : Vec4<double>{f.t.x, f.t.y, f.t.z, -f.sign});
      }
      const TrianglesReport report = assessed(soup);
      ASSERT_EQ(report.outside, 0u) << "mesh " << i << " by " << method;
      if (std::string_view(method) != "mikktspace") continue;
      corners += c.mesh.corners(), decided += report.compared;
      if (i % 10 != 0) continue;
      for (const Wrong how : {Wrong::negated, Wrong::swapped, Wrong::turned}) {
        const TrianglesReport wrong = assessed(wronged(soup, how));
        found[static_cast<std::size_t>(how)] += wrong.outside;
        missed[static_cast<std::size_t>(how)] += wrong.compared - wrong.outside;
      }
    }
    if (c.folded) continue;  // MikkTSpace gives both halves of a quad one sign
    // MikkTSpace of the quads, which it cuts as it likes, at the corners of the triangles.
    std::vector<float> p, n, uv;
    for (std::size_t v = 0; v < c.mesh.positions.size(); ++v) {
      for (const double x : {c.mesh.positions[v].x, c.mesh.positions[v].y, c.mesh.positions[v].z})
        p.push_back(static_cast<float>(x));
      for (const double x : {c.mesh.normals[v].x, c.mesh.normals[v].y, c.mesh.normals[v].z})
        n.push_back(static_cast<float>(x));
      for (const double x : {c.mesh.uvs[v].x, c.mesh.uvs[v].y}) uv.push_back(static_cast<float>(x));
    }
    const std::vector<std::uint8_t> sizes(c.quads.size() / 4, 4);
    std::vector<float> tangents(4 * c.quads.size());
    mikktspace(MikkMesh{p, n, uv, c.quads, sizes}, tangents, {.unserved_sign = 0});
    Mesh soup = unindexed(c.mesh);
    for (std::size_t k = 0; k < c.mesh.corners(); ++k) {
      const std::uint32_t v = c.mesh.triangles[k / 3][k % 3];
      const std::size_t quad = k / 6;
      std::size_t at = 0;
      while (c.quads[4 * quad + at] != v) ++at;
      const float* t = &tangents[4 * (4 * quad + at)];
      soup.tangents.push_back(t[3] == 0 ? Vec4<double>{0, 0, 0, 1} : Vec4<double>{t[0], t[1], t[2], -t[3]});
    }
    if (outside(soup) == 0) continue;
    // Of a quad of which rounding leaves half, MikkTSpace's other corner takes a tangent that no triangle
    // there has.
    ASSERT_GT(c.mesh.half_steps.position, 0) << "mesh " << i << " by mikktspace of quads";
    ++collapsed;
  }
  EXPECT_LE(collapsed, 1) << "of " << meshes;
  // The rest are directions that span 180 degrees, slivers, and tangents that none has.
  const auto share = [](std::size_t part, std::size_t all) {
    return static_cast<double>(part) / static_cast<double>(std::max<std::size_t>(all, 1));
  };
  std::cout << "judged " << share(decided, corners) << " of " << corners << " corners\n";
  EXPECT_GT(share(decided, corners), least_compared);
  for (const Wrong how : {Wrong::negated, Wrong::swapped, Wrong::turned}) {
    const auto k = static_cast<std::size_t>(how);
    std::cout << "wrong in way " << k << ": outside " << share(found[k], found[k] + missed[k]) << " of "
              << found[k] + missed[k] << " judged\n";
    EXPECT_GT(share(found[k], found[k] + missed[k]), least_found[k]) << k;
  }
}

// A scale baked into the positions takes tangents along, and normals by its inverse transpose. Averages of
// the old triangles need not be averages of the new ones: at vertices whose normals lean from their triangles
// they lie outside by up to the lean. A rough sheet of 24 x 24 quads, so that 3 % are many.
TEST(Cones, HoldAveragesOfMeshesThatWereScaledSince) {
  constexpr std::uint64_t seed = 41;
  std::cout << "seed " << seed << '\n';
  Random random(seed);
  constexpr std::uint32_t n = 24;
  std::size_t errors = 0, open = 0, scaled_errors = 0, scaled_open = 0, turned = 0, turned_by_triangles = 0;
  for (int i = 0; i < 60; ++i) {
    Mesh mesh;
    for (std::uint32_t k = 0; k <= n; ++k)
      for (std::uint32_t l = 0; l <= n; ++l) {
        const double x = l + uniform(random, -0.2, 0.2), y = k + uniform(random, -0.2, 0.2);
        mesh.positions.push_back(
            {x, y, 3 * std::sin(0.8 * x) * std::cos(0.7 * y) + uniform(random, -0.5, 0.5)});
        mesh.uvs.push_back({x / n, y / n});
      }
    for (std::uint32_t k = 0; k < n; ++k)
      for (std::uint32_t l = 0; l < n; ++l) {
        const std::uint32_t a = k * (n + 1) + l, up = n + 1;
        mesh.triangles.push_back({a, a + 1, a + up + 1});
        mesh.triangles.push_back({a, a + up + 1, a + up});
      }
    mesh.normals = vertex_normals(mesh, NormalWeight::angle);
    const MeshFrames frames = mesh_frames(mesh, find_frame_method("mikktspace"));
    mesh.tangents.resize(mesh.positions.size());
    for (std::size_t c = 0; c < mesh.corners(); ++c) {
      const CornerFrame& f = frames.corner(c);
      mesh.tangents[mesh.triangles[c / 3][c % 3]] = {f.t.x, f.t.y, f.t.z, -f.sign};
    }
    const TrianglesReport as_is = assessed(mesh, true);
    errors += as_is.outside, open += as_is.open;
    // One tangent turned by 20 degrees in a mesh whose others are MikkTSpace's: no scale explains that.
    Mesh one = mesh;
    const std::size_t v = static_cast<std::size_t>(integer(random, 0, n * n));
    const Vec3<double> t = one.tangents[v].xyz(), b = cross(one.normals[v], t);
    const Vec3<double> d = std::cos(0.35) * t + std::sin(0.35) * b;
    one.tangents[v] = {d.x, d.y, d.z, one.tangents[v].w};
    turned += assessed(one, true).outside > 0, turned_by_triangles += outside(one) > 0;
    const double scale = uniform(random, 1.5, 3), along = integer(random, 0, 1) ? scale : 1,
                 up = along == 1 ? scale : 1;
    for (std::size_t k = 0; k < mesh.positions.size(); ++k) {
      Vec3<double>&p = mesh.positions[k], &normal = mesh.normals[k];
      const Vec3<double> tangent = mesh.tangents[k].xyz();
      p = {p.x, along * p.y, up * p.z};
      normal = unit(Vec3<double>{normal.x, normal.y / along, normal.z / up});
      const Vec3<double> moved = unit(Vec3<double>{tangent.x, along * tangent.y, up * tangent.z});
      mesh.tangents[k] = {moved.x, moved.y, moved.z, mesh.tangents[k].w};
    }
    const TrianglesReport scaled = assessed(mesh, true);
    scaled_errors += scaled.outside, scaled_open += scaled.open;
  }
  std::cout << "scaled: " << scaled_errors << " errors, " << scaled_open - open
            << " more left open; turned: " << turned << " of 60 are errors, " << turned_by_triangles
            << " by triangles alone\n";
  EXPECT_EQ(errors, 0u);
  EXPECT_EQ(scaled_errors, 0u);
  EXPECT_GT(scaled_open, open) << "nothing was tested";
  // The others stay within their cones. Without MikkTSpace's nothing tells that no scale was baked in.
  EXPECT_GE(turned, 10u);
  EXPECT_LT(turned_by_triangles, turned);
}

// Normals of a finer mesh, as decimation leaves them: triangles may be edge-on to them. MikkTSpace weighs
// those by their angle seen along the normal, which may be 0; what a writer makes up then is no error, though
// the triangles seem to tell a direction.
TEST(Cones, HoldMikktspacesUnderAnyNormals) {
  constexpr std::uint64_t seed = 43;
  std::cout << "seed " << seed << '\n';
  Random random(seed);
  std::size_t corners = 0, by_triangles_alone = 0;
  for (int i = 0; i < 3000; ++i) {
    Case c = random_case(random);
    for (auto& n : c.mesh.normals) {
      n = unit(n + Vec3<double>{uniform(random, -2, 2), uniform(random, -2, 2), uniform(random, -2, 2)});
      n = {static_cast<float>(n.x), static_cast<float>(n.y), static_cast<float>(n.z)};
    }
    c.mesh.half_steps = {};
    const MeshFrames frames = mesh_frames(c.mesh, find_frame_method("mikktspace"));
    Mesh soup = unindexed(c.mesh);
    for (std::size_t k = 0; k < soup.corners(); ++k) {
      const CornerFrame& f = frames.corner(k);
      soup.tangents.push_back({f.t.x, f.t.y, f.t.z, -f.sign});
    }
    corners += soup.corners(), by_triangles_alone += outside(soup);
    ASSERT_EQ(assessed(soup, true).outside, 0u) << "mesh " << i;
  }
  std::cout << "by triangles alone " << by_triangles_alone << " of " << corners << " corners are beyond\n";
  EXPECT_GT(by_triangles_alone, 0u) << "nothing was tested";
}

// At borders too, where triangles lie on one side only.
TEST(Cones, LeaveOutWhatIsNoAverageAtBorders) {
  Mesh mesh;
  constexpr int n = 12;
  for (int j = 0; j <= n; ++j)
    for (int i = 0; i <= n; ++i) {
      const double x = static_cast<double>(i) / n, y = static_cast<double>(j) / n;
      mesh.positions.push_back({x, y, 0.1 * std::sin(3 * x) * std::cos(2 * y)});
      mesh.uvs.push_back({x, y});
    }
  for (std::uint32_t j = 0; j < n; ++j)
    for (std::uint32_t i = 0; i < n; ++i) {
      const std::uint32_t a = j * (n + 1) + i;
      mesh.triangles.push_back({a, a + 1, a + n + 2});
      mesh.triangles.push_back({a, a + n + 2, a + n + 1});
    }
  mesh.normals = vertex_normals(mesh, NormalWeight::angle);
  const MeshFrames frames = mesh_frames(mesh, find_frame_method("mikktspace"));
  Mesh soup = unindexed(mesh);
  for (std::size_t k = 0; k < mesh.corners(); ++k) {
    const CornerFrame& f = frames.corner(k);
    soup.tangents.push_back({f.t.x, f.t.y, f.t.z, -f.sign});
  }
  EXPECT_EQ(assessed(soup).compared, soup.corners());
  EXPECT_EQ(outside(soup), 0u);
  for (const Wrong how : {Wrong::negated, Wrong::swapped, Wrong::turned})
    EXPECT_EQ(outside(wronged(soup, how)), soup.corners()) << static_cast<int>(how);
}

// A bend of few columns, flat or a ramp: the tangent at its ends is half a column off the first, and the next
// column tells that.
TEST(Cones, LeaveOutHalfAColumnAtTheEndsOfABend) {
  for (const double rise : {0.0, 0.3})
    for (const double column_deg : {20.0, 45.0, 60.0})
      for (const std::uint32_t columns : {2U, 3U, 5U})
        for (const std::uint32_t rows : {1U, 3U}) {
          SCOPED_TRACE(std::to_string(columns) + " x " + std::to_string(rows) + " of " +
                       std::to_string(column_deg) + " deg, rise " + std::to_string(rise));
          Mesh bend;
          for (std::uint32_t j = 0; j <= rows; ++j)
            for (std::uint32_t i = 0; i <= columns; ++i) {
              const double angle = i * column_deg * std::numbers::pi / 180, radius = 1 + 1.0 * j / rows,
                           c = std::cos(angle), s = std::sin(angle);
              bend.positions.push_back({radius * c, radius * s, rise * angle});
              bend.uvs.push_back({1.0 * i, 1.0 * j});
              const Vec3<double> t = unit(Vec3<double>{-radius * s, radius * c, rise});
              bend.normals.push_back(unit(cross(Vec3<double>{c, s, 0}, t)));
              bend.tangents.push_back({t.x, t.y, t.z, 1});
            }
          for (std::uint32_t j = 0; j < rows; ++j)
            for (std::uint32_t i = 0; i < columns; ++i) {
              const std::uint32_t a = j * (columns + 1) + i, up = columns + 1;
              bend.triangles.push_back({a, a + up + 1, a + 1});
              bend.triangles.push_back({a, a + up, a + up + 1});
            }
          EXPECT_EQ(assessed(bend).outside, 0u);
          if (rise != 0) continue;
          // The ends by 20 degrees more, out of the bend, of which 15 are left open; the sides between them,
          // which have columns before and behind, by 50 either way: cones of quads reach so far at a few.
          const auto turned = [&](bool ends, double deg) {
            Mesh result = bend;
            for (std::uint32_t j = 0; j <= rows; ++j)
              for (std::uint32_t i = 0; i <= columns; ++i) {
                const bool is_end = i == 0 || i == columns;
                if (is_end != ends || (!is_end && j != 0 && j != rows)) continue;
                const std::size_t v = j * (columns + 1) + i;
                const double a = (i == 0 ? -deg : deg) * std::numbers::pi / 180;
                const Vec3<double> t = bend.tangents[v].xyz(),
                                   d = std::cos(a) * t + std::sin(a) * Vec3<double>{-t.y, t.x, 0};
                result.tangents[v] = {d.x, d.y, 0, 1};
              }
            return assessed(result).outside;
          };
          EXPECT_EQ(turned(true, 20), 6 * rows);
          EXPECT_GE(turned(false, 50), 3 * (columns - 1));
          EXPECT_GE(turned(false, -50), 3 * (columns - 1));
        }
}

// At the tip of a flat cone each column has a vertex of its own, whose exact tangent is that of one side of
// the column: half of it off its only triangle.
TEST(Cones, LeaveOutHalfAColumnAtTips) {
  for (const char* height : {"0.07", "0.15", "1"})
    for (const int columns : {6, 7, 8, 9, 10, 16}) {
      SCOPED_TRACE(std::string(height) + " high, " + std::to_string(columns) + " columns");
      Mesh mesh = sample_mesh(make_surface(std::string("cone:radius=1,height=") + height),
                              {.columns = columns, .rows = 1});
      EXPECT_EQ(assessed(mesh).outside, 0u);
      const std::uint32_t tip = mesh.triangles.front()[2];
      const Vec3<double> t = mesh.tangents[tip].xyz(), turned = cross(mesh.normals[tip], t);
      mesh.tangents[tip] = {turned.x, turned.y, turned.z, mesh.tangents[tip].w};
      EXPECT_EQ(assessed(mesh).outside, 1u);
    }
}

// Very many triangles at one place, each with vertices of its own: what is claimed of a few of them is
// claimed of all. (Each looked at beside each of the others would take hours.)
TEST(Cones, OfVeryManyTrianglesAtAPlace) {
  for (const std::uint32_t n : {20U, 200U, 1000U, 100000U})
    for (const double degrees : {0.0, 90.0, 180.0, 300.0}) {
      Mesh soup;
      const double sector = 1, a = degrees * std::numbers::pi / 180;
      for (std::uint32_t i = 0; i < n; ++i) {
        for (const double angle : {-1.0, sector * i / n, sector * i / n + 0.4}) {
          const Vec3<double> p =
              angle < 0 ? Vec3<double>{0, 0, 0} : Vec3<double>{std::cos(angle), std::sin(angle), 0};
          soup.positions.push_back(p);
          soup.uvs.push_back({p.x, p.y});
          soup.normals.push_back({0, 0, 1});
          soup.tangents.push_back({std::cos(a), std::sin(a), 0, -1});
        }
        soup.triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
      }
      const TrianglesReport report = assessed(soup);
      EXPECT_EQ(report.compared, soup.corners()) << n << " triangles, " << degrees;
      EXPECT_EQ(report.outside, degrees == 0 ? 0 : soup.corners()) << n << " triangles, " << degrees;
    }
}

// Turned, swapped, negated, and of uvs that have changed since.
TEST(Cones, LeaveOutWhatIsNoAverage) {
  Mesh mesh = sample_mesh(make_surface("torus"), {.columns = 64, .rows = 32});
  EXPECT_EQ(outside(mesh), 0u);
  const auto changed = [&](auto f) {
    Mesh other = mesh;
    for (std::size_t v = 0; v < mesh.tangents.size(); ++v) {
      const Vec4<double>& t = mesh.tangents[v];
      const Vec3<double> d = unit(f(t.xyz(), cross(mesh.normals[v], t.xyz())));
      other.tangents[v] = {d.x, d.y, d.z, t.w};
    }
    return outside(other);
  };
  using V = Vec3<double>;
  EXPECT_EQ(changed([](const V& t, const V&) { return -t; }), mesh.corners());
  EXPECT_EQ(changed([](const V&, const V& b) { return b; }), mesh.corners());
  // Cones of this mesh are some degrees wide, the limit is 5.
  EXPECT_GT(changed([](const V& t, const V& b) { return std::cos(0.35) * t + std::sin(0.35) * b; }),
            mesh.corners() * 9 / 10);
  Mesh stale = mesh;
  for (auto& uv : stale.uvs) uv = {0.25 * uv.x - 0.97 * uv.y, 0.97 * uv.x + 0.25 * uv.y};
  EXPECT_GT(outside(stale), mesh.corners() * 9 / 10);
}

// Fans with one triangle whose uvs are known to some ten degrees, the others' to one, and its tangent.
TEST(Cones, AreTheSameHoweverAFanLies) {
  constexpr unsigned seed = 71;
  SCOPED_TRACE("seed " + std::to_string(seed));
  Random random(seed);
  for (int k = 0; k < 3000; ++k) {
    Mesh fan;
    fan.half_steps.uv = 0.5 / 255;
    const auto triangles = static_cast<std::uint32_t>(4 + k % 5);
    std::vector<Vec2<double>> places{{0, 0}}, uvs{{0, 0}};
    for (std::uint32_t i = 0; i < triangles; ++i) {
      const double angle = 2 * std::numbers::pi * i / triangles,
                   radius = i < 2 ? uniform(random, 0.05, 0.15) : 1;
      const auto [x, y] = places.emplace_back(radius * std::cos(angle), radius * std::sin(angle));
      uvs.push_back({40 * (x + uniform(random, 0, 0.6) * y), 40 * (y + uniform(random, 0, 0.6) * x)});
      fan.triangles.push_back({0, i + 1, (i + 1) % triangles + 1});
    }
    Claim first = Claim::none;
    for (int turn = 0; turn < 24; ++turn) {
      const double c = std::cos(turn * std::numbers::pi / 12), s = std::sin(turn * std::numbers::pi / 12);
      fan.positions.clear();
      for (const auto& [x, y] : places)
        fan.positions.push_back({c * x - s * y, s * x + c * y, 0.3 * std::sin(9 * x + 5 * y)});
      fan.normals.assign(places.size(), {0, 0, 1});
      fan.uvs = uvs;
      const CornerFrame frame = mesh_frames(fan, find_frame_method("face")).corner(0);
      fan.tangents.assign(places.size(), {frame.t.x, frame.t.y, frame.t.z, -frame.sign});
      for (auto& uv : fan.uvs) uv = {std::nearbyint(uv.x) / 255, std::nearbyint(uv.y) / 255};
      const std::vector<double> limit(places.size(), 5);
      const Cones cones(fan, triangle_signs(fan), std::vector<bool>(triangles, true), join_vertices(fan), {},
                        limit, 5);
      if (turn == 0) first = cones.claim(0, 0);
      ASSERT_EQ(cones.claim(0, 0), first) << "fan " << k << " turned by " << 15 * turn;
    }
  }
}

}  // namespace
}  // namespace darboux::cones_test
