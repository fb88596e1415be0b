/// \file layout.h
/// Stores lanes in the requested layout: separate arrays, arrays of vectors, rows of structs.
#pragma once

#include <array>
#include <bit>
#include <concepts>
#include <cstddef>
#include <cstring>
#include <utility>

#include "lanes.h"
#include "transpose.h"
#include "work.h"

namespace darboux::kernels {
namespace {

// The compiler's own vector type of a register: what __builtin_shufflevector takes; and the same in memory,
// where only its numbers are aligned.
template <class T>
struct Native {
  typedef T type __attribute__((vector_size(sizeof(T) * Register<T>::size)));
  typedef T in_memory
      __attribute__((vector_size(sizeof(T) * Register<T>::size), aligned(sizeof(T)), may_alias));
};
template <class T>
using Vector = typename Native<T>::type;

template <class T>
Vector<T> native(const Register<T>& x) {
  Vector<T> result;
  static_assert(sizeof result == sizeof x.data);
  std::memcpy(&result, &x.data, sizeof result);
  return result;
}
template <class T>
void store(T* to, const Vector<T>& x) {
  *reinterpret_cast<typename Native<T>::in_memory*>(to) = x;
}

#if defined(__SSE2__)
constexpr bool stores_can_pass_caches = true;
#else
constexpr bool stores_can_pass_caches = false;
#endif
// Only worthwhile if consecutive registers fill whole cache lines.
template <class T>
void store_past_caches(T* to, const Vector<T>& x) {
#if defined(__AVX512F__)
  _mm512_stream_si512(reinterpret_cast<__m512i*>(to), std::bit_cast<__m512i>(x));
#elif defined(__AVX__)
  _mm256_stream_si256(reinterpret_cast<__m256i*>(to), std::bit_cast<__m256i>(x));
#elif defined(__SSE2__)
  _mm_stream_si128(reinterpret_cast<__m128i*>(to), std::bit_cast<__m128i>(x));
#else
  store(to, x);
#endif
}

inline void stream_lines(char* to, const char* from, std::size_t lines) {
  auto* out = reinterpret_cast<double*>(to);
  const auto* in = reinterpret_cast<const double*>(from);
  for (std::size_t i = 0; i < lines * batch_size<double>; i += Register<double>::size)
    store_past_caches(out + i, native<double>(Register<double>::load_aligned(in + i)));
}
inline void fence() {
#if defined(__SSE2__)
  _mm_sfence();
#endif
}

// The k-th register of a0 b0 c0 a1 b1 c1 ...
template <class T, int k, int... j>
Vector<T> third(const Vector<T>& a, const Vector<T>& b, const Vector<T>& c,
                std::integer_sequence<int, j...>) {
  constexpr int W = sizeof...(j);
  // From a and b first; the places of c are arbitrary.
  const Vector<T> ab = __builtin_shufflevector(a, b,
                                               ((k * W + j) % 3 == 0   ? (k * W + j) / 3
                                                : (k * W + j) % 3 == 1 ? W + (k * W + j) / 3
                                                                       : 0)...);
  return __builtin_shufflevector(ab, c, ((k * W + j) % 3 == 2 ? W + (k * W + j) / 3 : j)...);
}
// a0 b0 a1 b1 ...: the lower half (k = 0) or the upper (1).
template <class T, int k, int... j>
Vector<T> alternate(const Vector<T>& a, const Vector<T>& b, std::integer_sequence<int, j...>) {
  constexpr int W = sizeof...(j);
  return __builtin_shufflevector(a, b, ((j % 2) * W + (k * W + j) / 2)...);
}

template <class T>
using Sequence = std::make_integer_sequence<int, static_cast<int>(Register<T>::size)>;

// The vectors from consecutive registers, in registers.
template <class T>
std::array<Vector<T>, 1> packed(const Register<T>& x) {
  return {native(x)};
}
template <class T>
std::array<Vector<T>, 2> packed(const Register<T>& x, const Register<T>& y) {
  const Vector<T> a = native(x), b = native(y);
  return {alternate<T, 0>(a, b, Sequence<T>{}), alternate<T, 1>(a, b, Sequence<T>{})};
}
template <class T>
std::array<Vector<T>, 3> packed(const Register<T>& x, const Register<T>& y, const Register<T>& z) {
  const Vector<T> a = native(x), b = native(y), c = native(z);
  return {third<T, 0>(a, b, c, Sequence<T>{}), third<T, 1>(a, b, c, Sequence<T>{}),
          third<T, 2>(a, b, c, Sequence<T>{})};
}
template <class T>
std::array<Vector<T>, 4> packed(const Register<T>& x, const Register<T>& y, const Register<T>& z,
                                const Register<T>& w) {
  const Vector<T> a = native(x), b = native(y), c = native(z), d = native(w);
  const Vector<T> ac0 = alternate<T, 0>(a, c, Sequence<T>{}), ac1 = alternate<T, 1>(a, c, Sequence<T>{});
  const Vector<T> bd0 = alternate<T, 0>(b, d, Sequence<T>{}), bd1 = alternate<T, 1>(b, d, Sequence<T>{});
  return {alternate<T, 0>(ac0, bd0, Sequence<T>{}), alternate<T, 1>(ac0, bd0, Sequence<T>{}),
          alternate<T, 0>(ac1, bd1, Sequence<T>{}), alternate<T, 1>(ac1, bd1, Sequence<T>{})};
}

// The destination of a batch of points: the slots from `at` on.
template <class T>
struct Target {
  const Work<T>& work;
  std::size_t at;
  bool past_caches;
};

// The components of one attribute. Past the caches the registers of a line follow one another.
template <class T, std::size_t N, std::same_as<Lanes<T, N>>... C>
void put(const Target<T>& p, Attribute a, const Lanes<T, N>& first, const C&... other) {
  constexpr std::size_t W = Register<T>::size, components = 1 + sizeof...(C);
  const Slot<T>& slot = p.work.slots[static_cast<std::size_t>(a)];
  if (slot.arrangement == Arrangement::absent) return;
  const auto write = [&](T* to, const Vector<T>& x) {
    if constexpr (N * sizeof x == line)
      if (p.past_caches) return store_past_caches(to, x);
    store(to, x);
  };
  if (slot.arrangement == Arrangement::separate) {
    const auto one = [&](T* to, const Lanes<T, N>& x) {
      for (std::size_t i = 0; i < N; ++i) write(to + i * W, native<T>(x.value().at[i]));
    };
    one(slot.component[0] + p.at, first);
    std::size_t k = 1;
    (one(slot.component[k++] + p.at, other), ...);
  } else if (slot.arrangement == Arrangement::packed) {
    if constexpr (components <= 4) {
      T* to = slot.component[0] + components * p.at;
      for (std::size_t i = 0; i < N; ++i)
        for (const Vector<T>& x : packed<T>(first.value().at[i], other.value().at[i]...))
          write(std::exchange(to, to + W), x);
    }
  } else {
    T* to = p.work.tile + slot.row * batch_size<T>;
    first.store(to);
    (other.store(to += batch_size<T>), ...);
  }
}

// In each 128 bits of the rows, their transpose: rows become points.
inline void transpose(const Vector<double>* row, Vector<double>* point) {
  constexpr int W = Register<double>::size;
  const auto pick = [&]<int... j>(std::integer_sequence<int, j...>) {
    point[0] = __builtin_shufflevector(row[0], row[1], ((j % 2) * W + (j & ~1))...);
    point[1] = __builtin_shufflevector(row[0], row[1], ((j % 2) * W + (j | 1))...);
  };
  pick(Sequence<double>{});
}
inline void transpose(const Vector<float>* row, Vector<float>* point) {
  constexpr int W = Register<float>::size;
  const auto pick = [&]<int... j>(std::integer_sequence<int, j...>) {
    // a0 b0 a1 b1 and a2 b2 a3 b3 of each four, then halves of them.
    const auto low = [&](const Vector<float>& a, const Vector<float>& b) {
      return __builtin_shufflevector(a, b, ((j % 2) * W + (j & ~3) + (j % 4) / 2)...);
    };
    const auto high = [&](const Vector<float>& a, const Vector<float>& b) {
      return __builtin_shufflevector(a, b, ((j % 2) * W + (j & ~3) + 2 + (j % 4) / 2)...);
    };
    const Vector<float> l0 = low(row[0], row[1]), l1 = low(row[2], row[3]), h0 = high(row[0], row[1]),
                        h1 = high(row[2], row[3]);
    const auto first = [&](const Vector<float>& a, const Vector<float>& b) {
      return __builtin_shufflevector(a, b, ((j % 4 < 2 ? 0 : W) + (j & ~3) + j % 2)...);
    };
    const auto second = [&](const Vector<float>& a, const Vector<float>& b) {
      return __builtin_shufflevector(a, b, ((j % 4 < 2 ? 0 : W) + (j & ~3) + 2 + j % 2)...);
    };
    point[0] = first(l0, l1);
    point[1] = second(l0, l1);
    point[2] = first(h0, h1);
    point[3] = second(h0, h1);
  };
  pick(Sequence<float>{});
}

// The k-th 16 bytes of a register.
template <int k, class T>
void store_part(T* to, const Vector<T>& x) {
  constexpr int Q = 16 / sizeof(T);
  typedef T Part __attribute__((vector_size(16), aligned(sizeof(T)), may_alias));
  if constexpr (sizeof(Vector<T>) == 16)
    *reinterpret_cast<Part*>(to) = x;
  else
    [&]<int... j>(std::integer_sequence<int, j...>) {
      *reinterpret_cast<Part*>(to) = __builtin_shufflevector(x, x, (k * Q + j)...);
    }
  (std::make_integer_sequence<int, Q>{});
}

// Writes the tile's rows to the structs: a register of a point at a time if it has that many numbers, then 16
// bytes at a time.
template <std::size_t points, class T>
void scatter(const Target<T>& place) {
  const Work<T>& w = place.work;
  constexpr int W = Register<T>::size, B = batch_size<T>, Q = 16 / sizeof(T);
  for (std::size_t r = 0; r < w.run_count; ++r) {
    const Run<T>& run = w.runs[r];
    const T* rows = w.tile + run.row * B;
    char* first = reinterpret_cast<char*>(run.first) + run.stride * static_cast<std::ptrdiff_t>(place.at);
    if (run.count < Q) {
      for (std::size_t p = 0; p < points; ++p, first += run.stride)
        for (std::size_t k = 0; k < run.count; ++k) reinterpret_cast<T*>(first)[k] = rows[k * B + p];
      continue;
    }
    for (std::size_t part = 0; part < points; part += W, rows += W, first += W * run.stride) {
      std::size_t k = 0;
      if constexpr (W > Q)
        for (; k + W <= run.count; k += W) {
          std::array<Row<T>, std::size_t{W}> block;
#pragma GCC unroll 16
          for (std::size_t i = 0; i < W; ++i) std::memcpy(&block[i], rows + (k + i) * B, sizeof block[i]);
          transpose<W / 2>(block);
#pragma GCC unroll 16
          for (std::ptrdiff_t p = 0; p < W; ++p)
            std::memcpy(first + p * run.stride + k * sizeof(T), &block[p], sizeof block[p]);
        }
      for (; k < run.count; k += Q) {
        const std::size_t from = k + Q <= run.count ? k : run.count - Q;  // the last ones again, if need be
        Vector<T> row[Q], point[Q];
        for (std::size_t i = 0; i < Q; ++i)
          row[i] = *reinterpret_cast<const typename Native<T>::in_memory*>(rows + (from + i) * B);
        transpose(row, point);
        const auto to = [&](int p) { return reinterpret_cast<T*>(first + p * run.stride) + from; };
        [&]<int... p>(std::integer_sequence<int, p...>) {
          (store_part<p / Q>(to(p), point[p % Q]), ...);
        }
        (Sequence<T>{});
      }
    }
  }
}

}  // namespace
}  // namespace darboux::kernels
