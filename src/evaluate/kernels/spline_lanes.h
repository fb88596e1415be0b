/// \file spline_lanes.h
/// Splines over SIMD lanes: each lane has a span of its own. Knots and control points are the same for all
/// where they share one; else they are gathered, or on grids taken from what a row shares.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>
#include <utility>
#include <vector>

#include <darboux/spline_patch.h>

#include "lanes.h"
#include "transpose.h"

namespace darboux {
namespace kernels {
namespace {

// The `count` numbers, at least a row, that begin at a place times `step` for each lane: they are read in
// rows and transposed in registers. Numbers stored one by one would delay loading them as a register.
// \param to number i of all lanes from lanes * i on
template <int lanes, class T, class Place>
[[gnu::always_inline]] inline void transposed_numbers(const T* from, const Place& at, int step, int count,
                                                      T* to) {
  constexpr int size = row_size<T>;
  for (int first = 0;; first += size) {
    if (first + size > count) first = count - size;
#pragma GCC unroll 16
    for (int lane = 0; lane < lanes; lane += size) {
      std::array<Row<T>, static_cast<std::size_t>(size)> rows;
#pragma GCC unroll 16
      for (int k = 0; k < size; ++k)
        std::memcpy(&rows[k], from + std::ptrdiff_t{step} * at[lane + k] + first, sizeof(Row<T>));
      transpose<size / 2>(rows);
#pragma GCC unroll 16
      for (int k = 0; k < size; ++k) std::memcpy(to + lanes * (first + k) + lane, &rows[k], sizeof(Row<T>));
    }
    if (first + size == count) break;
  }
}

}  // namespace
}  // namespace kernels

namespace detail {

template <class T, std::size_t N>
struct SpanPlace<kernels::Lanes<T, N>> {
  using S = kernels::Lanes<T, N>;
  static constexpr int lanes = static_cast<int>(S::lanes);
  using Places = typename kernels::VectorOf<std::int32_t, lanes>::type;
  using Numbers = typename kernels::VectorOf<T, lanes>::type;
  Places at{};
  bool same = true;  // in all lanes

  // The maximum number of knots for a linear search.
  static constexpr int few = 64;
  template <class Knots>
  static SpanPlace find(const Knots& knots, const S& t) {
    const auto& list = knots.knots();
    const int first = knots.degree(), last = knots.not_empty(knots.count() - 1);
    if (last - first > few) {
      alignas(64) T each[lanes];
      t.store(each);
      SpanPlace result;
      for (int k = 0; k < lanes; ++k) {
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

  S as_number() const {
    const Numbers number = __builtin_convertvector(at, Numbers);
    return S::load(reinterpret_cast<const T*>(&number));
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
  S number(const std::vector<T>& list, int offset = 0) const {
    const T* const from = list.data() + offset;
    if (same) return S(from[at[0]]);
    alignas(64) T each[lanes];
    for (int k = 0; k < lanes; ++k) each[k] = from[at[k]];
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
      if (3 * count >= kernels::row_size<T>) {
        alignas(64) std::array<T, 3 * (max_spline_degree + 1) * lanes> all;
        kernels::transposed_numbers<lanes>(reinterpret_cast<const T*>(from), at, 3, 3 * count, all.data());
        for (int j = 0; j < count; ++j) {
          const T* const point = &all[3 * lanes * j];
          to[j] = {S::load(point), S::load(point + lanes), S::load(point + 2 * lanes)};
        }
        return;
      }
    for (int j = 0; j < count; ++j) {
      alignas(64) T x[lanes], y[lanes], z[lanes];
      for (int k = 0; k < lanes; ++k) {
        const Vec3<T>& p = from[at[k] + j];
        x[k] = p.x, y[k] = p.y, z[k] = p.z;
      }
      to[j] = {S::load(x), S::load(y), S::load(z)};
    }
  }
  template <class To>
  void numbers(const std::vector<T>& list, int offset, int count, To&& to) const {
    if constexpr (sizeof(T) == 8)
      if (!same && count >= kernels::row_size<T>) {
        alignas(64) std::array<T, 2 * (max_spline_degree + 1) * lanes> all;
        kernels::transposed_numbers<lanes>(list.data() + offset, at, 1, count, all.data());
        for (int j = 0; j < count; ++j) to[j] = S::load(&all[lanes * j]);
        return;
      }
    for (int j = 0; j < count; ++j) to[j] = number(list, offset + j);
  }
};

}  // namespace detail
}  // namespace darboux

namespace darboux::kernels {
namespace {

// A patch of which a kernel evaluates many points. If all of them have the same v, the columns of the net are
// evaluated there once, a register of them at a time.
template <int order, class X, class S>
class PatchInRows {
 public:
  using T = typename X::scalar;
  // \param v of all points, or null
  PatchInRows(const X& patch, const T* v) : patch_(patch), one_v_(v != nullptr) {
    if (one_v_) span_v_ = patch.span_v(S(*v));
  }

  template <int>
  Jet2<S> jet_to(const S& u, const S& v) const {
    const auto span_u = patch_.span_u(u);
    const int degree = patch_.degree_u();
    if (!one_v_ || !take_columns(span_u, degree))
      return detail::patch_jet<order>(patch_, span_u, patch_.span_v(v));
    return detail::with_degree<S>(degree, [&](auto p) {
      const auto of = [&]<class Point>(const Point&) {
        const auto along_u = span_u.weights(p, detail::Known<order>{});
        detail::Columns<order, S, Point, decltype(p)> columns;
        look_up(span_u.first, columns, p);
        return detail::jet_of_columns(columns, p, along_u);
      };
      return patch_.weights().empty() ? of(Vec3<S>{}) : of(detail::Homogeneous<S>{});
    });
  }
  Status singular(const S& u, const S& v) const { return patch_.singular(u, v); }
  S partials_condition(const S& u, const S& v) const { return patch_.partials_condition(u, v); }

 private:
  static constexpr int W = static_cast<int>(S::lanes);
  static constexpr int most = 64;  // columns at a time

  using Span = std::remove_cvref_t<decltype(std::declval<const X&>().span_v(std::declval<const S&>()))>;

  // Loads the columns of all lanes' windows. Returns false if these are too far apart.
  bool take_columns(const Span& span_u, int degree) const {
    const auto& at = span_u.first.at;
    int least = at[0], last = at[0];
    if (!span_u.first.same)
#pragma GCC unroll 16
      for (int lane = 1; lane < W; ++lane) {
        least = std::min<int>(least, at[lane]);
        last = std::max<int>(last, at[lane]);
      }
    const int end = last + degree + 1;
    if (last - least > 2 * W || end - least > most - W) return false;
    if (least < first_ || least > end_ || end > first_ + most - W) first_ = end_ = least;
    while (end_ < end) {
      take_register(span_u);
      end_ += W;
    }
    return true;
  }
  // Computes the register of columns that starts at end_, each lane with a window of one.
  [[gnu::noinline]] void take_register(Span span_u) const {
    auto net = patch_.net(span_u, span_v_);
    const int columns = static_cast<int>(net.net_points.size()) / net.row;
    for (int lane = 0; lane < W; ++lane) span_u.first.at[lane] = std::min(end_ + lane, columns - 1);
    span_u.first.same = false;
    net.first = span_u.first * net.row + span_v_.first;
    detail::with_degree<S>(net.degree_v, [&](auto q) {
      const auto of = [&]<class Point>(const Point&) {
        const auto columns = net.template columns<order, Point>(detail::Known<0>{}, q,
                                                                span_v_.weights(q, detail::Known<order>{}));
        store(columns.anchor[0], anchor_);
        for (int k = 0; k <= order; ++k) store(columns.f[k][0], f_[k]);
      };
      net.rational() ? of(detail::Homogeneous<S>{}) : of(Vec3<S>{});
    });
  }

  // Of columns first_ + 0, 1, ...: x, y, z, weight.
  using Table = std::array<std::array<T, most>, 4>;
  void store(const Vec3<S>& x, Table& to) const {
    const int at = end_ - first_;
    x.x.store(&to[0][at]), x.y.store(&to[1][at]), x.z.store(&to[2][at]);
  }
  void store(const detail::Homogeneous<S>& x, Table& to) const {
    store(x.a, to);
    x.w.store(&to[3][end_ - first_]);
  }

  // The windows of all lanes: each of their spans gives its lanes the same numbers.
  template <class Columns, class Degree>
  void look_up(const detail::SpanPlace<S>& window, Columns& columns, Degree p) const {
    int span = window.at[0] - first_;
    each_number(columns, p, [&](S& to, const T* from) { to = S(from[span]); });
    if (window.same) return;
    const S spans = (window + -first_).as_number();  // few, so that T has them all
    for (S left = spans;;) {
      left = select(left == S(static_cast<T>(span)), S(T(-1)), left);
      alignas(64) T each[S::lanes];
      left.store(each);
      const T* const next = std::find_if(each, each + S::lanes, [](T x) { return x >= T(0); });
      if (next == each + S::lanes) return;
      span = static_cast<int>(*next);
      const auto here = spans == S(*next);
      each_number(columns, p, [&](S& to, const T* from) { to = select(here, S(from[span]), to); });
    }
  }
  // f(a number of column i, that of first_ + i), i = 0 ... p
  template <class Columns, class Degree, class F>
  void each_number(Columns& columns, Degree p, const F& f) const {
    for (int i = 0; i <= p; ++i) {
      each_number(columns.anchor[i], anchor_, i, f);
      for (int k = 0; k <= order; ++k) each_number(columns.f[k][i], f_[k], i, f);
    }
  }
  template <class F>
  static void each_number(Vec3<S>& to, const Table& from, int i, const F& f) {
    f(to.x, &from[0][i]), f(to.y, &from[1][i]), f(to.z, &from[2][i]);
  }
  template <class F>
  static void each_number(detail::Homogeneous<S>& to, const Table& from, int i, const F& f) {
    each_number(to.a, from, i, f);
    f(to.w, &from[3][i]);
  }

  const X& patch_;
  bool one_v_;
  Span span_v_;
  mutable int first_ = std::numeric_limits<int>::max(), end_ = 0;  // the columns that are there
  mutable Table anchor_;
  mutable std::array<Table, order + 1> f_;
};

// A surface of which a kernel evaluates many points. \param v of all of them, or null
template <int order, class S, class X, class T>
decltype(auto) surface_in_rows(const X& surface, [[maybe_unused]] const T* v) {
  if constexpr (detail::HasNet<X>)
    return PatchInRows<order, X, S>(surface, v);
  else
    return (surface);
}

}  // namespace
}  // namespace darboux::kernels
