#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <string>

#include <darboux/error.h>
#include <darboux/fit.h>
#include <darboux/forms.h>
#include <darboux/project.h>

#include "closed_foot.h"
#include "manifolds.h"
#include "parameter_jet.h"

namespace darboux {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double degrees = 180 / std::numbers::pi;
constexpr Status singular = Status::dpdu_zero | Status::dpdv_zero | Status::parallel;

// One column for each component of δ, rows along t, b, n.
constexpr int most_columns = 6 + most_parameters + 6;
constexpr int any = Eigen::Dynamic;
template <int N>
using Columns = Eigen::Matrix<double, 3, N, 0, 3, N == any ? most_columns : N>;
using Ways = Eigen::Matrix<double, 2, any, 0, 2, most_columns>;  // of (u, v)

// The covariance of δ, N numbers, with or without the translation, which turns no frame at a fixed (u, v).
template <int N>
struct Spread {
  const SurfaceUncertainty& uncertainty;
  Eigen::Index parameters;  // the column of the surface's first; before are the rotation, and the translation
  Eigen::Matrix<double, N, N> covariance;
};

Spread<any> whole(const SurfaceUncertainty& uncertainty) {
  return {uncertainty, 6, uncertainty.covariance};
}
Spread<any> without_translation(const SurfaceUncertainty& uncertainty) {
  const Eigen::MatrixXd& c = uncertainty.covariance;
  if (c.rows() < 6 || c.cols() != c.rows()) return whole(uncertainty);  // which is refused
  const Eigen::Index rest = c.rows() - 6;
  Spread<any> result{uncertainty, 3, Eigen::MatrixXd(3 + rest, 3 + rest)};
  result.covariance << c.topLeftCorner(3, 3), c.topRightCorner(3, rest), c.bottomLeftCorner(rest, 3),
      c.bottomRightCorner(rest, rest);
  return result;
}

// What δ does to the surface at a fixed (u, v).
template <int N>
struct Velocities {
  Columns<any> position;  // empty without translation
  Columns<N> dpdu, dpdv;
  int parameters;  // of the surface
};

template <int N>
Velocities<N> velocities(const PlacedSurface& placed, const Spread<N>& spread, const Vec2<double>& uv,
                         const Jet2<double>& j, const Frame<double>& frame) {
  const ParameterJet by = parameter_jet(placed.surface, uv);
  const Eigen::MatrixXd& given = spread.uncertainty.covariance;
  const Eigen::Index rows = given.rows(), of_surface = 6 + by.count, n = spread.covariance.rows();
  if ((rows != of_surface && rows != of_surface + 6) || given.cols() != rows)
    throw ParameterError("fit", "covariance has " + std::to_string(rows) + " rows, permitted are " +
                                    std::to_string(of_surface) + ", or 6 more, for a " +
                                    std::string(placed.surface.info().name));
  Eigen::Matrix3d local;  // takes the surface's axes to t, b, n
  local << to_eigen(frame.t).transpose(), to_eigen(frame.b).transpose(), to_eigen(frame.n).transpose();
  const Eigen::Matrix3d rotation = placed.placement.linear(), to_frame = local * rotation.transpose();
  const bool moves = spread.parameters == 6;
  Velocities<N> result{Columns<any>::Zero(3, moves ? n : 0), Columns<N>::Zero(3, n), Columns<N>::Zero(3, n),
                       by.count};
  const auto rigid = [&](auto& columns, const Eigen::Vector3d& a) {
    columns.template leftCols<3>() = -to_frame * fit::cross_matrix(a);  // ω × a
  };
  rigid(result.dpdu, rotation * to_eigen(j.dpdu));
  rigid(result.dpdv, rotation * to_eigen(j.dpdv));
  if (moves) {
    rigid(result.position, placed.placement * to_eigen(j.position) - spread.uncertainty.centre);
    result.position.template middleCols<3>(3) = to_frame;
  }
  for (int k = 0; k < by.count; ++k) {
    const auto at = static_cast<std::size_t>(k);
    const Eigen::Index column = spread.parameters + k;
    if (moves) result.position.col(column) = local * to_eigen(by.position[at]);
    result.dpdu.col(column) = local * to_eigen(by.dpdu[at]);
    result.dpdv.col(column) = local * to_eigen(by.dpdv[at]);
  }
  return result;
}

// Whether the surface has a normal where its circles v = const shrink to a point near (u, v): the same from all sides. The
// point is where dpdu vanishes when it goes on along v as it does here.
bool pole_has_normal(const AnySurface& surface, const Vec2<double>& uv, const Jet2<double>& j) {
  if (surface.info().u != Coordinate::turn) return false;
  const double v = uv.y - dot(j.dpdu, j.d2pduv) / dot(j.d2pduv, j.d2pduv);
  const auto normal = [&](double x, double y) { return surface.frame(x, y).n; };
  const double sides = norm(normal(uv.x + 0.25, v) - normal(uv.x, v));
  // A smooth cap's normals differ less at its top than between here and there.
  return sides <= norm(normal(uv.x, uv.y) - normal(uv.x, v)) + 1e-9;
}

double root(double x) {
  return std::sqrt(std::fmax(x, 0));
}

// A point of a fitted surface and what δ does to it, to first order.
template <int N>
struct FirstOrder {
  const PlacedSurface& placed;
  const Eigen::Matrix<double, N, N>& covariance;
  bool at_pole;
  Vec2<double> uv;
  Jet2<double> j;
  Frame<double> frame;
  double e, f, g;  // dpdu = e t, dpdv = f t + g b
  Velocities<N> d;

  Eigen::Vector3d in_frame(const Vec3<double>& a) const {
    return {dot(a, frame.t), dot(a, frame.b), dot(a, frame.n)};
  }
  // The point moves over the surface too.
  void go(const Ways& way) {
    const Eigen::Vector3d uu = in_frame(j.d2pdu2), mixed = in_frame(j.d2pduv), vv = in_frame(j.d2pdv2);
    d.dpdu += uu * way.row(0) + mixed * way.row(1);
    d.dpdv += mixed * way.row(0) + vv * way.row(1);
  }
};

// At this sample of the surface; nothing where it has no frame to turn.
template <int N>
std::optional<FirstOrder<N>> first_order(const PlacedSurface& placed, const Spread<N>& spread,
                                         Sample<double> s) {
  const Status status = s.frame.status;
  if (has(status, Status::no_frame | Status::non_finite_input | Status::overflow | Status::dpdv_zero |
                      Status::parallel))
    return std::nullopt;
  // At a pole the covariance of n is that beside it, where dpdu tells directions apart.
  // A foot may miss it by a rounding.
  const bool at_pole = has(status, Status::dpdu_zero) || norm(s.jet.dpdu) < 1e-9 * norm(s.jet.d2pduv);
  if (at_pole) s = placed.surface.sample(s.u, s.v + (s.v < 0.5 ? 0x1p-20 : -0x1p-20));
  if (has(s.frame.status, Status::no_frame | singular)) return std::nullopt;
  const Vec2<double> uv{s.u, s.v};
  return FirstOrder<N>{placed,
                       spread.covariance,
                       at_pole,
                       uv,
                       s.jet,
                       s.frame,
                       dot(s.jet.dpdu, s.frame.t),
                       dot(s.jet.dpdv, s.frame.t),
                       dot(s.jet.dpdv, s.frame.b),
                       velocities(placed, spread, uv, s.jet, s.frame)};
}

// How the frame turns: its covariance, and whether first order tells n and t at all.
struct Turning {
  Eigen::Matrix3d covariance;
  Eigen::Matrix3d of_dpdu;  // the covariance of dpdu, along t, b, n
  double normal;            // standard deviation, radians
  bool knows_normal, knows_tangent;
};

template <int N>
Turning turning(const FirstOrder<N>& at) {
  const double e = at.e, f = at.f, g = at.g;
  // n stays orthogonal to the partials, t along dpdu: n' = -turn_t b + turn_b t, t' = turn_n b - turn_b n.
  Columns<N> turn(3, at.d.dpdu.cols());
  turn.row(1) = -at.d.dpdu.row(2) / e;
  turn.row(0) = (at.d.dpdv.row(2) + f * turn.row(1)) / g;
  turn.row(2) = at.d.dpdu.row(1) / e;
  Turning result;
  const Columns<N> spread = turn.lazyProduct(at.covariance);
  result.covariance = spread.lazyProduct(turn.transpose());
  // First order holds where three standard deviations change dpdu by less than its length, and n by less than a radian.
  const Columns<N> change_of_dpdu = at.d.dpdu.lazyProduct(at.covariance);
  result.of_dpdu = change_of_dpdu.lazyProduct(at.d.dpdu.transpose());
  const double change = root(result.of_dpdu.trace());
  result.knows_tangent = !at.at_pole && 3 * change < e;
  result.normal = root(result.covariance(0, 0) + result.covariance(1, 1));
  result.knows_normal =
      3 * result.normal < 1 && (result.knows_tangent || pole_has_normal(at.placed.surface, at.uv, at.j));
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

// The frame at uv with its covariance; where the point p stays and its foot moves, p is given, in the surface's axes.
UncertainFrame uncertain_frame(const PlacedSurface& placed, const SurfaceUncertainty& uncertainty,
                               const Vec2<double>& uv, const Vec3<double>* p) {
  const Sample<double> sample = placed.surface.sample(uv.x, uv.y);
  UncertainFrame result = placed_frame(placed, sample);
  result.covariance = Eigen::Vector3d(infinity, infinity, infinity).asDiagonal();
  result.normal_deg = result.tangent_deg = infinity;
  const Spread<any> spread = p ? whole(uncertainty) : without_translation(uncertainty);
  std::optional<FirstOrder<any>> at = first_order(placed, spread, sample);
  if (!at) return result;
  if (p) {
    // The foot x + d n = p stays a foot: (1 - d S) w = -(velocity + d (what turns n towards t, b)), w the foot's way
    // along t and b over the moving surface. [doCarmo2016, sec. 3-3]
    const ShapeOperator<double> s = shape_operator(at->j, at->frame);
    const Velocities<any>& d = at->d;
    const double distance = dot(*p - at->j.position, at->frame.n);
    Eigen::Matrix2d moving;
    moving << 1 - distance * s.a, -distance * s.m, -distance * s.m, 1 - distance * s.c;
    // Nearest points have both eigenvalues positive; at zero, a focal point, the foot is not unique.
    if (!(moving.determinant() > 1e-9 * moving.trace() * moving.trace())) return result;
    Ways way(2, d.dpdu.cols());
    way.row(0) = distance / s.e * d.dpdu.row(2) - d.position.row(0);
    way.row(1) = distance / s.g * (d.dpdv.row(2) - s.f / s.e * d.dpdu.row(2)) - d.position.row(1);
    way = (moving.inverse() * way).eval();
    way.row(1) /= s.g;                                   // now dv
    way.row(0) = (way.row(0) - s.f * way.row(1)) / s.e;  // and du
    at->go(way);
  }
  const Turning turns = turning(*at);
  if (turns.knows_normal) {
    result.normal_deg = turns.normal * degrees;
    result.covariance.topLeftCorner<2, 2>() = turns.covariance.topLeftCorner<2, 2>();
  }
  if (turns.knows_normal && turns.knows_tangent) {
    result.covariance = turns.covariance;
    result.tangent_deg = root(turns.covariance(1, 1) + turns.covariance(2, 2)) * degrees;
  }
  return result;
}

const PlacedSurface& surface_of(const PointFit& fit) {
  if (!fit.surface) throw ParameterError("fit", "has no surface, permitted is a usable fit");
  if (!address(fit.surface->surface))
    throw ParameterError(
        std::string(fit.surface->surface.info().name),
        "has no frames with uncertainty, permitted are the kinds that can be fitted to points");
  return *fit.surface;
}

// The foot on a surface that has no closed form for it. Each thread keeps the grid of the last surface it was asked for,
// and that surface, so that no other has its address.
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
Truth truth_at(const MeshFit& fit, const Spread<N>& spread, const Vec2<double>& stored) {
  const UvConvention& convention = fit.surface.uv;
  const Vec2<double> uv = convention.surface_uv(stored);
  const Sample<double> sample = fit.surface.surface.sample(uv.x, uv.y);
  Truth truth = fit.surface.truth(stored, sample);
  truth.normal_deg = truth.tangent_deg = infinity;
  std::optional<FirstOrder<N>> at = first_order(fit.surface, spread, sample);
  if (!at) return truth;
  // Along stored u: a = M00 dpdu + M10 dpdv.
  const auto& m = convention.affine;
  const Eigen::Vector3d u(at->e, 0, 0), v(at->f, at->g, 0), a = m[0] * u + m[2] * v;
  const Eigen::Index n = spread.covariance.rows(), map = spread.parameters + at->d.parameters;
  if (n > map) {  // the uv map is uncertain as well, and moves the point
    Ways way = Ways::Zero(2, n);
    for (int row = 0; row < 2; ++row) {
      way(row, map + 2 * row) = stored.x;
      way(row, map + 2 * row + 1) = stored.y;
      way(row, map + 4 + row) = 1;
    }
    at->go(way);
  }
  const Turning turns = turning(*at);
  if (!turns.knows_normal) return truth;
  truth.normal_deg = turns.normal * degrees;
  if (!turns.knows_tangent) return truth;
  Eigen::Matrix3d of_a = m[0] * m[0] * turns.of_dpdu;
  if (n > map || m[2] != 0) {
    Columns<N> along = m[0] * at->d.dpdu + m[2] * at->d.dpdv;
    if (n > map) {
      along.col(map) += u;
      along.col(map + 2) += v;
    }
    const Columns<N> change = along.lazyProduct(spread.covariance);
    of_a = change.lazyProduct(along.transpose());
  }
  if (!(9 * of_a.trace() < a.squaredNorm())) return truth;
  const double lengthening = a.dot(of_a * a) / a.squaredNorm();  // what only changes its length
  truth.tangent_deg = root((of_a.trace() - lengthening) / a.squaredNorm()) * degrees;
  return truth;
}

}  // namespace

UncertainFrame frame_near(const PointFit& fit, const Vec3<double>& p) {
  return frame_near(surface_of(fit), fit, p);
}

UncertainFrame frame_near(const PlacedSurface& placed, const SurfaceUncertainty& uncertainty,
                          const Vec3<double>& p) {
  const Vec3<double> local = from_eigen(placed.placement.inverse() * to_eigen(p));
  const auto closed = closed_foot(placed.surface, local);
  const Vec2<double> uv = closed ? *closed : searched_foot(placed.surface, local);
  return uncertain_frame(placed, uncertainty, uv, &local);
}

UncertainFrame frame_at(const PointFit& fit, const Vec2<double>& uv) {
  return uncertain_frame(surface_of(fit), fit, uv, nullptr);
}

Truth truth_at(const MeshFit& fit, const Vec2<double>& stored) {
  return truth_at(fit, without_translation(fit), stored);
}

std::vector<Truth> truths_at(const MeshFit& fit, std::span<const Vec2<double>> stored) {
  const Spread<any> spread = without_translation(fit);
  std::vector<Truth> result;
  result.reserve(stored.size());
  const auto all = [&](const auto& of_size) {
    for (const Vec2<double>& uv : stored) result.push_back(truth_at(fit, of_size, uv));
  };
  // One to three parameters, and plain uvs: the compiler knows all sizes.
  switch (spread.covariance.rows()) {
    case 4:
      all(Spread<4>{fit, spread.parameters, spread.covariance});
      break;
    case 5:
      all(Spread<5>{fit, spread.parameters, spread.covariance});
      break;
    case 6:
      all(Spread<6>{fit, spread.parameters, spread.covariance});
      break;
    default:
      all(spread);
  }
  return result;
}

}  // namespace darboux
