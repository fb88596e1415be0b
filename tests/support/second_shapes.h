/// \file second_shapes.h
/// The surfaces of the meshes in data/ and shared/, with formulas written out anew, for second_opinion.h.
#pragma once

#include "second_opinion.h"

namespace darboux::test {

// ---- directions by the formulas of the catalogue

inline Directions ellipsoid(Real a, Real b, Real c, const V2& p) {
  const Real C = std::cos(2 * pi_real * p.x()), S = std::sin(2 * pi_real * p.x()),
             x = std::cos(pi_real * p.y()), y = std::sin(pi_real * p.y());
  return {{-a * S, b * C, 0}, {a * x * C, b * x * S, c * y}, {y * C / a, y * S / b, -x / c}};
}
inline Directions torus(const V2& p) {
  const Real C = std::cos(2 * pi_real * p.x()), S = std::sin(2 * pi_real * p.x()),
             x = std::cos(2 * pi_real * p.y()), y = std::sin(2 * pi_real * p.y());
  return {{-S, C, 0}, {-y * C, -y * S, x}, {x * C, x * S, y}};
}
inline Directions cone(Real radius, Real height, const V2& p) {  // a cylinder has no slope
  const Real C = std::cos(2 * pi_real * p.x()), S = std::sin(2 * pi_real * p.x());
  return {{-S, C, 0}, {-radius * C, -radius * S, height}, {height * C, height * S, radius}};
}

// A surface as the library is told it, and as it is computed here, up to a rotation or a mirror image.
struct Shape {
  std::string specification;
  std::function<Directions(const V2&)> at;
  Eigen::Isometry3d placement = Eigen::Isometry3d::Identity();
  bool poles = false;   // at v = 0 and 1
  bool affine = false;  // its uvs are an affine map of the surface's, which is fitted whatever is declared
};

inline Eigen::Isometry3d axes(const Eigen::Matrix3d& linear, double y = 0) {
  Eigen::Isometry3d result = Eigen::Isometry3d::Identity();
  result.linear() = linear;
  result.translation() = Eigen::Vector3d(0, y, 0);
  return result;
}

// three.js has y up; its spheres begin at -x and its cylinders at +z, from the bottom at y = -1.
inline std::optional<Shape> shape_of(const std::string& file) {
  const auto sphere_axes = axes((Eigen::Matrix3d() << -1, 0, 0, 0, 0, 1, 0, 1, 0).finished());
  const auto cylinder_axes = axes((Eigen::Matrix3d() << 0, 1, 0, 0, 0, 1, 1, 0, 0).finished(), -1);
  const std::string name = file.substr(0, file.find('_'));
  if (name == "torus" || name == "jittertorus") return Shape{"torus:major_radius=1,minor_radius=0.4", torus};
  if (name == "sphere" || name == "plainsphere")
    return Shape{"sphere:radius=1", [](const V2& p) { return ellipsoid(1, 1, 1, p); }, sphere_axes, true};
  if (name == "ellipsoid")
    return Shape{"ellipsoid:semi_axis_x=1,semi_axis_y=0.5,semi_axis_z=0.7",
                 [](const V2& p) { return ellipsoid(1, 0.5L, 0.7L, p); }, sphere_axes, true};
  if (name == "cylinder")
    return Shape{"cylinder:radius=1,height=2", [](const V2& p) { return cone(0, 2, p); }, cylinder_axes};
  if (name == "cone")  // a frustum: half of a cone of twice its height
    return Shape{"cone:radius=1,height=4", [](const V2& p) { return cone(1, 4, p); }, cylinder_axes, false,
                 true};
  return std::nullopt;
}

// ---- at the vertices of a mesh

struct Truths {
  std::vector<Directions> at;
  std::vector<bool> pole;
};

// \param linear from the axes of the formulas to those of the mesh, orthogonal
inline Truths truths_of(const Read& mesh, const Shape& shape, const Eigen::Matrix3d& linear) {
  Truths result;
  const Eigen::Matrix<Real, 3, 3> m = linear.cast<Real>();
  for (const V2& uv : mesh.uvs) {
    const Directions d = shape.at(uv);
    result.at.push_back({m * d.t, m * d.b, m * d.n});
    result.pole.push_back(shape.poles && (uv.y() == 0 || uv.y() == 1));
  }
  return result;
}

}  // namespace darboux::test
