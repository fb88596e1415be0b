/// \file shape_operator.h
/// The shape operator, including poles and collapsed edges, and what follows from it: second form,
/// derivatives of the normal, area element.
#pragma once

#include <cmath>
#include <concepts>
#include <limits>
#include <optional>
#include <type_traits>

#include <darboux/forms.h>
#include <darboux/frame.h>
#include <darboux/multiprecision.h>
#include <darboux/point.h>
#include <darboux/surface.h>

namespace darboux {

/// The shape operator in the orthonormal basis (t, b): S t = a t + m b, S b = m t + c b. Units: 1/length.
/// A sphere of radius r with outward n has a = c = -1/r, m = 0. Also the partials in that basis: dpdu = e t,
/// dpdv = f t + g b; S dpdv = v_t t + v_b b. The _size members are sums of the magnitudes of the terms of a,
/// m, c, v_t and v_b: the rounding error of a is about a_size u.
template <class S>
struct ShapeOperator {
  S a, m, c;
  S e, f, g;
  S v_t, v_b;
  S a_size, m_size, c_size, v_t_size, v_b_size;
};

namespace detail {

// The sum of the sizes of the terms of a · b.
template <class S>
S terms_size(const Vec3<S>& a, const Vec3<S>& b) {
  using std::abs;
  return abs(a.x * b.x) + abs(a.y * b.y) + abs(a.z * b.z);
}

// Whether a product or quotient of non-zero numbers has underflowed: it has lost digits, or is 0.
template <class S>
auto underflows(const S& result, const S& of) {
  using std::abs;
  using T = Element<S>;
  return abs(result) < S(std::numeric_limits<T>::min() / std::numeric_limits<T>::epsilon()) && of != S(0);
}

}  // namespace detail

/// S = [[a, m], [m, c]] from a jet and its orthonormal frame: L = e² a, M = e (f a + g m),
/// N = f² a + 2 f g m + g² c. NaN where dpdu and dpdv span no plane.
template <class S>
ShapeOperator<S> shape_operator(const Jet2<S>& j, const Frame<S>& frame) {
  using std::abs;
  ShapeOperator<S> s;
  s.e = dot(j.dpdu, frame.t);
  s.f = dot(j.dpdv, frame.t);
  s.g = dot(j.dpdv, frame.b);
  // Divide each second derivative once before the dot product, which would underflow near a pole.
  const Vec3<S> along_u = j.d2pdu2 / s.e, mixed = j.d2pduv / s.e, along_v = j.d2pdv2 / s.g;
  const S f = abs(s.f), g = abs(s.g), skew = s.f / s.g, two = lift<S>(2.0);
  const S excess = detail::terms_size(j.dpdv, frame.b) - g;  // what has cancelled in g
  const S u_t = dot(frame.n, along_u), u_t_size = detail::terms_size(frame.n, along_u);
  s.a = u_t / s.e;
  s.a_size = u_t_size / abs(s.e);
  s.v_t = dot(frame.n, mixed);
  s.v_t_size = detail::terms_size(frame.n, mixed);
  s.m = (s.v_t - s.f * s.a) / s.g;
  s.m_size = (s.v_t_size + f * s.a_size + abs(s.m) * excess) / g;
  const S N = dot(frame.n, along_v), N_size = detail::terms_size(frame.n, along_v);
  s.v_b = N - skew * s.v_t;
  s.v_b_size = N_size + abs(skew) * s.v_t_size;
  s.c = (N - s.f * (s.a * skew + two * s.m)) / s.g;
  s.c_size = (N_size + f * (s.a_size * abs(skew) + two * s.m_size) + abs(s.c) * excess) / g;
  if constexpr (detail::Binary<S>) {
    // If partials are long, a and m may underflow although f a and f m matter, so these are computed
    // separately.
    const S g_m = s.v_t - s.f * s.a;
    if (detail::underflows(s.a, u_t) || detail::underflows(s.m, g_m)) [[unlikely]] {
      const S f_a = s.f / s.e * u_t, exact_g_m = s.v_t - f_a, f_a_size = abs(s.f / s.e) * u_t_size;
      s.m = exact_g_m / s.g;
      s.m_size = (s.v_t_size + f_a_size + abs(s.m) * excess) / g;
      s.c = (N - skew * (f_a + two * exact_g_m)) / s.g;
      s.c_size = (N_size + abs(skew) * (S(3) * f_a_size + two * s.v_t_size) + abs(s.c) * excess) / g;
    }
  }
  return s;
}

/// The derivatives of the unit normal (Weingarten's equations): dndu = -S dpdu, dndv = -S dpdv. [doCarmo2016,
/// sec. 3-3]
template <class S>
struct NormalDerivatives {
  Vec3<S> dndu, dndv;
};
template <class S>
NormalDerivatives<S> normal_derivatives(const ShapeOperator<S>& s, const Frame<S>& frame) {
  return {-(s.e * (s.a * frame.t + s.m * frame.b)), -(s.v_t * frame.t + s.v_b * frame.b)};
}

/// |dpdu × dpdv|, the area element dA/(du dv). Units: length².
template <class S>
S area_element(const ShapeOperator<S>& s) {
  using std::abs;
  return abs(s.e * s.g);
}

namespace detail {

// A sum is recomputed by another method if its terms exceed it by more than this factor: for curvatures, and
// (small_cancellation) for quantities that batches do not provide.
inline constexpr double cancellation = 8, small_cancellation = 4;
// large_cancellation: the same if the other method costs some 50 us and the sum is often small because its
// condition is large: for K and H that a surface does not state, and for surfaces defined by data instead of
// parameters, where every number is as uncertain as the terms. cancellation_of_directions: the factor for the
// difference of the principal curvatures, which determines the directions.
inline constexpr double large_cancellation = 0x1p12, cancellation_of_directions = 256;

// A partial at a point with its first and second derivatives along y, from nested dual numbers over (x, y).
template <class S>
struct AlongY {
  Vec3<S> value, first, second;

  explicit AlongY(const Vec3<Dual<Dual<S, 2>, 2>>& p)
      : value{p.x.value.value, p.y.value.value, p.z.value.value},
        first{p.x.value.derivative[1], p.y.value.derivative[1], p.z.value.derivative[1]},
        second{p.x.derivative[1].derivative[1], p.y.derivative[1].derivative[1],
               p.z.derivative[1].derivative[1]} {}
};

// The jets of any surface over nested dual numbers, type-erased so that the code that uses them is compiled
// only once.
template <class S>
struct NestedJets {
  using N = Dual<Dual<S, 2>, 2>;
  const void* surface;
  Jet2<N> (*jet)(const void* surface, const N& u, const N& v);
};

// The limit of the shape operator where the chart collapses along x: P_x = P_xx = 0 there, P_y and P_xy span
// the plane. Let s be the distance from there along y: P_x = s P_xy + ..., P_xx = s P_xxy + s²/2 P_xxyy +
// ..., n = n0 + s n_y + ..., n_y = -S P_y. To first order in s
//   n·P_xy = s (n_y·P_xy + n0·P_xyy),  and by the definition of S  n·P_xy = -n_y·P_x = -s n_y·P_xy,
// so that q = -n_y·t = n0·P_xyy / 2|P_xy| for t = P_xy / |P_xy|. With b = n0 × t and P_y = f t + g b
//   -n_y·P_y = n0·P_yy  gives  -n_y·b = (n0·P_yy - f q)/g,
// and the second order of n·P_xx = |P_x|² (t·S t) gives t·S t. Its first order, n0·P_xxy, must vanish:
// otherwise the normal at this one point depends on x, as at the apex of a cone, and the curvature is
// unbounded.
template <class S>
ShapeOperator<S> shape_operator_at_collapse(const NestedJets<S>& jets, S u, S v, const Jet2<S>& j,
                                            const Frame<S>& frame) {
  using D = Dual<S, 2>;
  using N = Dual<D, 2>;
  constexpr S nan = std::numeric_limits<S>::quiet_NaN();
  constexpr S rounding = S(32) * std::numeric_limits<S>::epsilon();
  const S e = dot(j.dpdu, frame.t), f = dot(j.dpdv, frame.t), g = dot(j.dpdv, frame.b);
  ShapeOperator<S> result{nan, nan, nan, e, f, g, nan, nan, nan, nan, nan, nan, nan};
  // x = (x_u, x_v) is the direction in which the position is constant, y = (-x_v, x_u). Near a collapsed
  // point, where the status has no bit, x is the direction of the smaller partial.
  S x_u = 1, x_v = 0;
  const bool flagged = has(frame.status, Status::dpdu_zero | Status::dpdv_zero | Status::parallel);
  if (has(frame.status, Status::dpdv_zero) || (!flagged && norm(j.dpdv) < norm(j.dpdu))) {
    if (has(frame.status, Status::dpdu_zero)) return result;
    x_u = 0;
    x_v = 1;
  } else if (has(frame.status, Status::parallel) && !has(frame.status, Status::dpdu_zero)) {
    const Vec3<S> d = unit(j.dpdv);
    const Vec2<S> x = unit(Vec2<S>{dot(j.dpdv, d), -dot(j.dpdu, d)});
    x_u = x.x;
    x_v = x.y;
  }
  const auto variable = [](S at, S along_x, S along_y) {
    D inner(at);
    inner.derivative = {along_x, along_y};
    N outer(inner);
    outer.derivative = {D(along_x), D(along_y)};
    return outer;
  };
  const Jet2<N> k = jets.jet(jets.surface, variable(u, x_u, -x_v), variable(v, x_v, x_u));
  const N xu(D{x_u}), xv(D{x_v});
  const AlongY<S> xx(xu * xu * k.d2pdu2 + lift<N>(2.0) * xu * xv * k.d2pduv + xv * xv * k.d2pdv2);
  const AlongY<S> xy(xu * xu * k.d2pduv + xu * xv * (k.d2pdv2 - k.d2pdu2) - xv * xv * k.d2pduv);
  const AlongY<S> y(xu * k.dpdv - xv * k.dpdu);
  const Vec3<S> t = unit(xy.value), n = frame.n, b = cross(n, t);
  const S length = norm(xy.value), sizes = norm(j.d2pdu2) + norm(j.d2pduv) + norm(j.d2pdv2);
  const S y_t = dot(y.value, t), y_b = dot(y.value, b);
  if (!(length > rounding * sizes) || !(norm(xx.value) <= rounding * sizes) ||
      !(std::fabs(dot(n, xx.first)) <= rounding * norm(xx.first)))
    return result;
  const S q = dot(n, xy.first / length) / S(2);
  const S h = (dot(n, y.first) - y_t * q) / y_b;
  const Vec3<S> bend = xx.first / length;
  const S tt = (dot(n, xx.second / length) / S(2) - q * dot(bend, t) - h * dot(bend, b)) / length;
  const S tb = (q - y_t * tt) / y_b;
  const S bb = (h - y_t * tb) / y_b;
  // Rotate from the basis (t, b) used here to that of the frame.
  const S cosine = dot(frame.t, t), sine = dot(frame.t, b);
  result.a = cosine * cosine * tt + S(2) * cosine * sine * tb + sine * sine * bb;
  result.m = cosine * sine * (bb - tt) + (cosine * cosine - sine * sine) * tb;
  result.c = sine * sine * tt - S(2) * cosine * sine * tb + cosine * cosine * bb;
  result.v_t = f * result.a + g * result.m;
  result.v_b = f * result.m + g * result.c;
  result.a_size = result.m_size = result.c_size = S(4) * (std::fabs(tt) + std::fabs(tb) + std::fabs(bb));
  result.v_t_size = result.v_b_size = (std::fabs(f) + std::fabs(g)) * result.m_size;
  return result;
}

// Jet and frame of a surface type, or of an AnySurface, which has them as members. Compiled once per scalar
// type, because compiling over nested dual numbers is slow.
template <class X, class S>
[[gnu::noinline]] auto jet_of(const X& surface, const S& u, const S& v) {
  if constexpr (ParametricSurface<X>)
    return darboux::jet(surface, u, v);
  else
    return surface.jet(u, v);
}
template <class X, class S>
Frame<S> frame_of(const X& surface, S u, S v) {
  if constexpr (ParametricSurface<X>)
    return darboux::frame(surface, u, v);
  else
    return surface.frame(u, v);
}

// Whether a sum cancels to less than a given fraction of its terms.
template <class S>
auto cancels(const S& terms, const S& sum, double most = cancellation) {
  using std::abs;
  return terms > S(static_cast<Element<S>>(most)) * abs(sum);
}
template <class S>
S size_of_both(const S& x, const S& y) {
  using std::abs;
  return abs(x) + abs(y);
}

// Whether a first partial is so small that its square, the magnitude of second partials, is subnormal and so
// has fewer digits.
template <class S>
auto squares_underflow(const S& e, const S& f, const S& g) {
  using std::abs;
  using T = Element<S>;
  const S least(std::ldexp(T(1), std::numeric_limits<T>::min_exponent / 2));
  return abs(e) < least || size_of_both(f, g) < least;
}
// The same for that square times the curvature: second partials may then be 0, as on a plane.
template <class S>
auto second_partials_underflow(const ShapeOperator<S>& s) {
  using std::abs;
  const S e = abs(s.e), g = size_of_both(s.f, s.g), shorter = select(e < g, e, g),
          curvature = abs(s.a) + abs(s.m) + abs(s.c);
  return squares_underflow(s.e, s.f, s.g) || underflows(S(curvature * shorter * shorter), curvature);
}

// Whether the formula of a surface type compiles with 40-digit numbers. A user's formula may not.
template <class X>
constexpr bool runs_in_40_digits = [] {
  if constexpr (ParametricSurface<X>)
    return requires(const X& x, const Prepared<X::info.u, Multiprecision>& u,
                    const Prepared<X::info.v, Multiprecision>& v) {
      x.jet(u, v);
    };
  else
    return true;
}();

// Whether it compiles with nested dual numbers, which poles and collapsed edges require.
template <class X, class S>
constexpr bool runs_over_nested_duals = [] {
  if constexpr (ParametricSurface<X>)
    return requires(const X& x, const Prepared<X::info.u, typename NestedJets<S>::N>& u,
                    const Prepared<X::info.v, typename NestedJets<S>::N>& v) {
      x.jet(u, v);
    };
  else
    return true;
}();

// The jet of a surface at a regular point in 40 digits, and its frame, with t and n oriented as in the given
// frame in S.
struct WideForms {
  Jet2<Multiprecision> jet;
  Frame<Multiprecision> frame;
  ShapeOperator<Multiprecision> shape;

  template <class X, class S>
  WideForms(const X& surface, S u, S v, const Frame<S>& narrow)
      : jet(jet_of(surface, Multiprecision(static_cast<double>(u)), Multiprecision(static_cast<double>(v)))) {
    frame.t = on_side(unit(jet.dpdu), narrow.t);
    frame.n = on_side(unit(cross(jet.dpdu, jet.dpdv)), narrow.n);
    frame.b = cross(frame.n, frame.t);
    frame.status = narrow.status;
    shape = shape_operator(jet, frame);
  }

 private:
  template <class S>
  static Vec3<Multiprecision> on_side(const Vec3<Multiprecision>& a, const Vec3<S>& of) {
    const Multiprecision along = dot(a, lift_vector(of));
    return along < Multiprecision(0.0) ? -a : a;
  }
  template <class S>
  static Vec3<Multiprecision> lift_vector(const Vec3<S>& a) {
    return {static_cast<double>(a.x), static_cast<double>(a.y), static_cast<double>(a.z)};
  }
};

template <class S>
S rounded_to(const Multiprecision& x) {
  return static_cast<S>(x);
}
template <class S>
Vec3<S> rounded_to(const Vec3<Multiprecision>& a) {
  return {static_cast<S>(a.x), static_cast<S>(a.y), static_cast<S>(a.z)};
}
template <class S>
ShapeOperator<S> rounded_to(const ShapeOperator<Multiprecision>& s) {
  const auto r = [](const Multiprecision& x) { return static_cast<S>(x); };
  return {r(s.a),   r(s.m),      r(s.c),      r(s.e),      r(s.f),        r(s.g),       r(s.v_t),
          r(s.v_b), r(s.a_size), r(s.m_size), r(s.c_size), r(s.v_t_size), r(s.v_b_size)};
}
// Whether the shape operator is a limit: see shape_operator below.
inline bool is_limit(Status status) {
  constexpr Status singular = Status::dpdu_zero | Status::dpdv_zero | Status::parallel;
  return has(status, Status::limit_frame) && has(status, singular) && !has(status, Status::no_frame);
}
template <class S>
bool finite(const ShapeOperator<S>& s) {
  return std::isfinite(s.a) && std::isfinite(s.m) && std::isfinite(s.c);
}
template <class X, class S>
ShapeOperator<S> limit_shape_operator(const X& surface, S u, S v, const Jet2<S>& j, const Frame<S>& frame) {
  using N = typename NestedJets<S>::N;
  static_assert(
      runs_over_nested_duals<X, S>,
      "expected template <class S> jet(u, v) of any scalar S; got one that does not take dual "
      "numbers. (From the jet and the frame alone: curvature(j, frame), shape_operator(j, frame).)");
  if constexpr (runs_over_nested_duals<X, S>) {
    const NestedJets<S> jets{&surface, [](const void* x, const N& a, const N& b) {
                               return detail::jet_of(*static_cast<const X*>(x), a, b);
                             }};
    return shape_operator_at_collapse(jets, u, v, j, frame);
  } else {
    return {};
  }
}
// Whether terms at a regular point are out of range, so that the limit at the neighbouring singular point
// replaces it.
template <class S>
bool left_range(const ShapeOperator<S>& s, const Jet2<S>& j, const Frame<S>& frame) {
  return !finite(s) && finite(frame.n) && finite(j.d2pdu2) && finite(j.d2pduv) && finite(j.d2pdv2);
}

// Whether entries of a shape operator have lost digits: of S dpdu = e (a t + m b), S b = m t + c b, S dpdv.
template <class X, class S>
bool loses_digits(const ShapeOperator<S>& s) {
  const auto lost = [](S terms, S x, S y) { return cancels(terms, size_of_both(x, y), small_cancellation); };
  return lost(s.a_size + s.m_size, s.a, s.m) || lost(s.m_size + s.c_size, s.m, s.c) ||
         lost(s.v_t_size + s.v_b_size, s.v_t, s.v_b) || (!HasClosedFrame<X> && cancels(abs(s.f), s.g)) ||
         second_partials_underflow(s);
}

// The shape operator in S; in 40 digits if S overflows or has lost digits.
template <class S>
struct ShapeAt {
  ShapeOperator<S> narrow;
  std::optional<WideForms> wide;

  template <class X>
  ShapeAt(const X& surface, S u, S v, const Jet2<S>& j, const Frame<S>& frame) {
    const bool singular = is_limit(frame.status);
    if (!singular) narrow = shape_operator(j, frame);
    const bool limit = singular || left_range(narrow, j, frame);
    if (limit) narrow = limit_shape_operator(surface, u, v, j, frame);
    if constexpr (runs_in_40_digits<X>)
      if (!singular && (limit ? !finite(narrow) : loses_digits<X>(narrow)))
        wide.emplace(surface, u, v, frame);
  }
};

}  // namespace detail

/// The shape operator of a surface at (u, v), from its jet and frame there. If the frame is flagged
/// limit_frame (poles, collapsed edges), it is the limit, computed from derivatives up to fourth order by
/// nested dual numbers, accurate to a few dozen roundings of its terms. The same is done at regular points so
/// close to such a point that terms overflow or underflow. Elsewhere it is computed from the jet, and again
/// in 40 digits if its terms cancel, if squares of first partials underflow, or if terms are out of range
/// near a point without a limit (see curvature()). NaN if there is no limit: at the apex of a cone and
/// wherever else the curvature is unbounded; where d2pduv vanishes together with dpdu; or where those
/// derivatives do not exist. \param surface a surface type, or AnySurface
template <class X, std::floating_point S>
ShapeOperator<S> shape_operator(const X& surface, S u, S v, const Jet2<S>& j, const Frame<S>& frame) {
  const detail::ShapeAt<S> at(surface, u, v, j, frame);
  return at.wide ? detail::rounded_to<S>(at.wide->shape) : at.narrow;
}

template <class X, std::floating_point S>
requires std::is_class_v<X> ShapeOperator<S> shape_operator(const X& surface, S u, S v) {
  return shape_operator(surface, u, v, detail::jet_of(surface, u, v), detail::frame_of(surface, u, v));
}

template <class X, class U, class V>
requires(detail::MixedCoordinates<U, V>&& std::is_class_v<X>)
    ShapeOperator<double> shape_operator(const X& surface, U u, V v) {
  return shape_operator(surface, static_cast<double>(u), static_cast<double>(v));
}

/// The second form of a surface at (u, v), from its jet and frame there, within the error bound of
/// curvature.h. second_form() of forms.h loses digits if terms cancel; this one is then recomputed in 40
/// digits. \param surface a surface type, or AnySurface
template <class X, std::floating_point S>
SecondForm<S> second_form(const X& surface, S u, S v, const Jet2<S>& j, const Frame<S>& frame) {
  const SecondForm<S> form = second_form(j, frame.n);
  const S terms = detail::terms_size(frame.n, j.d2pdu2) + detail::terms_size(frame.n, j.d2pduv) +
                  detail::terms_size(frame.n, j.d2pdv2);
  if constexpr (detail::runs_in_40_digits<X>)
    if (!has(frame.status, detail::degenerate) &&
        detail::cancels(terms, S(std::fabs(form.L) + std::fabs(form.M) + std::fabs(form.N)),
                        detail::small_cancellation)) {
      const detail::WideForms wide(surface, u, v, frame);
      const SecondForm<Multiprecision> exact = second_form(wide.jet, wide.frame.n);
      return {detail::rounded_to<S>(exact.L), detail::rounded_to<S>(exact.M), detail::rounded_to<S>(exact.N)};
    }
  return form;
}
/// L = n·d2pdu2, M = n·d2pduv, N = n·d2pdv2 at (u, v), lengths. Cost: jet() and frame(), plus 50 us if
/// terms cancel.
template <class X, std::floating_point S>
requires std::is_class_v<X> SecondForm<S> second_form(const X& surface, S u, S v) {
  return second_form(surface, u, v, detail::jet_of(surface, u, v), detail::frame_of(surface, u, v));
}
template <class X, class U, class V>
requires(detail::MixedCoordinates<U, V>&& std::is_class_v<X>) SecondForm<double> second_form(const X& surface,
                                                                                             U u, V v) {
  return second_form(surface, static_cast<double>(u), static_cast<double>(v));
}

/// The derivatives of the normal, from jet and frame.
template <class X, std::floating_point S>
NormalDerivatives<S> normal_derivatives(const X& surface, S u, S v, const Jet2<S>& j, const Frame<S>& frame) {
  const detail::ShapeAt<S> at(surface, u, v, j, frame);
  if (!at.wide) return normal_derivatives(at.narrow, frame);
  const NormalDerivatives<Multiprecision> d = normal_derivatives(at.wide->shape, at.wide->frame);
  return {detail::rounded_to<S>(d.dndu), detail::rounded_to<S>(d.dndv)};
}

/// dndu = -S dpdu, dndv = -S dpdv at (u, v), without units; limits at poles and collapsed edges. Cost: that
/// of shape_operator().
template <class X, std::floating_point S>
requires std::is_class_v<X> NormalDerivatives<S> normal_derivatives(const X& surface, S u, S v) {
  return normal_derivatives(surface, u, v, detail::jet_of(surface, u, v), detail::frame_of(surface, u, v));
}
template <class X, class U, class V>
requires(detail::MixedCoordinates<U, V>&& std::is_class_v<X>)
    NormalDerivatives<double> normal_derivatives(const X& surface, U u, V v) {
  return normal_derivatives(surface, static_cast<double>(u), static_cast<double>(v));
}

}  // namespace darboux
