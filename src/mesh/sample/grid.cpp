#include <cmath>
#include <numbers>
#include <random>

#include "chart_mesh.h"

namespace darboux {
namespace {

double graded(double x, double grading) {  // 0, 1/2 and 1 stay where they are, to the bit
  return grading == 0 ? x : x + grading * sincos_turns(x).sin / (2 * std::numbers::pi);
}

// The grid of (u, v), row by row, before any vertex is doubled.
std::vector<Vec2<double>> uv_grid(const SampleMeshOptions& o, std::mt19937_64& random) {
  const int columns = o.columns, rows = o.rows;
  const bool staggered = o.topology == MeshTopology::lantern;
  std::uniform_real_distribution<double> uniform(-1, 1);
  std::vector<Vec2<double>> grid;
  grid.reserve(static_cast<std::size_t>(columns + 1) * (rows + 1));
  for (int j = 0; j <= rows; ++j)
    for (int i = 0; i <= columns; ++i) {
      const bool moves = o.jitter > 0 && i > 0 && i < columns && j > 0 && j < rows;
      const bool on_fold = o.mirror && 2 * i == columns;  // stays at u = 1/2
      const double turned = staggered && j % 2 == 1 ? 0.5 : 0;
      const double du = moves && !on_fold ? o.jitter * uniform(random) : turned;
      const double dv = moves ? o.jitter * uniform(random) : 0;
      const double v = o.v_first + (o.v_last - o.v_first) * graded((j + dv) / rows, o.grading);
      grid.push_back({graded((i + du) / columns, o.grading), j == rows ? o.v_last : v});
    }
  return grid;
}

}  // namespace

ChartMesh grid_mesh(const AnySurface& surface, const SampleMeshOptions& o) {
  const int columns = o.columns, rows = o.rows;
  const bool staggered = o.topology == MeshTopology::lantern;
  const bool wrap_u = o.shared_seam && surface.info().u == Coordinate::turn;
  const bool wrap_v =
      o.shared_seam && surface.info().v == Coordinate::turn && o.v_first == 0 && o.v_last == 1;
  const bool moves_poles = o.pole != PolePlacement::per_column;
  const bool first_is_pole = moves_poles && is_pole(surface, o.v_first);
  const bool last_is_pole = moves_poles && is_pole(surface, o.v_last);
  std::mt19937_64 random(o.seed);
  std::uniform_real_distribution<double> uniform(-1, 1);

  const std::vector<Vec2<double>> grid = uv_grid(o, random);
  const auto at = [&](int i, int j) { return static_cast<std::size_t>(j) * (columns + 1) + i; };

  ChartMesh mesh;
  constexpr auto unused = static_cast<std::uint32_t>(-1);
  // Vertices by grid point and, on the fold of a mirrored mesh, by half.
  std::vector<std::uint32_t> index(2 * grid.size(), unused);
  const auto vertex = [&](int i, int j, int column) {
    int gi = wrap_u ? i % columns : i;
    const int gj = wrap_v ? j % rows : j;
    Vec2<double> uv = grid[at(gi, gj)];
    if ((first_is_pole && j == 0) || (last_is_pole && j == rows)) {
      const bool shared = o.pole == PolePlacement::shared;
      gi = shared ? 0 : column;
      uv.x = shared ? 0.5 : graded((column + 0.5) / columns, o.grading);
    }
    const bool second_half = o.mirror && 2 * column >= columns;
    std::uint32_t& known = index[2 * at(gi, gj) + second_half];
    if (known == unused) {
      known = static_cast<std::uint32_t>(mesh.vertices.size());
      mesh.vertices.push_back({uv, second_half});
    }
    return known;
  };

  // \returns false for a triangle that is omitted because it extends to infinity
  const auto add = [&](std::array<std::array<int, 2>, 3> corners, int column) {
    std::array<Vec3<double>, 3> p;
    Vec2<double> centre{};
    for (int k = 0; k < 3; ++k) {
      const Vec2<double> uv = grid[at(corners[k][0], corners[k][1])];
      p[k] = surface.jet(uv.x, uv.y).position;
      centre = centre + uv / 3.0;
    }
    const double scale = std::fmax(largest(p[0]), std::fmax(largest(p[1]), largest(p[2])));
    const auto together = [&](int k, int l) { return same_place(p[k], p[l], scale); };
    if (together(0, 1) || together(1, 2) || together(2, 0)) return std::isfinite(scale);  // at a pole
    if (turned_over(surface, centre)) std::swap(corners[1], corners[2]);
    Triangle triangle;
    for (int k = 0; k < 3; ++k) triangle[k] = vertex(corners[k][0], corners[k][1], column);
    mesh.triangles.push_back(triangle);
    return true;
  };
  for (int j = 0; j < rows; ++j)
    for (int i = 0; i < columns; ++i) {
      // A lantern's triangles stand on a segment of one row and point to a vertex of the other.
      const bool rising = staggered ? j % 2 == 1 : o.random_diagonals && uniform(random) < 0;
      const std::size_t before = mesh.triangles.size();
      const bool lower = rising ? add({{{i, j}, {i + 1, j}, {i + 1, j + 1}}}, i)
                                : add({{{i, j}, {i + 1, j}, {i, j + 1}}}, i);
      const bool upper = rising ? add({{{i, j}, {i + 1, j + 1}, {i, j + 1}}}, i)
                                : add({{{i + 1, j}, {i + 1, j + 1}, {i, j + 1}}}, i);
      mesh.dropped_cells += !lower || !upper || mesh.triangles.size() == before;
    }
  return mesh;
}

}  // namespace darboux
