#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <string>
#include <type_traits>

#include <darboux/error.h>
#include <darboux/fit_mesh.h>
#include <darboux/forms.h>
#include <darboux/project.h>

#include "fit/common/parameter_jet.h"
#include "fit/primitives/list.h"

namespace darboux {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double degrees = 180 / std::numbers::pi;
constexpr Status singular = Status::dpdu_zero | Status::dpdv_zero | Status::parallel;

constexpr int most_columns = 6 + most_parameters + 6;
constexpr int any = Eigen::Dynamic;
// A column for each component of δ: the turns about t, b and n, and the share by which the partial along t
// grows.
template <int N>
using Turns = Eigen::Matrix<double, 4, N, Eigen::RowMajor, 4, N == any ? most_columns : N>;
using Ways = Eigen::Matrix<double, 2, any, 0, 2, most_columns>;  // of (u, v)

// A fitted surface with the covariance of δ, N numbers, with or without the translation, which turns no frame
// at a fixed (u, v).
template <int N>
struct Fitted {
  const PlacedSurface& placed;
  SurfaceWithParameters surface;
  Eigen::Matrix3d rotation;
  Eigen::Index parameters;  // the column of the surface's first; before are the rotation, and the translation
  Eigen::Matrix<double, N, N> covariance;

  Eigen::Vector3d placed_direction(const Vec3<double>& a) const { return rotation * to_eigen(a); }

  // Of a row of Turns.
  double variance(const Turns<N>& turns, int row) const {
    double result = 0;
    for (Eigen::Index k = 0; k < turns.cols(); ++k) {
      double before = 0;
      for (Eigen::Index i = 0; i < k; ++i) before += covariance(i, k) * turns(row, i);
      result += (2 * before + covariance(k, k) * turns(row, k)) * turns(row, k);
    }
    return result;
  }
  std::array<double, 4> variances(const Turns<N>& turns) const {
    return {variance(turns, 0), variance(turns, 1), variance(turns, 2), variance(turns, 3)};
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

// Whether the surface has a normal where its circles v = const shrink to a point near (u, v): the same from
// all sides. The point is where dpdu vanishes when it goes on along v as it does here.
bool pole_has_normal(const AnySurface& surface, const Vec2<double>& uv, const Jet2<double>& j) {
  if (surface.info().u != Coordinate::turn) return false;
  const double v = uv.y - dot(j.dpdu, j.d2pduv) / dot(j.d2pduv, j.d2pduv);
  const auto normal = [&](double x, double y) { return surface.frame(x, y).n; };
  const double sides = norm(normal(uv.x + 0.25, v) - normal(uv.x, v));
  // A smooth cap's normals differ less at its top than between here and there.
  return sides <= norm(normal(uv.x, uv.y) - normal(uv.x, v)) + 1e-9;
}

// Of a variance, which rounding may make negative; of one that is not known, infinite.
double root(double x) {
  return x > 0 ? std::sqrt(x) : std::isnan(x) ? infinity : 0;
}

// Two partials of a surface, or a change of them, in its axes.
struct Partials {
  Vec3<double> u, v;
};

// The frame along the first of two partials: u = e t, v = f t + g b.
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

// A point of a fitted surface, where the surface's parameters move it, and the frame there.
struct Point {
  Sample<double> s;
  ParameterJet& by;
  bool at_pole = false;

  Point(const SurfaceWithParameters& surface, const Vec2<double>& uv, ParameterJet& place)
      : s(surface.sample(uv, place)), by(place) {}
  Chart chart() const { return {s.frame.t, s.frame.b, s.frame.n, {s.jet.dpdu, s.jet.dpdv}}; }
};

// Whether it has a frame to turn. At a pole it goes beside it.
bool has_first_order(const SurfaceWithParameters& surface, Point& at) {
  const Sample<double>& s = at.s;
  if (has(s.frame.status, Status::no_frame | Status::non_finite_input | Status::overflow | Status::dpdv_zero |
                              Status::parallel))
    return false;
  // At a pole the covariance of n is that beside it, where dpdu tells directions apart.
  // A foot may miss it by a rounding.
  at.at_pole = has(s.frame.status, Status::dpdu_zero) || norm(s.jet.dpdu) < 1e-9 * norm(s.jet.d2pduv);
  if (at.at_pole) at.s = surface.sample({s.u, s.v + (s.v < 0.5 ? 0x1p-20 : -0x1p-20)}, at.by);
  return !has(s.frame.status, Status::no_frame | singular);
}

// What δ does at a fixed (u, v) to the frame of a chart, of which the surface's partials are `seen`.
template <int N, class Seen>
Turns<N> turns_of(const Fitted<N>& fit, const Point& at, const Chart& chart, Seen seen) {
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
    result.col(first + k) = chart.turn(seen({at.by.dpdu[i], at.by.dpdv[i]}));
  }
  return result;
}

// The point moves over the surface too.
template <int N, class Seen>
void go(Turns<N>& turns, const Point& at, const Chart& chart, Seen seen, const Ways& way) {
  const Jet2<double>& j = at.s.jet;
  turns += chart.turn(seen({j.d2pdu2, j.d2pduv})) * way.row(0) +
           chart.turn(seen({j.d2pduv, j.d2pdv2})) * way.row(1);
}

Partials as_they_are(const Partials& p) {
  return p;
}

// Whether first order tells n and t at all: where three standard deviations change n by less than a radian,
// and dpdu by less than its length.
struct Known {
  double normal;  // standard deviation, radians
  bool knows_normal, knows_tangent;
};

Known known(const PlacedSurface& placed, const Point& at, const Chart& chart,
            const std::array<double, 4>& variances) {
  const auto& [t, b, n, growth] = variances;
  Known result;
  result.knows_tangent = !at.at_pole && chart.e > 0 && 9 * (b + n + growth) < 1;
  result.normal = root(t + b);
  result.knows_normal = 3 * result.normal < 1 &&
                        (result.knows_tangent || pole_has_normal(placed.surface, {at.s.u, at.s.v}, at.s.jet));
  return result;
}

// How δ moves the point at a fixed (u, v), along t and b.
Ways velocity(const Fitted<any>& fit, const Point& at, const Chart& chart, const Eigen::Vector3d& centre) {
  const Eigen::Vector3d arm = fit.placed.placement * to_eigen(at.s.jet.position) - centre;
  Ways result = Ways::Zero(2, fit.covariance.cols());
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

// Without its covariance.
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

// The frame at uv with its covariance; where the point p stays and its foot moves, p is given, in the
// surface's axes.
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
    // The foot x + d n = p stays a foot: (1 - d S) w = -(velocity + d (what turns n towards t, b)), w the
    // foot's way along t and b over the moving surface. [doCarmo2016, sec. 3-3]
    const ShapeOperator<double> s = shape_operator(at.s.jet, at.s.frame);
    const double distance = dot(*p - at.s.jet.position, chart.n);
    Eigen::Matrix2d moving;
    moving << 1 - distance * s.a, -distance * s.m, -distance * s.m, 1 - distance * s.c;
    // Nearest points have both eigenvalues positive; at zero, a focal point, the foot is not unique.
    if (!(moving.determinant() > 1e-9 * moving.trace() * moving.trace())) return result;
    Ways way = -velocity(fit, at, chart, uncertainty.centre);
    way.row(0) -= distance * turns.row(1);
    way.row(1) += distance * turns.row(0);
    way = (moving.inverse() * way).eval();
    way.row(1) /= s.g;                                   // now dv
    way.row(0) = (way.row(0) - s.f * way.row(1)) / s.e;  // and du
    go(turns, at, chart, as_they_are, way);
  }
  const std::array<double, 4> variances = fit.variances(turns);
  const Known knows = known(placed, at, chart, variances);
  if (!knows.knows_normal) return result;
  const auto turn = turns.topRows<3>();
  const Eigen::Matrix3d covariance = turn.lazyProduct(fit.covariance).eval().lazyProduct(turn.transpose());
  result.normal_deg = knows.normal * degrees;
  result.covariance.topLeftCorner<2, 2>() = covariance.topLeftCorner<2, 2>();
  if (knows.knows_tangent) {
    result.covariance = covariance;
    result.tangent_deg = root(variances[1] + variances[2]) * degrees;
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

// The foot on a surface that has no closed form for it. Each thread keeps the grid of the last surface it was
// asked for, and that surface, so that no other has its address.
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
  if (!has_first_order(fit.surface, at)) return truth;
  const Chart chart = at.chart();
  const Eigen::Index n = fit.covariance.cols(), map = fit.parameters + fit.surface.parameters();
  Ways way;
  Turns<N> turns = turns_of(fit, at, chart, as_they_are);
  if (n > map) {  // the uv map is uncertain as well, and moves the point
    way = Ways::Zero(2, n);
    for (int row = 0; row < 2; ++row) {
      way(row, map + 2 * row) = stored.x;
      way(row, map + 2 * row + 1) = stored.y;
      way(row, map + 4 + row) = 1;
    }
    go(turns, at, chart, as_they_are, way);
  }
  std::array<double, 4> variances = fit.variances(turns);
  const Known knows = known(fit.placed, at, chart, variances);
  if (!knows.knows_normal) return truth;
  truth.normal_deg = knows.normal * degrees;
  if (!knows.knows_tangent) return truth;
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
      go(turns, at, own, stored_partials, way);
      turns.col(map) += own.turn({at.s.jet.dpdu, {}});
      turns.col(map + 2) += own.turn({at.s.jet.dpdv, {}});
    }
    variances = fit.variances(turns);
  }
  const auto& [of_t, of_b, of_n, growth] = variances;
  if (9 * (of_b + of_n + growth) < 1) truth.tangent_deg = root(of_b + of_n) * degrees;
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
