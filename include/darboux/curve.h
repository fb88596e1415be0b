/// \file curve.h
/// Parametric curves, from which tubes, extrusions, ruled surfaces and surfaces of revolution are made. A
/// curve type has `kind`, the Coordinate of its parameter, and jet(t), which returns the CurveJet at a
/// prepared parameter of any scalar. Optional members:
///   using scalar                              the type of its data
///   auto rebind<To>()                         the same curve over another scalar
///   CurveFrame<S> moving_frame(t)             its own N and B; required for tubes
///   S remaining_speed(t, r)                   speed - r bend, without cancellation
///   S curvature(t)                            its curvature in closed form, signed as `bend`
///   Vec3<S> second_formula(t)                 the position by another formula
///   Status singular(t)                        crease if the tangent may jump
///   std::string refusal()                     why its data are invalid; empty if valid
/// Exceptions propagate. If a derivative is NaN or infinite, surfaces made from the curve have no frame there
/// (no_frame, overflow).
#pragma once

#include <array>
#include <cmath>
#include <concepts>
#include <limits>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include <darboux/spline.h>
#include <darboux/surface.h>

namespace darboux {

/// Position and derivatives to third order with respect to t in [0, 1], factors 2π included.
template <class S>
struct CurveJet {
  Vec3<S> position, first, second, third;
};

/// An orthonormal right-handed frame (T, N, B) along a curve, with its derivatives with respect to t:
///   T' = bend N + side B,   N' = -bend T + twist B,   B' = -side T - twist N,   speed = |K'|
/// The Frenet frame has side = 0, bend = speed · curvature and twist = speed · torsion. For a planar curve
/// N may stay on one side instead; bend is then signed. A rotation-minimising frame has twist = 0.
/// [doCarmo2016, sec. 1-5], [Bishop1975]
template <class S>
struct CurveFrame {
  Vec3<S> T, N, B;
  S speed, bend, side, twist;
  S speed_rate, bend_rate, side_rate, twist_rate;  ///< their derivatives with respect to t
};

namespace detail {

template <class C>
Status curve_status(const C& curve, const auto& t) {
  if constexpr (requires { curve.singular(t); })
    return curve.singular(t);
  else
    return Status::regular;
}
template <class C>
std::string curve_refusal(const C& curve) {
  if constexpr (requires { curve.refusal(); })
    return curve.refusal();
  else
    return {};
}
// The parameters at which a curve is only piecewise smooth: the interior knots of a spline, or of the spline
// inside a framed curve.
template <class C>
std::vector<double> curve_breaks(const C& curve) {
  if constexpr (requires { curve.knots().breaks(); })
    return curve.knots().breaks();
  else if constexpr (requires { curve.curve; })
    return curve_breaks(curve.curve);
  else
    return {};
}
// A curve whose jet was computed at one parameter, the only one at which it may be evaluated.
template <class S, Coordinate of>
struct CurveAtPlace {
  using scalar = S;
  static constexpr Coordinate kind = of;
  CurveJet<S> known;
  Status status;

  const CurveJet<S>& jet(const auto&) const { return known; }
  Status singular(const auto&) const { return status; }
};
// \tparam order the highest derivative required
template <int order, class C, class P>
auto curve_at_place(const C& curve, const P& t) {
  const auto jet = [&] {
    if constexpr (requires { curve.template jet_to<order>(t); })
      return curve.template jet_to<order>(t);
    else
      return curve.jet(t);
  }();
  return CurveAtPlace<std::remove_cvref_t<decltype(jet.position.x)>, C::kind>{jet, curve_status(curve, t)};
}
// The curve over another scalar: a callable without data of its own stays as it is.
template <class To, class C>
auto rebound(const C& curve) {
  if constexpr (requires { curve.template rebind<To>(); })
    return curve.template rebind<To>();
  else
    return curve;
}

// The direction of a curve at t: that of its first non-zero derivative, in the limit from above (from below
// at the upper end of the domain). order: the order of that derivative; 0 if all three vanish.
template <class S>
struct Passage {
  Vec3<S> direction;
  int order;
};
template <Coordinate kind, class S, class P>
Passage<S> passage(const CurveJet<S>& j, const P& t) {
  if (!vanishes(j.first)) return {unit(j.first), 1};
  if (!vanishes(j.second)) return {at_upper_end<kind>(t) ? -unit(j.second) : unit(j.second), 2};
  if (!vanishes(j.third)) return {unit(j.third), 3};
  return {j.first, 0};
}
// The status bits that result for the chart: a vanishing derivative, and a cusp where the direction reverses
// in the interior.
template <Coordinate kind, class S, class P>
Status passage_status(const Passage<S>& way, const P& t, Status zero) {
  Status result = way.order == 1 ? Status::regular : zero;
  if (way.order == 2 && within<kind>(t)) result |= Status::crease;
  return result;
}

// The components of T' and T'' along a unit vector x perpendicular to T, from
//   K'' = speed' T + speed T',   K''' = speed'' T + 2 speed' T' + speed T''
template <class S>
struct TangentRates {
  S first, second;
};
template <class S>
TangentRates<S> tangent_rates(const Vec3<S>& x, const CurveJet<S>& k, const S& speed, const S& speed_rate) {
  const S first = dot(x, k.second) / speed;
  return {first, (dot(x, k.third) - lift<S>(2.0) * speed_rate * first) / speed};
}

}  // namespace detail

/// The straight line (1 - t) a + t b.
/// Its moving frame is constant. N is perpendicular to b - a, in the plane of b - a and the coordinate axis
/// at the largest angle to it.
template <class T = double>
struct LineSegment {
  using scalar = T;
  static constexpr Coordinate kind = Coordinate::linear;
  Vec3<T> a{T(0), T(0), T(0)}, b{T(0), T(0), T(1)};

  template <class S>
  CurveJet<S> jet(const S& t) const {
    const Vec3<S> p = detail::lift_vector<S>(a), q = detail::lift_vector<S>(b), zero = lift<S>(0.0) * p;
    return {(lift<S>(1.0) - t) * p + t * q, q - p, zero, zero};
  }
  template <class S>
  CurveFrame<S> moving_frame(const S&) const {
    const S zero = lift<S>(0.0), one = lift<S>(1.0);
    const Vec3<S> along = detail::lift_vector<S>(b) - detail::lift_vector<S>(a);
    CurveFrame<S> f{unit(along), {}, {}, norm(along), zero, zero, zero, zero, zero, zero, zero};
    const S x = f.T.x * f.T.x, y = f.T.y * f.T.y, z = f.T.z * f.T.z;
    const Vec3<S> axis = !(y < x) && !(z < x) ? Vec3<S>{one, zero, zero}
                         : !(z < y)           ? Vec3<S>{zero, one, zero}
                                              : Vec3<S>{zero, zero, one};
    f.N = unit(axis - dot(axis, f.T) * f.T);
    f.B = cross(f.T, f.N);
    return f;
  }
  template <class S>
  S curvature(const S&) const {
    return lift<S>(0.0);
  }
  /// a + t (b - a)
  template <class S>
  Vec3<S> second_formula(const S& t) const {
    const Vec3<S> p = detail::lift_vector<S>(a);
    return p + t * (detail::lift_vector<S>(b) - p);
  }
  std::string refusal() const {
    using std::isfinite;
    for (const T& x : {a.x, a.y, a.z, b.x, b.y, b.z})
      if (!isfinite(x)) return "line segment: expected finite ends, got NaN or infinity";
    return {};
  }
  template <class To>
  auto rebind() const {
    return LineSegment<To>{detail::lift_vector<To>(a), detail::lift_vector<To>(b)};
  }
};
template <class T>
LineSegment(Vec3<T>, Vec3<T>) -> LineSegment<T>;

/// The circle (R cos 2πt, R sin 2πt, 0). N points to the centre, B = +z.
template <class T = double>
struct CircleCurve {
  using scalar = T;
  static constexpr Coordinate kind = Coordinate::turn;
  T radius{1};

  template <class S>
  CurveJet<S> jet(const Turn<S>& t) const {
    const S R = lift<S>(radius), tau = two_pi<S>(), zero = lift<S>(0.0);
    const S x = R * t.cos, y = R * t.sin;
    return {{x, y, zero},
            {-(tau * y), tau * x, zero},
            {-(tau * (tau * x)), -(tau * (tau * y)), zero},
            {tau * (tau * (tau * y)), -(tau * (tau * (tau * x))), zero}};
  }
  template <class S>
  CurveFrame<S> moving_frame(const Turn<S>& t) const {
    const S zero = lift<S>(0.0), speed = two_pi<S>() * lift<S>(radius);
    const Vec3<S> tangent{-t.sin, t.cos, zero}, normal{-t.cos, -t.sin, zero},
        binormal{zero, zero, lift<S>(1.0)};
    return {tangent, normal, binormal, speed, two_pi<S>(), zero, zero, zero, zero, zero, zero};
  }
  /// 2π (R - r)
  template <class S>
  S remaining_speed(const Turn<S>&, const S& r) const {
    return two_pi<S>() * (lift<S>(radius) - r);
  }
  template <class S>
  S curvature(const Turn<S>&) const {
    return lift<S>(1.0) / lift<S>(radius);
  }
  std::string refusal() const {
    using std::isfinite;
    return isfinite(radius) && T(0) < radius
               ? ""
               : "radius of the circle: expected a positive finite number, got another";
  }
  template <class To>
  auto rebind() const {
    return CircleCurve<To>{lift<To>(radius)};
  }
};
CircleCurve(double)->CircleCurve<double>;

/// The circular helix (R cos x, R sin x, p x), x = 2π turns t, p the pitch per radian (negative:
/// left-handed). N points to the axis. Curvature R/(R² + p²), torsion p/(R² + p²).
/// [doCarmo2016, sec. 1-5]
template <class T = double>
struct HelixCurve {
  using scalar = T;
  static constexpr Coordinate kind = Coordinate::linear;
  T radius{1}, pitch{0.25}, turns{1};

  template <class S>
  CurveJet<S> jet(const S& t) const {
    const S R = lift<S>(radius), p = lift<S>(pitch), zero = lift<S>(0.0), w = rate<S>();
    const Turn<S> a = sincos_turns(S(lift<S>(turns) * t));
    const S x = R * a.cos, y = R * a.sin;
    return {{x, y, p * (w * t)},
            {-(w * y), w * x, w * p},
            {-(w * (w * x)), -(w * (w * y)), zero},
            {w * (w * (w * y)), -(w * (w * (w * x))), zero}};
  }
  template <class S>
  CurveFrame<S> moving_frame(const S& t) const {
    const S R = lift<S>(radius), p = lift<S>(pitch), zero = lift<S>(0.0), w = rate<S>();
    const Turn<S> a = detail::normalised(sincos_turns(S(lift<S>(turns) * t)));
    const Vec2<S> d = unit(Vec2<S>{R, p});  // cosine and sine of the slope
    const Vec3<S> tangent{-(d.x * a.sin), d.x * a.cos, d.y}, normal{-a.cos, -a.sin, zero},
        binormal{d.y * a.sin, -(d.y * a.cos), d.x};
    return {tangent, normal, binormal, w * norm(Vec2<S>{R, p}), w * d.x, zero, w * d.y, zero,
            zero,    zero,   zero};
  }
  /// 2π turns (R (R - r) + p²)/sqrt(R² + p²)
  template <class S>
  S remaining_speed(const S&, const S& r) const {
    const S R = lift<S>(radius), p = lift<S>(pitch);
    const Vec2<S> d = unit(Vec2<S>{R, p});
    return rate<S>() * (d.x * (R - r) + d.y * p);
  }
  template <class S>
  S curvature(const S&) const {
    const S R = lift<S>(radius), p = lift<S>(pitch), l = norm(Vec2<S>{R, p});
    return R / l / l;
  }
  /// By half angles: (R (1 - 2 sin² x/2), 2 R sin x/2 cos x/2, p x).
  template <class S>
  Vec3<S> second_formula(const S& t) const {
    const S R = lift<S>(radius), two = lift<S>(2.0), x = lift<S>(turns) * t;
    const Turn<S> h = sincos_half_turns(x);
    return {R - two * (R * h.sin * h.sin), two * (R * h.sin * h.cos), two_pi<S>() * lift<S>(pitch) * x};
  }
  std::string refusal() const {
    using std::isfinite;
    if (!isfinite(radius) || !(T(0) < radius))
      return "radius of the helix: expected a positive finite number, got another";
    if (!isfinite(pitch)) return "pitch of the helix: expected a finite number, got NaN or infinity";
    if (!isfinite(turns) || !(T(0) < turns))
      return "turns of the helix: expected a positive finite number, got another";
    return {};
  }
  template <class To>
  auto rebind() const {
    return HelixCurve<To>{lift<To>(radius), lift<To>(pitch), lift<To>(turns)};
  }

 private:
  template <class S>
  S rate() const {
    return two_pi<S>() * lift<S>(turns);
  }
};
HelixCurve(double, double, double)->HelixCurve<double>;

/// A rational B-spline curve (NURBS), by de Boor's recurrence on homogeneous control points and their
/// hodographs.
///   K(t) = Σ w_i P_i N_{i,p}(t) / Σ w_i N_{i,p}(t)
/// Beyond [0, 1] the polynomials of the end spans are continued. At an interior knot of multiplicity `degree`
/// or more (degree 1: at every vertex) the tangent may jump; the status is then crease, and derivatives are
/// those from above. The scalar must be ordered, because the span is found from the value of t. Cost:
/// O(degree²), O(log n) in the number n of control points. [PieglTiller1997, ch. 4]
template <class T = double>
class BSplineCurve {
 public:
  using scalar = T;
  static constexpr Coordinate kind = Coordinate::linear;

  /// A wave in the xy plane, of degree 5 with one span, hence smooth everywhere.
  BSplineCurve()
      : BSplineCurve(5, clamped_knots<T>(5, 6),
                     {{T(0), T(0), T(0)},
                      {T(0.25), T(0.5), T(0)},
                      {T(0.5), T(0.25), T(0)},
                      {T(0.75), T(-0.25), T(0)},
                      {T(1), T(-0.5), T(0)},
                      {T(1.5), T(0.125), T(0)}}) {}

  /// \param degree 1 to 15
  /// \param knots as many as control points + degree + 1, not decreasing, no multiplicity above degree + 1;
  /// mapped to the domain [0, 1] \param weights positive; empty: all 1 \throws ParameterError naming what is
  /// wrong
  BSplineCurve(int degree, std::vector<T> knots, std::vector<Vec3<T>> control_points,
               std::vector<T> weights = {})
      : control_points_(std::move(control_points)), weights_(std::move(weights)) {
    if (const std::string why = refusal(degree, knots, control_points_, weights_); !why.empty())
      throw_refused("b-spline curve", why);
    detail::normalise_weights(weights_);
    knots_ = KnotVector<T>(degree, std::move(knots));
  }

  /// The profile of a vase in the xz plane, from the axis (its bottom) to the lip, in one span.
  static BSplineCurve vase() {
    const T o(0);
    return BSplineCurve(6, clamped_knots<T>(6, 7),
                        {{o, o, o},
                         {T(0.5), o, o},
                         {T(1), o, T(0.25)},
                         {T(1), o, T(0.75)},
                         {T(-0.5), o, T(1)},
                         {T(0.375), o, T(1.25)},
                         {T(0.5), o, T(1.5)}});
  }

  const KnotVector<T>& knots() const { return knots_; }
  const std::vector<Vec3<T>>& control_points() const { return control_points_; }
  /// The weights times a common power of two; empty if all are equal.
  const std::vector<T>& weights() const { return weights_; }

  static std::string refusal(int degree, const std::vector<T>& knots,
                             const std::vector<Vec3<T>>& control_points, const std::vector<T>& weights) {
    if (std::string why = KnotVector<T>::refusal(degree, knots); !why.empty()) return why;
    return detail::refuse_net(knots.size() - degree - 1, control_points, weights);
  }

  template <class S>
  CurveJet<S> jet(const S& t) const {
    return jet_to<3>(t);
  }
  /// jet() with derivatives up to `order`, bit for bit; higher ones are zero.
  template <int order, class S>
  CurveJet<S> jet_to(const S& t) const {
    const auto span = knots_.span(t);
    const int p = knots_.degree();
    return detail::with_degree<S>(p, [&]<class Degree>(Degree degree) -> CurveJet<S> {
      const detail::KnotWeights<S, Degree, order> weights(degree, {}, span);
      detail::ControlWindow<Vec3<S>, Degree> x;
      x[0] = x[p] = Vec3<S>{};  // compilers do not see that they are set
      span.first.points(control_points_, 0, p + 1, x);
      const Vec3<S> anchor = detail::choose(weights.upper(), x[p], x[0]);
      for (int i = 0; i <= p; ++i) x[i] = x[i] - anchor;
      if (weights_.empty()) {
        const auto f = detail::spline_derivatives<order + 1, Vec3<S>>(x, degree, weights);
        const auto of = [&](auto k) {
          if constexpr (k <= order)
            return f[k];
          else
            return Vec3<S>{};
        };
        return {anchor + f[0], of(detail::Known<1>{}), of(detail::Known<2>{}), of(detail::Known<3>{})};
      }
      detail::ControlWindow<detail::Homogeneous<S>, Degree> y;
      for (int i = 0; i <= p; ++i) {
        const S w = span.first.number(weights_, i);
        y[i] = {w * x[i], w};
      }
      const auto h = detail::spline_derivatives<order + 1, detail::Homogeneous<S>>(y, degree, weights);
      const S w = h[0].w, two = lift<S>(2.0), three = lift<S>(3.0);
      const Vec3<S> k = h[0].a / w;
      CurveJet<S> j{};
      j.position = anchor + k;
      if constexpr (order >= 1) j.first = (h[1].a - h[1].w * k) / w;
      if constexpr (order >= 2) j.second = (h[2].a - (two * h[1].w) * j.first - h[2].w * k) / w;
      if constexpr (order >= 3)
        j.third = (h[3].a - (three * h[1].w) * j.second - (three * h[2].w) * j.first - h[3].w * k) / w;
      return j;
    });
  }

  template <class S>
  Status singular(const S& t) const {
    return knots_.singular(t);
  }

  /// The sum over the basis functions of Cox and de Boor.
  template <class S>
  Vec3<S> second_formula(const S& t) const {
    int first = 0;
    const auto n = knots_.basis(t, first);
    const S zero = lift<S>(0.0);
    Vec3<S> sum{zero, zero, zero};
    S total = zero;
    for (int i = 0; i <= knots_.degree(); ++i) {
      const S w = weights_.empty() ? n[i] : n[i] * lift<S>(weights_[first + i]);
      sum += w * at<S>(first + i);
      total = total + w;
    }
    return sum / total;
  }

  std::string refusal() const { return refusal(knots_.degree(), knots_.knots(), control_points_, weights_); }

  template <class To>
  auto rebind() const {
    BSplineCurve<To> result;
    result.knots_ = knots_.template rebind<To>();
    result.control_points_ = detail::lift_points<To>(control_points_);
    result.weights_ = detail::lift_numbers<To>(weights_);
    return result;
  }

 private:
  template <class>
  friend class BSplineCurve;
  template <class S>
  Vec3<S> at(int i) const {
    return detail::lift_vector<S>(control_points_[i]);
  }
  KnotVector<T> knots_;
  std::vector<Vec3<T>> control_points_;
  std::vector<T> weights_;
};

/// A curve given only by its position, a function of the prepared parameter (t itself, or its Turn) for any
/// scalar:
///   PositionCurve curve{[]<class S>(const S& t) { return Vec3<S>{t, t * t, t * t * t}; }};
/// The derivatives come from nested dual numbers, exact to rounding; about ten times the cost of the
/// position.
template <class F, Coordinate K = Coordinate::linear, class T = double>
struct PositionCurve {
  using scalar = T;
  static constexpr Coordinate kind = K;
  F position{};

  template <class P>
  auto jet(const P& t) const {
    const auto x = position(detail::three_times_variable(t, K));
    using S = std::remove_cvref_t<decltype(x.x.value.value.value)>;
    return CurveJet<S>{
        {x.x.value.value.value, x.y.value.value.value, x.z.value.value.value},
        {x.x.derivative[0].value.value, x.y.derivative[0].value.value, x.z.derivative[0].value.value},
        {x.x.derivative[0].derivative[0].value, x.y.derivative[0].derivative[0].value,
         x.z.derivative[0].derivative[0].value},
        {x.x.derivative[0].derivative[0].derivative[0], x.y.derivative[0].derivative[0].derivative[0],
         x.z.derivative[0].derivative[0].derivative[0]}};
  }
  template <class To>
  auto rebind() const {
    auto rebound = detail::rebound<To>(position);
    return PositionCurve<decltype(rebound), K, To>{std::move(rebound)};
  }
};
template <class F>
PositionCurve(F) -> PositionCurve<F>;

}  // namespace darboux
