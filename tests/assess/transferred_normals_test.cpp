// Normals of leaves and rocks may be those of the crown or the ground. What they may not be: negated in a
// part, turned as one, or all the same on a closed piece. And normals far from their own triangles, where
// nothing else tells of them, are warnings.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <string>
#include <string_view>

#include <gtest/gtest.h>

#include <darboux/assess.h>

#include "append_mesh.h"

namespace darboux::test::transferred_normals_test {
namespace {

constexpr double tau = 2 * std::numbers::pi;

std::size_t count_of(const Mesh& mesh, Severity severity) {
  std::size_t count = 0;
  for (const Finding& f : assess(mesh).report.findings)
    if (f.code == "NORMAL_ANGLE" && f.severity == severity) count += f.count;
  return count;
}
std::size_t errors(const Mesh& mesh) {
  return count_of(mesh, Severity::error);
}
std::size_t warnings(const Mesh& mesh) {
  return count_of(mesh, Severity::warning);
}

// position(i, j) of (columns + 1) x (rows + 1) vertices.
template <class F>
Mesh grid(std::uint32_t columns, std::uint32_t rows, F position) {
  Mesh mesh;
  for (std::uint32_t j = 0; j <= rows; ++j)
    for (std::uint32_t i = 0; i <= columns; ++i) mesh.positions.push_back(position(i, j));
  for (std::uint32_t j = 0; j < rows; ++j)
    for (std::uint32_t i = 0; i < columns; ++i) {
      const std::uint32_t a = j * (columns + 1) + i, d = a + columns + 1;
      mesh.triangles.push_back({a, a + 1, d + 1});
      mesh.triangles.push_back({a, d + 1, d});
    }
  return mesh;
}

template <class F>
void set_normals(Mesh& mesh, F normal) {
  mesh.normals.clear();
  for (const Vec3<double>& p : mesh.positions) mesh.normals.push_back(unit(normal(p)));
}

// A leaf with a fold in the middle, 0.3 wide and 1 long.
Mesh leaf(std::uint32_t columns, std::uint32_t rows) {
  return grid(columns, rows, [&](std::uint32_t i, std::uint32_t j) {
    const double x = 0.3 * (i / static_cast<double>(columns) - 0.5), y = j / static_cast<double>(rows);
    return Vec3<double>{x, y, 0.4 * std::fabs(x) - 0.3 * y * y};
  });
}

// A closed blob that is no surface of the catalogue; its poles are points.
Mesh blob() {
  constexpr std::uint32_t columns = 24, rows = 12;
  Mesh mesh;
  const auto at = [](double u, double v) {
    const double r = 1 + 0.2 * std::cos(3 * tau * u) * std::sin(v) * std::sin(v) + 0.1 * std::cos(2 * v);
    return r * Vec3<double>{std::sin(v) * std::cos(tau * u), std::sin(v) * std::sin(tau * u), std::cos(v)};
  };
  mesh.positions.push_back(at(0, 0));
  for (std::uint32_t j = 1; j < rows; ++j)
    for (std::uint32_t i = 0; i < columns; ++i)
      mesh.positions.push_back(at(i / static_cast<double>(columns), j * std::numbers::pi / rows));
  mesh.positions.push_back(at(0, std::numbers::pi));
  const auto last = static_cast<std::uint32_t>(mesh.positions.size() - 1);
  for (std::uint32_t i = 0; i < columns; ++i) {
    const std::uint32_t next = (i + 1) % columns;
    mesh.triangles.push_back({0, 1 + i, 1 + next});
    for (std::uint32_t j = 0; j + 2 < rows; ++j) {
      const std::uint32_t a = 1 + j * columns + i, b = 1 + j * columns + next;
      mesh.triangles.push_back({a, a + columns, b + columns});
      mesh.triangles.push_back({a, b + columns, b});
    }
    const std::uint32_t row = 1 + (rows - 2) * columns;
    mesh.triangles.push_back({row + i, last, row + next});
  }
  return mesh;
}

// Averages by area, of a closed or open mesh whose vertices are not split.
void set_own_normals(Mesh& mesh) {
  mesh.normals.assign(mesh.positions.size(), {0, 0, 0});
  for (const auto& [a, b, c] : mesh.triangles) {
    const Vec3<double> plane =
        cross(mesh.positions[b] - mesh.positions[a], mesh.positions[c] - mesh.positions[a]);
    for (const std::uint32_t v : {a, b, c}) mesh.normals[v] = mesh.normals[v] + plane;
  }
  for (Vec3<double>& n : mesh.normals) n = unit(n);
}

TEST(TransferredNormals, OfLeavesInACrownAreNoErrors) {
  for (const auto& [columns, rows] : {std::pair{2u, 4u}, {2u, 2u}, {4u, 4u}}) {
    Mesh mesh = leaf(columns, rows);
    for (const Vec3<double>& centre : {Vec3<double>{0, 0.5, 0.6}, {1, 0, -1}, {0, -1, 0.5}}) {
      set_normals(mesh, [&](const Vec3<double>& p) { return p - centre; });
      EXPECT_EQ(errors(mesh), 0U) << columns << 'x' << rows;
    }
    // Inner vertices are among those that are more than 80 degrees off.
    set_normals(mesh, [](const Vec3<double>& p) { return p - Vec3<double>{0.2, 0.5, 1}; });
    EXPECT_EQ(errors(mesh), 0U);
    // One that differs from its neighbours was not meant so.
    set_own_normals(mesh);
    const std::size_t inner = columns + 2;
    mesh.normals[inner] = -mesh.normals[inner];
    EXPECT_GT(errors(mesh), 0U) << columns << 'x' << rows;
  }
}

TEST(TransferredNormals, OfClosedPiecesTurnLessThanTheSurface) {
  Mesh mesh = blob();
  set_own_normals(mesh);
  EXPECT_EQ(errors(mesh), 0U);
  // From the middle of a crown, and blended with the ground's.
  Mesh crown = mesh;
  set_normals(crown, [](const Vec3<double>& p) { return p - Vec3<double>{2.5, 0.5, 0}; });
  EXPECT_EQ(errors(crown), 0U);
  EXPECT_GT(warnings(crown), 0U);
  Mesh rock = mesh;
  for (std::size_t v = 0; v < rock.normals.size(); ++v) {
    const double w = std::clamp(0.9 - rock.positions[v].z, 0.0, 0.9);
    rock.normals[v] = unit((1 - w) * rock.normals[v] + w * Vec3<double>{0, 0, 1});
  }
  EXPECT_EQ(errors(rock), 0U);
  // What was not meant.
  Mesh same = mesh;
  set_normals(same, [](const Vec3<double>&) { return Vec3<double>{0, 0, 1}; });
  EXPECT_GT(errors(same), 0U) << "all the same";
  Mesh turned = mesh;
  for (Vec3<double>& n : turned.normals) n = {n.x, -n.z, n.y};
  EXPECT_GT(errors(turned), 0U) << "turned as one, as from y up to z up";
  Mesh negated = mesh;
  for (std::size_t v = 0; v < negated.normals.size(); ++v)
    if (negated.positions[v].x > 0.2) negated.normals[v] = -negated.normals[v];
  EXPECT_GT(errors(negated), 0U) << "negated in a part";
  Mesh two = mesh;
  Mesh other = mesh;
  for (std::size_t v = 0; v < other.normals.size(); ++v) {
    other.normals[v] = -other.normals[v];
    other.positions[v].x += 5;
  }
  append(two, other);
  EXPECT_GT(errors(two), 0U) << "a piece of two is negated";
}

// Each triangle with vertices of its own.
Mesh flat_shaded(const Mesh& mesh) {
  Mesh result;
  for (const Triangle& t : mesh.triangles) {
    const auto first = static_cast<std::uint32_t>(result.positions.size());
    for (const std::uint32_t v : t) result.positions.push_back(mesh.positions[v]);
    result.triangles.push_back({first, first + 1, first + 2});
  }
  set_own_normals(result);
  return result;
}

// Hard edges are edges too, and what is flat does not turn.
TEST(TransferredNormals, OfFlatFacesAreNone) {
  Mesh facets = flat_shaded(blob());
  EXPECT_EQ(errors(facets), 0U);
  for (std::size_t v = 0; v < facets.normals.size(); ++v)
    if (v / 3 % 2 == 0) facets.normals[v] = -facets.normals[v];
  EXPECT_GT(errors(facets), 0U);
  // A floor of 10 x 10 quads beside a blob, level and tilted, its normals turned by 90 degrees or negated.
  Mesh beside = blob();
  set_own_normals(beside);
  for (const double tilt : {0.0, 0.3}) {
    const Vec3<double> up = unit(Vec3<double>{-tilt, 0, 1});
    Mesh floor = grid(10, 10, [&](std::uint32_t i, std::uint32_t j) {
      return Vec3<double>{0.5 * i, 0.5 * j, 0.5 * i * tilt} + Vec3<double>{3, 3, 0};
    });
    for (const Vec3<double>& n : {Vec3<double>{0, 1, 0}, -up}) {
      floor.normals.assign(floor.positions.size(), n);
      Mesh both = beside;
      append(both, floor);
      EXPECT_GT(errors(both), 0U) << tilt;
    }
  }
}

// Of a flat card nothing tells which side it is lit from.
TEST(TransferredNormals, OfCurvedCardsAreNotAllNegated) {
  Mesh both = blob();
  set_own_normals(both);
  Mesh card = grid(4, 4, [](std::uint32_t i, std::uint32_t j) {
    const double x = 0.25 * i - 0.5, y = 0.25 * j - 0.5;
    return Vec3<double>{x, y, 0.4 * x * x + 0.3 * x * y} + Vec3<double>{3, 0, 0};
  });
  set_own_normals(card);
  for (Vec3<double>& n : card.normals) n = -n;
  append(both, card);
  EXPECT_GT(errors(both), 0U);
}

// At borders exact normals may be far from few triangles, as of a gutter of three columns: up to 61 degrees.
// Billboards are bent by 45.
TEST(DepartingNormals, OfBentBillboardsAreNone) {
  Mesh mesh = grid(1, 1, [](std::uint32_t i, std::uint32_t j) { return Vec3<double>{1.0 * i, 1.0 * j, 0}; });
  set_normals(mesh, [](const Vec3<double>& p) { return Vec3<double>{p.x < 0.5 ? -1.0 : 1.0, 0, 1}; });
  EXPECT_EQ(errors(mesh) + warnings(mesh), 0U);
}

// Facets: neighbours tell nothing.
TEST(DepartingNormals, AreWarnedOfWhereNothingElseTells) {
  Mesh mesh = flat_shaded(blob());
  EXPECT_EQ(errors(mesh) + warnings(mesh), 0U);
  // Turned by 70 degrees about an edge each.
  const double c = std::cos(70 * tau / 360), s = std::sin(70 * tau / 360);
  for (std::uint32_t v = 0; v < mesh.normals.size(); ++v) {
    const std::uint32_t first = v / 3 * 3;
    const Vec3<double> across =
        cross(mesh.normals[v], unit(mesh.positions[first + 1] - mesh.positions[first]));
    mesh.normals[v] = c * mesh.normals[v] + s * across;
  }
  EXPECT_GT(warnings(mesh), mesh.corners() / 2);
  EXPECT_EQ(errors(mesh), 0U);
}

}  // namespace
}  // namespace darboux::test::transferred_normals_test
