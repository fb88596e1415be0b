#include "synthetic_points.h"

#include <algorithm>
#include <array>
#include <limits>
#include <numbers>

#include <ceres/jet.h>

namespace darboux {

double parameter_of(const AnySurface& surface, std::string_view name) {
  for (const ParameterValue& p : surface.parameters())
    if (p.name == name) return p.value;
  return std::numeric_limits<double>::quiet_NaN();
}

namespace {

struct Shape {
  AnySurface surface;
  double largest_area_element;  // |dpdu x dpdv|
};

AnySurface surface_of(std::string_view kind, std::vector<double> values) {
  return make_surface(kind).with(values);
}

Shape make_shape(std::string_view kind, bool random_shape, PortableRandom& random) {
  constexpr double pi = std::numbers::pi, tau = 2 * pi;
  if (kind == "plane") return {surface_of(kind, {3, 2}), 6};
  if (kind == "sphere") return {surface_of(kind, {1}), tau * pi};
  if (kind == "cylinder") return {surface_of(kind, {1, 3}), tau * 3};
  if (kind == "torus") {
    const double r = 2 * (random_shape ? random.uniform(0.1, 0.8) : 0.3);
    return {surface_of(kind, {2, r}), tau * tau * r * (2 + r)};
  }
  if (kind == "cone") {
    const double angle = (random_shape ? random.uniform(10, 60) : 30) * pi / 180;
    return {surface_of(kind, {1, 1 / std::tan(angle)}), tau / std::sin(angle)};
  }
  std::vector<double> axes{1.5, 1, 0.7};
  if (random_shape) {
    axes = {random.uniform(1.3, 2), 1, 1 / random.uniform(1.3, 2)};
    random.shuffle(axes);
  }
  const double product = axes[0] * axes[1] * axes[2];
  return {surface_of("ellipsoid", axes), tau * pi * product / *std::min_element(axes.begin(), axes.end())};
}

// An interval of the chart: where it begins and how long it is.
struct Part {
  double begin, length;
};

Part random_part(Coordinate coordinate, double whole, double share, PortableRandom& random) {
  const double length = share * whole;
  return {coordinate == Coordinate::turn ? random.uniform() : random.uniform(0, whole - length), length};
}

// Along u and v.
std::pair<Part, Part> parts_of(std::string_view kind, const SurfaceInfo& info,
                               const SyntheticOptions& options, PortableRandom& random) {
  double share_u = 1, share_v = 1;
  if (options.region == Region::patch) {
    share_u = info.u == Coordinate::turn ? 1.0 / 12 : 1.0 / 4;
    share_v = kind == "torus" || kind == "plane"        ? 1.0 / 4
              : kind == "sphere" || kind == "ellipsoid" ? 1.0 / 6
                                                        : 1;
  } else if (options.region == Region::strip) {
    share_u = 0.5, share_v = 0.05;
  } else {
    const double coverage = options.region == Region::half      ? 0.5
                            : options.region == Region::quarter ? 0.25
                                                                : options.coverage;
    const bool both = coverage < 1 && random.uniform() < 0.5;
    share_u = both ? std::sqrt(coverage) : coverage;
    if (both) share_v = share_u;
  }
  const Part along_u = random_part(info.u, 1, share_u, random);
  return {along_u, random_part(info.v, kind == "cone" ? 0.8 : 1, share_v, random)};
}

}  // namespace

SyntheticPoints make_points(std::string_view kind, const SyntheticOptions& options) {
  PortableRandom random(options.seed);
  const Shape shape = make_shape(kind, options.random_shape, random);
  const SurfaceInfo& info = shape.surface.info();
  const std::pair<Part, Part> parts = parts_of(kind, info, options, random);
  const Part &along_u = parts.first, &along_v = parts.second;  // clang 14 captures no structured bindings

  std::vector<double> values;
  for (const ParameterValue& p : shape.surface.parameters()) values.push_back(options.scale * p.value);
  SyntheticPoints points{{}, {}, {shape.surface.with(values)}, options.scale * options.sigma, options.scale,
                         {}};
  const Eigen::Matrix3d rotation = random.rotation();
  const Eigen::Vector3d translation = options.offset * random.normals().normalized();
  points.truth.placement.linear() = rotation;
  points.truth.placement.translation() = options.scale * translation;
  points.truth.uv = uv_conventions()[options.uv_convention];

  const auto somewhere = [&] {
    return Vec2<double>{along_u.begin + along_u.length * random.uniform(),
                        along_v.begin + along_v.length * random.uniform()};
  };
  const auto foot = [&] {  // uniform by area
    for (;;) {
      const Vec2<double> uv = somewhere();
      const Jet2<double> jet = shape.surface.jet(uv.x, uv.y);
      if (random.uniform() * shape.largest_area_element < norm(cross(jet.dpdu, jet.dpdv)))
        return std::pair(to_eigen(jet.position), uv);
    }
  };

  struct Made {
    Eigen::Vector3d position;  // before translation and scaling
    Vec2<double> uv;
    bool is_inlier;
  };
  std::vector<Made> made;
  const auto outliers =
      static_cast<std::size_t>(std::llround(options.outlier_share * static_cast<double>(options.count)));
  Eigen::AlignedBox3d box;
  for (std::size_t k = outliers; k < options.count; ++k) {
    const auto [position, uv] = foot();
    points.feet.push_back(position);
    const Eigen::Vector3d turned = rotation * position;
    box.extend(turned);
    made.push_back({turned + options.sigma * random.normals(), uv, true});
  }
  const Eigen::Vector3d sides = 1.25 * box.sizes().cwiseMax(box.sizes().maxCoeff() / 3);
  const auto in_box = [&] {
    const double x = random.uniform(-1, 1), y = random.uniform(-1, 1), z = random.uniform(-1, 1);
    return Eigen::Vector3d(box.center() + Eigen::Vector3d(x, y, z).cwiseProduct(sides) / 2);
  };
  const Eigen::Vector3d middle =
      options.outlier_pattern == OutlierPattern::scattered ? Eigen::Vector3d::Zero() : in_box();
  for (std::size_t k = 0; k < outliers; ++k) {
    Eigen::Vector3d at;
    if (options.outlier_pattern == OutlierPattern::scattered)
      at = in_box();
    else if (options.outlier_pattern == OutlierPattern::cluster)
      at = middle + 0.1 * random.normals();
    else {
      points.second_feet.push_back(second_radius * random.normals().normalized());
      at = middle + points.second_feet.back() + options.sigma * random.normals();
    }
    made.push_back({at, somewhere(), false});
  }
  points.second_centre = options.scale * (middle + translation);
  random.shuffle(made);

  const auto& affine = points.truth.uv.affine;
  const Eigen::Matrix2d matrix{{affine[0], affine[1]}, {affine[2], affine[3]}};
  for (const Made& m : made) {
    points.cloud.positions.push_back(from_eigen(options.scale * (m.position + translation)));
    points.is_inlier.push_back(m.is_inlier);
    if (!options.with_uv) continue;
    const Eigen::Vector2d stored = matrix.inverse() * Eigen::Vector2d(m.uv.x - affine[4], m.uv.y - affine[5]);
    points.cloud.uvs.push_back({stored[0], stored[1]});
  }
  return points;
}

SyntheticPoints with_second_as_truth(const SyntheticPoints& points, std::string_view kind) {
  SyntheticPoints result = points;
  const double radius = points.scale * second_radius;
  const bool is_sphere = kind == "sphere";
  const std::vector<double> sizes(is_sphere ? 1 : 3, radius);
  result.truth = {make_surface(kind).with(sizes)};
  result.truth.placement.translation() = points.second_centre;
  result.is_inlier.flip();
  result.feet = points.second_feet;
  return result;
}

TrueShape::TrueShape(const SyntheticPoints& points) : kind(points.truth.surface.info().name) {
  for (const ParameterValue& p : points.truth.surface.parameters()) values.push_back(p.value / points.scale);
}

int TrueShape::parameters() const {
  return kind == "plane"      ? 3
         : kind == "sphere"   ? 4
         : kind == "cylinder" ? 5
         : kind == "cone"     ? 6
         : kind == "torus"    ? 7
                              : 9;
}

namespace {

// The signed distance of p from the surface with parameters q (those of the ellipsoid: to first order near
// the surface).
template <class S>
S signed_distance(const TrueShape& shape, const Eigen::Matrix<S, Eigen::Dynamic, 1>& q,
                  const Eigen::Vector3d& p) {
  using std::sqrt, std::cos, std::sin, std::exp;
  using V = Eigen::Matrix<S, 3, 1>;
  const auto axis = [](const S& a, const S& b, double z) {
    const S length = sqrt(a * a + b * b + 1.0);
    return V(a / length, b / length, S(z) / length);
  };
  const V at = p.cast<S>();
  if (shape.kind == "plane") return axis(q[0], q[1], 1).dot(at) - q[2];
  if (shape.kind == "sphere")
    return sqrt((at - V(q.template head<3>())).squaredNorm()) - (shape.values[0] + q[3]);
  if (shape.kind == "cylinder") {
    const V d = at - V(q[0], q[1], S(0));
    return sqrt(d.cross(axis(q[2], q[3], 1)).squaredNorm()) - (shape.values[0] + q[4]);
  }
  if (shape.kind == "cone") {
    const V d = at - V(q[0], q[1], shape.values[1] + q[2]), w = axis(q[3], q[4], -1);
    const S angle = std::atan2(shape.values[0], shape.values[1]) + q[5];
    return sqrt(d.cross(w).squaredNorm()) * cos(angle) - d.dot(w) * sin(angle);
  }
  if (shape.kind == "torus") {
    const V d = at - V(q.template head<3>()), w = axis(q[3], q[4], 1);
    const S across = sqrt(d.cross(w).squaredNorm()) - (shape.values[0] + q[5]), along = d.dot(w);
    return sqrt(across * across + along * along) - (shape.values[1] + q[6]);
  }
  // exp(-omega) (p - centre), to second order in omega
  const V omega = q.template segment<3>(3), d = at - V(q.template head<3>());
  const V once = d.cross(omega), turned = d + once + S(0.5) * V(once.cross(omega));
  V scaled, gradient;
  for (int k = 0; k < 3; ++k) {
    const S semi_axis = shape.values[static_cast<std::size_t>(k)] * exp(q[6 + k]);
    scaled[k] = turned[k] / semi_axis;
    gradient[k] = scaled[k] / semi_axis;
  }
  const S size = sqrt(scaled.squaredNorm());
  return (size - 1.0) * size / sqrt(gradient.squaredNorm());
}

}  // namespace

std::pair<double, Eigen::VectorXd> distance_and_slope(const TrueShape& shape, const Eigen::VectorXd& q,
                                                      const Eigen::Vector3d& p) {
  using S = ceres::Jet<double, 9>;
  const int n = shape.parameters();
  Eigen::Matrix<S, Eigen::Dynamic, 1> variables(n);
  for (int k = 0; k < n; ++k) variables[k] = S(q[k], k);
  const S d = signed_distance<S>(shape, variables, p);
  return {d.a, d.v.head(n)};
}

Eigen::MatrixXd unit_information(const SyntheticPoints& points) {
  const TrueShape shape(points);
  const int n = shape.parameters();
  Eigen::MatrixXd information = Eigen::MatrixXd::Zero(n, n);
  const Eigen::VectorXd zero = Eigen::VectorXd::Zero(n);
  for (const Eigen::Vector3d& foot : points.feet) {
    const Eigen::VectorXd slope = distance_and_slope(shape, zero, foot).second;
    information += slope * slope.transpose();
  }
  return information;
}

std::vector<Eigen::Matrix3d> cube_turns() {
  std::vector<Eigen::Matrix3d> turns;
  std::array<int, 3> to{0, 1, 2};
  do {
    for (int signs = 0; signs < 8; ++signs) {
      Eigen::Matrix3d turn = Eigen::Matrix3d::Zero();
      for (int k = 0; k < 3; ++k) turn(to[static_cast<std::size_t>(k)], k) = signs >> k & 1 ? -1 : 1;
      if (turn.determinant() > 0) turns.push_back(turn);
    }
  } while (std::next_permutation(to.begin(), to.end()));
  return turns;
}

Eigen::VectorXd parameter_error(const SyntheticPoints& points, const PlacedSurface& fit) {
  const TrueShape shape(points);
  const int n = shape.parameters();
  const Eigen::VectorXd nowhere = Eigen::VectorXd::Constant(n, std::numeric_limits<double>::infinity());
  if (fit.surface.info().name != shape.kind) return nowhere;
  std::vector<double> values;
  for (const ParameterValue& p : fit.surface.parameters()) values.push_back(p.value / points.scale);
  const Eigen::Isometry3d& truth = points.truth.placement;
  const Eigen::Matrix3d turn = truth.linear().transpose() * fit.placement.linear();
  const Eigen::Vector3d centre =
      truth.linear().transpose() * ((fit.placement.translation() - truth.translation()) / points.scale);
  const std::vector<double>& true_values = shape.values;
  Eigen::VectorXd q(n);
  if (shape.kind == "sphere") {
    q << centre, values[0] - true_values[0];
    return q;
  }
  if (shape.kind == "ellipsoid") {
    double nearest = -4;
    for (const Eigen::Matrix3d& cube : cube_turns()) {
      const Eigen::Matrix3d from_truth = turn * cube;
      if (from_truth.trace() <= nearest) continue;
      nearest = from_truth.trace();
      const Eigen::AngleAxisd rotation(from_truth);
      const Eigen::Vector3d axes =
          (cube.transpose() * Eigen::Vector3d(values[0], values[1], values[2])).cwiseAbs();
      q << centre, rotation.angle() * rotation.axis(), 0, 0, 0;
      for (int k = 0; k < 3; ++k) q[6 + k] = std::log(axes[k] / true_values[static_cast<std::size_t>(k)]);
    }
    return q;
  }
  Eigen::Vector3d axis = turn.col(2);
  if (axis.z() < 0 && shape.kind != "cone") axis = -axis;
  if (!(axis.z() > 0)) return nowhere;
  const double a = axis.x() / axis.z(), b = axis.y() / axis.z();
  if (shape.kind == "plane") q << a, b, axis.dot(centre);
  if (shape.kind == "cylinder")
    q << centre.x() - centre.z() * a, centre.y() - centre.z() * b, a, b, values[0] - true_values[0];
  if (shape.kind == "torus") q << centre, a, b, values[0] - true_values[0], values[1] - true_values[1];
  if (shape.kind == "cone") {
    const Eigen::Vector3d apex = centre + values[1] * axis - Eigen::Vector3d(0, 0, true_values[1]);
    q << apex, -a, -b, std::atan2(values[0], values[1]) - std::atan2(true_values[0], true_values[1]);
  }
  return q;
}

double mahalanobis_per_parameter(const SyntheticPoints& points, const PlacedSurface& fit) {
  const Eigen::VectorXd error = parameter_error(points, fit);
  if (!error.allFinite() || points.sigma == 0) return std::numeric_limits<double>::infinity();
  const Eigen::VectorXd in_sigmas = error / (points.sigma / points.scale);
  return in_sigmas.dot(unit_information(points) * in_sigmas) / static_cast<double>(error.size());
}

Eigen::Matrix3d true_frame(const SyntheticPoints& points, const PlacedSurface& fit,
                           const Eigen::Vector3d& foot) {
  const TrueShape shape(points);
  const Eigen::Matrix3d rotation = points.truth.placement.linear();
  const Eigen::Matrix3d turn = rotation.transpose() * fit.placement.linear();
  const double sign = turn(2, 2) < 0 ? -1 : 1;
  const Eigen::Vector3d axis(0, 0, shape.kind == "cone" ? 1 : sign);
  const Eigen::Vector3d radial = Eigen::Vector3d(foot.x(), foot.y(), 0).normalized();
  Eigen::Vector3d t = axis.cross(radial), n;
  if (shape.kind == "plane") {
    n = axis;
  } else if (shape.kind == "sphere") {
    n = foot.normalized();
  } else if (shape.kind == "cylinder") {
    n = radial;
  } else if (shape.kind == "cone") {
    n = (shape.values[1] * radial + shape.values[0] * axis).normalized();
  } else if (shape.kind == "torus") {
    n = (foot - shape.values[0] * radial).normalized();
  } else {
    Eigen::Matrix3d nearest = Eigen::Matrix3d::Identity();
    for (const Eigen::Matrix3d& cube : cube_turns())
      if ((turn * cube).trace() > (turn * nearest).trace()) nearest = cube;
    // turn * nearest is about the identity, so the fit's own axes are the truth's turned by nearest^T.
    const Eigen::Vector3d axes(shape.values[0], shape.values[1], shape.values[2]);
    const Eigen::Vector3d named = (nearest * axes).cwiseAbs(), at = nearest * foot;
    n = (at.array() / named.array().square()).matrix().normalized();
    t = Eigen::Vector3d(-named.x() * at.y() / named.y(), named.y() * at.x() / named.x(), 0).normalized();
    n = nearest.transpose() * n;
    t = nearest.transpose() * t;
  }
  t = (t - t.dot(n) * n).normalized();
  Eigen::Matrix3d frame;
  frame << t, n.cross(t), n;
  return rotation * frame;
}

}  // namespace darboux
