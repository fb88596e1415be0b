/// \file christoffel.h
/// Christoffel symbols of a surface.
#pragma once

#include <cmath>
#include <concepts>
#include <type_traits>

#include <darboux/shape_operator.h>

namespace darboux {

/// The Christoffel symbols Γ^k_ij: d2p/(di dj) = Γ^u_ij dpdu + Γ^v_ij dpdv + (normal part). u[0], u[1],
/// u[2] are Γ^u_uu, Γ^u_uv, Γ^u_vv, v[...] likewise Γ^v. Dimensionless. Not all are finite if dpdu and
/// dpdv are linearly dependent. [doCarmo2016, sec. 4-3]
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

/// The Christoffel symbols of a surface at (u, v), from its jet and frame there, within the error bound of
/// curvature.h. If terms cancel, or squares of partials underflow, they are recomputed in 40 digits. \param
/// surface a surface type, or AnySurface
template <class X, std::floating_point S>
Christoffel<S> christoffel(const X& surface, S u, S v, const Jet2<S>& j, const Frame<S>& frame) {
  const Christoffel<S> symbols = christoffel(j, frame);
  if constexpr (detail::runs_in_40_digits<X>)
    if (!has(frame.status, detail::degenerate)) {
      const S e = std::fabs(dot(j.dpdu, frame.t)), f = std::fabs(dot(j.dpdv, frame.t)),
              g = std::fabs(dot(j.dpdv, frame.b));
      S terms(0), sum(0), lengths(0);
      int k = 0;
      for (const Vec3<S>* second : {&j.d2pdu2, &j.d2pduv, &j.d2pdv2}) {
        const S along_b = detail::terms_size(*second, frame.b) / g;
        terms += along_b + (detail::terms_size(*second, frame.t) + f * along_b) / e;
        lengths += norm(*second) / std::fmin(e, g);
        sum += detail::size_of_both(symbols.u[k], symbols.v[k]);
        ++k;
      }
      // t and b may err by some u themselves, not by so little of each component.
      if (detail::cancels(terms, sum, detail::small_cancellation) || detail::cancels(lengths, sum, 16) ||
          (!HasClosedFrame<X> && detail::cancels(f, g)) || detail::squares_underflow(e, f, g)) {
        const detail::WideForms wide(surface, u, v, frame);
        const Christoffel<Multiprecision> exact = christoffel(wide.jet, wide.frame);
        Christoffel<S> result;
        for (int i = 0; i < 3; ++i) {
          result.u[i] = detail::rounded_to<S>(exact.u[i]);
          result.v[i] = detail::rounded_to<S>(exact.v[i]);
        }
        return result;
      }
    }
  return symbols;
}

/// Γ^k_ij with d2p/(di dj) = Γ^u_ij dpdu + Γ^v_ij dpdv + (normal part) at (u, v), dimensionless. Not all
/// are finite if dpdu and dpdv are linearly dependent. Cost: jet() and frame(), plus 50 us if terms cancel.
template <class X, std::floating_point S>
requires std::is_class_v<X> Christoffel<S> christoffel(const X& surface, S u, S v) {
  return christoffel(surface, u, v, detail::jet_of(surface, u, v), detail::frame_of(surface, u, v));
}
template <class X, class U, class V>
requires(detail::MixedCoordinates<U, V>&& std::is_class_v<X>)
    Christoffel<double> christoffel(const X& surface, U u, V v) {
  return christoffel(surface, static_cast<double>(u), static_cast<double>(v));
}

}  // namespace darboux
