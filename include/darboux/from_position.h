/// \file from_position.h
/// Surfaces defined by a position formula only. The partials are computed with dual numbers.
#pragma once

#include <type_traits>
#include <utility>

#include <darboux/adaptor.h>

namespace darboux {

namespace detail {

// Of a prepared coordinate.
template <class P>
struct ScalarOf {
  using Type = P;
};
template <class S>
struct ScalarOf<Turn<S>> {
  using Type = S;
};

}  // namespace detail

/// A surface defined by its position. X has `info` and position(u, v) -> Vec3<S> for prepared coordinates of
/// any scalar. The partials are computed with nested dual numbers, accurate to rounding, at some ten times
/// the cost of closed forms. Other members of X (parameters, singular, facts) are forwarded.
template <class X>
struct FromPosition : X {
  template <class PU, class PV>
  auto jet(const PU& u, const PV& v) const {
    using S = std::remove_cvref_t<decltype(X::position(u, v).x)>;
    return detail::jet_by_duals<X::info.u, X::info.v, S>(
        [this](const auto& a, const auto& b) {
          constexpr bool any_scalar = requires {
            this->X::position(a, b);
          };
          static_assert(any_scalar,
                        "expected template <class S> position(u, v) of any scalar S; got one that does not "
                        "take dual numbers");
          if constexpr (any_scalar)
            return this->X::position(a, b);
          else
            return Vec3<typename detail::ScalarOf<std::remove_cvref_t<decltype(a)>>::Type>{};
        },
        u, v);
  }

  template <class To>
  auto rebind() const {
    return FromPosition<decltype(darboux::rebind<To>(std::declval<const X&>()))>{
        darboux::rebind<To>(static_cast<const X&>(*this))};
  }
};

}  // namespace darboux
