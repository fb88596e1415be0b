// DistanceFunctions of a class with the formula of a primitive's distance. Templates: for the primitives' own
// files only.
#pragma once

#include <array>
#include <concepts>

#include "primitive.h"

namespace darboux::fit {

// Distance of one point from a surface, and derivatives. The distance is positive on the outer side.
template <int S>
struct LocalDistance {
  double d;                  // signed orthogonal distance
  Vector3d gradient;         // of d with respect to the point: the unit normal at its foot
  std::array<double, S> by;  // derivatives of d with respect to the model's parameters
  double curvature;          // k1 + k2 at the foot, positive where the side d < 0 is convex
  // The least of 1 + k1 d and 1 + k2 d: 0 where the point lies on a focal surface, an axis or at an apex, and
  // its foot jumps.
  double metric_ratio;
};

// A surface with given parameters s in local coordinates. Optional: static bool in_range(const double* s);
// double rough_distance(p), for starts.
template <class M>
concept DistanceModel = std::constructible_from<M, const double*> && M::parameters >= 1 &&
                        M::parameters <= static_cast<int>(LocalModel::most_parameters) &&
                        requires(const M& model, const Vector3d& p, LocalDistance<M::parameters>& local) {
  { model.distance(p) } -> std::same_as<double>;
  model.at(p, local);
};

namespace detail {

template <int S>
void set_state(PointStates& states, std::size_t i, const LocalDistance<S>& local) {
  states.d[i] = local.d;
  states.curvature[i] = local.curvature;
  states.regular[i] = local.metric_ratio > 0.2;
}

template <DistanceModel M>
bool in_range(const double* s) {
  if constexpr (requires { M::in_range(s); })
    return M::in_range(s);
  else
    return true;
}

template <DistanceModel M>
void rough_distances(const Eigen::Matrix3Xd& cloud, const LocalModel& model, std::vector<double>& to) {
  to.resize(static_cast<std::size_t>(cloud.cols()));
  const Matrix3d to_local = model.rotation.conjugate().toRotationMatrix();
  const M surface(model.s.data());
  for (Eigen::Index i = 0; i < cloud.cols(); ++i) {
    const Vector3d p = to_local * (cloud.col(i) - model.origin);
    if constexpr (requires { surface.rough_distance(p); })
      to[static_cast<std::size_t>(i)] = surface.rough_distance(p);
    else
      to[static_cast<std::size_t>(i)] = surface.distance(p);
  }
}

template <DistanceModel M>
void measure(const Eigen::Matrix3Xd& cloud, const LocalModel& model, PointStates& states) {
  const Matrix3d to_local = model.rotation.conjugate().toRotationMatrix();
  const M surface(model.s.data());
  LocalDistance<M::parameters> local;
  for (std::size_t i = 0; i < states.d.size(); ++i) {
    surface.at(to_local * (cloud.col(static_cast<Eigen::Index>(i)) - model.origin), local);
    set_state(states, i, local);
  }
}

template <DistanceModel M>
void foot_points(const Eigen::Matrix3Xd& cloud, const LocalModel& model, Eigen::Matrix3Xd& to) {
  const Matrix3d to_local = model.rotation.conjugate().toRotationMatrix();
  const M surface(model.s.data());
  LocalDistance<M::parameters> local;
  to.resize(3, cloud.cols());
  for (Eigen::Index i = 0; i < cloud.cols(); ++i) {
    const Vector3d p = to_local * (cloud.col(i) - model.origin);
    surface.at(p, local);
    to.col(i) = p - local.d * local.gradient;
  }
}

// How a small turn of the frame, and the parameters, change the distance. A turn by r moves the local point
// by p x r.
template <int S>
Eigen::Matrix<double, 1, 3 + S> derivatives(const LocalDistance<S>& local, const Vector3d& p) {
  Eigen::Matrix<double, 1, 3 + S> row;
  row.template head<3>() = local.gradient.cross(p).transpose();
  for (int k = 0; k < S; ++k) row[3 + k] = local.by[static_cast<std::size_t>(k)];
  return row;
}

template <DistanceModel M>
void jacobian(const Eigen::Matrix3Xd& cloud, const LocalModel& model, Eigen::MatrixXd& to) {
  const Matrix3d to_local = model.rotation.conjugate().toRotationMatrix();
  const M surface(model.s.data());
  LocalDistance<M::parameters> local;
  to.resize(cloud.cols(), 3 + M::parameters);
  for (Eigen::Index i = 0; i < cloud.cols(); ++i) {
    const Vector3d p = to_local * (cloud.col(i) - model.origin);
    surface.at(p, local);
    to.row(i) = derivatives(local, p);
  }
}

template <DistanceModel M>
void accumulate(const Eigen::Matrix3Xd& cloud, const LocalModel& model, const Weighting& weighting,
                PointStates& states, NormalEquations& sums) {
  constexpr int S = M::parameters, N = 3 + S;
  constexpr int block = 64;  // points at a time, so that sums run over vectors
  const Matrix3d to_local = model.rotation.conjugate().toRotationMatrix();
  const M surface(model.s.data());
  LocalDistance<S> local;
  Eigen::Matrix<double, N, N> hessian = Eigen::Matrix<double, N, N>::Zero();
  Eigen::Matrix<double, N, 1> gradient = Eigen::Matrix<double, N, 1>::Zero();
  double squares = 0;
  Eigen::Matrix<double, block, N> rows;
  Eigen::Matrix<double, block, 1> slopes, curvatures;
  int filled = 0;
  const auto add = [&] {
    rows.bottomRows(block - filled).setZero();
    slopes.tail(block - filled).setZero();
    curvatures.tail(block - filled).setZero();
    for (int k = 0; k < N; ++k) {
      const Eigen::Matrix<double, block, 1> scaled = curvatures.cwiseProduct(rows.col(k));
      for (int l = k; l < N; ++l) hessian(l, k) += scaled.dot(rows.col(l));
      gradient[k] += slopes.dot(rows.col(k));
    }
    filled = 0;
  };
  for (std::size_t i = 0; i < states.d.size(); ++i) {
    const Vector3d p = to_local * (cloud.col(static_cast<Eigen::Index>(i)) - model.origin);
    surface.at(p, local);
    set_state(states, i, local);
    double w, curvature;
    const double e = states.error(i);
    if (weighting.phase == Phase::robust) {
      w = curvature = weighting.weights[i];
    } else {
      const double r = e / weighting.mixture.sigma;
      if (!states.in_support[i]) continue;
      w = inlier_probability(e, weighting.mixture);
      curvature = weighting.convex ? w : w - w * (1 - w) * r * r;
    }
    if (w < 1e-12) continue;
    squares += w * e * e;
    slopes[filled] = w * e;
    curvatures[filled] = curvature;
    rows.row(filled) = derivatives(local, p);
    if (++filled == block) add();
  }
  add();
  hessian.template triangularView<Eigen::StrictlyUpper>() = hessian.transpose();
  sums.hessian = hessian;
  sums.gradient = gradient;
  sums.squares = squares;
}

}  // namespace detail

template <DistanceModel M>
inline constexpr DistanceFunctions distance_functions{
    M::parameters,          detail::in_range<M>, detail::rough_distances<M>, detail::measure<M>,
    detail::foot_points<M>, detail::jacobian<M>, detail::accumulate<M>};

}  // namespace darboux::fit
