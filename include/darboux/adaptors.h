/// \file adaptors.h
/// Surfaces made from other surfaces: placed in space, with other coordinates, at a distance, or from a position alone.
/// Each is a surface type itself, so adaptors compose, and every law of testing.h holds for them. They keep the base's
/// normal (placed: by the inverse transpose); a flip, swap or mirror negates the handedness instead.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <string>
#include <string_view>

#include <darboux/evaluate.h>
#include <darboux/forms.h>

namespace darboux {

namespace detail {

template <std::size_t N>
struct Literal {
  char text[N];
  constexpr Literal(const char (&from)[N]) { std::copy_n(from, N, text); }  // NOLINT: from a literal
};

// "offset of torus", of static duration.
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

// The k-th variable at a prepared coordinate, over the dual numbers D = Dual<S, 2>.
template <class D, class S>
D as_variable(const S& x, int k, Coordinate) {
  return D::variable(x, k);
}
template <class D, class S>
Turn<D> as_variable(const Turn<S>& x, int k, Coordinate kind) {
  const S omega = kind == Coordinate::turn ? two_pi<S>() : pi<S>();
  Turn<D> result{D(x.sin), D(x.cos)};
  result.sin.derivative[static_cast<std::size_t>(k)] = omega * x.cos;
  result.cos.derivative[static_cast<std::size_t>(k)] = -(omega * x.sin);
  return result;
}

// The unit normal of a surface at prepared coordinates of any scalar.
template <class X, class PU, class PV>
auto normal_of(const X& surface, const PU& u, const PV& v) {
  if constexpr (requires { surface.normal(u, v); }) {
    return surface.normal(u, v);
  } else if constexpr (HasClosedFrame<X>) {
    return surface.frame(u, v).n;
  } else {
    const auto j = surface.jet(u, v);
    return unit(cross(j.dpdu, j.dpdv));
  }
}

// Value and all derivatives to second order of a vector function of prepared coordinates, by nested dual numbers.
template <Coordinate ku, Coordinate kv, class S, class F, class PU, class PV>
Jet2<S> jet_by_duals(const F& f, const PU& u, const PV& v) {
  using D = Dual<S, 2>;
  using N = Dual<D, 2>;
  const Vec3<N> p = f(as_variable<N>(as_variable<D>(u, 0, ku), 0, ku), as_variable<N>(as_variable<D>(v, 1, kv), 1, kv));
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
        [this](const auto& a, const auto& b) { return X::position(a, b); }, u, v);
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
    const T determinant = M[0] * M[3] - M[1] * M[2];
    if (!(determinant > 0 || determinant < 0)) return "the map of (u, v) is singular, permitted are invertible ones";
    if constexpr (RefusesCombinations<X>) return base.refusal();
    return {};
  }

  template <class S>
  Jet2<S> jet(const S& u, const S& v) const {
    const auto [pu, pv] = inside(u, v);
    const Jet2<S> j = base.jet(pu, pv);
    const S a = lift<S>(M[0]), b = lift<S>(M[1]), c = lift<S>(M[2]), d = lift<S>(M[3]), two = lift<S>(2.0);
    return {.position = j.position,
            .dpdu = a * j.dpdu + c * j.dpdv,
            .dpdv = b * j.dpdu + d * j.dpdv,
            .d2pdu2 = a * a * j.d2pdu2 + two * a * c * j.d2pduv + c * c * j.d2pdv2,
            .d2pduv = a * b * j.d2pdu2 + (a * d + b * c) * j.d2pduv + c * d * j.d2pdv2,
            .d2pdv2 = b * b * j.d2pdu2 + two * b * d * j.d2pduv + d * d * j.d2pdv2};
  }

  template <std::floating_point S>
  Frame<S> frame(const S& u, const S& v) const {
    const auto [pu, pv] = inside(u, v);
    const Status at = detail::declared(base, pu, pv);
    const Frame<S> f = detail::frame_at<S>(base, pu, pv, at);
    if (has(f.status, Status::no_frame)) return f;
    const S a = lift<S>(M[0]), c = lift<S>(M[2]), one = lift<S>(1.0);
    const Jet2<S> j = base.jet(pu, pv);
    // Where one partial of the base vanishes the other decides; where that is not asked for, the limit does.
    Vec3<S> t;
    if (has(at, Status::dpdu_zero) || a == S(0))
      t = c == S(0) ? std::copysign(one, a) * f.t : std::copysign(one, c) * along_v(f, j.dpdv, at);
    else if (has(at, Status::dpdv_zero) || c == S(0))
      t = a == S(0) ? std::copysign(one, c) * along_v(f, j.dpdv, at) : std::copysign(one, a) * f.t;
    else
      t = unit(a * j.dpdu + c * j.dpdv);
    const T determinant = M[0] * M[3] - M[1] * M[2];
    Frame<S> result{t, accurate_cross(f.n, t), f.n, determinant < 0 ? -f.handedness : f.handedness};
    return result;
  }

  template <class S>
  Vec3<S> normal(const S& u, const S& v) const {
    const auto [pu, pv] = inside(u, v);
    return detail::normal_of(base, pu, pv);
  }

  template <class S>
  Status singular(const S& u, const S& v) const {
    const auto [pu, pv] = inside(u, v);
    const Status at = detail::declared(base, pu, pv);
    Status result = at & (Status::self_intersecting | Status::crease | Status::parallel);
    const bool u_zero = has(at, Status::dpdu_zero), v_zero = has(at, Status::dpdv_zero);
    if ((u_zero && M[2] == 0) || (v_zero && M[0] == 0) || (u_zero && v_zero)) result |= Status::dpdu_zero;
    if ((u_zero && M[3] == 0) || (v_zero && M[1] == 0) || (u_zero && v_zero)) result |= Status::dpdv_zero;
    if ((u_zero || v_zero) && !has(result, Status::dpdu_zero | Status::dpdv_zero)) result |= Status::parallel;
    if (detail::outside_prepared<X::info.u>(pu) || detail::outside_prepared<X::info.v>(pv))
      result |= Status::outside_domain;
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

  template <class To>
  auto rebind() const {
    Reparametrised<decltype(darboux::rebind<To>(base)), To> result{darboux::rebind<To>(base), {}, {}};
    for (std::size_t k = 0; k < 4; ++k) result.M[k] = lift<To>(M[k]);
    for (std::size_t k = 0; k < 2; ++k) result.offset[k] = lift<To>(offset[k]);
    return result;
  }

 private:
  template <class S>
  auto inside(const S& u, const S& v) const {
    return std::pair{prepare<X::info.u>(S(lift<S>(M[0]) * u + lift<S>(M[1]) * v + lift<S>(offset[0]))),
                     prepare<X::info.v>(S(lift<S>(M[2]) * u + lift<S>(M[3]) * v + lift<S>(offset[1])))};
  }
  template <class S>
  static Vec3<S> along_v(const Frame<S>& f, const Vec3<S>& dpdv, Status at) {
    return has(at, Status::dpdv_zero) ? f.handedness * f.b : unit(dpdv);
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
/// the handedness by the sign of det A. Differentiate the base numerically, never the placed points: far from the origin
/// those have lost the digits that differences need.
template <class X, class T = double>
struct Placed {
  X base;
  std::array<T, 9> A{1, 0, 0, 0, 1, 0, 0, 0, 1};  ///< row by row
  Vec3<T> translation{};

  static constexpr SurfaceInfo info{.name = detail::AdaptedName<"placed ", X>::value,
                                    .summary = X::info.summary,
                                    .u = X::info.u,
                                    .v = X::info.v,
                                    .singular = X::info.singular,
                                    .orientable = X::info.orientable,
                                    .euler_characteristic = X::info.euler_characteristic,
                                    .own_orientation = true,
                                    .frame_error = 16};

  std::string refusal() const {
    const T d = A[0] * (A[4] * A[8] - A[5] * A[7]) - A[1] * (A[3] * A[8] - A[5] * A[6]) +
                A[2] * (A[3] * A[7] - A[4] * A[6]);
    if (!(d > 0 || d < 0)) return "the placement is singular or not finite, permitted are invertible maps";
    if constexpr (RefusesCombinations<X>) return base.refusal();
    return {};
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
    Eigen::Matrix<S, 3, 3> m;
    for (int k = 0; k < 9; ++k) m(k / 3, k % 3) = static_cast<S>(A[static_cast<std::size_t>(k)]);
    Frame<S> result = FrameTransform<S>(m)(f);
    result.status = Status::regular;
    return result;
  }
  template <class PU, class PV>
  auto normal(const PU& u, const PV& v) const {
    const auto n = detail::normal_of(base, u, v);
    using S = std::remove_cvref_t<decltype(n.x)>;
    // The columns of the cofactor matrix, det A times the inverse transpose: its sign is put back.
    const auto column = [&](std::size_t k) { return Vec3<S>{lift<S>(A[k]), lift<S>(A[k + 3]), lift<S>(A[k + 6])}; };
    const Vec3<S> x = cross(column(1), column(2)), y = cross(column(2), column(0)), z = cross(column(0), column(1));
    const Vec3<S> m = unit(n.x * x + n.y * y + n.z * z);
    return dot(column(0), x) < lift<S>(0.0) ? -m : m;
  }

  template <class PU, class PV>
  Status singular(const PU& u, const PV& v) const {
    return detail::declared(base, u, v);
  }

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
    const auto row = [&](std::size_t k) {
      return lift<S>(A[k]) * p.x + lift<S>(A[k + 1]) * p.y + lift<S>(A[k + 2]) * p.z;
    };
    return {row(0), row(3), row(6)};
  }
};
template <class X>
Placed(X, std::array<double, 9>, Vec3<double>) -> Placed<X>;

/// The parallel surface P + d n at signed distance d along the base's normal. n is the base's; the handedness turns over
/// where d passes a focal point, d κ > 1 for one principal curvature κ. The partials need third derivatives of the base:
/// nested dual numbers over its normal, some twenty times the cost. Principal curvatures κ / (1 - d κ).
/// [doCarmo2016, sec. 3-5]
template <class X, class T = double>
struct Offset {
  X base;
  T distance{0};

  static constexpr SurfaceInfo info{.name = detail::AdaptedName<"offset ", X>::value,
                                    .summary = X::info.summary,
                                    .u = X::info.u,
                                    .v = X::info.v,
                                    .singular = X::info.singular,
                                    .orientable = X::info.orientable,
                                    .euler_characteristic = X::info.euler_characteristic,
                                    .own_orientation = true,
                                    .frame_error = X::info.frame_error + 12};

  std::string refusal() const {
    if constexpr (RefusesCombinations<X>) return base.refusal();
    return {};
  }

  template <class PU, class PV>
  auto jet(const PU& u, const PV& v) const {
    auto j = base.jet(u, v);
    using S = std::remove_cvref_t<decltype(j.position.x)>;
    const Jet2<S> n = normal_jet<S>(u, v);
    const S d = lift<S>(distance);
    return Jet2<S>{.position = j.position + d * n.position,
                   .dpdu = j.dpdu + d * n.dpdu,
                   .dpdv = j.dpdv + d * n.dpdv,
                   .d2pdu2 = j.d2pdu2 + d * n.d2pdu2,
                   .d2pduv = j.d2pduv + d * n.d2pduv,
                   .d2pdv2 = j.d2pdv2 + d * n.d2pdv2};
  }

  template <class PU, class PV>
  auto frame(const PU& u, const PV& v) const {
    using S = std::remove_cvref_t<decltype(base.jet(u, v).position.x)>;
    const Status at = detail::declared(base, u, v);
    const Frame<S> f = detail::frame_at<S>(base, u, v, at);
    if (has(f.status, Status::no_frame)) return f;
    const Jet2<S> j = jet(u, v);
    // Where dpdu vanishes its direction is that of d2pduv, on the base and here.
    const bool collapsed = has(at, Status::dpdu_zero);
    const Vec3<S> along = collapsed ? j.d2pduv : j.dpdu;
    const S side = collapsed && dot(base.jet(u, v).d2pduv, f.t) < S(0) ? S(-1) : S(1);
    Frame<S> result{side * unit(along), {}, f.n, f.handedness};
    result.b = accurate_cross(result.n, result.t);
    // The base's handedness, turned over with each focal point passed.
    const S determinant = dot(accurate_cross(unit(along), unit(j.dpdv)), f.n);
    if (!has(at, Status::dpdv_zero)) result.handedness = side * determinant < S(0) ? S(-1) : S(1);
    return result;
  }
  template <class PU, class PV>
  Status singular(const PU& u, const PV& v) const {
    return detail::declared(base, u, v);
  }

  template <class PU, class PV>
  auto normal(const PU& u, const PV& v) const {
    return detail::normal_of(base, u, v);
  }

  /// K / (1 - 2 d H + d² K) of the base's stated curvatures
  template <class PU, class PV>
  auto gaussian_curvature(const PU& u, const PV& v) const
      requires StatesGaussianCurvature<X> && StatesMeanCurvature<X> {
    const auto K = base.gaussian_curvature(u, v), H = base.mean_curvature(u, v);
    using S = std::remove_cvref_t<decltype(K)>;
    const S d = lift<S>(distance), one = lift<S>(1.0), two = lift<S>(2.0);
    return S(K / (one - two * d * H + d * d * K));
  }

  template <class To>
  auto rebind() const {
    return Offset<decltype(darboux::rebind<To>(base)), To>{darboux::rebind<To>(base), lift<To>(distance)};
  }

 private:
  template <class S, class PU, class PV>
  Jet2<S> normal_jet(const PU& u, const PV& v) const {
    return detail::jet_by_duals<X::info.u, X::info.v, S>(
        [this](const auto& a, const auto& b) { return normal(a, b); }, u, v);
  }
};
template <class X>
Offset(X, double) -> Offset<X>;

}  // namespace darboux
