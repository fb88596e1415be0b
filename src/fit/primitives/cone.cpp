#include <numbers>

#include <darboux/cone.h>

#include "any_surface/compiled_models.h"
#include "base/linear_algebra.h"
#include "distance_model.h"
#include "geometry.h"
#include "list.h"
#include "round_about_axes.h"

DARBOUX_COMPILED_MODEL(darboux::Cone<>)

namespace darboux::fit {
namespace {

// rho, kappa, alpha: the axis leaves (0, 0, rho + 1/kappa) in direction (cos alpha, 0, sin alpha), the cone
// opens along it for alpha > 0. d = -zeta + cos(alpha) f, f = (|(kappa y, m)| - m) / kappa, m = cos(alpha) +
// kappa (x sin(alpha) - zeta cos(alpha)). The generatrix continues beyond the apex. Exact at kappa = 0 too.
class ConeModel {
 public:
  static constexpr int parameters = 3;
  explicit ConeModel(const double* s)
      : rho_(s[0]), kappa_(s[1]), sine_(std::sin(s[2])), cosine_(std::cos(s[2])) {}
  double distance(const Vector3d& p) const {
    const Parts r = parts(p);
    return -r.zeta + cosine_ * r.f;
  }
  void at(const Vector3d& p, LocalDistance<parameters>& out) const {
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
    out.metric_ratio = foot > 0 ? r.root / foot : -1;
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

// lengths: the half-angle in radians; the centre is the apex, the axis leads into the opening.
// All tangent planes n . (x - p) = 0 meet in the apex; the normals lie in a plane n . a = const across the
// axis.
std::optional<GeometricParameters> start(const OrientedPoints& sample) {
  Matrix3d normal = Matrix3d::Zero();
  Vector3d right = Vector3d::Zero();
  for (Eigen::Index i = 0; i < sample.points.cols(); ++i) {
    const Vector3d n = sample.normals.col(i);
    normal += n * n.transpose();
    right += n.dot(sample.points.col(i)) * n;
  }
  const Vector3d apex = solve_symmetric(normal, right);
  Eigen::Matrix3Xd directions = sample.points.colwise() - apex;
  directions.colwise().normalize();
  if (!directions.allFinite()) return std::nullopt;
  const Vector3d mean = directions.rowwise().mean();
  const Eigen::Matrix3Xd spread = directions.colwise() - mean;
  Vector3d axis = least_direction(spread * spread.transpose());
  if (axis.dot(mean) < 0) axis = -axis;
  const double angle = std::acos(std::clamp(axis.dot(mean), -1.0, 1.0));
  if (!(angle > 0.01 && angle < 1.55)) return std::nullopt;
  return checked_start({apex, axes_with_z(axis), {angle}});
}

std::vector<GeometricParameters> starts_by_equation(const Eigen::Matrix3Xd& sample) {
  std::vector<GeometricParameters> result;
  for (const RoundAboutAxis& r : round_about_axes(sample, true)) {
    const double angle = std::atan(std::fabs(r.slope));
    if (!(angle > 0.01 && angle < 1.55)) continue;
    const Vector3d apex = r.centre - r.radius / r.slope * r.axis;
    const auto start = checked_start({apex, axes_with_z(r.slope > 0 ? r.axis : Vector3d(-r.axis)), {angle}});
    if (start) result.push_back(*start);
  }
  return result;
}

LocalModel localise(const GeometricParameters& n, const Vector3d& at) {
  const double sine = std::sin(n.lengths[0]), cosine = std::cos(n.lengths[0]);
  const Vector3d a = n.axes.col(2), e = radial(n, at);
  const Vector3d generatrix = cosine * a + sine * e, outward = cosine * e - sine * a;
  const double along = std::fmax((at - n.centre).dot(generatrix), 1e-3 * (at - n.centre).norm());
  LocalModel m = local_frame(n.centre + along * generatrix, generatrix, -outward);
  m.s = {0, cosine / (along * sine), n.lengths[0]};
  return m;
}

GeometricParameters geometric(const LocalModel& m) {
  // A descent may add half turns to it, which do not change the cone.
  const double angle = std::remainder(m.s[2], std::numbers::pi);
  const double kappa = std::fabs(m.s[1]), alpha = m.s[1] < 0 ? -angle : angle;
  const double sine = std::sin(alpha), side = m.s[1] < 0 ? -1 : 1;
  const Vector3d axis(std::cos(alpha), 0, side * sine);
  const Vector3d apex = Vector3d(0, 0, m.s[0] + side / kappa) - axis / (kappa * sine);
  return {m.origin + m.rotation * apex,
          axes_with_z(m.rotation * Vector3d(alpha < 0 ? -axis : axis)),
          {std::fabs(alpha)}};
}

GeometricParameters support_frame(const GeometricParameters& n, const Vector3d& mean, const Matrix3d&) {
  return axis_frame(n, mean);
}

SupportCoordinates coordinates(const GeometricParameters& n, const Vector3d& p) {
  const double across = std::hypot(p.x(), p.y());
  const double along = across * std::sin(n.lengths[0]) + p.z() * std::cos(n.lengths[0]);
  return {std::atan2(p.y(), p.x()), along, std::fabs(along)};
}

// The catalogue's axis leads from the base to the apex.
CatalogueSurface to_catalogue(const GeometricParameters& n, double scale, const ExtentAlong& extent) {
  const double height = extent(n.axes.col(2)).high, tangent = std::tan(n.lengths[0]);
  Eigen::MatrixXd by = Eigen::MatrixXd::Zero(2, 3);
  by(0, 0) = scale * height * (1 + tangent * tangent);
  return {Cone{scale * height * tangent, scale * height}, conventional_frame(-n.axes.col(2)),
          n.centre + height * n.axes.col(2), by};
}

GeometricParameters from_catalogue(const GeometricParameters& placed) {
  return {placed.centre + placed.lengths[1] * placed.axes.col(2),
          axes_with_z(-placed.axes.col(2)),
          {std::atan2(placed.lengths[0], placed.lengths[1])}};
}

std::optional<Vec2<double>> foot(const AnySurface& surface, const Vec3<double>& p) {
  const auto* s = surface.get<Cone<>>();
  if (!s) return std::nullopt;
  const double length = std::hypot(s->radius, s->height), across = s->radius / length,
               along = s->height / length;
  const double v = ((s->radius - std::hypot(p.x, p.y)) * across + p.z * along) / length;
  return Vec2<double>{turns(p.y, p.x), std::fmin(v, 1)};
}

std::string_view at_limit(const GeometricParameters& n, double deviation) {
  const double angle = n.lengths[0], from_plane = std::numbers::pi / 2 - angle;
  if (angle < 1e-3 || deviation > angle) return "indistinguishable from a cylinder";
  if (from_plane < 1e-3 || deviation > from_plane) return "indistinguishable from a plane";
  return {};
}

}  // namespace

constinit const Primitive cone_primitive{
    .name = Cone<>::info.name,
    .unknowns = 6,
    .sample_size = 3,
    .distance = distance_functions<ConeModel>,
    .second_parameter_is_curvature = true,
    .radius_about_axis = true,
    .has_apex = true,
    .length_names = {"half-angle"},
    .start = start,
    .starts_by_equation = starts_by_equation,
    .localise = localise,
    .geometric = geometric,
    .support = {support_frame, coordinates, 2 * std::numbers::pi, 0},
    .to_catalogue = to_catalogue,
    .from_catalogue = from_catalogue,
    .foot = foot,
    .at_limit = at_limit,
};

}  // namespace darboux::fit
