#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <string>
#include <type_traits>

#include <darboux/error.h>
#include <darboux/fit_mesh.h>
#include <darboux/project.h>
#include <darboux/shape_operator.h>

#include "base/degrees.h"
#include "fit/common/parameter_jet.h"
#include "fit/primitives/list.h"

namespace darboux {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr Status singular = Status::dpdu_zero | Status::dpdv_zero | Status::parallel;

constexpr int most_columns = 6 + most_parameters + 6;
constexpr int any = Eigen::Dynamic;
// One column per component of δ: how far it turns the frame about t, b and n, and the share by which it
// lengthens the partial along t.
template <int N>
using Turns = Eigen::Matrix<double, 4, N, Eigen::RowMajor, 4, N == any ? most_columns : N>;
// One column per component of δ: how far it moves a point along two directions, or its (u, v).
using Motion = Eigen::Matrix<double, 2, any, 0, 2, most_columns>;

// A fitted surface with the covariance of δ: (rotation vector, translation, parameters, uv map), N numbers.
// Without the translation if (u, v) is fixed, as it then turns no frame.
template <int N>
struct Fitted {
  const PlacedSurface& placed;
  SurfaceWithParameters surface;
  Eigen::Matrix3d rotation;
  Eigen::Index parameters;  // the column of the first parameter
  Eigen::Matrix<double, N, N> covariance;

  Eigen::Vector3d placed_direction(const Vec3<double>& a) const { return rotation * to_eigen(a); }

  // The variances of the rows.
  std::array<double, 4> variances(const Turns<N>& turns) const {
    const Turns<N> by_covariance = turns.lazyProduct(covariance);
    const Eigen::Vector4d result = by_covariance.cwiseProduct(turns).rowwise().sum();
    return {result[0], result[1], result[2], result[3]};
  }
};

Fitted<any> fitted(const PlacedSurface& placed, const SurfaceUncertainty& uncertainty,
                   bool with_translation) {
  Fitted<any> result{placed, SurfaceWithParameters(placed.surface), placed.placement.linear(), 6, {}};
  const Eigen::MatrixXd& c = uncertainty.covariance;
  const Eigen::Index of_surface = 6 + result.surface.parameters();
  if ((c.rows() != of_surface && c.rows() != of_surface + 6) || c.cols() != c.rows())
    throw ParameterError("fit", "expected a covariance of " + std::to_string(of_surface) +
                                    " rows, or 6 more, for a " + std::string(placed.surface.info().name) +
                                    ", got " + std::to_string(c.rows()));
  if (with_translation) {
    result.covariance = c;
    return result;
  }
  const Eigen::Index rest = c.rows() - 6;
  result.parameters = 3;
  result.covariance.resize(3 + rest, 3 + rest);
  result.covariance << c.topLeftCorner(3, 3), c.topRightCorner(3, rest), c.bottomLeftCorner(rest, 3),
      c.bottomRightCorner(rest, rest);
  return result;
}

// Whether the surface has a normal at the pole near (u, v), where its circles v = const shrink to a point:
// the limit is the same from all sides. The pole is extrapolated as the v where dpdu would vanish.
bool pole_has_normal(const AnySurface& surface, const Vec2<double>& uv, const Jet2<double>& j) {
  if (surface.info().u != Coordinate::turn) return false;
  const double v = uv.y - dot(j.dpdu, j.d2pduv) / dot(j.d2pduv, j.d2pduv);
  const auto normal = [&](double x, double y) { return surface.frame(x, y).n; };
  const double sides = norm(normal(uv.x + 0.25, v) - normal(uv.x, v));
  // A smooth cap's normals differ less at its top than between here and there.
  return sides <= norm(normal(uv.x, uv.y) - normal(uv.x, v)) + 1e-9;
}

// The root of a variance: 0 if rounding made it negative, infinite if it is NaN.
double deviation(double variance) {
  return variance > 0 ? std::sqrt(variance) : std::isnan(variance) ? infinity : 0;
}

// Two partials of a surface, or a change of them, in its axes.
struct Partials {
  Vec3<double> u, v;
};

// Two partials in the frame along the first: u = e t, v = f t + g b.
struct Chart {
  const Vec3<double>&t, &b, &n;
  double e, f, g;
  double by_e = 1 / e, by_g = 1 / g;

  Chart(const Vec3<double>& along, const Vec3<double>& across, const Vec3<double>& normal,
        const Partials& partials)
      : t(along), b(across), n(normal), e(dot(partials.u, t)), f(dot(partials.v, t)), g(dot(partials.v, b)) {}

  // A column of Turns. n stays orthogonal to the partials, t along the first: n' = -turn_t b + turn_b t,
  // t' = turn_n b - turn_b n.
  Eigen::Vector4d turn(const Partials& change) const {
    const double lift = by_e * dot(change.u, n);
    return {by_g * (dot(change.v, n) - f * lift), -lift, by_e * dot(change.u, b), by_e * dot(change.u, t)};
  }
};

// A point of a fitted surface, its derivatives with respect to the parameters, and the frame there.
struct Point {
  Sample<double> s;
  ParameterJet& by;
  bool at_pole = false;

  Point(const SurfaceWithParameters& surface, const Vec2<double>& uv, ParameterJet& place)
      : s(surface.sample(uv, place)), by(place) {}
  Chart chart() const { return {s.frame.t, s.frame.b, s.frame.n, {s.jet.dpdu, s.jet.dpdv}}; }
};

// Whether the frame at the point is differentiable. A point at a pole is moved off it, to where dpdu
// determines directions: the covariance of n is the same there.
bool has_first_order(const SurfaceWithParameters& surface, Point& at) {
  const Sample<double>& s = at.s;
  if (has(s.frame.status, Status::no_frame | Status::non_finite_input | Status::overflow | Status::dpdv_zero |
                              Status::parallel))
    return false;
  // A foot may miss the pole by rounding.
  at.at_pole =
      at.at_pole || has(s.frame.status, Status::dpdu_zero) || norm(s.jet.dpdu) < 1e-9 * norm(s.jet.d2pduv);
  if (at.at_pole) at.s = surface.sample({s.u, s.v + (s.v < 0.5 ? 0x1p-16 : -0x1p-16)}, at.by);
  return !has(s.frame.status, Status::no_frame | singular);
}

// How δ turns the frame of a chart at a fixed (u, v). \param in_chart takes partials of the surface to those
// of the chart
template <int N, class InChart>
Turns<N> turns_of(const Fitted<N>& fit, const Point& at, const Chart& chart, InChart in_chart) {
  Turns<N> result(4, fit.covariance.cols());
  result.row(0).template head<3>() = fit.placed_direction(chart.t);
  result.row(1).template head<3>() = fit.placed_direction(chart.b);
  result.row(2).template head<3>() = fit.placed_direction(chart.n);
  result.row(3).template head<3>().setZero();
  if (N == any) result.rightCols(result.cols() - 3).setZero();
  const Eigen::Index count = N == any ? fit.surface.parameters() : N - 3,
                     first = N == any ? fit.parameters : 3;
  for (Eigen::Index k = 0; k < count; ++k) {
    const auto i = static_cast<std::size_t>(k);
    result.col(first + k) = chart.turn(in_chart({at.by.dpdu[i], at.by.dpdv[i]}));
  }
  return result;
}

// Adds how the frame turns as δ moves the point over the surface. \param by of (u, v)
template <int N, class InChart>
void add_motion(Turns<N>& turns, const Point& at, const Chart& chart, InChart in_chart, const Motion& by) {
  const Jet2<double>& j = at.s.jet;
  turns += chart.turn(in_chart({j.d2pdu2, j.d2pduv})) * by.row(0) +
           chart.turn(in_chart({j.d2pduv, j.d2pdv2})) * by.row(1);
}

Partials as_they_are(const Partials& p) {
  return p;
}

// Where first order is valid: for n, if three standard deviations turn it by less than a radian; for t, if
// they change dpdu by less than its length.
struct Validity {
  double normal;  // standard deviation, radians
  bool of_normal, of_tangent;
};

Validity validity(const PlacedSurface& placed, const Point& at, const Chart& chart,
                  const std::array<double, 4>& variances) {
  const auto& [t, b, n, growth] = variances;
  Validity result;
  // Beyond a pole, where a uv map may place a whole mesh, dpdu points against t.
  result.of_tangent = !at.at_pole && std::fabs(chart.e) > 0 && 9 * (b + n + growth) < 1;
  result.normal = deviation(t + b);
  result.of_normal = 3 * result.normal < 1 &&
                     (result.of_tangent || pole_has_normal(placed.surface, {at.s.u, at.s.v}, at.s.jet));
  return result;
}

// How δ moves the point at a fixed (u, v), along t and b.
Motion velocity(const Fitted<any>& fit, const Point& at, const Chart& chart, const Eigen::Vector3d& centre) {
  const Eigen::Vector3d arm = fit.placed.placement * to_eigen(at.s.jet.position) - centre;
  Motion result = Motion::Zero(2, fit.covariance.cols());
  for (int row = 0; row < 2; ++row) {
    const Vec3<double>& along = row == 0 ? chart.t : chart.b;
    const Eigen::Vector3d placed = fit.placed_direction(along);
    result.block<1, 3>(row, 0) = arm.cross(placed).transpose();
    result.block<1, 3>(row, 3) = placed.transpose();
    for (int k = 0; k < fit.surface.parameters(); ++k)
      result(row, fit.parameters + k) = dot(along, at.by.position[static_cast<std::size_t>(k)]);
  }
  return result;
}

// The frame of the placed surface, without a covariance.
UncertainFrame placed_frame(const PlacedSurface& placed, const Sample<double>& s) {
  const Eigen::Matrix3d rotation = placed.placement.linear();
  const auto turned = [&](const Vec3<double>& a) { return from_eigen(rotation * to_eigen(a)); };
  UncertainFrame result;
  result.uv = {s.u, s.v};
  result.position = from_eigen(placed.placement * to_eigen(s.jet.position));
  result.t = turned(s.frame.t);
  result.b = turned(s.frame.b);
  result.n = turned(s.frame.n);
  result.status = s.frame.status;
  return result;
}

// The frame at uv with its covariance. \param p null: at a fixed uv; else at the foot of this point (in the
// surface's axes), which stays fixed while its foot moves
UncertainFrame uncertain_frame(const PlacedSurface& placed, const SurfaceUncertainty& uncertainty,
                               const Vec2<double>& uv, const Vec3<double>* p) {
  const Fitted<any> fit = fitted(placed, uncertainty, p != nullptr);
  ParameterJet by;
  Point at(fit.surface, uv, by);
  UncertainFrame result = placed_frame(placed, at.s);
  result.covariance = Eigen::Vector3d(infinity, infinity, infinity).asDiagonal();
  result.normal_deg = result.tangent_deg = infinity;
  if (!has_first_order(fit.surface, at)) return result;
  const Chart chart = at.chart();
  Turns<any> turns = turns_of(fit, at, chart, as_they_are);
  if (p) {
    // x + d n = p holds on: (1 - d S) w = -(velocity + d (turn of n towards t, b)), with w the motion of the
    // foot x along t and b over the moving surface. [doCarmo2016, sec. 3-3]
    const ShapeOperator<double> s = shape_operator(at.s.jet, at.s.frame);
    const double distance = dot(*p - at.s.jet.position, chart.n);
    Eigen::Matrix2d moving;
    moving << 1 - distance * s.a, -distance * s.m, -distance * s.m, 1 - distance * s.c;
    // At nearest points both eigenvalues are positive; where one is zero (a focal point) the foot is not
    // unique.
    if (!(moving.determinant() > 1e-9 * moving.trace() * moving.trace())) return result;
    Motion w = -velocity(fit, at, chart, uncertainty.centre);
    w.row(0) -= distance * turns.row(1);
    w.row(1) += distance * turns.row(0);
    w = (moving.inverse() * w).eval();
    w.row(1) /= s.g;                               // now dv
    w.row(0) = (w.row(0) - s.f * w.row(1)) / s.e;  // and du
    add_motion(turns, at, chart, as_they_are, w);
  }
  const std::array<double, 4> variances = fit.variances(turns);
  const Validity valid = validity(placed, at, chart, variances);
  if (!valid.of_normal) return result;
  const auto turn = turns.topRows<3>();
  const Eigen::Matrix3d covariance = turn.lazyProduct(fit.covariance).eval().lazyProduct(turn.transpose());
  result.normal_deg = valid.normal * degrees_per_radian;
  result.covariance.topLeftCorner<2, 2>() = covariance.topLeftCorner<2, 2>();
  if (valid.of_tangent) {
    result.covariance = covariance;
    result.tangent_deg = deviation(variances[1] + variances[2]) * degrees_per_radian;
  }
  return result;
}

const PlacedSurface& surface_of(const PointFit& fit) {
  if (!fit.surface) throw ParameterError("fit", "expected a usable fit, got one without a surface");
  if (!address(fit.surface->surface))
    throw ParameterError(
        std::string(fit.surface->surface.info().name),
        "expected a kind that can be fitted to points, got one whose frames have no uncertainty");
  return *fit.surface;
}

// The foot on a surface without a closed form for it. Each thread keeps the projector of the last surface it
// was called with, and a copy of that surface, so that no other surface can have its address.
Vec2<double> searched_foot(const AnySurface& surface, const Vec3<double>& p) {
  struct Last {
    AnySurface surface;
    Projector projector;
  };
  thread_local std::optional<Last> last;
  if (!last || address(last->surface) != address(surface)) last.emplace(Last{surface, Projector(surface)});
  return last->projector(p).uv;
}

template <int N>
Truth truth_at(const Fitted<N>& fit, const Vec2<double>& stored, ParameterJet& by) {
  const UvConvention& convention = fit.placed.uv;
  Point at(fit.surface, convention.surface_uv(stored), by);
  Truth truth = fit.placed.truth(stored, at.s);
  truth.normal_deg = truth.tangent_deg = infinity;
  at.at_pole = truth.pole && !has(truth.status, Status::dpdv_zero | Status::parallel);
  if (!has_first_order(fit.surface, at)) return truth;
  const Chart chart = at.chart();
  const Eigen::Index n = fit.covariance.cols(), map = fit.parameters + fit.surface.parameters();
  Motion motion;
  Turns<N> turns = turns_of(fit, at, chart, as_they_are);
  if (n > map) {  // the uv map is uncertain as well, and moves the point
    motion = Motion::Zero(2, n);
    for (int row = 0; row < 2; ++row) {
      motion(row, map + 2 * row) = stored.x;
      motion(row, map + 2 * row + 1) = stored.y;
      motion(row, map + 4 + row) = 1;
    }
    add_motion(turns, at, chart, as_they_are, motion);
  }
  std::array<double, 4> variances = fit.variances(turns);
  const Validity valid = validity(fit.placed, at, chart, variances);
  if (!valid.of_normal) return truth;
  truth.normal_deg = valid.normal * degrees_per_radian;
  if (!valid.of_tangent) return truth;
  const auto& m = convention.affine;
  if (n > map || m[0] == 0 || m[2] != 0) {
    // The chart of the stored uvs, whose partials are M00 dpdu + M10 dpdv and M01 dpdu + M11 dpdv.
    const auto stored_partials = [&](const Partials& p) {
      return Partials{m[0] * p.u + m[2] * p.v, m[1] * p.u + m[3] * p.v};
    };
    const Partials partials = stored_partials({at.s.jet.dpdu, at.s.jet.dpdv});
    const Vec3<double> t = unit(partials.u), b = cross(chart.n, t);
    const Chart own(t, b, chart.n, partials);
    turns = turns_of(fit, at, own, stored_partials);
    if (n > map) {
      add_motion(turns, at, own, stored_partials, motion);
      turns.col(map) += own.turn({at.s.jet.dpdu, {}});
      turns.col(map + 2) += own.turn({at.s.jet.dpdv, {}});
    }
    variances = fit.variances(turns);
  }
  const auto& [of_t, of_b, of_n, growth] = variances;
  if (9 * (of_b + of_n + growth) < 1) truth.tangent_deg = deviation(of_b + of_n) * degrees_per_radian;
  return truth;
}

}  // namespace

UncertainFrame frame_near(const PointFit& fit, const Vec3<double>& p) {
  return frame_near(surface_of(fit), fit, p);
}

UncertainFrame frame_near(const PlacedSurface& placed, const SurfaceUncertainty& uncertainty,
                          const Vec3<double>& p) {
  const Vec3<double> local = from_eigen(placed.placement.inverse() * to_eigen(p));
  const auto closed = fit::closed_form_foot(placed.surface, local);
  const Vec2<double> uv = closed ? *closed : searched_foot(placed.surface, local);
  return uncertain_frame(placed, uncertainty, uv, &local);
}

UncertainFrame frame_at(const PointFit& fit, const Vec2<double>& uv) {
  return uncertain_frame(surface_of(fit), fit, uv, nullptr);
}

Truth truth_at(const MeshFit& fit, const Vec2<double>& stored) {
  ParameterJet by;
  return truth_at(fitted(fit.surface, fit, false), stored, by);
}

std::vector<Truth> truths_at(const MeshFit& fit, std::span<const Vec2<double>> stored) {
  const Fitted<any> any_size = fitted(fit.surface, fit, false);
  std::vector<Truth> result;
  result.reserve(stored.size());
  const auto all = [&](const auto& of_size) {
    ParameterJet by;
    for (const Vec2<double>& uv : stored) result.push_back(truth_at(of_size, uv, by));
  };
  const auto with_size = [&]<int N>(std::integral_constant<int, N>) {
    all(Fitted<N>{any_size.placed, any_size.surface, any_size.rotation, any_size.parameters,
                  any_size.covariance});
  };
  // One to three parameters, and plain uvs: the compiler knows all sizes.
  switch (any_size.covariance.rows()) {
    case 4:
      with_size(std::integral_constant<int, 4>());
      break;
    case 5:
      with_size(std::integral_constant<int, 5>());
      break;
    case 6:
      with_size(std::integral_constant<int, 6>());
      break;
    default:
      all(any_size);
  }
  return result;
}

}  // namespace darboux
