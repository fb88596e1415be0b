// Small geometry that several primitives share.
#pragma once

#include <optional>
#include <utility>
#include <vector>

#include <Eigen/Geometry>

#include "primitive.h"

namespace darboux::fit {

// Any rotation whose z is the given direction.
Matrix3d axes_with_z(const Vector3d& z);

// The frame with this z whose x is the world axis least parallel to z, projected.
Matrix3d conventional_frame(const Vector3d& z);

// The direction or its opposite, whichever has a positive largest component.
Vector3d positive_side(const Vector3d& a);

// The direction from the axis to the point.
Vector3d radial(const GeometricParameters& n, const Vector3d& at);

// The local frame at a surface point, with this x and z.
LocalModel local_frame(const Vector3d& origin, const Vector3d& x, const Vector3d& z);

// The inverse of normal equations, zero in directions that they do not determine.
Eigen::MatrixXd determined_inverse(const Eigen::MatrixXd& hessian);

// The eigenvector of the smallest eigenvalue.
Vector3d least_direction(const Matrix3d& symmetric);

struct Sphere3 {
  Vector3d centre;
  double radius;
};
struct Circle2 {
  Eigen::Vector2d centre;
  double radius;
};
// |x - c|^2 = r^2 as a linear equation in c and r^2 - |c|^2 [Kasa1976].
std::optional<Sphere3> linear_sphere(const Eigen::Matrix3Xd& points);
std::optional<Circle2> linear_circle(const Eigen::Matrix2Xd& points);

struct Circle3 {
  Vector3d centre, axis;
  double radius;
  double deviation;  // of the points, root mean square, of each of the two directions across it
};
// The circle through weighted points: the algebraic fit x^2 + y^2 = 2 a x + 2 b y + c in the plane of their
// largest moments.
Circle3 algebraic_circle(const Eigen::Matrix3Xd& points, const std::vector<double>& weights);

struct AxisOfRevolution {
  Vector3d point, direction;
};
// Every normal of a surface of revolution meets the axis: with a its direction and m its moment, n . m + (p x
// n) . a = 0, a linear line complex [Pottmann2001].
AxisOfRevolution linear_axis(const OrientedPoints& sample);
// The points in the half-plane bounded by the axis: distance from it, and height above its point.
Eigen::Matrix2Xd half_plane(const OrientedPoints& sample, const AxisOfRevolution& axis);

// The start if its numbers are usable, else none.
std::optional<GeometricParameters> checked_start(const GeometricParameters& n);

// Coordinates of support about the axis: z along it, x towards the mean of the points.
GeometricParameters axis_frame(const GeometricParameters& n, const Vector3d& mean);
// About a given z, x along the largest scatter.
GeometricParameters scatter_frame(const GeometricParameters& n, const Vector3d& z, const Matrix3d& scatter);

// An angle in turns, from 0 to 1.
double turns(double y, double x);

}  // namespace darboux::fit
