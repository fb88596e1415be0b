#include "starts.h"

#include <algorithm>
#include <numeric>

#include <Eigen/Dense>

#include "base/neighbours.h"

namespace darboux::fit {
namespace {

using Eigen::Matrix3Xd;
using Eigen::Vector2d;

constexpr Eigen::Index tree_points = 3000, queries = 400;

bool usable(const Natural& n) {
  return n.centre.allFinite() && n.axes.allFinite() &&
         std::all_of(n.lengths.begin(), n.lengths.end(),
                     [](double x) { return std::isfinite(x) && x < 1e6; });
}

// The eigenvector of the smallest eigenvalue.
Vector3d least_direction(const Matrix3d& symmetric) {
  return Eigen::SelfAdjointEigenSolver<Matrix3d>().computeDirect(symmetric).eigenvectors().col(0);
}

// |x - c|^2 = r^2 as a linear equation in c and r^2 - |c|^2 [Kasa1976].
template <int Dimension>
std::optional<std::pair<Eigen::Matrix<double, Dimension, 1>, double>> round(
    const Eigen::Matrix<double, Dimension, Eigen::Dynamic>& points) {
  using Vector = Eigen::Matrix<double, Dimension, 1>;
  const Vector mean = points.rowwise().mean();
  Eigen::Matrix<double, Dimension + 1, Dimension + 1> normal;
  Eigen::Matrix<double, Dimension + 1, 1> right, row;
  normal.setZero(), right.setZero();
  for (Eigen::Index i = 0; i < points.cols(); ++i) {
    const Vector q = points.col(i) - mean;
    row << 2 * q, 1;
    normal += row * row.transpose();
    right += q.squaredNorm() * row;
  }
  const Eigen::Matrix<double, Dimension + 1, 1> x = normal.ldlt().solve(right);
  const Vector c = x.template head<Dimension>();
  const double square = x[Dimension] + c.squaredNorm();
  if (!(square > 0)) return std::nullopt;
  return std::pair<Vector, double>{c + mean, std::sqrt(square)};
}

// The points seen along the axis.
Eigen::Matrix2Xd across(const Oriented& sample, const Matrix3d& axes) {
  return axes.leftCols<2>().transpose() * sample.points;
}

}  // namespace

Oriented oriented_points(const Matrix3Xd& cloud, const Matrix3Xd& normals, std::mt19937_64& random) {
  if (normals.cols() == cloud.cols()) {
    const std::vector<Eigen::Index> chosen = evenly_chosen(cloud.cols(), queries, random);
    Oriented own{cloud(Eigen::all, chosen), normals(Eigen::all, chosen)};
    Eigen::Index kept = 0;
    for (Eigen::Index i = 0; i < own.points.cols(); ++i) {
      const Vector3d n = own.normals.col(i).stableNormalized();
      if (!n.allFinite() || n.isZero()) continue;
      own.points.col(kept) = own.points.col(i);
      own.normals.col(kept++) = n;
    }
    own.points.conservativeResize(3, kept);
    own.normals.conservativeResize(3, kept);
    if (kept > 0) return own;
  }
  std::vector<Vec3<double>> chosen;
  for (const Eigen::Index i : evenly_chosen(cloud.cols(), tree_points, random))
    chosen.push_back(from_eigen(cloud.col(i)));
  const auto n = static_cast<Eigen::Index>(chosen.size());
  const Neighbours tree(chosen);
  std::vector<std::uint32_t> nearest(std::clamp<std::size_t>(chosen.size() / 80, 6, 30));
  std::vector<double> squares(nearest.size());
  const Eigen::Index m = std::min(n, queries);
  Oriented all{Matrix3Xd(3, m), Matrix3Xd(3, m)};
  std::vector<std::pair<double, Eigen::Index>> flatness;
  for (Eigen::Index i = 0; i < m; ++i) {
    const std::size_t found = tree.nearest(chosen[static_cast<std::size_t>(i * n / m)], nearest, squares);
    Vector3d mean = Vector3d::Zero();
    for (std::size_t j = 0; j < found; ++j) mean += to_eigen(chosen[nearest[j]]);
    mean /= static_cast<double>(found);
    Matrix3d scatter = Matrix3d::Zero();
    for (std::size_t j = 0; j < found; ++j) {
      const Vector3d q = to_eigen(chosen[nearest[j]]) - mean;
      scatter += q * q.transpose();
    }
    Eigen::SelfAdjointEigenSolver<Matrix3d> eigen;
    eigen.computeDirect(scatter);
    // The mean has less noise; among few points it is off the surface.
    all.points.col(i) = nearest.size() > 6 ? mean : to_eigen(chosen[static_cast<std::size_t>(i * n / m)]);
    all.normals.col(i) = eigen.eigenvectors().col(0);
    flatness.emplace_back(eigen.eigenvalues()[0] / std::fmax(eigen.eigenvalues()[1], 1e-300), i);
  }
  // Of few points none can be spared.
  const Eigen::Index kept = std::max<Eigen::Index>(2 * m / 3 + 1, 20);
  std::nth_element(flatness.begin(), flatness.begin() + std::min(kept, m - 1), flatness.end());
  Oriented result{Matrix3Xd(3, std::min(kept, m)), Matrix3Xd(3, std::min(kept, m))};
  for (Eigen::Index i = 0; i < result.points.cols(); ++i) {
    result.points.col(i) = all.points.col(flatness[static_cast<std::size_t>(i)].second);
    result.normals.col(i) = all.normals.col(flatness[static_cast<std::size_t>(i)].second);
  }
  return result;
}

template <>
std::optional<Natural> start<PlaneShape>(const Oriented& sample) {
  const Vector3d mean = sample.points.rowwise().mean();
  if (sample.points.cols() < 3) return Natural{mean, axes_with_z(sample.normals.col(0)), {}};
  const Matrix3Xd q = sample.points.colwise() - mean;
  return Natural{mean, axes_with_z(least_direction(q * q.transpose())), {}};
}

template <>
std::optional<Natural> start<SphereShape>(const Oriented& sample) {
  const auto found = round<3>(sample.points);
  if (!found) return std::nullopt;
  const Natural n{found->first, Matrix3d::Identity(), {found->second}};
  return usable(n) ? std::optional(n) : std::nullopt;
}

template <>
std::optional<Natural> start<CylinderShape>(const Oriented& sample) {
  const Matrix3d axes = axes_with_z(least_direction(sample.normals * sample.normals.transpose()));
  const Eigen::Matrix2Xd points = across(sample, axes);
  Vector2d centre;
  double radius;
  if (points.cols() == 2) {  // where the two normals meet
    const Eigen::Matrix2Xd normals = across({sample.normals, {}}, axes);
    Eigen::Matrix2d m;
    m << normals.col(0), -normals.col(1);
    if (std::fabs(m.determinant()) < 1e-3) return std::nullopt;
    const Vector2d t = m.inverse() * (points.col(1) - points.col(0));
    centre = points.col(0) + t[0] * normals.col(0);
    radius = t.cwiseAbs().mean();
  } else {
    const auto found = round<2>(points);
    if (!found) return std::nullopt;
    std::tie(centre, radius) = *found;
  }
  const double along = axes.col(2).dot(sample.points.col(0));
  const Natural n{axes * Vector3d(centre.x(), centre.y(), along), axes, {radius}};
  return usable(n) ? std::optional(n) : std::nullopt;
}

// All tangent planes n . (x - p) = 0 meet in the apex; the normals lie in a plane n . a = const across the
// axis.
template <>
std::optional<Natural> start<ConeShape>(const Oriented& sample) {
  Matrix3d normal = Matrix3d::Zero();
  Vector3d right = Vector3d::Zero();
  for (Eigen::Index i = 0; i < sample.points.cols(); ++i) {
    const Vector3d n = sample.normals.col(i);
    normal += n * n.transpose();
    right += n.dot(sample.points.col(i)) * n;
  }
  const Vector3d apex = normal.ldlt().solve(right);
  Matrix3Xd directions = sample.points.colwise() - apex;
  directions.colwise().normalize();
  if (!directions.allFinite()) return std::nullopt;
  const Vector3d mean = directions.rowwise().mean();
  const Matrix3Xd spread = directions.colwise() - mean;
  Vector3d axis = least_direction(spread * spread.transpose());
  if (axis.dot(mean) < 0) axis = -axis;
  const double angle = std::acos(std::clamp(axis.dot(mean), -1.0, 1.0));
  if (!(angle > 0.01 && angle < 1.55)) return std::nullopt;
  const Natural n{apex, axes_with_z(axis), {angle}};
  return usable(n) ? std::optional(n) : std::nullopt;
}

// Every normal of a surface of revolution meets the axis: with a its direction and m its moment, n . m + (p x
// n) . a = 0, a linear line complex [Pottmann2001]. Then a circle in the half-plane of (distance from the
// axis, height).
template <>
std::optional<Natural> start<TorusShape>(const Oriented& sample) {
  Matrix3d mm = Matrix3d::Zero(), ma = mm, aa = mm;
  const Vector3d mean = sample.points.rowwise().mean();
  for (Eigen::Index i = 0; i < sample.points.cols(); ++i) {
    const Vector3d n = sample.normals.col(i), c = (sample.points.col(i) - mean).cross(n);
    mm += n * n.transpose();
    ma += n * c.transpose();
    aa += c * c.transpose();
  }
  const Eigen::LDLT<Matrix3d> solver(mm);
  const Matrix3d reduced = aa - ma.transpose() * solver.solve(ma);
  const Vector3d a = least_direction(0.5 * (reduced + reduced.transpose()));
  const Vector3d moment = -solver.solve(ma * a);
  const Vector3d on_axis = mean + a.cross(moment);
  Eigen::Matrix2Xd half_plane(2, sample.points.cols());
  for (Eigen::Index i = 0; i < sample.points.cols(); ++i) {
    const Vector3d q = sample.points.col(i) - on_axis;
    half_plane.col(i) << q.cross(a).norm(), q.dot(a);
  }
  const auto circle = round<2>(half_plane);
  if (!circle) return std::nullopt;
  const Natural n{
      on_axis + circle->first.y() * a, axes_with_z(a), {std::fmax(circle->first.x(), 0), circle->second}};
  return usable(n) ? std::optional(n) : std::nullopt;
}

// The quadric whose value at the points is 0 and whose gradient there is the normal, in the sense of least
// squares; normals are turned away from the centre of the sphere through the points.
template <>
std::optional<Natural> start<EllipsoidShape>(const Oriented& sample) {
  const auto sphere = round<3>(sample.points);
  if (!sphere || !sphere->first.allFinite()) return std::nullopt;
  const Vector3d mean = sample.points.rowwise().mean();
  Eigen::Matrix<double, 10, 10> normal = Eigen::Matrix<double, 10, 10>::Zero();
  Eigen::Matrix<double, 10, 1> right = Eigen::Matrix<double, 10, 1>::Zero();
  for (Eigen::Index i = 0; i < sample.points.cols(); ++i) {
    const Vector3d p = sample.points.col(i) - mean;
    Vector3d n = sample.normals.col(i);
    if (n.dot(sample.points.col(i) - sphere->first) < 0) n = -n;
    // Q = sum of the unknowns times x^2, y^2, z^2, 2yz, 2xz, 2xy, 2x, 2y, 2z, 1
    Eigen::Matrix<double, 4, 10> rows;
    rows << p.x() * p.x(), p.y() * p.y(), p.z() * p.z(), 2 * p.y() * p.z(), 2 * p.x() * p.z(),
        2 * p.x() * p.y(), 2 * p.x(), 2 * p.y(), 2 * p.z(), 1,  //
        2 * p.x(), 0, 0, 0, 2 * p.z(), 2 * p.y(), 2, 0, 0, 0,   //
        0, 2 * p.y(), 0, 2 * p.z(), 0, 2 * p.x(), 0, 2, 0, 0,   //
        0, 0, 2 * p.z(), 2 * p.y(), 2 * p.x(), 0, 0, 0, 2, 0;
    rows.row(0) *= 3 / sphere->second;
    normal += rows.transpose() * rows;
    right += rows.bottomRows<3>().transpose() * n;
  }
  const Eigen::Matrix<double, 10, 1> q = normal.ldlt().solve(right);
  Matrix3d form;
  form << q[0], q[5], q[4], q[5], q[1], q[3], q[4], q[3], q[2];
  Eigen::SelfAdjointEigenSolver<Matrix3d> eigen;
  eigen.computeDirect(form);
  const double largest = eigen.eigenvalues()[2];
  if (!(largest > 0)) return std::nullopt;
  // A direction in which the quadric opens becomes a long axis.
  const Vector3d curvatures = eigen.eigenvalues().cwiseMax(0.04 * largest);
  Matrix3d axes = eigen.eigenvectors();
  if (axes.determinant() < 0) axes.col(0) *= -1;
  const Vector3d gradient = axes.transpose() * q.segment<3>(6);
  const Vector3d centre = -gradient.cwiseQuotient(curvatures);
  const double level = curvatures.dot(centre.cwiseAbs2()) - q[9];
  if (!(level > 0)) return std::nullopt;
  const Vector3d semi_axes = (level * curvatures.cwiseInverse()).cwiseSqrt();
  const Natural n{mean + axes * centre, axes, {semi_axes[0], semi_axes[1], semi_axes[2]}};
  return usable(n) && semi_axes.minCoeff() > 1e-9 ? std::optional(n) : std::nullopt;
}

}  // namespace darboux::fit
