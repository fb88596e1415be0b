// The stages of a reference mesh: triangles over the uv square, what their vertices store, defects.
#pragma once

#include <cmath>
#include <limits>
#include <optional>
#include <vector>

#include <darboux/sample_mesh.h>

namespace darboux {

/// A vertex before anything is computed there.
struct ChartVertex {
  Vec2<double> uv;           ///< of the surface
  bool second_half = false;  ///< of a mirrored mesh
};

/// Triangles over the uv square, wound as the surface's n.
struct ChartMesh {
  std::vector<ChartVertex> vertices;
  std::vector<Triangle> triangles;
  std::size_t dropped_cells = 0;  ///< as sample_mesh() counts them
};

/// Whether a triangle that is counter-clockwise in uv is clockwise seen along n: where the chart turns over.
inline bool turned_over(const AnySurface& surface, const Vec2<double>& uv) {
  return surface.frame(uv.x, uv.y).handedness < 0;
}

/// The largest absolute coordinate.
inline double largest(const Vec3<double>& p) {
  return std::fmax(std::fabs(p.x), std::fmax(std::fabs(p.y), std::fabs(p.z)));
}

/// Whether two points are the same up to rounding: 8 ulps of numbers as large as the surface's coordinates
/// around them. A formula's sin(pi*v) is 1.2e-16 at v = 1, not 0. A NaN equals nothing.
inline bool same_place(const Vec3<double>& a, const Vec3<double>& b, double scale) {
  const Vec3<double> d = a - b;
  const double most = 8 * std::numeric_limits<double>::epsilon() * scale;
  return std::fabs(d.x) <= most && std::fabs(d.y) <= most && std::fabs(d.z) <= most;
}

/// Whether the whole row at v is one point.
inline bool is_pole(const AnySurface& surface, double v) {
  const auto at = [&](double u, double w) { return surface.jet(u, w).position; };
  const double scale =
      std::fmax(largest(at(0, 0.25)), std::fmax(largest(at(0.25, 0.5)), largest(at(0.5, 0.75))));
  const Vec3<double> p = at(0, v);
  return same_place(p, at(0.25, v), scale) && same_place(p, at(0.5, v), scale);
}

ChartMesh grid_mesh(const AnySurface& surface, const SampleMeshOptions& options);
ChartMesh sphere_mesh(const AnySurface& surface, const SampleMeshOptions& options);

/// Computes what a vertex stores.
class VertexMaker {
 public:
  VertexMaker(const AnySurface& surface, const SampleMeshOptions& options);
  void append(Mesh& mesh, const ChartVertex& vertex) const;

 private:
  const AnySurface& surface_;
  const SampleMeshOptions& options_;
  std::optional<FrameTransform<double>> scale_;
};

/// Rounds to multiples of 2^-20, so that a float holds the midpoint of any two, also sheared by a multiple of
/// 1/4.
void round_uvs(ChartMesh& chart);

/// Adds triangles without area and rounds the positions.
/// \param chart the mesh's vertices in uv
void add_degenerate_triangles(Mesh& mesh, const std::vector<ChartVertex>& chart, const VertexMaker& make,
                              int count);

/// Removes the uv area of some triangles among the first `of` of the mesh.
void collapse_uvs(Mesh& mesh, std::size_t of, int count);

}  // namespace darboux
