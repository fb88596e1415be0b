/// \file spline_lanes.h
/// Splines over SIMD lanes: each lane has a span of its own. Knots and control points are the same for all
/// where they share one, as on grids; else they are gathered.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <utility>
#include <vector>

#include <darboux/spline.h>

#include "lanes.h"
#include "transpose.h"

namespace darboux {
namespace kernels {
namespace {

// The `count` points from a place of each lane on: three numbers each, at least a row, are read in rows and
// turned round in registers. Numbers that are stored one by one would wait to be loaded as a register.
template <class S, class T, class Place, class To>
void transposed_points(const Vec3<T>* from, const Place& at, int count, To&& to) {
  constexpr int size = row_size<T>, lanes = static_cast<int>(S::lanes);
  const int numbers = 3 * count;
  alignas(64) std::array<T, 3 * (max_spline_degree + 1) * static_cast<std::size_t>(lanes)> all;
  for (int first = 0;; first += size) {
    if (first + size > numbers) first = numbers - size;
    for (int lane = 0; lane < lanes; lane += size) {
      std::array<Row<T>, static_cast<std::size_t>(size)> rows;
#pragma GCC unroll 16
      for (int k = 0; k < size; ++k)
        std::memcpy(&rows[k], reinterpret_cast<const T*>(from + at[lane + k]) + first, sizeof(Row<T>));
      transpose<size / 2>(rows);
#pragma GCC unroll 16
      for (int k = 0; k < size; ++k) std::memcpy(&all[lanes * (first + k) + lane], &rows[k], sizeof(Row<T>));
    }
    if (first + size == numbers) break;
  }
  for (int j = 0; j < count; ++j) {
    const T* const point = &all[3 * lanes * j];
    to[j] = {S::load(point), S::load(point + lanes), S::load(point + 2 * lanes)};
  }
}

}  // namespace
}  // namespace kernels

namespace detail {

template <class T, std::size_t N>
struct SpanPlace<kernels::Lanes<T, N>> {
  using S = kernels::Lanes<T, N>;
  static constexpr std::size_t lanes = S::lanes;
  using Places = typename kernels::VectorOf<std::int32_t, lanes>::type;
  using Numbers = typename kernels::VectorOf<T, lanes>::type;
  Places at{};
  bool same = true;  // in all lanes

  // At most as many knots are looked at one after the other.
  static constexpr int few = 64;
  template <class Knots>
  static SpanPlace find(const Knots& knots, const S& t) {
    const auto& list = knots.knots();
    const int first = knots.degree(), last = knots.not_empty(knots.count() - 1);
    if (last - first > few) {
      alignas(64) T each[lanes];
      t.store(each);
      SpanPlace result;
      for (std::size_t k = 0; k < lanes; ++k) {
        const int found = knots.find(each[k]);
        result.at[k] = found;
        result.same = result.same && found == result.at[0];
      }
      return result;
    }
    S found(static_cast<T>(first));
    for (int i = first + 1; i <= last; ++i)
      found = found + select(t < S(list[static_cast<std::size_t>(i)]), S(T(0)), S(T(1)));
    return SpanPlace(found);
  }
  SpanPlace() = default;
  // Small numbers: T is exact up to 2^24 only.
  explicit SpanPlace(const S& whole) {
    Numbers number;
    whole.store(reinterpret_cast<T*>(&number));
    at = __builtin_convertvector(number, Places);
    same = (whole == S(number[0])).all();
  }

  SpanPlace operator+(int n) const {
    SpanPlace result = *this;
    result.at += n;
    return result;
  }
  SpanPlace operator+(const SpanPlace& other) const {
    SpanPlace result = *this;
    result.at += other.at;
    result.same = same && other.same;
    return result;
  }
  SpanPlace operator*(int n) const {
    SpanPlace result = *this;
    result.at *= n;
    return result;
  }
  template <class Condition>
  static SpanPlace choose(const Condition& condition, int n) {
    return SpanPlace(select(condition, S(T(1)), S(T(0)))) * n;
  }

  S number(const std::vector<T>& list, int offset = 0) const {
    const T* const from = list.data() + offset;
    if (same) return S(from[at[0]]);
    alignas(64) T each[lanes];
    for (std::size_t k = 0; k < lanes; ++k) each[k] = from[at[k]];
    return S::load(each);
  }
  Vec3<S> point(const std::vector<Vec3<T>>& list, int offset = 0) const {
    Vec3<S> result;
    points(list, offset, 1, &result);
    return result;
  }
  template <class To>
  void points(const std::vector<Vec3<T>>& list, int offset, int count, To&& to) const {
    const Vec3<T>* const from = list.data() + offset;
    if (same) {
      const Vec3<T>* const p = from + at[0];
      for (int j = 0; j < count; ++j) to[j] = {S(p[j].x), S(p[j].y), S(p[j].z)};
      return;
    }
    if constexpr (sizeof(T) == 8)
      if (3 * count >= kernels::row_size<T>) return kernels::transposed_points<S>(from, at, count, to);
    for (int j = 0; j < count; ++j) {
      alignas(64) T x[lanes], y[lanes], z[lanes];
      for (std::size_t k = 0; k < lanes; ++k) {
        const Vec3<T>& p = from[at[k] + j];
        x[k] = p.x, y[k] = p.y, z[k] = p.z;
      }
      to[j] = {S::load(x), S::load(y), S::load(z)};
    }
  }
  template <class To>
  void numbers(const std::vector<T>& list, int offset, int count, To&& to) const {
    for (int j = 0; j < count; ++j) to[j] = number(list, offset + j);
  }
};

}  // namespace detail
}  // namespace darboux
