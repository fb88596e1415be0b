// Properties of a mesh before any surface is fitted: how many positions it has, how its faces turn, whether
// it is flat.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include <darboux/assess.h>
#include <darboux/mesh.h>

namespace darboux {

struct Shape {
  // One vertex per different finite position that triangles use. In large meshes, this and everything else
  // here is from the triangles about some thousands of vertices.
  std::vector<std::uint32_t> places;
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
  double size = 0;                                     // diagonal of the bounding box
  double thickness = 0;                                // rms distance from the best plane, over the size
  Eigen::Matrix3d axes = Eigen::Matrix3d::Identity();  // of inertia, the thinnest first
  Eigen::Vector3d plane_normal = Eigen::Vector3d::UnitZ();
  std::vector<std::array<std::uint32_t, 2>> edges;  // between positions, by vertex; each once
  std::size_t turning = 0;                          // edges whose faces turn by more than a degree
  double moderate = 1;                              // the share of these that turn by at most 50 degrees
  double turn_deg = 0;                              // their median
  double faceted = 0;  // of triangles with area, the share whose normals are their own
  // Whether uvs may be a surface's own, or an affine map of them: such uvs jump by one or two periods across
  // a seam, not by a different vector at every vertex, as between the islands of an atlas.
  bool one_chart = true;

  bool is_faceted() const { return faceted > 0.5; }
};

Shape shape_of(const Mesh& mesh);

// The quadric on which the positions lie, within three times fits_below. definite: a sphere or an ellipsoid;
// indefinite: a cone, a hyperboloid or a saddle; any: that is not clear, or they lie on several.
enum class Quadric { none, definite, indefinite, any };
Quadric quadric_of(const Mesh& mesh, const Shape& shape);  // looks at some hundreds of positions

// Whether the positions may lie on a Darboux cyclide, a |p|⁴ + |p|² l(p) + q(p) = 0 with l linear and q
// quadratic. A torus is one.
bool may_be_cyclide(const Mesh& mesh, const Shape& shape);  // looks at some hundreds of positions

// Why it is pointless to search for a curved surface; none if there may be one.
std::optional<Evidence> against_any_surface(const Shape& shape);

}  // namespace darboux
