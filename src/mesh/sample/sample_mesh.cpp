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

void require(bool holds, const char* option, double value, const char* permitted) {
  if (!holds) throw ParameterError(option, shortest(value) + " is out of range, permitted is " + permitted);
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

// The topology, for this surface and with the options that belong to others.
void check_topology(const AnySurface& surface, const SampleMeshOptions& o) {
  const SurfaceInfo& info = surface.info();
  const auto permit = [&](bool holds, const std::string& wrong, const char* permitted) {
    if (!holds)
      throw ParameterError(std::string("topology ") + name_of(o.topology),
                           wrong + ", permitted " + permitted);
  };
  const std::string name(info.name);
  if (is_sphere(o)) {
    permit(info.u == Coordinate::turn && info.v == Coordinate::half_turn && is_pole(surface, 0) &&
               is_pole(surface, 1),
           name + " does not run from pole to pole like a sphere",
           "are surfaces whose u is a turn and v a half turn, such as sphere, ellipsoid, superellipsoid");
    permit(!o.shared_seam, "has no shared seam", "is seam split");
    permit(o.v_first == 0 && o.v_last == 1, "covers the whole surface", "is v from 0 to 1");
    require(o.subdivisions >= 1 && o.subdivisions <= 2000, "subdivisions", o.subdivisions,
            "1 <= subdivisions <= 2000");
    if (o.topology == MeshTopology::cube_sphere && o.subdivisions % 2 != 0)
      throw ParameterError("subdivisions",
                           std::to_string(o.subdivisions) +
                               " of a cube-sphere puts the poles inside triangles, permitted is "
                               "an even number");
  }
  if (o.topology == MeshTopology::lantern) {
    permit(info.u == Coordinate::turn && info.v == Coordinate::linear && !is_pole(surface, o.v_first) &&
               !is_pole(surface, o.v_last),
           name + " is no tube",
           "are surfaces whose u is a turn and v linear, without a pole, such as cylinder");
    require(o.columns >= 3, "grid", o.columns, "at least 3 columns of a lantern");
  }
  if (o.topology != MeshTopology::grid) {
    permit(o.pole == PolePlacement::per_column, "has no choice of pole", "is a grid for that");
    permit(o.jitter == 0, "has no jitter", "is a grid for that");
    permit(!o.random_diagonals, "has no random diagonals", "is a grid for that");
    permit(!o.mirror, "has no mirrored half", "is a grid for that");
  } else if (o.pole != PolePlacement::per_column && !is_pole(surface, o.v_first) &&
             !is_pole(surface, o.v_last)) {
    throw ParameterError("pole", "neither end of v is one point on " + name +
                                     ", permitted are surfaces with a pole, such as sphere");
  }
}

void check(const AnySurface& surface, const SampleMeshOptions& o) {
  if (o.columns < 1 || o.rows < 1 || static_cast<double>(o.columns) * o.rows > 5e7)
    throw ParameterError("grid", grid_text(o) +
                                     " is out of range, permitted is at least 1 segment each way and at "
                                     "most 5e7 cells (a GLB holds 4 GiB)");
  require(o.jitter >= 0 && o.jitter < 0.5, "jitter", o.jitter, "0 <= jitter < 0.5");
  require(std::fabs(o.shear) <= 1000, "shear", o.shear, "-1000 <= shear <= 1000");
  require(o.v_first >= 0 && o.v_first < o.v_last && o.v_last <= 1, "v range", o.v_first,
          "0 <= first < last <= 1");
  if (o.mirror && o.columns % 2 != 0)
    throw ParameterError("mirror", std::to_string(o.columns) + " columns, permitted is an even number");
  if (o.shared_seam && o.columns < 3)
    throw ParameterError("seam",
                         "shared with " + std::to_string(o.columns) + " columns, permitted are at least 3");
  if (o.shared_seam && surface.info().v == Coordinate::turn && o.rows < 3)
    throw ParameterError("seam", "shared with " + std::to_string(o.rows) + " rows, permitted are at least 3");
  const std::array sizes{std::fabs(o.scale.x), std::fabs(o.scale.y), std::fabs(o.scale.z)};
  for (const double s : sizes) require(s >= 1e-30 && s <= 1e30, "scale", s, "1e-30 <= |s| <= 1e30 for each");
  const auto [least, most] = std::minmax_element(sizes.begin(), sizes.end());
  if (*most > 1e12 * *least)
    throw ParameterError("scale",
                         shortest(*most) + " beside " + shortest(*least) +
                             " is out of range, permitted is at most 1e12 times the least of the three");
  require(o.degenerate >= 0, "degenerate", o.degenerate, "0 or more triangles");
  require(o.degenerate_uvs >= 0, "degenerate-uvs", o.degenerate_uvs, "0 or more triangles");
  if (o.degenerate > 0 && (o.shared_seam || o.pole == PolePlacement::shared))
    throw ParameterError("degenerate",
                         "edges at a shared seam or pole have no middle in uv, permitted are a "
                         "split seam and unshared poles");
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

Mesh sample_mesh(const AnySurface& surface, const SampleMeshOptions& o) {
  check(surface, o);
  const VertexMaker make(surface, o);
  ChartMesh chart = is_sphere(o) ? sphere_mesh(surface, o) : grid_mesh(surface, o);
  if (chart.triangles.empty())
    throw ParameterError("grid", grid_text(o) + " gives no triangle with area on " +
                                     std::string(surface.info().name) + ", permitted are finer ones");
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
      throw ParameterError(option, std::to_string(count) + " of " + std::to_string(sound) +
                                       " triangles, permitted are at most as many");
  };
  at_most(o.degenerate, "degenerate");
  at_most(o.degenerate_uvs, "degenerate-uvs");
  if (o.degenerate > 0) add_degenerate_triangles(mesh, chart.vertices, make, o.degenerate);
  if (o.degenerate_uvs > 0) collapse_uvs(mesh, sound, o.degenerate_uvs);
  return mesh;
}

}  // namespace darboux
