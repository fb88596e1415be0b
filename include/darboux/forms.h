/// \file forms.h
/// First and second fundamental form and what follows from them: Gaussian, mean and principal curvatures.
#pragma once

#include <cmath>

#include <darboux/frame.h>
#include <darboux/surface.h>

namespace darboux {

/// E = dpdu·dpdu, F = dpdu·dpdv, G = dpdv·dpdv. Units: length².
template <class S>
struct FirstForm {
  S E, F, G;
};

/// L = n·d2pdu2, M = n·d2pduv, N = n·d2pdv2. Units: length. With n outward a sphere has L, N < 0.
template <class S>
struct SecondForm {
  S L, M, N;
};

template <class S>
FirstForm<S> first_form(const Jet2<S>& j) {
  return {dot(j.dpdu, j.dpdu), dot(j.dpdu, j.dpdv), dot(j.dpdv, j.dpdv)};
}

/// \param n the unit normal to which the signs refer
template <class S>
SecondForm<S> second_form(const Jet2<S>& j, const Vec3<S>& n) {
  return {dot(n, j.d2pdu2), dot(n, j.d2pduv), dot(n, j.d2pdv2)};
}

/// K = (LN - M²)/(EG - F²) and H = (EN - 2FM + GL)/(2(EG - F²)) as the literature writes them; any scalar,
/// regular points, radii whose fourth power is representable. curvature() below is the robust form.
/// [doCarmo2016, sec. 3-3]
template <class S>
S gaussian_curvature(const FirstForm<S>& I, const SecondForm<S>& II) {
  return (II.L * II.N - II.M * II.M) / (I.E * I.G - I.F * I.F);
}
template <class S>
S mean_curvature(const FirstForm<S>& I, const SecondForm<S>& II) {
  return (I.E * II.N - lift<S>(2.0) * (I.F * II.M) + I.G * II.L) / (lift<S>(2.0) * (I.E * I.G - I.F * I.F));
}

/// Curvatures at a point, with respect to the frame's n: with n outward a sphere of radius r has κ1 = κ2 = H
/// = -1/r.
template <class S>
struct Curvature {
  S gaussian;             ///< K = κ1 κ2, 1/length²
  S mean;                 ///< H = (κ1 + κ2)/2, 1/length
  S principal[2];         ///< κ1 >= κ2, 1/length
  Vec3<S> directions[2];  ///< unit; directions[1] = n × directions[0], and directions[0]·t >= 0
  Status status;          ///< the frame's, with `umbilic` where κ1 = κ2 (the directions are then t and b)
};

/// Curvatures from a jet and its orthonormal frame, through the shape operator in the basis (t, b):
///   S = [[a, m], [m, c]],  H = (a + c)/2,  κ = H ± hypot((a - c)/2, m)
/// accurate at umbilics and for any representable size. κ1 and κ2 count as equal (umbilic) when they differ
/// by less than 16u (|a| + |c|), what rounding leaves of the jet. NaN where dpdu and dpdv span no plane.
/// About 60 ns.
template <std::floating_point S>
Curvature<S> curvature(const Jet2<S>& j, const Frame<S>& frame) {
  // dpdu = e t, dpdv = f t + g b
  const S e = dot(j.dpdu, frame.t), f = dot(j.dpdv, frame.t), g = dot(j.dpdv, frame.b);
  // Each second derivative is divided once before the dot product, which near a pole would underflow.
  const S a = dot(frame.n, j.d2pdu2 / e) / e;
  const S m = (dot(frame.n, j.d2pduv / e) - f * a) / g;
  const S c = (dot(frame.n, j.d2pdv2 / g) - f * (a * (f / g) + S(2) * m)) / g;
  Curvature<S> result;
  result.status = frame.status;
  result.mean = (a + c) / S(2);
  result.gaussian = difference_of_products(a, c, m, m);
  if (!std::isfinite(result.gaussian)) result.gaussian = a * c - m * m;
  const S half_difference = (a - c) / S(2), radius = std::hypot(half_difference, m);
  result.principal[0] = result.mean + radius;
  result.principal[1] = result.mean - radius;
  // The eigenvector of κ1, from whichever of its two forms does not cancel.
  S x = half_difference >= S(0) ? half_difference + radius : m;
  S y = half_difference >= S(0) ? m : radius - half_difference;
  if (!(S(2) * radius > S(16) * std::numeric_limits<S>::epsilon() / S(2) * (std::fabs(a) + std::fabs(c)))) {
    if (std::isfinite(radius)) result.status |= Status::umbilic;
    x = std::isfinite(radius) ? S(1) : radius;
    y = S(0);
  }
  const S length = std::hypot(x, y);
  x = x / length;
  y = y / length;
  if (x < S(0) || (x == S(0) && y < S(0))) x = -x, y = -y;
  result.directions[0] = x * frame.t + y * frame.b;
  result.directions[1] = x * frame.b - y * frame.t;
  return result;
}

}  // namespace darboux
