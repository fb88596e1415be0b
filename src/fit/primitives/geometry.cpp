#include "geometry.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "base/linear_algebra.h"

namespace darboux::fit {
namespace {

template <int Dimension>
std::optional<std::pair<Eigen::Matrix<double, Dimension, 1>, double>> linear_round(
    const Eigen::Matrix<double, Dimension, Eigen::Dynamic>& points) {
  using Vector = Eigen::Matrix<double, Dimension, 1>;
  const Vector mean = points.rowwise().mean();
  using Row = Eigen::Matrix<double, Dimension + 1, 1>;
  using Square = Eigen::Matrix<double, Dimension + 1, Dimension + 1>;
  Square normal = Square::Zero();
  Row right = Row::Zero(), row;
  for (Eigen::Index i = 0; i < points.cols(); ++i) {
    const Vector q = points.col(i) - mean;
    row << 2 * q, 1;
    normal += row * row.transpose();
    right += q.squaredNorm() * row;
  }
  const Row x = solve_symmetric(normal, right);
  const Vector c = x.template head<Dimension>();
  const double square = x[Dimension] + c.squaredNorm();
  if (!(square > 0)) return std::nullopt;
  return std::pair<Vector, double>{c + mean, std::sqrt(square)};
}

GeometricParameters with_frame(GeometricParameters n, const Vector3d& x, const Vector3d& z) {
  n.axes.col(2) = z;
  n.axes.col(0) = x.norm() > 0 ? Vector3d(x.normalized()) : z.unitOrthogonal();
  n.axes.col(1) = z.cross(n.axes.col(0));
  return n;
}

}  // namespace

Matrix3d axes_with_z(const Vector3d& z) {
  Matrix3d axes;
  axes.col(2) = z.normalized();
  axes.col(0) = axes.col(2).unitOrthogonal();
  axes.col(1) = axes.col(2).cross(axes.col(0));
  return axes;
}

Matrix3d conventional_frame(const Vector3d& z) {
  Eigen::Index least;
  z.cwiseAbs().minCoeff(&least);
  Matrix3d r;
  r.col(2) = z;
  r.col(0) = (Vector3d::Unit(least) - z[least] * z).normalized();
  r.col(1) = z.cross(r.col(0));
  return r;
}

Vector3d positive_side(const Vector3d& a) {
  Eigen::Index largest;
  a.cwiseAbs().maxCoeff(&largest);
  return a[largest] < 0 ? Vector3d(-a) : a;
}

Vector3d radial(const GeometricParameters& n, const Vector3d& at) {
  const Vector3d a = n.axes.col(2), q = at - n.centre;
  const Vector3d r = q - q.dot(a) * a;
  return r.norm() > 1e-12 * q.norm() ? r.normalized() : Vector3d(n.axes.col(0));
}

LocalModel local_frame(const Vector3d& origin, const Vector3d& x, const Vector3d& z) {
  LocalModel m;
  Matrix3d r;
  r.col(0) = x;
  r.col(1) = z.cross(x);
  r.col(2) = z;
  m.rotation = Eigen::Quaterniond(r).normalized();
  m.origin = origin;
  return m;
}

Eigen::MatrixXd determined_inverse(const Eigen::MatrixXd& hessian) {
  const auto [values, vectors] = symmetric_eigen(hessian);
  constexpr double rounding = 1e-12;
  const double least = rounding * values.maxCoeff();
  const Eigen::VectorXd inverse = values.unaryExpr([least](double x) { return x > least ? 1 / x : 0; });
  return vectors * inverse.asDiagonal() * vectors.transpose();
}

Vector3d least_direction(const Matrix3d& symmetric) {
  return closed_form_symmetric_eigen(symmetric).vectors.col(0);
}

std::optional<Sphere3> linear_sphere(const Eigen::Matrix3Xd& points) {
  const auto found = linear_round<3>(points);
  return found ? std::optional(Sphere3{found->first, found->second}) : std::nullopt;
}

std::optional<Circle2> linear_circle(const Eigen::Matrix2Xd& points) {
  const auto found = linear_round<2>(points);
  return found ? std::optional(Circle2{found->first, found->second}) : std::nullopt;
}

Circle3 algebraic_circle(const Eigen::Matrix3Xd& points, const std::vector<double>& weights) {
  const Eigen::Map<const Eigen::VectorXd> w(weights.data(), points.cols());
  const double sum = w.sum();
  const Vector3d mean = points * w / sum;
  const Eigen::Matrix3Xd centred = points.colwise() - mean;
  const Matrix3d axes = symmetric_eigen(Matrix3d(centred * w.asDiagonal() * centred.transpose())).vectors;
  const Eigen::Matrix3Xd p = axes.transpose() * centred;  // the plane's normal first
  const Eigen::Matrix3Xd rows =
      (Eigen::Matrix3Xd(3, p.cols()) << 2 * p.bottomRows<2>(), Eigen::RowVectorXd::Ones(p.cols())).finished();
  const Eigen::VectorXd squares = p.bottomRows<2>().colwise().squaredNorm();
  const Matrix3d normal_matrix = rows * w.asDiagonal() * rows.transpose();
  const Vector3d circle = solve_symmetric(normal_matrix, Vector3d(rows * w.cwiseProduct(squares)));
  const double radius = std::sqrt(circle.z() + circle.head<2>().squaredNorm());
  const Eigen::ArrayXd radial =
      (p.bottomRows<2>().colwise() - circle.head<2>()).colwise().norm().transpose().array() - radius;
  const double squared = ((radial.square() + p.row(0).transpose().array().square()) * w.array()).sum();
  return {mean + axes * Vector3d(0, circle.x(), circle.y()), axes.col(0), radius,
          std::sqrt(squared / (2 * sum))};
}

AxisOfRevolution linear_axis(const OrientedPoints& sample) {
  Matrix3d mm = Matrix3d::Zero(), ma = mm, aa = mm;
  const Vector3d mean = sample.points.rowwise().mean();
  for (Eigen::Index i = 0; i < sample.points.cols(); ++i) {
    const Vector3d n = sample.normals.col(i), c = (sample.points.col(i) - mean).cross(n);
    mm += n * n.transpose();
    ma += n * c.transpose();
    aa += c * c.transpose();
  }
  const Matrix3d reduced = aa - ma.transpose() * solve_symmetric(mm, ma);
  const Vector3d a = least_direction(0.5 * (reduced + reduced.transpose()));
  const Vector3d moment = -solve_symmetric(mm, Vector3d(ma * a));
  return {mean + a.cross(moment), a};
}

Eigen::Matrix2Xd half_plane(const OrientedPoints& sample, const AxisOfRevolution& axis) {
  Eigen::Matrix2Xd result(2, sample.points.cols());
  for (Eigen::Index i = 0; i < sample.points.cols(); ++i) {
    const Vector3d q = sample.points.col(i) - axis.point;
    result.col(i) << q.cross(axis.direction).norm(), q.dot(axis.direction);
  }
  return result;
}

std::optional<GeometricParameters> checked_start(const GeometricParameters& n) {
  const bool usable =
      n.centre.allFinite() && n.axes.allFinite() &&
      std::all_of(n.lengths.begin(), n.lengths.end(), [](double x) { return std::isfinite(x) && x < 1e6; });
  return usable ? std::optional(n) : std::nullopt;
}

GeometricParameters axis_frame(const GeometricParameters& n, const Vector3d& mean) {
  const Vector3d q = mean - n.centre, z = n.axes.col(2), x = q - q.dot(z) * z;
  return with_frame(n, x, z);
}

GeometricParameters scatter_frame(const GeometricParameters& n, const Vector3d& z, const Matrix3d& scatter) {
  const Matrix3d across = Matrix3d::Identity() - z * z.transpose();
  const Vector3d x = symmetric_eigen(Matrix3d(across * scatter * across)).vectors.col(2);
  return with_frame(n, x, z);
}

double turns(double y, double x) {
  const double turn = std::atan2(y, x) / (2 * std::numbers::pi);
  return turn < 0 ? turn + 1 : turn;
}

double least_radius(const Primitive& primitive, const GeometricParameters& surface, const Vector3d& at) {
  double least = std::numeric_limits<double>::infinity();
  if (primitive.radius_about_axis) least = (at - surface.centre).cross(surface.axes.col(2)).norm();
  for (std::size_t k = 0; k < static_cast<std::size_t>(primitive.lengths); ++k)
    least = std::fmin(least, surface.lengths[k]);
  return least;
}

bool doubles_itself(const Primitive& primitive, const GeometricParameters& surface,
                    const Eigen::Matrix3Xd& cloud, double sigma) {
  if (!primitive.sheets || !primitive.crosses_itself(surface)) return false;
  Eigen::Index on_it = 0, doubled = 0;
  for (const auto p : cloud.colwise()) {
    const auto [near, far] = primitive.sheets(surface, p);
    if (!(near < 3 * sigma)) continue;
    ++on_it;
    doubled += far < 8 * sigma;
  }
  return 2 * doubled > on_it;
}

}  // namespace darboux::fit
