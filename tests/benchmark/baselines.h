/// \file baselines.h
/// The other methods of evaluation at many points, with which the library is compared, and the limits
/// of the machine. baselines.cpp is compiled at -O2 for the baseline of the architecture, whatever the rest
/// of the build asks for.
#pragma once

#include <array>
#include <cstddef>
#include <string_view>
#include <vector>

#include <darboux/bspline_patch.h>

namespace darboux::bench {

/// How the numbers of a point lie in memory.
enum class Layout { separate, vectors, structs };
/// Which numbers: position, dpdu, dpdv, t, b, n; or t, b, n; or t and the sign w; or position.
enum class Wanted { all, frame, tangent4, position };

constexpr std::size_t numbers_of(Wanted wanted) {
  return wanted == Wanted::all ? 18 : wanted == Wanted::frame ? 9 : wanted == Wanted::tangent4 ? 4 : 3;
}

/// Where a loop writes: `arrays` arrays of `bytes` bytes each, `stride` bytes apart.
struct Destination {
  char* base;
  std::size_t arrays, bytes, stride;
};

/// The destination of `points` points from `base` on: arrays of whole 64-byte lines, each 320 bytes further
/// than without a gap, so that no two start a power of two apart.
template <class T>
Destination destination_of(Layout layout, Wanted wanted, char* base, std::size_t points) {
  const std::size_t numbers = numbers_of(wanted), arrays = layout == Layout::structs    ? 1
                                                           : layout == Layout::separate ? numbers
                                                                                        : (numbers + 2) / 3;
  const std::size_t bytes = points * (numbers / arrays) * sizeof(T);
  return {base, arrays, bytes, (bytes + 63) / 64 * 64 + 320};
}

/// Where the k-th number of a point lies.
template <class T>
T* number_at(Layout layout, Wanted wanted, const Destination& to, std::size_t k, std::size_t point) {
  const std::size_t numbers = numbers_of(wanted);
  const auto first = [&](std::size_t array) { return reinterpret_cast<T*>(to.base + array * to.stride); };
  switch (layout) {
    case Layout::separate:
      return first(k) + point;
    case Layout::vectors:
      return first(k / 3) + 3 * point + k % 3;
    default:
      return first(0) + numbers * point + k;
  }
}

/// The two surfaces for which the loops are written by hand: Torus{1, 0.25} and Sphere{1}.
enum class ByHand { torus, sphere };

/// What a user would write, or has at hand.
enum class Method {
  naive,        ///< Eigen: std::sin and std::cos of 2πu, partials by the formula, normalized() and cross()
  closed_form,  ///< the same with the frame in closed form too: no square root, no division
  dual,         ///< partials by dual numbers through the formula of the position, the frame as in naive
  differences,  ///< partials by central differences of the second order, the frame as in naive
  occt_d1,      ///< OCCT's D1, the frame as in naive
  occt_d2,      ///< OCCT's D2, the frame as in naive
  points,       ///< the library's functions for single points: sample(), or frame() alone
};

/// Whether OCCT is compiled in.
extern const bool with_occt;

/// Evaluates at n points. Only naive knows other layouts and fewer numbers than 18 separate arrays, but
/// points also knows t, b, n.
template <class T>
void evaluate_by(Method method, ByHand surface, Layout layout, Wanted wanted, const T* u, const T* v,
                 std::size_t n, const Destination& to);

/// The loops that go through a surface type of the catalogue, 18 separate arrays.
template <class T>
struct CatalogueLoops {
  using Loop = void (*)(const T* u, const T* v, std::size_t n, const Destination& to);
  std::string_view surface;
  Loop naive;  ///< the type's own formula at std::sin and std::cos, the frame by Eigen
};
/// In the catalogue's order.
template <class T>
const std::vector<CatalogueLoops<T>>& catalogue_loops();

/// The B-spline that is timed: bicubic, on a net of 8 x 8 points without weights, clamped.
BSplinePatch<double> timed_spline();
/// It as a textbook has it, at n points, 18 separate arrays: each point's spans by bisection, its basis
/// functions and their first derivatives by Cox and de Boor, sums over sixteen control points, the frame as
/// in Method::naive. [PieglTiller1997, A2.1, A2.2, eq. 2.7, A3.6]
void textbook_spline(const double* u, const double* v, std::size_t n, const Destination& to);

/// A way to fill memory with registers of one width.
struct Writer {
  std::string_view name;
  void (*past_caches)(const Destination& to);  ///< non-temporal stores, a whole line an array in turn
  void (*cached)(const Destination& to);       ///< the same with plain stores
};
/// Those this machine can run.
std::vector<Writer> writers();

}  // namespace darboux::bench
