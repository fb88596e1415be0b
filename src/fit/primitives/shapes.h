// The kinds of surface that are found from points alone, each in local coordinates at one of its own points:
// that point is (0, 0, rho) with z along the inward normal and x along a principal direction. Curvatures, not
// radii, are the parameters, so that a sphere may pass through the plane into the sphere of the other side
// [Lukacs1998]. The formulas of the first four stay exact at kappa = 0. An object of a shape is one with
// given parameters s. Signed distance is positive on the side z < rho.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>

#include <Eigen/Core>

namespace darboux::fit {

using Eigen::Vector3d;

// What a shape says of one point.
template <int S>
struct Local {
  double d;                  // signed orthogonal distance
  Vector3d gradient;         // of d by the point: the unit normal at its foot
  std::array<double, S> by;  // derivatives of d by the shape's parameters
  double curvature;          // k1 + k2 at the foot, positive where the side d < 0 is convex
  // The least of 1 + k1 d and 1 + k2 d: 0 where the point lies on a focal surface, an axis or at an apex, and
  // its foot jumps.
  double stretch;
};

class PlaneShape {
 public:
  static constexpr std::string_view name = "plane";
  static constexpr int size = 1, freedom = 3;  // own parameters: rho; all observable ones with the pose
  static constexpr bool curved = false;        // whether the second parameter is a curvature
  explicit PlaneShape(const double* s) : rho_(s[0]) {}
  double distance(const Vector3d& p) const { return rho_ - p.z(); }
  void at(const Vector3d& p, Local<size>& out) const { out = {distance(p), {0, 0, -1}, {1}, 0, 1}; }

 private:
  double rho_;
};

// rho, kappa: d = |p - c| - 1/kappa for c = (0, 0, rho + 1/kappa), as Q / (1 + sqrt(1 + kappa Q)),
// Q = kappa |q|^2 - 2 q_z, q = p - (0, 0, rho).
class SphereShape {
 public:
  static constexpr std::string_view name = "sphere";
  static constexpr int size = 2, freedom = 4;
  static constexpr bool curved = true;
  explicit SphereShape(const double* s) : rho_(s[0]), kappa_(s[1]) {}
  double distance(const Vector3d& p) const {
    const double zeta = p.z() - rho_;
    const double q = kappa_ * (p.x() * p.x() + p.y() * p.y() + zeta * zeta) - 2 * zeta;
    return q / (1 + std::sqrt(std::max(0.0, 1 + kappa_ * q)));
  }
  void at(const Vector3d& p, Local<size>& out) const {
    const double zeta = p.z() - rho_;
    const double square = p.x() * p.x() + p.y() * p.y() + zeta * zeta, q = kappa_ * square - 2 * zeta;
    const double root = std::max(std::sqrt(std::max(0.0, 1 + kappa_ * q)), 1e-150);
    out.d = q / (1 + root);
    out.gradient = Vector3d(kappa_ * p.x(), kappa_ * p.y(), kappa_ * zeta - 1) / root;
    out.by = {-out.gradient.z(), (square + zeta * out.d) / ((1 + root) * root)};
    out.curvature = 2 * kappa_;
    out.stretch = root;
  }

 private:
  double rho_, kappa_;
};

// The same across the axis, which is parallel to x.
class CylinderShape {
 public:
  static constexpr std::string_view name = "cylinder";
  static constexpr int size = 2, freedom = 5;
  static constexpr bool curved = true;
  explicit CylinderShape(const double* s) : across_(s), kappa_(s[1]) {}
  double distance(const Vector3d& p) const { return across_.distance({0, p.y(), p.z()}); }
  void at(const Vector3d& p, Local<size>& out) const {
    across_.at({0, p.y(), p.z()}, out);
    out.curvature = kappa_;
  }

 private:
  SphereShape across_;
  double kappa_;
};

// rho, kappa, alpha: the axis leaves (0, 0, rho + 1/kappa) in direction (cos alpha, 0, sin alpha), the cone
// opens along it for alpha > 0. d = -zeta + cos(alpha) f, f = (|(kappa y, m)| - m) / kappa, m = cos(alpha) +
// kappa (x sin(alpha) - zeta cos(alpha)). Beyond the apex the generatrix goes on.
class ConeShape {
 public:
  static constexpr std::string_view name = "cone";
  static constexpr int size = 3, freedom = 6;
  static constexpr bool curved = true;
  explicit ConeShape(const double* s)
      : rho_(s[0]), kappa_(s[1]), sine_(std::sin(s[2])), cosine_(std::cos(s[2])) {}
  double distance(const Vector3d& p) const {
    const Parts r = parts(p);
    return -r.zeta + cosine_ * r.f;
  }
  void at(const Vector3d& p, Local<size>& out) const {
    const Parts r = parts(p);
    const double c = cosine_, along = r.m / r.root - 1;
    out.d = -r.zeta + c * r.f;
    out.gradient = {c * along * sine_, c * kappa_ * p.y() / r.root, -1 - c * c * along};
    const double w = p.x() * c + r.zeta * sine_;
    out.by = {-out.gradient.z(), c * c * r.y_part / r.root,
              r.f * (-sine_ + c / r.root * (sine_ - kappa_ * w))};
    const double foot =
        r.root - kappa_ * out.d * c;  // kappa times its distance from the axis, negative on the other nappe
    out.curvature = c * kappa_ / std::max(foot, 1e-6);
    out.stretch = foot > 0 ? r.root / foot : -1;
  }

 private:
  struct Parts {
    double zeta, m, root, y_part, f;  // y_part: y^2 / (root + m)
  };
  Parts parts(const Vector3d& p) const {
    Parts r;
    r.zeta = p.z() - rho_;
    r.m = cosine_ + kappa_ * (p.x() * sine_ - r.zeta * cosine_);
    r.root = std::max(std::sqrt(kappa_ * p.y() * kappa_ * p.y() + r.m * r.m), 1e-150);
    r.y_part = r.m > 0 ? p.y() * p.y() / (r.root + r.m) : (r.root - r.m) / (kappa_ * kappa_);
    r.f = kappa_ * r.y_part;
    return r;
  }
  double rho_, kappa_, sine_, cosine_;
};

// rho, kappa = 1/r, R, alpha: the tube's centre C = (0, 0, rho + 1/kappa), the axis passes through C + R e, e
// = (-sin alpha, 0, cos alpha), in direction a = (cos alpha, 0, sin alpha). For R < r the inner side (the
// lemon) belongs to the surface too.
class TorusShape {
 public:
  static constexpr std::string_view name = "torus";
  static constexpr int size = 4, freedom = 7;
  static constexpr bool curved = true;
  static bool permitted(const double* s) { return s[1] > 1e-9 && s[2] >= 0; }
  explicit TorusShape(const double* s)
      : centre_(s[0] + 1 / s[1]),
        kappa_(s[1]),
        major_(s[2]),
        sine_(std::sin(s[3])),
        cosine_(std::cos(s[3])) {}
  double distance(const Vector3d& p) const { return parts(p).tube - 1 / kappa_; }
  void at(const Vector3d& p, Local<size>& out) const {
    const Parts r = parts(p);
    const double radial = r.to_circle / r.tube, axial = r.h / r.tube;  // of the normal
    const double along_u = radial * r.u / r.from_axis;
    out.d = r.tube - 1 / kappa_;
    out.gradient = {axial * cosine_ - along_u * sine_, radial * p.y() / r.from_axis,
                    axial * sine_ + along_u * cosine_};
    out.by = {-out.gradient.z(), (1 + out.gradient.z()) / (kappa_ * kappa_),
              radial * (-r.u / r.from_axis - r.side), axial * (r.u + major_) - along_u * r.h};
    const double foot = r.from_axis - out.d * radial;
    out.curvature = kappa_ + radial / std::copysign(std::max(std::fabs(foot), 1e-6), foot);
    out.stretch = std::min(r.tube * kappa_, foot > 0 ? r.from_axis / foot : r.side < 0 ? 1 : -1);
  }

 private:
  struct Parts {
    double h, u, from_axis, to_circle, tube;  // tube: distance from the circle of the tube's centres
    double side;                              // 1; -1 where the far side of the circle is nearer
  };
  Parts parts(const Vector3d& p) const {
    Parts r;
    const double z = p.z() - centre_;
    r.h = p.x() * cosine_ + z * sine_;
    r.u = z * cosine_ - p.x() * sine_ - major_;
    r.from_axis = std::max(std::sqrt(r.u * r.u + p.y() * p.y()), 1e-150);
    r.side = 1;
    r.to_circle = r.from_axis - major_;
    r.tube = std::sqrt(r.to_circle * r.to_circle + r.h * r.h);
    if (major_ * kappa_ < 1) {
      const double far_to_circle = r.from_axis + major_;
      const double far_tube = std::sqrt(far_to_circle * far_to_circle + r.h * r.h);
      if (std::fabs(far_tube * kappa_ - 1) < std::fabs(r.tube * kappa_ - 1))
        r.side = -1, r.to_circle = far_to_circle, r.tube = far_tube;
    }
    r.tube = std::max(r.tube, 1e-150);
    return r;
  }
  double centre_, kappa_, major_, sine_, cosine_;
};

// Centre and logarithms of the semi-axes, in the frame of the axes: no point of the surface is special enough
// to start from. The foot is a_i^2 q_i / (a_i^2 + t), t the largest root of S = sum (a_i q_i / (a_i^2 + t))^2
// = 1 [Eberly2013]. 1 / sqrt(S) is nearly linear in t, exactly so for a sphere: Chebyshev's method on it
// takes two steps.
class EllipsoidShape {
 public:
  static constexpr std::string_view name = "ellipsoid";
  static constexpr int size = 6, freedom = 9;
  static constexpr bool curved = false;
  // Axes within a factor of a thousand of the cloud's size.
  static bool permitted(const double* s) {
    return std::all_of(s + 3, s + 6, [](double x) { return std::fabs(x) < 7; });
  }
  explicit EllipsoidShape(const double* s)
      : centre_(s[0], s[1], s[2]),
        axes_(std::exp(s[3]), std::exp(s[4]), std::exp(s[5])),
        square_(axes_.cwiseAbs2()),
        inverse_(square_.cwiseInverse()),
        least_(square_.minCoeff()) {}
  double distance(const Vector3d& p) const {
    const Parts r = parts(p);
    return r.t * r.length;
  }
  // To first order near the surface, for a tenth of the time.
  double rough_distance(const Vector3d& p) const {
    const Vector3d u = (p - centre_).cwiseQuotient(axes_);
    const double length = u.norm();
    return (length - 1) * length / std::max(u.cwiseQuotient(axes_).norm(), 1e-150);
  }
  void at(const Vector3d& p, Local<size>& out) const {
    const Parts r = parts(p);
    const Vector3d n = r.over / r.length;
    out.d = r.t * r.length;
    out.gradient = n;
    for (int k = 0; k < 3; ++k) {
      const auto i = static_cast<std::size_t>(k);
      out.by[i] = -n[k];
      out.by[3 + i] = -n[k] * r.over[k] * square_[k];
    }
    out.curvature = (inverse_.sum() - n.cwiseAbs2().dot(inverse_)) / r.length;
    out.stretch = 1 + std::min(r.t, 0.0) / least_;  // at the ends of the longest axis, less elsewhere
  }

 private:
  struct Parts {
    Vector3d over;     // foot_i / a_i^2
    double t, length;  // |over|: the distance is t times it
  };
  Parts parts(const Vector3d& p) const {
    Parts r;
    const Vector3d q = p - centre_, aq = axes_.cwiseProduct(q);
    // One term alone is 1 here, so the root is not below.
    const double low = (aq.cwiseAbs() - square_).maxCoeff();
    r.t = std::max(0.0, low);
    Vector3d inverse = r.t > 0 ? inverses(r.t) : inverse_;
    for (int k = 0; k < 30; ++k) {
      const Vector3d terms = aq.cwiseProduct(inverse).cwiseAbs2(), slopes = terms.cwiseProduct(inverse);
      const double sum = terms.sum(), slope = slopes.sum(), bend = slopes.dot(inverse);  // S, -S'/2, S''/6
      if (!(slope > 0)) break;
      const double over = 1 / slope, newton = sum * (std::sqrt(sum) - 1) * over, before = r.t;
      const double bent = 1.5 * (slope / sum - bend * over) * newton;  // f'' / 2f' times the step
      const bool near = std::fabs(bent) < 0.1;
      r.t = std::max(r.t + (near ? newton - bent * newton : newton), low);
      inverse = inverses(r.t);
      // What is left is of third order near the root, of second elsewhere.
      if (std::fabs(r.t - before) <= (near ? 1e-6 : 1e-9) * (std::fabs(r.t) + least_)) break;
    }
    r.over = q.cwiseProduct(inverse);
    r.length = std::max(r.over.norm(), 1e-150);
    return r;
  }
  // 1 / (a_i^2 + t), with one division.
  Vector3d inverses(double t) const {
    const Vector3d x = (square_.array() + t).max(1e-100);
    const double xy = x[0] * x[1], over = 1 / (xy * x[2]);
    return {x[1] * x[2] * over, x[0] * x[2] * over, xy * over};
  }
  Vector3d centre_, axes_, square_, inverse_;
  double least_;
};

}  // namespace darboux::fit
