#include <numbers>

#include <darboux/sphere.h>

#include "any_surface/compiled_models.h"
#include "geometry.h"
#include "list.h"
#include "sphere_model.h"

DARBOUX_COMPILED_MODEL(darboux::Sphere<>)

namespace darboux::fit {
namespace {

std::optional<GeometricParameters> start(const OrientedPoints& sample) {
  const auto found = linear_sphere(sample.points);
  if (!found) return std::nullopt;
  return checked_start({found->centre, Matrix3d::Identity(), {found->radius}});
}

LocalModel localise(const GeometricParameters& n, const Vector3d& at) {
  const Vector3d q = at - n.centre,
                 outward = q.norm() > 0 ? Vector3d(q.normalized()) : Vector3d(n.axes.col(2));
  const Matrix3d r = axes_with_z(-outward);
  LocalModel m = local_frame(n.centre + n.lengths[0] * outward, r.col(0), r.col(2));
  m.s = {0, 1 / n.lengths[0]};
  return m;
}

GeometricParameters geometric(const LocalModel& m) {
  return {m.origin + m.rotation * Vector3d(0, 0, m.s[0] + 1 / m.s[1]),
          m.rotation.toRotationMatrix(),
          {1 / std::fabs(m.s[1])}};
}

GeometricParameters support_frame(const GeometricParameters& n, const Vector3d& mean,
                                  const Matrix3d& scatter) {
  return scatter_frame(n, (mean - n.centre).normalized(), scatter);
}

SupportCoordinates coordinates(const GeometricParameters&, const Vector3d& p) {
  return {std::atan2(p.y(), p.x()), p.z() / p.norm(), 1};
}

CatalogueSurface to_catalogue(const GeometricParameters& n, double scale, const ExtentAlong&) {
  Eigen::MatrixXd by = Eigen::MatrixXd::Zero(1, 3);
  by(0, 0) = scale;
  return {Sphere{scale * n.lengths[0]}, Matrix3d::Identity(), n.centre, by};
}

std::optional<Vec2<double>> foot(const AnySurface& surface, const Vec3<double>& p) {
  if (!surface.get<Sphere<>>()) return std::nullopt;
  return Vec2<double>{turns(p.y, p.x), std::atan2(std::hypot(p.x, p.y), -p.z) / std::numbers::pi};
}

}  // namespace

constinit const Primitive sphere_primitive{
    .name = Sphere<>::info.name,
    .unknowns = 4,
    .sample_size = 4,
    .distance = distance_functions<SphereModel>,
    .second_parameter_is_curvature = true,
    .orientation = Orientation::none,
    .lengths = 1,
    .length_names = {"radius"},
    .start = start,
    .localise = localise,
    .geometric = geometric,
    .support = {support_frame, coordinates, 2 * std::numbers::pi, 2},
    .to_catalogue = to_catalogue,
    .from_catalogue = [](const GeometricParameters& n) { return n; },
    .foot = foot,
};

}  // namespace darboux::fit
