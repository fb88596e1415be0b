/// \file affine_map.h
/// Affine maps of points, normals and frames.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>

#include <darboux/frame.h>
#include <darboux/scalar.h>
#include <darboux/vector.h>

namespace darboux {

/// p -> A p + translation, det A ≠ 0, in the units of p: how Placed places a surface. Its numbers are
/// lifted to the scalar S of what is mapped. Nothing is checked or thrown: of a singular A the unit vectors
/// are zero or any, of numbers that are not finite NaN. Placed::refusal() finds both.
template <class T = double>
struct AffineMap {
  std::array<T, 9> A{1, 0, 0, 0, 1, 0, 0, 0, 1};  ///< row by row
  Vec3<T> translation{};

  /// What A does to normals: its cofactors, which are det A times the inverse transpose, column by column and
  /// times a power of two; and the sign of det A, 1 or -1.
  template <class S>
  struct NormalMap {
    Vec3<S> x, y, z;
    S sign;
    /// The unit normal where the surface's was n, on the same side of it.
    Vec3<S> operator()(const Vec3<S>& n) const {
      const Vec3<S> m = unit(n.x * x + n.y * y + n.z * z);
      return sign < lift<S>(0.0) ? -m : m;
    }
  };

  /// A p, for directions and derivatives. Terms with factor 0 are left out: the coordinate may be infinite.
  template <class S>
  Vec3<S> linear(const Vec3<S>& p) const {
    const auto row = [&](std::size_t k) {
      S sum = lift<S>(0.0);
      if (A[k] != T(0)) sum = sum + lift<S>(A[k]) * p.x;
      if (A[k + 1] != T(0)) sum = sum + lift<S>(A[k + 1]) * p.y;
      if (A[k + 2] != T(0)) sum = sum + lift<S>(A[k + 2]) * p.z;
      return sum;
    };
    return {row(0), row(3), row(6)};
  }
  /// A p + translation, for positions.
  template <class S>
  Vec3<S> point(const Vec3<S>& p) const {
    return linear(p) + Vec3<S>{lift<S>(translation.x), lift<S>(translation.y), lift<S>(translation.z)};
  }

  /// Computed once for many normals: three cross products with errors of a rounding or two. A is scaled
  /// first, so that none overflows.
  template <class S>
  NormalMap<S> of_normals() const {
    double largest = 0;
    for (const T& x : A) largest = std::fmax(largest, detail::size_of(x));
    const int e = largest > 0 ? std::ilogb(largest) : 0;
    const auto column = [&](std::size_t k) {
      return detail::scaled_by_power_of_two(Vec3<S>{lift<S>(A[k]), lift<S>(A[k + 3]), lift<S>(A[k + 6])}, -e);
    };
    const Vec3<S> x = accurate_cross(column(1), column(2)), y = accurate_cross(column(2), column(0)),
                  z = accurate_cross(column(0), column(1));
    return {x, y, z, lift<S>(dot(column(0), x) < lift<S>(0.0) ? -1.0 : 1.0)};
  }

  /// t = unit(A t), n by the inverse transpose, b = unit(n x t), the handedness times the sign of det A; the
  /// status stays. Some 12 roundings times the condition number of A. \param normals of_normals()
  template <class S>
  Frame<S> frame(const Frame<S>& f, const NormalMap<S>& normals) const {
    const Vec3<S> t = unit(linear(f.t)), n = normals(f.n);
    return {t, unit(accurate_cross(n, t)), n, normals.sign * f.handedness, f.status};
  }
};

}  // namespace darboux
