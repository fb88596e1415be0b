/// \file ceres_jet.h
/// Makes every formula of the library work with ceres::Jet. This header does not include Ceres: include
/// <ceres/jet.h> yourself.
#pragma once

#include <darboux/scalar.h>

namespace ceres {
template <typename T, int N>
struct Jet;
}

namespace darboux {

template <class T, int N>
struct Scalar<ceres::Jet<T, N>> {
  using D = ceres::Jet<T, N>;
  static const T& value(const D& x) { return x.a; }
  static D pi() { return D(darboux::pi<T>()); }
  static D lift(double x) { return D(darboux::lift<T>(x)); }
  static Turn<D> sincos_turns(const D& u) { return sincos(Scalar<T>::sincos_turns(u.a), two_pi<T>(), u); }
  static Turn<D> sincos_half_turns(const D& v) {
    return sincos(Scalar<T>::sincos_half_turns(v.a), darboux::pi<T>(), v);
  }

 private:
  static Turn<D> sincos(const Turn<T>& angle, const T& omega, const D& x) {
    return detail::sincos_dual<D>(angle, omega, [&](const T& v, const T& slope) {
      D result(v);
      result.v = slope * x.v;
      return result;
    });
  }
};

}  // namespace darboux
