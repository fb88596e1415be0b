/// \file loops.h
/// Frames at a point as commonly implemented: sines from the C++ library, a cross product, lengths; partials
/// by the formula, by dual numbers through the position, or by its central differences.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numbers>
#include <span>

#include <Eigen/Dense>

#include <darboux/point.h>
#include <darboux/surface.h>

namespace darboux::loops {

template <class T>
using Vector = Eigen::Matrix<T, 3, 1>;

template <class T>
struct Numbers {
  Vector<T> position, dpdu, dpdv, t, b, n;
};

template <class T>
Numbers<T> with_frame(const Vector<T>& position, const Vector<T>& dpdu, const Vector<T>& dpdv) {
  const Vector<T> t = dpdu.normalized(), n = dpdu.cross(dpdv).normalized();
  return {position, dpdu, dpdv, t, n.cross(t), n};
}

inline constexpr std::array<double, 16> central_weights{1. / 2, 0,        0,        0,  //
                                                        2. / 3, -1. / 12, 0,        0,  //
                                                        3. / 4, -3. / 20, 1. / 60,  0,  //
                                                        4. / 5, -1. / 5,  4. / 105, -1. / 280};
/// Weights of f(x + k h) - f(x - k h), k = 1 ... order/2, over h, for the first derivative.
/// \param order 2, 4, 6 or 8 [Fornberg1988]
constexpr std::span<const double> difference_weights(int order) {
  const auto terms = static_cast<std::size_t>(order / 2);
  return std::span(central_weights).subspan(4 * (terms - 1), terms);
}

/// The step at which rounding and truncation errors are about equal for a function that varies like sin 2πx,
/// a power of two.
template <class T>
T difference_step(int order) {
  const double truncation = order == 2 ? 1. / 6 : order == 4 ? 1. / 30 : order == 6 ? 1. / 140 : 1. / 630;
  const double angle =
      std::pow(static_cast<double>(std::numeric_limits<T>::epsilon()) / truncation, 1.0 / (order + 1));
  return static_cast<T>(std::exp2(std::round(std::log2(angle / (2 * std::numbers::pi)))));
}

/// \param position of (T, T), a Vector<T> \param h difference_step(order)
template <class T, class P>
Numbers<T> by_differences(int order, const P& position, T u, T v, T h) {
  const std::span<const double> weights = difference_weights(order);
  Vector<T> dpdu = Vector<T>::Zero(), dpdv = Vector<T>::Zero();
  for (std::size_t k = 0; k < weights.size(); ++k) {
    const T x = static_cast<T>(k + 1) * h, weight = static_cast<T>(weights[k]);
    dpdu += weight * (position(u + x, v) - position(u - x, v));
    dpdv += weight * (position(u, v + x) - position(u, v - x));
  }
  return with_frame<T>(position(u, v), dpdu / h, dpdv / h);
}

/// \param position of two dual numbers, a Vec3 of them
template <class T, class P>
Numbers<T> by_dual(const P& position, T u, T v) {
  using D = Dual<T, 2>;
  const Vec3<D> p = position(D::variable(u, 0), D::variable(v, 1));
  const auto part = [&](std::size_t k) {
    return Vector<T>{p.x.derivative[k], p.y.derivative[k], p.z.derivative[k]};
  };
  return with_frame<T>({p.x.value, p.y.value, p.z.value}, part(0), part(1));
}

// ---- through a surface type -------------------------------------------------------------------------------

/// A coordinate as prepare() hands it to formulas, by the sines of the C++ library.
template <Coordinate kind, class T>
auto prepare_naively(T x) {
  if constexpr (kind == Coordinate::linear) {
    return x;
  } else {
    const T angle = static_cast<T>(kind == Coordinate::turn ? 2 * std::numbers::pi : std::numbers::pi) * x;
    return Turn<T>{std::sin(angle), std::cos(angle)};
  }
}

template <class T>
Vector<T> eigen(const Vec3<T>& a) {
  return {a.x, a.y, a.z};
}

template <class T, class X>
Jet2<T> naive_jet(const X& surface, T u, T v) {
  return surface.jet(prepare_naively<X::info.u>(u), prepare_naively<X::info.v>(v));
}
template <class T, class X>
Numbers<T> naive(const X& surface, T u, T v) {
  const Jet2<T> j = naive_jet(surface, u, v);
  return with_frame<T>(eigen(j.position), eigen(j.dpdu), eigen(j.dpdv));
}
template <class T, class X>
Numbers<T> dual(const X& surface, T u, T v) {
  return by_dual<T>([&](const auto& a, const auto& b) { return jet(surface, a, b).position; }, u, v);
}
template <class T, class X>
Numbers<T> differences(int order, const X& surface, T u, T v, T h) {
  return by_differences<T>(
      order, [&](T a, T b) { return eigen(naive_jet(surface, a, b).position); }, u, v, h);
}

}  // namespace darboux::loops
