// Points on a known surface with noise and outliers, and the judge of what a fit makes of them: its error in
// units of the Cramér-Rao bound of the true inliers. Formulas of its own, none of the library's fit.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <random>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <Eigen/Dense>
#include <Eigen/Geometry>
#include <ceres/jet.h>

#include <darboux/placed_surface.h>
#include <darboux/point_cloud.h>

namespace darboux {

// The same numbers with every standard library, which its distributions do not promise.
class Random {
 public:
  explicit Random(std::uint64_t seed) : bits_(seed) {}

  double uniform() { return static_cast<double>(bits_() >> 11) * 0x1p-53; }  // in [0, 1)
  double uniform(double low, double high) { return low + (high - low) * uniform(); }
  std::size_t below(std::size_t n) { return static_cast<std::size_t>(uniform() * static_cast<double>(n)); }
  double normal() {  // Marsaglia's polar method
    for (;;) {
      const double x = uniform(-1, 1), y = uniform(-1, 1), s = x * x + y * y;
      if (s > 0 && s < 1) return x * std::sqrt(-2 * std::log(s) / s);
    }
  }
  Eigen::Vector3d normals() {
    const double x = normal(), y = normal(), z = normal();
    return {x, y, z};
  }
  Eigen::Matrix3d rotation() {  // uniform
    const double w = normal(), x = normal(), y = normal(), z = normal();
    return Eigen::Quaterniond(w, x, y, z).normalized().matrix();
  }
  template <class T>
  void shuffle(std::vector<T>& list) {
    for (std::size_t k = list.size(); k > 1; --k) std::swap(list[k - 1], list[below(k)]);
  }

 private:
  std::mt19937_64 bits_;
};

// What of the surface the points cover. patch: 30 degrees of each turn, of a torus's tube a quarter; strip:
// half of u and a twentieth of v. Others: SyntheticOptions::coverage.
enum class Region { full, half, quarter, patch, strip };

// cluster: Gaussian, a tenth of the size wide, about a point of the box. second_surface: on a sphere of
// radius 0.7 about a point of the box, with the same noise.
enum class OutlierPattern { scattered, cluster, second_surface };

struct SyntheticOptions {
  std::size_t count = 10000;
  // Standard deviation of each coordinate over a size that is 1 before scaling: the radius of sphere and
  // cylinder, half the major radius of the torus, the base radius of the cone, the middle semi-axis of the
  // ellipsoid, half the shorter side of the plane.
  double sigma = 0;
  // Outliers are uniform in the box of the inliers' feet, its sides along the axes of the points' space, 1.25
  // times as long, and none shorter than a third of the longest: a plane along two axes would else have its
  // outliers within the noise.
  double outlier_share = 0;
  OutlierPattern outlier_pattern = OutlierPattern::scattered;
  // Share of the chart that the inliers cover: with equal odds its square root along both u and v, or all of
  // it along u and the whole of v; anywhere in the chart, over a seam too. Of a cone's chart only v in [0,
  // 0.8] is used.
  double coverage = 1;
  Region region = Region::full;  // patch, strip: instead of the coverage
  // false: sphere 1, cylinder of radius 1 and height 3, torus 2 and 0.6, plane 3 x 2, cone of half-angle 30
  // degrees and base 1, ellipsoid 1.5, 1, 0.7. true: the same but for the cone's half-angle, uniform in 10 to
  // 60 degrees, the torus's minor over major radius, uniform in 0.1 to 0.8, and the ellipsoid's semi-axes,
  // neighbours of which in size have ratios uniform in 1.3 to 2, in random order.
  bool random_shape = false;
  double offset = 10;  // length of the translation before scaling; its direction and the rotation are random
  double scale = 1;    // of all lengths
  bool with_uv = false;           // outliers get a uv anywhere in the covered part
  std::size_t uv_convention = 0;  // of uv_conventions()
  std::uint64_t seed = 1;
};

struct SyntheticPoints {
  PointCloud cloud;
  std::vector<bool> is_inlier;
  PlacedSurface truth;
  double sigma;  // of the cloud's coordinates
  double scale;
  std::vector<Eigen::Vector3d>
      feet;  // of the inliers, without noise, in the surface's own frame and before scaling
};

inline double parameter_of(const AnySurface& surface, std::string_view name) {
  for (const ParameterValue& p : surface.parameters())
    if (p.name == name) return p.value;
  return std::numeric_limits<double>::quiet_NaN();
}

namespace synthetic_detail {

struct Shape {
  AnySurface surface;
  double largest_area_element;  // |dpdu x dpdv|
};

inline AnySurface surface_of(std::string_view kind, std::vector<double> values) {
  return make_surface(kind).with(values);
}

inline Shape make_shape(std::string_view kind, bool random_shape, Random& random) {
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

inline Part random_part(Coordinate coordinate, double whole, double share, Random& random) {
  const double length = share * whole;
  return {coordinate == Coordinate::turn ? random.uniform() : random.uniform(0, whole - length), length};
}

// Along u and v.
inline std::pair<Part, Part> parts_of(std::string_view kind, const SurfaceInfo& info,
                                      const SyntheticOptions& options, Random& random) {
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

}  // namespace synthetic_detail

// \param kind one of found_kinds()
inline SyntheticPoints make_points(std::string_view kind, const SyntheticOptions& options) {
  using namespace synthetic_detail;
  Random random(options.seed);
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
    else
      at = middle + 0.7 * random.normals().normalized() + options.sigma * random.normals();
    made.push_back({at, somewhere(), false});
  }
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

// ---- the judge --------------------------------------------------------------------------------------------
// Minimal parameters of each kind about a true surface, in its own frame and before scaling, zero at the
// truth:
//   plane      tilts a, b of the normal unit(a, b, 1); height along it
//   sphere     centre; change of the radius
//   cylinder   where the axis meets z = 0; tilts; change of the radius
//   cone       displacement of the apex; tilts of the axis unit(a, b, -1) from the apex to the base; change
//              of the half-angle
//   torus      centre; tilts of the axis; changes of both radii
//   ellipsoid  centre; rotation vector; logarithms of the ratios of the semi-axes

// What of the true surface the distance needs, in the order of its parameters, before scaling.
struct TrueShape {
  std::string kind;
  std::vector<double> values;
  explicit TrueShape(const SyntheticPoints& points) : kind(points.truth.surface.info().name) {
    for (const ParameterValue& p : points.truth.surface.parameters())
      values.push_back(p.value / points.scale);
  }
  int parameters() const {
    return kind == "plane"      ? 3
           : kind == "sphere"   ? 4
           : kind == "cylinder" ? 5
           : kind == "cone"     ? 6
           : kind == "torus"    ? 7
                                : 9;
  }
};

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

// The distance and its derivatives by the parameters.
inline std::pair<double, Eigen::VectorXd> distance_and_slope(const TrueShape& shape, const Eigen::VectorXd& q,
                                                             const Eigen::Vector3d& p) {
  using S = ceres::Jet<double, 9>;
  const int n = shape.parameters();
  Eigen::Matrix<S, Eigen::Dynamic, 1> variables(n);
  for (int k = 0; k < n; ++k) variables[k] = S(q[k], k);
  const S d = signed_distance<S>(shape, variables, p);
  return {d.a, d.v.head(n)};
}

// Fisher's information of the true inliers about the minimal parameters, for a noise of 1 before scaling.
inline Eigen::MatrixXd unit_information(const SyntheticPoints& points) {
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

namespace synthetic_detail {

// The 24 turns of a cube.
inline std::vector<Eigen::Matrix3d> cube_turns() {
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

}  // namespace synthetic_detail

// A fitted surface of the same kind in the minimal parameters. Of what is the same surface the nearest to the
// truth is taken: either sign of an axis, any order and signs of an ellipsoid's axes. Infinite where they
// cannot express it.
inline Eigen::VectorXd parameter_error(const SyntheticPoints& points, const PlacedSurface& fit) {
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
    for (const Eigen::Matrix3d& cube : synthetic_detail::cube_turns()) {
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

// e^T I e / n with e the error of the fit in the minimal parameters and I the information of the true inliers
// at the truth: 1 on average for an estimate that knows the inliers and reaches the Cramér-Rao bound.
// Infinite for another kind and where there is no noise.
inline double mahalanobis_per_parameter(const SyntheticPoints& points, const PlacedSurface& fit) {
  const Eigen::VectorXd error = parameter_error(points, fit);
  if (!error.allFinite() || points.sigma == 0) return std::numeric_limits<double>::infinity();
  const Eigen::VectorXd in_sigmas = error / (points.sigma / points.scale);
  return in_sigmas.dot(unit_information(points) * in_sigmas) / static_cast<double>(error.size());
}

// The true frame at a foot (in the surface's own frame, before scaling), as a fit names it: the sign of the
// axis and the order of an ellipsoid's axes are a convention. Columns t, b, n in the points' space; of plane
// and sphere only n means something.
inline Eigen::Matrix3d true_frame(const SyntheticPoints& points, const PlacedSurface& fit,
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
    for (const Eigen::Matrix3d& cube : synthetic_detail::cube_turns())
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
