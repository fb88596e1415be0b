/// \file frames.h
/// Frames at the texels of a triangle, as computed by shaders.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>

#include <Eigen/Eigenvalues>

#include <darboux/vector.h>

#include "coverage.h"

namespace darboux::normal_map {

/// t, b and n as columns; neither unit nor orthogonal.
struct Columns {
  Vec3<double> t, b, n;
};

/// M x
inline Vec3<double> times(const Columns& m, const Vec3<double>& x) {
  return x.x * m.t + x.y * m.b + x.z * m.n;
}

/// M⁻¹ d times |det M|; NaN or zero if M is singular.
inline Vec3<double> inverse_times(const Columns& m, const Vec3<double>& d) {
  const Vec3<double> across = cross(m.b, m.n);
  const double side = dot(m.t, across) < 0 ? -1 : 1;
  return side * Vec3<double>{dot(across, d), dot(cross(m.n, m.t), d), dot(cross(m.t, m.b), d)};
}

/// The attributes of a triangle corner.
struct Corner {
  Vec3<double> t, n;
  double w = 1;  ///< w n × t points up the image
};

/// Along a row: value = at + i step.
struct Along {
  Vec3<double> at{}, step{};
  Vec3<double> operator()(double i) const { return at + i * step; }
};

/// The frame that MikkTSpace requires: t, w n × t, n.
class MikkFrames {
 public:
  /// \param scale of t and b
  MikkFrames(const std::array<Corner, 3>& corners, double scale) : corners_(corners) {
    for (Corner& c : corners_) c.t = scale * c.t;  // b = w n × t follows
  }

  void set_steps(const std::array<double, 3>& steps) {
    t_.step = n_.step = {};
    for (std::size_t k = 0; k < 3; ++k) {
      t_.step += steps[k] * corners_[k].t;
      n_.step += steps[k] * corners_[k].n;
    }
  }
  void start_row(const std::array<double, 3>& weights) {
    t_.at = n_.at = {};
    for (std::size_t k = 0; k < 3; ++k) {
      t_.at += weights[k] * corners_[k].t;
      n_.at += weights[k] * corners_[k].n;
    }
  }
  Columns at(double i) const {
    const Vec3<double> t = t_(i), n = n_(i);
    return {t, corners_[0].w * cross(n, t), n};
  }
  /// The square of the ratio of a frame's extreme singular values. Two singular values are those of (t n),
  /// the third is their product, |n × t|.
  double condition_square(const Columns& m, double) const {
    const double a = dot(m.t, m.t), d = dot(m.n, m.n), g = dot(m.t, m.n), third = dot(m.b, m.b);
    const double largest = (a + d + std::sqrt((a - d) * (a - d) + 4 * g * g)) / 2;
    const double least = third / largest;  // their squares
    return std::max(largest, third) / std::min(least, third);
  }

 private:
  std::array<Corner, 3> corners_;
  Along t_, n_;
};

/// The frame of the Khronos sample viewer: t, n and the corners' w n × t interpolated, each made unit.
class ViewerFrames {
 public:
  /// \param scale of t and b
  ViewerFrames(const std::array<Corner, 3>& corners, double scale) : scale_(scale) {
    for (std::size_t k = 0; k < 3; ++k) {
      const Corner& c = corners[k];
      const Vec3<double> n = c.n / norm(c.n);
      vectors_[k] = {c.t, c.w * cross(n, c.t), n};
    }
  }

  void set_steps(const std::array<double, 3>& steps) {
    for (std::size_t v = 0; v < 3; ++v) {
      along_[v].step = {};
      for (std::size_t k = 0; k < 3; ++k) along_[v].step += steps[k] * vectors_[k][v];
    }
  }
  void start_row(const std::array<double, 3>& weights) {
    for (std::size_t v = 0; v < 3; ++v) {
      along_[v].at = {};
      for (std::size_t k = 0; k < 3; ++k) along_[v].at += weights[k] * vectors_[k][v];
    }
  }
  Columns at(double i) const {
    const auto unit_of = [&](std::size_t v) {
      const Vec3<double> a = along_[v](i);
      return a / std::sqrt(dot(a, a));
    };
    return {scale_ * unit_of(0), scale_ * unit_of(1), unit_of(2)};
  }
  /// The same, infinite where the frame has no inverse; `least` where it is known to be no more than that.
  /// Without a scale the Gram matrix is 1 + D, D without diagonal: eigenvalues of D have the sum 0 and
  /// squares of the sum 2 (tb² + tn² + bn²), so none is beyond k.
  double condition_square(const Columns& m, double least) const {
    const double tb = dot(m.t, m.b), tn = dot(m.t, m.n), bn = dot(m.b, m.n);
    const double k = std::sqrt(4.0 / 3 * (tb * tb + tn * tn + bn * bn));
    if (scale_ == 1 && 1 + k <= least * (1 - k)) return least;
    // The inverse's rows times the determinant are cross products: a scale leaves their digits.
    const Vec3<double> across = cross(m.b, m.n);
    const double determinant = dot(m.t, across);
    const double result = largest_square({m.t, m.b, m.n}) / determinant *
                          (largest_square({across, cross(m.n, m.t), cross(m.t, m.b)}) / determinant);
    return std::isnan(result) ? std::numeric_limits<double>::infinity() : result;
  }

 private:
  // The square of the largest singular value.
  static double largest_square(const Columns& m) {
    const double tb = dot(m.t, m.b), tn = dot(m.t, m.n), bn = dot(m.b, m.n);
    Eigen::Matrix3d gram;
    gram << dot(m.t, m.t), tb, tn, tb, dot(m.b, m.b), bn, tn, bn, dot(m.n, m.n);
    Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver;
    return solver.computeDirect(gram, Eigen::EigenvaluesOnly).eigenvalues()[2];
  }

  std::array<std::array<Vec3<double>, 3>, 3> vectors_;  // of each corner t, b, n
  std::array<Along, 3> along_;
  double scale_;
};

}  // namespace darboux::normal_map
