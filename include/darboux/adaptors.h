/// \file adaptors.h
/// Surfaces made from other surfaces: placed in space, with other coordinates, at a distance, or from a position alone.
/// Each is a surface type itself, so adaptors compose, and every law of testing.h holds for them. They keep the base's
/// normal (placed: by the inverse transpose); a flip, swap or mirror negates the handedness instead.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <darboux/error.h>
#include <darboux/forms.h>
#include <darboux/point.h>

namespace darboux {

namespace detail {

// What is wrong with the surface an adaptor changes, empty when nothing is.
template <class X>
std::string base_refusal(const X& base) {
  try {
    checked(base);
  } catch (const ParameterError& e) {
    return e.what();
  }
  return {};
}

template <std::size_t N>
struct Literal {
  char text[N];
  constexpr Literal(const char (&from)[N]) { std::copy_n(from, N, text); }  // NOLINT: from a literal
};

// "offset torus", of static duration.
template <Literal prefix, class X>
struct AdaptedName {
  static constexpr auto characters = [] {
    constexpr std::size_t length = sizeof(prefix.text) - 1;
    std::array<char, length + X::info.name.size()> result{};
    std::copy_n(prefix.text, length, result.begin());
    std::copy(X::info.name.begin(), X::info.name.end(), result.begin() + length);
    return result;
  }();
  static constexpr std::string_view value{characters.data(), characters.size()};
};

// What an adaptor says of itself that moves the points and keeps the coordinates.
// \param added roundings by which its frame errs more than the base's
template <Literal prefix, class X>
constexpr SurfaceInfo moved_info(double added) {
  SurfaceInfo info = X::info;
  info.name = AdaptedName<prefix, X>::value;
  info.own_orientation = true;
  info.frame_error += added;
  return info;
}

template <class S>
S constant_part(const S& x) {
  if constexpr (requires { Scalar<S>::value(x); })
    return S(constant_part(Scalar<S>::value(x)));
  else
    return x;
}

// ∫ f(x0 + s (x - x0)) ds over [0, 1], x0 the constant part of x: for a dual number x exact to fifth order (Boole's rule).
template <class S, class F>
auto mean_from_constant(const S& x, F f) {
  constexpr std::array<double, 5> weight{7, 32, 12, 32, 7};
  const S x0 = constant_part(x);
  auto sum = lift<S>(weight[0]) * f(x0);
  for (std::size_t k = 1; k < 5; ++k)
    sum = sum + lift<S>(weight[k]) * f(S(x0 + lift<S>(static_cast<double>(k) / 4) * (x - x0)));
  return sum / lift<S>(90.0);
}

template <class S>
Vec3<S> unit_or_nan(const Vec3<S>& a) {
  return largest_component(a) == 0 ? nan_vector<S>() : unit(a);
}

// The unit normal of a surface at prepared coordinates of any scalar. Where the chart of a surface without a closed frame
// collapses, dpdu = (v - v0) Q with Q the mean of d2pduv between v0 and v: the normal and all its derivatives are those of
// ±Q × dpdv, from the side of limit_at(). (The same for dpdv and u.) NaN where that is not enough.
template <class X, class PU, class PV>
auto normal_of(const X& surface, const PU& u, const PV& v) {
  if constexpr (requires { surface.normal(u, v); }) {
    return surface.normal(u, v);
  } else if constexpr (HasClosedFrame<X>) {
    return surface.frame(u, v).n;
  } else {
    const auto j = surface.jet(u, v);
    using S = std::remove_cvref_t<decltype(j.position.x)>;
    const bool u_collapsed = largest_component(j.dpdu) == 0, v_collapsed = largest_component(j.dpdv) == 0;
    if constexpr (std::same_as<PV, S>)
      if (u_collapsed && !v_collapsed) {
        const Vec3<S> q = mean_from_constant(v, [&](const S& x) { return surface.jet(u, x).d2pduv; });
        return unit_or_nan(cross(at_upper_end<X::info.v>(v) ? -q : q, j.dpdv));
      }
    if constexpr (std::same_as<PU, S>)
      if (v_collapsed && !u_collapsed) {
        const Vec3<S> q = mean_from_constant(u, [&](const S& x) { return surface.jet(x, v).d2pduv; });
        return unit_or_nan(cross(j.dpdu, at_upper_end<X::info.u>(u) ? -q : q));
      }
    return unit_or_nan(cross(j.dpdu, j.dpdv));
  }
}

// Value and all derivatives to second order of a vector function of prepared coordinates, by nested dual numbers.
template <Coordinate ku, Coordinate kv, class S, class F, class PU, class PV>
Jet2<S> jet_by_duals(const F& f, const PU& u, const PV& v) {
  using D = Dual<S, 2>;
  using N = Dual<D, 2>;
  const Vec3<N> p =
      f(as_variable<N>(as_variable<D>(u, 0, ku), 0, ku), as_variable<N>(as_variable<D>(v, 1, kv), 1, kv));
  const auto first = [](const N& x, std::size_t i) { return x.value.derivative[i]; };
  const auto second = [](const N& x, std::size_t i, std::size_t k) { return x.derivative[i].derivative[k]; };
  const auto each = [&](auto part, auto... index) {
    return Vec3<S>{part(p.x, index...), part(p.y, index...), part(p.z, index...)};
  };
  return {.position = {p.x.value.value, p.y.value.value, p.z.value.value},
          .dpdu = each(first, std::size_t{0}),
          .dpdv = each(first, std::size_t{1}),
          .d2pdu2 = each(second, std::size_t{0}, std::size_t{0}),
          .d2pduv = each(second, std::size_t{0}, std::size_t{1}),
          .d2pdv2 = each(second, std::size_t{1}, std::size_t{1})};
}

}  // namespace detail

/// A surface from its position alone: X has `info` and position(u, v) -> Vec3<S> on prepared coordinates of any scalar;
/// the partials come from nested dual numbers, to the last bits, at some ten times the cost. Whatever else X states
/// (parameters, singular, facts) is passed on.
template <class X>
struct FromPosition : X {
  template <class PU, class PV>
  auto jet(const PU& u, const PV& v) const {
    using S = std::remove_cvref_t<decltype(X::position(u, v).x)>;
    return detail::jet_by_duals<X::info.u, X::info.v, S>(
        [this](const auto& a, const auto& b) { return this->X::position(a, b); }, u, v);
  }

  template <class To>
  auto rebind() const {
    return FromPosition<decltype(darboux::rebind<To>(std::declval<const X&>()))>{
        darboux::rebind<To>(static_cast<const X&>(*this))};
  }
};

/// Other coordinates: (u, v) of the base = M (u, v) + offset, an affine map with det M ≠ 0: what meshes do to uvs. Both
/// coordinates become linear; where the base is periodic the map may leave the unit square.
template <class X, class T = double>
struct Reparametrised {
  X base;
  std::array<T, 4> M{1, 0, 0, 1};  ///< row by row: base u = M[0] u + M[1] v + offset[0]
  std::array<T, 2> offset{0, 0};

  static constexpr SurfaceInfo info{.name = detail::AdaptedName<"reparametrised ", X>::value,
                                    .summary = X::info.summary,
                                    .u = Coordinate::linear,
                                    .v = Coordinate::linear,
                                    .orientable = X::info.orientable,
                                    .own_orientation = true,
                                    .frame_error = X::info.frame_error + 8};

  std::string refusal() const {
    const T determinant = scaled_determinant();
    // An infinite or NaN entry makes the determinant NaN.
    if (!(determinant > 0 || determinant < 0))
      return "the map of (u, v) is singular, permitted are invertible ones";
    if (!std::isfinite(offset[0]) || !std::isfinite(offset[1]))
      return "the offset of (u, v) is not finite, permitted are numbers";
    return detail::base_refusal(base);
  }

  template <class S>
  Jet2<S> jet(const S& u, const S& v) const {
    const auto [pu, pv] = inside(u, v);
    const Jet2<S> j = base.jet(pu, pv);
    const T a = M[0], b = M[1], c = M[2], d = M[3];
    // A term with the factor 0 is left out: the partial may be infinite.
    const auto add = [](Vec3<S>& sum, const T& factor, const Vec3<S>& x) {
      if (factor != T(0)) sum = sum + lift<S>(factor) * x;
    };
    const auto first = [&](const T& by_u, const T& by_v) {
      const S zero = lift<S>(0.0);
      Vec3<S> sum{zero, zero, zero};
      add(sum, by_u, j.dpdu);
      add(sum, by_v, j.dpdv);
      return sum;
    };
    const auto second = [&](const T& u1, const T& v1, const T& u2, const T& v2) {
      const S zero = lift<S>(0.0);
      Vec3<S> sum{zero, zero, zero};
      add(sum, u1 * u2, j.d2pdu2);
      add(sum, u1 * v2 + u2 * v1, j.d2pduv);
      add(sum, v1 * v2, j.d2pdv2);
      return sum;
    };
    return {.position = j.position,
            .dpdu = first(a, c),
            .dpdv = first(b, d),
            .d2pdu2 = second(a, c, a, c),
            .d2pduv = second(a, c, b, d),
            .d2pdv2 = second(b, d, b, d)};
  }

  template <std::floating_point S>
  Frame<S> frame(const S& u, const S& v) const {
    const auto [pu, pv] = inside(u, v);
    const Status at = detail::declared(base, pu, pv);
    const Frame<S> f = detail::frame_at<S>(base, pu, pv, at);
    if (has(f.status, Status::no_frame)) return f;
    const S a = lift<S>(M[0]), c = lift<S>(M[2]), one = lift<S>(1.0);
    const Jet2<S> j = base.jet(pu, pv);
    Vec3<S> t;
    if (detail::limits_by_series<X> && has(f.status, Status::limit_frame)) {
      if constexpr (detail::limits_by_series<X>) t = detail::limit_direction(base, pu, pv, a, c);
      if (t == Vec3<S>{}) return detail::no_frame<S>();
    } else if (has(at, Status::dpdu_zero) || a == S(0)) {
      // Where one partial of the base vanishes the other decides; where that is not asked for, the limit does.
      t = c == S(0) ? std::copysign(one, a) * f.t : std::copysign(one, c) * along_v(f, j, at);
    } else if (has(at, Status::dpdv_zero) || c == S(0)) {
      t = a == S(0) ? std::copysign(one, c) * along_v(f, j, at) : std::copysign(one, a) * f.t;
    } else {
      t = unit(a * j.dpdu + c * j.dpdv);
    }
    const Vec3<S> b = t == f.t ? f.b : t == -f.t ? -f.b : unit(accurate_cross(f.n, t));
    return {t, b, f.n, scaled_determinant() < 0 ? -f.handedness : f.handedness, mapped_status(f.status)};
  }

  /// As the base has it (detail::limit_direction).
  static constexpr bool limits_by_series = detail::limits_by_series<X>;
  template <class S>
  Vec3<S> limit_direction(const S& u, const S& v, const S& x, const S& y) const requires limits_by_series {
    const auto [pu, pv] = inside(u, v);
    return detail::limit_direction(base, pu, pv, S(lift<S>(M[0]) * x + lift<S>(M[1]) * y),
                                   S(lift<S>(M[2]) * x + lift<S>(M[3]) * y));
  }

  template <class S>
  Vec3<S> normal(const S& u, const S& v) const {
    const auto [pu, pv] = inside(u, v);
    return detail::normal_of(base, pu, pv);
  }

  template <class S>
  Status singular(const S& u, const S& v) const {
    const auto [pu, pv] = inside(u, v);
    Status result = mapped_status(detail::declared(base, pu, pv));
    const auto [x, y] = mapped(u, v);
    if (detail::outside<X::info.u>(x) || detail::outside<X::info.v>(y)) result |= Status::outside_domain;
    return result;
  }

  template <class S>
  S implicit(const Vec3<S>& p) const requires StatesImplicit<X> {
    return base.implicit(p);
  }
  template <class S>
  S gaussian_curvature(const S& u, const S& v) const requires StatesGaussianCurvature<X> {
    const auto [pu, pv] = inside(u, v);
    return base.gaussian_curvature(pu, pv);
  }
  template <class S>
  S mean_curvature(const S& u, const S& v) const requires StatesMeanCurvature<X> {
    const auto [pu, pv] = inside(u, v);
    return base.mean_curvature(pu, pv);
  }

  /// Where the base is only piecewise smooth, for maps that keep coordinate lines coordinate lines; none for others.
  std::vector<double> breaks(int along) const requires requires(const X& x) { x.breaks(0); }
  {
    std::vector<double> result;
    for (int k = 0; k < 2; ++k) {
      const auto row = static_cast<std::size_t>(k);
      const T by_this = M[2 * row + static_cast<std::size_t>(along)],
              by_other = M[2 * row + static_cast<std::size_t>(1 - along)];
      if (by_this == 0 || by_other != 0) continue;
      for (const double x : base.breaks(k))
        if (const double y = static_cast<double>((x - offset[row]) / by_this); 0 < y && y < 1)
          result.push_back(y);
    }
    std::sort(result.begin(), result.end());
    return result;
  }

  template <class To>
  auto rebind() const {
    Reparametrised<decltype(darboux::rebind<To>(base)), To> result{darboux::rebind<To>(base), {}, {}};
    for (std::size_t k = 0; k < 4; ++k) result.M[k] = lift<To>(M[k]);
    for (std::size_t k = 0; k < 2; ++k) result.offset[k] = lift<To>(offset[k]);
    return result;
  }

 private:
  // The base's bits as they are here.
  Status mapped_status(Status at) const {
    Status result = detail::without(at, Status::dpdu_zero | Status::dpdv_zero);
    const bool u_zero = has(at, Status::dpdu_zero), v_zero = has(at, Status::dpdv_zero);
    if ((u_zero && M[2] == 0) || (v_zero && M[0] == 0) || (u_zero && v_zero)) result |= Status::dpdu_zero;
    if ((u_zero && M[3] == 0) || (v_zero && M[1] == 0) || (u_zero && v_zero)) result |= Status::dpdv_zero;
    if ((u_zero || v_zero) && !has(result, Status::dpdu_zero | Status::dpdv_zero)) result |= Status::parallel;
    return result;
  }
  // det M with the largest entry scaled to 1, so that no product overflows.
  T scaled_determinant() const {
    T largest = 0;
    for (const T& x : M) largest = std::fmax(largest, std::fabs(x));
    return M[0] / largest * (M[3] / largest) - M[1] / largest * (M[2] / largest);
  }
  template <class S>
  std::pair<S, S> mapped(const S& u, const S& v) const {
    return {lift<S>(M[0]) * u + lift<S>(M[1]) * v + lift<S>(offset[0]),
            lift<S>(M[2]) * u + lift<S>(M[3]) * v + lift<S>(offset[1])};
  }
  template <class S>
  auto inside(const S& u, const S& v) const {
    const auto [x, y] = mapped(u, v);
    return std::pair{prepare<X::info.u>(x), prepare<X::info.v>(y)};
  }
  // The direction of dpdv on the base; where it vanishes, that of ±d2pduv on the side of handedness · b.
  template <class S>
  static Vec3<S> along_v(const Frame<S>& f, const Jet2<S>& j, Status at) {
    if (!has(at, Status::dpdv_zero)) return unit(j.dpdv);
    const Vec3<S> leaning = f.handedness * f.b, limit = unit(j.d2pduv);
    if (!detail::finite(limit) || limit == Vec3<S>{}) return leaning;
    return dot(limit, leaning) < S(0) ? -limit : limit;
  }
};
template <class X>
Reparametrised(X, std::array<double, 4>, std::array<double, 2>) -> Reparametrised<X>;

/// u and v exchanged.
template <ParametricSurface X>
Reparametrised<X> swapped(const X& base) {
  return {base, {0, 1, 1, 0}, {0, 0}};
}
/// u replaced by 1 - u, v by 1 - v.
template <ParametricSurface X>
Reparametrised<X> flipped_u(const X& base) {
  return {base, {-1, 0, 0, 1}, {1, 0}};
}
template <ParametricSurface X>
Reparametrised<X> flipped_v(const X& base) {
  return {base, {1, 0, 0, -1}, {0, 1}};
}
/// The part over [u0, u1] × [v0, v1], again over the unit square.
template <ParametricSurface X>
Reparametrised<X> sub_rectangle(const X& base, double u0, double u1, double v0, double v1) {
  return {base, {u1 - u0, 0, 0, v1 - v0}, {u0, v0}};
}
/// u replaced by u + k v.
template <ParametricSurface X>
Reparametrised<X> sheared(const X& base, double k) {
  return {base, {1, k, 0, 1}, {0, 0}};
}

/// Placed in space by an affine map, P = A base + translation, det A ≠ 0. Tangents go by A, n by the inverse transpose,
/// the handedness by the sign of det A. The frame errs by some 12 roundings times the condition number of A more than the
/// base's. Differentiate the base numerically, never the placed points: far from the origin
/// those have lost the digits that differences need.
template <class X, class T = double>
struct Placed {
  X base;
  std::array<T, 9> A{1, 0, 0, 0, 1, 0, 0, 0, 1};  ///< row by row
  Vec3<T> translation{};

  static constexpr SurfaceInfo info = detail::moved_info<"placed ", X>(12);

  std::string refusal() const {
    Eigen::Matrix<T, 3, 3> m;
    for (int k = 0; k < 9; ++k) m(k / 3, k % 3) = A[static_cast<std::size_t>(k)];
    try {
      FrameTransform<T>{m};
    } catch (const ParameterError&) {
      return "the placement is singular to working precision or not finite, permitted are invertible maps";
    }
    if (!detail::finite(translation)) return "the translation is not finite, permitted are numbers";
    return detail::base_refusal(base);
  }

  template <class PU, class PV>
  auto jet(const PU& u, const PV& v) const {
    auto j = base.jet(u, v);
    using S = std::remove_cvref_t<decltype(j.position.x)>;
    for (Vec3<S>* p : {&j.position, &j.dpdu, &j.dpdv, &j.d2pdu2, &j.d2pduv, &j.d2pdv2}) *p = map(*p);
    j.position += Vec3<S>{lift<S>(translation.x), lift<S>(translation.y), lift<S>(translation.z)};
    return j;
  }

  template <class PU, class PV>
  auto frame(const PU& u, const PV& v) const {
    using S = std::remove_cvref_t<decltype(base.jet(u, v).position.x)>;
    const Frame<S> f = detail::frame_at<S>(base, u, v, detail::declared(base, u, v));
    if (has(f.status, Status::no_frame)) return f;
    const auto [n, sign] = transformed(f.n);
    Frame<S> result{unit(map(f.t)), {}, n, sign * f.handedness, f.status};
    result.b = unit(accurate_cross(result.n, result.t));
    return result;
  }
  template <class PU, class PV>
  auto normal(const PU& u, const PV& v) const {
    return transformed(detail::normal_of(base, u, v)).first;
  }
  /// As the base has it (detail::limit_direction).
  static constexpr bool limits_by_series = detail::limits_by_series<X>;
  template <class PU, class PV, class S>
  Vec3<S> limit_direction(const PU& u, const PV& v, const S& x, const S& y) const requires limits_by_series {
    return unit(map(detail::limit_direction(base, u, v, x, y)));
  }

  template <class PU, class PV>
  Status singular(const PU& u, const PV& v) const {
    return detail::declared(base, u, v);
  }

  std::vector<double> breaks(int along) const requires requires(const X& x) { x.breaks(0); }
  { return base.breaks(along); }

  template <class To>
  auto rebind() const {
    Placed<decltype(darboux::rebind<To>(base)), To> result{darboux::rebind<To>(base), {}, {}};
    for (std::size_t k = 0; k < 9; ++k) result.A[k] = lift<To>(A[k]);
    result.translation = {lift<To>(translation.x), lift<To>(translation.y), lift<To>(translation.z)};
    return result;
  }

 private:
  template <class S>
  Vec3<S> map(const Vec3<S>& p) const {
    // A term with the factor 0 is left out: the coordinate may be infinite.
    const auto row = [&](std::size_t k) {
      S sum = lift<S>(0.0);
      if (A[k] != T(0)) sum = sum + lift<S>(A[k]) * p.x;
      if (A[k + 1] != T(0)) sum = sum + lift<S>(A[k + 1]) * p.y;
      if (A[k + 2] != T(0)) sum = sum + lift<S>(A[k + 2]) * p.z;
      return sum;
    };
    return {row(0), row(3), row(6)};
  }
  // n by the inverse transpose, and the sign of det A. The columns of the cofactor matrix are det A times those of the
  // inverse transpose: its sign is put back. A is scaled to ordinary size first.
  template <class S>
  std::pair<Vec3<S>, S> transformed(const Vec3<S>& n) const {
    int e = std::numeric_limits<int>::min();
    for (const T& x : A)
      if (const double size = detail::size_of(x); size > 0) e = std::max(e, std::ilogb(size));
    const auto column = [&](std::size_t k) {
      return detail::scaled_by_power_of_two(Vec3<S>{lift<S>(A[k]), lift<S>(A[k + 3]), lift<S>(A[k + 6])}, -e);
    };
    const Vec3<S> x = accurate_cross(column(1), column(2)), y = accurate_cross(column(2), column(0)),
                  z = accurate_cross(column(0), column(1));
    const Vec3<S> m = unit(n.x * x + n.y * y + n.z * z);
    if (dot(column(0), x) < lift<S>(0.0)) return {-m, lift<S>(-1.0)};
    return {m, lift<S>(1.0)};
  }
};
template <class X>
Placed(X, std::array<double, 9>, Vec3<double>) -> Placed<X>;

/// The parallel surface P + d n at signed distance d along the base's normal. n is the base's; the handedness turns over
/// where d passes a focal point, d κ > 1 for one principal curvature κ. The partials need third derivatives of the base:
/// nested dual numbers over its normal, some twenty times the cost. Principal curvatures κ / (1 - d κ). At a focal point
/// of dpdu there is no frame (no_frame, dpdu_zero); at one of dpdv the frame is the base's (limit_frame, dpdv_zero). At a
/// conical point of the base n turns with u, and the parallel surface is regular. Where the base's frame is a limit that
/// d2pduv does not give, there is a position and no frame.
/// [doCarmo2016, sec. 3-5]
template <class X, class T = double>
struct Offset {
  X base;
  T distance{0};

  static constexpr SurfaceInfo info = detail::moved_info<"offset ", X>(12);

  std::string refusal() const {
    if (!std::isfinite(distance)) return "the distance is not finite, permitted are numbers";
    return detail::base_refusal(base);
  }

  template <class PU, class PV>
  auto jet(const PU& u, const PV& v) const {
    auto j = base.jet(u, v);
    using S = std::remove_cvref_t<decltype(j.position.x)>;
    const Jet2<S> n = normal_jet<S>(u, v);
    const S d = lift<S>(distance);
    Vec3<S> here = n.position;
    // The limit has a value, though no derivatives.
    if constexpr (std::floating_point<S> && std::floating_point<T>)
      if (!detail::finite(here)) here = detail::frame_at<S>(base, u, v, detail::declared(base, u, v)).n;
    return Jet2<S>{.position = j.position + d * here,
                   .dpdu = j.dpdu + d * n.dpdu,
                   .dpdv = j.dpdv + d * n.dpdv,
                   .d2pdu2 = j.d2pdu2 + d * n.d2pdu2,
                   .d2pduv = j.d2pduv + d * n.d2pduv,
                   .d2pdv2 = j.d2pdv2 + d * n.d2pdv2};
  }

  template <class PU, class PV>
  auto frame(const PU& u, const PV& v) const {
    using S = std::remove_cvref_t<decltype(base.jet(u, v).position.x)>;
    const Frame<S> f = detail::frame_at<S>(base, u, v, detail::declared(base, u, v));
    if (has(f.status, Status::no_frame)) return f;
    const Status at = still_singular(f.status, u, v);
    const Jet2<S> of_base = base.jet(u, v), j = jet(u, v);
    if (!detail::finite(normal(u, v))) {  // that of the base is a limit of higher order: t is not known here
      Frame<S> none = detail::no_frame<S>();
      none.status |= f.status & detail::degenerate;
      return none;
    }
    // Where a partial vanishes, its direction is that of ±d2pduv: on the base and here.
    const auto limit = [&](const Vec3<S>& leaning) {
      return dot(of_base.d2pduv, leaning) < S(0) ? -j.d2pduv : j.d2pduv;
    };
    if (!detail::finite(j.dpdu) || !detail::finite(j.dpdv))
      return Frame<S>{f.t, f.b, f.n, f.handedness, f.status};  // as the base's do
    const bool u_collapsed = has(at, Status::dpdu_zero), v_collapsed = has(at, Status::dpdv_zero);
    const Vec3<S> along_u = u_collapsed ? limit(f.t) : j.dpdu,
                  along_v = v_collapsed ? limit(f.handedness * f.b) : j.dpdv;
    Frame<S> result{unit(along_u), {}, f.n, f.handedness, at & (detail::degenerate | Status::crease)};
    if (has(at, detail::degenerate)) result.status |= Status::limit_frame;
    // At a focal point a partial is a difference of equal ones: what rounding leaves has no direction.
    constexpr S rounding = S(64) * std::numeric_limits<S>::epsilon();
    if (!u_collapsed && !(norm(j.dpdu) > rounding * norm(of_base.dpdu))) {
      result.t = result.b = result.n = detail::nan_vector<S>();
      result.status = Status::no_frame | Status::dpdu_zero;
      return result;
    }
    result.b = unit(accurate_cross(result.n, result.t));
    // The base's handedness, turned over with each focal point passed.
    if (has(at, Status::parallel)) {
      if constexpr (std::same_as<PU, S> && std::same_as<PV, S>) {
        Frame<S> limit_of_base = f;
        limit_of_base.status |= Status::limit_frame;
        const ShapeOperator<S> s = shape_operator(base, u, v, of_base, limit_of_base);
        const S d = lift<S>(distance), one = lift<S>(1.0);
        if ((one - d * s.a) * (one - d * s.c) < d * s.m * (d * s.m)) result.handedness = -f.handedness;
      }
    } else {
      const S sine = dot(accurate_cross(unit(along_u), unit(along_v)), f.n);
      result.handedness = sine < S(0) ? S(-1) : S(1);
      if (!v_collapsed &&
          !(norm(j.dpdv) > rounding * norm(of_base.dpdv)))  // the frame is the base's all the same
        result.status |= Status::dpdv_zero | Status::limit_frame;
    }
    return result;
  }

  /// The base's, but where the base has a conical point: there n turns with u, and the parallel surface is regular.
  template <class PU, class PV>
  Status singular(const PU& u, const PV& v) const {
    return still_singular(detail::declared(base, u, v), u, v);
  }

  template <class PU, class PV>
  auto normal(const PU& u, const PV& v) const {
    return detail::normal_of(base, u, v);
  }

  /// K / (1 - 2 d H + d² K) of the base's stated curvatures
  template <class PU, class PV>
  auto gaussian_curvature(const PU& u,
                          const PV& v) const requires StatesGaussianCurvature<X> && StatesMeanCurvature<X> {
    const auto K = base.gaussian_curvature(u, v), H = base.mean_curvature(u, v);
    using S = std::remove_cvref_t<decltype(K)>;
    const S d = lift<S>(distance), one = lift<S>(1.0), two = lift<S>(2.0);
    return S(K / (one - two * d * H + d * d * K));
  }

  std::vector<double> breaks(int along) const requires requires(const X& x) { x.breaks(0); }
  { return base.breaks(along); }

  template <class To>
  auto rebind() const {
    return Offset<decltype(darboux::rebind<To>(base)), To>{darboux::rebind<To>(base), lift<To>(distance)};
  }

 private:
  // What is left of the base's bits.
  template <class PU, class PV>
  Status still_singular(Status at, const PU& u, const PV& v) const {
    if (!has(at, detail::degenerate)) return at;
    const auto j = jet(u, v);
    using S = std::remove_cvref_t<decltype(j.position.x)>;
    constexpr S rounding = S(64) * std::numeric_limits<S>::epsilon();
    const auto regular = [&](const Vec3<S>& partial, const Vec3<S>& other) {
      return norm(partial) > rounding * (norm(other) + norm(j.d2pduv));
    };
    Status result = at;
    if (regular(j.dpdu, j.dpdv)) result = detail::without(result, Status::dpdu_zero);
    if (regular(j.dpdv, j.dpdu)) result = detail::without(result, Status::dpdv_zero);
    if (norm(cross(unit(j.dpdu), unit(j.dpdv))) > rounding)
      result = detail::without(result, Status::parallel);
    return result;
  }
  template <class S, class PU, class PV>
  Jet2<S> normal_jet(const PU& u, const PV& v) const {
    return detail::jet_by_duals<X::info.u, X::info.v, S>(
        [this](const auto& a, const auto& b) { return this->normal(a, b); }, u, v);
  }
};
template <class X>
Offset(X, double) -> Offset<X>;

}  // namespace darboux
