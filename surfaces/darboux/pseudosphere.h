/// \file pseudosphere.h
#pragma once

#include <array>
#include <charconv>
#include <string>

#include <darboux/surface.h>

namespace darboux {

/// Dini's surface: a pseudosphere (pitch b = 0, a tractrix turned about its asymptote, the z axis) or its
/// screw counterpart, of constant negative curvature.
///   P(u, v) = a (cos x sin w, sin x sin w, cos w + ln tan(w/2)) + (0, 0, b x),   x = 2π turns u,
///     w = w0 + (w1 - w0) v
/// u runs round the axis, v along the tractrix, upwards. With e_r, e_t, e_z of cylindrical coordinates
///   n = ± (a cos w e_r + b e_t - a sin w e_z) / sqrt(a² + b²),
///     t = (a sin w e_t + b e_z) / sqrt(a² sin² w + b²)
/// The sign is + for w < π/2 and - for w > π/2, so that n leans away from the axis on both sides of the
/// cuspidal edge w = π/2. dpdv vanishes on this edge; it points away from the axis before it and towards the
/// axis beyond it. On the edge the status is dpdv_zero and crease, as n jumps to its opposite; the frame is
/// the limit from w < π/2 (from w > π/2 if the surface begins at the edge). π/2 is not a floating-point
/// number: the edge is where cos w rounds to 0. Outside the domain, where the tractrix ends at infinity (w a
/// multiple of π) and b = 0, the status is dpdu_zero and t is the limit. Frame components err by at most 4u
/// times (1 + condition), u the unit roundoff; the condition is that of x and w in their inputs. [Gray2006]
template <class T = double>
struct Pseudosphere {
  T radius{1}, pitch{0}, turns{1}, w0{T(0.1)}, w1{T(1.5)};

  static constexpr SurfaceInfo info{"pseudosphere",
                                    "Dini's surface of constant negative curvature about z",
                                    Coordinate::linear,
                                    Coordinate::linear,
                                    {"w0 + (w1 - w0) v = π/2"}};
  static constexpr auto parameters() {
    constexpr Range below_pi{.minimum = 0, .maximum = 3.141592653589793};
    return std::array{
        parameter<&Pseudosphere::radius>("radius", Range::positive(),
                                         "radius of the cuspidal edge, a length"),
        parameter<&Pseudosphere::pitch>("pitch", Range{}, "rise per radian, a length"),
        parameter<&Pseudosphere::turns>("turns", Range::positive(), "number of turns", {1e-3, 1e3}),
        parameter<&Pseudosphere::w0>(
            "w0", below_pi, "angle of the tractrix with its asymptote at v = 0, radians", {1e-6, 1.49}),
        parameter<&Pseudosphere::w1>("w1", below_pi, "the same at v = 1, radians", {1.5, 3.1})};
  }

  /// What is wrong with w0 and w1 together; empty if nothing is.
  std::string refusal() const {
    if (w0 < w1) return {};
    const auto text = [](const T& x) {
      std::array<char, 32> digits{};
      const auto end =
          std::to_chars(digits.data(), digits.data() + digits.size(), static_cast<double>(x)).ptr;
      return std::string(digits.data(), end);
    };
    return "w0: expected less than w1 = " + text(w1) + ", got " + text(w0);
  }

  template <class S>
  constexpr Jet2<S> jet(const S& u, const S& v) const {
    const S zero = lift<S>(0.0), one = lift<S>(1.0), a = lift<S>(radius), b = lift<S>(pitch);
    const S rate = two_pi<S>() * lift<S>(turns), span = lift<S>(w1) - lift<S>(w0);  // dx/du, dw/dv
    const Turn<S> x = azimuth(u), w = profile_angle(v), half = half_profile_angle(v);
    const S &s = w.sin, &c = w.cos;
    const S radial = span * (a * c), rise = span * (a * (c * c / s));  // of dpdv
    return {
        .position = {a * s * x.cos, a * s * x.sin, a * (c + log(S(half.sin / half.cos))) + b * (rate * u)},
        .dpdu = {-(rate * (a * s * x.sin)), rate * (a * s * x.cos), rate * b},
        .dpdv = {radial * x.cos, radial * x.sin, rise},
        .d2pdu2 = {-(rate * (rate * (a * s * x.cos))), -(rate * (rate * (a * s * x.sin))), zero},
        .d2pduv = {-(rate * (radial * x.sin)), rate * (radial * x.cos), zero},
        .d2pdv2 = {-(span * (span * (a * s * x.cos))), -(span * (span * (a * s * x.sin))),
                   -(span * (radial * (one / s / s + one)))}};
  }

  template <class S>
  constexpr Frame<S> frame(const S& u, const S& v) const {
    const S zero = lift<S>(0.0), a = lift<S>(radius), b = lift<S>(pitch);
    const Turn<S> x = detail::normalised(azimuth(u)), w = detail::normalised(profile_angle(v));
    // Where dpdu vanishes, at the ends of the tractrix, t is the limit.
    const S round = select(w.sin == zero, lift<S>(pitch == T(0) ? 1.0 : 0.0), a * w.sin);
    const Vec2<S> all = unit(Vec2<S>{a, b}), along = unit(Vec2<S>{round, b});
    const S k = side(w), c = k * (all.x * w.cos), s = k * (all.x * w.sin);
    return {
        .t = cartesian<S>(x, {zero, along.x, along.y}),
        .b = cartesian<S>(x, unit(Vec3<S>{k * (all.y * along.y) + s * along.x, -(c * along.y), c * along.x})),
        .n = cartesian<S>(x, {c, k * all.y, -s})};
  }

  template <class S>
  constexpr Status singular(const S&, const S& v) const {
    const Turn<S> w = profile_angle(v);
    if (w.sin == lift<S>(0.0) && pitch == T(0)) return Status::dpdu_zero;
    return w.cos == lift<S>(0.0) ? Status::dpdv_zero | Status::crease : Status::regular;
  }

  /// K = -1/(a² + b²)
  template <class S>
  constexpr S gaussian_curvature(const S&, const S&) const {
    const S k = lift<S>(1.0) / norm(Vec2<S>{lift<S>(radius), lift<S>(pitch)});
    return -(k * k);
  }

  /// H = ∓ cot 2w / sqrt(a² + b²), - for w < π/2
  template <class S>
  constexpr S mean_curvature(const S&, const S& v) const {
    const Turn<S> w = profile_angle(v);
    const S h = norm(Vec2<S>{lift<S>(radius), lift<S>(pitch)}), two = lift<S>(2.0);
    return side(w) * (w.sin / w.cos - w.cos / w.sin) / two / h;
  }

  /// By the tractrix in the form of hyperbolic functions: with τ = ln tan(w/2), distance a / cosh τ from
  /// the axis, height a (τ - tanh τ); turned twice by half the azimuth.
  template <class S>
  constexpr Vec3<S> second_formula(const S& u, const S& v) const {
    const S one = lift<S>(1.0), two = lift<S>(2.0), a = lift<S>(radius), turned = lift<S>(turns) * u;
    const Turn<S> w = profile_angle(v), half = sincos_half_turns<S>(turned);
    const S tau = w.cos < lift<S>(0.0) ? log(S((one - w.cos) / w.sin)) : log(S(w.sin / (one + w.cos)));
    const S rho = a / cosh(tau);
    return {rho - two * (rho * half.sin * half.sin), two * (rho * half.sin * half.cos),
            a * (tau - tanh(tau)) + lift<S>(pitch) * (two_pi<S>() * turned)};
  }

 private:
  template <class S>
  constexpr Turn<S> azimuth(const S& u) const {
    return sincos_turns<S>(lift<S>(turns) * u);
  }
  template <class S>
  constexpr S profile_turns(const S& v) const {
    return (lift<S>(w0) + (lift<S>(w1) - lift<S>(w0)) * v) / two_pi<S>();
  }
  // sin w, cos w
  template <class S>
  constexpr Turn<S> profile_angle(const S& v) const {
    return sincos_turns<S>(profile_turns(v));
  }
  // sin(w/2), cos(w/2)
  template <class S>
  constexpr Turn<S> half_profile_angle(const S& v) const {
    return sincos_half_turns<S>(profile_turns(v));
  }
  // The sign of cos w; on the edge that of the neighbourhood in the domain, + where it lies on both sides.
  template <class S>
  constexpr S side(const Turn<S>& w) const {
    const S zero = lift<S>(0.0), one = lift<S>(1.0);
    const S at_edge = lift<S>(profile_angle(T(0)).cos > T(0) ? 1.0 : -1.0);
    return select(w.cos < zero, S(-one), select(zero < w.cos, one, at_edge));
  }
  // a.x e_r + a.y e_t + a.z e_z
  template <class S>
  static constexpr Vec3<S> cartesian(const Turn<S>& x, const Vec3<S>& a) {
    return {a.x * x.cos - a.y * x.sin, a.x * x.sin + a.y * x.cos, a.z};
  }
};
Pseudosphere(double, double, double, double, double)->Pseudosphere<double>;

}  // namespace darboux
