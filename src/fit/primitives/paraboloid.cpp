#include <algorithm>
#include <cmath>
#include <numbers>

#include <darboux/elliptic_paraboloid.h>

#include "any_surface/compiled_models.h"
#include "distance_model.h"
#include "geometry.h"
#include "list.h"

DARBOUX_COMPILED_MODEL(darboux::EllipticParaboloid<>)

namespace darboux::fit {
namespace {

// The paraboloid of revolution z = kappa r^2 / 2: its vertex and the logarithm of kappa, in the frame of its
// axis. With t the slope at the foot of a point, kappa times the foot's distance from the axis,
// t^3 + 2 (1 - kappa z) t = 2 kappa r. The distance is along (t, -1), down and out of the cup.
class ParaboloidModel {
 public:
  static constexpr int parameters = 4;
  // Radii of curvature within a factor of a thousand of the cloud's size.
  static bool in_range(const double* s) { return std::fabs(s[3]) < 7; }
  explicit ParaboloidModel(const double* s) : vertex_(s[0], s[1], s[2]), kappa_(std::exp(s[3])) {}
  double distance(const Vector3d& p) const { return foot(p - vertex_).d; }
  void at(const Vector3d& p, LocalDistance<parameters>& out) const {
    const Vector3d q = p - vertex_;
    const Foot f = foot(q);
    const double across = f.r > 0 ? f.t / (f.r * f.w) : 0;
    const Vector3d n(across * q.x(), across * q.y(), -1 / f.w);
    const double meridian = kappa_ / (f.w * f.w * f.w), parallel = kappa_ / f.w;
    out.d = f.d;
    out.gradient = n;
    // If kappa grows, the surface rises in proportion to the height of the foot.
    out.by = {-n.x(), -n.y(), -n.z(), f.t * f.t / (2 * kappa_ * f.w)};
    out.curvature = meridian + parallel;
    out.metric_ratio = 1 + std::min(parallel * f.d, meridian * f.d);
  }

 private:
  struct Foot {
    double r, t, w, d;  // distance from the axis of the point, slope, sqrt(1 + t^2), signed distance
  };
  Foot foot(const Vector3d& q) const {
    Foot f;
    f.r = std::sqrt(q.x() * q.x() + q.y() * q.y());
    const double linear = 2 * (1 - kappa_ * q.z()), constant = 2 * kappa_ * f.r;
    // Starts above the largest root, which Newton's steps then never pass: the cubic is convex there.
    double t = std::cbrt(constant) + (linear < 0 ? std::sqrt(-linear) : 0);
    if (linear > 0) t = std::min(t, constant / linear);
    for (int k = 0; k < 60 && t > 0; ++k) {
      const double slope = 3 * t * t + linear, next = t - (t * (t * t + linear) - constant) / slope;
      const bool ended = !(next < t - 1e-15 * t);
      t = std::max(next, 0.0);
      if (ended) break;
    }
    f.t = t;
    f.w = std::sqrt(1 + t * t);
    f.d = ((f.r - t / kappa_) * t - (q.z() - t * t / (2 * kappa_))) / f.w;
    return f;
  }
  Vector3d vertex_;
  double kappa_;
};

// lengths: the radius of curvature at the vertex, which is the centre; the axis leads into the cup. First the
// axis is found, then z as a linear function of r^2.
std::optional<GeometricParameters> start(const OrientedPoints& sample) {
  const AxisOfRevolution axis = linear_axis(sample);
  const Eigen::Matrix2Xd points = half_plane(sample, axis);
  const Eigen::VectorXd squares = points.row(0).cwiseAbs2().transpose(), heights = points.row(1).transpose();
  const double mean = squares.mean();
  const Eigen::VectorXd spread = squares.array() - mean;
  const double slope = spread.dot(heights) / spread.squaredNorm();  // kappa / 2
  const double side = slope < 0 ? -1 : 1, vertex = heights.mean() - slope * mean;
  return checked_start({axis.point + vertex * axis.direction,
                        axes_with_z(side * axis.direction),
                        {1 / (2 * std::fabs(slope))}});
}

LocalModel localise(const GeometricParameters& n, const Vector3d&) {
  LocalModel m;
  m.origin = n.centre;
  m.rotation = Eigen::Quaterniond(n.axes).normalized();
  m.s = {0, 0, 0, -std::log(n.lengths[0])};
  return m;
}

GeometricParameters geometric(const LocalModel& m) {
  return {m.origin + m.rotation * Vector3d(m.s[0], m.s[1], m.s[2]),
          m.rotation.toRotationMatrix(),
          {std::exp(-m.s[3])}};
}

GeometricParameters support_frame(const GeometricParameters& n, const Vector3d& mean, const Matrix3d&) {
  return axis_frame(n, mean);
}

// r dr is linear in the second coordinate: a unit of it has the area w.
SupportCoordinates coordinates(const GeometricParameters& n, const Vector3d& p) {
  const double r = std::hypot(p.x(), p.y());
  return {std::atan2(p.y(), p.x()), 0.5 * r * r, std::hypot(1, r / n.lengths[0])};
}

// The rim lies at the height of the highest inlier.
CatalogueSurface to_catalogue(const GeometricParameters& n, double scale, const ExtentAlong& extent) {
  const double height = std::fmax(extent(n.axes.col(2)).high, 1e-3 * n.lengths[0]);
  const double rim = std::sqrt(2 * height * n.lengths[0]);
  Eigen::MatrixXd by = Eigen::MatrixXd::Zero(3, 3);
  by(0, 0) = by(1, 0) = scale * rim / (2 * n.lengths[0]);
  return {EllipticParaboloid{scale * rim, scale * rim, scale * height}, conventional_frame(n.axes.col(2)),
          n.centre, by};
}

// semi_axis_x, semi_axis_y, height
GeometricParameters from_catalogue(const GeometricParameters& placed) {
  const double rim = 0.5 * (placed.lengths[0] + placed.lengths[1]);
  return {placed.centre, placed.axes, {rim * rim / (2 * placed.lengths[2])}};
}

std::optional<Vec2<double>> foot(const AnySurface& surface, const Vec3<double>& p) {
  const auto* s = surface.get<EllipticParaboloid<>>();
  if (!s || s->semi_axis_x != s->semi_axis_y) return std::nullopt;
  const double a = s->semi_axis_x, kappa = 2 * (s->height / a) / a;
  const std::array<double, 4> local{0, 0, 0, std::log(kappa)};
  LocalDistance<4> at;
  ParaboloidModel(local.data()).at({p.x, p.y, p.z}, at);
  const double r = std::hypot(p.x, p.y) - at.d * std::hypot(at.gradient.x(), at.gradient.y());
  return Vec2<double>{turns(p.y, p.x), r / a};
}

}  // namespace

constinit const Primitive paraboloid_primitive{
    .name = EllipticParaboloid<>::info.name,
    .unknowns = 6,
    .sample_size = 5,
    .distance = distance_functions<ParaboloidModel>,
    .only_where_lengths_agree = true,
    .lengths = 1,
    .length_names = {"radius of curvature at the vertex"},
    .start = start,
    .localise = localise,
    .geometric = geometric,
    .support = {support_frame, coordinates, 2 * std::numbers::pi, 0, true},
    .to_catalogue = to_catalogue,
    .from_catalogue = from_catalogue,
    .foot = foot,
};

}  // namespace darboux::fit
