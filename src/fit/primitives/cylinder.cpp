#include <numbers>

#include <darboux/cylinder.h>

#include "any_surface/compiled_models.h"
#include "geometry.h"
#include "list.h"
#include "round_about_axes.h"
#include "sphere_model.h"

DARBOUX_COMPILED_MODEL(darboux::Cylinder<>)

namespace darboux::fit {
namespace {

// The model of the sphere, perpendicular to the axis, which is parallel to x.
class CylinderModel {
 public:
  static constexpr int parameters = 2;
  explicit CylinderModel(const double* s) : across_(s), kappa_(s[1]) {}
  double distance(const Vector3d& p) const { return across_.distance({0, p.y(), p.z()}); }
  void at(const Vector3d& p, LocalDistance<parameters>& out) const {
    across_.at({0, p.y(), p.z()}, out);
    out.curvature = kappa_;
  }

 private:
  SphereModel across_;
  double kappa_;
};

// The circle whose centre is where the two normals meet, seen along the axis.
std::optional<Circle2> through_two(const Eigen::Matrix2Xd& points, const Eigen::Matrix2Xd& normals) {
  Eigen::Matrix2d m;
  m << normals.col(0), -normals.col(1);
  if (std::fabs(m.determinant()) < 1e-3) return std::nullopt;
  const Eigen::Vector2d t = m.inverse() * (points.col(1) - points.col(0));
  return Circle2{points.col(0) + t[0] * normals.col(0), t.cwiseAbs().mean()};
}

std::optional<GeometricParameters> start(const OrientedPoints& sample) {
  const Matrix3d axes = axes_with_z(least_direction(sample.normals * sample.normals.transpose()));
  const auto across = axes.leftCols<2>().transpose();
  const Eigen::Matrix2Xd points = across * sample.points;
  const auto circle =
      points.cols() == 2 ? through_two(points, across * sample.normals) : linear_circle(points);
  if (!circle) return std::nullopt;
  const double along = axes.col(2).dot(sample.points.col(0));
  return checked_start(
      {axes * Vector3d(circle->centre.x(), circle->centre.y(), along), axes, {circle->radius}});
}

std::vector<GeometricParameters> starts_by_equation(const Eigen::Matrix3Xd& sample) {
  std::vector<GeometricParameters> result;
  for (const RoundAboutAxis& r : round_about_axes(sample, false))
    if (const auto start = checked_start({r.centre, axes_with_z(r.axis), {r.radius}}))
      result.push_back(*start);
  return result;
}

LocalModel localise(const GeometricParameters& n, const Vector3d& at) {
  const Vector3d a = n.axes.col(2), outward = radial(n, at);
  LocalModel m = local_frame(n.centre + (at - n.centre).dot(a) * a + n.lengths[0] * outward, a, -outward);
  m.s = {0, 1 / n.lengths[0]};
  return m;
}

GeometricParameters geometric(const LocalModel& m) {
  return {m.origin + m.rotation * Vector3d(0, 0, m.s[0] + 1 / m.s[1]),
          axes_with_z(m.rotation * Vector3d::UnitX()),
          {1 / std::fabs(m.s[1])}};
}

GeometricParameters support_frame(const GeometricParameters& n, const Vector3d& mean, const Matrix3d&) {
  GeometricParameters frame = axis_frame(n, mean);
  frame.centre = n.centre + (mean - n.centre).dot(n.axes.col(2)) * n.axes.col(2);
  return frame;
}

SupportCoordinates coordinates(const GeometricParameters&, const Vector3d& p) {
  return {std::atan2(p.y(), p.x()), p.z(), 1};
}

CatalogueSurface to_catalogue(const GeometricParameters& n, double scale, const ExtentAlong& extent) {
  const Matrix3d frame = conventional_frame(positive_side(n.axes.col(2)));
  const Extent z = extent(frame.col(2));
  Eigen::MatrixXd by = Eigen::MatrixXd::Zero(2, 3);
  by(0, 0) = scale;
  return {Cylinder{scale * n.lengths[0], scale * (z.high - z.low)}, frame, n.centre + z.low * frame.col(2),
          by};
}

std::optional<Vec2<double>> foot(const AnySurface& surface, const Vec3<double>& p) {
  const auto* s = surface.get<Cylinder<>>();
  if (!s) return std::nullopt;
  return Vec2<double>{turns(p.y, p.x), p.z / s->height};
}

}  // namespace

constinit const Primitive cylinder_primitive{
    .name = Cylinder<>::info.name,
    .unknowns = 5,
    .sample_size = 2,
    .distance = distance_functions<CylinderModel>,
    .second_parameter_is_curvature = true,
    .slides_along_axis = true,
    .lengths = 1,
    .length_names = {"radius"},
    .start = start,
    .starts_by_equation = starts_by_equation,
    .localise = localise,
    .geometric = geometric,
    .support = {support_frame, coordinates, 2 * std::numbers::pi, 0},
    .to_catalogue = to_catalogue,
    .from_catalogue = [](const GeometricParameters& n) { return n; },
    .foot = foot,
};

}  // namespace darboux::fit
