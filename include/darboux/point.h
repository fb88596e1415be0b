/// \file point.h
/// Evaluates a surface at one point (u, v): partials, frames, status. Nothing here throws or logs. Without
/// NDEBUG, frame(), parametric_frame() and sample() terminate the program if checked() of surface.h rejects
/// the surface's parameters (for an adaptor, also its own numbers) and these are all finite and of type
/// double. jet() and status() do not check.
#pragma once

#include <cmath>

#include <darboux/limit.h>
#include <darboux/surface.h>

namespace darboux {

/// Position and partials at (u, v), for any scalar type that the formula compiles with. Integers are
/// converted to double.
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

// The result of status() at (u, v), for finite parameters. pu, pv: the prepared coordinates.
template <class X, std::floating_point S, class PU, class PV>
Status status_of_point(const X& surface, S u, S v, const PU& pu, const PV& pv) {
  if (!std::isfinite(u) || !std::isfinite(v)) return Status::non_finite_input;
  Status result = declared(surface, pu, pv);
  if (outside<X::info.u>(u) || outside<X::info.v>(v)) result |= Status::outside_domain;
  return result;
}

// The result of status() at (u, v), for any parameters. pu, pv: the prepared coordinates.
template <class X, std::floating_point S, class PU, class PV>
Status status_at(const X& surface, S u, S v, const PU& pu, const PV& pv) {
  return parameters_are_finite(surface) ? status_of_point(surface, u, v, pu, pv) : Status::non_finite_input;
}

}  // namespace detail

/// The status bits that are known at (u, v) without computing a frame: dpdu_zero, dpdv_zero, parallel,
/// self_intersecting and crease as the surface declares them; outside_domain; non_finite_input (u, v or a
/// parameter).
template <ParametricSurface X, std::floating_point S>
Status status(const X& surface, S u, S v) {
  return detail::status_at(surface, u, v, prepare<X::info.u>(u), prepare<X::info.v>(v));
}

namespace detail {

// The status bits for which the partials give no frame.
constexpr Status degenerate = Status::dpdu_zero | Status::dpdv_zero | Status::parallel;

// Whether limit_at() computes the limits of a surface type: true for types without a closed frame, and for
// adaptors of them.
template <class X>
constexpr bool limits_by_series = [] {
  if constexpr (requires { X::limits_by_series; })
    return X::limits_by_series;
  else
    return !HasClosedFrame<X>;
}();

// Whether a frame computed from partials is accurate to fewer than half the digits. Each partial errs by
// `condition` roundings, amplified by 1/sin of the angle between them.
template <Binary S>
auto is_ill_conditioned(const Jet2<S>& j, const Frame<S>& frame, const S& condition) {
  const S across = dot(j.dpdv, frame.b), size = condition * condition;
  return across * across < S(std::numeric_limits<Element<S>>::epsilon()) * size * dot(j.dpdv, j.dpdv);
}

// The frame at prepared coordinates. at: the result of status(). j: the jet, used only without a closed
// frame.
template <class S, class X, class PU, class PV>
Frame<S> frame_at(const X& surface, const PU& u, const PV& v, Status at, const Jet2<S>& j) {
  Frame<S> result;
  if (has(at, Status::non_finite_input)) {
    result.t = result.b = result.n = nan_vector<S>();
  } else if constexpr (HasClosedFrame<X>) {
    result = surface.frame(u, v);
    if (!finite(result.t) || !finite(result.b) || !finite(result.n)) {
      // A NaN partial (from a user's function), or parameters beyond the magnitudes proven for the formula.
      if (!has(result.status, Status::no_frame)) result.status |= Status::no_frame | Status::overflow;
      result.t = result.b = result.n = nan_vector<S>();
    }
    if (has(at, degenerate) && !has(result.status, Status::no_frame)) result.status |= Status::limit_frame;
  } else {
    result = frame_from_partials(j.dpdu, j.dpdv);
    if (has(result.status,
            Status::non_finite_input))  // the input is finite: overflow, or NaN from a user's function
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

// The unit vector to which the direction of x dpdu + y dpdv tends in the limit of frame(); zero if the series
// do not determine it. For types with limits_by_series; an adaptor delegates to its base.
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

/// The orthonormal frame at (u, v) with its status: in closed form if the surface has one (about 10 ns),
/// otherwise from the partials (about 90 ns). At a singular point of the chart it is the limit along the
/// given u (or v), flagged limit_frame together with the reason (dpdu_zero, dpdv_zero or parallel). Without a
/// closed form, the limit is computed from Taylor series of the partials up to third order, which takes 10 to
/// 50 us if the second partials do not suffice; limits of higher order are not found. The vectors are NaN if
/// there is no limit, or if u, v or a parameter is NaN or infinite. Outside the domain, the frame is
/// continued analytically. It is continuous through a pole: beyond it, dpdu = -|dpdu| t.
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

/// The unit tangents of the coordinate curves, from the orthonormal frame and the jet at a point. Where dpdu
/// vanishes, t is the limit of frame(). Where dpdv vanishes, b is the limit along u, ±d2pduv/|d2pduv|, with
/// the sign that agrees with handedness times the b of frame(). Where d2pduv vanishes too, b is handedness
/// times the b of frame().
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
/// The same at (u, v). Where dpdv vanishes, b is the limit that frame() takes, even one of higher order.
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

/// Jet, frame and status at one point. The status has `overflow` if a position or partial is not finite
/// although the input is.
template <class S>
struct Sample {
  S u, v;
  Jet2<S> jet;
  Frame<S> frame;  ///< frame.status is the status of the sample
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

// Coordinates that are not of one floating-point type: integers, as in frame(torus, 0, 1), or mixed types.
// They are converted to double, so long double is excluded.
template <class U, class V>
concept MixedCoordinates =
    std::is_arithmetic_v<U> && std::is_arithmetic_v<V> && !std::same_as<U, long double> &&
    !std::same_as<V, long double> && !(std::floating_point<U> && std::same_as<U, V>);

}  // namespace detail

/// The functions above for integer or mixed coordinates: both are converted to double, and the result is in
/// double. Two floats stay floats; long double is not accepted.
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

// For types that are not surfaces: a single compile error that names the missing member.
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
