// The kinds of surface that are found from points alone, each in local coordinates at one of its own points: that point is
// (0, 0, rho) with z along the inward normal and x along a principal direction. Curvatures, not radii, are the parameters,
// so that a sphere may pass through the plane into the sphere of the other side [Lukacs1998]. All formulas stay exact at
// kappa = 0. Signed distance is positive on the side z < rho.
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
  // The least of 1 + k1 d and 1 + k2 d: 0 where the point lies on a focal surface, an axis or at an apex, and its foot jumps.
  double stretch;
};

struct PlaneShape {
  static constexpr std::string_view name = "plane";
  static constexpr int size = 1, freedom = 3;  // own parameters: rho; all observable ones with the pose
  static constexpr bool spins = true;          // turning about z changes nothing
  static double distance(const double* s, const Vector3d& p) { return s[0] - p.z(); }
  static void at(const double* s, const Vector3d& p, Local<size>& out) {
    out = {distance(s, p), {0, 0, -1}, {1}, 0, 1};
  }
};

// rho, kappa: d = (|p - c| - 1/kappa) for c = (0, 0, rho + 1/kappa), as Q / (1 + sqrt(1 + kappa Q)),
// Q = kappa |q|^2 - 2 q_z, q = p - (0, 0, rho).
struct SphereShape {
  static constexpr std::string_view name = "sphere";
  static constexpr int size = 2, freedom = 4;
  static constexpr bool spins = true;
  static double distance(const double* s, const Vector3d& p) {
    const double zeta = p.z() - s[0];
    const double q = s[1] * (p.x() * p.x() + p.y() * p.y() + zeta * zeta) - 2 * zeta;
    return q / (1 + std::sqrt(std::max(0.0, 1 + s[1] * q)));
  }
  static void at(const double* s, const Vector3d& p, Local<size>& out) {
    const double kappa = s[1], zeta = p.z() - s[0];
    const double square = p.x() * p.x() + p.y() * p.y() + zeta * zeta, q = kappa * square - 2 * zeta;
    const double root = std::max(std::sqrt(std::max(0.0, 1 + kappa * q)), 1e-150);
    out.d = q / (1 + root);
    out.gradient = Vector3d(kappa * p.x(), kappa * p.y(), kappa * zeta - 1) / root;
    out.by = {-out.gradient.z(), (square + zeta * out.d) / ((1 + root) * root)};
    out.curvature = 2 * kappa;
    out.stretch = root;
  }
};

// The same across the axis, which is parallel to x.
struct CylinderShape {
  static constexpr std::string_view name = "cylinder";
  static constexpr int size = 2, freedom = 5;
  static constexpr bool spins = false;
  static double distance(const double* s, const Vector3d& p) {
    return SphereShape::distance(s, {0, p.y(), p.z()});
  }
  static void at(const double* s, const Vector3d& p, Local<size>& out) {
    SphereShape::at(s, {0, p.y(), p.z()}, out);
    out.curvature = s[1];
  }
};

// rho, kappa, alpha: the axis leaves (0, 0, rho + 1/kappa) in direction (cos alpha, 0, sin alpha), the cone opens along it for
// alpha > 0. d = -zeta + cos(alpha) f, f = (|(kappa y, m)| - m) / kappa, m = cos(alpha) + kappa (x sin(alpha) - zeta cos(alpha)).
// Beyond the apex the generatrix goes on.
struct ConeShape {
  static constexpr std::string_view name = "cone";
  static constexpr int size = 3, freedom = 6;
  static constexpr bool spins = false;
  struct Parts {
    double sine, cosine, zeta, m, root, f, y_part;  // y_part: y^2 / (root + m)
  };
  static Parts parts(const double* s, const Vector3d& p) {
    Parts r;
    r.sine = std::sin(s[2]), r.cosine = std::cos(s[2]);
    r.zeta = p.z() - s[0];
    r.m = r.cosine + s[1] * (p.x() * r.sine - r.zeta * r.cosine);
    r.root = std::max(std::sqrt(s[1] * p.y() * s[1] * p.y() + r.m * r.m), 1e-150);
    r.y_part = r.m > 0 ? p.y() * p.y() / (r.root + r.m) : (r.root - r.m) / (s[1] * s[1]);
    r.f = s[1] * r.y_part;
    return r;
  }
  static double distance(const double* s, const Vector3d& p) {
    const Parts r = parts(s, p);
    return -r.zeta + r.cosine * r.f;
  }
  static void at(const double* s, const Vector3d& p, Local<size>& out) {
    const Parts r = parts(s, p);
    const double c = r.cosine, along = r.m / r.root - 1;
    out.d = -r.zeta + c * r.f;
    out.gradient = {c * along * r.sine, c * s[1] * p.y() / r.root, -1 - c * c * along};
    const double w = p.x() * c + r.zeta * r.sine;
    out.by = {-out.gradient.z(), c * c * r.y_part / r.root,
              r.f * (-r.sine + c / r.root * (r.sine - s[1] * w))};
    const double foot =
        r.root -
        s[1] * out.d * c;  // times 1 / kappa: its distance from the axis, negative on the other nappe
    out.curvature = c * s[1] / std::max(foot, 1e-6);
    out.stretch = foot > 0 ? r.root / foot : -1;
  }
};

// rho, kappa = 1/r, R, alpha: the tube's centre C = (0, 0, rho + 1/kappa), the axis passes through C + R e, e = (-sin alpha, 0,
// cos alpha), in direction a = (cos alpha, 0, sin alpha). For R < r the inner side (the lemon) belongs to the surface too.
struct TorusShape {
  static constexpr std::string_view name = "torus";
  static constexpr int size = 4, freedom = 7;
  static constexpr bool spins = false;
  struct Parts {
    double sine, cosine, h, u, from_axis, to_circle, tube;  // tube: distance from the tube's centre circle
    double side;  // 1; -1 where the far side of the circle is nearer
  };
  static Parts parts(const double* s, const Vector3d& p) {
    Parts r;
    r.sine = std::sin(s[3]), r.cosine = std::cos(s[3]);
    const double z = p.z() - s[0] - 1 / s[1];
    r.h = p.x() * r.cosine + z * r.sine;
    r.u = z * r.cosine - p.x() * r.sine - s[2];
    r.from_axis = std::max(std::sqrt(r.u * r.u + p.y() * p.y()), 1e-150);
    r.side = 1;
    r.to_circle = r.from_axis - s[2];
    r.tube = std::sqrt(r.to_circle * r.to_circle + r.h * r.h);
    if (s[2] * s[1] < 1) {
      const double far_to_circle = r.from_axis + s[2];
      const double far_tube = std::sqrt(far_to_circle * far_to_circle + r.h * r.h);
      if (std::fabs(far_tube * s[1] - 1) < std::fabs(r.tube * s[1] - 1))
        r.side = -1, r.to_circle = far_to_circle, r.tube = far_tube;
    }
    r.tube = std::max(r.tube, 1e-150);
    return r;
  }
  static double distance(const double* s, const Vector3d& p) { return parts(s, p).tube - 1 / s[1]; }
  static void at(const double* s, const Vector3d& p, Local<size>& out) {
    const Parts r = parts(s, p);
    const double radial = r.to_circle / r.tube, axial = r.h / r.tube;  // of the normal
    const double along_u = radial * r.u / r.from_axis;
    out.d = r.tube - 1 / s[1];
    out.gradient = {axial * r.cosine - along_u * r.sine, radial * p.y() / r.from_axis,
                    axial * r.sine + along_u * r.cosine};
    out.by = {-out.gradient.z(), (1 + out.gradient.z()) / (s[1] * s[1]),
              radial * (-r.u / r.from_axis - r.side), axial * (r.u + s[2]) - along_u * r.h};
    const double foot = r.from_axis - out.d * radial;
    out.curvature = s[1] + radial / std::copysign(std::max(std::fabs(foot), 1e-6), foot);
    out.stretch = std::min(r.tube * s[1], foot > 0 ? r.from_axis / foot : r.side < 0 ? 1 : -1);
  }
  static bool permitted(const double* s) { return s[1] > 1e-9 && s[2] >= 0; }
};

// Centre and logarithms of the semi-axes, in the frame of the axes: no point of the surface is special enough to start from.
// The foot is a_i^2 q_i / (a_i^2 + t), t the largest root of S = sum (a_i q_i / (a_i^2 + t))^2 = 1 [Eberly2013]. 1 / sqrt(S) is nearly
// linear in t, exactly so for a sphere: Newton's method on it takes two or three steps.
struct EllipsoidShape {
  static constexpr std::string_view name = "ellipsoid";
  static constexpr int size = 6, freedom = 9;
  static constexpr bool spins = false;
  struct Parts {
    Vector3d square, over;  // squared semi-axes; foot_i / a_i^2
    double t, length;       // |over|: the distance is t times it
  };
  static Parts parts(const double* s, const Vector3d& p) {
    Parts r;
    const Vector3d q = p - Eigen::Map<const Vector3d>(s);
    const Vector3d a = Eigen::Map<const Eigen::Array3d>(s + 3).exp().matrix();
    r.square = a.cwiseProduct(a);
    const Vector3d aq = a.cwiseProduct(q);
    // One term alone is 1 here, so the root is not below.
    const double low = (aq.cwiseAbs() - r.square).maxCoeff();
    r.t = std::max(0.0, low);
    for (int k = 0; k < 30; ++k) {
      const Vector3d inverse = (r.square.array() + r.t).max(1e-300).inverse(),
                     terms = aq.cwiseProduct(inverse).cwiseAbs2();
      const double sum = terms.sum(), half_slope = terms.dot(inverse);
      if (!(half_slope > 0)) break;
      const double before = r.t;
      r.t = std::max(r.t + sum * (std::sqrt(sum) - 1) / half_slope, low);
      if (std::fabs(r.t - before) <= 4e-16 * (std::fabs(r.t) + r.square.minCoeff())) break;
    }
    r.over = q.cwiseQuotient((r.square.array() + r.t).max(1e-300).matrix());
    r.length = std::max(r.over.norm(), 1e-150);
    return r;
  }
  static double distance(const double* s, const Vector3d& p) {
    const Parts r = parts(s, p);
    return r.t * r.length;
  }
  static void at(const double* s, const Vector3d& p, Local<size>& out) {
    const Parts r = parts(s, p);
    const Vector3d n = r.over / r.length;
    out.d = r.t * r.length;
    out.gradient = n;
    for (int k = 0; k < 3; ++k) {
      out.by[k] = -n[k];
      out.by[3 + k] = -n[k] * r.over[k] * r.square[k];
    }
    const Vector3d a = r.square.cwiseInverse();
    out.curvature = (a.sum() - n.cwiseAbs2().dot(a)) / r.length;
    out.stretch =
        1 + std::min(r.t, 0.0) / r.square.minCoeff();  // at the ends of the longest axis, less elsewhere
  }
};

}  // namespace darboux::fit
