#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <string>

#include <darboux/error.h>
#include <darboux/fit_points.h>
#include <darboux/forms.h>
#include <darboux/project.h>

#include "closed_foot.h"
#include "parameter_jet.h"

namespace darboux {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double degrees = 180 / std::numbers::pi;
constexpr Status singular = Status::dpdu_zero | Status::dpdv_zero | Status::parallel;

// One column for each component of δ, rows along t, b, n.
using Columns = Eigen::Matrix<double, 3, Eigen::Dynamic, 0, 3, 6 + most_parameters>;

Eigen::Matrix3d cross_matrix(const Eigen::Vector3d& a) {
  Eigen::Matrix3d m;
  m << 0, -a.z(), a.y(), a.z(), 0, -a.x(), -a.y(), a.x(), 0;
  return m;
}

// What δ does to the surface at a fixed (u, v).
struct Velocities {
  Columns position, dpdu, dpdv;
};

Velocities velocities(const PointFit& fit, const Vec2<double>& uv, const Jet2<double>& j,
                      const Frame<double>& frame) {
  const PlacedSurface& placed = *fit.surface;
  const ParameterJet by = parameter_jet(placed.surface, uv);
  Eigen::Matrix3d local;  // takes the surface's axes to t, b, n
  local << to_eigen(frame.t).transpose(), to_eigen(frame.b).transpose(), to_eigen(frame.n).transpose();
  const Eigen::Matrix3d rotation = placed.placement.linear(), to_frame = local * rotation.transpose();
  const Eigen::Vector3d from_centre = placed.placement * to_eigen(j.position) - fit.centre;
  const Eigen::Index n = 6 + by.count;
  Velocities result{Columns(3, n), Columns(3, n), Columns(3, n)};
  const auto rigid = [&](Columns& columns, const Eigen::Vector3d& a) {
    columns.leftCols<3>() = -to_frame * cross_matrix(a);  // ω × a
  };
  rigid(result.position, from_centre);
  rigid(result.dpdu, rotation * to_eigen(j.dpdu));
  rigid(result.dpdv, rotation * to_eigen(j.dpdv));
  result.position.middleCols<3>(3) = to_frame;
  result.dpdu.middleCols<3>(3).setZero();
  result.dpdv.middleCols<3>(3).setZero();
  for (int k = 0; k < by.count; ++k) {
    const auto at = static_cast<std::size_t>(k);
    result.position.col(6 + k) = local * to_eigen(by.position[at]);
    result.dpdu.col(6 + k) = local * to_eigen(by.dpdu[at]);
    result.dpdv.col(6 + k) = local * to_eigen(by.dpdv[at]);
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

// The covariance's part of the frame at uv; where the point p stays and its foot moves, p is given, in the surface's axes.
void add_covariance(const PointFit& fit, const Vec2<double>& given_uv, const Vec3<double>* p,
                    UncertainFrame& result) {
  const AnySurface& surface = fit.surface->surface;
  result.covariance = Eigen::Vector3d(infinity, infinity, infinity).asDiagonal();
  result.normal_deg = result.tangent_deg = infinity;
  if (has(result.status, Status::no_frame | Status::non_finite_input | Status::overflow | Status::dpdv_zero |
                             Status::parallel))
    return;
  // At a pole the covariance of n is that beside it, where dpdu tells directions apart.
  const bool at_pole = has(result.status, Status::dpdu_zero);
  Vec2<double> uv = given_uv;
  if (at_pole) uv.y += uv.y < 0.5 ? 0x1p-20 : -0x1p-20;
  const Jet2<double> j = surface.jet(uv.x, uv.y);
  const Frame<double> frame = surface.frame(uv.x, uv.y);
  if (has(frame.status, Status::no_frame | singular)) return;
  Velocities d = velocities(fit, uv, j, frame);
  if (fit.covariance.rows() != d.dpdu.cols() || fit.covariance.cols() != d.dpdu.cols())
    throw ParameterError("fit", "covariance has " + std::to_string(fit.covariance.rows()) +
                                    " rows, permitted are " + std::to_string(d.dpdu.cols()) + " for a " +
                                    std::string(surface.info().name));
  const ShapeOperator<double> s = shape_operator(j, frame);
  if (p) {
    // The foot x + d n = p stays a foot: (1 - d S) w = -(velocity + d (what turns n towards t, b)), w the foot's way
    // along t and b over the moving surface. [doCarmo2016, sec. 3-3]
    const double distance = dot(*p - j.position, frame.n);
    Eigen::Matrix2d moving;
    moving << 1 - distance * s.a, -distance * s.m, -distance * s.m, 1 - distance * s.c;
    // Nearest points have both eigenvalues positive; at zero, a focal point, the foot is not unique.
    if (!(moving.determinant() > 1e-9 * moving.trace() * moving.trace())) return;
    Eigen::Matrix<double, 2, Eigen::Dynamic, 0, 2, 6 + most_parameters> way(2, d.dpdu.cols());
    way.row(0) = distance / s.e * d.dpdu.row(2) - d.position.row(0);
    way.row(1) = distance / s.g * (d.dpdv.row(2) - s.f / s.e * d.dpdu.row(2)) - d.position.row(1);
    way = (moving.inverse() * way).eval();
    way.row(1) /= s.g;                                   // now dv
    way.row(0) = (way.row(0) - s.f * way.row(1)) / s.e;  // and du
    const auto in_frame = [&](const Vec3<double>& a) {
      return Eigen::Vector3d(dot(a, frame.t), dot(a, frame.b), dot(a, frame.n));
    };
    const Eigen::Vector3d uu = in_frame(j.d2pdu2), mixed = in_frame(j.d2pduv), vv = in_frame(j.d2pdv2);
    d.dpdu += uu * way.row(0) + mixed * way.row(1);
    d.dpdv += mixed * way.row(0) + vv * way.row(1);
  }
  // n stays orthogonal to the partials, t along dpdu: n' = -turn_t b + turn_b t, t' = turn_n b - turn_b n.
  Columns turn(3, d.dpdu.cols());
  turn.row(1) = -d.dpdu.row(2) / s.e;
  turn.row(0) = (d.dpdv.row(2) + s.f * turn.row(1)) / s.g;
  turn.row(2) = d.dpdu.row(1) / s.e;
  const Columns spread = turn.lazyProduct(fit.covariance);
  result.covariance = spread.lazyProduct(turn.transpose());
  const auto root = [](double x) { return std::sqrt(std::fmax(x, 0)); };
  // First order holds where three standard deviations change dpdu by less than its length, and n by less than a radian.
  const double change = root(Columns(d.dpdu.lazyProduct(fit.covariance)).cwiseProduct(d.dpdu).sum());
  const bool tangent = !at_pole && 3 * change < s.e;
  const double normal_deviation = root(result.covariance(0, 0) + result.covariance(1, 1));
  const bool normal = 3 * normal_deviation < 1 && (tangent || pole_has_normal(surface, uv, j));
  if (!normal || !tangent) {
    const Eigen::Matrix2d of_normal = result.covariance.topLeftCorner<2, 2>();
    result.covariance = Eigen::Vector3d(infinity, infinity, infinity).asDiagonal();
    if (normal) result.covariance.topLeftCorner<2, 2>() = of_normal;
  }
  if (normal) result.normal_deg = normal_deviation * degrees;
  if (normal && tangent)
    result.tangent_deg = root(result.covariance(1, 1) + result.covariance(2, 2)) * degrees;
}

const PlacedSurface& surface_of(const PointFit& fit) {
  if (!fit.surface) throw ParameterError("fit", "has no surface, permitted is a usable fit");
  if (!address(fit.surface->surface))
    throw ParameterError(
        std::string(fit.surface->surface.info().name),
        "has no frames with uncertainty, permitted are the kinds that can be fitted to points");
  return *fit.surface;
}

UncertainFrame placed_frame(const PlacedSurface& placed, const Vec2<double>& uv) {
  const Sample<double> s = placed.surface.sample(uv.x, uv.y);
  const Eigen::Matrix3d rotation = placed.placement.linear();
  const auto turned = [&](const Vec3<double>& a) { return from_eigen(rotation * to_eigen(a)); };
  UncertainFrame result;
  result.uv = uv;
  result.position = from_eigen(placed.placement * to_eigen(s.jet.position));
  result.t = turned(s.frame.t);
  result.b = turned(s.frame.b);
  result.n = turned(s.frame.n);
  result.status = s.frame.status;
  return result;
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

}  // namespace

UncertainFrame frame_near(const PointFit& fit, const Vec3<double>& p) {
  const PlacedSurface& placed = surface_of(fit);
  const Vec3<double> local = from_eigen(placed.placement.inverse() * to_eigen(p));
  const auto closed = closed_foot(placed.surface, local);
  const Vec2<double> uv = closed ? *closed : searched_foot(placed.surface, local);
  UncertainFrame result = placed_frame(placed, uv);
  add_covariance(fit, uv, &local, result);
  return result;
}

UncertainFrame frame_at(const PointFit& fit, const Vec2<double>& uv) {
  UncertainFrame result = placed_frame(surface_of(fit), uv);
  add_covariance(fit, uv, nullptr, result);
  return result;
}

}  // namespace darboux
