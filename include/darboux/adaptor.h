/// \file adaptor.h
/// Common code of adaptors, the surfaces made from other surfaces: placed.h, reparametrised.h, offset.h,
/// from_position.h. An adaptor is itself a surface type, so adaptors compose, and every law of testing.h
/// applies to them. They keep the normal of the base (Placed transforms it by the inverse transpose). A flip,
/// swap or mirror negates the handedness, never the normal. An adaptor passes its own numbers to
/// for_each_own_number(f), so that the status reports NaN and infinity among them.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <string>
#include <string_view>

#include <darboux/error.h>
#include <darboux/point.h>

namespace darboux {

namespace detail {

// Why the base of an adaptor is invalid; empty if it is valid.
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

// The name, such as "offset torus", with static storage duration.
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

// The info of an adaptor that moves the points and keeps the coordinates. \param added error of its frame
// beyond that of the base, in roundings
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

// ∫ f(x0 + s (x - x0)) ds over [0, 1], x0 the constant part of x: for a dual number x exact to fifth order
// (Boole's rule).
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

// The unit normal of a surface at prepared coordinates of any scalar. If the chart of a surface without a
// closed frame collapses at v0, dpdu = (v - v0) Q with Q the mean of d2pduv between v0 and v. The normal and
// all its derivatives are then those of ±Q × dpdv, with the sign of limit_at(). (Likewise for dpdv and u.)
// NaN if that does not determine it.
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

// Value and all derivatives to second order of a vector function of prepared coordinates, by nested dual
// numbers.
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

}  // namespace darboux
