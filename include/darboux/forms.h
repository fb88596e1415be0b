/// \file forms.h
/// First and second fundamental forms. Derived quantities: shape_operator.h, curvature.h, christoffel.h.
#pragma once

#include <darboux/scalar.h>
#include <darboux/surface.h>

namespace darboux {

/// E = dpdu·dpdu, F = dpdu·dpdv, G = dpdv·dpdv. Units: length².
template <class S>
struct FirstForm {
  S E, F, G;
};

/// L = n·d2pdu2, M = n·d2pduv, N = n·d2pdv2. Units: length. A sphere with outward n has L, N < 0.
template <class S>
struct SecondForm {
  S L, M, N;
};

template <class S>
FirstForm<S> first_form(const Jet2<S>& j) {
  return {dot(j.dpdu, j.dpdu), dot(j.dpdu, j.dpdv), dot(j.dpdv, j.dpdv)};
}

/// The second form. \param n the unit normal; fixes the sign
template <class S>
SecondForm<S> second_form(const Jet2<S>& j, const Vec3<S>& n) {
  return {dot(n, j.d2pdu2), dot(n, j.d2pduv), dot(n, j.d2pdv2)};
}

/// K = (LN - M²)/(EG - F²) and H = (EN - 2FM + GL)/(2(EG - F²)) the textbook formulas, for any scalar, at
/// regular points, with radii whose fourth power is representable. curvature() of curvature.h is the robust
/// version. [doCarmo2016, sec. 3-3]
template <class S>
S gaussian_curvature(const FirstForm<S>& I, const SecondForm<S>& II) {
  return (II.L * II.N - II.M * II.M) / (I.E * I.G - I.F * I.F);
}
template <class S>
S mean_curvature(const FirstForm<S>& I, const SecondForm<S>& II) {
  return (I.E * II.N - lift<S>(2.0) * (I.F * II.M) + I.G * II.L) / (lift<S>(2.0) * (I.E * I.G - I.F * I.F));
}

}  // namespace darboux
