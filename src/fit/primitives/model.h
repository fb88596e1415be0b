// A shape where it lies, in two ways: as people name it (centre, axis, radii), and in the local coordinates
// of one of its own points, in which it is estimated.
#pragma once

#include <array>

#include <Eigen/Geometry>

#include "shapes.h"

namespace darboux::fit {

using Eigen::Matrix3d;

// The names' order of `lengths`: sphere, cylinder: radius; cone: half-angle (radians); torus: major, minor
// radius; ellipsoid: semi-axes. z of `axes` is the axis (plane: normal; cone: from the apex, which is
// `centre`, into the opening).
struct Natural {
  Vector3d centre = Vector3d::Zero();
  Matrix3d axes = Matrix3d::Identity();
  std::array<double, 3> lengths{};
};

// x = origin + rotation * local.
template <class Shape>
struct Model {
  Vector3d origin = Vector3d::Zero();
  Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();
  std::array<double, Shape::size> s{};

  Vector3d local(const Vector3d& x) const { return rotation.conjugate() * (x - origin); }
};

// Any rotation whose z is the given direction.
inline Matrix3d axes_with_z(const Vector3d& z) {
  Matrix3d axes;
  axes.col(2) = z.normalized();
  axes.col(0) = axes.col(2).unitOrthogonal();
  axes.col(1) = axes.col(2).cross(axes.col(0));
  return axes;
}

// The local coordinates at the surface point nearest to `at`; an inverse of natural(). Not finite where that
// point is none.
template <class Shape>
Model<Shape> localise(const Natural& n, const Vector3d& at);
template <class Shape>
Natural natural(const Model<Shape>& model);

namespace local {

inline void set_frame(const Vector3d& origin, const Vector3d& x, const Vector3d& z, Vector3d& to_origin,
                      Eigen::Quaterniond& to) {
  Matrix3d r;
  r.col(0) = x;
  r.col(1) = z.cross(x);
  r.col(2) = z;
  to = Eigen::Quaterniond(r).normalized();
  to_origin = origin;
}

// The direction from the axis to the point.
inline Vector3d radial(const Natural& n, const Vector3d& at) {
  const Vector3d a = n.axes.col(2), q = at - n.centre;
  const Vector3d r = q - q.dot(a) * a;
  return r.norm() > 1e-12 * q.norm() ? r.normalized() : Vector3d(n.axes.col(0));
}

}  // namespace local

template <>
inline Model<PlaneShape> localise(const Natural& n, const Vector3d& at) {
  Model<PlaneShape> m;
  const Vector3d z = n.axes.col(2);
  local::set_frame(at - z.dot(at - n.centre) * z, n.axes.col(0), z, m.origin, m.rotation);
  return m;
}
template <>
inline Natural natural(const Model<PlaneShape>& m) {
  const Matrix3d r = m.rotation.toRotationMatrix();
  return {m.origin + m.s[0] * r.col(2), r, {}};
}

template <>
inline Model<SphereShape> localise(const Natural& n, const Vector3d& at) {
  Model<SphereShape> m;
  const Vector3d q = at - n.centre,
                 outward = q.norm() > 0 ? Vector3d(q.normalized()) : Vector3d(n.axes.col(2));
  const Matrix3d r = axes_with_z(-outward);
  local::set_frame(n.centre + n.lengths[0] * outward, r.col(0), r.col(2), m.origin, m.rotation);
  m.s = {0, 1 / n.lengths[0]};
  return m;
}
template <>
inline Natural natural(const Model<SphereShape>& m) {
  return {m.origin + m.rotation * Vector3d(0, 0, m.s[0] + 1 / m.s[1]),
          m.rotation.toRotationMatrix(),
          {1 / std::fabs(m.s[1])}};
}

template <>
inline Model<CylinderShape> localise(const Natural& n, const Vector3d& at) {
  Model<CylinderShape> m;
  const Vector3d a = n.axes.col(2), outward = local::radial(n, at);
  local::set_frame(n.centre + (at - n.centre).dot(a) * a + n.lengths[0] * outward, a, -outward, m.origin,
                   m.rotation);
  m.s = {0, 1 / n.lengths[0]};
  return m;
}
template <>
inline Natural natural(const Model<CylinderShape>& m) {
  return {m.origin + m.rotation * Vector3d(0, 0, m.s[0] + 1 / m.s[1]),
          axes_with_z(m.rotation * Vector3d::UnitX()),
          {1 / std::fabs(m.s[1])}};
}

template <>
inline Model<ConeShape> localise(const Natural& n, const Vector3d& at) {
  Model<ConeShape> m;
  const double sine = std::sin(n.lengths[0]), cosine = std::cos(n.lengths[0]);
  const Vector3d a = n.axes.col(2), e = local::radial(n, at);
  const Vector3d generatrix = cosine * a + sine * e, outward = cosine * e - sine * a;
  const double along = std::fmax((at - n.centre).dot(generatrix), 1e-3 * (at - n.centre).norm());
  local::set_frame(n.centre + along * generatrix, generatrix, -outward, m.origin, m.rotation);
  m.s = {0, cosine / (along * sine), n.lengths[0]};
  return m;
}
template <>
inline Natural natural(const Model<ConeShape>& m) {
  const double kappa = std::fabs(m.s[1]), alpha = m.s[1] < 0 ? -m.s[2] : m.s[2];
  const double sine = std::sin(alpha), side = m.s[1] < 0 ? -1 : 1;
  const Vector3d axis(std::cos(alpha), 0, side * sine);
  const Vector3d apex = Vector3d(0, 0, m.s[0] + side / kappa) - axis / (kappa * sine);
  return {m.origin + m.rotation * apex,
          axes_with_z(m.rotation * Vector3d(alpha < 0 ? -axis : axis)),
          {std::fabs(alpha)}};
}

template <>
inline Model<TorusShape> localise(const Natural& n, const Vector3d& at) {
  Model<TorusShape> m;
  const Vector3d a = n.axes.col(2), q = at - n.centre;
  Vector3d e = local::radial(n, at);
  const auto tube_distance = [&](const Vector3d& side) {
    return std::fabs((q - n.lengths[0] * side).norm() - n.lengths[1]);
  };
  if (n.lengths[0] < n.lengths[1] && tube_distance(-e) < tube_distance(e)) e = -e;
  const Vector3d from_circle = q - n.lengths[0] * e;
  const Vector3d outward = from_circle.norm() > 0 ? Vector3d(from_circle.normalized()) : e;
  const double radial = outward.dot(e), axial = outward.dot(a);
  local::set_frame(n.centre + n.lengths[0] * e + n.lengths[1] * outward, radial * a - axial * e, -outward,
                   m.origin, m.rotation);
  m.s = {0, 1 / n.lengths[1], n.lengths[0], std::atan2(-axial, radial)};
  return m;
}
template <>
inline Natural natural(const Model<TorusShape>& m) {
  const double sine = std::sin(m.s[3]), cosine = std::cos(m.s[3]);
  const Vector3d centre = Vector3d(0, 0, m.s[0] + 1 / m.s[1]) + m.s[2] * Vector3d(-sine, 0, cosine);
  return {m.origin + m.rotation * centre,
          axes_with_z(m.rotation * Vector3d(cosine, 0, sine)),
          {m.s[2], 1 / m.s[1]}};
}

template <>
inline Model<EllipsoidShape> localise(const Natural& n, const Vector3d&) {
  Model<EllipsoidShape> m;
  m.origin = n.centre;
  m.rotation = Eigen::Quaterniond(n.axes).normalized();
  m.s = {0, 0, 0, std::log(n.lengths[0]), std::log(n.lengths[1]), std::log(n.lengths[2])};
  return m;
}
template <>
inline Natural natural(const Model<EllipsoidShape>& m) {
  return {m.origin + m.rotation * Vector3d(m.s[0], m.s[1], m.s[2]),
          m.rotation.toRotationMatrix(),
          {std::exp(m.s[3]), std::exp(m.s[4]), std::exp(m.s[5])}};
}

}  // namespace darboux::fit
