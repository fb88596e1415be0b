#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include <darboux/cone.h>
#include <darboux/cylinder.h>
#include <darboux/disk.h>
#include <darboux/ellipsoid.h>
#include <darboux/plane.h>
#include <darboux/sphere.h>
#include <darboux/tile_bounds.h>
#include <darboux/torus.h>

#include "enclosed.h"

namespace darboux {
namespace {

using namespace tiles;
using EnclosedTile = std::shared_ptr<const Enclosed>;

constexpr double pi = std::numbers::pi, tau = 2 * pi;
constexpr double rounding = 0x1p-49;  // 16u: of a bound, relative to the size of its terms
constexpr double infinity = std::numeric_limits<double>::infinity();

Arc turns(double from, double to) {
  const Turn<double> a = sincos_turns(from), b = sincos_turns(to);
  return {tau * from, tau * to, a.sin, a.cos, b.sin, b.cos};
}

// v of a sphere as the latitude.
Arc latitudes(double from, double to) {
  const Turn<double> a = sincos_half_turns(from), b = sincos_half_turns(to);
  return {pi * (from - 0.5), pi * (to - 0.5), -a.cos, a.sin, -b.cos, b.sin};
}

// Like std::fmax, which would be a function call; NaN if the first is.
double larger(double a, double b) {
  return a < b ? b : a;
}

double most_absolute(double a, double b) {
  return larger(std::fabs(a), std::fabs(b));
}

// The largest |sin x| and |cos x| over an arc.
double most_sine(const Arc& arc) {
  return std::fmin(std::fmax(arc.most(0, 1), arc.most(0, -1)), 1);
}
double most_cosine(const Arc& arc) {
  return std::fmin(std::fmax(arc.most(1, 0), arc.most(-1, 0)), 1);
}

// An upper bound of its length, at most 1.74 times that.
double sum_of(const Vec3<double>& d) {
  return std::fabs(d.x) + std::fabs(d.y) + std::fabs(d.z);
}

// The length of (a, b). hypot is slow, and only needed where squares leave the range of double.
double length_of(double a, double b) {
  const double square = a * a + b * b;
  return square > 1e-280 && square < 1e280 ? std::sqrt(square) : std::hypot(a, b);
}

double size_of(const RoundProfile& s) {
  return s.major_radius + s.radius;
}
double size_of(const ScaledSphere& s) {
  return s.axes.x + s.axes.y + s.axes.z;
}
double size_of(const StraightProfile& s) {
  return most_absolute(s.rho[0], s.rho[1]) + most_absolute(s.z[0], s.z[1]);
}
double size_of(const Rectangle& s) {
  return most_absolute(s.x[0], s.x[1]) + most_absolute(s.y[0], s.y[1]);
}
double size_of(const EnclosedTile&) {
  return 0;  // intervals have their rounding in them
}

// ---- support ----------------------------------------------------------------------------------------------

double most_along(const RoundProfile& s, const Vec3<double>& d) {
  const double m = s.round.most(d.x, d.y);  // ρ >= 0, so that the outermost φ is best everywhere
  return m * s.major_radius + s.radius * s.profile.most(m, d.z);
}
double most_along(const ScaledSphere& s, const Vec3<double>& d) {
  return s.profile.most(s.round.most(d.x * s.axes.x, d.y * s.axes.y), d.z * s.axes.z);
}
double most_along(const StraightProfile& s, const Vec3<double>& d) {
  const double m = s.round.most(d.x, d.y);
  return larger(m * s.rho[0] + d.z * s.z[0], m * s.rho[1] + d.z * s.z[1]);
}
double most_along(const Rectangle& s, const Vec3<double>& d) {
  return larger(d.x * s.x[0], d.x * s.x[1]) + larger(d.y * s.y[0], d.y * s.y[1]);
}

double most_along(const EnclosedTile& s, const Vec3<double>& d) {
  return enclosed_support(*s, d);
}

// ---- facing -----------------------------------------------------------------------------------------------

// The maximum of a cos x + b sin x over the part of an arc where cos x >= 0 (outer), or where cos x <= 0.
double most_of_side(const Arc& arc, bool outer, double a, double b) {
  double most = -infinity;
  const double first = outer ? -0.25 : 0.25;  // a half turn from there, and those a turn further
  for (double k = std::floor(arc.from / tau - 1); tau * (k + first) <= arc.to; ++k) {
    const double from = larger(arc.from, tau * (k + first)), to = std::fmin(arc.to, tau * (k + first + 0.5));
    if (from > to) continue;
    // The ends are those of the arc, or the points where cos x is 0.
    const double sign = outer ? -1 : 1;
    const bool own_from = from == arc.from, own_to = to == arc.to;
    const Arc piece{from,
                    to,
                    own_from ? arc.sin_from : sign,
                    own_from ? arc.cos_from : 0,
                    own_to ? arc.sin_to : -sign,
                    own_to ? arc.cos_to : 0};
    most = larger(most, piece.most(a, b));
  }
  return most;
}

// The maximum of n·E - offset·(n·P), offset 1 for an eye, 0 for a direction.
double most_facing(const RoundProfile& s, const Vec3<double>& e, double offset) {
  const double R = offset * s.major_radius;
  if (s.major_radius == 0)  // a sphere, on which cos x >= 0
    return s.profile.most(s.round.most(e.x, e.y), e.z) - offset * s.radius;
  const double outer = most_of_side(s.profile, true, s.round.most(e.x, e.y) - R, e.z),
               inner = most_of_side(s.profile, false, -s.round.most(-e.x, -e.y) - R, e.z);
  return larger(outer, inner) - offset * s.radius;
}
// A point S of the unit sphere has the normal N = (x/a, y/b, z/c), and N·P = 1. |N| lies between 1 over the
// longest axis and 1 over the shortest.
double most_facing(const ScaledSphere& s, const Vec3<double>& e, double offset) {
  const Vec3<double> scaled{e.x / s.axes.x, e.y / s.axes.y, e.z / s.axes.z};
  const double most = s.profile.most(s.round.most(scaled.x, scaled.y), scaled.z) - offset +
                      rounding * (sum_of(scaled) + offset);
  return most * (most < 0 ? s.shortest() : s.longest());
}
double most_facing(const StraightProfile& s, const Vec3<double>& e, double offset) {
  return s.n_rho * s.round.most(e.x, e.y) + s.n_z * e.z - offset * s.height_over_normal;
}
double most_facing(const Rectangle&, const Vec3<double>& e, double) {
  return e.z;
}

double most_facing(const EnclosedTile& s, const Vec3<double>& e, double offset) {
  return enclosed_facing(*s, e, offset);
}

// ---- resolution -------------------------------------------------------------------------------------------

TileRates rates_of(const RoundProfile& s) {
  const double per_v = s.major_radius == 0 ? pi : tau, rho = s.major_radius + s.radius * s.profile.most(1, 0);
  // n = (cos x cos φ, cos x sin φ, sin x), t = (-sin φ, cos φ, 0),
  // b = (-sin x cos φ, -sin x sin φ, cos x)
  const double sine = most_sine(s.profile), cosine = most_cosine(s.profile),
               bend = tau * tau * std::fmin(sine * cosine, 0.5);
  return {.position_uu = tau * tau * rho,
          .position_uv = tau * per_v * s.radius * sine,
          .position_vv = per_v * per_v * s.radius,
          .frame_u = tau,
          .frame_v = per_v,
          .normal_u = tau * cosine,
          .normal_v = per_v,
          .normal_uu = bend,
          .normal_uv = tau * per_v * sine,
          .normal_vv = 0,
          .frame_uu = bend,
          .frame_uv = tau * per_v * std::fmax(sine, cosine),
          .frame_vv = 0};
}
TileRates rates_of(const ScaledSphere& s) {
  TileRates r = s.enclosed ? enclosed_rates(*s.enclosed) : TileRates{};
  const auto square = [](double x) { return x * x; };
  const double sine_u = square(most_sine(s.round)), cosine_u = square(most_cosine(s.round)),
               sine_v = square(most_sine(s.profile)), cosine_v = square(most_cosine(s.profile)),
               x = square(s.axes.x), y = square(s.axes.y), z = square(s.axes.z);
  // The maximum of x cos² + y sin² over an arc, linear in either square.
  const auto most = [](double x, double y, double cosine, double sine) {
    return x > y ? y + (x - y) * cosine : x + (y - x) * sine;
  };
  const double along = most(x, y, cosine_u, sine_u), across = most(x, y, sine_u, cosine_u);
  r.position_uu = std::fmin(r.position_uu, tau * tau * std::sqrt(along * cosine_v));
  r.position_uv = std::fmin(r.position_uv, tau * pi * std::sqrt(across * sine_v));
  r.position_vv = std::fmin(r.position_vv, pi * pi * std::sqrt(most(along, z, cosine_v, sine_v)));
  // n = m/|m| with m the point of the sphere divided by the axes: |dn| <= |dm|/|m|, and |m| >= 1/longest.
  r.normal_u =
      std::fmin(r.normal_u, tau * most_cosine(s.profile) * s.longest() / std::fmin(s.axes.x, s.axes.y));
  r.normal_v = std::fmin(r.normal_v, pi * s.longest() / s.shortest());
  return r;
}
TileRates rates_of(const StraightProfile& s) {
  // All turns round the axis: n = (n_rho cos φ, n_rho sin φ, n_z), t = (-sin φ, cos φ, 0),
  // b = (-n_z cos φ, -n_z sin φ, n_rho)
  const double bend = tau * tau * std::fabs(s.n_rho * s.n_z);
  return {.position_uu = tau * tau * most_absolute(s.rho[0], s.rho[1]),
          .position_uv = s.rate_uv,
          .position_vv = 0,
          .frame_u = tau,
          .frame_v = 0,
          .normal_u = tau * std::fabs(s.n_rho),
          .normal_v = 0,
          .normal_uu = bend,
          .normal_uv = 0,
          .normal_vv = 0,
          .frame_uu = bend,
          .frame_uv = 0,
          .frame_vv = 0};
}
TileRates rates_of(const Rectangle&) {
  return {0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0};
}
TileRates rates_of(const EnclosedTile& s) {
  return enclosed_rates(*s);
}
TileRates rates_of(std::monostate) {
  return {};
}

constexpr double upward = 1 + 0x1p-48;  // for the rounding of the products below

// The error of linear interpolation, from second derivatives.
double interpolation_error(double uu, double uv, double vv, double du, double dv) {
  const double error = upward * (uu * du * du + 2 * uv * std::fabs(du * dv) + vv * dv * dv) / 8;
  return std::isnan(error) ? infinity : error;
}
double half_turning(double u, double v, double du, double dv) {
  const double turning = upward * (u * std::fabs(du) + v * std::fabs(dv)) / 2;
  return std::isnan(turning) ? infinity : turning;
}
// The angle of the interpolated unit vector, from the error across it and half its turning within the cell.
double interpolation_angle(double across, double half) {
  // (asin x - x)/x³ increases with x
  const double first = half < 1 ? half + (pi / 2 - 1) * half * half * half : infinity,
               length = 1 - half * half / 2;
  return upward * (length > 0 ? std::fmin(first, (across + half * half * half / 6) / length) : first);
}

template <class Shape, class F>
double of_known(const Shape& shape, F f) {
  return std::visit(
      [&](const auto& s) {
        if constexpr (std::is_same_v<std::remove_cvref_t<decltype(s)>, std::monostate>)
          return infinity;
        else {
          const double bound = f(s);
          return std::isnan(bound) ? infinity : bound;
        }
      },
      shape);
}

bool is_within(const Tile& t, bool periodic_u, bool periodic_v) {
  const auto within = [](double from, double to, bool periodic) {
    return from <= to && (periodic ? to <= from + 1 && std::fabs(from) < 0x1p20 : from >= 0 && to <= 1);
  };
  return within(t.u0, t.u1, periodic_u) && within(t.v0, t.v1, periodic_v);
}

bool is_periodic(Coordinate c) {
  return c == Coordinate::turn || c == Coordinate::twisted_turn;
}

StraightProfile straight(double rho_from, double rho_to, double height, const Tile& t, double n_rho,
                         double n_z, double n_dot_p) {
  const auto at = [&](double v) { return rho_from + (rho_to - rho_from) * v; };
  const double drop = std::fabs(rho_to - rho_from);
  return {{at(t.v0), at(t.v1)}, {height * t.v0, height * t.v1}, n_rho,     n_z, n_dot_p,
          turns(t.u0, t.u1),    std::hypot(drop, height),       tau * drop};
}

}  // namespace

double tiles::Arc::most(double a, double b) const {
  const double first = a * cos_from + b * sin_from, last = a * cos_to + b * sin_to,
               ends = first < last ? last : first;
  if (to - from >= tau) return length_of(a, b);
  // The cross products tell on which side of the two ends (a, b) lies, up to the rounding of angles and
  // sines. An arc of at most half a turn contains the maximum between its ends; a longer one contains it
  // unless it lies between the ends on the other side.
  const double slack = rounding * (1 + std::fabs(from) + std::fabs(to)) * (std::fabs(a) + std::fabs(b));
  const bool after = b * cos_from - a * sin_from >= -slack, before = a * sin_to - b * cos_to >= -slack;
  const bool within = to - from <= tau / 2 ? after && before && ends >= -slack : after || before;
  return within || std::isnan(ends) ? length_of(a, b) : ends;
}

TileBounds::TileBounds(const AnySurface& surface, const Tile& t, TileOrder order) {
  if (!std::isfinite(t.u0 + t.u1 + t.v0 + t.v1) ||
      !is_within(t, is_periodic(surface.info().u), is_periodic(surface.info().v)))
    return;
  const auto moderate = [](auto... x) { return ((std::fabs(x) < 1e100) && ...); };
  const auto on_intervals = [&]() -> EnclosedTile {
    for (const ParameterValue& p : surface.parameters())
      if (!moderate(p.value)) return nullptr;
    return enclose(surface, t, order);
  };
  if (const auto* s = surface.get<Sphere<>>()) {
    if (moderate(s->radius)) shape_ = RoundProfile{0, s->radius, turns(t.u0, t.u1), latitudes(t.v0, t.v1)};
    return;
  }
  if (const auto* s = surface.get<Torus<>>(); s && s->major_radius >= s->minor_radius) {
    if (moderate(s->major_radius, s->minor_radius))
      shape_ = RoundProfile{s->major_radius, s->minor_radius, turns(t.u0, t.u1), turns(t.v0, t.v1)};
    return;
  }
  if (const auto* s = surface.get<Ellipsoid<>>()) {
    if (moderate(s->semi_axis_x, s->semi_axis_y, s->semi_axis_z))
      shape_ = ScaledSphere{{s->semi_axis_x, s->semi_axis_y, s->semi_axis_z},
                            turns(t.u0, t.u1),
                            latitudes(t.v0, t.v1),
                            order == TileOrder::position ? nullptr : enclose(surface, t, order)};
    return;
  }
  if (const auto* s = surface.get<Cylinder<>>()) {
    if (moderate(s->radius, s->height))
      shape_ = straight(s->radius, s->radius, s->height, t, 1, 0, s->radius);
    return;
  }
  if (const auto* s = surface.get<Cone<>>()) {
    const double l = std::hypot(s->radius, s->height);
    if (moderate(l))
      shape_ = straight(s->radius, 0, s->height, t, s->height / l, s->radius / l, s->height / l * s->radius);
    return;
  }
  if (const auto* s = surface.get<Disk<>>()) {
    if (moderate(s->outer_radius, s->inner_radius))
      shape_ = straight(s->outer_radius, s->inner_radius, 0, t, 0, 1, 0);
    return;
  }
  if (const auto* s = surface.get<Plane<>>()) {
    if (moderate(s->width, s->depth))
      shape_ = Rectangle{{s->width * (t.u0 - 0.5), s->width * (t.u1 - 0.5)},
                         {s->depth * (t.v0 - 0.5), s->depth * (t.v1 - 0.5)}};
    return;
  }
  if (EnclosedTile enclosed = on_intervals()) shape_ = std::move(enclosed);
}

bool TileBounds::attained() const {
  return known() && !std::holds_alternative<EnclosedTile>(shape_);
}

double TileBounds::facing_rate() const {
  if (const auto* s = std::get_if<ScaledSphere>(&shape_)) return s->longest() / s->shortest();
  return attained() ? 1 : infinity;
}

double TileBounds::support(const Vec3<double>& d) const {
  return of_known(shape_,
                  [&](const auto& s) { return most_along(s, d) + rounding * sum_of(d) * size_of(s); });
}

double TileBounds::facing(const Vec3<double>& eye) const {
  return of_known(
      shape_, [&](const auto& s) { return most_facing(s, eye, 1) + rounding * (sum_of(eye) + size_of(s)); });
}

double TileBounds::facing_along(const Vec3<double>& d) const {
  return of_known(shape_, [&](const auto& s) { return most_facing(s, d, 0) + rounding * sum_of(d); });
}

TileRates TileBounds::rates() const {
  TileRates r = std::visit([](const auto& s) { return rates_of(s); }, shape_);
  for (double* rate :
       {&r.position_uu, &r.position_uv, &r.position_vv, &r.frame_u, &r.frame_v, &r.frame_uu, &r.frame_uv,
        &r.frame_vv, &r.normal_u, &r.normal_v, &r.normal_uu, &r.normal_uv, &r.normal_vv})
    *rate = std::isnan(*rate) ? infinity : upward * *rate;
  return r;
}

double TileRates::chord(double du, double dv) const {
  return interpolation_error(position_uu, position_uv, position_vv, du, dv);
}
double TileRates::normal_interpolation_angle(double du, double dv) const {
  return interpolation_angle(interpolation_error(normal_uu, normal_uv, normal_vv, du, dv),
                             half_turning(normal_u, normal_v, du, dv));
}
double TileRates::frame_interpolation_angle(double du, double dv) const {
  return interpolation_angle(interpolation_error(frame_uu, frame_uv, frame_vv, du, dv),
                             half_turning(frame_u, frame_v, du, dv));
}

double TileBounds::chord(double du, double dv) const {
  return rates().chord(du, dv);
}
double TileBounds::normal_angle(double du, double dv) const {
  const TileRates r = rates();
  return half_turning(r.normal_u, r.normal_v, du, dv);
}
double TileBounds::frame_angle(double du, double dv) const {
  const TileRates r = rates();
  return half_turning(r.frame_u, r.frame_v, du, dv);
}

}  // namespace darboux
