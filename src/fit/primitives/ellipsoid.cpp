#include <algorithm>
#include <cmath>
#include <numbers>

#include <darboux/ellipsoid.h>

#include "any_surface/compiled_models.h"
#include "base/linear_algebra.h"
#include "distance_model.h"
#include "geometry.h"
#include "list.h"

DARBOUX_COMPILED_MODEL(darboux::Ellipsoid<>)

namespace darboux::fit {
namespace {

// Parameters: centre and logarithms of the semi-axes, in the frame of the axes. No point of the surface is a
// natural origin. The foot is a_i^2 q_i / (a_i^2 + t), t the largest root of S = sum (a_i q_i / (a_i^2 +
// t))^2 = 1 [Eberly2013]. 1 / sqrt(S) is nearly linear in t, exactly so for a sphere: Chebyshev's method on
// it takes two steps.
class EllipsoidModel {
 public:
  static constexpr int parameters = 6;
  // Axes within a factor of a thousand of the cloud's size.
  static bool in_range(const double* s) {
    return std::all_of(s + 3, s + 6, [](double x) { return std::fabs(x) < 7; });
  }
  explicit EllipsoidModel(const double* s)
      : centre_(s[0], s[1], s[2]),
        axes_(std::exp(s[3]), std::exp(s[4]), std::exp(s[5])),
        square_(axes_.cwiseAbs2()),
        inverse_(square_.cwiseInverse()),
        least_(square_.minCoeff()) {}
  double distance(const Vector3d& p) const {
    const Parts r = parts(p);
    return r.t * r.length;
  }
  // Correct to first order near the surface, in a tenth of the time.
  double rough_distance(const Vector3d& p) const {
    const Vector3d u = (p - centre_).cwiseQuotient(axes_);
    const double length = u.norm();
    return (length - 1) * length / std::max(u.cwiseQuotient(axes_).norm(), 1e-150);
  }
  void at(const Vector3d& p, LocalDistance<parameters>& out) const {
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
    out.metric_ratio = 1 + std::min(r.t, 0.0) / least_;  // at the ends of the longest axis, less elsewhere
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
      // The error left is of third order near the root, of second elsewhere.
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

// lengths: the semi-axes, along the axes. The least-squares quadric whose value at the points is 0 and whose
// gradient there is the normal. Normals are turned away from the centre of the sphere through the points.
Eigen::Matrix<double, 10, 1> linear_quadric(const OrientedPoints& sample, const Vector3d& mean,
                                            const Sphere3& sphere) {
  Eigen::Matrix<double, 10, 10> normal = Eigen::Matrix<double, 10, 10>::Zero();
  Eigen::Matrix<double, 10, 1> right = Eigen::Matrix<double, 10, 1>::Zero();
  for (Eigen::Index i = 0; i < sample.points.cols(); ++i) {
    const Vector3d p = sample.points.col(i) - mean;
    Vector3d n = sample.normals.col(i);
    if (n.dot(sample.points.col(i) - sphere.centre) < 0) n = -n;
    // Q = sum of the unknowns times x^2, y^2, z^2, 2yz, 2xz, 2xy, 2x, 2y, 2z, 1
    Eigen::Matrix<double, 4, 10> rows;
    rows << p.x() * p.x(), p.y() * p.y(), p.z() * p.z(), 2 * p.y() * p.z(), 2 * p.x() * p.z(),
        2 * p.x() * p.y(), 2 * p.x(), 2 * p.y(), 2 * p.z(), 1,  //
        2 * p.x(), 0, 0, 0, 2 * p.z(), 2 * p.y(), 2, 0, 0, 0,   //
        0, 2 * p.y(), 0, 2 * p.z(), 0, 2 * p.x(), 0, 2, 0, 0,   //
        0, 0, 2 * p.z(), 2 * p.y(), 2 * p.x(), 0, 0, 0, 2, 0;
    rows.row(0) *= 3 / sphere.radius;
    normal += rows.transpose() * rows;
    right += rows.bottomRows<3>().transpose() * n;
  }
  return solve_symmetric(normal, right);
}

std::optional<GeometricParameters> start(const OrientedPoints& sample) {
  const auto sphere = linear_sphere(sample.points);
  if (!sphere || !sphere->centre.allFinite()) return std::nullopt;
  const Vector3d mean = sample.points.rowwise().mean();
  const Eigen::Matrix<double, 10, 1> q = linear_quadric(sample, mean, *sphere);
  Matrix3d form;
  form << q[0], q[5], q[4], q[5], q[1], q[3], q[4], q[3], q[2];
  const auto [values, vectors] = closed_form_symmetric_eigen(form);
  const double largest = values[2];
  if (!(largest > 0)) return std::nullopt;
  // A direction in which the quadric is open becomes a long axis.
  const Vector3d curvatures = values.cwiseMax(0.04 * largest);
  Matrix3d axes = vectors;
  if (axes.determinant() < 0) axes.col(0) *= -1;
  const Vector3d gradient = axes.transpose() * q.segment<3>(6);
  const Vector3d centre = -gradient.cwiseQuotient(curvatures);
  const double level = curvatures.dot(centre.cwiseAbs2()) - q[9];
  if (!(level > 0)) return std::nullopt;
  const Vector3d semi_axes = (level * curvatures.cwiseInverse()).cwiseSqrt();
  if (!(semi_axes.minCoeff() > 1e-9)) return std::nullopt;
  return checked_start({mean + axes * centre, axes, {semi_axes[0], semi_axes[1], semi_axes[2]}});
}

LocalModel localise(const GeometricParameters& n, const Vector3d&) {
  LocalModel m;
  m.origin = n.centre;
  m.rotation = Eigen::Quaterniond(n.axes).normalized();
  m.s = {0, 0, 0, std::log(n.lengths[0]), std::log(n.lengths[1]), std::log(n.lengths[2])};
  return m;
}

GeometricParameters geometric(const LocalModel& m) {
  return {m.origin + m.rotation * Vector3d(m.s[0], m.s[1], m.s[2]),
          m.rotation.toRotationMatrix(),
          {std::exp(m.s[3]), std::exp(m.s[4]), std::exp(m.s[5])}};
}

GeometricParameters support_frame(const GeometricParameters& n, const Vector3d&, const Matrix3d&) {
  return n;
}

SupportCoordinates coordinates(const GeometricParameters& n, const Vector3d& p) {
  const Vector3d a(n.lengths[0], n.lengths[1], n.lengths[2]), unit = p.cwiseQuotient(a).normalized();
  return {std::atan2(unit.y(), unit.x()), unit.z(), unit.cwiseQuotient(a).norm()};
}

// Longest semi-axis first.
CatalogueSurface to_catalogue(const GeometricParameters& n, double scale, const ExtentAlong&) {
  std::array<int, 3> order{0, 1, 2};
  const auto length = [&](int k) { return n.lengths[static_cast<std::size_t>(k)]; };
  std::sort(order.begin(), order.end(), [&](int a, int b) { return length(a) > length(b); });
  Matrix3d frame;
  frame.col(0) = positive_side(n.axes.col(order[0]));
  frame.col(2) = positive_side(n.axes.col(order[2]));
  frame.col(1) = frame.col(2).cross(frame.col(0));
  Eigen::MatrixXd by = Eigen::MatrixXd::Zero(3, 3);
  for (int k = 0; k < 3; ++k) by(k, order[static_cast<std::size_t>(k)]) = scale;
  return {Ellipsoid{scale * length(order[0]), scale * length(order[1]), scale * length(order[2])}, frame,
          n.centre, by};
}

// The foot is x_i = e_i² p_i / (e_i² + t) with t the largest root of
// F(t) = Σ (e_i p_i / (e_i² + t))² - 1, convex and falling there: Newton's steps from the left end of its
// interval never pass it.
Vec2<double> foot_on(const Ellipsoid<>& s, const Vec3<double>& p) {
  const double size = std::max({s.semi_axis_x, s.semi_axis_y, s.semi_axis_z});
  const std::array<double, 3> e{s.semi_axis_x / size, s.semi_axis_y / size, s.semi_axis_z / size};
  const std::array<double, 3> y{p.x / size, p.y / size, p.z / size};
  const auto least = static_cast<std::size_t>(std::min_element(e.begin(), e.end()) - e.begin());
  // shift = t + the square of the least semi-axis. Near the plane of the other two axes it is far smaller
  // than t.
  const auto over = [&](std::size_t i, double shift) {
    return (e[i] - e[least]) * (e[i] + e[least]) + shift;
  };
  const auto term = [&](std::size_t i, double shift) { return y[i] == 0 ? 0 : e[i] * y[i] / over(i, shift); };
  std::array<double, 3> q;  // the foot, over the semi-axes
  double beside = 0;
  for (std::size_t i = 0; i < 3; ++i)
    if (i != least) beside += term(i, 0) * term(i, 0);
  if (y[least] == 0 && beside <= 1) {
    // In the plane of the two greater axes, within the focal ellipse, there are two feet: either one is
    // taken.
    for (std::size_t i = 0; i < 3; ++i) q[i] = term(i, 0);
    q[least] = std::sqrt(1 - beside);
  } else {
    double root = e[least] * std::fabs(y[least]);
    for (int step = 0; step < 100; ++step) {
      double f = -1, slope = 0;
      for (std::size_t i = 0; i < 3; ++i) {
        const double x = term(i, root);
        f += x * x;
        if (x != 0) slope -= 2 * x * x / over(i, root);
      }
      const double next = root - f / slope;
      if (!(next > root)) break;
      root = next;
    }
    for (std::size_t i = 0; i < 3; ++i) q[i] = term(i, root);
  }
  return {turns(q[1], q[0]), std::atan2(std::hypot(q[0], q[1]), -q[2]) / std::numbers::pi};
}

std::optional<Vec2<double>> foot(const AnySurface& surface, const Vec3<double>& p) {
  const auto* s = surface.get<Ellipsoid<>>();
  return s ? std::optional(foot_on(*s, p)) : std::nullopt;
}

}  // namespace

constinit const Primitive ellipsoid_primitive{
    .name = Ellipsoid<>::info.name,
    .unknowns = 9,
    .sample_size = 10,
    .distance = distance_functions<EllipsoidModel>,
    .orientation = Orientation::frame,
    .lengths = 3,
    .length_names = {"semi-axis", "semi-axis", "semi-axis"},
    .start = start,
    .localise = localise,
    .geometric = geometric,
    .support = {support_frame, coordinates, 2 * std::numbers::pi, 2},
    .to_catalogue = to_catalogue,
    .from_catalogue = [](const GeometricParameters& n) { return n; },
    .foot = foot,
};

}  // namespace darboux::fit
