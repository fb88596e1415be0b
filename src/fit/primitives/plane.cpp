#include <darboux/plane.h>

#include "any_surface/compiled_models.h"
#include "distance_model.h"
#include "geometry.h"
#include "list.h"

DARBOUX_COMPILED_MODEL(darboux::Plane<>)

namespace darboux::fit {
namespace {

// rho.
class PlaneModel {
 public:
  static constexpr int parameters = 1;
  explicit PlaneModel(const double* s) : rho_(s[0]) {}
  double distance(const Vector3d& p) const { return rho_ - p.z(); }
  void at(const Vector3d& p, LocalDistance<parameters>& out) const {
    out = {distance(p), {0, 0, -1}, {1}, 0, 1};
  }

 private:
  double rho_;
};

std::optional<GeometricParameters> start(const OrientedPoints& sample) {
  const Vector3d mean = sample.points.rowwise().mean();
  if (sample.points.cols() < 3) return GeometricParameters{mean, axes_with_z(sample.normals.col(0)), {}};
  const Eigen::Matrix3Xd q = sample.points.colwise() - mean;
  return GeometricParameters{mean, axes_with_z(least_direction(q * q.transpose())), {}};
}

LocalModel localise(const GeometricParameters& n, const Vector3d& at) {
  const Vector3d z = n.axes.col(2);
  return local_frame(at - z.dot(at - n.centre) * z, n.axes.col(0), z);
}

GeometricParameters geometric(const LocalModel& m) {
  const Matrix3d r = m.rotation.toRotationMatrix();
  return {m.origin + m.s[0] * r.col(2), r, {}};
}

GeometricParameters support_frame(const GeometricParameters& n, const Vector3d& mean,
                                  const Matrix3d& scatter) {
  GeometricParameters frame = scatter_frame(n, n.axes.col(2), scatter);
  frame.centre = mean;
  return frame;
}

SupportCoordinates coordinates(const GeometricParameters&, const Vector3d& p) {
  return {p.x(), p.y(), 1};
}

CatalogueSurface to_catalogue(const GeometricParameters& n, double scale, const ExtentAlong& extent) {
  const Matrix3d frame = conventional_frame(positive_side(n.axes.col(2)));
  const Extent x = extent(frame.col(0)), y = extent(frame.col(1));
  const Vector3d origin =
      n.centre + 0.5 * ((x.low + x.high) * frame.col(0) + (y.low + y.high) * frame.col(1));
  return {Plane{scale * (x.high - x.low), scale * (y.high - y.low)}, frame, origin,
          Eigen::MatrixXd::Zero(2, 3)};
}

std::optional<Vec2<double>> foot(const AnySurface& surface, const Vec3<double>& p) {
  const auto* s = surface.get<Plane<>>();
  if (!s) return std::nullopt;
  return Vec2<double>{p.x / s->width + 0.5, p.y / s->depth + 0.5};
}

}  // namespace

constinit const Primitive plane_primitive{
    .name = Plane<>::info.name,
    .unknowns = 3,
    .sample_size = 1,
    .distance = distance_functions<PlaneModel>,
    .is_plane = true,
    .start = start,
    .localise = localise,
    .geometric = geometric,
    .support = {support_frame, coordinates, 0, 0},
    .to_catalogue = to_catalogue,
    .from_catalogue = [](const GeometricParameters& n) { return n; },
    .foot = foot,
};

}  // namespace darboux::fit
