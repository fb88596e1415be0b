/// \file from_position.h
/// Surfaces from a position alone: the partials come by dual numbers.
#pragma once

#include <type_traits>
#include <utility>

#include <darboux/adaptor.h>

namespace darboux {

/// A surface from its position alone: X has `info` and position(u, v) -> Vec3<S> on prepared coordinates of
/// any scalar; the partials come from nested dual numbers, to the last bits, at some ten times the cost.
/// Whatever else X states (parameters, singular, facts) is passed on.
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

}  // namespace darboux
