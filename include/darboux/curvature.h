/// \file curvature.h
/// Gaussian, mean and principal curvatures of a surface, and their directions.
#pragma once

#include <cmath>
#include <concepts>
#include <limits>
#include <type_traits>

#include <darboux/shape_operator.h>

namespace darboux {

/// Curvatures at a point, with respect to n of the frame. A sphere of radius r with outward n has κ1 = κ2 =
/// H = -1/r.
template <class S>
struct Curvature {
  S gaussian;      ///< K = κ1 κ2, 1/length²
  S mean;          ///< H = (κ1 + κ2)/2, 1/length
  S principal[2];  ///< κ1 >= κ2, 1/length
  /// Principal directions, unit; directions[1] = n × directions[0]. The sign: directions[0]·t > 0, or
  /// directions[0] = b exactly if it is parallel to b up to rounding.
  Vec3<S> directions[2];
  Status status;  ///< of the frame, with `umbilic` if κ1 = κ2 (the directions are then t and b)
};

namespace detail {

// sqrt(x² + y²) of finite numbers without overflow or underflow in between, within 2 ulp.
template <class S>
S hypotenuse(const S& x, const S& y) {
  using std::abs, std::sqrt;
  const S p = abs(x), q = abs(y), zero(0), one(1);
  const auto swapped = p < q;
  const S large = select(swapped, q, p), ratio = select(swapped, p, q) / large;
  return select(large > zero, S(large * sqrt(S(one + ratio * ratio))), S(p + q));
}

// \param equal_by κ1 and κ2 count as equal if they differ by at most this times |a| + |c|
// \param noise what rounding leaves of m, relative to its terms
template <class S>
Curvature<S> curvature_of(const ShapeOperator<S>& shape, const Frame<S>& frame, const S& equal_by,
                          const S& noise) {
  using std::abs;
  const S a = shape.a, m = shape.m, c = shape.c, zero(0), one(1), two(2);
  Curvature<S> result;
  result.status = frame.status;
  result.mean = (a + c) / two;
  result.gaussian = difference_of_products(a, c, m, m);
  result.gaussian = select(result.gaussian - result.gaussian == zero, result.gaussian, S(a * c - m * m));
  const S half_difference = (a - c) / two, radius = hypotenuse(half_difference, m);
  result.principal[0] = result.mean + radius;
  result.principal[1] = result.mean - radius;
  // The eigenvector of κ1, from whichever of its two forms does not cancel.
  const auto leans_to_t = half_difference >= zero;
  S x = select(leans_to_t, S(half_difference + radius), m);
  S y = select(leans_to_t, m, S(radius - half_difference));
  // If m is 0 up to rounding, its sign is noise, and direction b would change sign from point to point.
  x = select(!leans_to_t && abs(m) <= noise * shape.m_size, zero, x);
  y = select(leans_to_t && abs(m) <= S(0.25) * noise * shape.m_size, zero, y);
  const auto equal = !(two * radius > equal_by * (abs(a) + abs(c)));
  const bool finite = radius - radius == zero;
  if (equal && finite) result.status |= Status::umbilic;
  x = select(equal, finite ? one : radius, x);
  y = select(equal, zero, y);
  const S length = hypotenuse(x, y);
  x = x / length;
  y = y / length;
  const auto backwards = x < zero || (x == zero && y < zero);
  x = select(backwards, S(-x), x);
  y = select(backwards, S(-y), y);
  result.directions[0] = x * frame.t + y * frame.b;
  result.directions[1] = x * frame.b - y * frame.t;
  return result;
}

}  // namespace detail

/// Curvatures from the shape operator in the basis (t, b) of an orthonormal frame:
///   H = (a + c)/2,  κ = H ± hypot((a - c)/2, m)
/// Accurate at umbilics and for any representable size. κ1 and κ2 count as equal (umbilic) if they differ
/// by at most 16u (|a| + |c|), the rounding error of the jet. For the directions, m counts as 0 if it is at
/// most 32u of its terms (8u if a >= c).
template <detail::Binary S>
Curvature<S> curvature(const ShapeOperator<S>& shape, const Frame<S>& frame) {
  constexpr auto epsilon = std::numeric_limits<detail::Element<S>>::epsilon();
  return detail::curvature_of(shape, frame, S(8 * epsilon), S(16 * epsilon));
}

/// Curvatures from a jet and its orthonormal frame. NaN if dpdu and dpdv are linearly dependent; the overload
/// that takes the surface covers that case. Cost: about 60 ns.
template <detail::Binary S>
Curvature<S> curvature(const Jet2<S>& j, const Frame<S>& frame) {
  return curvature(shape_operator(j, frame), frame);
}

namespace detail {

// Whether a surface type, or the base of an adaptor, is defined by parameters.
template <class X>
constexpr bool has_parameters = [] {
  if constexpr (requires(const X& x) { x.base; })
    return has_parameters<std::remove_cvref_t<decltype(std::declval<const X&>().base)>>;
  else
    return HasParameters<X> || requires(const X& x) {
      x.parameter_values();
    };
}();

// Per lane, which curvatures have lost digits to cancellation that the frame has not.
template <class Truth>
struct Lost {
  Truth gaussian, mean, principal;  // the last: all, and the directions
};
template <class X, Binary S>
auto lost_digits(const ShapeOperator<S>& s, const Curvature<S>& c) {
  using std::abs;
  const S two(2), a = abs(s.a), m = abs(s.m), k = abs(s.c);
  const S sizes = s.a_size + two * s.m_size + s.c_size;
  constexpr double most = has_parameters<X> ? cancellation : large_cancellation;
  const auto vague = cancels(sizes, S(c.principal[0] - c.principal[1]), cancellation_of_directions) &&
                     m > S(4 * std::numeric_limits<Element<S>>::epsilon()) * s.m_size;
  auto small =
      cancels(sizes, size_of_both(c.principal[0], c.principal[1]), most) || second_partials_underflow(s);
  if constexpr (!HasClosedFrame<X>) small = small || cancels(abs(s.f), s.g, most);  // b errs by some u itself
  return Lost<std::remove_cv_t<decltype(vague)>>{
      cancels(S(k * s.a_size + a * s.c_size + two * m * s.m_size), c.gaussian,
              StatesGaussianCurvature<X> && has_parameters<X> ? cancellation : most),
      cancels(S(s.a_size + s.c_size), c.mean,
              StatesMeanCurvature<X> && has_parameters<X> ? cancellation : large_cancellation),
      small || vague};
}

template <std::floating_point S>
Curvature<S> curvature_of(const WideForms& wide) {
  const Curvature<Multiprecision> c = curvature_of(
      wide.shape, wide.frame, Multiprecision(8 * std::numeric_limits<S>::epsilon()), Multiprecision(1e-36));
  // A sum of which rounding to 40 digits is all that is left is 0.
  using std::abs;
  const ShapeOperator<Multiprecision>& s = wide.shape;
  const Multiprecision rounding(1e-36);
  const auto sum = [&](const Multiprecision& x, const Multiprecision& size) {
    return abs(x) <= rounding * size ? S(0) : rounded_to<S>(x);
  };
  return {sum(c.gaussian, s.a_size * s.c_size + s.m_size * s.m_size),
          sum(c.mean, s.a_size + s.c_size),
          {rounded_to<S>(c.principal[0]), rounded_to<S>(c.principal[1])},
          {rounded_to<S>(c.directions[0]), rounded_to<S>(c.directions[1])},
          c.status};
}

// Replaces curvatures that have lost digits by those that the surface states in closed form. Returns whether
// it states them.
template <class X, class S>
bool state_gaussian([[maybe_unused]] const X& surface, [[maybe_unused]] S u, [[maybe_unused]] S v,
                    [[maybe_unused]] S& gaussian) {
  if constexpr (StatesGaussianCurvature<X>) {
    gaussian = surface.gaussian_curvature(prepare<X::info.u>(u), prepare<X::info.v>(v));
    return true;
  }
  return false;
}
template <class X, class S>
bool state_mean([[maybe_unused]] const X& surface, [[maybe_unused]] S u, [[maybe_unused]] S v,
                [[maybe_unused]] S& mean) {
  if constexpr (StatesMeanCurvature<X>) {
    mean = surface.mean_curvature(prepare<X::info.u>(u), prepare<X::info.v>(v));
    return true;
  }
  return false;
}

// The curvatures at a regular point, from a shape operator of its jet.
template <class X, std::floating_point S>
Curvature<S> regular_curvature(const X& surface, S u, S v, const Frame<S>& frame,
                               const ShapeOperator<S>& shape) {
  Curvature<S> c = curvature(shape, frame);
  const Lost<bool> lost = lost_digits<X>(shape, c);
  if (!lost.gaussian && !lost.mean && !lost.principal) [[likely]]
    return c;
  if (!lost.principal && (!lost.gaussian || state_gaussian(surface, u, v, c.gaussian)) &&
      (!lost.mean || state_mean(surface, u, v, c.mean)))
    return c;
  if constexpr (runs_in_40_digits<X>) return curvature_of<S>(WideForms(surface, u, v, frame));
  if (lost.gaussian) state_gaussian(surface, u, v, c.gaussian);
  if (lost.mean) state_mean(surface, u, v, c.mean);
  return c;
}

}  // namespace detail

/// The curvatures of a surface at (u, v), including poles and collapsed edges (see shape_operator()). Error
/// at regular points: at most 8u (1 + condition), relative to the length of each of the vectors (K), (H),
/// (κ1, κ2) and the directions. The condition of q is the sum over u, v and the parameters x of |x
/// ∂q/∂x| / |q|. That of the directions has a further term: (1 + the condition of (κ1, κ2)) times
/// |κ|/(κ1 - κ2), this last factor limited to 256. Cost: about 100 ns. If terms cancel to less than an
/// eighth, K and H are taken from the closed forms of the surface (some 20 ns more). Without closed forms,
/// and for κ and the directions, they are computed in 40 digits (some 50 µs). This happens where the chart
/// is very oblique, where a curvature is small compared with the curvature of the coordinate curves, and
/// where the square of a first partial, alone or times the curvature, underflows.
template <class X, std::floating_point S>
Curvature<S> curvature(const X& surface, S u, S v, const Jet2<S>& j, const Frame<S>& frame) {
  if constexpr (!ParametricSurface<X>) {
    return surface.curvature(u, v, j, frame);
  } else if (!detail::is_limit(frame.status)) {
    const ShapeOperator<S> s = shape_operator(j, frame);
    if (!detail::left_range(s, j, frame)) return detail::regular_curvature(surface, u, v, frame, s);
  }
  const detail::ShapeAt<S> at(surface, u, v, j, frame);
  return at.wide ? detail::curvature_of<S>(*at.wide) : curvature(at.narrow, frame);
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

}  // namespace darboux
