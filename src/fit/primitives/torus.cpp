#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <random>
#include <vector>

#include <darboux/torus.h>

#include "any_surface/compiled_models.h"
#include "base/evenly_chosen.h"
#include "base/linear_algebra.h"
#include "base/quantile.h"
#include "distance_model.h"
#include "geometry.h"
#include "list.h"
#include "osculation.h"

DARBOUX_COMPILED_MODEL(darboux::Torus<>)

namespace darboux::fit {
namespace {

// rho, kappa = 1/r, R, alpha: the tube's centre C = (0, 0, rho + 1/kappa), the axis passes through C + R e, e
// = (-sin alpha, 0, cos alpha), in direction a = (cos alpha, 0, sin alpha). For R < r the inner side (the
// lemon) belongs to the surface too.
class TorusModel {
 public:
  static constexpr int parameters = 4;
  static bool in_range(const double* s) { return s[1] > 1e-9 && s[2] >= 0; }
  explicit TorusModel(const double* s)
      : centre_(s[0] + 1 / s[1]),
        kappa_(s[1]),
        major_(s[2]),
        sine_(std::sin(s[3])),
        cosine_(std::cos(s[3])) {}
  double distance(const Vector3d& p) const { return parts(p).tube - 1 / kappa_; }
  void at(const Vector3d& p, LocalDistance<parameters>& out) const {
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
    out.metric_ratio = std::min(r.tube * kappa_, foot > 0 ? r.from_axis / foot : r.side < 0 ? 1 : -1);
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

// lengths: major and minor radius. First the axis is found, then a circle in the half-plane.
std::optional<GeometricParameters> start(const OrientedPoints& sample) {
  const AxisOfRevolution axis = linear_axis(sample);
  const auto circle = linear_circle(half_plane(sample, axis));
  if (!circle) return std::nullopt;
  return checked_start({axis.point + circle->centre.y() * axis.direction,
                        axes_with_z(axis.direction),
                        {std::fmax(circle->centre.x(), 0), circle->radius}});
}

// The Darboux cyclide |x|^4 + |x|^2 b x + x Q x + c x + d = 0 that fits best. A torus about o is one: b = -4
// o, and about o the quadratic part is 4 R^2 a a - 2 (R^2 + r^2).
std::vector<GeometricParameters> starts_by_equation(const Eigen::Matrix3Xd& sample) {
  constexpr Eigen::Index coefficients = 14;
  if (sample.cols() < coefficients) return {};
  const Vector3d mean = sample.rowwise().mean();
  const Eigen::Matrix3Xd centred = sample.colwise() - mean;
  const double size = std::sqrt(centred.squaredNorm() / static_cast<double>(sample.cols()));
  if (!(size > 0)) return {};
  Eigen::MatrixXd sums = Eigen::MatrixXd::Zero(coefficients, coefficients);
  for (const auto& p : centred.colwise()) {
    const Vector3d x = p / size;
    const double square = x.squaredNorm();
    Eigen::Matrix<double, coefficients, 1> terms;
    terms << square * square, square * x, x.cwiseAbs2(), x.y() * x.z(), x.z() * x.x(), x.x() * x.y(), x, 1;
    sums += terms * terms.transpose();
  }
  const Eigen::VectorXd cyclide = symmetric_eigen(sums).vectors.col(0);
  const double quartic = cyclide[0];
  if (!(std::fabs(quartic) > 1e-6)) return {};  // a quadric
  const Vector3d centre = -cyclide.segment<3>(1) / (4 * quartic),
                 mixed = cyclide.segment<3>(7) / (2 * quartic);
  Matrix3d quadratic = (cyclide.segment<3>(4) / quartic).asDiagonal();
  quadratic(1, 2) = quadratic(2, 1) = mixed.x();
  quadratic(2, 0) = quadratic(0, 2) = mixed.y();
  quadratic(0, 1) = quadratic(1, 0) = mixed.z();
  quadratic -= 2 * centre.squaredNorm() * Matrix3d::Identity() + 4 * centre * centre.transpose();
  const auto [values, vectors] = symmetric_eigen(quadratic);
  const double across = 0.5 * (values[0] + values[1]);
  const double major = 0.25 * (values[2] - across), minor = -0.5 * across - major;  // squared
  if (!(minor > 0)) return {};
  const auto start = checked_start({mean + size * centre,
                                    axes_with_z(vectors.col(2)),
                                    {size * std::sqrt(major), size * std::sqrt(minor)}});
  return start ? std::vector{*start} : std::vector<GeometricParameters>{};
}

// The circle through three points.
std::optional<Circle3> circle_through(const Vector3d& a, const Vector3d& b, const Vector3d& c) {
  const Vector3d u = b - a, v = c - a, normal = u.cross(v);
  const double square = normal.squaredNorm();
  if (!(square > 1e-12 * u.squaredNorm() * v.squaredNorm())) return std::nullopt;
  const Vector3d from_a =
      (u.squaredNorm() * v.cross(normal) + v.squaredNorm() * normal.cross(u)) / (2 * square);
  return Circle3{a + from_a, normal / std::sqrt(square), from_a.norm(), 0};
}

// How many points lie in a tube about a circle, from their sorted distances: the likeliest k of n maximises k
// log(k / volume of the tube) + (n - k) log((n - k) / remaining volume). The three points through which the
// circle was made do not count.
std::size_t count_in_tube(const std::vector<double>& sorted, double circle_radius, double volume) {
  double best = 0;
  std::size_t count = 0;
  constexpr std::size_t laid_through = 3, least = 10;
  const double n = static_cast<double>(sorted.size()) - laid_through;
  for (std::size_t i = std::max(sorted.size() / 10, least); i + 1 < sorted.size(); ++i) {
    const double k = static_cast<double>(i + 1 - laid_through), minor = sorted[i],
                 tube = 2 * std::numbers::pi * std::numbers::pi * circle_radius * minor * minor;
    if (!(tube < 0.9 * volume)) break;
    const double value = k * std::log(k / tube) + (n - k) * std::log((n - k) / (volume - tube));
    if (count == 0 || value > best) best = value, count = i + 1;
  }
  return count;
}

// Circles with many points nearby: first through three points, then for a few rounds the circle through the
// points in the likeliest tube about the last one. The tube's radius is the median of their distances from
// the last circle but one.
std::vector<GeometricParameters> starts_among_outliers(const Eigen::Matrix3Xd& all_points,
                                                       std::mt19937_64& random) {
  constexpr int circles = 60, rounds = 4;
  constexpr Eigen::Index enough = 200;
  const Eigen::Matrix3Xd points = all_points(Eigen::all, evenly_chosen(all_points.cols(), enough, random));
  // From a ball with nine tenths of the points: some may be far.
  const Vector3d mean = points.rowwise().mean();
  std::vector<double> from_mean;
  for (const auto& p : points.colwise()) from_mean.push_back((p - mean).norm());
  const double volume = 4 * std::numbers::pi / 3 * std::pow(quantile(from_mean, 0.9), 3);
  const auto any = [&] {
    return Vector3d(
        points.col(static_cast<Eigen::Index>(random() % static_cast<std::uint64_t>(points.cols()))));
  };
  std::vector<GeometricParameters> result;
  std::vector<double> weights(static_cast<std::size_t>(points.cols())), sorted;
  for (int k = 0; k < circles; ++k) {
    const Vector3d a = any(), b = any(), c = any();
    std::optional<Circle3> circle = circle_through(a, b, c);
    double minor = 0;
    for (int round = 0; circle && round < rounds; ++round) {
      const Eigen::Matrix3Xd q = points.colwise() - circle->centre;
      const Eigen::ArrayXd height = (circle->axis.transpose() * q).transpose().array();
      const Eigen::ArrayXd from_axis =
          (q.colwise().squaredNorm().transpose().array() - height.square()).max(0).sqrt();
      const Eigen::ArrayXd distance = ((from_axis - circle->radius).square() + height.square()).sqrt();
      sorted.assign(distance.begin(), distance.end());
      std::sort(sorted.begin(), sorted.end());
      const std::size_t count = count_in_tube(sorted, circle->radius, volume);
      circle.reset();
      if (count == 0) break;
      minor = sorted[count / 2];
      const double within = 1.2 * sorted[count - 1];
      std::transform(distance.begin(), distance.end(), weights.begin(),
                     [&](double d) { return d <= within ? 1. : 0.; });
      circle = algebraic_circle(points, weights);
    }
    if (!circle || !(minor > 0)) continue;
    if (const auto torus =
            checked_start({circle->centre, axes_with_z(circle->axis), {circle->radius, minor}}))
      result.push_back(*torus);
  }
  return result;
}

std::array<double, 2> sheets(const GeometricParameters& n, const Vector3d& p) {
  const Vector3d a = n.axes.col(2), q = p - n.centre;
  const double h = q.dot(a), from_axis = (q - h * a).norm();
  const auto distance = [&](double to_circle) { return std::fabs(std::hypot(to_circle, h) - n.lengths[1]); };
  const auto [near, far] =
      std::minmax({distance(from_axis - n.lengths[0]), distance(from_axis + n.lengths[0])});
  return {near, far};
}

LocalModel localise(const GeometricParameters& n, const Vector3d& at) {
  const Vector3d a = n.axes.col(2), q = at - n.centre;
  Vector3d e = radial(n, at);
  const auto tube_distance = [&](const Vector3d& side) {
    return std::fabs((q - n.lengths[0] * side).norm() - n.lengths[1]);
  };
  if (n.lengths[0] < n.lengths[1] && tube_distance(-e) < tube_distance(e)) e = -e;
  const Vector3d from_circle = q - n.lengths[0] * e;
  const Vector3d outward = from_circle.norm() > 0 ? Vector3d(from_circle.normalized()) : e;
  const double radial_part = outward.dot(e), axial = outward.dot(a);
  LocalModel m = local_frame(n.centre + n.lengths[0] * e + n.lengths[1] * outward,
                             radial_part * a - axial * e, -outward);
  m.s = {0, 1 / n.lengths[1], n.lengths[0], std::atan2(-axial, radial_part)};
  return m;
}

GeometricParameters geometric(const LocalModel& m) {
  const double sine = std::sin(m.s[3]), cosine = std::cos(m.s[3]);
  const Vector3d centre = Vector3d(0, 0, m.s[0] + 1 / m.s[1]) + m.s[2] * Vector3d(-sine, 0, cosine);
  return {m.origin + m.rotation * centre,
          axes_with_z(m.rotation * Vector3d(cosine, 0, sine)),
          {m.s[2], 1 / m.s[1]}};
}

// Tori that a small patch or a thin strip may belong to. A patch: tori with these principal curvatures. One
// of them is that of the tube, 1 / r. The other is cos(phi) / (R + r cos(phi)) at the angle phi of the tube,
// which gives phi for any R, and R for phi on either equator. A strip: tori about the axis of its circle,
// with this normal.
std::vector<GeometricParameters> osculating(const Osculation& o) {
  std::vector<GeometricParameters> result;
  const auto add = [&](const Vector3d& outward, const Vector3d& across, double phi, double major,
                       double minor) {
    const Vector3d e = std::cos(phi) * outward - std::sin(phi) * across,
                   axis = std::sin(phi) * outward + std::cos(phi) * across;
    if (auto torus = checked_start({o.at - minor * outward - major * e, axes_with_z(axis), {major, minor}}))
      result.push_back(*torus);
  };
  for (const int tube : {0, 1}) {
    const double by_minor = o.curvatures[static_cast<std::size_t>(tube)];
    const double minor = 1 / std::fabs(by_minor);
    const Vector3d along_tube = o.frame.col(tube), outward = (by_minor > 0 ? -1 : 1) * o.frame.col(2);
    const double other = o.curvatures[static_cast<std::size_t>(1 - tube)] * (by_minor > 0 ? 1 : -1);
    if (!(minor < 1e3)) continue;
    add(outward, along_tube, 0 < other && other * minor <= 1 ? 0 : std::numbers::pi,
        std::fabs(1 / other - minor), minor);
    for (const double ratio : {1.2, 2., 3.5, 6., 12., 25.}) {
      const double major = ratio * minor, cosine = major * other / (1 - minor * other);
      if (!(std::fabs(cosine) <= 1)) continue;
      for (const double side : {-1., 1.}) add(outward, along_tube, side * std::acos(cosine), major, minor);
    }
  }
  if (!o.is_strip()) return result;
  const Vector3d axis = o.circle.axis, from_axis = o.at - o.circle.centre;
  const Vector3d across_axis = from_axis - axis.dot(from_axis) * axis;
  const double radius = across_axis.norm();
  for (const double side : {-1., 1.}) {
    const Vector3d outward = side * o.frame.col(2), e = across_axis / radius;
    const double phi = std::atan2(outward.dot(axis), outward.dot(e));
    const Vector3d across = std::cos(phi) * axis - std::sin(phi) * e;
    for (const double ratio : {0.15, 0.35, 0.8})
      add(outward, (across - across.dot(outward) * outward).normalized(), phi,
          radius * (1 - ratio * std::cos(phi)), ratio * radius);
  }
  return result;
}

GeometricParameters support_frame(const GeometricParameters& n, const Vector3d& mean, const Matrix3d&) {
  return axis_frame(n, mean);
}

SupportCoordinates coordinates(const GeometricParameters& n, const Vector3d& p) {
  const double tube = std::atan2(p.z(), std::hypot(p.x(), p.y()) - n.lengths[0]);
  return {std::atan2(p.y(), p.x()), tube, std::fabs(n.lengths[0] + n.lengths[1] * std::cos(tube))};
}

CatalogueSurface to_catalogue(const GeometricParameters& n, double scale, const ExtentAlong&) {
  Eigen::MatrixXd by = Eigen::MatrixXd::Zero(2, 3);
  by(0, 0) = by(1, 1) = scale;
  return {Torus{scale * n.lengths[0], scale * n.lengths[1]}, conventional_frame(positive_side(n.axes.col(2))),
          n.centre, by};
}

std::optional<Vec2<double>> foot(const AnySurface& surface, const Vec3<double>& p) {
  const auto* s = surface.get<Torus<>>();
  if (!s) return std::nullopt;
  const double rho = std::hypot(p.x, p.y);
  const double near = std::hypot(rho - s->major_radius, p.z) - s->minor_radius,
               far = std::hypot(rho + s->major_radius, p.z) - s->minor_radius;
  // The inner part of a spindle torus, of the tube's far side.
  if (std::fabs(far) < std::fabs(near))
    return Vec2<double>{turns(-p.y, -p.x), turns(p.z, -rho - s->major_radius)};
  return Vec2<double>{turns(p.y, p.x), turns(p.z, rho - s->major_radius)};
}

}  // namespace

constinit const Primitive torus_primitive{
    .name = Torus<>::info.name,
    .unknowns = 7,
    .sample_size = 5,
    .distance = distance_functions<TorusModel>,
    .second_parameter_is_curvature = true,
    .radius_about_axis = true,
    .lengths = 2,
    .length_names = {"major radius", "minor radius"},
    .start = start,
    .starts_by_equation = starts_by_equation,
    .starts_among_outliers = starts_among_outliers,
    .localise = localise,
    .geometric = geometric,
    .support = {support_frame, coordinates, 2 * std::numbers::pi, 2 * std::numbers::pi},
    .to_catalogue = to_catalogue,
    .from_catalogue = [](const GeometricParameters& n) { return n; },
    .foot = foot,
    .osculating = osculating,
    .crosses_itself = [](const GeometricParameters& n) { return n.lengths[0] < n.lengths[1]; },
    .sheets = sheets,
};

}  // namespace darboux::fit
