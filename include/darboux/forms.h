/// \file forms.h
/// First and second fundamental form and what follows from them: shape operator, Gaussian, mean and principal
/// curvatures, derivatives of the normal, Christoffel symbols, and the Darboux frame of a curve.
#pragma once

#include <cmath>
#include <concepts>
#include <limits>

#include <darboux/frame.h>
#include <darboux/point.h>
#include <darboux/surface.h>

namespace darboux {

/// E = dpdu·dpdu, F = dpdu·dpdv, G = dpdv·dpdv. Units: length².
template <class S>
struct FirstForm {
  S E, F, G;
};

/// L = n·d2pdu2, M = n·d2pduv, N = n·d2pdv2. Units: length. With n outward a sphere has L, N < 0.
template <class S>
struct SecondForm {
  S L, M, N;
};

template <class S>
FirstForm<S> first_form(const Jet2<S>& j) {
  return {dot(j.dpdu, j.dpdu), dot(j.dpdu, j.dpdv), dot(j.dpdv, j.dpdv)};
}

/// \param n the unit normal to which the signs refer
template <class S>
SecondForm<S> second_form(const Jet2<S>& j, const Vec3<S>& n) {
  return {dot(n, j.d2pdu2), dot(n, j.d2pduv), dot(n, j.d2pdv2)};
}

/// K = (LN - M²)/(EG - F²) and H = (EN - 2FM + GL)/(2(EG - F²)) as the literature writes them; any scalar,
/// regular points, radii whose fourth power is representable. curvature() below is the robust form.
/// [doCarmo2016, sec. 3-3]
template <class S>
S gaussian_curvature(const FirstForm<S>& I, const SecondForm<S>& II) {
  return (II.L * II.N - II.M * II.M) / (I.E * I.G - I.F * I.F);
}
template <class S>
S mean_curvature(const FirstForm<S>& I, const SecondForm<S>& II) {
  return (I.E * II.N - lift<S>(2.0) * (I.F * II.M) + I.G * II.L) / (lift<S>(2.0) * (I.E * I.G - I.F * I.F));
}

/// The shape operator in the orthonormal basis (t, b): S t = a t + m b, S b = m t + c b. Units: 1/length.
/// With n outward a sphere of radius r has a = c = -1/r, m = 0. Beside it the partials in that basis: dpdu =
/// e t, dpdv = f t + g b; and m_size, the size of the terms whose sum is m: rounding leaves some m_size u.
template <class S>
struct ShapeOperator {
  S a, m, c;
  S e, f, g;
  S m_size;
};

/// S = [[a, m], [m, c]] from a jet and its orthonormal frame: L = e² a, M = e (f a + g m), N = f² a + 2 f g m
/// + g² c. NaN where dpdu and dpdv span no plane.
template <class S>
ShapeOperator<S> shape_operator(const Jet2<S>& j, const Frame<S>& frame) {
  using std::abs;
  ShapeOperator<S> s;
  s.e = dot(j.dpdu, frame.t);
  s.f = dot(j.dpdv, frame.t);
  s.g = dot(j.dpdv, frame.b);
  // Each second derivative is divided once before the dot product, which near a pole would underflow.
  s.a = dot(frame.n, j.d2pdu2 / s.e) / s.e;
  const Vec3<S> mixed = j.d2pduv / s.e;
  s.m = (dot(frame.n, mixed) - s.f * s.a) / s.g;
  s.m_size =
      (abs(frame.n.x * mixed.x) + abs(frame.n.y * mixed.y) + abs(frame.n.z * mixed.z) + abs(s.f * s.a)) /
      abs(s.g);
  s.c = (dot(frame.n, j.d2pdv2 / s.g) - s.f * (s.a * (s.f / s.g) + lift<S>(2.0) * s.m)) / s.g;
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
  const Vec3<S> St = s.a * frame.t + s.m * frame.b, Sb = s.m * frame.t + s.c * frame.b;
  return {-(s.e * St), -(s.f * St + s.g * Sb)};
}

/// |dpdu × dpdv|, the area element dA/(du dv). Units: length².
template <class S>
S area_element(const ShapeOperator<S>& s) {
  using std::abs;
  return abs(s.e * s.g);
}

/// The Christoffel symbols Γ^k_ij: d2p/(di dj) = Γ^u_ij dpdu + Γ^v_ij dpdv + (normal part). u[0], u[1], u[2]
/// are Γ^u_uu, Γ^u_uv, Γ^u_vv, v[...] likewise Γ^v. Without units. NaN where dpdu and dpdv span no plane.
/// [doCarmo2016, sec. 4-3]
template <class S>
struct Christoffel {
  S u[3], v[3];
};
template <class S>
Christoffel<S> christoffel(const Jet2<S>& j, const Frame<S>& frame) {
  const S e = dot(j.dpdu, frame.t), f = dot(j.dpdv, frame.t), g = dot(j.dpdv, frame.b);
  Christoffel<S> result;
  int k = 0;
  for (const Vec3<S>* second : {&j.d2pdu2, &j.d2pduv, &j.d2pdv2}) {
    result.v[k] = dot(*second, frame.b) / g;
    result.u[k] = (dot(*second, frame.t) - f * result.v[k]) / e;
    ++k;
  }
  return result;
}

namespace detail {

// sqrt(x² + y²) of finite numbers without overflow or underflow in between, within 2 ulp.
template <Binary S>
S hypotenuse(const S& x, const S& y) {
  using std::abs, std::sqrt;
  const S p = abs(x), q = abs(y), zero(0), one(1);
  const auto swapped = p < q;
  const S large = select(swapped, q, p), ratio = select(swapped, p, q) / large;
  return select(large > zero, S(large * sqrt(S(one + ratio * ratio))), S(p + q));
}

}  // namespace detail

/// Curvatures at a point, with respect to the frame's n: with n outward a sphere of radius r has κ1 = κ2 = H
/// = -1/r.
template <class S>
struct Curvature {
  S gaussian;      ///< K = κ1 κ2, 1/length²
  S mean;          ///< H = (κ1 + κ2)/2, 1/length
  S principal[2];  ///< κ1 >= κ2, 1/length
  /// Unit; directions[1] = n × directions[0]. directions[0]·t > 0, or directions[0] = b exactly where it lies
  /// along b as far as rounding tells.
  Vec3<S> directions[2];
  Status status;  ///< the frame's, with `umbilic` where κ1 = κ2 (the directions are then t and b)
};

/// Curvatures from the shape operator in the basis (t, b) of an orthonormal frame:
///   H = (a + c)/2,  κ = H ± hypot((a - c)/2, m)
/// accurate at umbilics and for any representable size. κ1 and κ2 count as equal (umbilic) when they differ
/// by less than 16u (|a| + |c|), what rounding leaves of the jet.
template <detail::Binary S>
Curvature<S> curvature(const ShapeOperator<S>& shape, const Frame<S>& frame) {
  using std::abs;
  const S a = shape.a, m = shape.m, c = shape.c, zero(0), one(1), two(2);
  Curvature<S> result;
  result.status = frame.status;
  result.mean = (a + c) / two;
  result.gaussian = difference_of_products(a, c, m, m);
  result.gaussian = select(result.gaussian - result.gaussian == zero, result.gaussian, S(a * c - m * m));
  const S half_difference = (a - c) / two, radius = detail::hypotenuse(half_difference, m);
  result.principal[0] = result.mean + radius;
  result.principal[1] = result.mean - radius;
  // The eigenvector of κ1, from whichever of its two forms does not cancel.
  const auto leans_to_t = half_difference >= zero;
  S x = select(leans_to_t, S(half_difference + radius), m);
  S y = select(leans_to_t, m, S(radius - half_difference));
  // Where m is 0 but for rounding its sign is noise, and direction b would change its sign from point to
  // point.
  const auto along_b =
      !leans_to_t && abs(m) <= S(16 * std::numeric_limits<detail::Element<S>>::epsilon()) * shape.m_size;
  x = select(along_b, zero, x);
  const S rounding(8 * std::numeric_limits<detail::Element<S>>::epsilon());
  const auto equal = !(two * radius > rounding * (abs(a) + abs(c)));
  const bool finite = radius - radius == zero;
  if (equal && finite) result.status |= Status::umbilic;
  x = select(equal, finite ? one : radius, x);
  y = select(equal, zero, y);
  const S length = detail::hypotenuse(x, y);
  x = x / length;
  y = y / length;
  const auto backwards = x < zero || (x == zero && y < zero);
  x = select(backwards, S(-x), x);
  y = select(backwards, S(-y), y);
  result.directions[0] = x * frame.t + y * frame.b;
  result.directions[1] = x * frame.b - y * frame.t;
  return result;
}

/// Curvatures from a jet and its orthonormal frame. NaN where dpdu and dpdv span no plane: see the form
/// below, which takes the surface. About 60 ns.
template <detail::Binary S>
Curvature<S> curvature(const Jet2<S>& j, const Frame<S>& frame) {
  return curvature(shape_operator(j, frame), frame);
}

namespace detail {

// A partial at a point, and its first and second derivative along y, from nested dual numbers over (x, y).
template <class S>
struct AlongY {
  Vec3<S> value, first, second;

  explicit AlongY(const Vec3<Dual<Dual<S, 2>, 2>>& p)
      : value{p.x.value.value, p.y.value.value, p.z.value.value},
        first{p.x.value.derivative[1], p.y.value.derivative[1], p.z.value.derivative[1]},
        second{p.x.derivative[1].derivative[1], p.y.derivative[1].derivative[1],
               p.z.derivative[1].derivative[1]} {}
};

// The limit of the shape operator where the chart collapses along x: P_x = P_xx = 0 there, P_y and P_xy span
// the plane. With s the distance from there along y: P_x = s P_xy + ..., P_xx = s P_xxy + s²/2 P_xxyy + ...,
// n = n0 + s n_y + ..., n_y = -S P_y. To first order in s
//   n·P_xy = s (n_y·P_xy + n0·P_xyy),  and by the definition of S  n·P_xy = -n_y·P_x = -s n_y·P_xy,
// so that q = -n_y·t = n0·P_xyy / 2|P_xy| for t = P_xy / |P_xy|. With b = n0 × t and P_y = f t + g b
//   -n_y·P_y = n0·P_yy  gives  -n_y·b = (n0·P_yy - f q)/g,
// and the second order of n·P_xx = |P_x|² (t·S t) gives t·S t. Its first order, n0·P_xxy, must vanish: else
// the normal depends on x at one and the same point, as at the apex of a cone, and the curvature grows
// without bound.
template <class Jets, class S>
ShapeOperator<S> shape_operator_at_collapse(const Jets& jets, S u, S v, const Jet2<S>& j,
                                            const Frame<S>& frame) {
  using D = Dual<S, 2>;
  using N = Dual<D, 2>;
  constexpr S nan = std::numeric_limits<S>::quiet_NaN();
  constexpr S rounding = S(32) * std::numeric_limits<S>::epsilon();
  const S e = dot(j.dpdu, frame.t), f = dot(j.dpdv, frame.t), g = dot(j.dpdv, frame.b);
  ShapeOperator<S> result{nan, nan, nan, e, f, g, nan};
  // x = (x_u, x_v) is the direction in which the position does not move, y = (-x_v, x_u). Next to a collapse,
  // where no status says so, it is that of the smaller partial.
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
    N result(inner);
    result.derivative = {D(along_x), D(along_y)};
    return result;
  };
  const Jet2<N> k = jets(variable(u, x_u, -x_v), variable(v, x_v, x_u));
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
  // From the basis (t, b) here to that of the frame.
  const S cosine = dot(frame.t, t), sine = dot(frame.t, b);
  result.a = cosine * cosine * tt + S(2) * cosine * sine * tb + sine * sine * bb;
  result.m = cosine * sine * (bb - tt) + (cosine * cosine - sine * sine) * tb;
  result.c = sine * sine * tt - S(2) * cosine * sine * tb + cosine * cosine * bb;
  result.m_size = S(4) * (std::fabs(tt) + std::fabs(tb) + std::fabs(bb));
  return result;
}

// Jet and frame of a surface type, or of a surface chosen at run time (any_surface.h), which has them as
// members. Compiled once per scalar: over nested dual numbers that takes long.
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

}  // namespace detail

/// The shape operator of a surface at (u, v), from a jet and frame of it at hand. Where they carry
/// limit_frame (poles, collapsed edges) it is the limit, of derivatives to fourth order by nested dual
/// numbers, within a few dozen roundings of its terms; so it is where a regular point is so close to one that
/// terms leave the range of the scalar. Elsewhere it is that of the jet. NaN where there is none: at
/// the apex of a cone and wherever else the curvature grows without bound, where d2pduv vanishes with dpdu,
/// or where those derivatives do not exist. \param surface a surface type, or AnySurface
template <class X, std::floating_point S>
ShapeOperator<S> shape_operator(const X& surface, S u, S v, const Jet2<S>& j, const Frame<S>& frame) {
  constexpr Status singular = Status::dpdu_zero | Status::dpdv_zero | Status::parallel;
  if (!has(frame.status, Status::limit_frame) || !has(frame.status, singular) ||
      has(frame.status, Status::no_frame)) {
    const ShapeOperator<S> regular = shape_operator(j, frame);
    if (std::isfinite(regular.a) && std::isfinite(regular.m) && std::isfinite(regular.c)) return regular;
    if (!detail::finite(frame.n) || !detail::finite(j.d2pdu2) || !detail::finite(j.d2pduv) ||
        !detail::finite(j.d2pdv2))
      return regular;
  }
  const auto jets = [&](const auto& a, const auto& b) { return detail::jet_of(surface, a, b); };
  return detail::shape_operator_at_collapse(jets, u, v, j, frame);
}

/// The curvatures of a surface at (u, v), at poles and collapsed edges too: see shape_operator above.
template <class X, std::floating_point S>
Curvature<S> curvature(const X& surface, S u, S v, const Jet2<S>& j, const Frame<S>& frame) {
  return curvature(shape_operator(surface, u, v, j, frame), frame);
}
template <class X, std::floating_point S>
Curvature<S> curvature(const X& surface, S u, S v) {
  return curvature(surface, u, v, detail::jet_of(surface, u, v), detail::frame_of(surface, u, v));
}
template <class X, class U, class V>
requires(detail::MixedCoordinates<U, V>&& std::is_class_v<X>) Curvature<double> curvature(const X& surface,
                                                                                          U u, V v) {
  return curvature(surface, static_cast<double>(u), static_cast<double>(v));
}

/// A curve u(s), v(s) on a surface at one point, by its first and second derivatives with respect to its
/// parameter.
template <class S>
struct CurveOnSurface {
  S du, dv, d2u, d2v;
};

/// The Darboux frame of a curve on a surface: T its unit tangent, V = n × T the tangent normal, n the surface
/// normal; κn its normal curvature, κg its geodesic curvature, τg its geodesic torsion (1/length):
///   T' = κg V + κn n,   V' = -κg T + τg n,   n' = -κn T - τg V   (derivatives by arc length)
/// κn is positive where the curve bends towards n, κg where it turns to the left seen against n.
/// [doCarmo2016, sec. 4-4]
template <class S>
struct DarbouxFrame {
  Vec3<S> T, V, n;
  S normal_curvature, geodesic_curvature, geodesic_torsion;
  Status status;  ///< the surface frame's; no_frame and NaN where the curve does not move (du = dv = 0, or
                  ///< along a vanishing partial)
};
template <std::floating_point S>
DarbouxFrame<S> darboux_frame(const Jet2<S>& j, const Frame<S>& frame, const ShapeOperator<S>& shape,
                              const CurveOnSurface<S>& curve) {
  const Vec3<S> velocity = curve.du * j.dpdu + curve.dv * j.dpdv;
  const S speed = norm(velocity);
  DarbouxFrame<S> result{unit(velocity), {}, frame.n, {}, {}, {}, frame.status};
  if (!(speed > S(0)) || has(frame.status, Status::no_frame | Status::non_finite_input)) {
    const S nan = std::numeric_limits<S>::quiet_NaN();
    result.T = result.V = detail::nan_vector<S>();
    result.normal_curvature = result.geodesic_curvature = result.geodesic_torsion = nan;
    result.status |= Status::no_frame;
    return result;
  }
  result.V = accurate_cross(frame.n, result.T);
  const S du = curve.du / speed, dv = curve.dv / speed;  // by arc length
  const Vec3<S> bend = du * du * j.d2pdu2 + S(2) * du * dv * j.d2pduv + dv * dv * j.d2pdv2;
  result.normal_curvature = dot(frame.n, bend);
  result.geodesic_curvature =
      dot(result.V, bend + curve.d2u / speed / speed * j.dpdu + curve.d2v / speed / speed * j.dpdv);
  const S x = dot(result.T, frame.t), y = dot(result.T, frame.b);
  result.geodesic_torsion =
      dot(result.V, (shape.a * x + shape.m * y) * frame.t + (shape.m * x + shape.c * y) * frame.b);
  return result;
}
template <std::floating_point S>
DarbouxFrame<S> darboux_frame(const Jet2<S>& j, const Frame<S>& frame, const CurveOnSurface<S>& curve) {
  return darboux_frame(j, frame, shape_operator(j, frame), curve);
}
/// At (u, v) of a surface, at poles and collapsed edges too: see shape_operator above.
template <class X, std::floating_point S>
DarbouxFrame<S> darboux_frame(const X& surface, S u, S v, const CurveOnSurface<S>& curve) {
  const Jet2<S> j = detail::jet_of(surface, u, v);
  const Frame<S> f = detail::frame_of(surface, u, v);
  return darboux_frame(j, f, shape_operator(surface, u, v, j, f), curve);
}

}  // namespace darboux
