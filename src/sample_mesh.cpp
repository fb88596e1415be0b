#include <cmath>
#include <random>
#include <string>

#include <darboux/error.h>
#include <darboux/mesh_frames.h>
#include <darboux/sample_mesh.h>

#include "text.h"

namespace darboux {
namespace {

void check(const AnySurface& surface, const SampleMeshOptions& o) {
  const auto require = [](bool holds, const char* option, double value, const char* permitted) {
    if (!holds) throw ParameterError(option, shortest(value) + " is out of range, permitted is " + permitted);
  };
  require(o.columns >= 1 && o.rows >= 1, "grid", std::min(o.columns, o.rows), "at least 1 segment each way");
  require(static_cast<double>(o.columns) * o.rows <= 5e7, "grid", static_cast<double>(o.columns) * o.rows,
          "at most 5e7 cells (a GLB holds 4 GiB)");
  require(o.jitter >= 0 && o.jitter < 0.5, "jitter", o.jitter, "0 <= jitter < 0.5");
  require(std::isfinite(o.shear), "shear", o.shear, "a finite number");
  require(o.v_first >= 0 && o.v_first < o.v_last && o.v_last <= 1, "v range", o.v_first,
          "0 <= first < last <= 1");
  if (o.mirror && o.columns % 2 != 0)
    throw ParameterError("mirror", std::to_string(o.columns) + " columns, permitted is an even number");
  if (o.shared_seam && o.columns < 3)
    throw ParameterError("seam",
                         "shared with " + std::to_string(o.columns) + " columns, permitted are at least 3");
  if (o.shared_seam && surface.info().v == Coordinate::turn && o.rows < 3)
    throw ParameterError("seam", "shared with " + std::to_string(o.rows) + " rows, permitted are at least 3");
}

}  // namespace

Mesh sample_mesh(const AnySurface& surface, const SampleMeshOptions& o) {
  check(surface, o);
  const int columns = o.columns, rows = o.rows;
  const bool wrap_u = o.shared_seam && surface.info().u == Coordinate::turn;
  const bool wrap_v =
      o.shared_seam && surface.info().v == Coordinate::turn && o.v_first == 0 && o.v_last == 1;
  std::mt19937_64 random(o.seed);
  std::uniform_real_distribution<double> uniform(-1, 1);

  // The grid of (u, v), before any vertex is doubled.
  const auto at = [&](int i, int j) { return static_cast<std::size_t>(j) * (columns + 1) + i; };
  std::vector<Vec2<double>> grid(static_cast<std::size_t>(columns + 1) * (rows + 1));
  for (int j = 0; j <= rows; ++j)
    for (int i = 0; i <= columns; ++i) {
      const bool interior = i > 0 && i < columns && j > 0 && j < rows;
      const double du = o.jitter > 0 && interior ? o.jitter * uniform(random) : 0;
      const double dv = o.jitter > 0 && interior ? o.jitter * uniform(random) : 0;
      const double share = j == rows ? 1 : (j + dv) / rows;  // the last row is v_last to the bit
      grid[at(i, j)] = {(i + du) / columns, o.v_first + (o.v_last - o.v_first) * share};
      if (j == rows) grid[at(i, j)].y = o.v_last;
    }

  Mesh mesh;
  constexpr auto unused = static_cast<std::uint32_t>(-1);
  // Vertices by grid point and, on the fold of a mirrored mesh, by half.
  std::vector<std::uint32_t> index(2 * grid.size(), unused);
  const auto vertex = [&](int i, int j, bool right) {
    const int gi = wrap_u ? i % columns : i, gj = wrap_v ? j % rows : j;
    const bool second = o.mirror && right;
    std::uint32_t& known = index[2 * at(gi, gj) + second];
    if (known != unused) return known;
    known = static_cast<std::uint32_t>(mesh.positions.size());
    const auto [u, v] = grid[at(gi, gj)];
    const Sample<double> s = surface.sample(u, v);
    const double along = second ? -1 : 1;  // sign of d(stored u)/du
    Frame<double> frame = s.frame;
    frame.t = along * frame.t;
    frame.handedness = along * frame.handedness;
    const double mirrored = o.mirror ? 1 - std::fabs(2 * u - 1) : u;
    mesh.positions.push_back(s.jet.position);
    mesh.normals.push_back(frame.n);
    mesh.uvs.push_back({mirrored + o.shear * v, v});
    mesh.tangents.push_back(tangent4(frame, o.sign));
    return known;
  };

  const auto add = [&](std::array<std::array<int, 2>, 3> corners, bool right) {
    std::array<Vec3<double>, 3> p;
    for (int k = 0; k < 3; ++k) {
      const Vec2<double> uv = grid[at(corners[k][0], corners[k][1])];
      p[k] = surface.jet(uv.x, uv.y).position;
    }
    if (p[0] == p[1] || p[1] == p[2] || p[2] == p[0]) return;  // at a pole
    // Wound so that its normal agrees with n: the other way round where the chart turns over.
    Vec2<double> centre{};
    for (const auto& [i, j] : corners) {
      centre.x += grid[at(i, j)].x / 3;
      centre.y += grid[at(i, j)].y / 3;
    }
    if (surface.frame(centre.x, centre.y).handedness < 0) std::swap(corners[1], corners[2]);
    Triangle triangle;
    for (int k = 0; k < 3; ++k) triangle[k] = vertex(corners[k][0], corners[k][1], right);
    mesh.triangles.push_back(triangle);
  };
  for (int j = 0; j < rows; ++j)
    for (int i = 0; i < columns; ++i) {
      const bool right = 2 * i >= columns;
      if (o.random_diagonals && uniform(random) < 0) {
        add({{{i, j}, {i + 1, j}, {i + 1, j + 1}}}, right);
        add({{{i, j}, {i + 1, j + 1}, {i, j + 1}}}, right);
      } else {
        add({{{i, j}, {i + 1, j}, {i, j + 1}}}, right);
        add({{{i + 1, j}, {i + 1, j + 1}, {i, j + 1}}}, right);
      }
    }
  return mesh;
}

}  // namespace darboux
