/// \file point.h
/// Evaluates a surface at one point (u, v): partials, frames, status. Nothing here throws or logs. Without
/// NDEBUG, frame(), parametric_frame() and sample() of a surface end the program where checked() of surface.h
/// refuses it, if it has parameters (an adaptor its own numbers), all finite and of type double; jet() and
/// status() do not check.
#pragma once

#include <cmath>

#include <darboux/limit.h>
#include <darboux/surface.h>

namespace darboux {

/// Position and partials at (u, v), for any scalar the formula compiles with. Whole numbers are taken as
/// double.
template <ParametricSurface X, class S>
requires(!std::integral<S>) Jet2<S> jet(const X& surface, const S& u, const S& v) {
  return surface.jet(prepare<X::info.u>(u), prepare<X::info.v>(v));
}

namespace detail {

template <Coordinate kind, class S>
bool outside(const S& x) {
  if constexpr (kind == Coordinate::linear || kind == Coordinate::half_turn)
    return x < S(0) || x > S(1);
  else
    return false;
}

// The bits a surface declares at prepared coordinates.
template <class X, class PU, class PV>
Status declared(const X& surface, const PU& u, const PV& v) {
  if constexpr (DeclaresSingularPoints<X>)
    return surface.singular(u, v);
  else
    return Status::regular;
}

// What status() says of (u, v), also given prepared, where the parameters are finite.
template <class X, std::floating_point S, class PU, class PV>
Status status_of_point(const X& surface, S u, S v, const PU& pu, const PV& pv) {
  if (!std::isfinite(u) || !std::isfinite(v)) return Status::non_finite_input;
  Status result = declared(surface, pu, pv);
  if (outside<X::info.u>(u) || outside<X::info.v>(v)) result |= Status::outside_domain;
  return result;
}

// What status() says of (u, v) given prepared, whatever the parameters.
template <class X, std::floating_point S, class PU, class PV>
Status status_at(const X& surface, S u, S v, const PU& pu, const PV& pv) {
  return parameters_are_finite(surface) ? status_of_point(surface, u, v, pu, pv) : Status::non_finite_input;
}

}  // namespace detail

/// What the surface and the domain say of (u, v), before any frame is made: dpdu_zero, dpdv_zero, parallel,
/// self_intersecting, crease as the surface declares them, outside_domain, non_finite_input (u, v or a
/// parameter).
template <ParametricSurface X, std::floating_point S>
Status status(const X& surface, S u, S v) {
  return detail::status_at(surface, u, v, prepare<X::info.u>(u), prepare<X::info.v>(v));
}

namespace detail {

// The status bits that say that the partials give no frame.
constexpr Status degenerate = Status::dpdu_zero | Status::dpdv_zero | Status::parallel;

// Whether the limits of a surface type come from limit_at(): of those without a closed frame, and of adaptors
// of such.
template <class X>
constexpr bool limits_by_series = [] {
  if constexpr (requires { X::limits_by_series; })
    return X::limits_by_series;
  else
    return !HasClosedFrame<X>;
}();

// Whether a frame made of partials is known to fewer than half the digits: the angle between them magnifies
// their errors, `condition` roundings each.
template <Binary S>
auto is_ill_conditioned(const Jet2<S>& j, const Frame<S>& frame, const S& condition) {
  const S across = dot(j.dpdv, frame.b), size = condition * condition;
  return across * across < S(std::numeric_limits<Element<S>>::epsilon()) * size * dot(j.dpdv, j.dpdv);
}

// The frame at prepared coordinates, `at` what the surface and the domain say of the point, j its jet where
// it has no closed frame.
template <class S, class X, class PU, class PV>
Frame<S> frame_at(const X& surface, const PU& u, const PV& v, Status at, const Jet2<S>& j) {
  Frame<S> result;
  if (has(at, Status::non_finite_input)) {
    result.t = result.b = result.n = nan_vector<S>();
  } else if constexpr (HasClosedFrame<X>) {
    result = surface.frame(u, v);
    if (!finite(result.t) || !finite(result.b) || !finite(result.n)) {
      // A partial that is no number (a user's function), or parameters beyond the sizes the formula is proven
      // for.
      if (!has(result.status, Status::no_frame)) result.status |= Status::no_frame | Status::overflow;
      result.t = result.b = result.n = nan_vector<S>();
    }
    if (has(at, degenerate) && !has(result.status, Status::no_frame)) result.status |= Status::limit_frame;
  } else {
    result = frame_from_partials(j.dpdu, j.dpdv);
    if (has(result.status,
            Status::non_finite_input))  // not the input's doing: overflow, or a user function's NaN
      result.status = Status::no_frame | Status::overflow;
    else if (const Status why = at | (result.status & degenerate); has(why, degenerate)) {
      result = limit_at(surface, j, why, u, v).frame;
      result.status |= why;
    } else {
      S condition(1);
      if constexpr (requires { surface.partials_condition(u, v); })
        condition = surface.partials_condition(u, v);
      if (is_ill_conditioned(j, result, condition)) result.status |= Status::ill_conditioned;
    }
  }
  result.status |= at;
  return result;
}

template <class S, class X, class PU, class PV>
Frame<S> frame_at(const X& surface, const PU& u, const PV& v, Status at) {
  if constexpr (HasClosedFrame<X>)
    return frame_at<S>(surface, u, v, at, Jet2<S>{});
  else
    return frame_at<S>(surface, u, v, at, surface.jet(u, v));
}

// The direction to which x dpdu + y dpdv tends as frame() takes its limit, as a unit vector; zero where the
// series do not tell. For types with limits_by_series; an adaptor asks its base.
template <std::floating_point S, class X, class PU, class PV>
Vec3<S> limit_direction(const X& surface, const PU& u, const PV& v, S x, S y) {
  if constexpr (requires { surface.limit_direction(u, v, x, y); }) {
    return surface.limit_direction(u, v, x, y);
  } else {
    const Status why = frame_at<S>(surface, u, v, declared(surface, u, v)).status & degenerate;
    return limit_at(surface, Jet2<S>(surface.jet(u, v)), why, u, v).direction(x, y);
  }
}

}  // namespace detail

/// The orthonormal frame at (u, v) with its status. In closed form if the surface has one (about 10 ns), else
/// from the partials (about 90 ns). At a singular point of the chart it is the limit along the given u (or
/// v), flagged limit_frame with the bit that says why. Without a closed form the limit comes from the
/// partials' series to third order, which takes 10 to 50 us if the second partials do not suffice; a limit of
/// higher order is not found. If there is no limit, or u, v or a parameter is NaN or infinite, the vectors
/// are NaN. Outside the domain the frame is the analytic extension. It is continuous through a pole: beyond
/// it dpdu = -|dpdu| t.
template <ParametricSurface X, std::floating_point S>
Frame<S> frame(const X& surface, S u, S v) {
  detail::assert_permitted(surface);
  const auto pu = prepare<X::info.u>(u);
  const auto pv = prepare<X::info.v>(v);
  if (!std::isfinite(u) || !std::isfinite(v))
    return detail::frame_at<S>(surface, pu, pv, Status::non_finite_input);
  const auto& here = detail::at_place<3>(surface, pu, pv);
  return detail::frame_at<S>(here, pu, pv, detail::status_at(here, u, v, pu, pv));
}

/// The unit vectors along the coordinate curves, from an orthonormal frame and the partials there. Where dpdu
/// vanishes, t is the limit of frame(); where dpdv vanishes, b is the limit ±d2pduv/|d2pduv| along u, on the
/// side of handedness times the b of frame(), or that where d2pduv vanishes too.
template <std::floating_point S>
ParametricFrame<S> parametric_frame(const Frame<S>& base, const Jet2<S>& j) {
  ParametricFrame<S> result{base.t, base.handedness * base.b, base.n, base.handedness, base.status};
  if (!has(base.status, Status::non_finite_input | Status::no_frame)) {
    const Vec3<S> along_v = unit(j.dpdv), limit = unit(j.d2pduv);
    const S side = base.handedness * dot(limit, base.b);
    if (detail::finite(along_v) && along_v != Vec3<S>{})
      result.b = along_v;
    else if (side > S(0) || side < S(0))
      result.b = side > S(0) ? limit : -limit;
  }
  return result;
}
/// The same at (u, v): where dpdv vanishes, b too is the limit that frame() takes, also one of higher order.
template <ParametricSurface X, std::floating_point S>
ParametricFrame<S> parametric_frame(const X& surface, S u, S v) {
  const Frame<S> base = frame(surface, u, v);
  const Jet2<S> j = jet(surface, u, v);
  ParametricFrame<S> result = parametric_frame(base, j);
  if constexpr (detail::limits_by_series<X>)
    if (has(base.status, Status::limit_frame) && has(base.status, Status::dpdv_zero)) {
      const Vec3<S> b =
          detail::limit_direction(surface, prepare<X::info.u>(u), prepare<X::info.v>(v), S(0), S(1));
      if (b != Vec3<S>{}) result.b = b;
    }
  return result;
}

/// All of it at one point; the status adds `overflow` where a position or partial is not finite for finite
/// input.
template <class S>
struct Sample {
  S u, v;
  Jet2<S> jet;
  Frame<S> frame;  ///< frame.status is the sample's
};
template <std::floating_point S>
Sample<S> make_sample(S u, S v, const Jet2<S>& j, const Frame<S>& frame) {
  Sample<S> result{u, v, j, frame};
  const auto finite = [](const auto&... a) { return (detail::finite(a) && ...); };
  if (!finite(j.position, j.dpdu, j.dpdv, j.d2pdu2, j.d2pduv, j.d2pdv2) &&
      !has(frame.status, Status::non_finite_input))
    result.frame.status |= Status::overflow;
  return result;
}
template <ParametricSurface X, std::floating_point S>
Sample<S> sample(const X& surface, S u, S v) {
  detail::assert_permitted(surface);
  const auto pu = prepare<X::info.u>(u);
  const auto pv = prepare<X::info.v>(v);
  const auto& here = detail::at_place<3>(surface, pu, pv);
  const Jet2<S> j = here.jet(pu, pv);
  return make_sample(u, v, j, detail::frame_at<S>(here, pu, pv, detail::status_at(here, u, v, pu, pv), j));
}

namespace detail {

// Coordinates that are not two of one floating-point type: whole numbers, as in frame(torus, 0, 1), and mixed
// ones. All are taken as double, so that long double is none of them.
template <class U, class V>
concept MixedCoordinates =
    std::is_arithmetic_v<U> && std::is_arithmetic_v<V> && !std::same_as<U, long double> &&
    !std::same_as<V, long double> && !(std::floating_point<U> && std::same_as<U, V>);

}  // namespace detail

/// The functions above for coordinates that are whole numbers or of two types: both are taken as double, and
/// so is the result. Two floats stay floats; long double is not taken.
template <ParametricSurface X, class U, class V>
requires detail::MixedCoordinates<U, V> Jet2<double> jet(const X& surface, U u, V v) {
  return jet(surface, static_cast<double>(u), static_cast<double>(v));
}
template <ParametricSurface X, class U, class V>
requires detail::MixedCoordinates<U, V> Frame<double> frame(const X& surface, U u, V v) {
  return frame(surface, static_cast<double>(u), static_cast<double>(v));
}
template <ParametricSurface X, class U, class V>
requires detail::MixedCoordinates<U, V> ParametricFrame<double> parametric_frame(const X& surface, U u, V v) {
  return parametric_frame(surface, static_cast<double>(u), static_cast<double>(v));
}
template <ParametricSurface X, class U, class V>
requires detail::MixedCoordinates<U, V> Sample<double> sample(const X& surface, U u, V v) {
  return sample(surface, static_cast<double>(u), static_cast<double>(v));
}
template <ParametricSurface X, class U, class V>
requires detail::MixedCoordinates<U, V> Status status(const X& surface, U u, V v) {
  return status(surface, static_cast<double>(u), static_cast<double>(v));
}

// For what is no surface: one error that names the member it lacks.
template <class X, class S>
requires(std::is_class_v<X> && !ParametricSurface<X>) void jet(const X&, const S&, const S&) {
  detail::name_missing_member<X>();
}
template <class X, class S>
requires(std::is_class_v<X> && !ParametricSurface<X>) void frame(const X&, const S&, const S&) {
  detail::name_missing_member<X>();
}
template <class X, class S>
requires(std::is_class_v<X> && !ParametricSurface<X>) void sample(const X&, const S&, const S&) {
  detail::name_missing_member<X>();
}

}  // namespace darboux
