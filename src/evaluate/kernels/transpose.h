/// \file transpose.h
/// Square blocks of numbers, one register per row, transposed in registers.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <utility>

#include "lanes.h"

namespace darboux::kernels {
namespace {

// Vectors of the compiler. Their sizes are written out: some compilers lose those that depend on a parameter.
template <class T, std::size_t n>
struct VectorOf;
#define DARBOUX_VECTOR(T, n)                                    \
  template <>                                                   \
  struct VectorOf<T, n> {                                       \
    using type = T __attribute__((vector_size(sizeof(T) * n))); \
  };
DARBOUX_VECTOR(std::int32_t, 2)
DARBOUX_VECTOR(std::int32_t, 4)
DARBOUX_VECTOR(std::int32_t, 8)
DARBOUX_VECTOR(std::int32_t, 16)
DARBOUX_VECTOR(double, 2)
DARBOUX_VECTOR(double, 4)
DARBOUX_VECTOR(double, 8)
DARBOUX_VECTOR(float, 4)
DARBOUX_VECTOR(float, 8)
DARBOUX_VECTOR(float, 16)
#undef DARBOUX_VECTOR

// Rows of as many numbers as a register has.
template <class T>
inline constexpr int row_size = static_cast<int>(sizeof(Register<T>) / sizeof(T));
template <class T>
using Row = typename VectorOf<T, row_size<T>>::type;

// Exchanges the blocks of `width` columns that lie off the diagonal of two rows.
template <int width, class R, int... k>
[[gnu::always_inline]] inline void exchange(R& a, R& b, std::integer_sequence<int, k...>) {
  constexpr int n = sizeof...(k);
  const R upper = __builtin_shufflevector(a, b, ((k & width) != 0 ? n + k - width : k)...);
  b = __builtin_shufflevector(a, b, ((k & width) != 0 ? n + k : k + width)...);
  a = upper;
}
// Rows become columns. \tparam width of the first blocks: half a row
template <int width, class R, std::size_t n>
[[gnu::always_inline]] inline void transpose(std::array<R, n>& rows) {
#pragma GCC unroll 16
  for (std::size_t i = 0; i < n; ++i)
    if ((i & width) == 0)
      exchange<width>(rows[i], rows[i + width], std::make_integer_sequence<int, static_cast<int>(n)>{});
  if constexpr (width > 1) transpose<width / 2>(rows);
}

}  // namespace
}  // namespace darboux::kernels
