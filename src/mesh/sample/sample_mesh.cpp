#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include <darboux/error.h>
#include <darboux/sample_mesh.h>

#include "base/text.h"
#include "chart_mesh.h"

namespace darboux {
namespace {

void require(bool holds, const char* option, double value, const char* range) {
  if (!holds) throw ParameterError(option, expected_got(range, shortest(value)));
}

const char* name_of(MeshTopology topology) {
  switch (topology) {
    case MeshTopology::icosphere:
      return "icosphere";
    case MeshTopology::cube_sphere:
      return "cube-sphere";
    case MeshTopology::lantern:
      return "lantern";
    default:
      return "grid";
  }
}

bool is_sphere(const SampleMeshOptions& o) {
  return o.topology == MeshTopology::icosphere || o.topology == MeshTopology::cube_sphere;
}

std::string grid_text(const SampleMeshOptions& o) {
  return std::to_string(o.columns) + "x" + std::to_string(o.rows);
}

// Checks the topology for this surface, and that options of other topologies are not set.
void check_topology(const AnySurface& surface, const SampleMeshOptions& o) {
  const SurfaceInfo& info = surface.info();
  const auto expect = [&](bool holds, const char* expected, const std::string& got) {
    if (!holds)
      throw ParameterError(std::string("topology ") + name_of(o.topology), expected_got(expected, got));
  };
  const std::string name(info.name);
  if (is_sphere(o)) {
    expect(info.u == Coordinate::turn && info.v == Coordinate::half_turn && is_pole(surface, 0) &&
               is_pole(surface, 1),
           "a surface from pole to pole, whose u is a turn and v a half turn, such as sphere, ellipsoid, "
           "superellipsoid",
           name);
    expect(!o.shared_seam, "seam split", "a shared seam");
    expect(o.v_first == 0 && o.v_last == 1, "the whole surface, v from 0 to 1", "a part of it");
    require(o.subdivisions >= 1 && o.subdivisions <= 2000, "subdivisions", o.subdivisions,
            "1 <= subdivisions <= 2000");
    if (o.topology == MeshTopology::cube_sphere && o.subdivisions % 2 != 0)
      throw ParameterError("subdivisions",
                           expected_got("an even number, so that the poles of a cube-sphere are vertices",
                                        std::to_string(o.subdivisions)));
  }
  if (o.topology == MeshTopology::lantern) {
    expect(info.u == Coordinate::turn && info.v == Coordinate::linear && !is_pole(surface, o.v_first) &&
               !is_pole(surface, o.v_last),
           "a surface whose u is a turn and v linear, without a pole, such as cylinder", name);
    require(o.columns >= 3, "grid", o.columns, "at least 3 columns of a lantern");
  }
  if (o.topology != MeshTopology::grid) {
    expect(o.pole == PolePlacement::per_column, "a grid for a choice of pole", name_of(o.topology));
    expect(o.jitter == 0, "a grid for jitter", name_of(o.topology));
    expect(!o.random_diagonals, "a grid for random diagonals", name_of(o.topology));
    expect(!o.mirror, "a grid for a mirrored half", name_of(o.topology));
    expect(o.grading == 0, "a grid for grading", name_of(o.topology));
  } else if (o.pole != PolePlacement::per_column && !is_pole(surface, o.v_first) &&
             !is_pole(surface, o.v_last)) {
    throw ParameterError("pole", expected_got("a surface with a pole, such as sphere",
                                              name + ", which has none at either end of v"));
  }
}

void check(const AnySurface& surface, const SampleMeshOptions& o) {
  if (o.columns < 1 || o.rows < 1 || static_cast<double>(o.columns) * o.rows > 5e7)
    throw ParameterError(
        "grid",
        expected_got("at least 1 segment each way and at most 5e7 cells (a GLB holds 4 GiB)", grid_text(o)));
  require(o.jitter >= 0 && o.jitter < 0.5, "jitter", o.jitter, "0 <= jitter < 0.5");
  require(o.grading >= 0 && o.grading < 1, "grading", o.grading, "0 <= grading < 1");
  require(std::fabs(o.shear) <= 1000, "shear", o.shear, "-1000 <= shear <= 1000");
  require(o.v_first >= 0 && o.v_first < o.v_last && o.v_last <= 1, "v range", o.v_first,
          "0 <= first < last <= 1");
  if (o.mirror && o.columns % 2 != 0)
    throw ParameterError("mirror", expected_got("an even number of columns", std::to_string(o.columns)));
  if (o.shared_seam && o.columns < 3)
    throw ParameterError("seam",
                         expected_got("at least 3 columns for a shared seam", std::to_string(o.columns)));
  if (o.shared_seam && surface.info().v == Coordinate::turn && o.rows < 3)
    throw ParameterError("seam", expected_got("at least 3 rows for a shared seam", std::to_string(o.rows)));
  const std::array sizes{std::fabs(o.scale.x), std::fabs(o.scale.y), std::fabs(o.scale.z)};
  for (const double s : sizes) require(s >= 1e-30 && s <= 1e30, "scale", s, "1e-30 <= |s| <= 1e30 for each");
  const auto [least, most] = std::minmax_element(sizes.begin(), sizes.end());
  if (*most > 1e12 * *least)
    throw ParameterError("scale", expected_got("a largest factor of at most 1e12 times the smallest",
                                               shortest(*most) + " beside " + shortest(*least)));
  require(o.degenerate >= 0, "degenerate", o.degenerate, "0 or more triangles");
  require(o.degenerate_uvs >= 0, "degenerate-uvs", o.degenerate_uvs, "0 or more triangles");
  if (o.degenerate > 0 && (o.shared_seam || o.pole == PolePlacement::shared))
    throw ParameterError("degenerate", expected_got("a split seam and unshared poles",
                                                    "a shared one, whose edges have no midpoint in uv"));
  check_topology(surface, o);
}

}  // namespace

VertexMaker::VertexMaker(const AnySurface& surface, const SampleMeshOptions& options)
    : surface_(surface), options_(options) {
  if (options.scale != Vec3<double>{1, 1, 1})
    scale_.emplace(FrameTransform<double>::Matrix(to_eigen(options.scale).asDiagonal()));
}

void VertexMaker::append(Mesh& mesh, const ChartVertex& vertex) const {
  const SampleMeshOptions& o = options_;
  const auto [u, v] = vertex.uv;
  const Sample<double> s = surface_.sample(u, v);
  const double along = vertex.second_half ? -1 : 1;  // sign of d(stored u)/du
  Vec3<double> position = s.jet.position;
  Frame<double> frame = s.frame;
  frame.t = along * frame.t;
  frame.handedness = along * frame.handedness;
  if (scale_) {
    position = {o.scale.x * position.x, o.scale.y * position.y, o.scale.z * position.z};
    frame = (*scale_)(frame);
  }
  const double mirrored = o.mirror ? 1 - std::fabs(2 * u - 1) : u;
  mesh.positions.push_back(position);
  mesh.normals.push_back(frame.n);
  mesh.uvs.push_back({mirrored + o.shear * v, v});
  mesh.tangents.push_back(tangent4(frame, o.sign));
}

Mesh sample_mesh(const AnySurface& surface, const SampleMeshOptions& o, std::size_t* dropped_cells) {
  check(surface, o);
  const VertexMaker make(surface, o);
  ChartMesh chart = is_sphere(o) ? sphere_mesh(surface, o) : grid_mesh(surface, o);
  if (dropped_cells != nullptr) *dropped_cells = chart.dropped_cells;
  if (chart.triangles.empty())
    throw ParameterError(
        "grid", expected_got("one fine enough for triangles with area on " + std::string(surface.info().name),
                             grid_text(o)));
  if (o.degenerate > 0) round_uvs(chart);
  Mesh mesh;
  for (const ChartVertex& vertex : chart.vertices) make.append(mesh, vertex);
  mesh.triangles = std::move(chart.triangles);
  const bool mirrors = ((o.scale.x < 0) + (o.scale.y < 0) + (o.scale.z < 0)) % 2 == 1;
  if (mirrors)
    for (Triangle& triangle : mesh.triangles) std::swap(triangle[1], triangle[2]);
  const std::size_t sound = mesh.triangles.size();
  const auto at_most = [&](int count, const char* option) {
    if (static_cast<std::size_t>(count) > sound)
      throw ParameterError(option, expected_got("at most " + std::to_string(sound) + ", one per triangle",
                                                std::to_string(count)));
  };
  at_most(o.degenerate, "degenerate");
  at_most(o.degenerate_uvs, "degenerate-uvs");
  if (o.degenerate > 0) add_degenerate_triangles(mesh, chart.vertices, make, o.degenerate);
  if (o.degenerate_uvs > 0) collapse_uvs(mesh, sound, o.degenerate_uvs);
  return mesh;
}

}  // namespace darboux
